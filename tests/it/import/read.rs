//! Imported files, with functions for tests to inspect them.

use std::path::Path;

use pt::bsdf::TransportMode;
use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::import::{AutoCamera, ImportOptions, import_with};
use pt::math::{Ray, Spectrum};
use pt::scene::{Scene, Surface};
use pt::shape::MeshData;
use serde_json::Value;

/// An imported file.
pub struct Read {
    root: pt::reader::Node,
    pub tree: Value,
    pub files: Files,
    pub notes: Vec<String>,
}

/// Reads a scene, as the command line does before it renders.
pub fn try_read(path: &Path) -> pt::Result<Read> {
    try_read_with(path, AutoCamera::default(), &[])
}

/// Reads a file like [`try_read`], with options for the camera and with values that override those of the file.
pub fn try_read_with(path: &Path, auto_camera: AutoCamera, overrides: &[(&str, &str)]) -> pt::Result<Read> {
    let options = ImportOptions { auto_camera, exposure: pt::load::exposure(overrides.iter().copied()), ..ImportOptions::default() };
    let imported = import_with(path, &options, |root, _| overrides.iter().try_for_each(|(pointer, value)| root.set(pointer, value)))?;
    describe::read(&imported.root, &imported.file)?;
    let tree = serde_json::from_str(&imported.root.to_string()).expect("JSON");
    Ok(Read { tree, root: imported.root, files: imported.files, notes: imported.notes.iter().map(|note| note.to_string()).collect() })
}

pub fn read(path: &Path) -> Read {
    try_read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

impl Read {
    pub fn at(&self, pointer: &str) -> &Value {
        self.tree.pointer(pointer).unwrap_or_else(|| panic!("nothing at {pointer} of {:#}", self.tree))
    }

    pub fn number(&self, pointer: &str) -> f64 {
        self.at(pointer).as_f64().unwrap_or_else(|| panic!("{pointer}: {}", self.at(pointer)))
    }

    pub fn numbers(&self, pointer: &str) -> Vec<f64> {
        let list = self.at(pointer).as_array().unwrap_or_else(|| panic!("{pointer}: {}", self.at(pointer)));
        list.iter().map(|x| x.as_f64().expect("a number")).collect()
    }

    /// The mesh of a shape as pt reads it.
    pub fn mesh(&self, shape: usize) -> MeshData {
        self.mesh_at(&format!("/shapes/{shape}/file"))
    }

    /// The mesh whose file's name is at a pointer.
    pub fn mesh_at(&self, pointer: &str) -> MeshData {
        let file = self.at(pointer).as_str().expect("a file");
        self.files.mesh(file).unwrap_or_else(|e| panic!("{e}")).0
    }

    pub fn built(&self) -> Built {
        let source = Source { root: &self.root, file: "scene", files: &self.files };
        pt::build::build(&describe::read(&self.root, "scene").expect("a scene"), source).unwrap_or_else(|e| panic!("{e}"))
    }

    pub fn notes_say(&self, sentence: &str) -> bool {
        self.notes.iter().any(|note| note.contains(sentence))
    }
}

/// Calls `look` with the surface that a ray hits, and its position in the file's coordinates.
pub fn met<T>(built: &Built, from: [f64; 3], direction: [f32; 3], look: impl FnOnce(&Surface, glam::DVec3) -> T) -> T {
    let world = &built.world;
    let origin = (glam::DVec3::from(from) - world.origin()).as_vec3();
    let ray = Ray::new(origin, glam::Vec3::from(direction).normalize());
    let hit = world.intersect(&ray).unwrap_or_else(|| panic!("nothing from {from:?} into {direction:?}"));
    let surface = world.surface(&ray, &hit);
    let p = surface.point.p.as_dvec3() + world.origin();
    look(&surface, p)
}

/// The reflectance of a mirror at normal incidence, which is its colour.
pub fn reflected(surface: &Surface) -> Spectrum {
    let straight = surface.frame.to_local(surface.point.ns);
    surface.bsdf.sample(straight, 0.5, glam::Vec2::splat(0.5), TransportMode::Radiance).expect("a mirror reflects").weight
}

pub fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    let near = found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(near, "{what}: {found:?}, expected {expected:?}");
}
