//! Ambient occlusion.

use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::describe::Positive;
use pt::film::FilmSpec;
use pt::integrator::{CameraSample, Context, Estimator, Integrator};
use pt::math::Spectrum;
use pt::sampler::dimension::{self, Use};
use pt::scene::Scene;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Ambient occlusion: fraction of the directions sampled from the material at the first hit in which nothing is near.
///
/// The result is black where the camera ray hits nothing, or a material that scatters nothing.
#[derive(Clone, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct AmbientOcclusion {
    /// Distance beyond which surfaces do not count (m). Default: no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_distance: Option<Positive>,
}

impl Integrator for AmbientOcclusion {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(View { scene, max_distance: self.max_distance.map_or(f32::INFINITY, |d| d.get() as f32) })
    }
}

struct View {
    scene: Arc<dyn Scene>,
    max_distance: f32,
}

impl Estimator for View {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        let Some(hit) = camera.hit(&*self.scene) else { return Spectrum::BLACK };
        let surface = self.scene.surface(&camera.ray, &hit);
        let (choice, u) = cx.numbers.get_3d(dimension::vertex(0, Use::Bsdf));
        let Some((wi, _)) = surface.sample(-camera.ray.direction, choice, u, TransportMode::Radiance) else { return Spectrum::BLACK };
        let probe = surface.spawn(wi, camera.ray.time).within(self.max_distance);
        if self.scene.occluded(&probe) { Spectrum::BLACK } else { Spectrum::ONE }
    }
}
