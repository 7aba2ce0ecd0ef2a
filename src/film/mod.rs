//! Where samples end, and what is kept of them.

pub mod allocation;
pub mod block;
pub mod filter;
pub mod image;
pub mod layer;
pub mod memory;
pub mod moments;

use std::ops::Range;

use glam::UVec2;

use crate::sampler::Spread;

pub use allocation::Allocation;
pub use block::{Block, Slots};
pub use filter::Filter;
pub use image::{Channel, Image};
pub use layer::{Layer, LightNames};
pub use moments::{Moments, Tree};

/// The picture to be taken.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmSpec {
    /// Width and height of the whole picture (pixels).
    pub size: UVec2,
    /// The part to be rendered; its pixels are those of the whole picture, bit for bit.
    pub crop: Crop,
    pub filter: Filter,
    /// What is kept beside the picture; changes no bit of it.
    pub layers: Vec<Layer>,
    /// Whose light goes into which [`Layer::Light`].
    pub lights: LightNames,
    /// How many samples each pixel of the crop takes beside the others.
    pub allocation: Allocation,
}

impl FilmSpec {
    /// The whole picture, box filter, no layers, all pixels alike.
    pub fn new(width: u32, height: u32) -> FilmSpec {
        let size = UVec2::new(width, height);
        FilmSpec {
            size,
            crop: Crop { min: UVec2::ZERO, max: size },
            filter: Filter::default(),
            layers: vec![],
            lights: LightNames::default(),
            allocation: Allocation::default(),
        }
    }

    /// The picture alone.
    pub fn without_layers(self) -> FilmSpec {
        FilmSpec { layers: vec![], ..self }
    }

    /// Which numbers a pixel has.
    pub fn slots(&self, spread: Spread) -> Slots {
        Slots { spread, layers: layer::slots(&self.layers) }
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

    /// Which of its pixels, row by row, lies at these coordinates of the whole picture.
    pub fn index(&self, pixel: UVec2) -> usize {
        let UVec2 { x, y } = pixel - self.min;
        y as usize * self.size().x as usize + x as usize
    }

    pub fn pixel_count(&self) -> u64 {
        self.size().x as u64 * self.size().y as u64
    }
}

/// The samples `first` … `first + 2^level − 1` of every pixel; `first` is a multiple of 2^level.
///
/// Where an [`Allocation`] tells pixels apart, rounds of samples stand in the place of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wave {
    pub first: u64,
    pub level: u32,
}

impl Wave {
    pub fn samples(&self) -> u64 {
        1 << self.level
    }

    /// The indices of its samples.
    pub fn range(&self) -> Range<u64> {
        self.first..self.first + self.samples()
    }

    /// The samples of a pixel that takes 2^level of them in each round, this wave being of rounds.
    pub fn denser(&self, level: u32) -> Wave {
        Wave { first: self.first << level, level: self.level + level }
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

    /// Takes what one wave adds up to. Waves come in order, without gaps, and all have one spread.
    fn add(&mut self, wave: Wave, block: Block);
}

/// The film of production use: sums over the dyadic tree of sample indices.
///
/// It may hold a part of a picture's samples: those from the first wave on that it is given.
pub struct MomentFilm {
    spec: FilmSpec,
    tree: Tree<Block>,
}

impl MomentFilm {
    pub fn new(spec: FilmSpec) -> MomentFilm {
        MomentFilm { spec, tree: Tree::default() }
    }

    /// Samples per pixel so far; rounds of samples where an [`Allocation`] tells pixels apart.
    pub fn samples(&self) -> u64 {
        self.range().end - self.range().start
    }

    /// Which ones.
    pub fn range(&self) -> Range<u64> {
        self.tree.values()
    }

    /// What they add up to, block by block: added to another film in this order they are the same film again.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = (Wave, &Block)> {
        self.tree.blocks()
    }

    /// Of pixel i of the crop.
    pub fn samples_of(&self, pixel: usize) -> u64 {
        self.spec.allocation.samples(pixel, self.samples())
    }

    /// Samples so far, the mean of all pixels.
    pub fn mean_samples(&self) -> f64 {
        self.samples() as f64 * self.spec.allocation.mean()
    }

    /// ν, the degrees of freedom of the standard errors, of the pixel that has the fewest; 0 where there are none.
    pub fn freedom(&self) -> f64 {
        let [fewest, _] = self.spec.allocation.range();
        self.blocks().next().map_or(0.0, |(_, block)| block::freedom(block.spread(), fewest * self.samples()))
    }

    /// All that was added so far; black before the first wave.
    pub fn total(&self) -> Block {
        let black = || Block::black(self.spec.slots(Spread::Samples), self.spec.crop.pixel_count() as usize);
        self.tree.total(Block::join).unwrap_or_else(black)
    }

    /// The picture so far.
    pub fn image(&self) -> Image {
        Image::from_block(&self.spec, &self.total(), self.samples())
    }
}

impl Film for MomentFilm {
    fn spec(&self) -> &FilmSpec {
        &self.spec
    }

    fn add(&mut self, wave: Wave, block: Block) {
        if self.samples() == 0 {
            self.tree = Tree::starting_at(wave.first);
        }
        self.tree.push(wave.level, block, Block::join);
    }
}
