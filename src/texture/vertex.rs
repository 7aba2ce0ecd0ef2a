//! The colours of a mesh's vertices.

use crate::math::Rgb;
use crate::shape::SurfacePoint;

/// The colour that the mesh has at a point, or one channel of it; 1 on what has none.
///
/// Tests: colours_are_interpolated_over_triangles, what_has_no_colours_is_white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Vertex {
    /// Red, green, blue or opacity by itself, from 0.
    pub channel: Option<usize>,
}

impl Vertex {
    pub fn at(&self, point: &SurfacePoint) -> Rgb {
        let [r, g, b, a] = point.color.to_array();
        match self.channel {
            None => Rgb::new(r, g, b),
            Some(k) => Rgb::gray([r, g, b, a][k]),
        }
    }
}
