//! Plot of the spectrum of the errors: how strong they are at short and at long periods.

use super::drawing::{Color, Dashes, Drawing, Point};
use super::error_curve::quantile;
use super::frame::{Entry, Format, Frame, Quantity};
use crate::compare::{Comparison, Method, Ring};
use crate::measure::format::{self, per_cent};

/// Strength of the errors at a period, with its interval.
struct Strength {
    period: f64,
    /// √P
    value: f64,
    low: f64,
    high: f64,
}

/// Greatest logarithm of the ratio of an end of an interval to its middle: a factor of ten.
const WIDEST: f64 = std::f64::consts::LN_10;

/// Draws √P over the period for all methods.
pub fn spectrum(comparison: &Comparison, format: Format) -> Drawing {
    let curves: Vec<Vec<Strength>> = comparison.methods.iter().map(|method| strengths(method, comparison.confidence)).collect();
    let ends = |s: &Strength| [[s.period, s.value], [s.period, s.low.max(0.5 * s.value)], [s.period, s.high.min(2.0 * s.value)]];
    let points: Vec<Point> = curves.iter().flatten().flat_map(ends).collect();
    let entry = |(index, method): (usize, &Method)| Entry { index, text: method.name.clone() };
    let legend: Vec<Entry> = comparison.methods.iter().enumerate().map(entry).collect();
    let title = "Spectrum of the errors at the end: flat where pixels err independently";
    let title = if format.width < 500.0 { "Spectrum of the errors at the end" } else { title };
    let mut frame = Frame::new(format, title, &legend, Quantity::Period, &points);
    for (index, curve) in curves.iter().enumerate() {
        let upper = curve.iter().map(|s| frame.place([s.period, s.high]));
        let lower = curve.iter().rev().map(|s| frame.place([s.period, s.low]));
        let band: Vec<Point> = upper.chain(lower).collect();
        if band.len() > 2 {
            frame.drawing.area(band, Color::Method(index), 0.18, "");
        }
    }
    for (index, (curve, method)) in curves.iter().zip(&comparison.methods).enumerate() {
        let points: Vec<Point> = curve.iter().map(|s| frame.place([s.period, s.value])).collect();
        frame.drawing.line(points.clone(), Color::Method(index), 2.0, Dashes::None);
        for (point, strength) in points.into_iter().zip(curve) {
            frame.drawing.symbol(index, point, 0.32 * format.font_size, 1.0, format!("{}: {}", method.name, hint(strength)));
        }
    }
    frame.drawing.description = describe(comparison, &curves);
    frame.drawing
}

/// Rings whose power is above its standard error; others are not told from the noise of the reference.
fn strengths(method: &Method, confidence: f64) -> Vec<Strength> {
    let replicates = method.measurements.iter().map(|m| m.replicate + 1).max().unwrap_or(0) as usize;
    let strength = |ring: &Ring| {
        // The interval is one of the logarithm, so that it stays positive.
        let reach = 0.5 * quantile(0.5 + 0.5 * confidence, replicates) * ring.deviation / ring.power;
        let reach = if reach.is_finite() { reach.min(WIDEST) } else { 0.0 };
        let value = ring.power.sqrt();
        Strength { period: ring.period, value, low: value * (-reach).exp(), high: value * reach.exp() }
    };
    method.spectrum.iter().filter(|ring| ring.power > ring.deviation).map(strength).collect()
}

/// `a period of 2.4 pixels, 3.1 % (2.9–3.3 %)`
fn hint(s: &Strength) -> String {
    let [value, low, high] = [s.value, s.low, s.high].map(per_cent);
    format!("a period of {} pixels, {value} % ({low}–{high} %)", format::two_digits(s.period))
}

fn describe(comparison: &Comparison, curves: &[Vec<Strength>]) -> String {
    let one = |(method, curve): (&Method, &Vec<Strength>)| {
        let [first, last] = [curve.first(), curve.last()].map(|s| s.map_or("nothing".into(), hint));
        format!("{} from {first} to {last}", method.name)
    };
    let each: Vec<String> = comparison.methods.iter().zip(curves).map(one).collect();
    format!("Strength of the errors against their period, both axes logarithmic. {}.", each.join("; "))
}
