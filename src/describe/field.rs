//! Descriptions of signed distance fields, which define solids.

use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::MaterialRef;
use super::emission::Emission;
use crate::format::{Direction, NonNegative, Point, Positive, Transform};
use crate::reader::by_type;

/// A signed distance field, in metres and negative inside: a primitive, or an operation on fields.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Field {
    Sphere(BallField),
    Box(BoxField),
    ChebyshevBox(ChebyshevBoxField),
    Segment(SegmentField),
    Torus(TorusField),
    HalfRing(HalfRingField),
    Plane(PlaneField),
    Union(UnionField),
    Intersection(IntersectionField),
    Difference(DifferenceField),
    Complement(ComplementField),
    SmoothUnion(SmoothUnionField),
    Place(PlaceField),
    Mirror(MirrorField),
    Repeat(RepeatField),
    Extrude(ExtrudeField),
}

by_type!(Field {
    Sphere(BallField),
    Box(BoxField),
    ChebyshevBox(ChebyshevBoxField),
    Segment(SegmentField),
    Torus(TorusField),
    HalfRing(HalfRingField),
    Plane(PlaneField),
    Union(UnionField),
    Intersection(IntersectionField),
    Difference(DifferenceField),
    Complement(ComplementField),
    SmoothUnion(SmoothUnionField),
    Place(PlaceField),
    Mirror(MirrorField),
    Repeat(RepeatField),
    Extrude(ExtrudeField),
});

/// A ball.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BallField {
    /// The radius, in metres.
    pub radius: Positive,
    /// The centre, in metres.
    #[serde(default = "origin")]
    pub center: Point,
}

/// A box, with sharp or rounded edges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxField {
    /// One corner, in metres.
    pub low: Point,
    /// The corner opposite to `low`, in metres; its coordinates are larger.
    pub high: Point,
    /// Radius of edges and corners, in metres; half the shortest side at most. The box keeps its size.
    #[serde(default = "nothing")]
    pub rounding: NonNegative,
}

/// A box with the largest of the distances to its six planes as its distance. It suits rooms that are carved out. Beyond edges and
/// corners that distance is less than the true one, so that rays approach in smaller steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChebyshevBoxField {
    /// One corner, in metres.
    pub low: Point,
    /// The corner opposite to `low`, in metres; its coordinates are larger.
    pub high: Point,
}

/// A capsule: all points within `radius` of a line segment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SegmentField {
    /// One end of the segment, in metres.
    pub from: Point,
    /// The other end of the segment, in metres.
    pub to: Point,
    /// The radius, in metres; 0 only within an `extrude`.
    #[serde(default = "nothing")]
    pub radius: NonNegative,
}

/// A torus about the z axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorusField {
    /// The radius of the circle at the centre of the tube, in metres.
    pub radius: Positive,
    /// The radius of the tube, in metres; 0 only within an `extrude`.
    #[serde(default = "nothing")]
    pub tube: NonNegative,
    /// The centre, in metres.
    #[serde(default = "origin")]
    pub center: Point,
}

/// The half of a torus at larger x than its centre, with round ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HalfRingField {
    /// The radius of the circle at the centre of the tube, in metres.
    pub radius: Positive,
    /// The radius of the tube, in metres; 0 only within an `extrude`.
    #[serde(default = "nothing")]
    pub tube: NonNegative,
    /// The centre, in metres.
    #[serde(default = "origin")]
    pub center: Point,
}

/// The half space behind a plane. It is unbounded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneField {
    /// A point of the plane, in metres.
    #[serde(default = "origin")]
    pub point: Point,
    /// The normal of the plane, which points out of the solid.
    pub normal: Direction,
}

/// The union of several fields.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UnionField {
    /// The fields; at least one.
    pub of: Vec<Field>,
}

/// The intersection of several fields.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IntersectionField {
    /// The fields; at least one.
    pub of: Vec<Field>,
}

/// A field with others carved out of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DifferenceField {
    /// The field that others are carved out of.
    pub from: Box<Field>,
    /// The fields that are carved out; at least one.
    pub minus: Vec<Field>,
}

/// The complement of a field: inside becomes outside. A room is the complement of a box. It is unbounded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ComplementField {
    /// The field.
    pub of: Box<Field>,
}

/// A union that rounds the creases between its fields.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SmoothUnionField {
    /// The fields, at least one. They are joined one after the other.
    pub of: Vec<Field>,
    /// The width of the blend, in metres: the surfaces are blended where two distances differ by less than this.
    pub width: Positive,
}

/// A transformed field. Non-uniform scaling makes the distance smaller than the true one, so that rays need more steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceField {
    /// The field that is transformed.
    pub of: Box<Field>,
    /// Steps applied in listed order.
    pub transform: Transform,
}

/// The part of a field at positive coordinates along an axis, and its mirror image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MirrorField {
    /// The field that is mirrored.
    pub of: Box<Field>,
    /// The axis perpendicular to the mirror plane, which contains the origin.
    pub axis: Axis,
}

/// Copies of a field in a row, one every `period`. Without `first` and `last` the row is unbounded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RepeatField {
    /// The field that is copied. Along the axis it must be no longer than the period.
    pub of: Box<Field>,
    /// The direction of the row.
    pub axis: Axis,
    /// The distance between copies, in metres.
    pub period: Positive,
    /// The number of the first copy; copy k is moved by k periods. Default: the row has no first copy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<i32>,
    /// The number of the last copy. Default: the row has no last copy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<i32>,
}

/// A bar along the section of a field with the plane z = 0: all within `half_thickness` of that section, with edges rounded by a power.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExtrudeField {
    /// The field with the section at z = 0. Lines without thickness make bars.
    pub of: Box<Field>,
    /// Half the thickness of the bar, in metres.
    pub half_thickness: Positive,
    /// The roundness of the edges: 2 rounds them to half circles, larger powers make them sharper.
    #[serde(default)]
    pub power: Power,
}

/// A coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Axis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    Z,
}

/// A power of two as an exponent: 2, 4, 8, 16, 32 or 64.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline)]
pub struct Power(#[schemars(extend("enum" = [2, 4, 8, 16, 32, 64]))] u32);

impl Power {
    /// The logarithm to base 2, from 1 to 6.
    pub fn log2(self) -> u32 {
        self.0.ilog2()
    }
}

impl Default for Power {
    fn default() -> Power {
        Power(8)
    }
}

impl<'de> Deserialize<'de> for Power {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Power, D::Error> {
        let number = i128::deserialize(d)?;
        let known = u32::try_from(number).ok().filter(|power| power.is_power_of_two() && (2..=64).contains(power));
        known.map(Power).ok_or_else(|| D::Error::custom(format!("expected 2, 4, 8, 16, 32 or 64, found {number}")))
    }
}

/// One of several adjacent solids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SdfPart {
    /// The solid.
    pub field: Field,
    /// How the part reflects and transmits light. Default: the shape's material.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialRef>,
    /// The light that the part emits. Default: the shape's emission.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<Emission>,
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// One corner, in metres: in the shape's own space, or before the transform of a density.
    pub low: Point,
    /// The corner opposite to `low`, in metres; its coordinates are larger.
    pub high: Point,
}

/// Sphere tracing that stops at a given distance before the surface.
///
/// The visible surface then depends on these numbers: the solid is thicker by `stop`, and rays that leave it start that much
/// farther away. Transmissive materials do not work with it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FixedMarch {
    /// The distance below which a ray has hit the surface, in metres.
    pub stop: Positive,
    /// The number of steps after which a ray counts as having hit the surface.
    pub most_steps: u32,
    /// The length of a ray after which it hits nothing, in metres.
    pub reach: Positive,
    /// The length of the forward differences that give the normal, in metres.
    pub normal_step: Positive,
}

fn origin() -> Point {
    Point([0.0; 3])
}

fn nothing() -> NonNegative {
    NonNegative::known(0.0)
}

impl Sides for BoxField {
    fn corners(&self) -> [&Point; 2] {
        [&self.low, &self.high]
    }
}

impl Sides for ChebyshevBoxField {
    fn corners(&self) -> [&Point; 2] {
        [&self.low, &self.high]
    }
}

impl Sides for Bounds {
    fn corners(&self) -> [&Point; 2] {
        [&self.low, &self.high]
    }
}

/// A box with a low and a high corner.
pub(super) trait Sides {
    /// The low and the high corner.
    fn corners(&self) -> [&Point; 2];

    /// The lengths of the sides along x, y and z, in metres.
    fn sides(&self) -> [f64; 3] {
        let [low, high] = self.corners();
        std::array::from_fn(|axis| high.0[axis] - low.0[axis])
    }
}
