//! The spectrum of errors: flat for independent pixels, that of the filter for filtered ones, and nothing for an offset.

use std::f64::consts::PI;

use glam::UVec2;
use pt::compare::{Ring, error_spectrum};
use pt::film::{Channel, Image};

use crate::random::Random;

/// Size of the pictures. Its sides differ and are no powers of two, so that the transform is tested in its general case.
const SIZE: UVec2 = UVec2::new(60, 42);
const RENDERS: u64 = 8;

fn picture(value: impl Fn(usize, u32, u32) -> f64) -> Image {
    let values = |c: usize| (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| (x, y))).map(|(x, y)| value(c, x, y) as f32).collect();
    let channels = ["R", "G", "B"].into_iter().enumerate().map(|(c, name)| Channel { name: name.into(), values: values(c) }).collect();
    Image { full_size: SIZE, origin: UVec2::ZERO, size: SIZE, channels }
}

/// Independent noise of each colour, uniform in −√3 … √3, so that its variance is 1.
fn noise(seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    (0..3 * SIZE.element_product()).map(|_| 3f64.sqrt() * (2.0 * random.unit() - 1.0)).collect()
}

fn at(noise: &[f64], c: usize, x: u32, y: u32) -> f64 {
    noise[c * SIZE.element_product() as usize + (y % SIZE.y * SIZE.x + x % SIZE.x) as usize]
}

/// The reference: brightness 2 with a gradient.
fn truth(c: usize, x: u32, y: u32) -> f64 {
    2.0 + 0.1 * f64::from(x) / f64::from(SIZE.x) + f64::from(y) * 0.01 * c as f64
}

fn brightness() -> f64 {
    let picture = picture(truth);
    picture.pixels().flatten().map(f64::from).sum::<f64>() / f64::from(3 * SIZE.element_product())
}

/// Asserts that each ring is near an expected power: the mean over n frequencies, three colours and the renders has the relative
/// deviation √(2/3nR), since those of f and −f are the same. 4.5 of them are exceeded in 1 of 10⁵ cases.
fn assert_near(rings: &[Ring], expected: impl Fn(&Ring) -> f64) {
    assert!(rings.len() > 6, "{rings:?}");
    for ring in rings {
        let (wanted, deviation) = (expected(ring), (2.0 / (3.0 * ring.frequencies as f64 * RENDERS as f64)).sqrt());
        assert!((ring.power / wanted - 1.0).abs() < 4.5 * deviation, "{ring:?}, not {wanted} ± {}", wanted * deviation);
    }
}

/// Independent errors are as strong at every period, however unevenly they are distributed over the picture: the mean of their variances.
/// The noise of the reference is subtracted.
#[test]
fn independent_errors_have_a_flat_spectrum() {
    let weight = |x: u32| if x < SIZE.x / 3 { 0.3 } else { 0.1 };
    let render = |seed: u64| {
        let noise = noise(seed);
        picture(move |c, x, y| truth(c, x, y) + weight(x) * at(&noise, c, x, y))
    };
    let renders: Vec<Image> = (0..RENDERS).map(render).collect();
    let variance = (0.3 * 0.3 + 2.0 * 0.1 * 0.1) / 3.0;
    let expected = variance / brightness().powi(2);
    assert_near(&error_spectrum(&renders, &picture(truth)), |_| expected);
    let mut uncertain = picture(truth);
    let error = vec![0.05; SIZE.element_product() as usize];
    uncertain.channels.extend(["R", "G", "B"].map(|name| Channel { name: format!("StdErr.{name}"), values: error.clone() }));
    let less = expected - 0.05f64.powi(2) / brightness().powi(2);
    let rings = error_spectrum(&renders, &uncertain);
    rings.iter().zip(error_spectrum(&renders, &picture(truth))).for_each(|(less, all)| assert!((all.power - less.power) > 0.0));
    let mean = rings.iter().map(|ring| ring.power * ring.frequencies as f64).sum::<f64>()
        / rings.iter().map(|ring| ring.frequencies as f64).sum::<f64>();
    assert!((mean / less - 1.0).abs() < 0.05, "{mean}, not {less}");
}

/// Noise that a box of 4 × 4 pixels has averaged has the spectrum of the box: (sin πkf / k sin πf)² of either direction.
#[test]
fn filtered_errors_have_the_spectrum_of_their_filter() {
    const K: u32 = 4;
    let render = |seed: u64| {
        let noise = noise(seed);
        let mean = move |c: usize, x: u32, y: u32| (0..K * K).map(|i| at(&noise, c, x + i % K, y + i / K)).sum::<f64>() / f64::from(K * K);
        picture(move |c, x, y| truth(c, x, y) + 0.1 * mean(c, x, y))
    };
    let renders: Vec<Image> = (0..RENDERS).map(render).collect();
    let rings = error_spectrum(&renders, &picture(truth));
    let transfer = |f: f64| if f == 0.0 { 1.0 } else { ((PI * f64::from(K) * f).sin() / (f64::from(K) * (PI * f).sin())).powi(2) };
    // The frequencies of a ring, counted apart from those of the program.
    let expected = |ring: &Ring| {
        let ends = [ring.period / 2f64.powf(0.25), ring.period * 2f64.powf(0.25)];
        let [mut sum, mut count] = [0.0, 0.0];
        for (u, v) in (0..SIZE.x).flat_map(|u| (0..SIZE.y).map(move |v| (u, v))).skip(1) {
            let [fx, fy] = [(u, SIZE.x), (v, SIZE.y)].map(|(k, n)| f64::from(k.min(n - k)) / f64::from(n));
            let period = fx.hypot(fy).recip();
            if period >= ends[0] * (1.0 - 1e-9) && period < ends[1] * (1.0 - 1e-9) {
                sum += transfer(fx) * transfer(fy);
                count += 1.0;
            }
        }
        assert_eq!(count as usize, ring.frequencies);
        sum / count * 0.01 / brightness().powi(2)
    };
    // Within a ring the powers differ, so that fewer of them count; twice the deviation allows for it.
    for ring in &rings {
        let (wanted, deviation) = (expected(ring), (4.0 / (3.0 * ring.frequencies as f64 * RENDERS as f64)).sqrt());
        assert!((ring.power / wanted - 1.0).abs() < 4.5 * deviation, "{ring:?}, not {wanted} ± {}", wanted * deviation);
    }
    assert!(rings[rings.len() - 1].power > 20.0 * rings[0].power, "long periods are the stronger ones");
}

/// An offset of the whole picture is in no ring, light of another unit changes nothing, and what cannot be told is left out.
#[test]
fn offsets_and_units_do_not_count() {
    let offset = [picture(|c, x, y| truth(c, x, y) + 0.5), picture(|c, x, y| truth(c, x, y) + 0.25)];
    let rings = error_spectrum(&offset, &picture(truth));
    // f32 rounds the values by 2⁻²⁴ of 4.
    assert!(rings.iter().all(|ring| ring.power.abs() < 1e-12), "{rings:?}");
    let of = |scale: f64| {
        let render = |seed: u64| {
            let noise = noise(seed);
            picture(move |c, x, y| scale * f64::from((truth(c, x, y) + 0.1 * at(&noise, c, x, y)) as f32))
        };
        error_spectrum(&[render(1), render(2)], &picture(move |c, x, y| scale * f64::from(truth(c, x, y) as f32)))
    };
    assert_eq!(of(1.0), of(1024.0));
    assert_eq!(error_spectrum(&[], &picture(truth)), []);
    assert_eq!(error_spectrum(&[picture(|_, x, _| if x == 3 { f64::NAN } else { 1.0 })], &picture(truth)), []);
    assert_eq!(error_spectrum(&offset, &picture(|_, _, _| 0.0)), []);
}
