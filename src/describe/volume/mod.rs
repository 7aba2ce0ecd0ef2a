//! Reads grids of numbers and colours from files: properties of media.

mod pbrt;
mod vdb;
mod vol;

use glam::{DVec3, UVec3};

use crate::describe::ValuesAt;
use crate::medium::{MOST_VALUES, value_count};
use crate::{Error, Fault, Result};

/// Numbers or colours on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// The number of values along each axis.
    pub size: UVec3,
    /// The number of channels of each value: 1, or 3 for linear red, green and blue.
    pub channels: usize,
    /// The channels of the first value, of the second and so on, each within the range of the quantity: x varies fastest, then y, then z.
    pub values: Vec<f32>,
    /// The lower and upper corner of the box that the file gives them, in metres.
    pub bounds: Option<[DVec3; 2]>,
}

/// What the values of a grid are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A density: a number of at least 0.
    Density,
    /// An albedo: a number or a colour from 0 to 1.
    Albedo,
    /// A factor of an emission: a number or a colour of at least 0.
    Emission,
}

impl Quantity {
    /// Whether a value has this number of channels.
    fn has_channels(self, channels: usize) -> bool {
        channels == 1 || channels == 3 && self != Quantity::Density
    }

    /// The numbers of channels that a value may have.
    fn possible_channels(self) -> &'static str {
        if self == Quantity::Density { "one channel, the density" } else { "one channel or three" }
    }

    /// What is expected of the values.
    fn range(self) -> (&'static str, f32) {
        match self {
            Quantity::Density => ("finite densities of at least 0", f32::MAX),
            Quantity::Albedo => ("albedos from 0 to 1", 1.0),
            Quantity::Emission => ("finite factors of at least 0", f32::MAX),
        }
    }
}

/// What is asked of a file.
#[derive(Clone, Copy, Debug)]
pub struct Request<'r> {
    /// What the values are.
    pub quantity: Quantity,
    /// The number of values along each axis, which files of floats do not tell.
    pub size: Option<UVec3>,
    /// The name of the grid in an OpenVDB file, which one with a single grid does not need.
    pub grid: Option<&'r str>,
    /// Where in the box the values are.
    pub values_at: ValuesAt,
    /// For a colour grid, the box of the density's file: a grid of an OpenVDB file is read within this box.
    pub bounds: Option<[DVec3; 2]>,
}

/// Reads a grid: OpenVDB's `.vdb` and Mitsuba's `.vol` by their first bytes, a file of pbrt by the end of its name, and any other as 32-bit
/// floats.
///
/// # Errors
/// `Invalid` where the content is not that of such a file, or not what was asked of it; `Limit` for too many values.
pub fn read(content: &[u8], name: &str, request: Request) -> Result<Volume> {
    let Request { quantity, size, grid, .. } = request;
    let volume = if content.starts_with(vdb::MAGIC) {
        vdb::read(content, request)
    } else if grid.is_some() {
        invalid("\"grid\" is for OpenVDB files, and this is none: leave it out")
    } else if content.starts_with(vol::MAGIC) {
        vol::read(content, quantity)
    } else if name.ends_with(".pbrt") {
        pbrt::read(&String::from_utf8_lossy(content), quantity)
    } else {
        floats(content, size, quantity)
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
    let (expected, most) = quantity.range();
    match volume.values.iter().position(|value| !(0.0..=most).contains(value)) {
        None => Ok(volume),
        Some(wrong) => {
            let [x, y] = [volume.size.x as usize, volume.size.y as usize];
            let cell = wrong / volume.channels;
            let place = format!("x {}, y {}, z {}", cell % x, cell / x % y, cell / x / y);
            refused(format!("expected {expected}, found {} at {place}", volume.values[wrong]))
        }
    }
}

/// Reads 32-bit floats, little-endian.
fn floats(content: &[u8], size: Option<UVec3>, quantity: Quantity) -> Result<Volume> {
    let Some(size) = size else {
        return invalid(
            "no file of OpenVDB (.vdb), Mitsuba (.vol) or pbrt (.pbrt): if it holds only 32-bit floats, give their \"size\" along x, y and z",
        );
    };
    let count = counted(size)?;
    match [1, 3].into_iter().find(|channels| quantity.has_channels(*channels) && content.len() == 4 * count * channels) {
        Some(channels) => Ok(Volume { size, channels, values: to_floats(content), bounds: None }),
        None => {
            let or_three = if quantity.has_channels(3) { format!(", or {} for three channels", 12 * count) } else { String::new() };
            let (size, found) = (by_axis(size), content.len());
            invalid(format!("expected {} bytes for {size} floats of 32 bits{or_three}, found {found}", 4 * count))
        }
    }
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
