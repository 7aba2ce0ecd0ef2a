//! The plots of a report.

mod axis;
mod bars;
mod course;
mod curves;
mod drawing;
mod frame;
mod letters;
mod pareto;
mod raster;
mod svg;

use super::Files;
use crate::compare::{Comparison, Cost, Method};
use crate::error::Result;
use crate::measure::words;

pub use course::course;
use drawing::Drawing;
use frame::{Format, NARROW, WIDE};

/// A plot and the stem of its files.
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

/// All plots as SVG and as PNG.
pub fn files(comparison: &Comparison) -> Result<Files> {
    let mut files = Files::new();
    for plot in ALL {
        let drawing = (plot.draw)(comparison, WIDE);
        files.push((format!("plots/{}.svg", plot.name).into(), svg::file(&drawing)));
        files.push((format!("plots/{}.png", plot.name).into(), raster::png(&drawing)?));
    }
    Ok(files)
}

/// All plots for a page, each once for wide windows and once for narrow ones.
pub fn elements(comparison: &Comparison) -> Vec<[String; 2]> {
    ALL.iter().map(|plot| [WIDE, NARROW].map(|format| svg::element(&(plot.draw)(comparison, format)))).collect()
}

/// `−0.98 ± 0.02`: how relMSE follows time.
pub fn slope((b, deviation): (f64, f64)) -> String {
    let sign = if b > 0.0 { "−" } else { "" };
    format!("{sign}{:.2} ± {:.2}", b.abs(), deviation)
}

/// `14 s (12 s–17 s)`, foretold ones with `≈`.
pub fn price(cost: &Cost) -> String {
    let (seconds, interval) = (words::duration(cost.seconds), words::between(cost.low, cost.high));
    format!("{}{seconds} ({interval})", if cost.extrapolated { "≈ " } else { "" })
}

/// Why no time buys this error.
pub fn unpriced(method: &Method, target: f64) -> String {
    if method.bias.is_some_and(|(bias, _)| bias >= target) { "never: bias".into() } else { "not known".into() }
}
