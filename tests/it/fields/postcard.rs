//! The scene `postcard` compared with the output of the original program, if its files are present beside the project.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::film::{Image, MomentFilm};
use pt::integrator::{Integrator, choose};
use pt::integrators::ALL;
use pt::math::Ray;
use pt::measure::critical_z;
use pt::render::{Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;

use crate::shared::shared;

fn data(file: &str) -> Option<PathBuf> {
    shared("postcard").map(|folder| folder.join(file))
}

/// Rows of a table of numbers, without the heading.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).expect("a table");
    text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect()
}

/// The scene with other values at some pointers, and its integrator.
fn postcard(values: &[(&str, &str)]) -> (Built, Box<dyn Integrator>) {
    let file = "scenes/postcard.json";
    let mut root = describe::load(Path::new(file)).expect(file);
    values.iter().for_each(|(pointer, value)| root.set(pointer, value).expect(pointer));
    let scene = describe::read(&root, file).unwrap_or_else(|e| panic!("{e}"));
    let source = Source { root: &root, file, files: &Files::within("scenes") };
    let (_, integrator) = choose(&[ALL], root.child("integrator"), None, file).unwrap_or_else(|e| panic!("{e}"));
    (pt::build::build(&scene, source).unwrap_or_else(|e| panic!("{e}")), integrator)
}

/// At 400 points the distances agree to 10⁻⁵, the rounding of the original's numbers to f32, and the nearest part is the same.
#[test]
fn distances_are_the_originals() {
    let Some(path) = data("sdf_points.csv") else { return };
    let (built, _) = postcard(&[]);
    let shape = &built.world.shapes()[0];
    let rows = rows(&path);
    assert_eq!(rows.len(), 400);
    for row in rows {
        let [x, y, z, wanted, kind] = row[..] else { panic!("{row:?}") };
        let p = DVec3::new(x, y, z) - built.world.origin();
        let (distance, part) = shape.distance(p).expect("a field");
        assert!((distance - wanted).abs() <= 1e-5, "{distance} at {row:?}");
        assert_eq!(f64::from(part + 1), kind, "{row:?}");
    }
}

/// 300 camera rays hit the part that the original program hits, at the same point to 0.02 and on the same side.
#[test]
fn first_hits_are_the_originals() {
    let Some(path) = data("primary_hits.csv") else { return };
    let (built, _) = postcard(&[]);
    let origin = built.world.origin();
    let (mut farthest, mut turned) = (0f64, 0f64);
    let rows = rows(&path);
    assert_eq!(rows.len(), 300);
    for row in &rows {
        let triple = |k: usize| DVec3::new(row[k], row[k + 1], row[k + 2]);
        let ray = Ray::new((triple(0) - origin).as_vec3(), triple(3).normalize().as_vec3());
        let hit = built.world.intersect(&ray).expect("a closed room");
        let point = built.world.surface(&ray, &hit).point;
        assert_eq!(f64::from(built.world.shapes()[0].part(hit.primitive, hit.uv) + 1), row[6], "{row:?}");
        let apart = (point.p.as_dvec3() + origin - triple(7)).length();
        assert!(apart <= 0.02, "{apart} apart: {point:?}, {row:?}");
        farthest = farthest.max(apart);
        turned = turned.max(1.0 - point.ng.as_dvec3().dot(triple(10)));
    }
    println!("positions within {farthest:.1e}, normals within {:.2}°", (1.0 - turned).acos().to_degrees());
    // The original's normals are differences of f32 distances of about 10 over a step of 0.01, each with an error of 10⁻⁶: some 10⁻³ of a
    // right angle.
    assert!(turned < 1e-4, "{turned:e}");
}

/// The camera's rays in the corners of the picture, by the formula that comes with the original's numbers.
#[test]
fn the_camera_is_the_originals() {
    let (built, _) = postcard(&[("/film/height", "540"), ("/film/width", "960")]);
    let (eye, forward) = (DVec3::new(-22.0, 5.0, 25.0), DVec3::new(0.60477666, -0.03183035, -0.79575877));
    let (left, up) = (DVec3::new(-0.79616219, 0.0, -0.60508327), DVec3::new(0.01926001, 0.99949329, -0.02534212));
    let camera = built.world.camera();
    for (x, y) in [(0.0, 0.0), (960.0, 0.0), (0.0, 540.0), (960.0, 540.0), (480.0, 270.0), (123.0, 45.0)] {
        let ray = pinhole(camera, x as f32, y as f32);
        // The ray is to the left of the middle, and above it.
        let wanted = (forward + left * ((480.0 - x) / 960.0) + up * ((270.0 - y) / 960.0)).normalize();
        assert!((ray.direction.as_dvec3() - wanted).length() < 1e-6, "{} but {wanted}", ray.direction);
        assert!((ray.origin.as_dvec3() + built.world.origin() - eye).length() < 1e-5);
    }
}

fn pinhole(camera: &pt::camera::Camera, x: f32, y: f32) -> Ray {
    camera.ray(glam::Vec2::new(x / 960.0, y / 540.0), 960.0 / 540.0, glam::Vec2::ZERO, 0.0)
}

/// A picture's channels with their standard errors.
struct Picture {
    mean: Image,
    samples: u64,
}

const WIDTH: usize = 240;
const HEIGHT: usize = 135;
const EDGE: usize = 15;

/// The original divides an odd height by two with rounding, so its middle is half a pixel off. A picture that is one row higher has the
/// same middle and the same rows, except for the lowest.
fn ours(spp: u64, seed: u64) -> Picture {
    let fov = (2.0 * (68f64 / 240.0).atan().to_degrees()).to_string();
    let (built, integrator) =
        postcard(&[("/film/width", "240"), ("/film/height", "136"), ("/film/crop", "[0, 240, 0, 135]"), ("/camera/fov", &fov)]);
    let sampler = SamplerSpec { kind: Kind::Independent, spp, seed, ..built.sampler };
    let mut film = MomentFilm::new(built.film.clone());
    let report = render(Arc::new(built.world), &*integrator, &mut film, &Settings::new(sampler), &Silent);
    assert_eq!(report.invalid, 0);
    Picture { mean: film.image(), samples: spp }
}

/// Differences of the means of blocks of 15 × 15 pixels, in units of their standard errors. The original has 2048 samples, of the same
/// variance as ours.
fn z_scores(ours: &Picture, original: &Image) -> Vec<f64> {
    let mut scores = vec![];
    for channel in ["R", "G", "B"] {
        let find = |image: &Image, name: &str| image.channel(name).expect("a channel").to_vec();
        let (a, errors, b) = (find(&ours.mean, channel), find(&ours.mean, &format!("StdErr.{channel}")), find(original, channel));
        assert_eq!((a.len(), b.len()), (WIDTH * HEIGHT, WIDTH * HEIGHT));
        for (by, bx) in (0..HEIGHT / EDGE).flat_map(|y| (0..WIDTH / EDGE).map(move |x| (y, x))) {
            let pixels = (0..EDGE * EDGE).map(|k| (by * EDGE + k / EDGE) * WIDTH + bx * EDGE + k % EDGE);
            let (mut difference, mut variance) = (0.0, 0.0);
            for k in pixels {
                difference += f64::from(a[k] - b[k]);
                variance += f64::from(errors[k]).powi(2) * (1.0 + ours.samples as f64 / 2048.0);
            }
            scores.push(difference / variance.sqrt());
        }
    }
    scores
}

/// Asserts that no block differs by more than chance allows, and neither do all of them together.
fn agree(spp: u64, seed: u64) {
    let Some(path) = data("card-linear-240x135-2048spp.pfm") else { return };
    let (original, _) = pt::output::read(&path).expect("a picture");
    let scores = z_scores(&ours(spp, seed), &original);
    let worst = scores.iter().map(|z| z.abs()).fold(0.0, f64::max);
    let square = scores.iter().map(|z| z * z).sum::<f64>() / scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / scores.len() as f64;
    println!("{spp} spp: {} blocks, worst {worst:.2}, mean square {square:.3}, mean {mean:+.3}", scores.len());
    assert!(worst < critical_z(0.01, scores.len()), "{worst} standard errors");
    // The three channels of a block are strongly correlated, so there are only about 144 independent numbers: a mean square of 1 ±
    // √(2/144).
    assert!(square < 1.0 + 4.0 * (2.0f64 / 144.0).sqrt(), "mean square {square}");
    assert!(mean.abs() < 4.0 / 12.0, "all too bright or too dark: {mean}");
}

#[test]
fn the_picture_is_the_originals() {
    agree(8, 1);
}

/// Takes minutes, and resolves differences of 0.1 % of the brightest blocks.
#[test]
#[ignore = "takes minutes"]
fn the_picture_is_the_originals_in_full() {
    agree(512, 2);
}

/// Exact marching finds the same points as marching with a fixed stop distance, up to that distance.
#[test]
fn exact_hits_are_near_the_fixed_ones() {
    let (fixed, _) = postcard(&[]);
    let root = describe::load(Path::new("scenes/postcard.json")).expect("the scene");
    let mut scene = describe::read(&root, "s").unwrap_or_else(|e| panic!("{e}"));
    let describe::Shape::Sdf(sdf) = &mut scene.shapes[0] else { panic!("a field") };
    sdf.march = None;
    let source = Source { root: &root, file: "s", files: &Files::within("scenes") };
    let exact = pt::build::build(&scene, source).unwrap_or_else(|e| panic!("{e}"));
    let mut random = crate::random::Random::new(3);
    let (mut judged, mut same) = (0, 0);
    for _ in 0..3000 {
        let ray = pinhole(fixed.world.camera(), random.range(0.0, 960.0) as f32, random.range(0.0, 540.0) as f32);
        let find = |built: &Built| {
            let hit = built.world.intersect(&ray).expect("a closed room");
            (built.world.surface(&ray, &hit).point, hit)
        };
        let ((_, first), (b, second)) = (find(&fixed), find(&exact));
        judged += 1;
        // The points differ by at most 0.01 across the surface, and along the ray by that over the cosine.
        let cosine = b.ng.dot(ray.direction).abs();
        let apart = second.t - first.t;
        same += u32::from(apart >= -1e-4 && apart * cosine <= 0.0101);
    }
    // Rays that graze an edge may end at the edge or behind it.
    println!("{same} of {judged}");
    assert!(same * 100 > judged * 97, "{same} of {judged}");
}
