//! A picture as numbers: named f32 channels.

use std::ops::Range;

use glam::UVec2;

use super::FilmSpec;
use super::block::{Block, Estimate, estimate, freedom};
use super::layer::{self, Layer};

/// Linear channels over the crop of a picture, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Of the whole picture.
    pub full_size: UVec2,
    /// Where in it this part begins.
    pub origin: UVec2,
    pub size: UVec2,
    /// `R`, `G`, `B` first.
    pub channels: Vec<Channel>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// As in EXR: `R`, `StdErr.R`, …
    pub name: String,
    pub values: Vec<f32>,
}

/// - `place`: of its numbers among those of a pixel's layers
/// - `taken`: samples of pixel i
fn layer_channels(
    spec: &FilmSpec,
    block: &Block,
    layer: Layer,
    place: Range<usize>,
    taken: &dyn Fn(usize) -> u64,
) -> impl Iterator<Item = Channel> {
    layer.channels(&spec.lights).into_iter().enumerate().map(move |(c, name)| Channel {
        name,
        values: block.layers().enumerate().map(|(i, sums)| layer.value(&sums[place.clone()], c, taken(i)) as f32).collect(),
    })
}

const RGB: [&str; 3] = ["R", "G", "B"];

impl Image {
    /// The mean, its standard error where the samples' [`Spread`](crate::sampler::Spread) tells one, how many samples
    /// there are, and the layers of the film.
    pub fn from_block(spec: &FilmSpec, block: &Block, samples: u64) -> Image {
        let taken = |i: usize| spec.allocation.samples(i, samples);
        let estimates: Vec<Estimate> = block.pixels().enumerate().map(|(i, pixel)| estimate(block.spread(), pixel, taken(i))).collect();
        let channel = |name: String, value: &dyn Fn(&Estimate) -> f64| Channel {
            name,
            values: estimates.iter().map(|pixel| value(pixel) as f32).collect(),
        };
        let mut channels: Vec<Channel> = (0..3).map(|c| channel(RGB[c].into(), &|pixel| pixel[c].0)).collect();
        if freedom(block.spread(), spec.allocation.range()[0] * samples) > 0.0 {
            channels.extend((0..3).map(|c| channel(format!("StdErr.{}", RGB[c]), &|pixel| pixel[c].1.sqrt())));
        }
        channels.push(Channel { name: "SampleCount.Y".into(), values: (0..estimates.len()).map(|i| taken(i) as f32).collect() });
        channels.extend(layer::places(&spec.layers).flat_map(|(layer, place)| layer_channels(spec, block, layer, place, &taken)));
        Image { full_size: spec.size, origin: spec.crop.min, size: spec.crop.size(), channels }
    }

    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }

    /// Red, green and blue of pixel (x, y) of this part; missing channels are 0.
    pub fn rgb(&self, x: u32, y: u32) -> [f32; 3] {
        let i = (y * self.size.x + x) as usize;
        RGB.map(|name| self.channel(name).and_then(|values| values.get(i)).copied().unwrap_or(0.0))
    }

    pub fn pixels(&self) -> impl Iterator<Item = [f32; 3]> {
        let [r, g, b] = RGB.map(|name| self.channel(name).unwrap_or(&[]));
        r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b])
    }
}
