//! A custom integrator with the complete command line of pt: `cargo run --release --example plug_in -- --help`.
//!
//! Such a crate depends on pt alone: `pt::serde`, `pt::schemars` and `pt::glam` are the versions that pt uses.
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

/// Integrator that shows the nearness of the first surface as a shade of grey.
///
/// L = h / (h + distance): 1 at the camera, ½ at the distance h, 0 at infinity
///
/// The fields are the options of the integrator in a scene file, and their types determine which values are allowed.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(default, crate = "pt::serde")]
#[schemars(deny_unknown_fields, crate = "pt::schemars")]
struct Depth {
    /// Distance that is shown as ½ [m]. Default: 1.
    half_distance: Option<Positive>,
}

/// Prepares the integrator for a scene. Work that is done once, such as tables of the lights, belongs here.
impl Integrator for Depth {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(View { scene, half: self.half_distance.map_or(1.0, |d| d.get() as f32) })
    }
}

struct View {
    scene: Arc<dyn Scene>,
    half: f32,
}

/// Computes the radiance of every sample of every pixel, on all threads. Random numbers come from `Context`.
impl Estimator for View {
    fn li(&self, camera: &CameraSample, _: &mut Context) -> Spectrum {
        match self.scene.intersect(&camera.ray) {
            // Directions are unit vectors, so that t is a distance.
            Some(hit) => Spectrum::gray(self.half / (self.half + hit.t)),
            None => Spectrum::BLACK,
        }
    }
}

/// Row of the table of integrators, for the command line and its help. The pictures show no light, hence no effects.
const DEPTH: Entry = Entry::of::<Depth>("depth", "how near things are, as grey", Effects::NONE);

fn main() -> ExitCode {
    pt::cli::main_with(&[pt::integrators::ALL, &[DEPTH]])
}
