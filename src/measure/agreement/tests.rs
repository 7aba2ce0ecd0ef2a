//! Images of known noise, with and without planted faults.

use glam::UVec2;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::*;
use crate::film::Channel;

const SIZE: usize = 128;
const SAMPLES: u64 = 128;
const ALPHA: f64 = 0.01;
const RUNS: u64 = 20;

/// 128×128 pixels of mean `mean(x, y)` and σ = mean per sample, as a render with 128 samples would leave them.
fn noise(seed: u64, mean: impl Fn(usize, usize) -> f64) -> Image {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut uniform = move || -> f64 { (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64 };
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
    agreement(Render { image: a, samples: SAMPLES }, Render { image: b, samples: SAMPLES }, ALPHA).unwrap()
}

/// In how many of `RUNS` pairs each test, and any, says no.
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

/// The same random numbers twice: differences are smaller than the errors claim.
#[test]
fn shared_noise_is_found() {
    let a = noise(1, |_, _| 1.0);
    let found = compare(&a, &a);
    assert!(found.pixel.accepts() && found.block.accepts() && found.global.accepts());
    assert!(!found.spread.accepts());
}

/// Light that needs no chance: equal but for the last bits of f32.
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
    let render = |image, samples| Render { image, samples };
    assert!(agreement(render(&a, 8), render(&bare, 8), 0.01).is_err());
    assert!(agreement(render(&a, 8), render(&cut, 8), 0.01).is_err());
    assert!(agreement(render(&a, 8), render(&a, 1), 0.01).is_err());
}
