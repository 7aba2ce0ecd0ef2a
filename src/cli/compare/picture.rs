//! `--picture NAME=FILE@DURATION`: pictures of other renderers as contestants.

use std::path::PathBuf;

use super::super::parse::duration;
use super::super::quote::quoted;
use super::{GivenPicture, MethodConfig, read_picture};
use crate::error::{Error, Result};
use crate::film::FilmSpec;

/// Name, file and time of a picture.
#[derive(Clone, Debug)]
pub struct PictureArg {
    name: String,
    file: PathBuf,
    seconds: f64,
}

/// Reads `other=other.exr@12.5s`. A file name may contain `=` and `@`.
pub fn parse(text: &str) -> std::result::Result<PictureArg, String> {
    let expected = || "expected NAME=FILE@DURATION, such as other=other.exr@12.5s".to_owned();
    let (name, rest) = text.split_once('=').ok_or_else(expected)?;
    let (file, time) = rest.rsplit_once('@').ok_or_else(expected)?;
    if name.is_empty() || file.is_empty() {
        return Err(expected());
    }
    let seconds = duration(time).map_err(|e| format!("{time:?} after @: {e}"))?.as_secs_f64();
    Ok(PictureArg { name: name.into(), file: file.into(), seconds })
}

/// Reads the pictures. A contestant has a name of its own.
pub fn read(pictures: &[PictureArg], configs: &[MethodConfig], film: &FilmSpec) -> Result<Vec<GivenPicture>> {
    let one = |PictureArg { name, file, seconds }: &PictureArg| {
        if configs.iter().any(|config| config.name == *name) {
            return Err(Error::Usage(format!("--picture {name}: expected another name, {name} is a method that is rendered")));
        }
        let image = read_picture(file, film, "picture")?.0;
        Ok(GivenPicture { name: name.clone(), file: quoted(&file.display().to_string()), seconds: *seconds, image })
    };
    pictures.iter().map(one).collect()
}
