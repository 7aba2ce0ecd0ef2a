//! Pictures: named channels of f32 numbers.

use std::ops::Range;

use glam::UVec2;

use super::layer::{self, Layer};
use super::pixel_sums::{Estimate, PixelSums, estimate, freedom};
use super::standard_error::standard_errors;
use super::{FilmSpec, SampleSet};

/// Picture of linear channels over a crop, in rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width and height of the whole picture (pixels).
    pub full_size: UVec2,
    /// Position of this part in the whole picture (pixels).
    pub origin: UVec2,
    /// Width and height of this part (pixels).
    pub size: UVec2,
    /// Channels, `R`, `G`, `B` first.
    pub channels: Vec<Channel>,
}

/// One channel of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name as in EXR files: `R`, `StdErr.R`, …
    pub name: String,
    /// One number per pixel, in rows from the top.
    pub values: Vec<f32>,
}

/// Channels of a layer.
///
/// - `place`: range of its sums among the layer sums of a pixel
/// - `taken`: number of samples of pixel i
fn layer_channels(
    spec: &FilmSpec,
    sums: &PixelSums,
    layer: Layer,
    place: Range<usize>,
    taken: &dyn Fn(usize) -> u64,
) -> impl Iterator<Item = Channel> {
    layer.channels(&spec.lights).into_iter().enumerate().map(move |(c, name)| Channel {
        name,
        values: sums.layers().enumerate().map(|(i, layer_sums)| layer.value(&layer_sums[place.clone()], c, taken(i)) as f32).collect(),
    })
}

const RGB: [&str; 3] = ["R", "G", "B"];

impl Image {
    /// Picture with the mean, its standard error if the [`ErrorEstimator`](crate::sampler::ErrorEstimator) gives one, the number of
    /// samples, and the layers of the film.
    pub fn from_sums(spec: &FilmSpec, sums: &PixelSums, samples: &SampleSet) -> Image {
        let of_pixel = |i: usize| samples.of_pixel(spec.allocation.level(i));
        let taken = |i: usize| of_pixel(i).count();
        let estimates: Vec<Estimate> =
            sums.pixels().enumerate().map(|(i, pixel)| estimate(sums.error_estimator(), pixel, of_pixel(i))).collect();
        let channel = |name: String, value: &dyn Fn(&Estimate) -> f64| Channel {
            name,
            values: estimates.iter().map(|pixel| value(pixel) as f32).collect(),
        };
        let mut channels: Vec<Channel> = (0..3).map(|c| channel(RGB[c].into(), &|pixel| pixel[c].0)).collect();
        if freedom(sums.error_estimator(), samples.of_pixel(*spec.allocation.levels().start())) > 0.0 {
            let errors = standard_errors(spec, sums, &estimates, &taken);
            let values = |c: usize| errors.iter().map(|pixel| pixel[c] as f32).collect();
            channels.extend((0..3).map(|c| Channel { name: format!("StdErr.{}", RGB[c]), values: values(c) }));
        }
        channels.push(Channel { name: "SampleCount.Y".into(), values: (0..estimates.len()).map(|i| taken(i) as f32).collect() });
        channels.extend(layer::places(&spec.layers).flat_map(|(layer, place)| layer_channels(spec, sums, layer, place, &taken)));
        Image { full_size: spec.size, origin: spec.crop.min, size: spec.crop.size(), channels }
    }

    /// Values of the channel with this name.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }

    /// Red, green and blue of pixel (x, y) of this part. Missing channels are 0.
    pub fn rgb(&self, x: u32, y: u32) -> [f32; 3] {
        let i = (y * self.size.x + x) as usize;
        RGB.map(|name| self.channel(name).and_then(|values| values.get(i)).copied().unwrap_or(0.0))
    }

    /// Red, green and blue of each pixel. Missing channels are 0.
    pub fn pixels(&self) -> impl Iterator<Item = [f32; 3]> {
        let channels = RGB.map(|name| self.channel(name));
        (0..self.size.element_product() as usize).map(move |i| channels.map(|values| values.map_or(0.0, |values| values[i])))
    }
}
