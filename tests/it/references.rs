//! Pictures compared with `reference/*.exr`, each made by another integrator with at least 64 times the samples.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pt::bsdf::{Lobe, TransportMode};
use pt::build::Source;
use pt::describe::{self, Files};
use pt::film::{FilmSpec, Image, MomentFilm};
use pt::integrator::{CameraSample, Context, Estimator, Integrator, Vacuum, choose, sample_light};
use pt::math::{Density, Spectrum};
use pt::measure::{SampledImage, agreement};
use pt::render::{Settings, Silent, render};
use pt::sampler::dimension::{self, Use};
use pt::scene::Scene;
use serde_json::Value;

use crate::glass::faults::unturned;

/// Significance of the whole suite: 1 % of the seeds would give a false alarm. The seed is fixed.
const ALPHA: f64 = 0.01;

fn provenances() -> Vec<(PathBuf, Value)> {
    let mut all: Vec<PathBuf> = std::fs::read_dir("reference")
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|p| p.extension().is_some_and(|e| e == "json"))
        .collect();
    all.sort();
    all.into_iter().map(|path| (path.clone(), serde_json::from_slice(&std::fs::read(&path).expect("readable")).expect("JSON"))).collect()
}

fn number(value: &Value) -> u64 {
    value.as_u64().expect("a whole number")
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a string")
}

#[test]
fn pictures_agree_with_the_references_of_other_integrators() {
    let provenances = provenances();
    assert!(provenances.len() >= 5, "{}", provenances.len());
    let level = pt::measure::sidak(ALPHA, provenances.len());
    for (path, provenance) in provenances {
        let (judge, judged) = (text(&provenance["integrator"]), text(&provenance["judges"]["integrator"]));
        let (spp, reference_spp) = (number(&provenance["judges"]["spp"]), number(&provenance["spp"]));
        assert_ne!(judge, judged, "{}", path.display());
        assert!(reference_spp >= 64 * spp, "{}", path.display());
        let (reference, _) = pt::output::exr::read(&path.with_extension("exr")).expect("a picture");
        let image = picture(text(&provenance["scene"]), judged, spp, reference.size.to_array());
        let verdict =
            agreement(SampledImage { image: &image, samples: spp }, SampledImage { image: &reference, samples: reference_spp }, level)
                .expect("comparable");
        assert!(verdict.accepts(), "{judged} against {}:\n{verdict}", path.display());
    }
}

/// A picture of the glass panel with the magnification bug, a normal that is not turned when light leaves glass, differs from the
/// reference.
#[test]
fn the_reference_picture_detects_a_magnifying_panel() {
    let path = Path::new("reference/glass-panel.exr");
    let (reference, _) = pt::output::exr::read(path).expect("a picture");
    let provenance: Value = serde_json::from_slice(&std::fs::read(path.with_extension("json")).expect("readable")).expect("JSON");
    let (spp, reference_spp) = (number(&provenance["judges"]["spp"]), number(&provenance["spp"]));
    for (turned, accepted) in [(true, true), (false, false)] {
        let image = picture_by(&Panel { turned }, text(&provenance["scene"]), spp, reference.size.to_array());
        let verdict =
            agreement(SampledImage { image: &image, samples: spp }, SampledImage { image: &reference, samples: reference_spp }, ALPHA)
                .expect("comparable");
        assert_eq!(verdict.accepts(), accepted, "normal turned: {turned}\n{verdict}");
    }
}

/// A path tracer with light sampling only, which refracts correctly or with the magnification bug.
struct Panel {
    turned: bool,
}

struct Walk {
    scene: Arc<dyn Scene>,
    turned: bool,
}

impl Integrator for Panel {
    fn prepare(&self, scene: Arc<dyn Scene>, _: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Walk { scene, turned: self.turned })
    }
}

impl Estimator for Walk {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        let (mut ray, mut beta, mut radiance, mut sees_lights) = (camera.ray, Spectrum::ONE, Spectrum::BLACK, true);
        for depth in 0..24 {
            let Some(hit) = self.scene.intersect(&ray) else { break };
            let surface = self.scene.surface(&ray, &hit);
            let wo = -ray.direction;
            if sees_lights {
                radiance += beta * surface.emitted(wo);
            }
            radiance += beta
                * sample_light(&*self.scene, &Vacuum, &surface, wo, dimension::vertex(depth, Use::Light), 0.0, &mut cx.numbers)
                    .map_or(Spectrum::BLACK, |(direct, _)| direct);
            let (choice, u) = cx.numbers.get_3d(dimension::vertex(depth, Use::Bsdf));
            let Some((wi, sample)) = surface.sample(wo, choice, u, TransportMode::Radiance) else { break };
            beta *= sample.weight;
            sees_lights = sample.density == Density::Delta;
            let leaving = sample.lobe == Lobe::Transmission && surface.point.ng.dot(wo) < 0.0;
            let bent = if leaving && !self.turned { unturned(ray.direction, surface.point.ng, 1.0 / sample.eta) } else { wi };
            ray = surface.spawn(bent, 0.0);
        }
        radiance
    }
}

fn picture(file: &str, integrator: &str, spp: u64, size: [u32; 2]) -> Image {
    let root = describe::load(Path::new(file)).expect(file);
    let (_, integrator) = choose(&[pt::integrators::ALL], root.child("integrator"), Some(integrator), file).expect(file);
    picture_by(&*integrator, file, spp, size)
}

fn picture_by(integrator: &dyn Integrator, file: &str, spp: u64, [width, height]: [u32; 2]) -> Image {
    let mut root = describe::load(Path::new(file)).expect(file);
    let settings = [("/film/width", width.into()), ("/film/height", height.into()), ("/sampler/spp", spp), ("/sampler/seed", 1)];
    for (pointer, value) in settings {
        root.set(pointer, &value.to_string()).expect(pointer);
    }
    root.set("/sampler/type", "independent").expect("a sampler");
    let scene = describe::read(&root, file).expect(file);
    let built = pt::build::build(&scene, Source { root: &root, file, files: &Files::within("scenes") }).expect(file);
    let mut film = MomentFilm::new(built.film);
    render(Arc::new(built.world), integrator, &mut film, &Settings::new(built.sampler), &Silent);
    film.image()
}
