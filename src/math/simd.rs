//! SIMD vectors of eight numbers.
//!
//! All instruction sets do the same operations in the same order with the same rounding (without fused multiply-add), so that the choice
//! changes no bit of any picture. It is made once for each hierarchy and each light tree. `PT_SIMD=sse2` selects the plain one.
//!
//! Tests: instruction_sets_agree.

use glam::Vec4;

/// Vector of f32, with operations lane by lane.
pub trait Arithmetic: Copy {
    /// `x` in all lanes.
    fn splat(x: f32) -> Self;
    /// Sum.
    fn plus(self, other: Self) -> Self;
    /// Difference.
    fn minus(self, other: Self) -> Self;
    /// Product.
    fn times(self, other: Self) -> Self;
    /// Maximum; `other` if either is NaN.
    fn larger(self, other: Self) -> Self;
    /// Minimum; `other` if either is NaN.
    fn smaller(self, other: Self) -> Self;
    /// Quotient.
    fn over(self, other: Self) -> Self;
    /// Square root.
    fn root(self) -> Self;
    /// `yes` where self < other, `no` elsewhere.
    fn choose_below(self, other: Self, yes: Self, no: Self) -> Self;
    /// Absolute value.
    fn size(self) -> Self;
}

/// Vector of eight f32.
pub trait Lanes: Arithmetic {
    /// Eight numbers.
    fn load(from: &[f32; 8]) -> Self;
    /// Eight whole numbers.
    fn load_u16(from: &[u16; 8]) -> Self;
    /// Bit mask of self ≤ other.
    fn at_most(self, other: Self) -> u32;
    /// Bit mask of self < other.
    fn below(self, other: Self) -> u32;
    /// Product self · sign(other).
    fn signed_by(self, other: Self) -> Self;
    /// The eight numbers.
    fn to_array(self) -> [f32; 8];
}

/// Three numbers, each in all lanes.
///
/// Without `array::map`: a call of it is not sure to be inlined, and then its closure is compiled without AVX2.
#[inline(always)]
pub fn splat<A: Arithmetic>(numbers: [f32; 3]) -> [A; 3] {
    [A::splat(numbers[0]), A::splat(numbers[1]), A::splat(numbers[2])]
}

/// Scalar product of vectors of three numbers.
#[inline(always)]
pub fn dot<A: Arithmetic>(a: [A; 3], b: [A; 3]) -> A {
    a[0].times(b[0]).plus(a[1].times(b[1])).plus(a[2].times(b[2]))
}

/// Two vectors of four, available on every x86-64 processor and every other machine that glam supports.
#[derive(Clone, Copy)]
pub struct Halves([Vec4; 2]);

impl Halves {
    #[inline(always)]
    fn both(self, other: Halves, f: impl Fn(Vec4, Vec4) -> Vec4) -> Halves {
        Halves([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }
}

impl Arithmetic for Halves {
    #[inline(always)]
    fn splat(x: f32) -> Halves {
        Halves([Vec4::splat(x); 2])
    }

    #[inline(always)]
    fn plus(self, other: Halves) -> Halves {
        self.both(other, |a, b| a + b)
    }

    #[inline(always)]
    fn minus(self, other: Halves) -> Halves {
        self.both(other, |a, b| a - b)
    }

    #[inline(always)]
    fn times(self, other: Halves) -> Halves {
        self.both(other, |a, b| a * b)
    }

    #[inline(always)]
    fn larger(self, other: Halves) -> Halves {
        self.both(other, Vec4::max)
    }

    #[inline(always)]
    fn smaller(self, other: Halves) -> Halves {
        self.both(other, Vec4::min)
    }

    #[inline(always)]
    fn over(self, other: Halves) -> Halves {
        self.both(other, |a, b| a / b)
    }

    #[inline(always)]
    fn root(self) -> Halves {
        Halves(self.0.map(|half| Vec4::from(half.to_array().map(f32::sqrt))))
    }

    #[inline(always)]
    fn choose_below(self, other: Halves, yes: Halves, no: Halves) -> Halves {
        let half = |k: usize| Vec4::select(self.0[k].cmplt(other.0[k]), yes.0[k], no.0[k]);
        Halves([half(0), half(1)])
    }

    #[inline(always)]
    fn size(self) -> Halves {
        Halves(self.0.map(Vec4::abs))
    }
}

impl Lanes for Halves {
    #[inline(always)]
    fn load(from: &[f32; 8]) -> Halves {
        Halves([Vec4::from_slice(&from[..4]), Vec4::from_slice(&from[4..])])
    }

    #[inline(always)]
    fn load_u16(from: &[u16; 8]) -> Halves {
        let half = |k: usize| Vec4::new(from[k].into(), from[k + 1].into(), from[k + 2].into(), from[k + 3].into());
        Halves([half(0), half(4)])
    }

    #[inline(always)]
    fn at_most(self, other: Halves) -> u32 {
        self.0[0].cmple(other.0[0]).bitmask() | self.0[1].cmple(other.0[1]).bitmask() << 4
    }

    #[inline(always)]
    fn below(self, other: Halves) -> u32 {
        self.0[0].cmplt(other.0[0]).bitmask() | self.0[1].cmplt(other.0[1]).bitmask() << 4
    }

    #[inline(always)]
    fn signed_by(self, other: Halves) -> Halves {
        self.both(other, |x, sign| x * Vec4::ONE.copysign(sign))
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        let [low, high] = self.0.map(|half| half.to_array());
        [low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]]
    }
}

#[cfg(target_arch = "x86_64")]
pub use avx::Whole;

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "the instructions exist only where the processor has AVX2, which `Set::detect` asks")]
mod avx {
    use std::arch::x86_64::*;

    use super::{Arithmetic, Lanes};

    /// One AVX register. It is used only if AVX2 was detected: [`super::Set::Avx2`].
    #[derive(Clone, Copy)]
    pub struct Whole(__m256);

    // SAFETY: all code that makes or uses a `Whole` is compiled for AVX2 and runs only on machines that have it (see `accel::bvh` and `light::tree`).
    impl Arithmetic for Whole {
        #[inline(always)]
        fn splat(x: f32) -> Whole {
            Whole(unsafe { _mm256_set1_ps(x) })
        }

        #[inline(always)]
        fn plus(self, other: Whole) -> Whole {
            Whole(unsafe { _mm256_add_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn minus(self, other: Whole) -> Whole {
            Whole(unsafe { _mm256_sub_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn times(self, other: Whole) -> Whole {
            Whole(unsafe { _mm256_mul_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn larger(self, other: Whole) -> Whole {
            Whole(unsafe { _mm256_max_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn smaller(self, other: Whole) -> Whole {
            Whole(unsafe { _mm256_min_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn over(self, other: Whole) -> Whole {
            Whole(unsafe { _mm256_div_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn root(self) -> Whole {
            Whole(unsafe { _mm256_sqrt_ps(self.0) })
        }

        #[inline(always)]
        fn choose_below(self, other: Whole, yes: Whole, no: Whole) -> Whole {
            Whole(unsafe { _mm256_blendv_ps(no.0, yes.0, _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) })
        }

        #[inline(always)]
        fn size(self) -> Whole {
            Whole(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }
    }

    impl Lanes for Whole {
        #[inline(always)]
        fn load(from: &[f32; 8]) -> Whole {
            Whole(unsafe { _mm256_loadu_ps(from.as_ptr()) })
        }

        #[inline(always)]
        fn load_u16(from: &[u16; 8]) -> Whole {
            Whole(unsafe { _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(from.as_ptr().cast()))) })
        }

        #[inline(always)]
        fn at_most(self, other: Whole) -> u32 {
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) as u32 }
        }

        #[inline(always)]
        fn below(self, other: Whole) -> u32 {
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) as u32 }
        }

        #[inline(always)]
        fn signed_by(self, other: Whole) -> Whole {
            Whole(unsafe { _mm256_xor_ps(self.0, _mm256_and_ps(_mm256_set1_ps(-0.0), other.0)) })
        }

        #[inline(always)]
        fn to_array(self) -> [f32; 8] {
            let mut array = [0.0; 8];
            unsafe { _mm256_storeu_ps(array.as_mut_ptr(), self.0) };
            array
        }
    }
}

/// Instruction set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Set {
    /// Vectors of four numbers.
    Plain,
    /// AVX2.
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

impl Set {
    /// Best instruction set of this machine, unless the environment variable PT_SIMD selects another.
    pub fn detect() -> Set {
        #[cfg(target_arch = "x86_64")]
        if std::env::var_os("PT_SIMD").is_none_or(|set| set != "sse2") && std::arch::is_x86_feature_detected!("avx2") {
            return Set::Avx2;
        }
        Set::Plain
    }
}
