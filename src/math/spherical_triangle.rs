//! Solid angle of a triangle, and uniform sampling of it.
//!
//! tan(Ω/2) = |det(a, b, c)| / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|)                (sr)
//!
//! The arc from b to a point c′ of the arc from a to c cuts off a fraction u of Ω. With c′ = cos t a + sin t e, where e is the direction
//! at a towards c, the formula can be solved for t:
//!
//! tan(t/2) = sin σ (1 + a·b) / (cos σ |det(a, b, e)| − sin σ (b·e)),    σ = u Ω/2
//!
//! On the arc from b to c′, equal areas are equal steps of 1 − cos θ, where θ is the angle from b. Unlike in Girard's formula, no angle is
//! a difference of angles, so that tiny triangles are computed precisely.
//!
//! Source: Van Oosterom and Strackee, *The Solid Angle of a Plane Triangle* (1983); the division of the triangle is that of
//! Arvo, *Stratified Sampling of Spherical Triangles* (1995).
//! Tests: row G13 of `pt torture`, directions_are_uniform, directions_lie_inside, round_trip, mirror_images.

use glam::{DVec3, Vec2, Vec3};

use super::float::{ONE_MINUS_EPSILON, atan2_f64_lanes, sin_cos_f64};
use super::lanes::{Lanes, One, VectorF64};

/// Triangle seen from the origin. The corners are unit vectors in double precision, because they may be closer than an `f32` resolves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalTriangle {
    a: DVec3,
    b: DVec3,
    c: DVec3,
    /// Unit tangent at a towards c.
    e: DVec3,
    solid_angle: f64,
}

impl SphericalTriangle {
    /// A triangle; `None` if it is seen edge-on, or is so small that 1/Ω is not a finite `f32` and it should be sampled by area.
    ///
    /// - `corners`: corners relative to the viewer, at any distance and in either order
    pub fn new(corners: [Vec3; 3]) -> Option<SphericalTriangle> {
        let solid_angle = solid_angle(corners.map(Vec3::as_dvec3));
        let [a, b, c] = corners.map(|corner| corner.as_dvec3().normalize());
        let e = (c - a) - a.dot(c - a) * a;
        let is_seen = (solid_angle.recip() as f32).is_finite() && e != DVec3::ZERO;
        is_seen.then(|| SphericalTriangle { a, b, c, e: e.normalize(), solid_angle })
    }

    /// Solid angle Ω, up to 2π                                                                          (sr)
    pub fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// Density 1/Ω of a direction inside the triangle                                                             [sr⁻¹]
    pub fn pdf(&self) -> f32 {
        self.solid_angle.recip() as f32
    }

    /// Whether a ray from the origin hits the triangle. The result is undefined for directions on an edge.
    pub fn contains(&self, w: Vec3) -> bool {
        let w = w.as_dvec3();
        let [a, b, c] = [(self.b, self.c), (self.c, self.a), (self.a, self.b)].map(|(p, q)| p.cross(q - p).dot(w));
        let orientation = self.a.cross(self.b - self.a).dot(self.c);
        [a, b, c].iter().all(|side| side * orientation >= 0.0)
    }

    /// Samples a direction uniformly in the solid angle of the triangle.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let (share, height) = (f64::from(u.x), f64::from(u.y));
        let edge_end = self.cut(share);
        let chord2 = (edge_end - self.b).length_squared();
        // h = 1 − cos θ. For the whole arc it is half the square of the chord.
        let h = 0.5 * height * chord2;
        let along = ((edge_end - self.b) + 0.5 * chord2 * self.b).normalize_or_zero();
        (self.b + ((h * (2.0 - h)).sqrt() * along - h * self.b)).as_vec3()
    }

    /// Inverse of [`SphericalTriangle::sample`] for a direction inside. At the second corner u.x is arbitrary.
    pub fn sample_inverse(&self, w: Vec3) -> Vec2 {
        let w = w.as_dvec3().normalize();
        // Intersection of the plane through b and w with the arc from a to c.
        let end = (self.b.cross(w - self.b)).cross(self.a.cross(self.c - self.a)).normalize_or(self.c);
        let end = if end.dot(self.a + self.c) < 0.0 { -end } else { end };
        let share = solid_angle([self.a, self.b, end]) / self.solid_angle;
        let height = (w - self.b).length_squared() / (end - self.b).length_squared();
        Vec2::new(share as f32, height as f32).clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
    }

    /// Point c′ of the arc from a to c for which the triangle a, b, c′ has the fraction `u` of the solid angle.
    fn cut(&self, u: f64) -> DVec3 {
        let (sin, cos) = sin_cos_f64(0.5 * u * self.solid_angle);
        let (a, b, e) = (self.a, self.b, self.e);
        let det = a.cross(b - a).dot(e).abs();
        let (p, q) = (sin * 0.5 * (a + b).length_squared(), cos * det - sin * b.dot(e));
        // cos t and sin t from p/q = tan(t/2).
        let sum = p * p + q * q;
        a + (2.0 * p / sum) * (q * e - p * a)
    }
}

/// Solid angle Ω of a triangle seen from the origin (sr); 0 if it is seen edge-on.
fn solid_angle(corners: [DVec3; 3]) -> f64 {
    solid_angle_lanes::<One>(corners.map(VectorF64::splat))
}

/// [`solid_angle`] in each lane.
#[inline(always)]
pub(super) fn solid_angle_lanes<L: Lanes>([a, b, c]: [VectorF64<L>; 3]) -> L::F64 {
    let lengths = VectorF64::<L> { x: a.length(), y: b.length(), z: c.length() };
    let det = L::abs_f64(a.dot((b - a).cross(c - a)));
    let products = VectorF64 { x: b.dot(c), y: c.dot(a), z: a.dot(b) };
    let sum = lengths.x * lengths.y * lengths.z + products.dot(lengths);
    let zero = L::f64(0.0);
    L::select_f64(L::lt_f64(zero, det), L::f64(2.0) * atan2_f64_lanes::<L>(det, sum), zero)
}
