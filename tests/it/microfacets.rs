//! Rough metal and rough glass, compared with quadrature and published values.

use std::f64::consts::{PI, TAU};

use glam::Vec2;
use pt::bsdf::microfacet::energy_loss::Domain;
use pt::bsdf::microfacet::{Distribution, MIN_ALPHA, Microfacets};
use pt::bsdf::rough_conductor;
use pt::bsdf::rough_dielectric;
use pt::bsdf::{Bsdf, Reflectance, RoughConductor, RoughDielectric, TransportMode};
use pt::math::{Local, Spectrum};

const BOTH: [Distribution; 2] = [Distribution::Ggx, Distribution::Beckmann];

fn facets(x: f32, y: f32, distribution: Distribution) -> Microfacets {
    Microfacets::new(Vec2::new(x, y), distribution).expect("rough")
}

/// Metal that reflects all but 2·10⁻⁵ of the light at any angle.
fn white_metal(facets: Microfacets, compensated: bool) -> Bsdf<'static> {
    let reflectance = Reflectance::Index { eta: Spectrum::ONE, k: Spectrum::gray(1e4) };
    let more = |_| {
        let losses = rough_conductor::losses(Domain::One(facets.alpha), facets.distribution);
        rough_conductor::MultiScatter::new(losses, facets.alpha, reflectance.mean())
    };
    let multiple = compensated.then_some(()).and_then(more);
    Bsdf::RoughConductor(RoughConductor { reflectance, facets, more: multiple })
}

fn clear_glass(eta: f32, facets: Microfacets, compensated: bool) -> Bsdf<'static> {
    let more = |_| {
        let losses = rough_dielectric::losses(eta, Domain::One(facets.alpha), facets.distribution);
        rough_dielectric::MultiScatter::new(losses.into(), facets.alpha, eta)
    };
    let multiple = compensated.then_some(()).and_then(more);
    Bsdf::RoughDielectric(RoughDielectric { eta, color: Spectrum::ONE, facets, more: multiple })
}

fn at(cos: f64, phi: f64) -> Local {
    let sine = ((1.0 - cos) * (1.0 + cos)).sqrt();
    Local::new((sine * phi.cos()) as f32, (sine * phi.sin()) as f32, cos as f32)
}

/// The middle and the width of the i-th of n cells of [0, 1], which are smaller at both ends.
fn cell(i: usize, n: usize) -> (f64, f64) {
    let s = (i as f64 + 0.5) / n as f64;
    (s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / n as f64)
}

/// Integral over the sphere by the midpoint rule in cos θ and φ, finer near the horizon and near the normal.
fn over_the_sphere(n: usize, f: impl Fn(Local) -> f64) -> f64 {
    let mut sum = 0.0;
    for i in 0..n {
        let (z, width) = cell(i, n);
        for j in 0..n {
            let phi = TAU * (j as f64 + 0.5) / n as f64;
            sum += (f(at(z, phi)) + f(at(-z, phi))) * width;
        }
    }
    sum * TAU / n as f64
}

/// Albedo ∫ f |cos θi| dωi over all directions, computed without use of the facets.
fn albedo(model: &Bsdf, wo: Local, n: usize) -> f64 {
    over_the_sphere(n, |wi| model.eval(wo, wi, TransportMode::Importance).average() as f64)
}

/// Albedo of reflected light, integrated over half vectors h with dωi = 4 |wo·h| dh.
fn reflected(model: &Bsdf, facets: &Microfacets, wo: Local, n: usize) -> f64 {
    over_normals(facets, n, |h| {
        let h = h.0 * glam::Vec3::new(1.0, 1.0, 1f32.copysign(wo.cos()));
        let cos = wo.0.dot(h);
        let wi = Local(2.0 * cos * h - wo.0);
        let seen = cos > 0.0 && wo.same_side(wi);
        if seen { model.eval(wo, wi, TransportMode::Importance).average() as f64 * 4.0 * cos as f64 } else { 0.0 }
    })
}

/// Albedo of refracted light, integrated over the directions on the other side.
fn transmitted(model: &Bsdf, wo: Local, n: usize) -> f64 {
    let behind = |wi: Local| Local(wi.0.with_z(wi.cos().abs().copysign(-wo.cos())));
    0.5 * over_the_sphere(n, |wi| model.eval(wo, behind(wi), TransportMode::Importance).average() as f64)
}

/// Integral over the hemisphere of normals, in the slopes of the distribution: slope = α √(x/(1 − x)) (cos φ, sin φ).
fn over_normals(facets: &Microfacets, n: usize, f: impl Fn(Local) -> f64) -> f64 {
    let alpha = facets.alpha.as_dvec2();
    let mut sum = 0.0;
    for i in 0..n {
        let (x, width) = cell(i, n);
        let (s, ds) = (x / (1.0 - x), width / ((1.0 - x) * (1.0 - x)));
        for j in 0..n {
            let phi = TAU * (j as f64 + 0.5) / n as f64;
            let slope = s.sqrt() * alpha * glam::DVec2::new(phi.cos(), phi.sin());
            let h = slope.extend(1.0).normalize();
            sum += f(Local(h.as_vec3())) * h.z.powi(3) * ds;
        }
    }
    sum * 0.5 * alpha.x * alpha.y * TAU / n as f64
}

/// D at the normal is 1/(π αx αy), and for other directions it equals the textbook formula in f64, down to the smallest roughness.
#[test]
fn distribution_of_normals() {
    for alpha in [1.0f32, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, MIN_ALPHA] {
        for (y, slope) in [(1.0f32, 0.0f64), (1.0, 0.5), (1.0, 3.0), (4.0, 1.5)] {
            let (x, y) = (f64::from(alpha), f64::from(alpha * y));
            let h = glam::DVec3::new(slope * x * 0.6, slope * y * 0.8, 1.0).normalize();
            let local = Local(h.as_vec3());
            // The formula in f64 for the same rounded direction.
            let h = local.0.as_dvec3() / local.0.as_dvec3().length();
            let tan2 = ((h.x / x).powi(2) + (h.y / y).powi(2)) / (h.z * h.z);
            let peak = 1.0 / (PI * x * y * h.z.powi(4));
            for (distribution, exact) in [(Distribution::Ggx, peak / (1.0 + tan2).powi(2)), (Distribution::Beckmann, peak * (-tan2).exp())]
            {
                let d = facets(x as f32, y as f32, distribution).density(local);
                assert!((f64::from(d) / exact - 1.0).abs() < 1e-5, "{distribution:?} {alpha} {slope}: {d} but {exact}");
            }
        }
    }
}

/// ∫ D cos θ = 1, and ∫ D G₁ |wo·h| / cos θo over the normals on the side of wo is 1 for every direction and roughness.
///
/// The tolerance is the error of the midpoint rule: of order h² because of the kink at wo·h = 0, and more for Beckmann's D, which falls
/// steeply in these coordinates.
#[test]
fn weak_furnace() {
    for distribution in BOTH {
        for (x, y) in [(1e-3, 1e-3), (0.1, 0.1), (0.5, 0.5), (1.0, 1.0), (0.4, 0.1), (0.1, 0.8)] {
            let facets = facets(x, y, distribution);
            let projected = over_normals(&facets, 300, |h| facets.density(h) as f64 * h.cos() as f64);
            assert!((projected - 1.0).abs() < 1e-4, "∫ D cos = {projected}: {facets:?}");
            for cos in [1.0, 0.8, 0.5, 0.2, 0.05] {
                let wo = at(cos, 0.7);
                let seen = 2.0 / (wo.cos() as f64 + facets.projected_area(wo) as f64);
                let sum = over_normals(&facets, 1000, |h| facets.density(h) as f64 * (wo.0.dot(h.0) as f64).max(0.0) * seen);
                assert!((sum - 1.0).abs() < 1e-4, "{sum}: {facets:?} at {cos}");
            }
        }
    }
}

/// Share of light that white facets return after one reflection, with height-correlated masking and shadowing.
/// (With uncorrelated masking and shadowing it would be 0.6860 instead of 0.6983 at α = 0.5, μ = 0.5.)
#[test]
fn strong_furnace() {
    let cosines = [1.0, 0.8, 0.5, 0.2, 0.05];
    let rows = [
        (0.1, [0.988273, 0.984552, 0.969196, 0.904559, 0.911763]),
        (0.3, [0.877354, 0.856461, 0.821710, 0.838512, 0.931423]),
        (0.5, [0.687843, 0.682046, 0.698251, 0.789929, 0.912548]),
        (0.7, [0.503716, 0.526368, 0.589901, 0.730721, 0.887201]),
        (1.0, [0.306854, 0.351256, 0.450694, 0.641648, 0.847774]),
    ];
    for (alpha, row) in rows {
        let facets = facets(alpha, alpha, Distribution::Ggx);
        for (cos, exact) in cosines.into_iter().zip(row) {
            let found = reflected(&white_metal(facets, false), &facets, at(cos, 0.3), 600);
            assert!((found - exact).abs() < 5e-4, "α = {alpha}, μ = {cos}: {found} but {exact}");
            let table = 1.0 - rough_conductor::losses(Domain::One(facets.alpha), facets.distribution).loss(at(cos, 0.3), facets.alpha);
            assert!((f64::from(table) - exact).abs() < 1e-3, "table at α = {alpha}, μ = {cos}: {table} but {exact}");
        }
    }
    for (alpha, mean) in [(0.3, 0.846871), (0.5, 0.700241), (1.0, 0.409137)] {
        let table = rough_conductor::losses(Domain::One(Vec2::splat(alpha)), Distribution::Ggx).mean_loss(Vec2::splat(alpha));
        assert!((1.0 - table - mean).abs() < 1e-3, "Ē({alpha}): {}", 1.0 - table);
    }
}

/// Share of light that facets of glass reflect and refract at one encounter, from outside and from inside.
#[test]
fn glass_furnace() {
    let cosines = [1.0, 0.5, 0.2];
    let outside = [
        (0.1, [0.99883, 0.99225, 0.95197]),
        (0.3, [0.98839, 0.94850, 0.90283]),
        (0.5, [0.96811, 0.89263, 0.84080]),
        (1.0, [0.89334, 0.74184, 0.70409]),
    ];
    let cases = outside.map(|(alpha, row)| (alpha, 1.0, row)).into_iter().chain([(0.5, -1.0, [0.75393, 0.65976, 0.66424])]);
    for (alpha, side, row) in cases {
        let facets = facets(alpha, alpha, Distribution::Ggx);
        for (cos, exact) in cosines.into_iter().zip(row) {
            let found = albedo(&clear_glass(1.5, facets, false), at(side * cos, 0.3), 700);
            assert!((found - exact).abs() < 1e-3, "α = {alpha}, μ = {}: {found} but {exact}", side * cos);
        }
    }
}

/// With multiple scattering, white metal and clear glass lose no light: the albedo is 1 ± 2·10⁻³ at any angle.
#[test]
fn compensated_surfaces_are_white() {
    for distribution in BOTH {
        for (x, y) in [(0.1, 0.1), (0.4, 0.4), (1.0, 1.0), (0.2, 0.8)] {
            let facets = facets(x, y, distribution);
            let glass = [1.5, 2.42, 1.0 / 1.5].map(|eta| clear_glass(eta, facets, true));
            for model in [white_metal(facets, true)].into_iter().chain(glass) {
                for (cos, phi) in [(1.0, 0.0), (0.5, 1.2), (0.05, 0.8), (-0.9, 0.5), (-0.2, 0.1)] {
                    let wo = at(cos, phi);
                    // Narrow lobes need small cells.
                    let n = if x < 0.15 { 600 } else { 400 };
                    let through = if matches!(model, Bsdf::RoughDielectric(_)) { transmitted(&model, wo, n) } else { 0.0 };
                    let found = reflected(&model, &facets, wo, 300) + through;
                    assert!((found - 1.0).abs() < 2e-3, "{found} at {cos}, {phi}: {model:?}");
                }
            }
        }
    }
}
