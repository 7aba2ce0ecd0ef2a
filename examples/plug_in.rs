//! An integrator of one's own, with the whole command line of pt: `cargo run --release --example plug_in -- --help`.
//!
//! A crate of one's own depends on pt alone: `pt::serde`, `pt::schemars` and `pt::glam` are the versions that pt speaks.
//!
//! ```sh
//! cargo run --release --example plug_in -- --integrator depth scenes/cornell-box.json
//! cargo run --release --example plug_in -- --integrator depth -D /integrator/half_distance=3 scenes/cornell-box.json
//! ```

use std::process::ExitCode;
use std::sync::Arc;

use pt::describe::Positive;
use pt::effects::Effects;
use pt::film::FilmSpec;
use pt::integrator::{CameraSample, Context, Entry, Estimator, Integrator};
use pt::math::Spectrum;
use pt::scene::Scene;
use pt::schemars::JsonSchema;
use pt::serde::Deserialize;

/// How near things are, as grey.
///
/// L = h / (h + distance): 1 at the camera, ½ at the distance h, 0 at infinity
///
/// The fields are the integrator's options in a scene file; their types say what is allowed there.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(default, crate = "pt::serde")]
#[schemars(deny_unknown_fields, crate = "pt::schemars")]
struct Depth {
    /// The distance that is shown as ½ [m]. Default: 1.
    half_distance: Option<Positive>,
}

/// Settings meet a scene: here is the place for what is done once, such as tables of the lights.
impl Integrator for Depth {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(View { scene, half: self.half_distance.map_or(1.0, |d| d.get() as f32) })
    }
}

struct View {
    scene: Arc<dyn Scene>,
    half: f32,
}

/// Called for every sample of every pixel, from all threads. Random numbers come from `Context`.
impl Estimator for View {
    fn li(&self, camera: &CameraSample, _: &mut Context) -> Spectrum {
        match self.scene.intersect(&camera.ray) {
            // Directions are unit vectors, so that t is a distance.
            Some(hit) => Spectrum::gray(self.half / (self.half + hit.t)),
            None => Spectrum::BLACK,
        }
    }
}

/// The row that the command line, its help and its lists take it from. Of light it shows nothing: no effects.
const DEPTH: Entry = Entry::of::<Depth>("depth", "how near things are, as grey", Effects::NONE);

fn main() -> ExitCode {
    pt::cli::main_with(&[pt::integrators::ALL, &[DEPTH]])
}
