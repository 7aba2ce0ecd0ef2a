//! Runs of bytes as OpenVDB stores them: as they are, deflated, or by blosc, which splits them into blocks of shuffled bytes.
//!
//! Source: OpenVDB, `io/Compression.h`; c-blosc 1, `README_HEADER.rst` and the layout of its blocks.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::bytes::Bytes;
use crate::Result;
use crate::describe::volume::invalid;

/// How the runs of a grid are stored: bits of its header.
#[derive(Clone, Copy, Default)]
pub struct Compression(u32);

impl Compression {
    const ZIP: u32 = 1;
    const ACTIVE_MASK: u32 = 2;
    const BLOSC: u32 = 4;

    /// Reads the bits of a grid.
    ///
    /// # Errors
    /// `Invalid` for bits that have no meaning yet.
    pub fn read_flags(bytes: &mut Bytes) -> Result<Compression> {
        let flags = bytes.u32()?;
        let known = Compression::ZIP | Compression::ACTIVE_MASK | Compression::BLOSC;
        if flags & !known == 0 { Ok(Compression(flags)) } else { wrong(&format!("expected a method from 0 to {known}, found {flags}")) }
    }

    /// Whether only the values of active voxels are stored, where the inactive ones need no values of their own.
    pub fn leaves_out_inactive(self) -> bool {
        self.0 & Compression::ACTIVE_MASK != 0
    }

    /// Reads a run of `count` bytes.
    ///
    /// # Errors
    /// `Invalid` where the run has another length or cannot be read.
    pub fn read(self, bytes: &mut Bytes, count: usize) -> Result<Vec<u8>> {
        if self.0 & (Compression::ZIP | Compression::BLOSC) == 0 {
            return Ok(bytes.take(count)?.to_vec());
        }
        // A length that is not positive is that of bytes as they are.
        let length = bytes.i64()?;
        let stored = usize::try_from(length.unsigned_abs()).unwrap_or(usize::MAX);
        let run = bytes.take(stored)?;
        let run = match length {
            ..=0 => run.to_vec(),
            _ if self.0 & Compression::BLOSC != 0 => blosc(run, count)?,
            _ => inflated(run, count)?,
        };
        if run.len() == count { Ok(run) } else { wrong(&format!("expected {count} bytes, found {}", run.len())) }
    }
}

/// At most `most` bytes of a deflated run, and one more if there are more.
fn inflated(run: &[u8], most: usize) -> Result<Vec<u8>> {
    let mut inflated = vec![];
    match ZlibDecoder::new(run).take(most as u64 + 1).read_to_end(&mut inflated) {
        Ok(_) => Ok(inflated),
        Err(error) => wrong(&error.to_string()),
    }
}

/// Bytes of the header of a run of blosc.
const HEADER: usize = 16;
/// Versions of that header in c-blosc 1.
const HEADERS: std::ops::RangeInclusive<u8> = 1..=2;
/// Byte shuffle (`BLOSC_DOSHUFFLE`): the first bytes of all numbers, then all second bytes, and so on.
const SHUFFLED: u8 = 1;
/// Not compressed (`BLOSC_MEMCPYED`).
const COPIED: u8 = 2;
/// Bit shuffle (`BLOSC_DOBITSHUFFLE`).
const BITS_SHUFFLED: u8 = 4;
/// A block is one stream: it is not split into a stream for each byte of its numbers.
const UNSPLIT: u8 = 0x10;
/// Blocks are split into streams only for numbers of at most this size (bytes), and at least this count of numbers.
const SPLIT: [usize; 2] = [16, 128];

/// The bytes of a run that blosc compressed, which must be `expected` in number.
fn blosc(run: &[u8], expected: usize) -> Result<Vec<u8>> {
    let mut header = Bytes::new(run);
    let [version, _, flags, size] = [header.u8()?, header.u8()?, header.u8()?, header.u8()?];
    if !HEADERS.contains(&version) {
        return wrong(&format!("version {version} of blosc, which pt cannot read"));
    }
    let [count, block, stored] = [header.u32()? as usize, header.u32()? as usize, header.u32()? as usize];
    if count != expected || stored != run.len() || block == 0 && count > 0 || size == 0 {
        return wrong(&format!("expected {expected} bytes in {}, found {count} in {stored}", run.len()));
    }
    if flags & COPIED != 0 {
        return Ok(run[HEADER..].to_vec());
    }
    if flags & BITS_SHUFFLED != 0 {
        return wrong("shuffled bits, which pt cannot read");
    }
    let codec = Codec::of(flags >> 5)?;
    let size = usize::from(size);
    let mut values = vec![0; count];
    for target in values.chunks_mut(block.max(1)) {
        let start = header.u32()?;
        let mut source = header.at(start.into())?;
        let is_split = flags & UNSPLIT == 0 && size <= SPLIT[0] && block / size >= SPLIT[1] && target.len() == block;
        let streams = if is_split { size } else { 1 };
        let mut shuffled = vec![0; target.len()];
        if !target.len().is_multiple_of(streams) {
            return wrong("a block does not hold whole numbers");
        }
        for stream in shuffled.chunks_mut(target.len() / streams) {
            let stored = source.u32()? as usize;
            let stored = source.take(stored)?;
            if stored.len() == stream.len() { stream.copy_from_slice(stored) } else { codec.read(stored, stream)? }
        }
        if flags & SHUFFLED != 0 { unshuffle(&shuffled, size, target) } else { target.copy_from_slice(&shuffled) }
    }
    Ok(values)
}

/// Puts the bytes of numbers of a size together, which are stored in the order of their significance. Bytes after the last whole number are
/// stored as they are.
fn unshuffle(shuffled: &[u8], size: usize, target: &mut [u8]) {
    let numbers = target.len() / size;
    target.copy_from_slice(shuffled);
    for number in 0..numbers {
        for byte in 0..size {
            target[number * size + byte] = shuffled[byte * numbers + number];
        }
    }
}

/// How the blocks of blosc are compressed.
enum Codec {
    Lz4,
    Zlib,
}

impl Codec {
    fn of(number: u8) -> Result<Codec> {
        match number {
            1 => Ok(Codec::Lz4),
            3 => Ok(Codec::Zlib),
            other => {
                let name =
                    ["BloscLZ", "LZ4", "Snappy", "zlib", "Zstandard"].get(usize::from(other)).copied().unwrap_or("an unknown method");
                wrong(&format!("compressed by {name}, which pt cannot read: save it with LZ4 or zlib"))
            }
        }
    }

    /// Fills `target`.
    fn read(&self, stored: &[u8], target: &mut [u8]) -> Result<()> {
        let found = match self {
            Codec::Lz4 => match lz4_flex::block::decompress_into(stored, target) {
                Ok(count) => count,
                Err(error) => return wrong(&error.to_string()),
            },
            Codec::Zlib => {
                let inflated = inflated(stored, target.len())?;
                let count = inflated.len().min(target.len());
                target[..count].copy_from_slice(&inflated[..count]);
                inflated.len()
            }
        };
        if found == target.len() { Ok(()) } else { wrong(&format!("expected {} bytes of a block, found {found}", target.len())) }
    }
}

fn wrong<T>(message: &str) -> Result<T> {
    invalid(format!("compressed values: {message}"))
}
