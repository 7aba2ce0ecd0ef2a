//! Disks with a hole and disks that are cut at an angle, which a transform may stretch.

use glam::{DVec2, DVec3, Vec2};

use super::revolution::{Place, Profile, Revolved, Sector};
use super::{Geometry, Shape};
use crate::error::Result;
use crate::math::Transform;

/// Part rᵢ² ≤ x² + y² ≤ r², 0 ≤ φ ≤ φmax of the plane z = 0, with the normal +z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartialDisk {
    /// Radius r (m).
    pub radius: f64,
    /// Radius rᵢ of the hole, at least 0 and below r (m).
    pub inner_radius: f64,
    /// Angle φmax, above 0 and at most 360 (degrees).
    pub phi_max: f64,
}

impl PartialDisk {
    fn place(&self, to_world: &Transform) -> Revolved<Spoke> {
        let spoke = Spoke { inner: self.inner_radius / self.radius };
        Revolved::new(spoke, Sector::new(self.phi_max), [self.radius; 2], 0.0, to_world)
    }
}

impl Geometry for PartialDisk {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        self.place(to_world).corners()
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        Ok(Box::new(self.place(to_world)))
    }
}

/// The line z = 0, k ≤ ρ ≤ 1.
struct Spoke {
    inner: f64,
}

impl Profile for Spoke {
    const IS_FLAT: bool = true;

    fn roots(&self, o: DVec3, d: DVec3) -> [f64; 2] {
        [-o.z / d.z, f64::NAN]
    }

    fn covers(&self, rho_z: DVec2, margin: f64) -> bool {
        rho_z.x >= self.inner - margin && rho_z.x <= 1.0 + margin
    }

    fn project(&self, rho_z: DVec2) -> DVec2 {
        DVec2::new(rho_z.x.clamp(self.inner, 1.0), 0.0)
    }

    fn normal(&self, _: DVec2) -> DVec2 {
        DVec2::Y
    }

    fn normal_change(&self, _: &Place, _: DVec3) -> Option<DVec3> {
        Some(DVec3::ZERO)
    }

    fn area_per_radian(&self) -> f64 {
        0.5 * (1.0 - self.inner * self.inner)
    }

    /// The share of the area within ρ is (ρ² − k²) / (1 − k²).
    fn at_share(&self, share: f64) -> DVec2 {
        let inside = self.inner * self.inner;
        DVec2::new((inside + (1.0 - inside) * share).sqrt(), 0.0)
    }

    fn share(&self, rho_z: DVec2) -> f64 {
        let inside = self.inner * self.inner;
        (rho_z.x * rho_z.x - inside) / (1.0 - inside)
    }

    /// Coordinates whose square [0, 1]² encloses the whole disk, so that a hole does not move a texture.
    fn uv(&self, at: &Place, _: &Sector) -> Vec2 {
        at.position().truncate().as_vec2() * 0.5 + 0.5
    }

    fn tangents(&self, _: &Place, _: &Sector) -> Option<[DVec3; 2]> {
        Some([DVec3::X * 2.0, DVec3::Y * 2.0])
    }

    fn greatest(&self, a: f64, _: f64) -> f64 {
        a.max(a * self.inner)
    }
}
