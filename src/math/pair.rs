//! Two numbers of double precision side by side, for what is computed twice in the same way.
//!
//! Compilers find such pairs by themselves in some places and not in others; here they need not look. The operations are those of
//! IEEE 754 in either form, and so are the bits.

use std::ops::{Add, Mul};

#[cfg(target_arch = "x86_64")]
pub use register::Pair;

#[cfg(not(target_arch = "x86_64"))]
pub use plain::Pair;

/// One register.
#[cfg(target_arch = "x86_64")]
mod register {
    use std::arch::x86_64::*;

    #[derive(Clone, Copy)]
    pub struct Pair(__m128d);

    // Sound: the instructions are part of every x86-64 processor.
    impl Pair {
        #[inline(always)]
        pub fn splat(x: f64) -> Pair {
            Pair(unsafe { _mm_set1_pd(x) })
        }
    }

    impl From<[f64; 2]> for Pair {
        #[inline(always)]
        fn from([first, second]: [f64; 2]) -> Pair {
            Pair(unsafe { _mm_set_pd(second, first) })
        }
    }

    impl From<Pair> for [f64; 2] {
        #[inline(always)]
        fn from(pair: Pair) -> [f64; 2] {
            unsafe { [_mm_cvtsd_f64(pair.0), _mm_cvtsd_f64(_mm_unpackhi_pd(pair.0, pair.0))] }
        }
    }

    impl super::Add for Pair {
        type Output = Pair;
        #[inline(always)]
        fn add(self, other: Pair) -> Pair {
            Pair(unsafe { _mm_add_pd(self.0, other.0) })
        }
    }

    impl super::Mul for Pair {
        type Output = Pair;
        #[inline(always)]
        fn mul(self, other: Pair) -> Pair {
            Pair(unsafe { _mm_mul_pd(self.0, other.0) })
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
mod plain {
    #[derive(Clone, Copy)]
    pub struct Pair([f64; 2]);

    impl Pair {
        pub fn splat(x: f64) -> Pair {
            Pair([x; 2])
        }
    }

    impl From<[f64; 2]> for Pair {
        fn from(both: [f64; 2]) -> Pair {
            Pair(both)
        }
    }

    impl From<Pair> for [f64; 2] {
        fn from(pair: Pair) -> [f64; 2] {
            pair.0
        }
    }

    impl super::Add for Pair {
        type Output = Pair;
        fn add(self, other: Pair) -> Pair {
            Pair([self.0[0] + other.0[0], self.0[1] + other.0[1]])
        }
    }

    impl super::Mul for Pair {
        type Output = Pair;
        fn mul(self, other: Pair) -> Pair {
            Pair([self.0[0] * other.0[0], self.0[1] * other.0[1]])
        }
    }
}
