//! `pt convert IN OUT`: writes a scene of any dialect in pt's own format; its picture has the same bits.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::load::SceneArgs;
use super::load::{Loaded, load};
use super::note;
use crate::describe::{Files, files_of};
use crate::error::{Error, Result};
use crate::integrator::Entry;
use crate::output::{self, check_folder, replace};

#[derive(clap::Args, Debug)]
pub struct ConvertArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Output file: .json. Files that came with the scene go into a folder beside it, others stay where they are.
    #[arg(value_name = "OUT")]
    pub output: Option<PathBuf>,
}

/// Writes the scene, and the files that came with it into a folder beside it.
///
/// # Errors
/// The errors of [`load`], because a scene that cannot be rendered is not written; `Usage` if a scene would be overwritten; `Io`.
pub fn convert(args: &ConvertArgs, tables: &[&[Entry]]) -> Result<()> {
    // clap requires no argument after one that it does not require, and the scene is one.
    let to = args.output.as_deref().ok_or_else(|| Error::Usage("expected where to write, as in pt convert IN OUT.json".into()))?;
    let loaded = load(&args.scene, &[], None, tables)?;
    loaded.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
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
        note(&format!("note: {} names files outside of its folder: to render it, add --allow-outside", to.display()));
    }
    Ok(())
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

/// Folder of the written scene, and of the files that came with it.
struct Folder {
    /// Folder of the scene.
    path: PathBuf,
    /// Folder of the files, relative to that of the scene.
    files: PathBuf,
}

impl Folder {
    fn beside(scene: &Path) -> Folder {
        let mut files = scene.file_stem().unwrap_or(OsStr::new("scene")).to_owned();
        files.push("-files");
        Folder { path: output::folder(scene).to_owned(), files: files.into() }
    }

    /// Name in the written scene for the file that the original scene calls `name`.
    fn name_of(&self, name: &str, loaded: &Loaded) -> Result<String> {
        let path = match loaded.files.made.contains_key(name) {
            true => self.files.join(name),
            false => {
                let real = |path: &Path| path.canonicalize().map_err(|e| Error::io(path, e));
                let [from, to] = [real(output::folder(&loaded.files.folder.join("scene")))?, real(&self.path)?];
                if from == to { name.into() } else { pathdiff::diff_paths(from.join(name), to).unwrap_or_else(|| from.join(name)) }
            }
        };
        // Slashes are understood by every system.
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
