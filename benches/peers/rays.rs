//! Rays per second of the hierarchy, beside Embree if it is installed.
//!
//! `cargo bench --bench rays [-- blob|beams] [alone]`. Two scenes are made here: a million triangles over a floor, and a closed room with
//! 2.6 million triangles of long, thin, rotated beams. The rays are those from a camera, two diffuse bounces, shadow rays to a lamp,
//! ambient occlusion, and the diffuse rays again as rays without an end for which any hit will do. All programs trace single rays; pt
//! traces them a second time side by side, as many neighbours at once as the machine has lanes.
//!
//! Embree 3 needs its headers, its library and g++ (`alone` leaves it out). The program beside it is `embree.cpp`, which reads the same
//! files. It runs in its fast and in its robust mode with the default quality of the build, and in its robust mode with the highest. All
//! run in turn on one thread. Rates are millions of rays per CPU second: the best of three repetitions, median of three turns. Only ratios
//! within one run count.

#[path = "../memory/mod.rs"]
mod memory;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use cpu_time::ProcessTime;
use glam::{UVec2, Vec3, Vec3Swizzles};
use pt::accel;
use pt::math::lanes::Width;
use pt::math::{Frame, Local, Ray, Transform, float, warp};
use pt::primitive::Primitive;
use pt::sampler::{Independent, SampleNumbers, Sequence};
use pt::shape::{Geometry, MeshData, MeshPart, Shape, TriangleMesh};

/// Rays of one kind.
struct Rays {
    name: &'static str,
    rays: Vec<Ray>,
    is_any: bool,
}

struct Subject {
    name: &'static str,
    mesh: MeshData,
    /// Width and height of the camera's picture (rays).
    size: u32,
    eye: Vec3,
    target: Vec3,
    lamp: Vec3,
}

fn main() {
    let folder = PathBuf::from("target/peers");
    fs::create_dir_all(&folder).expect("target/peers");
    let arguments: Vec<String> = std::env::args().collect();
    let asks_for = |name: &str| arguments.iter().any(|argument| argument == name);
    let embree = if asks_for("alone") { None } else { compile(&folder) };
    let is_all = !asks_for("blob") && !asks_for("beams");
    for (name, subject) in [("blob", blob as fn() -> Subject), ("beams", beams)] {
        if is_all || asks_for(name) {
            measure(&subject(), &folder, embree.as_deref());
        }
    }
}

/// Compiles the program with Embree; `None` with a message if that is not possible.
fn compile(folder: &Path) -> Option<PathBuf> {
    let program = folder.join("embree");
    let compiler = Command::new("g++").args(["-O3", "-o"]).arg(&program).args(["benches/peers/embree.cpp", "-lembree3"]).output();
    let message = match compiler {
        Ok(output) if output.status.success() => return Some(program),
        Ok(output) => String::from_utf8_lossy(&output.stderr).into_owned(),
        Err(error) => error.to_string(),
    };
    println!("only pt is measured, because g++ cannot compile the program with Embree:\n{message}");
    None
}

fn measure(subject: &Subject, folder: &Path, embree: Option<&Path>) {
    let shape = TriangleMesh::new(subject.mesh.clone()).bake(&Transform::IDENTITY).expect("a mesh with area");
    let shapes: Arc<[Box<dyn Shape>]> = Arc::new([shape]);
    let (start, before) = (ProcessTime::now(), memory::in_use());
    let hierarchy = pt::accel::build(shapes);
    let (build, bytes) = (start.elapsed().as_secs_f64(), memory::in_use() - before);
    let kinds = rays(subject, &*hierarchy);

    let file = |name: &str| folder.join(format!("{}-{name}", subject.name));
    save(&file("vertices"), subject.mesh.positions.iter().flat_map(|p| p.to_array()).map(f32::to_le_bytes));
    save(&file("triangles"), subject.mesh.triangles.iter().flatten().map(|v| v.to_le_bytes()));
    for kind in &kinds {
        let numbers = kind.rays.iter().flat_map(|r| [r.origin.extend(0.0).to_array(), r.direction.extend(r.t_max).to_array()]);
        save(&file(kind.name), numbers.flatten().map(f32::to_le_bytes));
    }
    let embree_lines = |mode: &str| -> Vec<[f64; 2]> {
        let Some(program) = embree else { return vec![] };
        let suffix = |kind: &Rays| if kind.is_any { ":any" } else { "" };
        let files = kinds.iter().map(|kind| format!("{}{}", file(kind.name).display(), suffix(kind)));
        let output = Command::new(program).arg(mode).arg(file("vertices")).arg(file("triangles")).args(files).output();
        let output = output.expect("Embree's program");
        assert!(output.status.success(), "Embree: {}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).expect("text");
        let numbers: Vec<f64> = text.split_whitespace().map(|number| number.parse().expect("a number")).collect();
        numbers.as_chunks().0.to_vec()
    };
    // For each program and turn, the rate and the share of hits of each kind.
    let (mut turns, mut packets): ([Vec<Vec<[f64; 2]>>; 4], Vec<_>) = Default::default();
    let mut builds = vec![];
    for _ in 0..3 {
        turns[0].push(kinds.iter().map(|kind| rate(&*hierarchy, kind)).collect());
        packets.push(kinds.iter().map(|kind| packet_rate(&*hierarchy, kind)).collect());
        let lines = MODES.map(embree_lines);
        builds = lines.iter().filter_map(|lines| lines.first().copied()).collect();
        for (turn, lines) in turns[1..].iter_mut().zip(lines) {
            turn.push(lines.into_iter().skip(1).collect());
        }
    }

    let count = subject.mesh.triangles.len();
    println!("\n{}: {count} triangles", subject.name);
    println!("  built by pt in {build:.2} CPU s, {} bytes for each triangle beside the mesh", bytes / count);
    for (mode, [seconds, bytes]) in MODES.iter().zip(&builds) {
        println!("  built by Embree ({mode}) in {seconds:.2} CPU s, {bytes:.0} bytes for each triangle beside the mesh");
    }
    println!("M rays/s, and what share of the rays hits");
    for (i, kind) in kinds.iter().enumerate() {
        let own = median(&turns[0], i);
        print!("{:16} pt {:6.2} ({:.3} %)", format!("{}{}", kind.name, if kind.is_any { " (any)" } else { "" }), own[0], 100.0 * own[1]);
        for (mode, turns) in MODES.iter().zip(&turns[1..]).take(builds.len()) {
            let embree = median(turns, i);
            print!("   {mode} {:6.2} ({:.3} %) pt/it {:.2}", embree[0], 100.0 * embree[1], own[0] / embree[0]);
        }
        let side_by_side = median(&packets, i);
        print!("   side by side {:6.2}", side_by_side[0]);
        for (mode, turns) in MODES.iter().zip(&turns[1..]).take(builds.len()) {
            print!(" /{mode} {:.2}", side_by_side[0] / median(turns, i)[0]);
        }
        println!();
    }
}

/// Modes of Embree.
const MODES: [&str; 3] = ["fast", "robust", "high"];

/// Millions of rays per CPU second, and the share of the rays that hit.
fn rate(hierarchy: &dyn Primitive, kind: &Rays) -> [f64; 2] {
    let hits = |ray: &Ray| if kind.is_any { hierarchy.occluded(ray) } else { hierarchy.intersect(ray).is_some() };
    best_of_three(kind.rays.len(), || kind.rays.iter().filter(|ray| hits(ray)).count())
}

/// Millions of rays per CPU second, and the share of the rays that hit, for rays that are traced side by side.
fn packet_rate(hierarchy: &dyn Primitive, kind: &Rays) -> [f64; 2] {
    let width = Width::detect();
    best_of_three(kind.rays.len(), || match kind.is_any {
        true => accel::occluded_all(hierarchy, &kind.rays, width).into_iter().filter(|hit| *hit).count(),
        false => accel::intersect_all(hierarchy, &kind.rays, width).into_iter().flatten().count(),
    })
}

/// - `hits`: traces `rays` rays and counts the hits
fn best_of_three(rays: usize, hits: impl Fn() -> usize) -> [f64; 2] {
    let (mut best, mut count) = (f64::INFINITY, 0);
    for _ in 0..3 {
        let start = ProcessTime::now();
        count = hits();
        best = best.min(start.elapsed().as_secs_f64());
    }
    [1e-6 * rays as f64 / best, count as f64 / rays as f64]
}

/// Rate and share of hits of one kind in the turn with the middle rate.
fn median(turns: &[Vec<[f64; 2]>], kind: usize) -> [f64; 2] {
    let mut turns: Vec<[f64; 2]> = turns.iter().map(|turn| turn[kind]).collect();
    turns.sort_by(|a, b| a[0].total_cmp(&b[0]));
    turns[turns.len() / 2]
}

fn save(path: &Path, words: impl Iterator<Item = [u8; 4]>) {
    fs::write(path, words.flatten().collect::<Vec<u8>>()).expect("a file in target/peers");
}

/// Rays of all kinds. Diffuse bounces, shadow rays and ambient occlusion start where rays before them hit.
fn rays(subject: &Subject, hierarchy: &dyn Primitive) -> Vec<Rays> {
    let numbers = Sequence::Independent(Independent { seed: 1 });
    let forward = (subject.target - subject.eye).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let pixels = (0..subject.size).flat_map(|y| (0..subject.size).map(move |x| UVec2::new(x, y)));
    let camera: Vec<Ray> = pixels
        .map(|pixel| {
            let place = (pixel.as_vec2() + 0.5) / subject.size as f32 * 2.0 - 1.0;
            Ray::new(subject.eye, (forward + 0.32 * (right * place.x - up * place.y)).normalize())
        })
        .collect();
    // - `index`: sample whose random numbers are used
    let bounce = |rays: &[Ray], index: u64, next: &dyn Fn(Vec3, &Frame, SampleNumbers) -> Option<Ray>| -> Vec<Ray> {
        let hits = rays.iter().enumerate().filter_map(|(i, ray)| {
            let hit = hierarchy.intersect(ray)?;
            let [a, b, c] = subject.mesh.triangles[hit.primitive as usize].map(|v| subject.mesh.positions[v as usize]);
            let normal = (b - a).cross(c - a).try_normalize()?;
            let towards_viewer = normal * -ray.direction.dot(normal).signum();
            next(ray.at(hit.t) + 1e-4 * towards_viewer, &Frame::around(towards_viewer), numbers.sample(UVec2::new(i as u32, 0), index))
        });
        hits.collect()
    };
    let diffuse = |p: Vec3, frame: &Frame, mut numbers: SampleNumbers| {
        let local = warp::cosine_hemisphere(numbers.get_2d(0));
        Some(Ray::new(p, frame.to_world(Local(local)).normalize()))
    };
    let shadow = |p: Vec3, frame: &Frame, mut numbers: SampleNumbers| {
        let u = numbers.get_2d(2) - 0.5;
        let line = subject.lamp + 1.5 * Vec3::new(u.x, 0.0, u.y) - p;
        let ray = Ray::new(p, line.normalize());
        (frame.to_local(ray.direction).cos() > 0.0).then_some(Ray { t_max: 0.9999 * line.length(), ..ray })
    };
    let occlusion = |p: Vec3, frame: &Frame, mut numbers: SampleNumbers| {
        let local = warp::cosine_hemisphere(numbers.get_2d(4));
        Some(Ray { t_max: 1.0, ..Ray::new(p, frame.to_world(Local(local)).normalize()) })
    };
    let first = bounce(&camera, 0, &diffuse);
    let second = bounce(&first, 1, &diffuse);
    let (lit, near) = (bounce(&camera, 0, &shadow), bounce(&camera, 0, &occlusion));
    let kind = |name, rays, is_any| Rays { name, rays, is_any };
    vec![
        kind("camera", camera, false),
        kind("diffuse", first.clone(), false),
        kind("second", second, false),
        kind("shadow", lit, true),
        kind("occlusion", near, true),
        kind("unbounded", first, true),
    ]
}

/// A bumpy ball of a million triangles over a floor.
fn blob() -> Subject {
    const AROUND: u32 = 1024;
    const RINGS: u32 = 512;
    let at = |i: u32, j: u32| {
        let (sin, cos) = float::sin_cos(std::f32::consts::TAU * j as f32 / AROUND as f32);
        let (s, c) = float::sin_cos(std::f32::consts::PI * (i as f32 + 0.5) / RINGS as f32);
        let d = Vec3::new(s * cos, c, s * sin);
        let wave = |k: Vec3, amplitude: f32| amplitude * float::sin(k.dot(d) + 1.7 * float::sin(0.7 * k.dot(d.yzx())));
        let bumps: f32 = (0..7)
            .map(|octave| {
                let (frequency, amplitude) = (3.0 * 1.9f32.powi(octave), 0.16 * 0.55f32.powi(octave));
                wave(frequency * Vec3::new(0.6, 0.64, 0.48), 0.5 * amplitude)
                    + wave(frequency * Vec3::new(-0.48, 0.6, 0.64), 0.5 * amplitude)
            })
            .sum();
        d * (1.0 + bumps)
    };
    let mut positions: Vec<Vec3> = (0..RINGS).flat_map(|i| (0..AROUND).map(move |j| at(i, j))).collect();
    let mut triangles = vec![];
    for (i, j) in (1..RINGS).flat_map(|i| (0..AROUND).map(move |j| (i, j))) {
        let index = |i: u32, j: u32| i * AROUND + j % AROUND;
        let [a, b, c, d] = [index(i - 1, j), index(i - 1, j + 1), index(i, j + 1), index(i, j)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    quad(&mut positions, &mut triangles, [Vec3::new(-6.0, -1.3, -6.0), Vec3::Z * 12.0, Vec3::X * 12.0]);
    Subject {
        name: "blob",
        mesh: mesh(positions, triangles),
        size: 512,
        eye: Vec3::new(0.0, 1.2, 4.2),
        target: Vec3::Y * -0.1,
        lamp: Vec3::Y * 3.0,
    }
}

/// A closed room with beams in all directions.
fn beams() -> Subject {
    const COUNT: u64 = 220_000;
    let numbers = Sequence::Independent(Independent { seed: 2 });
    let (mut positions, mut triangles) = (vec![], vec![]);
    solid(&mut positions, &mut triangles, Vec3::ZERO, [Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0]);
    for beam in 0..COUNT {
        let mut numbers = numbers.sample(UVec2::ZERO, beam);
        let (u, v) = (numbers.get_2d(0), numbers.get_2d(2));
        let middle = (Vec3::new(u.x, u.y, numbers.get_1d(4)) - 0.5) * 3.6;
        // The middle of the room is free.
        let middle = if middle.length() < 1.0 { middle.normalize_or(Vec3::X) * (1.0 + 0.6 * numbers.get_1d(5)) } else { middle };
        let frame = Frame::around(warp::uniform_sphere(v));
        let axes = [Vec3::X * 0.002, Vec3::Y * 0.002, Vec3::Z * 0.12].map(|axis| frame.to_world(Local(axis)));
        solid(&mut positions, &mut triangles, middle, axes);
    }
    Subject {
        name: "beams",
        mesh: mesh(positions, triangles),
        size: 192,
        eye: Vec3::ZERO,
        target: Vec3::new(0.2, 0.1, -1.0),
        lamp: Vec3::ZERO,
    }
}

/// Adds a box with this middle and these half edges.
fn solid(positions: &mut Vec<Vec3>, triangles: &mut Vec<[u32; 3]>, middle: Vec3, [x, y, z]: [Vec3; 3]) {
    for [a, b, c] in [[x, y, z], [y, z, x], [z, x, y]] {
        quad(positions, triangles, [middle - a - b - c, 2.0 * a, 2.0 * b]);
        quad(positions, triangles, [middle - a - b + c, 2.0 * b, 2.0 * a]);
    }
}

/// Adds a parallelogram with a corner and its two edges.
fn quad(positions: &mut Vec<Vec3>, triangles: &mut Vec<[u32; 3]>, [corner, a, b]: [Vec3; 3]) {
    let first = positions.len() as u32;
    positions.extend([corner, corner + a, corner + a + b, corner + b]);
    triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> MeshData {
    let whole = MeshPart { triangles: 0..triangles.len() as u32, ..MeshPart::default() };
    MeshData { positions, triangles, parts: vec![whole], ..MeshData::default() }
}
