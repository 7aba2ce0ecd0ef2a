//! Cameras.
//!
//! A camera looks along −z of its frame, with x to the right and y up. It does not depend on pixels: positions on the film are
//! fractions of its width and height, from the upper left corner.
//!
//! A new camera is a file in this folder, a variant and its arms here, and a variant in `describe::camera`.

mod aperture;
pub mod fisheye;
pub mod orthographic;
pub mod perspective;
pub mod realistic;
pub mod spherical;

use arrayvec::ArrayVec;
use glam::{DMat3, DMat4, DVec3, DVec4, Vec2, Vec3};

use crate::effects::Effects;
use crate::error::Result;
use crate::math::lanes::{Lanes, Vector};
use crate::math::{AnimatedTransform, AreaPdf, Density, Ray, RayDifferential, Transform};

pub use aperture::{Aperture, Blades};
pub use fisheye::{Fisheye, FisheyeMapping};
pub use orthographic::Orthographic;
pub use perspective::{Perspective, focal_length};
pub use realistic::Realistic;
pub use spherical::Spherical;

/// Camera of a scene.
///
/// Functions without a time treat a camera that moves as it is when the shutter opens.
#[derive(Clone, Debug, PartialEq)]
pub enum Camera {
    /// Perspective projection, optionally with a thin lens.
    Perspective(Perspective),
    /// Parallel projection.
    Orthographic(Orthographic),
    /// Panorama of all directions.
    Spherical(Spherical),
    /// Round picture of a wide angle.
    Fisheye(Fisheye),
    /// Lens of spherical surfaces.
    Realistic(Realistic),
}

/// Ray of a camera, and the weight of the radiance that arrives along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// The ray. If its weight is 0 it ends where it starts, so that it meets nothing.
    pub ray: Ray,
    /// Factor of the radiance that arrives along the ray: 0 where no light arrives, 1 elsewhere; a realistic camera has other factors too.
    pub weight: f32,
}

impl From<Ray> for CameraRay {
    /// A ray whose light counts fully.
    #[inline(always)]
    fn from(ray: Ray) -> CameraRay {
        CameraRay { ray, weight: 1.0 }
    }
}

/// Connection of a point with the camera, for paths that start at the lights.
///
/// The importance We is normalized so that a film that covers the unit square has ∫∫ We |cos θ| dA dω = 1 over its rays: light of
/// radiance L along all of them gives the film the mean L. For a fisheye lens the integral is the share of the film in its round picture.
///
/// Source: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), §8.3.
/// Tests: importance_integrates_to_one, connections_are_the_rays_of_the_camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraConnection {
    /// Unit direction from the point towards the camera.
    pub wi: Vec3,
    /// Position on the film as in [`Camera::ray`]. It is outside of [0, 1)² where the camera does not see the point.
    pub film: Vec2,
    /// We divided by the density of `wi` as seen from the point [m⁻²]; for parallel projections, whose `wi` has no density, We
    /// itself.
    pub weight: f32,
    /// Point of the camera at which the shadow ray ends (m).
    pub end: Vec3,
}

/// Importance of a given ray from the camera, and the densities with which [`Camera::ray`] samples it where film positions and lens
/// positions are uniformly distributed.
///
/// Source and normalization: as [`CameraConnection`]. Tests: given_rays_have_the_densities_of_camera_rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraImportance {
    /// Position on the film.
    pub film: Vec2,
    /// Importance We: p(position) · p(direction) / |cos θ|, without the densities that are delta distributions. θ is the angle to the
    /// axis of the camera; panoramas and fisheye lenses, which have no flat film, have cos θ = 1.
    pub we: f32,
    /// Density of the start on the lens or, for parallel projections, on the plane of the eye.
    pub position: Density<AreaPdf>,
    /// Density of the direction.
    pub direction: Density,
}

impl Camera {
    /// Importance of a given ray; `None` if the film does not receive it, and for realistic cameras, which do not know it
    /// ([`Effects::REALISTIC_LENS`]).
    ///
    /// - `ray`: ray with a unit direction that starts at the eye or on the lens, or for parallel projections is parallel to the axis;
    ///   this is not examined
    /// - `aspect`: width / height of the film
    pub fn importance(&self, ray: &Ray, aspect: f32) -> Option<CameraImportance> {
        let moved = self.moved(ray.time);
        let importance = match moved.as_ref().unwrap_or(self) {
            Camera::Perspective(camera) => camera.importance(ray, aspect),
            Camera::Orthographic(camera) => camera.importance(ray, aspect),
            Camera::Spherical(camera) => camera.importance(ray),
            Camera::Fisheye(camera) => camera.importance(ray, aspect),
            Camera::Realistic(_) => None,
        };
        importance.filter(|found| found.film.cmpge(Vec2::ZERO).all() && found.film.cmplt(Vec2::ONE).all())
    }

    /// Connects a point with the camera; `None` if the point is not in front of it, and for realistic cameras
    /// ([`Effects::REALISTIC_LENS`]).
    ///
    /// - `aspect`, `lens`, `time`: as in [`Camera::ray`]
    pub fn connect(&self, p: Vec3, aspect: f32, lens: Vec2, time: f32) -> Option<CameraConnection> {
        let moved = self.moved(time);
        match moved.as_ref().unwrap_or(self) {
            Camera::Perspective(camera) => camera.connect(p, aspect, lens),
            Camera::Orthographic(camera) => camera.connect(p, aspect),
            Camera::Spherical(camera) => camera.connect(p),
            Camera::Fisheye(camera) => camera.connect(p, aspect),
            Camera::Realistic(_) => None,
        }
    }

    /// Ray through a point of the film, and the weight of the radiance that arrives along it.
    ///
    /// - `film`: position in [0, 1)², from the upper left corner; `aspect`: width / height of the film
    /// - `lens`: uniform numbers in [0, 1)², used only by cameras with a lens
    /// - `time`: fraction of the shutter interval, in [0, 1); 0 where nothing moves
    #[inline(always)]
    pub fn sample(&self, film: Vec2, aspect: f32, lens: Vec2, time: f32) -> CameraRay {
        let moved = self.moved(time);
        let CameraRay { ray, weight } = match moved.as_ref().unwrap_or(self) {
            Camera::Perspective(camera) => camera.ray(film, aspect, lens).into(),
            Camera::Orthographic(camera) => camera.ray(film, aspect).into(),
            Camera::Spherical(camera) => camera.ray(film).into(),
            Camera::Fisheye(camera) => camera.ray(film, aspect),
            Camera::Realistic(camera) => camera.ray(film, aspect, lens),
        };
        CameraRay { ray: Ray { time, ..ray }, weight }
    }

    /// The ray of [`Camera::sample`] alone.
    #[inline(always)]
    pub fn ray(&self, film: Vec2, aspect: f32, lens: Vec2, time: f32) -> Ray {
        self.sample(film, aspect, lens, time).ray
    }

    /// Differential of a ray of the camera, between neighbouring pixels of the film.
    ///
    /// - `ray`: the ray through `film`; the other parameters are those with which it was made
    /// - `pixel`: width and height of a pixel, in the unit of `film`
    pub fn differential(&self, ray: &Ray, film: Vec2, pixel: Vec2, aspect: f32, lens: Vec2) -> RayDifferential {
        let moved = self.moved(ray.time);
        if let Camera::Realistic(camera) = moved.as_ref().unwrap_or(self) {
            let [across, down] = camera.beside(ray, film, pixel, aspect, lens);
            return ray.differential_to([across.0, down.0], [across.1, down.1]);
        }
        let step = |k: usize| {
            let is_within = match self {
                // The neighbours towards the centre are in the round picture too.
                Camera::Fisheye(_) => film[k] < 0.5,
                // Film positions end at 1.
                _ => film[k] + pixel[k] < 1.0,
            };
            if is_within { 1.0 } else { -1.0 }
        };
        let step = [step(0), step(1)];
        let beside = |offset: Vec2| self.ray(film + offset, aspect, lens, ray.time);
        ray.differential_to([beside(Vec2::new(step[0] * pixel.x, 0.0)), beside(Vec2::new(0.0, step[1] * pixel.y))], step)
    }

    /// All positions on the plane of the film that show the same direction as `film`. For panoramas, which repeat beyond their edges, some
    /// are outside of the film, where the filter of a pixel may still reach them.
    ///
    /// - `film`: position in [0, 1)² for panoramas, anywhere for other cameras
    pub fn same_film_positions(&self, film: Vec2) -> impl Iterator<Item = Vec2> {
        let others = match self {
            Camera::Spherical(_) => spherical::other_film_positions(film),
            _ => ArrayVec::new(),
        };
        std::iter::once(film).chain(others)
    }

    /// Effects that simulating the camera requires.
    pub fn effects(&self) -> Effects {
        let lens = match self {
            Camera::Perspective(camera) if camera.has_lens() => Effects::THIN_LENS,
            Camera::Realistic(_) => Effects::THIN_LENS | Effects::REALISTIC_LENS,
            _ => Effects::NONE,
        };
        if self.is_moving() { lens | Effects::MOTION } else { lens }
    }

    /// Whether the camera moves while the shutter is open.
    pub fn is_moving(&self) -> bool {
        self.pose().motion.is_some()
    }

    /// The camera as it is at a time; `None` if it does not move.
    #[inline(always)]
    fn moved(&self, time: f32) -> Option<Camera> {
        self.pose().motion.as_ref().map(|motion| self.with_pose(Pose::new(&motion.at(time))))
    }

    #[cold]
    #[inline(never)]
    fn with_pose(&self, pose: Pose) -> Camera {
        let mut camera = self.clone();
        *camera.pose_mut() = pose;
        camera
    }

    /// Depth of a point at a time (m): along the axis of the camera, for panoramas and fisheye lenses the distance from the eye.
    pub fn depth(&self, p: DVec3, time: f32) -> f64 {
        let moved = self.moved(time);
        let camera = moved.as_ref().unwrap_or(self);
        let pose = camera.pose();
        match camera {
            Camera::Spherical(_) | Camera::Fisheye(_) => (p - pose.eye).length(),
            _ => (pose.eye - p).dot(pose.back.as_dvec3()),
        }
    }

    /// Matrix from world space to camera space, with x right, y up and −z ahead (m).
    pub fn world_to_camera(&self) -> DMat4 {
        let Pose { eye, right, up, back, .. } = *self.pose();
        let turn = DMat3::from_cols(right.as_dvec3(), up.as_dvec3(), back.as_dvec3()).transpose();
        DMat4::from_mat3_translation(turn, -(turn * eye))
    }

    /// Homogeneous matrix from camera space to the film, with x and y in [0, 1]² from the upper left corner. z is 1/depth for a
    /// perspective and the depth for a parallel projection. `None` for panoramas, fisheye lenses and realistic cameras, whose mappings
    /// are not projective.
    pub fn to_film(&self, aspect: f64) -> Option<DMat4> {
        let [x, y, z, w] = [DVec4::X, DVec4::Y, DVec4::Z, DVec4::W];
        let rows = match self {
            Camera::Perspective(camera) => {
                let (width, height) = (self.screen_width(aspect)?, 2.0 * f64::from(camera.tan_half_fov));
                let center = 0.5 * camera.center.as_dvec2();
                [x / width - center.x * z, -y / height - center.y * z, w, -z]
            }
            Camera::Orthographic(camera) => {
                let height = f64::from(camera.height);
                [x / (height * aspect) + 0.5 * w, -y / height + 0.5 * w, -z, w]
            }
            Camera::Spherical(_) | Camera::Fisheye(_) | Camera::Realistic(_) => return None,
        };
        Some(DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose())
    }

    /// Width that the film of a perspective camera shows of the plane one metre in front of it (m).
    pub fn screen_width(&self, aspect: f64) -> Option<f64> {
        match self {
            Camera::Perspective(camera) => Some(2.0 * f64::from(camera.tan_half_fov) * f64::from(camera.aspect(aspect as f32))),
            _ => None,
        }
    }

    /// Place of the middle of the film of a perspective camera on the plane one metre in front of it, to the right and up from the axis (m);
    /// `None` on the axis.
    pub fn screen_center(&self, aspect: f64) -> Option<[f64; 2]> {
        let Camera::Perspective(camera) = self else { return None };
        let half = [0.5 * self.screen_width(aspect)?, f64::from(camera.tan_half_fov)];
        let center = camera.center.as_dvec2();
        Some([half[0] * (1.0 - center.x), half[1] * (center.y - 1.0)]).filter(|center| *center != [0.0; 2])
    }

    /// Width of a pixel divided by its height, as angles of view.
    pub fn pixel_aspect(&self, aspect: f32) -> f32 {
        match self {
            Camera::Perspective(camera) => camera.aspect(aspect) / aspect,
            Camera::Realistic(camera) => camera.aspect(aspect) / aspect,
            _ => 1.0,
        }
    }

    /// Position of the camera (m).
    pub fn eye(&self) -> DVec3 {
        self.pose().eye
    }

    /// Position of the camera at a time (m).
    pub fn eye_at(&self, time: f32) -> DVec3 {
        self.moved(time).map_or(self.eye(), |camera| camera.eye())
    }

    /// Whether a ray of the camera can hit the side to which `n` points of the plane through `p`.
    pub fn faces(&self, p: DVec3, n: DVec3) -> bool {
        let pose = self.pose();
        match self {
            Camera::Orthographic(_) => pose.back.as_dvec3().dot(n) > 0.0,
            Camera::Perspective(camera) => (pose.eye - p).dot(n) > -f64::from(camera.aperture.radius),
            Camera::Spherical(_) | Camera::Fisheye(_) => (pose.eye - p).dot(n) > 0.0,
            Camera::Realistic(camera) => (pose.eye - p).dot(n) > -camera.reach(),
        }
    }

    fn pose(&self) -> &Pose {
        match self {
            Camera::Perspective(camera) => &camera.pose,
            Camera::Orthographic(camera) => &camera.pose,
            Camera::Spherical(camera) => &camera.pose,
            Camera::Fisheye(camera) => &camera.pose,
            Camera::Realistic(camera) => &camera.pose,
        }
    }

    fn pose_mut(&mut self) -> &mut Pose {
        match self {
            Camera::Perspective(camera) => &mut camera.pose,
            Camera::Orthographic(camera) => &mut camera.pose,
            Camera::Spherical(camera) => &mut camera.pose,
            Camera::Fisheye(camera) => &mut camera.pose,
            Camera::Realistic(camera) => &mut camera.pose,
        }
    }

    /// The camera in coordinates shifted by −`origin`.
    pub fn recentred(mut self, origin: DVec3) -> Camera {
        let pose = self.pose_mut();
        pose.eye -= origin;
        pose.motion = pose.motion.take().map(|motion| motion.shifted(-origin));
        self
    }
}

/// Position and orientation of a camera. The scale of a transform is ignored: distances are those of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Position when the shutter opens (m).
    pub eye: DVec3,
    right: Vec3,
    up: Vec3,
    back: Vec3,
    /// Transform from camera space to world space, if it changes while the shutter is open.
    motion: Option<AnimatedTransform>,
}

impl Pose {
    /// Pose given by the transform from camera space to world space.
    pub fn new(to_world: &Transform) -> Pose {
        let axis = |v: DVec3| to_world.vector(v).normalize().as_vec3();
        Pose { eye: to_world.point(DVec3::ZERO), right: axis(DVec3::X), up: axis(DVec3::Y), back: axis(DVec3::Z), motion: None }
    }

    /// Pose of a camera that may move.
    pub fn animated(to_world: &AnimatedTransform) -> Pose {
        Pose { motion: Some(to_world.clone()).filter(AnimatedTransform::is_moving), ..Pose::new(&to_world.at(0.0)) }
    }

    /// Pose at `from` that looks at `to`.
    ///
    /// # Errors
    /// The errors of [`Transform::look_at`].
    pub fn look_at(from: DVec3, to: DVec3, up: DVec3) -> Result<Pose> {
        Transform::look_at(from, to, up).map(|to_world| Pose::new(&to_world))
    }

    fn vector(&self, v: Vec3) -> Vec3 {
        self.right * v.x + self.up * v.y + self.back * v.z
    }

    /// [`Pose::vector`] in each lane.
    #[inline(always)]
    fn vectors<L: Lanes>(&self, v: Vector<L>) -> Vector<L> {
        Vector::splat(self.right).scaled(v.x) + Vector::splat(self.up).scaled(v.y) + Vector::splat(self.back).scaled(v.z)
    }

    /// Components of a vector along right, up and back.
    fn components(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.right), v.dot(self.up), v.dot(self.back))
    }

    fn eye(&self) -> Vec3 {
        self.eye.as_vec3()
    }
}
