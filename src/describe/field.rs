//! Distance fields: what solids are made of.

use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::MaterialRef;
use super::shape::Emission;
use crate::format::{Direction, NonNegative, Point, Positive, Transform};
use crate::reader::by_type;

/// A distance field: a primitive, or an operation on fields. Metres; negative inside.
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
    /// Metres.
    pub radius: Positive,
    /// Metres.
    #[serde(default = "origin")]
    pub center: Point,
}

/// A box, with sharp or rounded edges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxField {
    /// One corner.
    pub low: Point,
    /// The opposite corner; its coordinates are larger.
    pub high: Point,
    /// Radius of edges and corners, in metres; half the shortest side at most. The box keeps its size.
    #[serde(default = "nothing")]
    pub rounding: NonNegative,
}

/// A box whose distance is the largest of those from its six planes: for carving rooms. Beyond edges and corners it is less
/// than the box's own, so that rays come nearer in smaller steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChebyshevBoxField {
    /// One corner.
    pub low: Point,
    /// The opposite corner; its coordinates are larger.
    pub high: Point,
}

/// What lies within `radius` of a segment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SegmentField {
    /// One end.
    pub from: Point,
    /// The other end.
    pub to: Point,
    /// Metres; 0 only within an `extrude`.
    #[serde(default = "nothing")]
    pub radius: NonNegative,
}

/// A ring about the z axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorusField {
    /// Of the circle, in metres.
    pub radius: Positive,
    /// About the circle, in metres; 0 only within an `extrude`.
    #[serde(default = "nothing")]
    pub tube: NonNegative,
    /// Metres.
    #[serde(default = "origin")]
    pub center: Point,
}

/// The half of a ring that lies at larger x than its centre, with round ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HalfRingField {
    /// Of the circle, in metres.
    pub radius: Positive,
    /// About the circle, in metres; 0 only within an `extrude`.
    #[serde(default = "nothing")]
    pub tube: NonNegative,
    /// Metres.
    #[serde(default = "origin")]
    pub center: Point,
}

/// All that lies behind a plane. It has no end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneField {
    /// A point of the plane.
    #[serde(default = "origin")]
    pub point: Point,
    /// Out of the solid.
    pub normal: Direction,
}

/// All of several fields.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UnionField {
    /// At least one.
    pub of: Vec<Field>,
}

/// What several fields share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IntersectionField {
    /// At least one.
    pub of: Vec<Field>,
}

/// What is left of a field when others are carved out of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DifferenceField {
    /// What is carved.
    pub from: Box<Field>,
    /// What is carved out; at least one.
    pub minus: Vec<Field>,
}

/// All that a field is not: rooms are the complement of boxes. It has no end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ComplementField {
    /// What is left out.
    pub of: Box<Field>,
}

/// A union that fills the creases between its fields.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SmoothUnionField {
    /// At least one; joined one after the other.
    pub of: Vec<Field>,
    /// Metres: where two distances differ by less, the surfaces flow into each other.
    pub width: Positive,
}

/// A field moved, turned, stretched. Uneven stretching makes its distance smaller than it is, and rays slower.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceField {
    /// What is placed.
    pub of: Box<Field>,
    /// Steps applied in listed order.
    pub transform: Transform,
}

/// What of a field lies at positive coordinates, and its mirror image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MirrorField {
    /// What is mirrored.
    pub of: Box<Field>,
    /// The axis across the mirror, which goes through the origin.
    pub axis: Axis,
}

/// Copies of a field in a row, one every `period`. Without `first` and `last` it has no end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RepeatField {
    /// What is copied: along the axis no longer than the period.
    pub of: Box<Field>,
    /// The direction of the row.
    pub axis: Axis,
    /// Metres.
    pub period: Positive,
    /// The first copy, moved by so many periods. Default: no first one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<i32>,
    /// The last copy, moved by so many periods. Default: no last one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<i32>,
}

/// A bar along what a field shows in the plane z = 0: all within `half_thickness` of that section, its edges rounded by a power.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExtrudeField {
    /// Whose section at z = 0 it is; lines of no thickness make bars.
    pub of: Box<Field>,
    /// Metres.
    pub half_thickness: Positive,
    /// 2 rounds the edges to half circles, larger powers make them sharper.
    #[serde(default)]
    pub power: Power,
}

/// A coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Axis {
    X,
    Y,
    Z,
}

/// 2, 4, 8, 16, 32 or 64.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline)]
pub struct Power(#[schemars(extend("enum" = [2, 4, 8, 16, 32, 64]))] u32);

impl Power {
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

/// One of several solids that meet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SdfPart {
    /// The solid.
    pub field: Field,
    /// How it reflects and transmits. Default: as the shape says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialRef>,
    /// What it emits. Default: as the shape says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<Emission>,
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// One corner, in the shape's own space.
    pub low: Point,
    /// The opposite corner; its coordinates are larger.
    pub high: Point,
}

/// Steps of the whole distance that end before the surface.
///
/// What looks like the surface then depends on these numbers: it is thicker by `stop`, and rays that leave it start that much
/// farther off. Materials that let light through do not work with it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FixedMarch {
    /// What is nearer than this is hit, in metres.
    pub stop: Positive,
    /// What has not been hit after so many steps counts as hit.
    pub most_steps: u32,
    /// How far a ray sees, in metres.
    pub reach: Positive,
    /// Normals are forward differences over this length, in metres.
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

/// What has a low and a high corner.
pub(super) trait Sides {
    fn corners(&self) -> [&Point; 2];

    fn sides(&self) -> [f64; 3] {
        let [low, high] = self.corners();
        std::array::from_fn(|axis| high.0[axis] - low.0[axis])
    }
}
