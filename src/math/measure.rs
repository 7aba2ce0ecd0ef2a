//! Probability densities with their measures as types: by solid angle, by area, or delta distributions.
//!
//! ```compile_fail
//! use pt::math::{AreaPdf, SolidAnglePdf, power_heuristic};
//! let area = AreaPdf::new(1.0);
//! let angle = SolidAnglePdf::new(1.0);
//! power_heuristic(area, angle); // different measures: does not compile
//! ```

use std::ops::Mul;

use glam::DVec3;

use super::lanes::Lanes;

/// Probability density by solid angle [sr⁻¹].
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct SolidAnglePdf(f32);

/// Probability density by area [m⁻²].
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct AreaPdf(f32);

/// Density of a sampled direction, or of a sampled point with `P` = [`AreaPdf`].
///
/// A delta distribution has no density. The enum forces every user to handle this case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density<P = SolidAnglePdf> {
    /// Density by the measure of `P`.
    Smooth(P),
    /// Delta distribution.
    Delta,
}

impl<P> Density<P> {
    /// The density; `None` for a delta distribution.
    pub fn smooth(self) -> Option<P> {
        match self {
            Density::Smooth(pdf) => Some(pdf),
            Density::Delta => None,
        }
    }
}

impl SolidAnglePdf {
    /// Density 0.
    pub const ZERO: SolidAnglePdf = SolidAnglePdf(0.0);

    /// A density [sr⁻¹].
    pub const fn new(per_steradian: f32) -> SolidAnglePdf {
        SolidAnglePdf(per_steradian)
    }

    /// Value of the density.
    pub const fn get(self) -> f32 {
        self.0
    }
}

impl AreaPdf {
    /// A density [m⁻²].
    pub const fn new(per_square_metre: f32) -> AreaPdf {
        AreaPdf(per_square_metre)
    }

    /// Value of the density.
    pub const fn get(self) -> f32 {
        self.0
    }

    /// Converts to a density by solid angle: p(ω) = p(A) · d² / |cos θ| = p(A) · d³ / |n · line|
    ///
    /// - `line`: vector of length d from the viewer to the point on the area
    /// - `n`: unit normal of the area
    ///
    /// `None` if the area is seen edge-on (cos θ = 0) and so subtends no solid angle.
    pub fn to_solid_angle(self, line: DVec3, n: DVec3) -> Option<SolidAnglePdf> {
        let d2 = line.length_squared();
        let pdf = (f64::from(self.0) * (d2 * d2.sqrt() / n.dot(line).abs())) as f32;
        pdf.is_finite().then_some(SolidAnglePdf(pdf))
    }
}

impl SolidAnglePdf {
    /// Converts to a density by area: p(A) = p(ω) · |cos θ| / d² = p(ω) · |n · line| / d³
    ///
    /// - `line`: vector of length d > 0 from the viewer to the point on the area
    /// - `n`: unit normal of the area
    pub fn to_area(self, line: DVec3, n: DVec3) -> AreaPdf {
        let d2 = line.length_squared();
        AreaPdf((f64::from(self.0) * (n.dot(line).abs() / (d2 * d2.sqrt()))) as f32)
    }
}

/// Multiplies the density by the probability of a choice.
impl Mul<f32> for SolidAnglePdf {
    type Output = SolidAnglePdf;
    fn mul(self, probability: f32) -> SolidAnglePdf {
        SolidAnglePdf(self.0 * probability)
    }
}

/// Power heuristic: weight w = p² / (p² + q²) of a sample with density p = `this` that another technique samples with density q = `other`.
///
/// The formula uses the ratio q/p, so that no density overflows. The weight is 0 if `this` is 0.
///
/// Source: Veach and Guibas, *Optimally Combining Sampling Techniques* (1995), β = 2.
pub fn power_heuristic(this: SolidAnglePdf, other: SolidAnglePdf) -> f32 {
    if this.0 <= 0.0 {
        return 0.0;
    }
    let ratio = other.0 / this.0;
    1.0 / (1.0 + ratio * ratio)
}

/// [`power_heuristic`] in each lane.
#[inline(always)]
pub fn power_heuristic_lanes<L: Lanes>(this: L::F32, other: L::F32) -> L::F32 {
    let ratio = other / this;
    L::select(L::le(this, L::f32(0.0)), L::f32(0.0), L::f32(1.0) / (L::f32(1.0) + ratio * ratio))
}

/// [`balance_heuristic`] in each lane.
#[inline(always)]
pub fn balance_heuristic_lanes<L: Lanes>(this: L::F32, other: L::F32) -> L::F32 {
    L::select(L::le(this, L::f32(0.0)), L::f32(0.0), L::f32(1.0) / (L::f32(1.0) + other / this))
}

/// Balance heuristic: weight w = p / (p + q) of a sample with density p = `this` that another technique samples with density q = `other`.
///
/// The weight is 0 if `this` is 0.
///
/// Source: Veach and Guibas, *Optimally Combining Sampling Techniques* (1995), β = 1.
pub fn balance_heuristic(this: SolidAnglePdf, other: SolidAnglePdf) -> f32 {
    if this.0 <= 0.0 { 0.0 } else { 1.0 / (1.0 + other.0 / this.0) }
}
