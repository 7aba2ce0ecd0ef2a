//! Differentials of rays: how a ray of a pixel differs from those of its neighbours.
//!
//! Source: Igehy, *Tracing Ray Differentials* (1999).

use glam::Vec3;

use super::Ray;

/// Change of a ray from one pixel to the next: along a row of the film, and along a column.
///
/// Tests: differentials_are_those_of_neighbouring_rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayDifferential {
    /// Changes of the origin (m).
    pub origin: [Vec3; 2],
    /// Changes of the unit direction.
    pub direction: [Vec3; 2],
}

/// Change of a ray and of the surface that it hits, from one pixel to the next: along a row of the film, and along a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceDifferential {
    /// Changes of the point on the tangent plane (m).
    pub p: [Vec3; 2],
    /// Changes of the unit shading normal.
    pub n: [Vec3; 2],
    /// Changes of the unit direction of the ray that arrives.
    pub direction: [Vec3; 2],
}

impl RayDifferential {
    /// Changes ∂p of the point where the ray meets the plane with the normal n: ∂p = a − (a·n / d·n) d with a = ∂o + t ∂d.
    ///
    /// - `t`: length of the ray to the plane (m)
    pub fn on_plane(&self, direction: Vec3, t: f32, n: Vec3) -> [Vec3; 2] {
        let along = |k: usize| {
            let across = self.origin[k] + self.direction[k] * t;
            across - direction * (across.dot(n) / direction.dot(n))
        };
        [along(0), along(1)]
    }
}

impl SurfaceDifferential {
    /// Differential of the ray that a smooth surface reflects or refracts; `None` where it is not finite.
    ///
    /// ```text
    /// reflection: ∂d' = ∂d − 2 ((d·n) ∂n + ∂(d·n) n)
    /// refraction: d' = r d − μ n,  μ = r d·n − d'·n,  ∂d' = r ∂d − μ ∂n − ∂μ n,  ∂μ = (r − r² d·n / d'·n) ∂(d·n)
    /// ```
    ///
    /// - `n`: unit shading normal
    /// - `arriving`, `leaving`: unit directions d and d' of the rays
    /// - `eta`: 1/r, the index of refraction on the side of d' over that on the side of d
    pub fn scattered(&self, n: Vec3, arriving: Vec3, leaving: Vec3, eta: f32) -> Option<RayDifferential> {
        let side = if arriving.dot(n) > 0.0 { -1.0 } else { 1.0 };
        let n = n * side;
        let (cos, cos_leaving) = (arriving.dot(n), leaving.dot(n));
        let along = |k: usize| {
            let (direction, n_change) = (self.direction[k], self.n[k] * side);
            let cos_change = direction.dot(n) + arriving.dot(n_change);
            if cos_leaving > 0.0 {
                return direction - (n_change * cos + n * cos_change) * 2.0;
            }
            let r = 1.0 / eta;
            let mu = r * cos - cos_leaving;
            direction * r - n_change * mu - n * ((r - r * r * cos / cos_leaving) * cos_change)
        };
        let direction = [along(0), along(1)];
        direction.iter().all(|change| change.is_finite()).then_some(RayDifferential { origin: self.p, direction })
    }
}

impl Ray {
    /// Differential between the ray and rays at `step` pixels along a row and along a column of the film.
    pub fn differential_to(&self, others: [Ray; 2], step: [f32; 2]) -> RayDifferential {
        let change = |k: usize, of: fn(&Ray) -> Vec3| (of(&others[k]) - of(self)) / step[k];
        let changes = |of: fn(&Ray) -> Vec3| [change(0, of), change(1, of)];
        RayDifferential { origin: changes(|ray| ray.origin), direction: changes(|ray| ray.direction) }
    }
}

impl std::ops::Mul<f32> for RayDifferential {
    type Output = RayDifferential;

    /// Differential between rays that are `width` pixels apart.
    fn mul(self, width: f32) -> RayDifferential {
        RayDifferential { origin: self.origin.map(|v| v * width), direction: self.direction.map(|v| v * width) }
    }
}
