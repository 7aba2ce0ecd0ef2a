//! Poses of a mesh that a skin or morph targets bend while the shutter is open.

use glam::Vec3;

use super::pose::Pose;
use crate::shape::MeshData;

/// The mesh at as few of the times as are needed, for vertices that move evenly between them; none if it is always the same. `None` if the
/// poses do not have the same triangles, because some have no area in one of them.
///
/// - `middle`: the mesh in the middle of the exposure
/// - `keys`: poses of the nodes from the opening of the shutter to its closing
/// - `bent`: the mesh in a pose
pub fn poses(middle: &MeshData, keys: &[(f64, Pose)], bent: impl Fn(&Pose) -> Option<MeshData>) -> Option<Vec<(f64, MeshData)>> {
    let all: Vec<(f64, MeshData)> = keys.iter().map(|(time, pose)| Some((*time, bent(pose)?))).collect::<Option<_>>()?;
    if all.iter().all(|(_, mesh)| mesh.positions == middle.positions && mesh.normals == middle.normals) {
        return Some(vec![]);
    }
    let triangles = |mesh: &MeshData| mesh.clone().clean().0.triangles;
    let own = triangles(middle);
    let kept = needed(&all);
    let kept: Vec<(f64, MeshData)> = (0..).zip(all).filter(|(k, _)| kept.contains(k)).map(|(_, pose)| pose).collect();
    kept.iter().all(|(_, mesh)| triangles(mesh) == own).then_some(kept)
}

/// Indices of poses between which no vertex is farther than [`DEVIATION`] from the straight way, in order.
fn needed(poses: &[(f64, MeshData)]) -> Vec<usize> {
    let corners = poses.iter().flat_map(|(_, mesh)| &mesh.positions);
    let (low, high) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
    let allowed = DEVIATION * (high - low).max_element();
    let mut kept = vec![0, poses.len() - 1];
    let mut open = vec![(0, poses.len() - 1)];
    while let Some((start, end)) = open.pop() {
        let farthest = (start + 1..end).map(|k| (deviation(poses, start, k, end), k)).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, k)) = farthest.filter(|(distance, _)| *distance > allowed) {
            kept.push(k);
            open.extend([(start, k), (k, end)]);
        }
    }
    kept.sort_unstable();
    kept
}

/// Greatest distance of a vertex in a pose from where it is on the straight way between two others (m).
fn deviation(poses: &[(f64, MeshData)], start: usize, k: usize, end: usize) -> f32 {
    let [(before, a), (time, p), (after, b)] = [start, k, end].map(|k| (poses[k].0, &poses[k].1.positions));
    let share = ((time - before) / (after - before)) as f32;
    let distance = |((a, b), p): ((&Vec3, &Vec3), &Vec3)| a.lerp(*b, share).distance(*p);
    a.iter().zip(b).zip(p).map(distance).fold(0.0, f32::max)
}

/// Greatest distance of a vertex from its way, relative to the size of the mesh: a fraction of a pixel even where the mesh fills the picture.
const DEVIATION: f32 = 1.0 / 4096.0;
