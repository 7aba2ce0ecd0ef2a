//! A mix of two materials: rust on steel, dust on glass.

use glam::{DVec3, Vec2};

use super::{Compound, LayerStack, Scatter, choose};
use crate::bsdf::description::{Description, MaterialRef, Prepare, given};
use crate::bsdf::{BsdfSample, DeltaLobes, HitContext, Material, TransportMode};
use crate::format::{Textured, Varying};
use crate::math::{Local, SolidAnglePdf, Spectrum, fresnel};
use crate::texture::{Number, Texture};

/// A weighted sum of two materials.
///
/// f = a · f_a + b · f_b,    a + b ≤ 1
///
/// - by a share t, a number or a texture (a colour counts by its mean): a = 1 − t, b = t
/// - by Fresnel's F at the surface of a dielectric: a = 1 − max(F(θo), F(θi)), b = min(F(θo), F(θi)), so that the second
///   shows at grazing view. These weights are reciprocal and never return more light than arrives; F(θo) alone would be neither. For
///   mirror directions, where both angles are equal, nothing is lost
/// - sampling: the second with probability t or F(θo)
///
/// Tests: mixes_are_sums, compounds_are_proved.
#[derive(Clone, Debug, PartialEq)]
pub struct Mix {
    /// The first material.
    pub a: Material,
    /// The second material.
    pub b: Material,
    /// The share of the second material.
    pub share: Share,
}

/// The share of the second material in a mix.
#[derive(Clone, Debug, PartialEq)]
pub enum Share {
    /// A share t from 0 to 1.
    Texture(Texture),
    /// The Fresnel reflectance of a dielectric.
    Fresnel {
        /// The index of refraction inside over outside.
        eta: Number,
    },
}

impl Mix {
    /// The material that has the share 1 at a hit, if one has.
    pub(super) fn only(&self, at: &HitContext) -> Option<&Material> {
        match self.constant(at)? {
            0.0 => Some(&self.a),
            1.0 => Some(&self.b),
            _ => None,
        }
    }

    /// t at a hit, if it is the same for all directions.
    fn constant(&self, at: &HitContext) -> Option<f32> {
        match &self.share {
            Share::Texture(texture) => Some(texture.at(&at.texture).average().clamp(0.0, 1.0)),
            Share::Fresnel { .. } => None,
        }
    }

    /// The probability of sampling the second material.
    fn chance(&self, at: &HitContext, wo: Local) -> f32 {
        self.share_of(at, wo, wo)[1]
    }

    fn share_of(&self, at: &HitContext, wo: Local, wi: Local) -> [f32; 2] {
        match &self.share {
            Share::Fresnel { eta } => {
                let eta = eta.at(&at.texture);
                let [o, i] = [wo, wi].map(|w| fresnel::dielectric(w.abs_cos(), eta));
                [1.0 - o.max(i), o.min(i)]
            }
            Share::Texture(_) => {
                let t = self.constant(at).unwrap_or(0.0);
                [1.0 - t, t]
            }
        }
    }

    pub(super) fn recentred(self, origin: DVec3) -> Mix {
        let share = match self.share {
            Share::Texture(texture) => Share::Texture(texture.recentred(origin)),
            Share::Fresnel { eta } => Share::Fresnel { eta: eta.recentred(origin) },
        };
        Mix { a: self.a.recentred(origin), b: self.b.recentred(origin), share }
    }
}

impl Scatter for Mix {
    fn eval(&self, at: &HitContext, wo: Local, wi: Local, mode: TransportMode, above: Option<&LayerStack>) -> Spectrum {
        let [a, b] = self.share_of(at, wo, wi);
        at.bsdf_of(&self.a).beneath(above, wo, wi, mode) * a + at.bsdf_of(&self.b).beneath(above, wo, wi, mode) * b
    }

    fn pdf(&self, at: &HitContext, wo: Local, wi: Local) -> SolidAnglePdf {
        let chance = self.chance(at, wo);
        SolidAnglePdf::new(at.bsdf_of(&self.a).pdf(wo, wi).get() * (1.0 - chance) + at.bsdf_of(&self.b).pdf(wo, wi).get() * chance)
    }

    fn sample(&self, at: &HitContext, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let chance = self.chance(at, wo);
        let (second, choice) = choose(choice, chance);
        let (part, chance) = if second { (&self.b, chance) } else { (&self.a, 1.0 - chance) };
        let sample = at.bsdf_of(part).sample(wo, choice, u, mode)?;
        self.of_part(at, wo, sample, chance, |wi| Spectrum::gray(self.share_of(at, wo, wi)[usize::from(second)]), mode)
    }

    fn delta_lobes(&self, at: &HitContext, wo: Local, mode: TransportMode) -> DeltaLobes {
        let mut lobes = DeltaLobes::default();
        for (k, part) in [&self.a, &self.b].into_iter().enumerate() {
            for lobe in at.bsdf_of(part).delta_lobes(wo, mode) {
                lobes.add(lobe, Spectrum::gray(self.share_of(at, wo, lobe.wi)[k]));
            }
        }
        lobes
    }

    fn has_smooth_lobe(&self, at: &HitContext) -> bool {
        at.bsdf_of(&self.a).has_smooth_lobe() || at.bsdf_of(&self.b).has_smooth_lobe()
    }

    fn reciprocal(&self, at: &HitContext) -> bool {
        at.bsdf_of(&self.a).reciprocal() && at.bsdf_of(&self.b).reciprocal()
    }

    fn parts(&self) -> Vec<&Material> {
        vec![&self.a, &self.b]
    }

    fn textures(&self) -> Vec<&Texture> {
        match &self.share {
            Share::Texture(texture) => vec![texture],
            Share::Fresnel { eta } => eta.texture().into_iter().collect(),
        }
    }
}

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::description::MaterialRef;
    use crate::format::{Index, Textured, Varying};

    /// A weighted sum of two materials, as if both were there side by side in fine grains.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct MaterialMix {
        /// The first material.
        pub a: MaterialRef,
        /// The second material.
        pub b: MaterialRef,
        /// The share of `b`: 0 is all `a`, 1 all `b`. A colour counts by its mean.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub share: Option<Textured>,
        /// An index of refraction, in place of `share`: the share of `b` is the Fresnel reflectance, which is largest at grazing view. A
        /// little energy is lost unless `b` is a mirror.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub fresnel: Option<Varying<Index>>,
    }
}

impl Description for described::MaterialMix {
    fn textures(&self) -> Vec<(String, &Textured)> {
        let all = [("share", self.share.as_ref()), ("fresnel/by", self.fresnel.as_ref().and_then(Varying::by))];
        all.into_iter().filter_map(given).collect()
    }

    fn parts(&self) -> Vec<(&'static str, &MaterialRef)> {
        vec![("a", &self.a), ("b", &self.b)]
    }

    fn faults(&self) -> Vec<(&'static str, &'static str)> {
        if self.share.is_some() == self.fresnel.is_some() { vec![("", "a mix needs either \"share\" or \"fresnel\"")] } else { vec![] }
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let (a, b) = (builder.part("a", &self.a), builder.part("b", &self.b));
        match &self.fresnel {
            Some(eta) => Compound::Mix(Mix { a, b, share: Share::Fresnel { eta: builder.number("fresnel", eta) } }).into(),
            None => {
                let share = self.share.as_ref().map(|share| builder.texture("share", share));
                Material::mix(a, b, share.unwrap_or(0.0.into()))
            }
        }
    }
}
