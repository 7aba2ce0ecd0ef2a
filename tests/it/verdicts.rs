//! The test of `pt verify` on real renders: added biases are found, and unbiased pairs pass.
//!
//! `cargo test --release --test it verdicts -- --include-ignored` runs the full number of repetitions.

use std::path::Path;
use std::sync::Arc;

use pt::build::Source;
use pt::describe::{self, Files};
use pt::film::{FilmSpec, Image, MomentFilm};
use pt::integrator::{Integrator, choose};
use pt::measure::agreement::Conclusion;
use pt::measure::verify::{Side, verify};
use pt::measure::{Agreement, SampledImage, StopCondition, agreement, sidak};
use pt::render::{Settings, Silent, render};
use pt::sampler::SamplerSpec;
use pt::scene::Scene;
use statrs::distribution::{Binomial, DiscreteCDF};

/// Settings of `pt verify`: sixteen scramblings, and a significance of 1 %.
const SCRAMBLINGS: u32 = 16;
const ALPHA: f64 = 0.01;

struct Subject {
    built: Arc<dyn Scene>,
    spec: FilmSpec,
    sampler: SamplerSpec,
    root: pt::reader::Node,
}

impl Subject {
    fn cornell(edge: u32) -> Subject {
        Subject::of("scenes/cornell-box.json", edge)
    }

    /// A scene of a file as a square picture.
    fn of(file: &str, edge: u32) -> Subject {
        let mut root = describe::load(Path::new(file)).expect("a scene");
        for pointer in ["/film/width", "/film/height"] {
            root.set(pointer, &edge.to_string()).expect("a key");
        }
        let source = Source { root: &root, file, files: &Files::within("scenes") };
        let built = pt::build::build(&describe::read(&root, file).expect("a description"), source).expect("a scene");
        Subject { built: Arc::new(built.world), spec: built.film, sampler: built.sampler, root }
    }

    fn integrator(&self, name: &str) -> Box<dyn Integrator> {
        choose(&[pt::integrators::ALL], self.root.child("integrator"), Some(name), "").expect("known").1
    }

    fn side(&self, integrator: &str, spp: u64, seed: u64) -> Image {
        let integrator = self.integrator(integrator);
        let settings = Settings::new(SamplerSpec { spp, seed, scramblings: SCRAMBLINGS, ..self.sampler });
        let mut film = MomentFilm::new(self.spec.clone());
        render(self.built.clone(), &*integrator, &mut film, &settings, &Silent);
        film.image()
    }
}

fn verdict(a: &Image, b: &Image) -> Agreement {
    let side = |image| SampledImage { image, samples: SCRAMBLINGS.into() };
    agreement(side(a), side(b), ALPHA).expect("two sides")
}

/// The picture and its error estimates, multiplied by a factor that depends on the pixel.
fn planted(image: &Image, factor: impl Fn(u32, u32) -> f32) -> Image {
    let mut image = image.clone();
    let width = image.size.x;
    for channel in image.channels.iter_mut().filter(|channel| channel.name != "SampleCount.Y") {
        let values = channel.values.iter_mut().zip(0..);
        values.for_each(|(value, i): (&mut f32, u32)| *value *= factor(i % width, i / width));
    }
    image
}

/// Compares pairs with the same expected value as `pt verify` does, with light that is found often, and with light that is found so rarely
/// that a few samples hold all the noise. No more of them are called different than α and chance allow; the scenes share a significance of
/// 1 %. Twenty pairs, of which two may be called different, find gross errors only.
///
/// Where no sample at all has met a light, as those of `path` in the caustic, nothing tells that it is missing.
fn healthy(seeds: u64) {
    const SUBJECTS: [(&str, [(&str, u64); 2]); 3] = [
        ("scenes/cornell-box.json", [("nee", 64), ("path", 256)]),
        ("scenes/caustic.json", [("nee", 64), ("nee", 256)]),
        ("scenes/mis-plates.json", [("nee", 64), ("path", 64)]),
    ];
    for (file, sides) in SUBJECTS {
        let subject = Subject::of(file, 24);
        let mut alarms = 0;
        for seed in 0..seeds {
            let mut number = 0;
            let [a, b] = sides.map(|(name, samples)| {
                let sampler = SamplerSpec { seed: 1000 * seed, ..subject.sampler };
                let until = StopCondition { samples, time: None, target: None, patience: None };
                number += 1;
                let side =
                    Side::render(&subject.built, &subject.spec, (name, &*subject.integrator(name)), (sampler, number), &until, &Silent);
                side.side.expect("samples")
            });
            alarms += u64::from(verify(&a, &b, ALPHA).expect("two sides").agreement.conclusion() == Conclusion::Different);
        }
        let allowed = Binomial::new(ALPHA, seeds).expect("a distribution").inverse_cdf(1.0 - sidak(0.01, SUBJECTS.len()));
        assert!(alarms <= allowed, "{file}: {alarms} of {seeds} healthy pairs are called different, {allowed} allowed");
    }
}

#[test]
fn healthy_pairs_pass() {
    healthy(20);
}

#[test]
#[ignore = "the full number: minutes in release"]
fn two_hundred_healthy_pairs_pass() {
    healthy(200);
}

/// Few of 64 paths hit the lamp, and none in a dark corner. Light that has not been found yet does not count as a difference.
#[test]
fn paths_that_rarely_meet_the_lamp_agree() {
    let subject = Subject::cornell(256);
    let verdict = verdict(&subject.side("nee", 64, 1), &subject.side("path", 64, 2));
    assert!(verdict.heavy == [false; 2] && verdict.accepts(), "{verdict}");
}

/// Only the few pixels at the edge of the lamp have noise with `whitted`. The others are exact, so that missing light is a difference and
/// not noise.
#[test]
fn missing_light_is_a_difference() {
    let subject = Subject::cornell(128);
    let verdict = verdict(&subject.side("nee", 64, 1), &subject.side("whitted", 64, 2));
    assert!(verdict.heavy == [false; 2] && !verdict.accepts(), "{verdict}");
}

/// Asserts that each of these biases of all pixels is found, and also 20 % more light in one pixel of a hundred, a spot in a corner of the
/// picture.
fn found(edge: u32, spp: u64, biases: &[f32]) {
    let subject = Subject::cornell(edge);
    let (a, b) = (subject.side("nee", spp, 1), subject.side("nee", spp, 2));
    assert!(verdict(&a, &b).accepts(), "nothing planted: {}", verdict(&a, &b));
    for bias in biases {
        let found = verdict(&a, &planted(&b, |_, _| 1.0 + bias));
        assert!(!found.accepts(), "{bias} everywhere: {found}");
    }
    let (corner, spot) = (edge * 5 / 8, edge / 10);
    let inside = move |x: u32| (corner..corner + spot).contains(&x);
    let found = verdict(&a, &planted(&b, |x, y| if inside(x) && inside(y) { 1.2 } else { 1.0 }));
    assert!(!found.accepts(), "a spot: {found}");
}

#[test]
fn planted_biases_are_found() {
    found(48, 512, &[0.01, 0.03, -0.01]);
}

#[test]
#[ignore = "3 per mille take 40 million samples: a minute in release"]
fn small_planted_biases_are_found() {
    found(96, 2048, &[0.003, 0.01, 0.03, -0.003]);
}
