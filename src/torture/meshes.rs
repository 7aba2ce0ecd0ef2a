//! Meshes of the hard cases.

use std::sync::Arc;

use crate::math::Transform;
use crate::shape::{Geometry, MeshData, MeshPart, Shape, TriangleMesh};
use glam::{DVec3, Vec3};

/// A mesh without normals and texture coordinates.
pub fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> MeshData {
    MeshData { positions, triangles, ..MeshData::default() }
}

/// The mesh in world space, coordinates unchanged to the bit.
///
/// # Panics
/// No triangle has an area.
pub fn baked(mesh: MeshData) -> Box<dyn Shape> {
    TriangleMesh::new(mesh).bake(&Transform::IDENTITY).expect("some triangle has an area")
}

/// The shapes as an accelerator takes them.
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

/// A closed box around the origin; `half` are its half extents.
pub fn block(half: Vec3) -> MeshData {
    let positions = (0..8).map(|k| Vec3::from_array([0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 1.0 } else { -1.0 })) * half).collect();
    let triangles: Vec<[u32; 3]> =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]].into_iter().flat_map(halves).collect();
    let parts = vec![MeshPart { triangles: 0..triangles.len() as u32, ..MeshPart::default() }];
    MeshData { positions, triangles, parts, ..MeshData::default() }
}

fn halves([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// A unit sphere of flat triangles: an octahedron, each triangle divided by four `levels` times.
pub fn round_mesh(levels: u32) -> MeshData {
    let mut faces: Vec<[Vec3; 3]> = vec![];
    for signs in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| if signs >> axis & 1 == 1 { -1.0 } else { 1.0 });
        let corners = [Vec3::X * x, Vec3::Y * y, Vec3::Z * z];
        faces.push(if x * y * z > 0.0 { corners } else { [corners[0], corners[2], corners[1]] });
    }
    for _ in 0..levels {
        let split = |[a, b, c]: [Vec3; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(split).collect();
    }
    let count = faces.len() as u32;
    let parts = vec![MeshPart { triangles: 0..count, ..MeshPart::default() }];
    let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    MeshData { positions: faces.into_iter().flatten().collect(), triangles, parts, ..MeshData::default() }
}
