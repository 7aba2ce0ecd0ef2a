//! Thin films: the colours of soap bubbles and of tempered metal.
//!
//! Films on metal have exact answers in row O14 of `pt torture`.

use glam::{DVec3, Vec2};
use pt::bsdf::film::{Film, FilmTable};
use pt::bsdf::microfacet::{Distribution, Microfacets};
use pt::bsdf::{
    Bsdf, BsdfSample, ClearFilm, Element, FilmLayer, FilmedDielectric, HitContext, Material, Metallic, Reflectance, RoughDielectric,
    ScatteringModel, TransportMode, textured,
};
use pt::effects::Effects;
use pt::light::{Environment, Light};
use pt::math::{Local, Rgb, Spectrum, Wavelength, fresnel, thin_film};
use pt::proof::at;
use pt::shape::{Quad, SurfacePoint, VertexColor};
use pt::world::World;

use crate::marked::assert_fault_in_scene;
use crate::random::Random;
use crate::scenes::{Depth, Effort, KnownRadiance, confirm, facing, probe};

/// Reflectance of a film on a clear base, by Airy's formula in real numbers:
/// R = (r₁² + r₂² + 2 r₁ r₂ cos φ) / (1 + r₁² r₂² + 2 r₁ r₂ cos φ).
fn airy(nanometres: f64, cos: f64, thickness: f64, film: f64, base: f64) -> f64 {
    let sin = (1.0 - cos * cos).sqrt();
    let [a, b, c] = [1.0, film, base].map(|n| (1.0 - (sin / n).powi(2)).sqrt());
    let phase = 4.0 * std::f64::consts::PI * film * thickness * b / nanometres;
    let of = |first: f64, second: f64| {
        let (squares, product) = (first * first + second * second, 2.0 * first * second * phase.cos());
        (squares + product) / (1.0 + (first * second).powi(2) + product)
    };
    let s = of((a - film * b) / (a + film * b), (film * b - base * c) / (film * b + base * c));
    let p = of((film * a - b) / (film * a + b), (base * b - film * c) / (base * b + film * c));
    0.5 * (s + p)
}

/// Films on clear bases have the reflectance of Airy's formula; a film without thickness is no film; one of half a wavelength reflects at
/// normal incidence what its base does.
#[test]
fn clear_films_follow_airys_formula() {
    let mut random = Random::new(3);
    for _ in 0..100_000 {
        let wavelength = Wavelength::new(random.range(380.0, 700.0) as f32);
        let (cos, thickness) = (random.range(0.01, 1.0), random.range(0.0, 5000.0));
        let (film, base) = (random.range(1.05, 2.5), random.range(1.0, 2.5));
        let wanted = airy(f64::from(wavelength.nanometres()), cos, thickness, film, base);
        let found = thin_film::reflectance(wavelength, cos, thickness, film, [base, 0.0]);
        // The phase is up to 2·10⁵ times the rounding of the numbers that it is computed of.
        assert!((found - wanted).abs() < 1e-10, "{wavelength:?}, cos {cos}, {thickness} nm, {film} on {base}: {found}, not {wanted}");
        let half = f64::from(wavelength.nanometres()) / (2.0 * film);
        let [bare, absent] = [0.0, half].map(|thickness| thin_film::reflectance(wavelength, 1.0, thickness, film, [base, 0.0]));
        let fresnel = ((base - 1.0) / (base + 1.0)).powi(2);
        assert!((bare - fresnel).abs() < 1e-13 && (absent - fresnel).abs() < 1e-13, "{bare} and {absent}, not {fresnel}");
    }
}

fn soap(thickness: [f32; 2]) -> &'static FilmTable {
    Film { eta: 1.33, thickness, base: [Rgb::WHITE, Rgb::BLACK], on_both_faces: false }.table()
}

/// Tables are the integrals over the wavelength, also for the thinnest films, within what interpolation between their nodes leaves: a fiftieth
/// of a turn of the phase makes (2π/50)²/8 of the change by interference. Near grazing incidence, where the faces reflect nearly all light, the
/// film's resonances are narrower than the steps between the nodes. The means of tables are those over the hemisphere.
#[test]
fn tables_of_films_are_integrals_over_the_wavelength() {
    let mut random = Random::new(4);
    for (eta, base, thickness, tries) in [
        (1.33, 1.0, [380.0f32, 380.0], 60),
        (1.33, 1.0, [0.0, 1200.0], 200),
        (1.33, 1.0, [0.0, 10.0], 100),
        (2.4, 1.5, [0.0, 300.0], 100),
        (4.0, 1.5, [0.0, 100.0], 100),
        (1.33, 1.0, [1900.0, 2000.0], 60),
    ] {
        let table = Film { eta, thickness, base: [Rgb::gray(base), Rgb::BLACK], on_both_faces: false }.table();
        for _ in 0..tries {
            let cos = if random.unit() < 0.3 { random.range(1e-3, 0.05) } else { random.range(0.05, 1.0) };
            let d = random.range(thickness[0].into(), f64::from(thickness[1]) + 1e-9);
            let mut sum = [0.0; 3];
            for k in 0..3200 {
                let nanometres = 380.05 + 0.1 * f64::from(k);
                let r = airy(nanometres, cos, d, eta.into(), base.into());
                let matching = Wavelength::new(nanometres as f32).matching();
                sum = [0, 1, 2].map(|c| sum[c] + matching[c] * r * 0.1);
            }
            let found = table.at(cos as f32, d as f32).to_rgb();
            for c in 0..3 {
                let (found, wanted) = (f64::from(found[c]), sum[c].clamp(0.0, 1.0));
                let tolerance = if cos < 0.05 { 4e-2 } else { 8e-3 };
                assert!((found - wanted).abs() < tolerance, "index {eta}, {d} nm, cos {cos}, colour {c}: {found}, not {wanted}");
            }
        }
        for d in [thickness[0], 0.5 * (thickness[0] + thickness[1])] {
            const STEPS: u32 = 4096;
            let at = |k: u32| (k as f32 + 0.5) / STEPS as f32;
            let mean = table.mean(d).to_rgb();
            for (c, mean) in mean.iter().enumerate() {
                let wanted = (0..STEPS).map(|k| f64::from(table.at(at(k), d).to_rgb()[c] * 2.0 * at(k))).sum::<f64>() / f64::from(STEPS);
                assert!((f64::from(*mean) - wanted).abs() < 1e-5, "{d} nm, colour {c}: {mean}, not {wanted}");
            }
        }
    }
}

/// The mean of a function of the wavelength in daylight, for red, green and blue.
fn in_daylight(of: impl Fn(f64) -> f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for k in 0..3200 {
        let nanometres = 380.05 + 0.1 * f64::from(k);
        let (r, matching) = (of(nanometres), Wavelength::new(nanometres as f32).matching());
        sum = [0, 1, 2].map(|c| sum[c] + matching[c] * r * 0.1);
    }
    sum.map(|sum| sum.clamp(0.0, 1.0))
}

/// Films on bases without absorption have the mean over the wavelength of Airy's formula, whatever their indices, thickness and angle; and no
/// wavelength has more than the greatest reflectance. The table of waves has steps of 2 nm, whose interpolation leaves (2π · 2/380)²/8 of a wave:
/// 1.4e-4. Near grazing incidence the series is long: terms beyond 16 µm, which are left out, and those that are added as one hold up to three
/// thousandths.
#[test]
fn clear_films_are_integrals_over_the_wavelength() {
    let mut random = Random::new(6);
    for k in 0..600 {
        let cos = if k % 4 == 0 { random.range(1e-3, 0.05) } else { random.range(0.05, 1.0) };
        let thickness =
            [0.0, random.range(0.0, 20.0), random.range(0.0, 100.0), random.range(0.0, 1000.0), random.range(0.0, 2000.0)][k % 5];
        let base = [1.0, random.range(1.0, 2.5), random.range(1.0, 2.5), random.range(2.5, 60.0)][k % 4];
        let eta = random.range(1.0, 4.0);
        let film = ClearFilm { eta: eta as f32, thickness: thickness as f32, base: Spectrum::gray(base as f32) };
        let wanted = in_daylight(|nanometres| airy(nanometres, cos, thickness, eta, base));
        for (found, wanted) in film.at(cos as f32).to_rgb().into_iter().zip(wanted) {
            let tolerance = if cos < 0.05 { 4e-3 } else { 8e-4 };
            assert!(
                (f64::from(found) - wanted).abs() < tolerance,
                "index {eta} on {base}, {thickness} nm, cos {cos}: {found}, not {wanted}"
            );
        }
        let greatest = f64::from(ClearFilm::greatest(cos as f32, eta as f32, base as f32));
        let most = (0..2000).map(|k| airy(500.0, cos, f64::from(k), eta, base)).fold(0.0, f64::max);
        assert!(most < greatest + 1e-5, "index {eta} on {base}, cos {cos}: {most} is more than {greatest}");
    }
}

/// A metal by its colour is, under a film without thickness, the clear body that reflects as much at normal incidence.
#[test]
fn colors_become_clear_bodies_under_films() {
    for share in [0.0f32, 0.04, 0.3, 0.9] {
        let base = ClearFilm::base_of_reflectance(share);
        for cos in [1.0f32, 0.7, 0.2, 0.01, 1e-3] {
            let found = ClearFilm { eta: 1.4, thickness: 0.0, base: Spectrum::gray(base) }.at(cos).to_rgb()[0];
            let wanted = fresnel::dielectric(cos, base);
            assert!((found - wanted).abs() < 1e-5, "{share}, cos {cos}: {found}, not {wanted}");
            assert!(cos < 1.0 || (found - share).abs() < 1e-5, "{share}: {found}");
        }
    }
}

/// The mean over the hemisphere of a film on a metal by its colour is taken in few steps; it is only the share of light that facets reflect more than
/// once, where a hundredth does not show.
#[test]
fn means_of_clear_films_are_those_over_the_hemisphere() {
    let mut random = Random::new(7);
    for _ in 0..100 {
        let base = Spectrum::gray(random.range(1.0, 40.0) as f32);
        let film = ClearFilm { eta: random.range(1.2, 4.0) as f32, thickness: random.range(0.0, 2000.0) as f32, base };
        const STEPS: u32 = 2048;
        let at = |k: u32| (k as f32 + 0.5) / STEPS as f32;
        let wanted: Spectrum = (0..STEPS).map(|k| film.at(at(k)) * (2.0 * at(k) / STEPS as f32)).sum();
        let found = Reflectance::ClearFilm(film).mean();
        assert!(found.to_rgb().iter().zip(wanted.to_rgb()).all(|(a, b)| (a - b).abs() < 1e-2), "{film:?}: {found:?}, not {wanted:?}");
    }
}

/// Glass under a film reflects what Airy's formula says, and lets the rest pass. Light from inside that takes the same way back is reflected as
/// much, and beyond the critical angle all of it.
#[test]
fn films_on_glass_are_airys_formula_from_both_sides() {
    let mut random = Random::new(8);
    for _ in 0..300 {
        let (cos, thickness) = (random.range(0.05, 1.0), random.range(0.0, 1000.0));
        let (film, base) = (random.range(1.0, 2.5), random.range(1.0, 2.5));
        let (eta, color) = (base as f32, Spectrum::ONE);
        let glass = FilmedDielectric { eta, color, film_eta: film as f32, thickness: thickness as f32, facets: None };
        let wanted = in_daylight(|nanometres| airy(nanometres, cos, thickness, film, base));
        let outside = at(cos, 0.4);
        let [Some(back), Some(through)] = glass.delta_lobes(outside, TransportMode::Radiance) else { panic!("{glass:?}, cos {cos}") };
        let [Some(inner), Some(out)] = glass.delta_lobes(through.wi, TransportMode::Radiance) else { panic!("{glass:?}, cos {cos}") };
        let is_back = (out.wi.0 - outside.0).length() < 1e-3;
        assert!(is_back, "{:?} and not {outside:?}", out.wi);
        for (c, wanted) in wanted.into_iter().enumerate() {
            let of = |lobe: &BsdfSample| f64::from(lobe.weight.to_rgb()[c]);
            let found = [of(&back), of(&inner), 1.0 - of(&through) * base * base, 1.0 - of(&out) / (base * base)];
            // The refracted direction is rounded to 32 bits, which shifts the phase most near the critical angle.
            assert!(found.iter().all(|found| (found - wanted).abs() < 1.5e-3), "{glass:?}, cos {cos}: {found:?}, not {wanted}");
        }
    }
    let glass = FilmedDielectric { eta: 1.5, color: Spectrum::ONE, film_eta: 1.33, thickness: 300.0, facets: None };
    let steep = |cos: f64| Local(-at(cos, 0.0).0);
    // The critical angle has the cosine √5/3 = .7454.
    let lobes = |cos: f64| glass.delta_lobes(steep(cos), TransportMode::Radiance);
    assert!(lobes(0.75)[1].is_some() && lobes(0.74)[1].is_none());
    assert_eq!(lobes(0.74)[0].map(|lobe| lobe.weight), Some(Spectrum::ONE));
}

/// Rough glass under a film without thickness is rough glass, of which only the first hit counts, but for the end of the series at 1e-5 of the
/// light. Under the film of a soap bubble it is coloured.
#[test]
fn rough_glass_under_no_film_is_rough_glass() {
    let facets = Microfacets::new(Vec2::new(0.3, 0.1), Distribution::Ggx).expect("rough");
    let (eta, color) = (1.5, Spectrum::rgb(0.9, 0.8, 0.7));
    let bare = RoughDielectric { eta, color, facets, more: None };
    let filmed = |thickness: f32| FilmedDielectric { eta, color, film_eta: 1.33, thickness, facets: Some(facets) };
    let mut random = Random::new(9);
    for _ in 0..20_000 {
        let [wo, wi] = [0, 1].map(|_| Local(random.direction().as_vec3()));
        for mode in [TransportMode::Radiance, TransportMode::Importance] {
            let (found, wanted) = (filmed(0.0).eval(wo, wi, mode).to_rgb(), bare.eval(wo, wi, mode).to_rgb());
            assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= 1e-3 * b + 1e-6), "{wo:?}, {wi:?}: {found:?}, not {wanted:?}");
        }
        let (found, wanted) = (filmed(0.0).pdf(wo, wi).get(), bare.pdf(wo, wi).get());
        assert!((found - wanted).abs() <= 1e-3 * wanted + 1e-6, "{wo:?}, {wi:?}: {found}, not {wanted}");
    }
    let mirrored = at(0.8, 0.0);
    let back = Local(fresnel::reflect(mirrored.0));
    let [red, _, blue] = filmed(300.0).eval(mirrored, back, TransportMode::Radiance).to_rgb();
    assert!((red / blue - 0.9 / 0.7).abs() > 0.1, "{red} and {blue}");
}

/// A film on both faces of a pane reflects 2R/(1 + R) at each wavelength, where R is that of one face. Interpolation in the table of films
/// leaves what it does in tables_of_films_are_integrals_over_the_wavelength.
#[test]
fn films_on_panes_cover_both_faces() {
    let table = Film { eta: 1.8, thickness: [300.0; 2], base: [Rgb::gray(1.5), Rgb::BLACK], on_both_faces: true }.table();
    for cos in [0.1, 0.3, 0.6, 0.9, 1.0] {
        let wanted = in_daylight(|nanometres| {
            let once = airy(nanometres, cos, 300.0, 1.8, 1.5);
            2.0 * once / (1.0 + once)
        });
        for (found, wanted) in table.at(cos as f32, 300.0).to_rgb().into_iter().zip(wanted) {
            assert!((f64::from(found) - wanted).abs() < 8e-3, "cos {cos}: {found}, not {wanted}");
        }
    }
}

/// The bare metal is the metal under a film without thickness, within a thousandth, which interpolation between the nodes of the table
/// leaves at the most.
#[test]
fn metal_under_no_film_is_bare() {
    for metal in Element::ALL {
        let Metallic::Index { reflectance, .. } = Metallic::from(metal.index()) else { unreachable!("a metal by its index") };
        let filmed = Material::metal(Metallic::from(metal.index()).under_film(FilmLayer { eta: 1.5, thickness: 0.0.into() }), None, false);
        assert!(filmed.effects().contains(Effects::THIN_FILM));
        let point = SurfacePoint {
            p: glam::Vec3::ZERO,
            offset: 0.0,
            ng: glam::Vec3::Z,
            ns: glam::Vec3::Z,
            uv: Vec2::ZERO,
            color: VertexColor::WHITE,
        };
        let Bsdf::Conductor(found) = filmed.bsdf_at(&HitContext::from_outside(point)) else { unreachable!("a smooth metal") };
        assert!(matches!(found.reflectance, Reflectance::Film { .. }));
        for k in 1..=100 {
            let cos = k as f32 / 100.0;
            let (found, wanted) = (found.reflectance.at(cos).to_rgb(), reflectance.at(cos).to_rgb());
            assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-3), "{metal:?}, cos {cos}: {found:?}, not {wanted:?}");
        }
    }
}

/// What a soap film does not reflect passes, whatever it reflects: in light from all sides it vanishes. Its samples have the lobes' light as expected value.
#[test]
fn a_soap_film_keeps_all_light() {
    let law = |degrees: f64| {
        let direction = DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        let mut world = World::builder(probe(direction * 2.0, DVec3::ZERO));
        let film = world.material(Material::from(textured::ThinFilm::new(1.33, 350.0, 1.0)));
        world.shape(Quad { size: [4.0; 2] }, facing(DVec3::ZERO, DVec3::Z), film, None);
        world.light(Light::Environment(Environment { radiance: Rgb::WHITE }));
        KnownRadiance::new(format!("soap film at {degrees}°"), world, 1.0, Depth { max: 64, roulette: 4 }).resolution(1e-3, 3e-3)
    };
    confirm([10.0, 60.0, 85.0].map(law).into(), Effort::Standard);
    let film = Bsdf::ThinFilm(pt::bsdf::ThinFilm { table: soap([350.0; 2]), thickness: 350.0, color: Spectrum::ONE });
    let mut random = Random::new(5);
    for _ in 0..1000 {
        let wo = Local(random.direction().as_vec3());
        let lobes: Vec<_> = film.delta_lobes(wo, TransportMode::Radiance).collect();
        let sum = lobes.iter().fold(Spectrum::BLACK, |sum, lobe| sum + lobe.weight).to_rgb();
        assert!(sum.iter().all(|x| (x - 1.0).abs() < 1e-6), "{sum:?}");
        let chance = lobes[0].weight.average();
        for (choice, lobe, chance) in [(0.5 * chance, &lobes[0], chance), (0.5 * (1.0 + chance), &lobes[1], 1.0 - chance)] {
            let sample = film.sample(wo, choice, Vec2::ZERO, TransportMode::Radiance).expect("a lobe");
            let expected = (sample.weight * chance).to_rgb();
            assert!(sample.wi == lobe.wi && expected.iter().zip(lobe.weight.to_rgb()).all(|(a, b)| (a - b).abs() < 1e-6));
        }
    }
}

#[test]
fn impossible_films_are_refused() {
    assert_fault_in_scene(&[
        (r#""materials": {"m": {"type": "thin_film", "thickness": ^-1}}"#, "/materials/m/thickness: expected"),
        (r#""materials": {"m": {"type": "thin_film", "thickness": ^2001}}"#, "/materials/m/thickness: expected"),
        (
            r#""materials": {"m": {"type": "conductor", "eta": {"from": 1, "to": 2, "by": 0.5}, "k": 3, "film": ^{"eta": 1.5, "thickness": 100}}}"#,
            "/materials/m/film: a film needs an eta and a k that are the same everywhere",
        ),
        (
            r#""materials": {"m": {"type": "conductor", "metal": "Ti", "film": ^{"eta": 1.5}}}"#,
            "/materials/m/film: missing key \"thickness\"",
        ),
        (
            r#""materials": {"m": {"type": "dielectric", "eta": 0.75, "film": ^{"eta": 1.5, "thickness": 100}}}"#,
            "/materials/m/film: a film needs an index of refraction of at least 1",
        ),
        (
            r#""materials": {"m": {"type": "dielectric", "eta": {"from": 1.5, "to": 0.9, "by": 0.5}, "film": ^{"eta": 1.5, "thickness": 100}}}"#,
            "/materials/m/film: a film needs an index of refraction of at least 1",
        ),
    ]);
}
