//! The same picture, bit for bit: however it is divided, whatever its unit of length and of light.

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
