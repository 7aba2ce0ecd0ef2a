//! Fields seen through a change of space.

use glam::{DMat3, DVec3};

use super::dual::Scalar;
use super::{Field, everywhere};
use crate::math::Transform;

/// A field moved, turned, stretched: s · d(M⁻¹ p),  s the least factor by which M stretches a length
///
/// With s every stretch keeps the field's slope within 1; exact where M keeps shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    of: Box<Field>,
    to_world: Transform,
    /// Of M⁻¹: its rows, and what is added.
    rows: [DVec3; 3],
    shift: DVec3,
    scale: f64,
}

impl Placed {
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

/// The box around a box that is moved; everywhere, where it has no end.
pub(super) fn around([low, high]: [DVec3; 2], to_world: &Transform) -> [DVec3; 2] {
    if !(low.is_finite() && high.is_finite()) {
        return everywhere();
    }
    let corners = (0..8).map(|k| DVec3::select(glam::BVec3::new(k & 1 != 0, k & 2 != 0, k & 4 != 0), high, low));
    let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    corners.map(|p| to_world.point(p)).fold(nothing, |[low, high], p| [low.min(p), high.max(p)])
}

/// The most by which a matrix stretches a length: exactly where it keeps shapes, else √(‖M‖₁ ‖M‖∞), which is no less.
pub(super) fn greatest_stretch(m: DMat3) -> f64 {
    let square = m.transpose() * m;
    let s2 = square.x_axis.x.max(square.y_axis.y).max(square.z_axis.z);
    // A few roundings of each entry.
    let near = |column: DVec3, e: DVec3| (column - e * s2).abs().max_element() <= 16.0 * f64::EPSILON * s2;
    if near(square.x_axis, DVec3::X) && near(square.y_axis, DVec3::Y) && near(square.z_axis, DVec3::Z) {
        return s2.sqrt();
    }
    let norm = |m: DMat3| m.x_axis.abs().element_sum().max(m.y_axis.abs().element_sum()).max(m.z_axis.abs().element_sum());
    (norm(m) * norm(m.transpose())).sqrt()
}

/// What lies at positive coordinates, and its mirror image: d(|x|, y, z)
#[derive(Clone, Debug, PartialEq)]
pub struct Mirrored {
    pub of: Box<Field>,
    /// The axis across the mirror: 0, 1, 2.
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

/// Copies in a row, one in each cell of the width `period`: the least of d(x − k T) over two neighbours
///
/// The cells are centred about the field, which must fit in one. The copy in the point's own cell may be farther away
/// than one next door, on the side of the cell's middle on which the point lies: that is looked at too.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeated {
    of: Box<Field>,
    axis: usize,
    period: f64,
    copies: [f64; 2],
    /// Of the cell k = 0.
    middle: f64,
}

impl Repeated {
    /// - `axis`: 0, 1, 2
    /// - `period`: T (m)
    /// - `copies`: the first and the last k; without end where they are infinite
    ///
    /// `None` where the field does not fit into a cell.
    pub fn new(of: Field, axis: usize, period: f64, copies: [f64; 2]) -> Option<Repeated> {
        let [low, high] = of.bounds(0.0).map(|corner| corner[axis]);
        let fits = high - low <= period;
        fits.then(|| Repeated { of: Box::new(of), axis, period, copies, middle: 0.5 * (low + high) })
    }

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

/// The cross-section of a field at z = 0 as a bar along a tube: (max(d, 0)ᵖ + |z|ᵖ)^(1/p) − t,  d = d(x, y, 0)
///
/// All points within t of the section, by the p-norm: p = 2 rounds the edges to half circles, larger powers make them
/// sharper. Its slope is at most 1, for the p-norm of a vector is at most its length.
#[derive(Clone, Debug, PartialEq)]
pub struct Extruded {
    pub of: Box<Field>,
    /// t (m)
    pub half_thickness: f64,
    /// log₂ p, at least 1: powers and roots are squares and square roots then, the same on every machine.
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
        // By their quotient, so that no power overflows or vanishes.
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
