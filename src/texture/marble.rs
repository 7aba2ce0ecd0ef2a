//! A marble texture.

use glam::DVec3;

use super::noise::Turbulence;
use super::{Space, Texture, TextureContext};
use crate::math::{Rgb, float};

/// Layers across z, disturbed by turbulence: a blend from `base` to `veins` by the share ½ (1 + sin(scale·z + 10·turbulence(p))).
///
/// Source: Perlin, *An Image Synthesizer* (1985), with the constants of ray-tracing courses.
#[derive(Clone, Debug, PartialEq)]
pub struct Marble {
    /// The colour of the stone.
    pub base: Texture,
    /// The colour of the veins.
    pub veins: Texture,
    /// The frequency of the layers, in radians per unit along z.
    pub scale: f64,
    /// The kind of turbulence.
    pub turbulence: Turbulence,
    /// The coordinates of the layers.
    pub space: Space,
}

/// The number of octaves of the turbulence. Further octaves would have an amplitude of less than a hundredth.
const OCTAVES: u32 = 7;

impl Marble {
    /// Looks up the colour at a point.
    pub fn at(&self, at: &TextureContext) -> Rgb {
        let p = self.space.coordinates(at);
        let phase = self.scale * p.z + 10.0 * self.turbulence.at(p, OCTAVES);
        self.base.at(at).mix(self.veins.at(at), 0.5 * (1.0 + float::sin(phase as f32)))
    }

    pub(super) fn recentred(self, origin: DVec3) -> Marble {
        let (base, veins, space) = (self.base.recentred(origin), self.veins.recentred(origin), self.space.recentred(origin));
        Marble { base, veins, space, ..self }
    }
}
