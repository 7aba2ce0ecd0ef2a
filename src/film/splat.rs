//! Splats: light that arrives anywhere on the film, such as at the end of a path that started at a light.

use glam::{IVec2, UVec2, Vec2};
use rayon::prelude::*;

use super::layer::places;
use super::{Crop, FilmSpec, Filter, Layer};
use crate::math::Spectrum;

/// Light that arrives at a point of the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Position on the film (pixels), from the upper left corner of the whole picture.
    pub raster: Vec2,
    /// Flux of the path times the importance of the camera [W·m⁻²·sr⁻¹]. In each sample there are as many paths as pixels, so that the
    /// radiance of a pixel is expected to be the sum, over the splats of one sample, of `value` times the reconstruction filter there.
    pub value: Spectrum,
    /// Scattering events between light and camera.
    pub depth: u32,
    /// Index of the light.
    pub light: u32,
}

impl Splat {
    /// Whether the splat counts in a pixel of the rectangle.
    pub fn reaches(&self, filter: &Filter, crop: Crop) -> bool {
        // From the centres of the outermost pixels.
        let (low, high) = (crop.min.as_vec2() + 0.5 - filter.radius(), crop.max.as_vec2() - 0.5 + filter.radius());
        self.raster.cmpge(low).all() && self.raster.cmple(high).all()
    }
}

/// Sums of the splats of one sample of every pixel: for each pixel of the crop the colours, then the layers of light.
///
/// Each sum is added in the order of the splats, so that it does not depend on the number of threads.
pub struct SplatSums {
    crop: Crop,
    filter: Filter,
    /// Layers to which splats add, each with the place of its first sum among those of a pixel.
    layers: Vec<(Layer, usize)>,
    /// Name of each light, as an index of [`Layer::Light`].
    lights: std::sync::Arc<[u32]>,
    /// Number of sums per pixel.
    width: usize,
    sums: Vec<f64>,
}

impl SplatSums {
    /// Sums of no splats.
    pub fn new(spec: &FilmSpec) -> SplatSums {
        let layers = places(&spec.layers).filter(|(layer, _)| layer.is_light()).map(|(layer, place)| (layer, 3 + place.start)).collect();
        let width = 3 + super::layer::sum_count(&spec.layers);
        let sums = vec![0.0; width * spec.crop.pixel_count() as usize];
        SplatSums { crop: spec.crop, filter: spec.filter.clone(), layers, lights: spec.lights.of.clone(), width, sums }
    }

    /// The sums of each pixel, in rows of the crop: red, green and blue, then as many numbers as the film has layer sums.
    pub fn numbers(&self) -> &[f64] {
        &self.sums
    }

    /// Adds splats, list after list.
    pub fn add(&mut self, lists: &[&[Splat]]) {
        let row = self.width * self.crop.size().x as usize;
        let rows = self.crop.size().y.div_ceil(rayon::current_num_threads() as u32).max(1);
        let (crop, filter, width) = (self.crop, &self.filter, self.width);
        let (layers, lights) = (&self.layers, &self.lights);
        self.sums.par_chunks_mut(row * rows as usize).enumerate().for_each(|(k, band)| {
            let min = crop.min + UVec2::Y * (k as u32 * rows);
            let pixels = Crop { min, max: crop.max.with_y(min.y + band.len().div_ceil(row) as u32) };
            for splat in lists.iter().copied().flatten().filter(|splat| splat.reaches(filter, pixels)) {
                let value = splat.value.to_rgb().map(f64::from);
                for (pixel, weight) in filtered(splat.raster, filter, pixels) {
                    let sums = &mut band[width * pixels.index(pixel)..][..width];
                    let mut add = |start: usize| (0..3).for_each(|c| sums[start + c] += weight * value[c]);
                    add(0);
                    layers.iter().filter(|(layer, _)| shows(*layer, splat, lights)).for_each(|&(_, start)| add(start));
                }
            }
        });
    }
}

/// Pixels of the rectangle in which light at `raster` counts, each with its weight.
fn filtered(raster: Vec2, filter: &Filter, pixels: Crop) -> impl Iterator<Item = (UVec2, f64)> {
    // Pixel centres at a distance of at most the radius; a box of radius ½ reaches one or, at a border, two of them.
    let radius = filter.radius();
    let low = (raster - 0.5 - radius).ceil().as_ivec2().max(pixels.min.as_ivec2());
    let high = (raster - 0.5 + radius).floor().as_ivec2().min(pixels.max.as_ivec2() - 1);
    let places = (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec2::new(x, y)));
    places.map(move |place| (place.as_uvec2(), filter.eval(raster - (place.as_vec2() + 0.5)))).filter(|(_, weight)| *weight != 0.0)
}

/// Whether the layer contains the splat.
fn shows(layer: Layer, splat: &Splat, lights: &[u32]) -> bool {
    match layer {
        Layer::Emission => splat.depth == 0,
        Layer::Direct => splat.depth == 1,
        Layer::Indirect => splat.depth > 1,
        Layer::Light(name) => lights.get(splat.light as usize) == Some(&name),
        _ => false,
    }
}
