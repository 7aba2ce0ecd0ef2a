//! Renders that are cancelled: how soon they stop, and which samples are kept.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use pt::build::Source;
use pt::camera::Camera;
use pt::describe::{self, Files};
use pt::effects::Effects;
use pt::film::{Film, FilmSpec, MomentFilm, memory};
use pt::integrators::ALL;
use pt::light::Lights;
use pt::math::{Ray, RayDifferential, SurfaceDifferential};
use pt::medium::{Boundaries, Inside, InterfaceCrossing, Media};
use pt::primitive::Hit;
use pt::render::{Observer, Render, Settings, Silent};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::{Scene, Surface};
use pt::shape::SurfacePoint;

use crate::random::cases;
use pt::torture::everything::{Everything, bits};

/// A scene that cancels the render after a number of rays.
struct Tripwire {
    scene: Arc<dyn Scene>,
    rays: AtomicU64,
    at: u64,
}

impl Scene for Tripwire {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.rays.fetch_add(1, Ordering::Relaxed);
        self.scene.intersect(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.scene.occluded(ray)
    }

    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        self.scene.surface(ray, hit)
    }

    fn surface_with_footprint(&self, ray: &Ray, hit: &Hit, differential: &RayDifferential) -> (Surface<'_>, Option<SurfaceDifferential>) {
        self.scene.surface_with_footprint(ray, hit, differential)
    }

    fn surface_seen_from(&self, ray: &Ray, hit: &Hit, wo: Vec3) -> Surface<'_> {
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
        self.scene.effects()
    }

    fn origin(&self) -> DVec3 {
        self.scene.origin()
    }
}

impl Observer for Tripwire {
    fn cancelled(&self) -> bool {
        self.rays.load(Ordering::Relaxed) >= self.at
    }
}

fn built(text: &str) -> Arc<dyn Scene> {
    let root = describe::root(text.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").expect("a scene");
    let files = Files::within("");
    Arc::new(pt::build::build(&described, Source { root: &root, file: "s.json", files: &files }).expect("a world").world)
}

/// Scenes in which one sample takes very many rays: inside of a ball that is a perfect mirror, and in front of 24 shells of glass. Each has
/// the integrators to test.
fn slow_scenes() -> [(Arc<dyn Scene>, &'static [&'static str]); 2] {
    let mirror = r#"{"pt": 1, "camera": {"look_at": {"from": [0, 0, 0.3], "to": [0.2, 0.1, -1]}},
        "shapes": [{"type": "sphere", "material": {"type": "mirror", "color": 1}}]}"#;
    let shell = |i: u32| {
        let radius = 1.0 - f64::from(i) / 100.0;
        format!(r#"{{"type": "sphere", "radius": {radius}, "material": {{"type": "dielectric", "eta": 1.5}}}}"#)
    };
    let shells = (0..24).map(shell).collect::<Vec<_>>().join(",");
    let shells = format!(
        r#"{{"pt": 1, "camera": {{"look_at": {{"from": [0, 0, 4], "to": [0, 0, 0]}}, "fov": 10}}, "background": {{"radiance": 1}}, "shapes": [{shells}]}}"#
    );
    [(built(mirror), &["path", "nee", "card"]), (built(&shells), &["whitted"])]
}

/// A cancelled sample ends within 256 vertices, which the test counts by rays and not by seconds. Its incomplete value is not in the
/// picture.
#[test]
fn a_long_sample_is_abandoned_soon_after_a_cancel() {
    const RAYS: u64 = 1500;
    for (scene, names) in slow_scenes() {
        for name in names {
            let options = format!(r#"{{"type": "{name}", "max_depth": 60000}}"#);
            let options = if *name == "whitted" { options.replace('}', r#", "branch_depth": 12}"#) } else { options };
            let options = pt::reader::parse(options.as_bytes()).expect("JSON");
            let (_, integrator) = pt::integrator::choose(&[ALL], Some(&options), None, "").expect("an integrator");
            let scene = Arc::new(Tripwire { scene: scene.clone(), rays: 0.into(), at: RAYS });
            let spec = FilmSpec::new(1, 1);
            let mut film = MomentFilm::new(spec.clone());
            let sampler = SamplerSpec { kind: Kind::Independent, seed: 1, spp: 1, ..SamplerSpec::default() };
            let mut render = Render::new(scene.clone(), &*integrator, &spec, &Settings::new(sampler));
            render.advance(1, &mut film, &*scene);
            let rays = scene.rays.load(Ordering::Relaxed);
            assert!(rays >= RAYS, "{name}: a sample of {rays} rays is not long");
            assert!(rays <= RAYS + 256, "{name}: {} rays after the end", rays - RAYS);
            assert!(render.report().cancelled && film.samples() == 0, "{name}: the sample was counted");
        }
    }
}

/// Notes the waves of a render, and cancels it after so many camera samples of a wave that is not finished.
#[derive(Default)]
struct Waves {
    ends: std::sync::Mutex<Vec<u64>>,
    looks: AtomicU64,
    patience: u64,
}

impl Observer for Waves {
    fn wave_done(&self, samples: u64, _: &dyn Film) {
        self.ends.lock().expect("no panic").push(samples);
    }

    fn cancelled(&self) -> bool {
        self.patience > 0 && self.looks.fetch_add(1, Ordering::Relaxed) >= self.patience
    }
}

fn settings(kind: Kind, wave_time: Option<Duration>) -> Settings {
    let sampler = SamplerSpec { kind, seed: 5, spp: 4096, scramblings: 2 };
    Settings { wave_time, ..Settings::new(sampler) }
}

proptest! {
    #![proptest_config(cases(24))]

    /// If waves take long, each is at most an eighth of the finished samples (or a single sample), so that an interrupt loses at most one
    /// such wave. The picture equals, bit for bit, that of as many samples, and the waves need no more memory than was reserved.
    #[test]
    fn an_interrupt_loses_an_eighth_at_most(patience in 1u64..9000, kind in 0usize..4) {
        let (scene, kind): (Arc<dyn Scene>, Kind) = (Everything::default().build(), Kind::ALL[kind].0);
        let spec = FilmSpec::new(3, 2);
        let nee = || pt::integrator::choose(&[ALL], None, Some("nee"), "").expect("it is in the table").1;
        let waves = Waves { patience, ..Waves::default() };
        let mut film = MomentFilm::new(spec.clone());
        let mut render = Render::new(scene.clone(), &*nee(), &spec, &settings(kind, Some(Duration::ZERO)));
        while render.step(1500, None, &mut film, &waves) {
            let layout = spec.layout(settings(kind, None).sampler.error_estimator());
            let held = (8 * layout.all() * film.blocks().len()) as u128;
            prop_assert!(held + 16 * layout.all() as u128 <= memory::needed(1, layout, film.samples()), "{} samples", film.samples());
        }
        let ends = waves.ends.into_inner().expect("no panic");
        for (done, end) in std::iter::once(&0).chain(&ends).zip(&ends) {
            prop_assert!(end - done <= (done / 8).max(1), "a wave from {done} to {end}");
        }
        let done = film.samples();
        prop_assert_eq!(ends.last().copied().unwrap_or(0), done);
        // The render checks for a cancel before each sample and after each tile: at least six times for each sample.
        prop_assert!(done + (done / 8).max(1) + 1 >= (patience / 7).min(1500), "{} samples of {}", done, patience / 7);
        let mut whole = MomentFilm::new(spec.clone());
        Render::new(scene, &*nee(), &spec, &settings(kind, None)).advance(done, &mut whole, &Silent);
        prop_assert_eq!(bits(&film.image()), bits(&whole.image()));
    }
}
