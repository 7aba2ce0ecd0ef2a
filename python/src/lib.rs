//! Python package of pt: scenes, pictures with their errors, tests and rays, as numpy arrays.
//!
//! `package/pt_renderer` is what users import; it adds the types that need no Rust. Everything else is a thin layer over the library:
//! an argument that a scene file could hold is checked as one, so that messages are those of the command line.

#![warn(missing_docs)]

mod compare;
mod error;
mod integrator;
mod items;
mod meters;
mod part;
mod picture;
mod rays;
mod scene;
mod verify;
mod watch;

use pyo3::prelude::*;

/// Native part of the package `pt_renderer`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("BUILD", pt::part::BUILD)?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<picture::Picture>()?;
    module.add_class::<part::Part>()?;
    module.add_class::<rays::Mesh>()?;
    module.add_class::<integrator::SceneView>()?;
    module.add_class::<integrator::PathRay>()?;
    module.add_class::<integrator::SurfaceView>()?;
    module.add_class::<integrator::Numbers>()?;
    module.add_function(wrap_pyfunction!(scene::load_scene, module)?)?;
    module.add_function(wrap_pyfunction!(picture::unpickled, module)?)?;
    module.add_function(wrap_pyfunction!(part::of_bytes, module)?)?;
    module.add_function(wrap_pyfunction!(part::merge, module)?)?;
    module.add_function(wrap_pyfunction!(compare::compare_methods, module)?)?;
    module.add_function(wrap_pyfunction!(verify::verify_sides, module)?)?;
    Ok(())
}
