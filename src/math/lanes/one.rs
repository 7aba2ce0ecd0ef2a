//! One lane: plain numbers, on every machine.

use std::num::Wrapping;

use super::{Lanes, Subroutine, last_index};

/// Width of one lane: plain numbers.
#[derive(Clone, Copy, Debug)]
pub struct One;

type F32 = f32;
type F64 = f64;
type U32 = Wrapping<u32>;
type U64 = Wrapping<u64>;
type Mask = bool;

impl Lanes for One {
    const COUNT: usize = 1;
    type F32 = F32;
    type F64 = F64;
    type U32 = U32;
    type U64 = U64;
    type Mask = Mask;

    #[inline(always)]
    fn f32(x: f32) -> F32 {
        x
    }

    #[inline(always)]
    fn f64(x: f64) -> F64 {
        x
    }

    #[inline(always)]
    fn u32(x: u32) -> U32 {
        Wrapping(x)
    }

    #[inline(always)]
    fn u64(x: u64) -> U64 {
        Wrapping(x)
    }

    #[inline(always)]
    fn lanes() -> U32 {
        Wrapping(0)
    }

    #[inline(always)]
    fn load(from: &[f32]) -> F32 {
        from[0]
    }

    #[inline(always)]
    fn load_f64(from: &[f64]) -> F64 {
        from[0]
    }

    #[inline(always)]
    fn load_u32(from: &[u32]) -> U32 {
        Wrapping(from[0])
    }

    #[inline(always)]
    fn load_u64(from: &[u64]) -> U64 {
        Wrapping(from[0])
    }

    #[inline(always)]
    fn store(x: F32, to: &mut [f32]) {
        to[0] = x;
    }

    #[inline(always)]
    fn store_f64(x: F64, to: &mut [f64]) {
        to[0] = x;
    }

    #[inline(always)]
    fn store_u32(x: U32, to: &mut [u32]) {
        to[0] = x.0;
    }

    #[inline(always)]
    fn store_u64(x: U64, to: &mut [u64]) {
        to[0] = x.0;
    }

    #[inline(always)]
    fn pack(x: F32, mask: Mask, to: &mut [f32]) {
        if mask {
            to[0] = x;
        }
    }

    #[inline(always)]
    fn pack_u32(x: U32, mask: Mask, to: &mut [u32]) {
        if mask {
            to[0] = x.0;
        }
    }

    #[inline(always)]
    fn gather(table: &[f32], index: U32) -> F32 {
        table[index.0.min(last_index(table.len())) as usize]
    }

    #[inline(always)]
    fn gather_u32(table: &[u32], index: U32) -> U32 {
        Wrapping(table[index.0.min(last_index(table.len())) as usize])
    }

    #[inline(always)]
    fn gather_f64(table: &[f64], index: U32) -> F64 {
        table[index.0.min(last_index(table.len())) as usize]
    }

    #[inline(always)]
    fn sqrt(x: F32) -> F32 {
        x.sqrt()
    }

    #[inline(always)]
    fn abs(x: F32) -> F32 {
        x.abs()
    }

    #[inline(always)]
    fn min(a: F32, b: F32) -> F32 {
        if a < b { a } else { b }
    }

    #[inline(always)]
    fn max(a: F32, b: F32) -> F32 {
        if a > b { a } else { b }
    }

    #[inline(always)]
    fn copysign(x: F32, sign: F32) -> F32 {
        x.copysign(sign)
    }

    #[inline(always)]
    fn lt(a: F32, b: F32) -> Mask {
        a < b
    }

    #[inline(always)]
    fn le(a: F32, b: F32) -> Mask {
        a <= b
    }

    #[inline(always)]
    fn select(mask: Mask, yes: F32, no: F32) -> F32 {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn select_u32(mask: Mask, yes: U32, no: U32) -> U32 {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn eq_u32(a: U32, b: U32) -> Mask {
        a == b
    }

    #[inline(always)]
    fn widen(x: F32) -> F64 {
        x as f64
    }

    #[inline(always)]
    fn narrow(x: F64) -> F32 {
        x as f32
    }

    #[inline(always)]
    fn sqrt_f64(x: F64) -> F64 {
        x.sqrt()
    }

    #[inline(always)]
    fn abs_f64(x: F64) -> F64 {
        x.abs()
    }

    #[inline(always)]
    fn min_f64(a: F64, b: F64) -> F64 {
        if a < b { a } else { b }
    }

    #[inline(always)]
    fn max_f64(a: F64, b: F64) -> F64 {
        if a > b { a } else { b }
    }

    #[inline(always)]
    fn lt_f64(a: F64, b: F64) -> Mask {
        a < b
    }

    #[inline(always)]
    fn select_f64(mask: Mask, yes: F64, no: F64) -> F64 {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn mask(bits: u32) -> Mask {
        bits & 1 != 0
    }

    #[inline(always)]
    fn bits(mask: Mask) -> u32 {
        mask as u32
    }

    #[inline(always)]
    fn shl<const K: u32>(x: U32) -> U32 {
        const { assert!(K < 32) };
        Wrapping(x.0 << K)
    }

    #[inline(always)]
    fn shr<const K: u32>(x: U32) -> U32 {
        const { assert!(K < 32) };
        Wrapping(x.0 >> K)
    }

    #[inline(always)]
    fn shl_u64<const K: u32>(x: U64) -> U64 {
        const { assert!(K < 64) };
        Wrapping(x.0 << K)
    }

    #[inline(always)]
    fn shr_u64<const K: u32>(x: U64) -> U64 {
        const { assert!(K < 64) };
        Wrapping(x.0 >> K)
    }

    #[inline(always)]
    fn bits_f64(x: F64) -> U64 {
        Wrapping(x.to_bits())
    }

    #[inline(always)]
    fn from_bits_f64(x: U64) -> F64 {
        f64::from_bits(x.0)
    }

    #[inline(always)]
    fn rotate_32(x: U64) -> U64 {
        Wrapping(x.0.rotate_left(32))
    }

    #[inline(always)]
    fn wide(x: U32) -> U64 {
        Wrapping(x.0 as u64)
    }

    #[inline(always)]
    fn high(x: U64) -> U32 {
        Wrapping((x.0 >> 32) as u32)
    }

    #[inline(always)]
    fn low(x: U64) -> U32 {
        Wrapping(x.0 as u32)
    }

    #[inline(always)]
    fn reverse_bits(x: U32) -> U32 {
        Wrapping(x.0.reverse_bits())
    }

    #[inline(always)]
    fn to_f32(x: U32) -> F32 {
        x.0 as f32
    }

    #[inline(always)]
    fn to_u32(x: F32) -> U32 {
        Wrapping(x as u32)
    }

    #[inline(always)]
    fn call<S: Subroutine<Self>>(subroutine: S) -> S::Output {
        subroutine.run()
    }
}
