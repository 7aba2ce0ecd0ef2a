//! What pages for browsers have in common: filling a template, escaping, the style, and the image viewer.
//!
//! The report of a comparison and the page of a running render show pictures by the same JavaScript. A page puts the pieces of the viewer
//! where it wants them, and has the controls of its own beside them.

mod escape;
mod half_floats;

pub use escape::{csv, script, xml};
pub use half_floats::{EmbeddedImage, HalfFloats, exponent};

/// Style of all pages.
pub const STYLE: &str = include_str!("assets/page.css");
/// JavaScript of the viewer: the function `viewer`.
pub const VIEWER: &str = include_str!("assets/viewer.js");

/// Replaces every `{{name}}` of the template by its value. Values are not searched again.
pub fn fill(template: &str, value: impl Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut page = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once("}}").unwrap_or((part, ""));
        page.push_str(&value(name));
        page.push_str(rest);
    }
    page
}

/// A piece of the viewer, by the name that it has in templates; `None` for another name.
///
/// - `stage`: the picture, and what lies over it
/// - `develop`: controls of exposure and zoom
/// - `readout`: the numbers of a pixel
/// - `keys`: what the keys of these controls do
pub fn piece(name: &str) -> Option<&'static str> {
    match name {
        "stage" => Some(include_str!("assets/stage.html")),
        "develop" => Some(include_str!("assets/develop.html")),
        "readout" => Some(include_str!("assets/readout.html")),
        "keys" => Some(include_str!("assets/keys.html")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_not_searched_again() {
        let page = fill("<a>{{x}}</a>{{y}}.", |name| format!("[{name} {{{{x}}}}]"));
        assert_eq!(page, "<a>[x {{x}}]</a>[y {{x}}].");
    }
}
