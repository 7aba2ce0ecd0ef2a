//! Where samples fall, against what the density promises.

use statrs::distribution::{ContinuousCDF, Normal};

use super::{Case, Outcome, chance, show};
use crate::proof::chi2::chi2 as pearson;
use crate::proof::rect::direction;
use crate::proof::report::{CERTAIN, CounterExample};
use crate::proof::{Chi2, Division, Drawn};

/// Of ∫ pdf. Where a density jumps close to the edge of a cell, beyond the outermost node, only hints tell of it:
/// one share in 1024 of every bin may go unseen. The tolerances of the bins are far below that. (reliability M9)
const QUADRATURE: f64 = 1e-3;

/// ∫ pdf = the chance of a sample with a density, which drawing estimates.
pub fn integral(case: &Case) -> Outcome {
    let level = case.level();
    let refused = case.drawn.iter().filter(|drawn| drawn.is_resolved()).find_map(|drawn| integral_at(drawn, level));
    let notes = case.drawn.iter().map(|drawn| {
        let part = |count: u64| 100.0 * count as f64 / drawn.samples as f64;
        let delta = drawn.samples - drawn.smooth - drawn.failed;
        let judged = if drawn.is_resolved() { "" } else { "; not judged: the lobe is narrower than f32 tells directions apart" };
        format!(
            "cos θo {:>6.3}: ∫ pdf = {:.5}, drawn with a density {:.3} %, delta {:.3} %, nowhere {:.3} %{judged}",
            drawn.wo.cos(),
            drawn.mass,
            part(drawn.smooth),
            part(delta),
            part(drawn.failed)
        )
    });
    Outcome::new(refused, notes.collect())
}

fn integral_at(drawn: &Drawn, level: f64) -> Option<CounterExample> {
    let n = drawn.samples as f64;
    let share = drawn.smooth as f64 / n;
    let tolerance = QUADRATURE + drawn.blur;
    let excess = (drawn.mass - share).abs() - tolerance;
    let chance_of_one = drawn.mass.clamp(0.0, 1.0);
    let spread = (chance_of_one * (1.0 - chance_of_one) / n).sqrt();
    // Two-sided, and no difference at all where nothing is left to chance.
    let p = match excess > 0.0 || drawn.mass.is_nan() {
        true if spread > 0.0 => 2.0 * Normal::standard().sf(excess / spread),
        true => 0.0,
        false => 1.0,
    };
    (p < level || p.is_nan()).then(|| CounterExample {
        inputs: format!("wo = {}", show(drawn.wo)),
        expected: format!("∫ pdf over the sphere = share of samples with a density = {share:.6}"),
        found: format!("∫ pdf = {:.6}, by adaptive quadrature to {tolerance:.0e}", drawn.mass),
        sure: if p == 0.0 { CERTAIN.into() } else { chance(p, level, drawn.samples) },
    })
}

/// Three divisions of the sphere: a fine one for what is misplaced, a coarse one for what is misshapen, and
/// cells of equal chance for lobes narrower than both.
pub fn chi2(case: &Case) -> Outcome {
    let level = case.level();
    let tests: Vec<(&Drawn, &Division, Chi2)> = case
        .drawn
        .iter()
        .filter(|drawn| drawn.smooth > 0 && drawn.is_resolved())
        .flat_map(|drawn| drawn.divisions.iter().map(move |division| (drawn, division, pearson(&division.shares, &division.counts))))
        .collect();
    let Some((drawn, division, worst)) = tests.iter().min_by(|a, b| a.2.p.total_cmp(&b.2.p)) else {
        return Outcome::exempt("no sample has a density, or all lobes are narrower than f32 tells directions apart".into());
    };
    let empty = tests.iter().filter(|(_, _, test)| test.freedom == 0).count();
    let mut notes = vec![format!("{} tests of {} samples; smallest p {:.2e}, level {level:.2e}", tests.len(), drawn.samples, worst.p)];
    if empty > 0 {
        notes.push(format!("{empty} of them say nothing: the lobe lies within one bin"));
    }
    let refusal = (worst.p < level).then(|| refuse(drawn, division, worst, level));
    Outcome::new(refusal, notes)
}

fn refuse(drawn: &Drawn, division: &Division, test: &Chi2, level: f64) -> CounterExample {
    let bin = division.bins[test.worst];
    let expected = drawn.smooth as f64 * division.shares[test.worst] / division.shares.iter().sum::<f64>();
    let found = division.counts[test.worst];
    CounterExample {
        inputs: format!(
            "wo = {}; wi around {} in the bin z {:.4} to {:.4}, φ {:.4} to {:.4}",
            show(drawn.wo),
            show(direction(bin.middle())),
            bin.z[0],
            bin.z[1],
            bin.phi[0],
            bin.phi[1]
        ),
        expected: format!("{expected:.1} samples there, the integral of pdf; χ² of all bins about {}", test.freedom),
        found: format!("{found} samples there; χ² = {:.1} ({} bins, {} degrees of freedom)", test.statistic, division.name, test.freedom),
        sure: chance(test.p, level, drawn.samples),
    }
}
