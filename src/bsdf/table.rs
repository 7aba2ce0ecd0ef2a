//! The table of materials. From one row for each material it makes the types for scene files, for built worlds, and for hits.

use super::description::Description;
use super::parameter::Lookup;
use super::*;

/// Makes three enums from the rows `Model = file`: `described::Material`, [`Material`] and [`Bsdf`].
///
/// - `plain`: models that [`parameters!`](super::parameter) defines; the name of the file is the `type` in scene files
/// - `prepared`: models that compute tables, or select one of several models at a point; their files implement all stages
/// - `chosen`: further models that `prepared` ones select, with the `type` that they belong to
/// - `compound`: materials made of others, and those around all others; they are only descriptions
macro_rules! materials {
    (
        plain { $($plain:ident = $plain_file:ident,)+ }
        prepared { $($own:ident = $own_file:ident,)+ }
        chosen { $($chosen:ident = $chosen_file:ident as $chosen_name:literal,)+ }
        compound { $($compound:ident($content:ident) = $($compound_file:ident)::+ as $compound_name:literal,)+ }
    ) => {
        /// Materials as scene files describe them.
        pub mod described {
            use schemars::JsonSchema;
            use serde::Serialize;

            use crate::reader::by_type;
            $(pub use crate::bsdf::$plain_file::described::*;)+
            $(pub use crate::bsdf::$own_file::described::*;)+
            // (One file describes two of these materials, so that its second import is unused.)
            $(#[allow(unused_imports)] pub use crate::bsdf::$($compound_file)::+::described::*;)+

            /// How a surface reflects and transmits light.
            #[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
            #[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
            #[serde(tag = "type", rename_all = "snake_case")]
            pub enum Material {
                $($plain($plain),)+
                $($own($own),)+
                $($compound($content),)+
            }

            by_type!(Material {
                $($plain($plain),)+
                $($own($own),)+
                $($compound($content),)+
            });
        }

        impl described::Material {
            /// The description of the model.
            pub fn description(&self) -> &dyn Description {
                match self {
                    $(described::Material::$plain(m) => m,)+
                    $(described::Material::$own(m) => m,)+
                    $(described::Material::$compound(m) => m,)+
                }
            }

            /// The `type` of the material in scene files.
            pub fn kind(&self) -> &'static str {
                match self {
                    $(described::Material::$plain(_) => stringify!($plain_file),)+
                    $(described::Material::$own(_) => stringify!($own_file),)+
                    $(described::Material::$compound(_) => $compound_name,)+
                }
            }
        }

        /// The models with their textures.
        pub mod textured {
            $(pub use crate::bsdf::$plain_file::textured::*;)+
            $(pub use crate::bsdf::$own_file::textured::*;)+
        }

        /// A material with its textures: one model, or a compound. [`Material::bsdf_at`] looks up the parameters at a hit.
        #[allow(missing_docs, reason = "a variant's meaning is that of its model")]
        #[derive(Clone, Debug, PartialEq)]
        pub enum Material {
            $($plain(textured::$plain),)+
            $($own(textured::$own),)+
            /// A material made of others.
            Compound(Box<Compound>),
        }

        $(impl From<textured::$plain> for Material {
            fn from(model: textured::$plain) -> Material {
                Material::$plain(model)
            }
        })+
        $(impl From<textured::$own> for Material {
            fn from(model: textured::$own) -> Material {
                Material::$own(model)
            }
        })+

        impl Material {
            /// The model at a hit.
            #[inline]
            pub fn bsdf_at(&self, at: &HitContext) -> Bsdf<'_> {
                match self {
                    $(Material::$plain(m) => Bsdf::$plain(m.at(at)),)+
                    $(Material::$own(m) => m.at(at),)+
                    Material::Compound(compound) => compound.bsdf_at(at),
                }
            }

            /// The model, if it is the same everywhere, so that it needs to be looked up only once.
            pub fn uniform(&self) -> Option<Bsdf<'static>> {
                match self {
                    $(Material::$plain(m) => m.is_uniform().then(|| Bsdf::$plain(m.at(&HitContext::ANYWHERE))),)+
                    $(Material::$own(m) => m.is_uniform().then(|| m.at(&HitContext::ANYWHERE)),)+
                    Material::Compound(_) => None,
                }
            }

            /// The material after the world has been moved by −`origin`.
            pub fn recentred(self, origin: glam::DVec3) -> Material {
                match self {
                    $(Material::$plain(m) => m.recentred(origin).into(),)+
                    $(Material::$own(m) => m.recentred(origin).into(),)+
                    Material::Compound(compound) => compound.recentred(origin).into(),
                }
            }

            /// Whether scattering depends on the directions of the surface's tangents.
            pub fn is_anisotropic(&self) -> bool {
                match self {
                    $(Material::$plain(m) => m.is_anisotropic(),)+
                    $(Material::$own(m) => m.is_anisotropic(),)+
                    Material::Compound(compound) => compound.is_anisotropic(),
                }
            }

            /// Whether light passes through the surface, and what is behind it.
            pub fn passage(&self) -> Passage {
                match self {
                    $(Material::$plain(m) => m.passage(),)+
                    $(Material::$own(m) => m.passage(),)+
                    Material::Compound(compound) => compound.passage(),
                }
            }

            /// σ of the body behind the surface (1/m), if the model of the surface has the body's absorption.
            pub fn absorption(&self) -> Option<Rgb> {
                match self {
                    $(Material::$plain(m) => m.absorption(),)+
                    $(Material::$own(m) => m.absorption(),)+
                    Material::Compound(compound) => compound.absorption(),
                }
            }

            /// The effects that simulating this material needs.
            pub fn effects(&self) -> Effects {
                match self {
                    $(Material::$plain(m) => m.effects() | m.texture_effects(),)+
                    $(Material::$own(m) => m.effects() | m.texture_effects(),)+
                    Material::Compound(compound) => compound.effects(),
                }
            }
        }

        /// A scattering model at a hit, with numbers for parameters.
        #[allow(missing_docs, reason = "a variant's meaning is that of its model")]
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Bsdf<'a> {
            $($plain($plain),)+
            $($own($own),)+
            $($chosen($chosen),)+
            Compound(CompoundAt<'a>),
        }

        // Long functions are not inlined from the models: here they would cost the short models stack space and saved registers.
        impl Bsdf<'_> {
            /// f(wo, wi)·|cos θi| [sr⁻¹]; 0 for delta lobes.
            #[inline]
            pub fn eval(&self, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
                match self {
                    $(Bsdf::$plain(b) => b.eval(wo, wi, mode),)+
                    $(Bsdf::$own(b) => b.eval(wo, wi, mode),)+
                    $(Bsdf::$chosen(b) => b.eval(wo, wi, mode),)+
                    Bsdf::Compound(b) => b.eval(wo, wi, mode),
                }
            }

            /// Probability density with which [`Bsdf::sample`] returns `wi` [sr⁻¹]; 0 for delta lobes.
            #[inline]
            pub fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
                match self {
                    $(Bsdf::$plain(b) => b.pdf(wo, wi),)+
                    $(Bsdf::$own(b) => b.pdf(wo, wi),)+
                    $(Bsdf::$chosen(b) => b.pdf(wo, wi),)+
                    Bsdf::Compound(b) => b.pdf(wo, wi),
                }
            }

            /// Samples a direction for `wo` with uniform numbers: `choice` selects a lobe, `u` a direction in it.
            ///
            /// Returns `None` where nothing is scattered.
            #[inline]
            pub fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
                match self {
                    $(Bsdf::$plain(b) => b.sample(wo, choice, u, mode),)+
                    $(Bsdf::$own(b) => b.sample(wo, choice, u, mode),)+
                    $(Bsdf::$chosen(b) => b.sample(wo, choice, u, mode),)+
                    Bsdf::Compound(b) => b.sample(wo, choice, u, mode),
                }
            }

            /// The delta lobes for `wo`: single directions with their share of the light as weight.
            #[inline]
            pub fn delta_lobes(&self, wo: Local, mode: TransportMode) -> impl Iterator<Item = BsdfSample> + use<> {
                let lobes = match self {
                    $(Bsdf::$plain(b) => b.delta_lobes(wo, mode),)+
                    $(Bsdf::$own(b) => b.delta_lobes(wo, mode),)+
                    $(Bsdf::$chosen(b) => b.delta_lobes(wo, mode),)+
                    Bsdf::Compound(b) => return b.delta_lobes(wo, mode).0.into_iter(),
                };
                DeltaLobes::from(lobes).0.into_iter()
            }

            /// Whether [`Bsdf::eval`] is not 0 everywhere.
            #[inline]
            pub fn has_smooth_lobe(&self) -> bool {
                match self {
                    $(Bsdf::$plain(b) => b.has_smooth_lobe(),)+
                    $(Bsdf::$own(b) => b.has_smooth_lobe(),)+
                    $(Bsdf::$chosen(b) => b.has_smooth_lobe(),)+
                    Bsdf::Compound(b) => b.has_smooth_lobe(),
                }
            }

            /// Whether f(wo, wi) = f(wi, wo), up to the factor η² for transmission. Some models are not reciprocal by definition.
            pub fn reciprocal(&self) -> bool {
                match self {
                    $(Bsdf::$plain(b) => b.reciprocal(),)+
                    $(Bsdf::$own(b) => b.reciprocal(),)+
                    $(Bsdf::$chosen(b) => b.reciprocal(),)+
                    Bsdf::Compound(b) => b.reciprocal(),
                }
            }

            /// The `type` of materials with this model in scene files.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Bsdf::$plain(_) => stringify!($plain_file),)+
                    $(Bsdf::$own(_) => stringify!($own_file),)+
                    $(Bsdf::$chosen(_) => $chosen_name,)+
                    Bsdf::Compound(b) => b.compound.name(),
                }
            }
        }
    };
}

materials! {
    plain {
        Diffuse = diffuse,
        Mirror = mirror,
        MatteCone = matte_cone,
        OrenNayar = oren_nayar,
        LommelSeeliger = lommel_seeliger,
        Phong = phong,
        BlinnPhong = blinn_phong,
        Metal = metal,
        DiffuseTransmission = diffuse_transmission,
        ThinDielectric = thin_dielectric,
    }
    prepared {
        Conductor = conductor,
        Dielectric = dielectric,
        Plastic = plastic,
        Interface = interface,
        ThinFilm = thin_film,
    }
    chosen {
        RoughConductor = rough_conductor as "conductor",
        RoughDielectric = rough_dielectric as "dielectric",
        FilmedDielectric = filmed_dielectric as "dielectric",
    }
    compound {
        Coated(Coated) = compound::coated as "coated",
        Mix(MaterialMix) = compound::mix as "mix",
        Sheen(Sheen) = compound::sheen as "sheen",
        TwoSided(TwoSided) = compound::two_sided as "two_sided",
        Principled(Principled) = principled as "principled",
        Bumped(Bumped) = surface_material as "bumped",
        Masked(Masked) = surface_material as "masked",
    }
}
