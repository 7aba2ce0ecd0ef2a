//! Scenes of other programs: each becomes a scene of pt, and says what became of it.

mod convert;
mod gltf;
mod obj;
mod read;
mod table;
