//! Light and distance fields: glass, parts with different materials, and emission that paths find by chance; and what the integrator `card`
//! adds to `path`.

use std::sync::Arc;

use glam::DVec3;
use pt::bsdf::Material;
use pt::camera::{Camera, Perspective, Pose};
use pt::describe::{Direction, Positive, Radiometric};
use pt::effects::Effects;
use pt::film::FilmSpec;
use pt::integrator::Integrator;
use pt::integrators::card::{Card, Hemisphere};
use pt::integrators::path::Path;
use pt::light::{Environment, Light};
use pt::math::{Rgb, Transform};
use pt::sampler::SamplerSpec;
use pt::scene::Scene;
use pt::shape::sdf::*;
use pt::shape::{Quad, Sdf};
use pt::world::{PartAppearance, World, WorldBuilder};

use crate::scenes::{Depth, Effort, KnownRadiance, black, confirm, facing, glow, gray, measure, picture, probe, stored};

fn ball(radius: f64) -> Field {
    Field::Ball(Ball { center: DVec3::ZERO, radius })
}

fn sampler(spp: u64) -> SamplerSpec {
    SamplerSpec { spp, ..SamplerSpec::default() }
}

/// A solid of clear glass in uniform light is invisible: every path ends in a radiance of 1.
///
/// The tolerance is 2⁻¹⁴: some hundred vertices, each with a few roundings of 2⁻²⁴.
#[test]
fn glass_is_invisible_in_a_furnace() {
    let hollow = Field::Difference(Difference { from: ball(1.0).into(), minus: vec![ball(0.8)] });
    let arch = Field::Ring(Ring { center: DVec3::ZERO, radius: 0.8, tube: 0.3, half: true });
    let joined = Field::SmoothUnion(SmoothUnion { of: vec![ball(0.5), arch], width: 0.3 });
    for field in [ball(1.0), hollow, joined] {
        let place = Transform::look_at(DVec3::new(0.4, 0.3, 3.0), DVec3::new(0.1, 0.2, 0.0), DVec3::Y).expect("a view");
        let mut world = World::builder(Camera::Perspective(Perspective::new(Pose::new(&place), 50.0, 0.0, 1.0)));
        let glass = world.material(Material::glass(1.5));
        world.solid(Sdf::new(field.clone()), Transform::IDENTITY, vec![PartAppearance { material: glass, emitter: None }]);
        world.light(Light::Environment(Environment { radiance: Rgb::WHITE }));
        let path = Path { max_depth: 1000, roulette_depth: 1000 };
        let image = picture(Arc::new(world.build().expect("a world")), &path, FilmSpec::new(16, 16), sampler(16));
        let farthest = image.pixels().flatten().map(|v| (v - 1.0).abs()).fold(0.0, f32::max);
        assert!(farthest <= 2f32.powi(-14), "{farthest:e} with {field:?}");
    }
}

/// A matte floor under a ball of radiance L: E = π L (r/h)², so that the floor has the radiance ρ L (r/h)².
fn lamp(radius: f64, height: f64) -> WorldBuilder {
    let mut world = World::builder(probe(DVec3::new(2.0, 1.0, 0.0), DVec3::ZERO));
    let (matte, dark) = (world.material(Material::diffuse(stored(gray(0.5)))), world.material(black()));
    world.shape(Quad { size: [20.0; 2] }, facing(DVec3::ZERO, DVec3::Y), matte, None);
    let lamp = Sdf { parts: Union::new(vec![ball(radius), ball(0.5 * radius)]), ..Sdf::new(ball(radius)) };
    let parts = vec![PartAppearance { material: dark, emitter: glow(4.0) }, PartAppearance { material: dark, emitter: None }];
    world.solid(lamp, Transform::translate(DVec3::Y * height).expect("finite"), parts);
    world
}

/// Points on a field's surface cannot be sampled as a light. Paths find its emission by chance and count it once, with and without light
/// sampling.
#[test]
fn emission_of_fields_is_found_by_chance() {
    let (radius, height) = (0.8, 1.0f64);
    let wanted = 0.5 * 4.0 * (radius / height).powi(2);
    let depth = Depth { max: 1, roulette: 8 };
    let law = KnownRadiance::new("a ball over a floor", lamp(radius, height), wanted, depth);
    confirm(vec![law.resolution(5e-3, 5e-3).by_chance(5e-3).not_by_lights_alone()], Effort::Standard);

    let scene = lamp(radius, height).build().expect("a world");
    assert!(scene.effects().contains(Effects::UNSAMPLED_EMITTER) && scene.lights().has_emission());
    assert!(
        scene.lights().sample(&pt::light::LightSampleContext::at(glam::Vec3::ZERO), 0.5, glam::Vec2::splat(0.5)).is_none(),
        "nothing to sample"
    );
}

/// A disk of light overhead that covers the directions up to the angle θ from the normal. With cosine-weighted directions its share of the
/// irradiance is sin²θ, with directions uniform in the angle it is θ/90°.
///
/// At 45° both are ½. The test uses 30°, where they are ¼ and ⅓.
#[test]
fn only_the_cosine_is_right() {
    let half_width = 30f64.to_radians().tan();
    let mut world = World::builder(probe(DVec3::new(4.0, 0.5, 0.0), DVec3::ZERO));
    let (matte, dark) = (world.material(Material::diffuse(stored(gray(0.5)))), world.material(black()));
    world.shape(Quad { size: [20.0; 2] }, facing(DVec3::ZERO, DVec3::Y), matte, None);
    world.shape(pt::shape::Disk { radius: half_width }, facing(DVec3::Y, -DVec3::Y), dark, glow(1.0));
    let scene = Arc::new(world.build().expect("a world"));
    let mean = |hemisphere| {
        let card = Card { max_depth: 1, hemisphere, ..Card::default() };
        measure(scene.clone(), &card, 1 << 18, 1)
    };
    for (hemisphere, wanted) in [(Hemisphere::Cosine, 0.5 / 4.0), (Hemisphere::Angle, 0.5 / 3.0)] {
        let found = mean(hemisphere);
        assert!(found.z(wanted).abs() < 5.0, "{hemisphere:?}: {} ± {}, not {wanted}", found.value, found.standard_error());
        assert!(found.standard_error() < 0.01 * wanted);
    }
}

/// Without its own options `card` gives the same samples as `path`.
#[test]
fn card_is_path_to_the_bit() {
    for seed in 0..4 {
        let scene = crate::agreement::generated(seed, seed % 2 == 0);
        let card = picture(scene.clone(), &Card::default(), FilmSpec::new(16, 16), sampler(8));
        let path = picture(scene, &Path::default(), FilmSpec::new(16, 16), sampler(8));
        assert_eq!(card, path, "scene {seed}");
    }
    // Textures, averaged over what a pixel shows.
    let floor = r#"{ "pt": 1, "camera": { "look_at": { "from": [0, 1, 4], "to": [0, 0, 0] } }, "background": { "radiance": 1 },
        "shapes": [{ "type": "quad", "size": 40, "material": { "type": "diffuse", "albedo": { "type": "checker", "scale": 400 } } }] }"#;
    let scene = Arc::new(crate::light_tracer::built(floor).world);
    let rendered = |integrator: &dyn Integrator| picture(scene.clone(), integrator, FilmSpec::new(16, 16), sampler(2));
    assert_eq!(rendered(&Card::default()), rendered(&Path::default()), "a texture");
}

/// A floor below a window in the ceiling, through which the sun stands at 60° from the zenith: ρ S cos 60°, and no sunlight where the
/// window is not between the floor and the sun.
#[test]
fn the_sun_shines_through_windows() {
    let sun_radiance = Some([6.0; 3].map(|v| Radiometric::new(v).expect("in range")));
    let sun_direction = Direction([0.0, 1.0, 3f64.sqrt()]);
    for (window, seen) in [(DVec3::new(0.0, 1.0, 3f64.sqrt()), 1.0), (DVec3::new(0.0, 1.0, -3f64.sqrt()), 0.0)] {
        let mut world = World::builder(probe(DVec3::new(1.0, 0.5, 0.0), DVec3::ZERO));
        let (matte, dark) = (world.material(Material::diffuse(stored(gray(0.5)))), world.material(black()));
        world.shape(Quad { size: [20.0; 2] }, facing(DVec3::ZERO, DVec3::Y), matte, None);
        world.shape(Quad { size: [0.5; 2] }, facing(window, -DVec3::Y), dark, glow(1.0));
        let scene = Arc::new(world.build().expect("a world"));
        for step_off in [None, Positive::new(0.01)] {
            // The emission of the window itself is left out.
            let card = Card { max_depth: 1, emission_depth: 0, sun_radiance, sun_direction, step_off, ..Card::default() };
            let found = measure(scene.clone(), &card, 1024, 1);
            assert!((found.value - seen * 0.5 * 6.0 * 0.5).abs() < 1e-5, "{} with {step_off:?}", found.value);
        }
    }
}

/// Settings that leave out light are reported as biases.
#[test]
fn card_reports_its_biases() {
    let card = Card { max_depth: 3, step_off: Positive::new(0.1), hemisphere: Hemisphere::Angle, ..Card::default() };
    let settings: Vec<String> = card.biases().into_iter().map(|bias| bias.setting).collect();
    assert_eq!(settings, ["max_depth 3", "step_off 0.1", "hemisphere angle"]);
}
