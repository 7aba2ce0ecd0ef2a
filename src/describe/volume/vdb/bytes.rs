//! A reader of the numbers and strings in a file, all little-endian.

use crate::Result;
use crate::describe::volume::invalid;

/// The content of a file, and the place in it that is read next.
#[derive(Clone)]
pub struct Bytes<'c> {
    content: &'c [u8],
    place: usize,
}

impl<'c> Bytes<'c> {
    /// A reader at the beginning.
    pub fn new(content: &'c [u8]) -> Bytes<'c> {
        Bytes { content, place: 0 }
    }

    /// A reader of the same content at another place.
    ///
    /// # Errors
    /// `Invalid` where the file ends before it.
    pub fn at(&self, place: u64) -> Result<Bytes<'c>> {
        match usize::try_from(place) {
            Ok(place) if place <= self.content.len() => Ok(Bytes { content: self.content, place }),
            _ => invalid(format!("the file ends at byte {}, and says that a part of it begins at byte {place}", self.content.len())),
        }
    }

    /// Whether the place is beyond that of another reader.
    pub fn is_beyond(&self, other: &Bytes) -> bool {
        self.place > other.place
    }

    /// The next bytes.
    ///
    /// # Errors
    /// `Invalid` where the file ends before.
    pub fn take(&mut self, count: usize) -> Result<&'c [u8]> {
        let rest = &self.content[self.place..];
        let Some(taken) = rest.get(..count) else {
            return invalid(format!("the file ends at byte {}: expected {count} bytes from byte {} on", self.content.len(), self.place));
        };
        self.place += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    pub fn u8(&mut self) -> Result<u8> {
        Ok(self.array::<1>()?[0])
    }

    pub fn u32(&mut self) -> Result<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32> {
        self.array().map(i32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Result<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub fn i64(&mut self) -> Result<i64> {
        self.array().map(i64::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64> {
        self.array().map(f64::from_le_bytes)
    }

    /// A string after its length.
    pub fn string(&mut self) -> Result<String> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }
}
