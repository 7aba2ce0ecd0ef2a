//! Materials: microfacets against quadrature and published values, and every model against the laws of [`crate::proof`].

use std::f64::consts::{PI, TAU};

use glam::Vec2;

use super::{Failures, Row};
use crate::bsdf::microfacet::energy_loss::Domain;
use crate::bsdf::microfacet::{Distribution, MIN_ALPHA, Microfacets};
use crate::bsdf::rough_conductor;
use crate::bsdf::rough_dielectric;
use crate::bsdf::{
    Bsdf, Dielectric, Diffuse, DiffuseTransmission, LommelSeeliger, MatteCone, Mirror, OrenNayar, Plastic, Reflectance, RoughConductor,
    RoughDielectric, ThinDielectric, TransportMode,
};
use crate::math::warp::{cos_power_hemisphere, cos_power_hemisphere_pdf};
use crate::math::{Local, Spectrum};
use crate::proof::{Furnace, Options, prove};

/// The rows.
pub fn rows() -> Vec<Row> {
    vec![weak_furnace(), strong_furnace(), compensated(), glass_furnace(), peaks(), laws(), lobes()]
}

fn name(distribution: Distribution) -> &'static str {
    match distribution {
        Distribution::Ggx => "GGX",
        Distribution::Beckmann => "Beckmann",
    }
}

/// M1. ∫ D cos θ = 1, and ∫ D G₁ |wo·h| / cos θo = 1 over the normals on the side of wo.
fn weak_furnace() -> Row {
    let row = Row::new("M1", "weak white furnace: the facets seen from anywhere have the area seen", "the midpoint rule, of order h²");
    let alphas = [(1e-3, 1e-3), (0.1, 0.1), (0.5, 0.5), (1.0, 1.0), (0.4, 0.1), (0.1, 0.8)];
    let settings = [Distribution::Ggx, Distribution::Beckmann].into_iter().flat_map(|d| alphas.map(|(x, y)| (d, x, y)));
    settings.fold(row, |row, (distribution, x, y)| {
        let row = row.number(format!("{} {x} {y}, projected", name(distribution)), 1.0, 1e-4, move || {
            let facets = facets(x, y, distribution);
            over_normals(&facets, 300, |h| facets.density(h) as f64 * h.cos() as f64)
        });
        [1.0, 0.8, 0.5, 0.2, 0.05].into_iter().fold(row, |row, cos| {
            row.number(format!("{} {x} {y}, cosine {cos}", name(distribution)), 1.0, 1e-4, move || {
                let (facets, wo) = (facets(x, y, distribution), at(cos, 0.7));
                let seen = 2.0 / (wo.cos() as f64 + facets.projected_area(wo) as f64);
                over_normals(&facets, 1000, |h| facets.density(h) as f64 * (wo.0.dot(h.0) as f64).max(0.0) * seen)
            })
        })
    })
}

/// M2. With uncorrelated masking and shadowing it would be .6860 and not .6983 at α = .5, cosine .5.
fn strong_furnace() -> Row {
    let cosines = [1.0, 0.8, 0.5, 0.2, 0.05];
    let table = [
        (0.1, [0.988273, 0.984552, 0.969196, 0.904559, 0.911763]),
        (0.3, [0.877354, 0.856461, 0.821710, 0.838512, 0.931423]),
        (0.5, [0.687843, 0.682046, 0.698251, 0.789929, 0.912548]),
        (0.7, [0.503716, 0.526368, 0.589901, 0.730721, 0.887201]),
        (1.0, [0.306854, 0.351256, 0.450694, 0.641648, 0.847774]),
    ];
    let row = Row::new("M2", "light that white facets return after one reflection (GGX)", "midpoint rule; tables 1e-3");
    let cells = table.into_iter().flat_map(|(alpha, row)| cosines.into_iter().zip(row).map(move |(cos, exact)| (alpha, cos, exact)));
    let row = cells.fold(row, |row, (alpha, cos, exact)| {
        row.number(format!("alpha {alpha}, cosine {cos}"), exact, 5e-4, move || {
            let facets = facets(alpha, alpha, Distribution::Ggx);
            reflected(&white_metal(facets, false), &facets, at(cos, 0.3), 600)
        })
        .number(format!("alpha {alpha}, cosine {cos}, table"), exact, 1e-3, move || {
            let alpha = Vec2::splat(alpha);
            1.0 - f64::from(rough_conductor::losses(Domain::One(alpha), Distribution::Ggx).loss(at(cos, 0.3), alpha))
        })
    });
    [(0.3, 0.846871), (0.5, 0.700241), (1.0, 0.409137)].into_iter().fold(row, |row, (alpha, mean)| {
        row.number(format!("alpha {alpha}, mean, table"), mean, 1e-3, move || {
            let alpha = Vec2::splat(alpha);
            1.0 - f64::from(rough_conductor::losses(Domain::One(alpha), Distribution::Ggx).mean_loss(alpha))
        })
    })
}

/// M4. With multiple scattering, white metal and clear glass lose no light.
fn compensated() -> Row {
    let row = Row::new("M4", "light that white metal and clear glass scatter, multiple scattering included", "error of the tables");
    let alphas = [(0.1, 0.1), (0.4, 0.4), (1.0, 1.0), (0.2, 0.8)];
    let settings = [Distribution::Ggx, Distribution::Beckmann].into_iter().flat_map(|d| alphas.map(|(x, y)| (d, x, y)));
    settings.flat_map(|setting| [None, Some(1.5), Some(2.42), Some(1.0 / 1.5)].map(|eta| (setting, eta))).fold(
        row,
        |row, ((distribution, x, y), eta)| {
            [(1.0, 0.0), (0.5, 1.2), (0.05, 0.8), (-0.9, 0.5), (-0.2, 0.1)].into_iter().fold(row, |row, (cos, phi)| {
                let body = eta.map_or("metal".into(), |eta: f32| format!("glass {eta:.2}"));
                row.number(format!("{} {x} {y}, {body}, cosine {cos}", name(distribution)), 1.0, 2e-3, move || {
                    let (facets, wo) = (facets(x, y, distribution), at(cos, phi));
                    // Narrow lobes need small cells.
                    let n = if x < 0.15 { 600 } else { 400 };
                    match eta {
                        None => reflected(&white_metal(facets, true), &facets, wo, 300),
                        Some(eta) => {
                            let glass = clear_glass(eta, facets, true);
                            reflected(&glass, &facets, wo, 300) + transmitted(&glass, wo, n)
                        }
                    }
                })
                // Glass of each kind needs a table of its own, which takes a second.
                .slow(eta.is_some() && (eta != Some(1.5) || distribution == Distribution::Beckmann))
            })
        },
    )
}

/// M5. Facets of glass, from outside and from inside.
fn glass_furnace() -> Row {
    let cosines = [1.0, 0.5, 0.2];
    let outside = [
        (0.1, [0.99883, 0.99225, 0.95197]),
        (0.3, [0.98839, 0.94850, 0.90283]),
        (0.5, [0.96811, 0.89263, 0.84080]),
        (1.0, [0.89334, 0.74184, 0.70409]),
    ];
    let table = outside.map(|(alpha, row)| (alpha, 1.0, row)).into_iter().chain([(0.5, -1.0, [0.75393, 0.65976, 0.66424])]);
    let row = Row::new("M5", "light that facets of glass 1.5 scatter at one encounter (GGX)", "midpoint rule");
    let cells = table.flat_map(|(alpha, side, row)| cosines.into_iter().zip(row).map(move |(cos, exact)| (alpha, side * cos, exact)));
    cells.fold(row, |row, (alpha, cos, exact)| {
        row.number(format!("alpha {alpha}, cosine {cos}"), exact, 1e-3, move || {
            albedo(&clear_glass(1.5, facets(alpha, alpha, Distribution::Ggx), false), at(cos, 0.3), 700)
        })
    })
}

/// M6. D at the normal is 1/(π αx αy), and for other directions the textbook's formula in f64, down to the smallest roughness.
fn peaks() -> Row {
    let row = Row::new("M6", "distribution of normals over the exact one", "a few roundings");
    let row = row.peers("the textbook's form in f32: -2.6 % at 1e-3, infinite from 1e-4");
    let alphas = [1.0f32, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, MIN_ALPHA];
    let shapes = [(1.0f32, 0.0f64), (1.0, 0.5), (1.0, 3.0), (4.0, 1.5)];
    let settings = [Distribution::Ggx, Distribution::Beckmann].into_iter().flat_map(|d| alphas.map(|alpha| (d, alpha)));
    settings.flat_map(|setting| shapes.map(|shape| (setting, shape))).fold(row, |row, ((distribution, alpha), (stretch, slope))| {
        let setup = format!("{} {alpha:e}, 1:{stretch}, slope {slope}", name(distribution));
        row.number(setup, 1.0, 1e-5, move || {
            let (x, y) = (f64::from(alpha), f64::from(alpha * stretch));
            let local = Local(glam::DVec3::new(slope * x * 0.6, slope * y * 0.8, 1.0).normalize().as_vec3());
            // The formula in f64 for the same rounded direction.
            let h = local.0.as_dvec3().normalize();
            let tan2 = ((h.x / x).powi(2) + (h.y / y).powi(2)) / (h.z * h.z);
            let peak = 1.0 / (PI * x * y * h.z.powi(4));
            let exact = match distribution {
                Distribution::Ggx => peak / (1.0 + tan2).powi(2),
                Distribution::Beckmann => peak * (-tan2).exp(),
            };
            f64::from(facets(x as f32, y as f32, distribution).density(local)) / exact
        })
    })
}

/// M7 to M10. Reciprocity, weights and densities of samples, corners of the square, energy, and the distribution of samples.
fn laws() -> Row {
    let color = Spectrum::rgb(0.25, 0.5, 1.0);
    let gold = Reflectance::Index { eta: Spectrum::rgb(0.18, 0.42, 1.37), k: Spectrum::rgb(3.42, 2.35, 1.77) };
    let plain = [
        ("diffuse", Bsdf::Diffuse(Diffuse { albedo: color }), false),
        ("Oren-Nayar .7", Bsdf::OrenNayar(OrenNayar { albedo: Spectrum::ONE, roughness: 0.7 }), true),
        ("paper", Bsdf::DiffuseTransmission(DiffuseTransmission { reflectance: color * 0.5, transmittance: color * 0.5 }), false),
        ("dust", Bsdf::LommelSeeliger(LommelSeeliger { albedo: color }), false),
        ("mirror", Bsdf::Mirror(Mirror { color }), false),
        ("cone .3", Bsdf::MatteCone(MatteCone { color: Spectrum::ONE, mattness: 0.3 }), true),
        ("plastic 1.5", Bsdf::Plastic(Plastic { albedo: Spectrum::ONE, eta: 1.5, internal: Plastic::internal(1.5) }), true),
        ("glass 1.5", Bsdf::Dielectric(Dielectric { eta: 1.5, color: Spectrum::ONE }), true),
        ("glass 1/1.5", Bsdf::Dielectric(Dielectric { eta: 1.0 / 1.5, color: Spectrum::ONE }), true),
        ("thin pane", Bsdf::ThinDielectric(ThinDielectric { eta: 1.5, color: Spectrum::ONE }), true),
    ];
    let mut models: Vec<(String, Bsdf<'static>, bool)> =
        plain.into_iter().map(|(name, model, white)| (name.into(), model, white)).collect();
    for (x, y) in [(0.05, 0.05), (0.1, 0.1), (0.3, 0.3), (0.7, 0.7), (1.0, 1.0), (0.4, 0.1)] {
        let facets = facets(x, y, Distribution::Ggx);
        models.push((format!("gold {x} {y}"), Bsdf::RoughConductor(RoughConductor { reflectance: gold, facets, more: None }), false));
        for eta in [1.33, 1.5, 1.0 / 1.5, 2.42] {
            models.push((format!("frosted {eta:.2}, {x} {y}"), clear_glass(eta, facets, false), false));
        }
    }
    let suite = models.len();
    let row = Row::new("M10", "laws that a model breaks: reciprocity, weights, densities, chi², energy", "1 % of false alarms in all");
    let row = row.peers("pbrt: microfacet energy is switched off; Mitsuba: rough glass of .05 is switched off");
    models.into_iter().fold(row, |row, (setup, model, white)| {
        row.never(setup, 1_000_000, move |tries| {
            let furnace = if white { Furnace::Lossless(2e-3) } else { Furnace::Passive };
            let options = Options { samples: tries, cases: (tries / 50).max(1000), suite, furnace, ..Options::default() };
            let report = prove(&model, &options);
            let first = report.refusals().next().map(|(finding, example)| format!("{}: {}", finding.law, example.inputs));
            Failures { tries, failures: report.refusals().count() as u64, first }
        })
    })
}

/// M11. Cosine lobes of the exponents 10⁶ and 10⁸: mean cosine (n + 1)/(n + 2), finite densities.
fn lobes() -> Row {
    let row =
        Row::new("M11", "1 - mean cosine of narrow cosine lobes, over 1/(n + 2)", "4.4 standard errors of the samples, and f32 near 1");
    [1e2f32, 1e4, 1e6].into_iter().fold(row, |row, n| {
        row.number(format!("exponent {n:e}"), 1.0, 0.02, move || {
            let mut random = super::Random::new(11);
            const SAMPLES: u32 = 1 << 17;
            let sum: f64 = (0..SAMPLES)
                .map(|_| {
                    let w = cos_power_hemisphere(random.uniform_square(), n);
                    let is_finite = cos_power_hemisphere_pdf(w, n).is_finite();
                    // 1 − cos θ from the sine, which keeps its digits.
                    let sin2 = w.as_dvec3().truncate().length_squared();
                    if is_finite { sin2 / (1.0 + (1.0 - sin2).sqrt()) } else { f64::NAN }
                })
                .sum();
            sum / f64::from(SAMPLES) * f64::from(n + 2.0)
        })
    })
}

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
