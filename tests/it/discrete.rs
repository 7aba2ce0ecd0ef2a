//! Choosing in proportion to weights.

use pt::math::discrete::Discrete;
use pt::math::float::ONE_MINUS_EPSILON;
use pt::math::lanes::{Kernel, Lanes, Width, to_array, to_array_u32};

use crate::random::Random;

#[test]
fn zero_weights_are_never_chosen() {
    let mut random = Random::new(1);
    for _ in 0..10_000 {
        let n = 1 + random.bits() as usize % 20;
        // Each weight is zero with probability ½. The first, the last, or all but one may be zero.
        let mut weights: Vec<f32> = (0..n).map(|_| if random.bits() & 1 == 0 { 0.0 } else { random.magnitude(1e-6, 1e6) as f32 }).collect();
        weights[random.bits() as usize % n] = 1.0;
        let discrete = Discrete::new(&weights).unwrap();
        assert_eq!(discrete.len(), n);
        let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
        let choices =
            [0.0, 2f32.powi(-24), 0.5, ONE_MINUS_EPSILON].into_iter().chain((0..20).map(|_| random.unit() as f32 * ONE_MINUS_EPSILON));
        for choice in choices {
            let (i, pmf, rest) = discrete.sample(choice);
            assert!(weights[i] > 0.0, "{weights:?} {choice}");
            assert!((f64::from(pmf) / (f64::from(weights[i]) / total) - 1.0).abs() < 1e-7 && pmf == discrete.pmf(i));
            assert!((0.0..1.0).contains(&rest));
            // The number that is left after a choice, scaled back, is the number that was given.
            let before: f64 = weights[..i].iter().map(|&w| f64::from(w)).sum();
            let back = (before + f64::from(rest) * f64::from(weights[i])) / total;
            assert!((back - f64::from(choice)).abs() < 1.3e-7, "{choice} → {i}, {rest} → {back}");
        }
        let sum: f64 = (0..n).map(|i| f64::from(discrete.pmf(i))).sum();
        assert!((sum - 1.0).abs() < 1e-6);
        assert!((0..n).all(|i| (discrete.pmf(i) > 0.0) == (weights[i] > 0.0)) && discrete.pmf(n) == 0.0);
        // Weights scaled by a power of two give the same bits.
        let scale = 2f32.powi(random.range(-60.0, 60.0) as i32);
        let scaled = Discrete::new(&weights.iter().map(|w| w * scale).collect::<Vec<_>>()).unwrap();
        for choice in [0.0, 0.3, 0.9, ONE_MINUS_EPSILON] {
            assert_eq!(scaled.sample(choice), discrete.sample(choice));
        }
    }
}

#[test]
fn choices_are_in_proportion_to_their_weights() {
    let weights = [1.0f32, 0.0, 3.0, 4.0, 0.0];
    let discrete = Discrete::new(&weights).unwrap();
    let mut counts = [0u32; 5];
    for i in 0..8000 {
        counts[discrete.sample((i as f32 + 0.5) / 8000.0).0] += 1;
    }
    assert_eq!(counts, [1000, 0, 3000, 4000, 0]);
}

#[test]
fn invalid_weights_are_refused() {
    for weights in [&[][..], &[0.0], &[0.0, -0.0], &[1.0, -1.0], &[f32::NAN], &[1.0, f32::INFINITY]] {
        assert!(Discrete::new(weights).is_none(), "{weights:?}");
    }
    assert!(Discrete::new(&[f32::MAX; 100]).is_some() && Discrete::new(&[1e-45]).is_some());
}

/// A choice in each lane.
struct Choices<'a>(&'a Discrete, [f32; 16]);

impl Kernel for Choices<'_> {
    type Output = ([u32; 16], [f32; 16]);

    #[inline(always)]
    fn run<L: Lanes>(self) -> ([u32; 16], [f32; 16]) {
        let (index, rest) = self.0.sample_lanes::<L>(L::load(&self.1));
        (to_array_u32::<L>(index), to_array::<L>(rest))
    }
}

#[test]
fn lanes_have_the_bits_of_plain_samples() {
    let mut random = Random::new(2);
    for n in (1..40).chain([1000, 1023, 1024, 1025]) {
        // Half of the weights are 0, often the first and the last.
        let mut weights: Vec<f32> = (0..n).map(|_| if random.bits() & 1 == 0 { 0.0 } else { random.magnitude(1e-3, 1e3) as f32 }).collect();
        weights[random.bits() as usize % n] = 1.0;
        let discrete = Discrete::new(&weights).unwrap();
        for turn in 0..8 {
            let choices = std::array::from_fn(|k| match (turn, k) {
                (0, 0) => 0.0,
                (0, 1) => ONE_MINUS_EPSILON,
                _ => random.unit() as f32 * ONE_MINUS_EPSILON,
            });
            for width in Width::available() {
                let (index, rest) = width.run(Choices(&discrete, choices));
                for lane in 0..width.count() {
                    let (i, _, wanted) = discrete.sample(choices[lane]);
                    assert_eq!((index[lane] as usize, rest[lane].to_bits()), (i, wanted.to_bits()), "{n} weights, {width:?}");
                }
            }
        }
    }
}
