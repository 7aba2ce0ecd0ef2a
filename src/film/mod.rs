//! Where samples end, and what is kept of them.

pub mod filter;
pub mod image;
pub mod moments;

use glam::UVec2;

pub use filter::Filter;
pub use image::{Channel, Image};
pub use moments::{Moments, Tree};

/// The picture to be taken.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmSpec {
    /// Width and height of the whole picture (pixels).
    pub size: UVec2,
    /// The part to be rendered; its pixels are those of the whole picture, bit for bit.
    pub crop: Crop,
    pub filter: Filter,
}

impl FilmSpec {
    /// The whole picture, box filter.
    pub fn new(width: u32, height: u32) -> FilmSpec {
        let size = UVec2::new(width, height);
        FilmSpec { size, crop: Crop { min: UVec2::ZERO, max: size }, filter: Filter::default() }
    }

    pub fn aspect(&self) -> f32 {
        self.size.x as f32 / self.size.y as f32
    }
}

/// Pixels with min ≤ (x, y) < max.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    pub min: UVec2,
    pub max: UVec2,
}

impl Crop {
    pub fn size(&self) -> UVec2 {
        self.max - self.min
    }

    pub fn pixel_count(&self) -> u64 {
        self.size().x as u64 * self.size().y as u64
    }
}

/// The samples `first` … `first + 2^level − 1` of every pixel; `first` is a multiple of 2^level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wave {
    pub first: u64,
    pub level: u32,
}

impl Wave {
    pub fn samples(&self) -> u64 {
        1 << self.level
    }

    /// The largest aligned wave after `done` samples that ends by `total`, at most 2^`max_level` long.
    ///
    /// The first is a single sample, so that a picture shows at once.
    pub fn next(done: u64, total: u64, max_level: u32) -> Option<Wave> {
        let left = total.checked_sub(done).filter(|&left| left > 0)?;
        let aligned = if done == 0 { 0 } else { done.trailing_zeros() };
        Some(Wave { first: done, level: aligned.min(left.ilog2()).min(max_level) })
    }
}

/// What a render leaves behind.
pub trait Film: Send {
    fn spec(&self) -> &FilmSpec;

    /// Takes the moments of one wave, rows of the crop from the top. Waves come in order, without gaps.
    fn add(&mut self, wave: Wave, pixels: Vec<Moments>);
}

/// The film of production use: sums and sums of squares, added up over the dyadic tree of sample indices.
pub struct MomentFilm {
    spec: FilmSpec,
    samples: u64,
    tree: Tree<Vec<Moments>>,
}

impl MomentFilm {
    pub fn new(spec: FilmSpec) -> MomentFilm {
        MomentFilm { spec, samples: 0, tree: Tree::default() }
    }

    /// Samples per pixel so far.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The picture so far; black before the first wave.
    ///
    /// - `with_error`: whether s²/n is the variance of the mean, as it is for independent samples
    pub fn image(&self, with_error: bool) -> Image {
        let black = || vec![Moments::default(); self.spec.crop.pixel_count() as usize];
        let total = self.tree.total(join).unwrap_or_else(black);
        Image::from_moments(&self.spec, &total, self.samples, with_error)
    }
}

impl Film for MomentFilm {
    fn spec(&self) -> &FilmSpec {
        &self.spec
    }

    fn add(&mut self, wave: Wave, pixels: Vec<Moments>) {
        self.tree.push(wave.level, pixels, join);
        self.samples = wave.first + wave.samples();
    }
}

#[expect(clippy::ptr_arg, reason = "the tree joins what it holds")]
fn join(a: &Vec<Moments>, b: &Vec<Moments>) -> Vec<Moments> {
    a.iter().zip(b).map(|(a, b)| a.join(b)).collect()
}
