//! Scenes whose radiance is known by formula: every integrator that simulates all of their effects must find it.
//!
//! E: irradiance [W·m⁻²]; a white matte surface shows L = E/π.

use std::f64::consts::PI;

use glam::DVec3;
use pt::bsdf::Material;
use pt::light::{Light, Point};
use pt::shape::{Disk, Quad, Sphere};
use pt::world::{World, WorldBuilder};

use crate::scenes::{Depth, Effort, Law, at, black, confirm, facing, glow, gray, probe, room, stored, two_sided};

/// Limits of the default settings.
const DEFAULT: Depth = Depth { max: 64, roulette: 4 };

/// Sum 1 + ρ + … + ρ^depth.
fn terms(albedo: f64, depth: u32) -> f64 {
    (1.0 - albedo.powi(depth as i32 + 1)) / (1.0 - albedo)
}

/// The inside of a box whose walls all emit and reflect: L = Le/(1 − ρ), limited to `depth` scattering events.
fn glowing_box(albedo: f64) -> WorldBuilder {
    let mut world = World::builder(probe(DVec3::new(0.3, -0.2, 0.4), DVec3::new(1.0, 0.4, 0.1)));
    let wall = world.material(Material::diffuse(stored(gray(albedo))));
    room(&mut world, DVec3::ZERO, DVec3::new(1.0, 1.5, 1.0), |_, _| (wall, glow(1.0)));
    world
}

/// The inside of a sphere that emits and reflects. The radiance is that of [`glowing_box`], and the light is sampled from inside.
fn glowing_sphere(albedo: f64) -> WorldBuilder {
    let mut world = World::builder(probe(DVec3::new(0.3, -0.2, 0.4), DVec3::new(1.0, 0.4, 0.1)));
    let wall = world.material(Material::diffuse(stored(gray(albedo))));
    world.shape(Sphere { radius: 1.5 }, at(DVec3::ZERO), wall, two_sided(1.0));
    world
}

/// W1: the inside of a box and of a sphere that emit and reflect. Without Russian roulette only light sampling is random.
fn furnace() -> Vec<Law> {
    let row = |(albedo, depth): (f64, u32)| {
        let boxed = Law::new(format!("W1 box, albedo {albedo}"), glowing_box(albedo), terms(albedo, depth), Depth::exactly(depth));
        let round = Law::new(format!("W1 sphere, albedo {albedo}"), glowing_sphere(albedo), terms(albedo, depth), Depth::exactly(depth));
        [boxed, round].map(|law| law.resolution(1e-3, 2e-3).by_chance(1e-3))
    };
    [(0.2, 10), (0.5, 20), (0.8, 60), (0.9, 100), (0.99, 300)].into_iter().flat_map(row).collect()
}

/// W1 with the default Russian roulette, which must not change the mean.
fn roulette() -> Vec<Law> {
    let law = |(albedo, max): (f64, u32)| {
        let law = Law::new(format!("roulette, albedo {albedo}"), glowing_box(albedo), terms(albedo, max), Depth { max, roulette: 4 });
        law.resolution(1e-3, 6e-3).by_chance(6e-3)
    };
    [(0.2, 64), (0.5, 64), (0.8, 64), (0.9, 64)]
        .into_iter()
        .map(law)
        .chain([law((0.99, 300)).resolution(1e-3, 2e-2).by_chance(2e-2)])
        .collect()
}

/// W2: meaning of `max_depth`. 0 is emission, 1 is direct light, and each further step adds a reflection.
fn depth() -> Vec<Law> {
    let row = |albedo: f64| {
        [0, 1, 2, 8].map(|depth| {
            let name = format!("W2 depth {depth}, albedo {albedo}");
            let law =
                Law::new(name, glowing_box(albedo), terms(albedo, depth), Depth::exactly(depth)).resolution(1e-3, 2e-3).by_chance(1e-3);
            // Without weights, light samples near an edge of the box have too large a variance.
            law.not_by_lights_alone()
        })
    };
    [0.2, 0.5, 0.8, 0.9, 0.99].into_iter().flat_map(row).collect()
}

/// W3. A point light I = π in the middle of a unit sphere: L = ρ I / (π r² (1 − ρ)) = 1 for ρ = ½.
fn point_in_sphere() -> Vec<Law> {
    let mut world = World::builder(probe(DVec3::new(0.3, -0.2, 0.4), DVec3::new(0.9, 0.4, 0.1)));
    let wall = world.material(Material::diffuse(stored(gray(0.5))));
    world.shape(Sphere { radius: 1.0 }, at(DVec3::ZERO), wall, None);
    world.light(Light::Point(Point { position: DVec3::ZERO, intensity: stored(gray(PI)) }));
    vec![Law::new("W3", world, 1.0, DEFAULT).resolution(1e-3, 2e-3)]
}

/// W4. A point light I = 10 at height h = 2: E = I h/(h² + x²)^(3/2), without any noise.
fn point_above_floor() -> Vec<Law> {
    let law = |x: f64| {
        let spot = DVec3::new(x, 0.0, 0.0);
        let mut world = World::builder(probe(spot + DVec3::new(0.5, 1.0, 0.5), spot));
        let floor = world.material(Material::diffuse(stored(gray(0.5))));
        world.shape(Quad { size: [40.0, 40.0] }, facing(DVec3::ZERO, DVec3::Y), floor, None);
        world.light(Light::Point(Point { position: DVec3::Y * 2.0, intensity: stored(gray(10.0)) }));
        let irradiance = 20.0 / (4.0 + x * x).powf(1.5);
        Law::new(format!("W4, x = {x}"), world, 0.5 * irradiance / PI, Depth::exactly(1)).resolution(1e-5, 1e-5)
    };
    [0.0, 1.0, 2.0, 10.0].map(law).into()
}

/// A small white tile at the origin whose normal is `degrees` away from the direction of the light, +y; seen from the far side.
fn tile(scale: f64, degrees: f64) -> WorldBuilder {
    let away = |degrees: f64| DVec3::new(degrees.to_radians().sin(), degrees.to_radians().cos(), 0.0);
    let mut world = World::builder(probe(away(degrees + 60.0) * (0.01 * scale), DVec3::ZERO));
    let white = world.material(Material::diffuse(stored(gray(1.0))));
    world.shape(Quad { size: [0.005 * scale; 2] }, facing(DVec3::ZERO, away(degrees)), white, None);
    world
}

fn under_sphere(radius: f64, distance: f64, degrees: f64) -> WorldBuilder {
    let mut world = tile(distance, degrees);
    let dark = world.material(black());
    world.shape(Sphere { radius }, at(DVec3::Y * distance), dark, glow(1.0));
    world
}

/// W5. A spherical light wholly above the horizon: E = π L (r/d)² cos θ.
fn sphere_light() -> Vec<Law> {
    let row = |(r, d, degrees, chance): (f64, f64, f64, Option<f64>)| {
        let radiance = (r / d).powi(2) * degrees.to_radians().cos();
        let law = Law::new(format!("W5, r {r}, d {d}, {degrees}°"), under_sphere(r, d, degrees), radiance, Depth::exactly(1));
        Law { by_chance: chance, ..law }.resolution(1e-3, 2e-3)
    };
    // Share of the directions that hit the light by chance: 11 % and 5.6 %.
    [(1.0, 3.0, 0.0, Some(1e-2)), (1.0, 3.0, 60.0, Some(2e-2)), (1.0, 1e4, 0.0, None), (0.01, 100.0, 45.0, None)].map(row).into()
}

/// Irradiance by a spherical light of which the horizon cuts a part.
///
/// E = L [ (cos θ acos y − x sin θ √(1 − y²)) / (x² + 1) + atan(sin θ √(1 − y²) / x) ],  x = √((d/r)² − 1), y = −x cot θ
///
/// Source: Snyder, *Area Light Sources for Real-Time Graphics* (1996).
fn cut_sphere(ratio: f64, degrees: f64) -> f64 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let x = (ratio * ratio - 1.0).sqrt();
    let y = -x * cos / sin;
    let s = sin * (1.0 - y * y).sqrt();
    (cos * y.acos() - x * s) / (ratio * ratio) + (s / x).atan()
}

/// W6: a spherical light of which the horizon cuts a part; see [`cut_sphere`].
fn cut_sphere_light() -> Vec<Law> {
    let row = |(r, d, degrees, irradiance, chance): (f64, f64, f64, f64, Option<f64>)| {
        assert!((cut_sphere(d / r, degrees) - irradiance).abs() < 1e-9, "{}", cut_sphere(d / r, degrees));
        let law = Law::new(format!("W6, r {r}, d {d}, {degrees}°"), under_sphere(r, d, degrees), irradiance / PI, Depth::exactly(1));
        Law { by_chance: chance, ..law }.resolution(2e-3, 5e-3)
    };
    // Share of the directions that hit the light by chance: 5.5 %, 2.9 %, 1.1 %, 42 %.
    [
        (1.0, 2.0, 80.0, 0.1718319751, Some(2e-2)),
        (1.0, 2.0, 90.0, 0.0905860737, None),
        (1.0, 2.0, 100.0, 0.0354490153, None),
        (1.0, 1.01, 89.0, 1.3178958448, Some(5e-3)),
    ]
    .map(row)
    .into()
}

/// W7. A disk of radius 1 overhead, at its axis: E = π/(1 + h²).
fn disk_light() -> Vec<Law> {
    let row = |(h, chance, lights_alone): (f64, Option<f64>, bool)| {
        let mut world = tile(h, 0.0);
        let dark = world.material(black());
        world.shape(Disk { radius: 1.0 }, facing(DVec3::Y * h, -DVec3::Y), dark, glow(1.0));
        let law = Law::new(format!("W7, h {h}"), world, 1.0 / (1.0 + h * h), Depth::exactly(1));
        Law { by_chance: chance, lights_alone, ..law }.resolution(1e-3, 2e-3)
    };
    [(0.01, Some(1e-3), false), (0.5, Some(3e-3), false), (1.0, Some(4e-3), true), (2.0, Some(1e-2), true), (10.0, None, true)]
        .map(row)
        .into()
}

/// Irradiance at height h under the middle of a square of edge w: 4 corners of edge w/2.
///
/// E = 4 · ½ · 2 a/√(1 + a²) atan(a/√(1 + a²)),  a = w/2h
///
/// Source: Lambert, *Photometria* (1760).
fn square(edge: f64, height: f64) -> f64 {
    let a = 0.5 * edge / height;
    let s = a / (1.0 + a * a).sqrt();
    4.0 * s * s.atan()
}

/// W8: a square light overhead, whose edge is w and whose height is h; see [`square`].
fn square_light() -> Vec<Law> {
    let row = |(edge, h, irradiance, chance, lights_alone): (f64, f64, f64, Option<f64>, bool)| {
        assert!((square(edge, h) / irradiance - 1.0).abs() < 1e-8, "{}", square(edge, h));
        let mut world = tile(h, 0.0);
        let dark = world.material(black());
        world.shape(Quad { size: [edge; 2] }, facing(DVec3::Y * h, -DVec3::Y), dark, glow(1.0));
        let law = Law::new(format!("W8, w {edge}, h {h}"), world, irradiance / PI, Depth::exactly(1));
        Law { by_chance: chance, lights_alone, ..law }.resolution(1e-3, 2e-3)
    };
    [
        (1.0, 1.0, 0.7522746885, Some(6e-3), true),
        (1.0, 0.1, 3.0421284384, Some(1e-3), false),
        (1.0, 0.01, 3.1405646834, Some(1e-3), false),
        (1.0, 10.0, 0.0099667829, None, true),
        (1.0, 100.0, 9.9996667e-5, None, true),
        (2.0, 1.0, 1.7408395027, Some(4e-3), true),
    ]
    .map(row)
    .into()
}

/// W13. Two plates that close a tube of perfect mirrors see nothing but each other: L₁ = 1/(1 − ρ₁ρ₂), L₂ = ρ₂ L₁.
///
/// Mirrors count as scattering events, so the depth limit here is 1000.
fn mirror_tube() -> Vec<Law> {
    let (first, second) = (0.3, 0.7);
    let row = |(side, radiance): (f64, f64)| {
        let mut world = World::builder(probe(DVec3::new(0.1, 0.2, 0.0), DVec3::new(0.3, 0.1, side)));
        let mirror = world.material(Material::mirror(stored(gray(1.0))));
        let plates = [first, second].map(|albedo| world.material(Material::diffuse(stored(gray(albedo)))));
        room(&mut world, DVec3::ZERO, DVec3::new(0.5, 0.5, 1.0), |axis, side| match (axis, side < 0.0) {
            (2, true) => (plates[0], glow(1.0)),
            (2, false) => (plates[1], None),
            _ => (mirror, None),
        });
        Law::new(format!("W13, plate at z = {side}"), world, radiance, Depth { max: 1000, roulette: 4 })
            .resolution(1e-3, 4e-3)
            .by_chance(4e-3)
    };
    let bright = 1.0 / (1.0 - first * second);
    [(-1.0, bright), (1.0, second * bright)].map(row).into()
}

/// W14. A sphere whose wall reflects ρ, closed by a flat lamp where a cap with the share f of its surface was.
///
/// Every part of the wall lights every other equally. With a black lamp L = ρ f/(1 − ρ(1 − f)); with one that
/// reflects ρ too (and sees nothing but wall) L = ρ f/((1 − ρ)(1 + ρ f)).
fn integrating_sphere() -> Vec<Law> {
    let (f, radius) = (0.1f64, 1.0);
    let row = |(albedo, shines_back): (f64, bool)| {
        let mut world = World::builder(probe(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.9, -0.3, 0.1)));
        let wall = world.material(Material::diffuse(stored(gray(albedo))));
        let lamp = if shines_back { wall } else { world.material(black()) };
        // A cap of height 2 r f has the share f; the wall behind the lamp stays dark.
        let (h, rim) = (1.0 - 2.0 * f, (1.0 - (1.0 - 2.0 * f) * (1.0 - 2.0 * f)).sqrt());
        world.shape(Sphere { radius }, at(DVec3::ZERO), wall, None);
        world.shape(Disk { radius: rim }, facing(DVec3::Y * h, -DVec3::Y), lamp, glow(1.0));
        let radiance =
            if shines_back { albedo * f / ((1.0 - albedo) * (1.0 + albedo * f)) } else { albedo * f / (1.0 - albedo * (1.0 - f)) };
        Law::new(format!("W14, albedo {albedo}, reflecting lamp {shines_back}"), world, radiance, Depth { max: 500, roulette: 4 })
            .resolution(2e-3, 6e-3)
            .by_chance(1.5e-2)
    };
    [(0.5, false), (0.5, true), (0.9, false), (0.9, true)].map(row).into()
}

#[test]
fn furnace_is_uniform() {
    confirm(furnace(), Effort::Quick);
}

#[test]
fn roulette_keeps_the_mean() {
    confirm(roulette(), Effort::Quick);
}

#[test]
fn depth_counts_scattering_events() {
    confirm(depth(), Effort::Quick);
}

#[test]
fn point_lights() {
    confirm(point_in_sphere(), Effort::Quick);
    confirm(point_above_floor(), Effort::Quick);
}

#[test]
fn sphere_lights() {
    confirm(sphere_light(), Effort::Quick);
    confirm(cut_sphere_light(), Effort::Quick);
}

#[test]
fn flat_lights() {
    confirm(disk_light(), Effort::Quick);
    confirm(square_light(), Effort::Quick);
}

#[test]
fn perfect_mirrors_lose_no_light() {
    confirm(mirror_tube(), Effort::Quick);
}

#[test]
fn integrating_spheres() {
    confirm(integrating_sphere(), Effort::Quick);
}

#[test]
#[ignore = "minutes: all of the above at full resolution"]
fn full_resolution() {
    let laws = [
        furnace(),
        roulette(),
        depth(),
        point_in_sphere(),
        point_above_floor(),
        sphere_light(),
        cut_sphere_light(),
        disk_light(),
        square_light(),
        mirror_tube(),
        integrating_sphere(),
    ];
    confirm(laws.into_iter().flatten().collect(), Effort::Full);
}
