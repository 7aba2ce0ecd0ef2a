//! The sampler: where the random numbers come from.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::value::SamplesPerPixel;

/// The sampler and how much it samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sampler {
    /// How the samples are spread.
    #[serde(rename = "type")]
    pub kind: SamplerKind,
    /// Samples per pixel.
    pub spp: SamplesPerPixel,
    /// Another seed is another, independent image of the same scene.
    pub seed: u64,
}

/// How samples are spread.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum SamplerKind {
    /// Independent uniform numbers.
    Independent,
    /// Jittered strata, shuffled per dimension.
    Stratified,
    /// The Halton sequence, scrambled.
    Halton,
    /// The Sobol' sequence, Owen-scrambled.
    #[default]
    Sobol,
}

impl Default for Sampler {
    fn default() -> Sampler {
        Sampler { kind: SamplerKind::default(), spp: SamplesPerPixel::known(64), seed: 0 }
    }
}
