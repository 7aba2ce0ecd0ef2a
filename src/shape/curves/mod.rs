//! Curves: hair, fur, grass, threads and wires.

mod line;
mod packed_normal;
mod piece;
mod ribbon;
mod strands;
mod tube;

use std::ops::Range;

use glam::{DVec3, Vec3, Vec4, Vec4Swizzles as _};

use super::{Detail, Geometry, Shape};
use crate::error::{Error, Fault, Result};
use crate::math::Transform;
use packed_normal::PackedNormal;
use ribbon::Ribbons;
use strands::{MOST_POINTS, Strands};
use tube::Tubes;

/// Curves with a radius at each control point: tubes, or ribbons.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// How a curve follows from its control points.
    pub basis: Basis,
    /// Position (m) and radius (m) of the control points, curve after curve. The radius of a ribbon is half its width.
    pub points: Vec<Vec4>,
    /// Number of control points of each curve.
    pub counts: Vec<u32>,
    /// Normals at the control points of ribbons; empty for tubes.
    pub normals: Vec<Vec3>,
}

/// How a curve follows from its control points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Straight lines from point to point.
    Linear,
    /// Cubic Bézier curves: two points in between for each span.
    Bezier,
    /// Uniform cubic B-spline. It does not reach its points.
    Bspline,
    /// Cubic Catmull–Rom spline, which passes through all points. The ends are extended in a straight line.
    CatmullRom,
}

impl Basis {
    /// Whether some number of points is that of a curve.
    pub fn fits(self, points: usize) -> bool {
        match self {
            Basis::Linear | Basis::CatmullRom => points >= 2,
            Basis::Bspline => points >= 4,
            Basis::Bezier => points >= 4 && points % 3 == 1,
        }
    }
}

/// Greatest error of the entries of MᵀM/s² beside those of the identity, for a transform M that scales all lengths by s. It is far above the
/// rounding of transforms that are composed of several steps, and makes a circle an ellipse by less than a millionth.
const ROUND: f64 = 1e-6;

impl Curves {
    /// The factor by which a transform scales lengths; `None` if it differs between directions.
    pub fn scale(to_world: &Transform) -> Option<f64> {
        let m = to_world.matrix().matrix3;
        let scale = to_world.determinant().abs().cbrt();
        let product = m.transpose() * m * (1.0 / (scale * scale));
        let columns = [product.x_axis - DVec3::X, product.y_axis - DVec3::Y, product.z_axis - DVec3::Z];
        columns.into_iter().all(|column| column.abs().max_element() <= ROUND).then_some(scale)
    }

    /// Places of the control points of each curve that has a span, without points that are left over.
    fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        let mut next = 0;
        let range = move |count: &u32| {
            let first = next;
            next += *count as usize;
            first..first + self.basis.used(*count as usize)
        };
        self.counts.iter().map(range).filter(|range| !range.is_empty())
    }

    /// Positions and radii in world space.
    ///
    /// - `scale`: factor of lengths
    fn placed(&self, range: Range<usize>, to_world: &Transform, scale: f64) -> impl Iterator<Item = Vec4> {
        self.points[range].iter().map(move |b| to_world.point(b.xyz().as_dvec3()).extend(f64::from(b.w) * scale).as_vec4())
    }

    /// The curves in world space.
    ///
    /// - `scale`: factor of lengths
    fn strands(&self, to_world: &Transform, scale: f64) -> Strands {
        let (mut points, mut normals) = (Vec::with_capacity(self.points.len()), Vec::with_capacity(self.normals.len()));
        for range in self.ranges() {
            points.extend(self.placed(range.clone(), to_world, scale));
            let of_curve = if self.normals.is_empty() { &[] } else { &self.normals[range] };
            normals.extend(of_curve.iter().map(|n| PackedNormal::new(to_world.normal(n.as_dvec3()))));
        }
        Strands::new(self.basis, points, normals, self.ranges().map(|range| range.len()))
    }
}

impl Geometry for Curves {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        let scale = to_world.determinant().abs().cbrt();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut points = vec![];
        for range in self.ranges() {
            points.clear();
            points.extend(self.placed(range, to_world, scale));
            for k in 0..self.basis.spans(points.len()) {
                let (min, max) = self.basis.span(&points, k).bounds();
                (low, high) = (low.min(min), high.max(max));
            }
        }
        (low, high)
    }

    fn detail(&self, to_world: &Transform) -> Detail {
        let (min, max) = self.bounds(to_world);
        let count = self.points.len() as f64;
        let sum: DVec3 = self.points.iter().map(|b| to_world.point(b.xyz().as_dvec3())).sum();
        // One of n pieces that fill a volume of the extent e has a size of about e/∛n.
        Detail { middle: sum / count, density: count * count.cbrt() / (max - min).max_element() }
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        let invalid = |message: &str| Err(Error::invalid(Fault::new(message)));
        let Some(scale) = Curves::scale(to_world) else {
            return invalid("a transform stretches or shears curves, which stay round");
        };
        if self.points.len() > MOST_POINTS {
            return invalid("too many control points of curves: expected at most a thousand million");
        }
        let strands = self.strands(to_world, scale);
        Ok(match self.normals.is_empty() {
            true => Box::new(Tubes(strands)),
            false => Box::new(Ribbons(strands)),
        })
    }
}
