//! A sheet whose two faces are of different materials: a playing card, a book's cover, a wall seen from outside.

use glam::{DVec3, Vec2};

use super::{Compound, Scatter, Veil};
use crate::bsdf::description::{Description, MaterialRef, Prepare};
use crate::bsdf::{Bsdf, BsdfSample, DeltaLobes, HitContext, Lobe, Material, TransportMode};
use crate::format::Textured;
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
pub struct TwoSided {
    pub front: Option<Material>,
    pub back: Option<Material>,
}

impl TwoSided {
    fn towards(&self, at: &HitContext, w: Local) -> Option<Bsdf<'_>> {
        let side = if w.cos() > 0.0 { &self.front } else { &self.back };
        side.as_ref().map(|material| at.bsdf_of(material))
    }

    fn each(&self) -> impl Iterator<Item = &Material> {
        self.front.iter().chain(&self.back)
    }

    pub(super) fn recentred(self, origin: DVec3) -> TwoSided {
        let [front, back] = [self.front, self.back].map(|side| side.map(|material| material.recentred(origin)));
        TwoSided { front, back }
    }
}

impl Scatter for TwoSided {
    fn eval(&self, at: &HitContext, wo: Local, wi: Local, mode: TransportMode, above: Option<&Veil>) -> Spectrum {
        let side = self.towards(at, wo).filter(|_| wo.same_side(wi));
        side.map_or(Spectrum::BLACK, |side| side.beneath(above, wo, wi, mode))
    }

    fn pdf(&self, at: &HitContext, wo: Local, wi: Local) -> SolidAnglePdf {
        let side = self.towards(at, wo).filter(|_| wo.same_side(wi));
        side.map_or(SolidAnglePdf::ZERO, |side| side.pdf(wo, wi))
    }

    fn sample(&self, at: &HitContext, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        self.towards(at, wo)?.sample(wo, choice, u, mode).filter(|sample| sample.lobe == Lobe::Reflection)
    }

    fn delta_lobes(&self, at: &HitContext, wo: Local, mode: TransportMode) -> DeltaLobes {
        let mut lobes = DeltaLobes::default();
        for lobe in self.towards(at, wo).into_iter().flat_map(|side| side.delta_lobes(wo, mode)) {
            if lobe.lobe == Lobe::Reflection {
                lobes.add(lobe, Spectrum::ONE);
            }
        }
        lobes
    }

    fn has_smooth_lobe(&self, at: &HitContext) -> bool {
        self.each().any(|side| at.bsdf_of(side).has_smooth_lobe())
    }

    fn reciprocal(&self, at: &HitContext) -> bool {
        self.each().all(|side| at.bsdf_of(side).reciprocal())
    }

    fn parts(&self) -> Vec<&Material> {
        self.each().collect()
    }

    fn textures(&self) -> Vec<&Texture> {
        vec![]
    }
}

/// As a scene file says it.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::description::MaterialRef;

    /// A sheet with two faces. Nothing goes through; a side that is left out is black.
    #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct TwoSided {
        /// Where the normal points.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub front: Option<MaterialRef>,
        /// On the other side.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub back: Option<MaterialRef>,
    }
}

impl Description for described::TwoSided {
    fn textures(&self) -> Vec<(String, &Textured)> {
        vec![]
    }

    fn parts(&self) -> Vec<(&'static str, &MaterialRef)> {
        self.front.iter().map(|side| ("front", side)).chain(self.back.iter().map(|side| ("back", side))).collect()
    }

    fn faults(&self) -> Vec<(&'static str, &'static str)> {
        let none = self.front.is_none() && self.back.is_none();
        if none { vec![("", "a two-sided material needs \"front\", or \"back\", or both")] } else { vec![] }
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let mut side = |key: &str, chosen: &Option<MaterialRef>| {
            let material = builder.part(key, chosen.as_ref()?);
            if material.transmits() {
                builder.fault(key, "lets light through, and a two-sided material does not: use it without");
            }
            Some(material)
        };
        let (front, back) = (side("front", &self.front), side("back", &self.back));
        Compound::TwoSided(TwoSided { front, back }).into()
    }
}
