//! A picture has the same bits for every division of the work.

mod division;
mod effects;
mod instructions;
mod side_by_side;

use pt::integrator::{Entry, Integrator, choose};

/// An integrator with its default options.
pub fn new(entry: &Entry) -> Box<dyn Integrator> {
    choose(&[&[*entry]], None, Some(entry.name), "").expect("defaults are valid").1
}
