//! Hash of the content of a picture, independent of how it is stored.

use crate::film::{Image, Layer, LightNames};
use crate::math::hash::{Hash, Hasher};

/// Hash of a picture's window and decoded channels, bit by bit. Compression, order of channels and attributes do not change it, and
/// neither does a lossless change of the stored number type. [`Layer::Time`], which a clock measured, is left out.
///
/// XXH3 (128 bits) of: size of the whole picture, origin and size of the part, as u32; then of every channel, sorted by name, the
/// length of its name (u32), its name, its values (f32); all little-endian.
pub fn hash(image: &Image) -> Hash {
    let mut hasher = Hasher::default();
    hasher.whole([image.full_size, image.origin, image.size].iter().flat_map(|v| v.to_array()));
    let clocks: Vec<Layer> = Layer::ALL.iter().map(|row| row.0).filter(|layer| !layer.is_reproducible()).collect();
    let by_clock: Vec<String> = clocks.into_iter().flat_map(|layer| layer.channels(&LightNames::default())).collect();
    let mut channels: Vec<_> = image.channels.iter().filter(|channel| !by_clock.contains(&channel.name)).collect();
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    for channel in channels {
        hasher.text(&channel.name);
        hasher.floats(channel.values.iter().copied());
    }
    hasher.finish()
}
