//! Reads measured intensities of lamps from IES files (IESNA LM-63, photometry of type C).
//!
//! Source: ANSI/IESNA LM-63-02, *Standard File Format for the Electronic Transfer of Photometric Data*.

use crate::light::IntensityProfile;
use crate::{Error, Fault, Result};

/// Reads the content of an IES file. Returns the profile, and what is left out of it as sentences that begin with `name`.
///
/// Only the ratios of the values count: the lamp's own light, its ballast and its size are not used.
///
/// # Errors
/// `Invalid` where the content is no IES file, or one that pt does not read.
pub fn read(content: &[u8], name: &str) -> Result<(IntensityProfile, Vec<String>)> {
    let refused = |message: &str| Error::invalid(Fault::new(message).in_file(name));
    let text = String::from_utf8_lossy(content);
    let (line, tilt) = text
        .lines()
        .enumerate()
        .find_map(|(line, text)| Some((line, text.trim().strip_prefix("TILT=")?.trim().to_owned())))
        .ok_or_else(|| refused("no IES file: it has no line that begins with TILT="))?;
    let rest: String = text.lines().skip(line + 1).collect::<Vec<_>>().join(" ");
    let numbers = rest.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty()).map(|word| {
        let number = word.parse::<f64>().ok().filter(|x| x.is_finite());
        number.ok_or_else(|| refused(&format!("expected a number after TILT=, found {word:?}")))
    });
    let mut numbers = Numbers { found: numbers.collect::<Result<Vec<f64>>>()?, next: 0, name };
    let mut warnings = vec![];
    match tilt.as_str() {
        "NONE" => {}
        "INCLUDE" => {
            numbers.take(1)?;
            let count = numbers.count("tilt angles")?;
            numbers.take(2 * count)?;
            warnings.push(format!("{name}: its factors for a tilted lamp are left out"));
        }
        other => return Err(refused(&format!("TILT={other}: expected TILT=NONE or TILT=INCLUDE"))),
    }
    numbers.take(3)?;
    let (rows, columns) = (numbers.count("vertical angles")?, numbers.count("horizontal angles")?);
    let kind = numbers.take(1)?[0];
    if kind != 1.0 {
        return Err(refused(&format!("photometry of type {}: expected type C, which is 1", type_name(kind))));
    }
    // Units, width, length, height; factors of the ballast; watts.
    numbers.take(7)?;
    let (vertical, horizontal) = (numbers.take(rows)?.to_vec(), numbers.take(columns)?.to_vec());
    let values = numbers.take(rows * columns)?.to_vec();
    if let Some(wrong) = values.iter().find(|value| **value < 0.0) {
        return Err(refused(&format!("expected intensities of at least 0, found {wrong}")));
    }
    let curve = |i: usize| &values[i * rows..(i + 1) * rows];
    let all_around = unfolded(&horizontal)
        .ok_or_else(|| refused("expected horizontal angles that rise from 0 to 0, 90, 180 or 360 degrees, or from 90 to 270 degrees"))?;
    let radians = |degrees: f64| degrees.to_radians() as f32;
    let whole = all_around.iter().flat_map(|(_, i)| curve(*i).iter().copied()).collect();
    let around = all_around.iter().map(|(angle, _)| radians(*angle)).collect();
    let profile = IntensityProfile::new(vertical.iter().map(|angle| radians(*angle)).collect(), around, whole);
    let profile =
        profile.ok_or_else(|| refused("expected vertical angles that rise within 0 to 180 degrees, and some intensity above 0"))?;
    Ok((profile, warnings))
}

fn type_name(kind: f64) -> String {
    match kind {
        2.0 => "B".into(),
        3.0 => "A".into(),
        other => other.to_string(),
    }
}

/// The angles from 0 to 360 degrees that a list of horizontal angles stands for by symmetry, each with its index in the list; `None` for
/// a list without meaning.
fn unfolded(angles: &[f64]) -> Option<Vec<(f64, usize)>> {
    if !angles.windows(2).all(|pair| pair[0] < pair[1]) {
        return None;
    }
    let (first, last) = (*angles.first()?, *angles.last()?);
    let own = || angles.iter().copied().enumerate().map(|(i, angle)| (angle, i));
    let mut all: Vec<(f64, usize)> = match (first, last) {
        (0.0, 0.0) => vec![(0.0, 0), (360.0, 0)],
        (0.0, 360.0) => own().collect(),
        (0.0, 180.0) => own().chain(own().map(|(angle, i)| (360.0 - angle, i))).collect(),
        (0.0, 90.0) => own().flat_map(|(a, i)| [a, 180.0 - a, 180.0 + a, 360.0 - a].map(|angle| (angle, i))).collect(),
        (90.0, 270.0) => {
            let turned = own().flat_map(|(a, i)| [a, (540.0 - a).rem_euclid(360.0)].map(|angle| (angle, i)));
            let seam = own().find(|(angle, _)| *angle == 180.0).map(|(_, i)| [(0.0, i), (360.0, i)]);
            turned.chain(seam?).collect()
        }
        _ => return None,
    };
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.dedup_by(|a, b| a.0 == b.0);
    Some(all)
}

/// The numbers of a file, of which some are taken already.
struct Numbers<'a> {
    found: Vec<f64>,
    next: usize,
    name: &'a str,
}

impl Numbers<'_> {
    fn take(&mut self, count: usize) -> Result<&[f64]> {
        let (from, found) = (self.next, self.found.len());
        let end = from.checked_add(count).filter(|end| *end <= found);
        self.next = end.ok_or_else(|| {
            let message = format!("ends too early: {found} numbers after TILT=, expected {count} more after the first {from}");
            Error::invalid(Fault::new(message).in_file(self.name))
        })?;
        Ok(&self.found[from..self.next])
    }

    /// A number of things that follow.
    fn count(&mut self, what: &str) -> Result<usize> {
        let (number, name) = (self.take(1)?[0], self.name);
        let is_count = number >= 1.0 && number.fract() == 0.0 && number <= f64::from(1u32 << 16);
        let refused = || Error::invalid(Fault::new(format!("expected a number of {what} from 1 to 65536, found {number}")).in_file(name));
        if is_count { Ok(number as usize) } else { Err(refused()) }
    }
}
