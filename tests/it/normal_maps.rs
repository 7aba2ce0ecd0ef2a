//! Normal-mapped surfaces compared with quadrature in f64, by formulas that share no code with `src/`.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::{DVec2, DVec3, UVec2, Vec2};
use pt::bsdf::{Material, NormalModifier, SurfaceMaterial, TransportMode};
use pt::camera::{Camera, Perspective, Pose};
use pt::light::{Directional, Environment, Light};
use pt::math::{Ray, Transform};
use pt::scene::Scene;
use pt::shape::Quad;
use pt::texture::image::{Filter, Pixels, Wrap};
use pt::texture::{Image, Texture};
use pt::world::{World, WorldBuilder};

use crate::random::Random;
use crate::scenes::{Depth, Effort, KnownRadiance, black, confirm, facing, glow, gray, stored};

const ALBEDO: f64 = 0.5;
/// Edge of the quad, which is centred at the origin (m).
const SIDE: f64 = 4.0;
/// Pixels along an edge of the picture of normals.
const TEXELS: usize = 4;
/// Repetitions of that picture along an edge of the quad.
const REPEATS: f64 = 3.0;

const EYE: DVec3 = DVec3::new(0.2, -1.2, 0.7);
const FOV: f64 = 30.0;

/// Direction towards the sun.
const SUN: DVec3 = DVec3::new(0.48, 0.6, 0.64);
const LAMP: DVec3 = DVec3::new(-1.2, 1.0, 0.9);
const LAMP_SIDE: f64 = 0.6;

/// Normals of eight-bit pixels, row by row from the top: randomly tilted, with `last` as one of them.
fn normals(last: DVec3) -> Vec<DVec3> {
    let mut random = Random::new(19);
    let mut leaning = |_| {
        let (tilt, turn) = (random.range(0.0, 1.2), random.range(0.0, 2.0 * PI));
        DVec3::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos())
    };
    let all = (1..TEXELS * TEXELS).map(&mut leaning).collect::<Vec<_>>().into_iter().chain([last]);
    all.map(|n| ((0.5 * n + 0.5) * 255.0).round() / 255.0).collect()
}

/// The mapped normal at a point of the quad, not normalized: pixels interpolated between their centres, repeated.
fn mapped(pixels: &[DVec3], p: DVec2) -> DVec3 {
    let uv = (p / SIDE + 0.5) * REPEATS;
    let place = DVec2::new(uv.x, 1.0 - uv.y) * TEXELS as f64 - 0.5;
    let (corner, part) = (place.floor(), place - place.floor());
    let pixel = |x: f64, y: f64| pixels[y.rem_euclid(TEXELS as f64) as usize * TEXELS + x.rem_euclid(TEXELS as f64) as usize];
    let row = |y: f64| pixel(corner.x, y).lerp(pixel(corner.x + 1.0, y), part.x);
    2.0 * row(corner.y).lerp(row(corner.y + 1.0), part.y) - 1.0
}

/// The normal `n`, rotated towards `w` until the cosine between them is about 1/64, if it is less.
fn turned(n: DVec3, w: DVec3) -> DVec3 {
    let short = (1.0 / 64.0 - n.dot(w)).max(0.0);
    (n + w * short).normalize()
}

/// Illumination of the plane.
#[derive(Clone, Copy, Debug)]
enum Lit {
    /// A sky of radiance 1: the reflected radiance is ρ (1 + cos β)/2, with β between the normal and z. There is no light from below the
    /// plane.
    Sky,
    /// Parallel light of irradiance π perpendicular to it: ρ n·l.
    Sun,
    /// A lamp of radiance 1 that faces down: ρ/π ∫ (n·l)⁺ l_z/d² dA.
    Lamp,
}

impl Lit {
    fn radiance(self, p: DVec3, n: DVec3) -> f64 {
        match self {
            Lit::Sky => ALBEDO * 0.5 * (1.0 + n.z),
            Lit::Sun => ALBEDO * n.dot(SUN).max(0.0),
            Lit::Lamp => {
                const STEPS: i32 = 16;
                let cell = LAMP_SIDE / f64::from(STEPS);
                let along = |i: i32| (f64::from(i) + 0.5) * cell - 0.5 * LAMP_SIDE;
                let piece = |i: i32| {
                    let way = LAMP + DVec3::new(along(i % STEPS), along(i / STEPS), 0.0) - p;
                    way.dot(n).max(0.0) * way.z / way.length_squared().powi(2)
                };
                ALBEDO * FRAC_1_PI * (0..STEPS * STEPS).map(piece).sum::<f64>() * cell * cell
            }
        }
    }

    /// Mean radiance of the picture, by the midpoint rule.
    fn mean(self, shade: impl Fn(DVec2, DVec3) -> DVec3) -> f64 {
        const EDGE: i32 = 192;
        let back = EYE.normalize();
        let right = DVec3::Z.cross(back).normalize();
        let up = back.cross(right);
        let reach = (0.5 * FOV).to_radians().tan();
        let at = |k: i32| (2.0 * (f64::from(k) + 0.5) / f64::from(EDGE) - 1.0) * reach;
        let seen = |k: i32| {
            let ray = (right * at(k % EDGE) + up * at(k / EDGE) - back).normalize();
            let p = EYE - ray * (EYE.z / ray.z);
            self.radiance(p, shade(p.truncate(), -ray))
        };
        (0..EDGE * EDGE).map(seen).sum::<f64>() / f64::from(EDGE * EDGE)
    }

    fn add_to(self, world: &mut WorldBuilder) {
        match self {
            Lit::Sky => world.light(Light::Environment(Environment { radiance: stored(gray(1.0)) })),
            Lit::Sun => world.light(Light::Directional(Directional { direction: -SUN.as_vec3(), irradiance: stored(gray(PI)) })),
            Lit::Lamp => {
                let dark = world.material(black());
                world.shape(Quad { size: [LAMP_SIDE; 2] }, facing(LAMP, -DVec3::Z), dark, glow(1.0));
            }
        }
    }
}

fn plane(pixels: &[DVec3], lit: Lit) -> WorldBuilder {
    let pose = Transform::look_at(EYE, DVec3::ZERO, DVec3::Z).expect("not straight down");
    let mut world = World::builder(Camera::Perspective(Perspective::new(Pose::new(&pose), FOV, 0.0, 1.0)));
    let values = pixels.iter().map(|n| n.as_vec3().to_array()).collect();
    let pixels = Pixels::new(UVec2::splat(TEXELS as u32), values).expect("as many as the size says");
    let scale = Vec2::splat(REPEATS as f32);
    let map = Texture::Image(Image { pixels: Arc::new(pixels), pyramid: None, scale, wrap: Wrap::Repeat, filter: Filter::Bilinear });
    let normal_modifier = Some(NormalModifier::NormalMap { map, strength: 1.0.into() });
    let material = world.material(SurfaceMaterial { normal_modifier, ..Material::diffuse(stored(gray(ALBEDO))).into() });
    world.shape(Quad { size: [SIDE; 2] }, Transform::IDENTITY, material, None);
    lit.add_to(&mut world);
    world
}

/// The mapped normal, rotated until it is above the plane and then until it faces the eye.
fn seen(pixels: &[DVec3], p: DVec2, wo: DVec3) -> DVec3 {
    turned(turned(mapped(pixels, p).normalize(), DVec3::Z), wo)
}

/// Normal maps with a normal near the plane, and with one that points below the plane.
fn maps() -> [(&'static str, Vec<DVec3>); 2] {
    [("grazing", DVec3::new(0.8, -0.6, 0.004)), ("below", DVec3::new(0.64, -0.48, -0.6))].map(|(name, last)| (name, normals(last)))
}

/// At each point, a diffuse plane in sunlight reflects ρ (n·l)⁺/π, with the normals of its map.
///
/// The tolerance is a few roundings of the cosine, and of the position in the picture, where normals change by some 100 rad/m.
#[test]
fn mapped_planes_have_the_normals_of_their_map() {
    let mut random = Random::new(23);
    for (name, pixels) in maps() {
        let world = plane(&pixels, Lit::Sun).build().expect("a plane");
        for _ in 0..20_000 {
            let p = DVec2::new(random.range(-1.9, 1.9), random.range(-1.9, 1.9));
            let ray = (p.extend(0.0) - EYE).normalize();
            let ray = Ray::new((EYE - world.origin()).as_vec3(), ray.as_vec3());
            let surface = world.surface(&ray, &world.intersect(&ray).expect("the plane"));
            let found = surface.eval(-ray.direction, SUN.as_vec3(), TransportMode::Radiance).average();
            let expected = Lit::Sun.radiance(p.extend(0.0), seen(&pixels, p, -ray.direction.as_dvec3())) / PI;
            assert!((f64::from(found) - expected).abs() < 1e-4, "{name}, at {p}: {found}, expected {expected}");
        }
    }
}

/// The picture of a diffuse plane with a normal map equals the quadrature, with a sky, the sun and a lamp. The quadrature has an error of
/// 10⁻⁴.
///
/// If normals were not rotated towards the viewer, the result for the sky and the sun would be off by 1 to 2 parts in 1000.
#[test]
fn mapped_planes_are_lit_as_by_quadrature() {
    let mut laws = vec![];
    for (name, pixels) in maps() {
        for (lit, resolution) in [(Lit::Sky, 2e-3), (Lit::Sun, 2e-3), (Lit::Lamp, 8e-3)] {
            let expected = lit.mean(|p, wo| seen(&pixels, p, wo));
            let law = KnownRadiance::new(format!("{name}, {lit:?}"), plane(&pixels, lit), expected, Depth::exactly(1));
            laws.push(law.resolution(5e-4, resolution));
        }
    }
    confirm(laws, Effort::Standard);
}
