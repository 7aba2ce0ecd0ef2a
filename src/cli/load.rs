//! Loading of a scene with the options of the command line.

use std::path::Path;
use std::sync::Arc;

use super::memory;
use super::messages::Loading;
use super::quote::quoted;
use crate::build::{Built, Source};
use crate::describe::{self, Files, Identity, Scramblings, Shape, Shutter};
use crate::effects::Effects;
use crate::error::text::one_line;
use crate::error::{Error, Fault, MAX_FAULTS, Result};
use crate::import::{AutoCamera, Up, Viewpoint};
use crate::import::{Imported, import_with};
use crate::integrator::{self, Entry, Integrator};
use crate::reader::Node;
use crate::sampler::{Kind, SamplerSpec};
use crate::scene::Scene;
use crate::world::World;
use std::path::PathBuf;

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

    /// Options for a model without a camera.
    pub fn auto_camera(&self) -> AutoCamera {
        AutoCamera { up: self.up, view: self.view, ground: (self.ground || self.no_ground).then_some(self.ground), studio: self.studio }
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

    /// The flags of the scene that decide the picture, for commands that repeat it.
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
        let environment = self.environment.as_ref().map(|path| ["--environment".to_owned(), quoted(&path.display().to_string())]);
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

/// A scene that is ready to render.
pub struct Loaded {
    /// World, film and sampler.
    pub built: Built,
    /// Table row of the integrator.
    pub entry: Entry,
    /// The integrator.
    pub integrator: Arc<dyn Integrator>,
    /// Description of the scene.
    pub description: describe::Scene,
    /// Name of the scene file, without its folder and extension.
    pub stem: String,
    /// Scene in pt's own format, with overrides.
    pub root: Node,
    pub file: String,
    /// Files of the scene.
    pub files: Files,
}

impl Loaded {
    /// Identity: everything that determines the picture.
    ///
    /// # Errors
    /// `Internal`.
    pub fn identity(&self) -> Result<Identity> {
        Identity::new(&self.description, &self.built.contents, &self.entry)
    }

    /// Selects another integrator for the same scene.
    ///
    /// # Errors
    /// `Usage` for an unknown name, `Invalid` for options of the scene that it refuses.
    pub fn choose(&self, tables: &[&[Entry]], name: &str) -> Result<(Entry, Arc<dyn Integrator>)> {
        let (entry, integrator) = integrator::choose(tables, self.root.child("integrator"), Some(name), &self.file)?;
        Ok((entry, integrator.into()))
    }

    /// Sampler of the scene for another integrator: the two differ by the default number of scramblings.
    pub fn sampler_for(&self, integrator: &dyn Integrator) -> SamplerSpec {
        let sampler = self.built.sampler;
        if states_scramblings(&self.root) || integrator.splats() == self.integrator.splats() {
            return sampler;
        }
        let scramblings = if integrator.splats() { Scramblings::SPLATTING } else { describe::Sampler::default().scramblings };
        SamplerSpec { scramblings: scramblings.get(), ..sampler }
    }

    /// Makes another integrator the one that renders.
    pub fn select(&mut self, entry: Entry, integrator: Arc<dyn Integrator>) {
        self.built.sampler = self.sampler_for(&*integrator);
        if !states_scramblings(&self.root) {
            self.description.sampler.scramblings =
                if integrator.splats() { Scramblings::SPLATTING } else { describe::Sampler::default().scramblings };
        }
        (self.entry, self.integrator) = (entry, integrator);
    }

    /// Makes another sampler the one that renders.
    ///
    /// # Errors
    /// `Internal` for a sampler that scenes cannot name.
    pub fn select_sampler(&mut self, kind: Kind) -> Result<()> {
        let described = serde_json::from_value(serde_json::json!(kind.name()));
        self.description.sampler.kind = described.map_err(|error| Error::Internal(format!("{}: {error}", kind.name())))?;
        self.built.sampler.kind = kind;
        Ok(())
    }

    /// Calls a function with the shared scene, for renders that end before the function does. Returns the scene and the result.
    ///
    /// # Errors
    /// `Internal` if a render outlives the function.
    pub fn with_scene<T>(mut self, run: impl FnOnce(&Arc<dyn Scene>) -> T) -> Result<(Loaded, T)> {
        let world = Arc::new(self.built.world);
        let result = run(&(world.clone() as Arc<dyn Scene>));
        self.built.world = Arc::into_inner(world).ok_or_else(|| Error::Internal("a pilot still holds the scene".into()))?;
        Ok((self, result))
    }

    /// Scene with the shadows of its facets, and the number of meshes that differ; `None` if there are none.
    pub fn without_smooth_shadows(&self) -> Result<Option<(World, usize)>> {
        let mut description = self.description.clone();
        let groups = description.groups.values_mut().chain([&mut description.shapes]);
        let count: usize = groups.map(|shapes| take_smooth_shadows(shapes)).sum();
        let source = Source { root: &self.root, file: &self.file, files: &self.files };
        Ok(if count > 0 { Some((crate::build::build(&description, source)?.world, count)) } else { None })
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
pub fn load(scene: &SceneArgs, more: &[Override], integrator: Option<&str>, tables: &[&[Entry]]) -> Result<Loaded> {
    let _loading = Loading::start(&describe::name(scene.path()?));
    let Imported { root, file, files, notes, .. } = imported(scene, more, integrator)?;
    let chosen = integrator::choose(tables, root.child("integrator"), integrator, &file);
    let (mut description, (entry, integrator)) = both_or_all_faults(describe::read_with(&root, &file, &files), chosen)?;
    if integrator.splats() && !states_scramblings(&root) {
        description.sampler.scramblings = Scramblings::SPLATTING;
    }
    memory::check(&description, &root, &file)?;
    let mut built = crate::build::build(&description, Source { root: &root, file: &file, files: &files })?;
    built.warnings.splice(..0, notes.iter().map(Fault::to_string));
    if entry.simulates.contains(Effects::POINT_LIGHT) && !integrator.splats() {
        built.warnings.append(&mut built.warnings_for_camera_paths);
    }
    // Warnings contain names from files.
    built.warnings.iter_mut().for_each(|warning| *warning = one_line(warning).into_owned());
    let stem = Path::new(&file).file_stem().map_or("picture".into(), |stem| stem.to_string_lossy().into_owned());
    Ok(Loaded { built, entry, integrator: integrator.into(), description, stem, root, file, files })
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

/// Whether the scene or a flag gives the number of scramblings.
fn states_scramblings(root: &Node) -> bool {
    root.child("sampler").is_some_and(|sampler| sampler.child("scramblings").is_some())
}

/// Returns both results, or the faults of both in file order.
fn both_or_all_faults<A, B>(a: Result<A>, b: Result<B>) -> Result<(A, B)> {
    match (a, b) {
        (Ok(a), Ok(b)) => Ok((a, b)),
        (Err(Error::Invalid(mut faults)), Err(Error::Invalid(more))) => {
            let new = |fault: &Fault| !faults.iter().any(|known| known.pointer == fault.pointer);
            let more: Vec<Fault> = more.into_iter().filter(new).collect();
            faults.extend(more);
            faults.sort_by_key(|fault| (fault.line, fault.column));
            faults.truncate(MAX_FAULTS);
            Err(Error::Invalid(faults))
        }
        (Err(error), _) | (_, Err(error)) => Err(error),
    }
}

fn take_smooth_shadows(shapes: &mut [Shape]) -> usize {
    let take = |shape: &mut Shape| match shape {
        Shape::Mesh(mesh) => usize::from(std::mem::take(&mut mesh.smooth_shadows)),
        Shape::Group(group) => take_smooth_shadows(&mut group.shapes),
        _ => 0,
    };
    shapes.iter_mut().map(take).sum()
}

/// Reads the tree of the scene and applies overrides.
///
/// # Errors
/// The errors of [`import_with`], and `Usage` for overrides of a value that the scene cannot have.
fn imported(scene: &SceneArgs, more: &[Override], integrator: Option<&str>) -> Result<Imported> {
    let mut imported = import_with(scene.path()?, scene.allow_outside, scene.auto_camera(), |root, file| {
        apply_overrides(root, scene, more, integrator).map_err(|refusal| scene_faults_or(refusal, root, file))
    })?;
    scene.add_environment(&mut imported.files)?;
    Ok(imported)
}

fn apply_overrides(root: &mut Node, scene: &SceneArgs, more: &[Override], integrator: Option<&str>) -> Result<()> {
    let had_integrator = root.child("integrator").is_some();
    scene.override_values(root)?;
    more.iter().try_for_each(|flag| root.set_by(&flag.words, flag.pointer, &flag.value))?;
    // Options from the command line, for a scene without an integrator, are those of the integrator that renders.
    if !had_integrator && root.child("integrator").is_some_and(|options| options.child("type").is_none()) {
        // Fails where the options are no object, which is a fault of the scene.
        let _ = root.set("/integrator/type", integrator.unwrap_or(crate::integrator::DEFAULT));
    }
    Ok(())
}

/// Error for an override of a value that the scene cannot have. If the scene itself is invalid, its faults are reported instead.
fn scene_faults_or(refusal: Error, root: &Node, file: &str) -> Error {
    match describe::read(root, file) {
        Err(wrong @ Error::Invalid(_)) => wrong,
        _ => refusal,
    }
}
