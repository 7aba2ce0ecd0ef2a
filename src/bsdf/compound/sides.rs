//! A sheet whose two faces are of different materials: a playing card, a book's cover, a wall seen from outside.

use glam::{DVec3, Vec2};

use super::{Place, Scatter, Veil};
use crate::bsdf::{Bsdf, BsdfSample, DeltaLobes, Lobe, Material, TransportMode};
use crate::math::{Local, SolidAnglePdf, Spectrum};
use crate::texture::Texture;

/// One material in front, where the normal points, and another behind.
///
/// f(wo, wi) = f_front for both directions in front, f_back for both behind, else 0: nothing goes through
///
/// - no material: black
///
/// Tests: sides_are_their_own, compounds_are_proved.
#[derive(Clone, Debug, PartialEq)]
pub struct Sides {
    pub front: Option<Material>,
    pub back: Option<Material>,
}

impl Sides {
    fn towards(&self, at: &Place, w: Local) -> Option<Bsdf<'_>> {
        let side = if w.cos() > 0.0 { &self.front } else { &self.back };
        side.as_ref().map(|material| at.met(material))
    }

    fn each(&self) -> impl Iterator<Item = &Material> {
        self.front.iter().chain(&self.back)
    }

    pub(super) fn recentred(self, origin: DVec3) -> Sides {
        let [front, back] = [self.front, self.back].map(|side| side.map(|material| material.recentred(origin)));
        Sides { front, back }
    }
}

impl Scatter for Sides {
    fn eval(&self, at: &Place, wo: Local, wi: Local, mode: TransportMode, above: Option<&Veil>) -> Spectrum {
        let side = self.towards(at, wo).filter(|_| wo.same_side(wi));
        side.map_or(Spectrum::BLACK, |side| side.beneath(above, wo, wi, mode))
    }

    fn pdf(&self, at: &Place, wo: Local, wi: Local) -> SolidAnglePdf {
        let side = self.towards(at, wo).filter(|_| wo.same_side(wi));
        side.map_or(SolidAnglePdf::ZERO, |side| side.pdf(wo, wi))
    }

    fn sample(&self, at: &Place, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        self.towards(at, wo)?.sample(wo, choice, u, mode).filter(|sample| sample.lobe == Lobe::Reflection)
    }

    fn delta_lobes(&self, at: &Place, wo: Local, mode: TransportMode) -> DeltaLobes {
        let mut lobes = DeltaLobes::default();
        for lobe in self.towards(at, wo).into_iter().flat_map(|side| side.delta_lobes(wo, mode)) {
            if lobe.lobe == Lobe::Reflection {
                lobes.add(lobe, Spectrum::ONE);
            }
        }
        lobes
    }

    fn has_smooth_lobe(&self, at: &Place) -> bool {
        self.each().any(|side| at.met(side).has_smooth_lobe())
    }

    fn reciprocal(&self, at: &Place) -> bool {
        self.each().all(|side| at.met(side).reciprocal())
    }

    fn parts(&self) -> Vec<&Material> {
        self.each().collect()
    }

    fn textures(&self) -> Vec<&Texture> {
        vec![]
    }
}
