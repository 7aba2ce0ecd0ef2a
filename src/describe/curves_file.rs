//! Reads curves from files: `.hair` files, and lists of points as text.

use glam::Vec3;

use crate::{Error, Fault, Result};

/// The control points of curves.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePoints {
    /// The positions, curve after curve (m).
    pub positions: Vec<Vec3>,
    /// The radius at each point (m), where the file has one.
    pub radii: Option<Vec<f32>>,
    /// The number of points of each curve.
    pub counts: Vec<u32>,
}

/// Reads curves from a file, whose format is recognised by its first bytes: `HAIR` begins a .hair file, and any other file is text.
///
/// # Errors
/// `Invalid` where the file is neither: with the line in text, or what is wrong with a .hair file.
pub fn read(content: &[u8], name: &str) -> Result<CurvePoints> {
    let curves = if content.starts_with(b"HAIR") { hair(content) } else { text(content) };
    let curves = curves.and_then(|curves| if curves.counts.is_empty() { Err(Fault::new("no curves")) } else { Ok(curves) });
    curves.map_err(|fault| Error::invalid(fault.in_file(name)))
}

/// Text as Mitsuba's curves have it: a control point on each line, `x y z` and optionally its radius. An empty line ends a curve. What
/// follows a `#` is a comment.
fn text(content: &[u8]) -> std::result::Result<CurvePoints, Fault> {
    let (mut positions, mut radii, mut counts, mut count) = (vec![], vec![], vec![], 0);
    let text = String::from_utf8_lossy(content);
    for (k, line) in text.lines().chain([""]).enumerate() {
        if line.trim().is_empty() {
            counts.extend((count > 0).then_some(count));
            count = 0;
            continue;
        }
        let row = line.split('#').next().unwrap_or_default();
        if row.trim().is_empty() {
            continue;
        }
        let refused = |message: &str| Fault::new(message).at_line(k + 1);
        let numbers: Option<Vec<f32>> = row.split_whitespace().map(|word| word.parse().ok()).collect();
        let numbers = numbers.filter(|numbers| numbers.iter().all(|x: &f32| x.is_finite()));
        match numbers.as_deref() {
            Some([x, y, z]) if radii.is_empty() => positions.push(Vec3::new(*x, *y, *z)),
            Some([x, y, z, r]) if radii.len() == positions.len() && *r >= 0.0 => {
                positions.push(Vec3::new(*x, *y, *z));
                radii.push(*r);
            }
            Some([_, _, _]) => return Err(refused("expected a radius after x y z, as in the lines before")),
            Some([_, _, _, r]) if *r >= 0.0 => return Err(refused("expected x y z without a radius, as in the lines before")),
            _ => return Err(refused("expected a point: x y z, or x y z and a radius that is not negative")),
        }
        count += 1;
    }
    Ok(CurvePoints { positions, radii: (!radii.is_empty()).then_some(radii), counts })
}

/// Bytes of the header of a .hair file.
const HEADER: usize = 128;

/// Binary `.hair` files (cyHair): a header, then arrays: segments of each strand, positions, thickness, transparency, colours. The radius is
/// half the thickness. Transparency and colours are left out.
///
/// Source: Yuksel, *HAIR file format* (cyHairFile.h).
fn hair(content: &[u8]) -> std::result::Result<CurvePoints, Fault> {
    let truncated = |what: &str| Fault::new(format!("the file ends within {what}"));
    let header: &[u8; HEADER] = content.first_chunk().ok_or_else(|| truncated("its header"))?;
    let word = |at: usize| -> [u8; 4] { std::array::from_fn(|k| header[at + k]) };
    let [strands, points, flags, segments] = [4, 8, 12, 16].map(|at| u32::from_le_bytes(word(at)));
    let thickness = f32::from_le_bytes(word(20));
    let mut rest = &content[HEADER..];
    let mut array = |what: &str, is_there: bool, count: u32, size: usize| {
        let bytes = if is_there { count as usize * size } else { 0 };
        let (own, others) = rest.split_at_checked(bytes).ok_or_else(|| truncated(what))?;
        rest = others;
        Ok::<_, Fault>(own)
    };
    let own_segments = array("the segments", flags & 1 != 0, strands, 2)?;
    if flags & 2 == 0 {
        return Err(Fault::new("no points"));
    }
    let positions = array("the points", true, points, 12)?;
    let widths = array("the thickness", flags & 4 != 0, points, 4)?;
    let floats = |bytes: &[u8]| -> Vec<f32> { bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect() };
    let positions: Vec<Vec3> = floats(positions).as_chunks().0.iter().map(|xyz: &[f32; 3]| Vec3::from_array(*xyz)).collect();
    let radii: Vec<f32> = if flags & 4 != 0 { floats(widths) } else { vec![thickness; positions.len()] };
    let radii: Vec<f32> = radii.into_iter().map(|width| 0.5 * width).collect();
    let is_usable = |k: usize| positions[k].is_finite() && radii[k] >= 0.0 && radii[k].is_finite();
    if let Some(k) = (0..positions.len()).find(|k| !is_usable(*k)) {
        return Err(Fault::new(format!("point {k}: expected finite numbers and a thickness that is not negative")));
    }
    let counts: Vec<u32> = match flags & 1 != 0 {
        true => own_segments.as_chunks().0.iter().map(|bytes| u32::from(u16::from_le_bytes(*bytes)) + 1).collect(),
        false if u64::from(strands) * (u64::from(segments) + 1) <= u64::from(points) => vec![segments + 1; strands as usize],
        false => vec![],
    };
    let sum: u64 = counts.iter().map(|count| u64::from(*count)).sum();
    if sum != u64::from(points) {
        return Err(Fault::new(format!("{points} points, but the segments of {strands} strands need another number of them")));
    }
    // A thickness of 0 everywhere means that none is stated.
    let has_radii = radii.iter().any(|radius| *radius > 0.0);
    Ok(CurvePoints { positions, radii: has_radii.then_some(radii), counts })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(content: &[u8]) -> String {
        match read(content, "f") {
            Err(Error::Invalid(faults)) => faults.iter().map(|fault| format!("{}:{}", fault.line.unwrap_or(0), fault.message)).collect(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn text_is_read() {
        let curves = read(b"0 0 0 .1\n1 0 0 .2 # tip\n\n\n0 1 0 .3\n# a comment\n0 2 0 .4\n0 3 0 0\n", "f").expect("curves");
        assert_eq!(curves.counts, [2, 3]);
        assert_eq!(curves.radii, Some(vec![0.1, 0.2, 0.3, 0.4, 0.0]));
        assert_eq!(curves.positions[4], Vec3::new(0.0, 3.0, 0.0));
        assert_eq!(read(b"0 0 0\n1 0 0", "f").expect("curves").radii, None);
    }

    #[test]
    fn bad_text_is_told_with_its_line() {
        assert!(message(b"0 0 0\n1 0").starts_with("2:expected a point"));
        assert!(message(b"0 0 0\n1 0 0 1").starts_with("2:expected x y z without"));
        assert!(message(b"0 0 0 1\n1 0 0").starts_with("2:expected a radius"));
        assert!(message(b"0 0 0 -1").starts_with("1:expected a point"));
        assert!(message(b"0 0 nan").starts_with("1:expected a point"));
        assert_eq!(message(b"\n# nothing\n"), "0:no curves");
    }

    /// A file with two strands of one and two segments; the thickness is a hundredth of the point's number.
    fn binary(flags: u32) -> Vec<u8> {
        let mut bytes = b"HAIR".to_vec();
        [2u32, 5, flags, 1].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.extend(0.5f32.to_le_bytes());
        bytes.resize(HEADER, 0);
        if flags & 1 != 0 {
            [1u16, 2].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        }
        (0..15).for_each(|k| bytes.extend((k as f32).to_le_bytes()));
        if flags & 4 != 0 {
            (0..5).for_each(|k| bytes.extend((k as f32 / 100.0).to_le_bytes()));
        }
        bytes
    }

    #[test]
    fn hair_files_are_read() {
        let curves = read(&binary(7), "f").expect("curves");
        assert_eq!(curves.counts, [2, 3]);
        assert_eq!(curves.positions[1], Vec3::new(3.0, 4.0, 5.0));
        assert_eq!(curves.radii.expect("given")[4], 0.02);
        assert_eq!(read(&binary(3), "f").expect("curves").radii, Some(vec![0.25; 5]));
        assert_eq!(message(&binary(2)), "0:5 points, but the segments of 2 strands need another number of them");
        assert_eq!(message(&binary(1)), "0:no points");
        for end in [5, 127, 130, 150, 200] {
            assert!(message(&binary(7)[..end]).contains("ends within"), "{end}");
        }
    }
}
