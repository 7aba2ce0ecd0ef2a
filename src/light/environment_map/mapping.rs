//! Maps between a picture and the directions around a scene.

use std::f32::consts::{PI, TAU};

use glam::{IVec2, UVec2, Vec2, Vec3};

use crate::math::equal_area::{sphere_to_square, square_to_sphere};
use crate::math::float::{atan2, sin_cos, sin_cos_f64};

/// Map between a picture and the sphere of directions, with +y up.
///
/// Coordinates of the picture run from 0 to 1: u to the right, v down.
///
/// Tests: each_convention_has_its_directions, mappings_are_inverses, densities_integrate_to_one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mapping {
    /// Latitude and longitude: u = ½ + atan2(x, −z)/2π, v = θ/π with the angle θ from +y. The direction −z is in the middle, +x to its right,
    /// as in the pictures of a spherical camera.
    LatLong,
    /// Equal-area octahedral: pbrt's map, turned so that its +z becomes +y, its +x stays and its +y becomes −z.
    Octahedral,
}

impl Mapping {
    /// Coordinates of a unit direction.
    pub fn coordinates(self, w: Vec3) -> Vec2 {
        match self {
            Mapping::LatLong => Vec2::new(0.5 + atan2(w.x, -w.z) / TAU, polar_angle(w) / PI),
            Mapping::Octahedral => sphere_to_square(Vec3::new(w.x, -w.z, w.y)),
        }
    }

    /// Unit direction of coordinates.
    pub fn direction(self, uv: Vec2) -> Vec3 {
        match self {
            Mapping::LatLong => {
                let (sin_theta, cos_theta) = sin_cos(PI * uv.y);
                let (sin_phi, cos_phi) = sin_cos(TAU * (uv.x - 0.5));
                Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi).normalize()
            }
            Mapping::Octahedral => {
                let w = square_to_sphere(uv);
                Vec3::new(w.x, w.z, -w.y).normalize()
            }
        }
    }

    /// Density by solid angle at a unit direction, of a density by the area of the picture [sr⁻¹].
    ///
    /// dω = 2π² sin θ du dv for [`Mapping::LatLong`], 4π du dv for [`Mapping::Octahedral`]
    ///
    /// - `density`: proportional to [`Mapping::row_weight`], so that it is 0 at the poles where sin θ is
    pub fn by_solid_angle(self, w: Vec3, density: f32) -> f32 {
        match self {
            Mapping::LatLong => density / sine(w).max(f32::MIN_POSITIVE) / (2.0 * PI * PI),
            Mapping::Octahedral => density / (4.0 * PI),
        }
    }

    /// Solid angle of a row of pixels relative to others: sin θ at the centres of the pixels. Rows beyond a pole have negative weights.
    ///
    /// - `row`: from −1 to the number of rows
    pub fn row_weight(self, row: i32, rows: u32) -> f32 {
        match self {
            Mapping::LatLong => sin_cos_f64(std::f64::consts::PI * (f64::from(row) + 0.5) / f64::from(rows)).0 as f32,
            Mapping::Octahedral => 1.0,
        }
    }

    /// Pixel of the picture that a pixel up to one beyond its borders stands for.
    #[inline]
    pub fn wrap(self, pixel: IVec2, size: UVec2) -> UVec2 {
        let IVec2 { x, y } = pixel;
        let (width, height) = (size.x as i32, size.y as i32);
        if (0..width).contains(&x) && (0..height).contains(&y) {
            return pixel.as_uvec2();
        }
        let inside = match self {
            // Longitudes follow each other in a circle. Beyond a pole the row at the pole is repeated.
            Mapping::LatLong => IVec2::new(x.rem_euclid(width), y.clamp(0, height - 1)),
            // Each side of the square is folded onto itself.
            Mapping::Octahedral => {
                let (x, y) = if x < 0 || x >= width { (x.clamp(0, width - 1), height - 1 - y) } else { (x, y) };
                let (x, y) = if y < 0 || y >= height { (width - 1 - x, y.clamp(0, height - 1)) } else { (x, y) };
                IVec2::new(x, y)
            }
        };
        inside.as_uvec2()
    }
}

/// Angle of a unit direction from +y, in [0, π], accurate near both poles.
fn polar_angle(w: Vec3) -> f32 {
    atan2(sine(w), w.y)
}

/// Sine of the angle between a unit direction and the y axis. (`hypot` would have other bits on other systems.)
fn sine(w: Vec3) -> f32 {
    (w.x * w.x + w.z * w.z).sqrt()
}
