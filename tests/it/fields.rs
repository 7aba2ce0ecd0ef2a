//! Distance fields: laws of their values and gradients, and ray hits compared with formulas.

mod faults;
mod gradients;
mod laws;
mod light;
mod postcard;
mod rays;
mod spawned;
mod zoo;
