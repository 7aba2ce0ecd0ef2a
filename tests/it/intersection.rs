//! Laws of ray intersection: closed meshes have no leaks, the hierarchy finds what a linear search finds, and the tests of primitives are
//! exact.

mod exact;
mod hierarchy;
mod sphere;
