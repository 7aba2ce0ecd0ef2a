//! Numbers with derivatives.

use std::ops::{Add, Mul, Neg, Sub};

use glam::DVec3;

/// What the formula of a distance is made of: plain numbers, or numbers that know their gradient.
pub trait Scalar: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    /// A number that does not depend on the point.
    fn constant(v: f64) -> Self;

    fn value(self) -> f64;

    /// Of 0: 0, with the gradient 0, for there is none.
    fn sqrt(self) -> Self;

    /// self / by; `by` is not 0.
    fn over(self, by: Self) -> Self;

    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }

    /// The smaller one; of equals the first.
    fn min(self, other: Self) -> Self {
        if other.value() < self.value() { other } else { self }
    }

    /// The larger one; of equals the first.
    fn max(self, other: Self) -> Self {
        if other.value() > self.value() { other } else { self }
    }

    fn plus(self, v: f64) -> Self {
        self + Self::constant(v)
    }

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

/// v + g·dp: a function's value at a point, and its gradient there.
///
/// Source: Clifford, *Preliminary Sketch of Biquaternions* (1873). Tests: gradients_are_finite_differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    pub value: f64,
    pub gradient: DVec3,
}

impl Dual {
    /// The coordinates of `p`, as functions of `p`.
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
