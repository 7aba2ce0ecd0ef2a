//! Descriptions of lights without a surface. (Shapes emit light by their `emission`.)

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Color, ConeAngle, Direction, DiskAngle, Point, Radiometric};
use crate::math::float::sin_cos_degrees;
use crate::reader::by_type;

/// A light without a surface: no ray can hit it.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Light {
    Point(PointLight),
    Directional(DirectionalLight),
    Spot(SpotLight),
}

by_type!(Light { Point(PointLight), Directional(DirectionalLight), Spot(SpotLight) });

/// A point that emits equally in every direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointLight {
    /// The name of the light in messages and statistics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The position, in metres.
    pub position: Point,
    /// Radiant intensity, in W·sr⁻¹.
    pub intensity: Color<Radiometric>,
}

/// Light from one direction at infinite distance, such as sunlight.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectionalLight {
    /// The name of the light in messages and statistics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The direction in which the light travels.
    pub direction: Direction,
    /// Irradiance on a surface perpendicular to the light, in W·m⁻².
    pub irradiance: Color<Radiometric>,
    /// The full angle of the disk that the light comes from, in degrees; the sun's is 0.533. A disk makes soft shadows, and the camera and
    /// mirrors see it. 0 is a light without size: sharp shadows, and nothing to be seen.
    #[serde(default, skip_serializing_if = "DirectionalLight::is_parallel")]
    pub angle: DiskAngle,
}

impl DirectionalLight {
    fn is_parallel(angle: &DiskAngle) -> bool {
        angle.get() == 0.0
    }

    /// Radiance of the disk, in W·m⁻²·sr⁻¹, that makes the irradiance; `None` for a light without size.
    pub(super) fn radiance(&self) -> Option<[f64; 3]> {
        let sin = sin_cos_degrees(self.angle.get() / 2.0).0;
        (self.angle.get() > 0.0).then(|| self.irradiance.linear().map(|irradiance| irradiance / (std::f64::consts::PI * sin * sin)))
    }
}

/// A point that emits into a cone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpotLight {
    /// The name of the light in messages and statistics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The position, in metres.
    pub position: Point,
    /// The axis of the cone, in the direction in which the light travels. Give this or `to`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<Direction>,
    /// A point on the axis of the cone, in metres. Give this or `direction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<Point>,
    /// Radiant intensity within the inner angle, in W·sr⁻¹.
    pub intensity: Color<Radiometric>,
    /// Angle from the axis at which the light begins to fall off, in degrees; at most `outer_angle`.
    #[serde(default = "inner")]
    pub inner_angle: ConeAngle,
    /// Angle from the axis at which no light is left, in degrees.
    #[serde(default = "outer")]
    pub outer_angle: ConeAngle,
    /// How the intensity falls off from the inner to the outer angle.
    #[serde(default)]
    pub falloff: Falloff,
}

/// The falloff of a spot's intensity between its angles, where x runs from 0 at the outer to 1 at the inner angle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Falloff {
    /// 3x² − 2x³ with x linear in the cosine of the angle.
    #[default]
    Smooth,
    /// x, linear in the angle.
    Linear,
    /// x² with x linear in the cosine of the angle.
    Squared,
}

fn inner() -> ConeAngle {
    ConeAngle::known(25.0)
}

fn outer() -> ConeAngle {
    ConeAngle::known(30.0)
}
