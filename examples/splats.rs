//! A custom integrator whose paths start at the lights, with the complete command line of pt.
//!
//! Each path goes from a light to the first surface that it hits, and from there to the camera: emission and direct light. Light that
//! arrives at the camera counts in whatever pixel shows the surface. pt gives the same bits for any number of threads, and error bars.
//!
//! ```sh
//! cargo run --release --example splats -- --integrator first_light scenes/cornell-box.json
//! cargo run --release --example splats -- verify scenes/cornell-box.json first_light nee -D '/integrator={"type":"nee","max_depth":1}'
//! ```

use std::process::ExitCode;
use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::effects::Effects;
use pt::film::FilmSpec;
use pt::integrator::{CameraSample, Context, Entry, Estimator, Integrator, LightPath};
use pt::light::ShadowTarget;
use pt::math::{Spectrum, Vec2};
use pt::sampler::dimension::{self, Use};
use pt::scene::Scene;
use pt::schemars::JsonSchema;
use pt::serde::Deserialize;

/// Integrator that shows the light of the first surface that light hits.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(default, crate = "pt::serde")]
#[schemars(deny_unknown_fields, crate = "pt::schemars")]
struct FirstLight {}

impl Integrator for FirstLight {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Walk { scene })
    }

    /// Without this there is no `light_path` in the context.
    fn splats(&self) -> bool {
        true
    }
}

struct Walk {
    scene: Arc<dyn Scene>,
}

impl Estimator for Walk {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        if let Some(path) = &mut cx.light_path {
            self.follow(path);
        }
        // What shines itself is seen by the camera's own ray.
        match self.scene.intersect(&camera.ray) {
            Some(hit) => self.scene.surface(&camera.ray, &hit).emitted(-camera.ray.direction),
            None => self.scene.lights().background(camera.ray.direction).fold(Spectrum::BLACK, |sum, (_, light)| sum + light),
        }
    }
}

impl Walk {
    /// Follows one path, and adds its light to the film. `None` if it hits nothing.
    fn follow(&self, path: &mut LightPath) -> Option<bool> {
        let (choice, position) = path.numbers.get_3d(dimension::vertex(0, Use::Light));
        let (_, direction) = path.numbers.get_3d(dimension::vertex(0, Use::Bsdf));
        let emitted = self.scene.lights().emit(choice, position, direction, 0.0)?;
        let hit = self.scene.intersect(&emitted.ray)?;
        let surface = self.scene.surface(&emitted.ray, &hit);
        // A camera with a lens would take a point of the lens from two more numbers.
        let camera = self.scene.camera().connect(surface.point.p, path.aspect(), Vec2::ZERO, 0.0)?;
        let f = surface.eval(-emitted.ray.direction, camera.wi, TransportMode::Importance);
        let passed = self.scene.transmittance(&surface.shadow_ray(camera.wi, &ShadowTarget::Point(camera.end), 0.0))?;
        Some(path.splat(camera.film, emitted.flux() * f * camera.weight * passed, 1, emitted.light))
    }
}

/// Row of the table of integrators, for the command line and its help.
const FIRST_LIGHT: Entry = Entry::of::<FirstLight>(
    "first_light",
    "emission and direct light, by paths from the lights",
    Effects::AREA_LIGHT.union(Effects::POINT_LIGHT).union(Effects::ENVIRONMENT).union(Effects::TEXTURES).union(Effects::CUT_OUTS),
);

fn main() -> ExitCode {
    pt::cli::main_with(&[pt::integrators::ALL, &[FIRST_LIGHT]])
}
