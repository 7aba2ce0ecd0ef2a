//! Integrator with the mistake that made a glass panel magnify: see docs/glass-panel.md.
//!
//! ```sh
//! cargo run --release --example magnifying_panel -- --integrator magnifying scenes/glass-panel.json
//! ```

use std::process::ExitCode;
use std::sync::Arc;

use pt::bsdf::{Lobe, TransportMode};
use pt::effects::Effects;
use pt::film::FilmSpec;
use pt::integrator::{CameraSample, Context, Entry, Estimator, Integrator, Vacuum, sample_light};
use pt::math::{Density, Spectrum};
use pt::sampler::dimension::{self, Use};
use pt::scene::Scene;
use schemars::JsonSchema;
use serde::Deserialize;

/// Path tracer with light sampling that leaves glass with a normal on the wrong side.
///
/// t = ηd + (η cos θ − cos θt) n holds where n opposes d. When light leaves the glass, this code inverts η and uses |cos θ|, but n still
/// points along d. The direction then has the wrong length, which normalising hides, and a small angle θ' inside becomes θ'·n/(2n − 1)
/// outside.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
struct Magnifying {
    /// Greatest number of scattering events on a path.
    max_depth: u32,
}

impl Default for Magnifying {
    fn default() -> Magnifying {
        Magnifying { max_depth: 24 }
    }
}

impl Integrator for Magnifying {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Walk { scene, max_depth: self.max_depth })
    }
}

struct Walk {
    scene: Arc<dyn Scene>,
    max_depth: u32,
}

impl Estimator for Walk {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        let (mut ray, mut beta, mut radiance, mut sees_lights) = (camera.ray, Spectrum::ONE, Spectrum::BLACK, true);
        for depth in 0..self.max_depth {
            let Some(hit) = self.scene.intersect(&ray) else { break };
            let surface = self.scene.surface(&ray, &hit);
            let wo = -ray.direction;
            // Light that was sampled at the last vertex is not counted again.
            if sees_lights {
                radiance += beta * surface.emitted(wo);
            }
            let direct = sample_light(&*self.scene, &Vacuum, &surface, wo, dimension::vertex(depth, Use::Light), 0.0, &mut cx.numbers);
            radiance += beta * direct.map_or(Spectrum::BLACK, |(direct, _)| direct);
            let (choice, u) = cx.numbers.get_3d(dimension::vertex(depth, Use::Bsdf));
            let Some((wi, sample)) = surface.sample(wo, choice, u, TransportMode::Radiance) else { break };
            beta *= sample.weight;
            sees_lights = sample.density == Density::Delta;
            let (d, n, eta) = (ray.direction, surface.point.ng, 1.0 / sample.eta);
            let leaves_glass = sample.lobe == Lobe::Transmission && n.dot(d) > 0.0;
            let bent = if leaves_glass {
                let cos = n.dot(d).abs();
                let cos_t = (1.0 - eta * eta * (1.0 - cos * cos)).max(0.0).sqrt();
                (eta * d + (eta * cos - cos_t) * n).normalize()
            } else {
                wi
            };
            ray = surface.spawn(bent, ray.time);
        }
        radiance
    }
}

const MAGNIFYING: Entry = Entry::of::<Magnifying>(
    "magnifying",
    "a path tracer that forgets to turn a normal on leaving glass",
    Effects::ALL.without(Effects::DISPERSION).without(Effects::ENVIRONMENT),
);

fn main() -> ExitCode {
    pt::cli::main_with(&[pt::integrators::ALL, &[MAGNIFYING]])
}
