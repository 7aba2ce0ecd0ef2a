//! Fisheye lenses: the angle θ to the axis becomes a distance from the centre of a round picture.
//!
//! ```text
//! ρ = m(θ)/m(θ_max),  p(ω) = m m' / (m(θ_max)² A sin θ)    A: area of the film where the round picture has the radius 1
//!
//! equidistant     m = θ            m m'/sin θ = θ / sin θ
//! equisolid       m = sin(θ/2)     m m'/sin θ = 1/4
//! stereographic   m = tan(θ/2)     m m'/sin θ = 1 / (4 cos⁴(θ/2))
//! orthographic    m = sin θ        m m'/sin θ = cos θ
//! ```
//!
//! Source: Ray, *Applied Photographic Optics* (2002), ch. 32.

use glam::{Vec2, Vec3};

use super::{CameraConnection, CameraImportance, CameraRay, Pose};
use crate::math::{Density, Ray, SolidAnglePdf, float};

/// Fisheye camera. The picture is a circle that touches the longer sides of the film, and nothing is seen outside of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Fisheye {
    /// Position and orientation.
    pub pose: Pose,
    mapping: FisheyeMapping,
    /// m(θ_max).
    radius: f32,
}

/// How the angle to the axis becomes a distance from the centre of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FisheyeMapping {
    /// Equal angles have equal distances.
    Equidistant,
    /// Equal solid angles have equal areas.
    Equisolid,
    /// Circles stay circles.
    Stereographic,
    /// The picture of the scene on a sphere around the camera, seen from far ahead.
    Orthographic,
}

impl FisheyeMapping {
    /// m of an angle with this cosine and sine.
    fn m(self, cos: f32, sin: f32) -> f32 {
        match self {
            FisheyeMapping::Equidistant => float::atan2(sin, cos),
            // The sine of half the angle, without the cancellation of 1 − cos θ near the axis.
            FisheyeMapping::Equisolid if cos > 0.0 => sin / (2.0 * (1.0 + cos)).sqrt(),
            FisheyeMapping::Equisolid => (0.5 * (1.0 - cos)).sqrt(),
            FisheyeMapping::Stereographic if cos > 0.0 => sin / (1.0 + cos),
            FisheyeMapping::Stereographic => (1.0 - cos) / sin,
            FisheyeMapping::Orthographic => sin,
        }
    }

    /// cos θ, and sin θ / m, for a value of m.
    fn direction(self, m: f32) -> (f32, f32) {
        match self {
            FisheyeMapping::Equidistant => {
                let (sin, cos) = float::sin_cos(m);
                (cos, if m > 0.0 { sin / m } else { 1.0 })
            }
            FisheyeMapping::Equisolid => (1.0 - 2.0 * m * m, 2.0 * (1.0 - m * m).max(0.0).sqrt()),
            FisheyeMapping::Stereographic => ((1.0 - m * m) / (1.0 + m * m), 2.0 / (1.0 + m * m)),
            FisheyeMapping::Orthographic => ((1.0 - m * m).max(0.0).sqrt(), 1.0),
        }
    }

    /// m m' / sin θ.
    fn density(self, cos: f32, sin: f32) -> f32 {
        match self {
            FisheyeMapping::Equidistant if sin > 0.0 => float::atan2(sin, cos) / sin,
            FisheyeMapping::Equidistant if cos < 0.0 => f32::INFINITY,
            FisheyeMapping::Equidistant => 1.0,
            FisheyeMapping::Equisolid => 0.25,
            // cos²(θ/2) = (1 + cos θ)/2
            FisheyeMapping::Stereographic => 1.0 / ((1.0 + cos) * (1.0 + cos)),
            FisheyeMapping::Orthographic => cos.max(0.0),
        }
    }
}

impl Fisheye {
    /// A fisheye camera.
    ///
    /// - `fov`: full angle of the view (degrees), above 0 and up to 360; below 360 for a stereographic lens, up to 180 for an orthographic one
    pub fn new(pose: Pose, fov: f64, mapping: FisheyeMapping) -> Fisheye {
        let (sin, cos) = float::sin_cos_degrees(0.5 * fov);
        let radius = match mapping {
            FisheyeMapping::Equidistant => (0.5 * fov).to_radians() as f32,
            _ => mapping.m(cos as f32, sin as f32),
        };
        Fisheye { pose, mapping, radius }
    }

    /// Ray through a point of the film; outside of the round picture it has no weight and meets nothing.
    // Never inlined, so that other cameras do not pay for it.
    #[inline(never)]
    pub(super) fn ray(&self, film: Vec2, aspect: f32) -> CameraRay {
        let place = in_circle(film, aspect);
        let distance = place.length();
        let is_seen = distance <= 1.0;
        let place = if is_seen { place } else { place / distance };
        let (cos, share) = self.mapping.direction(self.radius * distance.min(1.0));
        let direction = (place * (share * self.radius)).extend(-cos);
        let ray = Ray::new(self.pose.eye(), self.pose.vector(direction).normalize());
        if is_seen { CameraRay { ray, weight: 1.0 } } else { CameraRay { ray: Ray { t_max: 0.0, ..ray }, weight: 0.0 } }
    }

    /// We = p(ω), as for a panorama.
    pub(super) fn connect(&self, p: Vec3, aspect: f32) -> Option<CameraConnection> {
        let line = self.pose.eye() - p;
        let (d2, w) = (line.length_squared(), self.pose.components(-line).try_normalize()?);
        let (film, density) = self.film(w, aspect)?;
        let weight = density / d2;
        weight.is_finite().then_some(CameraConnection { wi: line / d2.sqrt(), film, weight, end: self.pose.eye() })
    }

    /// Density of the direction, which is We.
    pub(super) fn importance(&self, ray: &Ray, aspect: f32) -> Option<CameraImportance> {
        let (film, we) = self.film(self.pose.components(ray.direction), aspect)?;
        let direction = Density::Smooth(SolidAnglePdf::new(we));
        we.is_finite().then_some(CameraImportance { film, we, position: Density::Delta, direction })
    }

    /// Position on the film of a direction in the frame of the camera, and the density of the direction; `None` outside of the picture.
    fn film(&self, w: Vec3, aspect: f32) -> Option<(Vec2, f32)> {
        let (cos, sin) = (-w.z, w.truncate().length());
        let m = self.mapping.m(cos, sin);
        // The sine has each value also behind the camera.
        if m > self.radius || self.mapping == FisheyeMapping::Orthographic && cos < 0.0 {
            return None;
        }
        let place = w.truncate().normalize_or_zero() * (m / self.radius);
        let density = self.mapping.density(cos, sin) / (self.radius * self.radius * film_area(aspect));
        Some((from_circle(place, aspect), density))
    }
}

/// Width and height of the film where the round picture has the radius 1.
fn film_size(aspect: f32) -> Vec2 {
    2.0 * if aspect > 1.0 { Vec2::new(aspect, 1.0) } else { Vec2::new(1.0, 1.0 / aspect) }
}

fn film_area(aspect: f32) -> f32 {
    let size = film_size(aspect);
    size.x * size.y
}

/// Position of a film point relative to the centre, to the right and up.
fn in_circle(film: Vec2, aspect: f32) -> Vec2 {
    (film - 0.5) * Vec2::new(1.0, -1.0) * film_size(aspect)
}

/// Inverse of [`in_circle`].
fn from_circle(place: Vec2, aspect: f32) -> Vec2 {
    place * Vec2::new(1.0, -1.0) / film_size(aspect) + 0.5
}
