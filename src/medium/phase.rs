//! Phase functions: the directions into which a point of a medium scatters light.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::{Vec2, Vec3};

use crate::math::lanes::Lanes;
use crate::math::{Frame, Local, float};

/// Greatest |g| of a Henyey–Greenstein phase function. Nearer to 1 the peak is narrower than what 32-bit directions can tell apart.
pub const MOST_ASYMMETRY: f64 = 0.999;

/// Phase function p(ωi, ωo) [sr⁻¹] of the angle θ between the direction of light before and after it was scattered. Its integral over all
/// directions is 1, and directions are sampled with exactly this density.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// p = 1/(4π).
    Isotropic,
    /// Mostly forwards or backwards.
    HenyeyGreenstein(HenyeyGreenstein),
    /// p = 3/(16π) (1 + cos² θ), of particles much smaller than the wavelength.
    Rayleigh,
    /// 1 − `share` of the first and `share` of the second.
    Mix(Box<[Phase; 2]>, f32),
}

/// Henyey–Greenstein phase function.
///
/// p = (1 − g²) / (4π (1 + g² − 2 g cos θ)^(3/2))
///
/// - g: mean cosine of θ. 1 + g² − 2 g cos θ = (1 − |g|)² + 2 |g| (1 ∓ cos θ), which has no cancellation in the peak.
///
/// Source: Henyey and Greenstein, *Diffuse radiation in the galaxy* (1941). Tests: rows V7 of `pt torture`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    g: f32,
    /// 1 − g and 1 + g, which a difference of f32 would not give precisely.
    less: f32,
    more: f32,
}

impl HenyeyGreenstein {
    /// A phase function with the mean cosine `g`, which is limited to ±[`MOST_ASYMMETRY`].
    pub fn new(g: f64) -> HenyeyGreenstein {
        let g = g.clamp(-MOST_ASYMMETRY, MOST_ASYMMETRY);
        HenyeyGreenstein { g: g as f32, less: (1.0 - g) as f32, more: (1.0 + g) as f32 }
    }

    /// p for 1 − cos θ and 1 + cos θ.
    fn density(&self, one_minus_cos: f32, one_plus_cos: f32) -> f32 {
        let base = match self.g >= 0.0 {
            true => self.less * self.less + 2.0 * self.g * one_minus_cos,
            false => self.more * self.more - 2.0 * self.g * one_plus_cos,
        };
        self.less * self.more * (0.25 * FRAC_1_PI) / (base * base.sqrt())
    }

    /// [`HenyeyGreenstein::density`] in each lane.
    #[inline(always)]
    pub(super) fn density_lanes<L: Lanes>(&self, one_minus_cos: L::F32, one_plus_cos: L::F32) -> L::F32 {
        let base = match self.g >= 0.0 {
            true => L::f32(self.less * self.less) + L::f32(2.0 * self.g) * one_minus_cos,
            false => L::f32(self.more * self.more) - L::f32(2.0 * self.g) * one_plus_cos,
        };
        L::f32(self.less * self.more * (0.25 * FRAC_1_PI)) / (base * L::sqrt(base))
    }

    /// 1 − cos θ and 1 + cos θ of a sampled direction.
    ///
    /// 1 − cos θ = 2 (1 − g)² (1 − u)(1 + g u) / k²,  1 + cos θ = 2 (1 + g)² u (1 − g (1 − u)) / k²,  k = (1 − g)(1 − u) + (1 + g) u
    fn sample(&self, u: f32) -> (f32, f32) {
        let HenyeyGreenstein { g, less, more } = *self;
        let v = 1.0 - u;
        let k = less * v + more * u;
        let (a, b) = (less / k, more / k);
        (2.0 * a * a * v * (1.0 + g * u), 2.0 * b * b * u * (1.0 - g * v))
    }

    /// [`HenyeyGreenstein::sample`] in each lane.
    #[inline(always)]
    pub(super) fn sample_lanes<L: Lanes>(&self, u: L::F32) -> (L::F32, L::F32) {
        let (g, less, more) = (L::f32(self.g), L::f32(self.less), L::f32(self.more));
        let (one, two) = (L::f32(1.0), L::f32(2.0));
        let v = one - u;
        let k = less * v + more * u;
        let (a, b) = (less / k, more / k);
        (two * a * a * v * (one + g * u), two * b * b * u * (one - g * v))
    }
}

impl Phase {
    /// A phase function with the mean cosine `g`.
    pub fn henyey_greenstein(g: f64) -> Phase {
        if g == 0.0 { Phase::Isotropic } else { Phase::HenyeyGreenstein(HenyeyGreenstein::new(g)) }
    }

    /// p [sr⁻¹] for light that comes from the direction `wi` and is scattered in the direction `wo`, or the other way round.
    ///
    /// - `wo`, `wi`: unit directions away from the point
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        // The angle is that between −wi and wo: 1 − cos θ = ½ |wo + wi|².
        match self {
            Phase::Isotropic => 0.25 * FRAC_1_PI,
            Phase::HenyeyGreenstein(phase) => phase.density(0.5 * (wo + wi).length_squared(), 0.5 * (wo - wi).length_squared()),
            Phase::Rayleigh => rayleigh(wo.dot(wi)),
            Phase::Mix(parts, share) => (1.0 - share) * parts[0].eval(wo, wi) + share * parts[1].eval(wo, wi),
        }
    }

    /// A direction with the density [`Phase::eval`] for `wo`.
    ///
    /// - `choice`, `u`: uniform numbers that choose a part of a mixture, and the direction
    pub fn sample(&self, wo: Vec3, choice: f32, u: Vec2) -> Vec3 {
        let (one_minus_cos, one_plus_cos) = match self {
            Phase::Isotropic => (2.0 * (1.0 - u.x), 2.0 * u.x),
            Phase::HenyeyGreenstein(phase) => phase.sample(u.x),
            Phase::Rayleigh => {
                let cos = rayleigh_cosine(u.x);
                (1.0 - cos, 1.0 + cos)
            }
            Phase::Mix(parts, share) => {
                return if choice < *share {
                    parts[1].sample(wo, choice / share, u)
                } else {
                    parts[0].sample(wo, ((choice - share) / (1.0 - share)).min(float::ONE_MINUS_EPSILON), u)
                };
            }
        };
        let sin = (one_minus_cos * one_plus_cos).max(0.0).sqrt();
        let cos = if one_minus_cos < one_plus_cos { 1.0 - one_minus_cos } else { one_plus_cos - 1.0 };
        let (sin_phi, cos_phi) = float::sin_cos(2.0 * PI * u.y);
        Frame::around(-wo).to_world(Local(Vec3::new(sin * cos_phi, sin * sin_phi, cos))).normalize()
    }

    /// Name as in scene files.
    pub fn name(&self) -> &'static str {
        match self {
            Phase::Isotropic => "isotropic",
            Phase::HenyeyGreenstein(_) => "henyey_greenstein",
            Phase::Rayleigh => "rayleigh",
            Phase::Mix(..) => "mix",
        }
    }
}

fn rayleigh(cos: f32) -> f32 {
    3.0 / 16.0 * FRAC_1_PI * (1.0 + cos * cos)
}

/// Cosine with the density of Rayleigh scattering: the solution of cos³ θ + 3 cos θ = 8 u − 4.
///
/// Newton's method starts from a quarter of the right side, which is exact for ±1 and 0. The slope is at least 3, and three steps reach
/// the precision of f32.
fn rayleigh_cosine(u: f32) -> f32 {
    let right = 8.0 * u - 4.0;
    let step = |x: f32| x - (x * (x * x + 3.0) - right) / (3.0 * (x * x + 1.0));
    step(step(step(0.25 * right))).clamp(-1.0, 1.0)
}

/// [`rayleigh_cosine`] in each lane.
#[inline(always)]
pub(super) fn rayleigh_cosine_lanes<L: Lanes>(u: L::F32) -> L::F32 {
    let (one, three) = (L::f32(1.0), L::f32(3.0));
    let right = L::f32(8.0) * u - L::f32(4.0);
    let mut x = L::f32(0.25) * right;
    for _ in 0..3 {
        x = x - (x * (x * x + three) - right) / (three * (x * x + one));
    }
    L::min(L::max(x, -one), one)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rayleigh_cosines_solve_their_equation() {
        for i in 0..=1000 {
            let u = i as f32 / 1000.0;
            let x = f64::from(rayleigh_cosine(u));
            // Three roundings of numbers up to 4.
            assert!((x * x * x + 3.0 * x - (8.0 * f64::from(u) - 4.0)).abs() < 3.0 * 4.0 * f64::from(f32::EPSILON), "u = {u}");
        }
    }
}
