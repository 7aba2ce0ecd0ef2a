//! Smooth glass, water or diamond, and the material `dielectric`.

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
/// with Fresnel's reflectance F(cos θo; η). The factor s is (ηo/ηi)² for radiance, because refraction changes the solid angle of the
/// light, and 1 for importance.
///
/// - `eta`: index of refraction inside (below the surface) over outside (where the normal points)
/// - for η = 1 light goes straight on, as without a surface
/// - sampling: reflection with probability F, otherwise refraction, so that weight = colour (· s)
///
/// Source: Walter et al., *Microfacet Models for Refraction* (2007), §2; Veach, thesis (1997), §5.2.
/// Tests: row O1 of `pt torture`, magnification, row O15 of `pt torture`, furnace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// η, the index of refraction inside over outside.
    pub eta: f32,
    /// The factor of all reflected and transmitted light: [0, 1]. Physical glass has 1.
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

    /// Returns the transmitted direction, or `None` under total reflection.
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

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::microfacet::{AlphaKey, Distribution};
    use crate::format::{Color, Fraction, Index, Positive, Textured, Varying};

    /// The surface of a body of glass, water, …, clear or frosted, with its normals outwards. It reflects and refracts.
    ///
    /// The body must be closed. Light that enters or leaves it without crossing its surface, through an open side of the mesh or
    /// behind a single sheet, is wrong by the square of `eta`; `pt check` and every render name such shapes. Use `thin_dielectric` for a
    /// pane that is one sheet. Water in an opaque basin counts as closed.
    ///
    /// Where two faces coincide (a glass box on a glass box), rays hit only the one that is listed first, and the other body seems to
    /// have no surface there, which is wrong. Describe glued bodies as one mesh without the faces between them. Describe two touching
    /// media (water in a glass) by one face with the ratio of the two indices as `eta`. Leave a gap of a hundred-thousandth of the
    /// scene's size between bodies that only stand on each other.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct Dielectric {
        /// The index of refraction inside (the side the normal points away from) divided by that outside.
        ///
        /// If the index varies over the surface, light that enters with one index and leaves with another is brighter or darker by the
        /// square of their ratio.
        pub eta: Varying<Index>,
        /// A factor of all light that the surface reflects or transmits, at every hit.
        pub color: Textured,
        /// The roughness: 0 is clear, 1 frosted. The width of highlights, alpha, is its square, so that equal steps look equal. Values
        /// below 0.001 count as smooth. A colour counts by its mean.
        pub roughness: Textured,
        /// The anisotropy: 0 gives round highlights, 1 highlights ten times as long as wide, along the first texture coordinate. A colour
        /// counts by its mean.
        pub anisotropy: Textured,
        /// The width of highlights itself, in place of `roughness` and `anisotropy`; `[along u, along v]` for different widths.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub alpha: Option<AlphaKey>,
        /// The distribution of the facets' normals on a rough surface.
        pub distribution: Distribution,
        /// Whether light that hits more than one facet is included. Without it frosted glass is too dark, mostly from inside. The cost is
        /// tables for each glass and a fifth of the time of a scattering event. A table takes 70 ms once with GGX, five times that with
        /// Beckmann, fifteen to thirty times that where the roughness is a texture or anisotropic, and a hundred times that where the
        /// anisotropy is a texture or both hold. A varying `eta` needs several tables: 5 from 1.3 to 1.6, 15 from 1 to 1.6.
        pub multiscatter: bool,
        /// The absorption of light inside the body. It is exact for a closed body with nothing in it: the distance between consecutive
        /// hits of this surface counts. Light on its way to an object inside the body is therefore not attenuated, and an open surface
        /// attenuates all light that reaches it from behind. It takes no textures, because it belongs to the body and not to its surface.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub absorption: Option<Absorption>,
    }

    /// The absorption of a body by the Beer–Lambert law: the transmittance over a length is color^(length / distance).
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Absorption {
        /// The transmittance over `distance`: the share of light that is left.
        pub color: Color<Fraction>,
        /// The length inside the body over which `color` is left (m).
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

/// The model with its textures.
pub mod textured {
    use super::{Number, Rgb, Roughness, TableRange, Texture, rough_dielectric};

    /// Glass with textures for parameters: smooth, rough, or varying between the two.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Dielectric {
        pub(super) eta: Number,
        pub(super) color: Texture,
        pub(super) roughness: Option<Roughness>,
        /// The tables for light that hits more than one facet.
        pub(super) losses: Option<TableRange<rough_dielectric::Losses>>,
        /// σ, the absorption coefficient of the body behind the surface (1/m): the transmittance over the distance d is e^(−σ d).
        pub(super) absorption: Option<Rgb>,
    }
}

impl textured::Dielectric {
    /// Clear glass with the index of refraction `eta`, inside over outside.
    pub fn smooth(eta: impl Into<Number>, color: impl Into<Texture>) -> textured::Dielectric {
        textured::Dielectric::new(eta, color, None, false)
    }

    /// Glass, smooth or rough.
    ///
    /// - `roughness`: the roughness; `None` for smooth glass
    /// - `multiscatter`: whether to include light that hits more than one facet
    pub fn new(
        eta: impl Into<Number>,
        color: impl Into<Texture>,
        roughness: Option<Roughness>,
        multiscatter: bool,
    ) -> textured::Dielectric {
        let eta = eta.into();
        let rough = roughness.as_ref().filter(|_| multiscatter);
        let tables = |roughness: &Roughness| {
            TableRange::new(eta.range(), Scale::Index, |eta| rough_dielectric::losses(eta, roughness.domain(), roughness.distribution))
        };
        textured::Dielectric { losses: rough.map(tables), color: color.into(), roughness, absorption: None, eta }
    }

    /// Adds the absorption of the body: the transmittance over the distance d inside is e^(−σ d).
    ///
    /// - `absorption`: σ (1/m)
    pub fn absorbing(self, absorption: Rgb) -> textured::Dielectric {
        textured::Dielectric { absorption: Some(absorption), ..self }
    }

    /// The colour of the surface times the transmittance of the path segment inside the body.
    fn color_at(&self, at: &HitContext) -> Spectrum {
        let color = Spectrum::from_albedo(self.color.at(&at.texture));
        match self.absorption.filter(|_| at.inside > 0.0) {
            None => color,
            Some(absorption) => color * Spectrum::from_coefficients(absorption).map(|sigma| float::exp(-sigma * at.inside)),
        }
    }
}

impl Lookup for textured::Dielectric {
    type Model = Bsdf<'static>;

    fn at(&self, at: &HitContext) -> Bsdf<'static> {
        let (eta, color) = (self.eta.at(&at.texture), self.color_at(at));
        let facets = self.roughness.as_ref().and_then(|roughness| roughness.at(&at.texture));
        let Some(facets) = facets.filter(|facets| RoughDielectric::is_rough(eta, facets.alpha)) else {
            return Bsdf::Dielectric(Dielectric { eta, color });
        };
        let losses = self.losses.as_ref().map(|losses| losses.at(eta));
        let more = losses.and_then(|losses| rough_dielectric::MultiScatter::new(losses, facets.alpha, eta));
        Bsdf::RoughDielectric(RoughDielectric { eta, color, facets, more })
    }

    fn textures(&self) -> Vec<&Texture> {
        self.roughness.iter().flat_map(Roughness::textures).chain(self.eta.texture()).chain([&self.color]).collect()
    }

    fn recentred(self, origin: DVec3) -> textured::Dielectric {
        let roughness = self.roughness.map(|roughness| roughness.recentred(origin));
        textured::Dielectric { eta: self.eta.recentred(origin), color: self.color.recentred(origin), roughness, ..self }
    }
}

impl TexturedModel for textured::Dielectric {
    fn effects(&self) -> Effects {
        let smooth = Effects::REFRACTION | Effects::SPECULAR_REFLECTION;
        self.roughness.as_ref().map_or(smooth, |roughness| roughness.effects(smooth))
    }

    fn passage(&self) -> Passage {
        Passage::Body
    }

    fn is_anisotropic(&self) -> bool {
        self.roughness.as_ref().is_some_and(Roughness::is_anisotropic)
    }

    /// Whether the model is the same at every hit. With absorption it depends on the path inside the body.
    fn is_uniform(&self) -> bool {
        self.absorption.is_none() && self.textures().into_iter().all(Texture::is_constant)
    }
}
