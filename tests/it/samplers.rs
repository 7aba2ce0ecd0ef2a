//! Samplers: their numbers are pure functions of the place, evenly distributed and independent.

use glam::{UVec2, UVec3, Vec2, Vec3};
use proptest::prelude::*;
use pt::sampler::dimension::{self, Use};
use pt::sampler::{Halton, Kind, SampleKey, Sampler, SamplerSpec, Sequence};

use crate::random::cases;
use crate::statistics::{sidak, uniformity};

const PIXEL: UVec2 = UVec2::new(17, 4);

fn kinds() -> impl Iterator<Item = Kind> {
    Kind::ALL.iter().map(|row| row.0)
}

fn build(kind: Kind, seed: u64, spp: u64) -> Sequence {
    SamplerSpec { kind, seed, spp, ..SamplerSpec::default() }.build()
}

fn number(sequence: &Sequence, pixel: UVec2, index: u64, dimension: u32) -> f32 {
    sequence.sample(pixel, index).get_1d(dimension)
}

fn point(sequence: &Sequence, pixel: UVec2, index: u64, dimension: u32) -> Vec2 {
    sequence.sample(pixel, index).get_2d(dimension)
}

fn triple(sequence: &Sequence, pixel: UVec2, index: u64, dimension: u32) -> (f32, Vec2) {
    sequence.sample(pixel, index).get_3d(dimension)
}

/// Sampler as another crate would write one.
struct Foreign(Halton);

impl Sampler for Foreign {
    fn key(&self, pixel: UVec2, index: u64) -> SampleKey {
        self.0.key(pixel, index)
    }

    fn get_1d(&self, key: SampleKey, dimension: u32) -> f32 {
        self.0.get_1d(key, dimension)
    }

    fn get_2d(&self, key: SampleKey, dimension: u32) -> Vec2 {
        self.0.get_2d(key, dimension)
    }
}

/// Dimensions that renders use: those of the camera, of the first vertices, and of a few late vertices.
fn used_dimensions() -> Vec<u32> {
    let vertices = [0, 1, 2, 3, 7, 30, 100, 200];
    let uses = [Use::Bsdf, Use::Light, Use::Roulette, Use::Medium];
    let of_vertices = vertices.iter().flat_map(|&depth| uses.map(|use_| dimension::vertex(depth, use_)));
    [dimension::FILM, dimension::LENS, dimension::TIME].into_iter().chain(of_vertices).collect()
}

/// Asserts that every cell of a grid holds the same number of points.
fn assert_even(points: &[Vec2], cells: (u32, u32), what: &str) {
    let mut counts = vec![0usize; (cells.0 * cells.1) as usize];
    for p in points {
        // Cells need not be dyadic, because the product of an f32 and a small integer is exact in f64.
        let (x, y) = ((f64::from(p.x) * f64::from(cells.0)) as u32, (f64::from(p.y) * f64::from(cells.1)) as u32);
        counts[(y * cells.0 + x) as usize] += 1;
    }
    let each = points.len() / counts.len();
    assert!(counts.iter().all(|&n| n == each), "{what}: {} × {} cells, {} points", cells.0, cells.1, points.len());
}

#[test]
fn names_are_unique_and_the_default_is_listed() {
    let names: std::collections::HashSet<_> = Kind::ALL.iter().map(|row| row.1).collect();
    assert_eq!(names.len(), Kind::ALL.len());
    assert_eq!(SamplerSpec::default().kind, Kind::Independent);
}

#[test]
fn blocks_of_dimensions_do_not_overlap() {
    let owned = |depth, use_, count| {
        let first = dimension::vertex(depth, use_);
        first..first + count
    };
    let mut all: Vec<u32> = (dimension::FILM..dimension::FILM + 2).collect();
    all.extend(dimension::LENS..dimension::LENS + 2);
    all.push(dimension::TIME);
    for depth in 0..100 {
        all.extend(owned(depth, Use::Bsdf, 3).chain(owned(depth, Use::Light, 3)));
        all.extend(owned(depth, Use::Roulette, 1).chain(owned(depth, Use::Medium, 1)));
    }
    let count = all.len();
    all.sort_unstable();
    all.dedup();
    assert_eq!(all.len(), count);
}

proptest! {
    #![proptest_config(cases(10_000))]

    /// A number does not depend on which numbers were asked for before, or on the instance.
    #[test]
    fn numbers_are_pure(
        seed: u64, x: u32, y: u32, index: u64, small_index in 0u64..5000, spp in 1u64..5000, dimensions in prop::collection::vec(0u32..3000, 1..8),
    ) {
        let pixel = UVec2::new(x, y);
        for kind in kinds() {
            for index in [index, small_index] {
                let (fresh, used) = (build(kind, seed, spp), build(kind, seed, spp));
                let mut numbers = used.sample(pixel, index);
                let forwards: Vec<_> = dimensions.iter().map(|&d| (numbers.get_1d(d), numbers.get_2d(d), numbers.get_3d(d))).collect();
                for (&d, &(one, two, three)) in dimensions.iter().zip(&forwards).rev() {
                    prop_assert_eq!(number(&fresh, pixel, index, d), one);
                    prop_assert_eq!(point(&fresh, pixel, index, d), two);
                    prop_assert_eq!(triple(&fresh, pixel, index, d), three);
                    for u in [one, two.x, two.y, three.0, three.1.x, three.1.y] {
                        prop_assert!((0.0..1.0).contains(&u), "{:?}: {}", kind, u);
                    }
                }
            }
        }
    }

    /// A sampler of another crate is asked for each number by the key that it made.
    #[test]
    fn a_sample_has_the_numbers_of_its_key(seed: u64, index: u64, d in 0u32..2000) {
        let (own, foreign) = (Halton { seed }, Sequence::Other(Box::new(Foreign(Halton { seed }))));
        let (key, mut numbers) = (own.key(PIXEL, index), foreign.sample(PIXEL, index));
        prop_assert_eq!(numbers.key(), key);
        prop_assert_eq!(numbers.get_1d(d), own.get_1d(key, d));
        prop_assert_eq!(numbers.get_2d(d), own.get_2d(key, d));
        prop_assert_eq!(numbers.get_3d(d), (own.get_1d(key, d), own.get_2d(key, d + 1)));
    }

    /// Numbers depend on seed, pixel, sample and dimension.
    #[test]
    fn every_coordinate_matters(seed: u64, x in 0u32..10_000, y in 0u32..10_000, index in 0u64..1 << 36, d in 0u32..2000) {
        for kind in kinds() {
            let at = |seed, x, y, index, d| {
                let sampler = build(kind, seed, 1000);
                // Three numbers are compared, because one alone is equal by chance in 1 of 2²⁴ cases.
                let mut numbers = sampler.sample(UVec2::new(x, y), index);
                (numbers.get_1d(d), numbers.get_1d(d + 1), numbers.get_1d(d + 2))
            };
            let here = at(seed, x, y, index, d);
            let others = [at(seed ^ 1, x, y, index, d), at(seed, x + 1, y, index, d), at(seed, x, y + 1, index, d),
                at(seed, y, x + 10_000, index, d), at(seed, x, y, index ^ 1, d), at(seed, x, y, index ^ (1 << 35), d), at(seed, x, y, index, d + 3)];
            for (i, other) in others.into_iter().enumerate() {
                prop_assert_ne!(here, other, "{:?}, change {}", kind, i);
            }
        }
    }
}

/// Calls a function for aligned blocks of 2ᵏ samples of the sampler `sobol`: with the sequence, the dimension, k and the first sample.
fn for_each_sobol_block(check: impl Fn(&Sequence, u32, u32, u64)) {
    for seed in 0..6 {
        let sampler = build(Kind::Sobol, seed, 1);
        for (d, k) in used_dimensions().into_iter().flat_map(|d| (0..=10u32).map(move |k| (d, k))) {
            let n = 1u64 << k;
            // The first 2ᵏ samples, a later aligned block of them, and one beyond 2³².
            [0, 5 * n, (7 << 32) + 3 * n].into_iter().for_each(|first| check(&sampler, d, k, first));
        }
    }
}

#[test]
fn sobol_points_fill_every_elementary_interval() {
    for_each_sobol_block(|sampler, d, k, first| {
        let samples = first..first + (1 << k);
        let points: Vec<_> = samples.clone().map(|i| point(sampler, PIXEL, i, d)).collect();
        for a in 0..=k {
            assert_even(&points, (1 << a, 1 << (k - a)), &format!("dimension {d}"));
        }
        let line: Vec<_> = samples.map(|i| Vec2::new(number(sampler, PIXEL, i, d), 0.0)).collect();
        assert_even(&line, (1 << k, 1), &format!("dimension {d}"));
    });
}

/// Numbers for a choice and a point fill boxes of all three dimensions, and the point alone is as even as without a choice.
#[test]
fn three_sobol_numbers_fill_every_box_together() {
    for_each_sobol_block(|sampler, d, k, first| {
        let points: Vec<_> = (first..first + (1 << k)).map(|i| triple(sampler, PIXEL, i, d)).collect();
        for (a, c) in (0..=k).flat_map(|a| (0..=(k - a) / 2).map(move |c| (a, c))) {
            let boxes = UVec3::new(1 << (2 * c), 1 << a, 1 << (k - a - 2 * c));
            let mut taken = vec![false; 1 << k];
            for &(choice, u) in &points {
                let at = (Vec3::new(choice, u.x, u.y) * boxes.as_vec3()).as_uvec3();
                let index = (at.z * boxes.y + at.y) * boxes.x + at.x;
                assert!(!std::mem::replace(&mut taken[index as usize], true), "dimension {d}: two points in a box of {boxes}");
            }
        }
    });
}

#[test]
fn halton_points_fill_every_box_of_prime_powers() {
    const PRIMES: [u32; 8] = [2, 3, 5, 7, 11, 13, 17, 19];
    for seed in 0..6 {
        let sampler = build(Kind::Halton, seed, 1);
        for (d, base) in PRIMES.into_iter().enumerate() {
            for (other, other_base) in PRIMES.into_iter().enumerate().filter(|(other, _)| *other != d) {
                for (j, k) in [(1, 0), (1, 1), (2, 1), (1, 2), (2, 2), (3, 1), (4, 1), (6, 1)] {
                    let cells = (base.pow(j), other_base.pow(k));
                    let Some(n) = u64::from(cells.0).checked_mul(u64::from(cells.1)).filter(|&n| n <= 2000) else { continue };
                    // The interval may start at any sample, not only at multiples of n.
                    for first in [0, 1, 12_345] {
                        let points: Vec<_> = (first..first + n)
                            .map(|i| Vec2::new(number(&sampler, PIXEL, i, d as u32), number(&sampler, PIXEL, i, other as u32)))
                            .collect();
                        // One-dimensional intervals of a radical inverse are even from any index on.
                        assert_even(&points, cells, &format!("bases {base} and {other_base} from {first}"));
                    }
                }
            }
        }
    }
}

#[test]
fn halton_primes_go_on_to_the_last_dimension() {
    // In the dimension of prime b, b consecutive samples take each of b intervals once.
    let sampler = build(Kind::Halton, 1, 1);
    let mut base = 1u32;
    for d in 0..1024 {
        base = (base + 1..).find(|n| (2..).take_while(|k| k * k <= *n).all(|k| n % k != 0)).unwrap();
        let points: Vec<_> = (0..u64::from(base)).map(|i| Vec2::new(number(&sampler, PIXEL, i, d), 0.0)).collect();
        assert_even(&points, (base, 1), &format!("dimension {d}, base {base}"));
    }
    assert_eq!(base, 8161, "the 1024th prime");
}

#[test]
fn stratified_samples_take_each_stratum_once() {
    for spp in (1..200).chain([256, 289, 400, 1000, 1024, 4096, 9973]) {
        let sampler = build(Kind::Stratified, 3, spp);
        for d in [0, 2, 9, 500] {
            // The planned samples, and those of two later stratifications.
            for first in [0, spp, 7 * spp] {
                let line: Vec<_> = (first..first + spp).map(|i| Vec2::new(number(&sampler, PIXEL, i, d), 0.0)).collect();
                assert_even(&line, (spp as u32, 1), &format!("{spp} spp, dimension {d}"));
            }
        }
    }
}

#[test]
fn later_stratifications_are_other_ones() {
    let sampler = build(Kind::Stratified, 3, 16);
    let at = |index| point(&sampler, PIXEL, index, 2);
    // One in 256 numbers has the same cell by chance, and none has the same bits.
    assert!((0..1000).all(|i| at(i) != at(i + 16)));
}

#[test]
fn stratified_points_take_each_cell_of_a_near_square_once() {
    for (spp, cells) in
        [(4, (2, 2)), (6, (3, 2)), (12, (4, 3)), (16, (4, 4)), (128, (16, 8)), (256, (16, 16)), (1000, (40, 25)), (1024, (32, 32))]
    {
        let sampler = build(Kind::Stratified, 3, spp);
        for d in [0, 2, 9, 500] {
            let points: Vec<_> = (0..spp).map(|i| point(&sampler, PIXEL, i, d)).collect();
            assert_even(&points, cells, &format!("{spp} spp, dimension {d}"));
        }
    }
    // Primes: no two samples in one cell of the covering grid.
    for (spp, x, y) in [(7, 3, 3), (13, 4, 4), (101, 11, 10), (997, 32, 32)] {
        let sampler = build(Kind::Stratified, 3, spp);
        let cell = |p: Vec2| ((f64::from(p.x) * f64::from(x)) as u32, (f64::from(p.y) * f64::from(y)) as u32);
        let cells: std::collections::HashSet<_> = (0..spp).map(|i| cell(point(&sampler, PIXEL, i, 2))).collect();
        assert_eq!(cells.len() as u64, spp);
    }
}

#[test]
fn dimensions_are_not_correlated() {
    let dimensions = used_dimensions();
    let choices: Vec<u32> = (0..8).flat_map(|depth| [Use::Bsdf, Use::Light].map(|use_| dimension::vertex(depth, use_))).collect();
    for kind in kinds() {
        for (seed, n) in [(1, 64u64), (2, 256), (3, 1024), (4, 1000)] {
            let sampler = build(kind, seed, n);
            // Each column has the numbers of one dimension. Those of one use belong together.
            let mut columns: Vec<Column> = Vec::new();
            for &used in &dimensions {
                let mut add = |dimension, number: &dyn Fn(u64) -> f32| {
                    columns.push(Column { used, dimension, numbers: (0..n).map(|i| f64::from(number(i))).collect() });
                };
                add(used, &|i| number(&sampler, PIXEL, i, used));
                add(used, &|i| point(&sampler, PIXEL, i, used).x);
                add(used + 1, &|i| point(&sampler, PIXEL, i, used).y);
                if choices.contains(&used) {
                    add(used, &|i| triple(&sampler, PIXEL, i, used).0);
                    add(used + 1, &|i| triple(&sampler, PIXEL, i, used).1.x);
                    add(used + 2, &|i| triple(&sampler, PIXEL, i, used).1.y);
                }
            }
            // Samplers whose dimensions are the same whether they are asked for alone or together.
            let has_one_meaning = matches!(kind, Kind::Halton | Kind::Independent);
            let mut worst: f64 = 0.0;
            for (i, a) in columns.iter().enumerate() {
                for b in &columns[i + 1..] {
                    if a.used != b.used && !(has_one_meaning && a.dimension == b.dimension) {
                        worst = worst.max(correlation(&a.numbers, &b.numbers).abs());
                    }
                }
            }
            // One in 1.7 million independent pairs exceeds 5/√N: of these 10 000 pairs in 16 repetitions, one in one of 10 runs.
            assert!(worst < 5.0 / (n as f64).sqrt(), "{kind:?}, {n} samples: |r| = {worst}");
        }
    }
}

/// Numbers of all samples in one dimension, asked for alone or together with others of the same use.
struct Column {
    used: u32,
    dimension: u32,
    numbers: Vec<f64>,
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let product = |x: &[f64], mx: f64, y: &[f64], my: f64| x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>();
    product(a, ma, b, mb) / (product(a, ma, a, ma) * product(b, mb, b, mb)).sqrt()
}

/// Each single sample is uniform over many pixels, which makes the estimate of each pixel unbiased.
#[test]
fn each_sample_is_uniform_over_pixels() {
    const CELLS: u32 = 16;
    let indices = [0u64, 1, 2, 5, 63, 1 << 33];
    let dimensions =
        [dimension::FILM, dimension::vertex(0, Use::Bsdf), dimension::vertex(3, Use::Light), dimension::vertex(200, Use::Bsdf)];
    let tests = 4 * indices.len() * dimensions.len() * 3;
    for kind in kinds() {
        let sampler = build(kind, 11, 64);
        for index in indices {
            for d in dimensions {
                let [mut squares, mut lines, mut choices] = [(); 3].map(|()| vec![0; (CELLS * CELLS) as usize]);
                for i in 0..40_000 {
                    let pixel = UVec2::new(i % 200, i / 200);
                    let p = (point(&sampler, pixel, index, d) * CELLS as f32).as_uvec2();
                    squares[(p.y * CELLS + p.x) as usize] += 1;
                    lines[(number(&sampler, pixel, index, d) * (CELLS * CELLS) as f32) as usize] += 1;
                    choices[(triple(&sampler, pixel, index, d).0 * (CELLS * CELLS) as f32) as usize] += 1;
                }
                for (counts, what) in [(squares, "2-D"), (lines, "1-D"), (choices, "3-D")] {
                    let p = uniformity(&counts);
                    assert!(p > sidak(tests), "{kind:?} {what}, sample {index}, dimension {d}: p = {p}");
                }
            }
        }
    }
}

/// Owen scrambling: two samples agree in the digits that their indices determine, and are independent in the following digits.
#[test]
fn scrambled_digits_are_independent_beyond_the_common_ones() {
    // Samples 0 and 1 lie in different halves (base 2) or thirds (base 3); within them, 8 × 8 cells each.
    for (kind, d, base) in [(Kind::Sobol, 3, 2), (Kind::Halton, 0, 2), (Kind::Halton, 1, 3), (Kind::Halton, 2, 5)] {
        let sampler = build(kind, 5, 1);
        let mut counts = vec![0u64; 64];
        let mut firsts = vec![0u64; (base * base) as usize];
        for i in 0..100_000 {
            let pixel = UVec2::new(i % 300, i / 300);
            let scaled = [0, 1].map(|index| f64::from(number(&sampler, pixel, index, d)) * f64::from(base));
            let [a, b] = scaled.map(|x| (x.fract() * 8.0) as usize);
            counts[a * 8 + b] += 1;
            firsts[(scaled[0] as u32 * base + scaled[1] as u32) as usize] += 1;
        }
        let p = uniformity(&counts);
        assert!(p > sidak(8), "{kind:?} base {base}: p = {p}");
        // All ordered pairs of different first digits are equally likely, and pairs of equal ones are impossible.
        let (equal, different): (Vec<_>, Vec<_>) = (0..firsts.len()).partition(|i| i % (base as usize + 1) == 0);
        assert!(equal.iter().all(|&i| firsts[i] == 0), "{kind:?}");
        let p = uniformity(&different.iter().map(|&i| firsts[i]).collect::<Vec<_>>());
        assert!(p > sidak(8), "{kind:?} base {base}, first digits: p = {p}");
    }
}

/// All orders of few strata are equally likely.
#[test]
fn strata_come_in_every_order() {
    for (spp, orders) in [(2u64, 2), (3, 6), (4, 24), (5, 120)] {
        let sampler = build(Kind::Stratified, 8, spp);
        let mut counts = std::collections::HashMap::<Vec<u32>, u64>::new();
        for i in 0..60_000 {
            let pixel = UVec2::new(i % 300, i / 300);
            let order = (0..spp).map(|s| (number(&sampler, pixel, s, 1) * spp as f32) as u32).collect();
            *counts.entry(order).or_default() += 1;
        }
        assert_eq!(counts.len(), orders, "{spp} strata");
        let p = uniformity(&counts.into_values().collect::<Vec<_>>());
        assert!(p > sidak(4), "{spp} strata: p = {p}");
    }
}

#[test]
fn extremes_of_every_argument_give_numbers() {
    for kind in kinds() {
        for spp in [0, 1, 1 << 24, u64::MAX] {
            let sampler = build(kind, u64::MAX, spp);
            for index in [0, u64::from(u32::MAX), 1 << 32, u64::MAX] {
                for d in [0, 1023, 1024, u32::MAX - 1, u32::MAX] {
                    let u = point(&sampler, UVec2::MAX, index, d);
                    assert!(u.min_element() >= 0.0 && u.max_element() < 1.0);
                    let u = number(&sampler, UVec2::ZERO, index, d);
                    assert!((0.0..1.0).contains(&u));
                }
            }
        }
    }
    dimension::vertex(u32::MAX, Use::Medium);
}

#[test]
fn integration_gains_what_stratification_promises() {
    // ∫ of a smooth function over the square: the standard deviation over pixels, relative to independent numbers.
    let deviation = |kind, n: u64| {
        // The first two dimensions, where Halton's bases are 2 and 3.
        let sampler = build(kind, 2, n);
        let squares = (0..400).map(|i| {
            let pixel = UVec2::new(i, 0);
            let sum: f64 = (0..n).map(|s| point(&sampler, pixel, s, dimension::FILM)).map(|p| f64::from(p.x) * f64::from(p.y)).sum();
            (sum / n as f64 - 0.25).powi(2)
        });
        (squares.sum::<f64>() / 400.0).sqrt()
    };
    // Var(xy) = 1/9 − 1/16 = 7/144; 400 deviations are known to 3.5 %, 5 σ of that.
    let plain = (7f64 / 144.0 / 256.0).sqrt();
    assert!((deviation(Kind::Independent, 256) / plain - 1.0).abs() < 0.18);
    // Jittering: variance N⁻² · ∫|∇f|²/12 = N⁻²/18: σ = √(1/18)/256.
    let jittered = |n: f64| (1f64 / 18.0).sqrt() / n;
    assert!(
        (deviation(Kind::Stratified, 256) / jittered(256.0) - 1.0).abs() < 0.18,
        "{}",
        deviation(Kind::Stratified, 256) / jittered(256.0)
    );
    // Nets converge like N^(−3/2) up to a logarithm, faster than jittering, and 4 times the points gain more than a factor of 4.
    assert!(deviation(Kind::Sobol, 256) < jittered(256.0) / 2.0);
    // Halton's nets in bases 2 and 3 have 2ʲ 3ᵏ points.
    assert!(deviation(Kind::Halton, 16 * 81) < jittered(16.0 * 81.0) / 2.0);
    assert!(deviation(Kind::Sobol, 1024) < deviation(Kind::Sobol, 256) / 5.0);
}

/// Pictures of neighbouring seeds are independent, because they have no scrambling in common.
#[test]
fn seeds_share_no_scrambling() {
    for kind in [Kind::Stratified, Kind::Halton, Kind::Sobol] {
        let mut seen = std::collections::HashSet::new();
        for seed in (0..64).chain((0..32).map(|bit| 1 << (bit + 32))) {
            let spec = SamplerSpec { kind, seed, spp: 64, scramblings: 16 };
            for (r, sequence) in spec.sequences().into_iter().enumerate() {
                let numbers: Vec<u32> =
                    [0, 1].iter().flat_map(|&i| point(&sequence, PIXEL, i, dimension::FILM).to_array().map(f32::to_bits)).collect();
                assert!(seen.insert(numbers), "{kind:?}: scrambling {r} of seed {seed} has been there");
            }
        }
    }
}
