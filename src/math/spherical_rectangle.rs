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
//! differences of angles. Ω itself is computed as that of two triangles. All is written once for several viewers, one in each lane; one
//! lane is a single viewer.
//! Tests: solid_angles_of_rectangles, directions_are_uniform, directions_lie_inside, round_trip, mirror_images.

use glam::{DVec3, Vec2, Vec3};

use super::float::{ONE_MINUS_EPSILON, atan2_f64_lanes, sin_cos_f64_lanes};
use super::lanes::{Lanes, One, Vector, VectorF64};
use super::spherical_triangle::solid_angle_lanes;

/// Unit vectors along the edges of a rectangle, and their lengths, in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectangleFrame {
    x: DVec3,
    y: DVec3,
    normal: DVec3,
    lengths: [f64; 2],
}

impl RectangleFrame {
    /// A frame; `None` if the edges are parallel or too short.
    ///
    /// - `edges`: vectors from a corner to the two neighbours, in either order. The second is made perpendicular to the first.
    pub fn new(edges: [Vec3; 2]) -> Option<RectangleFrame> {
        let [to_x, to_y] = edges.map(Vec3::as_dvec3);
        let x = to_x.try_normalize()?;
        let to_y = to_y - to_y.dot(x) * x;
        let y = to_y.try_normalize()?;
        Some(RectangleFrame { x, y, normal: x.cross(y), lengths: [to_x.length(), to_y.length()] })
    }
}

/// Rectangle seen from the origin, in coordinates along its edges and in double precision; with several lanes as many of the same
/// rectangle, at different places.
#[derive(Clone, Copy)]
pub struct SphericalRectangle<L: Lanes = One> {
    /// Unit vectors along the two edges and towards the plane.
    axes: [VectorF64<L>; 3],
    /// Least x and y.
    low: [L::F64; 2],
    /// Greatest x and y.
    high: [L::F64; 2],
    /// Distance d of the plane.
    height: L::F64,
    solid_angle: L::F64,
}

impl SphericalRectangle {
    /// A rectangle; `None` if it is seen edge-on, or is so small that 1/Ω is not a finite `f32` and it should be sampled by area.
    ///
    /// - `corner`: a corner, relative to the viewer
    /// - `edges`: vectors from there to the two neighbours, in either order. The second is made perpendicular to the first.
    pub fn new(corner: Vec3, edges: [Vec3; 2]) -> Option<SphericalRectangle> {
        let (rectangle, is_seen) = SphericalRectangle::<One>::seen(&RectangleFrame::new(edges)?, corner.into());
        is_seen.then_some(rectangle)
    }

    /// Solid angle Ω, up to 2π                                                                          (sr)
    pub fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// Density 1/Ω of a direction inside the rectangle                                                            [sr⁻¹]
    pub fn pdf(&self) -> f32 {
        self.pdf_lanes()
    }

    /// Whether a ray from the origin hits the rectangle. The result is undefined for directions on an edge.
    pub fn contains(&self, w: Vec3) -> bool {
        let [x, y, z] = self.coordinates(w);
        let (x, y) = (x * self.height, y * self.height);
        let ([low_x, low_y], [high_x, high_y]) = (self.low, self.high);
        z > 0.0 && x >= low_x * z && y >= low_y * z && x <= high_x * z && y <= high_y * z
    }

    /// Samples a direction uniformly in the solid angle of the rectangle.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        self.sample_lanes(u.into()).into()
    }

    /// Inverse of [`SphericalRectangle::sample`] for a direction inside.
    pub fn sample_inverse(&self, w: Vec3) -> Vec2 {
        let [x, y, z] = self.coordinates(w);
        let (x, y) = (self.height * (x / z), self.height * (y / z));
        let rho2 = x * x + self.height * self.height;
        let share = (self.strip_angle(x) - self.strip_angle(self.low[0])) / self.solid_angle;
        let height = (sine::<One>(y, rho2) - sine::<One>(self.low[1], rho2)) / self.sine_difference(rho2);
        Vec2::new(share as f32, height as f32).clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
    }

    /// Coordinates of a direction along the axes.
    fn coordinates(&self, w: Vec3) -> [f64; 3] {
        let w = Vector::<One>::from(w).widened();
        self.axes.map(|axis| axis.dot(w))
    }
}

impl<L: Lanes> SphericalRectangle<L> {
    /// Rectangles at different places, and the lanes in which they are seen: see [`SphericalRectangle::new`].
    ///
    /// - `corner`: the corner of each, relative to the viewer
    #[inline(always)]
    pub fn seen(frame: &RectangleFrame, corner: Vector<L>) -> (SphericalRectangle<L>, L::Mask) {
        let corner = corner.widened();
        let (x, y, normal) = (VectorF64::<L>::splat(frame.x), VectorF64::splat(frame.y), VectorF64::splat(frame.normal));
        let is_below = L::lt_f64(corner.dot(normal), L::f64(0.0));
        let z = normal.scaled(L::select_f64(is_below, L::f64(-1.0), L::f64(1.0)));
        let low = [corner.dot(x), corner.dot(y)];
        let high = [low[0] + L::f64(frame.lengths[0]), low[1] + L::f64(frame.lengths[1])];
        let height = corner.dot(z);
        let a = VectorF64 { x: low[0], y: low[1], z: height };
        let b = VectorF64 { x: high[0], y: low[1], z: height };
        let c = VectorF64 { x: high[0], y: high[1], z: height };
        let d = VectorF64 { x: low[0], y: high[1], z: height };
        let solid_angle = solid_angle_lanes::<L>([a, b, c]) + solid_angle_lanes::<L>([c, d, a]);
        let rectangle = SphericalRectangle { axes: [x, y, z], low, high, height, solid_angle };
        (rectangle, L::lt(L::abs(rectangle.pdf_lanes()), L::f32(f32::INFINITY)))
    }

    /// [`SphericalRectangle::pdf`] in each lane.
    #[inline(always)]
    pub fn pdf_lanes(&self) -> L::F32 {
        L::narrow(L::f64(1.0) / self.solid_angle)
    }

    /// [`SphericalRectangle::sample`] in each lane.
    #[inline(always)]
    pub fn sample_lanes(&self, [u, v]: [L::F32; 2]) -> Vector<L> {
        let x = self.cut(L::widen(u));
        let rho2 = x * x + self.height * self.height;
        let sine = sine::<L>(self.low[1], rho2) + L::widen(v) * self.sine_difference(rho2);
        let one = L::f64(1.0);
        let y = sine * L::sqrt_f64(rho2 / ((one - sine) * (one + sine)));
        let y = clamped::<L>(y, self.low[1], self.high[1]);
        let [along_x, along_y, upwards] = self.axes;
        (along_x.scaled(x) + along_y.scaled(y) + upwards.scaled(self.height)).normalized().narrowed()
    }

    /// The x below which the fraction `u` of the solid angle lies.
    #[inline(always)]
    fn cut(&self, u: L::F64) -> L::F64 {
        let target = self.strip_angle(self.low[0]) + u * self.solid_angle;
        let (sin_half, cos_half) = sin_cos_f64_lanes::<L>(L::f64(0.5) * target);
        let d2 = self.height * self.height;
        let (step, product) = (self.sine_difference(d2), sine::<L>(self.low[1], d2) * sine::<L>(self.high[1], d2));
        // The square under the root minus sin² G, from which tan ψ follows.
        let square = step * step - L::f64(4.0) * sin_half * sin_half * (cos_half * cos_half - product);
        let x = self.height * L::f64(2.0) * sin_half * cos_half / L::sqrt_f64(L::max_f64(square, L::f64(0.0)));
        clamped::<L>(x, self.low[0], self.high[0])
    }

    /// G(x), the signed solid angle of the strip from 0 to x between the two edges along x.
    #[inline(always)]
    fn strip_angle(&self, x: L::F64) -> L::F64 {
        self.strip_side(x, self.high[1]) - self.strip_side(x, self.low[1])
    }

    /// A(x, y).
    #[inline(always)]
    fn strip_side(&self, x: L::F64, y: L::F64) -> L::F64 {
        let d = self.height;
        atan2_f64_lanes::<L>(x * y, d * L::sqrt_f64(x * x + y * y + d * d))
    }

    /// Difference of the sines of elevation of the greater and the lesser y, computed without cancellation if both are near 1.
    #[inline(always)]
    fn sine_difference(&self, rho2: L::F64) -> L::F64 {
        let (y, other) = (self.high[1], self.low[1]);
        let (a, b) = (sine::<L>(y, rho2), sine::<L>(other, rho2));
        let without_cancellation = rho2 * (y - other) * (y + other) / ((y * y + rho2) * (other * other + rho2) * (a + b));
        L::select_f64(L::lt_f64(L::f64(0.0), a * b), without_cancellation, a - b)
    }
}

/// Sine of the elevation of a point at the height y and the distance ρ from the axis.
#[inline(always)]
fn sine<L: Lanes>(y: L::F64, rho2: L::F64) -> L::F64 {
    y / L::sqrt_f64(y * y + rho2)
}

/// Number in the range from `low` to `high` that is nearest to `x`; NaN for NaN.
#[inline(always)]
fn clamped<L: Lanes>(x: L::F64, low: L::F64, high: L::F64) -> L::F64 {
    let x = L::select_f64(L::lt_f64(x, low), low, x);
    L::select_f64(L::lt_f64(high, x), high, x)
}
