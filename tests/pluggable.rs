//! Integrators are plug-ins: the folder compiles as part of another crate, unchanged, and its pictures are the same.
//!
//! A private item of the library used there is a compile error of this file.

#[path = "../integrators/mod.rs"]
#[allow(dead_code)]
mod integrators;

#[path = "it/geometry.rs"]
#[allow(dead_code)]
mod geometry;

#[path = "it/random.rs"]
#[allow(dead_code)]
mod random;

#[path = "it/identity/zoo.rs"]
#[allow(dead_code)]
mod zoo;

use pt::integrator::choose;
use zoo::{Shot, render_on};

/// Every integrator, foreign and own, on different numbers of threads: the same bits.
#[test]
fn foreign_integrators_render_the_same_bits() {
    assert_eq!(integrators::ALL.len(), pt::integrators::ALL.len());
    for (foreign, own) in integrators::ALL.iter().zip(pt::integrators::ALL) {
        assert_eq!(foreign.name, own.name);
        let picture = |entry: &pt::integrator::Entry, threads| {
            let (_, integrator) = choose(&[&[*entry]], None, Some(entry.name), "").expect("defaults are valid");
            render_on(threads, &*integrator, &Shot::default())
        };
        assert_eq!(picture(foreign, 3), picture(own, 1), "{}", own.name);
    }
}
