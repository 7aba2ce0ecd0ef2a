//! Descriptions of meters: places where light is measured.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Direction, DiskAngle, NonNegative, Point};
use crate::reader::by_type;

/// A place where light is measured by `pt meter`. Meters are no part of the picture.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Meter {
    Irradiance(IrradianceMeter),
    Radiance(RadianceMeter),
}

by_type!(Meter { Irradiance(IrradianceMeter), Radiance(RadianceMeter) });

impl Meter {
    /// The name of the meter, if it has one.
    pub fn name(&self) -> Option<&str> {
        match self {
            Meter::Irradiance(meter) => meter.name.as_deref(),
            Meter::Radiance(meter) => meter.name.as_deref(),
        }
    }
}

/// The irradiance on one side of a plane, in W·m⁻²: at a point, or the mean over a disk.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IrradianceMeter {
    /// The name of the meter in messages and tables.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The point, or the centre of the disk, in metres. It may lie on a surface; the light then is that on the surface.
    pub position: Point,
    /// The direction that the meter faces. Light from the other side does not count.
    pub normal: Direction,
    /// The radius of the disk, in metres. 0 measures at the point.
    #[serde(default = "point", skip_serializing_if = "IrradianceMeter::is_point")]
    pub radius: NonNegative,
}

/// The radiance that arrives at a point from a direction, in W·m⁻²·sr⁻¹, or the mean over a disk of directions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RadianceMeter {
    /// The name of the meter in messages and tables.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The point where the light arrives, in metres.
    pub position: Point,
    /// The direction in which the meter looks, and from which the light comes.
    pub direction: Direction,
    /// The full angle of the disk of directions, in degrees. 0 measures in the one direction.
    #[serde(default, skip_serializing_if = "RadianceMeter::is_single")]
    pub angle: DiskAngle,
}

/// The radius of a meter that measures at a point.
fn point() -> NonNegative {
    NonNegative::known(0.0)
}

impl IrradianceMeter {
    fn is_point(radius: &NonNegative) -> bool {
        radius.get() == 0.0
    }
}

impl RadianceMeter {
    fn is_single(angle: &DiskAngle) -> bool {
        angle.get() == 0.0
    }
}
