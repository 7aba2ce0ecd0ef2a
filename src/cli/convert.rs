//! `pt convert IN OUT`: a scene of any dialect in pt's own format; its picture has the same bits.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::load::{Loaded, load};
use super::{args, note};
use crate::describe::{Files, files_of};
use crate::error::{Error, Result};
use crate::integrator::Entry;
use crate::output::{self, check_folder, replace};

/// Writes the scene, and into a folder beside it the files that came with it.
///
/// # Errors
/// As [`load`]: what cannot be rendered is not written. `Usage` where a scene would be overwritten; `Io`.
pub fn convert(args: &args::Convert, tables: &[&[Entry]]) -> Result<()> {
    let to = &args.output;
    let loaded = load(&args.scene, &[], None, tables)?;
    loaded.built.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    let usage = |message: &str| Error::Usage(format!("{}: {message}", to.display()));
    if to.extension().is_none_or(|extension| extension != "json") {
        return Err(usage("expected a name that ends in .json"));
    }
    if is_same_file(to, args.scene.path()?) {
        return Err(usage("is the scene file, which would be overwritten"));
    }
    check_folder(to)?;
    let folder = Folder::beside(to);
    let mut root = loaded.root.clone();
    let mut is_outside = false;
    for (pointer, name) in files_of(&loaded.description) {
        let name = folder.name_of(name, &loaded)?;
        is_outside |= Files::within(&folder.path).why_not(&name).is_some();
        root.set(&pointer, &serde_json::json!(name).to_string())?;
    }
    folder.fill(&loaded)?;
    replace(to, format!("{root}\n").as_bytes())?;
    if is_outside {
        note(&format!("note: {} names files outside of its folder: it is rendered with --allow-outside", to.display()));
    }
    Ok(())
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

/// Where the written scene lies, and the files that came with it.
struct Folder {
    /// Of the scene.
    path: PathBuf,
    /// Of the files, within it.
    files: PathBuf,
}

impl Folder {
    fn beside(scene: &Path) -> Folder {
        let mut files = scene.file_stem().unwrap_or(OsStr::new("scene")).to_owned();
        files.push("-files");
        Folder { path: output::folder(scene).to_owned(), files: files.into() }
    }

    /// What the written scene calls the file that the read one calls `name`.
    fn name_of(&self, name: &str, loaded: &Loaded) -> Result<String> {
        let path = match loaded.files.made.contains_key(name) {
            true => self.files.join(name),
            false => {
                let real = |path: &Path| path.canonicalize().map_err(|e| Error::io(path, e));
                let [from, to] = [real(output::folder(&loaded.files.folder.join("scene")))?, real(&self.path)?];
                if from == to { name.into() } else { pathdiff::diff_paths(from.join(name), to).unwrap_or_else(|| from.join(name)) }
            }
        };
        // As every system reads it.
        Ok(path.to_string_lossy().replace('\\', "/"))
    }

    fn fill(&self, loaded: &Loaded) -> Result<()> {
        let folder = self.path.join(&self.files);
        loaded.files.made.iter().try_for_each(|(name, bytes)| {
            let path = folder.join(name);
            std::fs::create_dir_all(output::folder(&path)).map_err(|e| Error::io(&folder, e))?;
            replace(&path, bytes)
        })
    }
}
