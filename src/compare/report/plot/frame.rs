//! What the plots of errors share: title, legend, axes, and room for the curves.

use super::axis::Axis;
use super::drawing::{Anchor, Dashes, Drawing, Ink, Spot};
use crate::measure::words;

/// How large a plot is, and its letters.
#[derive(Clone, Copy, PartialEq)]
pub struct Format {
    pub width: f64,
    pub height: f64,
    pub letters: f64,
}

/// For a desktop's window, a slide, a page.
pub const WIDE: Format = Format { width: 640.0, height: 430.0, letters: 13.0 };
/// For a phone's.
pub const NARROW: Format = Format { width: 350.0, height: 340.0, letters: 12.0 };

/// A line of the legend: the method's symbol and words.
pub struct Entry {
    pub place: usize,
    pub text: String,
}

/// What an axis measures.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    Samples,
    Seconds,
    Error,
}

impl Quantity {
    fn title(self) -> &'static str {
        match self {
            Quantity::Samples => "samples per pixel",
            Quantity::Seconds => "time of rendering",
            Quantity::Error => "relative error √relMSE",
        }
    }

    pub fn label(self, value: f64) -> String {
        match self {
            Quantity::Samples if value >= 1e4 => format!("{:.0}k", value / 1024.0),
            Quantity::Samples => format!("{value}"),
            // 10 min 00 s is 10 min.
            Quantity::Seconds => words::duration(value).trim_end_matches(" 00 s").trim_end_matches(" 00 min").into(),
            Quantity::Error => format!("{} %", words::per_cent(value)),
        }
    }
}

/// A drawing with axes.
pub struct Frame {
    pub drawing: Drawing,
    pub x: Axis,
    pub y: Axis,
    pub format: Format,
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

impl Frame {
    /// Title, legend, grid and labels; the axes hold all `points`, given as values.
    pub fn new(format: Format, title: &str, legend: &[Entry], across: Quantity, points: &[Spot]) -> Frame {
        let Format { width, height, letters } = format;
        let mut drawing = Drawing::new(width, height);
        drawing.text([0.0, letters + 3.0], title, Ink::Text, letters + 2.0, Anchor::Start);
        let under = draw_legend(&mut drawing, format, legend, 2.4 * letters + 4.0);
        let (left, right) = (4.2 * letters, width - 8.0);
        let (top, bottom) = (under + 3.0 * letters, height - 3.2 * letters);
        let x = Axis::over(points.iter().map(|p| p[0]), [left, right]);
        let y = Axis::over(points.iter().map(|p| p[1]), [bottom, top]);
        let mut frame = Frame { drawing, x, y, format, left, right, top, bottom };
        frame.draw_axes(across);
        frame
    }

    fn draw_axes(&mut self, across: Quantity) {
        let letters = self.format.letters;
        let room = (self.right - self.left) / (4.6 * letters);
        let ticks = match across {
            Quantity::Samples => self.x.doublings(room as usize),
            Quantity::Seconds => self.x.times(room as usize),
            Quantity::Error => self.x.ticks(room as usize),
        };
        for tick in ticks {
            let x = self.x.at(tick);
            self.drawing.line(vec![[x, self.top], [x, self.bottom]], Ink::Grid, 1.0, Dashes::None);
            self.drawing.text([x, self.bottom + 1.4 * letters], across.label(tick), Ink::Muted, letters, Anchor::Middle);
        }
        let rows = (self.bottom - self.top) / (2.6 * letters);
        for tick in self.y.ticks(rows as usize) {
            let y = self.y.at(tick);
            self.drawing.line(vec![[self.left, y], [self.right, y]], Ink::Grid, 1.0, Dashes::None);
            let label = Quantity::Error.label(tick);
            self.drawing.text([self.left - 8.0, y + 0.35 * letters], label, Ink::Muted, letters, Anchor::End);
        }
        self.drawing.text([self.right, self.bottom + 2.9 * letters], across.title(), Ink::Muted, letters, Anchor::End);
        self.drawing.text([0.0, self.top - 0.8 * letters], Quantity::Error.title(), Ink::Muted, letters, Anchor::Start);
    }

    pub fn place(&self, [x, y]: Spot) -> Spot {
        [self.x.at(x), self.y.at(y)]
    }
}

/// Entries side by side, as many to a row as fit; returns where the last row ends.
fn draw_legend(drawing: &mut Drawing, format: Format, legend: &[Entry], top: f64) -> f64 {
    let (letters, gap) = (format.letters, 1.6 * format.letters);
    let mut pen = [0.0, top + letters];
    for Entry { place, text } in legend {
        let width = 1.4 * letters + Drawing::width_of(text, letters);
        if pen[0] > 0.0 && pen[0] + width > format.width {
            pen = [0.0, pen[1] + 1.6 * letters];
        }
        drawing.symbol(*place, [pen[0] + 0.55 * letters, pen[1] - 0.35 * letters], 0.36 * letters, 1.0, "");
        drawing.text([pen[0] + 1.4 * letters, pen[1]], text, Ink::Text, letters, Anchor::Start);
        pen[0] += width + gap;
    }
    if legend.is_empty() { top } else { pen[1] }
}
