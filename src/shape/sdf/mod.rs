//! Surfaces given by their distance: where a field is 0, with the inside where it is negative.
//!
//! A [`Field`] is a tree of primitives and operations. Its law: it changes by no more than a metre per metre (its
//! Lipschitz bound is 1), so that |d| is never more than the distance to the surface and a ray may go on by |d| without
//! passing anything. Primitives have it, operations keep it, stretches are divided by. Bounds of fields are those of
//! {d ≤ grow}, which is what operations need of their parts.
//!
//! To add a node: a struct with `distance` and `bounds` in one of these files (its formula on top), a variant and its
//! arms here, a struct in `describe::field`, an arm in its builder, a row in `tests/it/fields/zoo.rs`.

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

/// A signed distance, or a bound of it.
#[derive(Clone, Debug, PartialEq)]
pub enum Field {
    Ball(Ball),
    Capsule(Capsule),
    Ring(Ring),
    Cuboid(Cuboid),
    ChebyshevBox(ChebyshevBox),
    HalfSpace(HalfSpace),
    Union(Union),
    Intersection(Intersection),
    Difference(Difference),
    Complement(Complement),
    SmoothUnion(SmoothUnion),
    Placed(Box<Placed>),
    Mirrored(Mirrored),
    Repeated(Repeated),
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
    /// At `p` (m), with whatever derivatives the numbers carry.
    pub fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        of_each!(self, node => node.distance(p))
    }

    /// At `p`, negative inside (m).
    pub fn at(&self, p: DVec3) -> f64 {
        self.distance(p.to_array())
    }

    /// Whether the distance is nowhere less than Chebyshev's to the box around the field: not where space is turned or
    /// stretched.
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

    /// The box around all points of distance ≤ `grow`: low and high corner, infinite where there is no end (m).
    pub fn bounds(&self, grow: f64) -> [DVec3; 2] {
        of_each!(self, node => node.bounds(grow))
    }
}

fn everywhere() -> [DVec3; 2] {
    [DVec3::NEG_INFINITY, DVec3::INFINITY]
}

/// A solid that a field describes, or several that meet: the first of the nearest is the part that a ray meets.
#[derive(Clone, Debug, PartialEq)]
pub struct Sdf {
    pub parts: Union,
    /// What lies outside of these corners is cut away (m); a cut shows no surface.
    pub within: [DVec3; 2],
    pub march: March,
}

impl Sdf {
    /// One solid, whole.
    pub fn new(field: Field) -> Sdf {
        Sdf { parts: Union::new(vec![field]), within: everywhere(), march: March::Exact }
    }

    /// The distance at `p`, and which part has it.
    pub fn nearest(&self, p: DVec3) -> (f64, usize) {
        self.parts.nearest(p.to_array())
    }

    fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        self.parts.distance(p)
    }

    /// The box in which the surface lies, object space: infinite where nothing ends it, empty where `low` > `high`.
    pub fn extent(&self) -> [DVec3; 2] {
        let [low, high] = self.parts.bounds(0.0);
        [low.max(self.within[0]), high.min(self.within[1])]
    }

    /// Along which axes it has an end.
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
    /// `Invalid` where it has no end, or is nowhere.
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
