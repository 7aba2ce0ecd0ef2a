//! Rendering a sample of a scene of surfaces allocates no memory.
//!
//! A render allocates memory while it is prepared, and a few times for each wave and tile (the tile's result and sums, and its sampler).
//! Twice the samples make one wave more, of twice the length. So each doubling of the samples adds only the allocations of one wave: at
//! most nine for each tile and eight for the film (twelve with the sums of splats). The length of paths does not matter.
#![allow(unsafe_code, reason = "an allocator is an unsafe trait; every call is the system allocator's own")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

use pt::film::{FilmSpec, MomentFilm};
use pt::integrator::{Integrator, choose};
use pt::integrators::nee::Nee;
use pt::render::{Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::torture::everything::Everything;

/// The system's allocator, counted on the thread that renders, because allocations of other threads depend on how busy the machine is.
struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

thread_local! {
    static IS_COUNTED: Cell<bool> = const { Cell::new(false) };
}

fn count() {
    // The value of a thread that is ending may already be gone.
    if IS_COUNTED.try_with(Cell::get).unwrap_or(false) {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
    }
}

// SAFETY: every call is the system allocator's own, with the caller's arguments.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
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

/// The only test of this binary, because renders of other tests would be counted too.
#[test]
fn samples_allocate_nothing() {
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
