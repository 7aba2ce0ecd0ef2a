//! Path tracing in double precision, which shows what rounding does to a picture.
//!
//! The renderer computes in single precision and rounds every point, direction and colour to 24 bits. [`DoublePath`] is a second, slow path
//! tracer with 53 bits and its own code for rays of the camera, intersections, scattering and the walk itself. It reads the description of the
//! scene, not the world that was built from it, so that the rounding of places counts too. What both share, and what it therefore cannot
//! judge, are the composition of transforms, the readers of files, the tables of metals, and the places on the film. It takes the random numbers of the integrator `path`
//! and uses them in the same way. So the two follow the same paths, and a picture by one differs from a picture by the other only by what
//! was rounded, and by mistakes of either.
//!
//! It knows spheres, quads, disks, boxes and triangle meshes; the materials `diffuse` (with checkerboards on quads, looked up at points),
//! `mirror`, `thin_dielectric`, and `conductor` and `dielectric` without roughness; a background of one radiance; perspective and
//! orthographic cameras. It refuses all other scenes.
//!
//! Tests: pictures_in_double_precision_differ_by_rounding_alone, formulas_hold_in_double_precision.

mod camera;
mod difference;
mod materials;
mod path;
mod read;
mod surfaces;

use std::sync::Arc;

use crate::error::Result;
use crate::film::FilmSpec;
use crate::integrator::{Estimator, Integrator};
use crate::integrators::path::Path;
use crate::load::Loaded;
use crate::reader::{self, Faults, UnknownKeys};
use crate::scene::Scene;

pub use difference::{PrecisionReport, difference};
use path::{Limits, Walk};
use read::DoubleScene;

/// Name of the method in comparisons.
pub const NAME: &str = "path (f64)";

/// The method `path` in double precision, for one scene.
pub struct DoublePath {
    scene: Arc<DoubleScene>,
    limits: Limits,
}

impl DoublePath {
    /// The method for a scene, with the options that it has for `path`.
    ///
    /// # Errors
    /// `Invalid` where the scene has something that the method does not know; those of files that cannot be read.
    pub fn new(loaded: &Loaded) -> Result<DoublePath> {
        let faults = Faults::default();
        let options = loaded.root.child("integrator");
        let read = |node| reader::read_options::<Path>(node, "/integrator", UnknownKeys::Ignore, &faults);
        let Path { max_depth, roulette_depth } = options.and_then(read).unwrap_or_default();
        faults.into_result(&loaded.file)?;
        Ok(DoublePath { scene: Arc::new(read::read(loaded)?), limits: Limits { max_depth, roulette_depth } })
    }
}

impl Integrator for DoublePath {
    fn prepare(&self, _world: Arc<dyn Scene>, film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Walk { scene: self.scene.clone(), limits: self.limits, film: film.size.as_dvec2() })
    }
}
