//! What a surface is made of: a model whose parameters may vary from point to point.

use glam::{Vec2, Vec3};

use super::microfacet::Roughness;
use super::{Bsdf, Compound, Material, Metallic, Mix, Share, textured};
use crate::math::Rgb;
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

/// Where and how light meets a material: what the lookup of its parameters may depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HitContext {
    /// The point of the surface.
    pub point: SurfacePoint,
    /// The length of the light's way through the body behind the surface (m); 0 for light from outside.
    pub inside: f32,
}

impl HitContext {
    /// A context for parameters that are the same everywhere.
    pub(super) const ANYWHERE: HitContext = HitContext::from_outside(SurfacePoint {
        p: Vec3::ZERO,
        offset: 0.0,
        ng: Vec3::Z,
        ns: Vec3::Z,
        uv: Vec2::ZERO,
        color: VertexColor::WHITE,
    });

    /// Light that comes from outside of the body.
    pub const fn from_outside(point: SurfacePoint) -> HitContext {
        HitContext { point, inside: 0.0 }
    }

    /// The model of a material here.
    pub(super) fn bsdf_of<'m>(&self, material: &'m Material) -> Bsdf<'m> {
        material.bsdf_at(self)
    }
}

impl Material {
    /// A matte surface that reflects the share `albedo`.
    pub fn diffuse(albedo: impl Into<Texture>) -> Material {
        textured::Diffuse { albedo: albedo.into() }.into()
    }

    /// A mirror that reflects the share `color`.
    pub fn mirror(color: impl Into<Texture>) -> Material {
        textured::Mirror { color: color.into() }.into()
    }

    /// Clear glass with the index of refraction `eta`, inside over outside.
    pub fn glass(eta: f32) -> Material {
        textured::Dielectric::smooth(eta, 1.0).into()
    }

    /// A matte base under a clear coat with the index of refraction `eta`, at least 1.
    pub fn plastic(albedo: impl Into<Texture>, eta: impl Into<Number>) -> Material {
        textured::Plastic::new(albedo, eta).into()
    }

    /// Metal: polished without a `finish`, else with facets; `multiscatter` follows light that they reflect more than once.
    pub fn metal(reflectance: impl Into<Metallic>, finish: Option<Roughness>, multiscatter: bool) -> Material {
        textured::Conductor::new(reflectance, finish, multiscatter).into()
    }

    /// Glass with facets; `multiscatter` follows light that meets more than one of them.
    pub fn rough_glass(eta: impl Into<Number>, color: impl Into<Texture>, finish: Roughness, multiscatter: bool) -> Material {
        textured::Dielectric::new(eta, color, Some(finish), multiscatter).into()
    }

    /// `share` of the second, from 0 to 1, the rest of the first.
    pub fn mix(a: Material, b: Material, share: impl Into<Texture>) -> Material {
        Material::mixed(|| a, || b, share.into())
    }

    /// [`Material::mix`] of what is made only where there is some of it: facets come with tables.
    pub(super) fn mixed(a: impl FnOnce() -> Material, b: impl FnOnce() -> Material, share: Texture) -> Material {
        match share {
            Texture::Constant(none) if none == Rgb::BLACK => a(),
            Texture::Constant(all) if all == Rgb::WHITE => b(),
            share => Compound::Mix(Mix { a: a(), b: b(), share: Share::Texture(share) }).into(),
        }
    }

    /// Whether light goes through.
    pub fn transmits(&self) -> bool {
        self.passage() != Passage::Blocked
    }

    /// A bound on the number of [`Bsdf::delta_lobes`]: the mirror direction, which all share, and that of each kind of glass.
    pub fn most_delta_lobes(&self) -> usize {
        1 + self.glasses()
    }

    fn glasses(&self) -> usize {
        match self {
            Material::Compound(compound) => compound.parts().into_iter().map(Material::glasses).sum(),
            Material::DiffuseTransmission(_) => 0,
            plain => usize::from(plain.transmits()),
        }
    }
}

impl From<Compound> for Material {
    fn from(compound: Compound) -> Material {
        Material::Compound(Box::new(compound))
    }
}
