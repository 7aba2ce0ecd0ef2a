//! Random numbers, samplers, and choices in proportion to weights.

use glam::{UVec2, Vec2};

use super::{Failures, Row};
use crate::math::discrete::Discrete;
use crate::math::float::{ONE_MINUS_EPSILON, unit_f32};
use crate::sampler::dimension::{self, Use};
use crate::sampler::{Kind, SamplerSpec, Sequence};

/// The rows.
pub fn rows() -> Vec<Row> {
    vec![uniform(), replay(), intervals(), correlation(), choices()]
}

fn uniform() -> Row {
    Row::new("R1", "uniform numbers from random bits are below 1, and each a multiple of 2^-24", "exact")
        .peers("bits/2^32 in f32 is 1.0 for 128 inputs: AMReX, volo, arrayfire")
        // All results, whatever the effort: 2²⁴ of them, with both ends of the 2⁸ inputs of each.
        .never("all 2^24 results", 1, |_| {
            let mut failures = Failures::default();
            for k in 0..1u32 << 24 {
                let (low, high) = (unit_f32(k << 8), unit_f32(k << 8 | 0xff));
                let exact = f64::from(k) / f64::from(1 << 24);
                let holds = f64::from(low) == exact && low == high && low < 1.0;
                failures.record((!holds).then(|| format!("{k}: {low:?}")));
            }
            failures
        })
        .number("greatest number", 1.0 - 2f64.powi(-24), 0.0, || unit_f32(u32::MAX).into())
}

fn build(kind: Kind, seed: u64, spp: u64) -> Sequence {
    SamplerSpec { kind, seed, spp, ..SamplerSpec::default() }.build()
}

/// Dimensions that renders use: those of the camera, of the first vertices, and of a few late ones.
fn dimensions() -> Vec<u32> {
    let vertices =
        [0, 1, 2, 3, 7, 30, 100, 200].into_iter().flat_map(|depth| [Use::Bsdf, Use::Light].map(|use_| dimension::vertex(depth, use_)));
    [dimension::FILM, dimension::LENS].into_iter().chain(vertices).collect()
}

/// A sample asked for again, in any order and with other samples between, has the same numbers in [0, 1).
fn replay() -> Row {
    let row = Row::new("R2", "samples asked for again have the same bits, in [0, 1)", "exact");
    Kind::ALL.iter().fold(row, |row, &(kind, ..)| {
        row.never(format!("{kind:?}"), 1_000_000, move |tries| {
            let dimensions = dimensions();
            Failures::count(tries, |random| {
                let (seed, pixel) = (random.bits(), UVec2::new(random.below(4096) as u32, random.below(4096) as u32));
                let (index, spp) = (random.below(1 << 20) as u64, random.pick(&[1, 16, 100, 1 << 20]));
                let dimension = random.pick(&dimensions);
                let ask = |index: u64| build(kind, seed, spp).sample(pixel, index).get_2d(dimension);
                let first = ask(index);
                ask(index ^ 1);
                let holds = ask(index) == first && first.min_element() >= 0.0 && first.max_element() < 1.0;
                (!holds).then(|| format!("seed {seed}, pixel {pixel}, sample {index}, dimension {dimension}: {first:?}"))
            })
        })
    })
}

/// Every block of 2ᵏ Sobol points has one point in each of 2ᵏ boxes of equal size, whatever their shape.
fn intervals() -> Row {
    Row::new("R2a", "Sobol points in boxes of equal size: one in each", "exact").never("blocks of 2 to 1024 points", 10_000, |tries| {
        let dimensions = dimensions();
        Failures::count(tries, |random| {
            let (seed, k, dimension) = (random.bits(), 1 + random.below(10) as u32, random.pick(&dimensions));
            let sequence = build(Kind::Sobol, seed, 1 << 20);
            let first = (random.below(1 << 9) as u64) << k;
            let points: Vec<Vec2> = (first..first + (1 << k)).map(|i| sequence.sample(UVec2::new(17, 4), i).get_2d(dimension)).collect();
            let is_even = |a: u32| {
                let (columns, rows) = (1u32 << a, 1u32 << (k - a));
                let mut taken = vec![false; 1 << k];
                points.iter().all(|u| {
                    let cell = (u.y * rows as f32) as u32 * columns + (u.x * columns as f32) as u32;
                    !std::mem::replace(&mut taken[cell as usize], true)
                })
            };
            (!(0..=k).all(is_even)).then(|| format!("seed {seed}, dimension {dimension}, 2^{k} points from {first}"))
        })
    })
}

/// |r| < 5/√N: one in 1.7 million independent pairs exceeds it.
fn correlation() -> Row {
    const SAMPLES: u64 = 1024;
    let row = Row::new(
        "R2b",
        "greatest correlation of two dimensions, times the root of the samples: at most 5",
        "one false alarm in 1.7 million pairs",
    );
    Kind::ALL.iter().fold(row, |row, &(kind, ..)| {
        row.number(format!("{kind:?}, {SAMPLES} samples, half of 5"), 2.5, 2.5, move || {
            let sequence = build(kind, 3, SAMPLES);
            let numbers = |d: u32| (0..SAMPLES).map(|i| f64::from(sequence.sample(UVec2::new(17, 4), i).get_1d(d))).collect::<Vec<_>>();
            let columns: Vec<Vec<f64>> = dimensions().into_iter().map(numbers).collect();
            let mut worst: f64 = 0.0;
            for (i, a) in columns.iter().enumerate() {
                worst = columns[i + 1..].iter().map(|b| correlated(a, b).abs()).fold(worst, f64::max);
            }
            worst * (SAMPLES as f64).sqrt()
        })
    })
}

fn correlated(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let product = |x: &[f64], mx: f64, y: &[f64], my: f64| x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>();
    product(a, ma, b, mb) / (product(a, ma, a, ma) * product(b, mb, b, mb)).sqrt()
}

fn choices() -> Row {
    Row::new("R3", "choices in proportion to weights: never one of weight 0", "exact; probabilities add up to 1 within 1e-6").never(
        "weights 1e-6 to 1e6, half of them 0, numbers 0 to 1 - 2^-24",
        1_000_000,
        |tries| {
            Failures::count(tries, |random| {
                let n = 1 + random.below(20);
                let mut weights: Vec<f32> =
                    (0..n).map(|_| if random.below(2) == 0 { 0.0 } else { random.magnitude(1e-6, 1e6) as f32 }).collect();
                weights[random.below(n)] = 1.0;
                let any = unit_f32(random.bits() as u32);
                let choice = random.pick(&[0.0, 2f32.powi(-24), 0.5, ONE_MINUS_EPSILON, any]);
                let Some(discrete) = Discrete::new(&weights) else { return Some(format!("{weights:?}")) };
                let (i, pmf, rest) = discrete.sample(choice);
                let sum: f64 = (0..n).map(|i| f64::from(discrete.pmf(i))).sum();
                let holds = weights[i] > 0.0 && pmf == discrete.pmf(i) && (0.0..1.0).contains(&rest) && (sum - 1.0).abs() < 1e-6;
                (!holds).then(|| format!("{weights:?}, number {choice:?}: {i}"))
            })
        },
    )
}
