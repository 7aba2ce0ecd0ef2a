//! Solid angle of a rectangle, and uniform sampling of it.
//!
//! In coordinates along the edges, seen from the height d above the plane, the part of the rectangle below a given x has the solid angle
//!
//! Ω(x) = G(x) − G(x₀),    G(x) = A(x, y₁) − A(x, y₀),    sin A(x, y) = sin ψ sin β,    tan ψ = x/d,  tan β = y/d          (sr)
//!
//! The law of cosines sin² G = sin² ψ (a² + b² − 2 a b cos G), with a = sin β₁ and b = sin β₀, can be solved for x:
//!
//! sin ψ = sin G / √((a − b)² + 4 a b sin²(G/2)),    G = G(x₀) + u Ω
//!
//! For a given x, equal areas are equal steps of y / √(x² + y² + d²), the sine of the elevation.
//!
//! Source: Ureña, Fajardo and King, *An Area-Preserving Parametrization for Spherical Rectangles* (2013), here in a form without
//! differences of angles. Ω itself is computed as that of two triangles.
//! Tests: solid_angles_of_rectangles, directions_are_uniform, directions_lie_inside, round_trip, mirror_images.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::float::{ONE_MINUS_EPSILON, atan2_f64, sin_cos_f64};
use super::spherical_triangle;

/// Rectangle seen from the origin, in coordinates along its edges and in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalRectangle {
    /// Unit vectors along the two edges and towards the plane.
    axes: [DVec3; 3],
    /// Least x and y.
    low: DVec2,
    /// Greatest x and y.
    high: DVec2,
    /// Distance d of the plane.
    height: f64,
    solid_angle: f64,
}

impl SphericalRectangle {
    /// A rectangle; `None` if it is seen edge-on, or is so small that 1/Ω is not a finite `f32` and it should be sampled by area.
    ///
    /// - `corner`: a corner, relative to the viewer
    /// - `edges`: vectors from there to the two neighbours, in either order. The second is made perpendicular to the first.
    pub fn new(corner: Vec3, edges: [Vec3; 2]) -> Option<SphericalRectangle> {
        let [corner, to_x, to_y] = [corner, edges[0], edges[1]].map(Vec3::as_dvec3);
        let x = to_x.try_normalize()?;
        let to_y = to_y - to_y.dot(x) * x;
        let y = to_y.try_normalize()?;
        let normal = x.cross(y);
        let z = normal * 1f64.copysign(corner.dot(normal));
        let low = DVec2::new(corner.dot(x), corner.dot(y));
        let high = low + DVec2::new(to_x.length(), to_y.length());
        let height = corner.dot(z);
        let at = |x: f64, y: f64| DVec3::new(x, y, height);
        let [a, b, c, d] = [at(low.x, low.y), at(high.x, low.y), at(high.x, high.y), at(low.x, high.y)];
        let solid_angle = spherical_triangle::solid_angle([a, b, c]) + spherical_triangle::solid_angle([c, d, a]);
        let is_seen = (solid_angle.recip() as f32).is_finite();
        is_seen.then_some(SphericalRectangle { axes: [x, y, z], low, high, height, solid_angle })
    }

    /// Solid angle Ω, up to 2π                                                                          (sr)
    pub fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// Density 1/Ω of a direction inside the rectangle                                                            [sr⁻¹]
    pub fn pdf(&self) -> f32 {
        self.solid_angle.recip() as f32
    }

    /// Whether a ray from the origin hits the rectangle. The result is undefined for directions on an edge.
    pub fn contains(&self, w: Vec3) -> bool {
        let [x, y, z] = self.axes.map(|axis| axis.dot(w.as_dvec3()));
        let at = DVec2::new(x, y) * self.height;
        z > 0.0 && at.cmpge(self.low * z).all() && at.cmple(self.high * z).all()
    }

    /// Samples a direction uniformly in the solid angle of the rectangle.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let x = self.cut(u.x.into());
        let rho2 = x * x + self.height * self.height;
        let sine = sine(self.low.y, rho2) + f64::from(u.y) * self.sine_difference(rho2);
        let y = sine * (rho2 / ((1.0 - sine) * (1.0 + sine))).sqrt();
        let y = y.clamp(self.low.y, self.high.y);
        let [along_x, along_y, upwards] = self.axes;
        (x * along_x + y * along_y + self.height * upwards).normalize().as_vec3()
    }

    /// Inverse of [`SphericalRectangle::sample`] for a direction inside.
    pub fn sample_inverse(&self, w: Vec3) -> Vec2 {
        let w = DVec3::from(self.axes.map(|axis| axis.dot(w.as_dvec3())));
        let (x, y) = (self.height * (w.x / w.z), self.height * (w.y / w.z));
        let rho2 = x * x + self.height * self.height;
        let share = (self.strip_angle(x) - self.strip_angle(self.low.x)) / self.solid_angle;
        let height = (sine(y, rho2) - sine(self.low.y, rho2)) / self.sine_difference(rho2);
        Vec2::new(share as f32, height as f32).clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
    }

    /// The x below which the fraction `u` of the solid angle lies.
    fn cut(&self, u: f64) -> f64 {
        let target = self.strip_angle(self.low.x) + u * self.solid_angle;
        let (sin_half, cos_half) = sin_cos_f64(0.5 * target);
        let d2 = self.height * self.height;
        let (step, product) = (self.sine_difference(d2), sine(self.low.y, d2) * sine(self.high.y, d2));
        // The square under the root minus sin² G, from which tan ψ follows.
        let square = step * step - 4.0 * sin_half * sin_half * (cos_half * cos_half - product);
        let x = self.height * 2.0 * sin_half * cos_half / square.max(0.0).sqrt();
        x.clamp(self.low.x, self.high.x)
    }

    /// G(x), the signed solid angle of the strip from 0 to x between the two edges along x.
    fn strip_angle(&self, x: f64) -> f64 {
        let d = self.height;
        let a = |y: f64| atan2_f64(x * y, d * (x * x + y * y + d * d).sqrt());
        a(self.high.y) - a(self.low.y)
    }

    /// Difference of the sines of elevation of the greater and the lesser y, computed without cancellation if both are near 1.
    fn sine_difference(&self, rho2: f64) -> f64 {
        let (y, other) = (self.high.y, self.low.y);
        let (a, b) = (sine(y, rho2), sine(other, rho2));
        if a * b <= 0.0 {
            return a - b;
        }
        rho2 * (y - other) * (y + other) / ((y * y + rho2) * (other * other + rho2) * (a + b))
    }
}

/// Sine of the elevation of a point at the height y and the distance ρ from the axis.
fn sine(y: f64, rho2: f64) -> f64 {
    y / (y * y + rho2).sqrt()
}
