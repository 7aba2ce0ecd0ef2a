//! Laws of meeting surfaces: nothing leaks, the hierarchy is the list, the tests are exact.

mod exact;
mod hierarchy;
mod sphere;
mod watertight;
