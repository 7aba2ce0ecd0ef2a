//! Spheres that are cut at planes z = const. and at an angle about z, which a transform may stretch and shear.

use glam::{DVec2, DVec3, Vec2};

use super::revolution::{Place, Profile, Revolved, Sector};
use super::{Geometry, Shape, sphere};
use crate::error::Result;
use crate::math::Transform;

/// Part z₀ ≤ z ≤ z₁, 0 ≤ φ ≤ φmax of the sphere x² + y² + z² = r². Its normal points away from the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartialSphere {
    /// Radius r (m).
    pub radius: f64,
    /// Ends z₀ and z₁ (m), with z₀ < z₁, z₀ < r and z₁ > −r.
    pub z: [f64; 2],
    /// Angle φmax, above 0 and at most 360 (degrees).
    pub phi_max: f64,
}

impl PartialSphere {
    fn place(&self, to_world: &Transform) -> Revolved<Arc> {
        let z = self.z.map(|z| (z / self.radius).clamp(-1.0, 1.0));
        Revolved::new(Arc { z }, Sector::new(self.phi_max), [self.radius; 2], 0.0, to_world)
    }
}

impl Geometry for PartialSphere {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        self.place(to_world).corners()
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        Ok(Box::new(self.place(to_world)))
    }
}

/// The arc ρ² + z² = 1, z₀ ≤ z ≤ z₁.
struct Arc {
    z: [f64; 2],
}

impl Arc {
    /// The point of the arc at a height.
    fn at_height(&self, z: f64) -> DVec2 {
        DVec2::new(((1.0 - z) * (1.0 + z)).max(0.0).sqrt(), z)
    }
}

impl Profile for Arc {
    const AREA_STEPS: u32 = 32;

    fn roots(&self, o: DVec3, d: DVec3) -> [f64; 2] {
        let d2 = d.length_squared();
        let middle = -o.dot(d) / d2;
        let half = ((1.0 - (o + d * middle).length_squared()) / d2).sqrt();
        [middle - half, middle + half]
    }

    fn covers(&self, rho_z: DVec2, margin: f64) -> bool {
        rho_z.y >= self.z[0] - margin && rho_z.y <= self.z[1] + margin
    }

    fn project(&self, rho_z: DVec2) -> DVec2 {
        rho_z.normalize()
    }

    fn normal(&self, rho_z: DVec2) -> DVec2 {
        rho_z
    }

    fn normal_change(&self, _: &Place, along: DVec3) -> Option<DVec3> {
        Some(along)
    }

    fn area_per_radian(&self) -> f64 {
        self.z[1] - self.z[0]
    }

    /// The area between two heights is proportional to their difference (Archimedes).
    fn at_share(&self, share: f64) -> DVec2 {
        self.at_height(self.z[0] + (self.z[1] - self.z[0]) * share)
    }

    fn share(&self, rho_z: DVec2) -> f64 {
        (rho_z.y - self.z[0]) / (self.z[1] - self.z[0])
    }

    /// The coordinates of the whole sphere, so that a cut does not move a texture.
    fn uv(&self, at: &Place, _: &Sector) -> Vec2 {
        sphere::uv(at.position())
    }

    fn tangents(&self, at: &Place, _: &Sector) -> Option<[DVec3; 2]> {
        sphere::tangents(at.position())
    }

    /// On the whole half-circle √(a² + b²) at z = b/√(a² + b²) if a > 0; otherwise, and where that is cut off, at an end.
    fn greatest(&self, a: f64, b: f64) -> f64 {
        let [low, high] = self.z;
        let value = |z: f64| DVec2::new(a, b).dot(self.at_height(z));
        if a > 0.0 { value((b / a.hypot(b)).clamp(low, high)) } else { value(low).max(value(high)) }
    }
}
