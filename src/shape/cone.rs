//! Cones, open at the base, which a transform may stretch and shear.

use std::f64::consts::SQRT_2;

use glam::{DVec2, DVec3, Vec2};

use super::revolution::{Place, Profile, Revolved, Sector};
use super::{Geometry, Shape};
use crate::error::Result;
use crate::math::Transform;

/// Cone x² + y² = r² (1 − z/h)², 0 ≤ z ≤ h, 0 ≤ φ ≤ φmax around the z axis, with the apex at z = h. Its normal points to the outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Radius r of the base at z = 0 (m).
    pub radius: f64,
    /// Height h (m).
    pub height: f64,
    /// Angle φmax, above 0 and at most 360 (degrees).
    pub phi_max: f64,
}

impl Cone {
    fn place(&self, to_world: &Transform) -> Revolved<Slope> {
        Revolved::new(Slope, Sector::new(self.phi_max), [self.radius, self.height], 0.0, to_world)
    }
}

impl Geometry for Cone {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        self.place(to_world).corners()
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        Ok(Box::new(self.place(to_world)))
    }
}

/// The line ρ = 1 − z, 0 ≤ z ≤ 1.
struct Slope;

impl Profile for Slope {
    /// Solves a t² + 2 b t + c = 0 for the form q(x, y, w) = x² + y² − w² of the distance w = 1 − z from the apex along the axis.
    ///
    /// Its discriminant b² − a c = (o_x d_w − o_w d_x)² + (o_y d_w − o_w d_y)² − (o_x d_y − o_y d_x)² loses no digits if it is computed
    /// from the right-hand side. It is not negative if a ≤ 0 or c ≤ 0, that is, for a line steeper than the cone or a point within.
    fn roots(&self, o: DVec3, d: DVec3) -> [f64; 2] {
        let (o, d) = (DVec3::new(o.x, o.y, 1.0 - o.z), DVec3::new(d.x, d.y, -d.z));
        let form = |p: DVec3, q: DVec3| p.x * q.x + p.y * q.y - p.z * q.z;
        let (a, b, c) = (form(d, d), form(o, d), form(o, o));
        let cross = o.cross(d);
        let square = cross.x * cross.x + cross.y * cross.y - cross.z * cross.z;
        let root = if a <= 0.0 || c <= 0.0 { square.max(0.0) } else { square }.sqrt();
        // The sum of terms with the same sign, for both roots.
        let sum = -(b + root.copysign(b));
        let (first, second) = (sum / a, c / sum);
        if first > second { [second, first] } else { [first, second] }
    }

    fn covers(&self, rho_z: DVec2, margin: f64) -> bool {
        rho_z.y >= -margin && rho_z.y <= 1.0 + margin
    }

    fn project(&self, rho_z: DVec2) -> DVec2 {
        let z = (0.5 * (1.0 + rho_z.y - rho_z.x)).clamp(0.0, 1.0);
        DVec2::new(1.0 - z, z)
    }

    fn normal(&self, _: DVec2) -> DVec2 {
        DVec2::ONE
    }

    fn normal_change(&self, at: &Place, along: DVec3) -> Option<DVec3> {
        at.turn(along)
    }

    fn area_per_radian(&self) -> f64 {
        0.5 * SQRT_2
    }

    /// The share of the area above ρ is ρ².
    fn at_share(&self, share: f64) -> DVec2 {
        let rho = share.sqrt();
        DVec2::new(rho, 1.0 - rho)
    }

    fn share(&self, rho_z: DVec2) -> f64 {
        rho_z.x * rho_z.x
    }

    /// u = φ/φmax, v = z.
    fn uv(&self, at: &Place, sector: &Sector) -> Vec2 {
        DVec2::new(sector.angle_of(at.direction) / sector.angle(), at.rho_z.y).as_vec2()
    }

    fn tangents(&self, at: &Place, sector: &Sector) -> Option<[DVec3; 2]> {
        Some([at.around(sector)?, (-at.direction).extend(1.0)])
    }

    fn greatest(&self, a: f64, b: f64) -> f64 {
        a.max(b)
    }
}
