//! Integrators are plug-ins: the folder `integrators` compiles unchanged as part of another crate, and its pictures are the same.
//!
//! If an integrator used a private item of the library, this file would not compile.

#[path = "../../integrators/mod.rs"]
#[allow(dead_code)]
mod integrators;

use pt::integrator::choose;
use pt::torture::everything::{Shot, render_on};

/// Every integrator, compiled here and in the library, renders the same bits, on different numbers of threads.
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
