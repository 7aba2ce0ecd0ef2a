//! Numbers of some pixels in few bytes, bit for bit.
//!
//! Sums of f32 samples use few of the 52 digits of an f64, and their exponents are alike. So the bytes of all numbers are sorted into
//! planes: one for each sum of a pixel and each of the eight bytes of a number. A plane is stored in one of three ways:
//!
//! ```text
//! constant     one byte, such as 0 for the last digits of sums of few samples
//! plain        as it is, if it looks like noise: Σ c² < n²/128 for the counts c of each value among n bytes
//! packed       with all other such planes, by deflate (RFC 1951)
//! ```
//!
//! The file has the ways of all planes (a byte each), the constants, the plain planes and the packed ones, each in the order of the
//! planes: the lowest bytes of all sums first.

use flate2::{Compress, Compression, Decompress, FlushCompress, FlushDecompress, Status};

use crate::error::memory::fallible;

const CONSTANT: u8 = 0;
const PLAIN: u8 = 1;
const PACKED: u8 = 2;

/// Speed of deflate, from 0 to 9. Higher levels take several times as long and save less than 1 % of these bytes.
const LEVEL: u32 = 1;

/// Numbers in a chunk at most: half a MiB of them, so that a few chunks for each thread take little memory.
const MOST_NUMBERS: usize = 1 << 16;

/// Pixels of a chunk, where a pixel has `width` numbers.
pub fn chunk_pixels(width: usize) -> usize {
    (MOST_NUMBERS / width.max(1)).max(1)
}

/// Bytes of the numbers of some pixels, each of which has `width` numbers.
pub fn encode(numbers: &[f64], width: usize) -> Vec<u8> {
    let (mut constants, mut plain, mut packed) = (vec![], vec![], vec![]);
    let mut ways = vec![];
    for byte in 0..8 {
        for number in 0..width {
            let plane: Vec<u8> = numbers.iter().skip(number).step_by(width).map(|x| x.to_le_bytes()[byte]).collect();
            let way = way(&plane);
            match way {
                CONSTANT => constants.extend(plane.first()),
                PLAIN => plain.extend(plane),
                _ => packed.extend(plane),
            }
            ways.push(way);
        }
    }
    [ways, constants, plain, deflated(&packed)].concat()
}

/// Way in which a plane is stored.
fn way(plane: &[u8]) -> u8 {
    let mut counts = [0u64; 256];
    plane.iter().for_each(|byte| counts[usize::from(*byte)] += 1);
    let (all, equal) = (plane.len() as u64, counts.iter().map(|count| count * count).sum::<u64>());
    if equal == all * all {
        CONSTANT
    } else if 128 * equal < all * all {
        PLAIN
    } else {
        PACKED
    }
}

/// Bytes packed by deflate.
pub fn deflated(bytes: &[u8]) -> Vec<u8> {
    if bytes.is_empty() {
        return vec![];
    }
    let mut packer = Compress::new(Compression::new(LEVEL), false);
    let mut packed = Vec::with_capacity(bytes.len() / 2 + 64);
    loop {
        let read = packer.total_in() as usize;
        // No other answer than that there is more to come or that all is there is possible.
        match packer.compress_vec(&bytes[read..], &mut packed, FlushCompress::Finish) {
            Ok(Status::StreamEnd) | Err(_) => return packed,
            Ok(_) => packed.reserve(packed.len() + 64),
        }
    }
}

/// Numbers of `pixels` pixels from the bytes of [`encode`]; `None` for other bytes, and if memory runs out. No more memory is taken than the
/// numbers need.
pub fn decode(bytes: &[u8], width: usize, pixels: usize) -> Option<Vec<f64>> {
    let (ways, rest) = bytes.split_at_checked(8 * width).filter(|_| pixels > 0)?;
    let count = |way: u8| ways.iter().filter(|found| **found == way).count();
    let (constants, rest) = rest.split_at_checked(count(CONSTANT))?;
    let (plain, rest) = rest.split_at_checked(count(PLAIN).checked_mul(pixels)?)?;
    let packed = inflated(rest, count(PACKED).checked_mul(pixels)?)?;
    let (mut constants, mut plain, mut packed) = (constants.iter(), plain.chunks_exact(pixels), packed.chunks_exact(pixels));
    let plane = |way: &u8| match *way {
        CONSTANT => constants.next().map(|byte| Plane::Constant(*byte)),
        PLAIN => plain.next().map(Plane::Bytes),
        PACKED => packed.next().map(Plane::Bytes),
        _ => None,
    };
    let planes: Vec<Plane> = ways.iter().map(plane).collect::<Option<_>>()?;
    let mut numbers = vec![];
    fallible(|| numbers.try_reserve_exact(width * pixels)).ok()?;
    numbers.resize(width * pixels, 0.0);
    let mut column: Vec<u64> = vec![];
    for number in 0..width {
        column.clear();
        column.resize(pixels, 0);
        for byte in 0..8 {
            let shift = 8 * byte;
            match planes[byte * width + number] {
                Plane::Constant(0) => {}
                Plane::Constant(digit) => column.iter_mut().for_each(|bits| *bits |= u64::from(digit) << shift),
                Plane::Bytes(digits) => column.iter_mut().zip(digits).for_each(|(bits, digit)| *bits |= u64::from(*digit) << shift),
            }
        }
        numbers.iter_mut().skip(number).step_by(width).zip(&column).for_each(|(place, bits)| *place = f64::from_bits(*bits));
    }
    Some(numbers)
}

/// One byte of one sum, for all pixels.
enum Plane<'a> {
    Constant(u8),
    Bytes(&'a [u8]),
}

/// Bytes that were packed; `None` unless they are exactly this many.
pub fn inflated(packed: &[u8], length: usize) -> Option<Vec<u8>> {
    let mut bytes = vec![];
    fallible(|| bytes.try_reserve_exact(length)).ok()?;
    bytes.resize(length, 0);
    if length == 0 {
        return packed.is_empty().then_some(bytes);
    }
    let mut unpacker = Decompress::new(false);
    let status = unpacker.decompress(packed, &mut bytes, FlushDecompress::Finish).ok()?;
    let is_all = status == Status::StreamEnd && (unpacker.total_in(), unpacker.total_out()) == (packed.len() as u64, length as u64);
    is_all.then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::hash::mix;

    /// Pixels of sums as renders have them: few digits, many digits, and equal numbers; and one of numbers of every kind.
    fn pixels(count: usize) -> Vec<f64> {
        let odd = [0.0, -0.0, f64::INFINITY, f64::NAN, f64::MIN_POSITIVE / 4.0, -1e300];
        let pixel = |i: usize| {
            let noise = mix(i as u64);
            [f64::from((noise >> 40) as u32) / 65536.0, f64::from_bits(noise >> 2), 7.0, odd[i % odd.len()]]
        };
        (0..count).flat_map(pixel).collect()
    }

    #[test]
    fn bits_come_back() {
        let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        for count in [1, 2, 3, 100, 5000] {
            for width in [1, 2, 4] {
                let numbers = pixels(count);
                let bytes = encode(&numbers, width);
                let found = decode(&bytes, width, numbers.len() / width).expect("the bytes of numbers");
                assert_eq!(bits(&found), bits(&numbers), "{count} pixels of {width}");
            }
        }
    }

    /// The sum of few digits has two bytes of zeros at least, and a constant none at all.
    #[test]
    fn bytes_without_news_are_not_stored() {
        let numbers: Vec<f64> = pixels(5000).chunks(4).flat_map(|pixel| [pixel[0], pixel[2]]).collect();
        let bytes = encode(&numbers, 2).len();
        assert!(bytes < 5000 * 5, "{bytes} bytes for 5000 numbers of 24 digits and as many that are equal");
    }

    /// Any other bytes give no numbers, or numbers, but never more than were asked for.
    #[test]
    fn other_bytes_are_refused() {
        let bytes = encode(&pixels(200), 4);
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length], 4, 200).is_none(), "{length} of {} bytes", bytes.len());
        }
        assert!(
            decode(&[&bytes[..], &[0]].concat(), 4, 200).is_none() && decode(&bytes, 4, 199).is_none() && decode(&bytes, 4, 201).is_none()
        );
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            assert!(decode(&changed, 4, 200).is_none_or(|numbers| numbers.len() == 800));
        }
    }
}
