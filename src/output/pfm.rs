//! Portable float map: the simplest format that keeps linear f32.

use crate::film::Image;

/// Little-endian (scale −1), rows from the bottom.
pub fn encode(image: &Image) -> Vec<u8> {
    let mut bytes = format!("PF\n{} {}\n-1.0\n", image.size.x, image.size.y).into_bytes();
    let pixels: Vec<[f32; 3]> = image.pixels().collect();
    for row in pixels.chunks(image.size.x.max(1) as usize).rev() {
        bytes.extend(row.iter().flatten().flat_map(|v| v.to_le_bytes()));
    }
    bytes
}
