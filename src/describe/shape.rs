//! Descriptions of shapes.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::MaterialRef;
use super::displacement::Displacement;
use super::emission::Emission;
use super::field::{Bounds, Field, FixedMarch, SdfPart};
use super::medium::MediumRef;
use super::mesh_keyframe::MeshKeyframe;
use crate::format::{Color, Fraction, NonNegative, Point, Positive, Real, Size, SubdivisionLevels, Transform, Turn, Vector};
use crate::reader::{by_kind, by_type};

/// A shape: a visible object of the scene.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Shape {
    Mesh(Mesh),
    Sphere(Sphere),
    Quad(Quad),
    Disk(Disk),
    Cylinder(Cylinder),
    Cone(Cone),
    BilinearPatch(BilinearPatch),
    Curves(Curves),
    Box(Cuboid),
    Sdf(Sdf),
    Group(Group),
    Instances(Instances),
}

by_type!(Shape {
    Mesh(Mesh), Sphere(Sphere), Quad(Quad), Disk(Disk), Cylinder(Cylinder), Cone(Cone), BilinearPatch(BilinearPatch), Curves(Curves), Box(Cuboid),
    Sdf(Sdf), Group(Group), Instances(Instances)
});

/// Defines a struct with the keys that all shapes except groups and instances have in common, and `closed` ones the medium inside. (serde's
/// `flatten` would lose positions in the file.)
macro_rules! surface {
    (closed $(#[$meta:meta])* pub struct $name:ident { $($own:tt)* }) => {
        surface! {
            $(#[$meta])*
            pub struct $name {
                $($own)*
                /// The medium inside the shape, which must be closed: fog, smoke, milk, coloured water. A shape with a medium and without a
                /// material has no surface, see the material `interface`. Not in instances that move, and not together with
                /// holes.
                #[serde(default, skip_serializing_if = "Option::is_none")]
                pub medium: Option<MediumRef>,
            }
        }
    };
    ($(#[$meta:meta])* pub struct $name:ident { $($own:tt)* }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $($own)*
            /// The name of the shape in messages and statistics.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub name: Option<String>,
            /// How the shape reflects and transmits light. Default: diffuse with albedo 0.5.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub material: Option<MaterialRef>,
            /// The light that the shape emits. Default: none.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub emission: Option<Emission>,
            /// Places the shape in the world, or in its group. Steps are applied in listed order.
            #[serde(default, skip_serializing_if = "Transform::is_identity")]
            pub transform: Transform,
        }
    };
}

surface! {
    closed
    /// A triangle mesh, from a file or from `positions` and `triangles` given here.
    pub struct Mesh {
        /// The path of an .obj, .ply or .stl file, relative to the scene file's folder. The file must lie in that folder (see
        /// `--allow-outside`).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub file: Option<String>,
        /// The material for each material name in the mesh file (OBJ: `usemtl`). Faces with other names have `material`.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        pub materials: BTreeMap<String, MaterialRef>,
        /// The positions of the vertices, in metres.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub positions: Option<Vec<Point>>,
        /// The triangles: three indices of vertices each, from 0, counter-clockwise as seen from the front.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub triangles: Option<Vec<[u32; 3]>>,
        /// One shading normal for each vertex. Without them the mesh looks faceted.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub normals: Option<Vec<Vector>>,
        /// Texture coordinates for each vertex.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub uvs: Option<Vec<[Real; 2]>>,
        /// A colour for each vertex, components from 0 to 1, for materials with a texture `vertex_color`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub colors: Option<Vec<Color<Fraction>>>,
        /// Softens the shadow terminator of coarse meshes with `normals`, where facets show as dark steps. Rays then leave the outside
        /// from the smooth surface that the normals describe, and facets do not hide what that surface sees. It costs a few operations
        /// for each hit, and removes shadows close to the mesh: an object casts no shadow on a facet where it is nearer than twice the
        /// height of the smooth surface above that facet.
        #[serde(default)]
        pub smooth_shadows: bool,
        /// The number of levels of Loop subdivision: each divides every triangle into four and rounds the mesh off, towards the smooth
        /// surface that a coarse mesh controls. The vertices of the last level are on that surface and have its normals. Vertices in the
        /// same place move together, and the border becomes a smooth curve. Texture coordinates and colours stay linear over each triangle
        /// of the mesh. 3 is smooth to the eye for most meshes. Default: 0, the mesh as it is.
        #[serde(default, skip_serializing_if = "SubdivisionLevels::is_none")]
        pub subdivision_levels: SubdivisionLevels,
        /// A texture that moves the vertices along their normals. Default: none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub displacement: Option<Displacement>,
        /// The vertices at several times, of a mesh that changes its form. Default: none, the mesh stays as it is.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub keyframes: Vec<MeshKeyframe>,
    }
}

surface! {
    closed
    /// A sphere; its normal points outwards. Texture coordinates: u is the angle about z, from +x towards +y, as a share of a full turn;
    /// v is the angle from +z, as a share of half a turn: 0 at +z, 1 at −z. The upper edge of a picture, v = 1, is therefore at −z. A
    /// first step `{"scale": -1}` of the transform puts the upper edge at +z and the middle of the picture at +x, not mirrored as seen
    /// from outside. `z_min`, `z_max` and `phi_max` leave a part of the sphere: a bowl, a dome, a belt or a slice. The part keeps the texture
    /// coordinates of the whole. It is an open surface, which cannot contain a medium.
    pub struct Sphere {
        /// The radius, in metres.
        #[serde(default = "one")]
        pub radius: Positive,
        /// The centre, in metres.
        #[serde(default = "origin")]
        pub center: Point,
        /// What lies below this z is left out, in metres above the centre. Default: nothing.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub z_min: Option<Real>,
        /// What lies above this z is left out, in metres above the centre. Default: nothing.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub z_max: Option<Real>,
        /// The angle about z up to which the sphere is there, from +x towards +y, in degrees. Default: 360.
        #[serde(default = "full_turn", skip_serializing_if = "Turn::is_full")]
        pub phi_max: Turn,
    }
}

surface! {
    /// A rectangle in the plane z = 0 with its centre at the origin and the normal +z. Texture coordinates run from 0 to 1 along x and y.
    pub struct Quad {
        /// Full width and height, in metres: one number, or `[x, y]`.
        #[serde(default = "unit_square")]
        pub size: Size,
    }
}

surface! {
    /// A disk in the plane z = 0 with its centre at the origin and the normal +z. Texture coordinates run from 0 to 1 along x and y over the
    /// square around the disk. `inner_radius` and `phi_max` leave a ring or a slice, with the texture coordinates of the whole disk.
    pub struct Disk {
        /// The radius, in metres.
        #[serde(default = "one")]
        pub radius: Positive,
        /// The radius of a hole in the middle, in metres, below `radius`. Default: 0, no hole.
        #[serde(default = "no_hole", skip_serializing_if = "is_no_hole")]
        pub inner_radius: NonNegative,
        /// The angle about z up to which the disk is there, from +x towards +y, in degrees. Default: 360.
        #[serde(default = "full_turn", skip_serializing_if = "Turn::is_full")]
        pub phi_max: Turn,
    }
}

surface! {
    /// A cylinder around the z axis, open at both ends; its normal points away from the axis. Texture coordinates: u is the angle about z, from
    /// +x towards +y, as a share of `phi_max`; v is 0 at `z_min` and 1 at `z_max`. Disks at both ends close it: the one at `z_min` turned
    /// over, so that its normal points outwards too.
    pub struct Cylinder {
        /// The radius, in metres.
        #[serde(default = "one")]
        pub radius: Positive,
        /// The lower end, in metres.
        #[serde(default = "minus_one")]
        pub z_min: Real,
        /// The upper end, in metres.
        #[serde(default = "plus_one")]
        pub z_max: Real,
        /// The angle about z up to which the cylinder is there, from +x towards +y, in degrees.
        #[serde(default = "full_turn")]
        pub phi_max: Turn,
    }
}

surface! {
    /// A cone around the z axis with its base in the plane z = 0, where it is open, and its apex at z = `height`; its normal points outwards.
    /// Texture coordinates: u is the angle about z, from +x towards +y, as a share of `phi_max`; v is 0 at the base and 1 at the apex.
    pub struct Cone {
        /// The radius of the base, in metres.
        #[serde(default = "one")]
        pub radius: Positive,
        /// The height, in metres.
        #[serde(default = "one")]
        pub height: Positive,
        /// The angle about z up to which the cone is there, from +x towards +y, in degrees.
        #[serde(default = "full_turn")]
        pub phi_max: Turn,
    }
}

surface! {
    /// A bilinear patch: the surface of the straight lines between opposite sides of a quadrilateral. Its four corners need not be in one
    /// plane. With the texture coordinates u and v, its points are (1 − u)(1 − v) p₀₀ + u (1 − v) p₁₀ + (1 − u) v p₀₁ + u v p₁₁. Its
    /// normal is on the side from which u and v run counter-clockwise, as x and y of a quad do.
    pub struct BilinearPatch {
        /// The corners p₀₀, p₁₀, p₀₁ and p₁₁, in metres, with the texture coordinates `[0, 0]`, `[1, 0]`, `[0, 1]` and `[1, 1]`: the third
        /// corner is beside the first one, and not opposite to it.
        pub corners: [Point; 4],
    }
}

surface! {
    /// Curves: hair, fur, grass, threads or wires. A curve is a tube: the surface of all balls whose centres lie on it. With `normals` it is a
    /// ribbon. Texture coordinates: u is the angle around a tube, or runs from one side of a ribbon to the other; v is 0 at the first end of
    /// the curve and 1 at its last. The transform may move, turn, mirror and scale curves, but neither stretch nor shear them.
    pub struct Curves {
        /// The path of a file with the points, relative to the scene file's folder: a .hair file, or text with `x y z` and optionally a radius
        /// on each line, in metres, and an empty line between two curves.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub file: Option<String>,
        /// The control points of each curve, in metres.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub points: Option<Vec<Vec<Point>>>,
        /// How a curve follows from its control points.
        #[serde(default)]
        pub basis: CurveBasis,
        /// Half the thickness of the curves, in metres: one number, or `[first, last]` for curves that taper from their first point to
        /// their last. Default: that of the file.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub radius: Option<CurveRadius>,
        /// Makes ribbons of the curves, twice as wide as `radius`, with these normals: one for each of `points`. A ribbon is open, and has no
        /// thickness.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub normals: Option<Vec<Vec<Vector>>>,
    }
}

surface! {
    closed
    /// A box with its sides along the axes; its normals point outwards. It is a closed surface, which glass needs. Each face has texture
    /// coordinates from 0 to 1. As seen from outside, on the four sides u runs to the right and v along +y; on the top (+y) u runs along
    /// +x and v along −z; at the bottom u runs along +x and v along +z.
    pub struct Cuboid {
        /// Full width, height and depth, in metres: one number, or `[x, y, z]`.
        #[serde(default = "unit_cube")]
        pub size: Sides,
        /// The centre, in metres.
        #[serde(default = "origin")]
        pub center: Point,
    }
}

surface! {
    closed
    /// A solid given by its signed distance field (negative inside): one `field`, or `parts` with different materials.
    /// It has no texture coordinates. Its surface cannot be sampled: its emission is found only by paths that happen to hit it.
    pub struct Sdf {
        /// The solid, if it is a single field.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub field: Option<Field>,
        /// Several solids with their own materials. Each point of the surface belongs to the part with the smallest distance, at equal
        /// distances to the first.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub parts: Option<Vec<SdfPart>>,
        /// A box outside of which the solid is cut off. A cut has no surface. It is required where a field is unbounded.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub bounds: Option<Bounds>,
        /// Stops at a given distance before the surface, instead of on it: for scenes that were made for such a renderer.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub march: Option<FixedMarch>,
    }
}

/// Shapes with a common transform.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// The shapes. Their own transforms act first.
    pub shapes: Vec<Shape>,
    /// The name of the group in messages and statistics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The transform of the group, which acts after the transforms of the shapes.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

/// Instances of one of the scene's `groups`: copies that share the memory of the group's shapes. Each costs a small record, so that there
/// may be millions. A shape that emits light is copied in full, and each copy is a light of its own; at most 1,048,576 such copies are
/// possible. Where a surface of an instance coincides with a surface outside of the instance, rounding decides which of them is seen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Instances {
    /// The name of the group.
    pub group: String,
    /// The places of the instances. Without them, and without `file`, there is one instance, placed by `transform` alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub placements: Option<Vec<Placement>>,
    /// The path of a .ply file with one point for each instance, relative to the scene file's folder. Its element `vertex` has the
    /// properties `x y z`, in metres, and optionally `qx qy qz qw`, a rotation as a quaternion of any length; `scale`, or `scale_x scale_y
    /// scale_z`; and `material`, a number from 0 that chooses one of `materials`. The group is scaled first, then rotated, then moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The materials that the points of `file` choose from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<MaterialRef>,
    /// The name of the instances in messages.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The material of all surfaces, instead of their own. Where instances lie within each other, the material of the outermost counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialRef>,
    /// Places all instances in the world, or in their group. It acts after their own placement.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

/// The place of one instance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Placement {
    /// Places the group.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
    /// The material of all surfaces of this instance. Default: that of the instances, or the shapes' own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialRef>,
}

fn one() -> Positive {
    Positive::known(1.0)
}

fn plus_one() -> Real {
    Real::known(1.0)
}

fn minus_one() -> Real {
    Real::known(-1.0)
}

fn full_turn() -> Turn {
    Turn::known(360.0)
}

fn no_hole() -> NonNegative {
    NonNegative::known(0.0)
}

fn is_no_hole(radius: &NonNegative) -> bool {
    radius.get() == 0.0
}

fn origin() -> Point {
    Point([0.0; 3])
}

fn unit_square() -> Size {
    Size::Square(one())
}

fn unit_cube() -> Sides {
    Sides::Cube(one())
}

/// Full width, height and depth: one number, or `[x, y, z]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Sides {
    /// One length for all three, in metres.
    Cube(Positive),
    /// Width, height and depth, in metres.
    Each([Positive; 3]),
}

by_kind!(Sides { Number => Cube(Positive), Array => Each([Positive; 3]) });

impl Sides {
    /// Width, height and depth, in metres.
    pub fn get(self) -> [f64; 3] {
        match self {
            Sides::Cube(side) => [side.get(); 3],
            Sides::Each(sides) => sides.map(Positive::get),
        }
    }
}

/// Half the thickness of curves: one number, or `[first, last]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum CurveRadius {
    /// The radius everywhere, in metres.
    Constant(Positive),
    /// The radius at the first and at the last point, in metres.
    Ends([NonNegative; 2]),
}

by_kind!(CurveRadius { Number => Constant(Positive), Array => Ends([NonNegative; 2]) });

impl CurveRadius {
    /// The radius at the first and at the last point (m).
    pub fn ends(self) -> [f64; 2] {
        match self {
            CurveRadius::Constant(radius) => [radius.get(); 2],
            CurveRadius::Ends(ends) => ends.map(NonNegative::get),
        }
    }
}

/// How a curve follows from its control points.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CurveBasis {
    /// A smooth curve through all points: a Catmull–Rom spline. At least two points.
    #[default]
    CatmullRom,
    /// A uniform cubic B-spline, which passes near its points, but not through them. At least four points.
    Bspline,
    /// Cubic Bézier curves: the fourth point ends the first curve and begins the second. 4, 7, 10 … points.
    Bezier,
    /// Straight lines from point to point. At least two points.
    Linear,
}

impl Sphere {
    /// The z above the centre from which and up to which the sphere is there (m); beyond the radius where nothing is cut off.
    pub fn ends(&self) -> [f64; 2] {
        let radius = self.radius.get();
        [self.z_min.map_or(-radius, Real::get), self.z_max.map_or(radius, Real::get)]
    }

    /// Whether nothing is cut off, so that it is a closed surface.
    pub fn is_whole(&self) -> bool {
        let ([low, high], radius) = (self.ends(), self.radius.get());
        low <= -radius && high >= radius && self.phi_max.is_full()
    }
}

impl Disk {
    /// Whether it has no hole and is a full turn.
    pub fn is_whole(&self) -> bool {
        self.inner_radius.get() == 0.0 && self.phi_max.is_full()
    }
}

impl Mesh {
    /// Whether its vertices move when the scene is built, so that their normals are computed.
    pub fn has_computed_normals(&self) -> bool {
        !self.subdivision_levels.is_none() || self.displacement.is_some()
    }
}

impl Shape {
    /// Whether the shape has keyframes, of its place or of its form. What it contains may have others.
    pub fn has_keyframes(&self) -> bool {
        self.transform().has_keyframes() || matches!(self, Shape::Mesh(mesh) if !mesh.keyframes.is_empty())
    }
}

impl Instances {
    /// The materials of single instances, each with its place below that of the instances: `placements/0/material`.
    pub fn materials(&self) -> impl Iterator<Item = (String, &MaterialRef)> {
        let placed = self.placements.iter().flatten().enumerate();
        let placed = placed.filter_map(|(i, p)| Some((format!("placements/{i}/material"), p.material.as_ref()?)));
        placed.chain(self.materials.iter().enumerate().map(|(i, material)| (format!("materials/{i}"), material)))
    }
}

impl Shape {
    /// The name, where one is given.
    pub fn name(&self) -> Option<&str> {
        match self {
            Shape::Mesh(s) => s.name.as_deref(),
            Shape::Sphere(s) => s.name.as_deref(),
            Shape::Quad(s) => s.name.as_deref(),
            Shape::Disk(s) => s.name.as_deref(),
            Shape::Cylinder(s) => s.name.as_deref(),
            Shape::Cone(s) => s.name.as_deref(),
            Shape::BilinearPatch(s) => s.name.as_deref(),
            Shape::Curves(s) => s.name.as_deref(),
            Shape::Box(s) => s.name.as_deref(),
            Shape::Sdf(s) => s.name.as_deref(),
            Shape::Group(s) => s.name.as_deref(),
            Shape::Instances(s) => s.name.as_deref(),
        }
    }

    /// The shape's own transform, without those of the groups around it.
    pub fn transform(&self) -> &Transform {
        match self {
            Shape::Mesh(s) => &s.transform,
            Shape::Sphere(s) => &s.transform,
            Shape::Quad(s) => &s.transform,
            Shape::Disk(s) => &s.transform,
            Shape::Cylinder(s) => &s.transform,
            Shape::Cone(s) => &s.transform,
            Shape::BilinearPatch(s) => &s.transform,
            Shape::Curves(s) => &s.transform,
            Shape::Box(s) => &s.transform,
            Shape::Sdf(s) => &s.transform,
            Shape::Group(s) => &s.transform,
            Shape::Instances(s) => &s.transform,
        }
    }

    /// The material; `None` where none is given, and for groups. That of instances replaces the materials of their shapes.
    pub fn material(&self) -> Option<&MaterialRef> {
        match self {
            Shape::Mesh(s) => s.material.as_ref(),
            Shape::Sphere(s) => s.material.as_ref(),
            Shape::Quad(s) => s.material.as_ref(),
            Shape::Disk(s) => s.material.as_ref(),
            Shape::Cylinder(s) => s.material.as_ref(),
            Shape::Cone(s) => s.material.as_ref(),
            Shape::BilinearPatch(s) => s.material.as_ref(),
            Shape::Curves(s) => s.material.as_ref(),
            Shape::Box(s) => s.material.as_ref(),
            Shape::Sdf(s) => s.material.as_ref(),
            Shape::Group(_) => None,
            Shape::Instances(s) => s.material.as_ref(),
        }
    }

    /// The medium inside; `None` where none is given, and for open shapes, groups and instances.
    pub fn medium(&self) -> Option<&MediumRef> {
        match self {
            Shape::Mesh(s) => s.medium.as_ref(),
            Shape::Sphere(s) => s.medium.as_ref(),
            Shape::Box(s) => s.medium.as_ref(),
            Shape::Sdf(s) => s.medium.as_ref(),
            Shape::Quad(_) | Shape::Disk(_) | Shape::Cylinder(_) | Shape::Cone(_) | Shape::BilinearPatch(_) | Shape::Curves(_) => None,
            Shape::Group(_) | Shape::Instances(_) => None,
        }
    }

    /// The emission; `None` where none is given, and for groups and instances.
    pub fn emission(&self) -> Option<&Emission> {
        match self {
            Shape::Mesh(s) => s.emission.as_ref(),
            Shape::Sphere(s) => s.emission.as_ref(),
            Shape::Quad(s) => s.emission.as_ref(),
            Shape::Disk(s) => s.emission.as_ref(),
            Shape::Cylinder(s) => s.emission.as_ref(),
            Shape::Cone(s) => s.emission.as_ref(),
            Shape::BilinearPatch(s) => s.emission.as_ref(),
            Shape::Curves(s) => s.emission.as_ref(),
            Shape::Box(s) => s.emission.as_ref(),
            Shape::Sdf(s) => s.emission.as_ref(),
            Shape::Group(_) | Shape::Instances(_) => None,
        }
    }
}
