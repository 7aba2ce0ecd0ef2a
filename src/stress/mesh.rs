//! Changes of the triangles of meshes that keep their surfaces.

use glam::{DVec3, Vec2, Vec3};
use serde_json::{Value, json};

use crate::describe::{Files, Mesh, Scene, Shape};
use crate::error::Result;
use crate::shape::MeshData;

/// Meshes with more triangles are left as they are: as JSON they would take gigabytes.
const MOST_TRIANGLES: usize = 100_000;

/// Number of parts of each side of the triangle within the largest one.
const PARTS: usize = 45;

/// Size of the inner triangle as a share of the whole one. The sides of the whole one are not divided, so that no vertex lies on the side
/// of a neighbour, where rounding would open a gap.
const INNER: f64 = 0.9;

/// Edits every mesh of one material, those within groups too, but for meshes whose triangles control a smooth surface or whose vertices move. Files are replaced
/// by their triangles.
///
/// # Errors
/// The errors of reading mesh files.
pub fn edit_all(changed: &mut Value, scene: &Scene, files: &Files, edit: fn(&mut MeshData)) -> Result<()> {
    edit_list(&mut changed["shapes"], &scene.shapes, files, edit)?;
    for (name, shapes) in &scene.groups {
        edit_list(&mut changed["groups"][name.as_str()], shapes, files, edit)?;
    }
    Ok(())
}

fn edit_list(changed: &mut Value, shapes: &[Shape], files: &Files, edit: fn(&mut MeshData)) -> Result<()> {
    let Some(values) = changed.as_array_mut() else { return Ok(()) };
    for (value, shape) in values.iter_mut().zip(shapes) {
        match shape {
            Shape::Mesh(mesh) => edit_mesh(value, mesh, files, edit)?,
            Shape::Group(group) => edit_list(&mut value["shapes"], &group.shapes, files, edit)?,
            _ => {}
        }
    }
    Ok(())
}

fn edit_mesh(value: &mut Value, mesh: &Mesh, files: &Files, edit: fn(&mut MeshData)) -> Result<()> {
    if mesh.has_computed_normals() || !mesh.keyframes.is_empty() {
        return Ok(());
    }
    let mut data = match &mesh.file {
        Some(file) => files.mesh(file)?.0,
        None => return edit_inline(value, mesh, edit),
    };
    let has_parts = data.parts.len() > 1 || data.parts.iter().any(|part| part.material.is_some()) || !mesh.materials.is_empty();
    if has_parts || data.triangles.len() > MOST_TRIANGLES || data.colors.iter().any(|color| color.w != 1.0) {
        return Ok(());
    }
    value.as_object_mut().expect("a mesh").remove("file");
    edit(&mut data);
    write(value, &data);
    Ok(())
}

fn edit_inline(value: &mut Value, mesh: &Mesh, edit: fn(&mut MeshData)) -> Result<()> {
    let mut data = MeshData {
        positions: mesh.positions.iter().flatten().map(|p| DVec3::from(p.0).as_vec3()).collect(),
        normals: mesh.normals.iter().flatten().map(|n| DVec3::from(n.0).as_vec3()).collect(),
        uvs: mesh.uvs.iter().flatten().map(|uv| Vec2::new(uv[0].get() as f32, uv[1].get() as f32)).collect(),
        colors: mesh.colors.iter().flatten().map(|color| Vec3::from(color.linear().map(|c| c as f32)).extend(1.0)).collect(),
        triangles: mesh.triangles.clone().unwrap_or_default(),
        parts: vec![],
    };
    edit(&mut data);
    write(value, &data);
    Ok(())
}

fn write(value: &mut Value, data: &MeshData) {
    let rows = |v: Vec3| v.as_dvec3().to_array();
    value["positions"] = data.positions.iter().map(|p| json!(rows(*p))).collect();
    value["triangles"] = json!(data.triangles);
    if !data.normals.is_empty() {
        value["normals"] = data.normals.iter().map(|n| json!(rows(*n))).collect();
    }
    if !data.uvs.is_empty() {
        value["uvs"] = data.uvs.iter().map(|uv| json!(uv.as_dvec2().to_array())).collect();
    }
    if !data.colors.is_empty() {
        value["colors"] = data.colors.iter().map(|color| json!(rows(color.truncate()))).collect();
    }
}

/// The triangles in reverse order.
pub fn reversed(data: &mut MeshData) {
    data.triangles.reverse();
}

/// Divides the largest triangle into thousands that lie in its plane.
pub fn refined(data: &mut MeshData) {
    let position = |v: u32| data.positions[v as usize].as_dvec3();
    let area = |&[a, b, c]: &[u32; 3]| (position(b) - position(a)).cross(position(c) - position(a)).length();
    let largest = (0..data.triangles.len()).max_by(|&i, &j| area(&data.triangles[i]).total_cmp(&area(&data.triangles[j])));
    let Some(corners) = largest.map(|largest| data.triangles.swap_remove(largest)) else { return };
    // Vertex (i, j) of the inner triangle has the weights i, j and PARTS − i − j of its corners.
    let mut number = |weights: [f64; 3]| {
        fn mean<const N: usize>(rows: [[f32; N]; 3], weights: [f64; 3]) -> [f32; N] {
            std::array::from_fn(|k| (0..3).map(|c| weights[c] * f64::from(rows[c][k])).sum::<f64>() as f32)
        }
        let of = corners.map(|corner| corner as usize);
        data.positions.push(mean(of.map(|v| data.positions[v].to_array()), weights).into());
        if !data.normals.is_empty() {
            data.normals.push(mean(of.map(|v| data.normals[v].to_array()), weights).into());
        }
        if !data.uvs.is_empty() {
            data.uvs.push(mean(of.map(|v| data.uvs[v].to_array()), weights).into());
        }
        if !data.colors.is_empty() {
            data.colors.push(mean(of.map(|v| data.colors[v].to_array()), weights).into());
        }
        data.positions.len() as u32 - 1
    };
    let grid: Vec<Vec<u32>> = (0..=PARTS)
        .map(|i| {
            let weights = |j| [i, j, PARTS - i - j].map(|count| INNER * count as f64 / PARTS as f64 + (1.0 - INNER) / 3.0);
            (0..=PARTS - i).map(|j| number(weights(j))).collect()
        })
        .collect();
    let inner = |i: usize, j: usize| grid[i][j];
    for i in 0..PARTS {
        for j in 0..PARTS - i {
            data.triangles.push([inner(i, j), inner(i + 1, j), inner(i, j + 1)]);
            if i + j + 2 <= PARTS {
                data.triangles.push([inner(i + 1, j), inner(i + 1, j + 1), inner(i, j + 1)]);
            }
        }
    }
    // Between each side and the side of the inner triangle beside it.
    let ends = [(PARTS, 0), (0, PARTS), (0, 0)];
    for from in 0..3 {
        let to = (from + 1) % 3;
        let (a, b) = (corners[from], corners[to]);
        let between = |start: usize, end: usize, k: usize| (start * (PARTS - k) + end * k) / PARTS;
        let at = |k| inner(between(ends[from].0, ends[to].0, k), between(ends[from].1, ends[to].1, k));
        data.triangles.extend((0..PARTS).map(|k| [a, at(k + 1), at(k)]));
        data.triangles.push([a, b, at(PARTS)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The divided mesh has the area and the winding of the whole one, and each inner edge is shared by two triangles.
    #[test]
    fn a_divided_triangle_covers_the_whole_one() {
        let positions = vec![Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.5, 2.0, 1.0)];
        let whole = MeshData { positions, triangles: vec![[0, 1, 2]], ..MeshData::default() };
        let mut parts = whole.clone();
        refined(&mut parts);
        let area = |data: &MeshData| {
            let vector = |&[a, b, c]: &[u32; 3]| {
                let [a, b, c] = [a, b, c].map(|v| data.positions[v as usize].as_dvec3());
                (b - a).cross(c - a)
            };
            let sum: DVec3 = data.triangles.iter().map(vector).sum();
            (sum, data.triangles.iter().map(|t| vector(t).length()).sum::<f64>())
        };
        let ((whole, size), (sum, sizes)) = (area(&whole), area(&parts));
        assert!((whole - sum).length() < 1e-6 * size && (sizes - size).abs() < 1e-6 * size, "{whole} {sum} {size} {sizes}");
        let mut edges = std::collections::BTreeMap::new();
        for t in &parts.triangles {
            (0..3).for_each(|k| *edges.entry([t[k], t[(k + 1) % 3]]).or_insert(0) += 1);
        }
        let single: Vec<_> = edges.keys().filter(|[a, b]| !edges.contains_key(&[*b, *a])).collect();
        assert_eq!(single, [&[0, 1], &[1, 2], &[2, 0]]);
        assert!(edges.values().all(|count| *count == 1) && parts.triangles.len() > 2000);
    }
}
