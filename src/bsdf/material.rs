//! Constructors of materials, and the context in which their parameters are looked up.

use glam::{Vec2, Vec3};

use super::dispersion::Dispersion;
use super::microfacet::Roughness;
use super::{Bsdf, Compound, Dispersive, Material, Metallic, Mix, Share, textured};
use crate::math::{Rgb, Wavelength};
use crate::shape::{SurfacePoint, VertexColor};
use crate::texture::{Number, Texture, TextureContext};

/// Whether light passes through a surface, and what is behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Passage {
    /// No light passes: the surface is opaque.
    Blocked,
    /// Light passes into the same medium as before, as behind a pane or a sheet of paper.
    Sheet,
    /// Light passes into a body with another index of refraction.
    Body,
}

/// The context of a hit that the lookup of parameters may depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HitContext {
    /// The point of the surface, with the footprint of textures.
    pub texture: TextureContext,
    /// The length of the path segment inside the body behind the surface (m); 0 for light from outside.
    pub inside: f32,
    /// The wavelength of the light, if the path has one: see [`Material::dispersive`].
    pub wavelength: Option<Wavelength>,
}

impl HitContext {
    /// A context for the lookup of parameters that are the same everywhere.
    pub(super) const ANYWHERE: HitContext = HitContext {
        texture: TextureContext { p: Vec3::ZERO, uv: Vec2::ZERO, color: VertexColor::WHITE, footprint: None },
        inside: 0.0,
        wavelength: None,
    };

    /// The context of light that comes from outside of the body.
    pub fn from_outside(point: SurfacePoint) -> HitContext {
        HitContext { texture: TextureContext::exact(&point), inside: 0.0, wavelength: None }
    }

    /// Looks up the model of a material in this context.
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

    /// Metal: rough, or polished if `roughness` is `None`. `multiscatter` adds the light that facets reflect more than once.
    pub fn metal(reflectance: impl Into<Metallic>, roughness: Option<Roughness>, multiscatter: bool) -> Material {
        textured::Conductor::new(reflectance, roughness, multiscatter).into()
    }

    /// Rough glass. `multiscatter` adds the light that hits more than one facet.
    pub fn rough_glass(eta: impl Into<Number>, color: impl Into<Texture>, roughness: Roughness, multiscatter: bool) -> Material {
        textured::Dielectric::new(eta, color, Some(roughness), multiscatter).into()
    }

    /// Glass whose index of refraction depends on the wavelength.
    ///
    /// A path that has no wavelength when it meets the surface takes one: see [`PathWavelength`](crate::integrator::PathWavelength).
    pub fn dispersive(glass: textured::Dielectric, dispersion: Dispersion) -> Material {
        Compound::Dispersive(Dispersive::new(glass, dispersion)).into()
    }

    /// A mix of 1 − `share` of the first material and `share` of the second, with `share` from 0 to 1.
    pub fn mix(a: Material, b: Material, share: impl Into<Texture>) -> Material {
        Material::mixed(|| a, || b, share.into())
    }

    /// A mix as of [`Material::mix`]. A material with the constant share 0 is not constructed, because the tables of facets take time.
    pub(super) fn mixed(a: impl FnOnce() -> Material, b: impl FnOnce() -> Material, share: Texture) -> Material {
        match share {
            Texture::Constant(none) if none == Rgb::BLACK => a(),
            Texture::Constant(all) if all == Rgb::WHITE => b(),
            share => Compound::Mix(Mix { a: a(), b: b(), share: Share::Texture(share) }).into(),
        }
    }

    /// Whether light passes through the surface.
    pub fn transmits(&self) -> bool {
        self.passage() != Passage::Blocked
    }

    /// An upper bound of the number of [`Bsdf::delta_lobes`]: the mirror direction, which all models share, and one for each kind of glass.
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
