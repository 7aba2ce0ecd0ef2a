//! Curves: tubes and ribbons. What is expected follows from the definitions of the splines and from many balls, or lines, along them, which pt
//! does not use.

mod hits;
mod surface;

use glam::{DVec3, DVec4, Vec3, Vec4Swizzles as _};
use pt::math::Transform;
use pt::shape::curves::Basis;
use pt::shape::{Curves, Geometry, Shape};

use crate::random::Random;

/// One curve, by the formulas of its spline.
#[derive(Clone, Debug)]
struct Spline {
    basis: Basis,
    /// Positions and radii.
    points: Vec<DVec4>,
}

impl Spline {
    fn spans(&self) -> usize {
        match self.basis {
            Basis::Linear | Basis::CatmullRom => self.points.len() - 1,
            Basis::Bspline => self.points.len() - 3,
            Basis::Bezier => (self.points.len() - 1) / 3,
        }
    }

    /// Position and radius at the share `u` of the spans.
    fn at(&self, u: f64) -> DVec4 {
        let spans = self.spans();
        let k = ((u * spans as f64) as usize).min(spans - 1);
        let t = u * spans as f64 - k as f64;
        let p = |i: isize| -> DVec4 {
            let n = self.points.len() as isize;
            match i {
                -1 => 2.0 * self.points[0] - self.points[1],
                i if i == n => 2.0 * self.points[n as usize - 1] - self.points[n as usize - 2],
                i => self.points[i as usize],
            }
        };
        let i = k as isize;
        let (t2, t3) = (t * t, t * t * t);
        match self.basis {
            Basis::Linear => p(i) * (1.0 - t) + p(i + 1) * t,
            Basis::Bezier => {
                let i = 3 * i;
                let w = 1.0 - t;
                p(i) * (w * w * w) + p(i + 1) * (3.0 * w * w * t) + p(i + 2) * (3.0 * w * t2) + p(i + 3) * t3
            }
            Basis::Bspline => {
                let weights = [(1.0 - t).powi(3), 3.0 * t3 - 6.0 * t2 + 4.0, -3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0, t3];
                (0..4).map(|j| p(i + j as isize) * (weights[j] / 6.0)).sum()
            }
            Basis::CatmullRom => {
                let [a, b, c, d] = [p(i - 1), p(i), p(i + 1), p(i + 2)];
                0.5 * (2.0 * b + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * t2 + (3.0 * b - a - 3.0 * c + d) * t3)
            }
        }
    }

    fn curves(&self) -> Curves {
        Curves {
            basis: self.basis,
            points: self.points.iter().map(|p| p.as_vec4()).collect(),
            counts: vec![self.points.len() as u32],
            normals: vec![],
        }
    }

    fn tube(&self) -> Box<dyn Shape> {
        self.curves().bake(&Transform::IDENTITY).expect("a curve")
    }
}

const BASES: [Basis; 4] = [Basis::Linear, Basis::Bezier, Basis::Bspline, Basis::CatmullRom];

/// A curve of a size of about 1 that bends gently, with radii between .02 and .1. The numbers are those of f32.
fn random_spline(basis: Basis, random: &mut Random) -> Spline {
    let count = if basis == Basis::Bezier { 4 } else { 5 };
    let (mut p, mut direction) = (random.in_cube() * 0.3, random.direction());
    let points = (0..count).map(|_| {
        p += direction * random.range(0.2, 0.4);
        direction = (direction + 0.5 * random.direction()).normalize();
        p.extend(random.range(0.02, 0.1)).as_vec4().as_dvec4()
    });
    Spline { basis, points: points.collect() }
}

/// Radius of the ball at the origin that contains all of these curves.
const EXTENT: f64 = 3.0;

/// A ribbon, by its formula.
struct RibbonSpline {
    centre: Spline,
    /// Normals, as points of a spline of the same kind.
    normal: Spline,
}

impl RibbonSpline {
    fn random(basis: Basis, random: &mut Random) -> RibbonSpline {
        let centre = random_spline(basis, random);
        // Nearly perpendicular to the curve: where the normal is along it, a ribbon has no direction.
        let chord = |k: usize| (centre.points[(k + 1).min(centre.points.len() - 1)] - centre.points[k.saturating_sub(1)]).xyz().normalize();
        let mut normal = random.direction().cross(chord(0)).normalize();
        let normals = (0..centre.points.len()).map(|k| {
            normal = (normal + 0.3 * random.direction()).reject_from_normalized(chord(k)).normalize();
            normal.extend(0.0).as_vec4().as_dvec4()
        });
        RibbonSpline { normal: Spline { basis, points: normals.collect() }, centre }
    }

    /// The point at the share `u` of the spans and `v` of the width, by a difference of points for the tangent.
    fn point(&self, u: f64, v: f64) -> DVec3 {
        let spans = self.centre.spans() as f64;
        // Both points lie on the same span.
        let span = (u * spans).floor().min(spans - 1.0);
        let (from, to) = (span / spans, (span + 1.0) / spans);
        let step = 1e-6;
        let (before, after) = ((u - step).max(from), (u + step).min(to - 1e-12));
        let tangent = self.centre.at(after) - self.centre.at(before);
        let b = tangent.xyz().cross(self.normal.at(u.min(to - 1e-12)).xyz()).normalize();
        let c = self.centre.at(u.min(to - 1e-12));
        c.xyz() + b * (c.w * (2.0 * v - 1.0))
    }

    fn shape(&self) -> Box<dyn Shape> {
        let normals: Vec<Vec3> = self.normal.points.iter().map(|p| p.xyz().as_vec3()).collect();
        Curves { normals, ..self.centre.curves() }.bake(&Transform::IDENTITY).expect("a ribbon")
    }
}
