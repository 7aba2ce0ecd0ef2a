//! Vectors of a width for formulas that are written over [`Arithmetic`].

use super::Lanes;
use crate::math::simd::Arithmetic;

/// A number for each lane.
#[derive(Clone, Copy)]
pub struct Each<L: Lanes>(pub L::F32);

impl<L: Lanes> Arithmetic for Each<L> {
    #[inline(always)]
    fn splat(x: f32) -> Self {
        Each(L::f32(x))
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Each(self.0 + other.0)
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Each(self.0 - other.0)
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Each(self.0 * other.0)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Each(L::max(self.0, other.0))
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Each(L::min(self.0, other.0))
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        Each(self.0 / other.0)
    }

    #[inline(always)]
    fn root(self) -> Self {
        Each(L::sqrt(self.0))
    }

    #[inline(always)]
    fn choose_below(self, other: Self, yes: Self, no: Self) -> Self {
        Each(L::select(L::lt(self.0, other.0), yes.0, no.0))
    }

    #[inline(always)]
    fn size(self) -> Self {
        Each(L::abs(self.0))
    }
}
