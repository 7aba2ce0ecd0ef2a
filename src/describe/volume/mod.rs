//! Reads grids of numbers from files: densities of media.

mod pbrt;
mod vol;

use glam::{DVec3, UVec3};

use crate::medium::{MOST_VALUES, value_count};
use crate::{Error, Fault, Result};

/// Numbers on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// The number of values along each axis.
    pub size: UVec3,
    /// The values, each finite and at least 0: x varies fastest, then y, then z.
    pub values: Vec<f32>,
    /// The lower and upper corner of the box that the file gives them, in metres.
    pub bounds: Option<[DVec3; 2]>,
}

/// Reads a grid: Mitsuba's `.vol` by its first bytes, a file of pbrt by the end of its name, and any other as 32-bit floats.
///
/// - `size`: the number of values along each axis, which files of floats do not tell
///
/// # Errors
/// `Invalid` where the content is not that of such a file, or where `size` is another than that of the file; `Limit` for too many values.
pub fn read(content: &[u8], name: &str, size: Option<UVec3>) -> Result<Volume> {
    let volume = if content.starts_with(vol::MAGIC) {
        vol::read(content)
    } else if name.ends_with(".pbrt") {
        pbrt::read(&String::from_utf8_lossy(content))
    } else {
        floats(content, size)
    };
    let volume = volume.map_err(|error| match error {
        Error::Invalid(faults) => Error::Invalid(faults.into_iter().map(|fault| fault.in_file(name)).collect()),
        Error::Limit(fault) => Error::Limit(fault.in_file(name)),
        other => other,
    })?;
    let refused = |message: String| Err(Error::invalid(Fault::new(message).in_file(name)));
    if size.is_some_and(|size| size != volume.size) {
        return refused(format!("the file has {} values, and \"size\" says otherwise: leave it out", by_axis(volume.size)));
    }
    match volume.values.iter().position(|value| !(value.is_finite() && *value >= 0.0)) {
        None => Ok(volume),
        Some(wrong) => {
            let [x, y] = [volume.size.x as usize, volume.size.y as usize];
            let place = format!("x {}, y {}, z {}", wrong % x, wrong / x % y, wrong / x / y);
            refused(format!("expected finite densities of at least 0, found {} at {place}", volume.values[wrong]))
        }
    }
}

/// Reads 32-bit floats, little-endian.
fn floats(content: &[u8], size: Option<UVec3>) -> Result<Volume> {
    let Some(size) = size else {
        return invalid("no file of Mitsuba (.vol) or pbrt (.pbrt): if it holds only 32-bit floats, give their \"size\" along x, y and z");
    };
    let count = counted(size)?;
    if content.len() != 4 * count {
        let found = content.len();
        return invalid(format!("expected {} bytes for {} floats of 32 bits, found {found}", 4 * count, by_axis(size)));
    }
    Ok(Volume { size, values: to_floats(content), bounds: None })
}

fn to_floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect()
}

/// Number of values of a grid.
fn counted(size: UVec3) -> Result<usize> {
    value_count(size)
        .ok_or_else(|| Error::Limit(Fault::new(format!("a grid of {} values, at most {MOST_VALUES} are possible", by_axis(size)))))
}

fn by_axis(size: UVec3) -> String {
    format!("{} × {} × {}", size.x, size.y, size.z)
}

fn invalid<T>(message: impl Into<String>) -> Result<T> {
    Err(Error::invalid(Fault::new(message)))
}
