//! The scenes, meshes and examples that come with pt work unchanged, with every integrator.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pt::bsdf::TransportMode;
use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::effects::Effects;
use pt::film::{Image, MomentFilm};
use pt::integrator::{Entry, Integrator, choose};
use pt::integrators::ALL;
use pt::render::{RenderReport, Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;

use crate::random::Random;

#[path = "../../examples/make_meshes/main.rs"]
mod make_meshes;

/// A scene of pt, built, to be rendered by one integrator after the other.
struct Demo {
    built: Built,
    root: pt::reader::Node,
    file: String,
}

impl Demo {
    /// Loads a scene with 16 × 16 pixels.
    fn load(path: &Path) -> Demo {
        let file = path.display().to_string();
        let mut root = describe::load(path).expect(&file);
        for side in ["/film/width", "/film/height"] {
            root.set(side, "16").expect(side);
        }
        let scene = describe::read(&root, &file).unwrap_or_else(|e| panic!("{e}"));
        let source = Source { root: &root, file: &file, files: &Files::within("scenes") };
        let built = pt::build::build(&scene, source).unwrap_or_else(|e| panic!("{e}"));
        Demo { built, root, file }
    }

    fn integrator(&self, name: Option<&str>) -> (Entry, Box<dyn Integrator>) {
        choose(&[ALL], self.root.child("integrator"), name, &self.file).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Renders with the scene's own options, as far as the integrator has them.
    fn render(self, names: &[&str], sampler: SamplerSpec, mut judge: impl FnMut(&str, Image, RenderReport)) {
        let integrators: Vec<_> = names.iter().map(|name| (*name, self.integrator(Some(name)).1)).collect();
        let world: Arc<dyn Scene> = Arc::new(self.built.world);
        for (name, integrator) in integrators {
            let mut film = MomentFilm::new(self.built.film.clone());
            let report = render(world.clone(), &*integrator, &mut film, &Settings::new(sampler), &Silent);
            judge(name, film.image(), report);
        }
    }
}

fn scenes() -> Vec<PathBuf> {
    let entries = std::fs::read_dir("scenes").expect("the folder of scenes");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "json"));
    paths.sort();
    assert!(paths.len() >= 9, "{paths:?}");
    paths
}

#[test]
fn scenes_render_without_warning_and_without_invalid_samples_by_every_integrator() {
    let names: Vec<&str> = ALL.iter().map(|entry| entry.name).collect();
    for path in scenes() {
        let demo = Demo::load(&path);
        assert_eq!(demo.built.warnings, Vec::<String>::new(), "{}", path.display());
        let effects = demo.built.world.effects();
        let (own, _) = demo.integrator(None);
        assert!((effects - own.simulates).is_empty(), "{}: its own integrator lacks {}", path.display(), effects - own.simulates);
        let sampler = SamplerSpec { spp: 2, ..demo.built.sampler };
        demo.render(&names, sampler, |name, image, report| {
            assert_eq!(report.invalid, 0, "{} by {name}: {:?}", path.display(), report.first_invalid);
            // In a closed room every direction hits a wall, so ambient occlusion is 0 there. No path starts at a lamp that only chance hits.
            let is_black = image.pixels().flatten().sum::<f32>() == 0.0;
            let may_be = name == "ao" || name == "light" && effects.contains(Effects::UNSAMPLED_EMITTER);
            assert!(!is_black || may_be, "{} by {name} is black", path.display());
        });
    }
}

/// Every path ends in the background, of radiance 1, and every vertex multiplies by 1, so every sample is 1. The tolerance is 2⁻¹⁴: some
/// hundred vertices, each with a few roundings of 2⁻²⁴.
#[test]
fn furnace_is_one_in_every_pixel_by_path() {
    let demo = Demo::load(Path::new("scenes/furnace.json"));
    let sampler = SamplerSpec { spp: 2, ..demo.built.sampler };
    demo.render(&["path"], sampler, |_, image, _| {
        let farthest = image.pixels().flatten().map(|v| (v - 1.0).abs()).fold(0.0, f32::max);
        assert!(farthest <= 2f32.powi(-14), "{farthest:e}");
    });
}

/// At every vertex two estimates are combined with weights, so that only the mean of the samples is 1. Each pixel is within 5 standard
/// errors (one of 256 pixels exceeds that with a probability of 10⁻⁴) and 2⁻¹⁴ for rounding, and so is their mean.
#[test]
fn furnace_is_one_in_every_pixel_by_nee_within_its_error() {
    let demo = Demo::load(Path::new("scenes/furnace.json"));
    let sampler = SamplerSpec { kind: Kind::Independent, spp: 256, ..demo.built.sampler };
    demo.render(&["nee"], sampler, |_, image, _| {
        let errors = image.channel("StdErr.R").expect("independent samples have errors");
        let is_one = |value: f32, error: f32| assert!((value - 1.0).abs() <= 5.0 * error + 2f32.powi(-14), "{value} ± {error}");
        image.pixels().zip(errors).for_each(|([value, ..], &error)| is_one(value, error));
        let pixels = errors.len() as f32;
        let mean = image.pixels().map(|[value, ..]| value).sum::<f32>() / pixels;
        is_one(mean, errors.iter().map(|e| e * e).sum::<f32>().sqrt() / pixels);
    });
}

#[test]
fn meshes_are_what_their_generator_makes() {
    for (name, bytes) in make_meshes::files().expect("memory") {
        let kept = std::fs::read(Path::new("scenes/meshes").join(name)).expect(name);
        assert!(kept == bytes, "{name}: run `cargo run --release --example make_meshes`, and look at the scenes");
    }
}

#[test]
fn an_outside_integrator_has_the_whole_command_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let picture = folder.path().join("depth.pfm");
    let plug_in = || assert_cmd::Command::new(example("plug_in"));

    let list = plug_in().args(["list", "integrators"]).assert().success();
    let text = String::from_utf8_lossy(&list.get_output().stdout).into_owned();
    assert!(text.contains("depth") && text.contains("nee"), "{text}");

    // The distance of the background is infinite, that of the ball is not.
    let render = ["scenes/furnace.json", "-i", "depth", "--size", "8x8", "--spp", "1", "-o"];
    plug_in().args(render).arg(&picture).assert().success();
    let bytes = std::fs::read(&picture).expect("a picture");
    assert!(bytes.starts_with(b"PF\n8 8\n"), "{}", String::from_utf8_lossy(&bytes[..16]));

    // The options are typed: a distance of −1 m is refused, with its position in the input.
    let wrong = ["scenes/furnace.json", "-i", "depth", "-D", "/integrator={\"type\":\"depth\",\"half_distance\":-1}"];
    let refused = plug_in().args(wrong).assert().code(2);
    let text = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(text.contains("/integrator/half_distance"), "{text}");
}

/// Path of an example's binary. `cargo test` builds all examples, but `cargo test --test it` builds none, so it is built here if needed.
fn example(name: &str) -> PathBuf {
    let file = format!("examples/{name}{}", std::env::consts::EXE_SUFFIX);
    let path = Path::new(env!("CARGO_BIN_EXE_pt")).with_file_name(file);
    if !path.exists() {
        let built = std::process::Command::new(env!("CARGO")).args(["build", "--profile", "test", "--example", name]).status();
        assert!(built.is_ok_and(|status| status.success()), "the example {name} cannot be built");
    }
    path
}

/// A surface that does not transmit light scatters none to its other side: no light is sampled there. Every surface of the demo scenes.
#[test]
fn opaque_surfaces_scatter_nothing_across() {
    let mut random = Random::new(7);
    let (mut opaque, mut clear) = (0, 0);
    for path in scenes() {
        let world = Demo::load(&path).built.world;
        for _ in 0..400 {
            let ray = world.camera().ray(random.uniform_square(), 1.0, random.uniform_square(), 0.0);
            let Some(hit) = world.intersect(&ray) else { continue };
            let surface = world.surface(&ray, &hit);
            if surface.transmits {
                clear += 1;
                continue;
            }
            opaque += 1;
            let (wo, wi) = (-ray.direction, random.direction().as_vec3());
            let ns = surface.light_context(wo, 0.0).ns;
            let across = if wi.dot(ns) > 0.0 { -wi } else { wi };
            assert!(surface.eval(wo, across, TransportMode::Radiance).is_black(), "{}: {:?}", path.display(), surface.bsdf);
        }
    }
    assert!(opaque > 3000 && clear > 100, "{opaque} opaque and {clear} clear surfaces");
}
