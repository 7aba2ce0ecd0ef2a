//! Description of the sampler: the source of the random numbers.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use crate::format::SamplesPerPixel;
use crate::sampler::SPLATTING_SCRAMBLINGS;

/// The sampler and the number of samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sampler {
    /// The method by which samples are distributed.
    #[serde(rename = "type")]
    pub kind: SamplerKind,
    /// Samples per pixel.
    pub spp: SamplesPerPixel,
    /// The seed. Another seed gives an independent image of the same scene.
    pub seed: u64,
    /// The number of independent scramblings that share the samples of a pixel, for `stratified`, `halton` and `sobol`. The variance
    /// between them estimates the error. With 1 the samples are distributed most evenly, but there are no error bars. `independent`
    /// samples need no scramblings. The default for the integrator `light` is 8.
    pub scramblings: Scramblings,
}

/// The method by which samples are distributed.
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
        Sampler { kind: SamplerKind::default(), spp: SamplesPerPixel::known(64), seed: 0, scramblings: Scramblings(2) }
    }
}

/// A number of scramblings: a power of two from 1 to 64, so that aligned blocks of samples are divided evenly among them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Scramblings(u32);

impl Scramblings {
    /// The allowed numbers.
    pub const ALL: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];
    /// Default for integrators that splat.
    pub const SPLATTING: Scramblings = Scramblings(SPLATTING_SCRAMBLINGS);

    /// The number as a primitive type.
    pub fn get(self) -> u32 {
        self.0
    }
}

impl<'de> Deserialize<'de> for Scramblings {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Scramblings, D::Error> {
        let number = i128::deserialize(d)?;
        let known = Scramblings::ALL.into_iter().find(|k| i128::from(*k) == number);
        known.map(Scramblings).ok_or_else(|| D::Error::custom(format!("expected a power of two from 1 to 64, found {number}")))
    }
}

impl JsonSchema for Scramblings {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Scramblings".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({ "enum": Scramblings::ALL })
    }
}
