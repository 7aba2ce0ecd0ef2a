//! Changes of a scene that must not change its picture, tried on the user's own scene: `pt stress`.
//!
//! [`change::all`] lists the changes: the scene in other sizes, at other places, turned, mirrored, with a far object, with its shapes in
//! another order. Each edits the scene file as a user would, and is read and built like any scene. Two things are compared with the scene
//! as it is: pictures with the same random numbers, tile by tile ([`pictures`]), and what rays meet ([`paths`]). The changes within which
//! all of it stays the same make a sentence, such as "safe from 1e-6 to 1e6 times its size".

pub mod change;
mod mesh;
#[cfg(feature = "cli")]
mod page;
pub mod paths;
pub mod pictures;
mod verdict;

use std::sync::Arc;

use glam::{DVec3, UVec2, Vec2};

use crate::build::{Source, build};
use crate::describe::{self, Files, Names, Scene as Description};
use crate::error::{Error, Result};
use crate::film::Image;
use crate::integrator::{self, Entry, Integrator};
use crate::reader::{Node, parse};
use crate::scene::Scene;
use crate::world::World;

pub use change::{Change, Edit, Range, Similarity};
#[cfg(feature = "cli")]
pub use page::html;
use paths::Paths;
use pictures::{Pictures, Rendering, TILE};
pub use verdict::{Verdict, sentence};

/// The scene that is tried.
pub struct Subject<'a> {
    /// The description of the scene.
    pub description: &'a Description,
    /// Its JSON tree.
    pub root: &'a Node,
    /// Its file, as the user named it.
    pub file: &'a str,
    /// The files that it may read.
    pub files: &'a Files,
    /// The integrator that renders.
    pub entry: &'a Entry,
    /// The tables that have the integrator.
    pub tables: &'a [&'a [Entry]],
}

/// What one change did.
pub struct Outcome {
    /// The change.
    pub change: Change,
    /// What is to be said of it.
    pub verdict: Verdict,
    /// What differs; `None` if the changed scene cannot be built.
    pub found: Option<Found>,
}

/// What differs between a changed scene and the scene as it is.
pub struct Found {
    /// Pictures.
    pub pictures: pictures::Difference,
    /// Rays.
    pub paths: paths::Difference,
    /// Number of samples that were no numbers.
    pub invalid: u64,
    /// Names of what the tile with the greatest difference shows.
    pub shown: Vec<String>,
    /// Warnings that the scene as it is does not give.
    pub warnings: Vec<String>,
    /// Mean of the pictures.
    pub image: Image,
}

/// A scene that is built.
struct Variant {
    world: Arc<World>,
    names: Names,
    integrator: Box<dyn Integrator>,
    warnings: Vec<String>,
}

/// Rays and pictures of the scene as it is.
pub struct Trial<'a> {
    subject: Subject<'a>,
    rendering: Rendering<'a>,
    sphere: (DVec3, f64),
    changes: Vec<Change>,
    paths: Paths,
    pictures: Pictures,
    warnings: Vec<String>,
}

impl<'a> Trial<'a> {
    /// Renders the scene as it is.
    ///
    /// # Errors
    /// The errors of building the scene, see [`build`].
    pub fn new(subject: Subject<'a>, rendering: Rendering<'a>) -> Result<Trial<'a>> {
        let Variant { world, names, integrator, warnings } = subject.built(subject.description, subject.root)?;
        let (center, radius) = world.bounding_sphere();
        // Without shapes there is nothing but the background, which has no size.
        let sphere = (center, if radius > 0.0 { radius } else { 1.0 });
        let ahead = world.camera().ray(Vec2::splat(0.5), rendering.film.aspect(), Vec2::splat(0.5), 0.0).direction.as_dvec3();
        let paths = Paths::follow(&world, &names, &Similarity::IDENTITY, sphere, rendering.film.aspect());
        let pictures = Pictures::render(&(world as Arc<dyn Scene>), &*integrator, &rendering);
        let changes = change::all(sphere.0, sphere.1, ahead, change::can_be_mirrored(subject.description));
        Ok(Trial { subject, rendering, sphere, changes, paths, pictures, warnings })
    }

    /// The changes that can be tried.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Mean of the pictures of the scene as it is.
    pub fn image(&self) -> Image {
        self.pictures.mean()
    }

    /// Number of paths whose rays are compared.
    pub fn path_count(&self) -> u64 {
        self.paths.count()
    }

    /// Tries a change.
    ///
    /// # Errors
    /// `Internal` where a scene cannot be written as JSON, and those of reading files. A changed scene that cannot be built is no error.
    pub fn ask(&self, change: &Change) -> Result<Outcome> {
        let variant = match self.subject.changed(&change.edit) {
            Ok(variant) => variant,
            Err(Error::Invalid(faults)) => return Ok(refused(change, faults.first().map(|fault| fault.message.clone()))),
            Err(Error::Limit(fault)) => return Ok(refused(change, Some(fault.message))),
            Err(other) => return Err(other),
        };
        let Variant { world, names, integrator, warnings } = variant;
        let aspect = self.rendering.film.aspect();
        let paths = Paths::follow(&world, &names, &change.edit.place(), self.sphere, aspect).difference(&self.paths);
        let pictures = Pictures::render(&(world.clone() as Arc<dyn Scene>), &*integrator, &self.rendering);
        let difference = pictures.difference(&self.pictures, self.changes.len());
        let shown = if difference.tiles > 0 { self.shown(&world, &names, difference.at) } else { vec![] };
        let is_new = |warning: &String| !self.warnings.contains(warning);
        let found = Found {
            invalid: pictures.invalid,
            shown,
            warnings: warnings.into_iter().filter(is_new).collect(),
            image: pictures.mean(),
            pictures: difference,
            paths,
        };
        let verdict = Verdict::of(change, &found, self.paths.count());
        Ok(Outcome { change: change.clone(), verdict, found: Some(found) })
    }

    /// Names of the first surfaces behind a tile.
    fn shown(&self, world: &World, names: &Names, tile: UVec2) -> Vec<String> {
        let film = self.rendering.film;
        let mut shown = vec![];
        for i in 0..TILE * TILE {
            let pixel = (tile + UVec2::new(i % TILE, i / TILE)).as_vec2() + 0.5;
            let ray = world.camera().ray(pixel / film.size.as_vec2(), film.aspect(), Vec2::splat(0.5), 0.0);
            let name = world.intersect(&ray).map(|hit| names.shapes[hit.shape as usize].clone());
            shown.extend(name.filter(|name| !shown.contains(name)));
        }
        shown
    }
}

fn refused(change: &Change, message: Option<String>) -> Outcome {
    Outcome { change: change.clone(), verdict: Verdict::Refused(message.unwrap_or_default()), found: None }
}

impl Subject<'_> {
    fn built(&self, description: &Description, root: &Node) -> Result<Variant> {
        let (_, integrator) = integrator::choose(self.tables, root.child("integrator"), Some(self.entry.name), self.file)?;
        let built = build(description, Source { root, file: self.file, files: self.files })?;
        Ok(Variant { world: Arc::new(built.world), names: built.names, integrator, warnings: built.warnings })
    }

    /// Builds the changed scene from its JSON text, as if the user had edited the file.
    fn changed(&self, edit: &Edit) -> Result<Variant> {
        let value = edit.apply(self.description, self.root, self.files)?;
        let root = parse(value.to_string().as_bytes()).map_err(Error::invalid)?;
        let description = describe::read_with(&root, self.file, self.files)?;
        self.built(&description, &root)
    }
}
