//! What each numeric measure of the renderer costs, and which error it removes: the table of docs/reliability.md.
//!
//! `cargo bench --bench numerics`, on one thread. Each measure is timed in turns with what would stand in its place.

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use glam::{DVec3, Vec3};
use pt::build::Source;
use pt::describe::{self, Files};
use pt::double::difference;
use pt::film::{FilmSpec, Image, MomentFilm};
use pt::import::{ImportOptions, import_with};
use pt::integrator::{Integrator, choose};
use pt::integrators::ALL;
use pt::load::load;
use pt::math::{ExactSum, Ray};
use pt::measure::Distance;
use pt::render::{Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;
use pt::shape::{offset_bound, triangle};
use pt::torture::Random;
use pt::torture::meshes::icosphere;
use pt::world::World;
use serde_json::{Value, json};

/// Takes a result, so that the compiler computes it.
fn keep<T>(result: T) {
    black_box(result);
}

/// Number of alternating measurements. The times are the medians of them.
const ROUNDS: usize = 9;

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        println!("| measure | in place of | its cost | error without it | error with it |\n|---|---|---|---|---|");
        for row in [triangles, boxes, offsets, sums, exact_sums, terminator, multiple_scattering, double_precision] {
            println!("{}", row());
        }
    });
}

/// A line of the table.
///
/// - `names`: the measure, and what stands in its place
/// - `errors`: with the measure and without it
fn line(names: [&str; 2], cost: String, errors: [String; 2]) -> String {
    format!("| {} | {} | {cost} | {} | {} |", names[0], names[1], errors[1], errors[0])
}

/// Median times of two works of `count` steps each, taken in turns (ns for a step).
fn timed(count: usize, mut works: [&mut dyn FnMut(); 2]) -> [f64; 2] {
    let mut times = [vec![], vec![]];
    for _ in 0..ROUNDS {
        for (work, times) in works.iter_mut().zip(&mut times) {
            let start = Instant::now();
            work();
            times.push(start.elapsed().as_secs_f64() * 1e9 / count as f64);
        }
    }
    times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[ROUNDS / 2]
    })
}

fn steps([with, without]: [f64; 2]) -> String {
    format!("{with:.1} ns beside {without:.1} ns")
}

fn percent([with, without]: [f64; 2]) -> String {
    format!("{:+.1} % of a render's time", 100.0 * (with / without - 1.0))
}

/// Rays from inside of a closed sphere at points of its edges: those that meet no triangle pass between two.
fn triangles() -> String {
    const RAYS: usize = 20_000;
    let (corners, indices) = icosphere(2);
    let corners: Vec<Vec3> = corners.iter().map(|p| p.as_vec3()).collect();
    let triangles: Vec<[Vec3; 3]> = indices.iter().map(|t| t.map(|v| corners[v as usize])).collect();
    let mut random = Random::new(1);
    let rays: Vec<Ray> = (0..RAYS)
        .map(|i| {
            let [a, b, _] = triangles[i % triangles.len()];
            let origin = Vec3::new(0.1, -0.2, 0.05);
            Ray::new(origin, (a.lerp(b, random.unit() as f32) - origin).normalize())
        })
        .collect();
    let lost = |test: &dyn Fn(&Ray, [Vec3; 3]) -> bool| rays.iter().filter(|ray| !triangles.iter().any(|t| test(ray, *t))).count();
    let (watertight, plain) =
        (|ray: &Ray, t| triangle::intersect(ray, f32::INFINITY, t).is_some(), |ray: &Ray, t| moeller_trumbore(ray, t).is_some());
    let all = |test: &dyn Fn(&Ray, [Vec3; 3]) -> bool| {
        for ray in &rays[..500] {
            triangles.iter().for_each(|t| keep(test(black_box(ray), *t)));
        }
    };
    let times = timed(500 * triangles.len(), [&mut || all(&watertight), &mut || all(&plain)]);
    let told = |count: usize| format!("{count} of {RAYS} rays pass a closed mesh at its edges");
    line(
        ["triangle test in f64, the same from both sides of an edge", "Möller and Trumbore's in f32"],
        steps(times),
        [told(lost(&watertight)), told(lost(&plain))],
    )
}

/// Source: Möller and Trumbore, *Fast, Minimum Storage Ray/Triangle Intersection* (1997).
#[inline(always)]
fn moeller_trumbore(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = ray.direction.cross(ac);
    let inverse = 1.0 / ab.dot(p);
    let from = ray.origin - a;
    let u = from.dot(p) * inverse;
    let q = from.cross(ab);
    let v = ray.direction.dot(q) * inverse;
    let t = ac.dot(q) * inverse;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

/// Rays at points within flat boxes, such as those around axis-parallel quads: the far side is widened by the rounding of the test.
fn boxes() -> String {
    const RAYS: usize = 1 << 18;
    let mut random = Random::new(2);
    let rays: Vec<(Vec3, Vec3, [Vec3; 2])> = (0..RAYS)
        .map(|_| {
            let low = random.direction().as_vec3() * 3.0;
            let mut high = low + Vec3::splat(random.unit() as f32);
            high.z = low.z;
            let inside = low + (high - low) * Vec3::new(random.unit() as f32, random.unit() as f32, 0.0);
            let origin = random.direction().as_vec3() * 10.0;
            (origin, 1.0 / (inside - origin).normalize(), [low, high])
        })
        .collect();
    let lost = |more: f32| rays.iter().filter(|(o, inverse, ends)| !slabs(*o, *inverse, *ends, more)).count();
    let all = |more: f32| {
        for (o, inverse, ends) in &rays {
            black_box(slabs(*o, *inverse, *ends, more));
        }
    };
    // 1 + 2γ₃ of the roundings of a slab.
    let wider = 1.0 + 6.0 * f32::EPSILON;
    let times = timed(RAYS, [&mut || all(black_box(wider)), &mut || all(1.0)]);
    let told = |count: usize| format!("{count} of {RAYS} rays miss a flat box that they pass");
    line(["boxes that are wider by the rounding of their test", "the test without it"], steps(times), [told(lost(wider)), told(lost(1.0))])
}

#[inline(always)]
fn slabs(origin: Vec3, inverse: Vec3, [low, high]: [Vec3; 2], more: f32) -> bool {
    let (a, b) = ((low - origin) * inverse, (high - origin) * inverse);
    let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element() * more);
    near <= far
}

/// Rays that leave a triangle, at coordinates of 1, 10³ and 10⁶: they must not meet it again.
fn offsets() -> String {
    const RAYS: usize = 1 << 16;
    let mut random = Random::new(3);
    let mut cases = vec![];
    for scale in [1.0, 1e3, 1e6f32] {
        for _ in 0..RAYS {
            let center = random.direction().as_vec3() * scale;
            let corners = [(); 3].map(|()| center + random.direction().as_vec3());
            let Some(normal) = triangle::normal(corners) else { continue };
            let (u, v) = (random.unit() as f32, random.unit() as f32);
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let p = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
            cases.push((corners, p, normal, random.direction().as_vec3().normalize()));
        }
    }
    let bound = |corners: [Vec3; 3], p: Vec3, normal: Vec3, w: Vec3| {
        let magnitude = corners[0].abs().max(corners[1].abs()).max(corners[2].abs());
        p + normal * offset_bound(normal, magnitude).copysign(normal.dot(w))
    };
    let fixed = |_: [Vec3; 3], p: Vec3, normal: Vec3, w: Vec3| p + normal * 1e-4f32.copysign(normal.dot(w));
    type Start<'s> = &'s dyn Fn([Vec3; 3], Vec3, Vec3, Vec3) -> Vec3;
    let hits = |start: Start| {
        let meets = |(corners, p, normal, w): &([Vec3; 3], Vec3, Vec3, Vec3)| {
            triangle::intersect(&Ray::new(start(*corners, *p, *normal, *w), *w), f32::INFINITY, *corners).is_some()
        };
        cases.iter().filter(|case| meets(case)).count()
    };
    let all = |start: Start| cases.iter().for_each(|(corners, p, normal, w)| keep(start(*corners, *p, *normal, *w)));
    let times = timed(cases.len(), [&mut || all(&bound), &mut || all(&fixed)]);
    let told = |count: usize| format!("{count} of {} rays meet the triangle that they leave, at 1, 10³ and 10⁶", cases.len());
    line(
        ["rays that start beside their surface by the error of the point", "a step of 10⁻⁴"],
        steps(times),
        [told(hits(&bound)), told(hits(&fixed))],
    )
}

/// Values of samples with a mean of ½.
fn values(count: usize) -> Vec<f32> {
    let mut random = Random::new(4);
    (0..count).map(|_| random.unit() as f32).collect()
}

const SAMPLES: usize = 1 << 24;

fn sums() -> String {
    let samples = values(SAMPLES);
    let (double, single) = (|| samples.iter().fold(0.0, |sum, x| sum + f64::from(*x)), || samples.iter().fold(0f32, |sum, x| sum + x));
    let times = timed(SAMPLES, [&mut || keep(double()), &mut || keep(single())]);
    let mut exact = ExactSum::default();
    samples.iter().for_each(|x| exact.add(*x));
    let told = |sum: f64| format!("the mean of 2²⁴ samples is off by {:.1e}", (sum / exact.get() - 1.0).abs());
    line(["sums of samples in f64", "sums in f32"], steps(times), [told(double()), told(single().into())])
}

fn exact_sums() -> String {
    let samples = values(SAMPLES >> 4);
    let exact = |samples: &mut dyn Iterator<Item = &f32>| {
        let mut sum = ExactSum::default();
        samples.for_each(|x| sum.add(*x));
        sum.get()
    };
    let double = |samples: &mut dyn Iterator<Item = &f32>| samples.fold(0.0, |sum, x| sum + f64::from(*x));
    let times = timed(samples.len(), [&mut || keep(exact(&mut samples.iter())), &mut || keep(double(&mut samples.iter()))]);
    // Small and large numbers, whose sum in f64 depends on the order.
    let uneven: Vec<f32> = samples.iter().enumerate().map(|(i, x)| if i % 2 == 0 { x * 1e-9 } else { x * 1e9 }).collect();
    let told = |sum: &dyn Fn(&mut dyn Iterator<Item = &f32>) -> f64| {
        let (there, back) = (sum(&mut uneven.iter()), sum(&mut uneven.iter().rev()));
        match (there / back - 1.0).abs() {
            0.0 => "another order does not change it".to_owned(),
            change => format!("another order changes a sum over 18 magnitudes by {change:.1e}"),
        }
    };
    line(["exact sums, where no tree gives an order (statistics of a render)", "sums in f64"], steps(times), [told(&exact), told(&double)])
}

struct Described {
    scene: Arc<World>,
    spec: FilmSpec,
    integrator: Box<dyn Integrator>,
}

impl Described {
    fn new(scene: &Value) -> Described {
        let root = describe::root(scene.to_string().as_bytes(), "scene").expect("JSON");
        let description = describe::read(&root, "scene").expect("a scene");
        let built = pt::build::build(&description, Source { root: &root, file: "scene", files: &Files::within("") }).expect("a world");
        let (_, integrator) = choose(&[ALL], None, Some("nee"), "scene").expect("an integrator");
        Described { scene: Arc::new(built.world), spec: built.film, integrator }
    }

    fn picture(&self, samples: u64) -> Image {
        let settings = Settings { samples, ..Settings::new(SamplerSpec { kind: Kind::Sobol, ..SamplerSpec::default() }) };
        let mut film = MomentFilm::new(self.spec.clone());
        let scene: Arc<dyn Scene> = self.scene.clone();
        render(scene, &*self.integrator, &mut film, &settings, &Silent);
        film.image()
    }
}

/// A scene with one shape in the picture of a parallel camera from +z.
fn of_shape(shape: Value, light: Value) -> Described {
    let mut scene = json!({
        "pt": 1, "film": {"width": 96, "height": 96}, "shapes": [shape],
        "camera": {"type": "orthographic", "height": 2.1, "look_at": {"from": [0, 0, 5], "to": [0, 0, 0]}}
    });
    scene.as_object_mut().expect("an object").extend(light.as_object().expect("an object").clone());
    Described::new(&scene)
}

/// A coarse ball with smooth normals under a sun from the side, beside the ball that it stands for.
fn terminator() -> String {
    const SPP: u64 = 16;
    let (corners, triangles) = icosphere(2);
    let list: Vec<[f64; 3]> = corners.iter().map(DVec3::to_array).collect();
    let material = json!({"type": "diffuse", "albedo": 0.8});
    let sun = json!({"lights": [{"type": "directional", "direction": [-1, 0, 0], "irradiance": 3}]});
    let mesh = |smooth: bool| json!({"type": "mesh", "positions": list, "normals": list, "triangles": triangles, "smooth_shadows": smooth, "material": material});
    let [with, without] = [true, false].map(|smooth| of_shape(mesh(smooth), sun.clone()));
    let ball = of_shape(json!({"type": "sphere", "material": material}), sun.clone()).picture(4 * SPP);
    let times = timed(1, [&mut || drop(with.picture(SPP)), &mut || drop(without.picture(SPP))]);
    let told = |described: &Described| {
        let distance = Distance::between(&described.picture(SPP), &ball).expect("pictures of one size");
        format!(
            "a coarse ball in the light of a sun differs from a round one by {:.0} % (√relMSE)",
            100.0 * distance.relmse.max(0.0).sqrt()
        )
    };
    line(
        ["rays from the smooth surface of coarse meshes (`smooth_shadows`)", "rays from the facets"],
        percent(times),
        [told(&with), told(&without)],
    )
}

/// White rough metal in a white room keeps all light.
fn multiple_scattering() -> String {
    const SPP: u64 = 64;
    let white = json!({"background": {"radiance": 1}});
    let material = |all: bool| json!({"type": "conductor", "color": 1, "roughness": 1, "multiscatter": all});
    let metal = |all: bool| json!({"type": "sphere", "radius": 2, "material": material(all)});
    let [with, without] = [true, false].map(|all| of_shape(metal(all), white.clone()));
    let times = timed(1, [&mut || drop(with.picture(SPP)), &mut || drop(without.picture(SPP))]);
    let told = |described: &Described| {
        let image = described.picture(SPP);
        let values = image.channel("G").expect("a channel");
        let mean = values.iter().map(|x| f64::from(*x)).sum::<f64>() / values.len() as f64;
        format!("white metal of roughness 1 loses {:.1} % of the light", 100.0 * (1.0 - mean))
    };
    line(["light between the facets of rough materials (`multiscatter`)", "one reflection"], percent(times), [told(&with), told(&without)])
}

/// The Cornell box by `path`, every path in both precisions.
fn double_precision() -> String {
    let small = |root: &mut pt::reader::Node, _: &str| {
        [("/film/width", "96"), ("/film/height", "96"), ("/sampler/spp", "64")]
            .iter()
            .try_for_each(|(pointer, value)| root.set(pointer, value))
    };
    let imported = import_with(Path::new("scenes/cornell-box.json"), &ImportOptions::default(), small).expect("a scene");
    let loaded = load(imported, Some("path"), &[ALL]).expect("a scene");
    let report = difference(&loaded, &|| false).expect("a scene that is known").expect("not cancelled");
    let [single, double] = report.times.map(|time| time.as_secs_f64());
    let cost = format!("a path takes {:.1} times as long as one in single precision without lanes", double / single);
    let [picture, noise] = [report.picture, report.noise.expect("several samples")].map(|error| 100.0 * error);
    let rounding =
        format!("pictures of the Cornell box differ by {picture:.1e} % (√relMSE), beside a noise of {noise:.0} % of independent samples");
    line(
        [
            "double precision everywhere: the second path tracer of `pt precision`, which is not tuned",
            "single, and double where digits cancel",
        ],
        cost,
        ["–".into(), rounding],
    )
}
