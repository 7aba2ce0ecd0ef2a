//! Rays through the surfaces of a lens, from the film to the scene, in double precision.
//!
//! ```text
//! t = F / (G − √(G² − c F))      to a sphere of the curvature c from the point (x, y) of the plane at its vertex, with the direction d
//!                                F = c (x² + y²),  G = d_z − c (x d_x + y d_y); the root is that on the side of the vertex
//! d' = η d + (η cos θ − √(1 − η² sin² θ)) n
//! ```
//!
//! Source: Welford, *Aberrations of Optical Systems* (1986), §4.3.

use glam::{DVec2, DVec3};

use super::table::LensTable;

/// Surfaces of a lens in the frame of a camera whose film is the plane z = 0, with the scene on the side of −z.
#[derive(Clone, Debug, PartialEq)]
pub struct LensStack {
    /// From the rear to the front.
    surfaces: Vec<PlacedSurface>,
    /// Index of the stop.
    stop: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct PlacedSurface {
    /// Position of the vertex on the axis, below 0.
    z: f64,
    curvature: f64,
    aperture: f64,
    /// Index of refraction on the side of the film over that on the side of the scene.
    eta: f64,
}

/// Whether the edges of the openings stop rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edges {
    /// A ray that meets a surface outside of its opening is stopped.
    Opaque,
    /// Only total internal reflection stops rays, and spheres that they miss.
    Ignored,
}

impl LensStack {
    /// The lens with its last surface at a distance from the film.
    pub fn new(table: &LensTable, film_distance: f64) -> LensStack {
        let mut z = -film_distance;
        let mut surfaces = Vec::with_capacity(table.surfaces().len());
        for (k, surface) in table.surfaces().iter().enumerate().rev() {
            if !surfaces.is_empty() {
                z -= surface.thickness;
            }
            let eta = surface.ior / table.ior_before(k);
            surfaces.push(PlacedSurface { z, curvature: surface.curvature, aperture: surface.aperture, eta });
        }
        let stop = table.stop().map(|stop| surfaces.len() - 1 - stop);
        LensStack { surfaces, stop }
    }

    /// Distance from the film to the rear surface.
    pub fn rear_distance(&self) -> f64 {
        -self.surfaces[0].z
    }

    /// Radius of the opening of the rear surface.
    pub fn rear_aperture(&self) -> f64 {
        self.surfaces[0].aperture
    }

    /// Radius of the opening of the stop; `None` for a lens without one.
    pub fn stop_aperture(&self) -> Option<f64> {
        self.stop.map(|stop| self.surfaces[stop].aperture)
    }

    /// Radius of a sphere around the middle of the film in which the rays into the scene start.
    pub fn reach(&self) -> f64 {
        let front = self.surfaces.iter().map(|surface| -surface.z).fold(0.0, f64::max);
        let widest = self.surfaces.iter().map(|surface| surface.aperture).fold(0.0, f64::max);
        // A surface within its opening is at most as deep as the opening is wide.
        (front + widest).hypot(widest)
    }

    /// Follows the ray from a point of the film through a point of the plane at the rear vertex. Returns the point at which it leaves the
    /// lens and its unit direction there; `None` if it does not get through.
    pub fn trace(&self, film: DVec2, rear: DVec2, edges: Edges) -> Option<(DVec3, DVec3)> {
        self.through(&self.surfaces, film, rear, edges)
    }

    /// Where the ray of [`LensStack::trace`] crosses the stop, whatever its openings.
    pub fn at_stop(&self, film: DVec2, rear: DVec2) -> Option<DVec2> {
        let (p, _) = self.through(&self.surfaces[..=self.stop?], film, rear, Edges::Ignored)?;
        Some(p.truncate())
    }

    fn through(&self, surfaces: &[PlacedSurface], film: DVec2, rear: DVec2, edges: Edges) -> Option<(DVec3, DVec3)> {
        let mut p = film.extend(0.0);
        let mut d = (rear - film).extend(-self.rear_distance()).normalize();
        for surface in surfaces {
            p = surface.hit(p, d)?;
            // The comparison is false for numbers that are not finite, too.
            let is_within = p.truncate().length_squared() <= surface.aperture * surface.aperture;
            if !is_within && edges == Edges::Opaque {
                return None;
            }
            d = surface.refracted(p, d)?;
        }
        (p.is_finite() && d.is_finite()).then_some((p, d))
    }
}

impl PlacedSurface {
    /// Where a ray towards the scene meets the surface.
    fn hit(&self, p: DVec3, d: DVec3) -> Option<DVec3> {
        let to_plane = (self.z - p.z) / d.z;
        let (x, y) = (p.x + to_plane * d.x, p.y + to_plane * d.y);
        if self.curvature == 0.0 {
            return (to_plane >= 0.0).then_some(DVec3::new(x, y, self.z));
        }
        let f = self.curvature * (x * x + y * y);
        let g = d.z - self.curvature * (x * d.x + y * d.y);
        let under = g * g - self.curvature * f;
        if !(under >= 0.0 && g < 0.0) {
            return None;
        }
        let t = f / (g - under.sqrt());
        (to_plane + t >= 0.0).then_some(DVec3::new(x + t * d.x, y + t * d.y, self.z + t * d.z))
    }

    /// Direction behind the surface; `None` for total internal reflection.
    fn refracted(&self, p: DVec3, d: DVec3) -> Option<DVec3> {
        if self.eta == 1.0 {
            return Some(d);
        }
        let n = DVec3::new(-self.curvature * p.x, -self.curvature * p.y, 1.0 - self.curvature * (p.z - self.z));
        let cos = -d.dot(n);
        let cos2_refracted = 1.0 - self.eta * self.eta * (1.0 - cos * cos);
        (cos > 0.0 && cos2_refracted > 0.0).then(|| (d * self.eta + n * (self.eta * cos - cos2_refracted.sqrt())).normalize())
    }
}
