//! Adaptive sampling: where samples go, that the picture stays unbiased, and that the error gets smaller.

use std::path::Path;
use std::sync::Arc;

use glam::UVec2;
use proptest::prelude::*;
use pt::build::Source;
use pt::describe::{self, Files};
use pt::film::{Allocation, Crop, Film, FilmSpec, MomentFilm, Moments, PixelSums, Wave};
use pt::integrator::{Integrator, choose};
use pt::math::Spectrum;
use pt::measure::adaptive::{allocate, pilot_allocation};
use pt::measure::{Distance, Mean, critical_z};
use pt::reader::Node;
use pt::render::{Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;

const WIDTH: u32 = 12;
const HEIGHT: u32 = 9;
const PIXELS: usize = (WIDTH * HEIGHT) as usize;

/// A film of independent samples, `samples(i)` of pixel i.
fn film(samples: impl Fn(usize) -> Vec<f32>) -> MomentFilm {
    let sum = |i| samples(i).into_iter().map(|x| Moments::of(Spectrum::gray(x))).reduce(|a, b| a.join(&b)).expect("a sample");
    let pixels: Vec<Moments> = (0..PIXELS).map(sum).collect();
    let level = samples(0).len().ilog2();
    let mut film = MomentFilm::new(FilmSpec::new(WIDTH, HEIGHT));
    film.add(Wave { first: 0, level }, PixelSums::of_samples(&pixels));
    film
}

fn is_white(i: usize) -> bool {
    (i % WIDTH as usize + i / WIDTH as usize).is_multiple_of(2)
}

proptest! {
    /// The number of samples of a pixel, and of all pixels on squares of its colour, does not depend on the pixel's own samples.
    #[test]
    fn sample_counts_do_not_depend_on_own_samples(
        mut values in prop::collection::vec(prop::collection::vec(0.0f32..2.0, 4), PIXELS),
        other in prop::collection::vec(0.0f32..1e6, 4),
        changed in 0..PIXELS,
    ) {
        let before = allocate(&film(|i| values[i].clone()));
        values[changed] = other;
        let after = allocate(&film(|i| values[i].clone()));
        for i in (0..PIXELS).filter(|&i| is_white(i) == is_white(changed)) {
            prop_assert_eq!(before.level(i), after.level(i), "pixel {} after a change of {}", i, changed);
        }
    }

    /// The numbers of samples do not depend on the unit of light.
    #[test]
    fn sample_counts_do_not_depend_on_brightness(
        values in prop::collection::vec(prop::collection::vec(0.0f32..2.0, 4), PIXELS),
        power in -60i32..60,
    ) {
        let factor = 2.0f32.powi(power);
        let scaled = |i: usize| values[i].iter().map(|x| factor * x).collect();
        prop_assert_eq!(allocate(&film(|i| values[i].clone())), allocate(&film(scaled)));
    }
}

/// nᵢ ∝ sᵢ: pixels with eight times the noise per sample get eight times as many samples. The average is eight.
#[test]
fn noisy_pixels_get_more_samples() {
    // Samples are 1 ± noise, and s = noise/√1.01 on both sides. The ideal numbers of samples are 10.67 and 1.33, with a mean of 6. As
    // powers of two with that mean they are 16 and 2 or 8 and 1, chosen for each pixel.
    let left = |i: usize| i % (WIDTH as usize) < WIDTH as usize / 2;
    let allocation = allocate(&film(|i| {
        let noise = if left(i) { 0.5 } else { 0.0625 };
        [1.0 - noise, 1.0 + noise, 1.0 - noise, 1.0 + noise].to_vec()
    }));
    // The noise estimates of two pixels beside the border include pixels across it.
    let far = |i: &usize| (i % WIDTH as usize).abs_diff(WIDTH as usize / 2) > 2;
    let mean = |side: bool| {
        let counts: Vec<f64> = (0..PIXELS).filter(far).filter(|&i| left(i) == side).map(|i| allocation.samples(i, 1) as f64).collect();
        counts.iter().sum::<f64>() / counts.len() as f64
    };
    let ratio = mean(true) / mean(false);
    assert!((8.0 / 2f64.sqrt()..=8.0 * 2f64.sqrt()).contains(&ratio), "{} and {} samples per round", mean(true), mean(false));
    assert!((allocation.mean() / 8.0).log2().abs() < 0.5, "{} samples per round", allocation.mean());
}

/// If all pixels have the same noise, all get the same number of samples, and the picture equals one that is sampled uniformly.
#[test]
fn even_noise_is_sampled_evenly() {
    let allocation = allocate(&film(|_| vec![0.5, 1.5, 0.5, 1.5]));
    assert_eq!(allocation.range(), [8, 8]);
    assert_eq!(allocate(&film(|_| vec![0.0; 4])), Allocation::default());
}

struct Subject {
    scene: Arc<dyn Scene>,
    integrator: Box<dyn Integrator>,
    spec: FilmSpec,
}

impl Subject {
    fn load(name: &str, width: u32, height: u32) -> Subject {
        let file = format!("scenes/{name}.json");
        Subject::of(describe::load(Path::new(&file)).expect("a scene"), &file, width, height)
    }

    fn of(mut root: Node, file: &str, width: u32, height: u32) -> Subject {
        for (pointer, value) in [("/film/width", width), ("/film/height", height)] {
            root.set(pointer, &value.to_string()).expect("a key");
        }
        let source = Source { root: &root, file, files: &Files::within("scenes") };
        let built = pt::build::build(&describe::read(&root, file).expect("a description"), source).expect("a scene");
        let (_, integrator) = choose(&[pt::integrators::ALL], root.child("integrator"), Some("nee"), file).expect("nee");
        Subject { scene: Arc::new(built.world), integrator, spec: built.film }
    }

    fn settings(&self, kind: Kind, samples: u64, seed: u64) -> Settings {
        Settings::new(SamplerSpec { kind, seed, spp: samples, scramblings: 2 })
    }

    fn rendered(&self, spec: &FilmSpec, settings: &Settings) -> MomentFilm {
        let mut film = MomentFilm::new(spec.clone());
        render(self.scene.clone(), &*self.integrator, &mut film, settings, &Silent);
        film
    }

    /// Renders adaptively with the given number of samples per pixel on average.
    fn adapted(&self, settings: &Settings) -> MomentFilm {
        let (allocation, _) = pilot_allocation(&self.scene, &*self.integrator, &self.spec, settings, settings.samples, &Silent);
        let samples = (settings.samples as f64 / allocation.mean()).round() as u64;
        self.rendered(&FilmSpec { allocation, ..self.spec.clone() }, &Settings { samples, ..settings.clone() })
    }
}

/// After n rounds a pixel has, bit for bit, the value that it has after n·2^l samples in a picture that is sampled uniformly.
#[test]
fn adaptive_rounds_equal_uniform_sampling() {
    let subject = Subject::load("cornell-box", 20, 15);
    let crop = Crop { min: UVec2::new(3, 2), max: UVec2::new(13, 11) };
    let plain = FilmSpec { crop, ..subject.spec.clone() };
    let levels = (0..crop.pixel_count()).map(|i| (i * 7 % 5) as u8).collect();
    let dense = FilmSpec { allocation: Allocation::new(levels), ..plain.clone() };
    for kind in [Kind::Independent, Kind::Sobol] {
        for rounds in [4, 5, 7] {
            let settings = Settings { tile: 4, ..subject.settings(kind, rounds, 1) };
            let image = subject.rendered(&dense, &settings).image();
            for level in 0..5 {
                let samples = rounds << level;
                let expected = subject.rendered(&plain, &Settings { samples, ..settings.clone() }).image();
                // Standard errors are shared with neighbours, which have other numbers of samples here.
                let is_own = |name: &str| !name.starts_with("StdErr.");
                for (dense, plain) in image.channels.iter().zip(&expected.channels).filter(|(dense, _)| is_own(&dense.name)) {
                    let own = (0..dense.values.len()).filter(|&i| (i * 7 % 5) as u64 == level);
                    own.for_each(|i| assert_eq!(dense.values[i], plain.values[i], "{}, pixel {i}, {samples} samples", dense.name));
                }
            }
        }
    }
}

/// The mean of many adaptive pictures equals the reference, in each pixel and as a whole, even if the samples that decide the allocation
/// are samples of the picture.
#[test]
fn adapted_pictures_are_unbiased() {
    let subject = Subject::load("mirror-balls", 16, 12);
    let truth = subject.rendered(&subject.spec, &subject.settings(Kind::Independent, 4096, u64::MAX)).image();
    let errors = truth.channel("StdErr.R").expect("errors");
    let red = truth.channel("R").expect("red");
    const SEEDS: u64 = 64;
    let picture = |seed: u64| {
        let pilot = subject.rendered(&subject.spec, &subject.settings(Kind::Independent, 4, seed));
        let allocation = allocate(&pilot);
        let samples = (64.0 / allocation.mean()).round() as u64;
        let film = subject.rendered(&FilmSpec { allocation, ..subject.spec.clone() }, &subject.settings(Kind::Independent, samples, seed));
        film.image().channel("R").expect("red").to_vec()
    };
    let pictures: Vec<Vec<f32>> = (0..SEEDS).map(picture).collect();
    let z = |values: &dyn Fn(&[f32]) -> f64, expected: f64, variance: f64| {
        let mut sums = [0.0; 2];
        for picture in &pictures {
            let value = values(picture);
            sums = [sums[0] + value, sums[1] + value * value];
        }
        let mean = Mean::from_sums(sums[0], sums[1], SEEDS);
        (mean.value - expected) / (mean.variance + variance).sqrt()
    };
    let critical = critical_z(1e-4, red.len() + 1);
    for i in 0..red.len() {
        let z = z(&|picture| picture[i].into(), red[i].into(), f64::from(errors[i]).powi(2));
        assert!(z.abs() < critical, "pixel {i}: {z} standard errors, {critical} allowed");
    }
    let sum = |picture: &[f32]| picture.iter().map(|&x| f64::from(x)).sum::<f64>();
    let whole = z(&sum, sum(red), errors.iter().map(|&e| f64::from(e).powi(2)).sum());
    assert!(whole.abs() < critical, "whole picture: {whole} standard errors");
}

/// A lamp without any noise fills half of the picture, so that the other pixels get more samples.
const LAMP: &str = r#"{
  "pt": 1,
  "camera": { "look_at": { "from": [0, 0, 5], "to": [0, 0, 0] }, "fov": 40 },
  "shapes": [
    { "type": "quad", "size": [2.4, 4], "transform": [{ "translate": [-0.7, 0, 0] }], "emission": 1 },
    { "type": "quad", "size": [1.2, 4], "transform": [{ "rotate": { "axis": [0, 1, 0], "degrees": -50 } }, { "translate": [1.1, 0, 0] }] }
  ]
}"#;

/// If half of the picture has little noise, the other half gets twice as many samples and the relMSE is halved, except for two losses: a
/// sixteenth of the samples is used by the pilot, and less than a third is lost because of powers of two and of pixels at the border.
#[test]
fn adaptive_sampling_reduces_the_error() {
    let root = describe::root(LAMP.as_bytes(), "lamp").expect("a scene");
    let subject = Subject::of(root, "lamp", 32, 24);
    let reference = subject.rendered(&subject.spec, &subject.settings(Kind::Sobol, 4096, u64::MAX)).image();
    let relmse = |film: &MomentFilm| Distance::between(&film.image(), &reference).expect("a reference").relmse;
    let (mut plain, mut adapted) = (0.0, 0.0);
    for seed in 0..4 {
        let settings = subject.settings(Kind::Independent, 256, seed);
        plain += relmse(&subject.rendered(&subject.spec, &settings));
        adapted += relmse(&subject.adapted(&settings));
    }
    let cost = adapted * (1.0 + 1.0 / 16.0) / plain;
    assert!(cost < 0.5 * (1.0 + 1.0 / 16.0) * 4.0 / 3.0, "adapted costs {cost} of plain: relMSE {adapted:e}, {plain:e}");
}

/// A wall that a red and a blue lamp light from afar: the choice of the lamp makes all pixels equally noisy.
const EVEN: &str = r#"{
  "pt": 1,
  "camera": { "look_at": { "from": [0, 0, 5], "to": [0, 0, 0] }, "fov": 40 },
  "shapes": [
    { "type": "quad", "size": 20 },
    { "type": "sphere", "radius": 1, "center": [20, 0, 20], "emission": [300, 0, 0] },
    { "type": "sphere", "radius": 1, "center": [-20, 0, 20], "emission": [0, 0, 300] }
  ]
}"#;

/// Where all pixels are equally noisy, the pilot gives each the same number of samples. A noisy half of the picture is worth uneven ones.
#[test]
fn what_does_not_pay_is_sampled_evenly() {
    // Sobol' samples of the lamp leave hardly any noise to distribute.
    for (text, kind, pays) in [(LAMP, Kind::Independent, true), (EVEN, Kind::Independent, false), (EVEN, Kind::Sobol, false)] {
        let subject = Subject::of(describe::root(text.as_bytes(), "lamp").expect("a scene"), "lamp", 32, 24);
        let settings = subject.settings(kind, 256, 3);
        let (allocation, _) = pilot_allocation(&subject.scene, &*subject.integrator, &subject.spec, &settings, 256, &Silent);
        assert_eq!(allocation.is_even(), !pays, "{kind:?}: {text}");
    }
}
