//! A clear smooth coat over a matte base: plastic, varnished wood, glazed china.

use std::f32::consts::FRAC_1_PI;

use glam::{DVec3, Vec2};

use super::description::{Description, Prepare, given};
use super::microfacet::{RoughnessKeys, roughness_keys};
use super::{Bsdf, BsdfSample, Coat, Coated, Compound, HitContext, Lookup, Material, ScatteringModel, TexturedModel, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Local, SolidAnglePdf, Spectrum, fresnel, warp};
use crate::texture::{Number, Texture};

/// A Lambertian base below a smooth dielectric surface.
///
/// f = F(μo) δ(wi − reflect(wo)) / μi  +  (1 − F(μo)) (1 − F(μi)) / η² · ρ / (π (1 − ρ F̄ᵢ))            [sr⁻¹]
///
/// Light passes through the surface, is scattered by the base, and leaves or is reflected back to the base. F̄ᵢ = 1 − (1 − F̄)/η² is the
/// reflectance of the surface for diffuse light from inside, F̄ that from outside. At ρ = 1 all light is reflected.
///
/// - on both sides of the surface; zero when the directions lie on opposite sides
/// - sampling: the surface or the base in proportion to the light that each returns; the base is cosine-weighted
///
/// Source: Wolff, *Diffuse-Reflectance Model for Smooth Dielectric Surfaces* (1994). Tests: own_models_are_proved,
/// coated_white_is_white, mean_reflectance_is_the_handbooks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    /// ρ, the albedo of the base: [0, 1].
    pub albedo: Spectrum,
    /// η, the index of refraction of the coat over that outside: at least 1.
    pub eta: f32,
    /// F̄ᵢ, the mean reflectance from inside: [`Plastic::internal`] of `eta`.
    pub internal: f32,
}

impl ScatteringModel for Plastic {
    #[inline]
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        if !wo.same_side(wi) {
            return Spectrum::BLACK;
        }
        let through = (1.0 - self.surface(wo)) * (1.0 - self.surface(wi)) / (self.eta * self.eta);
        self.base() * (through * FRAC_1_PI * wi.abs_cos())
    }

    #[inline]
    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let density = self.probabilities(wo)[1] * FRAC_1_PI * wi.abs_cos();
        SolidAnglePdf::new(if wo.same_side(wi) { density } else { 0.0 })
    }

    #[inline(never)]
    fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let [surface, _] = self.probabilities(wo);
        if choice < surface {
            return self.delta_lobe(wo).map(|lobe| BsdfSample { weight: lobe.weight / surface, ..lobe });
        }
        let wi = Local(warp::cosine_hemisphere(u) * 1f32.copysign(wo.cos()));
        let pdf = self.pdf(wo, wi);
        BsdfSample::of_lobe(wi, self.eval(wo, wi, mode) / pdf.get(), pdf)
    }

    #[inline]
    fn delta_lobes(&self, wo: Local, _mode: TransportMode) -> [Option<BsdfSample>; 2] {
        [self.delta_lobe(wo), None]
    }
}

impl Plastic {
    /// F̄ᵢ, the mean reflectance of the coat from inside, for the index `eta`.
    pub fn internal(eta: f32) -> f32 {
        1.0 - (1.0 - fresnel::dielectric_mean(eta)) / (eta * eta)
    }

    fn delta_lobe(&self, wo: Local) -> Option<BsdfSample> {
        let reflected = self.surface(wo);
        (reflected > 0.0).then(|| BsdfSample::reflected(Local(fresnel::reflect(wo.0)), Spectrum::gray(reflected)))
    }

    /// F, the reflectance of the coat from outside.
    pub(super) fn surface(&self, w: Local) -> f32 {
        fresnel::dielectric(w.abs_cos(), self.eta)
    }

    /// ρ / (1 − ρ F̄ᵢ), the albedo of the base with all internal reflections.
    fn base(&self) -> Spectrum {
        self.albedo.map(|rho| rho / (1.0 - rho * self.internal))
    }

    /// The probabilities of sampling surface and base, in proportion to the light that each returns. Each is computed by itself, because 1
    /// minus the other would round to 0 for a small share.
    fn probabilities(&self, wo: Local) -> [f32; 2] {
        let surface = self.surface(wo);
        let base = (1.0 - surface) * self.base().max() * (1.0 - self.internal);
        let sum = surface + base;
        if sum > 0.0 { [surface / sum, base / sum] } else { [1.0, 0.0] }
    }
}

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::microfacet::{AlphaKey, Distribution};
    use crate::format::{CoatIndex, Textured, Varying};

    /// A matte base under a clear coat that reflects, refracts, and reflects light back to the base.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct Plastic {
        /// The share of light that the base reflects.
        pub albedo: Textured,
        /// The index of refraction of the coat over that outside.
        pub eta: Varying<CoatIndex>,
        /// The roughness of the coat: 0 is smooth, 1 the roughest. The width of highlights, alpha, is its square, so that equal steps look
        /// equal. Values below 0.001 count as smooth. A colour counts by its mean.
        pub roughness: Textured,
        /// The anisotropy: 0 gives round highlights, 1 highlights ten times as long as wide, along the first texture coordinate. A colour
        /// counts by its mean.
        pub anisotropy: Textured,
        /// The width of highlights itself, in place of `roughness` and `anisotropy`; `[along u, along v]` for different widths.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub alpha: Option<AlphaKey>,
        /// The distribution of the facets' normals on a rough surface.
        pub distribution: Distribution,
    }

    impl Default for Plastic {
        fn default() -> Plastic {
            Plastic {
                albedo: Textured::gray(0.5),
                eta: Varying::Same(CoatIndex::known(1.5)),
                roughness: Textured::black(),
                anisotropy: Textured::black(),
                alpha: None,
                distribution: Distribution::Ggx,
            }
        }
    }
}

impl Description for described::Plastic {
    fn textures(&self) -> Vec<(String, &Textured)> {
        let own = [("eta/by", self.eta.by()), ("albedo", Some(&self.albedo))];
        own.into_iter().filter_map(given).chain(roughness_keys!(self).textures()).collect()
    }

    fn roughness_keys(&self) -> Option<RoughnessKeys<'_>> {
        Some(roughness_keys!(self))
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let (albedo, eta) = (builder.texture("albedo", &self.albedo), builder.number("eta", &self.eta));
        match roughness_keys!(self).prepare(builder) {
            None => textured::Plastic::new(albedo, eta).into(),
            roughness => Compound::Coated(Coated { base: Material::diffuse(albedo), coat: Coat::new(eta, 1.0, roughness) }).into(),
        }
    }
}

/// The model with its textures.
pub mod textured {
    use super::{Number, Texture};

    /// Smooth plastic with textures for parameters.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Plastic {
        pub(super) albedo: Texture,
        pub(super) eta: Number,
        /// [`Plastic::internal`](super::Plastic::internal), if `eta` is constant.
        pub(super) internal: Option<f32>,
    }
}

impl textured::Plastic {
    /// Smooth plastic.
    ///
    /// - `eta`: the index of refraction of the coat, at least 1
    pub fn new(albedo: impl Into<Texture>, eta: impl Into<Number>) -> textured::Plastic {
        let eta = eta.into();
        textured::Plastic { albedo: albedo.into(), internal: eta.constant().map(Plastic::internal), eta }
    }
}

impl Lookup for textured::Plastic {
    type Model = Bsdf<'static>;

    fn at(&self, at: &HitContext) -> Bsdf<'static> {
        let eta = self.eta.at(&at.texture);
        let internal = self.internal.unwrap_or_else(|| Plastic::internal(eta));
        Bsdf::Plastic(Plastic { albedo: Spectrum::from_albedo(self.albedo.at(&at.texture)), eta, internal })
    }

    fn textures(&self) -> Vec<&Texture> {
        self.eta.texture().into_iter().chain([&self.albedo]).collect()
    }

    fn recentred(self, origin: DVec3) -> textured::Plastic {
        textured::Plastic { albedo: self.albedo.recentred(origin), eta: self.eta.recentred(origin), ..self }
    }
}

impl TexturedModel for textured::Plastic {
    fn effects(&self) -> Effects {
        Effects::INTERREFLECTION | Effects::SPECULAR_REFLECTION
    }
}
