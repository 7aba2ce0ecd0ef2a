//! Emission of surfaces.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::math::{Rgb, Spectrum};
use crate::texture::{Texture, TextureContext};

/// Diffuse emission of a point, with the same radiance in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Radiance [W·m⁻²·sr⁻¹].
    pub radiance: Spectrum,
    /// Whether both sides emit, not only the side of the normal.
    pub two_sided: bool,
}

impl Emission {
    /// Radiance that a surface with normal `ng` emits in the direction `w`.
    pub fn towards(&self, ng: Vec3, w: Vec3) -> Spectrum {
        if self.two_sided || ng.dot(w) > 0.0 { self.radiance } else { Spectrum::BLACK }
    }
}

/// Settings of the emission of a shape, optionally multiplied by a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Emitter {
    /// Radiance [W·m⁻²·sr⁻¹], or its value where the texture is 1.
    pub radiance: Rgb,
    /// Whether both sides emit, not only the side of the normal.
    pub two_sided: bool,
    /// Factor that varies over the surface.
    pub texture: Option<Arc<Texture>>,
}

impl Emitter {
    /// Emission of one side, the same everywhere.
    pub fn new(radiance: Rgb) -> Emitter {
        Emitter { radiance, two_sided: false, texture: None }
    }

    /// Emission at a point.
    pub fn at(&self, at: &TextureContext) -> Emission {
        let (whole, two_sided) = (Spectrum::from_illuminant(self.radiance), self.two_sided);
        match &self.texture {
            None => Emission { radiance: whole, two_sided },
            Some(texture) => Emission { radiance: whole * Spectrum::from_coefficients(texture.at(at)), two_sided },
        }
    }

    /// The emitter in coordinates shifted by −`origin`.
    pub fn recentred(self, origin: DVec3) -> Emitter {
        Emitter { texture: self.texture.map(|texture| Arc::new(Texture::clone(&texture).recentred(origin))), ..self }
    }
}
