//! Repetition of a comparison: what changed beyond chance.
//!
//! ```text
//! t = (m₁ − m₂)/√(v₁ + v₂)        Welch's test, over the replicates, of relMSE and of ln seconds
//! ```
//!
//! A scene with the same settings and version gives the same bits: a picture whose hash is the recorded one has not changed.
//! Where the bits differ, the errors are compared. Errors and times of all methods together are called changed with a probability of
//! [`RISK`] if nothing did. The replicates of a run share the state of their machine: a change of times may be that of the machine.

use serde::Deserialize;

use super::{Measurement, Method, Provenance};
use crate::measure::format::{duration, per_cent};
use crate::measure::{Mean, sidak};

/// Probability of a false alarm.
pub const RISK: f64 = 0.01;

/// Parts of `convergence.json` that a repetition is compared with.
#[derive(Clone, Debug, Deserialize)]
pub struct Recorded {
    /// How the comparison was made.
    pub provenance: Provenance,
    /// Its methods.
    pub methods: Vec<RecordedMethod>,
}

/// Recorded results of a method.
#[derive(Clone, Debug, Deserialize)]
pub struct RecordedMethod {
    /// Name in the report.
    pub name: String,
    /// Hash of the mean of all replicates.
    pub hash: String,
    /// Measurements of all replicates.
    pub measurements: Vec<RecordedMeasurement>,
}

/// Recorded errors of one picture.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct RecordedMeasurement {
    /// Samples per pixel; `None` for pictures from files.
    pub spp: Option<u64>,
    /// Render time.
    pub seconds: f64,
    /// Relative mean squared error.
    pub relmse: f64,
}

impl RecordedMethod {
    /// Samples per pixel of the last checkpoint.
    pub fn last(&self) -> Option<u64> {
        self.measurements.iter().filter_map(|m| m.spp).max()
    }
}

/// Change of a method from the recorded run to the repetition.
#[derive(Clone, Debug)]
pub struct Change {
    /// One line for people.
    pub text: String,
    /// Whether the error changed beyond chance.
    pub error: bool,
}

/// Compares methods with the recorded ones.
///
/// - `hash`: hash of a method's mean picture
pub fn changes(recorded: &[RecordedMethod], methods: &[Method], hash: impl Fn(&Method) -> String) -> Vec<Change> {
    let tested = recorded.iter().filter(|method| method.last().is_some()).count();
    let level = sidak(RISK, 2 * tested.max(1));
    let one = |before: &RecordedMethod| match methods.iter().find(|method| method.name == before.name) {
        None => Change { text: format!("{}: is missing", before.name), error: true },
        Some(method) => change(before, method, &hash(method), level),
    };
    // Pictures from files are not rendered again.
    recorded.iter().filter(|method| method.last().is_some()).map(one).collect()
}

fn change(before: &RecordedMethod, method: &Method, hash: &str, level: f64) -> Change {
    let samples = before.last().unwrap_or(0);
    let then: Vec<&RecordedMeasurement> = before.measurements.iter().filter(|m| m.spp == Some(samples)).collect();
    let now: Vec<&Measurement> = method.measurements.iter().filter(|m| m.samples == samples).collect();
    let errors = [mean(now.iter().map(|m| m.relmse)), mean(then.iter().map(|m| m.relmse))];
    let times = [mean(now.iter().map(|m| m.seconds.ln())), mean(then.iter().map(|m| m.seconds.ln()))];
    let is_same = hash == before.hash;
    let p = errors[0].welch(&errors[1]).p();
    let error = !is_same && p < level;
    let [now_error, then_error] = errors.map(|mean| per_cent(mean.value.max(0.0).sqrt()));
    let picture = match (is_same, error) {
        (true, _) => format!("error {now_error} %, the same picture bit for bit"),
        (false, true) => format!("error {now_error} %, was {then_error} %: changed beyond chance (p = {p:.1e})"),
        (false, false) => format!("error {now_error} %, was {then_error} %: another picture, within chance"),
    };
    let [now_time, then_time] = times.map(|mean| duration(mean.value.exp()));
    let p = times[0].welch(&times[1]).p();
    let time = match p < level {
        true => format!("{now_time}, was {then_time}: changed beyond the spread of the renders (p = {p:.1e})"),
        false => format!("{now_time}, was {then_time}: within chance"),
    };
    Change { text: format!("{}: {samples} spp · {picture} · {time}", method.name), error }
}

/// Mean over the replicates. Fewer than two tell no variance; infinite variance finds no difference.
fn mean(values: impl Iterator<Item = f64> + Clone) -> Mean {
    let count = values.clone().count() as u64;
    if count < 2 {
        return Mean { value: values.sum(), variance: f64::INFINITY, samples: 2.0 };
    }
    // Deviations from the first value, so that no digits are lost.
    let first = values.clone().next().unwrap_or_default();
    let (sum, square) = values.fold((0.0, 0.0), |(sum, square), x| (sum + x - first, square + (x - first) * (x - first)));
    let mean = Mean::from_sums(sum, square, count);
    Mean { value: mean.value + first, ..mean }
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::history;
    use super::*;

    const NOISE: [f64; 4] = [0.97, 1.02, 1.03, 0.98];

    fn recorded(relmse: f64, seconds: f64) -> RecordedMethod {
        let one = |noise: f64| RecordedMeasurement { spp: Some(8), seconds: seconds * noise, relmse: relmse * noise };
        RecordedMethod { name: "nee".into(), hash: "old".into(), measurements: NOISE.map(one).into() }
    }

    fn repeated(relmse: f64, seconds: f64) -> Method {
        let one = |(replicate, noise): (u32, f64)| {
            let Measurement { others, .. } = history(replicate, 1.0, 1.0, 1).remove(0);
            Measurement { replicate, samples: 8, seconds: seconds * noise, mse: 0.0, relmse: relmse * noise, trimmed: 0.0, others }
        };
        Method { measurements: (0..).zip(NOISE).map(one).collect(), ..super::super::synthetic::method("nee") }
    }

    fn told(relmse: f64, seconds: f64, hash: &str) -> Change {
        changes(&[recorded(0.04, 2.0)], &[repeated(relmse, seconds)], |_| hash.to_owned()).remove(0)
    }

    /// The spread of 3 % of four replicates gives t = 0.1/(√2 · 0.03/√4) = 4.7 for a change of a tenth, p = 0.003; and t = 24 for a half.
    /// The level of each of two tests is 0.005.
    #[test]
    fn changes_beyond_chance_are_told() {
        let same = told(0.04, 2.0, "old");
        assert_eq!(same.text, "nee: 8 spp · error 20 %, the same picture bit for bit · 2 s, was 2 s: within chance");
        assert!(!same.error);
        let close = told(0.0404, 2.02, "new");
        assert!(!close.error && close.text.contains("another picture, within chance"), "{}", close.text);
        let far = told(0.06, 3.0, "new");
        assert!(far.error && far.text.contains("error 24 %, was 20 %: changed beyond chance (p = "), "{}", far.text);
        assert!(far.text.contains("3 s, was 2 s: changed beyond the spread of the renders"), "{}", far.text);
        // A picture with the recorded hash is that picture, whatever its numbers.
        assert!(!told(0.06, 2.0, "old").error);
        let gone = changes(&[recorded(0.04, 2.0)], &[], |_| String::new());
        assert!(gone[0].error && gone[0].text == "nee: is missing");
    }

    /// Two runs of the same law differ beyond chance in at most about RISK of the cases: 2000 pairs with fixed numbers, of which 20 are
    /// expected; Poisson's deviation is 4.5, so that 40 is more than four deviations away.
    #[test]
    fn chance_is_seldom_called_a_change() {
        let mut state = 1u64;
        let mut normal = || {
            let mut uniform = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 33) as f64 / f64::from(1u32 << 31)
            };
            (0..12).map(|_| uniform()).sum::<f64>() - 6.0
        };
        let mut alarms = 0;
        for _ in 0..2000 {
            let [mut before, mut now] = [recorded(0.04, 2.0), recorded(0.04, 2.0)];
            before.measurements.iter_mut().chain(&mut now.measurements).for_each(|m| m.relmse = 0.04 * (1.0 + 0.05 * normal()));
            let mut method = repeated(0.04, 2.0);
            method.measurements.iter_mut().zip(&now.measurements).for_each(|(own, m)| own.relmse = m.relmse);
            alarms += u32::from(changes(&[before], &[method], |_| "new".into())[0].error);
        }
        assert!(alarms <= 40, "{alarms} of 2000");
    }
}
