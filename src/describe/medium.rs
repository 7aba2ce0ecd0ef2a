//! Descriptions of participating media.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::field::Bounds;
use crate::format::{
    Asymmetry, Coefficient, Color, Fraction, NonNegative, Octaves, PerChannel, Positive, Radiometric, Real, Resolution, Side, Transform,
};
use crate::medium::subsurface::Measured;
use crate::reader::{by_kind, by_type};

/// A participating medium: it absorbs, scatters or emits light in the space between surfaces.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Medium {
    Homogeneous(Homogeneous),
    Heterogeneous(Box<Heterogeneous>),
    Subsurface(Subsurface),
}

by_type!(Medium { Homogeneous(Homogeneous), Heterogeneous(Box<Heterogeneous>), Subsurface(Subsurface) });

impl Medium {
    /// How the density varies, if it does.
    pub fn density(&self) -> Option<&Density> {
        match self {
            Medium::Homogeneous(_) | Medium::Subsurface(_) => None,
            Medium::Heterogeneous(medium) => Some(&medium.density),
        }
    }

    /// The grids of the box of the density, by their keys.
    pub fn color_grids(&self) -> impl Iterator<Item = (&'static str, &ColorGrid)> {
        let [albedo, emission] = match self {
            Medium::Homogeneous(_) | Medium::Subsurface(_) => [None, None],
            Medium::Heterogeneous(medium) => [medium.albedo_grid.as_ref(), medium.emission_grid.as_ref()],
        };
        [("albedo_grid", albedo), ("emission_grid", emission)].into_iter().filter_map(|(key, grid)| Some((key, grid?)))
    }
}

/// A medium that is the same everywhere. A ray of light keeps the share exp(−(absorption + scattering) · length) of its radiance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Homogeneous {
    /// The absorption coefficient σa, per metre: the share of light absorbed on a short length, divided by that length.
    #[serde(default = "none")]
    pub absorption: Color<Coefficient>,
    /// The scattering coefficient σs, per metre: the share of light scattered on a short length, divided by that length.
    #[serde(default = "none")]
    pub scattering: Color<Coefficient>,
    /// The radiance Le that the medium would have if it were opaque and did not scatter, in W·m⁻²·sr⁻¹. A short length emits the share
    /// σa of it per metre, so that a medium without absorption does not emit.
    #[serde(default = "dark")]
    pub emission: Color<Radiometric>,
    /// The directions of scattered light.
    #[serde(default)]
    pub phase: Phase,
    /// Where shapes with media overlap, the medium with the lowest priority number counts; of equal ones that of the smaller
    /// shape, by the volume of the box around it along its own axes.
    #[serde(default)]
    pub priority: i32,
}

/// A medium whose density varies from place to place. The coefficients are those where the density is 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Heterogeneous {
    /// The absorption coefficient σa, per metre: the share of light absorbed on a short length, divided by that length.
    #[serde(default = "none")]
    pub absorption: Color<Coefficient>,
    /// The scattering coefficient σs, per metre: the share of light scattered on a short length, divided by that length.
    #[serde(default = "none")]
    pub scattering: Color<Coefficient>,
    /// The radiance Le that the medium would have if it were opaque and did not scatter, in W·m⁻²·sr⁻¹.
    #[serde(default = "dark")]
    pub emission: Color<Radiometric>,
    /// The directions of scattered light.
    #[serde(default)]
    pub phase: Phase,
    /// Where shapes with media overlap, the medium with the lowest priority number counts; of equal ones that of the smaller
    /// shape, by the volume of the box around it along its own axes.
    #[serde(default)]
    pub priority: i32,
    /// The factor of the coefficients at each point.
    pub density: Density,
    /// The factor of the albedo σs/(σa + σs) at each point of the density's box, from 0 to 1. What is scattered less is absorbed. In a
    /// medium without absorption it is the albedo itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub albedo_grid: Option<ColorGrid>,
    /// The factor of the emission at each point of the density's box.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emission_grid: Option<ColorGrid>,
}

/// A translucent body: skin, marble, wax, milk. It is the same everywhere, and its coefficients follow from what one sees of it, or are
/// measured ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Subsurface {
    /// A measured material instead of `albedo` and `mean_free_path`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<Measured>,
    /// The diffuse reflectance (multiple-scattering albedo) of a very thick block, without reflection at its surface, in uniform light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub albedo: Option<Color<Fraction>>,
    /// The mean length that light goes before it is absorbed or scattered, in metres: 1/(σa + σs).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_free_path: Option<PerChannel<Positive>>,
    /// The anisotropy g, the mean cosine of the scattering angle. Only with `albedo`: measured materials scatter isotropically.
    #[serde(default = "even")]
    pub g: Asymmetry,
    /// A factor of all lengths in the body: 10 makes one of ten times the size look the same.
    #[serde(default = "all_lengths")]
    pub scale: Positive,
    /// Where shapes with media overlap, the medium with the lowest priority number counts; of equal ones that of the smaller
    /// shape, by the volume of the box around it along its own axes.
    #[serde(default)]
    pub priority: i32,
}

/// How dense a medium is at each point of the world.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Density {
    Grid(GridDensity),
    Noise(NoiseDensity),
    Exponential(ExponentialDensity),
}

by_type!(Density { Grid(GridDensity), Noise(NoiseDensity), Exponential(ExponentialDensity) });

impl Density {
    /// The file that it is read from.
    pub fn file(&self) -> Option<&str> {
        match self {
            Density::Grid(grid) => grid.file.as_deref(),
            Density::Noise(_) | Density::Exponential(_) => None,
        }
    }

    /// The box outside of which the density is 0, if the scene says it.
    pub fn bounds(&self) -> Option<&Bounds> {
        match self {
            Density::Grid(grid) => grid.bounds.as_ref(),
            Density::Noise(noise) => noise.bounds.as_ref(),
            Density::Exponential(air) => air.bounds.as_ref(),
        }
    }

    /// The steps that place the box in the world.
    pub fn transform(&self) -> &Transform {
        match self {
            Density::Grid(grid) => &grid.transform,
            Density::Noise(noise) => &noise.transform,
            Density::Exponential(air) => &air.transform,
        }
    }
}

/// Numbers on a grid in a box, linear between them along each axis. Outside of the box the density is 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GridDensity {
    /// A file with the numbers, relative to the scene file's folder: a `.vdb` file of OpenVDB with a fog volume, a `.vol` file of Mitsuba
    /// with one channel of 32-bit floats, a `.pbrt` file with one medium of type "uniformgrid", or else 32-bit floats, little-endian, x
    /// fastest, whose `size` is given here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The name of the grid in an OpenVDB file. Default: "density", or the only one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<String>,
    /// The number of values along x, y and z, for `values` and for files that do not tell it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<[Side; 3]>,
    /// The numbers themselves instead of a file: x varies fastest, then y, then z.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub values: Option<Vec<Coefficient>>,
    /// Where in the box the values are.
    #[serde(default)]
    pub values_at: ValuesAt,
    /// The box, before the transform. Default: that of the file, or else from (0, 0, 0) to (1, 1, 1).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<Bounds>,
    /// The steps that place the box in the world, the first acting first. Shapes around it do not move it. In a group, instances
    /// place it in the world.
    #[serde(default)]
    pub transform: Transform,
}

/// Colours on a grid in the box of a density, linear between them along each axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ColorGrid {
    /// A file with the values, relative to the scene file's folder: a `.vdb` file of OpenVDB with one or three channels; a `.vol` file of
    /// Mitsuba with one or three channels of 32-bit floats; for an emission, a `.pbrt` file with one medium of type "uniformgrid" and its
    /// "Lescale"; or else 32-bit floats, little-endian, x fastest, one or three for each value, whose `size` is given here. Three are linear
    /// red, green and blue.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The name of the grid in an OpenVDB file. Default: the only one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<String>,
    /// The number of values along x, y and z, for `values` and for files that do not tell it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<[Side; 3]>,
    /// The values themselves instead of a file: x varies fastest, then y, then z.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub values: Option<Vec<Color<Coefficient>>>,
    /// Where in the box the values are.
    #[serde(default)]
    pub values_at: ValuesAt,
}

/// A cloud: noise in a box, thinner away from its middle.
///
/// The density is offset + amplitude · fbm(p / size) − falloff · r², limited to 0 to 1, where fbm is a sum of octaves of gradient noise and r
/// the distance from the middle of the box, which is 1 at the middle of each side. It is computed on a grid once, and is linear between
/// the values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NoiseDensity {
    /// The size of the largest lumps, in metres before the transform.
    #[serde(default = "quarter")]
    pub size: Positive,
    /// The number of octaves. Each has half the size and half the strength of the one before.
    #[serde(default = "five")]
    pub octaves: Octaves,
    /// The strength of the noise, which lies between about −1 and 1.
    #[serde(default = "one")]
    pub amplitude: NonNegative,
    /// The density in the middle without noise.
    #[serde(default = "half")]
    pub offset: Real,
    /// How much the density without noise falls from the middle of the box to the middle of its sides.
    #[serde(default = "one")]
    pub falloff: NonNegative,
    /// The number of values along the longest side of the box.
    #[serde(default = "fine")]
    pub resolution: Resolution,
    /// The box, before the transform. Default: from (0, 0, 0) to (1, 1, 1).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<Bounds>,
    /// The steps that place the box in the world, the first acting first. Shapes around it do not move it. In a group, instances
    /// place it in the world.
    #[serde(default)]
    pub transform: Transform,
}

/// Fog near the ground, or air: the density is 1 at the bottom of a box, and e^(−height / scale_height) above it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExponentialDensity {
    /// The height over which the density falls to 1/e, in metres before the transform. Up is +y.
    pub scale_height: Positive,
    /// The box, before the transform; outside of it the density is 0. Default: from (0, 0, 0) to (1, 1, 1).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<Bounds>,
    /// The steps that place the box in the world, the first acting first. Shapes around it do not move it. In a group, instances
    /// place it in the world.
    #[serde(default)]
    pub transform: Transform,
}

/// Where in a box the values of a grid are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ValuesAt {
    /// In the centres of equal cells, as in files of Mitsuba and pbrt. From the outermost ones to the sides of the box the density is constant.
    #[default]
    Centers,
    /// In the corners of equal cells: the outermost values lie on the sides of the box.
    Corners,
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

/// A phase function that scatters light equally into all directions.
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

fn even() -> Asymmetry {
    Asymmetry::known(0.0)
}

fn all_lengths() -> Positive {
    Positive::known(1.0)
}

fn one() -> NonNegative {
    NonNegative::known(1.0)
}

fn half() -> Real {
    Real::known(0.5)
}

fn quarter() -> Positive {
    Positive::known(0.25)
}

fn five() -> Octaves {
    Octaves::known(5)
}

fn fine() -> Resolution {
    Resolution::known(128)
}

fn none() -> Color<Coefficient> {
    Color::Gray(Coefficient::known(0.0))
}

fn dark() -> Color<Radiometric> {
    Color::Gray(Radiometric::known(0.0))
}
