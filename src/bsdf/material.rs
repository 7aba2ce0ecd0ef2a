//! What a surface is made of: a model whose parameters may vary from point to point.

use glam::DVec3;

use super::{BlinnPhong, Bsdf, Conductor, Dielectric, Diffuse, DiffuseTransmission, MatteCone, Metal, Mirror, OrenNayar, Phong, Plastic};
use crate::effects::Effects;
use crate::math::Spectrum;
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
        };
        let textured = textures.into_iter().any(|t| !t.is_constant());
        if textured { model | Effects::TEXTURES } else { model }
    }
}
