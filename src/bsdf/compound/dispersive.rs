//! Glass that bends light of each wavelength differently.

use glam::{DVec3, Vec2};

use super::{LayerStack, Scatter};
use crate::bsdf::{Bsdf, BsdfSample, DeltaLobes, Dispersion, HitContext, Material, TransportMode, textured};
use crate::effects::Effects;
use crate::math::{Local, SolidAnglePdf, Spectrum, Wavelength};
use crate::texture::Texture;

/// Glass, clear or frosted, whose index of refraction depends on the wavelength.
///
/// For light of a wavelength λ it is plain glass with the index n(λ). Light without a wavelength sees the index at the yellow line d.
///
/// Tests: tests/it/dispersion.rs, rows O12 and O13 of `pt torture`.
#[derive(Clone, Debug, PartialEq)]
pub struct Dispersive {
    /// The glass, a [`Material::Dielectric`].
    glass: Material,
    dispersion: Dispersion,
}

impl Dispersive {
    /// Glass whose index of refraction is that of the formula and not its own.
    pub fn new(glass: textured::Dielectric, dispersion: Dispersion) -> Dispersive {
        Dispersive { glass: glass.for_indices(dispersion.tabulated()).into(), dispersion }
    }

    /// The model of the glass at a hit.
    pub(super) fn model(&self, at: &HitContext) -> Bsdf<'_> {
        let index = self.dispersion.index(at.wavelength.unwrap_or(Wavelength::D_LINE)) as f32;
        match &self.glass {
            Material::Dielectric(glass) => glass.with_index(at, index),
            other => at.bsdf_of(other),
        }
    }

    pub(super) fn recentred(self, origin: DVec3) -> Dispersive {
        Dispersive { glass: self.glass.recentred(origin), ..self }
    }
}

impl Scatter for Dispersive {
    fn eval(&self, at: &HitContext, wo: Local, wi: Local, mode: TransportMode, above: Option<&LayerStack>) -> Spectrum {
        self.model(at).beneath(above, wo, wi, mode)
    }

    fn pdf(&self, at: &HitContext, wo: Local, wi: Local) -> SolidAnglePdf {
        self.model(at).pdf(wo, wi)
    }

    fn sample(&self, at: &HitContext, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        self.model(at).sample(wo, choice, u, mode)
    }

    fn delta_lobes(&self, at: &HitContext, wo: Local, mode: TransportMode) -> DeltaLobes {
        let mut lobes = DeltaLobes::default();
        self.model(at).delta_lobes(wo, mode).for_each(|lobe| lobes.add(lobe, Spectrum::ONE));
        lobes
    }

    fn has_smooth_lobe(&self, at: &HitContext) -> bool {
        self.model(at).has_smooth_lobe()
    }

    fn reciprocal(&self, at: &HitContext) -> bool {
        self.model(at).reciprocal()
    }

    fn parts(&self) -> Vec<&Material> {
        vec![&self.glass]
    }

    fn textures(&self) -> Vec<&Texture> {
        vec![]
    }

    fn own_effects(&self) -> Effects {
        Effects::DISPERSION
    }
}
