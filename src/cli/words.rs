//! Errors, prices and targets in words.

pub use crate::measure::words::{duration, per_cent};
use crate::measure::{Course, Outcome, Price, RelativeError, Target};

/// The errors whose prices are told.
pub const TARGETS: [f64; 4] = [0.1, 0.03, 0.01, 0.003];

/// `2.1 % (95 %: 2.0–2.2)`
pub fn error(error: &RelativeError, confidence: f64) -> String {
    let [low, high] = error.interval(confidence).map(per_cent);
    format!("{} % ({} %: {low}–{high})", per_cent(error.value), per_cent(confidence))
}

/// What a smaller error than the last would cost: `1 % would take about 14 s`.
pub fn next_price(course: &Course, confidence: f64) -> Option<String> {
    let error = course.last()?.error?;
    let target = TARGETS.into_iter().rev().filter(|target| *target < 0.8 * error.value).find(|target| *target >= 0.01);
    let target = target.or_else(|| TARGETS.into_iter().find(|target| *target < 0.8 * error.value))?;
    let price = course.price(target, confidence)?;
    Some(format!("{} % would take about {}", per_cent(target), duration(price.seconds)))
}

/// `38 s (35–41 s)`
pub fn price(price: &Price) -> String {
    format!("{} ({}–{})", duration(price.seconds), duration(price.low), duration(price.high))
}

/// What became of a target: `target 1 %: met (95 % sure)`.
pub fn outcome(target: &Target, outcome: Outcome) -> String {
    let what = format!("target {} %", per_cent(target.error));
    match outcome {
        Outcome::Met => format!("{what}: met ({} % sure)", per_cent(target.confidence)),
        Outcome::NotMet => format!("{what}: not met"),
        Outcome::NotEstablished => format!("{what}: cannot be established (heavy tail: a few pixels hold all the noise)"),
    }
}
