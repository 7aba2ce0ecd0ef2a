//! What a surface is made of: a model whose parameters may vary from point to point.

use glam::DVec3;

use super::{Bsdf, Conductor, Dielectric, Diffuse, MatteCone, Mirror};
use crate::effects::Effects;
use crate::math::Spectrum;
use crate::shape::SurfacePoint;
use crate::texture::Texture;

/// A model with textures for parameters; [`Material::at`] looks them up.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    Diffuse { albedo: Texture },
    Mirror { color: Texture },
    Conductor { eta: Spectrum, k: Spectrum },
    Dielectric { eta: f32, color: Texture },
    MatteCone { color: Texture, mattness: f32 },
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

    pub fn at(&self, point: &SurfacePoint) -> Bsdf {
        match self {
            Material::Diffuse { albedo } => Bsdf::Diffuse(Diffuse { albedo: albedo.at(point) }),
            Material::Mirror { color } => Bsdf::Mirror(Mirror { color: color.at(point) }),
            Material::Conductor { eta, k } => Bsdf::Conductor(Conductor { eta: *eta, k: *k }),
            Material::Dielectric { eta, color } => Bsdf::Dielectric(Dielectric { eta: *eta, color: color.at(point) }),
            Material::MatteCone { color, mattness } => Bsdf::MatteCone(MatteCone { color: color.at(point), mattness: *mattness }),
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
        }
    }

    /// What simulating this material takes.
    pub fn effects(&self) -> Effects {
        let (model, textures): (Effects, [Option<&Texture>; 1]) = match self {
            Material::Diffuse { albedo } => (Effects::INTERREFLECTION, [Some(albedo)]),
            Material::Mirror { color } => (Effects::SPECULAR_REFLECTION, [Some(color)]),
            Material::Conductor { .. } => (Effects::SPECULAR_REFLECTION, [None]),
            Material::Dielectric { color, .. } => (Effects::REFRACTION | Effects::SPECULAR_REFLECTION, [Some(color)]),
            Material::MatteCone { color, mattness } => {
                let is_mirror = MatteCone { color: Spectrum::ONE, mattness: *mattness }.is_mirror();
                (if is_mirror { Effects::SPECULAR_REFLECTION } else { Effects::INTERREFLECTION }, [Some(color)])
            }
        };
        let textured = textures.into_iter().flatten().any(|t| !t.is_constant());
        if textured { model | Effects::TEXTURES } else { model }
    }
}
