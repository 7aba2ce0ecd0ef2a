//! This package has no library of its own: its test, in `pictures.rs`, compiles pt's integrators as a foreign crate would.
