//! Lights with extreme sizes and positions, and lights without extent, which no ray can hit.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use pt::bsdf::{Material, textured};
use pt::effects::Effects;
use pt::integrators::ALL;
use pt::light::{Directional, Falloff, Light, LightSample, LightSampleContext, Point, ShadowTarget, Spot};
use pt::math::Transform;
use pt::scene::Scene;
use pt::shape::{Disk, Quad, Sphere, TriangleMesh};
use pt::world::{World, WorldBuilder};

use crate::scenes::{Depth, Effort, KnownRadiance, at, black, confirm, facing, glow, gray, integrator, measure, probe, stored, two_sided};
use pt::torture::meshes::round_mesh;

const DIRECT: Depth = Depth { max: 1, roulette: u32::MAX };

/// White tile at the origin, facing up, seen at 60° from a distance of a hundredth of `scale`.
fn tile(scale: f64) -> WorldBuilder {
    let mut world = World::builder(probe(DVec3::new(3f64.sqrt(), 1.0, 0.0) * (0.005 * scale), DVec3::ZERO));
    let white = world.material(Material::diffuse(stored(gray(1.0))));
    world.shape(Quad { size: [0.005 * scale; 2] }, facing(DVec3::ZERO, DVec3::Y), white, None);
    world
}

/// Lamps that cover from 10⁻⁹ of the sky to all of it give the known irradiance E.
#[test]
fn tiny_far_and_huge_lights() {
    let sphere = |r: f64, d: f64| {
        let mut world = tile(d - r);
        let dark = world.material(black());
        world.shape(Sphere { radius: r }, at(DVec3::Y * d), dark, glow(1.0));
        KnownRadiance::new(format!("sphere, r {r:e}, d {d:e}"), world, (r / d).powi(2), DIRECT).resolution(1e-3, 2e-3)
    };
    let disk = |r: f64, h: f64| {
        let mut world = tile(h);
        let dark = world.material(black());
        world.shape(Disk { radius: r }, facing(DVec3::Y * h, -DVec3::Y), dark, glow(1.0));
        KnownRadiance::new(format!("disk, r {r:e}, h {h:e}"), world, r * r / (r * r + h * h), DIRECT).resolution(1e-3, 2e-3)
    };
    let spheres = [(1e-5, 1.0), (1e-3, 1.0), (1.0, 1e5), (1e3, 1.001e3), (1e6, 1e7), (1e-9, 1e-6)].map(|(r, d)| sphere(r, d));
    let disks = [(1e-5, 1.0), (1.0, 1e4), (1e-9, 1e-7), (1e9, 1e10)].map(|(r, h)| disk(r, h));
    confirm(spheres.into_iter().chain(disks).collect(), Effort::Standard);
    // The lamp covers nearly the whole sky, but samples by area are almost never near.
    let sky = [disk(1e3, 1.0), disk(1e5, 1.0)].map(|law| law.by_chance(1e-3).not_by_lights_alone());
    confirm(sky.into(), Effort::Standard);
}

/// Lamps seen edge-on, below the horizon or from their dark side give exactly no light, and all numbers are finite.
#[test]
fn hidden_lights_contribute_exactly_zero() {
    type Place = fn(&mut WorldBuilder);
    let cases: [(&str, Place); 6] = [
        ("edge-on square", |world| {
            let dark = world.material(black());
            world.shape(Quad { size: [1.0; 2] }, facing(DVec3::X * 2.0, DVec3::Y), dark, two_sided(1.0));
        }),
        ("edge-on disk", |world| {
            let dark = world.material(black());
            world.shape(Disk { radius: 1.0 }, facing(DVec3::Y * 2.0, DVec3::X), dark, two_sided(1.0));
        }),
        ("square behind the horizon", |world| {
            let dark = world.material(black());
            world.shape(Quad { size: [1.0; 2] }, facing(-DVec3::Y, DVec3::Y), dark, glow(1.0));
        }),
        ("mesh behind the horizon", |world| {
            let dark = world.material(black());
            world.shape(TriangleMesh::new(round_mesh(1)), at(-DVec3::Y * 1.5), dark, glow(1.0));
        }),
        ("sphere that touches the horizon from behind", |world| {
            let dark = world.material(black());
            world.shape(Sphere { radius: 0.5 }, at(DVec3::new(1.0, -0.5, 0.0)), dark, glow(1.0));
        }),
        ("the dark side of a square", |world| {
            let dark = world.material(black());
            world.shape(Quad { size: [1.0; 2] }, facing(DVec3::Y, DVec3::Y), dark, glow(1.0));
        }),
    ];
    for (name, place) in cases {
        let mut world = tile(1.0);
        place(&mut world);
        let scene = Arc::new(world.build().unwrap());
        for entry in ALL {
            let Some(integrator) = integrator(entry, DIRECT) else { continue };
            let mean = measure(scene.clone(), &*integrator, 1 << 15, 1);
            // The plane of a lamp seen edge-on misses the tile by a rounding error.
            let rounding = if name.starts_with("edge-on") { 1e-7 } else { 0.0 };
            assert!(mean.value <= rounding, "{name} by {}: {}", entry.name, mean.value);
        }
    }
}

/// Inside a lamp the irradiance is E = π L, or 0 if the lamp emits only outwards.
#[test]
fn inside_a_sphere_light() {
    let inside = |center: DVec3, radius: f64| {
        let mut world = tile(1.0);
        let dark = world.material(black());
        world.shape(Sphere { radius }, at(center), dark, two_sided(1.0));
        let law = KnownRadiance::new(format!("inside a sphere around {center}"), world, 1.0, DIRECT).resolution(1e-3, 3e-3).by_chance(1e-3);
        // Off the centre the wall is near, and samples by area vary strongly.
        if center == DVec3::ZERO { law } else { law.not_by_lights_alone() }
    };
    confirm(vec![inside(DVec3::ZERO, 1.0), inside(DVec3::new(0.5, 0.3, 0.2), 1.0), inside(DVec3::Y * 99.0, 100.0)], Effort::Standard);

    let mut world = tile(1.0);
    let dark = world.material(black());
    world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, dark, glow(1.0));
    let scene = Arc::new(world.build().unwrap());
    for entry in ALL {
        let Some(integrator) = integrator(entry, DIRECT) else { continue };
        assert_eq!(measure(scene.clone(), &*integrator, 1 << 13, 1).value, 0.0, "{}", entry.name);
    }
}

/// A lamp does not light its own surface: a sphere does not see itself from outside.
#[test]
fn a_sphere_light_does_not_light_itself() {
    let mut world = World::builder(probe(DVec3::new(0.0, 0.5, 3.0), DVec3::new(0.0, 0.4, 0.9)));
    let white = world.material(Material::diffuse(stored(gray(1.0))));
    world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, white, glow(1.0));
    let scene = Arc::new(world.build().unwrap());
    for entry in ALL {
        let Some(integrator) = integrator(entry, Depth::exactly(8)) else { continue };
        assert_eq!(measure(scene.clone(), &*integrator, 1 << 14, 1).value, 1.0, "{}", entry.name);
    }
}

/// Samples of the lights of a scene at the user's origin, over a grid of uniform numbers that includes 0 and 1 − 2⁻²⁴.
fn samples(scene: &World) -> Vec<Option<LightSample>> {
    let grid: Vec<f32> = (0..16).map(|k| k as f32 / 16.0).chain([1.0 - f32::EPSILON / 2.0]).collect();
    let mut found = vec![];
    for &choice in &grid {
        for &x in &grid {
            found.extend(
                grid.iter().map(|&y| scene.lights().sample(&LightSampleContext::at(-scene.origin().as_vec3()), choice, Vec2::new(x, y))),
            );
        }
    }
    found
}

/// Lamps without power are never chosen: every sample is of the lamp that emits.
#[test]
fn lights_without_power_are_never_chosen() {
    for place in 0..3 {
        let mut world = World::builder(probe(DVec3::Z, DVec3::ZERO));
        let dark = world.material(black());
        for k in 0..3 {
            let shines = if k == place { 2.0 } else { 0.0 };
            world.shape(Sphere { radius: 0.1 }, at(DVec3::new(f64::from(k) - 1.0, 2.0, 0.0)), dark, glow(shines));
            world.light(Light::Point(Point { position: DVec3::X * 9.0, intensity: stored(gray(0.0)) }));
        }
        let scene = world.build().unwrap();
        let lamp = DVec3::new(f64::from(place) - 1.0, 2.0, 0.0) - scene.origin();
        for sample in samples(&scene) {
            let sample = sample.expect("a sample of the lamp");
            let ShadowTarget::Surface(point) = sample.target else { panic!("not the lamp: {sample:?}") };
            assert!((point.p.as_dvec3() - lamp).length() < 0.11 && sample.weight().is_valid(), "{sample:?}");
        }
    }
}

/// Without lights, without power, and at the position of a point light, there is no sample and no panic.
#[test]
fn scenes_without_light_give_no_samples() {
    let scene = |light: Option<Point>| {
        let mut world = World::builder(probe(DVec3::Z, DVec3::ZERO));
        if let Some(light) = light {
            world.light(Light::Point(light));
        }
        world.build().unwrap()
    };
    let dark = Point { position: DVec3::X, intensity: stored(gray(0.0)) };
    let here = Point { position: DVec3::ZERO, intensity: stored(gray(1.0)) };
    for light in [None, Some(dark), Some(here)] {
        assert!(samples(&scene(light)).iter().all(Option::is_none), "{light:?}");
    }
}

/// Floor lit by one light without extent, seen at the origin, so that the radiance has no noise.
fn floor_under(name: String, light: Light, radiance: f64) -> KnownRadiance {
    let mut world = World::builder(probe(DVec3::new(0.6, 0.9, 0.3), DVec3::ZERO));
    let white = world.material(Material::diffuse(stored(gray(0.5))));
    world.shape(Quad { size: [2.0; 2] }, facing(DVec3::ZERO, DVec3::Y), white, None);
    world.light(light);
    let law = KnownRadiance::new(name, world, radiance, DIRECT).resolution(1e-5, 1e-5);
    assert!(law.scene.effects().contains(Effects::POINT_LIGHT));
    law
}

/// Spotlight at the height 2 with a tilted axis, an inner cone of 20° and an outer cone of 30°.
fn spot(tilt: f64) -> Light {
    let cos = |degrees: f64| degrees.to_radians().cos();
    let axis = DVec3::new(tilt.to_radians().sin(), -tilt.to_radians().cos(), 0.0).as_vec3().normalize();
    Light::Spot(Spot {
        position: DVec3::Y * 2.0,
        axis,
        intensity: stored(gray(10.0)),
        cos_inner: cos(20.0),
        cos_outer: cos(30.0),
        falloff: Falloff::Smooth,
    })
}

/// L = ρ/π · I/d² within the inner cone, 0 beyond the outer cone, and the smooth step s²(3 − 2s) of the cosine between.
#[test]
fn spot_lights() {
    let full = 0.5 / PI * 10.0 / 4.0;
    let step = |degrees: f64| {
        let cos = |d: f64| d.to_radians().cos();
        let s = ((cos(degrees) - cos(30.0)) / (cos(20.0) - cos(30.0))).clamp(0.0, 1.0);
        s * s * (3.0 - 2.0 * s)
    };
    let tilts = [0.0, 10.0, 19.99, 20.01, 22.0, 25.0, 27.0, 30.01, 45.0, 90.0, 180.0];
    confirm(tilts.map(|tilt| floor_under(format!("spot tilted by {tilt}°"), spot(tilt), full * step(tilt))).into(), Effort::Standard);
}

/// L = ρ/π · E cos θ down to grazing angles, and 0 from below.
#[test]
fn directional_lights() {
    let law = |degrees: f64| {
        let direction = DVec3::new(degrees.to_radians().sin(), -degrees.to_radians().cos(), 0.0).as_vec3().normalize();
        let light = Light::Directional(Directional { direction, irradiance: stored(gray(3.0)) });
        floor_under(format!("directional, {degrees}°"), light, 0.5 / PI * 3.0 * degrees.to_radians().cos().max(0.0))
    };
    confirm([0.0, 30.0, 60.0, 85.0, 89.0, 120.0, 180.0].map(law).into(), Effort::Standard);
}

/// An occluder casts an exactly black shadow for every kind of light. An object behind the light casts none.
#[test]
fn shadows_are_black() {
    let lights = [
        Light::Point(Point { position: DVec3::Y * 2.0, intensity: stored(gray(1.0)) }),
        spot(0.0),
        Light::Directional(Directional { direction: -Vec3::Y, irradiance: stored(gray(1.0)) }),
    ];
    for (k, light) in lights.into_iter().enumerate() {
        for (height, lit) in [(1.0, false), (3.0, k < 2)] {
            let mut world = World::builder(probe(DVec3::new(0.6, 0.5, 0.3), DVec3::ZERO));
            let (white, dark) = (world.material(Material::diffuse(stored(gray(0.5)))), world.material(black()));
            world.shape(Quad { size: [2.0; 2] }, facing(DVec3::ZERO, DVec3::Y), white, None);
            world.shape(Quad { size: [0.2; 2] }, facing(DVec3::Y * height, DVec3::Y), dark, None);
            world.light(light.clone());
            let scene = Arc::new(world.build().unwrap());
            for entry in ALL.iter().filter(|entry| entry.simulates.contains(Effects::POINT_LIGHT)) {
                let Some(integrator) = integrator(entry, DIRECT) else { continue };
                let mean = measure(scene.clone(), &*integrator, 1024, 1);
                assert_eq!(mean.value > 0.0, lit, "light {k}, occluder at {height}, by {}", entry.name);
            }
        }
    }
}

/// A tile is lit by the lights on the side from which it is seen, whether that is the side of its normal or the other, and those are
/// preferred. Paper that lets light through is lit by those on both sides.
#[test]
fn tiles_are_lit_on_the_side_that_is_seen() {
    let paper = |reflectance: f64, transmittance: f64| {
        let [reflectance, transmittance] = [reflectance, transmittance].map(|share| stored(gray(share)).into());
        Material::DiffuseTransmission(textured::DiffuseTransmission { reflectance, transmittance })
    };
    // Intensity and place of two lights on the seen side and of one on the other.
    let lights = [(1.0, DVec3::new(0.5, -2.0, 0.0)), (3.0, DVec3::new(-1.0, -1.0, 0.5)), (2.0, DVec3::new(0.3, 1.0, 0.2))];
    let brings = |(intensity, place): (f64, DVec3)| intensity * place.y.abs() / place.length().powi(3);
    let [seen, behind] = [brings(lights[0]) + brings(lights[1]), brings(lights[2])];
    for normal in [DVec3::Y, DVec3::NEG_Y] {
        for (material, expected) in [(Material::diffuse(stored(gray(0.5))), 0.5 * seen), (paper(0.25, 0.5), 0.25 * seen + 0.5 * behind)] {
            let mut world = World::builder(probe(DVec3::new(0.0, -0.5, 0.2), DVec3::ZERO));
            let material = world.material(material);
            world.shape(Quad { size: [0.1; 2] }, facing(DVec3::ZERO, normal), material, None);
            for (intensity, position) in lights {
                world.light(Light::Point(Point { position, intensity: stored(gray(intensity)) }));
            }
            let nee = ALL.iter().find(|entry| entry.name == "nee").expect("an integrator");
            let scene: Arc<dyn Scene> = Arc::new(world.build().expect("a scene"));
            let mean = measure(scene, &*integrator(nee, DIRECT).expect("an integrator"), 1 << 16, 1);
            // The 65,536 samples deviate from their mean by about half of it or less, which gives a standard error of at most 0.2 %. If
            // the lights on the wrong side were preferred, the mean would be the same, but its standard error would be about 3 %.
            let error = mean.variance.sqrt() / mean.value;
            assert!(error < 0.004, "normal {normal}: standard error {error}");
            assert!((mean.value * PI / expected - 1.0).abs() < 0.01, "normal {normal}: {} and not {}", mean.value * PI, expected);
        }
    }
}
