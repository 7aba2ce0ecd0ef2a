//! Pictures of red, green and blue, as most formats store them.

use glam::UVec2;

use crate::film::{Channel, Image};

/// Whole picture with `R`, `G`, `B`.
pub(super) fn rgb_image(size: UVec2, pixels: &[[f32; 3]]) -> Image {
    let channel = |(c, name): (usize, &str)| Channel { name: name.into(), values: pixels.iter().map(|p| p[c]).collect() };
    Image { full_size: size, origin: UVec2::ZERO, size, channels: ["R", "G", "B"].into_iter().enumerate().map(channel).collect() }
}
