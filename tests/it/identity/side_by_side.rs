//! Paths that are followed side by side have the bits of single paths.

use std::sync::Arc;

use glam::{DVec3, Mat3, UVec2, Vec2, Vec3};
use pt::bsdf::microfacet::Distribution;
use pt::bsdf::microfacet::roughness::{Alpha, Roughness};
use pt::bsdf::{Coat, Coated, Compound, Element, FilmLayer, Material, MaterialId, Metallic, NormalModifier, SurfaceMaterial, textured};
use pt::camera::{Camera, Fisheye, FisheyeMapping, Orthographic, Perspective, Pose, Spherical};
use pt::film::{Crop, FilmSpec, Filter, TextureFootprint};
use pt::integrator::Integrator;
use pt::integrators::nee::{Nee, Weights};
use pt::integrators::path::Path;
use pt::light::{Directional, Emitter, Environment, EnvironmentMap, Falloff, Light, Mapping, Point, Spot, Sun};
use pt::math::lanes::Width;
use pt::math::{Rgb, Spectrum, Transform};
use pt::medium::{Medium, Phase};
use pt::sampler::{Kind, SamplerSpec};
use pt::shape::{Cuboid, Disk, MeshData, Quad, Sphere, TriangleMesh};
use pt::texture::image::Pixels;
use pt::texture::{Checker, Space, Texture};
use pt::world::{WideWorld, World, WorldBuilder};
use rayon::prelude::*;

use crate::random::Random;
use pt::torture::everything::{Shot, bits, bright_half, picture, profile, projector, thread};
use pt::torture::meshes::icosphere;

/// Random scenes of all shapes, lights and cameras, with materials of many kinds, clear or in fog, with both methods and all samplers.
#[test]
fn side_by_side_paths_have_the_bits_of_single_ones() {
    let widths: Vec<Width> = Width::available().into_iter().filter(|width| width.count() > 1).collect();
    (0..160u64).into_par_iter().for_each(|seed| {
        let mut random = Random::new(seed);
        let method = method(&mut random);
        let shot = shot(&mut random);
        let scene = |width: Width| {
            let mut world = scene(&mut Random::new(seed ^ 1 << 32));
            world.width(width);
            Arc::new(world.build().expect("the scene is valid"))
        };
        let single = scene(Width::available()[0]);
        assert!(WideWorld::of(&*single).is_none(), "one path is no group");
        let wanted = bits(&picture(single, &*method, &shot));
        for &width in &widths {
            let wide = scene(width);
            assert_eq!(WideWorld::of(&*wide).map(|wide| wide.width()), Some(width), "seed {seed}: the scene has tables");
            assert!(bits(&picture(wide, &*method, &shot)) == wanted, "seed {seed}, {width:?}");
        }
    });
}

/// Boundaries without a surface cut the ways through a medium into pieces, for which there is no code for lanes.
#[test]
fn boundaries_without_a_surface_need_single_paths() {
    let Some(width) = Width::available().into_iter().find(|width| width.count() > 1) else { return };
    for (has_fog, has_boundary) in [(false, false), (false, true), (true, false), (true, true)] {
        let mut world = World::builder(camera(&mut Random::new(1), 1.0));
        let white = world.material(Material::diffuse(Rgb::WHITE));
        world.shape(Quad { size: [6.0, 6.0] }, Transform::IDENTITY, white, None);
        if has_boundary {
            let none = world.material(Material::from(textured::Interface));
            world.shape(Sphere { radius: 0.4 }, at(0.0, 1.0, 0.0), none, None);
        }
        if has_fog {
            let fog = world.medium(Medium::new(Spectrum::BLACK, Spectrum::ONE, Phase::Isotropic));
            world.surround(fog);
        }
        world.width(width);
        let world = world.build().expect("the scene is valid");
        assert_eq!(WideWorld::of(&world).is_some(), !has_boundary, "fog {has_fog}, boundary {has_boundary}");
    }
}

fn method(random: &mut Random) -> Box<dyn Integrator> {
    let (max_depth, roulette_depth) = (random.pick(&[0, 1, 3, 64]), random.pick(&[0, 2, 4]));
    match random.below(4) {
        0 => Box::new(Path { max_depth, roulette_depth }),
        _ => Box::new(Nee { max_depth, roulette_depth, weights: random.pick(&[Weights::Power, Weights::Balance, Weights::Light]) }),
    }
}

fn shot(random: &mut Random) -> Shot {
    let kind = random.pick(&[Kind::Sobol, Kind::Sobol, Kind::Independent, Kind::Halton, Kind::Stratified]);
    let filter = match random.below(3) {
        0 => Filter::tent(1.0),
        1 => Filter::mitchell(2.0, 1.0 / 3.0, 1.0 / 3.0),
        _ => Filter::default(),
    };
    let sampler = SamplerSpec { kind, spp: 1 + random.below(9) as u64, seed: random.below(100) as u64, ..SamplerSpec::default() };
    let whole = FilmSpec::new(23, 17);
    let crop = if random.below(3) == 0 { Crop { min: UVec2::new(3, 5), max: UVec2::new(20, 11) } } else { whole.crop };
    let texture_footprint = random.pick(&[TextureFootprint::default(), TextureFootprint::Fixed(0.0), TextureFootprint::Fixed(3.0)]);
    Shot { film: FilmSpec { filter, crop, texture_footprint, ..whole }, sampler, tile: random.pick(&[16, 64, 5]), ..Shot::default() }
}

fn scene(random: &mut Random) -> WorldBuilder {
    let scale = random.pick(&[1.0, 1.0, 1e-3, 1e4]);
    let mut world = World::builder(camera(random, scale));
    let place = |transform: Transform| transform.then(&Transform::scale(DVec3::splat(scale)).expect("not zero"));
    let materials: Vec<MaterialId> = materials(scale as f32).into_iter().map(|material| world.material(material)).collect();
    let (diffuse, others) = materials.split_at(3);
    let is_matte = random.below(3) == 0;
    let any = |random: &mut Random| if is_matte || random.below(2) == 0 { random.pick(diffuse) } else { random.pick(others) };
    let flat = Transform::rotate(DVec3::X, -90.0).expect("an axis");
    world.shape(Quad { size: [6.0, 6.0] }, place(flat.then(&at(0.0, -1.0, 0.0))), random.pick(diffuse), None);
    if random.below(2) == 0 {
        let inwards = Transform::scale(DVec3::splat(-1.0)).expect("not zero");
        world.shape(Cuboid { size: [7.0, 6.0, 12.0] }, place(inwards), random.pick(diffuse), None);
    }
    for _ in 0..1 + random.below(6) {
        let moved = random.rotation().then(&Transform::translate(random.in_cube() * 1.5).expect("finite"));
        let (material, emitter) = (any(random), (random.below(6) == 0).then(|| glow(random)));
        let stretched = (random.in_cube() + DVec3::splat(1.5)) * random.pick(&[1.0, -1.0]);
        let stretched = Transform::scale(stretched).expect("not zero");
        let transform = place(moved);
        match random.below(7) {
            0 => world.shape(Quad { size: [1.0, 0.7] }, transform, material, emitter),
            1 => world.shape(Cuboid { size: [0.7, 0.5, 0.9] }, transform, material, emitter),
            2 => world.shape(Sphere { radius: 0.5 }, transform, material, emitter),
            6 => world.shape(Sphere { radius: 0.5 }, stretched.then(&transform), material, emitter),
            3 => world.shape(Disk { radius: 0.6 }, transform, material, emitter),
            4 => world.shape(thread(random.below(2) == 0), transform, material, emitter),
            _ => world.shape(TriangleMesh::new(ball(random.below(2) == 0)), transform, material, emitter),
        }
    }
    lights(random, &mut world, &place, diffuse[0]);
    if random.below(3) == 0 {
        let medium = world.medium(medium(random, scale as f32));
        world.surround(medium);
    }
    world
}

/// A medium that is the same everywhere: thin or thick, and with absorption, scattering and emission or without.
fn medium(random: &mut Random, scale: f32) -> Medium {
    // Numbers of few digits, so that absorption and scattering have the same sum for all colours.
    let extinction = 2f32.powi(random.below(9) as i32 - 7 - scale.log2().round() as i32);
    let albedo = random.pick(&[Spectrum::BLACK, Spectrum::ONE, Spectrum::gray(0.875), Spectrum::rgb(0.25, 0.5, 0.75)]);
    let phase = match random.below(4) {
        0 => Phase::Isotropic,
        1 => Phase::Rayleigh,
        _ => Phase::henyey_greenstein(random.pick(&[-0.9, 0.3, 0.6, 0.99])),
    };
    let scattering = albedo * extinction;
    let medium = Medium::new(Spectrum::gray(extinction) - scattering, scattering, phase);
    if random.below(4) == 0 { medium.emitting(Spectrum::rgb(0.3, 0.2, 0.1)) } else { medium }
}

/// Often a single rectangle or a single picture of the surroundings, which have code of their own; otherwise lights of all kinds.
fn lights(random: &mut Random, world: &mut WorldBuilder, place: &dyn Fn(Transform) -> Transform, material: MaterialId) {
    if random.below(4) == 0 {
        world.light(surroundings(random));
        if random.below(2) == 0 {
            return;
        }
    }
    let down = Transform::rotate(DVec3::X, 90.0).expect("an axis");
    if random.below(4) > 0 {
        let lamp = Emitter { two_sided: random.below(2) == 0, ..glow(random) };
        let tilted = if random.below(2) == 0 { down } else { random.rotation() };
        let size = random.pick(&[[0.8, 0.6], [3.0, 2.0]]);
        world.shape(Quad { size }, place(tilted.then(&at(0.3, 1.5, 0.2))), material, Some(lamp));
    }
    // Spheres that shine into the scene, one of which may contain it.
    if random.below(3) == 0 {
        let lamp = Emitter { two_sided: random.below(2) == 0, ..glow(random) };
        let radius = random.pick(&[0.05, 0.4, 9.0]);
        world.shape(Sphere { radius }, place(at(-0.9, 1.2, 0.6)), material, Some(lamp));
    }
    if random.below(3) == 0 {
        world.light(Light::Environment(Environment { radiance: Rgb::new(0.1, 0.2, 0.4) }));
    }
    if random.below(4) == 0 {
        world.light(bright_half(Rgb::new(0.3, 0.2, 0.4)));
        world.light(Light::Sun(Sun::new(random.direction().as_vec3(), Rgb::new(9.0, 8.0, 5.0), 10.0)));
        world.light(profile());
        world.light(projector());
    }
    if random.below(4) == 0 {
        let direction = random.direction().as_vec3();
        world.light(Light::Directional(Directional { direction, irradiance: Rgb::new(0.5, 0.4, 0.3) }));
        let axis = random.direction().as_vec3();
        let (position, intensity) = (DVec3::new(-1.0, 1.2, 1.0), Rgb::new(1.0, 2.0, 4.0));
        world.light(Light::Point(Point { position: random.in_cube(), intensity }));
        world.light(Light::Spot(Spot { position, axis, intensity, cos_inner: 0.95, cos_outer: 0.8, falloff: Falloff::Smooth }));
    }
}

/// A turned picture of either mapping, of one brightness or with peaks of up to a thousand times the least radiance.
fn surroundings(random: &mut Random) -> Light {
    let (mapping, size) = random.pick(&[(Mapping::LatLong, [9, 4]), (Mapping::LatLong, [1, 1]), (Mapping::Octahedral, [5, 5])]);
    let contrast = random.pick(&[0.0, 1.5]);
    let values = (0..size[0] * size[1]).map(|_| [0; 3].map(|_| random.decade(-contrast, contrast) as f32)).collect();
    let pixels = Arc::new(Pixels::new(UVec2::from(size), values).expect("pixels"));
    let turned = Mat3::from_axis_angle(random.direction().as_vec3(), 1.0);
    Light::EnvironmentMap(Arc::new(EnvironmentMap::new(pixels, mapping, Rgb::new(0.3, 0.2, 0.25), turned)))
}

fn glow(random: &mut Random) -> Emitter {
    let plain = Emitter::new(Rgb::new(2.0, 8.0, 3.0) * random.unit() as f32);
    if random.below(4) == 0 { Emitter { texture: Some(Arc::new(checker(3.0))), ..plain } } else { plain }
}

/// A checkerboard over the texture coordinates.
fn checker(scale: f32) -> Texture {
    let [even, odd] = [Rgb::new(0.9, 0.6, 0.1), Rgb::new(0.1, 0.3, 0.8)].map(Texture::Constant);
    Texture::Checker(Box::new(Checker { even, odd, scale: Vec3::splat(scale), space: Space::Uv }))
}

fn at(x: f64, y: f64, z: f64) -> Transform {
    Transform::translate(DVec3::new(x, y, z)).expect("finite")
}

fn camera(random: &mut Random, scale: f64) -> Camera {
    let eye = DVec3::new(0.3, 0.6, 4.0) * scale;
    let pose = Pose::new(&Transform::look_at(eye, DVec3::ZERO, DVec3::Y).expect("looks somewhere"));
    let scale = scale as f32;
    match random.below(7) {
        0 => Camera::Orthographic(Orthographic { pose, height: 3.0 * scale }),
        1 => Camera::Spherical(Spherical { pose }),
        2 => Camera::Perspective(Perspective::new(pose, 45.0, 0.1 * scale, 4.0 * scale)),
        3 => Camera::Fisheye(Fisheye::new(pose, 120.0, FisheyeMapping::Equisolid)),
        4 => Camera::Perspective(Perspective::new(pose, 45.0, 0.0, 4.0 * scale).shifted([0.1, -0.05])),
        _ => Camera::Perspective(Perspective::new(pose, 45.0, 0.0, 4.0 * scale)),
    }
}

/// Three diffuse materials, then materials that have no code for lanes: those that are the same everywhere, and those that are not.
fn materials(scale: f32) -> Vec<SurfaceMaterial> {
    let roughness = |alpha| Roughness { alpha: Alpha::Constant(alpha), distribution: Distribution::Ggx };
    let rough = roughness(Vec2::splat(0.3));
    let plain = [
        Material::diffuse(Rgb::new(0.7, 0.5, 0.3)),
        Material::diffuse(Rgb::new(0.0, 0.9, 0.2)),
        Material::diffuse(checker(5.0)),
        Material::diffuse(Rgb::BLACK),
        Material::mirror(Rgb::new(0.9, 0.95, 1.0)),
        Material::glass(1.5),
        // Light is sampled on both sides of it.
        Material::rough_glass(1.5, Rgb::WHITE, roughness(Vec2::splat(0.2)), false),
        Material::plastic(Rgb::new(0.2, 0.5, 0.7), 1.5),
        Material::metal((Rgb::new(0.2, 0.9, 1.1), Rgb::new(3.9, 2.4, 2.2)), None, true),
        Material::metal(Element::Cu.index(), Some(rough), false),
        Material::metal(Metallic::from(Element::Cu.index()).under_film(FilmLayer { eta: 1.5, thickness: 90.0.into() }), None, true),
        Material::ThinFilm(textured::ThinFilm::new(1.33, 300.0, 1.0)),
        Material::ThinDielectric(textured::ThinDielectric { eta: 1.33.into(), color: Rgb::WHITE.into() }),
        Material::MatteCone(textured::MatteCone { color: Rgb::gray(0.7).into(), mattness: 0.2.into() }),
        Material::from(textured::Dielectric::smooth(1.5, Rgb::WHITE).absorbing(Rgb::new(0.3, 1.0, 2.0) * (1.0 / scale))),
        Material::mirror(checker(2.0)),
        Material::metal(Element::Cu.index(), Some(roughness(Vec2::new(0.4, 0.1))), true),
        Material::mix(Material::mirror(Rgb::WHITE), Material::diffuse(checker(7.0)), 0.5),
        Compound::Coated(Coated { base: Material::diffuse(checker(3.0)), coat: Coat::new(1.5, 1.0, None) }).into(),
    ];
    let bumps = NormalModifier::BumpMap { map: checker(4.0), scale: (0.1 * scale).into() };
    let normals = NormalModifier::NormalMap { map: checker(2.0), strength: 0.7.into() };
    let mapped =
        [(Material::diffuse(Rgb::gray(0.7)), bumps.clone()), (Material::mirror(Rgb::WHITE), normals), (Material::glass(1.4), bumps)];
    let mapped = mapped.map(|(material, normal_modifier)| SurfaceMaterial { normal_modifier: Some(normal_modifier), ..material.into() });
    plain.map(SurfaceMaterial::from).into_iter().chain(mapped).collect()
}

/// Eighty triangles, with interpolated normals or without.
fn ball(is_smooth: bool) -> MeshData {
    let (points, triangles) = icosphere(1);
    let positions: Vec<Vec3> = points.iter().map(|p| p.as_vec3() * 0.5).collect();
    let normals = points.iter().filter(|_| is_smooth).map(|p| p.as_vec3()).collect();
    let uvs = points.iter().map(|p| p.as_vec3().truncate()).collect();
    MeshData { normals, positions, triangles, uvs, ..MeshData::default() }
}
