//! Names for contents.

use std::fmt;

use xxhash_rust::xxh3::Xxh3;

/// 128 bits, shown as 32 hexadecimal digits: XXH3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Hash(pub u128);

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// What a hash is made from, piece by piece; only the bytes count, not where one piece ends.
#[derive(Default)]
pub struct Hasher(Xxh3);

impl Hasher {
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// The length of the text (u32, little-endian), and its bytes.
    pub fn text(&mut self, text: &str) {
        self.bytes(&(text.len() as u32).to_le_bytes());
        self.bytes(text.as_bytes());
    }

    /// Little-endian.
    pub fn whole(&mut self, numbers: impl IntoIterator<Item = u32>) {
        self.bytes(&numbers.into_iter().flat_map(u32::to_le_bytes).collect::<Vec<u8>>());
    }

    /// Bit by bit, little-endian.
    pub fn floats(&mut self, numbers: impl IntoIterator<Item = f32>) {
        self.whole(numbers.into_iter().map(f32::to_bits));
    }

    pub fn finish(&self) -> Hash {
        Hash(self.0.digest128())
    }
}
