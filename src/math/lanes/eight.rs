//! Eight lanes: registers of AVX2.

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use super::{Lanes, Subroutine, call_eight, last_index};

/// Width of eight lanes: AVX2.
///
/// It is used only on machines that have the instructions: [`Width::run`](super::Width::run).
#[derive(Clone, Copy, Debug)]
pub struct Eight;

/// Eight numbers.
#[derive(Clone, Copy)]
pub struct F32(__m256);

/// Eight numbers, the first four of them in the first register.
#[derive(Clone, Copy)]
pub struct F64(__m256d, __m256d);

/// Eight numbers.
#[derive(Clone, Copy)]
pub struct U32(__m256i);

/// Eight numbers, the first four of them in the first register.
#[derive(Clone, Copy)]
pub struct U64(__m256i, __m256i);

/// Eight truth values: all bits of a lane are set or none.
#[derive(Clone, Copy)]
pub struct Mask(__m256);

// SAFETY, of all operations of this file: `Eight` is used only by code that [`Width::run`](super::Width::run) or `Width::run_wide` runs, after
// `Width::available` has found every feature that `run_eight` and `call_eight` enable.
// Loads and stores touch only the numbers of slices whose length was checked, and gathers only indices that were bounded.

operators_of_one!(F32: Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);
operators_of_two!(F64: Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd);
operators_of_one!(U32: Add add _mm256_add_epi32, Sub sub _mm256_sub_epi32, Mul mul _mm256_mullo_epi32);
operators_of_one!(U32: BitAnd bitand _mm256_and_si256, BitOr bitor _mm256_or_si256, BitXor bitxor _mm256_xor_si256);
operators_of_two!(U64: Add add _mm256_add_epi64, Mul mul product);
operators_of_two!(U64: BitAnd bitand _mm256_and_si256, BitOr bitor _mm256_or_si256, BitXor bitxor _mm256_xor_si256);
operators_of_one!(Mask: BitAnd bitand _mm256_and_ps, BitOr bitor _mm256_or_ps, BitXor bitxor _mm256_xor_ps);

impl Neg for F32 {
    type Output = F32;

    #[inline(always)]
    fn neg(self) -> F32 {
        F32(unsafe { _mm256_xor_ps(self.0, _mm256_set1_ps(-0.0)) })
    }
}

impl Neg for F64 {
    type Output = F64;

    #[inline(always)]
    fn neg(self) -> F64 {
        unsafe {
            let bit = _mm256_set1_pd(-0.0);
            F64(_mm256_xor_pd(self.0, bit), _mm256_xor_pd(self.1, bit))
        }
    }
}

impl Not for Mask {
    type Output = Mask;

    #[inline(always)]
    fn not(self) -> Mask {
        Mask(unsafe { _mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1))) })
    }
}

/// Products of four numbers of 64 bits, of which AVX2 multiplies only halves. It needs AVX2.
#[inline(always)]
unsafe fn product(a: __m256i, b: __m256i) -> __m256i {
    unsafe {
        let low = _mm256_mul_epu32(a, b);
        let left = _mm256_mul_epu32(_mm256_srli_epi64::<32>(a), b);
        let right = _mm256_mul_epu32(a, _mm256_srli_epi64::<32>(b));
        _mm256_add_epi64(low, _mm256_slli_epi64::<32>(_mm256_add_epi64(left, right)))
    }
}

/// Numbers 0, 2, 4 and 6 of `a`, then those of `b`. It needs AVX2.
#[inline(always)]
unsafe fn even(a: __m256, b: __m256) -> __m256 {
    unsafe {
        let mixed = _mm256_castps_pd(_mm256_shuffle_ps::<0b10_00_10_00>(a, b));
        _mm256_castpd_ps(_mm256_permute4x64_pd::<0b11_01_10_00>(mixed))
    }
}

impl Lanes for Eight {
    const COUNT: usize = 8;
    type F32 = F32;
    type F64 = F64;
    type U32 = U32;
    type U64 = U64;
    type Mask = Mask;

    #[inline(always)]
    fn f32(x: f32) -> F32 {
        F32(unsafe { _mm256_set1_ps(x) })
    }

    #[inline(always)]
    fn f64(x: f64) -> F64 {
        let x = unsafe { _mm256_set1_pd(x) };
        F64(x, x)
    }

    #[inline(always)]
    fn u32(x: u32) -> U32 {
        U32(unsafe { _mm256_set1_epi32(x as i32) })
    }

    #[inline(always)]
    fn u64(x: u64) -> U64 {
        let x = unsafe { _mm256_set1_epi64x(x as i64) };
        U64(x, x)
    }

    #[inline(always)]
    fn lanes() -> U32 {
        U32(unsafe { _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7) })
    }

    #[inline(always)]
    fn load(from: &[f32]) -> F32 {
        let from = &from[..8];
        F32(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn load_f64(from: &[f64]) -> F64 {
        let from = &from[..8];
        unsafe { F64(_mm256_loadu_pd(from.as_ptr()), _mm256_loadu_pd(from.as_ptr().add(4))) }
    }

    #[inline(always)]
    fn load_u32(from: &[u32]) -> U32 {
        let from = &from[..8];
        U32(unsafe { _mm256_loadu_si256(from.as_ptr().cast()) })
    }

    #[inline(always)]
    fn load_u64(from: &[u64]) -> U64 {
        let from = &from[..8];
        unsafe { U64(_mm256_loadu_si256(from.as_ptr().cast()), _mm256_loadu_si256(from.as_ptr().add(4).cast())) }
    }

    #[inline(always)]
    fn store(x: F32, to: &mut [f32]) {
        let to = &mut to[..8];
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), x.0) }
    }

    #[inline(always)]
    fn store_f64(x: F64, to: &mut [f64]) {
        let to = &mut to[..8];
        unsafe {
            _mm256_storeu_pd(to.as_mut_ptr(), x.0);
            _mm256_storeu_pd(to.as_mut_ptr().add(4), x.1);
        }
    }

    #[inline(always)]
    fn store_u32(x: U32, to: &mut [u32]) {
        let to = &mut to[..8];
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), x.0) }
    }

    #[inline(always)]
    fn store_u64(x: U64, to: &mut [u64]) {
        let to = &mut to[..8];
        unsafe {
            _mm256_storeu_si256(to.as_mut_ptr().cast(), x.0);
            _mm256_storeu_si256(to.as_mut_ptr().add(4).cast(), x.1);
        }
    }

    #[inline(always)]
    fn pack(x: F32, mask: Mask, to: &mut [f32]) {
        let to = &mut to[..8];
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), _mm256_permutevar8x32_ps(x.0, order(mask))) }
    }

    #[inline(always)]
    fn pack_u32(x: U32, mask: Mask, to: &mut [u32]) {
        let to = &mut to[..8];
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), _mm256_permutevar8x32_epi32(x.0, order(mask))) }
    }

    #[inline(always)]
    fn gather(table: &[f32], index: U32) -> F32 {
        let last = Self::u32(last_index(table.len())).0;
        F32(unsafe { _mm256_i32gather_ps::<4>(table.as_ptr(), _mm256_min_epu32(index.0, last)) })
    }

    #[inline(always)]
    fn gather_u32(table: &[u32], index: U32) -> U32 {
        let last = Self::u32(last_index(table.len())).0;
        U32(unsafe { _mm256_i32gather_epi32::<4>(table.as_ptr().cast(), _mm256_min_epu32(index.0, last)) })
    }

    #[inline(always)]
    fn gather_f64(table: &[f64], index: U32) -> F64 {
        let last = Self::u32(last_index(table.len())).0;
        unsafe {
            let index = _mm256_min_epu32(index.0, last);
            let [low, high] = [_mm256_castsi256_si128(index), _mm256_extracti128_si256::<1>(index)];
            F64(_mm256_i32gather_pd::<8>(table.as_ptr(), low), _mm256_i32gather_pd::<8>(table.as_ptr(), high))
        }
    }

    #[inline(always)]
    fn sqrt(x: F32) -> F32 {
        F32(unsafe { _mm256_sqrt_ps(x.0) })
    }

    #[inline(always)]
    fn abs(x: F32) -> F32 {
        F32(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), x.0) })
    }

    #[inline(always)]
    fn min(a: F32, b: F32) -> F32 {
        F32(unsafe { _mm256_min_ps(a.0, b.0) })
    }

    #[inline(always)]
    fn max(a: F32, b: F32) -> F32 {
        F32(unsafe { _mm256_max_ps(a.0, b.0) })
    }

    #[inline(always)]
    fn copysign(x: F32, sign: F32) -> F32 {
        unsafe {
            let bit = _mm256_set1_ps(-0.0);
            F32(_mm256_or_ps(_mm256_andnot_ps(bit, x.0), _mm256_and_ps(bit, sign.0)))
        }
    }

    #[inline(always)]
    fn lt(a: F32, b: F32) -> Mask {
        Mask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a.0, b.0) })
    }

    #[inline(always)]
    fn le(a: F32, b: F32) -> Mask {
        Mask(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(a.0, b.0) })
    }

    #[inline(always)]
    fn select(mask: Mask, yes: F32, no: F32) -> F32 {
        F32(unsafe { _mm256_blendv_ps(no.0, yes.0, mask.0) })
    }

    #[inline(always)]
    fn select_u32(mask: Mask, yes: U32, no: U32) -> U32 {
        U32(unsafe { _mm256_blendv_epi8(no.0, yes.0, _mm256_castps_si256(mask.0)) })
    }

    #[inline(always)]
    fn eq_u32(a: U32, b: U32) -> Mask {
        Mask(unsafe { _mm256_castsi256_ps(_mm256_cmpeq_epi32(a.0, b.0)) })
    }

    #[inline(always)]
    fn widen(x: F32) -> F64 {
        unsafe { F64(_mm256_cvtps_pd(_mm256_castps256_ps128(x.0)), _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(x.0))) }
    }

    #[inline(always)]
    fn narrow(x: F64) -> F32 {
        F32(unsafe { _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(_mm256_cvtpd_ps(x.0)), _mm256_cvtpd_ps(x.1)) })
    }

    #[inline(always)]
    fn sqrt_f64(x: F64) -> F64 {
        unsafe { F64(_mm256_sqrt_pd(x.0), _mm256_sqrt_pd(x.1)) }
    }

    #[inline(always)]
    fn abs_f64(x: F64) -> F64 {
        unsafe {
            let bit = _mm256_set1_pd(-0.0);
            F64(_mm256_andnot_pd(bit, x.0), _mm256_andnot_pd(bit, x.1))
        }
    }

    #[inline(always)]
    fn min_f64(a: F64, b: F64) -> F64 {
        unsafe { F64(_mm256_min_pd(a.0, b.0), _mm256_min_pd(a.1, b.1)) }
    }

    #[inline(always)]
    fn max_f64(a: F64, b: F64) -> F64 {
        unsafe { F64(_mm256_max_pd(a.0, b.0), _mm256_max_pd(a.1, b.1)) }
    }

    #[inline(always)]
    fn lt_f64(a: F64, b: F64) -> Mask {
        unsafe {
            let (below, above) = (_mm256_cmp_pd::<_CMP_LT_OQ>(a.0, b.0), _mm256_cmp_pd::<_CMP_LT_OQ>(a.1, b.1));
            Mask(even(_mm256_castpd_ps(below), _mm256_castpd_ps(above)))
        }
    }

    #[inline(always)]
    fn select_f64(mask: Mask, yes: F64, no: F64) -> F64 {
        unsafe {
            let mask = _mm256_castps_si256(mask.0);
            let below = _mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm256_castsi256_si128(mask)));
            let above = _mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm256_extracti128_si256::<1>(mask)));
            F64(_mm256_blendv_pd(no.0, yes.0, below), _mm256_blendv_pd(no.1, yes.1, above))
        }
    }

    #[inline(always)]
    fn mask(bits: u32) -> Mask {
        unsafe {
            let place = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            Mask(_mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(bits as i32), place), place)))
        }
    }

    #[inline(always)]
    fn bits(mask: Mask) -> u32 {
        unsafe { _mm256_movemask_ps(mask.0) as u32 }
    }

    #[inline(always)]
    fn shl<const K: u32>(x: U32) -> U32 {
        const { assert!(K < 32) };
        U32(unsafe { _mm256_sll_epi32(x.0, _mm_cvtsi32_si128(K as i32)) })
    }

    #[inline(always)]
    fn shr<const K: u32>(x: U32) -> U32 {
        const { assert!(K < 32) };
        U32(unsafe { _mm256_srl_epi32(x.0, _mm_cvtsi32_si128(K as i32)) })
    }

    #[inline(always)]
    fn shl_u64<const K: u32>(x: U64) -> U64 {
        const { assert!(K < 64) };
        unsafe {
            let count = _mm_cvtsi32_si128(K as i32);
            U64(_mm256_sll_epi64(x.0, count), _mm256_sll_epi64(x.1, count))
        }
    }

    #[inline(always)]
    fn shr_u64<const K: u32>(x: U64) -> U64 {
        const { assert!(K < 64) };
        unsafe {
            let count = _mm_cvtsi32_si128(K as i32);
            U64(_mm256_srl_epi64(x.0, count), _mm256_srl_epi64(x.1, count))
        }
    }

    #[inline(always)]
    fn bits_f64(x: F64) -> U64 {
        unsafe { U64(_mm256_castpd_si256(x.0), _mm256_castpd_si256(x.1)) }
    }

    #[inline(always)]
    fn from_bits_f64(x: U64) -> F64 {
        unsafe { F64(_mm256_castsi256_pd(x.0), _mm256_castsi256_pd(x.1)) }
    }

    #[inline(always)]
    fn rotate_32(x: U64) -> U64 {
        unsafe { U64(_mm256_shuffle_epi32::<0b10_11_00_01>(x.0), _mm256_shuffle_epi32::<0b10_11_00_01>(x.1)) }
    }

    #[inline(always)]
    fn wide(x: U32) -> U64 {
        unsafe { U64(_mm256_cvtepu32_epi64(_mm256_castsi256_si128(x.0)), _mm256_cvtepu32_epi64(_mm256_extracti128_si256::<1>(x.0))) }
    }

    #[inline(always)]
    fn high(x: U64) -> U32 {
        Self::low(Self::shr_u64::<32>(x))
    }

    #[inline(always)]
    fn low(x: U64) -> U32 {
        U32(unsafe { _mm256_castps_si256(even(_mm256_castsi256_ps(x.0), _mm256_castsi256_ps(x.1))) })
    }

    #[inline(always)]
    fn reverse_bits(x: U32) -> U32 {
        // Turns the bytes of each number around, then the bits of each byte by tables of its two halves.
        unsafe {
            let bytes = _mm256_broadcastsi128_si256(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
            let low = _mm256_broadcastsi128_si256(_mm_setr_epi8(0, -128, 64, -64, 32, -96, 96, -32, 16, -112, 80, -48, 48, -80, 112, -16));
            let high = _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
            let (x, half) = (_mm256_shuffle_epi8(x.0, bytes), _mm256_set1_epi8(15));
            let low = _mm256_shuffle_epi8(low, _mm256_and_si256(x, half));
            let high = _mm256_shuffle_epi8(high, _mm256_and_si256(_mm256_srli_epi16::<4>(x), half));
            U32(_mm256_or_si256(low, high))
        }
    }

    #[inline(always)]
    fn to_f32(x: U32) -> F32 {
        F32(unsafe { _mm256_cvtepi32_ps(x.0) })
    }

    #[inline(always)]
    fn to_u32(x: F32) -> U32 {
        U32(unsafe { _mm256_cvttps_epi32(x.0) })
    }

    #[inline(always)]
    fn call<S: Subroutine<Self>>(subroutine: S) -> S::Output {
        unsafe { call_eight(subroutine) }
    }
}

/// For each mask of eight lanes, the lanes of the mask.
static LANES_OF_MASKS: [[u32; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut count, mut lane) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// The lanes of a mask, for packing.
#[inline(always)]
fn order(mask: Mask) -> __m256i {
    let lanes = &LANES_OF_MASKS[Eight::bits(mask) as usize & 255];
    unsafe { _mm256_loadu_si256(lanes.as_ptr().cast()) }
}
