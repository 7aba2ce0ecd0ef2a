//! Vectors of 1, 8 or 16 numbers, for code that is written once and compiled for each width.
//!
//! Each lane does the operations of the plain number in the same order with the same rounding: no fused multiply-add, no approximate
//! quotient or root. Results therefore have the same bits in every width, except for the sign and the payload of a NaN.
//!
//! Code over lanes is a [`Kernel`]. [`Width::run`] and [`Width::run_wide`] compile it for each instruction set and run the one that the
//! machine has. The environment variable PT_LANES limits the width, and PT_SIMD does so too: `sse2` to one lane, `avx2` to eight.
//!
//! Tests: lanes_agree_with_plain_numbers, vectors_agree_with_glam, gather_is_bounded, short_slices_are_refused,
//! widths_are_in_order.

use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

// Not public: safe code that named them could run their instructions on a machine that lacks them.
#[cfg(target_arch = "x86_64")]
use self::eight::Eight;
#[cfg(target_arch = "x86_64")]
use self::sixteen::Sixteen;

/// Operators of registers: `Type: Trait method instruction, ...` for a type that is one register.
#[cfg(target_arch = "x86_64")]
macro_rules! operators_of_one {
    ($name:ident: $($operator:ident $method:ident $instruction:ident),+) => {
        $(
            // SAFETY: as of all operations of the file that uses the macro.
            impl $operator for $name {
                type Output = $name;

                #[inline(always)]
                fn $method(self, other: $name) -> $name {
                    $name(unsafe { $instruction(self.0, other.0) })
                }
            }
        )+
    };
}

/// Operators of registers: `Type: Trait method instruction, ...` for a type that is two registers.
#[cfg(target_arch = "x86_64")]
macro_rules! operators_of_two {
    ($name:ident: $($operator:ident $method:ident $instruction:ident),+) => {
        $(
            // SAFETY: as of all operations of the file that uses the macro.
            impl $operator for $name {
                type Output = $name;

                #[inline(always)]
                fn $method(self, other: $name) -> $name {
                    unsafe { $name($instruction(self.0, other.0), $instruction(self.1, other.1)) }
                }
            }
        )+
    };
}

mod each;
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "the instructions exist only where the processor has AVX2, which `Width::available` asks")]
mod eight;
mod one;
mod rays;
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "the instructions exist only where the processor has AVX-512, which `Width::available` asks")]
mod sixteen;
#[cfg(test)]
mod tests;
mod vector;

pub use each::Each;
pub use one::One;
pub use rays::Rays;
pub use vector::{Vector, VectorF64, get, tangents, to_array, to_array_u32};

/// Floating-point numbers, one for each lane.
pub trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self> {}

impl<T> Number for T where T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Div<Output = T> + Neg<Output = T> {}

/// Bits, the same count for each lane.
pub trait Bits: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> {}

impl<T> Bits for T where T: Copy + BitAnd<Output = T> + BitOr<Output = T> + BitXor<Output = T> {}

/// Vector width: the types of its vectors and the operations on them, lane by lane.
///
/// Whole numbers wrap around on overflow. Slices may be longer than the vector; only their first [`Lanes::COUNT`] numbers are used.
pub trait Lanes: Copy + Send + Sync + 'static {
    /// Number of lanes: 1, 8 or 16.
    const COUNT: usize;
    /// Vector of `f32`.
    type F32: Number;
    /// Vector of `f64`.
    type F64: Number;
    /// Vector of `u32`.
    type U32: Bits + Add<Output = Self::U32> + Sub<Output = Self::U32> + Mul<Output = Self::U32>;
    /// Vector of `u64`.
    type U64: Bits + Add<Output = Self::U64> + Mul<Output = Self::U64>;
    /// Vector of truth values.
    type Mask: Bits + Not<Output = Self::Mask>;

    /// `x` in all lanes.
    fn f32(x: f32) -> Self::F32;
    /// `x` in all lanes.
    fn f64(x: f64) -> Self::F64;
    /// `x` in all lanes.
    fn u32(x: u32) -> Self::U32;
    /// `x` in all lanes.
    fn u64(x: u64) -> Self::U64;
    /// The number of each lane: 0, 1, 2 and so on.
    fn lanes() -> Self::U32;

    /// First numbers of a slice. Panics if the slice is too short.
    fn load(from: &[f32]) -> Self::F32;
    /// First numbers of a slice. Panics if the slice is too short.
    fn load_f64(from: &[f64]) -> Self::F64;
    /// First numbers of a slice. Panics if the slice is too short.
    fn load_u32(from: &[u32]) -> Self::U32;
    /// First numbers of a slice. Panics if the slice is too short.
    fn load_u64(from: &[u64]) -> Self::U64;
    /// Writes the first numbers of a slice. Panics if the slice is too short.
    fn store(x: Self::F32, to: &mut [f32]);
    /// Writes the first numbers of a slice. Panics if the slice is too short.
    fn store_f64(x: Self::F64, to: &mut [f64]);
    /// Writes the first numbers of a slice. Panics if the slice is too short.
    fn store_u32(x: Self::U32, to: &mut [u32]);
    /// Writes the first numbers of a slice. Panics if the slice is too short.
    fn store_u64(x: Self::U64, to: &mut [u64]);
    /// The numbers of a table at the given indices. An index beyond the end reads the last number.
    ///
    /// Panics if the table is empty or has 2³¹ numbers or more.
    fn gather(table: &[f32], index: Self::U32) -> Self::F32;
    /// The numbers of a table at the given indices. An index beyond the end reads the last number.
    ///
    /// Panics if the table is empty or has 2³¹ numbers or more.
    fn gather_u32(table: &[u32], index: Self::U32) -> Self::U32;
    /// The numbers of a table at the given indices. An index beyond the end reads the last number.
    ///
    /// Panics if the table is empty or has 2³¹ numbers or more.
    fn gather_f64(table: &[f64], index: Self::U32) -> Self::F64;

    /// Writes the numbers of the lanes of a mask side by side to the start of a slice. What is written behind them, within the first
    /// [`Lanes::COUNT`] numbers, is not specified. Panics if the slice is shorter than that.
    fn pack(x: Self::F32, mask: Self::Mask, to: &mut [f32]);
    /// Writes the numbers of the lanes of a mask side by side, as [`Lanes::pack`] does.
    fn pack_u32(x: Self::U32, mask: Self::Mask, to: &mut [u32]);

    /// Square root, correctly rounded.
    fn sqrt(x: Self::F32) -> Self::F32;
    /// Absolute value.
    fn abs(x: Self::F32) -> Self::F32;
    /// `a` where a < b, `b` elsewhere: also if either is NaN, and if both are zeros.
    fn min(a: Self::F32, b: Self::F32) -> Self::F32;
    /// `a` where a > b, `b` elsewhere: also if either is NaN, and if both are zeros.
    fn max(a: Self::F32, b: Self::F32) -> Self::F32;
    /// Magnitude of `x` with the sign bit of `sign`.
    fn copysign(x: Self::F32, sign: Self::F32) -> Self::F32;
    /// Whether a < b.
    fn lt(a: Self::F32, b: Self::F32) -> Self::Mask;
    /// Whether a ≤ b.
    fn le(a: Self::F32, b: Self::F32) -> Self::Mask;
    /// `yes` where the mask is true, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self::F32, no: Self::F32) -> Self::F32;
    /// `yes` where the mask is true, `no` elsewhere.
    fn select_u32(mask: Self::Mask, yes: Self::U32, no: Self::U32) -> Self::U32;
    /// Whether a = b.
    fn eq_u32(a: Self::U32, b: Self::U32) -> Self::Mask;

    /// Converts to double precision, exactly.
    fn widen(x: Self::F32) -> Self::F64;
    /// The nearest numbers in single precision; ties go to the even one.
    fn narrow(x: Self::F64) -> Self::F32;
    /// Square root, correctly rounded.
    fn sqrt_f64(x: Self::F64) -> Self::F64;
    /// Absolute value.
    fn abs_f64(x: Self::F64) -> Self::F64;
    /// `a` where a < b, `b` elsewhere: also if either is NaN, and if both are zeros.
    fn min_f64(a: Self::F64, b: Self::F64) -> Self::F64;
    /// `a` where a > b, `b` elsewhere: also if either is NaN, and if both are zeros.
    fn max_f64(a: Self::F64, b: Self::F64) -> Self::F64;
    /// Whether a < b.
    fn lt_f64(a: Self::F64, b: Self::F64) -> Self::Mask;
    /// `yes` where the mask is true, `no` elsewhere.
    fn select_f64(mask: Self::Mask, yes: Self::F64, no: Self::F64) -> Self::F64;

    /// Mask whose lane k is bit k. The bits beyond the last lane have no effect.
    fn mask(bits: u32) -> Self::Mask;
    /// Number whose bit k is lane k of the mask. The bits beyond the last lane are 0.
    fn bits(mask: Self::Mask) -> u32;
    /// Whether the mask is true in any lane.
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        Self::bits(mask) != 0
    }

    /// Shift to the left by K < 32 bits.
    fn shl<const K: u32>(x: Self::U32) -> Self::U32;
    /// Shift to the right by K < 32 bits; zeros come in.
    fn shr<const K: u32>(x: Self::U32) -> Self::U32;
    /// Shift to the left by K < 64 bits.
    fn shl_u64<const K: u32>(x: Self::U64) -> Self::U64;
    /// Shift to the right by K < 64 bits; zeros come in.
    fn shr_u64<const K: u32>(x: Self::U64) -> Self::U64;
    /// Bits of floating-point numbers.
    fn bits_f64(x: Self::F64) -> Self::U64;
    /// Floating-point numbers with the given bits.
    fn from_bits_f64(x: Self::U64) -> Self::F64;
    /// The upper and the lower 32 bits exchanged.
    fn rotate_32(x: Self::U64) -> Self::U64;
    /// Converts to 64 bits; the upper 32 are 0.
    fn wide(x: Self::U32) -> Self::U64;
    /// Upper 32 bits.
    fn high(x: Self::U64) -> Self::U32;
    /// Lower 32 bits.
    fn low(x: Self::U64) -> Self::U32;
    /// Bits in reverse order.
    fn reverse_bits(x: Self::U32) -> Self::U32;
    /// The nearest floating-point numbers to numbers below 2³¹; the result for a larger number is not specified.
    fn to_f32(x: Self::U32) -> Self::F32;
    /// Numbers from 0 to below 2³¹, rounded down; the result for another number is not specified.
    fn to_u32(x: Self::F32) -> Self::U32;

    /// Runs large code as a function of its own, compiled for the instruction set of this width, so that the kernels that use it share one
    /// copy. With one lane it is an ordinary call, which may be inlined.
    fn call<S: Subroutine<Self>>(subroutine: S) -> S::Output;
}

/// Large code over lanes that several kernels use, with its arguments: [`Lanes::call`] runs it.
pub trait Subroutine<L: Lanes> {
    /// Its result.
    type Output;

    /// Runs the code. It must be `#[inline(always)]`, as [`Kernel::run`].
    fn run(self) -> Self::Output;
}

/// Greatest number of lanes.
pub const MAX_COUNT: usize = 16;

/// Lanes of a bit mask, from the lowest.
#[inline(always)]
pub fn each_lane(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lowest = (mask != 0).then(|| mask.trailing_zeros() as usize);
        mask &= mask.wrapping_sub(1);
        lowest
    })
}

/// Index of the last number of a table, for bounding the indices of a gather.
#[inline(always)]
fn last_index(count: usize) -> u32 {
    assert!(count > 0, "gather from an empty table");
    assert!(count <= i32::MAX as usize, "gather from a table that is too long");
    (count - 1) as u32
}

/// Code that is compiled once for each width.
pub trait Kernel {
    /// Its result.
    type Output;

    /// Runs the code.
    ///
    /// It must be `#[inline(always)]`, and so must all functions over lanes that it calls: only what is inlined into [`Width::run`],
    /// [`Width::run_wide`] or code that [`Lanes::call`] runs is compiled for the instruction set of the width. The rest, which may include
    /// closures, gives the same result but slowly.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Vector width that this machine has.
///
/// Only [`Width::detect`] and [`Width::available`] make one, so that none names instructions that the machine lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Width(Kind);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    One,
    #[cfg(target_arch = "x86_64")]
    Eight,
    #[cfg(target_arch = "x86_64")]
    Sixteen,
}

impl Width {
    /// The largest width of this machine, unless the environment variables PT_LANES or PT_SIMD select a smaller one.
    ///
    /// It asks the environment at each call; callers keep the answer.
    pub fn detect() -> Width {
        let lanes = std::env::var("PT_LANES").ok().and_then(|lanes| lanes.parse().ok()).unwrap_or(usize::MAX);
        let limit = match std::env::var_os("PT_SIMD") {
            Some(set) if set == "sse2" => 1,
            Some(set) if set == "avx2" => lanes.min(8),
            _ => lanes,
        };
        Width::available().into_iter().rfind(|width| width.count() <= limit).unwrap_or(Width(Kind::One))
    }

    /// All widths of this machine, the smallest first. PT_SIMD has no effect on them.
    pub fn available() -> Vec<Width> {
        #[allow(unused_mut, reason = "other processors have only one width")]
        let mut widths = vec![Width(Kind::One)];
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            if has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt") {
                widths.push(Width(Kind::Eight));
                // The compiler takes avx512f to include fma and f16c.
                if has!("avx512f")
                    && has!("avx512dq")
                    && has!("avx512bw")
                    && has!("avx512vl")
                    && has!("avx512cd")
                    && has!("gfni")
                    && has!("fma")
                    && has!("f16c")
                {
                    widths.push(Width(Kind::Sixteen));
                }
            }
        }
        widths
    }

    /// Number of lanes.
    pub fn count(self) -> usize {
        match self.0 {
            Kind::One => One::COUNT,
            #[cfg(target_arch = "x86_64")]
            Kind::Eight => Eight::COUNT,
            #[cfg(target_arch = "x86_64")]
            Kind::Sixteen => Sixteen::COUNT,
        }
    }

    /// Runs a kernel in this width.
    #[cfg_attr(target_arch = "x86_64", allow(unsafe_code, reason = "the instructions exist only where `Width::available` found them"))]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Kind::One => kernel.run::<One>(),
            // SAFETY: only `available` makes this value, after it found all features that `run_eight` enables.
            #[cfg(target_arch = "x86_64")]
            Kind::Eight => unsafe { run_eight(kernel) },
            // SAFETY: only `available` makes this value, after it found all features that `run_sixteen` enables.
            #[cfg(target_arch = "x86_64")]
            Kind::Sixteen => unsafe { run_sixteen(kernel) },
        }
    }

    /// Runs a kernel in this width; `None` if that is one lane, for which the kernel is not compiled. It suits kernels beside which there is
    /// code for single numbers.
    #[cfg_attr(target_arch = "x86_64", allow(unsafe_code, reason = "the instructions exist only where `Width::available` found them"))]
    #[cfg_attr(not(target_arch = "x86_64"), allow(unused_variables, reason = "other processors have only one width"))]
    pub fn run_wide<K: Kernel>(self, kernel: K) -> Option<K::Output> {
        match self.0 {
            Kind::One => None,
            // SAFETY: as in `run`.
            #[cfg(target_arch = "x86_64")]
            Kind::Eight => Some(unsafe { run_eight(kernel) }),
            // SAFETY: as in `run`.
            #[cfg(target_arch = "x86_64")]
            Kind::Sixteen => Some(unsafe { run_sixteen(kernel) }),
        }
    }
}

/// The kernel, compiled for AVX2.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_eight<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Eight>()
}

/// The subroutine, compiled for AVX2.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn call_eight<S: Subroutine<Eight>>(subroutine: S) -> S::Output {
    subroutine.run()
}

/// The kernel, compiled for AVX-512.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl,avx512cd,gfni,avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_sixteen<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Sixteen>()
}

/// The subroutine, compiled for AVX-512.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
#[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl,avx512cd,gfni,avx2,bmi1,bmi2,lzcnt,popcnt")]
fn call_sixteen<S: Subroutine<Sixteen>>(subroutine: S) -> S::Output {
    subroutine.run()
}
