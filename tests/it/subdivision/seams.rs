//! Texture coordinates and colours, and the two sides of seams.

use glam::{DVec2, Vec2, Vec4};
use pt::shape::MeshData;
use pt::torture::meshes::mesh;

use super::cages::{closed, cube, irregular};
use super::{border, places, welded};
use crate::random::Random;

/// A mesh in which each triangle has vertices, texture coordinates and colours of its own, so that every edge is a seam.
fn torn(data: &MeshData, seed: u64) -> MeshData {
    let mut random = Random::new(seed);
    let corners: Vec<u32> = data.triangles.as_flattened().to_vec();
    let count = corners.len() as u32;
    MeshData {
        uvs: corners.iter().map(|_| random.square()).collect(),
        colors: corners.iter().map(|_| random.in_cube().abs().as_vec3().extend(0.5)).collect(),
        ..mesh(
            corners.iter().map(|v| data.positions[*v as usize]).collect(),
            (0..count / 3).map(|t| [0, 1, 2].map(|k| 3 * t + k)).collect(),
        )
    }
}

/// Positions and normals are those of the mesh without seams, to the bit, triangle by triangle, so that no crack opens. Without texture
/// coordinates and colours, what was torn is one surface.
#[test]
fn seams_do_not_open() {
    for (k, cage) in irregular().into_iter().enumerate() {
        let whole = cage.data();
        let torn = torn(&whole, k as u64);
        let bare = MeshData { uvs: vec![], colors: vec![], ..torn.clone() };
        let whole = whole.subdivided(3).expect("a surface");
        let corners = |data: &MeshData| -> Vec<_> {
            let at = |v: &u32| (data.positions[*v as usize], data.normals[*v as usize]);
            data.triangles.as_flattened().iter().map(at).collect()
        };
        let torn = torn.subdivided(3).expect("a surface");
        let bare = bare.subdivided(3).expect("a surface");
        assert_eq!(corners(&torn), corners(&whole));
        assert_eq!((corners(&bare), bare.positions.len()), (corners(&whole), whole.positions.len()));
    }
    for (k, (cage, _)) in closed().into_iter().enumerate() {
        let torn = torn(&cage.data(), k as u64).subdivided(3).expect("a surface");
        assert!(!border(&torn.triangles).is_empty() && border(&welded(&torn)).is_empty());
    }
}

/// Texture coordinates and colours are linear over each triangle of the cage: at each vertex those of the barycentric weights that it has
/// in the cage.
#[test]
fn texture_coordinates_are_linear_over_each_triangle() {
    let levels = 3;
    let torn = torn(&cube().data(), 1);
    let data = torn.clone().subdivided(levels).expect("a surface");
    // The weights of the corners of each triangle after the divisions, in the order in which triangles are divided.
    let mut weights = vec![[DVec2::ZERO, DVec2::X, DVec2::Y]];
    for _ in 0..levels {
        let divide = |[a, b, c]: [DVec2; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(|sum| sum / 2.0);
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        };
        weights = weights.into_iter().flat_map(divide).collect();
    }
    for (t, triangle) in data.triangles.iter().enumerate() {
        let coarse = torn.triangles[t / weights.len()];
        for (v, w) in triangle.iter().zip(weights[t % weights.len()]) {
            let w = w.as_vec2();
            let [a, b, c] = coarse.map(|v| torn.uvs[v as usize]);
            let uv: Vec2 = a * (1.0 - w.x - w.y) + b * w.x + c * w.y;
            let [a, b, c] = coarse.map(|v| torn.colors[v as usize]);
            let color: Vec4 = a * (1.0 - w.x - w.y) + b * w.x + c * w.y;
            let error = (data.uvs[*v as usize] - uv).length().max((data.colors[*v as usize] - color).length());
            assert!(error < 1e-6, "{error:e}");
        }
    }
}

/// Where both sides of an edge have the same texture coordinates there is one vertex, also if the mesh had two.
#[test]
fn only_seams_have_two_vertices() {
    for cage in irregular() {
        let plain = cage.data();
        let uvs = (0..plain.positions.len()).map(|v| Vec2::new(v as f32, 1.0)).collect();
        let same = MeshData { uvs, ..plain.clone() };
        let twice = mesh([places(&cage.positions), places(&cage.positions)].concat(), {
            let count = cage.positions.len() as u32;
            cage.triangles.iter().enumerate().map(|(t, corners)| corners.map(|v| v + count * (t as u32 % 2))).collect()
        });
        let twice = MeshData { uvs: [same.uvs.clone(), same.uvs.clone()].concat(), ..twice };
        let [plain, same, twice] = [plain, same, twice].map(|data| data.subdivided(2).expect("a surface"));
        assert_eq!((same.positions.len(), &same.positions.len()), (plain.positions.len(), &twice.positions.len()));
    }
}
