//! What a surface is made of: a model whose parameters may vary from point to point.

use glam::{DVec3, Vec2, Vec3};

use super::microfacet::{Albedo, Finish, Ladder, Scale};
use super::{
    BlinnPhong, Bsdf, Conductor, Dielectric, Diffuse, DiffuseTransmission, MatteCone, Metal, Mirror, OrenNayar, Phong, Plastic, Reflectance,
};
use super::{Compound, Mix, Place, RoughConductor, RoughDielectric, Share, ThinDielectric, rough_conductor, rough_dielectric};
use crate::effects::Effects;
use crate::math::{Spectrum, float};
use crate::shape::{SurfacePoint, VertexColor};
use crate::texture::{Number, Texture};

/// What becomes of light that goes on behind a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Passage {
    /// No light goes on: the surface is opaque.
    Blocked,
    /// The light is in the same medium as before: behind a pane, or a sheet of paper.
    Sheet,
    /// The light is inside a body of another index of refraction.
    Body,
}

/// A point for parameters that are the same at all of them.
pub(super) const ANYWHERE: SurfacePoint =
    SurfacePoint { p: Vec3::ZERO, offset: 0.0, ng: Vec3::Z, ns: Vec3::Z, uv: Vec2::ZERO, color: VertexColor::WHITE };

/// A model with textures for parameters; [`Material::at`] looks them up.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    Diffuse {
        albedo: Texture,
    },
    Mirror {
        color: Texture,
    },
    /// See [`Material::metal`].
    Conductor {
        reflectance: Metallic,
        finish: Option<Finish>,
        losses: Option<&'static Albedo>,
    },
    Dielectric {
        eta: Number,
        color: Texture,
    },
    MatteCone {
        color: Texture,
        mattness: Texture,
    },
    OrenNayar {
        albedo: Texture,
        roughness: Texture,
    },
    Phong {
        color: Texture,
        exponent: Number,
    },
    BlinnPhong {
        color: Texture,
        exponent: Number,
    },
    Metal {
        color: Texture,
        roughness: Texture,
    },
    /// See [`Material::plastic`].
    Plastic {
        albedo: Texture,
        eta: Number,
        /// [`Plastic::internal`], where it is the same everywhere.
        internal: Option<f32>,
    },
    /// Where reflectance and transmittance add up to more than 1, both are scaled down.
    DiffuseTransmission {
        reflectance: Texture,
        transmittance: Texture,
    },
    /// See [`Material::rough_glass`].
    RoughDielectric {
        eta: Number,
        color: Texture,
        finish: Finish,
        more: Option<Ladder<rough_dielectric::Losses>>,
    },
    ThinDielectric {
        eta: Number,
        color: Texture,
    },
    /// The surface of a body that absorbs: e^(−σ d) of the light passes the distance d inside (σ in 1/m).
    Filled {
        surface: Box<Material>,
        absorption: Spectrum,
    },
    /// Made of other materials.
    Compound(Box<Compound>),
}

/// What metal reflects, from point to point.
#[derive(Clone, Debug, PartialEq)]
pub enum Metallic {
    /// By its index of refraction; with the mean over the hemisphere.
    Index { reflectance: Reflectance, mean: Spectrum },
    /// By an index of refraction that varies.
    Indices { eta: Texture, k: Texture },
    /// By its colour, seen straight on.
    Color(Texture),
}

impl Metallic {
    fn at(&self, point: &SurfacePoint) -> Reflectance {
        match self {
            Metallic::Index { reflectance, .. } => *reflectance,
            Metallic::Indices { eta, k } => Reflectance::Index { eta: eta.at(point), k: k.at(point) },
            Metallic::Color(color) => Reflectance::Schlick { normal: color.at(point) },
        }
    }

    /// The mean over the hemisphere of what it reflects at a point.
    fn mean(&self, reflectance: &Reflectance) -> Spectrum {
        match self {
            Metallic::Index { mean, .. } => *mean,
            Metallic::Indices { .. } | Metallic::Color(_) => reflectance.mean(),
        }
    }

    fn textures(&self) -> impl Iterator<Item = &Texture> {
        let [first, second] = match self {
            Metallic::Index { .. } => [None, None],
            Metallic::Indices { eta, k } => [Some(eta), Some(k)],
            Metallic::Color(color) => [Some(color), None],
        };
        first.into_iter().chain(second)
    }

    fn recentred(self, origin: DVec3) -> Metallic {
        match self {
            Metallic::Index { .. } => self,
            Metallic::Indices { eta, k } => Metallic::Indices { eta: eta.recentred(origin), k: k.recentred(origin) },
            Metallic::Color(color) => Metallic::Color(color.recentred(origin)),
        }
    }
}

impl From<Texture> for Metallic {
    fn from(color: Texture) -> Metallic {
        Metallic::Color(color)
    }
}

/// eta and k.
impl From<(Spectrum, Spectrum)> for Metallic {
    fn from((eta, k): (Spectrum, Spectrum)) -> Metallic {
        let reflectance = Reflectance::Index { eta, k };
        Metallic::Index { reflectance, mean: reflectance.mean() }
    }
}

/// eta and k.
impl From<(Texture, Texture)> for Metallic {
    fn from(index: (Texture, Texture)) -> Metallic {
        match index {
            (Texture::Constant(eta), Texture::Constant(k)) => (eta, k).into(),
            (eta, k) => Metallic::Indices { eta, k },
        }
    }
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
        Material::Dielectric { eta: eta.into(), color: Spectrum::ONE.into() }
    }

    /// A matte ground under a clear coat with the index of refraction `eta`, at least 1.
    pub fn plastic(albedo: impl Into<Texture>, eta: impl Into<Number>) -> Material {
        let eta = eta.into();
        Material::Plastic { albedo: albedo.into(), internal: eta.constant().map(Plastic::internal), eta }
    }

    /// Metal: polished without a `finish`, else with facets; `multiscatter` follows light that they reflect more than once.
    pub fn metal(reflectance: impl Into<Metallic>, finish: Option<Finish>, multiscatter: bool) -> Material {
        let rough = finish.as_ref().filter(|_| multiscatter);
        let losses = rough.map(|finish| rough_conductor::losses(finish.domain(), finish.distribution));
        Material::Conductor { reflectance: reflectance.into(), finish, losses }
    }

    /// Glass with facets; `multiscatter` follows light that meets more than one of them.
    pub fn rough_glass(eta: impl Into<Number>, color: impl Into<Texture>, finish: Finish, multiscatter: bool) -> Material {
        let eta = eta.into();
        let tables = || Ladder::new(eta.range(), Scale::Index, |eta| rough_dielectric::losses(eta, finish.domain(), finish.distribution));
        Material::RoughDielectric { color: color.into(), more: multiscatter.then(tables), finish, eta }
    }

    /// `share` of the second, from 0 to 1, the rest of the first.
    pub fn mix(a: Material, b: Material, share: impl Into<Texture>) -> Material {
        Material::mixed(|| a, || b, share.into())
    }

    /// [`Material::mix`] of what is made only where there is some of it: facets come with tables.
    pub(super) fn mixed(a: impl FnOnce() -> Material, b: impl FnOnce() -> Material, share: Texture) -> Material {
        match share {
            Texture::Constant(none) if none == Spectrum::BLACK => a(),
            Texture::Constant(all) if all == Spectrum::ONE => b(),
            share => Compound::Mix(Mix { a: a(), b: b(), share: Share::Texture(share) }).into(),
        }
    }

    /// Whether it matters where the axes of the surface point.
    pub fn is_anisotropic(&self) -> bool {
        match self {
            Material::Conductor { finish, .. } => finish.as_ref().is_some_and(Finish::is_anisotropic),
            Material::RoughDielectric { finish, .. } => finish.is_anisotropic(),
            Material::Filled { surface, .. } => surface.is_anisotropic(),
            Material::Compound(compound) => compound.is_anisotropic(),
            _ => false,
        }
    }

    /// Whether light goes through.
    pub fn transmits(&self) -> bool {
        self.passage() != Passage::Blocked
    }

    /// What becomes of light that goes on behind the surface.
    pub fn passage(&self) -> Passage {
        match self {
            Material::Dielectric { .. } | Material::RoughDielectric { .. } | Material::Filled { .. } => Passage::Body,
            Material::ThinDielectric { .. } | Material::DiffuseTransmission { .. } => Passage::Sheet,
            Material::Compound(compound) => compound.parts().into_iter().map(Material::passage).max().unwrap_or(Passage::Blocked),
            _ => Passage::Blocked,
        }
    }

    /// A bound on [`Bsdf::delta_lobes`]: the mirror direction, which all share, and that of each kind of glass.
    pub fn most_delta_lobes(&self) -> usize {
        1 + self.glasses()
    }

    fn glasses(&self) -> usize {
        match self {
            Material::Compound(compound) => compound.parts().into_iter().map(Material::glasses).sum(),
            Material::DiffuseTransmission { .. } => 0,
            plain => usize::from(plain.transmits()),
        }
    }

    /// The model at a point, for light from outside.
    pub fn at(&self, point: &SurfacePoint) -> Bsdf<'_> {
        self.met(point, 0.0)
    }

    /// The model at a point, with what the body behind the surface has taken of the light on its way there.
    ///
    /// - `inside`: the length of that way (m); 0 for light from outside
    pub fn met(&self, point: &SurfacePoint, inside: f32) -> Bsdf<'_> {
        match self {
            Material::Compound(compound) => compound.met(&Place { point: *point, inside }),
            Material::Filled { surface, absorption } => {
                let surface = surface.met(point, inside);
                if inside > 0.0 { surface.dimmed(absorption.map(|sigma| float::exp(-sigma * inside))) } else { surface }
            }
            // All others have one.
            plain => plain.model(point).unwrap_or(Bsdf::Diffuse(Diffuse { albedo: Spectrum::BLACK })),
        }
    }

    /// The model that a material is everywhere, if it is; to be looked up once.
    pub fn uniform(&self) -> Option<Bsdf<'static>> {
        self.model(&ANYWHERE).filter(|_| !self.effects().contains(Effects::TEXTURES))
    }

    /// `None` for what is made of other materials.
    fn model(&self, point: &SurfacePoint) -> Option<Bsdf<'static>> {
        Some(match self {
            Material::Diffuse { albedo } => Bsdf::Diffuse(Diffuse { albedo: albedo.at(point) }),
            Material::Mirror { color } => Bsdf::Mirror(Mirror { color: color.at(point) }),
            Material::Conductor { reflectance: metallic, finish, losses } => {
                let reflectance = metallic.at(point);
                match finish.as_ref().and_then(|finish| finish.at(point)) {
                    None => Bsdf::Conductor(Conductor { reflectance }),
                    Some(facets) => {
                        let more = losses
                            .and_then(|losses| rough_conductor::MoreReflections::new(losses, facets.alpha, metallic.mean(&reflectance)));
                        Bsdf::RoughConductor(RoughConductor { reflectance, facets, more })
                    }
                }
            }
            Material::Dielectric { eta, color } => Bsdf::Dielectric(Dielectric { eta: eta.at(point), color: color.at(point) }),
            Material::MatteCone { color, mattness } => {
                Bsdf::MatteCone(MatteCone { color: color.at(point), mattness: mattness.scalar(point) })
            }
            Material::OrenNayar { albedo, roughness } => {
                Bsdf::OrenNayar(OrenNayar { albedo: albedo.at(point), roughness: roughness.scalar(point) })
            }
            Material::Phong { color, exponent } => Bsdf::Phong(Phong { color: color.at(point), exponent: exponent.at(point) }),
            Material::BlinnPhong { color, exponent } => {
                Bsdf::BlinnPhong(BlinnPhong { color: color.at(point), exponent: exponent.at(point) })
            }
            Material::Metal { color, roughness } => Bsdf::Metal(Metal { color: color.at(point), roughness: roughness.scalar(point) }),
            Material::Plastic { albedo, eta, internal } => {
                let eta = eta.at(point);
                Bsdf::Plastic(Plastic { albedo: albedo.at(point), eta, internal: internal.unwrap_or_else(|| Plastic::internal(eta)) })
            }
            Material::DiffuseTransmission { reflectance, transmittance } => {
                let (reflectance, transmittance) = (reflectance.at(point), transmittance.at(point));
                let scale = (reflectance + transmittance).max().max(1.0).recip();
                Bsdf::DiffuseTransmission(DiffuseTransmission { reflectance: reflectance * scale, transmittance: transmittance * scale })
            }
            Material::RoughDielectric { eta, color, finish, more } => {
                let (eta, color) = (eta.at(point), color.at(point));
                match finish.at(point).filter(|facets| RoughDielectric::is_rough(eta, facets.alpha)) {
                    None => Bsdf::Dielectric(Dielectric { eta, color }),
                    Some(facets) => {
                        let losses = more.as_ref().map(|losses| losses.at(eta));
                        let more = losses.and_then(|losses| rough_dielectric::MoreEncounters::new(losses, facets.alpha, eta));
                        Bsdf::RoughDielectric(RoughDielectric { eta, color, facets, more })
                    }
                }
            }
            Material::ThinDielectric { eta, color } => Bsdf::ThinDielectric(ThinDielectric { eta: eta.at(point), color: color.at(point) }),
            Material::Filled { .. } | Material::Compound(_) => return None,
        })
    }

    /// The same material after the world has moved by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Material {
        match self {
            Material::Diffuse { albedo } => Material::Diffuse { albedo: albedo.recentred(origin) },
            Material::Mirror { color } => Material::Mirror { color: color.recentred(origin) },
            Material::Conductor { reflectance, finish, losses } => {
                let finish = finish.map(|finish| finish.recentred(origin));
                Material::Conductor { reflectance: reflectance.recentred(origin), finish, losses }
            }
            Material::Dielectric { eta, color } => Material::Dielectric { eta: eta.recentred(origin), color: color.recentred(origin) },
            Material::MatteCone { color, mattness } => {
                Material::MatteCone { color: color.recentred(origin), mattness: mattness.recentred(origin) }
            }
            Material::OrenNayar { albedo, roughness } => {
                Material::OrenNayar { albedo: albedo.recentred(origin), roughness: roughness.recentred(origin) }
            }
            Material::Phong { color, exponent } => Material::Phong { color: color.recentred(origin), exponent: exponent.recentred(origin) },
            Material::BlinnPhong { color, exponent } => {
                Material::BlinnPhong { color: color.recentred(origin), exponent: exponent.recentred(origin) }
            }
            Material::Metal { color, roughness } => {
                Material::Metal { color: color.recentred(origin), roughness: roughness.recentred(origin) }
            }
            Material::Plastic { albedo, eta, internal } => {
                Material::Plastic { albedo: albedo.recentred(origin), eta: eta.recentred(origin), internal }
            }
            Material::DiffuseTransmission { reflectance, transmittance } => {
                Material::DiffuseTransmission { reflectance: reflectance.recentred(origin), transmittance: transmittance.recentred(origin) }
            }
            Material::RoughDielectric { eta, color, finish, more } => Material::RoughDielectric {
                eta: eta.recentred(origin),
                color: color.recentred(origin),
                finish: finish.recentred(origin),
                more,
            },
            Material::ThinDielectric { eta, color } => {
                Material::ThinDielectric { eta: eta.recentred(origin), color: color.recentred(origin) }
            }
            Material::Filled { surface, absorption } => Material::Filled { surface: Box::new(surface.recentred(origin)), absorption },
            Material::Compound(compound) => Material::Compound(Box::new(compound.recentred(origin))),
        }
    }

    /// What simulating this material takes.
    pub fn effects(&self) -> Effects {
        let spread = |width: &Texture| match width {
            Texture::Constant(none) if none.is_black() => Effects::SPECULAR_REFLECTION,
            Texture::Constant(_) => Effects::INTERREFLECTION,
            _ => Effects::SPECULAR_REFLECTION | Effects::INTERREFLECTION,
        };
        let (model, textures): (Effects, Vec<&Texture>) = match self {
            Material::Diffuse { albedo } => (Effects::INTERREFLECTION, vec![albedo]),
            Material::OrenNayar { albedo, roughness } => (Effects::INTERREFLECTION, vec![albedo, roughness]),
            Material::Mirror { color } => (Effects::SPECULAR_REFLECTION, vec![color]),
            Material::Conductor { reflectance, finish, .. } => {
                let model = finish.as_ref().map_or(Effects::SPECULAR_REFLECTION, |finish| finish.effects(Effects::SPECULAR_REFLECTION));
                (model, reflectance.textures().chain(finish.iter().flat_map(Finish::textures)).collect())
            }
            Material::Dielectric { eta, color } | Material::ThinDielectric { eta, color } => {
                // Light passes a thin one unbent.
                (Effects::REFRACTION | Effects::SPECULAR_REFLECTION, eta.texture().into_iter().chain([color]).collect())
            }
            Material::MatteCone { color, mattness } => (spread(mattness), vec![color, mattness]),
            Material::Metal { color, roughness } => (spread(roughness), vec![color, roughness]),
            Material::Phong { color, exponent } | Material::BlinnPhong { color, exponent } => {
                (Effects::INTERREFLECTION, exponent.texture().into_iter().chain([color]).collect())
            }
            Material::Plastic { albedo, eta, .. } => {
                (Effects::INTERREFLECTION | Effects::SPECULAR_REFLECTION, eta.texture().into_iter().chain([albedo]).collect())
            }
            Material::DiffuseTransmission { reflectance, transmittance } => (Effects::INTERREFLECTION, vec![reflectance, transmittance]),
            Material::RoughDielectric { eta, color, finish, .. } => {
                let smooth = Effects::REFRACTION | Effects::SPECULAR_REFLECTION;
                (finish.effects(smooth), finish.textures().chain(eta.texture()).chain([color]).collect())
            }
            Material::Filled { surface, .. } => (surface.effects(), vec![]),
            Material::Compound(compound) => (compound.effects(), vec![]),
        };
        let textured = textures.into_iter().any(|t| !t.is_constant());
        if textured { model | Effects::TEXTURES } else { model }
    }
}

impl From<Compound> for Material {
    fn from(compound: Compound) -> Material {
        Material::Compound(Box::new(compound))
    }
}
