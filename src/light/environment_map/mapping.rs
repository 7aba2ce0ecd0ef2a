//! Maps between a picture and the directions around a scene.

use std::f32::consts::{PI, TAU};

use glam::{UVec2, Vec2, Vec3};

use crate::math::equal_area::{sphere_to_square_lanes, square_to_sphere_lanes};
use crate::math::float::{atan2_lanes, sin_cos_f64, sin_cos_lanes};
use crate::math::lanes::{Lanes, One, Vector};

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
        self.coordinates_lanes::<One>(w.into()).into()
    }

    /// Unit direction of coordinates.
    pub fn direction(self, uv: Vec2) -> Vec3 {
        self.direction_lanes::<One>(uv.to_array()).into()
    }

    /// [`Mapping::coordinates`] in each lane.
    #[inline(always)]
    pub fn coordinates_lanes<L: Lanes>(self, w: Vector<L>) -> [L::F32; 2] {
        match self {
            Mapping::LatLong => [L::f32(0.5) + atan2_lanes::<L>(w.x, -w.z) / L::f32(TAU), atan2_lanes::<L>(sine(w), w.y) / L::f32(PI)],
            Mapping::Octahedral => sphere_to_square_lanes::<L>(Vector { x: w.x, y: -w.z, z: w.y }),
        }
    }

    /// [`Mapping::direction`] in each lane.
    #[inline(always)]
    pub fn direction_lanes<L: Lanes>(self, [u, v]: [L::F32; 2]) -> Vector<L> {
        match self {
            Mapping::LatLong => {
                let (sin_theta, cos_theta) = sin_cos_lanes::<L>(L::f32(PI) * v);
                let (sin_phi, cos_phi) = sin_cos_lanes::<L>(L::f32(TAU) * (u - L::f32(0.5)));
                Vector::<L> { x: sin_theta * sin_phi, y: cos_theta, z: -sin_theta * cos_phi }.normalized()
            }
            Mapping::Octahedral => {
                let w = square_to_sphere_lanes::<L>([u, v]);
                Vector::<L> { x: w.x, y: w.z, z: -w.y }.normalized()
            }
        }
    }

    /// Densities by solid angle at unit directions, of densities by the area of the picture [sr⁻¹].
    ///
    /// dω = 2π² sin θ du dv for [`Mapping::LatLong`], 4π du dv for [`Mapping::Octahedral`]
    ///
    /// - `density`: proportional to [`Mapping::row_weight`], so that it is 0 at the poles where sin θ is
    #[inline(always)]
    pub fn by_solid_angle<L: Lanes>(self, w: Vector<L>, density: L::F32) -> L::F32 {
        match self {
            Mapping::LatLong => density / L::max(sine(w), L::f32(f32::MIN_POSITIVE)) / L::f32(2.0 * PI * PI),
            Mapping::Octahedral => density / L::f32(4.0 * PI),
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

    /// Column and row of the pixel inside the picture that stands for a pixel inside it or one step beyond its border.
    ///
    /// - `place`: column and row of the pixel that is looked up, plus 1
    #[inline(always)]
    pub fn wrap<L: Lanes>(self, [x, y]: [L::U32; 2], size: UVec2) -> [L::U32; 2] {
        let (zero, one) = (L::u32(0), L::u32(1));
        let (is_left, is_right) = (L::eq_u32(x, zero), L::eq_u32(x, L::u32(size.x + 1)));
        let (is_above, is_below) = (L::eq_u32(y, zero), L::eq_u32(y, L::u32(size.y + 1)));
        let (last_x, last_y) = (L::u32(size.x - 1), L::u32(size.y - 1));
        let (x, y) = (x - one, y - one);
        let nearest_y = L::select_u32(is_above, zero, L::select_u32(is_below, last_y, y));
        match self {
            // Longitudes follow each other in a circle. Beyond a pole the row at the pole is repeated.
            Mapping::LatLong => [L::select_u32(is_left, last_x, L::select_u32(is_right, zero, x)), nearest_y],
            // Each side of the square is folded onto itself.
            Mapping::Octahedral => {
                let nearest_x = L::select_u32(is_left, zero, L::select_u32(is_right, last_x, x));
                let x = L::select_u32(is_above | is_below, last_x - nearest_x, nearest_x);
                [x, L::select_u32(is_left | is_right, last_y - nearest_y, nearest_y)]
            }
        }
    }
}

/// Sines of the angles between unit directions and the y axis. (`hypot` would have other bits on other systems.)
#[inline(always)]
fn sine<L: Lanes>(w: Vector<L>) -> L::F32 {
    L::sqrt(w.x * w.x + w.z * w.z)
}
