//! Boxes of six faces.

use glam::{DVec3, Vec2, Vec3};

use super::quad::Parallelogram;
use super::{Facet, Geometry, Shape, ShapeHit, SurfacePoint};
use crate::error::Result;
use crate::math::{Aabb, AreaPdf, Ray, SolidAnglePdf, Transform};

/// Box |x| ≤ a/2, |y| ≤ b/2, |z| ≤ c/2 with outward normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Lengths a, b, c of the sides (m).
    pub size: [f64; 3],
}

/// Outward normal n of each face, and the directions u and v in which its texture coordinates grow: a right-handed frame, u × v = n.
const FACES: [[DVec3; 3]; 6] = [
    [DVec3::X, DVec3::NEG_Z, DVec3::Y],
    [DVec3::NEG_X, DVec3::Z, DVec3::Y],
    [DVec3::Y, DVec3::X, DVec3::NEG_Z],
    [DVec3::NEG_Y, DVec3::X, DVec3::Z],
    [DVec3::Z, DVec3::X, DVec3::Y],
    [DVec3::NEG_Z, DVec3::NEG_X, DVec3::Y],
];

impl Cuboid {
    /// Corners of each face in turn, from the origin of its texture coordinates. Adjacent faces share the bits of their corners, so
    /// that no ray passes between them.
    fn faces(&self, to_world: &Transform) -> [[DVec3; 4]; 6] {
        let half = 0.5 * DVec3::from(self.size);
        FACES.map(|[n, u, v]| [n - u - v, n + u - v, n + u + v, n - u + v].map(|corner| to_world.point(corner * half)))
    }
}

impl Geometry for Cuboid {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        let corners = self.faces(to_world).into_iter().flatten();
        corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)))
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        let flips = to_world.flips_handedness();
        let faces = self.faces(to_world).into_iter().map(|corners| Parallelogram::new("box", corners, flips));
        Ok(Box::new(Faces(faces.collect::<Result<_>>()?)))
    }
}

/// Six faces in the order of [`FACES`].
struct Faces(Vec<Parallelogram>);

impl Faces {
    fn face(&self, i: u32) -> &Parallelogram {
        &self.0[i as usize]
    }
}

impl Shape for Faces {
    fn count(&self) -> u32 {
        self.0.len() as u32
    }

    fn bounds(&self, i: u32) -> Aabb {
        self.face(i).bounds(0)
    }

    fn area(&self, i: u32) -> f32 {
        self.face(i).area(0)
    }

    fn facet(&self, i: u32) -> Facet {
        self.face(i).facet(0)
    }

    fn point(&self, i: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.face(i).point(0, ray, hit)
    }

    fn tangents(&self, i: u32, point: &SurfacePoint, time: f32) -> Option<[Vec3; 2]> {
        self.face(i).tangents(0, point, time)
    }

    fn sample_area(&self, i: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        self.face(i).sample_area(0, u)
    }

    fn area_coordinates(&self, i: u32, point: &SurfacePoint) -> Option<Vec2> {
        self.face(i).area_coordinates(0, point)
    }

    fn is_rectangle(&self, i: u32) -> bool {
        self.face(i).is_rectangle(0)
    }

    fn sample_from(&self, i: u32, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAnglePdf)> {
        self.face(i).sample_from(0, from, u)
    }

    fn pdf_from(&self, i: u32, from: Vec3, point: &SurfacePoint) -> SolidAnglePdf {
        self.face(i).pdf_from(0, from, point)
    }
}
