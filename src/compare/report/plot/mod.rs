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
mod spectrum;
mod spread;
mod svg;

use super::Files;
use crate::compare::{Comparison, Cost, CostKind, Method, NoPrice};
use crate::error::Result;
use crate::measure::format;

use drawing::Drawing;
pub use error_curve::last_error;
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
    Plot { name: "error-spectrum", draw: spectrum::spectrum },
    Plot { name: "error-spread", draw: spread::spread },
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

/// Slope of the error √relMSE over time, as it appears on logarithmic axes: `−0.49 ± 0.01`. Errors below 0.01 are shown as 0.01.
///
/// - `slope`: exponent s of √relMSE ∝ timeˢ, and its standard error
pub fn slope((slope, deviation): (f64, f64)) -> String {
    let size = format!("{:.2}", slope.abs());
    let sign = if slope < 0.0 && size != "0.00" { "−" } else { "" };
    // "± 0.00" would claim an exact slope.
    format!("{sign}{size} ± {:.2}", deviation.max(0.01))
}

/// Time with its interval: `14 s (12 s–17 s)`, with `≈` before extrapolated ones and `<` before bounds.
pub fn price(cost: &Cost) -> String {
    match cost.kind {
        CostKind::AtMost => time(cost),
        _ => format!("{} ({})", time(cost), format::between(cost.low, cost.high)),
    }
}

/// Time without its interval.
pub fn time(cost: &Cost) -> String {
    let sign = match cost.kind {
        CostKind::Measured => "",
        CostKind::Extrapolated => "≈ ",
        CostKind::AtMost => "< ",
    };
    format!("{sign}{}", format::duration(cost.seconds))
}

/// Time of a method to one of the targets, or the reason why none is stated.
pub fn price_of(method: &Method, i: usize) -> Result<Cost, &'static str> {
    method.prices.get(i).map_or(Err("–"), |price| price.map_err(NoPrice::name))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slope has the sign of the curve that the eye sees, and 0 has none.
    #[test]
    fn slopes_have_the_sign_of_their_curve() {
        let told = [(-0.488, 0.01), (0.64, 0.05), (-0.001, 0.2), (-0.51, 0.83)].map(slope);
        assert_eq!(told, ["−0.49 ± 0.01", "0.64 ± 0.05", "0.00 ± 0.20", "−0.51 ± 0.83"]);
    }
}
