//! Hashes of contents.

use std::fmt;

use xxhash_rust::xxh3::Xxh3;

/// XXH3 hash of 128 bits, written as 32 hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Hash(pub u128);

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// Hasher of bytes in several pieces. The boundaries of the pieces do not change the hash.
#[derive(Default)]
pub struct Hasher(Xxh3);

impl Hasher {
    /// Adds bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Adds the length of a text (u32, little-endian) and its bytes.
    pub fn text(&mut self, text: &str) {
        self.bytes(&(text.len() as u32).to_le_bytes());
        self.bytes(text.as_bytes());
    }

    /// Adds whole numbers, little-endian.
    pub fn whole(&mut self, numbers: impl IntoIterator<Item = u32>) {
        self.bytes(&numbers.into_iter().flat_map(u32::to_le_bytes).collect::<Vec<u8>>());
    }

    /// Adds the bits of numbers, little-endian.
    pub fn floats(&mut self, numbers: impl IntoIterator<Item = f32>) {
        self.whole(numbers.into_iter().map(f32::to_bits));
    }

    /// Hash of all bytes so far.
    pub fn finish(&self) -> Hash {
        Hash(self.0.digest128())
    }
}
