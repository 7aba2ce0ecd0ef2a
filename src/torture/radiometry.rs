//! Scenes whose radiance is known by formula: every integrator that simulates all of their effects must find it.
//!
//! E: irradiance [W·m⁻²]; a white matte surface shows L = E/π.

use std::f64::consts::PI;

use crate::bsdf::{Material, TransportMode};
use crate::light::{Environment, Light, Point};
use crate::math::{Ray, Rgb};
use crate::output::tonemap;
use crate::scene::Scene;
use crate::shape::{Disk, Quad, Sphere, TriangleMesh};
use crate::world::{World, WorldBuilder};
use glam::{DVec3, Vec3};

use super::meshes::mesh;
use super::radiance::{Depth, KnownRadiance, at, black, facing, glow, gray, probe, room, stored, two_sided};
use super::{Row, lights};

/// The rows.
pub fn rows() -> Vec<Row> {
    const REASON: &str = "confidence interval of the mean; 1 % of false alarms over all cases";
    let row = |id, what, scenes: Vec<KnownRadiance>| scenes.into_iter().fold(Row::new(id, what, REASON), Row::radiance);
    vec![
        row("W1", "closed rooms that glow and reflect: L = Le/(1 - albedo)", furnace().into_iter().chain(roulette()).collect()),
        row("W2", "the same with a limited depth", depth()),
        row("W3", "point light in a sphere: L = 1", point_in_sphere()).peers("pbrt: within 2.5 %"),
        row("W4", "point light above a floor: E = I h/(h² + x²)^1.5", point_above_floor()),
        row("W5", "spherical light: E = pi L (r/d)² cos", sphere_light()),
        row("W6", "spherical light cut by the horizon", cut_sphere_light()),
        row("W7", "disk overhead: E = pi/(1 + h²)", disk_light()),
        row("W8", "square overhead, by Lambert's formula", square_light()),
        row("W9", "wall beside a floor", wall_light()),
        row("W10", "oblique triangle", triangle_light()),
        row("W13", "two plates that close a tube of mirrors", mirror_tube()),
        row("W14", "integrating sphere", integrating_sphere()),
        row("W15", "white floor under a uniform sky: L = 1", uniform_sky()),
        lights::sun(),
        lights::bright_pixel(),
        encoding(),
        mirrors(),
    ]
}

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
fn furnace() -> Vec<KnownRadiance> {
    let row = |(albedo, depth): (f64, u32)| {
        let boxed = KnownRadiance::new(format!("box, albedo {albedo}"), glowing_box(albedo), terms(albedo, depth), Depth::exactly(depth));
        let round =
            KnownRadiance::new(format!("sphere, albedo {albedo}"), glowing_sphere(albedo), terms(albedo, depth), Depth::exactly(depth));
        [boxed, round].map(|law| law.resolution(1e-3, 2e-3).by_chance(1e-3))
    };
    [(0.2, 10), (0.5, 20), (0.8, 60), (0.9, 100), (0.99, 300)].into_iter().flat_map(row).collect()
}

/// W1 with the default Russian roulette, which must not change the mean.
fn roulette() -> Vec<KnownRadiance> {
    let law = |(albedo, max): (f64, u32)| {
        let law =
            KnownRadiance::new(format!("roulette, albedo {albedo}"), glowing_box(albedo), terms(albedo, max), Depth { max, roulette: 4 });
        law.resolution(1e-3, 6e-3).by_chance(6e-3)
    };
    [(0.2, 64), (0.5, 64), (0.8, 64), (0.9, 64)]
        .into_iter()
        .map(law)
        .chain([law((0.99, 300)).resolution(1e-3, 2e-2).by_chance(2e-2)])
        .collect()
}

/// W2: meaning of `max_depth`. 0 is emission, 1 is direct light, and each further step adds a reflection.
fn depth() -> Vec<KnownRadiance> {
    let row = |albedo: f64| {
        [0, 1, 2, 8].map(|depth| {
            let name = format!("depth {depth}, albedo {albedo}");
            let law = KnownRadiance::new(name, glowing_box(albedo), terms(albedo, depth), Depth::exactly(depth))
                .resolution(1e-3, 2e-3)
                .by_chance(1e-3);
            // Without weights, light samples near an edge of the box have too large a variance.
            law.not_by_lights_alone()
        })
    };
    [0.2, 0.5, 0.8, 0.9, 0.99].into_iter().flat_map(row).collect()
}

/// W3. A point light I = π in the middle of a unit sphere: L = ρ I / (π r² (1 − ρ)) = 1 for ρ = ½.
fn point_in_sphere() -> Vec<KnownRadiance> {
    let mut world = World::builder(probe(DVec3::new(0.3, -0.2, 0.4), DVec3::new(0.9, 0.4, 0.1)));
    let wall = world.material(Material::diffuse(stored(gray(0.5))));
    world.shape(Sphere { radius: 1.0 }, at(DVec3::ZERO), wall, None);
    world.light(Light::Point(Point { position: DVec3::ZERO, intensity: stored(gray(PI)) }));
    vec![KnownRadiance::new("albedo 0.5", world, 1.0, DEFAULT).resolution(1e-3, 2e-3)]
}

/// W4. A point light I = 10 at height h = 2: E = I h/(h² + x²)^(3/2), without any noise.
fn point_above_floor() -> Vec<KnownRadiance> {
    let law = |x: f64| {
        let spot = DVec3::new(x, 0.0, 0.0);
        let mut world = World::builder(probe(spot + DVec3::new(0.5, 1.0, 0.5), spot));
        let floor = world.material(Material::diffuse(stored(gray(0.5))));
        world.shape(Quad { size: [40.0, 40.0] }, facing(DVec3::ZERO, DVec3::Y), floor, None);
        world.light(Light::Point(Point { position: DVec3::Y * 2.0, intensity: stored(gray(10.0)) }));
        let irradiance = 20.0 / (4.0 + x * x).powf(1.5);
        KnownRadiance::new(format!("x = {x}"), world, 0.5 * irradiance / PI, Depth::exactly(1)).resolution(1e-5, 1e-5)
    };
    [0.0, 1.0, 2.0, 10.0].map(law).into()
}

/// Directions from which a scene is built: towards one side, and up.
type Axes = [DVec3; 2];

/// As the scenes of this table stand.
const UPRIGHT: Axes = [DVec3::X, DVec3::Y];

/// A small white tile at the origin whose normal is `degrees` away from the direction of the light, up; seen from the far side.
fn tile(scale: f64, degrees: f64) -> WorldBuilder {
    turned_tile(scale, degrees, UPRIGHT)
}

fn turned_tile(scale: f64, degrees: f64, [aside, up]: Axes) -> WorldBuilder {
    let away = |degrees: f64| aside * degrees.to_radians().sin() + up * degrees.to_radians().cos();
    let mut world = World::builder(probe(away(degrees + 60.0) * (0.01 * scale), DVec3::ZERO));
    let white = world.material(Material::diffuse(stored(gray(1.0))));
    world.shape(Quad { size: [0.005 * scale; 2] }, facing(DVec3::ZERO, away(degrees)), white, None);
    world
}

fn under_sphere(radius: f64, distance: f64, degrees: f64, axes: Axes) -> WorldBuilder {
    let mut world = turned_tile(distance, degrees, axes);
    let dark = world.material(black());
    world.shape(Sphere { radius }, at(axes[1] * distance), dark, glow(1.0));
    world
}

/// The radiance of a tile under a spherical light that the horizon cuts, with its axes permuted and mirrored; row W6 has the formula.
pub(super) fn permuted() -> Vec<KnownRadiance> {
    let axes = [0, 1, 2].into_iter().flat_map(|a| [1, 2].map(|b| [DVec3::AXES[a], DVec3::AXES[(a + b) % 3]]));
    let signs = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0]];
    let scene = |[aside, up]: Axes| {
        let name = format!("beside {aside}, above {up}");
        let world = under_sphere(1.0, 2.0, 80.0, [aside, up]);
        KnownRadiance::new(name, world, 0.1718319751 / PI, Depth::exactly(1)).resolution(2e-3, 5e-3)
    };
    axes.flat_map(|[a, b]| signs.map(|[x, y]| [a * x, b * y])).map(scene).collect()
}

/// W5. A spherical light wholly above the horizon: E = π L (r/d)² cos θ.
fn sphere_light() -> Vec<KnownRadiance> {
    let row = |(r, d, degrees, chance): (f64, f64, f64, Option<f64>)| {
        let radiance = (r / d).powi(2) * degrees.to_radians().cos();
        let law =
            KnownRadiance::new(format!("r {r}, d {d}, {degrees}°"), under_sphere(r, d, degrees, UPRIGHT), radiance, Depth::exactly(1));
        KnownRadiance { by_chance: chance, ..law }.resolution(1e-3, 2e-3)
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
fn cut_sphere_light() -> Vec<KnownRadiance> {
    let row = |(r, d, degrees, irradiance, chance): (f64, f64, f64, f64, Option<f64>)| {
        assert!((cut_sphere(d / r, degrees) - irradiance).abs() < 1e-9, "{}", cut_sphere(d / r, degrees));
        let law = KnownRadiance::new(
            format!("r {r}, d {d}, {degrees}°"),
            under_sphere(r, d, degrees, UPRIGHT),
            irradiance / PI,
            Depth::exactly(1),
        );
        KnownRadiance { by_chance: chance, ..law }.resolution(2e-3, 5e-3)
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
fn disk_light() -> Vec<KnownRadiance> {
    let row = |(h, chance, lights_alone): (f64, Option<f64>, bool)| {
        let mut world = tile(h, 0.0);
        let dark = world.material(black());
        world.shape(Disk { radius: 1.0 }, facing(DVec3::Y * h, -DVec3::Y), dark, glow(1.0));
        let law = KnownRadiance::new(format!("h {h}"), world, 1.0 / (1.0 + h * h), Depth::exactly(1));
        KnownRadiance { by_chance: chance, lights_alone, ..law }.resolution(1e-3, 2e-3)
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
fn square_light() -> Vec<KnownRadiance> {
    let row = |(edge, h, irradiance, chance, lights_alone): (f64, f64, f64, Option<f64>, bool)| {
        assert!((square(edge, h) / irradiance - 1.0).abs() < 1e-8, "{}", square(edge, h));
        let mut world = tile(h, 0.0);
        let dark = world.material(black());
        world.shape(Quad { size: [edge; 2] }, facing(DVec3::Y * h, -DVec3::Y), dark, glow(1.0));
        let law = KnownRadiance::new(format!("w {edge}, h {h}"), world, irradiance / PI, Depth::exactly(1));
        KnownRadiance { by_chance: chance, lights_alone, ..law }.resolution(1e-3, 2e-3)
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
fn mirror_tube() -> Vec<KnownRadiance> {
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
        KnownRadiance::new(format!("plate at z = {side}"), world, radiance, Depth { max: 1000, roulette: 4 })
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
fn integrating_sphere() -> Vec<KnownRadiance> {
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
        KnownRadiance::new(format!("albedo {albedo}, reflecting lamp {shines_back}"), world, radiance, Depth { max: 500, roulette: 4 })
            .resolution(2e-3, 6e-3)
            .by_chance(1.5e-2)
    };
    [(0.5, false), (0.5, true), (0.9, false), (0.9, true)].map(row).into()
}

/// W9. A wall at x = 1, from −1 to 1 across and from the floor to a height of 2: E = ½ Σ θᵢ (nᵢ·n), Lambert's formula.
fn wall_light() -> Vec<KnownRadiance> {
    let mut world = tile(1.0, 0.0);
    let dark = world.material(black());
    world.shape(Quad { size: [2.0; 2] }, facing(DVec3::new(1.0, 1.0, 0.0), -DVec3::X), dark, glow(1.0));
    vec![KnownRadiance::new("2 by 2 at 1", world, 0.5973294913 / PI, Depth::exactly(1)).resolution(1e-3, 2e-3).by_chance(1e-2)]
}

/// W10. A triangle with its corners at the heights 1, 1 and 2.
fn triangle_light() -> Vec<KnownRadiance> {
    let mut world = tile(1.0, 0.0);
    let dark = world.material(black());
    let corners = vec![Vec3::new(1.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 1.0), Vec3::new(-1.0, 2.0, -1.0)];
    world.shape(TriangleMesh::new(mesh(corners, vec![[0, 1, 2]])), at(DVec3::ZERO), dark, two_sided(1.0));
    vec![KnownRadiance::new("heights 1, 1, 2", world, 0.6876173887 / PI, Depth::exactly(1)).resolution(1e-3, 2e-3).by_chance(1e-2)]
}

/// W15. E = π L.
fn uniform_sky() -> Vec<KnownRadiance> {
    let mut world = tile(1.0, 0.0);
    world.light(Light::Environment(Environment { radiance: Rgb::WHITE }));
    vec![KnownRadiance::new("albedo 1", world, 1.0, Depth::exactly(1)).by_chance(1e-3)]
}

/// W18. The transfer function of sRGB.
fn encoding() -> Row {
    Row::new("W18", "sRGB value of a linear one", "one rounding to f32, and that of the input")
        .number(".18", 0.4613561295, 1e-6, || tonemap::srgb(0.18).into())
        .number(".002, on the straight part", 0.02584, 1e-7, || tonemap::srgb(0.002).into())
        .number(".5", 0.7353569831, 1e-6, || tonemap::srgb(0.5).into())
}

/// W20. Between two parallel mirrors of reflectance ρ, k reflections leave ρ^k.
fn mirrors() -> Row {
    let row = Row::new("W20", "light left between two mirrors of .9, over .9^k", "1e-4: 200 roundings");
    [1, 10, 50, 200].into_iter().fold(row, |row, count| {
        row.number(format!("k = {count}"), 1.0, 1e-4, move || {
            let mut world = World::builder(probe(DVec3::new(0.3, 0.2, 0.0), DVec3::Z));
            let mirror = world.material(Material::mirror(stored(gray(0.9))));
            for side in [-1.0, 1.0] {
                world.shape(Quad { size: [4.0; 2] }, facing(DVec3::Z * side, DVec3::Z * -side), mirror, None);
            }
            let scene = world.build().expect("two mirrors");
            let mut ray = Ray::new(Vec3::new(0.3, 0.2, 0.0), Vec3::Z);
            let mut left = 1.0;
            for _ in 0..count {
                let Some(hit) = scene.intersect(&ray) else { return f64::NAN };
                let surface = scene.surface(&ray, &hit);
                let Some((wi, sample)) = surface.delta_lobes(-ray.direction, TransportMode::Radiance).next() else { return f64::NAN };
                left *= f64::from(sample.weight.average());
                ray = surface.spawn(wi, 0.0);
            }
            left / 0.9f64.powi(count)
        })
    })
}
