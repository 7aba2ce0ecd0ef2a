//! Files that are not parts of a render, and damaged parts.

use std::fs;

use pt::film::{Allocation, Film, PixelSums, Wave};
use pt::measure::ErrorHistory;
use pt::part::{self, About, Stored, merge};
use pt::render::RenderReport;
use pt::sampler::ErrorEstimator;

use super::{numbers, small, stored};

/// A file with one changed bit or byte is refused, and causes no panic.
#[test]
fn every_flipped_bit_is_detected() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ptc");
    small(&path, 0, 0);
    let right = fs::read(&path).expect("written");
    for at in 0..right.len() {
        for flip in (0..8).map(|bit| 1u8 << bit).chain([0xff]) {
            let mut wrong = right.clone();
            wrong[at] ^= flip;
            fs::write(&path, &wrong).expect("write");
            let refusal = Stored::open(&path).expect_err("it is damaged");
            assert_eq!((refusal.exit_code(), refusal.to_string().lines().count()), (3, 1), "byte {at}: {refusal}");
        }
    }
}

#[test]
fn every_truncation_is_detected() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ptc");
    small(&path, 0, 0);
    let right = fs::read(&path).expect("written");
    for length in 0..right.len() {
        fs::write(&path, &right[..length]).expect("write");
        let refusal = Stored::open(&path).expect_err("it is truncated").to_string();
        let expected = if length < 12 { "expected a part of a render (.ptc)" } else { "truncated: " };
        assert!(refusal.contains(expected), "{length}: {refusal}");
    }
    fs::write(&path, [&right[..], b"\n"].concat()).expect("write");
    assert!(Stored::open(&path).expect_err("it is too long").to_string().contains("damaged"));
}

/// A file of the format before this one is told from other files.
#[test]
fn files_of_earlier_versions_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ptc");
    fs::write(&path, b"\x89PTC\r\n\x1a\n and what it held").expect("write");
    let refusal = Stored::open(&path).expect_err("it is old");
    assert!(refusal.exit_code() == 3 && refusal.to_string().contains("of an earlier version of pt"), "{refusal}");
}

/// A valid checksum does not make a header valid: its values are checked too.
#[test]
fn headers_that_make_no_sense_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ptc");
    small(&path, 0, 0);
    let right = fs::read(&path).expect("written");
    let header_length = u32::from_le_bytes(right[8..12].try_into().expect("four")) as usize;
    let header: serde_json::Value = serde_json::from_slice(&right[12..12 + header_length]).expect("JSON");
    // Some are found when the numbers are read.
    let rewritten = |key: &str, value: serde_json::Value| {
        let mut header = header.clone();
        header[key] = value;
        let header = serde_json::to_vec(&header).expect("JSON");
        let numbers = &right[12 + header_length..right.len() - 16];
        let mut bytes = [&right[..8], &(header.len() as u32).to_le_bytes(), &header, numbers].concat();
        let mut sum = pt::math::hash::Hasher::default();
        sum.bytes(&bytes);
        bytes.extend(sum.finish().0.to_le_bytes());
        fs::write(&path, bytes).expect("write");
        Stored::open(&path).and_then(|stored| merge(vec![stored]))
    };
    assert!(rewritten("invalid", 3.into()).is_ok(), "the file is put together rightly");
    for (key, value) in [
        ("blocks", "[]"),
        ("blocks", "[[1, 1]]"),
        ("blocks", "[[0, 64]]"),
        ("blocks", "[[0, 57]]"),
        ("adaptive", "true"),
        ("blocks", "[[18446744073709551615, 0]]"),
        ("blocks", "[[0, 0], [0, 0]]"),
        ("blocks", "[[0, 0], [1, 0]]"),
        ("size", "[4294967295, 4294967295]"),
        ("size", "[1, 1]"),
        ("crop", "[0, 0, 0, 1]"),
        ("crop", "[2, 0, 0, 1]"),
        ("crop", "[0, 1, 0, 1]"),
        ("scramblings", "3"),
        ("scramblings", "4294967295"),
        ("scramblings", "4"),
        ("numbers", "0"),
        ("numbers", "18446744073709551615"),
        ("command", "3"),
        ("planned", "-1"),
        ("seconds", "-1"),
        ("seconds", "1e300"),
        ("seconds", "null"),
        ("scene", "\"0\""),
        ("facts", "{}"),
        ("course", r#"[{"samples": 1, "seconds": "x", "error": null}]"#),
    ] {
        let refusal = rewritten(key, serde_json::from_str(value).expect("JSON")).map(|_| ()).expect_err(value);
        assert_eq!(refusal.exit_code(), 3, "{key} {value}: {refusal}");
    }
}

/// The numbers of samples of the pixels come back. Those that no pixel can have are refused, as is a file that says that it has none.
#[test]
fn allocations_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ptc");
    let with_levels = |levels: [u8; 2]| {
        small(&path, 0, 0);
        let plain = stored(&path);
        let about = About { allocation: Allocation::new(levels.to_vec()), ..plain.about.clone() };
        let mut film = about.film();
        for (wave, block) in merge(vec![plain]).expect("a part").film.blocks() {
            film.add(wave, block.clone());
        }
        super::write(&path, &about, &film, &RenderReport::default(), &ErrorHistory::default());
    };
    with_levels([0, 6]);
    let part = stored(&path);
    assert_eq!(part.about.allocation.all(), Some(&[0, 6][..]));
    assert_eq!(merge(vec![part]).expect("a part").film.spec().allocation.samples(1, 1), 64);
    let right = fs::read(&path).expect("written");
    for at in 0..right.len() {
        fs::write(&path, [&right[..at], &[right[at] ^ 1], &right[at + 1..]].concat()).expect("write");
        assert_eq!(Stored::open(&path).expect_err("it is damaged").exit_code(), 3, "byte {at}");
    }
    // The header now says that all pixels have the same number of samples, but their levels are still in the file: it is longer than the header
    // allows.
    let length = u32::from_le_bytes(right[8..12].try_into().expect("four")) as usize;
    let header = String::from_utf8(right[12..12 + length].to_vec()).expect("JSON").replace(r#""adaptive":true"#, r#""adaptive":false"#);
    let mut bytes = [&right[..8], &(header.len() as u32).to_le_bytes(), header.as_bytes(), &right[12 + length..right.len() - 16]].concat();
    let mut sum = pt::math::hash::Hasher::default();
    sum.bytes(&bytes);
    bytes.extend(sum.finish().0.to_le_bytes());
    fs::write(&path, bytes).expect("write");
    assert_eq!(Stored::open(&path).expect_err("a chunk too many").exit_code(), 3);
}

#[test]
fn numbers_come_back_bit_by_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ptc");
    small(&path, 8, 2);
    let part = merge(vec![stored(&path)]).expect("a part");
    let expected: Vec<u64> = (0..16).map(|i| [0.0, -0.0, 1.0, f64::MIN_POSITIVE, 1e300, 0.1][i % 6].to_bits()).collect();
    assert_eq!(numbers(&part.film), [(8, 2, expected)]);
    assert_eq!(part.whole().err(), Some(0..8));
}

#[test]
fn overlapping_parts_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let [a, b] = ["a.ptc", "b.ptc"].map(|name| folder.path().join(name));
    small(&a, 0, 3);
    small(&b, 4, 1);
    let refusal = merge(vec![stored(&b), stored(&a)]).map(|_| ()).expect_err("they overlap").to_string();
    assert_eq!(refusal, format!("{}: samples 4..6 are in {} too", b.display(), a.display()));
    small(&b, 8, 1);
    assert!(merge(vec![stored(&b), stored(&a)]).is_ok());
}

/// A job that ran twice leaves two files with the same numbers, one of which counts. Their times may differ.
#[test]
fn copies_count_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let [a, b] = ["a.ptc", "b.ptc"].map(|name| folder.path().join(name));
    small(&a, 0, 3);
    let once = merge(vec![stored(&a)]).expect("a part");
    let report = RenderReport { elapsed: std::time::Duration::from_secs(7), ..RenderReport::default() };
    part::write(&b, &once.about, &once.film, &report, &once.history).expect("written");
    let twice = merge(vec![stored(&a), stored(&b)]).expect("parts");
    assert_eq!((numbers(&twice.film), &twice.copies), (numbers(&once.film), &vec![b.clone()]));
    assert_eq!(twice.report.samples, 8);
    // Other numbers for the same samples are no copy.
    let mut film = once.about.film();
    film.add(Wave { first: 0, level: 3 }, PixelSums::black(ErrorEstimator::Samples, 2));
    part::write(&b, &once.about, &film, &report, &once.history).expect("written");
    assert!(merge(vec![stored(&a), stored(&b)]).is_err());
}

/// What the packed numbers become follows from the header: a file whose numbers are none, or that has more or fewer of them, is refused
/// when they are read.
#[test]
fn numbers_that_cannot_be_unpacked_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ptc");
    small(&path, 0, 0);
    let right = fs::read(&path).expect("written");
    let start = 12 + u32::from_le_bytes(right[8..12].try_into().expect("four")) as usize;
    let chunk = &right[start + 4..right.len() - 16];
    for wrong in [&chunk[..chunk.len() - 1], &[chunk, &[0]].concat(), &[9; 80], &[]] {
        let mut bytes = [&right[..start], &(wrong.len() as u32).to_le_bytes(), wrong].concat();
        let mut sum = pt::math::hash::Hasher::default();
        sum.bytes(&bytes);
        bytes.extend(sum.finish().0.to_le_bytes());
        fs::write(&path, bytes).expect("write");
        let refusal = merge(vec![stored(&path)]).map(|_| ()).expect_err("they are none");
        assert!(refusal.exit_code() == 3 && refusal.to_string().contains("its numbers cannot be unpacked"), "{refusal}");
    }
}
