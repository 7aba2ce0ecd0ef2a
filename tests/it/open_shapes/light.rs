//! Lamps of these shapes: what they bring, by every integrator.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use pt::accel;
use pt::bsdf::Material;
use pt::math::{Ray, Transform};
use pt::shape::{PartialDisk, PartialSphere, Quad};
use pt::torture::meshes::shapes;
use pt::world::{World, WorldBuilder};

use super::{Kind, kinds, skewed};
use crate::random::Random;
use crate::scenes::{Depth, Effort, KnownRadiance, at, black, confirm, facing, glow, gray, probe, stored, two_sided};

const DIRECT: Depth = Depth { max: 1, roulette: u32::MAX };

/// White tile at the origin that faces +y, seen from near by.
fn tile() -> WorldBuilder {
    let mut world = World::builder(probe(DVec3::new(3f64.sqrt(), 1.0, 0.0) * 0.002, DVec3::ZERO));
    let white = world.material(Material::diffuse(stored(gray(1.0))));
    world.shape(Quad { size: [0.002; 2] }, facing(DVec3::ZERO, DVec3::Y), white, None);
    world
}

/// Irradiance on the tile from a lamp of radiance 1: the sum of cos θ cos θ′ dA / d² over the triangles of a fine mesh of it, as far as the
/// mesh does not hide them.
fn irradiance(kind: &Kind, place: &Transform, two_sided: bool) -> f64 {
    let hierarchy = accel::build(shapes(vec![kind.mesh(place, 256)]));
    let of_a_triangle = |[a, b, c]: [DVec3; 3]| {
        let (middle, normal) = ((a + b + c) / 3.0, 0.5 * (b - a).cross(c - a));
        let (d2, w) = (middle.length_squared(), middle.normalize());
        let facing = -normal.dot(w);
        let ray = Ray::new(Vec3::ZERO, w.as_vec3());
        let is_visible = hierarchy.intersect(&ray).is_none_or(|hit| f64::from(hit.t) > middle.length() * (1.0 - 1e-3));
        let seen = if two_sided { facing.abs() } else { facing.max(0.0) };
        if is_visible { seen * w.y.max(0.0) / d2 } else { 0.0 }
    };
    kind.triangles(place, 256).into_iter().map(of_a_triangle).sum()
}

/// A lamp of each shape, stretched, sheared and mirrored, on one side and on both, lights a tile as a fine mesh of it would, by all
/// integrators: those that sample lamps, those that hit them by chance, and those that do both.
///
/// The sums over triangles have errors below 10⁻³: outlines and shadows end within cells of 1/256.
#[test]
fn lamps_light_what_a_fine_mesh_of_them_would() {
    lamps_light_what_a_fine_mesh_would(Effort::Standard);
}

#[test]
#[ignore = "minutes: to 0.2 %"]
fn lamps_light_what_a_fine_mesh_would_to_two_per_mille() {
    lamps_light_what_a_fine_mesh_would(Effort::Full);
}

fn lamps_light_what_a_fine_mesh_would(effort: Effort) {
    let mut laws = vec![];
    for (k, kind) in kinds().into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        for sides in [1, 2] {
            let place =
                skewed(&mut random).then(&Transform::scale(DVec3::splat(0.6)).expect("not zero")).then(&at(DVec3::new(0.2, 1.4, -0.1)));
            let expected = irradiance(&kind, &place, sides == 2) / PI;
            // From where almost nothing of the bright side is seen there is nothing to measure.
            if expected < 0.03 {
                continue;
            }
            let mut world = tile();
            let dark = world.material(black());
            let emitter = if sides == 2 { two_sided(1.0) } else { glow(1.0) };
            let name = format!("{}, {sides} sides", kind.name);
            world.shape(kind.geometry.clone(), place, dark, emitter);
            laws.push(KnownRadiance::new(name, world, expected, DIRECT).resolution(2e-3, 1.2e-2).by_chance(4e-2));
        }
    }
    assert!(laws.len() >= 12, "{} lamps are seen", laws.len());
    confirm(laws, effort);
}

/// Lamps with a formula: a ring above the tile has the irradiance π (R²/(R² + h²) − r²/(r² + h²)), of which half a turn gives half, and a
/// dome around it whose rim is at the angle θ from the vertical π sin² θ.
#[test]
fn rings_and_domes_light_by_their_formulas() {
    let share = |r: f64, h: f64| r * r / (r * r + h * h);
    let ring = |inner_radius: f64, phi_max: f64, h: f64| {
        let mut world = tile();
        let dark = world.material(black());
        let ring = PartialDisk { radius: 1.0, inner_radius, phi_max };
        world.shape(ring, facing(DVec3::Y * h, -DVec3::Y), dark, glow(1.0));
        let expected = (share(1.0, h) - share(inner_radius, h)) * phi_max / 360.0;
        KnownRadiance::new(format!("ring {inner_radius} {phi_max}° at {h}"), world, expected, DIRECT).resolution(1e-3, 2e-3).by_chance(1e-2)
    };
    let dome = |height: f64, phi_max: f64| {
        let mut world = tile();
        let dark = world.material(black());
        let dome = PartialSphere { radius: 2.0, z: [height, 2.0], phi_max };
        world.shape(dome, facing(DVec3::ZERO, DVec3::Y), dark, two_sided(1.0));
        let expected = (1.0 - (height / 2.0).powi(2)) * phi_max / 360.0;
        KnownRadiance::new(format!("dome from {height}, {phi_max}°"), world, expected, DIRECT).resolution(1e-3, 2e-3).by_chance(1e-2)
    };
    let rings = [ring(0.5, 360.0, 0.7), ring(0.0, 180.0, 1.0), ring(0.5, 90.0, 0.5), ring(0.2, 270.0, 4.0)];
    let domes = [dome(0.5, 360.0), dome(1.0, 100.0), dome(1.9, 360.0), dome(0.0, 250.0)];
    confirm(rings.into_iter().chain(domes).collect(), Effort::Standard);
}
