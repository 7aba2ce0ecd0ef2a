//! Layers (AOVs): they match formulas and do not change the picture itself.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use assert_cmd::Command;
use glam::{DMat4, DVec3, DVec4, UVec2, Vec3};
use pt::bsdf::Material;
use pt::camera::{Camera, Fisheye, FisheyeMapping, Orthographic, Perspective, Pose, Spherical};
use pt::film::{Crop, FilmSpec, Filter, Image, Layer, LightNames, MomentFilm};
use pt::integrator::choose;
use pt::integrators::ALL;
use pt::integrators::path::Path as ByChance;
use pt::light::Emitter;
use pt::math::{Rgb, Spectrum, Transform};
use pt::output::attributes::of_camera;
use pt::output::{self, Value};
use pt::render::{Render, Settings, Silent};
use pt::sampler::{Kind, SamplerSpec};
use pt::shape::{MeshData, Quad, Sphere, TriangleMesh};
use pt::texture::{Checker, Space, Texture};
use pt::world::{World, WorldBuilder};

use crate::scenes::{at, facing, gray, picture, stored};
use pt::torture::everything::{self, Everything, Lens, Shot, bits};

/// Radius of the box filter that makes a pixel nearly a point [pixels].
const POINT: f32 = 1e-5;
/// Tolerance for coordinates of about 30 in f32 that change by 0.1 per pixel.
const CLOSE: f64 = 2e-5;

fn all() -> Vec<Layer> {
    Layer::ALL.iter().map(|row| row.0).filter(|layer| layer.is_reproducible()).collect()
}

/// Film with all layers, in which every pixel is nearly a point.
fn points(width: u32, height: u32) -> FilmSpec {
    FilmSpec { filter: Filter::pixel_box(POINT), layers: all(), ..FilmSpec::new(width, height) }
}

/// Renders only emission and layers, which is all that these tests need.
fn taken(scene: Arc<World>, film: FilmSpec, sampler: SamplerSpec) -> Image {
    picture(scene, &ByChance { max_depth: 0, ..ByChance::default() }, film, sampler)
}

fn spp(spp: u64) -> SamplerSpec {
    SamplerSpec { spp, seed: 5, ..SamplerSpec::default() }
}

fn built(world: WorldBuilder) -> Arc<World> {
    Arc::new(world.build().expect("a scene"))
}

/// Numbers of a layer in pixel i.
fn numbers(image: &Image, layer: Layer, i: usize) -> Vec<f64> {
    layer
        .channels(&LightNames::default())
        .iter()
        .map(|name| f64::from(image.channel(name).unwrap_or_else(|| panic!("no {name}"))[i]))
        .collect()
}

fn vector(image: &Image, layer: Layer, i: usize) -> DVec3 {
    DVec3::from_slice(&numbers(image, layer, i))
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, expected {expected}");
}

/// Orthographic camera, 2 m high, at `distance` in front of `center`, looking along −z.
fn straight(center: DVec3, distance: f64) -> Camera {
    Camera::Orthographic(Orthographic { pose: Pose::new(&at(center + distance * DVec3::Z)), height: 2.0 })
}

/// Nearest hit with a sphere by the quadratic formula, in the user's coordinates.
#[test]
fn position_layers_match_a_sphere() {
    const FOV: f64 = 40.0;
    let (center, radius) = (DVec3::new(10.0, -20.0, 30.0), 1.5);
    let eye = center + DVec3::new(0.5, 0.25, 5.0);
    let pose = Pose::new(&at(eye));
    let mut world = World::builder(Camera::Perspective(Perspective::new(pose, FOV, 0.0, 1.0)));
    let matte = world.material(Material::diffuse(Rgb::new(0.25, 0.5, 0.75)));
    world.shape(Sphere { radius }, at(center), matte, None);
    // This shape moves the middle of the scene away from its only other shape.
    world.shape(Sphere { radius: 0.1 }, at(center + DVec3::new(0.0, 0.0, 90.0)), matte, None);
    let [w, h] = [24_u32, 18];
    let image = taken(built(world), points(w, h), spp(4));
    let tau = (0.5 * FOV).to_radians().tan();
    let mut met = 0;
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
        let i = (y * w + x) as usize;
        let film = [(f64::from(x) + 0.5) / f64::from(w), (f64::from(y) + 0.5) / f64::from(h)];
        let d = DVec3::new((2.0 * film[0] - 1.0) * tau * 4.0 / 3.0, (1.0 - 2.0 * film[1]) * tau, -1.0).normalize();
        let (half_b, c) = ((eye - center).dot(d), (eye - center).length_squared() - radius * radius);
        let discriminant = half_b * half_b - c;
        if discriminant < 0.0 {
            for layer in all() {
                assert!(numbers(&image, layer, i).iter().all(|v| *v == 0.0), "{layer:?} of what misses");
            }
        } else if discriminant > 0.05 {
            met += 1;
            let p = eye + d * (-half_b - discriminant.sqrt());
            let n = (p - center) / radius;
            assert!(vector(&image, Layer::Position, i).distance(p) < CLOSE, "{x} {y}: {} {p}", vector(&image, Layer::Position, i));
            assert!(vector(&image, Layer::Normal, i).distance(n) < CLOSE, "{x} {y}");
            assert!(vector(&image, Layer::ShadingNormal, i).distance(n) < CLOSE, "{x} {y}");
            near(numbers(&image, Layer::Depth, i)[0], eye.z - p.z, CLOSE, "Z");
            assert_eq!(numbers(&image, Layer::Albedo, i), [0.25, 0.5, 0.75]);
        }
    }
    assert!(met > 50, "{met}");
}

/// u and v run along the sides of a quad, and the colours of the checker follow them.
#[test]
fn a_textured_quad_has_its_coordinates_and_colours() {
    let colors = [Spectrum::rgb(0.9, 0.5, 0.125), Spectrum::rgb(0.25, 0.375, 0.75)];
    let [even, odd] = colors.map(|color| Texture::from(stored(color)));
    let checker = Checker { even, odd, scale: Vec3::splat(3.0), space: Space::Uv };
    let mut world = World::builder(straight(DVec3::ZERO, 5.0));
    let matte = world.material(Material::diffuse(Texture::Checker(Box::new(checker))));
    world.shape(Quad { size: [2.0, 2.0] }, Transform::IDENTITY, matte, None);
    const EDGE: u32 = 16;
    let image = taken(built(world), points(EDGE, EDGE), spp(2));
    for (x, y) in (0..EDGE).flat_map(|y| (0..EDGE).map(move |x| (x, y))) {
        let i = (y * EDGE + x) as usize;
        let [u, v] = [(f64::from(x) + 0.5) / 16.0, 1.0 - (f64::from(y) + 0.5) / 16.0];
        let found = numbers(&image, Layer::Uv, i);
        near(found[0], u, 1e-6, "u");
        near(found[1], v, 1e-6, "v");
        let cell = (3.0 * u).floor() + (3.0 * v).floor();
        let expected = colors[usize::from(cell % 2.0 == 1.0)].to_rgb().map(f64::from);
        assert_eq!(numbers(&image, Layer::Albedo, i), expected, "{x} {y}");
        assert_eq!(vector(&image, Layer::Normal, i), DVec3::Z);
    }
}

/// The layer ns has the interpolated normal, and n that of the triangle.
#[test]
fn shading_and_geometric_normals_have_separate_layers() {
    let positions = [Vec3::new(-2.0, -2.0, 0.0), Vec3::new(2.0, -2.0, 0.0), Vec3::new(0.0, 2.0, 0.0)];
    let normals = [Vec3::new(-0.6, 0.0, 0.8), Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8)];
    let data = MeshData { positions: positions.into(), normals: normals.into(), triangles: vec![[0, 1, 2]], ..MeshData::default() };
    let mut world = World::builder(straight(DVec3::ZERO, 3.0));
    let matte = world.material(Material::diffuse(stored(gray(0.5))));
    world.shape(TriangleMesh::new(data), Transform::IDENTITY, matte, None);
    let image = taken(built(world), points(9, 9), spp(2));
    for i in [13, 31, 40, 44, 58, 76] {
        let p = vector(&image, Layer::Position, i);
        // Barycentric weights of the apex and of the right corner.
        let c = (p.y + 2.0) / 4.0;
        let b = (p.x + 2.0 * (1.0 - c)) / 4.0;
        let weights = [1.0 - b - c, b, c];
        let ns: DVec3 = normals.iter().zip(weights).map(|(n, w)| n.as_dvec3() * w).sum();
        assert!(vector(&image, Layer::ShadingNormal, i).distance(ns.normalize()) < 1e-5, "{i}");
        assert_eq!(vector(&image, Layer::Normal, i), DVec3::Z);
    }
}

/// In a pixel that is half covered, colours and normals are weighted by the coverage, and positions are not.
#[test]
fn positions_are_means_over_hits_and_colours_over_samples() {
    let mut world = World::builder(straight(DVec3::ZERO, 5.0));
    let matte = world.material(Material::diffuse(stored(gray(0.5))));
    // The quad ends in the middle of a column of pixels, each 0.25 m wide.
    world.shape(Quad { size: [1.25, 2.0] }, at(DVec3::new(-0.5, 0.0, 0.0)), matte, None);
    let scene = built(world);
    for filter in [Filter::default(), Filter::gaussian(1.5, 0.5), Filter::mitchell(2.0, 1.0 / 3.0, 1.0 / 3.0)] {
        let film = FilmSpec { filter: filter.clone(), layers: all(), ..FilmSpec::new(8, 8) };
        let image = taken(scene.clone(), film, spp(64));
        let i = 4 * 8 + 4;
        let share = numbers(&image, Layer::Normal, i)[2];
        // Half of the pixel's filter lies over the quad, for any filter. 64 samples estimate it to a few hundredths.
        near(share, 0.5, 0.05, "share");
        let albedo = numbers(&image, Layer::Albedo, i)[0];
        near(albedo, 0.5 * share, 1e-6, "albedo");
        assert_eq!(numbers(&image, Layer::Depth, i), [5.0]);
        let p = vector(&image, Layer::Position, i);
        // The mean position lies on the quad. A mean over all samples, or one with negative weights, would not.
        assert!((-1.125..0.125).contains(&p.x) && p.x > -0.4 && p.z == 0.0, "{p} {filter:?}");
        let u = numbers(&image, Layer::Uv, i)[0];
        near(u, (p.x + 1.125) / 1.25, 1e-6, "u");
    }
}

/// Layers have the weights of the picture: for white light of radiance 1, the albedo layer of a lamp equals the picture.
#[test]
fn layers_have_the_weights_of_the_picture() {
    let mut world = World::builder(straight(DVec3::ZERO, 5.0));
    let black = world.material(Material::diffuse(Rgb::BLACK));
    world.shape(Sphere { radius: 0.7 }, at(DVec3::ZERO), black, Some(Emitter::new(Rgb::WHITE)));
    let scene = built(world);
    for filter in [Filter::default(), Filter::tent(1.0), Filter::gaussian(1.5, 0.5), Filter::mitchell(2.0, 1.0 / 3.0, 1.0 / 3.0)] {
        for kind in [Kind::Independent, Kind::Sobol] {
            let film = FilmSpec { filter: filter.clone(), layers: all(), ..FilmSpec::new(20, 15) };
            // A single scrambling, so that picture and layers are summed in the same order.
            let image = taken(scene.clone(), film, SamplerSpec { kind, scramblings: 1, ..spp(13) });
            for (color, albedo) in [("R", "Albedo.R"), ("B", "Albedo.B")] {
                let of = |name: &str| image.channel(name).expect(name).iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                assert!(of(color) == of(albedo), "{filter:?} {kind:?}");
            }
        }
    }
}

/// Mean of a layer over a wall that fills the picture, seen perpendicularly.
fn wall(material: Material, emission: Option<Emitter>) -> DVec3 {
    let mut world = World::builder(straight(DVec3::ZERO, 5.0));
    let material = world.material(material);
    world.shape(Quad { size: [4.0, 4.0] }, Transform::IDENTITY, material, emission);
    let film = FilmSpec { layers: vec![Layer::Albedo], ..FilmSpec::new(16, 16) };
    let image = taken(built(world), film, spp(64));
    (0..256).map(|i| vector(&image, Layer::Albedo, i)).sum::<DVec3>() / 256.0
}

/// The albedo layer has the albedo of each model for light along the normal.
#[test]
fn albedo_layers_match_each_model() {
    let color = Spectrum::rgb(0.25, 0.5, 0.75);
    let expected = DVec3::new(0.25, 0.5, 0.75);
    assert_eq!(wall(Material::diffuse(stored(color)), None), expected);
    assert_eq!(wall(Material::mirror(stored(color)), None), expected);
    assert_eq!(wall(Material::mirror(Rgb::BLACK), None), DVec3::ZERO);
    // Glass loses no light, although radiance is scaled by η² inside.
    assert!(wall(Material::glass(1.5), None).distance(DVec3::ONE) < 1e-6);
    // Plastic: F₀ + (1 − F₀)(1 − F̄ᵢ) ρ/(1 − ρ F̄ᵢ).
    let (eta, rho) = (1.5, 0.5);
    let f0 = ((eta - 1.0_f64) / (eta + 1.0)).powi(2);
    let internal = 1.0 - (1.0 - mean_fresnel(eta)) / (eta * eta);
    let plastic = f0 + (1.0 - f0) * (1.0 - internal) * rho / (1.0 - rho * internal);
    // 16384 drawn directions, whose weights differ by a tenth.
    near(wall(Material::plastic(stored(gray(rho)), eta as f32), None).x, plastic, 3e-3, "plastic");
    // An emitting surface has the colour of its light, independent of its brightness.
    let light = Some(Emitter::new(Rgb::new(2e6, 4e6, 1e6)));
    assert_eq!(wall(Material::diffuse(stored(color)), light), DVec3::new(0.5, 1.0, 0.25));
}

/// 2 ∫ F(μ) μ dμ, by the midpoint rule.
fn mean_fresnel(eta: f64) -> f64 {
    const STEPS: usize = 100_000;
    let f = |mu: f64| {
        let inside = (1.0 - (1.0 - mu * mu) / (eta * eta)).sqrt();
        let (s, p) = ((mu - eta * inside) / (mu + eta * inside), (eta * mu - inside) / (eta * mu + inside));
        0.5 * (s * s + p * p)
    };
    (0..STEPS).map(|k| (k as f64 + 0.5) / STEPS as f64).map(|mu| 2.0 * f(mu) * mu).sum::<f64>() / STEPS as f64
}

/// The depth in a panorama is the distance.
#[test]
fn the_depth_of_a_panorama_is_the_distance() {
    let middle = DVec3::new(1.0, 2.0, 3.0);
    let pose = Pose::new(&at(middle));
    let fisheye = Fisheye::new(pose.clone(), 360.0, FisheyeMapping::Equisolid);
    for camera in [Camera::Spherical(Spherical { pose }), Camera::Fisheye(fisheye)] {
        let is_round = matches!(camera, Camera::Fisheye(_));
        let mut world = World::builder(camera);
        let matte = world.material(Material::diffuse(stored(gray(0.5))));
        world.shape(Sphere { radius: 3.0 }, at(middle), matte, None);
        let scene = built(world);
        let film = FilmSpec { layers: vec![Layer::Depth, Layer::Position], ..FilmSpec::new(16, 8) };
        let image = taken(scene.clone(), film.clone(), spp(4));
        for i in 0..128 {
            // Pixels that lie outside of the circle of 8 pixels in the middle see nothing.
            let (x, y) = (i as f64 % 16.0 - 7.5, (i / 16) as f64 - 3.5);
            let is_seen = !is_round || x.hypot(y) < 4.0 - 0.5f64.sqrt();
            let is_outside = is_round && x.hypot(y) > 4.0 + 0.5f64.sqrt();
            match numbers(&image, Layer::Depth, i)[0] {
                z if is_seen => near(z, 3.0, 1e-5, "Z"),
                z if is_outside => assert_eq!(z, 0.0, "pixel {i}"),
                z => assert!(z == 0.0 || (z - 3.0).abs() < 1e-5, "pixel {i}: {z}"),
            }
        }
        let names: Vec<String> = of_camera(&*scene, &film).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["worldToCamera"], "no matrix makes a panorama");
    }
}

/// The matrices of OpenEXR map positions, as row vectors, to camera space and to pixels.
#[test]
fn matrices_find_the_pixel() {
    let (eye, target) = (DVec3::new(3.0, 4.0, 9.0), DVec3::new(5.0, 1.0, 2.0));
    let pose = Pose::new(&Transform::look_at(eye, target, DVec3::new(0.1, 1.0, 0.2)).expect("a pose"));
    let perspective = Perspective::new(pose.clone(), 50.0, 0.0, 1.0);
    let tan = |angle: f64| (0.5 * angle).to_radians().tan();
    let mut shifted = 0;
    for (camera, seen, pixel) in [
        (Camera::Perspective(perspective.clone()), Some(2.0 * tan(50.0) * 1.5), None),
        (Camera::Perspective(perspective.clone().shifted([0.2, -0.3])), Some(2.0 * tan(50.0) * 1.5), None),
        (Camera::Perspective(perspective.across(50.0, 40.0)), Some(2.0 * tan(40.0)), Some(tan(40.0) / tan(50.0) / 1.5)),
        (Camera::Orthographic(Orthographic { pose, height: 3.0 }), None, None),
    ] {
        let mut world = World::builder(camera);
        let matte = world.material(Material::diffuse(stored(gray(0.5))));
        world.shape(Quad { size: [90.0, 90.0] }, facing(target, DVec3::new(0.3, 0.5, 1.0)), matte, None);
        let scene = built(world);
        let crop = Crop { min: UVec2::new(2, 3), max: UVec2::new(12, 7) };
        let film = FilmSpec { crop, ..points(12, 8) };
        let image = taken(scene.clone(), film.clone(), spp(1));
        let attributes = of_camera(&*scene, &film);
        let matrix = |name: &str| match attributes.iter().find(|row| row.0 == name) {
            Some((_, Value::Matrix(rows))) => DMat4::from_cols_array(&rows.map(f64::from)).transpose(),
            other => panic!("{name}: {other:?}"),
        };
        // A row times M is M transposed times the column.
        let times = |p: DVec3, m: DMat4| m.transpose() * DVec4::from((p, 1.0));
        for i in 0..40 {
            let p = vector(&image, Layer::Position, i);
            let there = times(p, matrix("worldToCamera"));
            near(-there.z, numbers(&image, Layer::Depth, i)[0], 1e-4, "Z");
            let ndc = times(p, matrix("worldToNDC"));
            let (x, y) = (ndc.x / ndc.w * 12.0, ndc.y / ndc.w * 8.0);
            near(x, f64::from(2 + i as u32 % 10) + 0.5, 1e-3, "column");
            near(y, f64::from(3 + i as u32 / 10) + 0.5, 1e-3, "row");
        }
        // The middle of the film that is shifted by a fifth of its width to the right, and by .3 of its height down.
        let is_shifted = seen.is_some() && attributes.iter().any(|row| row.0 == "screenWindowCenter");
        if is_shifted {
            let expected = [0.2 * 2.0 * tan(50.0) * 1.5, -0.3 * 2.0 * tan(50.0)];
            let center = attributes.iter().find_map(|row| if let Value::Point(center) = row.1 { Some(center) } else { None });
            let center = center.expect("a point").map(f64::from);
            (0..2).for_each(|k| near(center[k], expected[k], 1e-6, "screenWindowCenter"));
            shifted += 1;
        }
        for (name, expected) in [("screenWindowWidth", seen), ("pixelAspectRatio", pixel)] {
            match (attributes.iter().find(|row| row.0 == name), expected) {
                (Some((_, Value::Number(number))), Some(expected)) => near((*number).into(), expected, 1e-6, name),
                (found, expected) => assert!(found.is_none() && expected.is_none(), "{name}: {found:?}"),
            }
        }
    }
    assert_eq!(shifted, 1);
}

/// Layers do not change the picture, with a lens, with holes, and with all integrators and samplers.
#[test]
fn layers_change_no_bit_of_the_picture() {
    for (entry, (kind, ..)) in ALL.iter().flat_map(|e| Kind::ALL.iter().map(move |k| (e, k))) {
        let integrator = choose(&[&[*entry]], None, Some(entry.name), "").expect("defaults are valid").1;
        let scene = Everything { lens_radius: 0.1, ..Everything::default() };
        let sampler = SamplerSpec { kind: *kind, spp: 5, seed: 3, ..SamplerSpec::default() };
        let without = Shot { scene, sampler, film: FilmSpec::new(20, 15), ..Shot::default() };
        let layers = Layer::ALL.iter().map(|row| row.0).collect();
        let with = Shot { film: FilmSpec { layers, ..without.film.clone() }, ..without.clone() };
        let [without, with] = [without, with].map(|shot| bits(&everything::picture(shot.scene.build(), &*integrator, &shot)));
        assert!(with.len() > without.len() && with[..without.len()] == without, "{} {kind:?}", entry.name);
    }
}

/// Layers have the same bits for any number of threads, tiles, crops and pauses.
#[test]
fn layers_are_the_same_bits_however_they_are_divided() {
    let integrator = ByChance { max_depth: 1, ..ByChance::default() };
    for (k, camera) in [(1, Lens::Perspective), (2, Lens::Spherical), (8, Lens::Orthographic)] {
        let film = FilmSpec { layers: all(), filter: Filter::mitchell(2.0, 1.0 / 3.0, 1.0 / 3.0), ..FilmSpec::new(24, 18) };
        let sampler = SamplerSpec { kind: Kind::Sobol, spp: 21, seed: 3, scramblings: k };
        let shot = Shot { scene: Everything { camera, ..Everything::default() }, film, sampler, ..Shot::default() };
        let wanted = everything::render_on(1, &integrator, &shot);
        for (threads, tile) in [(2, 5), (3, 1), (2, u32::MAX)] {
            let found = everything::render_on(threads, &integrator, &Shot { tile, ..shot.clone() });
            assert!(found == wanted, "{k} {threads} threads, tiles of {tile}");
        }
        let mut paused = MomentFilm::new(shot.film.clone());
        let mut render = Render::new(shot.scene.build(), &integrator, &shot.film, &Settings::new(sampler));
        [3, 5, 6, 13, 21].into_iter().for_each(|samples| render.advance(samples, &mut paused, &Silent));
        assert!(bits(&paused.image()) == wanted, "{k} with pauses");
        // The comparison is of the sums in f64, because a picture in f32 would hide their last bits.
        let mut at_once = MomentFilm::new(shot.film.clone());
        Render::new(shot.scene.build(), &integrator, &shot.film, &Settings::new(sampler)).advance(21, &mut at_once, &Silent);
        let sums = |film: &MomentFilm| film.total().layers().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert!(sums(&paused) == sums(&at_once), "{k}: sums with pauses");
        let crop = Crop { min: UVec2::new(7, 4), max: UVec2::new(16, 9) };
        let part = everything::picture(shot.scene.build(), &integrator, &Shot { film: FilmSpec { crop, ..shot.film.clone() }, ..shot });
        // Standard errors are shared with neighbours, of which a crop has fewer.
        for ((name, part), (_, whole)) in bits(&part).iter().zip(&wanted).filter(|((name, _), _)| !name.starts_with("StdErr.")) {
            let row = |y: usize| whole[(y + 4) * 24 + 7..][..9].to_vec();
            assert!(*part == (0..5).flat_map(row).collect::<Vec<_>>(), "{k} {name}");
        }
    }
}

const SCENE: &str = r#"{
  "pt": 1,
  "camera": { "look_at": { "from": [0, 0, 3], "to": [0, 0, 0] } },
  "film": { "width": 8, "height": 6 },
  "sampler": { "spp": 2 },
  "shapes": [{ "type": "sphere" }],
  "background": { "radiance": 1 }
}"#;

fn pt(folder: &Path, command: &str) -> assert_cmd::assert::Assert {
    Command::cargo_bin("pt").expect("the binary").current_dir(folder).args(command.split_whitespace()).assert()
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("scene.json"), SCENE).expect("written");
    folder
}

fn names(image: &Image) -> Vec<&str> {
    image.channels.iter().map(|c| c.name.as_str()).collect()
}

/// Layers are selected by `all` or by name, on the command line or in the scene. The layer `time` is selected only by name and is not part
/// of the picture's hash.
#[test]
fn layers_are_selected_by_name() {
    let folder = folder();
    let read = |name: &str| output::read(&folder.path().join(name)).expect("readable").0;
    pt(folder.path(), "scene.json -q -o plain.exr").success();
    pt(folder.path(), "scene.json -q -o all.exr --aov all").success();
    let (plain, every) = (read("plain.exr"), read("all.exr"));
    let lights = LightNames { names: vec!["background".into()], ..LightNames::default() };
    let layers: Vec<String> = all().iter().flat_map(|layer| layer.channels(&lights)).collect();
    let mut expected: Vec<&str> = names(&plain);
    expected.extend(layers.iter().map(String::as_str));
    expected.sort_unstable();
    assert_eq!(names(&every), expected);
    assert!(plain.channels.iter().all(|c| every.channel(&c.name) == Some(&c.values)));
    // The middle of the sphere, two metres away.
    near(f64::from(every.channel("Z").expect("Z")[3 * 8 + 4]), 2.0, 0.05, "Z");

    pt(folder.path(), "scene.json -q -o timed.exr --aov time,z").success();
    pt(folder.path(), "scene.json -q -o again.exr -D /film/layers=[\"z\",\"time\",\"z\"]").success();
    let (timed, again) = (read("timed.exr"), read("again.exr"));
    let seconds = timed.channel("Time.Y").expect("seconds");
    assert!(seconds.iter().all(|s| s.is_finite() && *s >= 0.0) && seconds.iter().any(|s| *s > 0.0), "{seconds:?}");
    assert_eq!(names(&timed), names(&again));
    assert_eq!(output::hash(&timed), output::hash(&again));
    // The hash does not depend on the layer of time.
    let mut slow = timed.clone();
    slow.channels.iter_mut().filter(|c| c.name == "Time.Y").flat_map(|c| &mut c.values).for_each(|s| *s += 1.0);
    assert_eq!(output::hash(&slow), output::hash(&timed));

    let list = pt(folder.path(), "list aovs").success().get_output().stdout.clone();
    let list = String::from_utf8(list).expect("text");
    assert!(Layer::ALL.iter().all(|(_, name, about)| list.contains(name) && list.contains(about)), "{list}");
    assert_eq!(list.lines().count(), Layer::ALL.len());
}

#[test]
fn unknown_layers_are_refused_in_one_line() {
    let folder = folder();
    let refused = |command: &str, code: i32, expected: &str| {
        let output = pt(folder.path(), command).code(code).get_output().clone();
        assert_eq!(String::from_utf8_lossy(&output.stderr), expected, "{command}");
    };
    refused("scene.json --aov n,albdo", 2, "error: --aov: unknown layer \"albdo\", did you mean \"albedo\"?\n");
    fs::write(folder.path().join("wrong.json"), SCENE.replace("\"height\": 6", "\"height\": 6, \"layers\": [\"n\", \"tim\"]"))
        .expect("written");
    refused("wrong.json", 3, "error: wrong.json:4:54: /film/layers/1: unknown name \"tim\", did you mean \"time\"?\n");
    let output = pt(folder.path(), "scene.json -o x.png --aov n").success().get_output().clone();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("warning: layers are written to .exr files, and none is asked for"), "{said}");
}

/// Layers of colours, vectors, coordinates and single numbers can be shown as pictures.
#[test]
fn layers_become_pictures() {
    let folder = folder();
    pt(folder.path(), "scene.json -q -o x.exr --aov all").success();
    let whole = output::read(&folder.path().join("x.exr")).expect("readable").0;
    for (layer, channels) in [
        ("Albedo", ["Albedo.R", "Albedo.G", "Albedo.B"]),
        ("N", ["N.X", "N.Y", "N.Z"]),
        ("uv", ["uv.U", "uv.V", ""]),
        ("Z", ["Z", "Z", "Z"]),
    ] {
        pt(folder.path(), &format!("image convert x.exr -o layer.pfm --layer {layer}")).success();
        let image = output::read(&folder.path().join("layer.pfm")).expect("readable").0;
        for (c, name) in channels.into_iter().enumerate() {
            let expected = whole.channel(name).map_or(vec![0.0; 48], <[f32]>::to_vec);
            assert_eq!(image.channels[c].values, expected, "{layer} {name}");
        }
    }
    pt(folder.path(), "image falsecolor x.exr -o z.png --channel Z").success();
    pt(folder.path(), "image falsecolor x.exr -o z.png --layer Z").success();
    pt(folder.path(), "image diff x.exr x.exr --layer Ns --tolerance 0").success();
    pt(folder.path(), "image convert x.exr -o copy.exr").success();
    pt(folder.path(), "scene.json -q -o y.exr --aov all --seed 9").success();
    pt(folder.path(), "image average x.exr y.exr -o mean.exr").success();
    let (mean, attributes) = output::read(&folder.path().join("mean.exr")).expect("readable");
    assert_eq!(names(&mean), names(&whole));
    assert!(attributes.contains(&("samplesPerPixel".into(), Value::Integer(4))), "{attributes:?}");
    let kept = |name: &str| output::read(&folder.path().join(name)).expect("readable").1;
    assert_eq!(kept("copy.exr"), kept("x.exr"));
    let said = pt(folder.path(), "image info x.exr").success().get_output().stdout.clone();
    let words = String::from_utf8(said).expect("text").split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("samplesPerPixel 2 "), "{words}");
    assert!(words.contains("worldToCamera 1 0 0 0 | 0 1 0 0 | 0 0 1 0 | 0 0 -3 1 "), "{words}");
}
