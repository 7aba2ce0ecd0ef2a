//! Texture footprints: differentials of rays along mirrors and glass, and averages of textures over what a pixel shows.

use std::sync::Arc;

use glam::{DVec2, DVec3, UVec2, Vec2, Vec3};
use pt::bsdf::{Material, MaterialId, TransportMode};
use pt::camera::{Camera, Perspective, Pose};
use pt::effects::Effects;
use pt::film::{FilmSpec, TextureFootprint};
use pt::math::{Ray, RayDifferential, Rgb, Transform};
use pt::render::{Render, SampleId, Settings};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;
use pt::shape::sdf::{Ball, Field, Ring, SmoothUnion};
use pt::shape::{
    BilinearPatch, Cone, Cuboid, Cylinder, MeshData, PartialSphere, Quad, Sdf, Sphere, SurfacePoint, TriangleMesh, VertexColor,
};
use pt::texture::image::{Filter, Pixels, Wrap};
use pt::texture::noise::{fbm, filtered_fbm};
use pt::texture::pyramid::Pyramid;
use pt::texture::{Checker, Footprint, Image, Space, Texture, TextureContext};
use pt::world::{Objects, World, WorldBuilder};

use crate::random::Random;

fn place(steps: &[Transform]) -> Transform {
    steps.iter().fold(Transform::IDENTITY, |all, step| all.then(step))
}

fn moved(x: f64, y: f64, z: f64) -> Transform {
    Transform::translate(DVec3::new(x, y, z)).expect("finite")
}

fn camera() -> Camera {
    let pose = Pose::look_at(DVec3::new(0.0, 0.0, 6.0), DVec3::ZERO, DVec3::Y).expect("y is not the axis");
    Camera::Perspective(Perspective::new(pose, 40.0, 0.0, 1.0))
}

/// A scene of one object and a large box around it.
fn world(add: impl Fn(&mut WorldBuilder, [MaterialId; 2])) -> World {
    let mut builder = World::builder(camera());
    let smooth = [Material::mirror(1.0), Material::glass(1.5)].map(|material| builder.material(material));
    let matte = builder.material(Material::diffuse(0.5));
    builder.shape(Cuboid { size: [20.0; 3] }, moved(0.3, 0.2, 0.1), matte, None);
    add(&mut builder, smooth);
    builder.build().expect("a sound scene")
}

/// A ball that goes smoothly into a ring around it, as a distance field.
fn field() -> Sdf {
    let ball = Field::Ball(Ball { center: DVec3::ZERO, radius: 0.8 });
    let ring = Field::Ring(Ring { center: DVec3::ZERO, radius: 0.9, tube: 0.3, half: false });
    Sdf::new(Field::SmoothUnion(SmoothUnion { of: vec![ball, ring], width: 0.4 }))
}

/// Adds a group of objects and an instance of it.
fn show_instance(builder: &mut WorldBuilder, objects: Objects, to: Transform) {
    let group = builder.group(objects);
    let mut shown = Objects::default();
    shown.instance(group, to, None);
    builder.objects(shown);
}

/// A dome with normals that are interpolated over its triangles.
fn dome() -> TriangleMesh {
    let n = 8;
    let at = |i: u32, j: u32| {
        let (u, v) = (f64::from(i) / f64::from(n) * 2.0 - 1.0, f64::from(j) / f64::from(n) * 2.0 - 1.0);
        Vec3::new(u as f32, v as f32, (0.5 - 0.3 * (u * u + v * v)) as f32)
    };
    let normal = |p: Vec3| Vec3::new(0.6 * p.x, 0.6 * p.y, 1.0).normalize();
    let positions: Vec<Vec3> = (0..=n).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let corner = |i: u32, j: u32| j * (n + 1) + i;
    let cell =
        |i: u32, j: u32| [[corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)], [corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)]];
    let triangles = (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect();
    let normals = positions.iter().map(|p| normal(*p)).collect();
    TriangleMesh::new(MeshData { positions, normals, triangles, ..MeshData::default() })
}

/// How a path goes on at each surface.
#[derive(Clone, Copy, Debug)]
enum Turn {
    Reflect,
    Refract,
}

/// Point where a path ends after some turns, the length of its last part, and the differential there.
fn follow(world: &World, mut ray: Ray, mut differential: RayDifferential, turns: &[Turn]) -> Option<(Vec3, [Vec3; 2])> {
    for turn in turns {
        let hit = world.intersect(&ray)?;
        let (surface, at) = world.surface_with_footprint(&ray, &hit, &differential);
        let wo = -ray.direction;
        let is_wanted = |wi: Vec3| (wi.dot(surface.point.ng) * wo.dot(surface.point.ng) > 0.0) == matches!(turn, Turn::Reflect);
        let (wi, lobe) = surface.delta_lobes(wo, TransportMode::Radiance).find(|(wi, _)| is_wanted(*wi))?;
        differential = at?.scattered(surface.frame.z, ray.direction, wi, lobe.eta)?;
        ray = surface.spawn(wi, 0.0);
    }
    let hit = world.intersect(&ray)?;
    let ng = world.surface(&ray, &hit).point.ng;
    Some((ray.at(hit.t), differential.on_plane(ray.direction, hit.t, ng)))
}

/// What the differential of a path says of the point where it ends is what neighbouring paths do: after reflection by and refraction
/// through flat and curved surfaces, meshes with interpolated normals, and all of these as instances.
///
/// The neighbours are 2⁻¹¹ of the picture's width to each side. Their difference has an error of the second order of that, relative to the
/// curvature of what they pass, and one of the rounding of f32 positions, some 1e-6 of some 1e-3.
#[test]
fn differentials_are_those_of_neighbouring_rays() {
    let turned = place(&[
        Transform::scale(DVec3::new(1.3, 0.8, 1.1)).expect("not flat"),
        Transform::rotate(DVec3::new(0.3, 1.0, 0.2), 35.0).expect("an axis"),
        moved(0.1, -0.1, 0.2),
    ]);
    type Add = fn(&mut WorldBuilder, MaterialId, Transform);
    let direct: [(&str, Add); 8] = [
        ("ellipsoid", |builder, material, to| builder.shape(Sphere { radius: 1.0 }, to, material, None)),
        ("box", |builder, material, to| builder.shape(Cuboid { size: [2.0; 3] }, to, material, None)),
        ("dome", |builder, material, to| builder.shape(dome(), to, material, None)),
        ("field", |builder, material, to| builder.shape(field(), to, material, None)),
        ("open cylinder", |builder, material, to| {
            builder.shape(Cylinder { radius: 0.8, z: [-1.0, 1.0], phi_max: 360.0 }, to, material, None);
        }),
        ("open cone", |builder, material, to| builder.shape(Cone { radius: 1.0, height: 1.5, phi_max: 360.0 }, to, material, None)),
        ("open belt", |builder, material, to| {
            builder.shape(PartialSphere { radius: 1.0, z: [-0.7, 0.8], phi_max: 360.0 }, to, material, None);
        }),
        ("open patch", |builder, material, to| {
            let corners = [[-1.0, -1.0, 0.3], [1.0, -1.0, -0.3], [-1.0, 1.0, -0.3], [1.0, 1.0, 0.3]].map(DVec3::from);
            builder.shape(BilinearPatch { corners }, to, material, None);
        }),
    ];
    let instanced: [(&str, Add); 3] = [
        ("instance of an ellipsoid", |builder, material, to| {
            let mut objects = Objects::default();
            objects.shape(Sphere { radius: 1.0 }, Transform::scale(DVec3::new(1.0, 1.2, 0.9)).expect("not flat"), material, None);
            show_instance(builder, objects, to);
        }),
        ("instance of a field", |builder, material, to| {
            let mut objects = Objects::default();
            objects.shape(field(), Transform::IDENTITY, material, None);
            show_instance(builder, objects, to);
        }),
        ("instance of a dome", |builder, material, to| {
            let mut objects = Objects::default();
            objects.shape(dome(), Transform::IDENTITY, material, None);
            show_instance(builder, objects, to);
        }),
    ];
    let paths: [(usize, &[Turn]); 4] = [(0, &[]), (0, &[Turn::Reflect]), (1, &[Turn::Refract]), (1, &[Turn::Refract, Turn::Refract])];
    let mut random = Random::new(1);
    for (name, add) in direct.into_iter().chain(instanced) {
        // What is open lets no light out that goes in.
        let is_open = name.contains("dome") || name.contains("open");
        let paths = paths.into_iter().filter(|(_, turns)| turns.len() < 2 || !is_open);
        for (material, turns) in paths {
            let world = world(|builder, materials| add(builder, materials[material], turned));
            let (step, mut checked) = (1.0 / 2048.0, 0);
            for _ in 0..400 {
                let film = Vec2::new(random.unit() as f32, random.unit() as f32) * 0.3 + 0.35;
                let ray = |film: Vec2| world.camera().ray(film, 1.0, Vec2::ZERO, 0.0);
                let differential = |film: Vec2| world.camera().differential(&ray(film), film, Vec2::splat(step), 1.0, Vec2::ZERO);
                let end = |film: Vec2| follow(&world, ray(film), differential(film), turns);
                let Some((_, expected)) = end(film) else { continue };
                for (k, axis) in [Vec2::X, Vec2::Y].into_iter().enumerate() {
                    let (Some((before, b)), Some((after, a))) = (end(film - axis * step), end(film + axis * step)) else { continue };
                    let found = (after - before) * 0.5;
                    // Neighbours that pass other faces, or the rim of a refracting body, are of another kind.
                    let is_smooth = (a[k] - b[k]).length() < 0.02 * expected[k].length();
                    if is_smooth && found.length() < 0.5 {
                        let error = (found - expected[k]).length();
                        assert!(error <= 0.03 * expected[k].length() + 1e-5, "{name} {turns:?}: {} for {found} at {film}", expected[k]);
                        checked += 1;
                    }
                }
            }
            assert!(checked >= 200, "{name} {turns:?}: {checked} checked");
        }
    }
}

fn point(uv: Vec2) -> SurfacePoint {
    SurfacePoint { p: uv.extend(0.0), offset: 0.0, ng: Vec3::Z, ns: Vec3::Z, uv, color: VertexColor::WHITE }
}

fn over(uv: Vec2, sides: [Vec2; 2]) -> TextureContext {
    let footprint = Footprint::new(sides.map(|side| side.extend(0.0)), Some([Vec3::X, Vec3::Y]));
    TextureContext { footprint: Some(footprint), ..TextureContext::exact(&point(uv)) }
}

fn picture(size: UVec2, values: Vec<[f32; 3]>, wrap: Wrap) -> Texture {
    let pixels = Arc::new(Pixels::new(size, values).expect("as many values as pixels"));
    let pyramid = Some(Arc::new(Pyramid::new(&pixels)));
    Texture::Image(Image { pixels, pyramid, scale: Vec2::ONE, wrap, filter: Filter::Bilinear })
}

/// Over a footprint much larger than the picture a lookup gives its mean, whatever its size.
#[test]
fn pyramids_keep_the_mean() {
    let mut random = Random::new(2);
    for size in [UVec2::new(1, 1), UVec2::new(8, 8), UVec2::new(7, 5), UVec2::new(13, 1), UVec2::new(2, 31), UVec2::new(100, 63)] {
        let values: Vec<[f32; 3]> = (0..size.element_product()).map(|_| [(); 3].map(|()| random.unit() as f32)).collect();
        let mean = [0, 1, 2].map(|k| values.iter().map(|v| f64::from(v[k])).sum::<f64>() / values.len() as f64);
        let texture = picture(size, values, Wrap::Repeat);
        let found = texture.at(&over(Vec2::new(0.3, 0.7), [Vec2::new(900.0, 0.0), Vec2::new(0.0, 900.0)]));
        for (found, mean) in found.to_array().into_iter().zip(mean) {
            // Each level is rounded once.
            assert!((f64::from(found) - mean).abs() <= 8.0 * f64::from(f32::EPSILON) * mean, "{size}: {found}, mean {mean}");
        }
    }
}

/// The weights of an average have the sum 1 and the covariance of the footprint, (aaᵀ + bbᵀ)/12 for the sides a and b, from the size of a
/// few pixels to a quarter of the picture, and for oblong and slanted footprints. They are seen in pictures of a single white pixel.
#[test]
fn filtered_pictures_have_the_spread_of_the_footprint() {
    let n = 256u32;
    let mut values = vec![[0.0; 3]; (n * n) as usize];
    let lit = UVec2::new(101, 77);
    values[(lit.y * n + lit.x) as usize] = [1.0; 3];
    let texture = picture(UVec2::splat(n), values, Wrap::Repeat);
    let center = DVec2::new(f64::from(lit.x) + 0.5, f64::from(lit.y) + 0.5);
    for (a, b) in [([4.0, 0.0], [0.0, 4.0]), ([12.0, 3.0], [-2.0, 6.0]), ([5.0, 5.0], [-30.0, 30.0]), ([64.0, 0.0], [0.0, 50.0])] {
        let sides = [a, b].map(|[x, y]: [f64; 2]| DVec2::new(x, y));
        let (mut sum, mut moments) = (0.0, [0.0; 3]);
        let reach = sides.iter().map(|side| side.abs().max_element()).sum::<f64>().ceil() as i32 + 8;
        // Positions with other fractions than those of pixels, so that all alignments of the levels count.
        for (i, j) in (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (i, j))) {
            let away = DVec2::new(f64::from(i) + 0.37, f64::from(j) - 0.21);
            let pixel = center + away;
            let uv = DVec2::new(pixel.x / f64::from(n), 1.0 - pixel.y / f64::from(n)).as_vec2();
            let sides = sides.map(|side| (side * DVec2::new(1.0, -1.0) / f64::from(n)).as_vec2());
            let weight = f64::from(texture.at(&over(uv, sides)).to_array()[0]);
            sum += weight;
            moments = [moments[0] + weight * away.x * away.x, moments[1] + weight * away.x * away.y, moments[2] + weight * away.y * away.y];
        }
        let [a, b] = sides;
        let expected = [a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y].map(|x| x / 12.0);
        // The lit pixel has a variance of its own, and lookups on a level weight it by the place of the level's pixels.
        assert!((sum - 1.0).abs() < 0.08, "{sides:?}: {sum}");
        let size = expected[0].max(expected[2]);
        for (found, expected) in moments.map(|m| m / sum).into_iter().zip(expected) {
            assert!((found - expected).abs() < 0.12 * size + 0.1, "{sides:?}: {found}, expected {expected}");
        }
    }
}

/// Where the footprint is smaller than a pixel of the picture the lookup is that of the point, bit for bit.
#[test]
fn enlarged_pictures_are_looked_up_at_points() {
    let mut random = Random::new(3);
    let values: Vec<[f32; 3]> = (0..64).map(|_| [(); 3].map(|()| random.unit() as f32)).collect();
    let texture = picture(UVec2::splat(8), values, Wrap::Mirror);
    for _ in 0..1000 {
        let uv = Vec2::new(random.unit() as f32, random.unit() as f32) * 3.0;
        let side = || Vec2::new(0.08, 0.0);
        let sides = [side(), Vec2::new(0.0, 0.05)];
        assert_eq!(texture.at(&over(uv, sides)), texture.at(&TextureContext::exact(&point(uv))));
    }
}

/// A checkerboard over a footprint is its mean over the box with the footprint's variance along each axis, by quadrature.
#[test]
fn filtered_checkers_are_means_over_boxes() {
    let checker = Checker { even: Rgb::WHITE.into(), odd: Rgb::BLACK.into(), scale: Vec3::splat(2.0), space: Space::Uv };
    let texture = Texture::Checker(Box::new(checker));
    let mut random = Random::new(4);
    for _ in 0..200 {
        let mut uniform = |most: f64| ((2.0 * random.unit() - 1.0) * most) as f32;
        let uv = Vec2::new(uniform(3.0), uniform(3.0));
        let sides = [Vec2::new(uniform(1.0), uniform(0.4)), Vec2::new(uniform(0.3), uniform(2.0))];
        let widths = (sides[0] * sides[0] + sides[1] * sides[1]).as_dvec2().map(f64::sqrt);
        let n = 400;
        let at = |i: i32, j: i32| {
            let inside = DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5) / f64::from(n) - 0.5;
            let cell = ((uv.as_dvec2() + inside * widths) * 2.0).floor();
            if (cell.x + cell.y).rem_euclid(2.0) < 1.0 { 1.0 } else { 0.0 }
        };
        let mean = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).map(|(i, j)| at(i, j)).sum::<f64>() / f64::from(n * n);
        let found = f64::from(texture.at(&over(uv, sides)).to_array()[0]);
        // Each border of cells is off by half a step of the quadrature at most; a side crosses up to ten.
        assert!((found - mean).abs() < 10.0 / f64::from(n), "{uv} {sides:?}: {found}, quadrature {mean}");
    }
}

/// Noise over a footprint is nearer to its mean over the box than noise at the point is, and loses all octaves finer than the footprint.
#[test]
fn filtered_noise_is_near_its_mean() {
    let mut random = Random::new(5);
    assert_eq!(filtered_fbm(DVec3::new(0.3, 0.4, 0.9), 6, 0.0), fbm(DVec3::new(0.3, 0.4, 0.9), 6));
    assert_eq!(filtered_fbm(DVec3::new(0.3, 0.4, 0.9), 6, 1.5), 0.0);
    for width in [0.1, 0.3, 0.6] {
        let (mut filtered, mut exact) = (0.0, 0.0);
        for _ in 0..300 {
            let p = random.in_cube() * 50.0;
            let inside = |i: i32| (f64::from(i) + 0.5) / 12.0 - 0.5;
            let cells = (0..12).flat_map(|i| (0..12).flat_map(move |j| (0..12).map(move |k| DVec3::new(inside(i), inside(j), inside(k)))));
            let mean = cells.map(|offset| fbm(p + offset * width, 6)).sum::<f64>() / 1728.0;
            filtered += (filtered_fbm(p, 6, width) - mean).powi(2);
            exact += (fbm(p, 6) - mean).powi(2);
        }
        assert!(filtered < 0.5 * exact, "{width}: {filtered} and {exact}");
    }
}

/// The footprint of a sample depends on its index alone, is the same in all sequences, and shrinks with the samples before it.
#[test]
fn footprints_shrink_with_the_index_of_the_sample() {
    let width = |index, sequences| TextureFootprint::Shrinking.width(index, sequences);
    assert_eq!([0, 1, 2, 3, 4, 7, 8, 1023, 1024].map(|i| width(i, 1).recip()), [1.0, 1.0, 2.0, 2.0, 4.0, 4.0, 8.0, 512.0, 1024.0]);
    for sequences in [2, 3, 8] {
        for index in 0..1000 {
            assert_eq!(width(index, sequences), width(index - index % sequences, sequences), "{index} of {sequences}");
            assert!(width(index, sequences) <= (2.0 * sequences as f32 / (index + 1) as f32).min(1.0));
        }
    }
    assert_eq!(TextureFootprint::Fixed(0.25).width(77, 2), 0.25);
}

/// A checkered plane that reaches to the horizon, lit from everywhere alike.
fn plane() -> World {
    let pose = Pose::look_at(DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.3, 0.8, -1.0), DVec3::Y).expect("y is not the axis");
    let mut builder = World::builder(Camera::Perspective(Perspective::new(pose, 50.0, 0.0, 1.0)));
    let checker =
        Checker { even: Rgb::gray(0.9).into(), odd: Rgb::gray(0.1).into(), scale: Vec3::ONE, space: Space::World(Transform::IDENTITY) };
    let checkered = builder.material(Material::diffuse(Texture::Checker(Box::new(checker))));
    let flat = Transform::rotate(DVec3::X, -90.0).expect("x is an axis");
    builder.shape(Quad { size: [4000.0, 4000.0] }, flat.then(&moved(0.0, -0.5, 0.0)), checkered, None);
    builder.light(pt::light::Light::Environment(pt::light::Environment { radiance: Rgb::WHITE }));
    builder.build().expect("a sound scene")
}

/// At one sample per pixel the picture of a plane to the horizon has at most half the squared error that lookups at points have, and the
/// bias that remains after many samples is small: the mean of the picture is that of lookups at points.
#[test]
fn footprints_take_aliasing_away() {
    let world: Arc<dyn Scene> = Arc::new(plane());
    assert!(world.effects().contains(Effects::FOOTPRINTS));
    let spec = |footprint| FilmSpec { texture_footprint: footprint, ..FilmSpec::new(40, 30) };
    let settings = Settings::new(SamplerSpec { kind: Kind::Independent, seed: 7, ..SamplerSpec::default() });
    let integrator = pt::integrators::path::Path::default();
    let [filtered, exact] = [TextureFootprint::Shrinking, TextureFootprint::Fixed(0.0)]
        .map(|footprint| Render::new(world.clone(), &integrator, &spec(footprint), &settings));
    let (mut errors, mut means) = ([0.0; 2], [0.0; 2]);
    let samples = 256;
    for pixel in (0..30).flat_map(|y| (0..40).map(move |x| (x, y))) {
        let value = |render: &Render, index| f64::from(render.replay(SampleId { pixel, index }, None).average());
        let mean = |render: &Render| (0..samples).map(|index| value(render, index)).sum::<f64>() / samples as f64;
        let truth = mean(&exact);
        for (k, render) in [&filtered, &exact].into_iter().enumerate() {
            // Another sample than those of the reference, with the width of the first.
            errors[k] += (value(render, 0) - truth).powi(2);
            means[k] += mean(render) / 1200.0;
        }
    }
    assert!(errors[0] < 0.5 * errors[1], "{errors:?}");
    // The mean of 300 000 samples of two values .4 from their mean has a standard error of 7e-4; the lookups share their numbers.
    assert!((means[0] - means[1]).abs() < 2e-3, "{means:?}");
}
