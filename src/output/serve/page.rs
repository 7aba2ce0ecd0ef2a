//! The page of a running render: one HTML file, with the viewer of the report.

use crate::output::page::{STYLE, VIEWER, fill, piece, xml};

const TEMPLATE: &str = include_str!("assets/page.html");

/// The page.
///
/// - `title`: name of the picture
/// - `epsilon`: ε of relative errors
pub fn html(title: &str, epsilon: f64) -> String {
    fill(TEMPLATE, |name| match name {
        "title" => xml(title),
        "epsilon" => epsilon.to_string(),
        "style" => STYLE.into(),
        "own-style" => include_str!("assets/page.css").into(),
        "viewer" => VIEWER.into(),
        "script" => include_str!("assets/page.js").into(),
        other => piece(other).unwrap_or_else(|| unreachable!("the page asks for {other}")).into(),
    })
}
