//! The proof kit for scattering models: pt's own models pass, deliberate bugs do not, and false alarms have the stated rate.

mod mutants;

use glam::{Vec2, Vec3};
use proptest::prelude::*;
use pt::bsdf::microfacet::Distribution;
use pt::bsdf::microfacet::roughness::{Alpha, Roughness};
use pt::bsdf::{
    BlinnPhong, Bsdf, Coat, Coated, Compound, Conductor, Dielectric, Diffuse, DiffuseTransmission, Element, FilmLayer, FilmedDielectric,
    Glass, HitContext, LommelSeeliger, Material, MatteCone, Metal, Metallic, Mirror, Mix, OrenNayar, Phong, Plastic, Principled,
    Reflectance, Share, Sheen, ThinDielectric, TwoSided, textured,
};
use pt::math::{Rgb, Spectrum};
use pt::proof::strategies::{any_bsdf, mode, sphere, square, uniform};
use pt::proof::{Case, CounterExample, Furnace, Options, Verdict, at, chi2, inputs_at, prove, reciprocity_at, weight_at};
use pt::shape::{SurfacePoint, VertexColor};
use pt::texture::Texture;

use crate::random::{Random, cases};
use crate::scenes::stored;
use crate::statistics::{sidak, uniformity};

/// Samples per incidence. `PT_PROOF_SAMPLES=1000000 cargo test --test it proof` gives the full figures.
fn samples() -> u64 {
    std::env::var("PT_PROOF_SAMPLES").ok().and_then(|n| n.parse().ok()).unwrap_or(50_000)
}

fn options() -> Options {
    Options { samples: samples(), cases: 4000, ..Options::default() }
}

const COLOR: Spectrum = Spectrum::rgb(0.25, 0.5, 1.0);

/// Every model, with parameters at the ends of their ranges and between. The flag is whether the model loses no light.
fn models() -> Vec<(Bsdf<'static>, bool)> {
    let colored = [COLOR, Spectrum::ONE].into_iter().flat_map(|color| {
        let cones = [0.0, 1e-6, 1e-4, 1e-3, 0.02, 0.3, 0.7, 1.0].map(|mattness| Bsdf::MatteCone(MatteCone { color, mattness }));
        let glass = [1.0, 1.33, 1.5, 1.0 / 1.5, 2.42].map(|eta| Bsdf::Dielectric(Dielectric { eta, color }));
        let plain = [Bsdf::Diffuse(Diffuse { albedo: color }), Bsdf::Mirror(Mirror { color })];
        cones.into_iter().chain(glass).chain(plain).map(move |model| (model, color == Spectrum::ONE))
    });
    let reflectance = Reflectance::Index { eta: Spectrum::rgb(0.18, 0.42, 1.37), k: Spectrum::rgb(3.42, 2.35, 1.77) };
    let gold = Conductor { reflectance };
    let matte = [0.0, 0.5, 1.0].map(|roughness| (Bsdf::OrenNayar(OrenNayar { albedo: Spectrum::ONE, roughness }), true));
    let lobes = [0.0, 1.0, 30.0, 1e4].into_iter().flat_map(|exponent| {
        [Bsdf::Phong(Phong { color: COLOR, exponent }), Bsdf::BlinnPhong(BlinnPhong { color: COLOR, exponent })].map(|lobe| (lobe, false))
    });
    // Narrower cones are mostly rim, where the density has a pole and rounding dominates. `matte_models` tests those with a larger
    // tolerance.
    let shaken = [0.0, 0.2, 0.7, 1.0].map(|roughness| (Bsdf::Metal(Metal { color: COLOR, roughness }), false));
    let coated = [1.0, 1.5, 2.42].map(|eta| {
        let internal = Plastic::internal(eta);
        (Bsdf::Plastic(Plastic { albedo: Spectrum::ONE, eta, internal }), true)
    });
    let (reflectance, transmittance) = (Spectrum::gray(0.25), Spectrum::gray(0.75));
    let under_film =
        |eta, film_eta, color| Bsdf::FilmedDielectric(FilmedDielectric { eta, color, film_eta, thickness: 300.0, facets: None });
    let films = [(1.5, 1.38, COLOR), (1.5, 2.4, Spectrum::ONE), (1.0, 1.33, Spectrum::ONE)];
    let films = films.map(|(eta, film, color)| (under_film(eta, film, color), color == Spectrum::ONE));
    let dust = (Bsdf::LommelSeeliger(LommelSeeliger { albedo: COLOR }), false);
    let paper = (Bsdf::DiffuseTransmission(DiffuseTransmission { reflectance, transmittance }), true);
    colored
        .chain([(Bsdf::Conductor(gold), false), paper, dust])
        .chain(matte)
        .chain(lobes)
        .chain(shaken)
        .chain(coated)
        .chain(films)
        .collect()
}

/// The BSDF of a material at a point, with a static lifetime.
fn met(material: Material) -> Bsdf<'static> {
    let point = SurfacePoint { p: Vec3::ZERO, offset: 0.0, ng: Vec3::Z, ns: Vec3::Z, uv: Vec2::ZERO, color: VertexColor::WHITE };
    Box::leak(Box::new(material)).bsdf_at(&HitContext::from_outside(point))
}

/// Compound materials. The flag is whether the model loses no light.
fn compounds() -> Vec<(Bsdf<'static>, bool)> {
    let round = |alpha: f32| Some(Roughness { alpha: Alpha::Constant(Vec2::splat(alpha)), distribution: Distribution::Ggx });
    let coated = |base, coat: Coat| Material::from(Compound::Coated(Coated { base, coat }));
    let clay = |albedo: Spectrum| Material::OrenNayar(textured::OrenNayar { albedo: stored(albedo).into(), roughness: 0.7.into() });
    let copper = |roughness| Material::metal(Element::Cu.index(), roughness, true);
    let glazed = || coated(Material::diffuse(Rgb::WHITE), Coat::new(1.6, Rgb::WHITE, None));
    let fresnel = |a, b| Material::from(Compound::Mix(Mix { a, b, share: Share::Fresnel { eta: 1.5.into() } }));
    let glass = || Material::rough_glass(1.5, stored(COLOR), round(0.3).unwrap(), true);
    let film = |eta: f32| Some(FilmLayer { eta, thickness: 350.0.into() });
    let principled = Principled {
        base_color: stored(COLOR).into(),
        metallic: 0.3.into(),
        transmission: 0.4.into(),
        specular: 0.7.into(),
        roughness: round(0.2),
        eta: 1.5.into(),
        coat: 0.5.into(),
        coat_eta: 1.5.into(),
        coat_color: Rgb::WHITE.into(),
        coat_roughness: round(0.05),
        sheen_color: Rgb::new(0.1, 0.4, 0.2).into(),
        sheen_roughness: 0.45.into(),
        iridescence: 0.5.into(),
        film: FilmLayer { eta: 1.8, thickness: 300.0.into() },
        multiscatter: true,
    };
    // Choices of the same lobe are close together, with few other choices between them.
    let dense = Principled {
        metallic: 0.0.into(),
        transmission: 0.5.into(),
        specular: 1.0.into(),
        eta: 100.0.into(),
        coat: 0.0.into(),
        sheen_color: 0.0.into(),
        ..principled.clone()
    };
    let white = Principled {
        base_color: 1.0.into(),
        metallic: 0.0.into(),
        transmission: 0.0.into(),
        specular: 1.0.into(),
        coat: 1.0.into(),
        sheen_color: 1.0.into(),
        ..principled.clone()
    };
    let lossless = [
        Material::mix(Material::diffuse(Rgb::WHITE), Material::mirror(Rgb::WHITE), 0.3),
        coated(Material::diffuse(Rgb::WHITE), Coat::new(1.5, Rgb::WHITE, None)),
        coated(Material::diffuse(Rgb::WHITE), Coat::new(2.4, Rgb::WHITE, None).keep_base_color()),
        coated(Material::mirror(Rgb::WHITE), Coat::new(1.5, Rgb::WHITE, None)),
        coated(glazed(), Coat::new(1.3, Rgb::WHITE, None)),
        coated(Material::plastic(Rgb::WHITE, 1.5), Coat::new(1.5, Rgb::WHITE, None)),
        fresnel(Material::mirror(Rgb::WHITE), Material::mirror(Rgb::WHITE)),
    ];
    let others = [
        Material::mix(Material::diffuse(stored(COLOR)), copper(round(0.1)), 0.6),
        Material::mix(glass(), clay(COLOR), 0.5),
        fresnel(Material::diffuse(stored(COLOR)), copper(round(0.3))),
        coated(Material::diffuse(stored(COLOR)), Coat::new(1.5, stored(COLOR), round(0.2))),
        coated(clay(Spectrum::ONE), Coat::new(1.5, Rgb::WHITE, round(0.4))),
        coated(copper(round(0.4)), Coat::new(1.7, Rgb::new(0.9, 0.5, 0.1), None)),
        coated(copper(None), Coat::new(1.5, stored(COLOR), round(0.1))),
        coated(glass(), Coat::new(1.3, Rgb::WHITE, round(0.6))),
        coated(Material::diffuse(Rgb::WHITE), Coat::under_film(1.5, 1.0, None, film(1.33))),
        coated(copper(round(0.4)), Coat::under_film(1.5, 1.0, round(0.2), film(2.0))),
        Material::metal(Metallic::from(Texture::from(stored(COLOR))).under_film(film(1.5).unwrap()), round(0.3), true),
        Compound::Sheen(Sheen::new(Material::diffuse(stored(COLOR)), Rgb::WHITE, 0.55)).into(),
        Compound::Sheen(Sheen::new(Material::mirror(Rgb::WHITE), stored(COLOR), 0.14)).into(),
        Compound::Sheen(Sheen::new(Material::diffuse(Rgb::WHITE), Rgb::WHITE, 0.1)).into(),
        Compound::TwoSided(TwoSided { front: Some(copper(round(0.3))), back: Some(Material::diffuse(stored(COLOR))) }).into(),
        Compound::TwoSided(TwoSided { front: None, back: Some(Material::mirror(stored(COLOR))) }).into(),
        Material::metal(Texture::from(stored(COLOR)), round(0.3), true),
        coated(
            Material::DiffuseTransmission(textured::DiffuseTransmission { reflectance: stored(COLOR).into(), transmittance: 0.0.into() }),
            Coat::new(1.5, stored(COLOR), round(0.3)),
        ),
        Compound::Sheen(Sheen::new(glazed(), Rgb::WHITE, 0.45)).into(),
        principled.into(),
        dense.into(),
        white.into(),
    ];
    lossless.into_iter().map(|material| (met(material), true)).chain(others.into_iter().map(|material| (met(material), false))).collect()
}

/// Rough metal and glass, seen from either side: facets that are round and four times as long as wide, with and without multiple
/// scattering. The flag is whether the model loses no light.
fn rough() -> Vec<(Bsdf<'static>, bool)> {
    let copper = Element::Cu.index();
    let mut models = vec![];
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for (alpha, multiscatter) in [(Vec2::splat(0.05), false), (Vec2::splat(0.3), true), (Vec2::new(0.8, 0.2), false), (Vec2::ONE, true)]
        {
            let roughness = || Roughness { alpha: Alpha::Constant(alpha), distribution };
            models.push(met(Material::metal(copper, Some(roughness()), multiscatter)));
            models.extend([1.5, 1.0 / 1.5].map(|eta| met(Material::rough_glass(eta, stored(COLOR), roughness(), multiscatter))));
        }
    }
    models.push(Bsdf::ThinDielectric(ThinDielectric { eta: 1.5, color: COLOR }));
    models.push(met(textured::ThinFilm::new(1.33, 400.0, stored(COLOR)).into()));
    let tempered = || Metallic::from(Element::Ti.index()).under_film(FilmLayer { eta: 2.4, thickness: 60.0.into() });
    models.push(met(Material::metal(tempered(), None, false)));
    let roughness = Roughness { alpha: Alpha::Constant(Vec2::splat(0.3)), distribution: Distribution::Ggx };
    models.push(met(Material::metal(tempered(), Some(roughness.clone()), true)));
    let frosted = textured::Dielectric::new(1.5, stored(COLOR), Some(roughness), true);
    let film = FilmLayer { eta: 1.8, thickness: 250.0.into() };
    models.push(met(frosted.clone().under_film(film).into()));
    models.push(met(Material::dispersive(frosted, Glass::Sf11.dispersion())));
    models.into_iter().map(|model| (model, false)).collect()
}

/// All laws of all models are one family of tests, with a probability of 1 % that any of them fails by chance.
#[test]
fn own_models_are_proved() {
    accepted(&models());
}

#[test]
fn rough_models_are_proved() {
    accepted(&rough());
}

#[test]
fn compounds_are_proved() {
    accepted(&compounds());
}

fn accepted(models: &[(Bsdf, bool)]) {
    let refused: Vec<String> = models
        .iter()
        .map(|(model, lossless)| {
            let furnace = if *lossless { Furnace::Lossless(0.0) } else { Furnace::Passive };
            prove(model, &Options { suite: models.len(), furnace, ..options() })
        })
        .filter(|report| !report.accepts())
        .map(|report| report.to_string())
        .collect();
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

fn refused(result: Result<(), CounterExample>) -> Result<(), TestCaseError> {
    result.map_err(|example| TestCaseError::fail(format!("\n{example}")))
}

proptest! {
    #![proptest_config(cases(100_000))]

    /// The laws of single inputs, for generated models. Counterexamples are shrunk.
    #[test]
    fn own_models_obey_single_laws(
        model in any_bsdf(), wo in sphere(), wi in sphere(), choice in uniform(), u in square(), mode in mode()
    ) {
        refused(inputs_at(&model, wo, wi, choice, u, mode))?;
        refused(weight_at(&model, wo, choice, u, mode))?;
        if model.reciprocal() {
            refused(reciprocity_at(&model, wo, wi, 1.0))?;
        }
    }
}

/// For models with `reciprocal()` = false, there is a pair of directions for which reciprocity fails.
#[test]
fn models_declared_not_reciprocal_are_not() {
    for (model, _) in models().into_iter().filter(|(model, _)| !model.reciprocal()) {
        // The law takes random directions, and no samples at incidences.
        let report = prove(&model, &Options { incidences: vec![], ..options() });
        let finding = report.findings.iter().find(|finding| finding.law == "reciprocity").expect("a law of that name");
        assert_eq!(finding.verdict, Verdict::Exempt);
        assert!(finding.notes[0].contains("and it is not"), "{report}");
    }
}

/// For a correct model, p is uniformly distributed: its deciles are equally frequent, and it is below 5 % in 5 % of the runs.
#[test]
fn false_alarms_are_as_frequent_as_they_say() {
    const RUNS: u64 = 1000;
    // Bins and shares are random, and some bins have few counts.
    let shares: Vec<f64> = (1..=60).map(|k| 1.0 / f64::from(k)).collect();
    let total: f64 = shares.iter().sum();
    let mut random = Random::new(11);
    let mut deciles = [0u64; 10];
    let mut alarms = 0;
    for _ in 0..RUNS {
        let mut counts = vec![0u64; shares.len()];
        for _ in 0..3000 {
            let mut rest = random.unit() * total;
            let bin = shares.iter().position(|share| {
                rest -= share;
                rest < 0.0
            });
            counts[bin.unwrap_or(0)] += 1;
        }
        let p = chi2(&shares, &counts).p;
        deciles[((p * 10.0) as usize).min(9)] += 1;
        alarms += u64::from(p < 0.05);
    }
    assert!(uniformity(&deciles) > sidak(2), "{deciles:?}");
    // The expected count is 50 ± 6.9, which is within 2.8 σ with a probability of 99.5 %.
    assert!((31..=69).contains(&alarms), "{alarms} of {RUNS}");
}

/// The significance of the law as a whole, with quadrature and samples, is the stated one.
#[test]
fn the_whole_law_keeps_its_level() {
    const RUNS: u64 = 40;
    let model = Bsdf::MatteCone(MatteCone { color: COLOR, mattness: 0.3 });
    let run = |seed| Options { alpha: 0.2, samples: 20_000, cases: 0, seed, incidences: vec![at(0.7, 1.0)], ..Options::default() };
    let level = |options: &Options| Case::new(&model, options).level();
    let smallest = |options: &Options| {
        let case = Case::new(&model, options);
        case.sampled[0].divisions.iter().map(|d| chi2(&d.shares, &d.counts).p).fold(1.0, f64::min)
    };
    // The significance is divided among nine tests, of which three are chi² tests: 1 − (1 − 0.2)^(3/9) = 7.2 %, or less because these are
    // correlated.
    assert!((level(&run(0)) - (1.0 - 0.8f64.powf(1.0 / 9.0))).abs() < 1e-12);
    let alarms = (0..RUNS)
        .filter(|&seed| {
            let options = run(seed);
            smallest(&options) < level(&options)
        })
        .count();
    // 2.9 are expected, with σ = 1.6. More than 8 have a probability of 0.2 %.
    assert!(alarms <= 8, "{alarms} false alarms of {RUNS}");
}

/// The message of a failed law has all numbers to repeat the counterexample, and its significance.
#[test]
fn a_refusal_is_readable() {
    let report = prove(&mutants::Lambert { cosine: false, consistent: false }, &options());
    let text = report.to_string();
    for part in ["REFUSED", "weight", "wo = (", "choice = ", "u = (", "expected", "found", "how sure", "certain"] {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }
    assert!(report.into_result().is_err());
}

/// A lobe that is too narrow for f32 is not tested, and the report says so. A slightly wider lobe is tested.
#[test]
fn lobes_narrower_than_rounding_are_reported_as_untested() {
    let options = Options { incidences: vec![at(0.8, 0.3)], ..options() };
    for (mattness, said) in [(1e-6, true), (1e-3, false)] {
        let report = prove(&Bsdf::MatteCone(MatteCone { color: COLOR, mattness }), &options);
        assert_eq!(report.to_string().contains("narrower than f32"), said, "{report}");
    }
}

/// A lobe that is far narrower than the finest grid is still tested, because the cells of equal probability adapt to it.
#[test]
fn narrow_lobes_are_resolved() {
    let model = mutants::Blinn { exponent: 1e6, bug: None };
    let options = Options { samples: 2 * samples(), incidences: vec![at(0.8, 0.3)], ..options() };
    let case = Case::new(&model, &options);
    let [fine, coarse, equal] = &case.sampled[0].divisions;
    let freedom = |d: &pt::proof::Division| chi2(&d.shares, &d.counts).freedom;
    assert!(freedom(coarse) <= 1 && freedom(fine) <= 8 && freedom(equal) > 200);
    assert!(case.report().accepts(), "{}", case.report());
    let wider = mutants::Blinn { exponent: 1e6, bug: Some(mutants::Bug::Width) };
    assert!(prove(&wider, &options).refuses("chi2"));
}
