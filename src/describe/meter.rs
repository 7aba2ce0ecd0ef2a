//! Descriptions of meters: places where light is measured.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Direction, DiskAngle, NonNegative, Point};
use crate::reader::by_type;

/// A place where light is measured by `pt meter`. Meters are no part of the picture.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Meter {
    /// The irradiance on one side of a plane, in W·m⁻²: at a point, or the mean over a disk.
    Irradiance(PlaneMeter),
    /// The illuminance on one side of a plane, in lux: at a point, or the mean over a disk. One watt of white light is 683 lumens.
    Illuminance(PlaneMeter),
    /// The radiance that arrives at a point from a direction, in W·m⁻²·sr⁻¹, or the mean over a disk of directions.
    Radiance(DirectionMeter),
    /// The luminance of what is seen from a point in a direction, in cd·m⁻², or the mean over a disk of directions. One watt of white light
    /// is 683 lumens.
    Luminance(DirectionMeter),
}

by_type!(Meter { Irradiance(PlaneMeter), Illuminance(PlaneMeter), Radiance(DirectionMeter), Luminance(DirectionMeter) });

impl Meter {
    /// The name of the meter, if it has one.
    pub fn name(&self) -> Option<&str> {
        match self {
            Meter::Irradiance(meter) | Meter::Illuminance(meter) => meter.name.as_deref(),
            Meter::Radiance(meter) | Meter::Luminance(meter) => meter.name.as_deref(),
        }
    }
}

/// A meter on one side of a plane.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneMeter {
    /// The name of the meter in messages and tables.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The point, or the centre of the disk, in metres. It may lie on a surface; the light then is that on the surface.
    pub position: Point,
    /// The direction that the meter faces. Light from the other side does not count.
    pub normal: Direction,
    /// The radius of the disk, in metres. 0 measures at the point.
    #[serde(default = "point", skip_serializing_if = "PlaneMeter::is_point")]
    pub radius: NonNegative,
}

/// A meter that looks in a direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectionMeter {
    /// The name of the meter in messages and tables.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The point where the light arrives, in metres.
    pub position: Point,
    /// The direction in which the meter looks, and from which the light comes.
    pub direction: Direction,
    /// The full angle of the disk of directions, in degrees. 0 measures in the one direction.
    #[serde(default, skip_serializing_if = "DirectionMeter::is_single")]
    pub angle: DiskAngle,
}

/// The radius of a meter that measures at a point.
fn point() -> NonNegative {
    NonNegative::known(0.0)
}

impl PlaneMeter {
    fn is_point(radius: &NonNegative) -> bool {
        radius.get() == 0.0
    }
}

impl DirectionMeter {
    fn is_single(angle: &DiskAngle) -> bool {
        angle.get() == 0.0
    }
}
