//! A name for what a picture shows: the same for the same pixels, however they are stored.

use std::fmt;

use xxhash_rust::xxh3::Xxh3;

use crate::film::{Image, Layer};

/// 128 bits, shown as 32 hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Hash(pub u128);

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// The hash of a picture's window and decoded channels, bit by bit: compression, order of channels, attributes and, where nothing
/// is lost, the type of the stored numbers have no say in it. Neither has what a clock measured, [`Layer::Time`].
///
/// XXH3 (128 bits) of: size of the whole picture, origin and size of the part, as u32; then of every channel, sorted by name, the
/// length of its name (u32), its name, its values (f32); all little-endian.
pub fn hash(image: &Image) -> Hash {
    let mut hasher = Xxh3::new();
    let corners = [image.full_size, image.origin, image.size];
    corners.iter().flat_map(|v| v.to_array()).for_each(|n| hasher.update(&n.to_le_bytes()));
    let by_clock = |name: &str| Layer::ALL.iter().any(|(layer, ..)| !layer.is_reproducible() && layer.channels().contains(&name));
    let mut channels: Vec<_> = image.channels.iter().filter(|channel| !by_clock(&channel.name)).collect();
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    for channel in channels {
        hasher.update(&(channel.name.len() as u32).to_le_bytes());
        hasher.update(channel.name.as_bytes());
        let bytes: Vec<u8> = channel.values.iter().flat_map(|v| v.to_le_bytes()).collect();
        hasher.update(&bytes);
    }
    Hash(hasher.digest128())
}
