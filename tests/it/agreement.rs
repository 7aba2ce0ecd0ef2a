//! Different integrators render the same picture of generated scenes, which have every effect.

mod combined;

use std::sync::Arc;

use glam::{DVec3, UVec2, UVec3, Vec2, Vec4};
use pt::bsdf::{Material, MaterialId, TransportMode, textured};
use pt::camera::{Camera, Perspective, Pose};
use pt::film::{FilmSpec, Image};
use pt::integrator::{CameraSample, Context, Estimator, Integrator};
use pt::integrators::nee::{Nee, Weights};
use pt::integrators::{ALL, path::Path};
use pt::light::{Emitter, Environment, Light, LightSampleContext};
use pt::math::{Rgb, Spectrum, Transform, Vec3};
use pt::measure::{SampledImage, agreement, sidak};
use pt::medium::{ColorGrid, Density, Grid, Medium, Phase, Places, Varying};
use pt::sampler::dimension::{self, Use};
use pt::sampler::{SamplerSpec, Sequence};
use pt::scene::Scene;
use pt::shape::curves::Basis;
use pt::shape::{BilinearPatch, Cone, Cuboid, Curves, Cylinder, Disk, PartialDisk, PartialSphere, Quad, Sphere, TriangleMesh};
use pt::texture::Texture;
use pt::texture::image::{Filter, Image as TextureImage, Pixels, Wrap};
use pt::world::{World, WorldBuilder};

use crate::scenes::{Depth, at, facing, integrator, needs, picture, stored};
use pt::torture::everything::bright_half;
use pt::torture::meshes::{block, round_mesh};

/// Maximum depths at which all integrators must agree.
const DEPTH: Depth = Depth { max: 12, roulette: 3 };
const SAMPLES: u64 = 256;
const EDGE: u32 = 32;
/// Number of scenes with only matte objects, of scenes that also have mirrors and glass, and of scenes with media.
const MATTE: u64 = 20;
const CLEAR: u64 = 4;
const FILLED: u64 = 4;
/// Number of compared pairs of pictures, which together have 1 % of false alarms.
const PAIRS: usize = (MATTE + 3 * CLEAR + FILLED + combined::SCENES) as usize;

/// Numbers that choose what is in a scene: pt's own independent sampler, one sample per scene.
struct Dice {
    sequence: Sequence,
    scene: u64,
    dimension: u32,
}

impl Dice {
    fn new(scene: u64) -> Dice {
        Dice { sequence: SamplerSpec { seed: 7, ..SamplerSpec::default() }.build(), scene, dimension: 0 }
    }

    fn within(&mut self, from: f64, to: f64) -> f64 {
        let number = self.sequence.sample(UVec2::ZERO, self.scene).get_1d(self.dimension);
        self.dimension += 1;
        from + (to - from) * f64::from(number)
    }

    fn of(&mut self, count: u32) -> u32 {
        (self.within(0.0, f64::from(count)) as u32).min(count - 1)
    }

    fn color(&mut self, from: f64, to: f64) -> Spectrum {
        let [r, g, b] = [0; 3].map(|_| self.within(from, to) as f32);
        Spectrum::rgb(r, g, b)
    }

    fn point(&mut self, reach: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| self.within(-reach, reach)))
    }
}

/// Material of an object by number; the first three are clear.
fn substance(kind: u32, dice: &mut Dice) -> Material {
    match kind {
        0 => Material::glass(dice.within(1.1, 2.4) as f32),
        1 => Material::mirror(stored(dice.color(0.6, 1.0))),
        2 => Material::metal((stored(dice.color(0.1, 2.0)), stored(dice.color(2.0, 5.0))), None, true),
        3 => Material::MatteCone(textured::MatteCone {
            color: stored(dice.color(0.3, 0.9)).into(),
            mattness: (dice.within(0.1, 1.0) as f32).into(),
        }),
        _ => Material::diffuse(stored(dice.color(0.2, 0.8))),
    }
}

/// A picture with one bright pixel of four.
fn bright_quarter() -> Texture {
    let pixels = Pixels::new(UVec2::new(2, 2), vec![[0.1; 3], [2.0, 1.5, 1.0], [0.0; 3], [0.3; 3]]).expect("pixels");
    Texture::Image(TextureImage { pixels: pixels.into(), pyramid: None, scale: Vec2::ONE, wrap: Wrap::Clamp, filter: Filter::Bilinear })
}

/// A bilinear patch around the origin.
fn saddle(half: f64) -> BilinearPatch {
    BilinearPatch { corners: [[-1.0, -1.0, 0.4], [1.0, -0.9, -0.3], [-0.8, 1.0, -0.4], [0.9, 1.0, 0.2]].map(|p| DVec3::from(p) * half) }
}

/// A thick tube around the origin.
fn bend(half: f32) -> Curves {
    let points = [[-1.0, -0.3, 0.2, 0.3], [-0.4, 0.4, -0.2, 0.4], [0.4, -0.4, 0.3, 0.5], [1.0, 0.4, 0.0, 0.2]];
    let points = points.map(|p| Vec4::from(p) * half).to_vec();
    Curves { basis: Basis::CatmullRom, counts: vec![4], points, normals: vec![] }
}

/// Adds a lamp under the ceiling, of each family of shapes in turn, large enough to be hit by chance. Every third lamp has a texture.
fn lamp(world: &mut WorldBuilder, scene: u64, dice: &mut Dice, dark: MaterialId) {
    let texture = scene.is_multiple_of(3).then(|| Arc::new(bright_quarter()));
    let emitter = Emitter { two_sided: scene / 10 % 2 == 1, texture, ..Emitter::new(stored(dice.color(1.0, 4.0))) };
    let place = facing(DVec3::new(dice.within(-0.2, 0.2), 0.8, dice.within(-0.3, 0.3)), dice.point(0.4) - DVec3::Y);
    match scene % 10 {
        0 => world.shape(Quad { size: [1.2, 1.0] }, place, dark, Some(emitter)),
        1 => world.shape(Disk { radius: 0.6 }, place, dark, Some(emitter)),
        2 => world.shape(Sphere { radius: 0.4 }, at(DVec3::new(0.2, 0.5, -0.2)), dark, Some(emitter)),
        4 => world.shape(Cylinder { radius: 0.3, z: [-0.6, 0.5], phi_max: 360.0 }, place, dark, Some(emitter)),
        5 => world.shape(Cone { radius: 0.6, height: 0.4, phi_max: 270.0 }, place, dark, Some(emitter)),
        6 => world.shape(PartialSphere { radius: 0.5, z: [-0.2, 0.5], phi_max: 360.0 }, place, dark, Some(emitter)),
        7 => world.shape(PartialDisk { radius: 0.7, inner_radius: 0.3, phi_max: 300.0 }, place, dark, Some(emitter)),
        8 => world.shape(saddle(0.6), place, dark, Some(emitter)),
        9 => world.shape(bend(0.6), place, dark, Some(emitter)),
        _ => {
            let squeezed = Transform::scale(DVec3::new(0.6, 0.3, 0.5)).unwrap().then(&at(DVec3::new(0.0, 0.55, 0.0)));
            world.shape(TriangleMesh::new(round_mesh(1)), squeezed, dark, Some(emitter));
        }
    }
}

/// Generates a scene: a box open towards the camera, with a lamp and three objects. Every third scene also has a sky, every sixth a picture
/// of one.
pub fn generated(scene: u64, matte: bool) -> Arc<World> {
    let mut dice = Dice::new(if matte { scene } else { 1000 + scene });
    Arc::new(objects(scene, matte, &mut dice).build().unwrap())
}

/// A matte scene with two bodies of media that may reach into each other and into its objects, and in every second scene a medium around
/// everything.
fn filled(scene: u64) -> Arc<World> {
    let mut dice = Dice::new(2000 + scene);
    let mut world = objects(scene, true, &mut dice);
    for place in [DVec3::new(-0.4, -0.4, 0.1), DVec3::new(0.3, -0.3, 0.2)] {
        let boundary = if dice.of(4) == 0 { Material::glass(1.2) } else { textured::Interface.into() };
        let (boundary, medium) = (world.material(boundary), medium(&mut dice, place));
        let medium = world.medium(medium);
        let turned = Transform::rotate(dice.point(1.0) + DVec3::Y, dice.within(0.0, 360.0)).unwrap().then(&at(place));
        match dice.of(2) {
            0 => world.shape(Sphere { radius: 0.5 }, turned, boundary, None),
            _ => world.shape(Cuboid { size: [0.7, 0.9, 0.6] }, turned, boundary, None),
        }
        world.fill(medium);
    }
    if scene.is_multiple_of(2) {
        let haze = Medium::new(dice.color(0.0, 0.05), dice.color(0.02, 0.2), Phase::Rayleigh);
        let haze = world.medium(haze);
        world.surround(haze);
    }
    Arc::new(world.build().unwrap())
}

/// A medium of any kind, whose density, if it has one, is in a box around a point.
fn medium(dice: &mut Dice, around: DVec3) -> Medium {
    let phase = if dice.of(3) == 0 { Phase::Rayleigh } else { Phase::henyey_greenstein(dice.within(-0.5, 0.8)) };
    let medium = Medium::new(dice.color(0.0, 1.0), dice.color(0.5, 4.0), phase).with_priority(dice.of(2) as i32);
    let medium = if dice.of(3) == 0 { medium.emitting(dice.color(0.0, 1.0)) } else { medium };
    if dice.of(2) == 0 {
        return medium;
    }
    let size = UVec3::new(3, 4, 2);
    let values: Vec<f32> = (0..24).map(|_| dice.within(-0.5, 2.0).max(0.0) as f32).collect();
    let colors: Vec<Rgb> = (0..24).map(|_| stored(dice.color(0.3, 1.0))).collect();
    let varying = Varying { albedo: Some(ColorGrid::Rgb(Grid::new(size, colors, Places::Corners))), emission: None };
    let placed = at(around - DVec3::splat(0.6));
    let density = Density::new(Grid::new(size, values, Places::Centers), &Transform::scale(DVec3::splat(1.2)).unwrap().then(&placed));
    medium.with_density(density).with_varying(varying)
}

/// The objects of a generated scene.
fn objects(scene: u64, matte: bool, dice: &mut Dice) -> WorldBuilder {
    let pose = Pose::new(&Transform::look_at(DVec3::new(0.1, 0.1, 3.4), DVec3::ZERO, DVec3::Y).unwrap());
    let mut world = World::builder(Camera::Perspective(Perspective::new(pose, 40.0, 0.02, 3.0)));
    let kinds = if matte { 6 } else { 3 };
    for (axis, side) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0), (2, -1.0)] {
        let out = DVec3::AXES[axis] * side;
        let wall = if matte { Material::diffuse(stored(dice.color(0.2, 0.8))) } else { Material::mirror(stored(dice.color(0.3, 0.9))) };
        let wall = world.material(wall);
        world.shape(Quad { size: [2.0; 2] }, facing(out, -out), wall, None);
    }
    let dark = world.material(Material::mirror(Rgb::gray(0.1)));
    lamp(&mut world, scene, dice, dark);
    if scene.is_multiple_of(3) || !matte {
        let radiance = stored(dice.color(0.2, 0.8));
        world.light(if scene.is_multiple_of(2) { bright_half(radiance) } else { Light::Environment(Environment { radiance }) });
    }
    for thing in 0..3 {
        // Glass, mirror, metal and matte cone in turn, so that every scene has clear and matte objects.
        let kind = if thing == 0 { (scene % 4) as u32 } else { dice.of(kinds) };
        let material = world.material(substance(kind.min(kinds - 1), dice));
        let place = DVec3::new([-0.5, 0.45, 0.0][thing], -0.6, [-0.2, -0.4, 0.4][thing]);
        let turn = Transform::rotate(dice.point(1.0) + DVec3::Y, dice.within(0.0, 360.0)).unwrap();
        // Glass encloses a volume.
        match dice.of(if kind == 0 || !matte { 3 } else { 8 }) {
            0 => world.shape(TriangleMesh::new(block(Vec3::new(0.2, 0.25, 0.15))), turn.then(&at(place)), material, None),
            1 => {
                world.shape(TriangleMesh::new(round_mesh(1)), Transform::scale(DVec3::splat(0.3)).unwrap().then(&at(place)), material, None)
            }
            2 => world.shape(Sphere { radius: 0.3 }, at(place), material, None),
            3 => world.shape(Cylinder { radius: 0.2, z: [-0.2, 0.3], phi_max: 300.0 }, turn.then(&at(place)), material, None),
            4 => world.shape(Cone { radius: 0.3, height: 0.5, phi_max: 360.0 }, turn.then(&at(place)), material, None),
            5 => world.shape(PartialSphere { radius: 0.3, z: [-0.3, 0.1], phi_max: 360.0 }, turn.then(&at(place)), material, None),
            6 => world.shape(saddle(0.3), turn.then(&at(place)), material, None),
            _ => world.shape(bend(0.3), turn.then(&at(place)), material, None),
        }
    }
    world
}

fn image(scene: &Arc<World>, integrator: &dyn Integrator, seed: u64) -> Image {
    let sampler = SamplerSpec { spp: SAMPLES, seed, ..SamplerSpec::default() };
    picture(scene.clone(), integrator, FilmSpec::new(EDGE, EDGE), sampler)
}

/// Text of the four tests on two images, if one of them finds that the images differ.
fn refusal(a: &Image, b: &Image) -> Option<String> {
    let render = |image| SampledImage { image, samples: SAMPLES };
    let found = agreement(render(a), render(b), sidak(0.01, PAIRS)).unwrap();
    (!found.accepts()).then(|| found.to_string())
}

/// Compares all pairs of integrators that simulate all effects of a generated scene.
///
/// - `least`: least number of such integrators
fn agree(name: &str, world: &Arc<World>, least: usize) {
    let able = ALL.iter().filter(|entry| entry.simulates.contains(needs(&**world, DEPTH)));
    let images: Vec<(&str, Image)> =
        able.zip(1..).filter_map(|(entry, seed)| Some((entry.name, image(world, &*integrator(entry, DEPTH)?, seed)))).collect();
    assert!(images.len() >= least);
    for (k, (one, a)) in images.iter().enumerate() {
        for (other, b) in &images[k + 1..] {
            if let Some(found) = refusal(a, b) {
                panic!("{name}, {one} and {other}: {found}");
            }
        }
    }
}

#[test]
fn methods_agree_on_matte_scenes() {
    (0..MATTE).for_each(|scene| agree(&format!("matte scene {scene}"), &generated(scene, true), 2));
}

#[test]
fn methods_agree_on_scenes_with_mirrors_and_glass() {
    (0..CLEAR).for_each(|scene| agree(&format!("clear scene {scene}"), &generated(scene, false), 3));
}

#[test]
fn methods_agree_on_scenes_with_media() {
    (0..FILLED).for_each(|scene| agree(&format!("scene {scene} with media"), &filled(scene), 2));
}

/// The choice of weights for multiple importance sampling does not change the mean, on scenes with and without a sky.
#[test]
fn mis_weights_do_not_change_the_mean() {
    for scene in 0..3 {
        let world = generated(scene, true);
        let power = image(&world, &nee(), 1);
        for (weights, seed) in [(Weights::Balance, 2), (Weights::Light, 3)] {
            if let Some(found) = refusal(&power, &image(&world, &Nee { weights, ..nee() }, seed)) {
                panic!("scene {scene}, {weights:?}: {found}");
            }
        }
    }
}

/// Integrator with a bias: its radiance is multiplied by a factor.
struct Biased<T>(T, f32);

struct Scaled {
    inner: Box<dyn Estimator>,
    factor: f32,
}

impl<T: Integrator> Integrator for Biased<T> {
    fn prepare(&self, scene: Arc<dyn Scene>, film: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Scaled { inner: self.0.prepare(scene, film), factor: self.1 })
    }
}

impl Estimator for Scaled {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        self.inner.li(camera, cx) * self.factor
    }
}

/// Faulty integrator that samples the lights and also counts light that paths hit by chance, without weights.
struct CountsTwice;

struct Twice(Arc<dyn Scene>);

impl Integrator for CountsTwice {
    fn prepare(&self, scene: Arc<dyn Scene>, _: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Twice(scene))
    }
}

impl Estimator for Twice {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        let (mut ray, mut beta, mut radiance) = (camera.ray, Spectrum::ONE, Spectrum::BLACK);
        for depth in 0.. {
            let Some(hit) = self.0.intersect(&ray) else {
                let background = self.0.lights().background(ray.direction).map(|(_, radiance)| radiance);
                return radiance + beta * background.fold(Spectrum::BLACK, |sum, radiance| sum + radiance);
            };
            let surface = self.0.surface(&ray, &hit);
            let wo = -ray.direction;
            radiance += beta * surface.emitted(wo);
            if depth == DEPTH.max {
                break;
            }
            let (choice, u) = cx.numbers.get_3d(dimension::vertex(depth, Use::Light));
            if let Some(light) = self.0.lights().sample(&LightSampleContext::at(surface.point.p), choice, u) {
                let f = surface.eval(wo, light.wi, TransportMode::Radiance);
                if !f.is_black() && !self.0.occluded(&surface.shadow_ray(light.wi, &light.target, 0.0)) {
                    radiance += beta * f * light.weight();
                }
            }
            let (choice, u) = cx.numbers.get_3d(dimension::vertex(depth, Use::Bsdf));
            let Some((wi, sample)) = surface.sample(wo, choice, u, TransportMode::Radiance) else { break };
            beta *= sample.weight;
            ray = surface.spawn(wi, ray.time);
        }
        radiance
    }
}

fn nee() -> Nee {
    Nee { max_depth: DEPTH.max, roulette_depth: DEPTH.roulette, ..Nee::default() }
}

#[test]
fn light_counted_twice_is_detected() {
    for scene in 0..4 {
        let world = generated(scene, true);
        let found = refusal(&image(&world, &nee(), 1), &image(&world, &CountsTwice, 2));
        assert!(found.is_some(), "scene {scene}");
    }
}

/// A bias of 3 % is found although the error of each pixel is about 10 %.
#[test]
fn a_bias_of_three_per_cent_is_detected() {
    for scene in 0..4 {
        let world = generated(scene, true);
        let path = Path { max_depth: DEPTH.max, roulette_depth: DEPTH.roulette };
        let honest = image(&world, &path, 1);
        assert!(refusal(&honest, &image(&world, &Biased(nee(), 1.0), 2)).is_none(), "scene {scene}");
        assert!(refusal(&honest, &image(&world, &Biased(nee(), 1.03), 2)).is_some(), "scene {scene}");
    }
}
