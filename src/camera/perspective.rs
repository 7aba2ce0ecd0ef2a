//! Perspective projection with a pinhole or a thin lens, whose film may be shifted and whose plane of focus may be tilted.
//!
//! ```text
//! q = ((x + 2 sx) a τ, (y + 2 sy) τ)                      where the ray of the film point (x, y) through the eye meets the plane z = −1
//! w = q − o κ(q),  κ(q) = 1/s − g·q                       slope of the ray from the point o of the lens, s: focus distance
//! q = m − o (g·m)/(1 + g·o),  m = w + o/s                 the inverse, because w = (1 + o gᵀ) q − o/s
//! |dw/dq| = |1 + g·o|
//! ```
//!
//! 1/κ is the depth at which the rays of a film point meet. For a plane of focus with the normal n through (0, 0, −s), g = (n_x, n_y)/(n_z s).

use glam::{Vec2, Vec3};

use super::{Aperture, Blades, CameraConnection, CameraImportance, Pose};
use crate::math::lanes::{Lanes, Vector};
use crate::math::{AreaPdf, Density, Ray, SolidAnglePdf, float};

/// Perspective camera with a thin lens.
///
/// The film point (x, y), with coordinates from −1 to 1, is focused on (x·a·τ, y·τ, −1)·focus_distance. Here τ = tan(fov/2), and a
/// is the aspect ratio: that of the film, so that pixels are square, or one set by [`Perspective::across`]. The rays of a film point
/// start on the lens, an [`Aperture`] around the eye. [`Perspective::shifted`] and [`Perspective::tilted`] change the two parts of this.
#[derive(Clone, Debug, PartialEq)]
pub struct Perspective {
    /// Position and orientation.
    pub pose: Pose,
    /// τ, the tangent of half the vertical field of view.
    pub(super) tan_half_fov: f32,
    /// Aspect ratio a if it is not that of the film.
    aspect: Option<f32>,
    /// Opening of the lens.
    pub(super) aperture: Aperture,
    /// Distance along the axis to the plane in focus (m).
    focus_distance: f32,
    /// Twice the position on the film, from the left and from the top, that the axis meets: (1, 1) for a film that is not shifted.
    pub(super) center: Vec2,
    /// g, the change of the inverse depth of the plane of focus across the picture [m⁻¹]; `None` for a plane across the axis.
    tilt: Option<Vec2>,
}

impl Perspective {
    /// A perspective camera with the aspect ratio of the film.
    ///
    /// - `fov`: full vertical field of view (degrees)
    /// - `lens_radius`, `focus_distance`: in metres
    pub fn new(pose: Pose, fov: f64, lens_radius: f32, focus_distance: f32) -> Perspective {
        let (aperture, center) = (Aperture::disk(lens_radius), Vec2::ONE);
        Perspective { pose, tan_half_fov: tan_half(fov) as f32, aspect: None, aperture, focus_distance, center, tilt: None }
    }

    /// The camera with a view that is moved to the right and up, by fractions of the width and the height of the picture. It looks in
    /// the same direction as before, so that parallel lines stay parallel.
    pub fn shifted(self, [right, up]: [f64; 2]) -> Perspective {
        Perspective { center: Vec2::new((1.0 - 2.0 * right) as f32, (1.0 + 2.0 * up) as f32), ..self }
    }

    /// The camera with a plane of focus that is turned about its point on the axis: first about the x axis, then about the y axis of the
    /// camera, by angles below 90 degrees, counterclockwise as seen from the end of the axis. The view stays as it is.
    pub fn tilted(self, [about_x, about_y]: [f64; 2]) -> Perspective {
        let [(sin_x, cos_x), (sin_y, cos_y)] = [about_x, about_y].map(float::sin_cos_degrees);
        // The normal is (sin_y cos_x, −sin_x, cos_y cos_x).
        let slope = [sin_y / cos_y, -sin_x / (cos_y * cos_x)].map(|slope| (slope / f64::from(self.focus_distance)) as f32);
        Perspective { tilt: Some(Vec2::from(slope)).filter(|slope| *slope != Vec2::ZERO), ..self }
    }

    /// The camera with a lens whose opening is a polygon. The radius of the lens becomes that of the circle through its corners.
    pub fn with_blades(self, blades: Blades) -> Perspective {
        Perspective { aperture: Aperture { blades: Some(blades), ..self.aperture }, ..self }
    }

    /// The camera with a full horizontal field of view (degrees) that does not depend on the shape of the film.
    pub fn across(self, fov: f64, horizontal_fov: f64) -> Perspective {
        Perspective { aspect: Some((tan_half(horizontal_fov) / tan_half(fov)) as f32), ..self }
    }

    /// The camera with the view of a sensor at the distance `focal_length` behind a lens: τ = h/2f. All lengths have the same unit.
    ///
    /// - `width`: of the sensor; `None` for that of the film's shape
    pub fn with_sensor(self, focal_length: f64, height: f64, width: Option<f64>) -> Perspective {
        let aspect = width.map(|width| (width / height) as f32);
        Perspective { tan_half_fov: (0.5 * height / focal_length) as f32, aspect, ..self }
    }

    /// Aspect ratio a on a film with the aspect ratio `film`.
    #[inline(always)]
    pub(super) fn aspect(&self, film: f32) -> f32 {
        self.aspect.unwrap_or(film)
    }

    /// Whether the lens has a radius above 0.
    pub fn has_lens(&self) -> bool {
        self.aperture.is_open()
    }

    #[inline(always)]
    pub(super) fn ray(&self, film: Vec2, aspect: f32, lens: Vec2) -> Ray {
        let x = (2.0 * film.x - self.center.x) * self.tan_half_fov * self.aspect(aspect);
        let y = (self.center.y - 2.0 * film.y) * self.tan_half_fov;
        let towards = Vec3::new(x, y, -1.0);
        if !self.has_lens() {
            return Ray::new(self.pose.eye(), self.pose.vector(towards).normalize());
        }
        let on_lens = self.on_lens(lens);
        let direction = match self.tilt {
            None => towards * self.focus_distance - on_lens,
            Some(slope) => towards - on_lens * (1.0 / self.focus_distance - slope.dot(towards.truncate())),
        };
        Ray::new(self.pose.eye() + self.pose.vector(on_lens), self.pose.vector(direction).normalize())
    }

    /// Rays of a pinhole through several points of the film, as [`Camera::ray`](super::Camera::ray).
    #[inline(always)]
    pub(crate) fn pinhole_rays<L: Lanes>(&self, [x, y]: [L::F32; 2], aspect: f32) -> (Vector<L>, Vector<L>) {
        let (one, two, tan) = (L::f32(1.0), L::f32(2.0), L::f32(self.tan_half_fov));
        let (center_x, center_y) = (L::f32(self.center.x), L::f32(self.center.y));
        let (x, y) = ((two * x - center_x) * tan * L::f32(self.aspect(aspect)), (center_y - two * y) * tan);
        let d = self.pose.vectors(Vector { x, y, z: L::f32(-1.0) });
        (Vector::splat(self.pose.eye()), d.scaled(one / d.length()))
    }

    /// Point of the lens in the frame of the camera.
    #[inline(always)]
    fn on_lens(&self, lens: Vec2) -> Vec3 {
        self.aperture.point(lens).extend(0.0)
    }

    /// weight = We / p(ω) = 1 / (A J cos³ θ d²), for a film that shows the area A = 4τ²a at a distance of 1, and J = |1 + g·o|.
    ///
    /// We = 1 / (A J cos⁴ θ A_lens) and the density of `wi` at p is p(ω) = d² / (cos θ A_lens), so that the area of the lens cancels.
    pub(super) fn connect(&self, p: Vec3, aspect: f32, lens: Vec2) -> Option<CameraConnection> {
        let on_lens = if self.has_lens() { self.on_lens(lens) } else { Vec3::ZERO };
        let end = self.pose.eye() + self.pose.vector(on_lens);
        let line = end - p;
        let away = self.pose.components(-line);
        let d2 = line.length_squared();
        let d = d2.sqrt();
        let cos = -away.z / d;
        let weight = 1.0 / (self.film_area(on_lens, aspect) * cos * cos * cos * d2);
        let film = self.film(on_lens, away, aspect);
        (away.z < 0.0 && weight.is_finite()).then_some(CameraConnection { wi: line / d, film, weight, end })
    }

    /// Density 1 / (A J cos³ θ) of the direction, and that of the point on the lens.
    pub(super) fn importance(&self, ray: &Ray, aspect: f32) -> Option<CameraImportance> {
        let away = self.pose.components(ray.direction);
        let on_lens = if self.has_lens() { self.pose.components(ray.origin - self.pose.eye()) } else { Vec3::ZERO };
        if away.z >= 0.0 {
            return None;
        }
        let cos = -away.z;
        let direction = 1.0 / (self.film_area(on_lens, aspect) * cos * cos * cos);
        let lens = 1.0 / self.aperture.area();
        let (position, we) = match self.has_lens() {
            true => (Density::Smooth(AreaPdf::new(lens)), lens * direction / cos),
            false => (Density::Delta, direction / cos),
        };
        let film = self.film(on_lens, away, aspect);
        Some(CameraImportance { film, we, position, direction: Density::Smooth(SolidAnglePdf::new(direction)) })
    }

    /// Area A = 4τ²a that the film shows at a distance of 1 from the eye, times J, which makes it the area of the slopes of the rays from
    /// a point of the lens (m²).
    fn film_area(&self, on_lens: Vec3, aspect: f32) -> f32 {
        let area = 4.0 * self.tan_half_fov * self.tan_half_fov * self.aspect(aspect);
        match self.tilt {
            None => area,
            Some(slope) => area * (1.0 + slope.dot(on_lens.truncate())).abs(),
        }
    }

    /// Position on the film of the ray from a point of the lens in the direction `away`, both in the frame of the camera: that of the
    /// point where the ray is in focus, at a distance of 1 for a pinhole.
    fn film(&self, on_lens: Vec3, away: Vec3, aspect: f32) -> Vec2 {
        let mut focus = on_lens / self.focus_distance + away / -away.z;
        if let Some(slope) = self.tilt {
            let (q, o) = (focus.truncate(), on_lens.truncate());
            focus -= on_lens * (slope.dot(q) / (1.0 + slope.dot(o)));
        }
        Vec2::new(focus.x / (self.tan_half_fov * self.aspect(aspect)), -focus.y / self.tan_half_fov) * 0.5 + 0.5 * self.center
    }
}

/// Focal length with which a sensor of this height has a vertical field of view of `fov` degrees, f = h/2τ; in the unit of the height.
pub fn focal_length(fov: f64, height: f64) -> f64 {
    0.5 * height / tan_half(fov)
}

/// tan(θ/2), with θ in degrees. It uses pt's own sine and cosine, which have the same bits on all machines.
fn tan_half(degrees: f64) -> f64 {
    let (sin, cos) = float::sin_cos_degrees(0.5 * degrees);
    sin / cos
}
