//! Meshes that several suites of laws share.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use pt::math::Transform;
use pt::shape::{Geometry, MeshData, Shape, TriangleMesh};

/// A mesh without normals and texture coordinates.
pub fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> MeshData {
    MeshData { positions, triangles, ..MeshData::default() }
}

/// The mesh in world space, coordinates unchanged to the bit.
pub fn baked(mesh: MeshData) -> Box<dyn Shape> {
    TriangleMesh::new(mesh).bake(&Transform::IDENTITY).expect("some triangle has an area")
}

pub fn shapes(shapes: Vec<Box<dyn Shape>>) -> Arc<[Box<dyn Shape>]> {
    shapes.into()
}

/// The unit icosahedron, each triangle split into four `splits` times and blown up to the sphere; outward, closed.
pub fn icosphere(splits: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points = vec![];
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        points.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    let near = |i: usize, j: usize| (points[i] - points[j]).length() < 2.1;
    let mut triangles = vec![];
    for (i, j, k) in (0..12).flat_map(|i| (i + 1..12).flat_map(move |j| (j + 1..12).map(move |k| (i, j, k)))) {
        if near(i, j) && near(j, k) && near(k, i) {
            let outward = (points[j] - points[i]).cross(points[k] - points[i]).dot(points[i]) > 0.0;
            triangles.push(if outward { [i as u32, j as u32, k as u32] } else { [i as u32, k as u32, j as u32] });
        }
    }
    points.iter_mut().for_each(|p| *p = p.normalize());
    for _ in 0..splits {
        (points, triangles) = split(points, &triangles);
    }
    (points, triangles)
}

fn split(mut points: Vec<DVec3>, triangles: &[[u32; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut middles = std::collections::HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            points.push((points[a as usize] + points[b as usize]).normalize());
            points.len() as u32 - 1
        })
    };
    let mut finer = vec![];
    for &[a, b, c] in triangles {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    (points, finer)
}
