//! What a surface is made of: a model whose parameters may vary from point to point.

use glam::DVec3;

use super::microfacet::{Albedo, Finish};
use super::{BlinnPhong, Bsdf, Conductor, Dielectric, Diffuse, DiffuseTransmission, MatteCone, Metal, Mirror, OrenNayar, Phong, Plastic};
use super::{RoughConductor, RoughDielectric, ThinDielectric, rough_conductor, rough_dielectric};
use crate::effects::Effects;
use crate::math::{Ray, Spectrum, float};
use crate::shape::SurfacePoint;
use crate::texture::Texture;

/// A model with textures for parameters; [`Material::at`] looks them up.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    Diffuse {
        albedo: Texture,
    },
    Mirror {
        color: Texture,
    },
    Conductor {
        eta: Spectrum,
        k: Spectrum,
    },
    Dielectric {
        eta: f32,
        color: Texture,
    },
    MatteCone {
        color: Texture,
        mattness: f32,
    },
    OrenNayar {
        albedo: Texture,
        roughness: f32,
    },
    Phong {
        color: Texture,
        exponent: f32,
    },
    BlinnPhong {
        color: Texture,
        exponent: f32,
    },
    Metal {
        color: Texture,
        roughness: f32,
    },
    Plastic {
        albedo: Texture,
        eta: f32,
        internal: f32,
    },
    /// Where reflectance and transmittance add up to more than 1, both are scaled down.
    DiffuseTransmission {
        reflectance: Texture,
        transmittance: Texture,
    },
    /// See [`Material::rough_conductor`].
    RoughConductor {
        eta: Spectrum,
        k: Spectrum,
        finish: Finish,
        more: Option<(&'static Albedo, Spectrum)>,
    },
    /// See [`Material::rough_glass`].
    RoughDielectric {
        eta: f32,
        color: Texture,
        finish: Finish,
        more: Option<&'static rough_dielectric::Losses>,
    },
    ThinDielectric {
        eta: f32,
        color: Texture,
    },
    /// The surface of a body that absorbs: e^(−σ d) of the light passes the distance d inside (σ in 1/m).
    Filled {
        surface: Box<Material>,
        absorption: Spectrum,
    },
}

impl Material {
    /// A matte surface that reflects the share `albedo`.
    pub fn diffuse(albedo: impl Into<Texture>) -> Material {
        Material::Diffuse { albedo: albedo.into() }
    }

    pub fn mirror(color: impl Into<Texture>) -> Material {
        Material::Mirror { color: color.into() }
    }

    /// Clear glass with the index of refraction `eta`, inside over outside.
    pub fn glass(eta: f32) -> Material {
        Material::Dielectric { eta, color: Spectrum::ONE.into() }
    }

    /// A matte ground under a clear coat with the index of refraction `eta`, at least 1.
    pub fn plastic(albedo: impl Into<Texture>, eta: f32) -> Material {
        Material::Plastic { albedo: albedo.into(), eta, internal: Plastic::internal(eta) }
    }

    /// Metal with facets; `multiscatter` follows light that is reflected more than once among them.
    pub fn rough_conductor(eta: Spectrum, k: Spectrum, finish: Finish, multiscatter: bool) -> Material {
        let tables = || (rough_conductor::losses(finish.domain(), finish.distribution), rough_conductor::mean_reflectance(eta, k));
        Material::RoughConductor { eta, k, more: multiscatter.then(tables), finish }
    }

    /// Glass with facets; `multiscatter` follows light that meets more than one of them.
    pub fn rough_glass(eta: f32, color: impl Into<Texture>, finish: Finish, multiscatter: bool) -> Material {
        let tables = || rough_dielectric::losses(eta, finish.domain(), finish.distribution);
        Material::RoughDielectric { eta, color: color.into(), more: multiscatter.then(tables), finish }
    }

    /// The model at the end of a ray of length `t`, with what the body behind the surface has taken of its light on the way.
    ///
    /// A ray that meets a surface from inside has been inside since it last met one: exact for a body without others in it.
    pub fn met(&self, point: &SurfacePoint, ray: &Ray, t: f32) -> Bsdf {
        match self {
            Material::Filled { surface, absorption } if ray.direction.dot(point.ng) > 0.0 => {
                surface.at(point).dimmed(absorption.map(|sigma| float::exp(-sigma * t)))
            }
            _ => self.at(point),
        }
    }

    /// Whether it matters where the axes of the surface point.
    pub fn is_anisotropic(&self) -> bool {
        match self {
            Material::RoughConductor { finish, .. } | Material::RoughDielectric { finish, .. } => finish.is_anisotropic(),
            Material::Filled { surface, .. } => surface.is_anisotropic(),
            _ => false,
        }
    }

    pub fn at(&self, point: &SurfacePoint) -> Bsdf {
        match self {
            Material::Diffuse { albedo } => Bsdf::Diffuse(Diffuse { albedo: albedo.at(point) }),
            Material::Mirror { color } => Bsdf::Mirror(Mirror { color: color.at(point) }),
            Material::Conductor { eta, k } => Bsdf::Conductor(Conductor { eta: *eta, k: *k }),
            Material::Dielectric { eta, color } => Bsdf::Dielectric(Dielectric { eta: *eta, color: color.at(point) }),
            Material::MatteCone { color, mattness } => Bsdf::MatteCone(MatteCone { color: color.at(point), mattness: *mattness }),
            Material::OrenNayar { albedo, roughness } => Bsdf::OrenNayar(OrenNayar { albedo: albedo.at(point), roughness: *roughness }),
            Material::Phong { color, exponent } => Bsdf::Phong(Phong { color: color.at(point), exponent: *exponent }),
            Material::BlinnPhong { color, exponent } => Bsdf::BlinnPhong(BlinnPhong { color: color.at(point), exponent: *exponent }),
            Material::Metal { color, roughness } => Bsdf::Metal(Metal { color: color.at(point), roughness: *roughness }),
            Material::Plastic { albedo, eta, internal } => {
                Bsdf::Plastic(Plastic { albedo: albedo.at(point), eta: *eta, internal: *internal })
            }
            Material::DiffuseTransmission { reflectance, transmittance } => {
                let (reflectance, transmittance) = (reflectance.at(point), transmittance.at(point));
                let scale = (reflectance + transmittance).max().max(1.0).recip();
                Bsdf::DiffuseTransmission(DiffuseTransmission { reflectance: reflectance * scale, transmittance: transmittance * scale })
            }
            Material::RoughConductor { eta, k, finish, more } => match finish.at(point) {
                None => Bsdf::Conductor(Conductor { eta: *eta, k: *k }),
                Some(facets) => {
                    let more = more.and_then(|(losses, mean)| rough_conductor::MoreReflections::new(losses, facets.alpha, mean));
                    Bsdf::RoughConductor(RoughConductor { eta: *eta, k: *k, facets, more })
                }
            },
            Material::RoughDielectric { eta, color, finish, more } => {
                let (eta, color) = (*eta, color.at(point));
                match finish.at(point).filter(|facets| RoughDielectric::is_rough(eta, facets.alpha)) {
                    None => Bsdf::Dielectric(Dielectric { eta, color }),
                    Some(facets) => {
                        let more = more.and_then(|losses| rough_dielectric::MoreEncounters::new(losses, facets.alpha, eta));
                        Bsdf::RoughDielectric(RoughDielectric { eta, color, facets, more })
                    }
                }
            }
            Material::ThinDielectric { eta, color } => Bsdf::ThinDielectric(ThinDielectric { eta: *eta, color: color.at(point) }),
            Material::Filled { surface, .. } => surface.at(point),
        }
    }

    /// The same material after the world has moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Material {
        match self {
            Material::Diffuse { albedo } => Material::Diffuse { albedo: albedo.recentred(origin) },
            Material::Mirror { color } => Material::Mirror { color: color.recentred(origin) },
            Material::Conductor { eta, k } => Material::Conductor { eta, k },
            Material::Dielectric { eta, color } => Material::Dielectric { eta, color: color.recentred(origin) },
            Material::MatteCone { color, mattness } => Material::MatteCone { color: color.recentred(origin), mattness },
            Material::OrenNayar { albedo, roughness } => Material::OrenNayar { albedo: albedo.recentred(origin), roughness },
            Material::Phong { color, exponent } => Material::Phong { color: color.recentred(origin), exponent },
            Material::BlinnPhong { color, exponent } => Material::BlinnPhong { color: color.recentred(origin), exponent },
            Material::Metal { color, roughness } => Material::Metal { color: color.recentred(origin), roughness },
            Material::Plastic { albedo, eta, internal } => Material::Plastic { albedo: albedo.recentred(origin), eta, internal },
            Material::DiffuseTransmission { reflectance, transmittance } => {
                Material::DiffuseTransmission { reflectance: reflectance.recentred(origin), transmittance: transmittance.recentred(origin) }
            }
            Material::RoughConductor { eta, k, finish, more } => {
                Material::RoughConductor { eta, k, finish: finish.recentred(origin), more }
            }
            Material::RoughDielectric { eta, color, finish, more } => {
                Material::RoughDielectric { eta, color: color.recentred(origin), finish: finish.recentred(origin), more }
            }
            Material::ThinDielectric { eta, color } => Material::ThinDielectric { eta, color: color.recentred(origin) },
            Material::Filled { surface, absorption } => Material::Filled { surface: Box::new(surface.recentred(origin)), absorption },
        }
    }

    /// What simulating this material takes.
    pub fn effects(&self) -> Effects {
        let spread = |is_mirror: bool| if is_mirror { Effects::SPECULAR_REFLECTION } else { Effects::INTERREFLECTION };
        let (model, textures): (Effects, Vec<&Texture>) = match self {
            Material::Diffuse { albedo } | Material::OrenNayar { albedo, .. } => (Effects::INTERREFLECTION, vec![albedo]),
            Material::Mirror { color } => (Effects::SPECULAR_REFLECTION, vec![color]),
            Material::Conductor { .. } => (Effects::SPECULAR_REFLECTION, vec![]),
            Material::Dielectric { color, .. } => (Effects::REFRACTION | Effects::SPECULAR_REFLECTION, vec![color]),
            Material::MatteCone { color, mattness } => {
                (spread(MatteCone { color: Spectrum::ONE, mattness: *mattness }.is_mirror()), vec![color])
            }
            Material::Metal { color, roughness } => {
                (spread(Metal { color: Spectrum::ONE, roughness: *roughness }.is_mirror()), vec![color])
            }
            Material::Phong { color, .. } | Material::BlinnPhong { color, .. } => (Effects::INTERREFLECTION, vec![color]),
            Material::Plastic { albedo, .. } => (Effects::INTERREFLECTION | Effects::SPECULAR_REFLECTION, vec![albedo]),
            Material::DiffuseTransmission { reflectance, transmittance } => (Effects::INTERREFLECTION, vec![reflectance, transmittance]),
            Material::RoughConductor { finish, .. } => {
                (finish_effects(finish, Effects::SPECULAR_REFLECTION), finish.texture().into_iter().collect())
            }
            Material::RoughDielectric { color, finish, .. } => {
                let smooth = Effects::REFRACTION | Effects::SPECULAR_REFLECTION;
                (finish_effects(finish, smooth), finish.texture().into_iter().chain([color]).collect())
            }
            // Light passes it unbent.
            Material::ThinDielectric { color, .. } => (Effects::REFRACTION | Effects::SPECULAR_REFLECTION, vec![color]),
            Material::Filled { surface, .. } => (surface.effects(), vec![]),
        };
        let textured = textures.into_iter().any(|t| !t.is_constant());
        if textured { model | Effects::TEXTURES } else { model }
    }
}

/// A rough surface scatters all around; a textured one may be smooth in places.
fn finish_effects(finish: &Finish, smooth: Effects) -> Effects {
    if finish.texture().is_some() { Effects::INTERREFLECTION | smooth } else { Effects::INTERREFLECTION }
}
