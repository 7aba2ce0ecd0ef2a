//! Plots as SVG: to stand in a page, where its style sheet may change the colours, or alone.

use std::fmt::Write as _;

use super::drawing::{Anchor, Drawing, Ink, MARGIN, Mark, Spot};
use crate::compare::report::escape;

const FONTS: &str = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif";

/// An element of a page.
pub fn element(drawing: &Drawing) -> String {
    svg(drawing, "", "", 0.0)
}

/// A file: on paper, or dark where the reader's window is.
pub fn file(drawing: &Drawing) -> Vec<u8> {
    let style = format!("<style>@media (prefers-color-scheme: dark) {{\n{}}}</style>\n", include_str!("../assets/dark.css"));
    let paper = format!("{style}<rect x=\"-{MARGIN}\" y=\"-{MARGIN}\" width=\"100%\" height=\"100%\" {}/>\n", fill(Ink::Paper));
    svg(drawing, " xmlns=\"http://www.w3.org/2000/svg\"", &paper, MARGIN).into_bytes()
}

fn svg(drawing: &Drawing, namespace: &str, ground: &str, margin: f64) -> String {
    let [width, height] = drawing.size.map(|s| s + 2.0 * margin);
    let about = escape::xml(&drawing.description);
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
        Mark::Line { points, ink, width, dashes } => {
            let dash = dashes.pattern().map(|[on, off]| format!(" stroke-dasharray=\"{} {}\"", on * width, off * width));
            let dash = dash.unwrap_or_default();
            let [class, color] = [ink.class(), hex(*ink)];
            format!(
                "<polyline points=\"{}\" fill=\"none\" class=\"s-{class}\" stroke=\"{color}\" stroke-width=\"{width}\" \
                 stroke-linejoin=\"round\" stroke-linecap=\"{}\"{dash}/>",
                list(points),
                if dash.is_empty() { "round" } else { "butt" }
            )
        }
        Mark::Area { points, ink, opacity, hint } => {
            let start = format!("<polygon points=\"{}\" {} fill-opacity=\"{opacity}\"", list(points), fill(*ink));
            if hint.is_empty() { format!("{start}/>") } else { format!("{start}><title>{}</title></polygon>", escape::xml(hint)) }
        }
        Mark::Text { at, text, ink, size, anchor } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let [x, y] = at.map(short);
            let text = escape::xml(text);
            format!("<text x=\"{x}\" y=\"{y}\" {} font-size=\"{size}\" text-anchor=\"{anchor}\">{text}</text>", fill(*ink))
        }
    }
}

fn fill(ink: Ink) -> String {
    format!("class=\"f-{}\" fill=\"{}\"", ink.class(), hex(ink))
}

fn hex(ink: Ink) -> String {
    let [r, g, b] = ink.rgb();
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn list(points: &[Spot]) -> String {
    points.iter().map(|p| format!("{},{}", short(p[0]), short(p[1]))).collect::<Vec<_>>().join(" ")
}

/// A hundredth of a pixel is enough.
fn short(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}
