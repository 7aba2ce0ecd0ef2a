//! The Beckmann distribution: facets of a surface with Gaussian slopes.
//!
//! D(h) = e^(−tan²) / (π αx αy hz⁴),    tan² = ((hx/αx)² + (hy/αy)²) / hz²          [sr⁻¹]
//!
//! S(w) = cos θ erf(a) + s e^(−a²)/√π,    a = cos θ / s,    s = √((αx wx)² + (αy wy)²)
//!
//! The functions are not inlined: a call costs little beside an exponential, and this leaves more registers to GGX.
//!
//! Source: Beckmann and Spizzichino (1963); Walter et al., *Microfacet Models for Refraction* (2007).

use glam::{Vec2, Vec3};

use crate::math::float::{erf_inverse, erfc_and_gaussian, exp, ln_f64};

/// The square root of π.
const SQRT_PI: f64 = 1.772_453_850_905_516;

/// D(h) / D(normal), from (hx/αx)² + (hy/αy)², hz² and |h|².
#[inline(never)]
pub(super) fn profile(slope2: f32, cos2: f32, length2: f32) -> f32 {
    let (tan2, root) = (slope2 / cos2, length2 / cos2);
    // Beyond tan² = 80 the value rounds to 0 in f32. This includes hz = 0.
    if tan2 < 80.0 { exp(-tan2) * (root * root) } else { 0.0 }
}

/// S(w), from cos θ and (αx wx)² + (αy wy)².
#[inline(never)]
pub(super) fn projected_area(cos: f32, sine2: f32) -> f32 {
    let (cos, sine) = (f64::from(cos), f64::from(sine2).sqrt());
    let (erfc, gaussian) = erfc_and_gaussian(cos / sine);
    (cos * (1.0 - erfc) + sine * gaussian / SQRT_PI) as f32
}

/// Samples a normal that is visible from `wo`, for roughness 1. The result is not normalized.
///
/// Slopes perpendicular to the view direction are Gaussian. Slopes along it have, if visible, the density
///
/// p(x) ∝ (cos θ + x sin θ) e^(−x²),    x > −cot θ,  positive towards the viewer
///
/// Its integral from x to ∞, N(x) = cos θ (√π/2) erfc x + (sin θ/2) e^(−x²), is inverted by Newton's method.
///
/// Source: Heitz and d'Eon, *Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals* (2014).
#[inline(never)]
pub(super) fn sample_visible(wo: Vec3, u: Vec2) -> Vec3 {
    let sine = wo.truncate().length();
    let side = if sine > 0.0 { wo.truncate() / sine } else { Vec2::X };
    // The centres of the cells of the uniform numbers, which are neither 0 nor 1.
    let [u, v] = [u.x, u.y].map(|u| f64::from(u) + 0.5 / 16_777_216.0);
    let x = along_the_view(f64::from(wo.z), f64::from(sine), u) as f32;
    let y = erf_inverse(2.0 * v - 1.0) as f32;
    Vec3::new(x * side.x - y * side.y, x * side.y + y * side.x, 1.0)
}

/// The slope x above which the share `u` of the visible slopes lies.
fn along_the_view(cos: f64, sine: f64, u: f64) -> f64 {
    let above = |x: f64| {
        let (erfc, gaussian) = erfc_and_gaussian(x.abs());
        let erfc = if x < 0.0 { 2.0 - erfc } else { erfc };
        (0.5 * (SQRT_PI * cos * erfc + sine * gaussian), gaussian)
    };
    // Slopes beyond 6 have a probability of 10⁻¹⁶.
    let (mut low, mut high) = (-(cos / sine).min(6.0), 6.0);
    let wanted = u * above(low).0;
    // The starting value is exact at grazing incidence; it blends to the quantile of the Gaussian, which is exact at normal incidence.
    let grazing = (-ln_f64(u)).sqrt();
    let mut x = (grazing * sine + erf_inverse(1.0 - 2.0 * u) * cos).clamp(low, high);
    for _ in 0..MOST_STEPS {
        let (n, gaussian) = above(x);
        if n > wanted {
            low = x
        } else {
            high = x
        }
        let step = (n - wanted) / ((cos + x * sine) * gaussian);
        let next = x + step;
        // Newton's step overshoots where the density is nearly 0; then the interval is halved.
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        let is_there = (next - x).abs() <= PRECISION;
        x = next;
        if is_there {
            break;
        }
    }
    x
}

/// The error of a slope in units of the roughness, which is below the rounding of a direction.
const PRECISION: f64 = 1e-8;
/// The largest number of steps. Newton's method needs 3 to 6; halving an interval of 12 down to the precision needs 30.
const MOST_STEPS: u32 = 32;
