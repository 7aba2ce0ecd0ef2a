//! Plot of the spread of the error: how much the errors of single renders differ.
//!
//! ```text
//! v = s / mean relMSE,   interval of v: s √((R − 1)/χ²) / mean relMSE
//! ```
//!
//! s is the standard deviation of the relMSE of R renders with different random numbers, and χ² a quantile of its distribution for R − 1
//! degrees of freedom. The interval holds for normally distributed errors, and is too narrow where a few renders have much larger errors than
//! the others. A method whose errors differ much from one render to the next cannot be judged by a single render. Source: Celarek and others, *Quantifying the Error of Light Transport Algorithms* (2019), §4.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::axis::Axis;
use super::drawing::{Anchor, Color, Dashes, Drawing};
use super::font;
use super::frame::{Format, Quantity};
use crate::compare::{Comparison, Method};
use crate::measure::format;

/// Errors of the single renders of a method at its last checkpoint.
struct Spread {
    /// √relMSE of each render.
    errors: Vec<f64>,
    /// Number of renders whose relMSE, less the reference's own, is not above 0: they have no place on a logarithmic axis.
    below: usize,
    /// √ of the mean relMSE less and plus one standard deviation.
    range: [f64; 2],
    /// The relative standard deviation of relMSE, and the ends of its interval; `None` for a single render.
    variation: Option<[f64; 3]>,
}

/// Draws the errors of the renders of each method on a logarithmic axis. The drawing is as tall as the methods need.
pub fn spread(comparison: &Comparison, format: Format) -> Drawing {
    let Format { width, font_size, .. } = format;
    let spreads: Vec<Option<Spread>> = comparison.methods.iter().map(|method| spread_of(method, comparison.confidence)).collect();
    let row = 3.4 * font_size;
    let top = 2.4 * font_size;
    let bottom = top + spreads.len() as f64 * row;
    let mut drawing = Drawing::new(width, bottom + 3.6 * font_size);
    let title = if width < 500.0 { "Errors of single renders" } else { "Errors of single renders at the end" };
    drawing.text([0.0, font_size + 3.0], title, Color::Text, font_size + 2.0, Anchor::Start);

    let radius = 0.32 * font_size;
    let all = spreads.iter().flatten();
    let axis = Axis::over(all.flat_map(|spread| spread.errors.iter().chain(&spread.range)).copied(), [radius, width - radius]);
    let widest = font::width_in_any_font("100 %", font_size) + font_size;
    for tick in axis.ticks((width / widest) as usize) {
        let x = axis.at(tick);
        drawing.line(vec![[x, top], [x, bottom]], Color::Grid, 1.0, Dashes::None);
        drawing.text([x, bottom + 1.4 * font_size], Quantity::Error.label(tick), Color::Muted, font_size, Anchor::Middle);
    }
    let narrow = "√relMSE; line: ± standard deviation";
    let axis_title =
        if width < 500.0 { narrow } else { "relative error √relMSE; line: that of the mean relMSE ± its standard deviation" };
    drawing.text([width, bottom + 2.9 * font_size], axis_title, Color::Muted, font_size, Anchor::End);

    for (index, (method, spread)) in comparison.methods.iter().zip(&spreads).enumerate() {
        let y = top + index as f64 * row;
        drawing.text([0.0, y + 1.2 * font_size], words(method, spread.as_ref()), Color::Text, font_size, Anchor::Start);
        let Some(spread) = spread else { continue };
        let middle = y + 2.3 * font_size;
        if spread.variation.is_some() {
            let [low, high] = spread.range.map(|error| axis.at(error));
            drawing.line(vec![[low, middle], [high, middle]], Color::Method(index), 2.0, Dashes::None);
        }
        for error in &spread.errors {
            let hint = format!("{}: {} %", method.name, format::per_cent(*error));
            drawing.symbol(index, [axis.at(*error), middle], radius, 0.6, hint);
        }
    }
    let each: Vec<String> = comparison.methods.iter().zip(&spreads).map(|(method, spread)| words(method, spread.as_ref())).collect();
    drawing.description = format!("Errors of single renders at the end. {}.", each.join("; "));
    drawing
}

/// `None` where no error is above that of the reference.
fn spread_of(method: &Method, confidence: f64) -> Option<Spread> {
    let last = method.measurements.iter().map(|m| m.samples).max()?;
    let squares: Vec<f64> = method.measurements.iter().filter(|m| m.samples == last).map(|m| m.relmse).collect();
    let count = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let errors: Vec<f64> = squares.iter().filter(|square| **square > 0.0).map(|square| square.sqrt()).collect();
    if errors.is_empty() || mean <= 0.0 {
        return None;
    }
    let deviation = (squares.iter().map(|square| (square - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    let variation = ChiSquared::new(count - 1.0).ok().filter(|_| count > 1.0).map(|chi2| {
        let at = |p: f64| deviation / mean * ((count - 1.0) / chi2.inverse_cdf(p)).sqrt();
        [deviation / mean, at(0.5 + 0.5 * confidence), at(0.5 - 0.5 * confidence)]
    });
    let deviation = if count > 1.0 { deviation } else { 0.0 };
    // Below 0 there is no logarithm; the line then ends at the least error.
    let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
    let low = if mean > deviation { (mean - deviation).sqrt() } else { least };
    Some(Spread { below: squares.len() - errors.len(), errors, range: [low, (mean + deviation).sqrt()], variation })
}

/// `nee: relMSE differs by 12 % (8–26 %)`
fn words(method: &Method, spread: Option<&Spread>) -> String {
    let told = match spread {
        None => "no error above that of the reference".to_owned(),
        Some(Spread { variation: None, .. }) => "a single render".to_owned(),
        Some(Spread { variation: Some(variation), below, .. }) => {
            let [value, low, high] = variation.map(format::per_cent);
            let below = if *below > 0 { format!(", {below} below that of the reference") } else { String::new() };
            format!("relMSE differs by {value} % ({low}–{high} %){below}")
        }
    };
    format!("{}: {told}", method.name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Measurement;

    /// Five renders with relMSE of 1, 2, 3, 4 and 5 have a mean of 3 and a standard deviation of √2.5. The 2.5 % and 97.5 % quantiles of the χ²
    /// distribution with 4 degrees of freedom, which make the interval, are 0.4844 and 11.143 (NIST tables).
    #[test]
    fn variations_are_standard_deviations() {
        let one = |k: u32| Measurement {
            replicate: k,
            samples: 8,
            seconds: 1.0,
            mse: 0.0,
            relmse: f64::from(k + 1),
            trimmed: 0.0,
            others: vec![],
        };
        let earlier = Measurement { samples: 4, relmse: 100.0, ..one(0) };
        let all: Vec<Measurement> = (0..5).map(one).chain([earlier]).collect();
        let method = |measurements: Vec<Measurement>| Method { measurements, ..crate::compare::synthetic::method("a") };
        let spread = spread_of(&method(all.clone()), 0.95).expect("errors");
        let [value, low, high] = spread.variation.expect("renders");
        let deviation = 2.5f64.sqrt() / 3.0;
        for (found, wanted) in
            [(value, deviation), (low, deviation * (4.0 / 11.143f64).sqrt()), (high, deviation * (4.0 / 0.4844f64).sqrt())]
        {
            assert!((found / wanted - 1.0).abs() < 1e-4, "{found}, not {wanted}");
        }
        assert_eq!((spread.errors.len(), spread.range[1]), (5, (3.0 + 2.5f64.sqrt()).sqrt()));
        let mixed = spread_of(&method(vec![one(0), Measurement { relmse: -0.5, ..one(1) }]), 0.95).expect("an error above 0");
        assert_eq!((mixed.errors.len(), mixed.below), (1, 1));
        assert!(spread_of(&method(vec![one(0)]), 0.95).expect("an error").variation.is_none());
        assert!(spread_of(&method(vec![Measurement { relmse: -1.0, ..one(0) }]), 0.95).is_none());
    }
}
