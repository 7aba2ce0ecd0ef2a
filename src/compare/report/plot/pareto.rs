//! Plot of time against error for all methods, with the Pareto front: the least error that any method has reached at each time.

use super::curves::hint;
use super::drawing::{Color, Dashes, Drawing, Point};
use super::envelope::{Piece, envelope};
use super::error_curve::{ErrorPoint, error_curve};
use super::frame::{Entry, Format, Frame, Quantity};
use crate::compare::{Comparison, Method};
use crate::measure::format;

/// Draws the Pareto front. It has the colour of the best method, and its interval as a band.
pub fn front(comparison: &Comparison, format: Format) -> Drawing {
    let curves: Vec<Vec<ErrorPoint>> = comparison.methods.iter().map(|method| error_curve(method, comparison.confidence)).collect();
    let pieces = envelope(&curves);
    let points: Vec<Point> = curves.iter().flatten().map(|c| [c.seconds, c.error]).collect();
    let entry = |(index, method): (usize, &Method)| Entry { index, text: method.name.clone() };
    let legend: Vec<Entry> = comparison.methods.iter().enumerate().map(entry).collect();
    let mut frame = Frame::new(format, "The best for the time: Pareto front", &legend, Quantity::Seconds, &points);
    beaten(&mut frame, &pieces);
    for (index, curve) in curves.iter().enumerate() {
        let points = curve.iter().map(|c| frame.place([c.seconds, c.error])).collect();
        frame.drawing.line(points, Color::Method(index), 1.0, Dashes::Short);
    }
    for Piece { curve, ends: [start, end] } in &pieces {
        let place = |c: &ErrorPoint, error: f64| frame.place([c.seconds, error]);
        let band = vec![place(start, start.high), place(end, end.high), place(end, end.low), place(start, start.low)];
        let line = vec![place(start, start.error), place(end, end.error)];
        frame.drawing.area(band, Color::Method(*curve), 0.18, "");
        frame.drawing.line(line, Color::Method(*curve), 3.0, Dashes::None);
    }
    let radius = 0.32 * format.font_size;
    for (index, curve) in curves.iter().enumerate() {
        for c in curve {
            let at = frame.place([c.seconds, c.error]);
            let is_best = pieces.iter().any(|piece| piece.curve == index && piece.ends.contains(c));
            let opacity = if is_best { 1.0 } else { 0.3 };
            frame.drawing.symbol(index, at, radius, opacity, hint(&comparison.methods[index].name, c));
        }
    }
    frame.drawing.description = describe(comparison, &pieces);
    frame.drawing
}

/// Shades the area above the front, where something better is known, and joins the pieces by a thin line.
fn beaten(frame: &mut Frame, pieces: &[Piece]) {
    let Some((first, last)) = pieces.first().zip(pieces.last()) else { return };
    let mut points = vec![[frame.x.at(first.ends[0].seconds), frame.top]];
    for end in pieces.iter().flat_map(|piece| piece.ends) {
        points.push(frame.place([end.seconds, end.error]));
    }
    points.push([frame.right, frame.y.at(last.ends[1].error)]);
    frame.drawing.line(points.clone(), Color::Muted, 1.0, Dashes::None);
    points.push([frame.right, frame.top]);
    frame.drawing.area(points, Color::Muted, 0.08, "");
}

/// The best methods in words: `path from 4 ms (200 %), nee from 19 ms (30 %) to 1.5 s (3 %)`.
fn describe(comparison: &Comparison, pieces: &[Piece]) -> String {
    let told = |c: &ErrorPoint| format!("{} ({} %)", format::duration(c.seconds), format::per_cent(c.error));
    let owners = pieces.chunk_by(|a, b| a.curve == b.curve).filter_map(|run| run.first());
    let each: Vec<String> = owners.map(|piece| format!("{} from {}", comparison.methods[piece.curve].name, told(&piece.ends[0]))).collect();
    let end = pieces.last().map_or(String::new(), |piece| format!(" to {}", told(&piece.ends[1])));
    format!("Pareto front of time against error: {}{end}.", each.join(", "))
}
