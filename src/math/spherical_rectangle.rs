//! A rectangle as it is seen from a point, and directions that are uniform in what it covers.
//!
//! In coordinates along its edges, at the height d above its plane: the part of the rectangle below a given x covers
//!
//! Ω(x) = G(x) − G(x₀),    G(x) = A(x, y₁) − A(x, y₀),    sin A(x, y) = sin ψ sin β,    tan ψ = x/d,  tan β = y/d          (sr)
//!
//! which is a law of cosines, sin² G = sin² ψ (a² + b² − 2 a b cos G) for a = sin β₁, b = sin β₀, and so can be solved for x:
//!
//! sin ψ = sin G / √((a − b)² + 4 a b sin²(G/2)),    G = G(x₀) + u Ω
//!
//! Given x, equal areas are equal steps of y / √(x² + y² + d²), the sine of the elevation.
//!
//! Source: Ureña, Fajardo and King, *An Area-Preserving Parametrization for Spherical Rectangles* (2013), of which this is a form
//! without differences of angles; Ω itself is that of two triangles.
//! Tests: solid_angles_of_rectangles, directions_are_uniform, directions_lie_inside, round_trip, mirror_images.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::float::{ONE_MINUS_EPSILON, atan2_f64, sin_cos_f64};
use super::spherical_triangle;

/// In coordinates of its own, in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalRectangle {
    /// Unit vectors along the edges, and towards the plane.
    axes: [DVec3; 3],
    /// The least and the greatest x and y.
    low: DVec2,
    high: DVec2,
    /// d
    height: f64,
    solid_angle: f64,
}

impl SphericalRectangle {
    /// - `corner`: as seen from the origin
    /// - `edges`: from there to the two neighbours, in either order; what the second lacks of a right angle to the first is left out
    /// - `None` for a rectangle seen edge-on, and for one so small that 1/Ω is no finite `f32`: sample it by area instead
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

    /// Ω, up to 2π                                                                          (sr)
    pub fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// 1/Ω inside the rectangle                                                            [sr⁻¹]
    pub fn pdf(&self) -> f32 {
        self.solid_angle.recip() as f32
    }

    /// Whether a ray from the origin meets the rectangle; on an edge either way.
    pub fn contains(&self, w: Vec3) -> bool {
        let [x, y, z] = self.axes.map(|axis| axis.dot(w.as_dvec3()));
        let at = DVec2::new(x, y) * self.height;
        z > 0.0 && at.cmpge(self.low * z).all() && at.cmple(self.high * z).all()
    }

    /// A direction, uniform in the solid angle of the rectangle.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let x = self.cut(u.x.into());
        let rho2 = x * x + self.height * self.height;
        let sine = sine(self.low.y, rho2) + f64::from(u.y) * self.step_of_sines(rho2);
        let y = sine * (rho2 / ((1.0 - sine) * (1.0 + sine))).sqrt();
        let y = y.clamp(self.low.y, self.high.y);
        let [along_x, along_y, upwards] = self.axes;
        (x * along_x + y * along_y + self.height * upwards).normalize().as_vec3()
    }

    /// Of a direction inside.
    pub fn sample_inverse(&self, w: Vec3) -> Vec2 {
        let w = DVec3::from(self.axes.map(|axis| axis.dot(w.as_dvec3())));
        let (x, y) = (self.height * (w.x / w.z), self.height * (w.y / w.z));
        let rho2 = x * x + self.height * self.height;
        let share = (self.covered(x) - self.covered(self.low.x)) / self.solid_angle;
        let height = (sine(y, rho2) - sine(self.low.y, rho2)) / self.step_of_sines(rho2);
        Vec2::new(share as f32, height as f32).clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
    }

    /// The x below which the rectangle has the share `u` of its solid angle.
    fn cut(&self, u: f64) -> f64 {
        let target = self.covered(self.low.x) + u * self.solid_angle;
        let (sin_half, cos_half) = sin_cos_f64(0.5 * target);
        let d2 = self.height * self.height;
        let (step, product) = (self.step_of_sines(d2), sine(self.low.y, d2) * sine(self.high.y, d2));
        // What is under the root less sin² G: tan ψ follows from it.
        let square = step * step - 4.0 * sin_half * sin_half * (cos_half * cos_half - product);
        let x = self.height * 2.0 * sin_half * cos_half / square.max(0.0).sqrt();
        x.clamp(self.low.x, self.high.x)
    }

    /// G(x): what covers the strip from 0 to x between the two edges along x; negative for negative x.
    fn covered(&self, x: f64) -> f64 {
        let d = self.height;
        let a = |y: f64| atan2_f64(x * y, d * (x * x + y * y + d * d).sqrt());
        a(self.high.y) - a(self.low.y)
    }

    /// How much farther up the greater y is than the lesser, as sines; not by a difference where both are near 1.
    fn step_of_sines(&self, rho2: f64) -> f64 {
        let (y, other) = (self.high.y, self.low.y);
        let (a, b) = (sine(y, rho2), sine(other, rho2));
        if a * b <= 0.0 {
            return a - b;
        }
        rho2 * (y - other) * (y + other) / ((y * y + rho2) * (other * other + rho2) * (a + b))
    }
}

/// Of the elevation of a point at the height y and the distance ρ from the axis.
fn sine(y: f64, rho2: f64) -> f64 {
    y / (y * y + rho2).sqrt()
}
