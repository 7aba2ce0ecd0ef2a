//! What takes memory: rendering a sample of a scene of surfaces takes none, and a hair little.
//!
//! A render allocates memory while it is prepared, and a few times for each wave and tile (the tile's result and sums, and its sampler).
//! Twice the samples make one wave more, of twice the length. So each doubling of the samples adds only the allocations of one wave: at
//! most nine for each tile and eight for the film (twelve with the sums of splats). The length of paths does not matter.
#![allow(unsafe_code, reason = "an allocator is an unsafe trait; every call is the system allocator's own")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Mutex;
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};

use glam::Vec4;
use pt::bsdf::Material;
use pt::camera::{Camera, Pose, Spherical};
use pt::film::{FilmSpec, MomentFilm};
use pt::integrator::{Integrator, choose};
use pt::integrators::nee::Nee;
use pt::math::{Rgb, Transform};
use pt::render::{Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::shape::Curves;
use pt::shape::curves::Basis;
use pt::torture::Random;
use pt::torture::everything::Everything;
use pt::world::World;

/// The system's allocator, counted on the thread that renders, because allocations of other threads depend on how busy the machine is.
struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);
/// Bytes that are in use, on all threads.
static IN_USE: AtomicI64 = AtomicI64::new(0);

thread_local! {
    static IS_COUNTED: Cell<bool> = const { Cell::new(false) };
}

fn count() {
    // The value of a thread that is ending may already be gone.
    if IS_COUNTED.try_with(Cell::get).unwrap_or(false) {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
    }
}

fn change(bytes: i64) {
    IN_USE.fetch_add(bytes, Ordering::Relaxed);
}

// SAFETY: every call is the system allocator's own, with the caller's arguments.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        change(layout.size() as i64);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        change(-(layout.size() as i64));
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        change(size as i64 - layout.size() as i64);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

const SIZE: [u32; 2] = [64, 48];
const TILE: u32 = 16;
const TILES: u64 = (SIZE[0] / TILE * (SIZE[1] / TILE)) as u64;

/// Number of allocations of a render on one thread.
fn allocations(integrator: &dyn Integrator, kind: Kind, spp: u64) -> u64 {
    let scene = Everything::default().build();
    let settings = Settings { tile: TILE, ..Settings::new(SamplerSpec { kind, seed: 1, spp, ..SamplerSpec::default() }) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be had");
    pool.install(|| {
        IS_COUNTED.set(true);
        let mut film = MomentFilm::new(FilmSpec::new(SIZE[0], SIZE[1]));
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        render(scene, integrator, &mut film, &settings, &Silent);
        ALLOCATIONS.load(Ordering::Relaxed) - before
    })
}

/// The tests run one after the other, because what one allocates would be counted by the other too.
static TURN: Mutex<()> = Mutex::new(());

#[test]
fn samples_allocate_nothing() {
    let _turn = TURN.lock();
    for (entry, (kind, ..)) in pt::integrators::ALL.iter().flat_map(|e| Kind::ALL.iter().map(move |k| (e, k))) {
        let (_, integrator) = choose(&[&[*entry]], None, Some(entry.name), "").expect("defaults are valid");
        let spp = [1, 2, 4, 8, 16, 32];
        let counts = spp.map(|spp| allocations(&*integrator, *kind, spp));
        for ((few, many), before) in counts.iter().zip(&counts[1..]).zip(spp) {
            // Where paths bring light to all pixels, each sample of all pixels is a wave.
            let (waves, film) = if integrator.splats() { (before, 12) } else { (1, 8) };
            // The allocations of one more wave: for each tile a sampler and a tree for each of two sequences, and the lists of samplers,
            // trees, third powers, moments and sums; sometimes also a block of the thread pool's queue.
            assert!(many - few <= waves * (9 * TILES + film + 2), "{} {kind:?}: {counts:?}", entry.name);
        }
    }
    let [shallow, deep] = [2, 16].map(|max_depth| allocations(&Nee { max_depth, ..Nee::default() }, Kind::Independent, 8));
    assert_eq!(shallow, deep, "allocations depend on the depth of paths");
}

/// Bytes that a scene of hairs of four points on a ball keeps. A million of them have a length of .1 and a radius of 2·10⁻⁴; fewer are longer and
/// thicker, so that the fur is as dense. (Of sparse hairs fewer share a leaf of the hierarchy, and each takes more.)
fn bytes_of_hairs(hairs: usize, basis: Basis, is_ribbon: bool) -> i64 {
    let before = IN_USE.load(Ordering::Relaxed);
    let (mut random, size) = (Random::new(1), (1e6 / hairs as f64).sqrt());
    let (mut points, mut normals) = (Vec::with_capacity(4 * hairs), vec![]);
    for _ in 0..hairs {
        let (root, bend) = (random.direction(), random.in_cube() * (0.04 * size));
        points.extend([0.0, 1.0, 2.0, 3.0].map(|k| {
            let share = k / 3.0;
            let p = root * (1.0 + 0.1 * size * share) + bend * (share * share);
            Vec4::from((p.as_vec3(), 2e-4 * size as f32 * (1.2 - share as f32)))
        }));
        if is_ribbon {
            normals.extend([random.direction().cross(root).normalize().as_vec3(); 4]);
        }
    }
    let mut world = World::builder(Camera::Spherical(Spherical { pose: Pose::new(&Transform::IDENTITY) }));
    let gray = world.material(Material::diffuse(Rgb::gray(0.5)));
    world.shape(Curves { basis, counts: vec![4; hairs], points, normals }, Transform::IDENTITY, gray, None);
    let world = world.build().expect("a valid scene");
    let bytes = IN_USE.load(Ordering::Relaxed) - before;
    drop(world);
    bytes
}

/// A hair of four points in dense fur takes at most 200 bytes, a tube of any basis or a ribbon of a B-spline: points and radii take 64 of them, the
/// normals of a ribbon 24, and the boxes, capsules and order of the hierarchy the rest.
#[test]
fn a_hair_takes_at_most_200_bytes() {
    const HAIRS: usize = 20_000;
    let _turn = TURN.lock();
    let tubes = [Basis::CatmullRom, Basis::Bspline, Basis::Bezier, Basis::Linear].map(|basis| (basis, false));
    for (basis, is_ribbon) in tubes.into_iter().chain([(Basis::Bspline, true)]) {
        let bytes = bytes_of_hairs(HAIRS, basis, is_ribbon) as f64 / HAIRS as f64;
        println!("{basis:?}, ribbon {is_ribbon}: {bytes:.0} bytes a hair");
        assert!(bytes <= 200.0, "{basis:?}, ribbon {is_ribbon}: {bytes} bytes a hair");
    }
}
