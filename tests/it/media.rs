//! Participating media: what does not change a picture, what integrators agree on, and what they are told of.
//!
//! Formulas and published numbers are rows V1 to V10 of `pt torture`.

use std::fs;
use std::sync::Arc;

use assert_cmd::Command;
use glam::{DQuat, DVec3, UVec2, UVec3};
use pt::bsdf::{Material, MaterialId, textured};
use pt::film::{FilmSpec, Image};
use pt::integrator::{Context, Integrator, Interrupt};
use pt::integrators::ALL;
use pt::integrators::light::LightTracer;
use pt::integrators::nee::Nee;
use pt::integrators::path::Path;
use pt::light::{Directional, Emitter, Environment, Light, Point};
use pt::math::{Rgb, Spectrum, Transform, Vec3};
use pt::measure::{SampledImage, agreement, sidak};
use pt::medium::{ColorGrid, Density, Grid, Medium, Phase, Places, Varying};
use pt::recorder::{End, Event};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;
use pt::shape::{Cuboid, Quad, Sphere};
use pt::world::{World, WorldBuilder};
use serde_json::{Value, json};

use crate::marked::assert_fault_in_scene;
use crate::scenes::{at, facing, gray, picture};
use crate::shared::shared;

/// Samples of each pixel, and width and height of the pictures.
const SAMPLES: u64 = 128;
const EDGE: u32 = 16;

fn spectrum([r, g, b]: [f32; 3]) -> Spectrum {
    Spectrum::rgb(r, g, b)
}

fn interface(world: &mut WorldBuilder) -> MaterialId {
    world.material(Material::from(textured::Interface))
}

/// A camera with a wide view.
fn camera(from: DVec3, to: DVec3) -> pt::camera::Camera {
    let pose = pt::camera::Pose::new(&Transform::look_at(from, to, DVec3::Y).expect("a view"));
    pt::camera::Camera::Perspective(pt::camera::Perspective::new(pose, 40.0, 0.0, 1.0))
}

/// A room that is open to the front, with a lamp of some size under its ceiling; `scale` multiplies all lengths.
fn room(scale: f64) -> WorldBuilder {
    let mut world = World::builder(camera(DVec3::Z * 4.0 * scale, DVec3::ZERO));
    let white = world.material(Material::diffuse(Rgb::gray(0.7)));
    let red = world.material(Material::diffuse(Rgb::new(0.7, 0.2, 0.1)));
    for (place, normal, material) in [
        (DVec3::NEG_Y, DVec3::Y, white),
        (DVec3::Y, DVec3::NEG_Y, white),
        (DVec3::NEG_Z, DVec3::Z, white),
        (DVec3::NEG_X, DVec3::X, red),
        (DVec3::X, DVec3::NEG_X, white),
    ] {
        world.shape(Quad { size: [2.0 * scale; 2] }, facing(place * scale, normal), material, None);
    }
    let lamp = Some(Emitter::new(Rgb::new(4.0, 3.0, 2.0)));
    world.shape(Quad { size: [scale; 2] }, facing(DVec3::Y * 0.99 * scale, DVec3::NEG_Y), white, lamp);
    world
}

/// A cloud whose coefficients differ between the colours.
fn smoke() -> Medium {
    Medium::new(spectrum([0.2, 0.5, 0.1]), spectrum([1.0, 0.4, 3.0]), Phase::henyey_greenstein(0.6))
}

/// A cloud whose coefficients differ between the colours and whose density, albedo and emission vary in a cube around the origin.
///
/// - `edge`: edge of the cube (m); the coefficients are as much smaller as it is longer than 1
fn cloud(edge: f64, bounds_factor: f32) -> Medium {
    let by = (1.0 / edge) as f32;
    let coefficients = [[0.5, 1.5, 0.2], [6.0, 2.0, 12.0]].map(|color| spectrum(color) * by);
    let size = UVec3::new(19, 11, 23);
    // Dense along a spiral, with holes.
    let value = |i: u32| {
        let p = UVec3::new(i % size.x, i / size.x % size.y, i / size.x / size.y).as_vec3() / size.as_vec3() - 0.5;
        (0.6 - 3.0 * p.length() + 0.5 * (20.0 * p.x + 9.0 * p.y).sin() * (15.0 * p.z).cos()).max(0.0)
    };
    let grid = Grid::new(size, (0..size.element_product()).map(value).collect(), Places::Centers);
    let placed = Transform::translate(DVec3::splat(-0.5)).and_then(|middle| Ok(middle.then(&Transform::scale(DVec3::splat(edge))?)));
    let density = Density::new(grid, &placed.expect("a transform")).with_bounds_scaled(bounds_factor);
    let glow = spectrum([0.5, 0.2, 0.1]);
    let albedo = Grid::new(UVec3::new(2, 1, 2), [1.0, 0.8, 0.9, 0.3].map(|x| Rgb::new(x, 0.9, 1.0 - 0.5 * x)).into(), Places::Centers);
    let emission = Grid::new(UVec3::new(1, 3, 1), vec![2.0, 0.0, 1.0], Places::Corners);
    let varying = Varying { albedo: Some(ColorGrid::Rgb(albedo)), emission: Some(ColorGrid::Gray(emission)) };
    let cloud = Medium::new(coefficients[0], coefficients[1], Phase::henyey_greenstein(0.6)).emitting(glow);
    cloud.with_density(density).with_varying(varying)
}

/// A shape with a medium, placed in a scene.
fn fill(world: &mut WorldBuilder, shape: impl pt::shape::Geometry + 'static, place: DVec3, material: MaterialId, medium: Medium) {
    let medium = world.medium(medium);
    world.shape(shape, at(place), material, None);
    world.fill(medium);
}

/// Scenes with media of all kinds, by name.
fn scenes() -> Vec<(&'static str, WorldBuilder)> {
    let mut scenes = vec![];

    let mut world = room(1.0);
    let boundary = interface(&mut world);
    fill(&mut world, Sphere { radius: 0.6 }, DVec3::ZERO, boundary, smoke());
    scenes.push(("a ball of smoke in a room", world));

    let mut world = room(1.0);
    let haze = world.medium(Medium::new(gray(0.02), gray(0.2), Phase::Rayleigh));
    world.surround(haze);
    scenes.push(("a room full of haze", world));

    let mut world = room(1.0);
    let glass = world.material(Material::glass(1.33));
    fill(
        &mut world,
        Sphere { radius: 0.5 },
        DVec3::Y * -0.4,
        glass,
        Medium::new(gray(0.01), spectrum([4.0, 5.0, 6.0]), Phase::henyey_greenstein(0.8)),
    );
    scenes.push(("a ball of milk", world));

    // A block of smoke on the floor and at the wall, so that faces coincide, with a ball of another medium in it and a matte ball in that.
    let mut world = room(1.0);
    let (boundary, matte) = (interface(&mut world), world.material(Material::diffuse(Rgb::gray(0.8))));
    fill(&mut world, Cuboid { size: [1.0, 1.0, 1.0] }, DVec3::new(-0.5, -0.5, -0.5), boundary, smoke());
    fill(&mut world, Sphere { radius: 0.3 }, DVec3::new(-0.5, -0.5, -0.5), boundary, Medium::new(gray(0.5), gray(0.5), Phase::Isotropic));
    world.shape(Sphere { radius: 0.1 }, at(DVec3::new(-0.5, -0.5, -0.5)), matte, None);
    scenes.push(("smoke on the floor, with a ball in it", world));

    // A fire: it emits, and its light is scattered by haze.
    let mut world = room(1.0);
    let boundary = interface(&mut world);
    let haze =
        world.medium(Medium::new(gray(0.05), gray(0.3), Phase::Mix(Box::new([Phase::Isotropic, Phase::henyey_greenstein(-0.5)]), 0.4)));
    world.surround(haze);
    let flame = Medium::new(gray(1.0), gray(0.2), Phase::Isotropic).emitting(spectrum([6.0, 3.0, 1.0]));
    fill(&mut world, Sphere { radius: 0.4 }, DVec3::Y * -0.5, boundary, flame);
    scenes.push(("a flame in haze", world));

    // A cloud that floats in haze and reaches into the floor, with a matte ball in it.
    let mut world = room(1.0);
    let (boundary, matte) = (interface(&mut world), world.material(Material::diffuse(Rgb::gray(0.8))));
    let haze = world.medium(Medium::new(gray(0.02), gray(0.1), Phase::Rayleigh));
    world.surround(haze);
    fill(&mut world, Sphere { radius: 0.8 }, DVec3::ZERO, boundary, cloud(1.8, 1.0));
    world.shape(Sphere { radius: 0.2 }, at(DVec3::new(0.3, 0.1, 0.3)), matte, None);
    scenes.push(("a cloud whose density varies", world));

    // A block of glass whose medium absorbs and emits but does not scatter, with the density of the cloud above.
    let mut world = room(1.0);
    let glass = world.material(Material::glass(1.2));
    let density = cloud(1.0, 1.0).density().expect("a density").clone();
    let amber = Medium::new(spectrum([1.0, 4.0, 9.0]), Spectrum::BLACK, Phase::Isotropic).emitting(gray(0.3)).with_density(density);
    fill(&mut world, Cuboid { size: [0.9; 3] }, DVec3::ZERO, glass, amber);
    scenes.push(("glass whose tint varies", world));

    // The camera within a cloud, under a sky.
    let mut world = World::builder(camera(DVec3::Z * 0.5, DVec3::ZERO));
    let (boundary, matte) = (interface(&mut world), world.material(Material::diffuse(Rgb::gray(0.5))));
    fill(&mut world, Sphere { radius: 1.0 }, DVec3::ZERO, boundary, smoke());
    world.shape(Sphere { radius: 0.2 }, at(DVec3::new(0.1, 0.0, -0.4)), matte, None);
    world.light(Light::Environment(Environment { radiance: Rgb::new(0.5, 0.7, 1.0) }));
    scenes.push(("the camera in a cloud", world));
    scenes
}

fn shot(scene: Arc<World>, integrator: &dyn Integrator, kind: Kind, seed: u64, spp: u64) -> Image {
    picture(scene, integrator, FilmSpec::new(EDGE, EDGE), SamplerSpec { kind, spp, seed, ..SamplerSpec::default() })
}

/// `path`, which finds light by chance, and `nee`, which samples lights and phase functions, converge to the same pictures.
#[test]
fn integrators_agree_in_media() {
    let scenes = scenes();
    let level = sidak(0.01, scenes.len());
    for (seed, (name, world)) in (0..).zip(scenes) {
        let scene = Arc::new(world.build().expect(name));
        let by_chance = shot(scene.clone(), &Path::default(), Kind::Independent, 2 * seed, 8 * SAMPLES);
        let by_samples = shot(scene.clone(), &Nee::default(), Kind::Independent, 2 * seed + 1, SAMPLES);
        let of = |image, samples| SampledImage { image, samples };
        let found = agreement(of(&by_chance, 8 * SAMPLES), of(&by_samples, SAMPLES), level).expect("two pictures");
        assert!(found.accepts(), "{name}: {found}");
    }
}

/// Scenes that suit `light`: without mirrors, glass and glowing media, and with the camera outside of media that scatter, where points near it
/// would be rare and so bright that the variance has no bound.
fn scenes_for_light() -> Vec<(&'static str, WorldBuilder)> {
    let suits = ["a ball of smoke in a room", "smoke on the floor, with a ball in it"];
    let mut found: Vec<_> = scenes().into_iter().filter(|(name, _)| suits.contains(name)).collect();

    let mut world = room(1.0);
    let (boundary, matte) = (interface(&mut world), world.material(Material::diffuse(Rgb::gray(0.8))));
    fill(&mut world, Sphere { radius: 0.8 }, DVec3::ZERO, boundary, cloud(1.8, 1.0).emitting(Spectrum::BLACK));
    world.shape(Sphere { radius: 0.2 }, at(DVec3::new(0.3, 0.1, 0.3)), matte, None);
    found.push(("a cloud", world));

    // Red fog around a lamp that is a point, with a ball in it that scatters forwards, in absorbing air that lets nothing arrive from the sky.
    let mut world = room(1.0);
    let boundary = interface(&mut world);
    let air = world.medium(Medium::new(gray(0.05), Spectrum::BLACK, Phase::Isotropic));
    world.surround(air);
    let fog = Medium::new(spectrum([0.02, 0.1, 0.2]), spectrum([0.5, 0.2, 0.1]), Phase::Isotropic);
    fill(&mut world, Cuboid { size: [1.8; 3] }, DVec3::ZERO, boundary, fog);
    let milk = Medium::new(gray(0.1), spectrum([1.0, 2.0, 4.0]), Phase::henyey_greenstein(0.6));
    fill(&mut world, Sphere { radius: 0.4 }, DVec3::new(0.2, -0.3, 0.2), boundary, milk);
    world.light(Light::Point(Point { position: DVec3::new(0.3, 0.4, 0.3), intensity: Rgb::new(0.3, 0.5, 0.8) }));
    world.light(Light::Environment(Environment { radiance: Rgb::new(0.5, 0.7, 1.0) }));
    found.push(("a point light in red fog", world));

    // A ball of smoke under the sun, seen from outside, with a matte ball in it.
    let mut world = World::builder(camera(DVec3::Z * 3.0, DVec3::ZERO));
    let (boundary, matte) = (interface(&mut world), world.material(Material::diffuse(Rgb::gray(0.5))));
    fill(&mut world, Sphere { radius: 0.9 }, DVec3::ZERO, boundary, cloud(1.9, 1.0).emitting(Spectrum::BLACK));
    world.shape(Sphere { radius: 0.2 }, at(DVec3::new(0.1, 0.0, 0.3)), matte, None);
    world
        .light(Light::Directional(Directional { direction: Vec3::new(-1.0, -2.0, -1.0).normalize(), irradiance: Rgb::new(3.0, 2.5, 2.0) }));
    found.push(("a cloud in parallel light", world));
    found
}

/// Paths from lights, whose points in media are connected to the camera, and `nee` converge to the same pictures. The two share what lies
/// between two points, and nothing of what chooses them.
#[test]
fn light_tracing_agrees_in_media() {
    let scenes = scenes_for_light();
    let level = sidak(0.01, scenes.len());
    for (seed, (name, world)) in (0..).zip(scenes) {
        let scene = Arc::new(world.build().expect(name));
        let lacks = ALL.iter().find(|entry| entry.name == "light").and_then(|entry| entry.lacks(scene.effects()));
        assert_eq!(lacks, None, "{name}");
        let from_lights = shot(scene.clone(), &LightTracer::default(), Kind::Independent, 100 + 2 * seed, 8 * SAMPLES);
        let from_camera = shot(scene.clone(), &Nee::default(), Kind::Independent, 101 + 2 * seed, 2 * SAMPLES);
        let of = |image, samples| SampledImage { image, samples };
        let found = agreement(of(&from_lights, 8 * SAMPLES), of(&from_camera, 2 * SAMPLES), level).expect("two pictures");
        assert!(found.accepts(), "{name}: {found}");
    }
}

/// `light` weakens what the camera sees by e^(−τ), and nothing arrives from the sky and the sun through a medium that is endless.
#[test]
fn light_tracing_knows_how_far_light_has_come() {
    let air = |world: &mut WorldBuilder| {
        let air = world.medium(Medium::new(gray(0.5), Spectrum::BLACK, Phase::Isotropic));
        world.surround(air);
    };
    let flat = || {
        let pose = pt::camera::Pose::new(&at(DVec3::Z * 2.0));
        World::builder(pt::camera::Camera::Orthographic(pt::camera::Orthographic { pose, height: 0.5 }))
    };
    let by_light = |world: WorldBuilder| shot(Arc::new(world.build().expect("a scene")), &LightTracer::default(), Kind::Sobol, 1, 64);

    let mut world = flat();
    let black = world.material(Material::diffuse(Rgb::gray(0.0)));
    world.shape(Quad { size: [4.0; 2] }, at(DVec3::ZERO), black, Some(Emitter::new(Rgb::gray(3.0))));
    air(&mut world);
    for pixel in by_light(world).pixels() {
        assert!((f64::from(pixel[1]) / (3.0 * (-1f64).exp()) - 1.0).abs() < 1e-5, "{pixel:?}");
    }

    let mut world = flat();
    let matte = world.material(Material::diffuse(Rgb::gray(0.8)));
    world.shape(Quad { size: [0.3; 2] }, at(DVec3::ZERO), matte, None);
    world.light(Light::Directional(Directional { direction: Vec3::NEG_Z, irradiance: Rgb::gray(3.0) }));
    world.light(Light::Environment(Environment { radiance: Rgb::gray(2.0) }));
    air(&mut world);
    assert!(by_light(world).pixels().flatten().all(|value| value == 0.0));
}

/// A point light within a ball that absorbs lights a wall outside with e^(−τ) of what it would without the ball, whatever path is taken.
#[test]
fn lights_within_bodies_shine_through_them() {
    let lit = |absorption: f64| {
        let scene = json!({"pt": 1, "camera": {"look_at": {"from": [0, 0, 2], "to": [0, 0, 0]}, "fov": 40}, "film": {"width": 16, "height": 16},
            "sampler": {"spp": 256}, "lights": [{"type": "point", "position": [0, 3, 3], "intensity": 9}],
            "shapes": [{"type": "quad", "size": 1, "material": {"type": "diffuse", "albedo": 0.8}}, {"type": "sphere", "radius": 0.5,
                "center": [0, 3, 3], "medium": {"type": "homogeneous", "absorption": absorption}}]});
        rendered(&scene, "light").into_iter().map(|value| f64::from(f32::from_bits(value))).sum::<f64>()
    };
    let ratio = lit(2.0) / lit(0.0);
    assert!((ratio / (-1f64).exp() - 1.0).abs() < 1e-4, "{ratio}");
}

/// The bits of a picture.
fn bits(image: &Image) -> Vec<u32> {
    image.pixels().flatten().map(f32::to_bits).collect()
}

/// A scene of other size has the same bits if the media are as much thinner.
#[test]
fn size_times_extinction_is_all_that_counts() {
    let scaled = |exponent: i32| {
        let scale = 2f64.powi(exponent);
        let mut world = room(scale);
        let boundary = interface(&mut world);
        let by = |s: Spectrum| s * (1.0 / scale) as f32;
        let smoke = Medium::new(by(spectrum([0.2, 0.5, 0.1])), by(spectrum([1.0, 0.4, 3.0])), Phase::henyey_greenstein(0.6));
        fill(&mut world, Sphere { radius: 0.6 * scale }, DVec3::ZERO, boundary, smoke);
        fill(&mut world, Cuboid { size: [0.8 * scale; 3] }, DVec3::Y * 0.5 * scale, boundary, cloud(scale, 1.0));
        let haze = world.medium(Medium::new(by(gray(0.02)), by(gray(0.2)), Phase::Rayleigh).emitting(gray(0.1)));
        world.surround(haze);
        Arc::new(world.build().expect("a room"))
    };
    for integrator in [&Path::default() as &dyn Integrator, &Nee::default()] {
        let wanted = bits(&shot(scaled(0), integrator, Kind::Sobol, 1, 4));
        for exponent in [-20, -3, 20] {
            assert!(bits(&shot(scaled(exponent), integrator, Kind::Sobol, 1, 4)) == wanted, "2^{exponent}");
        }
    }
}

/// Upper bounds of a density that are higher than they must be give the same picture.
#[test]
fn upper_bounds_do_not_matter() {
    let scene = |factor: f32| {
        let mut world = room(1.0);
        let boundary = interface(&mut world);
        fill(&mut world, Sphere { radius: 0.8 }, DVec3::ZERO, boundary, cloud(1.8, factor));
        Arc::new(world.build().expect("a cloud"))
    };
    let close = shot(scene(1.0), &Nee::default(), Kind::Independent, 0, SAMPLES);
    let factors = [2.0, 10.0, 100.0];
    for (seed, factor) in (1..).zip(factors) {
        let high = shot(scene(factor), &Nee::default(), Kind::Independent, seed, SAMPLES);
        let of = |image| SampledImage { image, samples: SAMPLES };
        let found = agreement(of(&close), of(&high), sidak(0.01, factors.len())).expect("two pictures");
        assert!(found.accepts(), "{factor}: {found}");
    }
}

/// A picture in media is the same with any number of threads and any tiles.
#[test]
fn threads_and_tiles_do_not_matter_in_media() {
    for (name, world) in scenes() {
        let scene = Arc::new(world.build().expect(name));
        let render = |threads: usize, tile: u32| {
            let mut film = pt::film::MomentFilm::new(FilmSpec::new(EDGE, EDGE));
            let sampler = SamplerSpec { kind: Kind::Sobol, spp: 4, ..SamplerSpec::default() };
            let settings = pt::render::Settings { tile, ..pt::render::Settings::new(sampler) };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| pt::render::render(scene.clone(), &Nee::default(), &mut film, &settings, &pt::render::Silent));
            bits(&film.image())
        };
        let wanted = render(1, 16);
        assert!(render(2, 5) == wanted && render(3, 1) == wanted, "{name}");
    }
}

/// A boundary within a medium changes no path: a cube of smoke cut into slices that touch has the picture of the whole cube, sample by
/// sample, but for the rounding of lengths.
#[test]
fn slices_of_smoke_are_the_whole() {
    let cut = |slices: u32| {
        let mut world = room(1.0);
        let boundary = interface(&mut world);
        let thickness = 1.0 / f64::from(slices);
        for k in 0..slices {
            let z = (f64::from(k) + 0.5) * thickness - 0.5;
            fill(&mut world, Cuboid { size: [1.0, 1.0, thickness] }, DVec3::Z * z, boundary, smoke());
        }
        Arc::new(world.build().expect("slices"))
    };
    let whole = shot(cut(1), &Nee::default(), Kind::Sobol, 0, 16);
    for slices in [2, 5, 12] {
        let parts = shot(cut(slices), &Nee::default(), Kind::Sobol, 0, 16);
        let off: f32 = parts.pixels().zip(whole.pixels()).flat_map(|(a, b)| (0..3).map(move |c| (a[c] - b[c]).abs())).sum();
        let all: f32 = whole.pixels().flatten().sum();
        // A path that rounding leads past an edge is another path; there are few.
        assert!(off < 2e-3 * all, "{slices} slices: {off} of {all}");
    }
}

/// A box without a medium and without a surface changes nothing, and neither does the way in which a gray medium is written down.
#[test]
fn what_is_not_there_does_not_show() {
    let base = json!({"pt": 1, "camera": {"look_at": {"from": [0, 1, 4], "to": [0, 0.5, 0]}}, "film": {"width": 24, "height": 16},
        "sampler": {"spp": 4}, "lights": [{"type": "point", "position": [1, 3, 1], "intensity": 20}], "background": {"radiance": 0.1},
        "shapes": [{"type": "quad", "size": 10, "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}}]}]});
    let with = |shape: Value| {
        let mut scene = base.clone();
        scene["shapes"].as_array_mut().expect("shapes").push(shape);
        scene
    };
    let block = |medium: Value, material: Value| {
        let mut shape = json!({"type": "box", "size": 1, "center": [0, 0.5, 0]});
        for (key, value) in [("medium", medium), ("material", material)].into_iter().filter(|(_, value)| !value.is_null()) {
            shape[key] = value;
        }
        with(shape)
    };
    let boundary = json!({"type": "interface"});
    for integrator in ["nee", "path"] {
        let empty = rendered(&base, integrator);
        assert!(rendered(&block(Value::Null, boundary.clone()), integrator) == empty, "{integrator}: an interface");
        let nothing = json!({"type": "homogeneous"});
        assert!(rendered(&block(nothing, Value::Null), integrator) == empty, "{integrator}: a medium of nothing");
        let varying = |scattering: Value, values: Value| {
            let density = json!({"type": "grid", "size": [2, 1, 1], "values": values, "transform": [{"translate": [-0.5, 0, -0.5]}]});
            block(json!({"type": "heterogeneous", "scattering": scattering, "absorption": 0.25, "density": density}), Value::Null)
        };
        assert!(rendered(&varying(json!(2), json!([0, 0])), integrator) == empty, "{integrator}: a density of 0");
        let gray = rendered(&varying(json!(2), json!([0.5, 2])), integrator);
        assert!(gray == rendered(&varying(json!([2, 2, 2]), json!([0.5, 2])), integrator) && gray != empty, "{integrator}: gray");
        let fog = |scattering: Value| block(json!({"type": "homogeneous", "scattering": scattering, "absorption": 0.25}), Value::Null);
        let gray = rendered(&fog(json!(2)), integrator);
        assert!(gray == rendered(&fog(json!([2, 2, 2])), integrator) && gray != empty, "{integrator}: a gray medium");
    }
}

/// Grids of equal albedos and emissions give the bits of the medium without them, in numbers, in files of Mitsuba and pbrt, and in floats.
#[test]
fn grids_of_equal_colors_do_not_show() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, parts: &[&[u8]]| {
        let path = folder.path().join(name);
        fs::write(&path, parts.concat()).expect("written");
        path
    };
    let floats = |values: &[f32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let volume = |name: &str, channels: u8, values: &[f32]| {
        let counts = [1u8, 1, 1, 2, channels].map(|count| [count, 0, 0, 0]).concat();
        file(name, &[b"VOL\x03", &counts, &floats(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), &floats(values)])
    };
    let albedo = [0.5f32, 0.25, 1.0];
    let colors = [albedo, albedo].concat();
    let lescale =
        "MakeNamedMedium \"a\" \"string type\" \"uniformgrid\" \"integer nx\" 1 \"integer ny\" 1 \"integer nz\" 2 \"float Lescale\" [2 2]";

    let picture = |medium: Value| {
        let mut medium = medium;
        medium["type"] = json!("heterogeneous");
        medium["density"] = json!({"type": "grid", "size": [2, 1, 1], "values": [0.5, 2]});
        let scene = json!({"pt": 1, "camera": {"look_at": {"from": [0.5, 0.5, 3], "to": [0.5, 0.5, 0.5]}, "fov": 30}, "sampler": {"spp": 4},
            "film": {"width": 12, "height": 12}, "background": {"radiance": 0.5},
            "shapes": [{"type": "box", "size": 1, "center": [0.5, 0.5, 0.5], "medium": medium}]});
        let (folder, _) = run(&scene, &["-i", "nee", "--allow-outside", "-o", "x.exr"]);
        bits(&pt::output::exr::read(&folder.path().join("x.exr")).expect("a picture").0)
    };
    // All numbers are powers of two or sums of two, so that no operation rounds.
    let plain = picture(json!({"scattering": [2, 0.5, 8], "absorption": [2, 1.5, 0], "emission": 1}));
    let files = [volume("albedo.vol", 3, &colors), file("albedo.raw", &[&floats(&colors)])];
    let numbers = json!({"size": [1, 1, 2], "values": [albedo, albedo]});
    let grids = [numbers, json!({"file": files[0]}), json!({"file": files[1], "size": [1, 1, 2], "values_at": "corners"})];
    for grid in grids {
        let found = picture(json!({"scattering": [4, 2, 8], "emission": 1, "albedo_grid": grid}));
        assert!(found == plain, "{grid}");
    }
    let files = [volume("glow.vol", 1, &[2.0, 2.0]), file("glow.pbrt", &[lescale.as_bytes()]), file("glow.raw", &[&floats(&[2.0])])];
    let grids = [json!({"file": files[0]}), json!({"file": files[1]}), json!({"file": files[2], "size": [1, 1, 1]})];
    for grid in grids {
        let found = picture(json!({"scattering": [2, 0.5, 8], "absorption": [2, 1.5, 0], "emission": 0.5, "emission_grid": grid}));
        assert!(found == plain, "{grid}");
    }
}

/// Media of a group are where its instances show them: the picture is that of the same shapes in the places of the instances, path by path,
/// but for rounding. The density is placed with the group, and the coefficients stay per metre of the world.
#[test]
fn instances_show_the_media_of_their_group() {
    let places = [
        json!([{"translate": [-1, 0.6, 0]}]),
        json!([{"scale": 0.5}, {"rotate": {"axis": [0, 1, 1], "degrees": 70}}, {"translate": [1, 1, 0.5]}]),
    ];
    // A cloud in a ball, in a box of milk glass; and a lamp that is a body, too.
    let shapes = |steps: &Value| {
        let mut density = json!({"type": "noise", "resolution": 24, "transform": [{"translate": [-0.5, -0.5, -0.5]}]});
        let steps = steps.as_array().cloned().unwrap_or_default();
        density["transform"].as_array_mut().expect("steps").extend(steps.clone());
        let cloud = json!({"type": "heterogeneous", "scattering": [20, 12, 8], "density": density,
            "albedo_grid": {"size": [1, 2, 1], "values": [1, [1, 0.6, 0.4]]}});
        let milk = json!({"type": "homogeneous", "scattering": 1, "absorption": [0.1, 0.3, 0.6], "phase": {"type": "henyey_greenstein", "g": 0.5}});
        let flame = json!({"type": "homogeneous", "absorption": 3, "scattering": 1});
        json!([{"type": "group", "transform": steps, "shapes": [
            {"type": "sphere", "radius": 0.5, "medium": cloud},
            {"type": "box", "size": 1.2, "medium": milk, "material": {"type": "dielectric", "eta": 1.2, "roughness": 0.3}},
            {"type": "sphere", "radius": 0.2, "center": [0, 0, 0.9], "medium": flame, "material": {"type": "dielectric"}, "emission": 2}]}])
    };
    let scene = |groups: Value, shown: Value| {
        let ground = json!({"type": "quad", "size": 10, "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}}]});
        let mut scene = json!({"pt": 1, "camera": {"look_at": {"from": [0, 1.2, 4], "to": [0, 0.7, 0]}}, "film": {"width": 24, "height": 16},
            "sampler": {"spp": 16}, "lights": [{"type": "point", "position": [1, 4, 2], "intensity": 20}], "background": {"radiance": 0.3}});
        scene["groups"] = groups;
        scene["shapes"] = json!([vec![ground], shown.as_array().cloned().unwrap_or_default()].concat());
        scene
    };
    let values = |scene: &Value| rendered(scene, "nee").into_iter().map(|bits| f64::from(f32::from_bits(bits))).collect::<Vec<f64>>();
    let direct = values(&scene(json!({}), json!([shapes(&places[0])[0], shapes(&places[1])[0]])));
    let placements = places.each_ref().map(|steps| json!({"transform": steps}));
    let shown =
        values(&scene(json!({"puff": shapes(&json!([]))}), json!([{"type": "instances", "group": "puff", "placements": placements}])));
    // Within each other: the second instance is one of a group in a group.
    let [first, second] = placements;
    let groups = json!({"puff": shapes(&json!([])), "pair": [{"type": "instances", "group": "puff", "placements": [first]},
        {"type": "instances", "group": "puff", "placements": [second]}]});
    let nested = values(&scene(groups, json!([{"type": "instances", "group": "pair"}])));
    for (found, what) in [(shown, "instances"), (nested, "instances in instances")] {
        let off: f64 = found.iter().zip(&direct).map(|(a, b)| (a - b).abs()).sum();
        let all: f64 = direct.iter().sum();
        // A path that rounding leads past an edge is another path; there are few.
        assert!(off < 5e-3 * all, "{what}: {off} of {all}");
    }

    // A slab of one metre, in an instance of twice the size, is one of two metres.
    let slab = json!([{"type": "box", "size": [9, 9, 1], "medium": {"type": "homogeneous", "absorption": 0.5}}]);
    let mut behind = json!({"pt": 1, "camera": {"look_at": {"from": [0, 0, 4], "to": [0, 0, 0]}, "fov": 1}, "film": {"width": 2, "height": 2},
        "sampler": {"spp": 1}, "background": {"radiance": 1}, "shapes": [{"type": "instances", "group": "slab"}]});
    behind["groups"] = json!({"slab": slab});
    for (scale, depth) in [(1.0, 0.5f64), (2.0, 1.0)] {
        behind["shapes"][0]["placements"] = json!([{"transform": [{"scale": scale}]}]);
        let [found, ..] = values(&behind)[..] else { panic!("a picture") };
        assert!((found / (-depth).exp() - 1.0).abs() < 1e-4, "{scale}: {found}");
    }
}

/// Where two bodies with media overlap, the medium of the smaller one counts, however the bodies are turned; if both are equally large, the one
/// that the scene describes last. A ray along the axis of a rod within a cube is absorbed by the rod alone, and one through two equal cubes
/// by the second alone.
#[test]
fn turned_bodies_are_as_large_as_before() {
    let behind = |from: DVec3, shapes: Value| {
        let scene = json!({"pt": 1, "camera": {"look_at": {"from": from.to_array(), "to": [0, 0, 0], "up": [0.3, 0.5, 0.1]}, "fov": 0.1},
            "film": {"width": 1, "height": 1}, "sampler": {"spp": 1}, "background": {"radiance": 1}, "shapes": shapes});
        f64::from(f32::from_bits(rendered(&scene, "nee")[0]))
    };
    let body = |size: Value, absorption: f64, axis: DVec3, degrees: f64| {
        json!({"type": "box", "size": size, "medium": {"type": "homogeneous", "absorption": absorption},
            "transform": [{"rotate": {"axis": axis.to_array(), "degrees": degrees}}]})
    };
    let agrees = |found: f64, depth: f64, what: &str| {
        // The optical depth is rounded to f32 a few times.
        assert!((found / (-depth).exp() - 1.0).abs() < 1e-5, "{what}: {found}, not {}", (-depth).exp());
    };
    for (axis, degrees) in [(DVec3::X, 0.0f64), (DVec3::new(1.0, 1.0, 0.0), 45.0), (DVec3::new(1.0, 2.0, 3.0), 70.0)] {
        let along = DQuat::from_axis_angle(axis.normalize(), degrees.to_radians()) * DVec3::Z;
        let (rod, cube) = (body(json!([0.2, 0.2, 2]), 0.25, axis, degrees), body(json!(0.5), 4.0, DVec3::X, 0.0));
        for shapes in [json!([rod, cube]), json!([cube, rod])] {
            agrees(behind(4.0 * along, shapes), 0.5, &format!("a rod turned by {degrees} degrees"));
        }
    }
    for degrees in (0..90).step_by(7) {
        let degrees = f64::from(degrees);
        let cubes = json!([body(json!(1), 1.0, DVec3::Z, degrees), body(json!(1), 3.0, DVec3::Z, 2.0 * degrees)]);
        agrees(behind(4.0 * DVec3::Z, cubes), 3.0, &format!("cubes turned by {degrees} degrees"));
    }
}

/// A large ball of a medium with an albedo, without a surface: in even light, an orthographic picture of it shows the albedo in the mean over
/// its disk.
#[test]
fn translucent_bodies_have_their_albedo() {
    let albedo = [0.8, 0.5, 0.2];
    for g in [0.0, 0.6] {
        let wax = json!({"type": "subsurface", "albedo": albedo, "mean_free_path": [1e-3, 2e-3, 4e-3], "g": g, "scale": 0.5});
        let scene = json!({"pt": 1, "camera": {"type": "orthographic", "height": 2, "look_at": {"from": [0, 0, 4], "to": [0, 0, 0]}},
            "film": {"width": 24, "height": 24, "filter": {"type": "box"}}, "integrator": {"type": "path", "max_depth": 4096},
            "sampler": {"spp": 64}, "background": {"radiance": 1}, "shapes": [{"type": "sphere", "medium": wax}]});
        let (folder, _) = run(&scene, &["-o", "x.exr"]);
        let (found, _) = pt::output::read(&folder.path().join("x.exr")).expect("a picture");
        let mean = |c: usize| found.pixels().map(|rgb| f64::from(rgb[c])).sum::<f64>() / f64::from(24 * 24);
        // Outside of the disk, a share of 1 − π/4, the picture is 1. The formula has an error of 0.01, the mean of 0.003.
        let disk = std::f64::consts::FRAC_PI_4;
        for (c, wanted) in albedo.into_iter().enumerate() {
            let found = 1.0 - (1.0 - mean(c)) / disk;
            assert!((found - wanted).abs() < 0.02, "g = {g}, channel {c}: {found}, not {wanted}");
        }
    }
}

/// A cloud from a `.vol` file over a bowl, as Mitsuba's own test has it, beside its reference picture.
#[test]
fn clouds_are_those_of_mitsuba() {
    let Some(data) = shared("mitsuba") else { return };
    let test = data.join("tests/scenes/participating_media");
    let mesh = |name: &str| test.join("meshes").join(name);
    // Mitsuba gives the extinction and the albedo, counts the ray of the camera in its depth, and turns v upside down.
    let density =
        json!({"type": "grid", "file": test.join("textures/sigmat.vol"), "bounds": {"low": [-0.5, -0.5, -0.5], "high": [1, 1, 1]}});
    let scene = json!({"pt": 1, "camera": {"look_at": {"from": [0, 0.5, 4], "to": [0, -0.5, 0]}, "fov": 34.022_057},
        "film": {"width": 48, "height": 48, "filter": {"type": "box"}}, "integrator": {"type": "nee", "max_depth": 5},
        "sampler": {"type": "sobol", "spp": 512},
        "background": {"image": data.join("common/textures/museum.exr"), "transform": [{"rotate": {"axis": [0, 1, 0], "degrees": 180}}]},
        "media": {"cloud": {"type": "heterogeneous", "scattering": [4.95, 2.5, 2.5], "absorption": [0.05, 2.5, 2.5], "density": density}},
        "shapes": [
            {"type": "mesh", "file": mesh("background.obj"),
                "material": {"type": "diffuse", "albedo": {"type": "checker", "even": 0.4, "odd": 0.2, "scale": 32}}},
            {"type": "mesh", "file": mesh("unit_cube_centered.obj"), "medium": "cloud", "transform": [{"scale": 1.5}]},
            {"type": "mesh", "file": mesh("sphere_base.obj"), "material": {"type": "diffuse", "albedo": 0.5}}]});
    let (folder, _) = run(&scene, &["--allow-outside", "-o", "x.exr"]);
    let (found, _) = pt::output::read(&folder.path().join("x.exr")).expect("a picture");
    let (wanted, _) = pt::output::read(&test.join("refs/test_hetero_sigmat_ref_rgb.pfm")).expect("a picture");
    let sum = |of: &dyn Fn([f32; 3], [f32; 3]) -> f64| found.pixels().zip(wanted.pixels()).map(|(a, b)| of(a, b)).sum::<f64>();
    for c in 0..3 {
        // The two agree on environment maps to 0.4 % here, since Mitsuba's first and last row lie at the poles; the mean has an error of 0.1 %.
        let ratio = sum(&|a, _| a[c].into()) / sum(&|_, b| b[c].into());
        assert!((ratio - 1.0).abs() < 7e-3, "channel {c}: {ratio}");
    }
    // The error of a pixel is about 3 % here, and 2 % of what it shows.
    let relative = |a: f32, b: f32| f64::from((a - b) / b).powi(2) / 3.0;
    let squares = sum(&|a, b| (0..3).map(|c| relative(a[c], b[c])).sum()) / f64::from(48 * 48);
    assert!(squares.sqrt() < 0.045, "{}", squares.sqrt());
}

/// The bits of a scene's picture as the program renders it.
fn rendered(scene: &Value, integrator: &str) -> Vec<u32> {
    let (folder, _) = run(scene, &["-i", integrator, "-o", "x.exr"]);
    bits(&pt::output::exr::read(&folder.path().join("x.exr")).expect("a picture").0)
}

/// Runs the program on a scene; returns its folder and what it says.
fn run(scene: &Value, args: &[&str]) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("s.json"), scene.to_string()).expect("written");
    let mut command = Command::cargo_bin("pt").expect("the program");
    let run = command.current_dir(folder.path()).args(["s.json", "--progress", "none"]).args(args).assert().success();
    let output = run.get_output();
    let said = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat();
    (folder, said)
}

/// What is recorded of a path in media adds up to its radiance, and each vertex follows from the one before: it lies at the recorded
/// distance in the recorded direction, and a gray medium multiplies the throughput by its albedo.
#[test]
fn paths_in_media_are_recorded() {
    let mut world = room(1.0);
    let haze = world.medium(Medium::new(gray(0.5), gray(1.5), Phase::henyey_greenstein(0.4)));
    world.surround(haze);
    let scene: Arc<dyn Scene> = Arc::new(world.build().expect("a room"));
    let spec = FilmSpec::new(EDGE, EDGE);
    let estimator = Nee::default().prepare(scene.clone(), &spec);
    let sequence = SamplerSpec::default().build();
    let (mut in_media, mut checked) = (0, 0);
    for k in 0..2000u32 {
        let (pixel, aspect) = (UVec2::new(k % EDGE, k / EDGE % EDGE), 1.0);
        let ray = scene.camera().ray((pixel.as_vec2() + 0.5) / EDGE as f32, aspect, pt::math::Vec2::ZERO, 0.0);
        let camera = pt::integrator::CameraSample {
            ray,
            weight: 1.0,
            pixel,
            raster: pixel.as_vec2() + 0.5,
            known_hit: None,
            inside: *scene.media().expect("haze").at_camera(),
            differential: None,
        };
        let mut events: Vec<Event> = vec![];
        let numbers = sequence.sample(pixel, k.into());
        let mut cx = Context { numbers, recorder: Some(&mut events), interrupt: Interrupt::NEVER, light_path: None };
        let radiance = estimator.li(&camera, &mut cx);
        let sum = events.iter().filter_map(|e| if let Event::Light(light) = e { Some(light.value) } else { None });
        assert_eq!(sum.fold(Spectrum::BLACK, |sum, value| sum + value), radiance);
        let (mut place, mut direction, mut beta) = (ray.origin, ray.direction, Spectrum::ONE);
        for event in &events {
            let (point, distance, wo, arrived, albedo) = match event {
                Event::Vertex(v) => (v.point, v.distance, v.wo, v.beta, 1.0),
                Event::Medium(v) => (v.point, v.distance, v.wo, v.beta, 0.75),
                Event::Scattering(s) => {
                    (direction, beta) = (s.wi, beta * s.weight * (1.0 / s.survival));
                    continue;
                }
                Event::End { why: End::Absorbed, .. } => break,
                _ => continue,
            };
            assert!((place + direction * distance - point).length() < 1e-4, "{event:?}");
            assert!((wo + direction).length() < 1e-6, "{event:?}");
            assert!((arrived - beta * albedo).map(f32::abs).max() < 1e-5 * beta.max(), "{event:?} after {beta:?}");
            (place, beta) = (point, arrived);
            in_media += u32::from(albedo < 1.0);
            checked += 1;
        }
    }
    assert!(in_media > 2000 && checked > in_media, "{in_media} of {checked}");
}

/// Faults of media, each at its place.
#[test]
fn faults_of_media_have_their_place() {
    assert_fault_in_scene(&[
        (r#""medium": ^"mist", "media": {"fog": {"type": "homogeneous"}}"#, "/medium: unknown medium \"mist\""),
        (
            r#""media": {"fog": {"type": "homogeneous", "phase": {"type": "henyey_greenstein", "g": ^0.9995}}}"#,
            "/media/fog/phase/g: expected a number from -0.999 to 0.999, found 0.9995",
        ),
        (r#""media": {"fog": {"type": "homogeneous", "absorption": ^-1}}"#, "/media/fog/absorption: expected a number from 0 to 1e30"),
        (r#""media": {"fog": {"type": "homogeneous", "absorption": [0, ^1e31, 0]}}"#, "/media/fog/absorption/1: expected a number"),
        (r#""media": {"fog": {"type": ^"cloud"}}"#, "/media/fog/type: unknown"),
        (r#""media": {"fog": ^{"type": "heterogeneous"}}"#, "/media/fog: missing key \"density\""),
        (
            r#""media": {"wax": ^{"type": "subsurface", "albedo": 0.5}}"#,
            "/media/wax: expected \"measured\", or albedo and mean_free_path: no \"mean_free_path\"",
        ),
        (
            r#""media": {"wax": {"type": "subsurface", "albedo": ^0.5, "measured": "skin1"}}"#,
            "/media/wax/albedo: give \"measured\", or albedo and mean_free_path, not both",
        ),
        (r#""media": {"wax": {"type": "subsurface", "measured": ^"wax"}}"#, "/media/wax/measured: unknown name \"wax\""),
        (
            r#""media": {"fog": {"type": "heterogeneous", "density": ^{"type": "grid"}}}"#,
            "/media/fog/density: expected a \"file\", or \"size\" and \"values\"",
        ),
        (
            r#""media": {"fog": {"type": "heterogeneous", "density": {"type": "grid", "size": [2, 2, 1], "values": ^[1, 2]}}}"#,
            "/media/fog/density/values: expected 2 × 2 × 1 = 4 values, found 2",
        ),
        (
            r#""media": {"fog": {"type": "heterogeneous", "density": {"type": "grid", "values": ^[1, 2]}}}"#,
            "/media/fog/density/values: expected a \"size\"",
        ),
        (
            r#""media": {"fog": {"type": "heterogeneous", "density": {"type": "grid", "size": [1, 1, 1], "values": [^-1]}}}"#,
            "/media/fog/density/values/0: expected a number from 0 to 1e30",
        ),
        (
            r#""media": {"fog": {"type": "heterogeneous", "density": {"type": "grid", "size": [1, 1, 1], "values": [1],
                "bounds": {"low": [0, 0, 0], "high": [1, ^0, 1]}}}}"#,
            "/media/fog/density/bounds/high/1: expected a number above 0, that of low, found 0",
        ),
        (
            r#""media": {"fog": {"type": "heterogeneous", "density": {"type": "exponential", "scale_height": 1},
                "albedo_grid": {"size": [1, 1, 2], "values": [0.5, ^[0.5, 1.25, 1]]}}}"#,
            "/media/fog/albedo_grid/values/1: expected albedos from 0 to 1, found 1.25",
        ),
        (
            r#""media": {"fog": {"type": "heterogeneous", "density": {"type": "exponential", "scale_height": 1},
                "emission_grid": {"size": [1, 1, 2], "values": ^[1]}}}"#,
            "/media/fog/emission_grid/values: expected 1 × 1 × 2 = 2 values, found 1",
        ),
        (r#""shapes": [{"type": "quad", ^"medium": {"type": "homogeneous"}}]"#, "/shapes/0/medium: unknown key"),
        (
            r#""groups": {"g": [{"type": "sphere", "medium": {"type": "homogeneous"}}], "h": [{"type": "instances", "group": "g"}]},
                "shutter": {"open": 0, "close": 1}, "shapes": [{"type": "instances", "group": ^"h", "placements": [{"transform": [{"keyframes": [
                {"time": 0, "transform": []}, {"time": 1, "transform": [{"translate": [1, 0, 0]}]}]}]}]}]"#,
            "/shapes/0/group: a shape that contains a medium cannot move",
        ),
        (
            r#""groups": {"g": [{"type": "sphere", "medium": {"type": "homogeneous"}}]}, "shapes": [{"type": "instances", "group": "g",
                "material": ^{"type": "masked", "surface": {"type": "diffuse"}, "opacity": 0.5}}]"#,
            "/shapes/0/material: a shape of this group contains a medium: a shape with holes cannot",
        ),
        (
            r#""shapes": [{"type": "sphere", "medium": {"type": "homogeneous"}, "emission": ^1}]"#,
            "/shapes/0/emission: what is only the boundary of a medium has no surface that could emit",
        ),
        (
            r#""shapes": [{"type": "sphere", "medium": ^{"type": "homogeneous"},
                "material": {"type": "masked", "surface": {"type": "diffuse"}, "opacity": 0.5}}]"#,
            "/shapes/0/medium: a shape with holes cannot contain a medium",
        ),
        (
            r#""shapes": [{"type": "sphere", "medium": ^{"type": "homogeneous"},
                "material": {"type": "dielectric", "absorption": {"color": 0.5, "distance": 1}}}]"#,
            "/shapes/0/medium: the material has an \"absorption\" of its own",
        ),
    ]);
}

/// Media whose numbers no ray could be followed with are refused when the scene is built.
#[test]
fn impossible_media_are_refused() {
    let dense = json!({"type": "grid", "size": [2, 1, 1], "values": [1, 1e9]});
    let color_volume = |albedo: f32| {
        let box_of_two = [0f32, 0.0, 0.0, 1.0, 1.0, 2.0, 0.5, 0.5, albedo].map(f32::to_le_bytes).concat();
        [b"VOL\x03".as_slice(), &[1, 1, 1, 1, 3].map(|count| [count, 0, 0, 0]).concat(), &box_of_two].concat()
    };
    let varying = |key: &str, grid: Value| {
        let mut medium =
            json!({"type": "heterogeneous", "scattering": 1, "emission": 2, "density": {"type": "exponential", "scale_height": 1}});
        medium[key] = grid;
        medium
    };
    let of_media = [
        (varying("density", json!({"type": "grid", "file": "half.vol"})), "half.vol: expected one channel, the density, found 3"),
        (
            varying("albedo_grid", json!({"file": "half.vol"})),
            "/shapes/0/medium/albedo_grid/file: half.vol: expected the box of the density, from",
        ),
        (varying("albedo_grid", json!({"file": "two.vol"})), "two.vol: expected albedos from 0 to 1, found 2 at x 0, y 0, z 0"),
        (varying("albedo_grid", json!({"file": "a.pbrt"})), "a.pbrt: media of pbrt have no grid of albedos"),
        (varying("emission_grid", json!({"size": [1, 1, 1], "values": [1e30]})), "/shapes/0/medium/emission_grid: an emission of 2.0e30"),
        (json!({"type": "heterogeneous", "scattering": 1, "density": dense}), "/shapes/0/medium/density: an optical depth of"),
        (
            json!({"type": "subsurface", "albedo": 1, "mean_free_path": 1e-30, "scale": 1e-20}),
            "/shapes/0/medium: coefficients beyond the range",
        ),
    ];
    let sphere = |medium: Value| json!({"type": "sphere", "medium": medium});
    let group = json!({"g": [sphere(varying("density", json!({"type": "noise", "resolution": 8})))]});
    let huge = json!({"type": "instances", "group": "g", "placements": [{"transform": [{"scale": 1e8}]}]});
    let of_media = of_media.into_iter().map(|(medium, expected)| (sphere(medium), expected));
    for (shape, expected) in of_media.chain([(huge, "an instance gives a medium an optical depth of")]) {
        let scene = json!({"pt": 1, "camera": {}, "groups": group, "shapes": [shape]});
        let folder = tempfile::tempdir().expect("a folder");
        let files = [
            ("s.json", scene.to_string().into_bytes()),
            ("half.vol", color_volume(0.5)),
            ("two.vol", color_volume(2.0)),
            ("a.pbrt", vec![]),
        ];
        files.into_iter().for_each(|(name, bytes)| fs::write(folder.path().join(name), bytes).expect("written"));
        let refused = Command::cargo_bin("pt").expect("the program").current_dir(folder.path()).arg("s.json").assert().code(3);
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(said.contains(expected), "{said}");
    }
}

/// Integrators that lack media say so, and those that have them do not; and a trace names the media of a path.
#[test]
fn media_are_told_of() {
    let scene = json!({"pt": 1, "camera": {"look_at": {"from": [0, 0, 3], "to": [0, 0, 0]}}, "film": {"width": 8, "height": 8},
        "sampler": {"spp": 1}, "media": {"fog": {"type": "homogeneous", "scattering": 5}}, "background": {"radiance": 1},
        "shapes": [{"type": "sphere", "medium": "fog"}]});
    for entry in ALL.iter().filter(|entry| !entry.simulates.is_empty()) {
        let (_, said) = run(&scene, &["-i", entry.name, "-o", "x.exr"]);
        let lacks = said.contains("does not simulate") && said.contains("participating media");
        assert_eq!(lacks, !["path", "nee", "light"].contains(&entry.name), "{}: {said}", entry.name);
    }
    let (_, said) = run(&scene, &["--pixel", "4,4", "--sample", "0", "--trace"]);
    assert!(said.contains("fog (isotropic), at ("), "{said}");
    // What a medium emits is light.
    for (emission, is_black) in [(1, false), (0, true)] {
        let mut scene = scene.clone();
        scene.as_object_mut().expect("an object").remove("background");
        scene["media"]["fog"] = json!({"type": "homogeneous", "absorption": 1, "emission": emission});
        let (_, said) = run(&scene, &["-o", "x.exr"]);
        assert_eq!(said.contains("no light, the image will be black"), is_black, "{said}");
    }
}
