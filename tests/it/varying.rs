//! Every number or colour of a material can be a texture, and has the texture's value at each point.

use glam::{Vec2, Vec3};
use pt::bsdf::microfacet::roughness::{Alpha, Roughness};
use pt::bsdf::microfacet::{self, Distribution};
use pt::bsdf::{Bsdf, Coat, Coated, Compound, HitContext, Material, Plastic, Sheen, TransportMode};
use pt::effects::Effects;
use pt::math::fresnel::{dielectric, dielectric_mean};
use pt::math::{Local, Rgb};
use pt::proof::at;
use pt::scene::Scene;
use pt::shape::{SurfacePoint, VertexColor};
use pt::texture::{Number, Texture, TextureContext};

use crate::compounds::{albedo, ramp};
use crate::random::Random;
use crate::roughness::{bsdf, square};

/// A material with `$` in place of a number, and two values of that number.
type Row = (&'static str, &'static str, &'static str);

/// Numbers from 0 to 1 take a texture directly. Numbers with a table have values at its nodes.
const SHARES: &[Row] = &[
    (r#"{"type": "conductor", "metal": "Cu", "roughness": 0.5, "anisotropy": $, "multiscatter": false}"#, "0", "0.75"),
    (r#"{"type": "conductor", "metal": "Cu", "alpha": $, "multiscatter": false}"#, "0.25", "0.5"),
    (r#"{"type": "conductor", "metal": "Cu", "alpha": [$, 0.5], "multiscatter": false}"#, "0", "0.25"),
    (r#"{"type": "conductor", "metal": "Cu", "alpha": [0.5, $], "multiscatter": false}"#, "0.25", "0.75"),
    (r#"{"type": "dielectric", "roughness": 0.5, "anisotropy": $, "multiscatter": false}"#, "0", "0.75"),
    (r#"{"type": "sheen", "ground": {"type": "diffuse"}, "roughness": $}"#, "0", "1"),
    (r#"{"type": "principled", "sheen_color": 0.5, "sheen_roughness": $}"#, "0", "1"),
    (r#"{"type": "principled", "metallic": 1, "roughness": 0.5, "anisotropy": $, "multiscatter": false}"#, "0", "0.75"),
    (r#"{"type": "principled", "metallic": 1, "roughness": 0.5, "iridescence": $}"#, "0", "1"),
];

/// Other numbers take a texture that interpolates between two ends.
const NUMBERS: &[Row] = &[
    (r#"{"type": "phong", "exponent": $}"#, "3", "1e4"),
    (r#"{"type": "blinn_phong", "exponent": $}"#, "0", "30"),
    (r#"{"type": "conductor", "eta": $, "k": 3}"#, "0.2", "[1.5, 0.4, 0.1]"),
    (r#"{"type": "conductor", "eta": [1.5, 0.4, 0.1], "k": $}"#, "[3, 2, 1]", "1000"),
    (r#"{"type": "conductor", "eta": [1.5, 0.4, 0.1], "k": $, "roughness": 0.5}"#, "[3, 2, 1]", "[2, 2, 4]"),
    (r#"{"type": "dielectric", "eta": $}"#, "1", "1.7"),
    (r#"{"type": "dielectric", "eta": $, "roughness": 0.5}"#, "0.8", "1.25"),
    (r#"{"type": "dielectric", "eta": $, "roughness": 0.5, "multiscatter": false}"#, "2", "1.25"),
    (r#"{"type": "thin_dielectric", "eta": $}"#, "1.5", "1"),
    (r#"{"type": "plastic", "albedo": 0.7, "eta": $}"#, "1.3", "1.5"),
    (r#"{"type": "plastic", "albedo": 0.7, "eta": $, "roughness": 0.3}"#, "1.3", "1.5"),
    (r#"{"type": "coated", "ground": {"type": "diffuse"}, "eta": $}"#, "1", "2.4"),
    (r#"{"type": "mix", "a": {"type": "diffuse"}, "b": {"type": "mirror"}, "fresnel": $}"#, "1.1", "3"),
    (r#"{"type": "principled", "transmission": 0.5, "roughness": 0, "eta": $}"#, "1.2", "1.6"),
    (r#"{"type": "principled", "coat": 0.5, "coat_eta": $}"#, "1.2", "1.6"),
    (r#"{"type": "principled", "iridescence": 1, "iridescence_thickness": $}"#, "100", "400"),
    (r#"{"type": "principled", "iridescence": 1, "roughness": 0.3, "eta": $}"#, "1.3", "1.5"),
    (r#"{"type": "dielectric", "film": {"eta": 1.4, "thickness": $}}"#, "0", "300"),
    (r#"{"type": "conductor", "color": 0.5, "roughness": 0.3, "film": {"eta": 1.5, "thickness": $}}"#, "0", "300"),
];

/// With a checker of two squares as the texture, the surface has one material on the left and the other on the right.
#[test]
fn a_texture_is_each_of_its_values() {
    let mut random = Random::new(3);
    let checker = |even: &str, odd: &str| format!(r#"{{"type": "checker", "even": {even}, "odd": {odd}, "scale": 2}}"#);
    let between = |a: &str, b: &str| format!(r#"{{"from": {a}, "to": {b}, "by": {}}}"#, checker("0", "1"));
    let shares = SHARES.iter().map(|(material, a, b)| (material, checker(a, b), a, b));
    let numbers = NUMBERS.iter().map(|(material, a, b)| (material, between(a, b), a, b));
    for (material, textured, a, b) in shares.chain(numbers) {
        let textured = square(&material.replace('$', &textured));
        assert!(textured.world.effects().contains(Effects::TEXTURES), "{material}");
        for (x, value) in [(-0.5, a), (0.5, b)] {
            let plain = square(&material.replace('$', value));
            assert!(!plain.world.effects().contains(Effects::TEXTURES), "{material}");
            same(&bsdf(&textured, x), &bsdf(&plain, x), &mut random, &format!("{material}, {value}"));
        }
    }
}

/// Asserts that two BSDFs scatter the same light between random directions, up to the rounding of table lookups at the nodes.
fn same(found: &Bsdf, expected: &Bsdf, random: &mut Random, what: &str) {
    const MODE: TransportMode = TransportMode::Radiance;
    let near = |a: f32, b: f32| (a - b).abs() <= 2e-5 * b.abs() + 1e-7;
    for _ in 0..100 {
        let [wo, wi] = [(); 2].map(|()| Local(random.direction().as_vec3()));
        let (choice, u) = (random.unit() as f32, random.uniform_square());
        assert!(near(found.pdf(wo, wi).get(), expected.pdf(wo, wi).get()), "{what}");
        let [a, b] = [found, expected].map(|bsdf| bsdf.eval(wo, wi, MODE).to_rgb());
        assert!(a.into_iter().zip(b).all(|(a, b)| near(a, b)), "{what}: {a:?}, expected {b:?} for {wo:?} {wi:?}");
        let [a, b] = [found, expected].map(|bsdf| bsdf.sample(wo, choice, u, MODE));
        assert_eq!(a.map(|s| s.wi), b.map(|s| s.wi), "{what}");
        let [a, b] = [found, expected].map(|bsdf| bsdf.delta_lobes(wo, MODE).map(|lobe| (lobe.wi, lobe.weight)).collect::<Vec<_>>());
        assert!(a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a.0 == b.0 && near(a.1.average(), b.1.average())), "{what}");
    }
}

/// The number goes from one end to the other, and reaches both exactly, whichever is greater. A constant texture gives a constant number.
#[test]
fn textured_numbers_lie_between_their_ends() {
    let point =
        |u: f32| SurfacePoint { p: Vec3::ZERO, offset: 0.0, ng: Vec3::Z, ns: Vec3::Z, uv: Vec2::new(u, 0.5), color: VertexColor::WHITE };
    let place = |u: f32| TextureContext::exact(&point(u));
    for (from, to) in [(1.1f32, 1.7f32), (1e8, 0.0), (-3.0, 5.0)] {
        let number = Number::between(from, to, ramp(0.0, 1.0));
        assert_eq!(number.range(), [from.min(to), from.max(to)]);
        // The ramp rises from 1/4 to 3/4.
        for (u, share) in [(0.0, 0.0), (0.25, 0.0), (0.5, 0.5), (0.625, 0.75), (0.75, 1.0), (1.0, 1.0)] {
            let expected = from + (to - from) * share;
            assert!((number.at(&place(u)) - expected).abs() <= 2e-6 * from.abs().max(to.abs()), "{number:?} at {u}");
        }
        assert_eq!((number.at(&place(0.0)), number.at(&place(1.0))), (from, to));
        assert_eq!(Number::between(from, to, 1.0.into()), Number::Constant(to));
    }
}

/// The BSDF of a material at the middle of the ramp.
fn halfway(material: &Material) -> Bsdf<'_> {
    material.bsdf_at(&HitContext::from_outside(SurfacePoint {
        p: Vec3::ZERO,
        offset: 0.0,
        ng: Vec3::Z,
        ns: Vec3::Z,
        uv: Vec2::splat(0.5),
        color: VertexColor::WHITE,
    }))
}

fn roughness(alpha: f32) -> Roughness {
    Roughness { alpha: Alpha::Constant(Vec2::splat(alpha)), distribution: Distribution::Ggx }
}

/// White glass and a coated white base, half way between two tables, where interpolation has the largest error, compared with tables for
/// that index: the albedo differs by less than 2e-3, the required precision of the tables themselves. (Glass with η below 1.0025 has total
/// reflection only within the last 4°. That edge lies between the tables, and the difference is 5e-3.)
#[test]
fn between_two_tables_no_light_is_lost() {
    for (low, high) in [(1.0, 1.0025), (1.0025, 1.01), (1.022, 1.04), (1.19, 1.248), (1.43, 1.5), (2.2, 2.4), (0.65, 0.69)] {
        let varying = || Number::between(low, high, ramp(0.0, 1.0));
        let middle = 0.5 * (low + high);
        for alpha in [0.1, 0.3, 1.0] {
            let glass = |eta| Material::rough_glass(eta, Rgb::WHITE, roughness(alpha), true);
            let coat = |eta| {
                let coat = Coat::new(eta, Rgb::WHITE, Some(roughness(alpha)));
                Material::from(Compound::Coated(Coated { base: Material::diffuse(Rgb::WHITE), coat }))
            };
            let mut pairs = vec![("glass", glass(varying()), glass(middle.into()))];
            if low >= 1.0 {
                pairs.push(("coat", coat(varying()), coat(middle.into())));
            }
            for (name, between, exact) in &pairs {
                for (cos, side) in [1.0, 0.6, 0.2].into_iter().flat_map(|cos| [(cos, 1.0), (cos, -1.0)]) {
                    let difference = difference(&halfway(between), &halfway(exact), Local(at(cos, 0.4).0 * side));
                    let what = format!("{name}, η {low} to {high}, α {alpha}, cos {cos} {side}");
                    assert!(difference.abs() < if high < 1.005 { 5e-3 } else { 2e-3 }, "{what}: {difference}");
                }
            }
        }
    }
}

/// Anisotropic facets whose anisotropy or roughness varies, compared with tables for those widths, are white to 1 %. With the mean of the
/// two widths only, half of the light would be missing.
#[test]
fn long_facets_that_vary_lose_no_light() {
    let white = |alpha| Material::metal(Texture::from(Rgb::WHITE), Some(Roughness { alpha, distribution: Distribution::Ggx }), true);
    let varying = |value: f32| ramp(value - 0.02, value + 0.02);
    for (roughness, anisotropy) in [(0.3f32, 0.9f32), (0.53, 0.5), (0.7, 0.98), (0.95, 0.3)] {
        let widths = microfacet::roughness::alpha(roughness, anisotropy);
        let exact = white(Alpha::Constant(widths));
        let mut varied = vec![
            Alpha::Textured { roughness: roughness.into(), anisotropy: varying(anisotropy) },
            Alpha::Textured { roughness: varying(roughness), anisotropy: anisotropy.into() },
            Alpha::Textured { roughness: varying(roughness), anisotropy: varying(anisotropy) },
        ];
        if widths.x < 0.98 {
            varied.push(Alpha::Widths([varying(widths.x), widths.y.into()]));
        }
        for alpha in varied {
            let between = white(alpha.clone());
            for (cos, phi) in [1.0, 0.6, 0.2, 0.05].into_iter().flat_map(|cos| [0.0, 0.8, 1.57].map(|phi| (cos, phi))) {
                let difference = difference(&halfway(&between), &halfway(&exact), at(cos, phi));
                assert!(difference.abs() < 0.012, "{roughness}, {anisotropy}, {alpha:?}, cos {cos}, φ {phi}: {difference}");
            }
        }
    }
}

/// Fibres between two tables take from a mirror below exactly the light that they reflect, with the same precision as at a table.
#[test]
fn between_two_tables_of_fibres_no_light_is_lost() {
    for (low, high) in [(0.1, 0.25), (0.3, 0.6), (0.6, 1.0)] {
        let sheen = Sheen::new(Material::mirror(Rgb::WHITE), Rgb::WHITE, ramp(low, high));
        for cos in [1.0, 0.6, 0.25] {
            let found = albedo(&halfway(&Compound::Sheen(sheen.clone()).into()), at(cos, 0.0)).average();
            assert!((found - 1.0).abs() < 5e-3, "roughness {low} to {high}, cos {cos}: {found}");
        }
    }
}

/// The difference of the albedos of two models, over both sides of the surface. The integrand is the difference, so that equal narrow lobes
/// cancel.
fn difference(a: &Bsdf, b: &Bsdf, wo: Local) -> f64 {
    const N: u32 = 64;
    let cell = |k: u32| {
        let [i, j] = [k % N, k / N].map(|k| (f64::from(k) + 0.5) / f64::from(N));
        let sides = [1.0, -1.0].map(|side| {
            let wi = Local(at((1.0 - i).sqrt(), std::f64::consts::TAU * j).0 * side);
            let [a, b] = [a, b].map(|model| f64::from(model.eval(wo, wi, TransportMode::Importance).average()));
            (a - b) / f64::from(wi.abs_cos())
        });
        sides[0] + sides[1]
    };
    (0..N * N).map(cell).sum::<f64>() * std::f64::consts::PI / f64::from(N * N)
}

/// Where an index of refraction varies, quantities that depend on it have the values for a constant index.
#[test]
fn means_follow_the_index() {
    let model = Material::plastic(Rgb::WHITE, Number::between(1.2, 1.8, ramp(0.0, 1.0)));
    let Bsdf::Plastic(plastic) = halfway(&model) else { panic!("plastic") };
    assert!((plastic.eta - 1.5).abs() < 1e-6);
    assert_eq!(plastic.internal, Plastic::internal(plastic.eta));
}

/// The mean reflectance against Simpson's rule; near 1, where the terms of the formula cancel, too.
#[test]
fn mean_reflectance_is_the_integral() {
    const STEPS: u32 = 2048;
    let integral = |eta: f32| {
        let at = |step: u32| f64::from(step) / f64::from(STEPS);
        let term = |step: u32| f64::from(2 << (step % 2)) * 2.0 * at(step) * f64::from(dielectric(at(step) as f32, eta));
        ((1..STEPS).map(term).sum::<f64>() + 2.0 * f64::from(dielectric(1.0, eta))) / f64::from(3 * STEPS)
    };
    for eta in [1.0001f32, 1.00011, 1.001, 1.01, 1.1, 1.5, 2.42, 10.0, 100.0] {
        let (found, expected) = (f64::from(dielectric_mean(eta)), integral(eta));
        // The tolerance is the error of Simpson's rule where F is almost a step at the horizon: a tenth of a cell.
        assert!((found - expected).abs() < 1e-7 + 5e-5 * expected, "η {eta}: {found}, {expected}");
    }
}

/// A texture with values that the number cannot have is one fault, with its position.
#[test]
fn textured_numbers_respect_the_range_of_the_number() {
    let refused = |material: &str| {
        let scene = format!(r#"{{"pt": 1, "camera": {{}}, "materials": {{"m": {material}}}}}"#);
        let root = pt::describe::root(scene.as_bytes(), "s.json").expect("JSON");
        pt::describe::read(&root, "s.json").expect_err("a fault").to_string()
    };
    for (material, said) in [
        (
            r#"{"type": "dielectric", "eta": {"from": 0, "to": 1.5, "by": 1}}"#,
            "/materials/m/eta/from: expected an index of refraction from 0.01 to 100, found 0",
        ),
        (
            r#"{"type": "plastic", "eta": {"from": 1, "to": 0.9, "by": 1}}"#,
            "/materials/m/eta/to: expected an index of refraction from 1 to 100, found 0.9",
        ),
        (
            r#"{"type": "phong", "exponent": {"from": 1, "to": 9, "by": 2}}"#,
            "/materials/m/exponent/by: expected a number from 0 to 1, found 2",
        ),
        (r#"{"type": "phong", "exponent": {"from": 1, "by": 1}}"#, "/materials/m/exponent: missing key \"to\""),
        (r#"{"type": "phong", "exponent": {"from": 1, "to": 9, "by": "wood"}}"#, "/materials/m/exponent/by: unknown texture \"wood\""),
        (r#"{"type": "conductor", "eta": 1, "k": {"from": 1, "to": [1, 2], "by": 1}}"#, "/materials/m/k/to"),
        (r#"{"type": "sheen", "ground": {"type": "mirror"}, "roughness": "wood"}"#, "/materials/m/roughness: unknown texture \"wood\""),
        (r#"{"type": "conductor", "metal": "Cu", "alpha": [0.1, "wood"]}"#, "/materials/m/alpha/1: unknown texture \"wood\""),
    ] {
        let found = refused(material);
        assert!(found.contains(said), "{material}: {found}");
    }
}
