//! Mesh files: invalid files and their messages, and laws of reading.

use std::io::Cursor;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};
use proptest::test_runner::{Config, RngSeed};
use pt::describe::mesh;
use pt::shape::mesh_data::MeshData;

mod bad_input;
mod clean;
mod files;
mod fuzz;
mod laws;

type Read = pt::Result<(MeshData, Vec<String>)>;

/// Reads bytes under the name `mesh.obj`.
fn read(bytes: impl AsRef<[u8]>) -> Read {
    mesh::read(Cursor::new(bytes.as_ref()), "mesh.obj")
}

/// Reads bytes that must be a valid mesh.
fn mesh_of(bytes: impl AsRef<[u8]>) -> MeshData {
    let bytes = bytes.as_ref();
    match read(bytes) {
        Ok((mesh, _)) => mesh,
        Err(error) => panic!("{error}\n{}", String::from_utf8_lossy(bytes)),
    }
}

fn area(mesh: &MeshData) -> f64 {
    mesh.triangles.iter().map(|&t| mesh.cross(t).length() / 2.0).sum()
}

type Corner = (Vec3, Option<Vec3>, Option<Vec2>);

/// A mesh without its numbering of vertices: for each triangle the corners with normal (where smooth) and uv.
fn seen(mesh: &MeshData) -> Vec<[Corner; 3]> {
    let normal = |i: u32| mesh.normals.get(i as usize).copied().filter(|&n| n != Vec3::ZERO);
    let corners = |&t: &[u32; 3]| {
        let is_smooth = t.iter().all(|&i| normal(i).is_some());
        t.map(|i| (mesh.positions[i as usize], normal(i).filter(|_| is_smooth), mesh.uvs.get(i as usize).copied()))
    };
    mesh.triangles.iter().map(corners).collect()
}

/// Asserts the invariants of every mesh that was read.
fn assert_sound(mesh: &MeshData) {
    let vertices = mesh.positions.len();
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < vertices));
    assert!(mesh.triangles.iter().all(|&t| mesh.cross(t) != DVec3::ZERO));
    assert!(mesh.positions.iter().all(|p| p.is_finite()) && mesh.normals.iter().all(|n| n.is_finite()));
    assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
    assert!([0, vertices].contains(&mesh.normals.len()) && [0, vertices].contains(&mesh.uvs.len()));
    let mut end = 0;
    for part in &mesh.parts {
        assert!(part.triangles.start == end && part.triangles.end > end, "parts cover the triangles in order");
        end = part.triangles.end;
    }
    assert_eq!(end as usize, mesh.triangles.len());
}

/// Configuration with this number of cases and a fixed seed, so that every run has the same cases.
fn cases(cases: u32) -> Config {
    Config { cases, failure_persistence: None, rng_seed: RngSeed::Fixed(0x6d65_7368), ..Config::default() }
}

fn write_to(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> std::path::PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).expect("the temporary folder takes files");
    path
}

/// Four vertices of a square, to which tests add faces.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
