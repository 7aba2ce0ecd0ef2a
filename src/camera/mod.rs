//! Where pictures are taken from.
//!
//! A camera looks down −z of its frame, x to the right, y up. It knows nothing of pixels:
//! positions on the film are shares of its width and height, from the upper left.
//!
//! To add one: a file beside these, a variant and an arm here, a variant in `describe::camera`.

pub mod orthographic;
pub mod perspective;
pub mod spherical;

use glam::{DMat3, DMat4, DVec3, DVec4, Vec2, Vec3};

use crate::effects::Effects;
use crate::error::Result;
use crate::math::{Ray, Transform};

pub use orthographic::Orthographic;
pub use perspective::Perspective;
pub use spherical::Spherical;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Camera {
    Perspective(Perspective),
    Orthographic(Orthographic),
    Spherical(Spherical),
}

impl Camera {
    /// The ray through a point of the film.
    ///
    /// - `film`: [0, 1)², from the upper left; `aspect`: width / height of the film
    /// - `lens`: [0, 1)², used where there is a lens
    #[inline(always)]
    pub fn ray(&self, film: Vec2, aspect: f32, lens: Vec2) -> Ray {
        match self {
            Camera::Perspective(camera) => camera.ray(film, aspect, lens),
            Camera::Orthographic(camera) => camera.ray(film, aspect),
            Camera::Spherical(camera) => camera.ray(film),
        }
    }

    pub fn effects(&self) -> Effects {
        match self {
            Camera::Perspective(camera) if camera.has_lens() => Effects::THIN_LENS,
            _ => Effects::NONE,
        }
    }

    /// How far a point is in front of it: along its axis, for panoramas from the eye (m).
    pub fn depth(&self, p: DVec3) -> f64 {
        let pose = self.pose();
        match self {
            Camera::Spherical(_) => (p - pose.eye).length(),
            _ => (pose.eye - p).dot(pose.back.as_dvec3()),
        }
    }

    /// From the world to the camera's space: x right, y up, −z ahead (m).
    pub fn world_to_camera(&self) -> DMat4 {
        let Pose { eye, right, up, back } = *self.pose();
        let turn = DMat3::from_cols(right.as_dvec3(), up.as_dvec3(), back.as_dvec3()).transpose();
        DMat4::from_mat3_translation(turn, -(turn * eye))
    }

    /// From the camera's space to its film, in homogeneous coordinates: x and y in [0, 1]², from the upper left; z is 1/depth of a
    /// perspective, else the depth. `None` for panoramas, which no matrix makes.
    pub fn to_film(&self, aspect: f64) -> Option<DMat4> {
        let [x, y, z, w] = [DVec4::X, DVec4::Y, DVec4::Z, DVec4::W];
        let rows = match self {
            Camera::Perspective(camera) => {
                let (width, height) = (self.screen_width(aspect)?, 2.0 * f64::from(camera.tan_half_fov));
                [x / width - 0.5 * z, -y / height - 0.5 * z, w, -z]
            }
            Camera::Orthographic(camera) => {
                let height = f64::from(camera.height);
                [x / (height * aspect) + 0.5 * w, -y / height + 0.5 * w, -z, w]
            }
            Camera::Spherical(_) => return None,
        };
        Some(DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose())
    }

    /// How much of the plane a metre in front of a perspective camera the film shows, from left to right (m).
    pub fn screen_width(&self, aspect: f64) -> Option<f64> {
        match self {
            Camera::Perspective(camera) => Some(2.0 * f64::from(camera.tan_half_fov) * f64::from(camera.aspect(aspect as f32))),
            _ => None,
        }
    }

    /// The width of a pixel over its height, as seen.
    pub fn pixel_aspect(&self, aspect: f32) -> f32 {
        match self {
            Camera::Perspective(camera) => camera.aspect(aspect) / aspect,
            _ => 1.0,
        }
    }

    /// Where it stands.
    pub fn eye(&self) -> DVec3 {
        self.pose().eye
    }

    /// Whether a ray of it may meet the side of the plane through `p` to which `n` points.
    pub fn faces(&self, p: DVec3, n: DVec3) -> bool {
        let pose = self.pose();
        match self {
            Camera::Orthographic(_) => pose.back.as_dvec3().dot(n) > 0.0,
            Camera::Perspective(camera) => (pose.eye - p).dot(n) > -f64::from(camera.lens_radius),
            Camera::Spherical(_) => (pose.eye - p).dot(n) > 0.0,
        }
    }

    fn pose(&self) -> &Pose {
        match self {
            Camera::Perspective(camera) => &camera.pose,
            Camera::Orthographic(camera) => &camera.pose,
            Camera::Spherical(camera) => &camera.pose,
        }
    }

    /// The same camera after the world has moved by −`origin`.
    pub fn recentred(mut self, origin: DVec3) -> Camera {
        let pose = match &mut self {
            Camera::Perspective(camera) => &mut camera.pose,
            Camera::Orthographic(camera) => &mut camera.pose,
            Camera::Spherical(camera) => &mut camera.pose,
        };
        pose.eye -= origin;
        self
    }
}

/// Position and orientation. Distances are the world's: a scaled transform does not scale the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub eye: DVec3,
    right: Vec3,
    up: Vec3,
    back: Vec3,
}

impl Pose {
    /// From the camera's space to the world's.
    pub fn new(to_world: &Transform) -> Pose {
        let axis = |v: DVec3| to_world.vector(v).normalize().as_vec3();
        Pose { eye: to_world.point(DVec3::ZERO), right: axis(DVec3::X), up: axis(DVec3::Y), back: axis(DVec3::Z) }
    }

    /// The pose at `from` that looks at `to`.
    ///
    /// # Errors
    /// The errors of [`Transform::look_at`].
    pub fn look_at(from: DVec3, to: DVec3, up: DVec3) -> Result<Pose> {
        Transform::look_at(from, to, up).map(|to_world| Pose::new(&to_world))
    }

    fn vector(&self, v: Vec3) -> Vec3 {
        self.right * v.x + self.up * v.y + self.back * v.z
    }

    fn eye(&self) -> Vec3 {
        self.eye.as_vec3()
    }
}
