//! Scenes of other programs: each becomes a scene of pt, and says what became of it.

mod aalto;
mod at_hand;
mod convert;
mod darts;
mod dialect;
mod gltf;
mod obj;
mod read;
mod table;
