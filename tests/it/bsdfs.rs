//! Properties of pt's scattering models beyond the laws of `pt::proof`, which `proof.rs` tests: exact weights, exact shares of delta lobes,
//! and light that leaves a slab with the radiance that it had before.

use glam::Vec3;
use proptest::prelude::*;
use pt::bsdf::{Bsdf, Dielectric, Diffuse, Lobe, MatteCone, Mirror, TransportMode};
use pt::math::{Density, Local, Spectrum};
use pt::proof::strategies::{color, eta, fraction, mode, simple_bsdf, sphere, square, uniform};

use crate::random::cases;

const ULP: f32 = f32::EPSILON;

fn near(a: Spectrum, b: Spectrum, relative: f32) -> bool {
    a.zip(b, |a, b| if (a - b).abs() <= relative * a.abs().max(b.abs()) { 0.0 } else { 1.0 }).is_black()
}

/// A spectrum is black only if every coefficient is 0, of either sign. The smallest number is not black.
#[test]
fn black_means_that_all_coefficients_are_zero() {
    assert!(Spectrum::BLACK.is_black() && Spectrum::rgb(-0.0, 0.0, -0.0).is_black());
    let least = f32::from_bits(1);
    for coefficient in [least, -least, 1.0, f32::INFINITY, f32::NAN] {
        for place in 0..3 {
            let [r, g, b] = std::array::from_fn(|i| if i == place { coefficient } else { 0.0 });
            assert!(!Spectrum::rgb(r, g, b).is_black(), "{r} {g} {b}");
        }
    }
}

/// Upper bound of the weights of a model, for each coefficient.
fn bound(model: &Bsdf) -> Spectrum {
    match model {
        Bsdf::Diffuse(b) => b.albedo,
        Bsdf::Mirror(b) => b.color,
        Bsdf::Conductor(_) => Spectrum::ONE,
        Bsdf::Dielectric(b) => b.color,
        Bsdf::MatteCone(b) => b.color,
        other => panic!("{other:?} is proved elsewhere"),
    }
}

proptest! {
    #![proptest_config(cases(100_000))]

    /// No weight exceeds the model's color, and each model has either a density or delta lobes.
    #[test]
    fn weights_stay_within_the_color(model in simple_bsdf(), wo in sphere(), choice in uniform(), u in square(), mode in mode()) {
        let Some(sample) = model.sample(wo, choice, u, mode) else {
            // The edge of a cone may lie exactly in the surface.
            prop_assert!(bound(&model).is_black() || matches!(model, Bsdf::MatteCone(_)), "{model:?} gave nothing");
            return Ok(());
        };
        prop_assert_eq!(matches!(sample.density, Density::Smooth(_)), model.has_smooth_lobe());
        // Importance is not scaled by η², unlike radiance.
        if mode == TransportMode::Importance || sample.lobe == Lobe::Reflection {
            prop_assert!((bound(&model) - sample.weight).min() >= 0.0, "{:?} exceeds {:?}", sample.weight, bound(&model));
        }
    }

    /// A white model in a white furnace: every weight is 1, to the last bit.
    #[test]
    fn furnace(wo in sphere(), choice in uniform(), u in square(), mattness in fraction(), eta in eta()) {
        let color = Spectrum::ONE;
        let models = [
            Bsdf::Diffuse(Diffuse { albedo: color }),
            Bsdf::Mirror(Mirror { color }),
            Bsdf::Dielectric(Dielectric { eta, color }),
            Bsdf::MatteCone(MatteCone { color, mattness }),
        ];
        for model in models {
            let weight = model.sample(wo, choice, u, TransportMode::Importance).map(|s| s.weight);
            // The edge of a cone may lie exactly in the surface.
            prop_assert!(weight == Some(color) || (weight.is_none() && matches!(model, Bsdf::MatteCone(_))), "{model:?}: {weight:?}");
        }
    }

    /// The weights of reflection and refraction add up to the colour.
    #[test]
    fn delta_lobes_make_up_the_color(wo in sphere(), eta in eta(), color in color()) {
        for model in [Bsdf::Mirror(Mirror { color }), Bsdf::Dielectric(Dielectric { eta, color })] {
            let sum: Spectrum = model.delta_lobes(wo, TransportMode::Importance).map(|lobe| lobe.weight).sum();
            prop_assert!(near(sum, color, 2.0 * ULP), "{model:?}: {sum:?}");
        }
    }

    /// `delta_lobes` are what `sample` chooses from: the same directions, weights divided by the chance of each.
    #[test]
    fn delta_lobes_are_the_samples(model in simple_bsdf(), wo in sphere(), choice in uniform(), mode in mode()) {
        let Some(sample) = model.sample(wo, choice, glam::Vec2::splat(0.5), mode) else { return Ok(()) };
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
    fn radiance_is_compressed_and_restored(wo in sphere(), eta in eta(), color in color()) {
        let model = Bsdf::Dielectric(Dielectric { eta, color });
        let pass = |wo: Local, mode| model.delta_lobes(wo, mode).find(|lobe| lobe.lobe == Lobe::Transmission);
        let (Some(entry), Some(flux)) = (pass(wo, TransportMode::Radiance), pass(wo, TransportMode::Importance)) else { return Ok(()) };
        prop_assert!(near(entry.weight * (entry.eta * entry.eta), flux.weight, 4.0 * ULP));
        // The normal of the far face points the other way, so that the path meets this face from inside.
        let back = Local::new(-entry.wi.0.x, -entry.wi.0.y, entry.wi.0.z);
        let Some(exit) = pass(back, TransportMode::Radiance) else { return Ok(()) };
        let Some(exit_flux) = pass(back, TransportMode::Importance) else { return Ok(()) };
        prop_assert!((exit.eta * entry.eta - 1.0).abs() <= 2.0 * ULP);
        prop_assert!(near(entry.weight * exit.weight, flux.weight * exit_flux.weight, 8.0 * ULP));
        // The direction is that of before, where one rounding of the direction inside does not change the one outside much (law O1).
        let onwards = Vec3::new(exit.wi.0.x, exit.wi.0.y, -exit.wi.0.z);
        let amplified = ULP * (1.0 + eta.max(1.0 / eta)).powi(2) / wo.abs_cos().min(entry.wi.abs_cos());
        prop_assert!((onwards + wo.0).length() <= 2.0 * amplified + 2.0 * ULP, "{onwards} but {wo:?}");
    }
}

/// The cone model is not reciprocal: at the angle β from the normal, f is 1/(Ω cos β) in one direction and 1/Ω in the other.
#[test]
fn cone_is_not_reciprocal() {
    let model = Bsdf::MatteCone(MatteCone { color: Spectrum::ONE, mattness: 0.9 });
    assert!(!model.reciprocal());
    let beta = 0.5f32;
    let (a, b) = (Local::NORMAL, Local::new(beta.sin(), 0.0, beta.cos()));
    let f = |wo: Local, wi: Local| model.eval(wo, wi, TransportMode::Radiance).average() / wi.abs_cos();
    assert!((f(a, b) / f(b, a) - 1.0 / beta.cos()).abs() < 1e-6);
}
