//! Samplers: sources of uniform numbers for integrators.
//!
//! A new sampler is a file in this folder that implements [`Sampler`], a variant of [`Kind`], a row in [`Kind::ALL`] and an arm in
//! [`SamplerSpec::build`].

mod halton;
pub(crate) mod hash;
mod independent;
mod sobol;
mod stratified;

use glam::{UVec2, Vec2};

/// Source of uniform numbers in [0, 1), never 1.0.
///
/// Each number is a pure function of (seed, pixel, sample index, dimension), independent of the order of calls and of the thread.
/// Each effect owns its dimensions (see [`dimension`]) and goes to them with [`at`](Sampler::at), so that switching one effect off
/// never shifts the numbers of another.
///
/// Tests: replay in any order, blocks independent, uniformity, stratification, no correlation of dimensions.
pub trait Sampler {
    /// Begins the sample `index` of a pixel at dimension 0.
    fn start(&mut self, pixel: UVec2, index: u64);

    /// Sets the dimension of the next number.
    fn at(&mut self, dimension: u32);

    /// Returns the number of the current dimension and goes to the next dimension.
    fn next_1d(&mut self) -> f32;

    /// Returns the numbers of the current dimension and the next one, and goes two dimensions on. Samplers that stratify do so in both
    /// dimensions together.
    fn next_2d(&mut self) -> Vec2;
}

/// Settings of a sampler.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SamplerSpec {
    /// Kind of sampler.
    pub kind: Kind,
    /// Seed of all numbers.
    pub seed: u64,
    /// Planned number of samples per pixel. Only `stratified` depends on it; the samples of the other samplers are a prefix of an
    /// endless sequence.
    pub spp: u64,
    /// Number K of independent scramblings among which the samples of a pixel are divided, a power of two. The variance of their means
    /// gives the error.
    ///
    /// One long sequence is more even than K shorter ones but does not allow an estimate of its own error. Independent samples need no
    /// scramblings.
    pub scramblings: u32,
}

impl Default for SamplerSpec {
    /// Independent samples with seed 0, and two scramblings: the smallest number that gives an error, with the least loss of evenness.
    fn default() -> SamplerSpec {
        SamplerSpec { kind: Kind::default(), seed: 0, spp: 0, scramblings: 2 }
    }
}

/// Estimator of the error of a pixel's mean, by the samples that are independent of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ErrorEstimator {
    /// The variance of samples, each of which is independent of all others.
    Samples,
    /// The variance of the means of K independent sequences. Sample i belongs to sequence i mod K.
    Scramblings(u32),
}

impl ErrorEstimator {
    /// Number of sequences among which the samples are divided.
    pub fn sequences(self) -> u32 {
        match self {
            ErrorEstimator::Samples => 1,
            ErrorEstimator::Scramblings(k) => k,
        }
    }
}

impl SamplerSpec {
    /// Estimator of the error for this sampler.
    pub fn error_estimator(&self) -> ErrorEstimator {
        match self.kind {
            Kind::Independent => ErrorEstimator::Samples,
            Kind::Stratified | Kind::Halton | Kind::Sobol => ErrorEstimator::Scramblings(self.scramblings.max(1).next_power_of_two()),
        }
    }

    /// Independent sequences among which the samples of a pixel are divided. With K sequences, sample i of the pixel is sample i div K of
    /// sequence i mod K.
    pub fn sequences(&self) -> Vec<Box<dyn Sampler>> {
        let k = self.error_estimator().sequences();
        (0..k).map(|r| SamplerSpec { seed: scrambled(self.seed, r), spp: self.spp.div_ceil(k.into()), ..*self }.build()).collect()
    }

    /// A single sequence with all samples of a pixel.
    pub fn build(&self) -> Box<dyn Sampler> {
        match self.kind {
            Kind::Independent => Box::new(independent::Independent::new(self.seed)),
            Kind::Stratified => Box::new(stratified::Stratified::new(self.seed, self.spp)),
            Kind::Halton => Box::new(halton::Halton::new(self.seed)),
            Kind::Sobol => Box::new(sobol::Sobol::new(self.seed)),
        }
    }
}

/// Seed of scrambling r. Scrambling 0 has the seed itself.
///
/// The seed is mixed before r is added, because neighbouring seeds would otherwise share scramblings in another order.
///
/// Tests: seeds_share_no_scrambling.
fn scrambled(seed: u64, r: u32) -> u64 {
    if r == 0 { seed } else { hash::dimension_key(hash::mix(!seed), r) }
}

/// Kind of sampler.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Kind {
    /// Independent random numbers.
    #[default]
    Independent,
    /// Stratified numbers.
    Stratified,
    /// Scrambled Halton sequence.
    Halton,
    /// Scrambled Sobol' sequences.
    Sobol,
}

impl Kind {
    /// Each sampler with its name and a description in one line.
    pub const ALL: &[(Kind, &str, &str)] = &[
        (Kind::Independent, "independent", "Random numbers without structure: the plain Monte Carlo that error bars assume."),
        (Kind::Stratified, "stratified", "One number in each of spp equal strata of every dimension, in random order."),
        (Kind::Halton, "halton", "Radical inverses in prime bases, Owen-scrambled: any prefix is evenly spread over all dimensions."),
        (Kind::Sobol, "sobol", "Owen-scrambled (0,2)-sequences, one per pair of dimensions: every 2^k samples fill each pair evenly."),
    ];
}

/// Assignment of dimensions: a block of 8 for the camera, then a block of 8 for each vertex of a path. The number of dimensions that a
/// use takes is in parentheses.
pub mod dimension {
    /// Position within the pixel (2).
    pub const FILM: u32 = 0;
    /// Position on the lens (2).
    pub const LENS: u32 = 2;
    /// Time within the shutter interval (1).
    pub const TIME: u32 = 4;

    /// Number of dimensions per block.
    pub(crate) const BLOCK: u32 = 8;

    /// Use of numbers at a path vertex. The value is the offset within the vertex's block.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Use {
        /// Choice of a lobe (1), then a direction (2).
        Bsdf = 0,
        /// Choice of a light (1), then a point or direction (2).
        Light = 3,
        /// Russian roulette: whether the path survives (1).
        Roulette = 6,
        /// Distance travelled in a medium (1).
        Medium = 7,
    }

    /// First dimension of a use at the path vertex of the given depth. The camera's block comes before depth 0.
    #[inline]
    pub const fn vertex(depth: u32, use_: Use) -> u32 {
        BLOCK.wrapping_mul(depth.wrapping_add(1)).wrapping_add(use_ as u32)
    }
}
