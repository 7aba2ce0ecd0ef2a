//! `--frames`: the pictures of a sequence, one after the other.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::json;

use super::{RenderArgs, render_one};
use crate::cli::load::shutter;
use crate::cli::signals;
use crate::error::{Error, Result};
use crate::integrator::Entry;

/// Share of the time of a picture for which the shutter is open where the scene does not say it: that of a film camera with a disk that
/// covers half of each turn.
const OPEN: f64 = 0.5;

/// Renders the pictures of a sequence. Each is a render of its own, of the scene with another shutter.
///
/// # Errors
/// Those of a render; `Usage` for a scene from stdin, which can be read only once, and for --resume without a number of samples.
pub fn render(args: &RenderArgs, frames: RangeInclusive<u32>, tables: &[&[Entry]]) -> Result<ExitCode> {
    if args.scene.path()? == Path::new("-") {
        return Err(Error::Usage("--frames: the scene is read for each picture, and stdin can be read only once".into()));
    }
    if args.resume.is_some() && (args.time.is_some() || args.target.is_some()) {
        return Err(Error::Usage(
            "--frames --resume: a picture is done when it has its samples: give --spp, not --time or --target".into(),
        ));
    }
    if matches!(args.resume, Some(Some(_))) {
        return Err(Error::Usage(
            "--frames --resume=FILE: each picture has a state of its own, beside its output: give --resume alone".into(),
        ));
    }
    let described = shutter(&args.scene, &args.overrides()?, args.named_integrator())?;
    let [open, close] = described.map_or([0.0, OPEN / args.fps], |shutter| [shutter.open.get(), shutter.close.get()]);
    let mut code = ExitCode::SUCCESS;
    for frame in frames {
        let later = f64::from(frame) / args.fps;
        let mut args = args.clone();
        let shutter = json!({ "open": open + later, "close": close + later });
        args.scene.overrides.push(format!("/shutter={shutter}"));
        args.output = args.output.iter().map(|path| numbered(path, frame)).collect();
        let of_frame = render_one(&args, Some(frame), tables)?;
        if of_frame != ExitCode::SUCCESS {
            code = of_frame;
        }
        if let Some(signal) = signals::caught() {
            return Err(Error::Interrupted(signal));
        }
    }
    Ok(code)
}

/// Name with the number of a picture before its extension: `x.0001.exr`.
fn numbered(path: &Path, frame: u32) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map_or_else(String::new, |extension| format!(".{}", extension.to_string_lossy()));
    path.with_file_name(format!("{}{extension}", numbered_stem(&stem, frame)))
}

/// Name without an extension, with the number of a picture.
pub fn numbered_stem(stem: &str, frame: u32) -> String {
    format!("{stem}.{frame:04}")
}
