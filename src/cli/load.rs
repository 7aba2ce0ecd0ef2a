//! From the command line to a scene that can be rendered.

use std::path::Path;
use std::sync::Arc;

use super::voice::Loading;
use super::{args, memory};
use crate::describe::{self, Built, Files, Identity, Shape, Source};
use crate::error::text::one_line;
use crate::error::{Error, Fault, MAX_FAULTS, Result};
use crate::import::{Imported, import_with};
use crate::integrator::{self, Entry, Integrator};
use crate::reader::Node;
use crate::world::World;

/// A scene, and how it is to be rendered.
pub struct Loaded {
    pub built: Built,
    pub entry: Entry,
    pub integrator: Arc<dyn Integrator>,
    pub description: describe::Scene,
    /// Of the scene file, without its folder and extension.
    pub stem: String,
    /// In pt's own format, overridden.
    pub root: Node,
    file: String,
    pub files: Files,
}

impl Loaded {
    /// What decides the picture.
    ///
    /// # Errors
    /// `Internal`.
    pub fn identity(&self) -> Result<Identity> {
        Identity::new(&self.description, &self.built.contents, &self.entry)
    }

    /// Another integrator for the same scene.
    ///
    /// # Errors
    /// `Usage` for an unknown name, `Invalid` for options of the scene that it refuses.
    pub fn choose(&self, tables: &[&[Entry]], name: &str) -> Result<(Entry, Arc<dyn Integrator>)> {
        let (entry, integrator) = integrator::choose(tables, self.root.child("integrator"), Some(name), &self.file)?;
        Ok((entry, integrator.into()))
    }

    /// The scene as its facets have it, and how many meshes are different then; `None` where none is.
    pub fn without_smooth_shadows(&self) -> Result<Option<(World, usize)>> {
        let mut description = self.description.clone();
        let count = take_smooth_shadows(&mut description.shapes);
        let source = Source { root: &self.root, file: &self.file, files: &self.files };
        Ok(if count > 0 { Some((describe::build(&description, source)?.world, count)) } else { None })
    }
}

/// What a flag says in place of a key of the scene.
pub struct Override {
    /// The flag as it was written, such as `--spp 16`: what is wrong with the value is told by it.
    pub words: String,
    pub pointer: &'static str,
    pub value: String,
}

/// Reads, overrides, checks and builds the scene.
///
/// - `more`: overrides that have flags of their own, after those of `-D`
pub fn load(scene: &args::Scene, more: &[Override], integrator: Option<&str>, tables: &[&[Entry]]) -> Result<Loaded> {
    let _loading = Loading::start(&describe::name(scene.path()?));
    let Imported { root, file, files, notes, .. } = imported(scene, more)?;
    let chosen = integrator::choose(tables, root.child("integrator"), integrator, &file);
    let (description, (entry, integrator)) = together(describe::read_with(&root, &file, &files), chosen)?;
    memory::check(&description, &root, &file)?;
    let mut built = describe::build(&description, Source { root: &root, file: &file, files: &files })?;
    built.warnings.splice(..0, notes.iter().map(Fault::to_string));
    // Names from files are in them.
    built.warnings.iter_mut().for_each(|warning| *warning = one_line(warning).into_owned());
    let stem = Path::new(&file).file_stem().map_or("picture".into(), |stem| stem.to_string_lossy().into_owned());
    Ok(Loaded { built, entry, integrator: integrator.into(), description, stem, root, file, files })
}

/// Both, or all that is wrong with either, in file order.
fn together<A, B>(a: Result<A>, b: Result<B>) -> Result<(A, B)> {
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

/// The scene's tree, overridden.
///
/// # Errors
/// The errors of [`import_with`], and `Usage` for overrides without a place.
pub fn imported(scene: &args::Scene, more: &[Override]) -> Result<Imported> {
    import_with(scene.path()?, scene.allow_outside, scene.framing(), |root, file| {
        overridden(root, scene, more).map_err(|refusal| deeper(refusal, root, file))
    })
}

fn overridden(root: &mut Node, scene: &args::Scene, more: &[Override]) -> Result<()> {
    scene.overrides()?.into_iter().try_for_each(|(pointer, text)| root.set(pointer, text))?;
    more.iter().try_for_each(|flag| root.set_by(&flag.words, flag.pointer, &flag.value))
}

/// Why there was no place for a value: where the scene itself is wrong, that is what to say.
fn deeper(refusal: Error, root: &Node, file: &str) -> Error {
    match describe::read(root, file) {
        Err(wrong @ Error::Invalid(_)) => wrong,
        _ => refusal,
    }
}
