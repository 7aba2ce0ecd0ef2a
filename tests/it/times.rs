//! Time within the shutter interval: all rays of a path have that of its first ray, and nothing draws one while nothing moves.
//!
//! The scenes here only claim to move. That times which are drawn change no bit of a scene without motion is tested by
//! `simulating_effects_that_do_not_occur_changes_no_bit`.

use std::sync::{Arc, Mutex};

use glam::{DVec3, Vec3};
use pt::build::Built;
use pt::camera::Camera;
use pt::effects::Effects;
use pt::film::{Crop, FilmSpec, MomentFilm};
use pt::integrator::{CameraSample, Context, Estimator, Integrator};
use pt::integrators::ALL;
use pt::light::Lights;
use pt::math::{Ray, RayDifferential, Spectrum, SurfaceDifferential};
use pt::medium::{Boundaries, Inside, InterfaceCrossing, Media};
use pt::primitive::Hit;
use pt::render::{Render, SampleId, Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::{Scene, Surface};
use pt::shape::SurfacePoint;

use crate::light_tracer::built;

/// A scene that claims to move or not, and writes the times of all rays down.
struct Watched {
    scene: Arc<dyn Scene>,
    moves: bool,
    times: Mutex<Vec<f32>>,
}

impl Watched {
    fn note(&self, ray: &Ray) {
        self.times.lock().expect("one thread").push(ray.time);
    }
}

impl Scene for Watched {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.note(ray);
        self.scene.intersect(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.note(ray);
        self.scene.occluded(ray)
    }

    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        self.note(ray);
        self.scene.surface(ray, hit)
    }

    fn surface_with_footprint(&self, ray: &Ray, hit: &Hit, differential: &RayDifferential) -> (Surface<'_>, Option<SurfaceDifferential>) {
        self.note(ray);
        self.scene.surface_with_footprint(ray, hit, differential)
    }

    fn surface_seen_from(&self, ray: &Ray, hit: &Hit, wo: Vec3) -> Surface<'_> {
        self.note(ray);
        self.scene.surface_seen_from(ray, hit, wo)
    }

    fn lights(&self) -> &Lights {
        self.scene.lights()
    }

    fn camera(&self) -> &Camera {
        self.scene.camera()
    }

    fn media(&self) -> Option<&Media> {
        self.scene.media()
    }

    fn boundaries(&self, hit: &Hit, point: &SurfacePoint) -> Boundaries {
        self.scene.boundaries(hit, point)
    }

    fn bodies_around(&self, p: Vec3) -> Inside {
        self.scene.bodies_around(p)
    }

    fn interface(&self, ray: &Ray) -> Option<InterfaceCrossing> {
        self.scene.interface(ray)
    }

    fn effects(&self) -> Effects {
        let still = self.scene.effects().without(Effects::MOTION);
        if self.moves { still | Effects::MOTION } else { still }
    }

    fn origin(&self) -> DVec3 {
        self.scene.origin()
    }
}

/// A room with a lamp, a mirror, glass and a lens.
const ROOM: &str = r#"{ "pt": 1, "camera": { "look_at": { "from": [0, 1, 3.5], "to": [0, 0.8, 0] }, "fov": 50, "lens_radius": 0.02, "focus_distance": 3 },
    "film": { "width": 8, "height": 6 },
    "shapes": [
        { "type": "box", "size": [4, 4, 8], "transform": [{ "scale": -1 }] },
        { "type": "sphere", "radius": 0.5, "center": [-0.6, 0.5, 0], "material": { "type": "mirror" } },
        { "type": "sphere", "radius": 0.5, "center": [0.6, 0.5, 0], "material": { "type": "dielectric" } },
        { "type": "quad", "size": 1, "emission": 5, "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 1.9, 0] }] }] }"#;

fn watched(moves: bool) -> (Arc<Watched>, FilmSpec) {
    let Built { world, film, .. } = built(ROOM);
    (Arc::new(Watched { scene: Arc::new(world), moves, times: Mutex::default() }), film)
}

/// Every integrator: the rays of one path share one time, that of the camera's ray or of the light's; all are 0 where nothing moves.
#[test]
fn rays_of_a_path_share_their_time() {
    for (entry, moves) in ALL.iter().flat_map(|entry| [true, false].map(|moves| (entry, moves))) {
        let (scene, film) = watched(moves);
        let integrator = crate::identity::new(entry);
        let sampler = SamplerSpec { kind: Kind::Sobol, ..SamplerSpec::default() };
        let render = Render::new(scene.clone(), &*integrator, &film, &Settings::new(sampler));
        let mut most = 0;
        for index in 0..48u64 {
            scene.times.lock().expect("one thread").clear();
            render.replay(SampleId { pixel: (index as u32 % 8, index as u32 / 8), index }, None);
            let times = scene.times.lock().expect("one thread").clone();
            let mut distinct = times.clone();
            distinct.dedup();
            // A light tracer also shoots the camera's own ray.
            assert!(distinct.len() <= 1 + usize::from(integrator.splats()), "{}: {times:?}", entry.name);
            assert!(times.iter().all(|&time| if moves { time > 0.0 && time < 1.0 } else { time == 0.0 }), "{}: {times:?}", entry.name);
            most = most.max(times.len());
        }
        assert!(most >= 2, "{} shot rays", entry.name);
    }
}

/// An integrator that shows the time of the camera's rays.
struct Clock;

impl Integrator for Clock {
    fn prepare(&self, _: Arc<dyn Scene>, _: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Clock)
    }
}

impl Estimator for Clock {
    fn li(&self, camera: &CameraSample, _: &mut Context) -> Spectrum {
        Spectrum::gray(camera.ray.time)
    }
}

/// Times are stratified in every pixel: the mean of n of them differs from ½ by less than half a stratum. Halton's numbers in the dimension of
/// time have the base 11, so that their strata are full after 11² samples.
#[test]
fn times_are_stratified() {
    for (kind, spp) in [(Kind::Sobol, 64), (Kind::Stratified, 64), (Kind::Halton, 121)] {
        let (scene, spec) = watched(true);
        let spec = FilmSpec { crop: Crop { min: glam::UVec2::ZERO, max: spec.size }, ..spec };
        let mut film = MomentFilm::new(spec);
        let sampler = SamplerSpec { kind, spp, scramblings: 1, ..SamplerSpec::default() };
        render(scene, &Clock, &mut film, &Settings::new(sampler), &Silent);
        for value in &film.image().channels[0].values {
            assert!((value - 0.5).abs() <= 0.5 / spp as f32, "{kind:?}: mean time {value}");
        }
    }
}
