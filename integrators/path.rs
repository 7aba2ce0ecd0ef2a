//! Path tracing without light sampling.

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::effects::Effects;
use pt::film::FilmSpec;
use pt::integrator::{
    Bias, CameraPath, CameraSample, Estimator, Filled, Integrator, MAX_DEPTH, PathLanes, PathWalk, Roulette, SideBySide, Space, Vacuum,
    WideSpace, WideWalk,
};
use pt::math::Spectrum;
use pt::math::lanes::Lanes;
use pt::recorder::{End, Event, Origin, Recorder};
use pt::sampler::dimension::{self, Use};
use pt::sampler::{NumberLanes, SampleNumbers};
use pt::scene::{Interaction, Scene};
use pt::world::WideWorld;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Path tracing that follows one path from the camera and adds up the emission of the surfaces it hits.
///
/// L = Σ_k β_k Le(x_k),  β_k = Π f·|cos| / pdf
///
/// No light is sampled, so that no light can be counted twice. The method is slow where lights are small, does not see lights
/// without extent, and serves as the reference for all other methods. Where a participating medium scatters the path, the factor of β is
/// the phase function divided by its density, 1.
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
        match scene.effects().contains(Effects::MEDIA) {
            true => Box::new(self.walk::<Filled>(scene)),
            false => Box::new(self.walk::<Vacuum>(scene)),
        }
    }

    /// Bias of `max_depth`. The integrator without the limit follows the same paths up to that depth; beyond it Russian roulette ends them.
    fn biases(&self) -> Vec<Bias> {
        let without = Path { max_depth: MAX_DEPTH, roulette_depth: self.roulette_depth.min(self.max_depth) };
        vec![Bias { setting: format!("max_depth {}", self.max_depth), without: Box::new(without) }]
    }
}

impl Path {
    fn walk<S>(&self, scene: Arc<dyn Scene>) -> Walk<S> {
        Walk { scene, max_depth: self.max_depth, roulette: Roulette { from_depth: self.roulette_depth }, space: PhantomData }
    }
}

/// The method in a space without or with media.
struct Walk<S> {
    scene: Arc<dyn Scene>,
    max_depth: u32,
    roulette: Roulette,
    space: PhantomData<S>,
}

impl<S: WideSpace> PathWalk for Walk<S> {
    type State = (CameraPath, S);

    fn start(&self, camera: &CameraSample) -> (CameraPath, S) {
        (CameraPath::new(camera), S::at_camera(&*self.scene, camera))
    }

    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        WideWalk::scene(self).map(|_| self as &dyn SideBySide)
    }

    // Inlined into the loop over the steps, because a call would cost 3 % of a render.
    #[inline(always)]
    fn step<R: Recorder + ?Sized>(
        &self,
        state: &mut (CameraPath, S),
        numbers: &mut SampleNumbers,
        recorder: &mut R,
    ) -> ControlFlow<Spectrum> {
        let (path, space) = state;
        let hit = path.hit(&*self.scene);
        if let Some(point) = space.scatter(&*self.scene, path, hit.as_ref(), numbers, recorder) {
            return self.scatter(&point, state, numbers, recorder);
        }
        let Some(hit) = hit else {
            for (light, radiance) in self.scene.lights().background(path.ray.direction) {
                path.add_emission(radiance, recorder, || Origin::background(light, 1.0));
            }
            return path.end(End::Escaped, recorder);
        };
        let mut surface = path.surface(&*self.scene, &hit);
        let wo = -path.ray.direction;
        recorder.record(|| Event::vertex(path.depth, &path.ray, &hit, &surface, path.beta));
        path.add_emission(surface.emitted(wo), recorder, || Origin::emission(&surface, 1.0));
        space.arrive(&*self.scene, &hit, &surface);
        path.take_wavelength(&mut surface, numbers, recorder);
        self.scatter(&surface, state, numbers, recorder)
    }
}

impl<S: Space> Walk<S> {
    /// Goes on from a vertex in a sampled direction.
    #[inline(always)]
    fn scatter<I: Interaction, R: Recorder + ?Sized>(
        &self,
        at: &I,
        (path, space): &mut (CameraPath, S),
        numbers: &mut SampleNumbers,
        recorder: &mut R,
    ) -> ControlFlow<Spectrum> {
        if path.depth == self.max_depth {
            return path.end(End::DepthLimit, recorder);
        }
        let (choice, u) = numbers.get_3d(dimension::vertex(path.depth, Use::Bsdf));
        let sample = at.sample(-path.ray.direction, choice, u, TransportMode::Radiance);
        path.scatter(at, sample, self.roulette, numbers, recorder)?;
        space.leave(path.ray.direction);
        ControlFlow::Continue(())
    }
}

impl<S: WideSpace> WideWalk for Walk<S> {
    fn scene(&self) -> Option<WideWorld<'_>> {
        S::scene(&*self.scene)
    }

    #[inline(always)]
    fn step<L: Lanes>(
        &self,
        scene: WideWorld,
        depth: u32,
        paths: &mut PathLanes<'_, L>,
        numbers: &mut NumberLanes<L>,
        active: L::Mask,
    ) -> L::Mask {
        let mut hits = scene.intersect(&paths.rays, active);
        let in_medium = S::scatter_lanes(scene, paths, &mut hits, numbers, depth, active);
        let scattered = in_medium.as_ref().map_or(L::mask(0), |points| points.found);
        let found = L::mask(hits.found);
        let missed = active & !(found | scattered);
        if L::any(missed) {
            for &light in scene.background_lights() {
                paths.add(missed, scene.background(light, &paths.rays, missed));
            }
        }
        if !L::any(found | scattered) {
            return found;
        }
        let surface = paths.surfaces(scene, &hits);
        let wo = -paths.rays.direction;
        paths.add(found, surface.emitted(wo));
        if depth == self.max_depth {
            return L::mask(0);
        }
        paths.scatter(scene, &surface, in_medium.as_ref(), self.roulette, depth, numbers)
    }
}
