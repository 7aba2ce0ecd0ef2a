//! Displacement: vertices of a mesh that are moved along their normals.

use glam::{DVec3, Vec3};

use super::MeshData;
use super::places::places;
use crate::math::float::atan2_f64;

impl MeshData {
    /// The mesh with each vertex p moved to p + h n along its normal n, and with the normals of the moved surface.
    ///
    /// - `heights`: h of each vertex, in the unit of the positions
    ///
    /// Vertices in the same place stay together, as on both sides of a seam: they are moved by the mean of their heights along the mean of
    /// their normals. Where normals differ, as at a hard edge, each side keeps normals of its own. A mesh without normals stays faceted.
    /// Each triangle has the front that it had before.
    ///
    /// Means, and the new normals from the triangles around each vertex, are weighted by the angles of the triangles there, so that it does
    /// not matter how a flat part is divided into triangles. Source: Thürmer and Wüthrich, *Computing Vertex Normals from Polygonal Facets*
    /// (1998). Tests: a_sphere_grows_by_a_constant, a_ramp_has_the_normal_of_its_slope.
    pub fn displaced(mut self, heights: &[f64]) -> MeshData {
        self.triangles = self.triangles.iter().map(|&t| self.outward(t)).collect();
        if heights.iter().all(|&h| h == 0.0) {
            return self;
        }
        let places = places(&self.positions);
        let mut moves = vec![Move::default(); self.positions.len()];
        self.for_corners(|triangle, k, angle, face| {
            let v = triangle[k] as usize;
            let normal = if self.is_flat(triangle) { face } else { self.normals[v].as_dvec3().normalize_or_zero() };
            let at = &mut moves[places[v] as usize];
            at.normals += angle * normal;
            at.heights += angle * heights[v];
            at.angles += angle;
        });
        let moved = |(p, place): (&Vec3, &u32)| moves[*place as usize].of(p.as_dvec3()).as_vec3();
        self.positions = self.positions.iter().zip(&places).map(moved).collect();
        self.normals = self.new_normals(&places);
        self
    }

    /// Normals of the triangles around each vertex, as they are now. Vertices in the same place have one normal if theirs were the same.
    /// What was flat stays flat.
    fn new_normals(&self, places: &[u32]) -> Vec<Vec3> {
        if self.normals.is_empty() {
            return vec![];
        }
        let key = |&v: &u32| (places[v as usize], self.normals[v as usize].to_array().map(f32::to_bits));
        let mut sorted: Vec<u32> = (0..self.normals.len() as u32).collect();
        sorted.sort_unstable_by_key(|v| (key(v), *v));
        let mut group = vec![0; sorted.len()];
        for same in sorted.chunk_by(|a, b| key(a) == key(b)) {
            same.iter().for_each(|&v| group[v as usize] = same[0] as usize);
        }
        let mut sums = vec![DVec3::ZERO; group.len()];
        self.for_corners(|triangle, k, angle, face| {
            if !self.is_flat(triangle) {
                sums[group[triangle[k] as usize]] += angle * face;
            }
        });
        group.iter().map(|&group| sums[group].normalize_or_zero().as_vec3()).collect()
    }

    /// Whether a triangle has no normals of its own.
    fn is_flat(&self, triangle: [u32; 3]) -> bool {
        self.normals.is_empty() || triangle.iter().any(|&v| self.normals[v as usize] == Vec3::ZERO)
    }

    /// Calls a function for each corner of each triangle: with the triangle, the number of the corner, its angle in radians, and the unit
    /// normal of the triangle, 0 if it has no area.
    fn for_corners(&self, mut visit: impl FnMut([u32; 3], usize, f64, DVec3)) {
        for &triangle in &self.triangles {
            let corners = self.corners(triangle);
            let cross = self.cross(triangle);
            let (area, face) = (cross.length(), cross.normalize_or_zero());
            for k in 0..3 {
                let [to_next, to_last] = [1, 2].map(|step| corners[(k + step) % 3] - corners[k]);
                visit(triangle, k, atan2_f64(area, to_next.dot(to_last)), face);
            }
        }
    }
}

/// Sums over the corners of triangles in one place, weighted by their angles.
#[derive(Clone, Copy, Default)]
struct Move {
    normals: DVec3,
    heights: f64,
    angles: f64,
}

impl Move {
    fn of(&self, p: DVec3) -> DVec3 {
        if self.angles > 0.0 { p + self.normals.normalize_or_zero() * (self.heights / self.angles) } else { p }
    }
}
