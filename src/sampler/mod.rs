//! Where an integrator's numbers come from.
//!
//! To add a sampler: a file beside this one that implements [`Sampler`], a variant of [`Kind`], a
//! row in [`Kind::ALL`], an arm in [`SamplerSpec::build`].

mod halton;
pub(crate) mod hash;
mod independent;
mod sobol;
mod stratified;

use glam::{UVec2, Vec2};

/// A source of uniform numbers in [0, 1), never 1.0.
///
/// Each number is a pure function of (seed, pixel, sample index, dimension): whoever asks, in
/// whatever order, on whatever thread, gets the same. Each effect owns its dimensions (see
/// [`dimension`]) and goes to them with [`at`](Sampler::at), so that switching one effect off
/// never shifts another's numbers.
///
/// Tests: replay in any order, blocks independent, uniformity, stratification, no correlation of dimensions.
pub trait Sampler {
    /// Begins a sample: everything before is forgotten, the dimension is 0.
    fn start(&mut self, pixel: UVec2, index: u64);

    /// Goes to a dimension.
    fn at(&mut self, dimension: u32);

    /// The number of this dimension; the next dimension follows.
    fn next_1d(&mut self) -> f32;

    /// A point of the square of this dimension and its successor, stratified as a pair where the sampler stratifies.
    fn next_2d(&mut self) -> Vec2;
}

/// Settings of a sampler.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SamplerSpec {
    pub kind: Kind,
    pub seed: u64,
    /// Samples per pixel that are planned. Only `stratified` depends on it; the others' samples are a prefix of an endless sequence.
    pub spp: u64,
    /// K, a power of two: how many independent scramblings share the samples of a pixel, so that their spread tells the error.
    ///
    /// One long sequence is more even than K shorter ones, and says nothing of its own error. Independent
    /// samples need no such thing.
    pub scramblings: u32,
}

impl Default for SamplerSpec {
    /// Two scramblings: the least that tells an error, and the least that it costs.
    fn default() -> SamplerSpec {
        SamplerSpec { kind: Kind::default(), seed: 0, spp: 0, scramblings: 2 }
    }
}

/// What of a pixel's samples is independent of what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Spread {
    /// Each sample of all others.
    Samples,
    /// K sequences of each other; sample i belongs to sequence i mod K.
    Scramblings(u32),
}

impl Spread {
    /// Into how many sequences samples are dealt.
    pub fn sequences(self) -> u32 {
        match self {
            Spread::Samples => 1,
            Spread::Scramblings(k) => k,
        }
    }
}

impl SamplerSpec {
    pub fn spread(&self) -> Spread {
        match self.kind {
            Kind::Independent => Spread::Samples,
            Kind::Stratified | Kind::Halton | Kind::Sobol => Spread::Scramblings(self.scramblings.max(1).next_power_of_two()),
        }
    }

    /// The sequences of a pixel: sample i of the pixel is sample i div K of sequence i mod K.
    pub fn sequences(&self) -> Vec<Box<dyn Sampler>> {
        let k = self.spread().sequences();
        (0..k).map(|r| SamplerSpec { seed: scrambled(self.seed, r), spp: self.spp.div_ceil(k.into()), ..*self }.build()).collect()
    }

    /// One sequence, whole.
    pub fn build(&self) -> Box<dyn Sampler> {
        match self.kind {
            Kind::Independent => Box::new(independent::Independent::new(self.seed)),
            Kind::Stratified => Box::new(stratified::Stratified::new(self.seed, self.spp)),
            Kind::Halton => Box::new(halton::Halton::new(self.seed)),
            Kind::Sobol => Box::new(sobol::Sobol::new(self.seed)),
        }
    }
}

/// The seed of scrambling r; the first keeps the pixel's own.
///
/// Mixed before r comes in: neighbouring seeds would share their scramblings, in another order.
///
/// Tests: seeds_share_no_scrambling.
fn scrambled(seed: u64, r: u32) -> u64 {
    if r == 0 { seed } else { hash::dimension_key(hash::mix(!seed), r) }
}

/// The samplers there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Kind {
    #[default]
    Independent,
    Stratified,
    Halton,
    Sobol,
}

impl Kind {
    /// Each sampler with its name and one line about it.
    pub const ALL: &[(Kind, &str, &str)] = &[
        (Kind::Independent, "independent", "Random numbers without structure: the plain Monte Carlo that error bars assume."),
        (Kind::Stratified, "stratified", "One number in each of spp equal strata of every dimension, in random order."),
        (Kind::Halton, "halton", "Radical inverses in prime bases, Owen-scrambled: any prefix is evenly spread over all dimensions."),
        (Kind::Sobol, "sobol", "Owen-scrambled (0,2)-sequences, one per pair of dimensions: every 2^k samples fill each pair evenly."),
    ];
}

/// Who owns which dimensions: a block of 8 for the camera, then a block of 8 for each vertex of a path.
pub mod dimension {
    /// Position within the pixel (2).
    pub const FILM: u32 = 0;
    /// Position on the lens (2).
    pub const LENS: u32 = 2;
    /// Time within the shutter interval (1).
    pub const TIME: u32 = 4;

    /// Dimensions per block.
    pub(crate) const BLOCK: u32 = 8;

    /// What a path vertex spends numbers on; the value is the place in the vertex's block.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Use {
        /// Choice of a lobe (1), then a direction (2).
        Bsdf = 0,
        /// Choice of a light (1), then a point or direction (2).
        Light = 3,
        /// Survival (1).
        Roulette = 6,
        /// Distance travelled in a medium (1).
        Medium = 7,
    }

    /// The first dimension of one use at the path vertex of this depth; the camera's block comes before depth 0.
    #[inline]
    pub const fn vertex(depth: u32, use_: Use) -> u32 {
        BLOCK.wrapping_mul(depth.wrapping_add(1)).wrapping_add(use_ as u32)
    }
}
