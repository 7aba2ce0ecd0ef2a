//! Distance fields: what their numbers promise, and that rays end where the formulas say.

mod faults;
mod gradients;
mod laws;
mod light;
mod postcard;
mod rays;
mod spawned;
mod zoo;
