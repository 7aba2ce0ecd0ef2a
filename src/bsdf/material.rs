//! What a surface is made of: a model whose parameters may vary from point to point.

use glam::DVec3;

use super::microfacet::{Albedo, Finish};
use super::{Bsdf, Conductor, Dielectric, Diffuse, MatteCone, Mirror, RoughConductor, RoughDielectric, ThinDielectric};
use super::{rough_conductor, rough_dielectric};
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
        let (model, textures): (Effects, [Option<&Texture>; 2]) = match self {
            Material::Diffuse { albedo } => (Effects::INTERREFLECTION, [Some(albedo), None]),
            Material::Mirror { color } => (Effects::SPECULAR_REFLECTION, [Some(color), None]),
            Material::Conductor { .. } => (Effects::SPECULAR_REFLECTION, [None, None]),
            Material::Dielectric { color, .. } => (Effects::REFRACTION | Effects::SPECULAR_REFLECTION, [Some(color), None]),
            Material::MatteCone { color, mattness } => {
                let is_mirror = MatteCone { color: Spectrum::ONE, mattness: *mattness }.is_mirror();
                (if is_mirror { Effects::SPECULAR_REFLECTION } else { Effects::INTERREFLECTION }, [Some(color), None])
            }
            Material::RoughConductor { finish, .. } => (finish_effects(finish, Effects::SPECULAR_REFLECTION), [finish.texture(), None]),
            Material::RoughDielectric { color, finish, .. } => {
                let smooth = Effects::REFRACTION | Effects::SPECULAR_REFLECTION;
                (finish_effects(finish, smooth), [Some(color), finish.texture()])
            }
            // Light passes it unbent.
            Material::ThinDielectric { color, .. } => (Effects::REFRACTION | Effects::SPECULAR_REFLECTION, [Some(color), None]),
            Material::Filled { surface, .. } => (surface.effects(), [None, None]),
        };
        let textured = textures.into_iter().flatten().any(|t| !t.is_constant());
        if textured { model | Effects::TEXTURES } else { model }
    }
}

/// A rough surface scatters all around; a textured one may be smooth in places.
fn finish_effects(finish: &Finish, smooth: Effects) -> Effects {
    if finish.texture().is_some() { Effects::INTERREFLECTION | smooth } else { Effects::INTERREFLECTION }
}
