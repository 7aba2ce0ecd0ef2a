//! Roughness in scenes: by a texture, and values that are too small to matter.

use glam::Vec3;
use pt::bsdf::{Bsdf, TransportMode};
use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::math::{Local, Ray};
use pt::scene::Scene;

use crate::random::Random;

/// A square of two metres of this material that faces the camera.
pub fn square(material: &str) -> Built {
    let scene = format!(
        r#"{{"pt": 1, "camera": {{}}, "background": {{"radiance": 1}}, "materials": {{"m": {material}}},
            "shapes": [{{"type": "quad", "size": 2, "material": "m"}}]}}"#
    );
    built(&scene)
}

fn built(scene: &str) -> Built {
    let root = describe::root(scene.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").unwrap_or_else(|e| panic!("{e}"));
    let source = Source { root: &root, file: "s.json", files: &Files::within("") };
    pt::build::build(&described, source).unwrap_or_else(|e| panic!("{e}"))
}

/// BSDF at x on a quad with a checker of two squares: the even square is at x < 0, the odd one at x > 0.
pub fn bsdf(built: &Built, x: f32) -> Bsdf<'_> {
    let ray = Ray::new(Vec3::new(x, -0.5, 3.0) - built.world.origin().as_vec3(), Vec3::NEG_Z);
    let hit = built.world.intersect(&ray).expect("the square is there");
    built.world.surface(&ray, &hit).bsdf
}

fn metal(roughness: &str, more: &str) -> String {
    format!(r#"{{"type": "conductor", "metal": "Cu", "roughness": {roughness}{more}}}"#)
}

/// Where a texture gives a metal two values of roughness, each equals a metal of that constant roughness. Both values are multiples of
/// 1/16, which are rows of the energy-loss table for textured metals, so that nothing is interpolated.
#[test]
fn a_textured_roughness_is_each_of_its_values() {
    let mut random = Random::new(91);
    for more in [r#", "multiscatter": false"#, "", r#", "distribution": "beckmann""#] {
        let textured = square(&metal(r#"{"type": "checker", "even": 0.25, "odd": 0.625, "scale": 2}"#, more));
        for (x, roughness) in [(-0.5, "0.25"), (0.5, "0.625")] {
            let plain = square(&metal(roughness, more));
            let (found, expected) = (bsdf(&textured, x), bsdf(&plain, 0.5));
            assert!(matches!(found, Bsdf::RoughConductor(_)), "{found:?}");
            for _ in 0..200 {
                let [wo, wi] = [(); 2].map(|()| Local(random.direction().as_vec3()));
                let (choice, u) = (random.unit() as f32, random.uniform_square());
                assert_eq!(found.pdf(wo, wi), expected.pdf(wo, wi));
                let [a, b] = [&found, &expected].map(|bsdf| bsdf.eval(wo, wi, TransportMode::Radiance).to_rgb());
                let [c, d] = [&found, &expected].map(|bsdf| bsdf.sample(wo, choice, u, TransportMode::Radiance));
                assert_eq!(c.map(|s| s.wi), d.map(|s| s.wi));
                for (a, b) in a.into_iter().zip(b) {
                    // The row of the table is computed with a rounding error, in steps of 1/16 and with slopes of some tenths.
                    assert!((a - b).abs() <= 1e-5 * b.abs(), "{roughness}{more}: {a}, expected {b} for {wo:?} {wi:?}");
                }
            }
        }
    }
}

/// Where a textured roughness is 0 the metal is a mirror.
#[test]
fn a_textured_roughness_of_0_is_smooth() {
    let textured = square(&metal(r#"{"type": "checker", "even": 0, "odd": 0.5, "scale": 2}"#, ""));
    assert_eq!(bsdf(&textured, -0.5), bsdf(&square(&metal("0", "")), 0.5));
    assert!(matches!(bsdf(&textured, -0.5), Bsdf::Conductor(_)));
    assert!(matches!(bsdf(&textured, 0.5), Bsdf::RoughConductor(_)));
}

/// Directions in f32 cannot resolve a roughness with α = r² below 10⁻⁶. So there is a warning for r below 10⁻³, but not for 0.
#[test]
fn a_negligible_roughness_is_reported() {
    let kinds = [
        (r#""type": "conductor", "metal": "Au""#, "roughness"),
        (r#""type": "dielectric", "eta": 1.5"#, "roughness"),
        (r#""type": "principled""#, "roughness"),
        (r#""type": "principled", "coat": 1"#, "coat_roughness"),
    ];
    for (kind, key) in kinds {
        for (roughness, is_said) in [("0", false), ("1e-6", true), ("9.99e-4", true), ("1.001e-3", false), ("0.5", false)] {
            let mut warnings = square(&format!(r#"{{{kind}, "{key}": {roughness}}}"#)).warnings;
            // A square of glass is not a closed body, which causes another warning.
            warnings.retain(|warning| !warning.contains("open or inconsistently wound glass"));
            let said = warnings.iter().any(|warning| {
                let value: f32 = roughness.parse().expect("a number");
                *warning == format!("s.json: /materials/m/{key}: {value} is as good as 0, the surface is smooth")
            });
            assert_eq!(said, is_said, "{kind}, {roughness}: {warnings:?}");
            assert_eq!(warnings.len(), usize::from(is_said), "{kind}, {roughness}: {warnings:?}");
        }
    }
}

/// A bump map on a triangle whose texture coordinates have no area causes a warning. Other triangles do not.
#[test]
fn a_bump_map_without_effect_is_reported() {
    for (uvs, is_said) in
        [("[[0, 0], [1, 0], [0, 1]]", false), ("[[0.5, 0.5], [0.5, 0.5], [0.5, 0.5]]", true), ("[[0, 0], [1, 1], [2, 2]]", true)]
    {
        for (bumped, matters) in
            [(r#"{"type": "bumped", "surface": {"type": "diffuse"}, "bump_map": 0.5}"#, true), (r#"{"type": "diffuse"}"#, false)]
        {
            let mesh = format!(
                r#"{{"type": "mesh", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]], "uvs": {uvs}, "material": {bumped}}}"#
            );
            let warnings = built(&format!(r#"{{"pt": 1, "camera": {{}}, "background": {{"radiance": 1}}, "shapes": [{mesh}]}}"#)).warnings;
            let expected =
                "s.json: /shapes/0: the texture coordinates of 1 of 1 triangles span no area: normal and bump maps have no effect there";
            assert_eq!(warnings.iter().any(|warning| warning == expected), is_said && matters, "{uvs}, {bumped}: {warnings:?}");
        }
    }
}
