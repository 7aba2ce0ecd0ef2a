//! Plots as PNG. Every mark is a set of outlines, filled by the share of a pixel that they cover.

use ab_glyph_rasterizer::{Rasterizer, point};
use image::ImageEncoder;
use image::codecs::png::PngEncoder;

use super::drawing::{Anchor, Color, Drawing, MARGIN, Mark, Point};
use super::font;
use crate::error::{Error, Result};

/// Pixels per CSS pixel: sharp on paper and on dense screens.
const DENSITY: f64 = 2.0;

/// Returns a drawing as a PNG file.
pub fn png(drawing: &Drawing) -> Result<Vec<u8>> {
    let mut canvas = Canvas::new(drawing.size.map(|s| ((s + 2.0 * MARGIN) * DENSITY).ceil() as usize), Color::Paper);
    for mark in &drawing.marks {
        canvas.paint(mark);
    }
    let mut bytes = vec![];
    let [width, height] = canvas.size.map(|s| s as u32);
    PngEncoder::new(&mut bytes)
        .write_image(&canvas.bytes(), width, height, image::ExtendedColorType::Rgb8)
        .map_err(|e| Error::Internal(format!("cannot encode PNG: {e}")))?;
    Ok(bytes)
}

struct Canvas {
    size: [usize; 2],
    dots: Vec<[f32; 3]>,
}

impl Canvas {
    fn new(size: [usize; 2], ground: Color) -> Canvas {
        Canvas { size, dots: vec![ground.rgb().map(f32::from); size[0] * size[1]] }
    }

    fn bytes(&self) -> Vec<u8> {
        self.dots.iter().flatten().map(|v| v.round() as u8).collect()
    }

    fn paint(&mut self, mark: &Mark) {
        match mark {
            Mark::Line { points, color, width, dashes } => {
                let points: Vec<Point> = points.iter().map(dots).collect();
                let width = width * DENSITY;
                let strokes = match dashes.pattern() {
                    None => vec![points],
                    Some(pattern) => dashed(&points, pattern.map(|length| length * width)),
                };
                let ends = dashes.pattern().is_none();
                let outlines: Vec<Vec<Point>> = strokes.iter().flat_map(|stroke| stroked(stroke, 0.5 * width, ends)).collect();
                self.fill(&outlines, *color, 1.0);
            }
            Mark::Area { points, color, opacity, .. } => {
                self.fill(&[points.iter().map(dots).collect()], *color, *opacity);
            }
            Mark::Text { at, text, color, size, anchor } => {
                let size = size * DENSITY;
                let shift = match anchor {
                    Anchor::Start => 0.0,
                    Anchor::Middle => 0.5,
                    Anchor::End => 1.0,
                };
                let [x, y] = dots(at);
                let start = [x - shift * font::width(text, size), y];
                for glyph in font::outlines(text, start, size) {
                    let corner = glyph.px_bounds().min;
                    glyph.draw(|x, y, share| self.blend(corner.x as i64 + i64::from(x), corner.y as i64 + i64::from(y), *color, share));
                }
            }
        }
    }

    /// Fills closed outlines. Where outlines of the same orientation overlap, they count once.
    fn fill(&mut self, outlines: &[Vec<Point>], color: Color, opacity: f64) {
        let corners = || outlines.iter().flatten();
        let bound = |axis: usize| {
            let least = corners().map(|p| p[axis]).fold(f64::INFINITY, f64::min).floor().max(-1e6);
            let most = corners().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max).ceil().min(1e6);
            (least, (most - least).max(0.0) as usize + 1)
        };
        let ((left, width), (top, height)) = (bound(0), bound(1));
        if corners().next().is_none() {
            return;
        }
        let mut rasterizer = Rasterizer::new(width, height);
        let place = |p: &Point| -> ab_glyph_rasterizer::Point { point((p[0] - left) as f32, (p[1] - top) as f32) };
        for outline in outlines {
            for (from, to) in outline.iter().zip(outline.iter().cycle().skip(1)) {
                rasterizer.draw_line(place(from), place(to));
            }
        }
        rasterizer.for_each_pixel_2d(|x, y, share| {
            let share = share.min(1.0) * opacity as f32;
            self.blend(left as i64 + i64::from(x), top as i64 + i64::from(y), color, share);
        });
    }

    fn blend(&mut self, x: i64, y: i64, color: Color, share: f32) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x < self.size[0] && y < self.size[1] {
            let dot = &mut self.dots[y * self.size[0] + x];
            let color = color.rgb().map(f32::from);
            *dot = std::array::from_fn(|c| dot[c] + share.clamp(0.0, 1.0) * (color[c] - dot[c]));
        }
    }
}

/// Converts CSS pixels of the drawing to pixels of the picture.
fn dots(at: &Point) -> Point {
    at.map(|v| (v + MARGIN) * DENSITY)
}

/// Outlines of a line with a width: a rectangle for each segment, a disk at each joint and, if wanted, at the ends.
fn stroked(points: &[Point], radius: f64, ends: bool) -> Vec<Vec<Point>> {
    let mut outlines = vec![];
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        if length > 0.0 {
            let n = [-(b[1] - a[1]) / length * radius, (b[0] - a[0]) / length * radius];
            let corner = |p: Point, side: f64| [p[0] + side * n[0], p[1] + side * n[1]];
            outlines.push(vec![corner(a, 1.0), corner(a, -1.0), corner(b, -1.0), corner(b, 1.0)]);
        }
    }
    let last = points.len().saturating_sub(1);
    let joints = points.iter().enumerate().filter(|(i, _)| ends || (*i > 0 && *i < last));
    outlines.extend(joints.map(|(_, p)| disk(*p, radius)));
    outlines
}

/// Disk with the same orientation as the rectangles of [`stroked`].
fn disk(center: Point, radius: f64) -> Vec<Point> {
    let corner = |i: u32| {
        let angle = f64::from(i) / 16.0 * std::f64::consts::TAU;
        [center[0] + radius * angle.cos(), center[1] + radius * angle.sin()]
    };
    (0..16).map(corner).collect()
}

/// Segments that remain of a line under a pattern of dashes and gaps.
fn dashed(points: &[Point], [on, off]: [f64; 2]) -> Vec<Vec<Point>> {
    let mut pieces = vec![];
    let mut at = 0.0;
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        let between = |s: f64| [a[0] + s / length * (b[0] - a[0]), a[1] + s / length * (b[1] - a[1])];
        // `at` is the position of the segment's start in the pattern.
        let mut start = -at;
        while start < length {
            let [from, to] = [start.max(0.0), (start + on).min(length)];
            if from < to {
                pieces.push(vec![between(from), between(to)]);
            }
            start += on + off;
        }
        at = (at + length) % (on + off);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::report::plot::drawing::Dashes;

    /// Painted area, in CSS pixels squared, weighted with the opacity.
    fn covered(paint: impl Fn(&mut Drawing)) -> f64 {
        let mut drawing = Drawing::new(60.0, 40.0);
        paint(&mut drawing);
        let bytes = png(&drawing).expect("a picture");
        let image = image::load_from_memory(&bytes).expect("PNG").to_rgb8();
        assert_eq!(image.dimensions(), (184, 144));
        let [paper, color] = [Color::Paper, Color::Text].map(|color| f64::from(color.rgb()[0]));
        image.pixels().map(|p| (paper - f64::from(p[0])) / (paper - color)).sum::<f64>() / (DENSITY * DENSITY)
    }

    /// Drawn areas are those of the formulas. Rounding to 8 bits changes each pixel at the border by at most 1/(2·255).
    #[test]
    fn marks_cover_their_area() {
        let triangle = vec![[5.3, 5.1], [25.7, 9.2], [11.4, 33.3]];
        let area = 0.5 * ((25.7 - 5.3) * (33.3 - 5.1) - (11.4 - 5.3) * (9.2 - 5.1_f64)).abs();
        let found = covered(|d| d.area(triangle.clone(), Color::Text, 1.0, ""));
        assert!((found - area).abs() < 0.3, "{found} for {area}");
        let half = covered(|d| d.area(triangle.clone(), Color::Text, 0.5, ""));
        assert!((half - 0.5 * area).abs() < 0.6, "{half} for {}", 0.5 * area);

        // A straight line: length × width, and a round end on both sides, here a polygon with 16 corners.
        let length = 30f64.hypot(10.0);
        let ends = 16.0 / 2.0 * (std::f64::consts::TAU / 16.0).sin() * 1.5 * 1.5;
        let found = covered(|d| d.line(vec![[10.0, 10.0], [40.0, 20.0]], Color::Text, 3.0, Dashes::None));
        assert!((found - (3.0 * length + ends)).abs() < 0.6, "{found} for {}", 3.0 * length + ends);
    }

    /// Four on and three off: 4/7 of the line, up to one dash.
    #[test]
    fn dashes_leave_their_share() {
        let found = covered(|d| d.line(vec![[2.0, 20.0], [58.0, 20.0]], Color::Text, 1.0, Dashes::Long));
        assert!((found - 56.0 * 4.0 / 7.0).abs() <= 4.0, "{found}");
    }

    #[test]
    fn letters_stand_where_they_are_put() {
        let width = font::width("relMSE", 12.0);
        let color = |anchor| covered(|d| d.text([30.0, 25.0], "relMSE", Color::Text, 12.0, anchor));
        assert!(width > 30.0 && width < 60.0, "{width}");
        assert!(color(Anchor::Middle) > 20.0, "{}", color(Anchor::Middle));
        // The text extends over the right border and is cut.
        let [start, end] = [50.0, 70.0].map(|x| covered(|d| d.text([x, 25.0], "relMSE", Color::Text, 12.0, Anchor::Start)));
        assert!(end < 0.5 * start && end > 0.0, "{end} of {start}");
    }
}
