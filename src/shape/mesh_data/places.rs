//! Vertices in the same place.

use glam::Vec3;
use rayon::prelude::*;

/// For each vertex, the lowest index of the vertices at the same position. −0 equals 0.
pub(super) fn places(positions: &[Vec3]) -> Vec<u32> {
    let key = |&v: &u32| ((positions[v as usize] + 0.0).to_array().map(f32::to_bits), v);
    let mut sorted: Vec<u32> = (0..positions.len() as u32).collect();
    sorted.par_sort_unstable_by_key(key);
    let mut places = vec![0; positions.len()];
    for same in sorted.chunk_by(|a, b| key(a).0 == key(b).0) {
        same.iter().for_each(|&v| places[v as usize] = same[0]);
    }
    places
}
