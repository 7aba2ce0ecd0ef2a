//! Recorded paths of integrators: the light adds up to the radiance, and the numbers of a path are consistent.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::integrator::choose;
use pt::integrators::ALL;
use pt::math::{Density, Spectrum, Vec3};
use pt::recorder::{Contribution, End, Event, LightSplit, MediumVertex, PathRecorder, Scattering, Technique, Vertex};
use pt::render::{Render, SampleId, Settings};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;

use crate::random::Random;

/// Every scene that comes with pt, with 32 × 24 pixels.
fn scenes() -> Vec<(PathBuf, Built)> {
    let entries = std::fs::read_dir("scenes").expect("the folder of scenes").map(|entry| entry.expect("an entry").path());
    let mut paths: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "json")).collect();
    paths.sort();
    assert!(paths.len() >= 9, "{paths:?}");
    paths.into_iter().map(|path| (path.clone(), load(&path, [32, 24]))).collect()
}

pub fn load(path: &Path, [width, height]: [u32; 2]) -> Built {
    let file = path.display().to_string();
    let mut root = describe::load(path).expect(&file);
    for (side, length) in [("/film/width", width), ("/film/height", height)] {
        root.set(side, &length.to_string()).expect(side);
    }
    let scene = describe::read(&root, &file).unwrap_or_else(|e| panic!("{e}"));
    let source = Source { root: &root, file: &file, files: &Files::within("scenes") };
    pt::build::build(&scene, source).unwrap_or_else(|e| panic!("{e}"))
}

/// Applies `law` to the recorded events of a few hundred samples of every integrator on every scene.
fn for_recorded(samples: usize, mut law: impl FnMut(&str, &dyn Scene, &Render, SampleId, &[Event])) {
    for (path, built) in scenes() {
        let world: Arc<dyn Scene> = Arc::new(built.world);
        for entry in ALL {
            let (_, integrator) = choose(&[ALL], None, Some(entry.name), "").expect("defaults are valid");
            let mut random = Random::new(7);
            let sampler = SamplerSpec { kind: random.pick(&[Kind::Independent, Kind::Sobol]), seed: 3, spp: 16, scramblings: 2 };
            let render = Render::new(world.clone(), &*integrator, &built.film, &Settings::new(sampler));
            for _ in 0..samples {
                let id = SampleId { pixel: (random.below(32) as u32, random.below(24) as u32), index: random.below(16) as u64 };
                let mut events: Vec<Event> = vec![];
                render.replay(id, Some(&mut events));
                law(&format!("{} {} {id:?}", path.display(), entry.name), &*world, &render, id, &events);
            }
        }
    }
}

fn contributions(events: &[Event]) -> impl Iterator<Item = &Contribution> {
    events.iter().filter_map(|event| if let Event::Light(contribution) = event { Some(contribution) } else { None })
}

/// Recording does not change the radiance of a sample, and the recorded light is all of it, bit for bit.
#[test]
fn recorded_light_adds_up_to_the_radiance() {
    let (mut bright, mut silent) = (0, 0);
    for_recorded(150, |name, _, render, id, events| {
        let (alone, mut again) = (render.replay(id, None), Vec::<Event>::new());
        let watched = render.replay(id, Some(&mut again));
        assert_eq!(watched.to_rgb().map(f32::to_bits), alone.to_rgb().map(f32::to_bits), "{name}");
        if events.is_empty() {
            assert!(name.contains(" normals ") || name.contains(" ao "), "{name} tells nothing");
            silent += 1;
            return;
        }
        let sum = contributions(events).fold(Spectrum::BLACK, |sum, c| sum + c.value) * render.camera(id).weight;
        assert_eq!(sum.to_rgb().map(f32::to_bits), alone.to_rgb().map(f32::to_bits), "{name}");
        bright += u32::from(!sum.is_black());
    });
    assert!(bright > 1000 && silent > 1000, "{bright} bright, {silent} silent");
}

/// Consecutive vertices of paths that do not branch are consistent.
///
/// - throughput: β' = β · weight / survival, times the factors of a wavelength that is taken at the vertex, to the bit
/// - weight = f·cos/density, for models with a density. Both sides are f32 numbers of four operations each, and lobes much narrower
///   than a radian lose digits in both.
/// - the next vertex lies at the recorded distance in the recorded direction
#[test]
fn throughputs_follow_from_the_vertices() {
    let (mut smooth, mut vertices, mut dispersed) = (0, 0, 0);
    for_recorded(100, |name, scene, _, _, events| {
        // Paths in media have a law of their own, `paths_in_media_are_recorded`.
        if scene.media().is_some() || ![" path ", " nee ", " light "].iter().any(|method| name.contains(method)) {
            return;
        }
        let mut last: Option<(&Vertex, Option<&Scattering>)> = None;
        // Factors of the wavelength that the path takes at a vertex.
        let mut colors = Spectrum::ONE;
        for event in events {
            match event {
                Event::Vertex(vertex) => {
                    if let Some((before, Some(scattering))) = last {
                        let beta = before.beta * colors * scattering.weight * (1.0 / scattering.survival);
                        assert_eq!(vertex.beta, beta, "{name} {vertex:?}");
                        colors = Spectrum::ONE;
                        assert_eq!(vertex.depth, before.depth + 1, "{name}");
                        let met = before.point + scattering.wi * vertex.distance;
                        let size = vertex.point.abs().max_element().max(before.point.abs().max_element());
                        // If marching stops 0.01 m before a surface, rays start slightly more than five times as far from it.
                        let off = if name.contains("postcard") { 0.06 } else { 0.0 };
                        assert!((met - vertex.point).length() < 1e-4 * size.max(vertex.distance) + off, "{name}: {met} {vertex:?}");
                        assert!((vertex.wo + scattering.wi).length() < 1e-6, "{name}");
                    } else {
                        assert_eq!((vertex.depth, vertex.beta), (0, Spectrum::ONE), "{name}");
                    }
                    vertices += 1;
                    last = Some((vertex, None));
                }
                Event::Scattering(scattering) => {
                    let (vertex, _) = last.take().expect("a vertex before");
                    assert_eq!(scattering.cos, vertex.ns.dot(scattering.wi), "{name}");
                    if let Density::Smooth(pdf) = scattering.density {
                        let weight = scattering.value / pdf.get();
                        let off = (weight - scattering.weight).map(f32::abs).max() / scattering.weight.max();
                        assert!(off < 2e-3, "{name}: {} · {scattering:?}: {weight:?}", vertex.model);
                        smooth += 1;
                    }
                    last = Some((vertex, Some(scattering)));
                }
                Event::Medium(_) => panic!("{name} has no medium"),
                // A path from a light starts after the camera's ray.
                Event::Emission(_) => (last, colors) = (None, Spectrum::ONE),
                Event::Wavelength { factors, .. } => {
                    colors = *factors;
                    dispersed += 1;
                }
                Event::Light(_) | Event::Splat(_) | Event::End { .. } => {}
            }
        }
        if name.contains(" light ") {
            return;
        }
        let ends = events.iter().filter(|event| matches!(event, Event::End { .. })).count();
        assert!(ends == 1 && matches!(events.last(), Some(Event::End { .. })), "{name}: {ends} ends");
    });
    assert!(smooth > 2000 && vertices > 3000 && dispersed > 0, "{smooth} smooth of {vertices}, {dispersed} with a wavelength");
}

/// Depths count scattering events, light indices are valid, weights are from 0 to 1, and a path that ends at the depth limit has reached it.
#[test]
fn contributions_have_valid_depths_lights_and_weights() {
    for_recorded(60, |name, scene, _, _, events| {
        let mut depth = 0;
        for event in events {
            match event {
                Event::Vertex(Vertex { depth: at, .. }) | Event::Medium(MediumVertex { depth: at, .. }) => depth = *at,
                Event::Light(c) => {
                    let is_known = |light: u32| (light as usize) < scene.lights().len();
                    assert!(c.origin.light.map_or(scene.media().is_some(), is_known), "{name}: {c:?}");
                    assert!((0.0..=1.0).contains(&c.origin.weight) && c.value == c.whole, "{name}: {c:?}");
                    match c.origin.technique {
                        // Light that a medium scatters on the way to the next vertex.
                        Technique::Light { .. } if scene.media().is_some() => assert!(c.depth <= depth + 2, "{name}"),
                        Technique::Light { .. } => assert_eq!(c.depth, depth + 1, "{name}"),
                        Technique::Emission => assert!(c.depth == depth || c.depth == depth + 1 || name.contains(" whitted "), "{name}"),
                    }
                }
                Event::End { depth, why: End::DepthLimit } => assert_eq!(*depth, 64, "{name}"),
                Event::Emission(emitted) => assert!((emitted.light as usize) < scene.lights().len(), "{name}: {emitted:?}"),
                Event::Splat(splat) => {
                    assert!((splat.light as usize) < scene.lights().len() && splat.depth == depth + 1, "{name}: {splat:?}");
                }
                Event::Scattering(_) | Event::End { .. } => {}
                Event::Wavelength { depth, wavelength, factors } => {
                    assert!(*depth < 64 && *factors == wavelength.factors(), "{name}");
                }
            }
        }
    });
}

/// Where both techniques of nee can find an emitter, their weights are strictly between 0 and 1. Emission seen by the camera directly has
/// the weight 1.
#[test]
fn mis_weights_are_strictly_between_0_and_1() {
    let (mut shared, mut whole) = (0, 0);
    for_recorded(100, |name, _, _, _, events| {
        for c in contributions(events).filter(|_| name.contains(" nee ")) {
            if c.depth == 0 {
                assert_eq!(c.origin.weight, 1.0, "{name}");
                whole += 1;
            }
            shared += u32::from(c.origin.weight > 0.0 && c.origin.weight < 1.0);
        }
    });
    assert!(shared > 100 && whole > 10, "{shared} {whole}");
}

/// The clamp limits each contribution of indirect light and nothing else, keeps hues, and keeps the unclamped sum to the bit.
#[test]
fn clamping_limits_only_indirect_light() {
    const LIMIT: f32 = 0.05;
    let mut held = 0;
    for_recorded(60, |name, _, render, id, events| {
        let mut inner: Vec<Event> = vec![];
        let mut clamp = pt::recorder::Clamp::new(LIMIT, Some(&mut inner));
        render.replay(id, Some(&mut clamp));
        let (acted, unclamped) = (clamp.acted(), clamp.unclamped() * render.camera(id).weight);
        if !events.is_empty() {
            assert_eq!(unclamped, render.replay(id, None), "{name}");
        }
        for (c, before) in contributions(&inner).zip(contributions(events)) {
            assert_eq!((c.whole, c.depth), (before.value, before.depth), "{name}");
            if c.depth < 2 || c.whole.max() <= LIMIT {
                assert_eq!(c.value, c.whole, "{name}");
            } else {
                assert!((c.value.max() - LIMIT).abs() < 1e-6 * LIMIT, "{name}: {c:?}");
                let ratio = c.whole * (c.value.max() / c.whole.max());
                assert!((ratio - c.value).map(f32::abs).max() < 1e-6 * LIMIT, "{name}: {c:?}");
                held += 1;
                assert!(acted);
            }
        }
    });
    assert!(held > 100, "{held}");
}

/// Emission, direct and indirect light add up to all light, and so do the lights, up to one rounding per term.
#[test]
fn split_light_adds_up_to_all_light() {
    let (mut indirect, mut several) = (0, 0);
    for_recorded(100, |name, scene, render, id, events| {
        let group_of: std::sync::Arc<[u32]> = (0..=scene.lights().len() as u32).collect();
        let mut split = LightSplit::new(group_of);
        render.replay(id, Some(&mut split));
        if events.is_empty() {
            return;
        }
        let whole = contributions(events).fold(Spectrum::BLACK, |sum, c| sum + c.value);
        let parts = contributions(events).count() as f32;
        for sum in [split.emission + split.direct + split.indirect, split.groups.iter().copied().sum()] {
            let off = (sum - whole).map(f32::abs).max();
            assert!(off <= parts * f32::EPSILON * whole.max(), "{name}: {sum:?} {whole:?}");
        }
        let depths = |least: u32, most: u32| {
            contributions(events).filter(|c| (least..=most).contains(&c.depth)).fold(Spectrum::BLACK, |sum, c| sum + c.value)
        };
        assert_eq!([split.emission, split.direct, split.indirect], [depths(0, 0), depths(1, 1), depths(2, u32::MAX)], "{name}");
        indirect += u32::from(!split.indirect.is_black());
        several += u32::from(split.groups.iter().filter(|light| !light.is_black()).count() > 1);
        split.clear();
        assert!(split.emission.is_black() && split.groups.iter().all(|light| light.is_black()));
    });
    assert!(indirect > 100 && several > 10, "{indirect} {several}");
}

/// Events are plain data.
#[test]
fn recorders_can_be_of_any_type() {
    #[derive(Default)]
    struct Farthest(f32);
    impl PathRecorder for Farthest {
        fn record(&mut self, event: Event) {
            if let Event::Vertex(vertex) = event {
                self.0 = self.0.max(vertex.point.distance(Vec3::ZERO));
            }
        }
    }
    let built = load(Path::new("scenes/cornell-box.json"), [32, 24]);
    let (_, integrator) = choose(&[ALL], None, Some("nee"), "").expect("defaults are valid");
    let render = Render::new(Arc::new(built.world), &*integrator, &built.film, &Settings::new(SamplerSpec::default()));
    let mut farthest = Farthest::default();
    render.replay(SampleId { pixel: (16, 12), index: 0 }, Some(&mut farthest));
    assert!(farthest.0 > 0.5 && farthest.0 < 5.0, "{}", farthest.0);
}
