//! Films: sums of the samples of each pixel, and pictures made from them.

pub mod allocation;
pub mod filter;
mod footprint;
pub mod image;
pub mod layer;
pub mod memory;
pub mod moments;
pub(crate) mod neighborhood;
pub mod pixel_sums;
mod sample_set;
pub mod splat;
mod standard_error;

use std::fmt;
use std::ops::Range;

use glam::UVec2;
use rayon::prelude::*;

use crate::sampler::ErrorEstimator;

pub use allocation::Allocation;
pub use filter::Filter;
pub use footprint::TextureFootprint;
pub use image::{Channel, Image};
pub use layer::{Layer, LightNames};
pub use moments::{Moments, Tree};
pub use pixel_sums::{PixelLayout, PixelSums};
pub use sample_set::{PixelSamples, SampleSet};
pub use splat::{Splat, SplatSums};

/// Settings of a picture: size, crop, filter and layers.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmSpec {
    /// Width and height of the whole picture (pixels).
    pub size: UVec2,
    /// Part of the picture that is rendered. Its pixels equal those of the whole picture, bit for bit; only standard errors that are
    /// shared with neighbours differ at its edges.
    pub crop: Crop,
    /// Reconstruction filter.
    pub filter: Filter,
    /// Layers that are kept in addition to the colours. They change no bit of the picture.
    pub layers: Vec<Layer>,
    /// Names of the lights, which choose the [`Layer::Light`] of each light.
    pub lights: LightNames,
    /// Relative number of samples of each pixel of the crop.
    pub allocation: Allocation,
    /// Width of the area over which the textures of materials are averaged.
    pub texture_footprint: TextureFootprint,
}

impl FilmSpec {
    /// A film of the whole picture with a box filter, no layers and the same number of samples for all pixels.
    pub fn new(width: u32, height: u32) -> FilmSpec {
        let size = UVec2::new(width, height);
        FilmSpec {
            size,
            crop: Crop { min: UVec2::ZERO, max: size },
            filter: Filter::default(),
            layers: vec![],
            lights: LightNames::default(),
            allocation: Allocation::default(),
            texture_footprint: TextureFootprint::default(),
        }
    }

    /// The film without layers.
    pub fn without_layers(self) -> FilmSpec {
        FilmSpec { layers: vec![], ..self }
    }

    /// A smaller film that shows the same view, without layers. A film that has fewer pixels keeps its size.
    ///
    /// - `most`: about the number of pixels within the crop
    pub fn with_pixels(&self, most: f32) -> FilmSpec {
        let factor = (most / self.crop.size().as_vec2().element_product()).sqrt().min(1.0);
        let scaled = |v: UVec2| (v.as_vec2() * factor).round().as_uvec2();
        let size = scaled(self.size).max(UVec2::ONE);
        let min = scaled(self.crop.min).min(size - 1);
        let crop = Crop { min, max: scaled(self.crop.max).clamp(min + 1, size) };
        FilmSpec { size, crop, ..self.clone().without_layers() }
    }

    /// The film with textures looked up at points.
    pub fn without_footprints(self) -> FilmSpec {
        FilmSpec { texture_footprint: TextureFootprint::Fixed(0.0), ..self }
    }

    /// Layout of the sums of a pixel.
    pub fn layout(&self, error_estimator: ErrorEstimator) -> PixelLayout {
        PixelLayout { error_estimator, layers: layer::sum_count(&self.layers) }
    }

    /// Width of the whole picture divided by its height.
    pub fn aspect(&self) -> f32 {
        self.size.x as f32 / self.size.y as f32
    }
}

/// Rectangle of the pixels with min ≤ (x, y) < max.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First pixel of the rectangle.
    pub min: UVec2,
    /// First pixel beyond the rectangle.
    pub max: UVec2,
}

/// `X0,X1,Y0,Y1`, as `--crop` takes it.
impl fmt::Display for Crop {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Crop { min, max } = self;
        write!(f, "{},{},{},{}", min.x, max.x, min.y, max.y)
    }
}

impl Crop {
    /// Width and height (pixels).
    pub fn size(&self) -> UVec2 {
        self.max - self.min
    }

    /// Row-major index within the crop of a pixel of the whole picture.
    pub fn index(&self, pixel: UVec2) -> usize {
        let UVec2 { x, y } = pixel - self.min;
        y as usize * self.size().x as usize + x as usize
    }

    /// Number of pixels.
    pub fn pixel_count(&self) -> u64 {
        self.size().x as u64 * self.size().y as u64
    }

    /// Whether the pixel of the whole picture is in the rectangle.
    pub fn contains(&self, pixel: UVec2) -> bool {
        pixel.cmpge(self.min).all() && pixel.cmplt(self.max).all()
    }

    /// Ranges of the indices of a rectangle's pixels, row by row.
    ///
    /// - `inner`: rectangle within this one
    pub fn rows(self, inner: Crop) -> impl Iterator<Item = Range<usize>> {
        (inner.min.y..inner.max.y).map(move |y| {
            let start = self.index(UVec2::new(inner.min.x, y));
            start..start + inner.size().x as usize
        })
    }

    /// Pixels of both rectangles; no pixels if they are apart.
    pub fn intersection(&self, other: Crop) -> Crop {
        let min = self.min.max(other.min);
        Crop { min, max: self.max.min(other.max).max(min) }
    }
}

/// Aligned range of sample indices `first` … `first + 2^level − 1` of every pixel, where `first` is a multiple of 2^level.
///
/// If an [`Allocation`] gives pixels different numbers of samples, the indices count rounds of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wave {
    /// First sample index.
    pub first: u64,
    /// Binary logarithm of the number of samples.
    pub level: u32,
}

impl Wave {
    /// Number of samples per pixel.
    pub fn samples(&self) -> u64 {
        1 << self.level
    }

    /// Range of the sample indices.
    pub fn range(&self) -> Range<u64> {
        self.first..self.first + self.samples()
    }

    /// Converts a wave of rounds into the wave of samples of a pixel that takes 2^`level` samples per round.
    pub fn scaled(&self, level: u32) -> Wave {
        Wave { first: self.first << level, level: self.level + level }
    }

    /// The largest aligned wave after `done` samples that ends at `total` or before and has at most 2^`max_level` samples.
    ///
    /// The first wave is a single sample, so that a picture is shown at once.
    pub fn next(done: u64, total: u64, max_level: u32) -> Option<Wave> {
        let left = total.checked_sub(done).filter(|&left| left > 0)?;
        let aligned = if done == 0 { 0 } else { done.trailing_zeros() };
        Some(Wave { first: done, level: aligned.min(left.ilog2()).min(max_level) })
    }
}

/// Receiver of the sums of a render.
pub trait Film: Send {
    /// Settings of the picture.
    fn spec(&self) -> &FilmSpec;

    /// Adds the sums of one wave. Waves arrive in order, and all have the same error estimator.
    fn add(&mut self, wave: Wave, block: PixelSums);
}

/// Film that keeps sums over the dyadic tree of sample indices.
///
/// The film may hold only some of a picture's samples, with gaps between them.
pub struct MomentFilm {
    spec: FilmSpec,
    /// One tree for each range of samples without gaps, in order.
    trees: Vec<Tree<PixelSums>>,
}

impl MomentFilm {
    /// A film without samples.
    pub fn new(spec: FilmSpec) -> MomentFilm {
        MomentFilm { spec, trees: vec![] }
    }

    /// Number of samples per pixel so far, or of rounds of samples if the [`Allocation`] is uneven.
    pub fn samples(&self) -> u64 {
        self.ranges().map(|range| range.end - range.start).sum()
    }

    /// Ranges of the samples (or rounds) so far, in order and without gaps.
    fn ranges(&self) -> impl Iterator<Item = Range<u64>> {
        self.trees.iter().map(Tree::values)
    }

    /// Samples (or rounds) so far.
    pub fn sample_set(&self) -> SampleSet {
        SampleSet::of(self.ranges())
    }

    /// Range of the indices from the first sample (or round) to the last.
    pub fn range(&self) -> Range<u64> {
        let end = |tree: Option<&Tree<PixelSums>>| tree.map_or(0..0, Tree::values);
        end(self.trees.first()).start..end(self.trees.last()).end
    }

    /// Sums of the dyadic blocks. Added to an empty film in this order, they give an identical film.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = (Wave, &PixelSums)> {
        self.trees.iter().flat_map(Tree::blocks).collect::<Vec<_>>().into_iter()
    }

    /// The film of some of the pixels, as a render of this crop has it.
    ///
    /// - `crop`: rectangle within the film's own
    pub fn cropped(&self, crop: Crop) -> MomentFilm {
        let spec = FilmSpec { crop, allocation: self.spec.allocation.cropped(self.spec.crop, crop), ..self.spec.clone() };
        let mut film = MomentFilm::new(spec);
        self.blocks().for_each(|(wave, block)| film.add(wave, block.cropped(self.spec.crop, crop)));
        film
    }

    /// Number of samples so far of one pixel, by its index in the crop.
    pub fn samples_of(&self, pixel: usize) -> u64 {
        self.spec.allocation.samples(pixel, self.samples())
    }

    /// Number of samples so far, averaged over all pixels.
    pub fn mean_samples(&self) -> f64 {
        self.samples() as f64 * self.spec.allocation.mean()
    }

    /// Degrees of freedom ν of the standard errors of the pixel with the fewest samples; 0 if errors cannot be estimated.
    pub fn freedom(&self) -> f64 {
        let fewest = *self.spec.allocation.levels().start();
        let (samples, estimator) = (self.sample_set(), self.error_estimator());
        estimator.map_or(0.0, |estimator| pixel_sums::freedom(estimator, samples.of_pixel(fewest)))
    }

    /// Estimator of the error; `None` without samples.
    pub fn error_estimator(&self) -> Option<ErrorEstimator> {
        self.trees.iter().flat_map(Tree::blocks).next().map(|(_, block)| block.error_estimator())
    }

    /// Sums of all samples so far; zero before the first wave.
    pub fn total(&self) -> PixelSums {
        let black = || PixelSums::black(self.spec.layout(ErrorEstimator::Samples), self.spec.crop.pixel_count() as usize);
        let totals = self.trees.iter().filter_map(|tree| tree.total(PixelSums::join));
        totals.reduce(|sum, total| sum.join(&total)).unwrap_or_else(black)
    }

    /// The picture so far.
    pub fn image(&self) -> Image {
        Image::from_sums(&self.spec, &self.total(), &self.sample_set())
    }

    /// Red, green and blue of the picture so far, within rounding. That takes a fraction of the time of [`MomentFilm::image`], which
    /// also has errors and layers.
    pub fn colors(&self) -> Image {
        let blocks: Vec<&PixelSums> = self.blocks().map(|(_, block)| block).collect();
        let color = |i: usize| {
            let sum = blocks.iter().fold([0.0; 3], |sum, block| {
                let more = block.sum(i);
                std::array::from_fn(|c| sum[c] + more[c])
            });
            sum.map(|sum: f64| (sum / self.samples_of(i).max(1) as f64) as f32)
        };
        let colors: Vec<[f32; 3]> = (0..self.spec.crop.pixel_count() as usize).into_par_iter().map(color).collect();
        let channel = |(c, name): (usize, &str)| Channel { name: name.into(), values: colors.iter().map(|color| color[c]).collect() };
        let channels = ["R", "G", "B"].into_iter().enumerate().map(channel).collect();
        Image { full_size: self.spec.size, origin: self.spec.crop.min, size: self.spec.crop.size(), channels }
    }
}

impl Film for MomentFilm {
    fn spec(&self) -> &FilmSpec {
        &self.spec
    }

    fn add(&mut self, wave: Wave, block: PixelSums) {
        if self.trees.last().is_none_or(|tree| tree.values().end != wave.first) {
            self.trees.push(Tree::starting_at(wave.first));
        }
        if let Some(tree) = self.trees.last_mut() {
            tree.push(wave.level, block, PixelSums::join);
        }
    }
}
