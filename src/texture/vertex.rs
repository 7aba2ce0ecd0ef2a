//! Vertex colours.

use super::TextureContext;
use crate::math::Rgb;

/// The interpolated colour of a mesh's vertices, or a channel of it; 1 on shapes without such colours.
///
/// Tests: colours_are_interpolated_over_triangles, meshes_without_colours_are_white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Vertex {
    /// A single channel, used as a grey: 0 is red, 1 green, 2 blue, 3 opacity. Without one the colour is used.
    pub channel: Option<usize>,
}

impl Vertex {
    /// Looks up the colour at a point.
    pub fn at(&self, at: &TextureContext) -> Rgb {
        let [r, g, b, a] = at.color.to_array();
        match self.channel {
            None => Rgb::new(r, g, b),
            Some(k) => Rgb::gray([r, g, b, a][k]),
        }
    }
}
