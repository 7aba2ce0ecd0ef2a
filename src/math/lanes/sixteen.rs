//! Sixteen lanes: registers of AVX-512.

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use super::{Lanes, Subroutine, call_sixteen, last_index};

/// Width of sixteen lanes: AVX-512 with the instructions of Galois fields.
///
/// It is used only on machines that have the instructions: [`Width::run`](super::Width::run).
#[derive(Clone, Copy, Debug)]
pub struct Sixteen;

/// Sixteen numbers.
#[derive(Clone, Copy)]
pub struct F32(__m512);

/// Sixteen numbers, the first eight of them in the first register.
#[derive(Clone, Copy)]
pub struct F64(__m512d, __m512d);

/// Sixteen numbers.
#[derive(Clone, Copy)]
pub struct U32(__m512i);

/// Sixteen numbers, the first eight of them in the first register.
#[derive(Clone, Copy)]
pub struct U64(__m512i, __m512i);

/// Sixteen truth values, one bit each.
#[derive(Clone, Copy)]
pub struct Mask(u16);

// SAFETY, of all operations of this file: `Sixteen` is used only by code that [`Width::run`](super::Width::run) or `Width::run_wide` runs,
// after `Width::available` has found every feature that `run_sixteen` and `call_sixteen` enable.
// Loads and stores touch only the numbers of slices whose length was checked, and gathers only indices that were bounded.

operators_of_one!(F32: Add add _mm512_add_ps, Sub sub _mm512_sub_ps, Mul mul _mm512_mul_ps, Div div _mm512_div_ps);
operators_of_two!(F64: Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd);
operators_of_one!(U32: Add add _mm512_add_epi32, Sub sub _mm512_sub_epi32, Mul mul _mm512_mullo_epi32);
operators_of_one!(U32: BitAnd bitand _mm512_and_si512, BitOr bitor _mm512_or_si512, BitXor bitxor _mm512_xor_si512);
operators_of_two!(U64: Add add _mm512_add_epi64, Mul mul _mm512_mullo_epi64);
operators_of_two!(U64: BitAnd bitand _mm512_and_si512, BitOr bitor _mm512_or_si512, BitXor bitxor _mm512_xor_si512);

impl Neg for F32 {
    type Output = F32;

    #[inline(always)]
    fn neg(self) -> F32 {
        F32(unsafe { _mm512_xor_ps(self.0, _mm512_set1_ps(-0.0)) })
    }
}

impl Neg for F64 {
    type Output = F64;

    #[inline(always)]
    fn neg(self) -> F64 {
        unsafe {
            let bit = _mm512_set1_pd(-0.0);
            F64(_mm512_xor_pd(self.0, bit), _mm512_xor_pd(self.1, bit))
        }
    }
}

impl BitAnd for Mask {
    type Output = Mask;

    #[inline(always)]
    fn bitand(self, other: Mask) -> Mask {
        Mask(self.0 & other.0)
    }
}

impl BitOr for Mask {
    type Output = Mask;

    #[inline(always)]
    fn bitor(self, other: Mask) -> Mask {
        Mask(self.0 | other.0)
    }
}

impl BitXor for Mask {
    type Output = Mask;

    #[inline(always)]
    fn bitxor(self, other: Mask) -> Mask {
        Mask(self.0 ^ other.0)
    }
}

impl Not for Mask {
    type Output = Mask;

    #[inline(always)]
    fn not(self) -> Mask {
        Mask(!self.0)
    }
}

impl Lanes for Sixteen {
    const COUNT: usize = 16;
    type F32 = F32;
    type F64 = F64;
    type U32 = U32;
    type U64 = U64;
    type Mask = Mask;

    #[inline(always)]
    fn f32(x: f32) -> F32 {
        F32(unsafe { _mm512_set1_ps(x) })
    }

    #[inline(always)]
    fn f64(x: f64) -> F64 {
        let x = unsafe { _mm512_set1_pd(x) };
        F64(x, x)
    }

    #[inline(always)]
    fn u32(x: u32) -> U32 {
        U32(unsafe { _mm512_set1_epi32(x as i32) })
    }

    #[inline(always)]
    fn u64(x: u64) -> U64 {
        let x = unsafe { _mm512_set1_epi64(x as i64) };
        U64(x, x)
    }

    #[inline(always)]
    fn lanes() -> U32 {
        U32(unsafe { _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15) })
    }

    #[inline(always)]
    fn load(from: &[f32]) -> F32 {
        let from = &from[..16];
        F32(unsafe { _mm512_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn load_f64(from: &[f64]) -> F64 {
        let from = &from[..16];
        unsafe { F64(_mm512_loadu_pd(from.as_ptr()), _mm512_loadu_pd(from.as_ptr().add(8))) }
    }

    #[inline(always)]
    fn load_u32(from: &[u32]) -> U32 {
        let from = &from[..16];
        U32(unsafe { _mm512_loadu_si512(from.as_ptr().cast()) })
    }

    #[inline(always)]
    fn load_u64(from: &[u64]) -> U64 {
        let from = &from[..16];
        unsafe { U64(_mm512_loadu_si512(from.as_ptr().cast()), _mm512_loadu_si512(from.as_ptr().add(8).cast())) }
    }

    #[inline(always)]
    fn store(x: F32, to: &mut [f32]) {
        let to = &mut to[..16];
        unsafe { _mm512_storeu_ps(to.as_mut_ptr(), x.0) }
    }

    #[inline(always)]
    fn store_f64(x: F64, to: &mut [f64]) {
        let to = &mut to[..16];
        unsafe {
            _mm512_storeu_pd(to.as_mut_ptr(), x.0);
            _mm512_storeu_pd(to.as_mut_ptr().add(8), x.1);
        }
    }

    #[inline(always)]
    fn store_u32(x: U32, to: &mut [u32]) {
        let to = &mut to[..16];
        unsafe { _mm512_storeu_si512(to.as_mut_ptr().cast(), x.0) }
    }

    #[inline(always)]
    fn store_u64(x: U64, to: &mut [u64]) {
        let to = &mut to[..16];
        unsafe {
            _mm512_storeu_si512(to.as_mut_ptr().cast(), x.0);
            _mm512_storeu_si512(to.as_mut_ptr().add(8).cast(), x.1);
        }
    }

    #[inline(always)]
    fn pack(x: F32, mask: Mask, to: &mut [f32]) {
        let to = &mut to[..16];
        unsafe { _mm512_storeu_ps(to.as_mut_ptr(), _mm512_maskz_compress_ps(mask.0, x.0)) }
    }

    #[inline(always)]
    fn pack_u32(x: U32, mask: Mask, to: &mut [u32]) {
        let to = &mut to[..16];
        unsafe { _mm512_storeu_si512(to.as_mut_ptr().cast(), _mm512_maskz_compress_epi32(mask.0, x.0)) }
    }

    #[inline(always)]
    fn gather(table: &[f32], index: U32) -> F32 {
        let last = Self::u32(last_index(table.len())).0;
        F32(unsafe { _mm512_i32gather_ps::<4>(_mm512_min_epu32(index.0, last), table.as_ptr()) })
    }

    #[inline(always)]
    fn gather_u32(table: &[u32], index: U32) -> U32 {
        let last = Self::u32(last_index(table.len())).0;
        U32(unsafe { _mm512_i32gather_epi32::<4>(_mm512_min_epu32(index.0, last), table.as_ptr().cast()) })
    }

    #[inline(always)]
    fn gather_f64(table: &[f64], index: U32) -> F64 {
        let last = Self::u32(last_index(table.len())).0;
        unsafe {
            let index = _mm512_min_epu32(index.0, last);
            let [low, high] = [_mm512_castsi512_si256(index), _mm512_extracti64x4_epi64::<1>(index)];
            F64(_mm512_i32gather_pd::<8>(low, table.as_ptr()), _mm512_i32gather_pd::<8>(high, table.as_ptr()))
        }
    }

    #[inline(always)]
    fn sqrt(x: F32) -> F32 {
        F32(unsafe { _mm512_sqrt_ps(x.0) })
    }

    #[inline(always)]
    fn abs(x: F32) -> F32 {
        F32(unsafe { _mm512_abs_ps(x.0) })
    }

    #[inline(always)]
    fn min(a: F32, b: F32) -> F32 {
        F32(unsafe { _mm512_min_ps(a.0, b.0) })
    }

    #[inline(always)]
    fn max(a: F32, b: F32) -> F32 {
        F32(unsafe { _mm512_max_ps(a.0, b.0) })
    }

    #[inline(always)]
    fn copysign(x: F32, sign: F32) -> F32 {
        unsafe {
            let bit = _mm512_set1_ps(-0.0);
            F32(_mm512_or_ps(_mm512_andnot_ps(bit, x.0), _mm512_and_ps(bit, sign.0)))
        }
    }

    #[inline(always)]
    fn lt(a: F32, b: F32) -> Mask {
        Mask(unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a.0, b.0) })
    }

    #[inline(always)]
    fn le(a: F32, b: F32) -> Mask {
        Mask(unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a.0, b.0) })
    }

    #[inline(always)]
    fn select(mask: Mask, yes: F32, no: F32) -> F32 {
        F32(unsafe { _mm512_mask_blend_ps(mask.0, no.0, yes.0) })
    }

    #[inline(always)]
    fn select_u32(mask: Mask, yes: U32, no: U32) -> U32 {
        U32(unsafe { _mm512_mask_blend_epi32(mask.0, no.0, yes.0) })
    }

    #[inline(always)]
    fn eq_u32(a: U32, b: U32) -> Mask {
        Mask(unsafe { _mm512_cmpeq_epi32_mask(a.0, b.0) })
    }

    #[inline(always)]
    fn widen(x: F32) -> F64 {
        unsafe { F64(_mm512_cvtps_pd(_mm512_castps512_ps256(x.0)), _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(x.0))) }
    }

    #[inline(always)]
    fn narrow(x: F64) -> F32 {
        F32(unsafe { _mm512_insertf32x8::<1>(_mm512_castps256_ps512(_mm512_cvtpd_ps(x.0)), _mm512_cvtpd_ps(x.1)) })
    }

    #[inline(always)]
    fn sqrt_f64(x: F64) -> F64 {
        unsafe { F64(_mm512_sqrt_pd(x.0), _mm512_sqrt_pd(x.1)) }
    }

    #[inline(always)]
    fn abs_f64(x: F64) -> F64 {
        unsafe { F64(_mm512_abs_pd(x.0), _mm512_abs_pd(x.1)) }
    }

    #[inline(always)]
    fn min_f64(a: F64, b: F64) -> F64 {
        unsafe { F64(_mm512_min_pd(a.0, b.0), _mm512_min_pd(a.1, b.1)) }
    }

    #[inline(always)]
    fn max_f64(a: F64, b: F64) -> F64 {
        unsafe { F64(_mm512_max_pd(a.0, b.0), _mm512_max_pd(a.1, b.1)) }
    }

    #[inline(always)]
    fn lt_f64(a: F64, b: F64) -> Mask {
        unsafe {
            let (below, above) = (_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a.0, b.0), _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a.1, b.1));
            Mask(below as u16 | (above as u16) << 8)
        }
    }

    #[inline(always)]
    fn select_f64(mask: Mask, yes: F64, no: F64) -> F64 {
        unsafe { F64(_mm512_mask_blend_pd(mask.0 as u8, no.0, yes.0), _mm512_mask_blend_pd((mask.0 >> 8) as u8, no.1, yes.1)) }
    }

    #[inline(always)]
    fn mask(bits: u32) -> Mask {
        Mask(bits as u16)
    }

    #[inline(always)]
    fn bits(mask: Mask) -> u32 {
        mask.0 as u32
    }

    #[inline(always)]
    fn shl<const K: u32>(x: U32) -> U32 {
        const { assert!(K < 32) };
        U32(unsafe { _mm512_slli_epi32::<K>(x.0) })
    }

    #[inline(always)]
    fn shr<const K: u32>(x: U32) -> U32 {
        const { assert!(K < 32) };
        U32(unsafe { _mm512_srli_epi32::<K>(x.0) })
    }

    #[inline(always)]
    fn shl_u64<const K: u32>(x: U64) -> U64 {
        const { assert!(K < 64) };
        unsafe { U64(_mm512_slli_epi64::<K>(x.0), _mm512_slli_epi64::<K>(x.1)) }
    }

    #[inline(always)]
    fn shr_u64<const K: u32>(x: U64) -> U64 {
        const { assert!(K < 64) };
        unsafe { U64(_mm512_srli_epi64::<K>(x.0), _mm512_srli_epi64::<K>(x.1)) }
    }

    #[inline(always)]
    fn bits_f64(x: F64) -> U64 {
        unsafe { U64(_mm512_castpd_si512(x.0), _mm512_castpd_si512(x.1)) }
    }

    #[inline(always)]
    fn from_bits_f64(x: U64) -> F64 {
        unsafe { F64(_mm512_castsi512_pd(x.0), _mm512_castsi512_pd(x.1)) }
    }

    #[inline(always)]
    fn rotate_32(x: U64) -> U64 {
        unsafe { U64(_mm512_shuffle_epi32::<0b10_11_00_01>(x.0), _mm512_shuffle_epi32::<0b10_11_00_01>(x.1)) }
    }

    #[inline(always)]
    fn wide(x: U32) -> U64 {
        unsafe { U64(_mm512_cvtepu32_epi64(_mm512_castsi512_si256(x.0)), _mm512_cvtepu32_epi64(_mm512_extracti64x4_epi64::<1>(x.0))) }
    }

    #[inline(always)]
    fn high(x: U64) -> U32 {
        unsafe {
            let odd = _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
            U32(_mm512_permutex2var_epi32(x.0, odd, x.1))
        }
    }

    #[inline(always)]
    fn low(x: U64) -> U32 {
        unsafe {
            let even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
            U32(_mm512_permutex2var_epi32(x.0, even, x.1))
        }
    }

    #[inline(always)]
    fn reverse_bits(x: U32) -> U32 {
        // Turns the bytes of each number around, then the bits of each byte by a matrix of 8 · 8 bits.
        unsafe {
            let bytes = _mm512_broadcast_i32x4(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
            let matrix = _mm512_set1_epi64(0x8040_2010_0804_0201_u64 as i64);
            U32(_mm512_gf2p8affine_epi64_epi8::<0>(_mm512_shuffle_epi8(x.0, bytes), matrix))
        }
    }

    #[inline(always)]
    fn to_f32(x: U32) -> F32 {
        F32(unsafe { _mm512_cvtepi32_ps(x.0) })
    }

    #[inline(always)]
    fn to_u32(x: F32) -> U32 {
        U32(unsafe { _mm512_cvttps_epi32(x.0) })
    }

    #[inline(always)]
    fn call<S: Subroutine<Self>>(subroutine: S) -> S::Output {
        unsafe { call_sixteen(subroutine) }
    }
}
