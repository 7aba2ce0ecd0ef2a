//! Loop subdivision. What is expected comes from the rules alone: from the map of a vertex and its neighbours to the next level, repeated in
//! f64 until it stands still, from B-splines, and from counts.

pub mod cages;
mod faults;
mod limit;
mod seams;
mod topology;

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use pt::shape::MeshData;

use crate::random::Random;
use cages::Cage;

/// Rounding of a position to f32, twice, for coordinates of at most 2.
const ROUNDING: f64 = 2.4e-7;

fn subdivided(cage: &Cage, levels: u32) -> MeshData {
    cage.data().subdivided(levels).expect("a surface")
}

/// Edges as ordered pairs of vertices, each with the number of triangles that have it in this direction.
pub fn edges(triangles: &[[u32; 3]]) -> BTreeMap<[u32; 2], u32> {
    let mut edges = BTreeMap::new();
    triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).for_each(|edge| *edges.entry(edge).or_insert(0) += 1);
    edges
}

/// Edges that only one triangle has, in its direction.
pub fn border(triangles: &[[u32; 3]]) -> BTreeMap<u32, u32> {
    let edges = edges(triangles);
    assert!(edges.values().all(|count| *count == 1), "triangles are wound alike, and at most two meet at an edge");
    edges.keys().filter(|[a, b]| !edges.contains_key(&[*b, *a])).map(|[a, b]| (*a, *b)).collect()
}

/// The number of the vertex for each different position.
pub fn welded(data: &MeshData) -> Vec<[u32; 3]> {
    let mut numbers = BTreeMap::new();
    let mut number = |p: Vec3| {
        let next = numbers.len() as u32;
        *numbers.entry((p + 0.0).to_array().map(f32::to_bits)).or_insert(next)
    };
    data.triangles.iter().map(|t| t.map(|v| number(data.positions[v as usize]))).collect()
}

fn largest_difference(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.as_dvec3().distance(b.as_dvec3())).fold(0.0, f64::max)
}

/// Moves each vertex a little.
pub fn shaken(mut cage: Cage, seed: u64, by: f64) -> Cage {
    let mut random = Random::new(seed);
    cage.positions.iter_mut().for_each(|p| *p += by * random.in_cube());
    cage
}

pub fn places(positions: &[DVec3]) -> Vec<Vec3> {
    positions.iter().map(|p| p.as_vec3()).collect()
}
