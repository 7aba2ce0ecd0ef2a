//! Time and memory for dense fur, what rays cost in it, and how many hairs they are tested against.
//!
//! `cargo bench --bench curves`, or `cargo bench --bench curves -- 100000` for another number of hairs. Fewer hairs are longer and thicker, so
//! that rays meet as many.

mod memory;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use cpu_time::ThreadTime;
use glam::{DVec3, Vec2, Vec4};
use pt::accel;
use pt::bsdf::Material;
use pt::camera::{Camera, Pose, Spherical};
use pt::math::{Aabb, AreaPdf, Ray, Rgb, Transform};
use pt::primitive::Primitive;
use pt::scene::Scene;
use pt::shape::curves::Basis;
use pt::shape::{Capsule, Curves, Facet, Geometry, Shape, ShapeHit, SurfacePoint};
use pt::torture::Random;
use pt::world::World;

const RAYS: u32 = 1 << 17;

/// Number of hairs for which tests are counted.
const COUNTED: u32 = 100_000;

/// Distances of the origins of rays from the middle of the ball of fur, whose radius is 1: outside, and along the skin.
const DISTANCES: [f64; 2] = [3.0, 1.02];

const KINDS: [(&str, Basis, bool); 4] = [
    ("tubes, B-spline", Basis::Bspline, false),
    ("tubes, Catmull–Rom", Basis::CatmullRom, false),
    ("tubes, Bézier", Basis::Bezier, false),
    ("ribbons, B-spline", Basis::Bspline, true),
];

fn main() -> pt::Result<()> {
    let hairs = std::env::args().find_map(|word| word.parse().ok()).unwrap_or(1_000_000);
    println!("| {hairs} hairs of 4 points | bytes a hair | most while building | ready in | M rays/s from outside | along the skin |");
    println!("|---|---|---|---|---|---|");
    for (name, basis, is_ribbon) in KINDS {
        let before = memory::in_use();
        let start = Instant::now();
        let world = world(fur(hairs, basis, is_ribbon))?;
        let seconds = start.elapsed().as_secs_f64();
        let each = |bytes: usize| (bytes - before) as f64 / f64::from(hairs);
        let (kept, most) = (each(memory::in_use()), each(memory::most()));
        let [outside, along] = DISTANCES.map(|distance| rays_per_second(&world, distance));
        println!("| {name} | {kept:.0} | {most:.0} | {seconds:.1} s | {outside:.3} | {along:.3} |");
    }
    println!("\n| a ray from outside, and along the skin, among {COUNTED} hairs | tests of pieces | of these hits | rays that hit |");
    println!("|---|---|---|---|");
    for (name, basis, is_ribbon) in KINDS {
        let shape = Counted(fur(COUNTED, basis, is_ribbon).bake(&Transform::IDENTITY)?);
        let shapes: Vec<Box<dyn Shape>> = vec![Box::new(shape)];
        let hierarchy = accel::build(Arc::from(shapes));
        let [outside, along] = DISTANCES.map(|distance| tests(&*hierarchy, distance));
        let row = |k: usize| format!("{:.2}, {:.2}", outside[k], along[k]);
        println!("| {name} | {} | {} | {} |", row(0), row(1), row(2));
    }
    Ok(())
}

/// Hairs on a ball of radius 1. A million of them have a length of .1 and a radius of 2·10⁻⁴.
fn fur(hairs: u32, basis: Basis, is_ribbon: bool) -> Curves {
    let mut random = Random::new(1);
    let size = (1e6 / f64::from(hairs)).sqrt();
    let count = hairs as usize * 4;
    let mut curves = Curves { basis, counts: vec![4; hairs as usize], points: Vec::with_capacity(count), normals: vec![] };
    for _ in 0..hairs {
        let (root, bend) = (random.direction(), random.in_cube() * (0.04 * size));
        for k in 0..4 {
            let share = f64::from(k) / 3.0;
            let p = root * (1.0 + 0.1 * size * share) + bend * (share * share);
            curves.points.push(Vec4::from((p.as_vec3(), 2e-4 * size as f32 * (1.2 - share as f32))));
        }
        if is_ribbon {
            let normal = root.cross(random.direction()).normalize().as_vec3();
            curves.normals.extend([normal; 4]);
        }
    }
    curves
}

fn world(curves: Curves) -> pt::Result<World> {
    let mut world = World::builder(Camera::Spherical(Spherical { pose: Pose::new(&Transform::IDENTITY) }));
    let gray = world.material(Material::diffuse(Rgb::gray(0.5)));
    world.shape(curves, Transform::IDENTITY, gray, None);
    world.build()
}

/// Rays from a sphere around the ball to points near its surface.
fn rays(distance: f64) -> Vec<Ray> {
    let mut random = Random::new(2);
    (0..RAYS)
        .map(|_| {
            let from: DVec3 = random.direction() * distance;
            let to = random.direction();
            Ray::new(from.as_vec3(), (to - from).normalize().as_vec3())
        })
        .collect()
}

/// Nearest hits per second of processor time (10⁶/s).
fn rays_per_second(world: &World, distance: f64) -> f64 {
    let rays = rays(distance);
    let start = ThreadTime::now();
    let hits = rays.iter().filter(|ray| world.intersect(ray).is_some()).count();
    let seconds = start.elapsed().as_secs_f64();
    assert!(hits > 0, "some ray hits a hair");
    f64::from(RAYS) / seconds / 1e6
}

/// Tests of pieces per ray, those that find a hit, and the share of the rays that hit anything.
fn tests(hierarchy: &dyn Primitive, distance: f64) -> [f64; 3] {
    for count in [&TESTS, &HITS] {
        count.store(0, Ordering::Relaxed);
    }
    let hits = rays(distance).iter().filter(|ray| hierarchy.intersect(ray).is_some()).count() as u64;
    [TESTS.load(Ordering::Relaxed), HITS.load(Ordering::Relaxed), hits].map(|count| count as f64 / f64::from(RAYS))
}

static TESTS: AtomicU64 = AtomicU64::new(0);
static HITS: AtomicU64 = AtomicU64::new(0);

/// A shape that counts tests and hits.
struct Counted(Box<dyn Shape>);

impl Shape for Counted {
    fn count(&self) -> u32 {
        self.0.count()
    }

    fn bounds(&self, i: u32) -> Aabb {
        self.0.bounds(i)
    }

    fn area(&self, i: u32) -> f32 {
        self.0.area(i)
    }

    fn facet(&self, i: u32) -> Facet {
        self.0.facet(i)
    }

    fn capsule(&self, i: u32) -> Option<Capsule> {
        self.0.capsule(i)
    }

    fn intersect(&self, i: u32, ray: &Ray) -> Option<ShapeHit> {
        let hit = self.0.intersect(i, ray);
        TESTS.fetch_add(1, Ordering::Relaxed);
        HITS.fetch_add(u64::from(hit.is_some()), Ordering::Relaxed);
        hit
    }

    fn point(&self, i: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.0.point(i, ray, hit)
    }

    fn sample_area(&self, i: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        self.0.sample_area(i, u)
    }
}
