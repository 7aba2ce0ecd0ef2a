//! Path tracing without light sampling.

use std::ops::ControlFlow;
use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::film::FilmSpec;
use pt::integrator::{
    Bias, CameraPath, CameraSample, Estimator, Integrator, MAX_DEPTH, PathLanes, PathWalk, Roulette, SideBySide, WideWalk,
};
use pt::math::Spectrum;
use pt::math::lanes::Lanes;
use pt::recorder::{End, Event, Origin, Recorder};
use pt::sampler::dimension::{self, Use};
use pt::sampler::{NumberLanes, SampleNumbers};
use pt::scene::Scene;
use pt::world::WideWorld;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Path tracing that follows one path from the camera and adds up the emission of the surfaces it hits.
///
/// L = Σ_k β_k Le(x_k),  β_k = Π f·|cos| / pdf
///
/// No light is sampled, so that no light can be counted twice. The method is slow where lights are small, does not see lights
/// without extent, and serves as the reference for all other methods.
///
/// Source: Kajiya, *The Rendering Equation* (1986).
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Path {
    /// Greatest number of scattering events on a path: 0 shows emission only, 1 adds direct light.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub max_depth: u32,
    /// Number of scattering events before Russian roulette may end a path.
    #[serde(deserialize_with = "pt::integrator::depth")]
    #[schemars(range(max = 65535))]
    pub roulette_depth: u32,
}

impl Default for Path {
    fn default() -> Path {
        Path { max_depth: 64, roulette_depth: 4 }
    }
}

impl Integrator for Path {
    fn prepare(&self, scene: Arc<dyn Scene>, _film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Walk { scene, max_depth: self.max_depth, roulette: Roulette { from_depth: self.roulette_depth } })
    }

    /// Bias of `max_depth`. The integrator without the limit follows the same paths up to that depth; beyond it Russian roulette ends them.
    fn biases(&self) -> Vec<Bias> {
        let without = Path { max_depth: MAX_DEPTH, roulette_depth: self.roulette_depth.min(self.max_depth) };
        vec![Bias { setting: format!("max_depth {}", self.max_depth), without: Box::new(without) }]
    }
}

struct Walk {
    scene: Arc<dyn Scene>,
    max_depth: u32,
    roulette: Roulette,
}

impl PathWalk for Walk {
    type State = CameraPath;

    fn start(&self, camera: &CameraSample) -> CameraPath {
        CameraPath::new(camera)
    }

    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        WideWalk::scene(self).map(|_| self as &dyn SideBySide)
    }

    // Inlined into the loop over the steps, because a call would cost 3 % of a render.
    #[inline(always)]
    fn step<R: Recorder + ?Sized>(&self, path: &mut CameraPath, numbers: &mut SampleNumbers, recorder: &mut R) -> ControlFlow<Spectrum> {
        let Some(hit) = path.hit(&*self.scene) else {
            for (light, radiance) in self.scene.lights().background(path.ray.direction) {
                path.add_emission(radiance, recorder, || Origin::background(light, 1.0));
            }
            return path.end(End::Escaped, recorder);
        };
        let surface = path.surface(&*self.scene, &hit);
        let wo = -path.ray.direction;
        recorder.record(|| Event::vertex(path.depth, &path.ray, &hit, &surface, path.beta));
        path.add_emission(surface.emitted(wo), recorder, || Origin::emission(&surface, 1.0));
        if path.depth == self.max_depth {
            return path.end(End::DepthLimit, recorder);
        }
        let (choice, u) = numbers.get_3d(dimension::vertex(path.depth, Use::Bsdf));
        let sample = surface.sample(wo, choice, u, TransportMode::Radiance);
        path.scatter(&surface, sample, self.roulette, numbers, recorder)?;
        ControlFlow::Continue(())
    }
}

impl WideWalk for Walk {
    fn scene(&self) -> Option<WideWorld<'_>> {
        WideWorld::of(&*self.scene)
    }

    #[inline(always)]
    fn step<L: Lanes>(
        &self,
        scene: WideWorld,
        depth: u32,
        paths: &mut PathLanes<L>,
        numbers: &mut NumberLanes<L>,
        active: L::Mask,
    ) -> L::Mask {
        let hits = scene.intersect(&paths.rays, active);
        let found = L::mask(hits.found);
        scene.background(&paths.rays, active & !found, paths.beta, &mut paths.radiance, |_, _, _| 1.0);
        if !L::any(found) {
            return found;
        }
        let surface = scene.surfaces(&paths.rays, &hits);
        let wo = -paths.rays.direction;
        paths.add(found, surface.emitted(wo));
        if depth == self.max_depth {
            return L::mask(0);
        }
        let sample = scene.scatter(&surface, wo, numbers.get_3d(dimension::vertex(depth, Use::Bsdf)), found);
        paths.scatter(&surface, wo, &sample, self.roulette, depth, numbers)
    }
}
