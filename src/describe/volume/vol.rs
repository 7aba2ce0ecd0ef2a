//! Grids of Mitsuba: "VOL", a version, and a header of 48 bytes in all before the values.
//!
//! Source: Mitsuba 3, documentation of its `gridvolume`.

use glam::{DVec3, UVec3};

use super::{Quantity, Volume, counted, invalid, to_floats};
use crate::Result;

/// First bytes of such a file.
pub const MAGIC: &[u8] = b"VOL";
/// Bytes before the values: magic, version, encoding, three sizes, channels, and a box of six floats.
const HEADER: usize = 48;
const VERSION: u8 = 3;
/// Encoding of 32-bit floats.
const FLOAT32: u32 = 1;

/// Reads the content of a `.vol` file.
///
/// # Errors
/// `Invalid` where it is not one with a possible number of channels of 32-bit floats; `Limit` for too many values.
pub fn read(content: &[u8], quantity: Quantity) -> Result<Volume> {
    let Some((header, values)) = content.split_at_checked(HEADER) else {
        return invalid(format!("the file ends within its header of {HEADER} bytes"));
    };
    if header[3] != VERSION {
        return invalid(format!("expected version {VERSION} of Mitsuba's format, found {}", header[3]));
    }
    let word = |place: usize| [header[place], header[place + 1], header[place + 2], header[place + 3]];
    let number = |place: usize| u32::from_le_bytes(word(place));
    if number(4) != FLOAT32 {
        return invalid(format!("expected values of encoding {FLOAT32}, 32-bit floats, found encoding {}", number(4)));
    }
    let size = UVec3::new(number(8), number(12), number(16));
    if size.min_element() == 0 {
        return invalid(format!("expected sizes above 0, found {} × {} × {}", size.x, size.y, size.z));
    }
    let channels = number(20) as usize;
    if !quantity.has_channels(channels) {
        return invalid(format!("expected {}, found {channels}", quantity.possible_channels()));
    }
    let bytes = 4 * channels * counted(size)?;
    if values.len() != bytes {
        return invalid(format!("expected {bytes} bytes after the header, found {}", values.len()));
    }
    let corner = |place: usize| DVec3::from_array([0, 4, 8].map(|step| f64::from(f32::from_le_bytes(word(place + step)))));
    let bounds = [corner(24), corner(36)];
    if !bounds.iter().all(|corner| corner.is_finite()) || bounds[0].cmpge(bounds[1]).any() {
        return invalid(format!("expected a box whose upper corner is above the lower one, found {} to {}", bounds[0], bounds[1]));
    }
    Ok(Volume { size, channels, values: to_floats(values), bounds: Some(bounds) })
}
