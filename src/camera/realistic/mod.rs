//! Realistic camera: rays through the surfaces of a lens.
//!
//! ```text
//! E = L ∫ cos⁴ θ / Z² dA                                  over the exit pupil, in the plane at the distance Z from the film
//! weight = A cos⁴ θ / (Z² Ω₀),  Ω₀ = π sin² θ₀            A: area in which points of the pupil are sampled
//! ```
//!
//! Ω₀, the irradiance E of the middle of the film for a radiance L of 1, makes the middle of the picture as bright as it is with the other
//! cameras. The corners are darker by vignetting: the weights of the rays from there have a mean below 1, and rays that meet the edge of an
//! opening have the weight 0.
//!
//! Source: Kolb, Mitchell and Hanrahan, *A Realistic Camera Model for Computer Graphics* (1995).

mod pupil;
mod stack;
mod table;
mod thick;

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::{CameraRay, Pose};
use crate::math::Ray;
use pupil::{ExitPupils, projected_solid_angle};
use stack::{Edges, LensStack};

pub use table::{LensSurface, LensTable, MOST_SURFACES, TableFault};
pub use thick::ThickLens;

/// Camera with a lens of spherical surfaces. The film is at the position of the camera, and the lens in front of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Realistic {
    /// Position and orientation of the film.
    pub pose: Pose,
    sensor: Sensor,
    lens: Arc<FocusedLens>,
}

/// Size of the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Height (m).
    pub height: f64,
    /// Width (m); `None` for that of the picture's shape.
    pub width: Option<f64>,
}

impl Sensor {
    /// Width and height (m), for a picture with this aspect ratio.
    fn size(&self, aspect: f64) -> DVec2 {
        DVec2::new(self.width.unwrap_or(self.height * aspect), self.height)
    }
}

/// Lens at its distance from the film.
#[derive(Debug, PartialEq)]
struct FocusedLens {
    stack: LensStack,
    pupils: ExitPupils,
    /// Ω₀ (sr).
    projected_solid_angle: f64,
    /// The thin lens that is equivalent near the axis.
    thin: ThinLens,
}

/// The thin lens that forms the same image as a realistic lens near the axis. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Distance from the film to the front principal plane, along the view direction, at which the thin lens lies: v plus the distance
    /// between the principal planes.
    pub place: f64,
    /// v, the distance from the rear principal plane to the film. It decides what the sensor shows.
    pub image_distance: f64,
    /// u, the distance of the plane in focus.
    pub focus_distance: f64,
    /// Radius: v tan θ₀, so that the middle of the film gets the cone of light that it gets through the realistic lens.
    pub radius: f64,
}

impl Realistic {
    /// A camera with its lens in focus at a distance from the film.
    ///
    /// - `table`: lengths in metres
    /// - `focus_distance`: in metres
    /// - `aspect`: width / height of the picture, for which the pupils are computed
    ///
    /// `None` if the lens does not focus there ([`ThickLens::film_distance`]), or no light gets through it to the middle of the film.
    pub fn new(pose: Pose, table: &LensTable, focus_distance: f64, sensor: Sensor, aspect: f64) -> Option<Realistic> {
        let thick = ThickLens::new(table).ok()?;
        let film_distance = thick.film_distance(focus_distance)?;
        let stack = LensStack::new(table, film_distance);
        let projected_solid_angle = projected_solid_angle(&stack);
        if !(projected_solid_angle > 0.0 && projected_solid_angle.is_finite()) {
            return None;
        }
        let pupils = ExitPupils::new(&stack, 0.5 * sensor.size(aspect).length());
        let image_distance = film_distance - thick.rear;
        let place = image_distance + thick.separation;
        let sin2 = projected_solid_angle / PI;
        let radius = image_distance * (sin2 / (1.0 - sin2)).sqrt();
        let thin = ThinLens { place, image_distance, focus_distance: focus_distance - place, radius };
        Some(Realistic { pose, sensor, lens: Arc::new(FocusedLens { stack, pupils, projected_solid_angle, thin }) })
    }

    /// The thin lens that is equivalent near the axis.
    pub fn thin_lens(&self) -> ThinLens {
        self.lens.thin
    }

    /// Ω₀ = π sin² θ₀ of the cone of light that arrives at the middle of the film (sr).
    pub fn projected_solid_angle(&self) -> f64 {
        self.lens.projected_solid_angle
    }

    /// Distance from the film to the rear surface of the lens (m).
    pub fn film_distance(&self) -> f64 {
        self.lens.stack.rear_distance()
    }

    /// Radius of a sphere around the middle of the film in which the rays into the scene start (m).
    pub(super) fn reach(&self) -> f64 {
        self.lens.stack.reach()
    }

    /// Width divided by height of what the film shows, for a picture with this aspect ratio.
    pub(super) fn aspect(&self, aspect: f32) -> f32 {
        self.sensor.width.map_or(aspect, |width| (width / self.sensor.height) as f32)
    }

    // Never inlined, so that other cameras do not pay for it.
    #[inline(never)]
    pub(super) fn ray(&self, film: Vec2, aspect: f32, lens: Vec2) -> CameraRay {
        let at = self.on_film(film, aspect);
        let through = self.on_pupil(at, lens).and_then(|(rear, area)| {
            let ray = self.lens.stack.trace(at, rear, Edges::Opaque)?;
            let distance2 = self.film_distance() * self.film_distance();
            let cos2 = distance2 / (distance2 + (rear - at).length_squared());
            Some((ray, area * cos2 * cos2 / (distance2 * self.lens.projected_solid_angle)))
        });
        match through {
            Some((ray, weight)) => CameraRay { ray: self.world_ray(ray), weight: weight as f32 },
            None => CameraRay { ray: Ray { t_max: 0.0, ..self.world_ray((DVec3::ZERO, DVec3::NEG_Z)) }, weight: 0.0 },
        }
    }

    /// Rays beside that of [`Realistic::ray`] through the same point of the pupil, along x and along y, each with its distance in pixels;
    /// whether the edges of the lens stop them does not matter.
    ///
    /// - `ray`: the ray itself, for neighbours that do not exist
    pub(super) fn beside(&self, ray: &Ray, film: Vec2, pixel: Vec2, aspect: f32, lens: Vec2) -> [(Ray, f32); 2] {
        let rear = self.on_pupil(self.on_film(film, aspect), lens).map(|(rear, _)| rear);
        let through = |offset: Vec2| self.lens.stack.trace(self.on_film(film + offset, aspect), rear?, Edges::Ignored);
        [Vec2::X, Vec2::Y].map(|axis| {
            let found = [1.0, -1.0].into_iter().find_map(|step| Some((through(axis * pixel * step)?, step)));
            found.map_or((*ray, 1.0), |(beside, step)| (Ray { time: ray.time, ..self.world_ray(beside) }, step))
        })
    }

    /// Point of the film in the frame of the camera (m). The lens turns the picture upside down.
    fn on_film(&self, film: Vec2, aspect: f32) -> DVec2 {
        (film.as_dvec2() - 0.5) * DVec2::new(-1.0, 1.0) * self.sensor.size(aspect.into())
    }

    /// Point in the bounds of the exit pupil, and their area (m²).
    fn on_pupil(&self, at: DVec2, lens: Vec2) -> Option<(DVec2, f64)> {
        let bounds = self.lens.pupils.bounds(at.length())?;
        // The bounds are those of a film point on the x axis.
        let axis = at.try_normalize().unwrap_or(DVec2::X);
        Some((axis.rotate(bounds.point(lens.as_dvec2())), bounds.area()))
    }

    fn world_ray(&self, (origin, direction): (DVec3, DVec3)) -> Ray {
        let [origin, direction] = [origin, direction].map(|v: DVec3| -> Vec3 { self.pose.vector(v.as_vec3()) });
        Ray::new(self.pose.eye() + origin, direction.normalize())
    }
}
