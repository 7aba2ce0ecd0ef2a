//! Glass: the direction and amount of refracted light, and how typical mistakes would look.

mod distances;
pub mod faults;
mod open_bodies;
mod touching;

use std::sync::Arc;

use glam::{DVec3, Vec3};
use pt::bsdf::{Material, textured};
use pt::camera::{Camera, Perspective, Pose};
use pt::film::FilmSpec;
use pt::integrators::ALL;
use pt::light::{Environment, Light};
use pt::math::{Ray, Transform};
use pt::sampler::SamplerSpec;
use pt::scene::Scene;
use pt::shape::{Quad, Sphere, TriangleMesh};
use pt::torture::glass::{before_lamp, no_camera, pane, passed, reflectance, slanting, through};
use pt::torture::meshes::block;
use pt::world::World;

use crate::scenes::{Depth, Effort, KnownRadiance, at, black, confirm, facing, glow, gray, integrator, picture, probe, stored, two_sided};

/// The integrator with its default options.
const DEFAULT: Depth = Depth { max: 64, roulette: 4 };

/// A lamp seen from within glass: n²(1 − R), compressed into a narrower cone, where R is the reflectance from inside.
fn lamp_from_within() -> Vec<KnownRadiance> {
    let table = [(10.0, 0.0400829592), (30.0, 0.0551901673), (40.0, 0.2452912043), (41.0, 0.3797512660)];
    let law = |(degrees, r): (f64, f64)| {
        let mut world = before_lamp(degrees);
        let glass = world.material(Material::glass(1.5));
        world.shape(Quad { size: [100.0; 2] }, facing(DVec3::ZERO, -DVec3::Z), glass, None);
        KnownRadiance::new(format!("from within, {degrees}°"), world, 2.25 * (1.0 - r), DEFAULT).resolution(1e-3, 6e-3)
    };
    table.map(law).into()
}

/// A pane of index 1.7 whose faces multiply all light by c = .8, seen at 52° against a lamp on one side of it.
///
/// With F of one face: T = c² (1 − F)² / (1 − c² F²) with the lamp behind, R = c F (1 + T) with the lamp in front.
fn colored_pane() -> Vec<KnownRadiance> {
    const COLOR: f64 = 0.8;
    let (theta, once) = (52f64.to_radians(), reflectance(52.0, 1.7));
    let transmitted = (COLOR * (1.0 - once)).powi(2) / (1.0 - (COLOR * once).powi(2));
    let law = |(lamp, radiance): (f64, f64)| {
        let mut world = World::builder(probe(DVec3::new(-theta.sin(), 0.0, theta.cos()) * 2.0, DVec3::ZERO));
        let dark = world.material(black());
        world.shape(Quad { size: [4000.0; 2] }, facing(DVec3::Z * lamp, -DVec3::Z * lamp), dark, glow(1.0));
        let glass = world.material(Material::from(textured::Dielectric::smooth(1.7, stored(gray(COLOR)))));
        pane(&mut world, glass, DVec3::ZERO, [-0.001, 0.001], 100.0);
        KnownRadiance::new(format!("lamp at {lamp} m"), world, radiance, DEFAULT).resolution(1e-3, 3e-3)
    };
    vec![law((-4.0, transmitted)), law((4.0, COLOR * once * (1.0 + transmitted)))]
}

#[test]
fn the_color_of_glass_dims_reflections_too() {
    confirm(colored_pane(), Effort::Standard);
}

#[test]
fn lamps_seen_from_within_glass() {
    confirm(lamp_from_within(), Effort::Standard);
}

#[test]
#[ignore = "minutes: all of the above at full resolution"]
fn full_resolution() {
    confirm(lamp_from_within(), Effort::Full);
}

/// At and beyond the critical angle, 41.81°, exactly all light is reflected.
#[test]
fn reflection_is_total() {
    for degrees in [41.82, 45.0, 60.0, 80.0, 89.0] {
        for (lamp_behind, radiance) in [(false, 0.0), (true, 1.0)] {
            let from = DVec3::new(-f64::to_radians(degrees).sin(), 0.0, f64::to_radians(degrees).cos());
            let mut world = World::builder(probe(from * 2.0, DVec3::ZERO));
            let (dark, glass) = (world.material(black()), world.material(Material::glass(1.5)));
            let z = if lamp_behind { 4.0 } else { -1.0 };
            world.shape(Quad { size: [4000.0; 2] }, facing(DVec3::Z * z, -DVec3::Z * f64::signum(z)), dark, glow(1.0));
            world.shape(Quad { size: [100.0; 2] }, facing(DVec3::ZERO, -DVec3::Z), glass, None);
            let scene = Arc::new(world.build().unwrap());
            for entry in ALL {
                let Some(integrator) = integrator(entry, DEFAULT) else { continue };
                let mean = crate::scenes::measure(scene.clone(), &*integrator, 4096, 1);
                assert_eq!((mean.value, mean.variance), (radiance, 0.0), "{degrees}° by {}", entry.name);
            }
        }
    }
}

/// A body with η = 1 is invisible: the picture is the same, bit for bit, with and without it.
///
/// The picture shows lamps and their mirror images, so that the only random number is the position in the pixel.
#[test]
fn index_of_one_is_invisible() {
    let scene = |with: bool| {
        let pose = Pose::new(&Transform::look_at(DVec3::new(0.3, 0.4, 6.0), DVec3::ZERO, DVec3::Y).unwrap());
        let mut world = World::builder(Camera::Perspective(Perspective::new(pose, 50.0, 0.0, 1.0)));
        let (dark, mirror, nothing) =
            (world.material(black()), world.material(Material::mirror(stored(gray(0.9)))), world.material(Material::glass(1.0)));
        for k in 0..12 {
            let place = DVec3::new(f64::from(k % 4) - 1.5, f64::from(k / 4) - 1.0, -3.0 + 0.1 * f64::from(k));
            world.shape(
                Quad { size: [0.7, 0.5] },
                facing(place, DVec3::new(0.1 * f64::from(k), 0.3, 1.0)),
                dark,
                two_sided(1.0 + f64::from(k)),
            );
        }
        world.shape(Quad { size: [8.0; 2] }, facing(-DVec3::Y * 2.0, DVec3::Y), mirror, None);
        world.shape(Sphere { radius: 0.4 }, at(DVec3::new(0.8, 0.9, 0.2)), mirror, None);
        world.light(Light::Environment(Environment { radiance: stored(gray(0.25)) }));
        // The finest detail, below the floor, so that both scenes have their origin here.
        world.shape(Quad { size: [1e-3; 2] }, facing(-DVec3::Y * 3.0, DVec3::Y), dark, None);
        if with {
            world.shape(Sphere { radius: 1.0 }, at(DVec3::new(-0.5, 0.2, 1.0)), nothing, None);
            world.shape(TriangleMesh::new(block(Vec3::new(0.7, 0.5, 0.3))), at(DVec3::new(1.0, -0.6, 1.5)), nothing, None);
        }
        Arc::new(world.build().unwrap())
    };
    let (with, without) = (scene(true), scene(false));
    assert_eq!(with.origin(), without.origin());
    for entry in ALL {
        let Some(integrator) = integrator(entry, Depth::exactly(64)) else { continue };
        let image = |scene: &Arc<World>| {
            picture(scene.clone(), &*integrator, FilmSpec::new(64, 64), SamplerSpec { spp: 4, ..SamplerSpec::default() })
        };
        assert_eq!(image(&with), image(&without), "{}", entry.name);
    }
}
