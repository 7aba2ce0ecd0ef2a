//! Light that is scattered more than once.

use std::f64::consts::PI;

use super::atmosphere::{Atmosphere, Color, GROUND, TOP};
use super::path::{Path, radius_at, square};
use super::sunlight::Sunlight;
use super::table::{Table, coordinate};
use crate::math::float::sin_cos_f64;

/// Radiance of light scattered at least twice, averaged over all directions, by height and elevation of the sun.
///
/// Light after the second scattering is taken to come equally from all directions, and each further scattering to add the same share f:
/// Ψ = L₂ (1 + f + f² + …) = L₂ / (1 − f).
///
/// Source: Hillaire, *A Scalable and Production Ready Sky and Atmosphere Rendering Technique* (2020), §5.5.
pub(super) struct Multiple {
    radiance: Table,
}

/// Entries of the table by height and by elevation of the sun.
const HEIGHTS: usize = 24;
const ELEVATIONS: usize = 32;

/// Directions along which light arrives at a point: by height and around.
const UP: u32 = 8;
const AROUND: u32 = 8;

/// Steps of the integrals along these directions.
const STEPS: u32 = 8;

impl Multiple {
    /// Computes the table for the air and a ground of this albedo.
    pub fn new(atmosphere: &Atmosphere, sunlight: &Sunlight, ground: Color) -> Multiple {
        let of_height = |y: f64| {
            let radius = GROUND + (TOP - GROUND) * square(y).clamp(1e-6, 1.0 - 1e-6);
            let paths: Vec<(f64, Path)> =
                (0..UP).map(|k| (f64::from(2 * k + 1) / f64::from(UP)) - 1.0).map(|z| (z, Path::new(radius, z, STEPS))).collect();
            (0..ELEVATIONS).map(|column| at(atmosphere, sunlight, ground, radius, &paths, cosine_of(column))).collect()
        };
        Multiple { radiance: Table::new(ELEVATIONS, HEIGHTS, of_height) }
    }

    /// Radiance for a unit irradiance of the sun at the upper end of the atmosphere [sr⁻¹].
    ///
    /// - `radius`: distance from the centre of the earth (m); `cos`: cosine between the zenith and the sun there
    pub fn at(&self, radius: f64, cos: f64) -> Color {
        self.radiance.at(place_of(cos), ((radius - GROUND) / (TOP - GROUND)).max(0.0).sqrt())
    }
}

/// Cosine of a column of the table: the columns are dense around the horizon.
fn cosine_of(column: usize) -> f64 {
    let x = 2.0 * coordinate(column, ELEVATIONS) - 1.0;
    x * x.abs()
}

/// Inverse of [`cosine_of`], as a share of all columns.
fn place_of(cos: f64) -> f64 {
    0.5 * (1.0 + cos.abs().sqrt().copysign(cos))
}

/// Radiance Ψ at a point.
///
/// - `paths`: cosines to the zenith of paths from the point, and the paths; they go in all directions around
fn at(atmosphere: &Atmosphere, sunlight: &Sunlight, ground: Color, radius: f64, paths: &[(f64, Path)], sun: f64) -> Color {
    let (mut second, mut further) = ([0.0; 3], [0.0; 3]);
    let sun_sin = (1.0 - sun * sun).max(0.0).sqrt();
    let weight = 1.0 / f64::from(UP * AROUND);
    for (cos, path) in paths {
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        for around in 0..AROUND {
            // The sun is in the plane of the azimuth 0. Both halves around it are alike.
            let azimuth = PI * (f64::from(around) + 0.5) / f64::from(AROUND);
            let to_sun = sin * sun_sin * sin_cos_f64(azimuth).1 + cos * sun;
            let sun_at = |distance: f64| (radius * sun + distance * to_sun) / radius_at(radius, *cos, distance);
            for point in &path.points {
                let passed = atmosphere.transmittance(&point.amounts);
                let [rayleigh, mie] = atmosphere.scattering(&point.densities);
                let arriving = sunlight.at(point.radius, sun_at(point.distance));
                for k in 0..3 {
                    let scattered = weight * point.weight * passed[k] * (rayleigh[k] + mie[k]);
                    second[k] += scattered * arriving[k] / (4.0 * PI);
                    further[k] += scattered;
                }
            }
            if path.hits_ground {
                let (passed, sun) = (atmosphere.transmittance(&path.amounts), sun_at(path.length));
                let arriving = sunlight.at(GROUND, sun);
                for k in 0..3 {
                    second[k] += weight * passed[k] * ground[k] / PI * arriving[k] * sun.max(0.0);
                }
            }
        }
    }
    std::array::from_fn(|k| second[k] / (1.0 - further[k]))
}
