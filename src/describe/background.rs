//! Descriptions of the light from infinite distance, all around.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Altitude, Color, Elevation, Encoding, Fraction, Latitude, Longitude, Moment, Radiometric, Real, Transform, Turbidity};

/// Light from infinite distance, from all directions: give `radiance`, `image` or `sky`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Background {
    /// Radiance, in W·m⁻²·sr⁻¹, the same from every direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radiance: Option<Color<Radiometric>>,
    /// A picture of the surroundings (environment map): the path of a Radiance HDR, OpenEXR, PNG, JPEG or WebP file, relative to the
    /// scene file's folder. Its values times `scale` are radiances, in W·m⁻²·sr⁻¹. The file must lie in that folder (see
    /// `--allow-outside`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image: Option<String>,
    /// The sky by day, computed from the scattering of sunlight in clear air.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sky: Option<Sky>,
    /// How the picture shows the directions. Only with `image`.
    #[serde(default, skip_serializing_if = "Mapping::is_default")]
    pub mapping: Mapping,
    /// How colours are encoded in the picture. Only with `image`.
    #[serde(default, skip_serializing_if = "Encoding::is_auto")]
    pub encoding: Encoding,
    /// A factor for the picture, or one for each of red, green and blue. Default: 1. Only with `image`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<Color<Radiometric>>,
    /// Turns the picture or the sky in the world: rotations, and scaling by −1 to mirror it. Only with `image` or `sky`.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

/// The sky by day and the sun, over a flat ground, with +y up. Clouds, refraction and stars are left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sky {
    /// Elevation of the sun above the horizon, in degrees. As its disk sets, between 0.27 and −0.27, it is shown
    /// whole and dimmed by the part that has set; then the sky darkens, until −18. Default: 40, or as `place` says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elevation: Option<Elevation>,
    /// Azimuth of the sun, in degrees: 0 is −z, 90 is +x, 180 is +z. Default: 120, or as `place` says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<Real>,
    /// Where and when the sun is seen, in place of `elevation` and `azimuth`. North is −z, east is +x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<Place>,
    /// Irradiance of the sun on a surface that faces it above the atmosphere, in W·m⁻². All radiances of the sky are proportional to it. With
    /// the default, π, a white surface that faces the sun there has a radiance of 1.
    pub irradiance: Color<Radiometric>,
    /// How hazy the air is: the ratio of the extinction by air and aerosols to that by air alone, for green light. 1 is air without aerosols,
    /// 2 a clear day, 5 a hazy one.
    pub turbidity: Turbidity,
    /// The share of light that the ground reflects.
    pub ground: Color<Fraction>,
    /// The height of the observer above the ground, in metres. The ground is lit as the place below the observer is.
    pub altitude: Altitude,
    /// Whether the sun's disk, 0.533° wide, is part of the scene. Without it there is the light of the sky alone, and that of the ground
    /// below the horizon, which the sun still shines on.
    pub sun: bool,
}

impl Default for Sky {
    /// A clear day, with the sun to the right of a camera that looks down −z, and a little behind it.
    fn default() -> Sky {
        Sky {
            elevation: None,
            azimuth: None,
            place: None,
            irradiance: Color::Gray(Radiometric::known(std::f64::consts::PI)),
            turbidity: Turbidity::known(2.0),
            ground: Color::Gray(Fraction::known(0.3)),
            altitude: Altitude::known(2.0),
            sun: true,
        }
    }
}

/// A place on the earth and a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// Latitude, in degrees; north is positive.
    pub latitude: Latitude,
    /// Longitude, in degrees; east is positive.
    pub longitude: Longitude,
    /// Date and time with their distance from UTC: `2026-06-21T18:30+02:00`, or with `Z` for UTC. The position of the sun is good to 0.01°
    /// from 1900 to 2100.
    pub time: Moment,
}

/// How a picture shows the directions around the scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Mapping {
    /// Longitude runs across the picture, with −z in the middle and +x to its right; latitude runs from +y at the top to −y at the
    /// bottom. Panoramas of the `spherical` camera are of this kind.
    #[default]
    LatLong,
    /// pbrt's equal-area octahedral map, a square: +y in the middle, −y in the corners, −z at the middle of the lower side, +x at the middle
    /// of the right side.
    Octahedral,
}

impl Mapping {
    fn is_default(&self) -> bool {
        *self == Mapping::default()
    }
}

impl Background {
    /// What is wrong with the keys together, with the key that each message is about.
    pub(super) fn faults(&self) -> Vec<(&'static str, &'static str)> {
        let of_image =
            [("/mapping", !self.mapping.is_default()), ("/encoding", !self.encoding.is_auto()), ("/scale", self.scale.is_some())];
        let given = [("radiance", self.radiance.is_some()), ("image", self.image.is_some()), ("sky", self.sky.is_some())];
        let given: Vec<&str> = given.into_iter().filter(|(_, is_given)| *is_given).map(|(key, _)| key).collect();
        let stands_twice = self.sky.as_ref().is_some_and(|sky| sky.place.is_some() && (sky.elevation.is_some() || sky.azimuth.is_some()));
        match given[..] {
            ["sky"] if stands_twice => vec![("/sky/place", "give \"place\", or \"elevation\" and \"azimuth\"")],
            [] => vec![("", "expected \"radiance\", \"image\" (a picture of the surroundings) or \"sky\"")],
            ["image"] => vec![],
            [other] => {
                let unused = of_image.into_iter().filter(|(_, is_given)| *is_given);
                let turned = (other == "radiance" && !self.transform.is_identity())
                    .then_some(("/transform", "only a background with an \"image\" or a \"sky\" has this"));
                unused.map(|(key, _)| (key, "only a background with an \"image\" has this")).chain(turned).collect()
            }
            _ => vec![("", "give one of radiance, image and sky")],
        }
    }
}
