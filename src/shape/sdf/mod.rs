//! Signed distance fields: surfaces at the zeros of a function that is negative inside.
//!
//! A [`Field`] is a tree of primitives and operations. Every field has the Lipschitz bound 1: it changes by no more than one metre per
//! metre. |d| is therefore never more than the distance to the surface, and a ray may advance by |d| without crossing it. Primitives
//! have this bound, operations keep it, and transforms divide by their stretch. The bounds of a field enclose {d ≤ grow}, because
//! operations need enlarged bounds of their parts.
//!
//! A new node is a struct with `distance` and `bounds` in one of these files, documented by its formula, a variant with its arms here, a
//! struct in `describe::field`, an arm in its builder, and a row in `tests/it/fields/zoo.rs`.

mod combine;
mod dual;
mod flat;
mod march;
mod round;
mod solid;
mod space;

use glam::{BVec3, DVec3};

use crate::error::{Error, Fault, Result};
use crate::math::Transform;

use super::{Geometry, Shape};
pub use combine::{Complement, Difference, Intersection, SmoothUnion, Union};
pub use dual::{Dual, Scalar};
pub use flat::{ChebyshevBox, Cuboid, HalfSpace};
pub use march::{Fixed, March};
pub use round::{Ball, Capsule, Ring};
pub use space::{Extruded, Mirrored, Placed, Repeated};

/// Signed distance, or a lower bound of its absolute value.
#[derive(Clone, Debug, PartialEq)]
pub enum Field {
    /// Ball.
    Ball(Ball),
    /// Segment with a radius.
    Capsule(Capsule),
    /// Torus or half of one.
    Ring(Ring),
    /// Box with rounded edges.
    Cuboid(Cuboid),
    /// Box by the Chebyshev distance.
    ChebyshevBox(ChebyshevBox),
    /// Half-space.
    HalfSpace(HalfSpace),
    /// Union.
    Union(Union),
    /// Intersection.
    Intersection(Intersection),
    /// Difference.
    Difference(Difference),
    /// Complement.
    Complement(Complement),
    /// Union with filled creases.
    SmoothUnion(SmoothUnion),
    /// Transformed field.
    Placed(Box<Placed>),
    /// Field and its mirror image.
    Mirrored(Mirrored),
    /// Row of copies.
    Repeated(Repeated),
    /// Extruded cross-section.
    Extruded(Extruded),
}

/// `of_each!(field, node => expression)` for every variant.
macro_rules! of_each {
    ($field:expr, $node:ident => $value:expr) => {
        match $field {
            Field::Ball($node) => $value,
            Field::Capsule($node) => $value,
            Field::Ring($node) => $value,
            Field::Cuboid($node) => $value,
            Field::ChebyshevBox($node) => $value,
            Field::HalfSpace($node) => $value,
            Field::Union($node) => $value,
            Field::Intersection($node) => $value,
            Field::Difference($node) => $value,
            Field::Complement($node) => $value,
            Field::SmoothUnion($node) => $value,
            Field::Placed($node) => $value,
            Field::Mirrored($node) => $value,
            Field::Repeated($node) => $value,
            Field::Extruded($node) => $value,
        }
    };
}

impl Field {
    /// Distance at `p` (m), with the derivatives that the number type carries.
    pub fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        of_each!(self, node => node.distance(p))
    }

    /// Distance at `p`, negative inside (m).
    pub fn at(&self, p: DVec3) -> f64 {
        self.distance(p.to_array())
    }

    /// Whether the distance is nowhere less than the Chebyshev distance to the bounding box. Rotated and stretched fields do not
    /// guarantee this.
    fn keeps_its_box(&self) -> bool {
        match self {
            Field::Ball(_) | Field::Capsule(_) | Field::Ring(_) | Field::Cuboid(_) | Field::ChebyshevBox(_) => true,
            Field::HalfSpace(_) | Field::Complement(_) => true,
            Field::Union(f) => f.of().all(Field::keeps_its_box),
            Field::Intersection(f) => f.of.iter().all(Field::keeps_its_box),
            Field::SmoothUnion(f) => f.of.iter().all(Field::keeps_its_box),
            Field::Difference(f) => f.from.keeps_its_box(),
            Field::Placed(_) => false,
            Field::Mirrored(f) => f.of.keeps_its_box(),
            Field::Repeated(f) => f.of().keeps_its_box(),
            Field::Extruded(f) => f.of.keeps_its_box(),
        }
    }

    /// Lower and upper corner of the bounding box of all points with distance ≤ `grow`, infinite where the field has no end (m).
    pub fn bounds(&self, grow: f64) -> [DVec3; 2] {
        of_each!(self, node => node.bounds(grow))
    }
}

/// Bounds of all space.
fn everywhere() -> [DVec3; 2] {
    [DVec3::NEG_INFINITY, DVec3::INFINITY]
}

/// Solid of one or more parts, each described by a field. Where several parts are equally near, the first one is hit.
#[derive(Clone, Debug, PartialEq)]
pub struct Sdf {
    /// Parts of the solid.
    pub parts: Union,
    /// Lower and upper corner of a box outside of which the solid is cut away (m). The cuts have no surface.
    pub within: [DVec3; 2],
    /// Method of intersection with rays.
    pub march: March,
}

impl Sdf {
    /// A solid of one part, not cut.
    pub fn new(field: Field) -> Sdf {
        Sdf { parts: Union::new(vec![field]), within: everywhere(), march: March::Exact }
    }

    /// Distance at `p` (m), and the index of the nearest part.
    pub fn nearest(&self, p: DVec3) -> (f64, usize) {
        self.parts.nearest(p.to_array())
    }

    fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        self.parts.distance(p)
    }

    /// Lower and upper corner of the bounding box of the surface in object space: infinite where the surface has no end, empty if
    /// `low` > `high`.
    pub fn extent(&self) -> [DVec3; 2] {
        let [low, high] = self.parts.bounds(0.0);
        [low.max(self.within[0]), high.min(self.within[1])]
    }

    /// Axes along which the surface has an end.
    pub fn ends(&self) -> BVec3 {
        let [low, high] = self.extent();
        low.is_finite_mask() & high.is_finite_mask()
    }
}

impl Geometry for Sdf {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        let [low, high] = space::around(self.extent(), to_world);
        (low, high)
    }

    /// # Errors
    /// `Invalid` if the surface has no end or is empty.
    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        let [low, high] = self.extent();
        if !self.ends().all() {
            return Err(Error::invalid(Fault::new("a distance field without end needs bounds".to_owned())));
        }
        if !low.cmplt(high).all() {
            return Err(Error::invalid(Fault::new("nothing of the distance field lies within its bounds".to_owned())));
        }
        Ok(Box::new(solid::Solid::new(self.clone(), to_world)))
    }
}
