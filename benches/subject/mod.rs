//! Subject of a benchmark: a scene of `scenes/`, rendered by `nee`.

use std::path::Path;
use std::sync::Arc;

use pt::build::Source;
use pt::describe::{self, Files};
use pt::film::FilmSpec;
use pt::integrator::{Integrator, choose};
use pt::scene::Scene;

pub struct Subject {
    pub scene: Arc<dyn Scene>,
    pub integrator: Box<dyn Integrator>,
    pub spec: FilmSpec,
}

impl Subject {
    /// The scene for `nee`.
    ///
    /// - `changes`: pointers into the file, and the values that replace those in the file
    pub fn load(name: &str, changes: &[(&str, &str)]) -> pt::Result<Subject> {
        Subject::load_with(name, changes, "nee")
    }

    /// The scene for an integrator.
    pub fn load_with(name: &str, changes: &[(&str, &str)], integrator: &str) -> pt::Result<Subject> {
        let file = format!("scenes/{name}.json");
        let mut root = describe::load(Path::new(&file))?;
        for (pointer, value) in changes {
            root.set(pointer, value)?;
        }
        let described = describe::read(&root, &file)?;
        let built = pt::build::build(&described, Source { root: &root, file: &file, files: &Files::within("scenes") })?;
        let (_, integrator) = choose(&[pt::integrators::ALL], root.child("integrator"), Some(integrator), &file)?;
        Ok(Subject { scene: Arc::new(built.world), integrator, spec: built.film })
    }
}
