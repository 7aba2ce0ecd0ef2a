//! Curves of error over samples, and over time.

use super::drawing::{Anchor, Color, Dashes, Drawing, Point};
use super::error_curve::{ErrorPoint, error_curve};
use super::frame::{Entry, Format, Frame, Quantity};
use crate::compare::{Comparison, Method};
use crate::measure::format;

/// Draws error over samples.
pub fn against_samples(comparison: &Comparison, format: Format) -> Drawing {
    draw(comparison, format, "Error against samples", Quantity::Samples)
}

/// Draws error over time.
pub fn against_time(comparison: &Comparison, format: Format) -> Drawing {
    draw(comparison, format, "Error against time", Quantity::Seconds)
}

fn draw(comparison: &Comparison, format: Format, title: &str, across: Quantity) -> Drawing {
    let mut curves: Vec<Vec<ErrorPoint>> = comparison.methods.iter().map(|method| error_curve(method, comparison.confidence)).collect();
    if across == Quantity::Samples {
        curves.iter_mut().for_each(|curve| curve.retain(|checkpoint| checkpoint.samples.is_some()));
    }
    let x = |checkpoint: &ErrorPoint| match across {
        Quantity::Samples => checkpoint.samples.unwrap_or(1.0),
        _ => checkpoint.seconds,
    };
    let biases = comparison.methods.iter().filter_map(|method| method.bias).map(|(bias, _)| bias);
    let points = extent(&curves, x, biases);
    let legend: Vec<Entry> = comparison.methods.iter().enumerate().map(|(index, method)| Entry { index, text: name(method) }).collect();
    let mut frame = Frame::new(format, title, &legend, across, &points);
    for (index, error_curve) in curves.iter().enumerate() {
        band(&mut frame, index, error_curve, x);
    }
    let free_below = plateaus(&mut frame, comparison);
    guide(&mut frame, free_below);
    for (index, (error_curve, method)) in curves.iter().zip(&comparison.methods).enumerate() {
        curve(&mut frame, index, error_curve, x, &method.name);
    }
    frame.drawing.description = describe(comparison, &curves, title);
    frame.drawing
}

/// Values that the axes must hold: the points, and the part of their intervals within a factor of two.
fn extent(curves: &[Vec<ErrorPoint>], x: impl Fn(&ErrorPoint) -> f64, biases: impl Iterator<Item = f64>) -> Vec<Point> {
    let checkpoints = || curves.iter().flatten();
    let ends = |c: &ErrorPoint| [[x(c), c.error], [x(c), c.low.max(0.5 * c.error)], [x(c), c.high.min(2.0 * c.error)]];
    let anywhere = checkpoints().next().map_or(1.0, &x);
    checkpoints().flat_map(ends).chain(biases.map(|bias| [anywhere, bias])).collect()
}

/// Label of a method with its slope: `nee: slope −0.49 ± 0.01`.
fn name(method: &Method) -> String {
    match method.slope {
        Some(slope) => format!("{}: slope {}", method.name, super::slope(slope)),
        None => method.name.clone(),
    }
}

/// Draws the slope of plain Monte Carlo: half the error for four times the work. It is left out if its label has no room below
/// `free_below`.
fn guide(frame: &mut Frame, free_below: f64) {
    let font_size = frame.format.font_size - 1.0;
    let at = [frame.left + 6.0, frame.bottom - 0.6 * font_size];
    if at[1] < free_below + 1.1 * font_size {
        return;
    }
    let [left, right] = [frame.left, frame.right].map(|pixel| frame.x.value(pixel));
    // The line is in the lower left, where no curve is.
    let start = frame.y.value(frame.top + 0.75 * (frame.bottom - frame.top));
    let end = frame.y.value(frame.bottom);
    let across = (right / left).min((start / end).powi(2));
    let points = vec![frame.place([left, start]), frame.place([left * across, start / across.sqrt()])];
    frame.drawing.line(points.clone(), Color::Muted, 1.0, Dashes::Short);
    frame.drawing.text(at, "½ error for 4 × work", Color::Muted, font_size, Anchor::Start);
}

fn band(frame: &mut Frame, index: usize, error_curve: &[ErrorPoint], x: impl Fn(&ErrorPoint) -> f64) {
    let upper = error_curve.iter().map(|c| frame.place([x(c), c.high]));
    let lower = error_curve.iter().rev().map(|c| frame.place([x(c), c.low]));
    let points: Vec<Point> = upper.chain(lower).collect();
    if points.len() > 2 {
        frame.drawing.area(points, Color::Method(index), 0.18, "");
    }
}

/// Draws the bias of each method as a line that its curve never crosses. Labels that would overlap are moved apart.
/// Returns the baseline of the lowest label.
fn plateaus(frame: &mut Frame, comparison: &Comparison) -> f64 {
    let font_size = frame.format.font_size - 1.0;
    let mut biased: Vec<(usize, &Method, f64)> =
        comparison.methods.iter().enumerate().filter_map(|(i, m)| m.bias.map(|bias| (i, m, bias.0))).collect();
    biased.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut above = frame.top;
    for (index, method, bias) in biased {
        let y = frame.y.at(bias);
        frame.drawing.line(vec![[frame.left, y], [frame.right, y]], Color::Method(index), 1.5, Dashes::Long);
        let text = format!("bias of {}: {} %", method.name, format::per_cent(bias));
        // The label is below the line, where the method's own curve never is.
        let baseline = (y + 1.15 * font_size).max(above + 1.1 * font_size);
        frame.drawing.text([frame.left + 6.0, baseline], text, Color::Text, font_size, Anchor::Start);
        above = baseline;
    }
    above
}

fn curve(frame: &mut Frame, index: usize, error_curve: &[ErrorPoint], x: impl Fn(&ErrorPoint) -> f64, name: &str) {
    let points: Vec<Point> = error_curve.iter().map(|c| frame.place([x(c), c.error])).collect();
    frame.drawing.line(points.clone(), Color::Method(index), 2.0, Dashes::None);
    for (point, checkpoint) in points.into_iter().zip(error_curve) {
        frame.drawing.symbol(index, point, 0.32 * frame.format.font_size, 1.0, hint(name, checkpoint));
    }
}

/// Text of a point: `nee: 64 samples, 1.2 s, 3.1 % (2.9–3.3 %)`.
pub fn hint(name: &str, c: &ErrorPoint) -> String {
    let [error, low, high] = [c.error, c.low, c.high].map(format::per_cent);
    let samples = c.samples.map_or(String::new(), |samples| format!("{samples} samples, "));
    format!("{name}: {samples}{}, {error} % ({low}–{high} %)", format::duration(c.seconds))
}

fn describe(comparison: &Comparison, curves: &[Vec<ErrorPoint>], title: &str) -> String {
    let one = |(method, error_curve): (&Method, &Vec<ErrorPoint>)| {
        let [first, last] = [error_curve.first(), error_curve.last()].map(|c| c.map_or("–".into(), |c| hint("", c)));
        format!("{} from{} to{}", method.name, first.trim_start_matches(':'), last.trim_start_matches(':'))
    };
    let each: Vec<String> = comparison.methods.iter().zip(curves).map(one).collect();
    format!("{title}, both axes logarithmic. {}.", each.join("; "))
}
