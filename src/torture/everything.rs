//! A small scene with every kind of material, light, shape and texture, and the settings to render it.

use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use crate::bsdf::microfacet::Distribution;
use crate::bsdf::microfacet::roughness::{Alpha, Roughness};
use crate::bsdf::{Element, FilmLayer, Glass, Material, MaterialId, NormalModifier, Principled, SurfaceMaterial, textured};
use crate::camera::realistic::{LensTable, Sensor};
use crate::camera::{Camera, Fisheye, FisheyeMapping, Orthographic, Perspective, Pose, Realistic, Spherical};
use crate::film::{FilmSpec, Image, MomentFilm};
use crate::integrator::Integrator;
use crate::light::{
    Directional, Emitter, Environment, EnvironmentMap, Falloff, IntensityProfile, Light, Mapping, Point, ProfiledPoint, Projector, Spot,
};
use crate::math::animation::Keyframes;
use crate::math::{Rgb, Transform};
use crate::render::{RenderReport, Settings, Silent, render};
use crate::sampler::SamplerSpec;
use crate::scene::Scene;
use crate::shape::curves::Basis;
use crate::shape::{BilinearPatch, Cone, Curves, Cylinder, Disk, MeshData, PartialDisk, PartialSphere, Quad, Sphere, TriangleMesh};
use crate::texture::image::Pixels;
use crate::texture::{Checker, Space, Texture};
use crate::world::{Objects, World, WorldBuilder};
use glam::{DVec3, Mat3, UVec2, Vec2, Vec3, Vec4};

use super::meshes::icosphere;

/// The parameters of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Everything {
    /// Factor of all lengths. Intensities are scaled by its square, so that the picture stays the same.
    pub scale: f64,
    /// Emission of every light.
    pub emission: f32,
    /// Radius of the lens, in units of the scale.
    pub lens_radius: f32,
    /// Kind of the camera.
    pub camera: Lens,
    /// Which lights shine.
    pub lights: Which,
    /// Whether to add a point light without power and a shape outside of the picture.
    pub idle: bool,
    /// Whether to add a body and a lamp that move and turn while the shutter is open.
    pub moves: bool,
}

/// Kind of the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lens {
    /// Central projection.
    Perspective,
    /// Parallel rays.
    Orthographic,
    /// All directions.
    Spherical,
    /// Half of all directions, in a circle.
    Fisheye,
    /// Central projection through the surfaces of a lens.
    Realistic,
}

impl Lens {
    /// All of them.
    pub const ALL: [Lens; 5] = [Lens::Perspective, Lens::Orthographic, Lens::Spherical, Lens::Fisheye, Lens::Realistic];
}

/// Which lights shine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// All of them.
    All,
    /// Surfaces that emit.
    AreaOnly,
    /// Parallel light.
    DirectionalOnly,
    /// Light from all around.
    EnvironmentOnly,
}

impl Default for Everything {
    fn default() -> Everything {
        let (camera, lights) = (Lens::Perspective, Which::All);
        Everything { scale: 1.0, emission: 1.0, lens_radius: 0.0, camera, lights, idle: false, moves: false }
    }
}

impl Everything {
    /// The scene, built.
    ///
    /// # Panics
    /// A length is not finite.
    pub fn build(&self) -> Arc<World> {
        let mut world = World::builder(self.camera());
        let checker = |space| {
            let colors = [Rgb::new(0.9, 0.5, 0.1), Rgb::new(0.1, 0.3, 0.8)].map(Texture::Constant);
            let [even, odd] = colors;
            Texture::Checker(Box::new(Checker { even, odd, scale: Vec3::splat(4.0), space }))
        };
        let to_texture = Transform::scale(DVec3::splat(self.scale)).expect("not zero").inverse();
        let floor = world.material(Material::diffuse(checker(Space::World(to_texture))));
        let spotted = world.material(Material::diffuse(checker(Space::Uv)));
        let mirror = world.material(Material::mirror(Rgb::new(0.9, 0.95, 1.0)));
        let gold = world.material(Material::metal((Rgb::new(0.2, 0.9, 1.1), Rgb::new(3.9, 2.4, 2.2)), None, true));
        let glass = textured::Dielectric::smooth(1.5, Rgb::WHITE);
        let glass = world.material(Material::dispersive(glass, Glass::Bk7.dispersion()));
        let roughness = |alpha: Vec2, distribution| Roughness { alpha: Alpha::Constant(alpha), distribution };
        let brushed = world.material(Material::metal(Element::Cu.index(), Some(roughness(Vec2::new(0.3, 0.06), Distribution::Ggx)), true));
        let frosted = textured::Dielectric::new(1.5, Rgb::WHITE, Some(roughness(Vec2::splat(0.2), Distribution::Beckmann)), true);
        let absorption = Rgb::new(0.3, 1.0, 2.0) * (1.0 / self.scale) as f32;
        let bottle = world.material(Material::from(frosted.absorbing(absorption)));
        let bubble = world.material(Material::from(textured::ThinFilm::new(1.33, 350.0, Rgb::WHITE)));
        let satin = world.material(Material::MatteCone(textured::MatteCone { color: Rgb::gray(0.7).into(), mattness: 0.2.into() }));
        let paint = world.material(self.paint(checker(Space::Uv)));
        let veil =
            SurfaceMaterial { opacity: Some(0.6.into()), ..Material::mix(Material::mirror(Rgb::WHITE), Material::glass(1.2), 0.5).into() };
        let veil = world.material(veil);
        let at = |x, y, z| Transform::translate(DVec3::new(x, y, z)).expect("finite");
        let flat = Transform::rotate(DVec3::X, -90.0).expect("an axis");
        let down = Transform::rotate(DVec3::X, 90.0).expect("an axis");
        let squash = Transform::scale(DVec3::new(1.3, 0.6, 0.8)).expect("not zero");
        world.shape(Quad { size: [6.0, 6.0] }, self.place(flat), floor, None);
        world.shape(Sphere { radius: 0.5 }, self.place(at(-1.1, 0.5, 0.0)), glass, None);
        world.shape(Sphere { radius: 0.4 }, self.place(squash.then(&at(0.1, 0.5, -0.6))), gold, None);
        world.shape(Sphere { radius: 0.3 }, self.place(at(0.2, 0.3, 0.9)), satin, None);
        world.shape(Sphere { radius: 0.25 }, self.place(at(-0.5, 0.25, 0.9)), bottle, None);
        world.shape(Quad { size: [0.5, 0.8] }, self.place(at(0.75, 0.4, 0.6)), brushed, None);
        world.shape(Sphere { radius: 0.2 }, self.place(at(-0.1, 1.3, 0.3)), bubble, None);
        world.shape(Sphere { radius: 0.3 }, self.place(at(-1.6, 0.3, 0.9)), paint, None);
        world.shape(Quad { size: [0.6, 0.6] }, self.place(at(-0.6, 0.5, 1.4)), veil, None);
        world.shape(Disk { radius: 0.9 }, self.place(at(0.0, 1.0, -1.9)), mirror, None);
        world.shape(TriangleMesh::new(ball()), self.place(at(1.2, 0.6, 0.2)), spotted, None);
        let upright = |x, y, z| self.place(flat.then(&at(x, y, z)));
        world.shape(Cylinder { radius: 0.15, z: [0.0, 0.4], phi_max: 250.0 }, upright(0.7, 0.0, 1.2), brushed, None);
        world.shape(Cone { radius: 0.2, height: 0.5, phi_max: 300.0 }, upright(1.2, 0.0, 1.0), spotted, None);
        world.shape(PartialSphere { radius: 0.3, z: [-0.3, 0.1], phi_max: 360.0 }, upright(-1.2, 0.3, -1.0), gold, None);
        world.shape(PartialDisk { radius: 0.25, inner_radius: 0.1, phi_max: 200.0 }, self.place(at(1.8, 0.8, -0.5)), satin, None);
        world.shape(BilinearPatch { corners: SADDLE }, self.place(at(-1.9, 0.7, -0.4)), brushed, None);
        world.shape(thread(false), self.place(at(0.2, 1.1, 0.4)), spotted, None);
        world.shape(thread(true), self.place(at(-1.1, 1.2, 0.2)), gold, None);
        self.add_lights(&mut world, &at, &down, spotted);
        if self.moves {
            self.add_motion(&mut world, &at, spotted);
        }
        Arc::new(world.build().expect("a valid scene"))
    }

    /// Materials within materials, on a surface with a relief.
    fn paint(&self, color: Texture) -> SurfaceMaterial {
        let roughness = |alpha: f32| Some(Roughness { alpha: Alpha::Constant(Vec2::splat(alpha)), distribution: Distribution::Ggx });
        let paint = Principled {
            base_color: color.clone(),
            metallic: 0.5.into(),
            transmission: 0.2.into(),
            specular: 1.0.into(),
            roughness: roughness(0.1),
            eta: 1.5.into(),
            coat: 0.8.into(),
            coat_eta: 1.5.into(),
            coat_color: Rgb::new(0.9, 0.8, 0.7).into(),
            coat_roughness: None,
            sheen_color: 0.3.into(),
            sheen_roughness: 0.45.into(),
            iridescence: 0.5.into(),
            film: FilmLayer { eta: 1.4, thickness: 300.0.into() },
            multiscatter: true,
        };
        let normal_modifier = NormalModifier::BumpMap { map: color, scale: ((1e-3 * self.scale) as f32).into() };
        SurfaceMaterial { normal_modifier: Some(normal_modifier), ..Material::from(paint).into() }
    }

    fn add_lights(&self, world: &mut WorldBuilder, at: &dyn Fn(f64, f64, f64) -> Transform, down: &Transform, material: MaterialId) {
        let glow = |r, g, b| Rgb::new(r, g, b) * self.emission;
        let square = (self.scale * self.scale) as f32;
        let has = |which| self.lights == Which::All || self.lights == which;
        let lamp = has(Which::AreaOnly).then(|| Emitter::new(glow(6.0, 5.0, 4.0)));
        world.shape(Quad { size: [0.8, 0.6] }, self.place(down.then(&at(0.3, 2.5, 0.2))), material, lamp);
        let (even, odd) = (Texture::Constant(Rgb::gray(2.0)), Texture::Constant(Rgb::gray(0.1)));
        let checker = Checker { even, odd, scale: Vec3::splat(3.0), space: Space::Uv };
        let texture = Some(Arc::new(Texture::Checker(Box::new(checker))));
        let bulb = has(Which::AreaOnly).then(|| Emitter { two_sided: true, texture, ..Emitter::new(glow(2.0, 8.0, 3.0)) });
        world.shape(Sphere { radius: 0.1 }, self.place(at(-0.4, 1.4, 0.5)), material, bulb);
        if has(Which::DirectionalOnly) {
            let direction = Vec3::new(0.5, -0.75, -0.4).normalize();
            world.light(Light::Directional(Directional { direction, irradiance: glow(0.5, 0.4, 0.3) }));
        }
        if has(Which::EnvironmentOnly) {
            world.light(Light::Environment(Environment { radiance: glow(0.1, 0.2, 0.4) }));
            world.light(bright_half(glow(0.3, 0.2, 0.1)));
        }
        if self.lights == Which::All {
            if let Light::Profiled(lamp) = profile() {
                let (position, intensity) = (lamp.position * self.scale, glow(0.4, 0.3, 0.2) * square);
                world.light(Light::Profiled(ProfiledPoint { position, intensity, ..lamp }));
            }
            if let Light::Projector(mut projector) = projector() {
                projector.spot.position *= self.scale;
                projector.spot.intensity = glow(0.5, 0.6, 0.7) * square;
                world.light(Light::Projector(projector));
            }
            let position = DVec3::new(1.5, 2.0, 1.0) * self.scale;
            world.light(Light::Point(Point { position, intensity: glow(2.0, 1.0, 1.0) * square }));
            let (position, axis) = (DVec3::new(-2.0, 2.0, 1.0) * self.scale, Vec3::new(0.6, -0.64, -0.48).normalize());
            let spot =
                Spot { position, axis, intensity: glow(1.0, 2.0, 4.0) * square, cos_inner: 0.95, cos_outer: 0.8, falloff: Falloff::Smooth };
            world.light(Light::Spot(spot));
        }
        if self.idle {
            world.light(Light::Point(Point { position: DVec3::ZERO, intensity: Rgb::BLACK }));
        }
    }

    /// A body of triangles and a lamp that fly and turn around each other.
    fn add_motion(&self, world: &mut WorldBuilder, at: &dyn Fn(f64, f64, f64) -> Transform, material: MaterialId) {
        let turn = |degrees: f64| Transform::rotate(DVec3::new(0.3, 1.0, 0.2), degrees).expect("an axis");
        let ends = [turn(20.0).then(&at(0.6, 1.2, 1.0)), turn(150.0).then(&at(1.2, 1.5, 0.8))].map(|end| self.place(end));
        let keys: Vec<(f64, Transform)> = [0.0, 1.0].into_iter().zip(ends).collect();
        let mut objects = Objects::default();
        objects.shape(TriangleMesh::new(ball()), Transform::scale(DVec3::splat(0.3)).expect("not zero"), material, None);
        let lamp = (self.lights != Which::DirectionalOnly && self.lights != Which::EnvironmentOnly)
            .then(|| Emitter::new(Rgb::new(3.0, 4.0, 5.0) * self.emission));
        let aside = Transform::translate(DVec3::new(0.3, 0.1, 0.0)).expect("finite");
        objects.shape(Sphere { radius: 0.06 }, aside, material, lamp);
        world.moving(objects, Keyframes::new(&keys).expect("neither mirrors").into());
    }

    fn place(&self, transform: Transform) -> Transform {
        transform.then(&Transform::scale(DVec3::splat(self.scale)).expect("not zero"))
    }

    fn camera(&self) -> Camera {
        let (eye, target) = (DVec3::new(0.3, 1.6, 4.0) * self.scale, DVec3::new(0.0, 0.7, 0.0) * self.scale);
        let pose = Pose::new(&Transform::look_at(eye, target, DVec3::Y).expect("looks somewhere"));
        let scale = self.scale as f32;
        match self.camera {
            Lens::Perspective => Camera::Perspective(Perspective::new(pose, 45.0, self.lens_radius * scale, 4.0 * scale)),
            Lens::Orthographic => Camera::Orthographic(Orthographic { pose, height: 3.0 * scale }),
            Lens::Spherical => Camera::Spherical(Spherical { pose }),
            Lens::Fisheye => Camera::Fisheye(Fisheye::new(pose, 180.0, FisheyeMapping::Equisolid)),
            Lens::Realistic => {
                let table = LensTable::new(&BICONVEX).expect("a lens").scaled(self.scale);
                let sensor = Sensor { height: 0.8 * self.scale, width: None };
                Camera::Realistic(Realistic::new(pose, &table, 4.0 * self.scale, sensor, 4.0 / 3.0).expect("it focuses"))
            }
        }
    }
}

/// A lens of a focal length of about 0.67, as rows of a lens table, in units of the scale.
const BICONVEX: [[f64; 4]; 3] = [[0.68, 0.05, 1.5, 0.3], [-0.68, 0.04, 1.0, 0.3], [0.0, 0.0, 1.0, 0.2]];

/// The corners of a saddle.
const SADDLE: [DVec3; 4] =
    [DVec3::new(-0.3, -0.3, 0.1), DVec3::new(0.3, -0.3, -0.1), DVec3::new(-0.3, 0.3, -0.1), DVec3::new(0.3, 0.3, 0.1)];

/// A bent curve that tapers: a tube, or a ribbon that twists.
pub fn thread(is_ribbon: bool) -> Curves {
    let points = [[-0.4, -0.1, 0.1, 0.05], [-0.1, 0.3, -0.1, 0.04], [0.1, -0.2, 0.1, 0.04], [0.4, 0.1, -0.1, 0.03]];
    let normals = [[0.1, 0.2, 1.0], [0.3, 0.4, 0.8], [-0.2, 0.5, 0.9], [0.3, -0.2, 1.0]];
    let normals = if is_ribbon { normals.map(Vec3::from).to_vec() } else { vec![] };
    Curves { basis: Basis::Bezier, points: points.map(Vec4::from).to_vec(), counts: vec![4], normals }
}

/// A picture of the surroundings whose pixels on one side are eight times as bright as on the other.
pub fn bright_half(radiance: Rgb) -> Light {
    let values = (0..32).map(|k| if k % 8 < 2 { radiance * 2.0 } else { radiance * 0.25 }.to_array()).collect();
    let pixels = Arc::new(Pixels::new(UVec2::new(8, 4), values).expect("pixels"));
    Light::EnvironmentMap(Arc::new(EnvironmentMap::new(pixels, Mapping::LatLong, Rgb::WHITE, Mat3::from_rotation_y(1.0))))
}

/// The intensity 2 before the light and falling linearly with the angle to 0 behind it.
pub fn profile() -> Light {
    let (vertical, horizontal) = (vec![0.0, FRAC_PI_2, PI], vec![0.0, 3.0, TAU]);
    let profile = IntensityProfile::new(vertical, horizontal, [5.0, 5.0, 0.0].repeat(3)).expect("a profile");
    let z = Vec3::new(0.3, -0.9, 0.2).normalize();
    let x = z.any_orthonormal_vector();
    let (position, axes) = (DVec3::new(0.5, 1.0, 0.2), [x, z.cross(x), z]);
    Light::Profiled(ProfiledPoint { position, axes, intensity: Rgb::gray(2.0), profile: Arc::new(profile) })
}

/// A white square, within the cone of the spotlight.
pub fn projector() -> Light {
    let (position, axis) = (DVec3::new(0.5, 1.0, 0.2), Vec3::new(0.3, -0.9, 0.2).normalize());
    let spot = Spot { position, axis, intensity: Rgb::gray(2.0), cos_inner: 0.9, cos_outer: 0.6, falloff: Falloff::Linear };
    let white = Arc::new(Pixels::new(UVec2::ONE, vec![[1.0; 3]]).expect("a pixel"));
    Light::Projector(Box::new(Projector::new(spot, Vec3::Y, 0.3, white).expect("not along the axis")))
}

/// Eighty triangles with interpolated normals and texture coordinates.
fn ball() -> MeshData {
    let (points, triangles) = icosphere(1);
    let positions: Vec<Vec3> = points.iter().map(|p| p.as_vec3() * 0.5).collect();
    let uvs = points.iter().map(|p| p.as_vec3().truncate()).collect();
    MeshData { normals: points.iter().map(|p| p.as_vec3()).collect(), uvs, positions, triangles, ..MeshData::default() }
}

/// Settings to render the scene.
#[derive(Clone, Debug)]
pub struct Shot {
    /// The scene.
    pub scene: Everything,
    /// The film.
    pub film: FilmSpec,
    /// The sampler.
    pub sampler: SamplerSpec,
    /// Edge of a tile (pixels).
    pub tile: u32,
}

impl Default for Shot {
    fn default() -> Shot {
        let sampler = SamplerSpec { spp: 11, seed: 7, ..SamplerSpec::default() };
        Shot { scene: Everything::default(), film: FilmSpec::new(40, 30), sampler, tile: 16 }
    }
}

/// The bits of a picture, standard errors included.
pub type Bits = Vec<(String, Vec<u32>)>;

/// The bits of a picture.
pub fn bits(image: &Image) -> Bits {
    image.channels.iter().map(|c| (c.name.clone(), c.values.iter().map(|v| v.to_bits()).collect())).collect()
}

/// Renders on the threads of the caller.
///
/// # Panics
/// A sample is not a number.
pub fn picture(scene: Arc<dyn Scene>, integrator: &dyn Integrator, shot: &Shot) -> Image {
    let mut film = MomentFilm::new(shot.film.clone());
    let settings = Settings { tile: shot.tile, ..Settings::new(shot.sampler) };
    let report: RenderReport = render(scene, integrator, &mut film, &settings, &Silent);
    assert_eq!(report.invalid, 0, "{:?} {shot:?}", report.first_invalid);
    assert_eq!(report.samples, shot.sampler.spp);
    film.image()
}

/// Builds the scene and renders it, on this number of threads.
///
/// # Panics
/// There are no threads to be had, or a sample is not a number.
pub fn render_on(threads: usize, integrator: &dyn Integrator, shot: &Shot) -> Bits {
    with_threads(threads, || bits(&picture(shot.scene.build(), integrator, shot)))
}

/// Runs code on this number of threads.
///
/// # Panics
/// There are no threads to be had.
pub fn with_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had").install(run)
}
