//! Common parts of the error plots: title, legend, axes, and room for the curves.

use super::axis::Axis;
use super::drawing::{Anchor, Color, Dashes, Drawing, Point};
use super::font;
use crate::measure::format;

/// Size of a plot and of its text (CSS pixels).
#[derive(Clone, Copy, PartialEq)]
pub struct Format {
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
    /// Size of the text.
    pub font_size: f64,
}

/// Format for a desktop window, a slide, a page.
pub const WIDE: Format = Format { width: 640.0, height: 430.0, font_size: 13.0 };
/// Format for a phone.
pub const NARROW: Format = Format { width: 350.0, height: 340.0, font_size: 12.0 };

/// Entry of the legend: the symbol of a method, and a text.
pub struct Entry {
    /// Index of the method.
    pub index: usize,
    /// Text of the entry.
    pub text: String,
}

/// Quantity of an axis.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Samples per pixel.
    Samples,
    /// Render time.
    Seconds,
    /// Relative error √relMSE.
    Error,
    /// Period of errors.
    Period,
}

impl Quantity {
    fn title(self) -> &'static str {
        match self {
            Quantity::Samples => "samples per pixel",
            Quantity::Seconds => "time of rendering",
            Quantity::Error => "relative error √relMSE",
            Quantity::Period => "period of the error (pixels)",
        }
    }

    /// Title of the vertical axis of a plot over this quantity.
    fn upright_title(self) -> &'static str {
        match self {
            Quantity::Period => "error √P, relative to the mean brightness",
            _ => Quantity::Error.title(),
        }
    }

    /// Label of a tick.
    pub fn label(self, value: f64) -> String {
        match self {
            Quantity::Samples if value >= 1e4 => format!("{:.0}k", value / 1024.0),
            Quantity::Samples | Quantity::Period => format!("{value}"),
            // 10 min 00 s is written as 10 min.
            Quantity::Seconds => format::duration(value).trim_end_matches(" 00 s").trim_end_matches(" 00 min").into(),
            Quantity::Error => format!("{} %", format::per_cent(value)),
        }
    }
}

/// Drawing with axes.
pub struct Frame {
    /// The drawing.
    pub drawing: Drawing,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Size of the plot.
    pub format: Format,
    /// Left edge of the area for curves.
    pub left: f64,
    /// Right edge of the area for curves.
    pub right: f64,
    /// Upper edge of the area for curves.
    pub top: f64,
    /// Lower edge of the area for curves.
    pub bottom: f64,
}

impl Frame {
    /// Draws title, legend, grid and labels; the axes hold all `points`, given as values.
    pub fn new(format: Format, title: &str, legend: &[Entry], across: Quantity, points: &[Point]) -> Frame {
        let Format { width, height, font_size } = format;
        let mut drawing = Drawing::new(width, height);
        drawing.text([0.0, font_size + 3.0], title, Color::Text, font_size + 2.0, Anchor::Start);
        let under = draw_legend(&mut drawing, format, legend, 2.4 * font_size + 4.0);
        let (left, right) = (4.2 * font_size, width - 8.0);
        let (top, bottom) = (under + 3.0 * font_size, height - 3.2 * font_size);
        let x = Axis::over(points.iter().map(|p| p[0]), [left, right]);
        let y = Axis::over(points.iter().map(|p| p[1]), [bottom, top]);
        let mut frame = Frame { drawing, x, y, format, left, right, top, bottom };
        frame.draw_axes(across);
        frame
    }

    fn draw_axes(&mut self, across: Quantity) {
        let font_size = self.format.font_size;
        let room = (self.right - self.left) / (4.6 * font_size);
        let ticks = match across {
            Quantity::Samples | Quantity::Period => self.x.doublings(room as usize),
            Quantity::Seconds => self.x.times(room as usize),
            Quantity::Error => self.x.ticks(room as usize),
        };
        for tick in ticks {
            let x = self.x.at(tick);
            self.drawing.line(vec![[x, self.top], [x, self.bottom]], Color::Grid, 1.0, Dashes::None);
            self.drawing.text([x, self.bottom + 1.4 * font_size], across.label(tick), Color::Muted, font_size, Anchor::Middle);
        }
        let rows = (self.bottom - self.top) / (2.6 * font_size);
        for tick in self.y.ticks(rows as usize) {
            let y = self.y.at(tick);
            self.drawing.line(vec![[self.left, y], [self.right, y]], Color::Grid, 1.0, Dashes::None);
            let label = Quantity::Error.label(tick);
            self.drawing.text([self.left - 8.0, y + 0.35 * font_size], label, Color::Muted, font_size, Anchor::End);
        }
        self.drawing.text([self.right, self.bottom + 2.9 * font_size], across.title(), Color::Muted, font_size, Anchor::End);
        self.drawing.text([0.0, self.top - 0.8 * font_size], across.upright_title(), Color::Muted, font_size, Anchor::Start);
    }

    /// Converts values to pixels.
    pub fn place(&self, [x, y]: Point) -> Point {
        [self.x.at(x), self.y.at(y)]
    }
}

/// Draws the legend with as many entries to a row as fit, and returns the lower end of the last row.
fn draw_legend(drawing: &mut Drawing, format: Format, legend: &[Entry], top: f64) -> f64 {
    let (font_size, gap) = (format.font_size, 1.6 * format.font_size);
    let mut pen = [0.0, top + font_size];
    for Entry { index, text } in legend {
        let width = 1.4 * font_size + font::width_in_any_font(text, font_size);
        if pen[0] > 0.0 && pen[0] + width > format.width {
            pen = [0.0, pen[1] + 1.6 * font_size];
        }
        drawing.symbol(*index, [pen[0] + 0.55 * font_size, pen[1] - 0.35 * font_size], 0.36 * font_size, 1.0, "");
        drawing.text([pen[0] + 1.4 * font_size, pen[1]], text, Color::Text, font_size, Anchor::Start);
        pen[0] += width + gap;
    }
    if legend.is_empty() { top } else { pen[1] }
}
