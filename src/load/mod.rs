//! Loading of a scene: everything from a tree of pt's own format to what a render takes.
//!
//! ```text
//! import ─▶ Imported ─▶ load ─▶ Loaded: world, film, sampler and integrator
//! ```
//!
//! The command line and the Python package begin here, so that both report the same faults and render the same bits.

mod memory;
mod settings;

use std::path::Path;
use std::sync::Arc;

use crate::build::{Built, Source, build};
use crate::describe::{self, Contents, Files, Identity, Names, Scramblings, Shape, Shutter};
use crate::effects::Effects;
use crate::error::text::one_line;
use crate::error::{Error, Fault, MAX_FAULTS, Result};
use crate::film::FilmSpec;
use crate::import::Imported;
use crate::integrator::{self, Entry, Integrator};
use crate::reader::{Faults, Node, UnknownKeys};
use crate::sampler::{Kind, SamplerSpec};
use crate::world::World;

pub use settings::{Settings, layers_named, sampler_named};

/// A scene that is ready to render.
#[derive(Clone)]
pub struct Loaded {
    /// Shapes, lights, materials and the camera.
    pub world: Arc<World>,
    /// The image, its crop, filter and layers.
    pub film: FilmSpec,
    /// The sampler with its seed and number of samples.
    pub sampler: SamplerSpec,
    /// Sentences about probable mistakes in the scene, and about what was left out of a scene of another program.
    pub warnings: Vec<String>,
    /// Names of shapes, materials and lights.
    pub names: Names,
    /// Parts of the scene by name, each with the effects that it needs.
    pub needs: Vec<(String, Effects)>,
    /// Hashes of the files' contents.
    pub contents: Contents,
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
    /// Name of the scene file in messages.
    pub file: String,
    /// Files of the scene.
    pub files: Arc<Files>,
}

impl Loaded {
    /// Identity: everything that determines the picture.
    ///
    /// # Errors
    /// `Internal`.
    pub fn identity(&self) -> Result<Identity> {
        Identity::new(&self.description, &self.contents, &self.entry)
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
        if states_scramblings(&self.root) || integrator.splats() == self.integrator.splats() {
            return self.sampler;
        }
        let scramblings = if integrator.splats() { Scramblings::SPLATTING } else { describe::Sampler::default().scramblings };
        SamplerSpec { scramblings: scramblings.get(), ..self.sampler }
    }

    /// Makes another integrator the one that renders.
    pub fn select(&mut self, entry: Entry, integrator: Arc<dyn Integrator>) {
        self.sampler = self.sampler_for(&*integrator);
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
        self.sampler.kind = kind;
        Ok(())
    }

    /// Scene with the shadows of its facets, and the number of meshes that differ; `None` if there are none.
    ///
    /// # Errors
    /// Those of [`build`].
    pub fn without_smooth_shadows(&self) -> Result<Option<(World, usize)>> {
        let mut description = self.description.clone();
        let groups = description.groups.values_mut().chain([&mut description.shapes]);
        let count: usize = groups.map(|shapes| take_smooth_shadows(shapes)).sum();
        let source = Source { root: &self.root, file: &self.file, files: &self.files };
        Ok(if count > 0 { Some((build(&description, source)?.world, count)) } else { None })
    }
}

/// Checks and builds an imported scene.
///
/// - `integrator`: name of the integrator; the scene's own without a name
/// - `tables`: tables of integrators
///
/// # Errors
/// `Invalid` with the faults of the scene and of its options for the integrator, and those of [`build`]; `Usage` for an unknown name;
/// `Limit` if the picture does not fit into memory.
pub fn load(imported: Imported, integrator: Option<&str>, tables: &[&[Entry]]) -> Result<Loaded> {
    let Imported { root, file, files, notes, .. } = imported;
    let chosen = integrator::choose(tables, root.child("integrator"), integrator, &file);
    let (mut description, (entry, integrator)) = both_or_all_faults(describe::read_with(&root, &file, &files), chosen)?;
    if integrator.splats() && !states_scramblings(&root) {
        description.sampler.scramblings = Scramblings::SPLATTING;
    }
    memory::check(&description, &root, &file)?;
    let Built { world, film, sampler, mut warnings, mut warnings_for_camera_paths, names, needs, contents } =
        build(&description, Source { root: &root, file: &file, files: &files })?;
    warnings.splice(..0, notes.iter().map(Fault::to_string));
    if entry.simulates.contains(Effects::POINT_LIGHT) && !integrator.splats() {
        warnings.append(&mut warnings_for_camera_paths);
    }
    // Warnings contain names from files.
    warnings.iter_mut().for_each(|warning| *warning = one_line(warning).into_owned());
    let stem = Path::new(&file).file_stem().map_or("picture".into(), |stem| stem.to_string_lossy().into_owned());
    let (world, integrator, files) = (Arc::new(world), integrator.into(), Arc::new(files));
    Ok(Loaded { world, film, sampler, warnings, names, needs, contents, entry, integrator, description, stem, root, file, files })
}

/// Applies changes of a scene's tree. Options of an integrator that they add to a scene without one are those of the integrator that
/// renders.
///
/// - `integrator`: name of the integrator that renders, if one is given
/// - `change`: sets values with [`Node::set_by`]
///
/// # Errors
/// Those of `change`; `Invalid` with the faults of the scene, if it has any, in their place.
pub fn override_values(root: &mut Node, file: &str, integrator: Option<&str>, change: impl FnOnce(&mut Node) -> Result<()>) -> Result<()> {
    let had_integrator = root.child("integrator").is_some();
    change(root).map_err(|refusal| scene_faults_or(refusal, root, file))?;
    if !had_integrator && root.child("integrator").is_some_and(|options| options.child("type").is_none()) {
        // Fails where the options are no object, which is a fault of the scene.
        let _ = root.set("/integrator/type", integrator.unwrap_or(integrator::DEFAULT));
    }
    Ok(())
}

/// When the shutter opens and closes by overrides of a scene (s); `None` without such overrides, or if they have a fault, which setting
/// them reports.
///
/// - `overrides`: JSON pointers and JSON values
pub fn exposure<'o>(overrides: impl IntoIterator<Item = (&'o str, &'o str)>) -> Option<[f64; 2]> {
    let mut scene = crate::reader::parse(b"{}").ok()?;
    for (pointer, value) in overrides.into_iter().filter(|(pointer, _)| pointer.split('/').nth(1) == Some("shutter")) {
        scene.set(pointer, value).ok()?;
    }
    let shutter = crate::reader::read::<Shutter>(scene.child("shutter")?, "/shutter", UnknownKeys::Ignore, &Faults::default())?;
    Some([shutter.open.get(), shutter.close.get()])
}

/// Error for an override of a value that the scene cannot have. If the scene itself is invalid, its faults are reported instead.
fn scene_faults_or(refusal: Error, root: &Node, file: &str) -> Error {
    match describe::read(root, file) {
        Err(wrong @ Error::Invalid(_)) => wrong,
        _ => refusal,
    }
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
