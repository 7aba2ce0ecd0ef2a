//! Warnings about probable mistakes in a built scene: each names the objects, says what is wrong in the picture, and what to do.
//!
//! A kind of mistake is a file with a function that finds it and a row in [`LINTS`]; what depends on the integrator is apart, in
//! [`warnings_for_camera_paths`]. A warning is for what makes pictures wrong, or is hardly ever meant, so that a healthy scene has none. The
//! tests are random rays with fixed seeds, so that a scene has the same warnings each time; what only few rays meet may pass unseen.
//!
//! Tests: `tests/it/lints.rs`.

mod camera_place;
mod coincident;
mod lights;
mod media;
mod open_glass;
mod overlaps;
mod precision;
mod rays;
mod tinted_glass;

use crate::describe::Names;
use crate::scene::Scene as _;
use crate::world::World;

/// A built scene, and what its parts are called.
pub(super) struct Linted<'a> {
    pub world: &'a World,
    /// The name and kind of each shape of the description.
    pub shapes: &'a [&'a str],
    pub names: &'a Names,
}

impl Linted<'_> {
    /// The name and kind of a shape.
    fn name(&self, shape: u32) -> &str {
        self.shapes.get(self.world.described_shape(shape) as usize).copied().unwrap_or("?")
    }

    /// The name of a light.
    fn light(&self, light: u32) -> &str {
        self.names.light(self.world.lights(), light)
    }
}

/// Finds one kind of mistake: a sentence for each.
type Lint = fn(&Linted) -> Vec<String>;

/// All kinds of mistakes, in the order of their warnings.
const LINTS: [Lint; 9] = [
    precision::warnings,
    open_glass::warnings,
    tinted_glass::warnings,
    media::open,
    media::hidden,
    overlaps::warnings,
    coincident::warnings,
    camera_place::warnings,
    lights::shut_in,
];

/// The largest number of objects that the warnings of one kind name.
const NAMED: usize = 4;

/// The warnings about a scene.
pub(super) fn warnings(linted: &Linted) -> Vec<String> {
    LINTS.iter().flat_map(|lint| lint(linted)).collect()
}

/// The warnings that hold for integrators whose paths start at the camera only.
pub(super) fn warnings_for_camera_paths(linted: &Linted) -> Vec<String> {
    lights::behind_glass(linted)
}

/// The first few sentences, and how many more there are.
///
/// - `more`: what the others are, such as `more shapes of such glass`
fn first_few(mut said: Vec<String>, more: &str) -> Vec<String> {
    let left = said.len().saturating_sub(NAMED);
    said.truncate(NAMED);
    said.extend((left > 0).then(|| format!("and at least {left} {more}")));
    said
}
