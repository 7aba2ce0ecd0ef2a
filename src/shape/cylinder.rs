//! Cylinders, open at both ends, which a transform may stretch and shear.

use glam::{DVec2, DVec3, Vec2};

use super::revolution::{Place, Profile, Revolved, Sector};
use super::{Geometry, Shape};
use crate::error::Result;
use crate::math::Transform;

/// Cylinder x² + y² = r², z₀ ≤ z ≤ z₁, 0 ≤ φ ≤ φmax around the z axis. Its normal points away from the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius r (m).
    pub radius: f64,
    /// Ends z₀ and z₁ (m), with z₀ < z₁.
    pub z: [f64; 2],
    /// Angle φmax, above 0 and at most 360 (degrees).
    pub phi_max: f64,
}

impl Cylinder {
    fn place(&self, to_world: &Transform) -> Revolved<Wall> {
        let [low, high] = self.z;
        Revolved::new(Wall, Sector::new(self.phi_max), [self.radius, high - low], low, to_world)
    }
}

impl Geometry for Cylinder {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        self.place(to_world).corners()
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        Ok(Box::new(self.place(to_world)))
    }
}

/// The line ρ = 1, 0 ≤ z ≤ 1.
struct Wall;

impl Profile for Wall {
    /// The distance of the line from the axis is computed first, as for spheres: o + m d is nearest to the axis at m = −o·d/d² in x and y.
    fn roots(&self, o: DVec3, d: DVec3) -> [f64; 2] {
        let (o, d) = (o.truncate(), d.truncate());
        let d2 = d.length_squared();
        let middle = -o.dot(d) / d2;
        let half = ((1.0 - (o + d * middle).length_squared()) / d2).sqrt();
        [middle - half, middle + half]
    }

    fn covers(&self, rho_z: DVec2, margin: f64) -> bool {
        rho_z.y >= -margin && rho_z.y <= 1.0 + margin
    }

    fn project(&self, rho_z: DVec2) -> DVec2 {
        DVec2::new(1.0, rho_z.y.clamp(0.0, 1.0))
    }

    fn normal(&self, _: DVec2) -> DVec2 {
        DVec2::X
    }

    fn normal_change(&self, at: &Place, along: DVec3) -> Option<DVec3> {
        at.turn(along)
    }

    fn area_per_radian(&self) -> f64 {
        1.0
    }

    fn at_share(&self, share: f64) -> DVec2 {
        DVec2::new(1.0, share)
    }

    fn share(&self, rho_z: DVec2) -> f64 {
        rho_z.y
    }

    /// u = φ/φmax, v = z.
    fn uv(&self, at: &Place, sector: &Sector) -> Vec2 {
        DVec2::new(sector.angle_of(at.direction) / sector.angle(), at.rho_z.y).as_vec2()
    }

    fn tangents(&self, at: &Place, sector: &Sector) -> Option<[DVec3; 2]> {
        Some([at.around(sector)?, DVec3::Z])
    }

    fn greatest(&self, a: f64, b: f64) -> f64 {
        a + b.max(0.0)
    }
}
