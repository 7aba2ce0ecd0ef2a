//! Laws of scattering, over every model and generated parameters (reliability M7–M9, M12).

use std::f64::consts::TAU;

use glam::{Vec2, Vec3};
use proptest::prelude::*;
use pt::bsdf::microfacet::albedo::Domain;
use pt::bsdf::microfacet::{Distribution, Microfacets};
use pt::bsdf::rough_conductor::{self, MoreReflections};
use pt::bsdf::rough_dielectric::{self, MoreEncounters};
use pt::bsdf::{
    Bsdf, Conductor, Dielectric, Diffuse, Lobe, MatteCone, Mirror, RoughConductor, RoughDielectric, ThinDielectric, TransportMode,
};
use pt::math::float::ONE_MINUS_EPSILON;
use pt::math::{Density, Local, Spectrum};

use crate::random::cases;

const ULP: f32 = f32::EPSILON;

fn color() -> impl Strategy<Value = Spectrum> {
    prop_oneof![4 => [0f32..=1.0, 0f32..=1.0, 0f32..=1.0].prop_map(|[r, g, b]| Spectrum::rgb(r, g, b)), 1 => Just(Spectrum::ONE)]
}

fn mattness() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0f32), Just(1.0), Just(1e-8), (-6f32..0.0).prop_map(|e| 10f32.powf(e)), 0f32..=1.0]
}

fn eta() -> impl Strategy<Value = f32> {
    prop_oneof![Just(1.0f32), Just(1.5), Just(1.0 / 1.5), Just(1.000001), (-0.5f32..0.5).prop_map(|e| 10f32.powf(e))]
}

fn distribution() -> impl Strategy<Value = Distribution> {
    prop_oneof![Just(Distribution::Ggx), Just(Distribution::Beckmann)]
}

/// Down to the smoothest that is still rough, and beyond 1; one in four rougher one way than the other.
fn facets() -> impl Strategy<Value = Microfacets> {
    let alpha = || prop_oneof![4 => (-6f32..0.0).prop_map(|e| 10f32.powf(e)), 1 => Just(1.0f32), 1 => Just(3.1f32), 1 => Just(1e-6f32)];
    (alpha(), alpha(), 0..4, distribution())
        .prop_map(|(x, y, way, distribution)| Microfacets { alpha: Vec2::new(x, if way == 0 { y } else { x }), distribution })
}

/// Some whose tables are made once.
fn tabulated_facets() -> impl Strategy<Value = Microfacets> {
    let alpha = prop::sample::select(vec![Vec2::splat(1e-3), Vec2::splat(0.1), Vec2::splat(0.6), Vec2::new(0.8, 0.2)]);
    (alpha, distribution()).prop_map(|(alpha, distribution)| Microfacets { alpha, distribution })
}

fn rough_metal(eta: Spectrum, k: Spectrum) -> impl Strategy<Value = Bsdf> {
    let compensated = move |facets: Microfacets| {
        let losses = rough_conductor::losses(Domain::One(facets.alpha), facets.distribution);
        let more = MoreReflections::new(losses, facets.alpha, rough_conductor::mean_reflectance(eta, k));
        Bsdf::RoughConductor(RoughConductor { eta, k, facets, more })
    };
    prop_oneof![
        2 => facets().prop_map(move |facets| Bsdf::RoughConductor(RoughConductor { eta, k, facets, more: None })),
        1 => tabulated_facets().prop_map(compensated),
    ]
}

fn rough_glass() -> impl Strategy<Value = Bsdf> {
    let tabulated = prop::sample::select(vec![1.5f32, 1.0 / 1.5, 2.42]);
    let compensated = |(eta, color, facets): (f32, Spectrum, Microfacets)| {
        let losses = rough_dielectric::losses(eta, Domain::One(facets.alpha), facets.distribution);
        Bsdf::RoughDielectric(RoughDielectric { eta, color, facets, more: MoreEncounters::new(losses, facets.alpha, eta) })
    };
    let plain = |(eta, color, facets): (f32, Spectrum, Microfacets)| {
        let rough = RoughDielectric::is_rough(eta, facets.alpha);
        let model = RoughDielectric { eta, color, facets, more: None };
        if rough { Bsdf::RoughDielectric(model) } else { Bsdf::Dielectric(Dielectric { eta, color }) }
    };
    prop_oneof![
        2 => (eta(), color(), facets()).prop_map(plain),
        1 => (tabulated, color(), tabulated_facets()).prop_map(compensated),
    ]
}

fn is_rough(model: &Bsdf) -> bool {
    matches!(model, Bsdf::RoughConductor(_) | Bsdf::RoughDielectric(_))
}

fn model() -> impl Strategy<Value = Bsdf> {
    let metal = ([0.05f32..5.0, 0.05f32..5.0, 0.05f32..5.0], [0f32..9.0, 0f32..9.0, 0f32..9.0]);
    let rough = ([0.05f32..5.0, 0.05f32..5.0, 0.05f32..5.0], [0f32..9.0, 0f32..9.0, 0f32..9.0])
        .prop_flat_map(|([a, b, c], [d, e, f])| rough_metal(Spectrum::rgb(a, b, c), Spectrum::rgb(d, e, f)));
    prop_oneof![
        rough,
        rough_glass(),
        (eta(), color()).prop_map(|(eta, color)| Bsdf::ThinDielectric(ThinDielectric { eta, color })),
        color().prop_map(|albedo| Bsdf::Diffuse(Diffuse { albedo })),
        color().prop_map(|color| Bsdf::Mirror(Mirror { color })),
        metal.prop_map(|([a, b, c], [d, e, f])| Bsdf::Conductor(Conductor { eta: Spectrum::rgb(a, b, c), k: Spectrum::rgb(d, e, f) })),
        (eta(), color()).prop_map(|(eta, color)| Bsdf::Dielectric(Dielectric { eta, color })),
        (color(), mattness()).prop_map(|(color, mattness)| Bsdf::MatteCone(MatteCone { color, mattness })),
    ]
}

/// Uniform by cosine, with grazing and straight ones added, on both sides.
fn direction() -> impl Strategy<Value = Local> {
    let cosine = prop_oneof![4 => 1e-3f32..=1.0, 1 => Just(1.0f32), 1 => Just(1e-7), 1 => (-7f32..0.0).prop_map(|e| 10f32.powf(e))];
    (cosine, 0f64..TAU, any::<bool>()).prop_map(|(cosine, phi, below)| {
        let (z, sine) = (cosine as f64, ((1.0 - cosine as f64) * (1.0 + cosine as f64)).sqrt());
        Local::new((sine * phi.cos()) as f32, (sine * phi.sin()) as f32, if below { -z } else { z } as f32)
    })
}

fn uniform() -> impl Strategy<Value = f32> {
    prop_oneof![1 => Just(0.0f32), 1 => Just(ONE_MINUS_EPSILON), 1 => Just(ULP / 2.0), 8 => any::<u32>().prop_map(pt::math::float::unit_f32)]
}

fn square() -> impl Strategy<Value = Vec2> {
    (uniform(), uniform()).prop_map(|(x, y)| Vec2::new(x, y))
}

fn mode() -> impl Strategy<Value = TransportMode> {
    prop_oneof![Just(TransportMode::Radiance), Just(TransportMode::Importance)]
}

fn near(a: Spectrum, b: Spectrum, relative: f32) -> bool {
    a.zip(b, |a, b| if (a - b).abs() <= relative * a.abs().max(b.abs()) { 0.0 } else { 1.0 }).is_black()
}

/// What a model reflects at most, per coefficient.
fn bound(model: &Bsdf) -> Spectrum {
    match model {
        Bsdf::Diffuse(b) => b.albedo,
        Bsdf::Mirror(b) => b.color,
        Bsdf::Conductor(_) => Spectrum::ONE,
        Bsdf::Dielectric(b) => b.color,
        Bsdf::MatteCone(b) => b.color,
        Bsdf::ThinDielectric(b) => b.color,
        // Three roundings in the division by the density.
        Bsdf::RoughConductor(RoughConductor { more: None, .. }) => Spectrum::gray(1.0 + 4.0 * ULP),
        Bsdf::RoughDielectric(b) if b.more.is_none() => b.color * (1.0 + 4.0 * ULP),
        // One lobe may be sampled where the other is bright: only the mean is bounded.
        Bsdf::RoughConductor(_) => Spectrum::gray(f32::MAX),
        Bsdf::RoughDielectric(b) => b.color * f32::MAX,
    }
}

/// Whether a direction lies so near the rim of a cone that rounding decides: within two roundings of unit vectors.
fn at_rim(model: &Bsdf, wo: Local, wi: Local) -> bool {
    let Bsdf::MatteCone(cone) = model else { return false };
    let angle = cone.mattness as f64 * std::f64::consts::FRAC_PI_2;
    let chord = 2.0 * (0.5 * angle).sin();
    let mirror = Vec3::new(-wo.0.x, -wo.0.y, wo.0.z).as_dvec3();
    let ways = [wi.0, wi.0 * Vec3::new(1.0, 1.0, -1.0)];
    ways.iter().any(|w| ((w.as_dvec3() - mirror).length() - chord).abs() < 4.0 * ULP as f64)
}

proptest! {
    #![proptest_config(cases(100_000))]

    /// M8: what is sampled is unit, finite, on the side it says, no brighter than the model, and has the density it says.
    #[test]
    fn sample_eval_pdf_agree(model in model(), wo in direction(), choice in uniform(), u in square(), mode in mode()) {
        let Some(sample) = model.sample(wo, choice, u, mode) else {
            prop_assert!(bound(&model).is_black() || matches!(model, Bsdf::MatteCone(_)) || is_rough(&model), "{model:?} gave nothing");
            return Ok(());
        };
        let wi = sample.wi;
        prop_assert!((wi.0.as_dvec3().length() - 1.0).abs() <= 4.0 * ULP as f64, "{wi:?} has length {}", wi.0.length());
        prop_assert_eq!(wo.same_side(wi), sample.lobe == Lobe::Reflection);
        prop_assert!(sample.weight.is_valid() && sample.eta > 0.0 && sample.eta.is_finite());
        match sample.density {
            Density::Delta => {
                prop_assert!(model.eval(wo, wi, mode).is_black());
                prop_assert_eq!(model.pdf(wo, wi).get(), 0.0);
                prop_assert!(!model.has_smooth_lobe());
            }
            Density::Smooth(pdf) => {
                prop_assert!(pdf.get() > 0.0 && pdf.get().is_finite());
                prop_assert!(model.has_smooth_lobe());
                if !at_rim(&model, wo, wi) {
                    prop_assert_eq!(model.pdf(wo, wi), pdf);
                    prop_assert!(near(model.eval(wo, wi, mode), sample.weight * pdf.get(), 4.0 * ULP), "{:?}", model.eval(wo, wi, mode));
                }
            }
        }
        // Light gained by compression is given back on leaving: importance has none.
        if mode == TransportMode::Importance || sample.lobe == Lobe::Reflection {
            prop_assert!((bound(&model) - sample.weight).min() >= 0.0, "{:?} exceeds {:?}", sample.weight, bound(&model));
        }
    }

    /// `eval` and `pdf` of any two directions: finite, not negative, nothing through the surface; the mode does not matter to reflection.
    #[test]
    fn eval_and_pdf_are_sound(model in model(), wo in direction(), wi in direction()) {
        let f = model.eval(wo, wi, TransportMode::Radiance);
        let pdf = model.pdf(wo, wi).get();
        prop_assert!(f.is_valid() && pdf >= 0.0 && pdf.is_finite());
        if let (Bsdf::RoughDielectric(glass), false) = (model, wo.same_side(wi)) {
            let eta = if wo.cos() > 0.0 { glass.eta } else { 1.0 / glass.eta };
            prop_assert!(near(f * (eta * eta), model.eval(wo, wi, TransportMode::Importance), 4.0 * ULP));
        } else {
            prop_assert_eq!(f, model.eval(wo, wi, TransportMode::Importance));
            prop_assert!(wo.same_side(wi) || (f.is_black() && pdf == 0.0));
        }
        // Sampling finds whatever is there.
        prop_assert!(f.is_black() || pdf > 0.0);
    }

    /// A white model in a white furnace: every weight is 1, to the last bit.
    #[test]
    fn furnace(wo in direction(), choice in uniform(), u in square(), mattness in mattness(), eta in eta()) {
        let color = Spectrum::ONE;
        let models = [
            Bsdf::Diffuse(Diffuse { albedo: color }),
            Bsdf::Mirror(Mirror { color }),
            Bsdf::Dielectric(Dielectric { eta, color }),
            Bsdf::MatteCone(MatteCone { color, mattness }),
        ];
        for model in models {
            let weight = model.sample(wo, choice, u, TransportMode::Importance).map(|s| s.weight);
            // A cone may end exactly in the surface.
            prop_assert!(weight == Some(color) || (weight.is_none() && matches!(model, Bsdf::MatteCone(_))), "{model:?}: {weight:?}");
        }
    }

    /// The shares of reflection and refraction make up the colour.
    #[test]
    fn delta_lobes_make_up_the_color(wo in direction(), eta in eta(), color in color()) {
        for model in [Bsdf::Mirror(Mirror { color }), Bsdf::Dielectric(Dielectric { eta, color })] {
            let sum: Spectrum = model.delta_lobes(wo, TransportMode::Importance).map(|lobe| lobe.weight).sum();
            prop_assert!(near(sum, color, 2.0 * ULP), "{model:?}: {sum:?}");
        }
    }

    /// `delta_lobes` are what `sample` chooses from: the same directions, weights divided by the chance of each.
    #[test]
    fn delta_lobes_are_the_samples(model in model(), wo in direction(), choice in uniform(), mode in mode()) {
        let Some(sample) = model.sample(wo, choice, Vec2::splat(0.5), mode) else { return Ok(()) };
        let mut lobes = model.delta_lobes(wo, mode);
        let found = lobes.find(|lobe| lobe.lobe == sample.lobe);
        match sample.density {
            Density::Smooth(_) => prop_assert!(found.is_none()),
            Density::Delta => {
                let lobe = found.expect("sampled, so there");
                prop_assert_eq!((lobe.wi, lobe.eta), (sample.wi, sample.eta));
                prop_assert!((sample.weight - lobe.weight).min() >= 0.0);
            }
        }
    }

    /// Radiance is divided by η² on the way in and multiplied on the way out of a slab, where it leaves as it came.
    #[test]
    fn radiance_is_compressed_and_restored(wo in direction(), eta in eta(), color in color()) {
        let model = Bsdf::Dielectric(Dielectric { eta, color });
        let pass = |wo: Local, mode| model.delta_lobes(wo, mode).find(|lobe| lobe.lobe == Lobe::Transmission);
        let (Some(entry), Some(flux)) = (pass(wo, TransportMode::Radiance), pass(wo, TransportMode::Importance)) else { return Ok(()) };
        prop_assert!(near(entry.weight * (entry.eta * entry.eta), flux.weight, 4.0 * ULP));
        // The far face looks the other way: back along the path, seen from inside of it.
        let back = Local::new(-entry.wi.0.x, -entry.wi.0.y, entry.wi.0.z);
        let Some(exit) = pass(back, TransportMode::Radiance) else { return Ok(()) };
        let Some(exit_flux) = pass(back, TransportMode::Importance) else { return Ok(()) };
        prop_assert!((exit.eta * entry.eta - 1.0).abs() <= 2.0 * ULP);
        prop_assert!(near(entry.weight * exit.weight, flux.weight * exit_flux.weight, 8.0 * ULP));
        // O1, where one rounding of the direction inside does not turn the one outside by much.
        let onwards = Vec3::new(exit.wi.0.x, exit.wi.0.y, -exit.wi.0.z);
        let amplified = ULP * (1.0 + eta.max(1.0 / eta)).powi(2) / wo.abs_cos().min(entry.wi.abs_cos());
        prop_assert!((onwards + wo.0).length() <= 2.0 * amplified + 2.0 * ULP, "{onwards} but {wo:?}");
    }

    /// M7: f(a, b) = f(b, a) where the model says so; for refraction the flux that passes is the same both ways (Stokes).
    #[test]
    fn reciprocity(model in model(), wo in direction(), wi in direction()) {
        if !model.reciprocal() {
            return Ok(());
        }
        let (there, back) = (model.eval(wo, wi, TransportMode::Radiance), model.eval(wi, wo, TransportMode::Radiance));
        // Per η² on the side that is looked from.
        let eta = |w: Local| if let (Bsdf::RoughDielectric(glass), true) = (model, w.cos() < 0.0) { glass.eta } else { 1.0 };
        let (there, back) = (there * (wo.abs_cos() / eta(wo).powi(2)), back * (wi.abs_cos() / eta(wi).powi(2)));
        prop_assert!(near(there, back, 4e-6), "{there:?} but {back:?}");
        for lobe in model.delta_lobes(wo, TransportMode::Importance) {
            let reverse = model.delta_lobes(lobe.wi, TransportMode::Importance).find(|r| r.lobe == lobe.lobe);
            let reverse = reverse.map_or(Spectrum::BLACK, |r| r.weight);
            // A cosine rounded by one part in 2²⁴ moves Fresnel's reflectance by that over the cosine itself.
            let Bsdf::Dielectric(glass) = model else { prop_assert_eq!(reverse, lobe.weight); continue };
            let steep = glass.eta.max(1.0 / glass.eta).powi(2) / wo.abs_cos().min(lobe.wi.abs_cos());
            let error = (reverse - lobe.weight).map(f32::abs).max();
            prop_assert!(error <= 64.0 * ULP * steep, "{error} for {model:?}");
        }
    }
}

/// Why the cone is not reciprocal: β off the normal, f is 1/(Ω cos β) one way and 1/Ω the other.
#[test]
fn cone_is_not_reciprocal() {
    let model = Bsdf::MatteCone(MatteCone { color: Spectrum::ONE, mattness: 0.9 });
    assert!(!model.reciprocal());
    let beta = 0.5f32;
    let (a, b) = (Local::NORMAL, Local::new(beta.sin(), 0.0, beta.cos()));
    let f = |wo: Local, wi: Local| model.eval(wo, wi, TransportMode::Radiance).average() / wi.abs_cos();
    assert!((f(a, b) / f(b, a) - 1.0 / beta.cos()).abs() < 1e-6);
}

/// M9 and M12: ∫ pdf = 1 and ∫ f·|cos| = colour over the sphere of directions, by the midpoint rule.
///
/// Error: the rim of a cone cuts cells; at most the share of cells it cuts, 8/N of the patch, half of them
/// wrongly counted, and their signs differ from cell to cell: far below 1/N.
#[test]
fn densities_and_albedos_integrate() {
    const N: usize = 1000;
    let color = Spectrum::rgb(0.25, 0.5, 1.0);
    let cones = [1e-3, 0.02, 0.3, 0.7, 1.0].map(|mattness| Bsdf::MatteCone(MatteCone { color, mattness }));
    let diffuse = Bsdf::Diffuse(Diffuse { albedo: color });
    for model in cones.into_iter().chain([diffuse]) {
        for theta in [0.0f64, 0.4, 1.0, 1.5, 1.5700] {
            let wo = Local::new(theta.sin() as f32, 0.0, theta.cos() as f32);
            let (pdf, albedo) = integrate(&model, wo, theta, N);
            assert!((pdf - 1.0).abs() < 2.0 / N as f64, "∫ pdf = {pdf}: {model:?} at {theta}");
            let error = (albedo - color).map(f32::abs).max();
            assert!(error < 2.0 / N as f32, "albedo {albedo:?}: {model:?} at {theta}");
        }
    }
}

/// Over the patch of the sphere, bounded by angles, that holds the cone around the mirror direction and what
/// is folded up from below; nothing is anywhere else.
fn integrate(model: &Bsdf, wo: Local, theta: f64, n: usize) -> (f64, Spectrum) {
    let alpha = match model {
        Bsdf::MatteCone(cone) => cone.mattness as f64 * std::f64::consts::FRAC_PI_2 * 1.01,
        _ => 4.0,
    };
    let (low, high) = ((theta - alpha).max(0.0), (theta + alpha).min(std::f64::consts::FRAC_PI_2));
    let phi = if alpha < theta && alpha < 1.5 { (alpha.sin() / theta.sin()).min(1.0).asin() } else { std::f64::consts::PI };
    // Cells of equal solid angle: cos θ = 1 − h, with h = 2 sin²(θ/2) for narrow cones.
    let h = |theta: f64| 2.0 * (0.5 * theta).sin().powi(2);
    let cell = (h(high) - h(low)) * 2.0 * phi / (n * n) as f64;
    let (mut pdf, mut albedo) = (0.0, [0.0f64; 3]);
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let h = h(low) + (h(high) - h(low)) * (i as f64 + 0.5) / n as f64;
        let turn = std::f64::consts::PI - phi + 2.0 * phi * (j as f64 + 0.5) / n as f64;
        let sine = (h * (2.0 - h)).sqrt();
        let wi = Local::new((sine * turn.cos()) as f32, (sine * turn.sin()) as f32, (1.0 - h) as f32);
        pdf += model.pdf(wo, wi).get() as f64 * cell;
        let f = model.eval(wo, wi, TransportMode::Radiance).to_rgb();
        (0..3).for_each(|c| albedo[c] += f[c] as f64 * cell);
    }
    (pdf, Spectrum::rgb(albedo[0] as f32, albedo[1] as f32, albedo[2] as f32))
}
