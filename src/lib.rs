//! A physically based renderer whose integrators are plug-ins.

extern crate self as pt;

pub mod accel;
pub mod bsdf;
pub mod camera;
pub mod cli;
pub mod compare;
pub mod describe;
pub mod effects;
mod error;
pub mod film;
pub mod format;
pub mod import;
pub mod integrator;
#[path = "../integrators/mod.rs"]
pub mod integrators;
pub mod light;
pub mod math;
pub mod measure;
pub mod output;
pub mod part;
pub mod primitive;
pub mod proof;
pub mod reader;
pub mod recorder;
pub mod render;
pub mod sampler;
pub mod scene;
pub mod shape;
pub mod texture;
pub mod world;

pub use error::memory::Memory;
pub use error::{Error, Fault, MAX_FAULTS, Result};

/// What a plug-in needs beside pt, in the versions that pt speaks: vectors, options from scene files, and their schema.
pub use {glam, schemars, serde};
