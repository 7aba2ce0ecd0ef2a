//! A sheet with different materials on its two sides: a playing card, a book's cover, a wall seen from outside.

use glam::{DVec3, Vec2};

use super::{Compound, LayerStack, Scatter};
use crate::bsdf::description::{Description, MaterialRef, Prepare};
use crate::bsdf::{Bsdf, BsdfSample, DeltaLobes, HitContext, Lobe, Material, TransportMode};
use crate::format::Textured;
use crate::math::{Local, SolidAnglePdf, Spectrum};
use crate::texture::Texture;

/// An opaque sheet with one material in front, where the normal points, and another behind.
///
/// f(wo, wi) = f_front for both directions in front, f_back for both behind, and 0 for directions on opposite sides
///
/// - a side without a material is black
///
/// Tests: two_sided_materials_keep_their_sides_apart, compounds_are_proved.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoSided {
    /// The material on the side of the normal.
    pub front: Option<Material>,
    /// The material on the other side.
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
    fn eval(&self, at: &HitContext, wo: Local, wi: Local, mode: TransportMode, above: Option<&LayerStack>) -> Spectrum {
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

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::description::MaterialRef;

    /// An opaque sheet with different materials on its two sides. A side that is left out is black.
    #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct TwoSided {
        /// The material on the side of the normal.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub front: Option<MaterialRef>,
        /// The material on the other side.
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
                builder.fault(key, "transmits light, but both sides of a two-sided material must be opaque");
            }
            Some(material)
        };
        let (front, back) = (side("front", &self.front), side("back", &self.back));
        Compound::TwoSided(TwoSided { front, back }).into()
    }
}
