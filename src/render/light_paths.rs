//! Paths from the lights: their random numbers, and the light that they bring to the film.

use glam::UVec2;

use crate::film::{Crop, FilmSpec};
use crate::sampler::{SampleNumbers, SamplerSpec, Sequence};

/// Paths from the lights, if the integrator follows any. In each sample there is one for each pixel of the whole picture.
///
/// All paths of one scrambling take their numbers from one sequence, so that they are evenly distributed all together. With
/// evenly distributed samplers the samples of a pixel are therefore not independent, and only whole scramblings are: the error of a picture
/// follows from the spread of their means.
pub struct LightPaths {
    sequences: Vec<Sequence>,
    size: UVec2,
}

/// Number of light paths whose splats are in memory at once.
const BATCH: u64 = 1 << 16;

/// Key of the sequences: a pixel that no picture has.
const NO_PIXEL: UVec2 = UVec2::MAX;

impl LightPaths {
    /// Light paths of a picture.
    pub fn new(spec: &FilmSpec, sampler: &SamplerSpec) -> LightPaths {
        let pixels = u64::from(spec.size.x) * u64::from(spec.size.y);
        let spp = sampler.spp.saturating_mul(pixels);
        LightPaths { sequences: SamplerSpec { spp, ..*sampler }.sequences(), size: spec.size }
    }

    /// Random numbers of the path that belongs to a pixel and a sample index.
    pub fn numbers(&self, pixel: UVec2, index: u64) -> SampleNumbers<'_> {
        let k = self.sequences.len() as u64;
        let [width, height] = [self.size.x, self.size.y].map(u64::from);
        let place = u64::from(pixel.y) * width + u64::from(pixel.x);
        self.sequences[(index % k) as usize].sample(NO_PIXEL, (index / k) * width * height + place)
    }

    /// Strips of the whole picture, about `area` pixels each. In their order the pixels are in rows, so that the order of the splats
    /// does not depend on `area`.
    pub fn strips(&self, area: u32) -> Vec<Crop> {
        let rows = (area / self.size.x).max(1);
        let strip = |y: u32| Crop { min: UVec2::new(0, y), max: UVec2::new(self.size.x, (y + rows).min(self.size.y)) };
        (0..self.size.y).step_by(rows as usize).map(strip).collect()
    }

    /// Number of these strips whose paths are followed before their splats are added.
    pub fn batch(strips: &[Crop]) -> usize {
        let most = strips.first().map_or(1, Crop::pixel_count).max(1);
        (BATCH / most).max(1) as usize
    }
}
