//! Plots of a report.

mod axis;
mod bars;
mod curves;
mod drawing;
mod envelope;
mod error_curve;
mod font;
mod frame;
mod pareto;
mod raster;
mod svg;

use super::Files;
use crate::compare::{Comparison, Cost, Method};
use crate::error::Result;
use crate::measure::format;

use drawing::Drawing;
pub use error_curve::error_curve;
use frame::{Format, NARROW, WIDE};

/// A plot, with the stem of its file names.
struct Plot {
    name: &'static str,
    draw: fn(&Comparison, Format) -> Drawing,
}

const ALL: &[Plot] = &[
    Plot { name: "error-against-time", draw: curves::against_time },
    Plot { name: "error-against-samples", draw: curves::against_samples },
    Plot { name: "time-to-error", draw: bars::bars },
    Plot { name: "pareto-front", draw: pareto::front },
];

/// Returns all plots as SVG and PNG files.
pub fn files(comparison: &Comparison) -> Result<Files> {
    let mut files = Files::new();
    for plot in ALL {
        let drawing = (plot.draw)(comparison, WIDE);
        files.push((format!("plots/{}.svg", plot.name).into(), svg::file(&drawing)));
        files.push((format!("plots/{}.png", plot.name).into(), raster::png(&drawing)?));
    }
    Ok(files)
}

/// Returns all plots for the page, each for wide windows and for narrow ones.
pub fn elements(comparison: &Comparison) -> Vec<[String; 2]> {
    ALL.iter().map(|plot| [WIDE, NARROW].map(|format| svg::element(&(plot.draw)(comparison, format)))).collect()
}

/// Slope of relMSE over time, in logarithms: `−0.98 ± 0.02`.
///
/// - `b`: exponent of relMSE ∝ time⁻ᵇ, and its standard error
pub fn slope((b, deviation): (f64, f64)) -> String {
    let sign = if b > 0.0 { "−" } else { "" };
    format!("{sign}{:.2} ± {:.2}", b.abs(), deviation)
}

/// Time with its interval: `14 s (12 s–17 s)`, with `≈` before extrapolated ones.
pub fn price(cost: &Cost) -> String {
    let (seconds, interval) = (format::duration(cost.seconds), format::between(cost.low, cost.high));
    format!("{}{seconds} ({interval})", if cost.extrapolated { "≈ " } else { "" })
}

/// Reason why a method never reaches an error.
pub fn unpriced(method: &Method, target: f64) -> String {
    if method.bias.is_some_and(|(bias, _)| bias >= target) { "never: bias".into() } else { "not known".into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exponent of a falling error is shown as the falling slope, that of a growing error as a growing one.
    #[test]
    fn slopes_have_one_sign() {
        assert_eq!([slope((0.976, 0.02)), slope((-1.28, 0.1))], ["−0.98 ± 0.02", "1.28 ± 0.10"]);
    }
}
