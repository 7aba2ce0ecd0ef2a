//! Images of known noise, with and without planted faults.

use approx::assert_relative_eq;
use glam::UVec2;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use statrs::distribution::{DiscreteCDF, Poisson};

use super::pixel_group::GroupSum;
use super::*;
use crate::film::Channel;

const SIZE: usize = 128;
const SAMPLES: u64 = 128;
const ALPHA: f64 = 0.01;
const RUNS: u64 = 20;

/// Uniform numbers in [0, 1).
fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    move || (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// 128×128 pixels of mean `mean(x, y)` and σ = mean per sample, as a render with 128 samples would leave them.
fn noise(seed: u64, mean: impl Fn(usize, usize) -> f64) -> Image {
    let mut uniform = uniform(seed);
    let mut channels: Vec<Channel> = ["R", "G", "B"].map(|c| Channel { name: c.into(), values: vec![] }).into();
    channels.extend(["R", "G", "B"].map(|c| Channel { name: format!("StdErr.{c}"), values: vec![] }));
    for (x, y, c) in (0..SIZE).flat_map(|y| (0..SIZE).flat_map(move |x| (0..3).map(move |c| (x, y, c)))) {
        let error = mean(x, y) / (SAMPLES as f64).sqrt();
        let normal = (-2.0 * (1.0 - uniform()).ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
        channels[c].values.push((mean(x, y) + error * normal) as f32);
        channels[c + 3].values.push(error as f32);
    }
    let size = UVec2::splat(SIZE as u32);
    Image { full_size: size, origin: UVec2::ZERO, size, channels }
}

fn compare(a: &Image, b: &Image) -> Agreement {
    agreement(SampledImage { image: a, samples: SAMPLES }, SampledImage { image: b, samples: SAMPLES }, ALPHA).unwrap()
}

/// Number of the `RUNS` pairs that each test refuses, and that any of them does.
fn refusals(planted: impl Fn(usize, usize) -> f64) -> [usize; 5] {
    let mut count = [0; 5];
    for run in 0..RUNS {
        let found = compare(&noise(2 * run, |_, _| 1.0), &noise(2 * run + 1, &planted));
        let says_no = [found.pixel, found.block, found.global, found.spread].map(|v| !v.accepts());
        (0..4).for_each(|k| count[k] += usize::from(says_no[k]));
        count[4] += usize::from(!found.accepts());
    }
    count
}

/// 20 runs at 1 %: two or more false alarms have a probability of 1.7 %, and the seeds are fixed.
#[test]
fn equal_pictures_agree() {
    assert!(refusals(|_, _| 1.0)[4] <= 1);
}

/// Gives a pixel this value and standard error in all colours.
fn put(image: &mut Image, pixel: usize, value: f64, error: f64) {
    for channel in &mut image.channels {
        channel.values[pixel] = if channel.name.starts_with("StdErr") { error } else { value } as f32;
    }
}

/// Picture that 16 scramblings give of a light of mean `mean`, which `hits` of the samples of a pixel meet on average.
fn rare(seed: u64, hits: f64, mean: impl Fn(usize, usize) -> f64) -> Image {
    let mut uniform = uniform(seed);
    let mut image = noise(seed, |_, _| 1.0);
    let chance = hits / 16.0;
    for (pixel, x, y) in (0..SIZE * SIZE).map(|pixel| (pixel, pixel % SIZE, pixel / SIZE)) {
        let met = (0..16).filter(|_| uniform() < chance).count() as f64;
        let each = mean(x, y) / chance;
        let found = Mean::from_sums(met * each, met * each * each, 16);
        put(&mut image, pixel, found.value, found.standard_error());
    }
    image
}

/// Compares a picture of rare samples with one that is known to 9 %.
fn against_noise(rare: &Image, run: u64) -> Agreement {
    let sure = noise(run + 1000, |_, _| 1.0);
    agreement(SampledImage { image: rare, samples: 16 }, SampledImage { image: &sure, samples: SAMPLES }, ALPHA).unwrap()
}

/// Squares of 8×8 pixels with some fifteen samples that found light, or with three. These are too few for a normal distribution,
/// and some squares found next to nothing.
#[test]
fn light_that_is_rarely_found_is_no_difference() {
    for hits in [0.25, 0.05] {
        let found = |run| against_noise(&rare(run, hits, |_, _| 1.0), run);
        let alarms: Vec<_> = (0..RUNS).map(found).filter(|found| !found.accepts()).collect();
        assert!(alarms.len() <= 1, "{} alarms, {}", alarms.len(), alarms[0]);
    }
}

/// A quarter of the picture, in a corner, is half as bright again.
#[test]
fn light_that_is_rarely_found_can_be_wrong() {
    let corner = |x, y| if x < SIZE / 2 && y < SIZE / 2 { 1.5 } else { 1.0 };
    for run in 0..RUNS {
        let found = against_noise(&rare(run, 0.25, corner), run);
        assert!(!found.accepts(), "{found}");
    }
}

/// A pixel that sees the lamp with half of its 512 samples.
const EDGE: Mean = Mean { value: 8.0, variance: 8.0 * 8.0 / 512.0, samples: 512.0 };

/// The few pixels of the edge are known by hundreds of samples each.
#[test]
fn the_edge_of_a_lamp_is_a_block_of_its_own() {
    let wall = Mean { value: 0.5, variance: 0.0, samples: 512.0 };
    let sum = GroupSum::of((0..64).map(|i| if i < 3 { EDGE } else { wall }));
    // h = ((8 - 0.5)/8)² 512 = 450 samples in each of three pixels
    assert_relative_eq!(sum.samples(), 3.0 * 450.0, max_relative = 1e-12);
    assert_relative_eq!(sum.third, 3.0 * EDGE.variance.powf(1.5) / 450f64.sqrt(), max_relative = 1e-12);
}

/// One pixel holds all the noise. At the edge of a lamp many samples make it, and the noise is known. A single
/// sample that met the lamp says little about the noise, and a black picture says nothing.
#[test]
fn noise_of_a_few_samples_is_a_heavy_tail() {
    let flat = |value: f64| {
        let mut image = noise(1, |_, _| 0.5);
        (0..SIZE * SIZE).for_each(|pixel| put(&mut image, pixel, value, 0.0));
        image
    };
    let with_pixel = |value: f64, error: f64| {
        let mut image = flat(0.5);
        put(&mut image, SIZE * SIZE / 2, value, error);
        image
    };
    let heavy = |image: &Image| compare(image, &noise(1, |_, _| 0.5)).heavy;
    assert_eq!(heavy(&with_pixel(8.0, EDGE.standard_error())), [false; 2]);
    assert_eq!(heavy(&with_pixel(0.5 + 8.0, 8.0)), [true, false]);
    assert_eq!(heavy(&flat(0.5)), [false; 2]);
    assert_eq!(heavy(&flat(0.0)), [true, false]);
}

/// n equal samples where λ were expected, in a picture that is otherwise known: p is twice Poisson's probability, which is known exactly.
#[test]
fn few_samples_explain_what_poisson_allows() {
    for (found, expected) in [(2u64, 9.0), (3, 4.0), (5, 40.0), (1, 12.0)] {
        let size = 3.0;
        // One sample each in n pixels of 64, and the rest without light.
        let lit = Mean { value: size, variance: size * size, samples: 1e6 };
        let dark = Mean { value: 0.0, variance: 0.0, samples: 1e6 };
        let side = GroupSum::of((0..64).map(|i| if i < found { lit } else { dark }));
        let known = GroupSum::of([Mean { value: expected * size, variance: 0.0, samples: 1e6 }].into_iter());
        let exact = 2.0 * Poisson::new(expected).unwrap().cdf(found);
        let p = rare_samples::p([&side, &known]);
        assert!((p / exact.min(1.0) - 1.0).abs() < 1e-6, "{found} of {expected}: {p:e}, {exact:e}");
        assert_eq!(p, rare_samples::p([&known, &side]));
    }
}

/// Three samples hold the noise of a picture. One that is ten times as bright is another, whatever a few more such samples bring. One
/// that has the light of two more of them may be the same.
#[test]
fn a_heavy_tail_does_not_hide_a_brighter_lamp() {
    let light = (SIZE * SIZE) as f64;
    let dotted = |value: f64| {
        let mut image = noise(1, |_, _| value);
        (0..SIZE * SIZE).for_each(|pixel| put(&mut image, pixel, value, 0.0));
        (1..4).for_each(|dot| put(&mut image, 5000 * dot, 0.05 * light, 0.05 * light));
        image
    };
    let conclusion = |other: &Image| compare(&dotted(1.0), other).conclusion();
    assert_eq!(conclusion(&noise(2, |_, _| 10.0)), Conclusion::Different);
    assert_eq!(conclusion(&noise(2, |_, _| 1.25)), Conclusion::Inconclusive);
    assert_eq!(conclusion(&noise(2, |_, _| 1.0)), Conclusion::Inconclusive);
    assert_eq!(conclusion(&noise(2, |_, _| 0.0)), Conclusion::Inconclusive, "black says nothing");
    assert_eq!(conclusion(&dotted(1.0)), Conclusion::Inconclusive);
}

/// Two pictures of the same expectation, with λ bright dots each on average, of a fifth of the picture's light. Often one has none and the
/// other some. They are never the same for certain, and at a level of 1 % hardly ever different.
#[test]
fn samples_that_only_one_side_has_met_are_no_difference() {
    let light = (SIZE * SIZE) as f64;
    let dotted = |seed: u64, expected: f64| {
        let mut uniform = uniform(seed);
        let mut image = noise(1, |_, _| 1.0);
        (0..SIZE * SIZE).for_each(|pixel| put(&mut image, pixel, 1.0, 0.0));
        // Poisson: events of a unit rate before the time `expected`.
        let (mut time, mut dots) = (-(1.0 - uniform()).ln(), 0);
        while time < expected {
            put(&mut image, 997 * (dots + 1), 1.0 + 0.2 * light, 0.2 * light);
            (time, dots) = (time - (1.0 - uniform()).ln(), dots + 1);
        }
        image
    };
    for expected in [1.0, 2.0, 4.0] {
        let wrong = |run: &u64| {
            let pair = [2 * run, 2 * run + 1].map(|seed| dotted(1000 * expected as u64 + seed, expected));
            let found = compare(&pair[0], &pair[1]);
            found.heavy.contains(&true) && found.conclusion() == Conclusion::Different
        };
        let wrong = (0..60).filter(wrong).count();
        assert!(wrong <= 3, "{wrong} of 60 with {expected} dots");
    }
}

/// k hits where 60 were expected: no more significant than Poisson's distribution, which is known exactly here, but more
/// significant than its root.
#[test]
fn too_few_hits_are_as_improbable_as_poisson_has_it() {
    let expected = 60.0;
    let poisson = Poisson::new(expected).unwrap();
    for k in 20..45 {
        let hits = k as f64;
        let found = Mean { value: hits, variance: hits, samples: 1e6 };
        let known = Mean { value: expected, variance: 0.0, samples: 1e6 };
        let p = MeanTest { means: [found, known], third: [hits, 0.0] }.p();
        let exact = poisson.cdf(k);
        assert!(exact <= p && p <= 2.0 * exact.sqrt(), "{k}: {p:e}, {exact:e}");
    }
}

/// 1 % of bias hides in every pixel, but not in the sum: σ of the difference of the sums is 0.1 %.
#[test]
fn bias_of_one_per_cent_is_found_by_the_whole() {
    assert_eq!(refusals(|_, _| 1.01)[2], RUNS as usize);
}

/// Expected z of a block: 6 % · 8 · √128 / √2 = 3.8, and there are 768 of them.
#[test]
fn bias_of_six_per_cent_is_found_by_blocks_and_spread() {
    let [_, block, _, spread, _] = refusals(|_, _| 1.06);
    assert_eq!((block, spread), (RUNS as usize, RUNS as usize));
}

/// One pixel of three times the brightness: z = √128 · 2/√(1 + 9) = 7.2.
#[test]
fn one_wrong_pixel_is_found() {
    let [pixel, _, global, _, _] = refusals(|x, y| if (x, y) == (77, 33) { 3.0 } else { 1.0 });
    assert_eq!(pixel, RUNS as usize);
    assert!(global < RUNS as usize / 2);
}

/// Two pictures from one set of random numbers: their differences are smaller than the errors claim.
#[test]
fn shared_noise_is_found() {
    let a = noise(1, |_, _| 1.0);
    let found = compare(&a, &a);
    assert!(found.pixel.accepts() && found.block.accepts() && found.global.accepts());
    assert!(!found.spread.accepts());
}

/// Light without noise: the pictures are equal except for the last bits of f32.
#[test]
fn pictures_without_noise_agree_up_to_rounding() {
    let still = |by: f32| {
        let mut image = noise(1, |_, _| 1.0);
        image.channels.iter_mut().for_each(|c| c.values.fill(if c.name.starts_with("StdErr") { 0.0 } else { by }));
        image
    };
    assert!(compare(&still(1.0), &still(1.0 + f32::EPSILON)).accepts());
    assert!(!compare(&still(1.0), &still(1.001)).accepts());
}

#[test]
fn scaling_both_changes_no_verdict() {
    let scaled = |by: f64| compare(&noise(1, |_, _| by), &noise(2, |_, _| by));
    let (one, tiny) = (scaled(1.0), scaled(2f64.powi(-40)));
    assert!((one.pixel.p - tiny.pixel.p).abs() < 1e-9 && (one.spread.p - tiny.spread.p).abs() < 1e-9);
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let a = noise(1, |_, _| 1.0);
    let bare = Image { channels: a.channels[..3].to_vec(), ..a.clone() };
    let cut = Image { size: UVec2::new(64, 256), ..a.clone() };
    let render = |image, samples| SampledImage { image, samples };
    assert!(agreement(render(&a, 8), render(&bare, 8), 0.01).is_err());
    assert!(agreement(render(&a, 8), render(&cut, 8), 0.01).is_err());
    assert!(agreement(render(&a, 8), render(&a, 1), 0.01).is_err());
}
