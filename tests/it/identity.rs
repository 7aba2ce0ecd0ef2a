//! A picture has the same bits however it is divided, and whatever its units of length and of light.

mod division;
mod effects;
mod instructions;
mod scaling;
pub mod zoo;

use pt::integrator::{Entry, Integrator, choose};

/// With its default options.
fn new(entry: &Entry) -> Box<dyn Integrator> {
    choose(&[&[*entry]], None, Some(entry.name), "").expect("defaults are valid").1
}
