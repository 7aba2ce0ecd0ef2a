//! Time and memory for a million instances of a mesh of a hundred thousand triangles, and what rays cost in instances and in copies.
//!
//! `cargo bench --bench instances`

use std::time::Instant;

use glam::{DVec3, Vec3};
use pt::bsdf::Material;
use pt::camera::{Camera, Pose, Spherical};
use pt::math::{Ray, Rgb, Transform, float};
use pt::scene::Scene;
use pt::shape::{MeshData, MeshPart, TriangleMesh};
use pt::world::{Objects, World};

/// Numbers of cells around and along the ball: 316 · 158 cells of two triangles are about a hundred thousand.
const CELLS: [u32; 2] = [316, 158];
const RAYS: u32 = 1 << 20;

fn main() -> pt::Result<()> {
    let before = peak_megabytes();
    let start = Instant::now();
    let many = world(CELLS, 1_000_000, true)?;
    let seconds = start.elapsed().as_secs_f64();
    let (instances, triangles) = (many.instance_count(), many.primitive_count());
    println!(
        "{instances} instances of {triangles} triangles ready in {seconds:.2} s, peak {:.0} MB (before: {before:.0} MB)",
        peak_megabytes()
    );
    println!("  {:.2} M rays/s", rays_per_second(&many, 500.0));
    drop(many);
    let [instances, copies] = [true, false].map(|is_shared| world([64, 32], 400, is_shared).map(|world| rays_per_second(&world, 10.0)));
    let (instances, copies) = (instances?, copies?);
    println!("400 balls of 4096 triangles: {instances:.2} M rays/s in instances, {copies:.2} in copies, {:.2} as fast", instances / copies);
    Ok(())
}

/// Scene of balls on a plane, turned and scaled.
///
/// - `is_shared`: whether they are instances of one ball, or copies
fn world(cells: [u32; 2], count: u32, is_shared: bool) -> pt::Result<World> {
    let mut world = World::builder(Camera::Spherical(Spherical { pose: Pose::new(&Transform::IDENTITY) }));
    let gray = world.material(Material::diffuse(Rgb::gray(0.5)));
    let edge = f64::from(count).sqrt();
    let mut objects = Objects::default();
    let ball = || TriangleMesh::new(ball(cells));
    if is_shared {
        let mut group = Objects::default();
        group.shape(ball(), Transform::IDENTITY, gray, None);
        let group = world.group(group);
        (0..count).try_for_each(|i| placement(i, edge).map(|place| objects.instance(group, place, None)))?;
    } else {
        (0..count).try_for_each(|i| placement(i, edge).map(|place| objects.shape(ball(), place, gray, None)))?;
    }
    world.objects(objects);
    world.build()
}

fn placement(i: u32, edge: f64) -> pt::Result<Transform> {
    let number = |k: u32| f64::from(float::unit_f32((hash_of(i, k) >> 32) as u32));
    let turn = Transform::rotate(DVec3::new(number(0) + 0.1, number(1), number(2)), 360.0 * number(3))?;
    let place = DVec3::new((number(4) - 0.5) * edge, number(5), (number(6) - 0.5) * edge);
    Ok(Transform::scale(DVec3::splat(0.3 + 0.7 * number(7)))?.then(&turn).then(&Transform::translate(place)?))
}

/// A number of 64 bits.
fn hash_of(i: u32, k: u32) -> u64 {
    let mut z = (u64::from(i) << 8 | u64::from(k)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

/// A ball with waves.
fn ball([around, along]: [u32; 2]) -> MeshData {
    let at = |i: u32, j: u32| {
        let (theta, phi) = (std::f32::consts::PI * (i as f32 + 0.5) / along as f32, std::f32::consts::TAU * j as f32 / around as f32);
        let r = 0.5 * (1.0 + 0.1 * float::sin(9.0 * phi) * float::sin(7.0 * theta) * float::sin(theta));
        r * Vec3::new(float::sin(theta) * float::cos(phi), float::cos(theta), float::sin(theta) * float::sin(phi))
    };
    let index = |i: u32, j: u32| i * around + j % around;
    let cells = (0..along - 1).flat_map(|i| (0..around).map(move |j| (i, j)));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let whole = MeshPart { triangles: 0..triangles.len() as u32, ..MeshPart::default() };
    let positions = (0..along).flat_map(|i| (0..around).map(move |j| at(i, j))).collect();
    MeshData { positions, triangles, parts: vec![whole], ..MeshData::default() }
}

/// Rays from above the plane to points on it, on one thread.
fn rays_per_second(world: &World, reach: f64) -> f64 {
    let start = Instant::now();
    let mut hits = 0;
    for i in 0..RAYS {
        let number = |k: u32| f64::from(float::unit_f32((hash_of(i, k) >> 32) as u32)) - 0.5;
        let from = DVec3::new(number(0) * reach, 5.0, number(1) * reach);
        let to = from + DVec3::new(8.0 * number(2), -5.0, 8.0 * number(3));
        let ray = Ray::new((from - world.origin()).as_vec3(), (to - from).normalize().as_vec3());
        hits += u32::from(world.intersect(&ray).is_some());
    }
    assert!(hits > RAYS / 8, "{hits} hits");
    f64::from(RAYS) * 1e-6 / start.elapsed().as_secs_f64()
}

/// Peak memory of this process (MB); 0 if the system does not report it.
fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()).unwrap_or(0.0) / 1e3
}
