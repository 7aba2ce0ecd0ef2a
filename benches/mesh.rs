//! Time and memory for a million triangles, from file to hierarchy.
//!
//! `cargo bench --bench mesh`. The file is a wavy square, made here.

use std::io::BufWriter;
use std::time::Instant;

use glam::Vec3;
use pt::bsdf::Material;
use pt::camera::{Camera, Pose, Spherical};
use pt::describe::mesh;
use pt::math::{Rgb, Transform, float};
use pt::shape::{MeshData, MeshPart, TriangleMesh};
use pt::world::World;

/// Number of cells along each edge: 708² cells of two triangles are about a million.
const EDGE: u32 = 708;

fn main() -> pt::Result<()> {
    let folder = tempfile::tempdir().map_err(|e| pt::Error::io("temporary folder", e))?;
    for name in ["million.ply", "million.obj"] {
        let path = folder.path().join(name);
        let io = |e| pt::Error::io(&path, e);
        let mut file = BufWriter::new(std::fs::File::create(&path).map_err(io)?);
        let written = if name.ends_with("obj") { wavy().write_obj(&mut file) } else { wavy().write_ply_binary(&mut file) };
        written.map_err(io)?;
        drop(file);
        let before = peak_megabytes();
        let start = Instant::now();
        let (data, _) = mesh::load(&path, name)?;
        let (loaded, triangles) = (start.elapsed().as_secs_f64(), data.triangles.len());
        let mut world = World::builder(Camera::Spherical(Spherical { pose: Pose::new(&Transform::IDENTITY) }));
        let gray = world.material(Material::diffuse(Rgb::gray(0.5)));
        world.shape(TriangleMesh::new(data), Transform::IDENTITY, gray, None);
        let world = world.build()?;
        let total = start.elapsed().as_secs_f64();
        let memory = format!("peak {:.0} MB (before: {before:.0} MB)", peak_megabytes());
        println!("{name}: {triangles} triangles read in {loaded:.2} s, ready in {total:.2} s, {memory}");
        drop(world);
    }
    Ok(())
}

fn wavy() -> MeshData {
    let at = |i: u32, j: u32| {
        let (x, z) = (i as f32 / EDGE as f32, j as f32 / EDGE as f32);
        Vec3::new(x, 0.02 * float::sin(40.0 * x) * float::cos(40.0 * z), z)
    };
    let index = |i: u32, j: u32| i * (EDGE + 1) + j;
    let cells = (0..EDGE).flat_map(|i| (0..EDGE).map(move |j| (i, j)));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let whole = MeshPart { triangles: 0..triangles.len() as u32, ..MeshPart::default() };
    let positions = (0..=EDGE).flat_map(|i| (0..=EDGE).map(move |j| at(i, j))).collect();
    MeshData { positions, triangles, parts: vec![whole], ..MeshData::default() }
}

/// Peak memory of this process (MB); 0 if the system does not report it.
fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kib = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.trim().parse().ok());
    kib.map_or(0.0, |kib: f64| kib * 1024e-6)
}
