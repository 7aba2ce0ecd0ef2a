//! Time and memory for a million hairs, and what rays cost among them.
//!
//! `cargo bench --bench curves`

mod memory;

use std::time::Instant;

use cpu_time::ThreadTime;
use glam::{DVec3, Vec4};
use pt::bsdf::Material;
use pt::camera::{Camera, Pose, Spherical};
use pt::math::{Ray, Rgb, Transform};
use pt::scene::Scene;
use pt::shape::Curves;
use pt::shape::curves::Basis;
use pt::torture::Random;
use pt::world::World;

const HAIRS: u32 = 1_000_000;
const RAYS: u32 = 1 << 18;

fn main() -> pt::Result<()> {
    println!("| a million hairs of 4 points | bytes a hair | most while building | ready in | M rays/s from outside | along the skin |");
    println!("|---|---|---|---|---|---|");
    for (name, basis, is_ribbon) in [
        ("tubes, B-spline", Basis::Bspline, false),
        ("tubes, Catmull–Rom", Basis::CatmullRom, false),
        ("ribbons, B-spline", Basis::Bspline, true),
    ] {
        let before = memory::in_use();
        let start = Instant::now();
        let world = world(basis, is_ribbon)?;
        let seconds = start.elapsed().as_secs_f64();
        let each = |bytes: usize| (bytes - before) as f64 / f64::from(HAIRS);
        let (kept, most) = (each(memory::in_use()), each(memory::most()));
        let [outside, along] = [3.0, 1.02].map(|distance| rays_per_second(&world, distance));
        println!("| {name} | {kept:.0} | {most:.0} | {seconds:.1} s | {outside:.3} | {along:.3} |");
    }
    Ok(())
}

/// Hairs of a length of .1 and a radius of 2·10⁻⁴ on a ball of radius 1.
fn world(basis: Basis, is_ribbon: bool) -> pt::Result<World> {
    let mut random = Random::new(1);
    let count = HAIRS as usize * 4;
    let mut curves = Curves { basis, counts: vec![4; HAIRS as usize], points: Vec::with_capacity(count), normals: vec![] };
    for _ in 0..HAIRS {
        let (root, bend) = (random.direction(), random.in_cube() * 0.04);
        for k in 0..4 {
            let share = f64::from(k) / 3.0;
            let p = root * (1.0 + 0.1 * share) + bend * (share * share);
            curves.points.push(Vec4::from((p.as_vec3(), 2e-4 * (1.2 - share as f32))));
        }
        if is_ribbon {
            let normal = root.cross(random.direction()).normalize().as_vec3();
            curves.normals.extend([normal; 4]);
        }
    }
    let mut world = World::builder(Camera::Spherical(Spherical { pose: Pose::new(&Transform::IDENTITY) }));
    let gray = world.material(Material::diffuse(Rgb::gray(0.5)));
    world.shape(curves, Transform::IDENTITY, gray, None);
    world.build()
}

/// Nearest hits per second of processor time (10⁶/s) of rays from a sphere around the ball to points near its surface.
fn rays_per_second(world: &World, distance: f64) -> f64 {
    let mut random = Random::new(2);
    let rays: Vec<Ray> = (0..RAYS)
        .map(|_| {
            let from: DVec3 = random.direction() * distance;
            let to = random.direction();
            Ray::new(from.as_vec3(), (to - from).normalize().as_vec3())
        })
        .collect();
    let start = ThreadTime::now();
    let hits = rays.iter().filter(|ray| world.intersect(ray).is_some()).count();
    let seconds = start.elapsed().as_secs_f64();
    assert!(hits > 0, "some ray hits a hair");
    f64::from(RAYS) / seconds / 1e6
}
