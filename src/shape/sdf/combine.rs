//! Boolean operations on fields.

use glam::DVec3;

use super::dual::Scalar;
use super::flat::ChebyshevBox;
use super::{Field, everywhere};

/// Union: min over the parts
///
/// A part is not evaluated where the Chebyshev distance to its bounding box exceeds the distance of another part, because no distance
/// is less than that.
///
/// Tests: unions_skip_only_fields_that_cannot_be_nearest.
#[derive(Clone, Debug, PartialEq)]
pub struct Union {
    members: Vec<Member>,
}

/// Part of a union with its bounding box.
#[derive(Clone, Debug, PartialEq)]
struct Member {
    field: Field,
    bounds: ChebyshevBox,
}

impl Union {
    /// The union of at least one field.
    pub fn new(of: Vec<Field>) -> Union {
        let member = |field: Field| {
            let [low, high] = if field.keeps_its_box() { field.bounds(0.0) } else { everywhere() };
            Member { field, bounds: ChebyshevBox { low, high } }
        };
        Union { members: of.into_iter().map(member).collect() }
    }

    /// Parts of the union.
    pub fn of(&self) -> impl Iterator<Item = &Field> {
        self.members.iter().map(|member| &member.field)
    }

    /// Least distance, and the first part that has it; infinity if there are no parts.
    pub fn nearest<S: Scalar>(&self, p: [S; 3]) -> (S, usize) {
        let place = p.map(S::value);
        let mut best = (S::constant(f64::INFINITY), 0);
        // The last parts are evaluated first, because large parts with simple formulas tend to come last.
        for (k, member) in self.members.iter().enumerate().rev() {
            if member.bounds.distance(place) <= best.0.value() {
                let distance = member.field.distance(p);
                best = if distance.value() <= best.0.value() { (distance, k) } else { best };
            }
        }
        best
    }

    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        self.nearest(p).0
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        hull(self.of(), grow)
    }
}

/// Intersection: max over the parts
#[derive(Clone, Debug, PartialEq)]
pub struct Intersection {
    /// Parts, at least one.
    pub of: Vec<Field>,
}

impl Intersection {
    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        -least(self.of.iter().map(|field| -field.distance(p)))
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        let boxes = self.of.iter().map(|field| field.bounds(grow));
        boxes.fold(everywhere(), |a, b| [a[0].max(b[0]), a[1].min(b[1])])
    }
}

/// Difference: max(d, −min over the subtracted fields)
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Field from which the others are subtracted.
    pub from: Box<Field>,
    /// Subtracted fields, at least one.
    pub minus: Vec<Field>,
}

impl Difference {
    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        self.from.distance(p).max(-least(self.minus.iter().map(|field| field.distance(p))))
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        self.from.bounds(grow)
    }
}

/// Complement: −d
#[derive(Clone, Debug, PartialEq)]
pub struct Complement {
    /// Field whose complement this is.
    pub of: Box<Field>,
}

impl Complement {
    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        -self.of.distance(p)
    }

    /// Bounds of all space. Only the complement of a half-space could have smaller ones.
    pub(super) fn bounds(&self, _: f64) -> [DVec3; 2] {
        everywhere()
    }
}

/// Smooth union, which fills creases: min(a, b) − h² k / 4,  h = max(1 − |a − b| / k, 0)
///
/// More than two parts are joined one after the other. The gradient is a convex combination of those of a and b, because ∂/∂a and ∂/∂b
/// are not negative and their sum is 1.
///
/// Source: Quílez, *Smooth minimum* (2013), the quadratic one.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothUnion {
    /// Parts, at least one.
    pub of: Vec<Field>,
    /// Width k: creases are filled where the distances differ by less (m).
    pub width: f64,
}

impl SmoothUnion {
    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        let k = self.width;
        let join = |a: S, b: S| {
            let overlap = (-(a - b).abs()).plus(k).max(S::constant(0.0));
            a.min(b) - (overlap * overlap).times(0.25 / k)
        };
        self.of.iter().map(|field| field.distance(p)).reduce(join).unwrap_or(S::constant(f64::INFINITY))
    }

    /// Lower and upper corner of a bounding box of the union. Its parts are grown by k/4 for each smooth join, because each join lowers
    /// the distance by at most k/4.
    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        hull(self.of.iter(), grow + 0.25 * self.width * (self.of.len() as f64 - 1.0))
    }
}

/// Least distance, the first of equal ones; infinity if there are none.
fn least<S: Scalar>(distances: impl Iterator<Item = S>) -> S {
    distances.reduce(S::min).unwrap_or(S::constant(f64::INFINITY))
}

/// Bounding box of the bounding boxes.
fn hull<'a>(fields: impl Iterator<Item = &'a Field>, grow: f64) -> [DVec3; 2] {
    let boxes = fields.map(|field| field.bounds(grow));
    boxes.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or(everywhere())
}
