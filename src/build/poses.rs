//! Loads the keyframes of meshes whose vertices move.

use super::Builder;
use crate::describe::{Mesh, MeshKeyframe};
use crate::error::Result;
use crate::shape::MeshData;
use crate::shape::moving_mesh::{Pose, pose_at};

impl Builder<'_> {
    /// Poses of a mesh while the shutter is open, at fractions of the shutter interval: a single one if nothing moves meanwhile, and none
    /// without keyframes. Returns `None` after adding a fault.
    ///
    /// # Errors
    /// `Io` where a file cannot be read; `Limit` where a file has too many triangles.
    pub(super) fn poses(&mut self, pointer: &str, mesh: &Mesh, data: &MeshData) -> Result<Option<Vec<Pose>>> {
        let mut poses = vec![];
        for (i, keyframe) in mesh.keyframes.iter().enumerate() {
            let at = format!("{pointer}/keyframes/{i}");
            let Some(at_keyframe) = self.keyframe(&at, mesh, keyframe, data)? else { return Ok(None) };
            if at_keyframe.triangles != data.triangles || at_keyframe.normals.is_empty() != data.normals.is_empty() {
                let at = if keyframe.file.is_some() { format!("{at}/file") } else { at };
                self.fault(&at, &difference(&at_keyframe, data));
                return Ok(None);
            }
            poses.push(Pose { time: keyframe.time.get(), positions: at_keyframe.positions, normals: at_keyframe.normals });
        }
        if poses.is_empty() {
            return Ok(Some(poses));
        }
        Ok(Some(during(&poses, self.scene.shutter.open.get(), self.scene.shutter.close.get())))
    }

    /// The mesh at a keyframe.
    fn keyframe(&mut self, pointer: &str, mesh: &Mesh, keyframe: &MeshKeyframe, data: &MeshData) -> Result<Option<MeshData>> {
        let at_keyframe = match (&keyframe.file, &keyframe.positions) {
            (None, None) => return Ok(Some(data.clone())),
            (file, positions) => {
                let (file, positions, normals) = (file.clone(), positions.clone(), keyframe.normals.clone());
                Mesh { file, positions, normals, keyframes: vec![], ..mesh.clone() }
            }
        };
        self.loaded(pointer, &at_keyframe)
    }
}

/// What makes a keyframe unlike its mesh.
fn difference(keyframe: &MeshData, mesh: &MeshData) -> String {
    let [found, expected] = [keyframe, mesh].map(|mesh| mesh.triangles.len());
    if found != expected {
        return format!("expected the triangles of the mesh, {expected} that have an area, found {found}");
    }
    if keyframe.triangles != mesh.triangles {
        return "expected the triangles of the mesh in the same order, with the same vertices".into();
    }
    match mesh.normals.is_empty() {
        true => "the mesh has no normals, so that its keyframes can have none".into(),
        false => "the mesh has normals, so that its keyframes need them".into(),
    }
}

/// The poses from the opening of the shutter to its closing, at fractions of that interval; a single one if they are all the same.
fn during(poses: &[Pose], open: f64, close: f64) -> Vec<Pose> {
    let opening = Pose { time: 0.0, ..pose_at(poses, open) };
    let within = poses.iter().filter(|pose| open < pose.time && pose.time < close);
    let within = within.map(|pose| Pose { time: (pose.time - open) / (close - open), ..pose.clone() });
    let closing = (open < close).then(|| Pose { time: 1.0, ..pose_at(poses, close) });
    let is_same = |pose: &Pose| pose.positions == opening.positions && pose.normals == opening.normals;
    let others: Vec<Pose> = within.chain(closing).collect();
    if others.iter().all(is_same) { vec![opening] } else { std::iter::once(opening).chain(others).collect() }
}
