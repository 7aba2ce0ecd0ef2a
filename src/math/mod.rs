//! Vectors, densities, transforms and numerics.

pub mod animation;
pub mod bounds;
pub mod differential;
pub mod discrete;
pub mod equal_area;
pub mod exact;
mod f64x2;
pub mod float;
pub mod frame;
pub mod fresnel;
pub mod hash;
pub mod lanes;
pub mod measure;
pub mod ray;
pub mod rgb;
pub(crate) mod simd;
pub mod spectrum;
pub mod spherical_rectangle;
pub mod spherical_triangle;
pub mod transform;
pub mod warp;

pub use animation::{AnimatedTransform, Keyframes};
pub use bounds::Aabb;
pub use differential::{RayDifferential, SurfaceDifferential};
pub use discrete::Discrete;
pub use exact::ExactSum;
pub use frame::{Frame, Local};
pub use glam::{UVec2, Vec2, Vec3};
pub use measure::{AreaPdf, Density, SolidAnglePdf, balance_heuristic, balance_heuristic_lanes, power_heuristic, power_heuristic_lanes};
pub use ray::Ray;
pub use rgb::Rgb;
pub use spectrum::Spectrum;
pub use spherical_rectangle::SphericalRectangle;
pub use spherical_triangle::SphericalTriangle;
pub use transform::Transform;
