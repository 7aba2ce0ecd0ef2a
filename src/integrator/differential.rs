//! How a path from the camera differs from those beside it, which textures are averaged over.

use glam::Vec3;

use super::CameraSample;
use crate::math::{Density, Ray, RayDifferential, SurfaceDifferential};
use crate::primitive::Hit;
use crate::scene::{Scene, Surface};

/// How a path from the camera differs from those beside it.
#[derive(Clone, Copy, Debug)]
pub enum PathDifferential {
    /// Unknown: no texture depends on it, or the path was scattered by something else than smooth mirrors and glass.
    None,
    /// Between two vertices.
    Ray(RayDifferential),
    /// At a surface.
    Surface(SurfaceDifferential),
}

impl PathDifferential {
    /// The differential of a path that starts at the camera.
    pub fn at_camera(camera: &CameraSample) -> PathDifferential {
        camera.differential.map_or(PathDifferential::None, PathDifferential::Ray)
    }

    /// Whether it is known.
    pub fn is_known(&self) -> bool {
        !matches!(self, PathDifferential::None)
    }

    /// Surface that the path hit, with its textures averaged over the path's footprint.
    #[inline(always)]
    pub fn surface<'s>(&mut self, scene: &'s dyn Scene, ray: &Ray, hit: &Hit) -> Surface<'s> {
        match self {
            PathDifferential::Ray(differential) => {
                let (surface, onward) = scene.surface_with_footprint(ray, hit, differential);
                *self = onward.map_or(PathDifferential::None, PathDifferential::Surface);
                surface
            }
            _ => scene.surface(ray, hit),
        }
    }

    /// Goes on from the surface in a sampled direction.
    ///
    /// - `normal`: shading normal of the surface
    /// - `arriving`, `leaving`: unit directions of the rays before and after the surface
    /// - `density`, `eta`: those of the sample
    #[inline(always)]
    pub fn scatter(&mut self, normal: Vec3, [arriving, leaving]: [Vec3; 2], density: Density, eta: f32) {
        if let PathDifferential::Surface(differential) = self {
            let onward = scattered(differential, normal, [arriving, leaving], density, eta);
            *self = onward.map_or(PathDifferential::None, PathDifferential::Ray);
        }
    }
}

/// Differential of a ray that leaves a surface; `None` after anything but reflection or refraction into a single direction. Then
/// textures are looked up at points, since the paths through a pixel spread over far more than it shows.
#[inline(never)]
fn scattered(
    at: &SurfaceDifferential,
    normal: Vec3,
    [arriving, leaving]: [Vec3; 2],
    density: Density,
    eta: f32,
) -> Option<RayDifferential> {
    match density {
        Density::Delta => at.scattered(normal, arriving, leaving, eta),
        Density::Smooth(_) => None,
    }
}
