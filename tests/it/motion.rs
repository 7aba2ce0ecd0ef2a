//! Motion blur: what moves is hit, lit and seen as the average of what it is at each time.
//!
//! Interpolation and bounds are rows T5 to T7 of `pt torture`, and light with a formula rows T8 and T9.

use std::fs;
use std::sync::Arc;

use assert_cmd::Command;
use glam::{DVec2, DVec3, Vec3};
use pt::camera::{Camera, CameraRay, Orthographic, Pose};
use pt::effects::Effects;
use pt::film::{FilmSpec, Image};
use pt::integrator::Integrator;
use pt::integrators::light::LightTracer;
use pt::integrators::nee::Nee;
use pt::integrators::path::Path;
use pt::light::{Directional, Emitter, Falloff, Light, LightSampleContext, Lights, Placed, Point, ShadowTarget, Spot};
use pt::math::{AnimatedTransform, Keyframes, Ray, Rgb, Transform};
use pt::measure::meter::{Meter, Quantity, Response, measure};
use pt::measure::{SampledImage, agreement, critical_z, sidak};
use pt::medium::Phase;
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::{Interaction, MediumPoint, Scene};
use pt::shape::{Disk, Geometry, Quad, Sphere};
use pt::world::{Objects, World};
use serde_json::{Value, json};
use statrs::distribution::{Binomial, DiscreteCDF};

use crate::instances::{assert_same, one_of_each};
use crate::light_tracer::built;
use crate::marked::assert_fault_in_scene;
use crate::random::Random;
use crate::scenes::{at, black, picture};

/// Transforms that begin with one and end with another.
fn between(start: Transform, end: Transform) -> AnimatedTransform {
    Keyframes::new(&[(0.0, start), (1.0, end)]).expect("sound keyframes").into()
}

fn turned(axis: DVec3, degrees: f64) -> Transform {
    Transform::rotate(axis, degrees).expect("an axis")
}

/// A scene of one shape that moves and emits a radiance of 1, seen by a camera that looks along −z and shows 2 m of the plane z = 0.
fn alone(shape: impl Geometry + 'static, motion: AnimatedTransform) -> World {
    let pose = Pose::new(&Transform::translate(DVec3::Z * 4.0).expect("finite"));
    let mut world = World::builder(Camera::Orthographic(Orthographic { pose, height: 2.0 }));
    let material = world.material(black());
    let mut objects = Objects::default();
    objects.shape(shape, Transform::IDENTITY, material, Some(Emitter { two_sided: true, ..Emitter::new(Rgb::gray(1.0)) }));
    world.moving(objects, motion);
    world.build().expect("a valid scene")
}

/// Share of the exposure in which something covers the point (x, y), from rays at evenly spaced times.
fn covered(world: &World, x: f64, y: f64) -> f64 {
    const TIMES: u32 = 1 << 14;
    let origin = (DVec3::new(x, y, 2.0) - world.origin()).as_vec3();
    let ray = |k: u32| Ray { time: (k as f32 + 0.5) / TIMES as f32, ..Ray::new(origin, Vec3::NEG_Z) };
    f64::from((0..TIMES).filter(|k| world.intersect(&ray(*k)).is_some()).count() as u32) / f64::from(TIMES)
}

/// A disk or a ball of the radius r that crosses a point at the speed v, at the distance y from its middle, covers it for the time
/// 2 √(r² − y²) / v. A bar of the half width h that turns by a quarter covers a point at the distance r for 2 asin(h / r) / (π/2).
#[test]
fn coverage_is_chord_over_speed() {
    let crossing = between(at(DVec3::new(-2.0, 0.1, -0.5)), at(DVec3::new(2.5, 0.1, 0.5)));
    let disk = alone(Disk { radius: 0.6 }, crossing.clone());
    let ball = alone(Sphere { radius: 0.6 }, crossing);
    // Each end of an interval is found to within the distance of two times.
    let tolerance = 2.0 / f64::from(1 << 14);
    for (x, y) in [(0.0, 0.1), (0.3, -0.2), (-0.5, 0.5), (0.2, 0.695), (0.1, 0.71), (-1.0, -0.4)] {
        let chord = (0.36f64 - (y - 0.1f64).powi(2)).max(0.0).sqrt() * 2.0 / 4.5;
        for (name, world) in [("disk", &disk), ("ball", &ball)] {
            let found = covered(world, x, y);
            assert!((found - chord).abs() <= tolerance, "{name} at {x}, {y}: {found}, not {chord}");
        }
    }
    let half = 0.05;
    let quarter = between(turned(DVec3::Z, -45.0), turned(DVec3::Z, 45.0));
    let bar = alone(Quad { size: [2.0, 2.0 * half] }, quarter);
    for r in [0.1, 0.3, 0.6, 0.9] {
        for degrees in [0.0f64, 10.0, -12.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let wanted = 2.0 * (half / r).asin() / std::f64::consts::FRAC_PI_2;
            let found = covered(&bar, r * cos, r * sin);
            assert!((found - wanted).abs() <= tolerance, "bar at {r}, {degrees} degrees: {found}, not {wanted}");
        }
    }
}

/// A rectangle that crosses the picture at a constant speed gives each column of pixels the share of the time in which it covers it: the
/// numbers of samples that hit it are binomial.
#[test]
fn blur_is_the_share_of_time() {
    const EDGE: u32 = 16;
    const SAMPLES: u64 = 256;
    let (from, to, half) = (-1.2, 0.7, 0.25);
    let world = alone(Quad { size: [2.0 * half, 4.0] }, between(at(DVec3::X * from), at(DVec3::X * to)));
    let sampler = SamplerSpec { kind: Kind::Independent, spp: SAMPLES, seed: 3, ..SamplerSpec::default() };
    let spec = FilmSpec { filter: pt::film::Filter::pixel_box(0.5), ..FilmSpec::new(EDGE, EDGE) };
    let image = picture(Arc::new(world), &Path::default(), spec, sampler);
    let pixels: Vec<[f32; 3]> = image.pixels().collect();
    let until = |x: f64| ((x - from) / (to - from)).clamp(0.0, 1.0);
    let share = |x: f64| until(x + half) - until(x - half);
    let width = 2.0 / f64::from(EDGE);
    for column in 0..EDGE {
        const STEPS: u32 = 4096;
        let x = |k: u32| -1.0 + width * (f64::from(column) + (f64::from(k) + 0.5) / f64::from(STEPS));
        let wanted = (0..STEPS).map(|k| share(x(k))).sum::<f64>() / f64::from(STEPS);
        let found = (0..EDGE).map(|row| f64::from(pixels[(row * EDGE + column) as usize][0])).sum::<f64>() / f64::from(EDGE);
        let samples = f64::from(EDGE) * SAMPLES as f64;
        let z = (found - wanted) / (wanted * (1.0 - wanted) / samples).sqrt().max(1e-6);
        assert!(z.abs() < critical_z(0.01, EDGE as usize), "column {column}: {found}, not {wanted}");
    }
}

/// A disk crosses the picture, and a bar turns. In each pixel the number of samples that hit one of them has a binomial distribution. Its
/// probability is the share of the pixel's area and of the exposure that the disk or the bar covers; it is computed as a sum, with an error below
/// 10⁻³.
#[test]
fn blur_of_disks_and_bars_is_the_share_of_time() {
    const EDGE: u32 = 16;
    const SAMPLES: u64 = 1024;
    const PLACES: u32 = 24;
    const TIMES: u32 = 128;
    /// Whether something covers a point at a time.
    type Covers = fn(DVec2, f64) -> bool;
    let crossing = between(at(DVec3::new(-1.5, 0.1, 0.0)), at(DVec3::new(1.8, 0.1, 0.0)));
    let is_in_disk: Covers = |p, time| p.distance(DVec2::new(-1.5 + 3.3 * time, 0.1)) < 0.6;
    let turning = between(turned(DVec3::Z, -45.0), turned(DVec3::Z, 45.0));
    let is_in_bar: Covers = |p, time| {
        let turned_back = DVec2::from_angle(std::f64::consts::FRAC_PI_2 * (0.5 - time)).rotate(p);
        turned_back.abs().cmplt(DVec2::new(0.7, 0.1)).all()
    };
    let subjects =
        [("disk", alone(Disk { radius: 0.6 }, crossing), is_in_disk), ("bar", alone(Quad { size: [1.4, 0.2] }, turning), is_in_bar)];
    let level = 0.5 * sidak(0.01, 2 * (EDGE * EDGE) as usize);
    let middle = |k: u32, count: u32| (f64::from(k) + 0.5) / f64::from(count);
    for (name, world, covers) in subjects {
        let sampler = SamplerSpec { kind: Kind::Independent, spp: SAMPLES, seed: 5, ..SamplerSpec::default() };
        let spec = FilmSpec { filter: pt::film::Filter::pixel_box(0.5), ..FilmSpec::new(EDGE, EDGE) };
        let pixels: Vec<[f32; 3]> = picture(Arc::new(world), &Path::default(), spec, sampler).pixels().collect();
        let mut blurred = 0;
        for (pixel, found) in (0..EDGE * EDGE).zip(pixels) {
            let (column, row) = (pixel % EDGE, pixel / EDGE);
            let width = 2.0 / f64::from(EDGE);
            let covered = (0..PLACES * PLACES).map(|place| {
                let within = DVec2::new(middle(place % PLACES, PLACES), middle(place / PLACES, PLACES));
                let p = DVec2::new(-1.0, 1.0) + width * DVec2::new(f64::from(column) + within.x, -f64::from(row) - within.y);
                (0..TIMES).filter(|k| covers(p, middle(*k, TIMES))).count() as f64
            });
            let share = covered.sum::<f64>() / f64::from(PLACES * PLACES * TIMES);
            blurred += usize::from(share > 0.1 && share < 0.9);
            let hits = (f64::from(found[0]) * SAMPLES as f64).round() as u64;
            let hits_with = |share: f64| Binomial::new(share.clamp(0.0, 1.0), SAMPLES).expect("a share");
            let too_few = hits_with(share - 1e-3).cdf(hits);
            let too_many = if hits == 0 { 1.0 } else { hits_with(share + 1e-3).sf(hits - 1) };
            assert!(too_few.min(too_many) > level, "{name} at {column}, {row}: {hits} of {SAMPLES} hit, the share is {share}");
        }
        assert!(blurred > 30, "{name}: {blurred} pixels are blurred");
    }
}

/// A step of a transform with keyframes: positions, sizes and orientations that change. Under stronger stretches the normals at the corners
/// of a coarse mesh may disagree with its facets about the outside, which instances and meshes in the world treat differently.
fn moves(random: &mut Random, reach: f64) -> Value {
    // Either all keyframes mirror the shape or none does.
    let side = random.pick(&[1.0, -1.0]);
    let mut key = |time: f64| {
        let scale = [side * random.range(0.9, 1.1), random.range(0.9, 1.1), random.range(0.9, 1.1)];
        let (axis, by) = (random.direction().to_array(), (random.in_cube() * reach).to_array());
        json!({ "time": time, "transform": [{ "scale": scale }, { "rotate": { "axis": axis, "degrees": random.range(0.0, 360.0) } }, { "translate": by }] })
    };
    json!({ "keyframes": [key(-0.3), key(0.4), key(1.5)] })
}

/// Meshes whose vertices move: with normals and without, one with relief, and one that moves as a whole, too.
fn deforming(random: &mut Random) -> Vec<Value> {
    let corners = [[1.0, 0.0, -0.4], [-0.6, 0.9, -0.4], [-0.6, -0.9, -0.4], [0.0, 0.0, 1.2]];
    let triangles = json!([[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]]);
    let mut pose = |size: f64| -> [Value; 2] {
        let mut near = |p: [f64; 3], by: f64| (DVec3::from(p) * size + random.in_cube() * by).to_array();
        let positions: Vec<_> = corners.iter().map(|p| near(*p, 0.15)).collect();
        let normals: Vec<_> = corners.iter().map(|p| near(*p, 0.1)).collect();
        [json!(positions), json!(normals)]
    };
    let mut mesh = |name: &str, is_smooth: bool| {
        let [positions, normals] = pose(1.0);
        let mut mesh = json!({ "type": "mesh", "name": name, "positions": positions, "triangles": triangles });
        let mut keyframes = vec![];
        for (time, size) in [(-0.2, 0.9), (0.3, 1.0), (1.2, 1.1)] {
            let [positions, normals] = pose(size);
            keyframes.push(json!({ "time": time, "positions": positions }));
            if is_smooth {
                keyframes.last_mut().expect("one")["normals"] = normals;
            }
        }
        if is_smooth {
            mesh["normals"] = normals;
        }
        mesh["keyframes"] = json!(keyframes);
        mesh
    };
    let (plain, mut smooth, mut relief) = (mesh("facets", false), mesh("smooth", true), mesh("relief", true));
    smooth["smooth_shadows"] = json!(true);
    relief["uvs"] = json!([[0, 0], [1, 0], [0.2, 1], [0.7, 0.6]]);
    relief["emission"] = json!({ "radiance": [3, 2, 1], "two_sided": true });
    relief["material"] = json!({ "type": "bumped", "surface": { "type": "diffuse" }, "bump_map": { "type": "noise", "scale": 3, "on": "uv" }, "scale": 0.05 });
    vec![plain, smooth, relief]
}

/// Shapes of all kinds that move: alone, in a group, in a group that is itself within one that moves, and as instances.
fn zoo(random: &mut Random, shutter: [f64; 2]) -> Value {
    let still = json!({ "translate": [0, 0, 3] });
    let mut alone = one_of_each();
    alone.as_array_mut().expect("shapes").extend(deforming(random));
    for shape in alone.as_array_mut().expect("shapes") {
        let steps = shape.as_object_mut().expect("a shape").entry("transform").or_insert(json!([]));
        steps.as_array_mut().expect("steps").extend([moves(random, 6.0), still.clone()]);
    }
    let within = json!({ "type": "group", "shapes": one_of_each(), "transform": [{ "scale": 0.8 }, moves(random, 2.0), { "translate": [0, 5, 0] }, moves(random, 1.0)] });
    let group = json!({ "type": "group", "shapes": [within, { "type": "sphere", "name": "inner" }], "transform": [moves(random, 6.0)] });
    let placements: Vec<Value> = (0..3).map(|_| json!({ "transform": [moves(random, 8.0), { "scale": 0.7 }] })).collect();
    let instances = json!({ "type": "instances", "group": "things", "placements": placements, "transform": [moves(random, 3.0)] });
    let shapes = [
        alone.as_array().expect("shapes").clone(),
        vec![json!({ "type": "sphere", "name": "at rest" }), group, instances],
        deforming(random),
    ]
    .concat();
    let things = [
        one_of_each().as_array().expect("shapes").clone(),
        deforming(random),
        vec![json!({ "type": "sphere", "name": "last", "transform": [moves(random, 2.0)] })],
    ]
    .concat();
    json!({ "pt": 1, "camera": { "look_at": { "from": [6, 5, 7], "to": [0, 0, 0] } }, "film": { "width": 24, "height": 18 },
        "shutter": { "open": shutter[0], "close": shutter[1] }, "background": { "radiance": 0.5 }, "groups": { "things": things }, "shapes": shapes })
}

/// At each time rays hit what moves where they hit the scene as it is at that time, with the same points, normals, tangents, emission and
/// names.
#[test]
fn moving_shapes_are_hit_where_they_are() {
    const SCENES: u64 = 12;
    const RAYS: u64 = 4000;
    let (mut hits, mut apart) = (0, 0);
    for seed in 0..SCENES {
        let moving = built(&zoo(&mut Random::new(seed), [0.0, 1.0]).to_string());
        let mut random = Random::new(SCENES + seed);
        let time = random.unit() as f32;
        let still = built(&zoo(&mut Random::new(seed), [time.into(); 2]).to_string());
        assert!(moving.world.effects().contains(Effects::MOTION) && !still.world.effects().contains(Effects::MOTION));
        assert_eq!(moving.world.lights().len(), still.world.lights().len());
        let shift = (moving.world.origin() - still.world.origin()).as_vec3();
        for _ in 0..RAYS {
            let from = (random.direction() * 25.0).as_vec3();
            let to = (random.in_cube() * 6.0).as_vec3();
            let ray = Ray { time, ..Ray::new(from, (to - from).normalize()) };
            let at_rest = Ray::new(from + shift, ray.direction);
            let (found, wanted) = (moving.world.intersect(&ray), still.world.intersect(&at_rest));
            assert_eq!(moving.world.occluded(&ray), found.is_some());
            let (Some(found), Some(wanted)) = (found, wanted) else {
                apart += u64::from(found.is_some() != wanted.is_some());
                continue;
            };
            let names = [&moving.names.shapes[found.shape as usize], &still.names.shapes[wanted.shape as usize]];
            if (found.t - wanted.t).abs() > 1e-3 || names[0] != names[1] {
                apart += 1;
                continue;
            }
            hits += 1;
            let (surface, mut other) = (moving.world.surface(&ray, &found), still.world.surface(&at_rest, &wanted));
            other.point.p -= shift;
            other.shadow_origin -= shift;
            assert_same(&surface, &other, 100.0, seed);
            let name = |built: &pt::build::Built, light: u32| built.names.light(built.world.lights(), light).to_owned();
            if surface.emission.is_some() {
                assert_eq!(name(&moving, surface.light), name(&still, other.light));
            }
        }
    }
    assert!(hits > SCENES * RAYS / 10, "{hits} hits");
    // Outlines within rounding are seen by about one ray in a thousand.
    assert!(apart < SCENES * RAYS / 500, "{apart} of {} rays", SCENES * RAYS);
}

/// Rays that leave a moving surface do not hit it, and shadow rays to points of moving lamps are not stopped by the lamps.
#[test]
fn moving_surfaces_do_not_hide_themselves() {
    let (mut left, mut lit) = (0, 0);
    for seed in 0..8 {
        let scene = zoo(&mut Random::new(seed), [0.0, 1.0]);
        let world = built(&scene.to_string()).world;
        let mut random = Random::new(100 + seed);
        for _ in 0..20_000 {
            let time = random.unit() as f32;
            let from = (random.direction() * 25.0).as_vec3();
            let to = (random.in_cube() * 6.0).as_vec3();
            let ray = Ray { time, ..Ray::new(from, (to - from).normalize()) };
            let Some(hit) = world.intersect(&ray) else { continue };
            let surface = world.surface(&ray, &hit);
            let wi = random.direction().as_vec3();
            let onward = surface.spawn(wi, time);
            if let Some(next) = world.intersect(&onward) {
                let is_itself = (next.instance, next.shape, next.primitive) == (hit.instance, hit.shape, hit.primitive);
                let is_near = next.t < 10.0 * surface.point.offset;
                assert!(!(is_itself && is_near), "seed {seed}: {hit:?} and {next:?}");
            }
            left += 1;
            // A lamp with nothing else near it.
            let cx = LightSampleContext { time, ..LightSampleContext::at(from) };
            let Some(sample) = world.lights().sample(&cx, random.unit() as f32, random.uniform_square()) else { continue };
            let ShadowTarget::Surface(point) = sample.target else { continue };
            let towards = point.p - from;
            let ray = Ray { time, ..Ray::new(from, towards.normalize()) };
            let Some(hit) = world.intersect(&ray) else { panic!("seed {seed}: no lamp") };
            let surface = world.surface(&ray, &hit);
            if surface.emission.is_some() && surface.light == sample.light {
                let pdf = world.lights().pdf(sample.light, &cx, &surface.point).get();
                let wanted = sample.density.smooth().expect("a surface").get();
                // Lamps that are seen from the side amplify the rounding of the place.
                assert!((pdf / wanted - 1.0).abs() < 2e-2, "seed {seed}: density {pdf}, sampled with {wanted}");
                lit += 1;
            }
            let shadow = MediumPoint { p: from, phase: &Phase::Isotropic }.shadow_ray(sample.wi, &sample.target, time);
            if let Some(hit) = world.intersect(&shadow) {
                let surface = world.surface(&shadow, &hit);
                assert!(surface.emission.is_none() || surface.light != sample.light, "seed {seed}: the lamp hides itself");
            }
        }
    }
    assert!(left > 20_000 && lit > 1000, "{left} rays, {lit} lamps");
}

/// A room with lamps and bodies that move, for integrators to agree on.
fn room(kind: usize) -> Value {
    let matte = |albedo: f64| json!({ "type": "diffuse", "albedo": albedo });
    let wall = |place: [f64; 3], axis: [f64; 3], degrees: f64| json!({ "type": "quad", "size": 4, "material": matte(0.6), "transform": [{ "rotate": { "axis": axis, "degrees": degrees } }, { "translate": place }] });
    let keys = |from: Value, to: Value| json!([{ "keyframes": [{ "time": 0, "transform": from }, { "time": 1, "transform": to }] }]);
    let mut shapes = vec![
        wall([0.0, -1.0, 0.0], [1.0, 0.0, 0.0], -90.0),
        wall([0.0, 0.0, -1.5], [1.0, 0.0, 0.0], 0.0),
        wall([-1.5, 0.0, 0.0], [0.0, 1.0, 0.0], 90.0),
    ];
    let lamp = |shape: Value, transform: Value| {
        let mut lamp = shape;
        lamp["transform"] = transform;
        lamp
    };
    let swing = keys(
        json!([{ "scale": [0.5, 1.5, 1] }, { "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [-0.8, 1, 0] }]),
        json!([{ "scale": [1.2, 0.4, 0.8] }, { "rotate": { "axis": [1, 0.3, 0.8], "degrees": 60 } }, { "translate": [0.9, 0.6, 0.3] }]),
    );
    let mut lights: Vec<Value> = vec![];
    let mut camera = json!({ "look_at": { "from": [0.5, 0.5, 4], "to": [0, 0, 0] }, "fov": 45 });
    match kind {
        // A lamp that is stretched while it turns.
        0 => shapes.push(lamp(json!({ "type": "quad", "size": 1, "emission": 5 }), swing)),
        // Lamps of a mesh and a ball, with a picture on one of them.
        1 => {
            let mesh = json!({ "type": "mesh", "positions": [[-0.4, -0.4, 0], [0.4, -0.4, 0], [0, 0.5, 0.2], [0, 0, -0.4]],
                "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]], "triangles": [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]],
                "emission": { "radiance": [6, 3, 2], "two_sided": true, "texture": { "type": "checker", "even": 0.1, "odd": 1, "scale": 3 } } });
            shapes.push(lamp(mesh, swing));
            let ball = json!({ "type": "sphere", "radius": 0.2, "emission": [1, 2, 9] });
            shapes.push(lamp(
                ball,
                keys(json!([{ "translate": [-1, 0.2, 1] }]), json!([{ "scale": [1, 2, 0.5] }, { "translate": [1, -0.4, -0.5] }])),
            ));
        }
        // Matte and smooth bodies that move under a lamp at rest, within a group that moves too.
        2 => {
            shapes.push(lamp(
                json!({ "type": "disk", "radius": 0.6, "emission": 6 }),
                json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 1.5, 0.5] }]),
            ));
            let spin = keys(json!([]), json!([{ "rotate": { "axis": [0, 1, 0], "degrees": 120 } }]));
            let box_ = json!({ "type": "box", "size": [0.3, 1.2, 0.6], "material": matte(0.4), "transform": spin });
            let ball = json!({ "type": "sphere", "radius": 0.3, "center": [0.9, 0, 0.2], "material": { "type": "conductor", "metal": "Cu", "roughness": 0.3 } });
            shapes.push(json!({ "type": "group", "shapes": [box_, ball], "transform": keys(json!([{ "translate": [-0.5, -0.3, 0] }]), json!([{ "translate": [0.2, 0, 0] }])) }));
        }
        // Lights without a surface that move among things at rest.
        3 => {
            let spot = json!({ "type": "spot", "position": [0, 1, 2], "direction": [0, 0, -1], "intensity": 9, "outer_angle": 40,
                "transform": keys(json!([{ "translate": [-0.6, 0, 0] }]), json!([{ "rotate": { "axis": [0, 1, 0], "degrees": 40 } }])) });
            let point = json!({ "type": "point", "position": [0, 0, 0], "intensity": [1, 2, 4],
                "transform": keys(json!([{ "translate": [1, 0.9, 1] }]), json!([{ "translate": [-1, 0.4, 0.2] }])) });
            lights.extend([spot, point]);
            shapes.push(json!({ "type": "box", "size": 0.8, "material": matte(0.7) }));
        }
        // Bodies that change their form under a lamp at rest.
        4 => {
            shapes.push(lamp(
                json!({ "type": "disk", "radius": 0.6, "emission": 6 }),
                json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 1.5, 0.5] }]),
            ));
            let tent = |top: [f64; 3]| json!([[-0.7, -0.9, 0.5], [0.7, -0.9, 0.5], [0, -0.9, -0.7], top]);
            let sides = json!([[0, 1, 3], [1, 2, 3], [2, 0, 3]]);
            let wagging = |material: Value| {
                json!({ "type": "mesh", "positions": tent([0.0, 0.4, 0.0]), "triangles": sides, "material": material,
                    "keyframes": [{ "time": 0, "positions": tent([-1.0, 0.2, 0.3]) }, { "time": 0.6 }, { "time": 1, "positions": tent([0.9, -0.2, 0.8]) }] })
            };
            shapes.push(wagging(matte(0.5)));
            let mut metal = wagging(json!({ "type": "conductor", "metal": "Cu", "roughness": 0.4 }));
            metal["transform"] = json!([{ "scale": 0.4 }, { "translate": [-0.9, 0.6, -0.6] }]);
            shapes.push(metal);
        }
        // A camera that moves and turns.
        _ => {
            shapes.push(lamp(
                json!({ "type": "disk", "radius": 0.6, "emission": 6 }),
                json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 1.5, 0.5] }]),
            ));
            shapes.push(json!({ "type": "sphere", "radius": 0.6, "material": matte(0.7) }));
            let look = |from: [f64; 3]| json!([{ "look_at": { "from": from, "to": [0, 0, 0] } }]);
            camera = json!({ "transform": keys(look([0.2, 0.5, 4.0]), look([0.9, 0.3, 3.7])), "fov": 45, "lens_radius": 0.05, "focus_distance": 4 });
        }
    }
    json!({ "pt": 1, "camera": camera, "film": { "width": 16, "height": 16 }, "shapes": shapes, "lights": lights })
}

/// Number of kinds of rooms.
const ROOMS: usize = 6;

const EDGE: u32 = 16;

fn shot(scene: Arc<World>, integrator: &dyn Integrator, seed: u64, spp: u64) -> Image {
    picture(scene, integrator, FilmSpec::new(EDGE, EDGE), SamplerSpec { kind: Kind::Independent, spp, seed, ..SamplerSpec::default() })
}

/// Paths that meet moving lamps by chance, paths that sample them, and paths from them converge to the same pictures.
#[test]
fn integrators_agree_on_motion() {
    let level = sidak(0.01, 2 * ROOMS);
    for kind in 0..ROOMS {
        let scene = Arc::new(built(&room(kind).to_string()).world);
        let seed = 10 * kind as u64;
        // Chance never meets a light without a surface.
        let has_points = scene.effects().contains(Effects::POINT_LIGHT);
        let by_chance: Box<dyn Integrator> = if has_points { Box::new(Nee::default()) } else { Box::new(Path::default()) };
        let by_chance = shot(scene.clone(), &*by_chance, seed, 1024);
        let by_samples = shot(scene.clone(), &Nee::default(), seed + 1, 128);
        let from_lights = shot(scene.clone(), &LightTracer::default(), seed + 2, 1024);
        for (name, image, samples) in [("path", &by_chance, 1024), ("light", &from_lights, 1024)] {
            let of = |image, samples| SampledImage { image, samples };
            let found = agreement(of(image, samples), of(&by_samples, 128), level).expect("two pictures");
            assert!(found.accepts(), "room {kind}, {name} and nee: {found}");
        }
    }
}

/// The green channel of each pixel, and its standard error.
fn greens(image: &Image) -> impl Iterator<Item = (f64, f64)> {
    let channel = |name: &str| image.channel(name).expect("a channel").iter().map(|x| f64::from(*x));
    channel("G").zip(channel("StdErr.G"))
}

/// The picture of what moves is the mean of the pictures of moments: their even mean over 64 moments differs from it by less than chance
/// makes.
#[test]
fn blur_is_the_mean_of_moments() {
    const MOMENTS: u32 = 64;
    for kind in 0..ROOMS {
        let mut scene = room(kind);
        let blurred = shot(Arc::new(built(&scene.to_string()).world), &Nee::default(), 7, 512);
        let (mut sum, mut variance) = (vec![0.0; (EDGE * EDGE) as usize], vec![0.0; (EDGE * EDGE) as usize]);
        for k in 0..MOMENTS {
            let time = (f64::from(k) + 0.5) / f64::from(MOMENTS);
            scene["shutter"] = json!({ "open": time, "close": time });
            let moment = shot(Arc::new(built(&scene.to_string()).world), &Nee::default(), 100 + u64::from(k), 16);
            for (i, (value, error)) in greens(&moment).enumerate() {
                sum[i] += value / f64::from(MOMENTS);
                variance[i] += (error / f64::from(MOMENTS)).powi(2);
            }
        }
        let (values, errors): (Vec<f64>, Vec<f64>) = greens(&blurred).unzip();
        // The whole picture, and each quarter.
        for quarter in 0..5 {
            let counts = |i: usize| quarter == 4 || (i as u32 % EDGE / (EDGE / 2) + 2 * (i as u32 / EDGE / (EDGE / 2))) as usize == quarter;
            let part = |of: &dyn Fn(usize) -> f64| (0..sum.len()).filter(|i| counts(*i)).map(of).sum::<f64>();
            let (found, wanted) = (part(&|i| values[i]), part(&|i| sum[i]));
            let error = part(&|i| errors[i].powi(2) + variance[i]).sqrt();
            let z = (found - wanted) / error;
            assert!(z.abs() < critical_z(0.01, 5 * ROOMS), "room {kind}, part {quarter}: {found}, the mean of moments {wanted} ± {error}");
        }
    }
}

/// A camera that moves sees what things see it do that move the other way: the same surfaces at the same distances, at any time.
#[test]
fn a_camera_that_moves_is_the_world_moving() {
    let still = |camera: Value, shapes: Value| {
        let scene =
            json!({ "pt": 1, "camera": camera, "film": { "width": 16, "height": 16 }, "background": { "radiance": 1 }, "shapes": shapes });
        built(&scene.to_string()).world
    };
    let keys = |from: Value, to: Value| json!([{ "keyframes": [{ "time": 0, "transform": from }, { "time": 1, "transform": to }] }]);
    let shapes = json!([{ "type": "box", "center": [0.4, 0.2, -4] }, { "type": "sphere", "center": [-1, 0, -5] }]);
    let cameras = [
        json!({ "fov": 50, "lens_radius": 0.1, "focus_distance": 4 }),
        json!({ "focal_length": 30, "f_number": 0.2, "focus_distance": 4, "aperture": { "blades": 5 }, "tilt": [20, 40], "shift": [0.2, 0.1] }),
        json!({ "type": "fisheye", "fov": 60, "mapping": "stereographic" }),
        json!({ "type": "realistic", "lens": [[50, 2, 1.5, 20], [-50, 0, 1, 20]], "focus_distance": 4, "sensor": 36 }),
    ];
    // Translations at an even speed, and turns about the camera, are undone by their opposites at each time.
    let turn = |degrees: f64| json!([{ "rotate": { "axis": [0.2, 1, 0.1], "degrees": degrees } }]);
    let shift = |by: [f64; 3]| json!([{ "translate": by }]);
    let ways = [[turn(25.0), turn(-25.0)], [shift([0.5, -0.2, 0.3]), shift([-0.5, 0.2, -0.3])]];
    for (camera, [to, back]) in cameras.iter().flat_map(|camera| ways.iter().map(move |way| (camera, way.clone()))) {
        let with = |transform: Option<Value>| {
            let mut camera = camera.clone();
            if let Some(transform) = transform {
                camera["transform"] = transform;
            }
            camera
        };
        let a = still(with(Some(keys(json!([]), to))), shapes.clone());
        let b = still(with(None), json!([{ "type": "group", "shapes": shapes, "transform": keys(json!([]), back) }]));
        assert!(a.effects().contains(Effects::MOTION));
        let mut random = Random::new(5);
        let (mut hits, mut apart) = (0, 0);
        for _ in 0..20_000 {
            let (film, lens, time) = (random.uniform_square(), random.uniform_square(), random.unit() as f32);
            let [here, there] = [&a, &b].map(|world| world.intersect(&world.camera().ray(film, 1.0, lens, time)));
            match (here, there) {
                (Some(here), Some(there)) if (here.t - there.t).abs() < 1e-4 * here.t => hits += 1,
                (None, None) => {}
                _ => apart += 1,
            }
        }
        assert!(hits > 2000 && apart < 20, "{camera}: {hits} hits, {apart} apart");
        // A point that the camera sees is connected with the film position of its ray.
        for _ in 0..1000 {
            let (film, lens, time) = (random.uniform_square(), random.uniform_square(), random.unit() as f32);
            let CameraRay { ray, weight } = a.camera().sample(film, 1.0, lens, time);
            if weight == 0.0 || matches!(a.camera(), Camera::Realistic(_)) {
                continue;
            }
            let p = ray.at(3.0);
            let connection = a.camera().connect(p, 1.0, lens, time).expect("in front of the camera");
            assert!((connection.film - film).abs().max_element() < 1e-4, "{film}, {}", connection.film);
            let importance = a.camera().importance(&ray, 1.0).expect("a ray of the camera");
            assert!((importance.film - film).abs().max_element() < 1e-4);
        }
    }
}

/// The bits of a picture.
fn bits(image: &Image) -> Vec<u32> {
    image.pixels().flatten().map(f32::to_bits).collect()
}

/// A picture of what moves is the same with any number of threads and any tiles.
#[test]
fn threads_and_tiles_do_not_matter_in_motion() {
    for kind in 0..ROOMS {
        let scene = Arc::new(built(&room(kind).to_string()).world);
        for integrator in [&Nee::default() as &dyn Integrator, &LightTracer::default()] {
            let render = |threads: usize, tile: u32| {
                let mut film = pt::film::MomentFilm::new(FilmSpec::new(EDGE, EDGE));
                let sampler = SamplerSpec { kind: Kind::Sobol, spp: 4, ..SamplerSpec::default() };
                let settings = pt::render::Settings { tile, ..pt::render::Settings::new(sampler) };
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                pool.install(|| pt::render::render(scene.clone(), integrator, &mut film, &settings, &pt::render::Silent));
                bits(&film.image())
            };
            let wanted = render(1, 16);
            assert!(render(2, 5) == wanted && render(3, 1) == wanted, "room {kind}");
        }
    }
}

/// Runs the program on a scene; returns the bits of its picture and what it says.
pub fn rendered(scene: &Value) -> (Vec<u32>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("s.json"), scene.to_string()).expect("written");
    let mut command = Command::cargo_bin("pt").expect("the program");
    let run = command.current_dir(folder.path()).args(["s.json", "--progress", "none", "--spp", "4", "-o", "x.exr"]).assert().success();
    let output = run.get_output();
    let said = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat();
    (bits(&pt::output::exr::read(&folder.path().join("x.exr")).expect("a picture").0), said)
}

/// A shutter that closes when it opens shows the moment, and what does not move while the shutter is open costs and changes nothing: the
/// bits are those of the scene without keyframes.
#[test]
fn moments_have_the_bits_of_still_scenes() {
    let place = json!([{ "rotate": { "axis": [1, 2, 3], "degrees": 40 } }, { "translate": [0.3, 0.2, 0.1] }]);
    let keyframes = json!({ "keyframes": [{ "time": 0, "transform": [{ "translate": [-1, 0, 0] }] }, { "time": 2, "transform": place }] });
    let scene = |steps: Value, shutter: Value| {
        let mut scene = json!({ "pt": 1, "camera": { "look_at": { "from": [1, 2, 5], "to": [0, 0, 0] } }, "film": { "width": 24, "height": 16 },
            "background": { "radiance": 0.3 }, "lights": [{ "type": "point", "position": [1, 3, 2], "intensity": 20 }],
            "shapes": [{ "type": "box", "transform": steps }, { "type": "quad", "size": 0.3, "emission": 4, "transform": [{ "translate": [1, 1, 1] }] }] });
        if !shutter.is_null() {
            scene["shutter"] = shutter;
        }
        scene
    };
    let (still, said) = rendered(&scene(place.clone(), Value::Null));
    assert!(!said.contains("motion"), "{said}");
    let moment = json!({ "open": 2, "close": 2 });
    assert!(rendered(&scene(json!([keyframes.clone()]), moment)).0 == still, "a moment");
    let later = json!({ "open": 2.5, "close": 3 });
    assert!(rendered(&scene(json!([keyframes.clone()]), later)).0 == still, "after the last keyframe");
    let nothing = json!({ "keyframes": [{ "time": 0, "transform": place }, { "time": 1, "transform": place }] });
    assert!(rendered(&scene(json!([nothing]), Value::Null)).0 == still, "keyframes that are the same");
    assert!(rendered(&scene(json!([keyframes]), Value::Null)).0 != still, "the motion itself");
}

/// What is wrong with keyframes is said at its place.
#[test]
fn impossible_keyframes_are_refused() {
    let moving = |steps: &str| format!("\"shapes\": [{{\"type\": \"sphere\", \"transform\": [{steps}]}}]");
    assert_fault_in_scene(&[
        ("\"shutter\": {\"open\": 1, \"close\": ^0.5}", "/shutter/close: expected a time from 1 s on, when the shutter opens, found 0.5"),
        ("\"shutter\": {\"open\": ^\"now\"}", "/shutter/open: expected"),
        (&moving("{\"keyframes\": ^[]}"), "/shapes/0/transform/0/keyframes: expected at least one keyframe"),
        (
            &moving("{\"keyframes\": [{\"time\": 1}, {\"time\": ^1}]}"),
            "/shapes/0/transform/0/keyframes/1/time: expected a time after that of the keyframe before it, 1 s, found 1",
        ),
        (
            &moving("{\"keyframes\": [{\"time\": 0, \"transform\": [{\"keyframes\": ^[]}]}]}"),
            "/shapes/0/transform/0/keyframes/0/transform/0/keyframes: keyframes within keyframes",
        ),
        (
            &moving("{\"keyframes\": [{\"time\": 0, \"transform\": [{\"scale\": ^0}]}]}"),
            "/shapes/0/transform/0/keyframes/0/transform/0/scale: the transform has no inverse",
        ),
        (
            "\"background\": {\"image\": \"a.exr\", \"transform\": [{\"keyframes\": ^[{\"time\": 0}]}]}",
            "/background/transform/0/keyframes: only shapes, groups, instances, lights and the camera can move",
        ),
        (
            "\"shapes\": [{\"type\": \"sphere\", \"medium\": ^{\"type\": \"homogeneous\"}, \"transform\": [{\"keyframes\": [{\"time\": 0}]}]}]",
            "/shapes/0/medium: a shape that contains a medium cannot move",
        ),
    ]);
    let scene = json!({ "pt": 1, "camera": {}, "shapes": [{ "type": "sphere", "transform": [{ "keyframes": [{ "time": 0 }, { "time": 1, "transform": [{ "scale": -1 }] }] }] }] });
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("s.json"), scene.to_string()).expect("written");
    let run = Command::cargo_bin("pt").expect("the program").current_dir(folder.path()).arg("s.json").assert().code(3);
    let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
    assert!(said.contains("keyframe 1 mirrors and keyframe 0 does not"), "{said}");
}

/// A light that is placed, at rest or in motion, shines as one whose position and direction are those of the time.
#[test]
fn placed_lights_shine_as_others() {
    let mut random = Random::new(11);
    let lights = |light: Light| Lights::new(vec![light], Vec::<Box<dyn pt::shape::Shape>>::new().into(), (Vec3::ZERO, 10.0));
    for k in 0..200 {
        let place = |random: &mut Random| random.rotation().then(&at(random.in_cube() * 3.0));
        let (start, end) = (place(&mut random), place(&mut random));
        let motion = if k % 2 == 0 { AnimatedTransform::from(start) } else { between(start, end) };
        let time = random.unit() as f32;
        let now = *motion.at(time);
        let (position, axis) = (random.in_cube(), random.direction());
        let (here, along) = (now.point(position), now.vector(axis).as_vec3());
        let intensity = Rgb::new(3.0, 2.0, 1.0);
        let spot = |position, axis| Spot { position, axis, intensity, cos_inner: 0.8, cos_outer: 0.1, falloff: Falloff::Smooth };
        let pairs = [
            (Light::Point(Point { position, intensity }), Light::Point(Point { position: here, intensity })),
            (Light::Spot(spot(position, axis.as_vec3())), Light::Spot(spot(here, along))),
            (
                Light::Directional(Directional { direction: axis.as_vec3(), irradiance: intensity }),
                Light::Directional(Directional { direction: along, irradiance: intensity }),
            ),
        ];
        for (own, world) in pairs {
            let placed = Placed::new(own, motion.clone()).expect("lengths are kept");
            let [placed, world] = [Light::Placed(Box::new(placed)), world].map(lights);
            let cx = LightSampleContext { time, ..LightSampleContext::at((random.in_cube() * 5.0).as_vec3()) };
            let (choice, u, v) = (random.unit() as f32, random.uniform_square(), random.uniform_square());
            match [&placed, &world].map(|lights| lights.sample(&cx, choice, u)) {
                [Some(a), Some(b)] => {
                    assert!((a.wi - b.wi).length() < 1e-5, "{} {}", a.wi, b.wi);
                    assert!((a.li.average() / b.li.average() - 1.0).abs() < 1e-3 && a.probability == b.probability);
                    if let (ShadowTarget::Point(p), ShadowTarget::Point(q)) = (a.target, b.target) {
                        assert!((p - q).length() < 1e-5);
                    }
                }
                // The edge of the cone.
                [a, b] => assert!(a.or(b).is_none_or(|sample| sample.li.average() < 1e-3), "{a:?} {b:?}"),
            }
            let Some(emitted) = placed.emit(choice, u, v, time) else { continue };
            let density = placed.emission_density(0, None, emitted.ray.direction, time);
            let same = match (density.direction.smooth(), emitted.direction.smooth()) {
                (Some(a), Some(b)) => (a.get() / b.get() - 1.0).abs() < 1e-4,
                (None, None) => true,
                _ => false,
            };
            assert!(same && emitted.ray.time == time, "{density:?} {emitted:?}");
            // The ray that another light would bring to a point of it.
            let onward = LightSampleContext { time, ..LightSampleContext::at(emitted.ray.at(1.5)) };
            let back = world.sample(&onward, choice, u).expect("the light that emitted the ray");
            assert!((back.wi + emitted.ray.direction).length() < 1e-4, "{} {}", back.wi, emitted.ray.direction);
        }
    }
    let stretch = Transform::scale(DVec3::new(1.0, 1.0, 1.001)).expect("not zero");
    let point = Light::Point(Point { position: DVec3::ZERO, intensity: Rgb::gray(1.0) });
    assert!(Placed::new(point.clone(), stretch.into()).is_none(), "scales are refused");
    assert!(Placed::new(point.clone(), between(Transform::IDENTITY, stretch)).is_none(), "also at a single time");
    let within = Keyframes::new(&[(0.0, Transform::IDENTITY), (0.1, stretch), (0.2, Transform::IDENTITY)]).expect("sound");
    assert!(Placed::new(point, within.into()).is_none(), "also at a keyframe within the exposure");
}

/// The pictures of a sequence are renders of their own with a later shutter, and those that are there are not rendered again.
#[test]
fn sequences_are_pictures_one_after_the_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = json!({ "pt": 1, "camera": { "look_at": { "from": [0, 0, 5], "to": [0, 0, 0] } }, "film": { "width": 24, "height": 16 },
        "background": { "radiance": 1 }, "shapes": [{ "type": "sphere", "radius": 0.5, "transform": [{ "keyframes": [
            { "time": 0, "transform": [{ "translate": [-2, 0, 0] }] }, { "time": 1, "transform": [{ "translate": [2, 0, 0] }] }] }] }] });
    fs::write(folder.path().join("s.json"), scene.to_string()).expect("written");
    let pt = |args: &[&str]| {
        let mut command = Command::cargo_bin("pt").expect("the program");
        let samples: &[&str] = if args.contains(&"--spp") { &[] } else { &["--spp", "4"] };
        command.current_dir(folder.path()).args(["s.json", "--progress", "none"]).args(samples).args(args);
        let run = command.assert().success();
        String::from_utf8_lossy(&run.get_output().stderr).into_owned()
    };
    let picture = |name: &str| bits(&pt::output::exr::read(&folder.path().join(name)).expect(name).0);
    pt(&["--frames", "1..3", "--fps", "10", "-o", "x.exr"]);
    for (frame, shutter) in [(1, "0.1,\"close\":0.15000000000000002"), (2, "0.2,\"close\":0.25"), (3, "0.3,\"close\":0.35")] {
        pt(&["-D", &format!("/shutter={{\"open\":{shutter}}}"), "-o", "alone.exr"]);
        assert!(picture(&format!("x.{frame:04}.exr")) == picture("alone.exr"), "picture {frame}");
    }
    assert!(picture("x.0001.exr") != picture("x.0002.exr"));
    // Where the scene has a shutter, it is open as long in each picture. The default names are those of the scene.
    pt(&["-D", "/shutter={\"open\": 0.5, \"close\": 0.5}", "--frames", "0..0"]);
    pt(&["-D", "/shutter={\"open\": 0.5, \"close\": 0.5}", "-o", "alone.exr"]);
    assert!(picture("s.0000.exr") == picture("alone.exr") && folder.path().join("s.0000.png").exists());
    // One picture of the sequence alone, and in parts.
    pt(&["--frame", "2", "--fps", "10", "-o", "one.exr"]);
    assert!(picture("one.0002.exr") == picture("x.0002.exr"));
    for shard in ["1/2", "2/2"] {
        pt(&["--frames", "1..2", "--fps", "10", "--shard", shard, "-o", &format!("p{}.ptc", &shard[..1])]);
    }
    for frame in ["0001", "0002"] {
        let parts = ["1", "2"].map(|shard| format!("p{shard}.{frame}.ptc"));
        let mut command = Command::cargo_bin("pt").expect("the program");
        command.current_dir(folder.path()).arg("merge").args(parts).args(["-o", "merged.exr"]).assert().success();
        assert!(picture("merged.exr") == picture(&format!("x.{frame}.exr")), "picture {frame} in parts");
    }
    // A picture with fewer samples is not done, and one of another scene is not that picture.
    pt(&["--frames", "1..1", "--fps", "10", "--spp", "2", "-o", "x.exr"]);
    let before = fs::metadata(folder.path().join("x.0003.exr")).expect("there").modified().expect("a time");
    let said = pt(&["--frames", "1..4", "--fps", "10", "--resume", "-o", "x.exr"]);
    let there = |frame: u32| said.contains(&format!("x.{frame:04}.exr: is there"));
    assert!(!there(1) && there(2) && there(3) && !there(4), "{said}");
    assert_eq!(fs::metadata(folder.path().join("x.0003.exr")).expect("there").modified().expect("a time"), before);
    assert!(!said.contains("x.0002.ptc"), "{said}");
    let said = pt(&["--frames", "2..2", "--fps", "11", "--resume", "-o", "x.exr"]);
    assert!(!said.contains("is there"), "{said}");
    // A picture that was rendered with --clamp is rendered again.
    pt(&["--frames", "5..5", "--clamp", "0.5", "-o", "x.exr"]);
    let said = pt(&["--frames", "5..5", "--resume", "-o", "x.exr"]);
    assert!(!said.contains("is there"), "{said}");
    for (args, expected) in [
        (vec!["--frames", "3..1"], "expected pictures such as 1..48"),
        (vec!["--frame", "x"], "expected pictures such as 1..48"),
        (vec!["--frames", "1..2", "--pixel", "1,1"], "cannot be used with"),
        (vec!["--frames", "1..2", "--resume", "--time", "1"], "--frames --resume"),
        (vec!["--frames", "1..2", "--resume=x.ptc"], "--frames --resume=FILE"),
        (vec!["--frames", "1..2", "--fps", "0"], "expected a number of pictures per second"),
    ] {
        let mut command = Command::cargo_bin("pt").expect("the program");
        let run = command.current_dir(folder.path()).arg("s.json").args(&args).assert().code(2);
        let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        assert!(said.contains(expected), "{args:?}: {said}");
    }
}

/// A meter under a ball of the radius r and the radiance L that flies past shows the mean of π L (r/d)² cos θ over the exposure.
#[test]
fn meters_show_the_mean_over_the_exposure() {
    let (from, to) = (DVec3::new(-1.5, 0.8, 0.3), DVec3::new(1.0, 2.0, -0.5));
    let key = |time: f64, p: DVec3| json!({ "time": time, "transform": [{ "translate": p.to_array() }] });
    let scene = json!({ "pt": 1, "camera": {}, "shapes": [{ "type": "sphere", "radius": 0.25, "emission": 3,
        "transform": [{ "keyframes": [key(0.0, from), key(1.0, to)] }] }] });
    let world = built(&scene.to_string()).world;
    let steps = 1 << 14;
    let at = |k: u32| from.lerp(to, (f64::from(k) + 0.5) / f64::from(steps));
    let irradiance = |p: DVec3| std::f64::consts::PI * 3.0 * 0.0625 * p.y / p.length().powi(3);
    let wanted = (0..steps).map(|k| irradiance(at(k))).sum::<f64>() / f64::from(steps);
    let meter = Meter {
        position: (DVec3::ZERO - world.origin()).as_vec3(),
        quantity: Quantity::Irradiance { normal: Vec3::Y, radius: 0.0 },
        response: Response::Radiometric,
    };
    let estimator = {
        let scene: Arc<dyn Scene> = Arc::new(built(&scene.to_string()).world);
        Nee::default().prepare(scene, &FilmSpec::new(1, 1))
    };
    let sampler = SamplerSpec { kind: Kind::Independent, seed: 5, ..SamplerSpec::default() };
    let mean = measure(&world, &*estimator, &meter, (sampler, 0), &|| false, |reading| match reading.samples >= 1 << 16 {
        true => std::ops::ControlFlow::Break(reading.values[3]),
        false => std::ops::ControlFlow::Continue(()),
    });
    let z = (mean.value - wanted) / mean.standard_error();
    assert!(z.abs() < critical_z(0.01, 1), "{} ± {}, not {wanted}", mean.value, mean.standard_error());
    assert!(mean.standard_error() < 0.02 * wanted);
}

/// Lights that are placed far from the origin are as precise there as others: their rays start and end where those of lights at rest do.
#[test]
fn placed_lights_are_precise_far_away() {
    let far = 1e7;
    let scene = |steps: Value| {
        let mut point = json!({ "type": "point", "position": [far, 2, 0], "intensity": 5 });
        let mut sun = json!({ "type": "directional", "direction": [0.3, -1, 0.2], "irradiance": 1 });
        if !steps.is_null() {
            point["transform"] = json!([steps, { "translate": [0, 0, 0] }]);
            sun["transform"] = json!([{ "translate": [-far, 0, 0] }, { "translate": [far, 0, 0] }]);
        }
        let ball = json!({ "type": "sphere", "center": [far, 0, 0] });
        let look = json!({ "look_at": { "from": [far, 1, 5], "to": [far, 0, 0] } });
        built(&json!({ "pt": 1, "camera": look, "shapes": [ball], "lights": [point, sun] }).to_string()).world
    };
    let (placed, plain) = (scene(json!({ "rotate": { "axis": [0, 1, 0], "degrees": 0 } })), scene(Value::Null));
    assert_eq!(placed.origin(), plain.origin());
    let mut random = Random::new(3);
    for _ in 0..1000 {
        let cx = LightSampleContext::at((random.in_cube() * 2.0).as_vec3());
        let (choice, u, v) = (random.unit() as f32, random.uniform_square(), random.uniform_square());
        let [a, b] = [&placed, &plain].map(|world| world.lights().emit(choice, u, v, 0.0).expect("a ray"));
        assert!((a.ray.origin - b.ray.origin).length() < 1e-5 && (a.ray.direction - b.ray.direction).length() < 1e-6, "{a:?} {b:?}");
        for world in [&placed, &plain] {
            let Some(sample) = world.lights().sample(&cx, choice, u) else { continue };
            if let ShadowTarget::Point(p) = sample.target {
                let line = DVec3::new(far, 2.0, 0.0) - world.origin() - cx.p.as_dvec3();
                assert!((p.as_dvec3() - cx.p.as_dvec3() - line).length() < 1e-5);
                assert!((f64::from(sample.li.average()) * line.length_squared() / 5.0 - 1.0).abs() < 1e-5, "{sample:?}");
            }
        }
    }
}
