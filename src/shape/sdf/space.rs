//! Transformations of the space of a field.

use glam::DVec3;

use super::dual::Scalar;
use super::{Field, everywhere};
use crate::math::Transform;
use crate::math::transform::greatest_stretch;

/// Field under an affine transform M: s · d(M⁻¹ p), where s is the least factor by which M stretches a length
///
/// The factor s keeps the slope of the field within 1. The distance is exact if M is a similarity.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    of: Box<Field>,
    to_world: Transform,
    /// Rows and translation of M⁻¹.
    rows: [DVec3; 3],
    shift: DVec3,
    scale: f64,
}

impl Placed {
    /// The field under a transform.
    pub fn new(of: Field, to_world: Transform) -> Placed {
        let back = to_world.inverse().matrix();
        let rows = back.matrix3.transpose();
        let scale = 1.0 / greatest_stretch(back.matrix3);
        Placed { of: Box::new(of), to_world, rows: [rows.x_axis, rows.y_axis, rows.z_axis], shift: back.translation, scale }
    }

    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        let inner = |axis: usize| dot(p, self.rows[axis]).plus(self.shift[axis]);
        self.of.distance([inner(0), inner(1), inner(2)]).times(self.scale)
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        around(self.of.bounds(grow / self.scale), &self.to_world)
    }
}

/// Bounding box of a transformed box; all space if the box is not finite.
pub(super) fn around([low, high]: [DVec3; 2], to_world: &Transform) -> [DVec3; 2] {
    if !(low.is_finite() && high.is_finite()) {
        return everywhere();
    }
    to_world.bounds([low, high])
}

/// Part of a field at positive coordinates and its mirror image: d(|x|, y, z)
#[derive(Clone, Debug, PartialEq)]
pub struct Mirrored {
    /// Mirrored field.
    pub of: Box<Field>,
    /// Axis perpendicular to the mirror: 0, 1, 2.
    pub axis: usize,
}

impl Mirrored {
    pub(super) fn distance<S: Scalar>(&self, mut p: [S; 3]) -> S {
        p[self.axis] = p[self.axis].abs();
        self.of.distance(p)
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        let [mut low, mut high] = self.of.bounds(grow);
        let reach = high[self.axis].max(0.0);
        (low[self.axis], high[self.axis]) = (-reach, reach);
        [low, high]
    }
}

/// Row of copies, one in each cell of the width `period`: the least of d(x − k T) over two neighbouring cells
///
/// The cells are centred on the field, which must fit in one cell. The copy in the cell of a point may be farther away than the copy in
/// the neighbouring cell on the point's side of the centre, so that both are evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeated {
    of: Box<Field>,
    axis: usize,
    period: f64,
    copies: [f64; 2],
    /// Centre of the cell k = 0.
    middle: f64,
}

impl Repeated {
    /// A row of copies; `None` if the field does not fit into a cell.
    ///
    /// - `axis`: 0, 1, 2
    /// - `period`: T (m)
    /// - `copies`: first and last k, which may be infinite
    pub fn new(of: Field, axis: usize, period: f64, copies: [f64; 2]) -> Option<Repeated> {
        let [low, high] = of.bounds(0.0).map(|corner| corner[axis]);
        let fits = high - low <= period;
        fits.then(|| Repeated { of: Box::new(of), axis, period, copies, middle: 0.5 * (low + high) })
    }

    /// Repeated field.
    pub fn of(&self) -> &Field {
        &self.of
    }

    pub(super) fn distance<S: Scalar>(&self, p: [S; 3]) -> S {
        let x = p[self.axis];
        let cells = (x.value() - self.middle) / self.period;
        let own = cells.round().clamp(self.copies[0], self.copies[1]);
        let next = (own + if cells < own { -1.0 } else { 1.0 }).clamp(self.copies[0], self.copies[1]);
        let copy = |k: f64| {
            let mut p = p;
            p[self.axis] = x.plus(-k * self.period);
            self.of.distance(p)
        };
        if next == own { copy(own) } else { copy(own).min(copy(next)) }
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        let [mut low, mut high] = self.of.bounds(grow);
        low[self.axis] += self.copies[0] * self.period;
        high[self.axis] += self.copies[1] * self.period;
        [low, high]
    }
}

/// Extruded cross-section of a field at z = 0: (max(d, 0)ᵖ + |z|ᵖ)^(1/p) − t,  d = d(x, y, 0)
///
/// The solid contains all points within t of the section by the p-norm: p = 2 rounds the edges to half circles, and larger powers make
/// them sharper. The slope is at most 1, because the p-norm of a vector for p ≥ 2 is at most its length.
#[derive(Clone, Debug, PartialEq)]
pub struct Extruded {
    /// Field whose cross-section is extruded.
    pub of: Box<Field>,
    /// Half of the thickness, t (m).
    pub half_thickness: f64,
    /// log₂ p, at least 1, so that powers and roots are repeated squares and square roots, which have the same bits on all machines.
    pub log_power: u32,
}

impl Extruded {
    pub(super) fn distance<S: Scalar>(&self, [x, y, z]: [S; 3]) -> S {
        let zero = S::constant(0.0);
        let (section, z) = (self.of.distance([x, y, zero]).max(zero), z.abs());
        let (less, more) = (section.min(z), section.max(z));
        if more.value() == 0.0 {
            return S::constant(-self.half_thickness);
        }
        // The power is taken of the quotient, so that it neither overflows nor underflows.
        let squared = |q: S| q * q;
        let power = (0..self.log_power).fold(less.over(more), |q, _| squared(q)).plus(1.0);
        let root = (0..self.log_power).fold(power, |q, _| q.sqrt());
        (more * root).plus(-self.half_thickness)
    }

    pub(super) fn bounds(&self, grow: f64) -> [DVec3; 2] {
        let reach = self.half_thickness + grow;
        let [low, high] = self.of.bounds(reach);
        [low.with_z(-reach), high.with_z(reach)]
    }
}

pub(super) fn offset<S: Scalar>([x, y, z]: [S; 3], from: DVec3) -> [S; 3] {
    [x.plus(-from.x), y.plus(-from.y), z.plus(-from.z)]
}

pub(super) fn dot<S: Scalar>([x, y, z]: [S; 3], v: DVec3) -> S {
    x.times(v.x) + y.times(v.y) + z.times(v.z)
}

pub(super) fn length<S: Scalar>([x, y, z]: [S; 3]) -> S {
    (x * x + y * y + z * z).sqrt()
}
