//! Procedural textures in scenes, compared with their formulas.

use glam::{DVec3, Vec2, Vec3};
use pt::bsdf::Bsdf;
use pt::build::Source;
use pt::describe::{self, Files};
use pt::math::{Ray, Rgb};
use pt::scene::Scene;
use pt::shape::{SurfacePoint, VertexColor};
use pt::texture::noise::{Turbulence, perlin, turbulence};
use pt::texture::{Marble, Space, Texture, TextureContext};
use pt::world::World;

use crate::random::Random;

/// A matte unit sphere about the origin with this texture.
fn sphere(texture: &str) -> World {
    let scene = format!(
        r#"{{"pt": 1, "camera": {{}}, "textures": {{"t": {texture}}},
            "shapes": [{{"type": "sphere", "material": {{"type": "diffuse", "albedo": "t"}}}}]}}"#
    );
    let root = describe::root(scene.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").unwrap_or_else(|e| panic!("{e}"));
    let source = Source { root: &root, file: "s.json", files: &Files::within("") };
    pt::build::build(&described, source).unwrap_or_else(|e| panic!("{e}")).world
}

/// The hit of a ray from this side with the sphere, and the texture's value there. (The texture is evaluated just behind the hit.)
fn seen(world: &World, from: DVec3) -> (DVec3, f32) {
    let ray = Ray::new((3.0 * from).as_vec3(), -from.as_vec3());
    let hit = world.intersect(&ray).expect("it aims at the centre");
    let surface = world.surface(&ray, &hit);
    let Bsdf::Diffuse(diffuse) = surface.bsdf else { panic!("the sphere is matte") };
    let behind = surface.point.p - surface.point.ng * surface.point.offset;
    (behind.as_dvec3() + world.origin(), diffuse.albedo.average())
}

/// A checker in radians, as in an older renderer: odd where the product of three sines is negative.
#[test]
fn a_checker_in_radians_has_the_sign_of_three_sines() {
    let mut random = Random::new(81);
    for radians in [1.0, 10.0, 31.4] {
        let texture = format!(r#"{{"type": "checker", "even": 0.75, "odd": 0.25, "scale": {{"radians": {radians}}}, "on": "position"}}"#);
        let world = sphere(&texture);
        let mut odd = 0;
        for _ in 0..2000 {
            let (p, albedo) = seen(&world, random.direction());
            let sines = (radians * p).to_array().map(f64::sin);
            // Points nearer to a wall of a cell than the rounding of 31.4 p may be on either side.
            if sines.iter().any(|sine| sine.abs() < 2e-5) {
                continue;
            }
            let product: f64 = sines.iter().product();
            assert_eq!(albedo, if product < 0.0 { 0.25 } else { 0.75 }, "{radians} at {p}");
            odd += u32::from(product < 0.0);
        }
        assert!((500..1500).contains(&odd), "{odd} of 2000 are odd");
    }
}

/// A transform T places the pattern in the world: the value at p is that at T⁻¹ p without the transform.
#[test]
fn patterns_are_placed_by_their_transforms() {
    let mut random = Random::new(85);
    let steps = r#"[{"scale": [0.5, 1, 2]}, {"rotate": {"axis": [0, 0, 1], "degrees": 90}}, {"translate": [0.1, 0.2, 0.3]}]"#;
    let back = |p: DVec3| {
        let moved = p - DVec3::new(0.1, 0.2, 0.3);
        let turned = DVec3::new(moved.y, -moved.x, moved.z);
        turned / DVec3::new(0.5, 1.0, 2.0)
    };
    let described = |texture: &str| sphere(&texture.replace("STEPS", steps));
    let checker = described(r#"{"type": "checker", "even": 0.75, "odd": 0.25, "scale": 5, "on": "position", "transform": STEPS}"#);
    let marble = described(r#"{"type": "marble", "base": 0, "veins": 1, "scale": 4, "transform": STEPS}"#);
    for _ in 0..1000 {
        let from = random.direction();
        let (p, found) = seen(&checker, from);
        let cells = 5.0 * back(p);
        // The point is farther from a wall of a cell than its rounding error.
        if (cells - cells.round()).abs().min_element() > 1e-5 {
            let odd = cells.floor().element_sum().rem_euclid(2.0) == 1.0;
            assert_eq!(found, if odd { 0.25 } else { 0.75 }, "at {p}");
        }
        let (p, found) = seen(&marble, from);
        let q = back(p);
        let share = 0.5 * (1.0 + (4.0 * q.z + 10.0 * turbulence(q, 7)).sin());
        // The tolerance is as in `marble_is_a_sine_stirred_by_turbulence`, but twice as large where the pattern is scaled to a half.
        assert!((f64::from(found) - share).abs() < 2e-5, "at {p}: {found}, expected {share}");
    }
}

/// Cells of a checker in radians are π/r wide, so that both ways to give a scale agree.
#[test]
fn radians_are_cells_by_pi() {
    let mut random = Random::new(82);
    let checker = |scale: &str| sphere(&format!(r#"{{"type": "checker", "scale": {scale}, "on": "position"}}"#));
    let (cells, radians) = (checker("4"), checker(r#"{"radians": 12.566370614359172}"#));
    for _ in 0..1000 {
        let from = random.direction();
        assert_eq!(seen(&cells, from), seen(&radians, from));
    }
}

/// Marble goes from `base` to `veins` by ½ (1 + sin(scale·z + 10·turbulence(p))).
#[test]
fn marble_is_a_sine_stirred_by_turbulence() {
    let mut random = Random::new(83);
    for scale in [0.5, 4.0, 20.0] {
        let [base, veins] = [Rgb::new(0.25, 0.5, 0.0), Rgb::new(0.75, 0.5, 1.0)];
        let to_texture = random.rotation();
        let space = Space::World(to_texture);
        let marble = Texture::Marble(Box::new(Marble {
            base: base.into(),
            veins: veins.into(),
            scale,
            turbulence: Turbulence::SumOfAbsolutes,
            space,
        }));
        let world = sphere(&format!(r#"{{"type": "marble", "base": 0, "veins": 1, "scale": {scale}}}"#));
        // The phase is up to 20 + 10 · 2, with a rounding error of 2⁻²⁰. The point has a rounding error of 2⁻²⁴, times the slope of the
        // turbulence, at most some 1.5 for each of seven octaves, times 10.
        const TOLERANCE: f64 = 1e-5;
        let share = |p: DVec3| 0.5 * (1.0 + (scale * p.z + 10.0 * turbulence(p, 7)).sin());
        for _ in 0..1000 {
            let p = random.in_cube().as_vec3();
            let point = SurfacePoint { p, offset: 0.0, ng: Vec3::Z, ns: Vec3::Z, uv: Vec2::ZERO, color: VertexColor::WHITE };
            let expected = base.mix(veins, share(to_texture.point(p.as_dvec3())) as f32);
            let found = marble.at(&TextureContext::exact(&point));
            for (found, expected) in found.to_array().into_iter().zip(expected.to_array()) {
                assert!(f64::from((found - expected).abs()) < TOLERANCE, "{scale} at {p}: {found}, expected {expected}");
            }
            let (p, found) = seen(&world, random.direction());
            assert!((f64::from(found) - share(p)).abs() < TOLERANCE, "described, {scale} at {p}: {found}, expected {}", share(p));
        }
    }
}

/// Turbulence is Σ 2⁻ᵏ |n(2ᵏ p)|, with octaves shifted by half a cell each. It is never negative, and differs from the absolute value of
/// the sum.
#[test]
fn turbulence_is_the_sum_of_absolute_octaves() {
    let mut random = Random::new(84);
    for _ in 0..1000 {
        let p = 10.0 * random.in_cube();
        let octave = |k: i32| perlin(p * 2f64.powi(k) + DVec3::splat(0.5 * f64::from(k))).abs() / 2f64.powi(k);
        let sum: f64 = (0..7).map(octave).sum();
        assert!((turbulence(p, 7) - sum).abs() < 1e-14, "{p}");
    }
}

/// Marble can use the turbulence of *Ray Tracing: The Next Week*: |Σ 2⁻ᵏ n(2ᵏ p)|, from gradients of length 1.
#[test]
fn marble_may_be_stirred_by_the_absolute_sum() {
    let mut random = Random::new(85);
    let world = sphere(r#"{"type": "marble", "base": 0, "veins": 1, "scale": 3, "turbulence": "absolute_of_sum"}"#);
    for _ in 0..1000 {
        let (p, found) = seen(&world, random.direction());
        let octave = |k: i32| perlin(p * 2f64.powi(k)) / 2f64.powi(k) / 2f64.sqrt();
        let sum: f64 = (0..7).map(octave).sum();
        let share = 0.5 * (1.0 + (3.0 * p.z + 10.0 * sum.abs()).sin());
        // The tolerance is as in `marble_is_a_sine_stirred_by_turbulence`.
        assert!((f64::from(found) - share).abs() < 1e-5, "at {p}: {found}, expected {share}");
    }
}
