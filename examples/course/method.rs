//! A light transport method that is a single function.

use std::sync::Arc;

use pt::effects::Effects;
use pt::film::FilmSpec;
use pt::integrator::{CameraSample, Context, Entry, Estimator, Integrator, Options};
use pt::math::{Ray, Spectrum};
use pt::sampler::SampleNumbers;
use pt::scene::Scene;
use pt::schemars::{self, JsonSchema};

/// Estimate of the radiance that arrives along a ray [W·m⁻²·sr⁻¹], by the random numbers of one sample.
pub type Radiance = fn(&dyn Scene, &Ray, &mut SampleNumbers) -> Spectrum;

/// Integrator of a function.
pub struct Method(pub Radiance);

impl Integrator for Method {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Prepared { scene, radiance: self.0 })
    }
}

struct Prepared {
    scene: Arc<dyn Scene>,
    radiance: Radiance,
}

impl Estimator for Prepared {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        (self.radiance)(&*self.scene, &camera.ray, &mut cx.numbers)
    }
}

/// Options of a method that has none.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields, crate = "pt::schemars")]
struct NoOptions {}

/// Row of the table of integrators.
///
/// - `new`: makes the [`Method`]
pub const fn row(name: &'static str, about: &'static str, new: fn(&Options) -> Box<dyn Integrator>) -> Entry {
    Entry { name, about, simulates: Effects::ALL, when_missing: &[], new, schema: || schemars::schema_for!(NoOptions) }
}
