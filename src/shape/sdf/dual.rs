//! Dual numbers for automatic differentiation.

use std::ops::{Add, Mul, Neg, Sub};

use glam::DVec3;

/// Number type of distance formulas: f64, or [`Dual`] numbers with a gradient.
pub trait Scalar: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    /// Constant, whose gradient is 0.
    fn constant(v: f64) -> Self;

    /// Value without the gradient.
    fn value(self) -> f64;

    /// Square root. At 0, where the gradient is not defined, the gradient is 0.
    fn sqrt(self) -> Self;

    /// Quotient self / by, where `by` is not 0.
    fn over(self, by: Self) -> Self;

    /// Absolute value.
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }

    /// Smaller of both numbers; `self` if they are equal.
    fn min(self, other: Self) -> Self {
        if other.value() < self.value() { other } else { self }
    }

    /// Larger of both numbers; `self` if they are equal.
    fn max(self, other: Self) -> Self {
        if other.value() > self.value() { other } else { self }
    }

    /// Sum with a constant.
    fn plus(self, v: f64) -> Self {
        self + Self::constant(v)
    }

    /// Product with a constant.
    fn times(self, v: f64) -> Self {
        self * Self::constant(v)
    }
}

impl Scalar for f64 {
    fn constant(v: f64) -> f64 {
        v
    }

    fn value(self) -> f64 {
        self
    }

    fn sqrt(self) -> f64 {
        self.sqrt()
    }

    fn over(self, by: f64) -> f64 {
        self / by
    }
}

/// Dual number v + g·dp: value and gradient of a function at a point.
///
/// Source: Clifford, *Preliminary Sketch of Biquaternions* (1873). Tests: gradients_are_finite_differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    /// Value v of the function.
    pub value: f64,
    /// Gradient g of the function.
    pub gradient: DVec3,
}

impl Dual {
    /// Coordinates of `p` as functions of `p`.
    pub fn coordinates(p: DVec3) -> [Dual; 3] {
        let along = |value, gradient| Dual { value, gradient };
        [along(p.x, DVec3::X), along(p.y, DVec3::Y), along(p.z, DVec3::Z)]
    }
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, other: Dual) -> Dual {
        Dual { value: self.value + other.value, gradient: self.gradient + other.gradient }
    }
}

impl Sub for Dual {
    type Output = Dual;
    fn sub(self, other: Dual) -> Dual {
        Dual { value: self.value - other.value, gradient: self.gradient - other.gradient }
    }
}

impl Mul for Dual {
    type Output = Dual;
    fn mul(self, other: Dual) -> Dual {
        Dual { value: self.value * other.value, gradient: self.gradient * other.value + other.gradient * self.value }
    }
}

impl Neg for Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        Dual { value: -self.value, gradient: -self.gradient }
    }
}

impl Scalar for Dual {
    fn constant(value: f64) -> Dual {
        Dual { value, gradient: DVec3::ZERO }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn sqrt(self) -> Dual {
        let value = self.value.sqrt();
        let gradient = if value > 0.0 { self.gradient * (0.5 / value) } else { DVec3::ZERO };
        Dual { value, gradient }
    }

    fn over(self, by: Dual) -> Dual {
        let value = self.value / by.value;
        Dual { value, gradient: (self.gradient - by.gradient * value) / by.value }
    }
}
