//! Picture files: writing, as a whole or not at all, and reading.

mod agx;
pub mod attributes;
pub mod colormap;
pub(crate) mod decode;
mod decode_error;
pub mod exposure;
pub mod exr;
pub mod hash;
pub mod hdr;
pub mod layer;
mod open;
#[cfg(feature = "cli")]
mod pace;
#[cfg(feature = "cli")]
pub(crate) mod page;
pub mod pfm;
pub mod png;
mod read;
mod rgb_image;
#[cfg(feature = "cli")]
pub mod serve;
#[cfg(feature = "cli")]
pub mod tev;
pub mod tonemap;

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::error::{Error, Fault, Result};
use crate::film::{FilmSpec, Image};

pub use crate::math::hash::Hash;
pub use attributes::{Attributes, Value};
pub use colormap::Colormap;
pub use hash::hash;
pub use layer::{Pick, window};
pub use open::regular;
pub use read::{facts, read};
pub use tonemap::{Curve, Tonemap};

/// File formats that can be written, by extension. All of them can be read too, see [`read()`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Linear f32, every channel.
    Exr,
    /// Linear, red, green and blue with 8 bits each and one exponent.
    Hdr,
    /// sRGB, 8 bits.
    Png,
    /// sRGB, 8 bits, no compression.
    Ppm,
    /// Linear f32, red, green, blue.
    Pfm,
}

impl Format {
    /// Extensions of all formats, for messages.
    pub const EXTENSIONS: &str = ".exr, .hdr, .png, .ppm or .pfm";

    /// Format of a path by its extension; `None` for an unknown one.
    pub fn of(path: &Path) -> Option<Format> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "exr" => Some(Format::Exr),
            "hdr" => Some(Format::Hdr),
            "png" => Some(Format::Png),
            "ppm" => Some(Format::Ppm),
            "pfm" => Some(Format::Pfm),
            _ => None,
        }
    }
}

/// Writes `image` in the format of the path's extension. An existing file is replaced when the new one is complete.
///
/// # Errors
/// `Usage` for an unknown extension, `Io` if the system refuses.
pub fn write(path: &Path, image: &Image, attributes: &Attributes, tonemap: &Tonemap) -> Result<()> {
    let unknown = || Error::Usage(format!("{}: expected a name that ends in {}", path.display(), Format::EXTENSIONS));
    let bytes = match Format::of(path).ok_or_else(unknown)? {
        Format::Exr => exr::encode(image, attributes)?,
        Format::Hdr => hdr::encode(image)?,
        Format::Png => png::encode(image, tonemap)?,
        Format::Ppm => png::encode_ppm(image, tonemap),
        Format::Pfm => pfm::encode(image),
    };
    replace(path, &bytes)
}

/// Replaces the file at `path` by these bytes at once; on an error the old file stays.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    replace_with(path, |file| file.write_all(bytes))
}

/// Replaces a file as [`replace`] does, with bytes that are written piece by piece.
///
/// If `path` is a link, the file that it leads to is replaced. A pipe or a device is written to and stays.
pub fn replace_with(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> Result<()> {
    let put = || -> io::Result<()> {
        if is_special(path) {
            return write(&mut File::options().write(true).open(path)?);
        }
        let target = target(path)?;
        let mut file = beside(&target)?;
        // The file itself is used: its wrapper would name the temporary path in errors.
        write(file.as_file_mut())?;
        file.as_file().sync_all()?;
        file.persist(&target)?;
        // A folder is written to the disk later than its files, and a power failure before that would undo the renaming. Where a folder
        // cannot be opened as a file, as on Windows, this step is left out.
        let _ = File::open(folder(&target)).and_then(|folder| folder.sync_all());
        Ok(())
    };
    put().map_err(|e| Error::io(path, e))
}

/// Checks that `path` could be written.
///
/// # Errors
/// `Io` if its folder is missing or read-only.
pub fn check_folder(path: &Path) -> Result<()> {
    let check = || -> io::Result<()> {
        if is_special(path) {
            return Ok(());
        }
        let target = target(path)?;
        let missing = || io::Error::new(io::ErrorKind::NotFound, format!("there is no folder {}", folder(&target).display()));
        let named = |e: io::Error| if e.kind() == io::ErrorKind::NotFound { missing() } else { e };
        beside(&target).map(drop).map_err(named)
    };
    check().map_err(|e| Error::io(path, e))
}

/// Checks that a picture from a file shows the pixels of the scene's film.
///
/// # Errors
/// `Invalid` if it does not.
pub fn same_pixels(path: &Path, image: &Image, film: &FilmSpec) -> Result<()> {
    let (expected, found) = (film.crop.size(), image.size);
    if (found, image.origin) == (expected, film.crop.min) {
        return Ok(());
    }
    let text = format!("expected {} × {} pixels as the scene has, found {} × {}", expected.x, expected.y, found.x, found.y);
    Err(Error::invalid(Fault::new(text).in_file(path)))
}

/// Returns whether `path` is a pipe, a device or the like, which is written to and not replaced.
fn is_special(path: &Path) -> bool {
    path.metadata().is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// More links than any system follows.
const MOST_LINKS: usize = 64;

/// File that `path` leads to, which need not exist; `path` itself if it is not a link.
///
/// # Errors
/// Links that lead in a circle.
pub fn target(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        match target.read_link() {
            // A relative link starts from its own folder; an absolute one replaces the path.
            Ok(next) => target = folder(&target).join(next),
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::other("links that lead in a circle"))
}

/// Temporary file in the folder of `path`, with the usual permissions: a picture is not a secret.
fn beside(path: &Path) -> io::Result<NamedTempFile> {
    // The system's message is kept without the temporary name, as the user knows only `path`.
    let mut refusal = None;
    let create = |temporary: &Path| File::create_new(temporary).inspect_err(|e| refusal = e.raw_os_error());
    let made = tempfile::Builder::new().prefix(".pt-").make_in(folder(path), create);
    made.map_err(|e| refusal.map_or(e, io::Error::from_raw_os_error))
}

/// Folder of `path`.
pub fn folder(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
