//! Fields made of fields.

use glam::DVec3;

use super::dual::Scalar;
use super::flat::ChebyshevBox;
use super::{Field, everywhere};

/// min over the parts
///
/// A part is not asked where its box is farther away than another part is: no distance is less than Chebyshev's to
/// the box around the field.
///
/// Tests: boxes_are_nearer_than_fields.
#[derive(Clone, Debug, PartialEq)]
pub struct Union {
    members: Vec<Member>,
}

#[derive(Clone, Debug, PartialEq)]
struct Member {
    field: Field,
    bounds: ChebyshevBox,
}

impl Union {
    /// - `of`: at least one
    pub fn new(of: Vec<Field>) -> Union {
        let member = |field: Field| {
            let [low, high] = if field.keeps_its_box() { field.bounds(0.0) } else { everywhere() };
            Member { field, bounds: ChebyshevBox { low, high } }
        };
        Union { members: of.into_iter().map(member).collect() }
    }

    pub fn of(&self) -> impl Iterator<Item = &Field> {
        self.members.iter().map(|member| &member.field)
    }

    /// The least distance, and the first member that has it; infinitely far away where there is none.
    pub fn nearest<S: Scalar>(&self, p: [S; 3]) -> (S, usize) {
        let place = p.map(S::value);
        let mut best = (S::constant(f64::INFINITY), 0);
        // From the last: large things, of simple distances, tend to come last.
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

/// max over the parts
#[derive(Clone, Debug, PartialEq)]
pub struct Intersection {
    /// At least one.
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

/// What is left when the others are carved out: max(d, −min over the others)
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    pub from: Box<Field>,
    /// At least one.
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

/// Everything else: −d
#[derive(Clone, Debug, PartialEq)]
pub struct Complement {
    pub of: Box<Field>,
}

impl Complement {
    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        -self.of.distance(p)
    }

    /// Of a half-space it would be another; of nothing else it is finite.
    pub(super) fn bounds(&self, _: f64) -> [DVec3; 2] {
        everywhere()
    }
}

/// A union that fills its creases: min(a, b) − h² k / 4,  h = max(1 − |a − b| / k, 0)
///
/// One after the other. Its slope lies between those of a and b: the sum of ∂/∂a and ∂/∂b is 1, neither is negative.
///
/// Source: Quílez, *Smooth minimum* (2013), the quadratic one.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothUnion {
    /// At least one.
    pub of: Vec<Field>,
    /// k: creases are filled where the distances differ by less (m).
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

    /// Each joining lowers the distance by k/4 at most.
    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        hull(self.of.iter(), grow + 0.25 * self.width * (self.of.len() as f64 - 1.0))
    }
}

/// The least distance, the first of equals; infinitely far away where there is none.
fn least<S: Scalar>(distances: impl Iterator<Item = S>) -> S {
    distances.reduce(S::min).unwrap_or(S::constant(f64::INFINITY))
}

/// The box around the boxes.
fn hull<'a>(fields: impl Iterator<Item = &'a Field>, grow: f64) -> [DVec3; 2] {
    let boxes = fields.map(|field| field.bounds(grow));
    boxes.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or(everywhere())
}
