//! The GGX distribution: normals distributed as on an ellipsoid.
//!
//! D(h) = 1 / (π αx αy ((hx/αx)² + (hy/αy)² + hz²)²)                              [sr⁻¹]
//!
//! S(w) = √(cos²θ + (αx wx)² + (αy wy)²)
//!
//! Source: Trowbridge and Reitz (1975); Walter et al., *Microfacet Models for Refraction* (2007).

use glam::{Vec2, Vec3};

use crate::math::warp;

/// D(h) / D(normal), from (hx/αx)² + (hy/αy)², hz² and |h|²; 0 for a vector of length 0.
#[inline]
pub(super) fn profile(slope2: f32, cos2: f32, length2: f32) -> f32 {
    let sum = slope2 + cos2;
    let root = length2 / sum;
    if sum > 0.0 { root * root } else { 0.0 }
}

/// S(w), from cos θ and (αx wx)² + (αy wy)².
#[inline]
pub(super) fn projected_area(cos: f32, sine2: f32) -> f32 {
    (cos * cos + sine2).sqrt()
}

/// Samples a normal that is visible from `wo`, for roughness 1, where facets are distributed as on a hemisphere. Neither vector is
/// normalized.
///
/// Reflection of `wo` maps the visible normals of a hemisphere uniformly to the cap z > −cos θo of the sphere. So the normal is the half
/// vector of `wo` and a uniform point of the cap.
///
/// Source: Dupuy and Benyoub, *Sampling Visible GGX Normals with Spherical Caps* (2023).
#[inline]
pub(super) fn sample_visible(wo: Vec3, u: Vec2) -> Vec3 {
    let (r, direction) = warp::polar(u);
    // The sphere has the radius l = |wo|, which avoids a division.
    let l = wo.length();
    let height = l + wo.z;
    // With z = l − r² height of the point on the cap, z + wo.z and l² − z² = r² height (l + z) are computed without cancellation.
    let z_and_cos = height * ((1.0 - r) * (1.0 + r));
    let sine = r * (height * ((l - wo.z) + z_and_cos)).sqrt();
    Vec3::new(sine * direction.x + wo.x, sine * direction.y + wo.y, z_and_cos)
}
