//! Matte, glossy and coated models: the properties of each model in addition to the laws that hold for all.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::Vec2;
use proptest::prelude::*;
use pt::bsdf::{BlinnPhong, Bsdf, DiffuseTransmission, Lobe, LommelSeeliger, Metal, OrenNayar, Phong, Plastic, TransportMode};
use pt::math::float::unit_f32;
use pt::math::fresnel::{dielectric, dielectric_mean};
use pt::math::{Density, Local, Spectrum};

use crate::random::{Random, cases};

const ULP: f32 = f32::EPSILON;
const COLOR: Spectrum = Spectrum::rgb(0.25, 0.5, 1.0);

fn plastic(albedo: Spectrum, eta: f32) -> Bsdf<'static> {
    Bsdf::Plastic(Plastic { albedo, eta, internal: Plastic::internal(eta) })
}

fn model() -> impl Strategy<Value = Bsdf<'static>> {
    let exponent = prop_oneof![Just(0f32), Just(1.0), (0f32..8.0).prop_map(|e| 10f32.powf(e))];
    let share = prop_oneof![Just(0f32), Just(1.0), (-6f32..0.0).prop_map(|e| 10f32.powf(e)), 0f32..=1.0];
    let eta = prop_oneof![Just(1f32), Just(1.5), 1f32..=4.0];
    prop_oneof![
        share.clone().prop_map(|roughness| Bsdf::OrenNayar(OrenNayar { albedo: COLOR, roughness })),
        Just(Bsdf::LommelSeeliger(LommelSeeliger { albedo: COLOR })),
        exponent.clone().prop_map(|exponent| Bsdf::Phong(Phong { color: COLOR, exponent })),
        exponent.prop_map(|exponent| Bsdf::BlinnPhong(BlinnPhong { color: COLOR, exponent })),
        share.prop_map(|roughness| Bsdf::Metal(Metal { color: COLOR, roughness })),
        eta.prop_map(|eta| plastic(COLOR, eta)),
        Just(Bsdf::DiffuseTransmission(DiffuseTransmission { reflectance: COLOR * 0.5, transmittance: COLOR * 0.25 })),
    ]
}

fn direction() -> impl Strategy<Value = Local> {
    let cosine = prop_oneof![4 => 1e-3f64..=1.0, 1 => Just(1.0f64), 1 => (-7f64..0.0).prop_map(|e| 10f64.powf(e))];
    (cosine, 0f64..TAU, any::<bool>()).prop_map(|(z, phi, below)| {
        let sine = ((1.0 - z) * (1.0 + z)).sqrt();
        Local::new((sine * phi.cos()) as f32, (sine * phi.sin()) as f32, if below { -z } else { z } as f32)
    })
}

fn uniform() -> impl Strategy<Value = f32> {
    prop_oneof![1 => Just(0f32), 1 => Just(unit_f32(u32::MAX)), 8 => any::<u32>().prop_map(unit_f32)]
}

proptest! {
    #![proptest_config(cases(100_000))]

    /// A sampled direction is a unit vector on the side that the lobe names, with the weight and density that follow from `eval` and `pdf`.
    #[test]
    fn samples_match_eval_and_pdf(model in model(), wo in direction(), choice in uniform(), x in uniform(), y in uniform()) {
        let Some(sample) = model.sample(wo, choice, Vec2::new(x, y), TransportMode::Radiance) else { return Ok(()) };
        let wi = sample.wi;
        prop_assert!((wi.0.as_dvec3().length() - 1.0).abs() <= 4.0 * ULP as f64, "{wi:?}");
        prop_assert_eq!(wo.same_side(wi), sample.lobe == Lobe::Reflection);
        prop_assert!(sample.weight.is_valid() && sample.eta == 1.0);
        match sample.density {
            Density::Delta => prop_assert!(model.delta_lobes(wo, TransportMode::Radiance).any(|lobe| lobe.wi == wi)),
            Density::Smooth(pdf) => {
                let relative = 4.0 * ULP;
                prop_assert!((model.pdf(wo, wi).get() - pdf.get()).abs() <= relative * pdf.get(), "{:?} {pdf:?}", model.pdf(wo, wi));
                let error = (model.eval(wo, wi, TransportMode::Radiance) - sample.weight * pdf.get()).map(f32::abs).max();
                prop_assert!(error <= relative * pdf.get() * sample.weight.max(), "{error}");
            }
        }
    }

    /// `eval` and `pdf` are finite and not negative, and the density is above 0 wherever the model scatters light.
    #[test]
    fn eval_and_pdf_are_sound(model in model(), wo in direction(), wi in direction()) {
        let (f, pdf) = (model.eval(wo, wi, TransportMode::Radiance), model.pdf(wo, wi).get());
        prop_assert!(f.is_valid() && pdf >= 0.0 && pdf.is_finite(), "{f:?} {pdf}");
        prop_assert!(f.is_black() || pdf > 0.0);
    }

    /// f(a, b) = f(b, a) for models that are reciprocal.
    #[test]
    fn reciprocity(model in model(), a in direction(), b in direction()) {
        if model.reciprocal() {
            let f = |wo, wi| model.eval(wo, wi, TransportMode::Radiance);
            let (there, back) = (f(a, b) * a.abs_cos(), f(b, a) * b.abs_cos());
            prop_assert!((there - back).map(f32::abs).max() <= 4e-6 * there.max(), "{there:?} {back:?}");
        }
    }
}

/// The models that are exempt from reciprocity are not reciprocal: f(a, b) and f(b, a) differ by far more than rounding.
#[test]
fn models_exempt_from_reciprocity_are_not_reciprocal() {
    let (a, b) = (Local::NORMAL, Local::new(0.6, 0.0, 0.8));
    let models = [
        Bsdf::Phong(Phong { color: COLOR, exponent: 3.0 }),
        Bsdf::BlinnPhong(BlinnPhong { color: COLOR, exponent: 3.0 }),
        Bsdf::Metal(Metal { color: COLOR, roughness: 0.9 }),
    ];
    for model in models {
        let f = |wo: Local, wi: Local| model.eval(wo, wi, TransportMode::Radiance).max() / wi.abs_cos();
        assert!(!model.reciprocal() && (f(a, b) / f(b, a) - 1.25).abs() < 1e-5, "{model:?}: {}", f(a, b) / f(b, a));
    }
}

/// ∫ pdf is 1 minus the share of sampled directions below the surface (and, for a coat, of those in the mirror direction).
///
/// The share of valid samples has a standard error below ½/√N = 8·10⁻⁴. The tolerance is five of them, for 30 comparisons.
#[test]
fn densities_integrate_to_the_share_of_samples() {
    const N: u32 = 400_000;
    let lobes = [0.0, 1.0, 10.0, 200.0]
        .into_iter()
        .flat_map(|exponent| [Bsdf::Phong(Phong { color: COLOR, exponent }), Bsdf::BlinnPhong(BlinnPhong { color: COLOR, exponent })]);
    let others = [
        plastic(COLOR, 1.5),
        Bsdf::OrenNayar(OrenNayar { albedo: COLOR, roughness: 1.0 }),
        Bsdf::LommelSeeliger(LommelSeeliger { albedo: COLOR }),
        Bsdf::DiffuseTransmission(DiffuseTransmission { reflectance: COLOR * 0.5, transmittance: COLOR * 0.1 }),
    ];
    let mut random = Random::new(1);
    for model in lobes.chain(others) {
        for theta in [0.0f64, 0.6, 1.3] {
            let wo = Local::new(theta.sin() as f32, 0.0, theta.cos() as f32);
            let mut smooth = 0;
            for _ in 0..N {
                let mut unit = || unit_f32(random.bits() as u32);
                let (choice, u) = (unit(), Vec2::new(unit(), unit()));
                let sample = model.sample(wo, choice, u, TransportMode::Radiance);
                smooth += sample.is_some_and(|s| s.density != Density::Delta) as u32;
            }
            let share = smooth as f64 / N as f64;
            let integral = integral(|wi| model.pdf(wo, wi).get() as f64);
            assert!((integral - share).abs() < 0.004, "∫ pdf = {integral}, found {share}: {model:?} at {theta}");
        }
    }
}

/// The share of a metal's lobe within the angle α of its axis is 1 − b q / r (the integral of p, by hand), for the samples and for the
/// density. The standard error of sampling is below ½/√N = 8·10⁻⁴, and the tolerance is five of them.
#[test]
fn perturbed_mirrors_fill_their_cone() {
    const N: u32 = 400_000;
    let mut random = Random::new(2);
    for r in [0.05f64, 0.3, 0.7] {
        let model = Bsdf::Metal(Metal { color: COLOR, roughness: r as f32 });
        for part in [0.5, 0.95] {
            let sine = part * r;
            let (b, q) = ((1.0 - sine * sine).sqrt(), (r * r - sine * sine).sqrt());
            let expected = 1.0 - b * q / r;
            let mut unit = || unit_f32(random.bits() as u32);
            let mut within = || {
                let wi = model.sample(Local::NORMAL, unit(), Vec2::new(unit(), unit()), TransportMode::Radiance).expect("none is lost").wi;
                (wi.cos() as f64) > b
            };
            let share = (0..N).filter(|_| within()).count() as f64 / N as f64;
            assert!((share - expected).abs() < 0.004, "{share} for {expected}: r = {r}, {part}");
            let step = sine.asin() / 1000.0;
            let ring = |i: u32| {
                let (sine, z) = (step * (i as f64 + 0.5)).sin_cos();
                model.pdf(Local::NORMAL, Local::new(sine as f32, 0.0, z as f32)).get() as f64 * TAU * sine * step
            };
            let integral: f64 = (0..1000).map(ring).sum();
            assert!((integral - expected).abs() < 1e-5, "{integral} for {expected}: r = {r}, {part}");
        }
    }
}

/// The metal of roughness 1 is a cosine lobe about the mirror direction; narrower ones obey p = dΩ/dA of the sphere.
#[test]
fn perturbed_mirrors_have_the_derived_density() {
    let wo = Local::new(0.6, 0.0, 0.8);
    let cosine = Bsdf::Metal(Metal { color: COLOR, roughness: 1.0 });
    for wi in [Local::new(-0.6, 0.0, 0.8), Local::NORMAL, Local::new(0.0, 0.6, 0.8)] {
        let cos = (-wo.0.x * wi.0.x - wo.0.y * wi.0.y + wo.0.z * wi.0.z) as f64;
        assert!((cosine.pdf(wo, wi).get() as f64 - cos * FRAC_1_PI).abs() < 1e-6);
    }
    // Along the axis of a sphere of radius r whose centre is at distance 1, the surface is at the distances 1 ± r and perpendicular to the
    // axis.
    let r = 0.25f64;
    let expected = ((1.0 + r).powi(2) + (1.0 - r).powi(2)) / (2.0 * TAU * r * r);
    let found = Bsdf::Metal(Metal { color: COLOR, roughness: r as f32 }).pdf(wo, Local::new(-0.6, 0.0, 0.8)).get() as f64;
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} for {expected}");
}

/// White grooves lose no light, for any roughness. Grey ones reflect at most as much light as a Lambertian surface.
#[test]
fn rough_matte_is_white() {
    for roughness in [0.0, 0.1, 0.5, 1.0] {
        for mu in [1.0f64, 0.8, 0.5, 0.2, 0.05, 0.001] {
            let wo = Local::new(((1.0 - mu) * (1.0 + mu)).sqrt() as f32, 0.0, mu as f32);
            let albedo = |rho| {
                let model = Bsdf::OrenNayar(OrenNayar { albedo: Spectrum::gray(rho), roughness });
                integral(|wi| model.eval(wo, wi, TransportMode::Radiance).max() as f64)
            };
            // The quadrature's own error is 8·10⁻⁷ on a Lambertian surface, and below 10⁻⁵ with the crease at s = 0; more where both
            // directions graze the surface, and s/t varies only in the first cell.
            let tolerance = if mu < 0.01 { 3e-4 } else { 2e-5 };
            assert!((albedo(1.0) - 1.0).abs() < tolerance, "{} at μ = {mu}, σ = {roughness}", albedo(1.0));
            assert!(albedo(0.5) <= 0.5 + tolerance, "{} at μ = {mu}, σ = {roughness}", albedo(0.5));
        }
    }
}

/// The albedo of dust is ω/2 · (1 − μ ln((1 + μ)/μ)), which the integral of f over directions must give.
#[test]
fn the_albedo_of_dust_is_its_formula() {
    let model = Bsdf::LommelSeeliger(LommelSeeliger { albedo: Spectrum::ONE });
    for mu in [1.0f64, 0.8, 0.5, 0.2, 0.05] {
        let wo = Local::new(((1.0 - mu) * (1.0 + mu)).sqrt() as f32, 0.0, mu as f32);
        let albedo = integral(|wi| f64::from(model.eval(wo, wi, TransportMode::Radiance).max()));
        let expected = 0.5 * (1.0 - mu * ((1.0 + mu) / mu).ln());
        // The quadrature's own error, see `rough_matte_is_white`.
        assert!((albedo - expected).abs() < 2e-5, "{albedo} for {expected} at μ = {mu}");
    }
    // Like the full moon, a ball lit from the direction of the viewer is as bright at its edge as at its middle.
    let radiance = |mu: f32| {
        let w = Local::new(((1.0 - mu) * (1.0 + mu)).sqrt(), 0.0, mu);
        model.eval(w, w, TransportMode::Radiance).max()
    };
    assert!([0.9, 0.5, 0.1, 0.01].into_iter().all(|mu| (radiance(mu) / radiance(1.0) - 1.0).abs() < 2.0 * ULP));
}

/// Fujii's formula for ρ → 0, where grooves do not light each other: f·π/ρ = A (1 + σ s/t).
#[test]
fn dark_grooves_follow_fujii() {
    let (roughness, rho) = (0.6, 1e-6f32);
    let model = Bsdf::OrenNayar(OrenNayar { albedo: Spectrum::gray(rho), roughness });
    let a = 1.0 / (1.0 + (0.5 - 2.0 * FRAC_1_PI / 3.0) * roughness as f64);
    for (phi, s, t) in [(0.0f64, 0.6 * 0.8, 0.8), (PI, -0.6 * 0.8, 1.0)] {
        let (wo, wi) = (Local::new(0.6, 0.0, 0.8), Local::new((0.8 * phi.cos()) as f32, 0.0, 0.6));
        let f = model.eval(wo, wi, TransportMode::Radiance).max() as f64 / (0.6 * rho as f64 * FRAC_1_PI);
        assert!((f - a * (1.0 + roughness as f64 * s / t)).abs() < 1e-5, "{f} at φ = {phi}");
    }
}

/// The light that the coat reflects and the light that the base returns through it add up to all light, for every index and angle.
#[test]
fn coated_white_is_white() {
    for eta in [1.0f32, 1.1, 1.5, 2.42] {
        let model = plastic(Spectrum::ONE, eta);
        for mu in [1.0f64, 0.6, 0.2, 0.02] {
            let wo = Local::new(((1.0 - mu) * (1.0 + mu)).sqrt() as f32, 0.0, mu as f32);
            let coat: Spectrum = model.delta_lobes(wo, TransportMode::Radiance).map(|lobe| lobe.weight).sum();
            assert_eq!(coat.max(), dielectric(wo.cos(), eta));
            let ground = integral(|wi| model.eval(wo, wi, TransportMode::Radiance).max() as f64);
            assert!((coat.max() as f64 + ground - 1.0).abs() < 1e-5, "{coat:?} + {ground}: η = {eta}, μ = {mu}");
        }
    }
}

/// Mean Fresnel reflectances from outside and inside, to the rounding of the expected digits and of f32.
#[test]
fn mean_reflectance_is_the_handbooks() {
    for (eta, outside, inside) in [(1.33, 0.0659308493, 0.4719491488), (1.5, 0.0917779593, 0.5963457597)] {
        assert!((dielectric_mean(eta) as f64 - outside).abs() < 1e-7);
        assert!((Plastic::internal(eta) as f64 - inside).abs() < 2e-7);
    }
    assert_eq!(dielectric_mean(1.0), 0.0);
}

/// Integral over the sphere of directions by the midpoint rule in θ and φ. The horizon lies between two cells.
fn integral(f: impl Fn(Local) -> f64) -> f64 {
    const N: u32 = 1000;
    let step = PI / N as f64;
    let mut sum = 0.0;
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let (theta, phi) = (step * (i as f64 + 0.5), 2.0 * step * (j as f64 + 0.5));
        let (sine, z) = theta.sin_cos();
        let wi = Local::new((sine * phi.cos()) as f32, (sine * phi.sin()) as f32, z as f32);
        sum += f(wi) * sine * 2.0 * step * step;
    }
    sum
}
