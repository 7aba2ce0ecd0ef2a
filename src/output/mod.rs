//! Pictures to files: whole or not at all.

pub mod exr;
pub mod pfm;
pub mod png;
pub mod tonemap;

use std::io::Write;
use std::path::Path;

use crate::error::{Error, Result};
use crate::film::Image;

pub use tonemap::{Curve, Tonemap};

/// The file types that can be written, by extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Linear f32, every channel.
    Exr,
    /// sRGB, 8 bits.
    Png,
    /// sRGB, 8 bits, no compression.
    Ppm,
    /// Linear f32, red, green, blue.
    Pfm,
}

impl Format {
    pub const EXTENSIONS: &str = ".exr, .png, .ppm or .pfm";

    pub fn of(path: &Path) -> Option<Format> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "exr" => Some(Format::Exr),
            "png" => Some(Format::Png),
            "ppm" => Some(Format::Ppm),
            "pfm" => Some(Format::Pfm),
            _ => None,
        }
    }
}

/// Facts about a picture that its file carries: functions of scene and settings, never of clock or host.
pub type Attributes = Vec<(String, String)>;

/// Writes `image` in the format of the path's extension; an existing file is replaced when the new one is complete.
///
/// # Errors
/// `Usage` for an unknown extension, `Io` where the system refuses.
pub fn write(path: &Path, image: &Image, attributes: &Attributes, tonemap: &Tonemap) -> Result<()> {
    let unknown = || Error::Usage(format!("{}: expected a name that ends in {}", path.display(), Format::EXTENSIONS));
    let bytes = match Format::of(path).ok_or_else(unknown)? {
        Format::Exr => exr::encode(image, attributes)?,
        Format::Png => png::encode(image, tonemap)?,
        Format::Ppm => png::encode_ppm(image, tonemap),
        Format::Pfm => pfm::encode(image),
    };
    replace(path, &bytes)
}

/// The bytes appear under `path` at once, or the old file stays.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    let put = || -> std::io::Result<()> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".pt-");
        // What the user's mask leaves of read and write for all: a picture is not a secret.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.tempfile_in(folder(path))?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    put().map_err(|e| Error::io(path, e))
}

/// Whether a file could be made beside `path`.
///
/// # Errors
/// `Io` where the folder is missing or read-only.
pub fn check_folder(path: &Path) -> Result<()> {
    tempfile::Builder::new().prefix(".pt-").tempfile_in(folder(path)).map(drop).map_err(|e| Error::io(path, e))
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
