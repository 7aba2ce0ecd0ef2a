//! Descriptions of lights without a surface. (Shapes emit light by their `emission`.)

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Color, ConeAngle, Direction, DiskAngle, Encoding, HalfAngle, Point, Radiometric, Transform};
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

impl Light {
    /// The transform, without the light's own position and directions.
    pub fn transform(&self) -> &Transform {
        match self {
            Light::Point(l) => &l.transform,
            Light::Directional(l) => &l.transform,
            Light::Spot(l) => &l.transform,
        }
    }

    /// The name, where one is given.
    pub fn name(&self) -> Option<&str> {
        match self {
            Light::Point(l) => l.name.as_deref(),
            Light::Directional(l) => l.name.as_deref(),
            Light::Spot(l) => l.name.as_deref(),
        }
    }
}

/// A point that emits equally in every direction, or as a lamp was measured to do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointLight {
    /// The name of the light in messages and statistics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Places the light, after its own position and directions, and may move it. It must keep lengths: translate, rotate, look at.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
    /// The position, in metres.
    pub position: Point,
    /// Radiant intensity, in W·sr⁻¹; with `profile` that in the direction where it is greatest.
    pub intensity: Color<Radiometric>,
    /// An IES file with the measured intensity of a lamp for each direction: the path, relative to the scene file's folder. Only ratios
    /// of its values count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The direction of the profile's vertical angle 0. Default: straight down, −y. Only with `profile`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<Direction>,
    /// The direction of the profile's horizontal angle 0, made perpendicular to `direction`. Default: +x, or +z where `direction` is
    /// along x. Only with `profile`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub across: Option<Direction>,
}

/// Light from one direction at infinite distance, such as sunlight.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectionalLight {
    /// The name of the light in messages and statistics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Places the light, after its own direction, and may move it. It must keep lengths: translate, rotate, look at. Not with an `angle`.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
    /// The direction in which the light travels.
    pub direction: Direction,
    /// Irradiance on a surface perpendicular to the light, in W·m⁻².
    pub irradiance: Color<Radiometric>,
    /// The full angle of the disk that the light comes from, in degrees; the sun's is 0.533. A disk makes soft shadows, and the camera and
    /// mirrors see it. 0 is a light without size: sharp shadows, and nothing to be seen.
    #[serde(default, skip_serializing_if = "DirectionalLight::is_parallel")]
    pub angle: DiskAngle,
}

/// Cosine above which a default direction is too close to an axis.
const NEARLY_ALONG: f64 = 0.999;

impl PointLight {
    /// The axis of the profile and the direction of its horizontal angle 0, not yet perpendicular, with their defaults (unit).
    pub(crate) fn axes(&self) -> [DVec3; 2] {
        let unit = |direction: Option<Direction>, default: DVec3| direction.map_or(default, |d| DVec3::from(d.0).normalize());
        let axis = unit(self.direction, DVec3::NEG_Y);
        [axis, unit(self.across, if axis.x.abs() < NEARLY_ALONG { DVec3::X } else { DVec3::Z })]
    }
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
    /// Places the light, after its own position and directions, and may move it. It must keep lengths: translate, rotate, look at.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
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
    /// A picture that the light projects, as a slide: the path, relative to the scene file's folder. It multiplies the intensity; beside it
    /// there is no light.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image: Option<String>,
    /// How colours are encoded in the picture. Only with `image`.
    #[serde(default, skip_serializing_if = "Encoding::is_auto")]
    pub encoding: Encoding,
    /// Half the angle under which the light sees the width of its picture, in degrees. Default: `outer_angle`. Only with `image`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image_angle: Option<HalfAngle>,
    /// The direction towards the upper edge of the picture. Default: +y, or −z where the axis is along y. Only with `image`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<Direction>,
}

impl SpotLight {
    /// The unit axis of the cone; `None` if it points at itself, or nowhere.
    pub(crate) fn axis(&self) -> Option<DVec3> {
        let towards = self.to.map(|to| DVec3::from(to.0) - DVec3::from(self.position.0));
        self.direction.map(|d| DVec3::from(d.0)).or(towards)?.try_normalize()
    }

    /// The direction that is up in the picture, or its default.
    pub(crate) fn image_up(&self) -> DVec3 {
        let is_upright = self.axis().unwrap_or(DVec3::NEG_Z).y.abs() < NEARLY_ALONG;
        self.up.map_or(if is_upright { DVec3::Y } else { DVec3::NEG_Z }, |up| DVec3::from(up.0))
    }
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
