//! Shapes: what there is to see.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::MaterialRef;
use super::field::{Bounds, Field, FixedMarch, SdfPart};
use crate::format::{Color, Fraction, Point, Positive, Radiometric, Real, Size, Textured, Transform, Vector};
use crate::reader::{by_kind, by_type};

/// What there is to see.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Shape {
    Mesh(Mesh),
    Sphere(Sphere),
    Quad(Quad),
    Disk(Disk),
    Box(Cuboid),
    Sdf(Sdf),
    Group(Group),
}

by_type!(Shape { Mesh(Mesh), Sphere(Sphere), Quad(Quad), Disk(Disk), Box(Cuboid), Sdf(Sdf), Group(Group) });

/// Defines a struct whose last keys are those that all shapes but groups share. (serde's `flatten` would lose the positions.)
macro_rules! surface {
    ($(#[$meta:meta])* pub struct $name:ident { $($own:tt)* }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $($own)*
            /// What the shape is called in messages and statistics.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub name: Option<String>,
            /// How it reflects and transmits. Default: diffuse of albedo 0.5.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub material: Option<MaterialRef>,
            /// Makes the shape a light.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub emission: Option<Emission>,
            /// Places it: steps applied in listed order.
            #[serde(default, skip_serializing_if = "Transform::is_identity")]
            pub transform: Transform,
        }
    };
}

surface! {
    /// Triangles: from a file, or `positions` and `triangles` given here.
    pub struct Mesh {
        /// An .obj, .ply or .stl file: a path from the scene file's folder, in which it lies (see `--allow-outside`).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub file: Option<String>,
        /// The file's own material names (OBJ: `usemtl`) and the materials they stand for; other faces have `material`.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        pub materials: BTreeMap<String, MaterialRef>,
        /// Vertices.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub positions: Option<Vec<Point>>,
        /// Three vertices each, counted from 0, counter-clockwise seen from the front.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub triangles: Option<Vec<[u32; 3]>>,
        /// One shading normal for each vertex; without them the mesh is faceted.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub normals: Option<Vec<Vector>>,
        /// Texture coordinates for each vertex.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub uvs: Option<Vec<[Real; 2]>>,
        /// A colour for each vertex, components from 0 to 1, for materials with a texture `vertex_color`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub colors: Option<Vec<Color<Fraction>>>,
        /// For coarse meshes with `normals`, whose facets show as dark steps where the surface turns away from a light: light
        /// then leaves the outside from the smooth surface of which the normals tell, and facets do not hide what that
        /// surface sees. It costs a few operations where a ray meets the mesh, and shadows right at it: nothing that comes
        /// nearer to a facet than twice the height of the bulge that the facet cuts off shades it there.
        #[serde(default)]
        pub smooth_shadows: bool,
    }
}

surface! {
    /// A sphere; its normal points outwards. Texture coordinates: u is the angle about z, from +x towards +y, as a share of a full turn;
    /// v is the angle from +z, as a share of half a turn: 0 at +z, 1 at −z. A picture's upper edge, v = 1, is therefore at −z. A first
    /// step `{"scale": -1}` of the transform puts it at +z, with the picture's middle at +x, seen from outside as it was drawn.
    pub struct Sphere {
        /// Metres.
        #[serde(default = "one")]
        pub radius: Positive,
        /// Metres.
        #[serde(default = "origin")]
        pub center: Point,
    }
}

surface! {
    /// A rectangle in the plane z = 0 about the origin; its normal is +z. Texture coordinates run from 0 to 1 along x and y.
    pub struct Quad {
        /// Full width and height, in metres: one number, or `[x, y]`.
        #[serde(default = "unit_square")]
        pub size: Size,
    }
}

surface! {
    /// A disk in the plane z = 0 about the origin; its normal is +z.
    pub struct Disk {
        /// Metres.
        #[serde(default = "one")]
        pub radius: Positive,
    }
}

surface! {
    /// A box about `center`, its sides along the axes; its normals point outwards. It is closed: glass may be made of it. Each face has
    /// texture coordinates from 0 to 1, seen from outside: on the four sides u runs to the right and v along +y, on the top
    /// (+y) u along +x and v along −z, at the bottom u along +x and v along +z.
    pub struct Cuboid {
        /// Full width, height and depth, in metres: one number, or `[x, y, z]`.
        #[serde(default = "unit_cube")]
        pub size: Sides,
        /// Metres.
        #[serde(default = "origin")]
        pub center: Point,
    }
}

surface! {
    /// A solid given by its signed distance (negative inside): one `field`, or `parts` that differ in what they are made of.
    /// It has no texture coordinates, and no points can be drawn on it: where it emits, paths meet its light by chance.
    pub struct Sdf {
        /// The solid.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub field: Option<Field>,
        /// Several solids with materials of their own; where they meet, the nearest counts, of equals the first.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub parts: Option<Vec<SdfPart>>,
        /// What lies outside is cut away; a cut shows no surface. Needed where a field has no end.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub bounds: Option<Bounds>,
        /// Looks for the surface in steps that end before it, instead of on it: for scenes made that way.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub march: Option<FixedMarch>,
    }
}

/// Shapes that are moved together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// The shapes, placed by their own transforms first.
    pub shapes: Vec<Shape>,
    /// What the group is called in messages and statistics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Acts after the transforms of the shapes.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

fn one() -> Positive {
    Positive::known(1.0)
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
    Cube(Positive),
    Each([Positive; 3]),
}

by_kind!(Sides { Number => Cube(Positive), Array => Each([Positive; 3]) });

impl Sides {
    pub fn get(self) -> [f64; 3] {
        match self {
            Sides::Cube(side) => [side.get(); 3],
            Sides::Each(sides) => sides.map(Positive::get),
        }
    }
}

/// What a surface emits: its radiance, or an object with more to say.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(from = "EmissionForm")]
pub struct Emission {
    /// W·m⁻²·sr⁻¹, the same in every direction.
    pub radiance: Color<Radiometric>,
    /// What the radiance is multiplied by, place by place; its pictures may hold any finite amounts. Default: nothing, it is the
    /// same all over.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texture: Option<Textured>,
    /// Whether the back shines too; else only the side to which the normal points.
    pub two_sided: bool,
}

/// The forms of an [`Emission`], by the kind of the JSON value.
#[derive(Deserialize, JsonSchema)]
#[serde(rename = "by kind", rename_all = "snake_case")]
#[schemars(rename = "EmissionForm", untagged)]
enum EmissionForm {
    /// Radiance of the front, in W·m⁻²·sr⁻¹.
    Number(Radiometric),
    /// Radiance of the front, linear `[red, green, blue]`, in W·m⁻²·sr⁻¹.
    Array([Radiometric; 3]),
    Object(EmissionKeys),
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
struct EmissionKeys {
    /// W·m⁻²·sr⁻¹, the same in every direction.
    radiance: Color<Radiometric>,
    /// What the radiance is multiplied by, place by place; its pictures may hold any finite amounts. Default: nothing, it is the
    /// same all over.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    texture: Option<Textured>,
    /// Whether the back shines too; else only the side to which the normal points.
    #[serde(default)]
    two_sided: bool,
}

impl From<EmissionForm> for Emission {
    fn from(form: EmissionForm) -> Emission {
        let front = |radiance| Emission { radiance, texture: None, two_sided: false };
        match form {
            EmissionForm::Number(gray) => front(Color::Gray(gray)),
            EmissionForm::Array(rgb) => front(Color::Rgb(rgb)),
            EmissionForm::Object(EmissionKeys { radiance, texture, two_sided }) => Emission { radiance, texture, two_sided },
        }
    }
}

impl Shape {
    pub fn name(&self) -> Option<&str> {
        match self {
            Shape::Mesh(s) => s.name.as_deref(),
            Shape::Sphere(s) => s.name.as_deref(),
            Shape::Quad(s) => s.name.as_deref(),
            Shape::Disk(s) => s.name.as_deref(),
            Shape::Box(s) => s.name.as_deref(),
            Shape::Sdf(s) => s.name.as_deref(),
            Shape::Group(s) => s.name.as_deref(),
        }
    }

    pub fn transform(&self) -> &Transform {
        match self {
            Shape::Mesh(s) => &s.transform,
            Shape::Sphere(s) => &s.transform,
            Shape::Quad(s) => &s.transform,
            Shape::Disk(s) => &s.transform,
            Shape::Box(s) => &s.transform,
            Shape::Sdf(s) => &s.transform,
            Shape::Group(s) => &s.transform,
        }
    }

    /// `None` where none is given, and for groups.
    pub fn material(&self) -> Option<&MaterialRef> {
        match self {
            Shape::Mesh(s) => s.material.as_ref(),
            Shape::Sphere(s) => s.material.as_ref(),
            Shape::Quad(s) => s.material.as_ref(),
            Shape::Disk(s) => s.material.as_ref(),
            Shape::Box(s) => s.material.as_ref(),
            Shape::Sdf(s) => s.material.as_ref(),
            Shape::Group(_) => None,
        }
    }

    /// `None` where none is given, and for groups.
    pub fn emission(&self) -> Option<&Emission> {
        match self {
            Shape::Mesh(s) => s.emission.as_ref(),
            Shape::Sphere(s) => s.emission.as_ref(),
            Shape::Quad(s) => s.emission.as_ref(),
            Shape::Disk(s) => s.emission.as_ref(),
            Shape::Box(s) => s.emission.as_ref(),
            Shape::Sdf(s) => s.emission.as_ref(),
            Shape::Group(_) => None,
        }
    }
}
