//! Samplers: sources of uniform numbers for integrators.
//!
//! A new sampler is a file in this folder that implements [`Sampler`], a variant of [`Sequence`] with its arms, a variant of [`Kind`],
//! a row in [`Kind::ALL`] and an arm in [`SamplerSpec::build`].

mod halton;
pub(crate) mod hash;
mod independent;
mod many;
mod sequence;
mod sobol;
mod stratified;

use glam::{UVec2, Vec2};

pub use halton::Halton;
pub use independent::{Independent, Stream};
pub use many::{BatchNumbers, NumberLanes};
pub use sequence::{SampleNumbers, Sequence};
pub use sobol::Sobol;
pub use stratified::Stratified;

/// Source of uniform numbers in [0, 1), never 1.0.
///
/// A number is a pure function of the sampler, the pixel, the index of the sample and the dimension. [`key`](Sampler::key) does once
/// what the numbers of a sample have in common. Each effect owns its dimensions (see [`dimension`]), so that switching one effect off
/// never shifts the numbers of another.
///
/// Tests: the same numbers in any order, every coordinate matters, uniformity, stratification, no correlation of dimensions.
pub trait Sampler: Send + Sync {
    /// Key of the sample `index` of a pixel.
    fn key(&self, pixel: UVec2, index: u64) -> SampleKey;

    /// Number of a dimension.
    fn get_1d(&self, key: SampleKey, dimension: u32) -> f32;

    /// Numbers of a dimension and of the next one. Samplers that stratify do so in both dimensions together.
    fn get_2d(&self, key: SampleKey, dimension: u32) -> Vec2;

    /// Number of a dimension, such as for a choice, and the numbers of the next two, which belong together. Samplers may stratify in all
    /// three together; then these are other numbers than those of [`get_1d`](Sampler::get_1d) and [`get_2d`](Sampler::get_2d).
    fn get_3d(&self, key: SampleKey, dimension: u32) -> (f32, Vec2) {
        (self.get_1d(key, dimension), self.get_2d(key, dimension.wrapping_add(1)))
    }
}

/// Place of one sample in a sampler's sequence, from which all its numbers are computed. Each sampler uses the fields in its own way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SampleKey {
    /// Hash of what distinguishes sequences: seed, pixel, and for some samplers the index.
    pub hash: u64,
    /// Place in the sequence.
    pub index: u64,
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

/// Default number of scramblings of integrators that splat. A scrambling of theirs gives one observation of each pixel, whatever its
/// number of samples, and 8 observations give error bars that are right to a quarter.
pub const SPLATTING_SCRAMBLINGS: u32 = 8;

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

    /// One more than the last index of a sample: `stratified` has its planned samples alone, the others as many as 32 bits count.
    pub fn end(&self) -> u64 {
        if self.kind == Kind::Stratified { self.spp } else { u32::MAX.into() }
    }

    /// Independent sequences among which the samples of a pixel are divided. With K sequences, sample i of the pixel is sample i div K of
    /// sequence i mod K.
    pub fn sequences(&self) -> Vec<Sequence> {
        let k = self.error_estimator().sequences();
        (0..k).map(|r| SamplerSpec { seed: scrambled(self.seed, r), spp: self.spp.div_ceil(k.into()), ..*self }.build()).collect()
    }

    /// A single sequence with all samples of a pixel.
    pub fn build(&self) -> Sequence {
        match self.kind {
            Kind::Independent => Sequence::Independent(Independent { seed: self.seed }),
            Kind::Stratified => Sequence::Stratified(Stratified::new(self.seed, self.spp)),
            Kind::Halton => Sequence::Halton(Halton { seed: self.seed }),
            Kind::Sobol => Sequence::Sobol(Sobol { seed: self.seed }),
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
        (
            Kind::Stratified,
            "stratified",
            "One number in each of n equal strata of every dimension, in random order, for the n samples of each scrambling.",
        ),
        (Kind::Halton, "halton", "Radical inverses in prime bases, Owen-scrambled: any prefix is evenly spread over all dimensions."),
        (
            Kind::Sobol,
            "sobol",
            "Owen-scrambled Sobol' sequences, one for each choice, point or direction: every 2^k samples fill each evenly.",
        ),
    ];

    /// Name of the sampler in scene files and on the command line.
    pub fn name(self) -> &'static str {
        Kind::ALL.iter().find(|row| row.0 == self).map_or("unknown", |row| row.1)
    }

    /// The sampler of this name.
    pub fn named(name: &str) -> Option<Kind> {
        Kind::ALL.iter().find(|row| row.1 == name).map(|row| row.0)
    }
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
    /// Choice of a light (1), then a point or direction (2), for light that arrives at a meter.
    pub const METER_LIGHT: u32 = 5;
    /// Wavelength of a path through dispersive glass (1). A meter adds such a path to the light that it samples itself, so that the two may
    /// share a number.
    pub const WAVELENGTH: u32 = 5;

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

    /// Use of numbers for a point on the way to a path vertex, where a medium may scatter light into the path. The value is the offset
    /// within a block of its own.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum OnWay {
        /// Choice of a light near which the point shall be (1), then a point of it (2).
        Guide = 0,
        /// Distance (1).
        Distance = 3,
        /// Choice of a light (1), then a point or direction (2).
        Light = 4,
    }

    /// First dimension of a use on the way to the path vertex of the given depth. These blocks lie beyond those of vertices.
    #[inline]
    pub const fn on_way(depth: u32, use_: OnWay) -> u32 {
        (1u32 << 31).wrapping_add(BLOCK.wrapping_mul(depth)).wrapping_add(use_ as u32)
    }

    /// First dimension of a use at the path vertex of the given depth. The block of the camera comes before that of depth 0.
    #[inline]
    pub const fn vertex(depth: u32, use_: Use) -> u32 {
        BLOCK.wrapping_mul(depth.wrapping_add(1)).wrapping_add(use_ as u32)
    }
}
