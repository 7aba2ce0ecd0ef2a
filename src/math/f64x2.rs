//! SIMD vector of two `f64`.
//!
//! Compilers vectorize pairs of operations in some places only, and this type makes it explicit. Both implementations use the operations
//! of IEEE 754 and so give the same bits.

use std::ops::{Add, Mul};

#[cfg(target_arch = "x86_64")]
pub use register::F64x2;

#[cfg(not(target_arch = "x86_64"))]
pub use plain::F64x2;

/// Both numbers in one register.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "the instructions are part of every x86-64 processor")]
mod register {
    use std::arch::x86_64::*;

    #[derive(Clone, Copy)]
    pub struct F64x2(__m128d);

    // Sound: the instructions are part of every x86-64 processor.
    impl F64x2 {
        #[inline(always)]
        pub fn splat(x: f64) -> F64x2 {
            F64x2(unsafe { _mm_set1_pd(x) })
        }
    }

    impl From<[f64; 2]> for F64x2 {
        #[inline(always)]
        fn from([first, second]: [f64; 2]) -> F64x2 {
            F64x2(unsafe { _mm_set_pd(second, first) })
        }
    }

    impl From<F64x2> for [f64; 2] {
        #[inline(always)]
        fn from(pair: F64x2) -> [f64; 2] {
            unsafe { [_mm_cvtsd_f64(pair.0), _mm_cvtsd_f64(_mm_unpackhi_pd(pair.0, pair.0))] }
        }
    }

    impl super::Add for F64x2 {
        type Output = F64x2;
        #[inline(always)]
        fn add(self, other: F64x2) -> F64x2 {
            F64x2(unsafe { _mm_add_pd(self.0, other.0) })
        }
    }

    impl super::Mul for F64x2 {
        type Output = F64x2;
        #[inline(always)]
        fn mul(self, other: F64x2) -> F64x2 {
            F64x2(unsafe { _mm_mul_pd(self.0, other.0) })
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
mod plain {
    #[derive(Clone, Copy)]
    pub struct F64x2([f64; 2]);

    impl F64x2 {
        pub fn splat(x: f64) -> F64x2 {
            F64x2([x; 2])
        }
    }

    impl From<[f64; 2]> for F64x2 {
        fn from(both: [f64; 2]) -> F64x2 {
            F64x2(both)
        }
    }

    impl From<F64x2> for [f64; 2] {
        fn from(pair: F64x2) -> [f64; 2] {
            pair.0
        }
    }

    impl super::Add for F64x2 {
        type Output = F64x2;
        fn add(self, other: F64x2) -> F64x2 {
            F64x2([self.0[0] + other.0[0], self.0[1] + other.0[1]])
        }
    }

    impl super::Mul for F64x2 {
        type Output = F64x2;
        fn mul(self, other: F64x2) -> F64x2 {
            F64x2([self.0[0] * other.0[0], self.0[1] * other.0[1]])
        }
    }
}
