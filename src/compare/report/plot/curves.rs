//! Error against samples, and against time.

use super::course::{Checkpoint, course};
use super::drawing::{Anchor, Dashes, Drawing, Ink, Spot};
use super::frame::{Entry, Format, Frame, Quantity};
use crate::compare::{Comparison, Method};
use crate::measure::words;

pub fn against_samples(comparison: &Comparison, format: Format) -> Drawing {
    draw(comparison, format, "Error against samples", Quantity::Samples)
}

pub fn against_time(comparison: &Comparison, format: Format) -> Drawing {
    draw(comparison, format, "Error against time", Quantity::Seconds)
}

fn draw(comparison: &Comparison, format: Format, title: &str, across: Quantity) -> Drawing {
    let courses: Vec<Vec<Checkpoint>> = comparison.methods.iter().map(|method| course(method, comparison.confidence)).collect();
    let x = |checkpoint: &Checkpoint| if across == Quantity::Samples { checkpoint.samples } else { checkpoint.seconds };
    let biases = comparison.methods.iter().filter_map(|method| method.bias).map(|(bias, _)| bias);
    let points = extent(&courses, x, biases);
    let legend: Vec<Entry> = comparison.methods.iter().enumerate().map(|(place, method)| Entry { place, text: name(method) }).collect();
    let mut frame = Frame::new(format, title, &legend, across, &points);
    guide(&mut frame);
    for (place, course) in courses.iter().enumerate() {
        band(&mut frame, place, course, x);
    }
    plateaus(&mut frame, comparison);
    for (place, (course, method)) in courses.iter().zip(&comparison.methods).enumerate() {
        curve(&mut frame, place, course, x, &method.name);
    }
    frame.drawing.description = describe(comparison, &courses, title);
    frame.drawing
}

/// Values that the axes must hold: the points, and of their intervals what does not dwarf them.
fn extent(courses: &[Vec<Checkpoint>], x: impl Fn(&Checkpoint) -> f64, biases: impl Iterator<Item = f64>) -> Vec<Spot> {
    let checkpoints = || courses.iter().flatten();
    let ends = |c: &Checkpoint| [[x(c), c.error], [x(c), c.low.max(0.5 * c.error)], [x(c), c.high.min(2.0 * c.error)]];
    let anywhere = checkpoints().next().map_or(1.0, &x);
    checkpoints().flat_map(ends).chain(biases.map(|bias| [anywhere, bias])).collect()
}

/// `nee: slope −0.98 ± 0.02`
fn name(method: &Method) -> String {
    match method.slope {
        Some(slope) => format!("{}: slope {}", method.name, super::slope(slope)),
        None => method.name.clone(),
    }
}

/// How steeply plain Monte Carlo falls: half the error for four times the work.
fn guide(frame: &mut Frame) {
    let [left, right] = [frame.left, frame.right].map(|pixel| frame.x.value(pixel));
    // Through the middle of the picture, in the lower left, where no curve is.
    let start = frame.y.value(frame.top + 0.75 * (frame.bottom - frame.top));
    let end = frame.y.value(frame.bottom);
    let across = (right / left).min((start / end).powi(2));
    let points = vec![frame.place([left, start]), frame.place([left * across, start / across.sqrt()])];
    frame.drawing.line(points.clone(), Ink::Muted, 1.0, Dashes::Short);
    let letters = frame.format.letters - 1.0;
    let at = [frame.left + 6.0, frame.bottom - 0.6 * letters];
    frame.drawing.text(at, "½ error for 4 × work", Ink::Muted, letters, Anchor::Start);
}

fn band(frame: &mut Frame, place: usize, course: &[Checkpoint], x: impl Fn(&Checkpoint) -> f64) {
    let upper = course.iter().map(|c| frame.place([x(c), c.high]));
    let lower = course.iter().rev().map(|c| frame.place([x(c), c.low]));
    let points: Vec<Spot> = upper.chain(lower).collect();
    if points.len() > 2 {
        frame.drawing.area(points, Ink::Method(place), 0.18, "");
    }
}

/// A line that the curve cannot cross, however long one waits. Labels that would touch move apart.
fn plateaus(frame: &mut Frame, comparison: &Comparison) {
    let letters = frame.format.letters - 1.0;
    let mut biased: Vec<(usize, &Method, f64)> =
        comparison.methods.iter().enumerate().filter_map(|(i, m)| m.bias.map(|bias| (i, m, bias.0))).collect();
    biased.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut above = frame.top;
    for (place, method, bias) in biased {
        let y = frame.y.at(bias);
        frame.drawing.line(vec![[frame.left, y], [frame.right, y]], Ink::Method(place), 1.5, Dashes::Long);
        let text = format!("bias of {}: {} %", method.name, words::per_cent(bias));
        // Below the line, where its own curve never is.
        let baseline = (y + 1.15 * letters).max(above + 1.1 * letters);
        frame.drawing.text([frame.left + 6.0, baseline], text, Ink::Text, letters, Anchor::Start);
        above = baseline;
    }
}

fn curve(frame: &mut Frame, place: usize, course: &[Checkpoint], x: impl Fn(&Checkpoint) -> f64, name: &str) {
    let points: Vec<Spot> = course.iter().map(|c| frame.place([x(c), c.error])).collect();
    frame.drawing.line(points.clone(), Ink::Method(place), 2.0, Dashes::None);
    for (point, checkpoint) in points.into_iter().zip(course) {
        frame.drawing.symbol(place, point, 0.32 * frame.format.letters, 1.0, hint(name, checkpoint));
    }
}

/// `nee: 64 samples, 1.2 s, 3.1 % (2.9–3.3 %)`
pub fn hint(name: &str, c: &Checkpoint) -> String {
    let [error, low, high] = [c.error, c.low, c.high].map(words::per_cent);
    format!("{name}: {} samples, {}, {error} % ({low}–{high} %)", c.samples, words::duration(c.seconds))
}

fn describe(comparison: &Comparison, courses: &[Vec<Checkpoint>], title: &str) -> String {
    let one = |(method, course): (&Method, &Vec<Checkpoint>)| {
        let [first, last] = [course.first(), course.last()].map(|c| c.map_or("–".into(), |c| hint("", c)));
        format!("{} from{} to{}", method.name, first.trim_start_matches(':'), last.trim_start_matches(':'))
    };
    let each: Vec<String> = comparison.methods.iter().zip(courses).map(one).collect();
    format!("{title}, both axes logarithmic. {}.", each.join("; "))
}
