//! Light from all around, infinitely far away.

use std::f64::consts::PI;

use glam::{Vec2, Vec3};

use super::{Offer, Target};
use crate::math::{Density, SolidAnglePdf, Spectrum, warp};

/// The same radiance from every direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// [W·m⁻²·sr⁻¹]
    pub radiance: Spectrum,
}

impl Environment {
    /// What comes from where `_direction` leads.
    pub fn radiance(&self, _direction: Vec3) -> Spectrum {
        self.radiance
    }

    pub(super) fn sample(&self, u: Vec2) -> Option<Offer> {
        let wi = warp::uniform_sphere(u);
        Some(Offer { wi, li: self.radiance, density: Density::Smooth(self.pdf(wi)), target: Target::Infinity })
    }

    /// 1 / 4π
    pub(super) fn pdf(&self, _wi: Vec3) -> SolidAnglePdf {
        SolidAnglePdf::new((0.25 / PI) as f32)
    }

    /// Φ = π R² · 4π L: what falls on a scene of radius R.
    pub(super) fn power(&self, radius: f64) -> f64 {
        4.0 * PI * PI * radius * radius * f64::from(self.radiance.average())
    }
}
