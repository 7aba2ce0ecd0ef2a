//! Wavefront OBJ. The text passes through pt's own check to the crate tobj, which makes the triangles.
//!
//! The statements `v`, `vt`, `vn`, `f`, `g`, `o` and `usemtl` are read. Polygons become fans of triangles, which is right for convex
//! polygons. Material libraries (`mtllib`) are ignored, because materials come from the scene.

use glam::{Vec2, Vec3};

use super::obj_check::Checked;
use super::{Found, Source, invalid};
use crate::shape::mesh_data::MeshData;
use crate::{Error, Result};

/// Reads an OBJ file.
///
/// # Errors
/// [`Error::Invalid`] with up to 20 faults, each with its line; [`Error::Io`] where the source cannot be read.
pub(super) fn read(source: &mut dyn Source, name: &str) -> Result<Found> {
    let mut text = Checked::new(source, name, false);
    let mut mesh = triangles(&mut text, name)?;
    if text.is_mixed() {
        drop(mesh);
        source.rewind().map_err(|e| Error::io(name, e))?;
        text = Checked::new(source, name, true);
        mesh = triangles(&mut text, name)?;
        // No face has texture coordinates: all of them were padding.
        if text.faces_with[0] == 0 {
            mesh.uvs = Vec::new();
        }
    }
    let mut warnings = Vec::new();
    let ignored: Vec<_> = text.ignored.iter().map(|(keyword, count)| format!("{keyword} ({count})")).collect();
    if !ignored.is_empty() {
        warnings.push(format!("{name}: ignored statements: {}", ignored.join(", ")));
    }
    Ok(Found { mesh: MeshData { parts: text.parts, ..mesh }, warnings, directionless: text.directionless })
}

/// Lets tobj read the checked text. It finds a single model, since names and groups are not passed on.
fn triangles(text: &mut Checked<'_>, name: &str) -> Result<MeshData> {
    let read = tobj::load_obj_buf(text, &tobj::GPU_LOAD_OPTIONS, |_| Err(tobj::LoadError::GenericFailure));
    if let Some(error) = text.failure.take() {
        return Err(Error::io(name, error));
    }
    if !text.faults.is_empty() {
        return Err(Error::Invalid(std::mem::take(&mut text.faults)));
    }
    if text.faces == 0 {
        return Err(invalid(name, "no faces"));
    }
    let disagreement = |how: String| Error::Internal(format!("{name}: tobj {how}"));
    let (mut models, _) = read.map_err(|e| disagreement(format!("refused what the check passed: {e}")))?;
    let tobj::Mesh { positions, normals, texcoords, indices, .. } = models.pop().map(|model| model.mesh).unwrap_or_default();
    let mesh = MeshData {
        positions: triples(&positions).map(Vec3::from).collect(),
        normals: triples(&normals).map(Vec3::from).collect(),
        uvs: texcoords.as_chunks().0.iter().copied().map(Vec2::from).collect(),
        colors: Vec::new(),
        triangles: triples(&indices).collect(),
        parts: Vec::new(),
    };
    if mesh.triangles.len() as u64 != text.triangles {
        return Err(disagreement(format!("made {} triangles of {}", mesh.triangles.len(), text.triangles)));
    }
    Ok(mesh)
}

fn triples<T: Copy>(flat: &[T]) -> impl Iterator<Item = [T; 3]> {
    flat.as_chunks().0.iter().copied()
}
