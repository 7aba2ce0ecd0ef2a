//! Lights that are not surfaces; surfaces shine by their `emission`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Color, ConeAngle, Direction, Point, Radiometric};
use crate::reader::by_type;

/// A light without a surface: rays never meet it by chance.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Light {
    Point(PointLight),
    Directional(DirectionalLight),
    Spot(SpotLight),
}

by_type!(Light { Point(PointLight), Directional(DirectionalLight), Spot(SpotLight) });

/// Shines equally in every direction from one point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointLight {
    /// What the light is called in messages and statistics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Metres.
    pub position: Point,
    /// Radiant intensity, in W·sr⁻¹.
    pub intensity: Color<Radiometric>,
}

/// Shines in one direction, from infinitely far: a sun without size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectionalLight {
    /// What the light is called in messages and statistics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The way the light travels.
    pub direction: Direction,
    /// Irradiance of a surface that faces the light, in W·m⁻².
    pub irradiance: Color<Radiometric>,
}

/// A point light that shines into a cone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpotLight {
    /// What the light is called in messages and statistics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Metres.
    pub position: Point,
    /// The axis of the cone: the way the light travels. Give this or `to`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<Direction>,
    /// A point on the axis of the cone, in metres. Give this or `direction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<Point>,
    /// Radiant intensity within the inner angle, in W·sr⁻¹.
    pub intensity: Color<Radiometric>,
    /// Angle between the axis and where the light begins to fall off, in degrees; at most `outer_angle`.
    #[serde(default = "inner")]
    pub inner_angle: ConeAngle,
    /// Angle between the axis and where no light is left, in degrees.
    #[serde(default = "outer")]
    pub outer_angle: ConeAngle,
    /// How the intensity falls off from the inner to the outer angle, where x runs from 1 to 0.
    #[serde(default)]
    pub falloff: Falloff,
}

/// How a spot's intensity falls off from its inner to its outer angle; x runs from 0 at the outer to 1 at the inner angle.
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
