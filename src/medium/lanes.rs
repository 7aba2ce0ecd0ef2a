//! Media for paths that are followed side by side.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;

use super::{Media, Medium, Phase};
use crate::math::float;
use crate::math::lanes::{Lanes, Vector, tangents};

impl Media {
    /// The medium that fills all space, if it has code for lanes: it is the same everywhere, its extinction is the same for all wavelengths,
    /// and its phase function is no mixture.
    pub fn uniform(&self) -> Option<&Medium> {
        let is_simple = |medium: &&Medium| medium.is_gray && medium.density.is_none() && medium.phase.has_lanes();
        self.around().filter(is_simple).filter(|_| self.bodies().next().is_none())
    }
}

/// Light along rays through a medium of [`Media::uniform`].
impl Medium {
    /// [`Medium::depth`] in each lane, equal for all wavelengths.
    #[inline(always)]
    pub fn depth_lanes<L: Lanes>(&self, length: L::F32) -> L::F32 {
        match self.extinction.coefficients()[0] {
            extinction if extinction > 0.0 => L::f32(extinction) * length,
            _ => L::f32(0.0),
        }
    }

    /// [`Medium::emitted`] in each lane.
    #[inline(always)]
    pub fn emitted_lanes<L: Lanes>(&self, length: L::F32) -> Vector<L> {
        let lost = lost_lanes::<L>(self.depth_lanes::<L>(length));
        Vector::splat(Vec3::from(self.emission().coefficients())).scaled(lost)
    }
}

/// [`transmittance`](super::transmittance) in each lane.
#[inline(always)]
pub fn transmittance_lanes<L: Lanes>(depth: L::F32) -> L::F32 {
    float::exp_lanes::<L>(-depth)
}

/// 1 − e^(−τ), the share of the light that does not pass an optical depth, in each lane.
#[inline(always)]
pub fn lost_lanes<L: Lanes>(depth: L::F32) -> L::F32 {
    L::narrow(-float::exp_m1_f64_lanes::<L>(-L::widen(depth)))
}

impl Phase {
    /// Whether the phase function has code for lanes.
    fn has_lanes(&self) -> bool {
        !matches!(self, Phase::Mix(..))
    }

    /// [`Phase::eval`] in each lane.
    #[inline(always)]
    pub fn eval_lanes<L: Lanes>(&self, wo: Vector<L>, wi: Vector<L>) -> L::F32 {
        match self {
            Phase::Isotropic => L::f32(0.25 * FRAC_1_PI),
            Phase::HenyeyGreenstein(phase) => {
                let half = L::f32(0.5);
                phase.density_lanes::<L>(half * (wo + wi).length_squared(), half * (wo - wi).length_squared())
            }
            Phase::Rayleigh => {
                let cos = wo.dot(wi);
                L::f32(3.0 / 16.0 * FRAC_1_PI) * (L::f32(1.0) + cos * cos)
            }
            Phase::Mix(..) => unreachable!("mixtures have no code for lanes"),
        }
    }

    /// [`Phase::sample`] in each lane.
    #[inline(always)]
    pub fn sample_lanes<L: Lanes>(&self, wo: Vector<L>, [u, v]: [L::F32; 2]) -> Vector<L> {
        let (zero, one, two) = (L::f32(0.0), L::f32(1.0), L::f32(2.0));
        let (one_minus_cos, one_plus_cos) = match self {
            Phase::Isotropic => (two * (one - u), two * u),
            Phase::HenyeyGreenstein(phase) => phase.sample_lanes::<L>(u),
            Phase::Rayleigh => {
                let cos = super::phase::rayleigh_cosine_lanes::<L>(u);
                (one - cos, one + cos)
            }
            Phase::Mix(..) => unreachable!("mixtures have no code for lanes"),
        };
        let sin = L::sqrt(L::max(one_minus_cos * one_plus_cos, zero));
        let is_forward = L::lt(one_minus_cos, one_plus_cos);
        let cos = L::select(is_forward, one - one_minus_cos, one_plus_cos - one);
        let (sin_phi, cos_phi) = float::sin_cos_lanes::<L>(L::f32(2.0 * PI) * v);
        let [x, y] = tangents(-wo);
        (x.scaled(sin * cos_phi) + y.scaled(sin * sin_phi) + (-wo).scaled(cos)).normalized()
    }
}
