//! A physically based renderer whose integrators are plug-ins.
//!
//! The program `pt` renders scene files; this crate is everything that it does, as a library. A picture takes three things:
//!
//! 1. **A scene.** [`world::World`] is built in Rust, as below, or from a scene file, by [`describe`]. Integrators see it through
//!    the trait [`scene::Scene`].
//! 2. **An integrator.** It computes the light that reaches the camera. Those of [`integrators`] come with pt; others
//!    implement [`integrator::Integrator`].
//! 3. **A film.** It collects samples: [`film::MomentFilm`] keeps sums from which the picture and its standard errors follow.
//!
//! [`render::render`] brings the three together. The picture is a pure function of scene, integrator, sampler and film: threads,
//! tiles and machines change no bit of it.
//!
//! # A first picture
//!
//! A grey ball reflects half of the light that reaches it. Under a sky of radiance 1 from everywhere it shows radiance ½:
//!
//! ```
//! use std::sync::Arc;
//!
//! use pt::bsdf::Material;
//! use pt::camera::{Camera, Perspective, Pose};
//! use pt::film::{FilmSpec, MomentFilm};
//! use pt::glam::DVec3;
//! use pt::integrators::path::Path;
//! use pt::light::{Environment, Light};
//! use pt::math::{Rgb, Spectrum, Transform};
//! use pt::render::{Settings, Silent, render};
//! use pt::sampler::SamplerSpec;
//! use pt::shape::Sphere;
//! use pt::world::World;
//!
//! # fn main() -> pt::Result<()> {
//! // The scene. Lengths are metres; the field of view is 40 degrees from top to bottom, and nothing is out of focus.
//! let pose = Pose::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y)?;
//! let (fov, lens_radius, focus_distance) = (40.0, 0.0, 1.0);
//! let mut world = World::builder(Camera::Perspective(Perspective::new(pose, fov, lens_radius, focus_distance)));
//! let grey = world.material(Material::diffuse(Rgb::gray(0.5)));
//! world.shape(Sphere { radius: 1.0 }, Transform::translate(DVec3::ZERO)?, grey, None);
//! world.light(Light::Environment(Environment { radiance: Rgb::gray(1.0) }));
//! let world = Arc::new(world.build()?);
//!
//! // The integrator and the film. From here on nothing can fail.
//! let mut film = MomentFilm::new(FilmSpec::new(16, 12));
//! let settings = Settings::new(SamplerSpec { spp: 16, ..SamplerSpec::default() });
//! let report = render(world, &Path::default(), &mut film, &settings, &Silent);
//!
//! // The picture: linear colours. `pt::output::write` makes a file of it.
//! let picture = film.image();
//! assert_eq!(report.samples, 16);
//! assert!(picture.rgb(8, 6).iter().all(|radiance| (radiance - 0.5).abs() < 1e-4));
//! assert_eq!(picture.rgb(0, 0), [1.0; 3]);
//! # Ok(())
//! # }
//! ```
//!
//! # A scene from a file
//!
//! A description is read and checked, all its faults at once, then built. The files that it names lie in a folder of one's choice:
//!
//! ```
//! use pt::build::{Source, build};
//! use pt::describe::{self, Files};
//!
//! # fn main() -> pt::Result<()> {
//! let file = "ball.json";
//! let text = br#"{
//!     "pt": 1,
//!     "camera": { "look_at": { "from": [0, 0, 4], "to": [0, 0, 0] }, "fov": 40 },
//!     "film": { "width": 16, "height": 12 },
//!     "materials": { "grey": { "type": "diffuse", "albedo": 0.5 } },
//!     "shapes": [{ "type": "sphere", "radius": 1, "material": "grey" }],
//!     "background": { "radiance": 1 }
//! }"#;
//! let root = describe::root(text, file)?;
//! let scene = describe::read(&root, file)?;
//! let built = build(&scene, Source { root: &root, file, files: &Files::within(".") })?;
//! assert_eq!(built.film.size, pt::glam::UVec2::new(16, 12));
//! # Ok(())
//! # }
//! ```
//!
//! `built.world`, `built.film` and `built.sampler` are what [`render::render`] takes. [`integrator::choose`] finds the integrator
//! that the file asks for.
//!
//! # Where to go on
//!
//! - **An integrator of one's own**: [`integrator`] has the two traits. `examples/plug_in.rs` is a complete program: an
//!   integrator with settings, schema and the whole command line of pt, by `cli::main_with`. `examples/splats.rs` is one whose paths
//!   start at the lights and bring light to any pixel.
//! - **A scattering model of one's own**: [`proof`] puts it to the laws that scattering obeys; `examples/prove_my_bsdf.rs`.
//! - **A larger scene in Rust**: `examples/build_scene.rs`.
//! - **Accuracy**: [`measure`] has error measures, tests of agreement, and renders that end when an error is reached.
//! - **Scene files**: `docs/scene-format.md` describes every key; [`describe::schema()`] is the same as a JSON Schema.
//! - **How the crate is built**: `ARCHITECTURE.md` has the layers and a recipe for everything that can be added.
//!
//! # Features
//!
//! - `cli` (default): the command line `cli`, the comparison of methods `compare` with its report, the connection `output::tev` to the
//!   image viewer tev, and the allocator `Memory`. A library that only renders leaves them out with `default-features = false`.
//! - `serve`: the page that shows a picture while it renders, `output::serve`. Without it, the server cannot be started.
//! - `proptest`: generators of models and directions for property tests, `proof::strategies`.

extern crate self as pt;

pub mod accel;
pub mod bsdf;
pub mod build;
pub mod camera;
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "cli")]
pub mod compare;
pub mod describe;
pub mod double;
pub mod effects;
mod error;
pub mod film;
pub mod format;
pub mod import;
pub mod integrator;
#[path = "../integrators/mod.rs"]
pub mod integrators;
pub mod light;
pub mod load;
pub mod math;
pub mod measure;
pub mod medium;
pub mod output;
pub mod part;
pub mod primitive;
pub mod proof;
pub mod rays;
pub mod reader;
pub mod recorder;
pub mod render;
pub mod sampler;
pub mod scene;
pub mod shape;
pub mod stress;
pub mod summary;
pub mod texture;
pub mod torture;
pub mod world;

#[cfg(feature = "cli")]
pub use error::allocator::Memory;
pub use error::{Error, Fault, MAX_FAULTS, Result};

/// The crates whose types and derives a plug-in shares with pt, in the versions that pt is built with: `glam` for vectors, `serde`
/// for settings from scene files, and `schemars` for the JSON Schema of these settings.
///
/// Derives find them with `#[serde(crate = "pt::serde")]` and `#[schemars(crate = "pt::schemars")]`.
pub use {glam, schemars, serde};
