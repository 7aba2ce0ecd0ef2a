//! Densities that cannot be mixed up: per solid angle, per area, or of no measure at all.
//!
//! ```compile_fail
//! use pt::math::{AreaPdf, SolidAnglePdf, power_heuristic};
//! let area = AreaPdf::new(1.0);
//! let angle = SolidAnglePdf::new(1.0);
//! power_heuristic(area, angle); // two measures: does not compile
//! ```

use std::ops::Mul;

use glam::DVec3;

/// Probability per solid angle [sr⁻¹].
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct SolidAnglePdf(f32);

/// Probability per area [m⁻²].
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct AreaPdf(f32);

/// What a sampled direction was drawn from.
///
/// A delta lobe has no density: the match on this type cannot be forgotten.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    Smooth(SolidAnglePdf),
    Delta,
}

impl SolidAnglePdf {
    pub const ZERO: SolidAnglePdf = SolidAnglePdf(0.0);

    pub const fn new(per_steradian: f32) -> SolidAnglePdf {
        SolidAnglePdf(per_steradian)
    }

    pub const fn get(self) -> f32 {
        self.0
    }
}

impl AreaPdf {
    pub const fn new(per_square_metre: f32) -> AreaPdf {
        AreaPdf(per_square_metre)
    }

    pub const fn get(self) -> f32 {
        self.0
    }

    /// p(ω) = p(A) · d² / |cos θ| = p(A) · d³ / |n · line|
    ///
    /// - `line`: from where the area is seen to the point on it, of length d; `n`: the area's normal there, unit
    ///
    /// Edge-on (cos θ = 0) the area subtends no angle: `None`.
    pub fn to_solid_angle(self, line: DVec3, n: DVec3) -> Option<SolidAnglePdf> {
        let d2 = line.length_squared();
        let pdf = (f64::from(self.0) * (d2 * d2.sqrt() / n.dot(line).abs())) as f32;
        pdf.is_finite().then_some(SolidAnglePdf(pdf))
    }
}

/// A choice among alternatives multiplies the density.
impl Mul<f32> for SolidAnglePdf {
    type Output = SolidAnglePdf;
    fn mul(self, probability: f32) -> SolidAnglePdf {
        SolidAnglePdf(self.0 * probability)
    }
}

/// w = p² / (p² + q²): the weight of a sample drawn with density `this` that `other` could have drawn.
///
/// Written with the ratio q/p, so that no density overflows. Zero where `this` is zero.
///
/// Source: Veach and Guibas, *Optimally Combining Sampling Techniques* (1995), β = 2.
pub fn power_heuristic(this: SolidAnglePdf, other: SolidAnglePdf) -> f32 {
    if this.0 <= 0.0 {
        return 0.0;
    }
    let ratio = other.0 / this.0;
    1.0 / (1.0 + ratio * ratio)
}

/// The weight of a sample of density `this` where `other` could have found it too: p / (p + q)
///
/// 0 where `this` is 0.
///
/// Source: Veach and Guibas, *Optimally Combining Sampling Techniques* (1995), β = 1.
pub fn balance_heuristic(this: SolidAnglePdf, other: SolidAnglePdf) -> f32 {
    if this.0 <= 0.0 { 0.0 } else { 1.0 / (1.0 + other.0 / this.0) }
}
