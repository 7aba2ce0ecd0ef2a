//! Descriptions of participating media.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Asymmetry, Coefficient, Color, Fraction, Radiometric};
use crate::reader::{by_kind, by_type};

/// A participating medium: it absorbs, scatters or emits light in the space between surfaces.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Medium {
    Homogeneous(Homogeneous),
}

by_type!(Medium { Homogeneous(Homogeneous) });

/// A medium that is the same everywhere. A ray of light keeps the share exp(−(absorption + scattering) · length) of its radiance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Homogeneous {
    /// σa, the share of the light that is absorbed on a short length, per metre.
    #[serde(default = "none")]
    pub absorption: Color<Coefficient>,
    /// σs, the share of the light that is scattered on a short length, per metre.
    #[serde(default = "none")]
    pub scattering: Color<Coefficient>,
    /// The radiance Le that the medium would have if it were opaque and did not scatter, in W·m⁻²·sr⁻¹. A short length emits the share
    /// σa of it per metre, so that a medium without absorption does not emit.
    #[serde(default = "dark")]
    pub emission: Color<Radiometric>,
    /// The directions of scattered light.
    #[serde(default)]
    pub phase: Phase,
    /// Where shapes with media overlap, the medium with the lowest priority number counts; of equal ones that of the smaller shape.
    #[serde(default)]
    pub priority: i32,
}

/// A phase function: how much light is scattered by which angle.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Phase {
    Isotropic(Isotropic),
    HenyeyGreenstein(HenyeyGreenstein),
    Rayleigh(Rayleigh),
    Mix(PhaseMix),
}

by_type!(Phase { Isotropic(Isotropic), HenyeyGreenstein(HenyeyGreenstein), Rayleigh(Rayleigh), Mix(PhaseMix) });

/// The same in all directions.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Isotropic {}

/// Mostly forwards, as in fog, clouds and milk, or mostly backwards: Henyey and Greenstein's function.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HenyeyGreenstein {
    /// The mean cosine of the angle: 0 scatters equally, towards 1 forwards, towards −1 backwards. Fog has about 0.85, skin 0.8 to 0.9.
    pub g: Asymmetry,
}

/// Scattering by particles much smaller than the wavelength, such as the molecules of air: 3/(16π) (1 + cos²).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rayleigh {}

/// A mixture of two phase functions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PhaseMix {
    /// The first phase function.
    pub a: Box<Phase>,
    /// The second phase function.
    pub b: Box<Phase>,
    /// The share of the light that the second one scatters.
    pub share: Fraction,
}

/// The name of a medium under `media`, or a medium.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum MediumRef {
    /// The name of a medium under `media`.
    Named(String),
    /// A medium described in place.
    Inline(Box<Medium>),
}

by_kind!(MediumRef { String => Named(String), Object => Inline(Box<Medium>) });

impl Default for Phase {
    fn default() -> Phase {
        Phase::Isotropic(Isotropic {})
    }
}

fn none() -> Color<Coefficient> {
    Color::Gray(Coefficient::known(0.0))
}

fn dark() -> Color<Radiometric> {
    Color::Gray(Radiometric::known(0.0))
}
