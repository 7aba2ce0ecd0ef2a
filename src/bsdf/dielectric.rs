//! Clear glass, water, diamond.

use glam::{DVec3, Vec2};

use super::description::{Description, Prepare, given};
use super::microfacet::{Roughness, RoughnessKeys, Scale, TableRange, roughness_keys};
use super::{
    Bsdf, BsdfSample, HitContext, Lobe, Lookup, Material, Passage, RoughDielectric, ScatteringModel, TexturedModel, TransportMode,
    rough_dielectric,
};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Density, Local, Rgb, Spectrum, float, fresnel};
use crate::texture::{Number, Texture};

/// A smooth interface between two clear media.
///
/// f(wo, wi) = F δ(wi − reflect(wo)) / |cos θi|  +  (1 − F) s δ(wi − refract(wo)) / |cos θi|
///
/// with Fresnel's reflectance F(cos θo; η) and s = (ηo/ηi)² for radiance, which is spread over a
/// wider or narrower cone behind the interface, and s = 1 for importance.
///
/// - `eta`: index of refraction inside (below the surface) over outside (where the normal points)
/// - η = 1 is not there at all: the light goes straight on
/// - sampling: reflection with probability F, else refraction, so that weight = colour (· s)
///
/// Source: Walter et al., *Microfacet Models for Refraction* (2007), §2; Veach, thesis (1997), §5.2.
/// Tests: slab_is_parallel, magnification, glass_in_a_uniform_field, furnace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    pub eta: f32,
    /// Multiplies what passes or is reflected, at every interface: [0, 1]. Physical glass has 1.
    pub color: Spectrum,
}

impl ScatteringModel for Dielectric {
    #[inline(never)]
    fn sample(&self, wo: Local, choice: f32, _u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if wo.cos() == 0.0 || self.color.is_black() {
            return None;
        }
        if choice < fresnel::dielectric(wo.cos(), self.eta) { Some(self.reflect(wo, 1.0)) } else { self.transmit(wo, 1.0, mode) }
    }

    #[inline]
    fn delta_lobes(&self, wo: Local, mode: TransportMode) -> [Option<BsdfSample>; 2] {
        if wo.cos() == 0.0 || self.color.is_black() {
            return [None, None];
        }
        let reflectance = fresnel::dielectric(wo.cos(), self.eta);
        let reflected = (reflectance > 0.0).then(|| self.reflect(wo, reflectance));
        let transmitted = if reflectance < 1.0 { self.transmit(wo, 1.0 - reflectance, mode) } else { None };
        [reflected, transmitted]
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        false
    }
}

impl Dielectric {
    fn reflect(&self, wo: Local, share: f32) -> BsdfSample {
        BsdfSample::reflected(Local(fresnel::reflect(wo.0)), self.color * share)
    }

    /// `None` where it is totally reflected.
    fn transmit(&self, wo: Local, share: f32, mode: TransportMode) -> Option<BsdfSample> {
        let wi = Local(fresnel::refract(wo.0, self.eta)?);
        let eta = if wo.cos() > 0.0 { self.eta } else { 1.0 / self.eta };
        let spread = match mode {
            TransportMode::Radiance => 1.0 / (eta * eta),
            TransportMode::Importance => 1.0,
        };
        let weight = self.color * (share * spread);
        Some(BsdfSample { wi, weight, density: Density::Delta, lobe: Lobe::Transmission, eta })
    }
}

/// As a scene file says it.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::microfacet::{AlphaKey, Distribution};
    use crate::format::{Color, Fraction, Index, Positive, Textured, Varying};

    /// Glass, water, …: the surface of a body, normals outwards, that reflects and refracts, clear or frosted.
    ///
    /// Light that gets into a body and out of it without passing its surface, through an open side of its mesh or behind a single sheet, is wrong
    /// by the square of `eta`: `pt check` and every render name such shapes. A pane as one sheet is `thin_dielectric`; water in an opaque
    /// basin is closed by that.
    ///
    /// Of two faces in exactly one place (a glass box standing on a glass box) only the one listed first is met, and light
    /// goes on as if the other body had no surface there: wrong. Describe glued bodies as one mesh without the faces between
    /// them; two media that touch (water in a glass) by one face whose `eta` is the ratio of the two; bodies that only stand
    /// on each other with a gap of a hundred-thousandth of the scene's size.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct Dielectric {
        /// Index of refraction inside (the side the normal points away from) divided by that outside.
        ///
        /// A body whose index varies over its surface has no index inside: light that goes in by one index and out by another is
        /// brighter or darker by the square of their ratio.
        pub eta: Varying<Index>,
        /// Light is multiplied by this every time it meets the surface: what is reflected there as well as what passes.
        pub color: Textured,
        /// 0 is clear, 1 frosted. The width of highlights, alpha, is its square, so that equal steps look equal. Below 0.001 a
        /// surface is as good as smooth. (Of a colour, the mean.)
        pub roughness: Textured,
        /// From round highlights to highlights ten times as long as wide, along the first texture coordinate. (Of a colour, the mean.)
        pub anisotropy: Textured,
        /// In place of `roughness` and `anisotropy`, the width itself; `[along u, along v]` for each of them.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub alpha: Option<AlphaKey>,
        /// How the facets of a rough surface lean.
        pub distribution: Distribution,
        /// Follow light that meets more than one facet. Without, frosted glass is too dark, from inside above all. It costs tables
        /// (70 ms once for each glass with GGX, five times that with Beckmann, fifteen to thirty times where the roughness is a texture
        /// or anisotropic, a hundred times where the anisotropy is a texture or both; all that for each table of a varying `eta`, which are
        /// 5 from 1.3 to 1.6, 15 from 1 to 1.6) and a fifth of the time of a scattering.
        pub multiscatter: bool,
        /// What the glass itself takes of the light on its way through. Exact for a closed body with nothing in it: the way from
        /// one meeting with this surface to the next counts, so that light on its way to something inside of the body is not dimmed,
        /// and an open surface dims whatever reaches it from behind. It takes no textures: it belongs to the body, not to a place on
        /// its surface.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub absorption: Option<Absorption>,
    }

    /// The colour that is left of white light after a distance (Beer and Lambert): colour^(way / distance).
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Absorption {
        /// The share of light that is left.
        pub color: Color<Fraction>,
        /// After how long a way inside (m).
        pub distance: Positive,
    }

    impl Default for Dielectric {
        fn default() -> Dielectric {
            Dielectric {
                eta: Varying::Same(Index::known(1.5)),
                color: Textured::white(),
                roughness: Textured::black(),
                anisotropy: Textured::black(),
                alpha: None,
                distribution: Distribution::Ggx,
                multiscatter: true,
                absorption: None,
            }
        }
    }
}

impl Description for described::Dielectric {
    fn textures(&self) -> Vec<(String, &Textured)> {
        let own = [("eta/by", self.eta.by()), ("color", Some(&self.color))];
        own.into_iter().filter_map(given).chain(roughness_keys!(self).textures()).collect()
    }

    fn roughness_keys(&self) -> Option<RoughnessKeys<'_>> {
        Some(roughness_keys!(self))
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let (eta, color) = (builder.number("eta", &self.eta), builder.texture("color", &self.color));
        let surface = textured::Dielectric::new(eta, color, roughness_keys!(self).prepare(builder), self.multiscatter);
        match &self.absorption {
            None => surface.into(),
            Some(absorption) => {
                let left = Rgb::from_f64(absorption.color.linear());
                surface.absorbing(left.map(|left| -float::ln(left) / absorption.distance.get() as f32)).into()
            }
        }
    }
}

/// With its pictures read.
pub mod textured {
    use super::{Number, Rgb, Roughness, TableRange, Texture, rough_dielectric};

    /// The model with textures for parameters: smooth, rough, or one of them from point to point.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Dielectric {
        pub(super) eta: Number,
        pub(super) color: Texture,
        pub(super) finish: Option<Roughness>,
        /// The tables for light that meets more than one facet.
        pub(super) losses: Option<TableRange<rough_dielectric::Losses>>,
        /// σ of the body behind the surface: e^(−σ d) of the light passes the distance d inside (1/m).
        pub(super) absorption: Option<Rgb>,
    }
}

impl textured::Dielectric {
    /// Clear glass with the index of refraction `eta`, inside over outside.
    pub fn smooth(eta: impl Into<Number>, color: impl Into<Texture>) -> textured::Dielectric {
        textured::Dielectric::new(eta, color, None, false)
    }

    /// - `finish`: `None` for smooth glass
    /// - `multiscatter`: whether to follow light that meets more than one facet
    pub fn new(eta: impl Into<Number>, color: impl Into<Texture>, finish: Option<Roughness>, multiscatter: bool) -> textured::Dielectric {
        let eta = eta.into();
        let rough = finish.as_ref().filter(|_| multiscatter);
        let tables = |finish: &Roughness| {
            TableRange::new(eta.range(), Scale::Index, |eta| rough_dielectric::losses(eta, finish.domain(), finish.distribution))
        };
        textured::Dielectric { losses: rough.map(tables), color: color.into(), finish, absorption: None, eta }
    }

    /// The surface of a body that absorbs: e^(−σ d) of the light passes the distance d inside.
    ///
    /// - `absorption`: σ (1/m)
    pub fn absorbing(self, absorption: Rgb) -> textured::Dielectric {
        textured::Dielectric { absorption: Some(absorption), ..self }
    }

    /// The colour of the surface, darker by what the body took of the light on its way to it.
    fn color_at(&self, at: &HitContext) -> Spectrum {
        let color = Spectrum::from_albedo(self.color.at(&at.point));
        match self.absorption.filter(|_| at.inside > 0.0) {
            None => color,
            Some(absorption) => color * Spectrum::from_coefficients(absorption).map(|sigma| float::exp(-sigma * at.inside)),
        }
    }
}

impl Lookup for textured::Dielectric {
    type Model = Bsdf<'static>;

    fn at(&self, at: &HitContext) -> Bsdf<'static> {
        let (eta, color) = (self.eta.at(&at.point), self.color_at(at));
        let facets = self.finish.as_ref().and_then(|finish| finish.at(&at.point));
        let Some(facets) = facets.filter(|facets| RoughDielectric::is_rough(eta, facets.alpha)) else {
            return Bsdf::Dielectric(Dielectric { eta, color });
        };
        let losses = self.losses.as_ref().map(|losses| losses.at(eta));
        let more = losses.and_then(|losses| rough_dielectric::MultiScatter::new(losses, facets.alpha, eta));
        Bsdf::RoughDielectric(RoughDielectric { eta, color, facets, more })
    }

    fn textures(&self) -> Vec<&Texture> {
        self.finish.iter().flat_map(Roughness::textures).chain(self.eta.texture()).chain([&self.color]).collect()
    }

    fn recentred(self, origin: DVec3) -> textured::Dielectric {
        let finish = self.finish.map(|finish| finish.recentred(origin));
        textured::Dielectric { eta: self.eta.recentred(origin), color: self.color.recentred(origin), finish, ..self }
    }
}

impl TexturedModel for textured::Dielectric {
    fn effects(&self) -> Effects {
        let smooth = Effects::REFRACTION | Effects::SPECULAR_REFLECTION;
        self.finish.as_ref().map_or(smooth, |finish| finish.effects(smooth))
    }

    fn passage(&self) -> Passage {
        Passage::Body
    }

    fn is_anisotropic(&self) -> bool {
        self.finish.as_ref().is_some_and(Roughness::is_anisotropic)
    }

    /// Absorption depends on the way through the body.
    fn is_uniform(&self) -> bool {
        self.absorption.is_none() && self.textures().into_iter().all(Texture::is_constant)
    }
}
