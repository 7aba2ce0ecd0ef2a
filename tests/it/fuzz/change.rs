//! Changes of inputs that keep much of their structure: bits, pieces, numbers and words.

use pt::torture::Random;

/// Numbers at which programs fail.
const NUMBERS: [&str; 24] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "0.5",
    "1e-45",
    "1e-30",
    "1e-9",
    "1e9",
    "1e18",
    "1e30",
    "1e38",
    "1e39",
    "1e308",
    "1e999",
    "127",
    "255",
    "65535",
    "65536",
    "2147483648",
    "4294967295",
    "9223372036854775807",
    "18446744073709551616",
];

/// Words that mean something in some format.
const WORDS: [&str; 28] = [
    "null",
    "true",
    "nan",
    "inf",
    "\"\"",
    "[]",
    "{}",
    "[",
    "}",
    ",",
    ":",
    "\"",
    "\\",
    "/",
    "//",
    "\n",
    "\r\n",
    " ",
    "\t",
    "#",
    "-",
    "\0",
    "\u{fffd}",
    "\u{feff}",
    "..",
    "f 1 1 1\n",
    "v 0 0 0\n",
    "end_header\n",
];

/// The input after one to four changes.
///
/// - `other`: another input, from which pieces are taken
pub fn changed(input: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = input.to_vec();
    for _ in 0..=random.below(4) {
        change(&mut bytes, other, random);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    if bytes.is_empty() {
        bytes.extend(other);
        return;
    }
    let at = random.below(bytes.len());
    let end = (at + 1 + random.below(24)).min(bytes.len());
    match random.below(13) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => bytes[at] = random.bits() as u8,
        2 => bytes.truncate(at),
        3 => drop(bytes.drain(at..end)),
        4 => {
            let piece = bytes[at..end].to_vec();
            drop(bytes.splice(at..at, piece.iter().copied().cycle().take(piece.len() << random.below(6))));
        }
        5 => drop(bytes.splice(at..at, random.pick(&WORDS).bytes())),
        6 if !other.is_empty() => {
            let from = random.below(other.len());
            let piece = &other[from..(from + 1 + random.below(200)).min(other.len())];
            drop(bytes.splice(at..end, piece.iter().copied()));
        }
        7 => {
            let wide = [0u32, 1, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 0x7fc0_0000, 0x7f80_0000, 1 << 16];
            let number = random.pick(&wide);
            let number = if random.below(2) == 0 { number.to_le_bytes() } else { number.to_be_bytes() };
            bytes.iter_mut().skip(at).zip(number).for_each(|(byte, new)| *byte = new);
        }
        8 | 9 => swap_piece(bytes, at, is_numeric, random.pick(&NUMBERS).as_bytes()),
        10 => {
            let from = random.below(bytes.len());
            let word = piece(bytes, from, is_of_word);
            let word = bytes[word].to_vec();
            swap_piece(bytes, at, is_of_word, &word);
        }
        // A line, or a member of a list or object in one line, is removed or repeated.
        _ => {
            let of_line = |byte: u8| !matches!(byte, b'\n' | b',');
            let range = piece(bytes, at, of_line);
            let range = range.start..(range.end + 1).min(bytes.len());
            if random.below(2) == 0 {
                drop(bytes.drain(range));
            } else {
                let line = bytes[range.clone()].to_vec();
                drop(bytes.splice(range.end..range.end, line));
            }
        }
    }
}

fn is_numeric(byte: u8) -> bool {
    byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+' | b'e' | b'E')
}

fn is_of_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

/// The next run of bytes of a kind, from a position on.
fn piece(bytes: &[u8], at: usize, is_of: impl Fn(u8) -> bool) -> std::ops::Range<usize> {
    let start = bytes[at..].iter().position(|byte| is_of(*byte)).map_or(bytes.len(), |skipped| at + skipped);
    let before = bytes[..start].iter().rev().take_while(|byte| is_of(**byte)).count();
    let length = bytes[start..].iter().take_while(|byte| is_of(**byte)).count();
    start - before..start + length
}

/// Puts other bytes in the place of the next run of bytes of a kind.
fn swap_piece(bytes: &mut Vec<u8>, at: usize, is_of: impl Fn(u8) -> bool, new: &[u8]) {
    let range = piece(bytes, at, is_of);
    drop(bytes.splice(range, new.iter().copied()));
}
