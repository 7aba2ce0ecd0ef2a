//! Loading of a scene with the options of the command line.

use std::path::{Path, PathBuf};

use super::messages::Loading;
use crate::describe::{self, Files, Shutter};
use crate::error::{Error, Result};
use crate::import::{AutoCamera, ImportOptions, Imported, Up, Viewpoint, import_with};
use crate::integrator::Entry;
use crate::load::{exposure, override_values};
use crate::reader::Node;

pub use crate::load::Loaded;

/// Scene file, and how it is read.
#[derive(clap::Args, Clone, Debug)]
pub struct SceneArgs {
    /// The scene file; `-` reads it from stdin, with paths relative to the working directory.
    #[arg(value_name = "SCENE")]
    pub path: Option<PathBuf>,
    /// Override a value of the scene file: a JSON pointer and a JSON value. May be repeated.
    #[arg(short = 'D', value_name = "/POINTER=VALUE")]
    pub overrides: Vec<String>,
    /// Let the scene name meshes and pictures that lie outside of its own folder.
    #[arg(long)]
    pub allow_outside: bool,
    /// Side from which a camera shows the whole model (glTF, OBJ, PLY, STL). Default: the file's camera, or three-quarter.
    #[arg(long, value_name = "SIDE", value_parser = viewpoint)]
    view: Option<Viewpoint>,
    /// Axis of a model that points up, y or z. Default: y, for STL z.
    #[arg(long, value_name = "AXIS", value_parser = up)]
    up: Option<Up>,
    /// Put a matte ground under a model, to catch its shadow. Default: under a model that has no light.
    #[arg(long, overrides_with = "no_ground")]
    ground: bool,
    /// Put no ground under a model.
    #[arg(long)]
    no_ground: bool,
    /// Light the scene by a clear sky and its sun, in place of its background. -D /background/sky/elevation=5 is a low sun.
    #[arg(long)]
    sky: bool,
    /// Light the scene by a picture of the surroundings (environment map), in place of its background.
    #[arg(long, value_name = "FILE", conflicts_with = "sky")]
    environment: Option<PathBuf>,
    /// Light a model that has no light by the lamps of a studio, in place of the sky.
    #[arg(long, conflicts_with_all = ["sky", "environment"])]
    studio: bool,
}

impl SceneArgs {
    /// Path of the scene. clap cannot require it: a subcommand has a scene of its own, or none.
    pub fn path(&self) -> Result<&Path> {
        self.path.as_deref().ok_or_else(|| Error::Usage("expected a scene file, such as scenes/cornell-box.json; see pt --help".into()))
    }

    /// Another file, read in the same way.
    pub fn with_path(&self, path: &Path) -> SceneArgs {
        SceneArgs { path: Some(path.to_owned()), ..self.clone() }
    }

    /// Options for reading the scene. If `-D` sets the shutter, animations in imported files are read for that exposure.
    pub fn import_options(&self) -> ImportOptions {
        let ground = (self.ground || self.no_ground).then_some(self.ground);
        let auto_camera = AutoCamera { up: self.up, view: self.view, ground, studio: self.studio };
        let exposure = exposure(self.overrides.iter().filter_map(|text| text.split_once('=')));
        ImportOptions { allow_outside: self.allow_outside, auto_camera, exposure }
    }

    /// Applies `--sky`, `--environment` and then `-D`, which may change what those set.
    fn override_values(&self, root: &mut Node) -> Result<()> {
        if self.sky {
            root.set_by("--sky", "/background", r#"{"sky": {}}"#)?;
        }
        if let Some(name) = self.environment_name() {
            root.set_by("--environment", "/background", &serde_json::json!({ "image": name }).to_string())?;
        }
        let usage = |text: &str| Error::Usage(format!("-D {text}: expected /POINTER=VALUE, such as -D /camera/fov=60"));
        self.overrides.iter().try_for_each(|text| {
            let (pointer, value) = text.split_once('=').ok_or_else(|| usage(text))?;
            root.set(pointer, value)
        })
    }

    /// Name, in the scene, of the picture of `--environment`. No file of the scene's own folder is meant.
    fn environment_name(&self) -> Option<String> {
        let file = self.environment.as_ref()?.file_name().map_or_else(Default::default, |name| name.to_string_lossy());
        Some(format!("environment/{file}"))
    }

    /// Adds the picture of `--environment` to the files that come with the scene.
    fn add_environment(&self, files: &mut Files) -> Result<()> {
        if let (Some(path), Some(name)) = (&self.environment, self.environment_name()) {
            // The user names this file, not the scene, so it may lie anywhere.
            let anywhere = Files { allow_outside: true, ..Files::default() };
            files.made.insert(name, anywhere.bytes(&path.to_string_lossy())?);
        }
        Ok(())
    }

    /// The flags of the scene that decide the picture, as words of commands that repeat it.
    pub fn flags(&self) -> Vec<String> {
        let flags = [
            ("--sky", self.sky),
            ("--studio", self.studio),
            ("--ground", self.ground),
            ("--no-ground", self.no_ground),
            ("--allow-outside", self.allow_outside),
        ];
        let given = flags.into_iter().filter(|(_, is_given)| *is_given).map(|(flag, _)| flag.to_owned());
        let view = self.view.map(|view| ["--view".to_owned(), view.name.to_owned()]);
        let up = self.up.map(|up| ["--up".to_owned(), if up == Up::Z { "z" } else { "y" }.to_owned()]);
        let environment = self.environment.as_ref().map(|path| ["--environment".to_owned(), path.display().to_string()]);
        given.chain([view, up, environment].into_iter().flatten().flatten()).collect()
    }
}

fn viewpoint(text: &str) -> std::result::Result<Viewpoint, String> {
    let names = Viewpoint::ALL.map(|view| view.name).join(", ");
    Viewpoint::ALL.into_iter().find(|view| view.name == text).ok_or_else(|| format!("expected one of {names}"))
}

fn up(text: &str) -> std::result::Result<Up, String> {
    match text {
        "y" => Ok(Up::Y),
        "z" => Ok(Up::Z),
        _ => Err("expected y or z".to_owned()),
    }
}

/// Value of a flag that replaces a key of the scene.
pub struct Override {
    /// The flag as it was written, such as `--spp 16`, for messages about its value.
    pub words: String,
    /// Pointer of the key.
    pub pointer: &'static str,
    /// JSON value.
    pub value: String,
}

/// Reads the scene, applies overrides, and checks and builds it.
///
/// - `more`: overrides by flags of their own, applied after those of `-D`
///
/// # Errors
/// The errors of [`import_with`] and of [`load::load`](crate::load::load), and `Usage` for overrides of a value that the scene cannot have.
pub fn load(scene: &SceneArgs, more: &[Override], integrator: Option<&str>, tables: &[&[Entry]]) -> Result<Loaded> {
    let _loading = Loading::start(&describe::name(scene.path()?));
    crate::load::load(imported(scene, more, integrator)?, integrator, tables)
}

/// Reads when the shutter of a scene is open; `None` if the scene does not say it. Nothing is built.
///
/// # Errors
/// Those of reading the scene.
pub fn shutter(scene: &SceneArgs, more: &[Override], integrator: Option<&str>) -> Result<Option<Shutter>> {
    let Imported { root, file, files, .. } = imported(scene, more, integrator)?;
    let described = describe::read_with(&root, &file, &files)?;
    Ok(root.child("shutter").map(|_| described.shutter))
}

/// Reads the scene and applies overrides.
///
/// # Errors
/// The errors of [`import_with`], and `Usage` for overrides of a value that the scene cannot have.
fn imported(scene: &SceneArgs, more: &[Override], integrator: Option<&str>) -> Result<Imported> {
    let change = |root: &mut Node| {
        scene.override_values(root)?;
        more.iter().try_for_each(|flag| root.set_by(&flag.words, flag.pointer, &flag.value))
    };
    let mut imported = import_with(scene.path()?, &scene.import_options(), |root, file| override_values(root, file, integrator, change))?;
    scene.add_environment(&mut imported.files)?;
    Ok(imported)
}
