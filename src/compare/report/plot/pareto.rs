//! Plot of time against error for all methods. The Pareto front holds the points for which no other point has both less time and less
//! error.

use super::curves::hint;
use super::drawing::{Color, Dashes, Drawing, Point};
use super::error_curve::{ErrorPoint, error_curve};
use super::frame::{Entry, Format, Frame, Quantity};
use crate::compare::Comparison;

/// Index of a method, and one of its checkpoints.
type Candidate = (usize, ErrorPoint);

/// Draws the Pareto front.
pub fn front(comparison: &Comparison, format: Format) -> Drawing {
    let of = |(index, method)| error_curve(method, comparison.confidence).into_iter().map(move |c| (index, c));
    let all: Vec<Candidate> = comparison.methods.iter().enumerate().flat_map(of).collect();
    let best = unbeaten(&all);
    let points: Vec<Point> = all.iter().map(|(_, c)| [c.seconds, c.error]).collect();
    let entry = |(index, method): (usize, &crate::compare::Method)| Entry { index, text: method.name.clone() };
    let legend: Vec<Entry> = comparison.methods.iter().enumerate().map(entry).collect();
    let mut frame = Frame::new(format, "The best for the time: Pareto front", &legend, Quantity::Seconds, &points);
    stairs(&mut frame, &best);
    let name = |index: usize| &comparison.methods[index].name;
    let radius = 0.36 * format.font_size;
    for (index, c) in &all {
        let (at, is_best) = (frame.place([c.seconds, c.error]), best.iter().any(|(p, b)| p == index && b == c));
        let (size, opacity) = if is_best { (radius, 1.0) } else { (0.8 * radius, 0.3) };
        frame.drawing.symbol(*index, at, size, opacity, hint(name(*index), c));
    }
    let each: Vec<String> = best.iter().map(|(index, c)| hint(name(*index), c)).collect();
    frame.drawing.description = format!("Pareto front of time against error: {}.", each.join("; "));
    frame.drawing
}

/// Points of the front in order of time: each has a smaller error than all faster ones.
fn unbeaten(all: &[Candidate]) -> Vec<Candidate> {
    let mut sorted = all.to_vec();
    sorted.sort_by(|(_, a), (_, b)| a.seconds.total_cmp(&b.seconds).then(a.error.total_cmp(&b.error)));
    let mut best: Vec<Candidate> = vec![];
    for candidate in sorted {
        if best.last().is_none_or(|(_, last)| candidate.1.error < last.error) {
            best.push(candidate);
        }
    }
    best
}

/// Draws the front as steps: between two points the earlier one is the best.
fn stairs(frame: &mut Frame, best: &[Candidate]) {
    let mut points: Vec<Point> = vec![];
    for (_, c) in best {
        let at = frame.place([c.seconds, c.error]);
        let before = points.last().map_or([at[0], frame.top], |last: &Point| [at[0], last[1]]);
        points.extend([before, at]);
    }
    if let Some(last) = points.last().copied() {
        points.push([frame.right, last[1]]);
    }
    // The area above is beaten.
    let mut beaten = points.clone();
    if !beaten.is_empty() {
        beaten.push([frame.right, frame.top]);
    }
    frame.drawing.area(beaten, Color::Muted, 0.08, "");
    frame.drawing.line(points, Color::Text, 1.5, Dashes::None);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_beats_all_others() {
        let at = |seconds, error| (0, ErrorPoint { samples: 1.0, seconds, error, low: error, high: error });
        let all = [at(4.0, 0.1), at(1.0, 0.3), at(2.0, 0.4), at(3.0, 0.1), at(8.0, 0.05), at(1.0, 0.5)];
        assert_eq!(unbeaten(&all), [at(1.0, 0.3), at(3.0, 0.1), at(8.0, 0.05)]);
    }
}
