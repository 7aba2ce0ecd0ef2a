//! Laws of the distribution of samples: they follow the density.

use statrs::distribution::{ContinuousCDF, Normal};

use super::{Case, Outcome, chance, show};
use crate::proof::chi2::chi2 as pearson;
use crate::proof::rect::direction;
use crate::proof::report::{CERTAIN, CounterExample};
use crate::proof::{Chi2, Division, SampledDirections};

/// Tolerance for ∫ pdf. A density that jumps near the edge of a cell, beyond the outermost node, is found only by the hints, and
/// 1/1024 of every bin may be missed. The tolerances of the bins are far below that.
const QUADRATURE: f64 = 1e-3;

/// Tests the law `integral`: ∫ pdf is the probability of a sample with a density, which sampling estimates.
pub fn integral(case: &Case) -> Outcome {
    let level = case.level();
    let refused = case.sampled.iter().filter(|sampled| sampled.is_resolved()).find_map(|sampled| integral_at(sampled, level));
    let notes = case.sampled.iter().map(|sampled| {
        let part = |count: u64| 100.0 * count as f64 / sampled.samples as f64;
        let delta = sampled.samples - sampled.smooth - sampled.failed;
        let judged = if sampled.is_resolved() { "" } else { "; not judged: the lobe is narrower than f32 tells directions apart" };
        format!(
            "cos θo {:>6.3}: ∫ pdf = {:.5}, drawn with a density {:.3} %, delta {:.3} %, nowhere {:.3} %{judged}",
            sampled.wo.cos(),
            sampled.mass,
            part(sampled.smooth),
            part(delta),
            part(sampled.failed)
        )
    });
    Outcome::new(refused, notes.collect())
}

fn integral_at(sampled: &SampledDirections, level: f64) -> Option<CounterExample> {
    let n = sampled.samples as f64;
    let share = sampled.smooth as f64 / n;
    let tolerance = QUADRATURE + sampled.blur;
    let excess = (sampled.mass - share).abs() - tolerance;
    let chance_of_one = sampled.mass.clamp(0.0, 1.0);
    let spread = (chance_of_one * (1.0 - chance_of_one) / n).sqrt();
    // Two-sided. Where nothing is random, no difference is allowed.
    let p = match excess > 0.0 || sampled.mass.is_nan() {
        true if spread > 0.0 => 2.0 * Normal::standard().sf(excess / spread),
        true => 0.0,
        false => 1.0,
    };
    (p < level || p.is_nan()).then(|| CounterExample {
        inputs: format!("wo = {}", show(sampled.wo)),
        expected: format!("∫ pdf over the sphere = share of samples with a density = {share:.6}"),
        found: format!("∫ pdf = {:.6}, by adaptive quadrature to {tolerance:.0e}", sampled.mass),
        sure: if p == 0.0 { CERTAIN.into() } else { chance(p, level, sampled.samples) },
    })
}

/// Tests the law `chi2` on three divisions of the sphere: a fine one for shifted lobes, a coarse one for wrong shapes, and cells of
/// equal probability for lobes that are narrower than both.
pub fn chi2(case: &Case) -> Outcome {
    let level = case.level();
    let tests: Vec<(&SampledDirections, &Division, Chi2)> = case
        .sampled
        .iter()
        .filter(|sampled| sampled.smooth > 0 && sampled.is_resolved())
        .flat_map(|sampled| sampled.divisions.iter().map(move |division| (sampled, division, pearson(&division.shares, &division.counts))))
        .collect();
    let Some((sampled, division, worst)) = tests.iter().min_by(|a, b| a.2.p.total_cmp(&b.2.p)) else {
        return Outcome::exempt("no sample has a density, or all lobes are narrower than f32 tells directions apart".into());
    };
    let empty = tests.iter().filter(|(_, _, test)| test.freedom == 0).count();
    let mut notes = vec![format!("{} tests of {} samples; smallest p {:.2e}, level {level:.2e}", tests.len(), sampled.samples, worst.p)];
    if empty > 0 {
        notes.push(format!("{empty} of them say nothing: the lobe lies within one bin"));
    }
    let refusal = (worst.p < level).then(|| refuse(sampled, division, worst, level));
    Outcome::new(refusal, notes)
}

fn refuse(sampled: &SampledDirections, division: &Division, test: &Chi2, level: f64) -> CounterExample {
    let bin = division.bins[test.worst];
    let expected = sampled.smooth as f64 * division.shares[test.worst] / division.shares.iter().sum::<f64>();
    let found = division.counts[test.worst];
    CounterExample {
        inputs: format!(
            "wo = {}; wi around {} in the bin z {:.4} to {:.4}, φ {:.4} to {:.4}",
            show(sampled.wo),
            show(direction(bin.middle())),
            bin.z[0],
            bin.z[1],
            bin.phi[0],
            bin.phi[1]
        ),
        expected: format!("{expected:.1} samples there, the integral of pdf; χ² of all bins about {}", test.freedom),
        found: format!("{found} samples there; χ² = {:.1} ({} bins, {} degrees of freedom)", test.statistic, division.name, test.freedom),
        sure: chance(test.p, level, sampled.samples),
    }
}
