//! Plots as SVG: elements of an HTML page, whose style sheet may change the colours, or files of their own.

use std::fmt::Write as _;

use super::drawing::{Anchor, Color, Drawing, MARGIN, Mark, Point};
use crate::output::page::xml;

const FONTS: &str = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif";

/// Element for a page.
pub fn element(drawing: &Drawing) -> String {
    svg(drawing, "", "", 0.0)
}

/// File with a white background, or a dark one where the reader's window is dark.
pub fn file(drawing: &Drawing) -> Vec<u8> {
    let style = format!("<style>@media (prefers-color-scheme: dark) {{\n{}}}</style>\n", include_str!("../assets/dark.css"));
    let paper = format!("{style}<rect x=\"-{MARGIN}\" y=\"-{MARGIN}\" width=\"100%\" height=\"100%\" {}/>\n", fill(Color::Paper));
    svg(drawing, " xmlns=\"http://www.w3.org/2000/svg\"", &paper, MARGIN).into_bytes()
}

fn svg(drawing: &Drawing, namespace: &str, ground: &str, margin: f64) -> String {
    let [width, height] = drawing.size.map(|s| s + 2.0 * margin);
    let about = xml(&drawing.description);
    let mut text = format!(
        "<svg{namespace} viewBox=\"{} {} {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\" \
         aria-label=\"{about}\" font-family=\"{FONTS}\">\n{ground}",
        -margin, -margin
    );
    for mark in &drawing.marks {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", element_of(mark));
    }
    text.push_str("</svg>\n");
    text
}

fn element_of(mark: &Mark) -> String {
    match mark {
        Mark::Line { points, color, width, dashes } => {
            let dash = dashes.pattern().map(|[on, off]| format!(" stroke-dasharray=\"{} {}\"", on * width, off * width));
            let dash = dash.unwrap_or_default();
            let [class, color] = [color.class(), hex(*color)];
            format!(
                "<polyline points=\"{}\" fill=\"none\" class=\"s-{class}\" stroke=\"{color}\" stroke-width=\"{width}\" \
                 stroke-linejoin=\"round\" stroke-linecap=\"{}\"{dash}/>",
                list(points),
                if dash.is_empty() { "round" } else { "butt" }
            )
        }
        Mark::Area { points, color, opacity, hint } => {
            let start = format!("<polygon points=\"{}\" {} fill-opacity=\"{opacity}\"", list(points), fill(*color));
            if hint.is_empty() { format!("{start}/>") } else { format!("{start}><title>{}</title></polygon>", xml(hint)) }
        }
        Mark::Text { at, text, color, size, anchor } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let [x, y] = at.map(short);
            let text = xml(text);
            format!("<text x=\"{x}\" y=\"{y}\" {} font-size=\"{size}\" text-anchor=\"{anchor}\">{text}</text>", fill(*color))
        }
    }
}

fn fill(color: Color) -> String {
    format!("class=\"f-{}\" fill=\"{}\"", color.class(), hex(color))
}

fn hex(color: Color) -> String {
    let [r, g, b] = color.rgb();
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn list(points: &[Point]) -> String {
    points.iter().map(|p| format!("{},{}", short(p[0]), short(p[1]))).collect::<Vec<_>>().join(" ")
}

/// Rounds to a hundredth of a pixel.
fn short(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}
