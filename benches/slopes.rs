//! How time and memory grow with triangles, lamps, pixels, the depth of paths, and threads.
//!
//! `cargo bench --bench slopes [-- triangles lamps pixels depth threads]` measures all, or the named ones, and prints a table for each.
//! Scenes are made here, in `target/slopes`, and rendered by `nee`; all but the last table with one thread. Times are wall-clock times,
//! the shortest of three renders. Ratios within one run count.
//!
//! A **slope** is that of the logarithms of two numbers, from each row to the next: 0 where the second number stays the same, 1 where it
//! grows as much as the first.
//!
//! The table of threads is compared with a **model**: on n threads a render takes (s + (1 − s) / n) of its time on one, where s is the
//! share of the work that only one thread does, or for which threads wait for each other, for memory or for the processor's clock. It is
//! fitted by least squares to the times of all numbers of threads.

mod memory;
mod subject;

use std::fmt::Write;
use std::fs;
use std::num::NonZero;
use std::path::Path;
use std::sync::Arc;
use std::thread::available_parallelism;
use std::time::Instant;

use pt::build::{Source, build};
use pt::describe::{self, Files};
use pt::film::MomentFilm;
use pt::integrators::nee::Nee;
use pt::math::float;
use pt::render::{Settings, Silent, render};
use pt::sampler::SamplerSpec;
use serde_json::{Value, json};
use subject::Subject;

const FOLDER: &str = "target/slopes";
const REPEATS: u64 = 3;

fn main() -> pt::Result<()> {
    fs::create_dir_all(FOLDER).expect(FOLDER);
    let names: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    for (name, table) in
        [("triangles", triangles as fn() -> pt::Result<()>), ("lamps", lamps), ("pixels", pixels), ("depth", depth), ("threads", threads)]
    {
        if names.is_empty() || names.iter().any(|asked| asked == name) {
            table()?;
        }
    }
    Ok(())
}

/// What a scene takes.
struct Cost {
    /// Time of loading and building (s).
    build: f64,
    /// Memory of the scene (bytes).
    scene: f64,
    /// Time of a sample (ns).
    sample: f64,
    /// Memory of the render, beside the scene (bytes).
    render: f64,
}

/// Builds and renders a scene with so many threads.
fn cost(load: impl Fn() -> pt::Result<Subject> + Sync, samples: u64, threads: usize) -> pt::Result<Cost> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let before = memory::in_use();
    let start = Instant::now();
    let subject = pool.install(&load)?;
    let build = start.elapsed().as_secs_f64();
    let with_scene = memory::in_use();
    memory::most();
    let (mut sample, mut bytes) = (f64::INFINITY, 0);
    for seed in 0..REPEATS {
        let settings = Settings { samples, ..Settings::new(SamplerSpec { seed, ..SamplerSpec::default() }) };
        let mut pixels = MomentFilm::new(subject.spec.clone());
        let start = Instant::now();
        pool.install(|| render(subject.scene.clone(), &*subject.integrator, &mut pixels, &settings, &Silent));
        sample = sample.min(1e9 * start.elapsed().as_secs_f64() / (subject.spec.crop.pixel_count() * samples) as f64);
        drop(pixels);
        bytes = memory::most() - with_scene;
    }
    Ok(Cost { build, scene: with_scene.saturating_sub(before) as f64, sample, render: bytes as f64 })
}

/// The subject of a scene that is made here.
fn subject(scene: &Value) -> pt::Result<Subject> {
    let (text, file) = (scene.to_string(), format!("{FOLDER}/scene.json"));
    let root = describe::root(text.as_bytes(), &file)?;
    let built = build(&describe::read(&root, &file)?, Source { root: &root, file: &file, files: &Files::within(FOLDER) })?;
    Ok(Subject { scene: Arc::new(built.world), integrator: Box::new(Nee::default()), spec: built.film })
}

/// The Cornell box with so many pixels.
fn cornell(size: u32, changes: &[(&str, &str)]) -> pt::Result<Subject> {
    let size = size.to_string();
    let film = [("/film/width", size.as_str()), ("/film/height", &size)];
    Subject::load("cornell-box", &[&film, changes].concat())
}

/// Slope of the logarithms of y over x from one row to the next; empty for the first row.
struct Slope(Option<(f64, f64)>);

impl Slope {
    fn to(&mut self, x: f64, y: f64) -> String {
        let text = self.0.map_or(String::new(), |(x0, y0)| format!("{:.2}", (y / y0).ln() / (x / x0).ln()));
        self.0 = Some((x, y));
        text
    }
}

/// A floor with a camera above it, and what is added; without lights.
fn outdoors(size: u32, mut shapes: Vec<Value>) -> Value {
    shapes.push(
        json!({ "type": "quad", "size": 8, "material": "matte", "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }] }),
    );
    json!({
        "pt": 1,
        "camera": { "look_at": { "from": [0, 3, 4], "to": [0, 0.8, 0] }, "fov": 40 },
        "film": { "width": size, "height": size },
        "materials": { "matte": { "type": "diffuse", "albedo": 0.6 } },
        "shapes": shapes,
    })
}

/// A wavy ball, of 10³ to 10⁷ triangles, that fills the same part of the picture.
fn triangles() -> pt::Result<()> {
    println!("\n| triangles | ready in | slope | bytes a triangle | ns a sample | slope |\n|---|---|---|---|---|---|");
    let (mut build, mut sample) = (Slope(None), Slope(None));
    for exponent in 3..=7 {
        let count = write_ball(10f64.powi(exponent), &Path::new(FOLDER).join("ball.obj"));
        let ball = json!({ "type": "mesh", "file": "ball.obj", "material": "matte", "transform": [{ "translate": [0, 1, 0] }] });
        let mut scene = outdoors(256, vec![ball]);
        scene["background"] = json!({ "radiance": 1 });
        let cost = cost(|| subject(&scene), 16, 1)?;
        println!(
            "| {count:.0} | {:.3} s | {} | {:.0} | {:.0} | {} |",
            cost.build,
            build.to(count, cost.build),
            cost.scene / count,
            cost.sample,
            sample.to(count, cost.sample),
        );
    }
    Ok(())
}

/// Writes a ball with waves and returns the number of its triangles, about `wanted`.
fn write_ball(wanted: f64, path: &Path) -> f64 {
    let rings = (wanted / 4.0).sqrt().round() as usize;
    let around = 2 * rings;
    let mut text = String::new();
    for i in 0..=rings {
        let (s, c) = float::sin_cos(std::f32::consts::PI * i as f32 / rings as f32);
        for j in 0..around {
            let (sin, cos) = float::sin_cos(std::f32::consts::TAU * j as f32 / around as f32);
            let r = 1.0 + 0.1 * float::sin(5.0 * s * cos) * float::sin(7.0 * c);
            writeln!(text, "v {} {} {}", r * s * cos, r * c, r * s * sin).expect("a text grows");
        }
    }
    let index = |i: usize, j: usize| i * around + j % around + 1;
    for (i, j) in (0..rings).flat_map(|i| (0..around).map(move |j| (i, j))) {
        let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
        writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").expect("a text grows");
    }
    fs::write(path, text).expect("a file in target/slopes");
    (2 * rings * around) as f64
}

/// A square of 1 to 10⁵ lamps over the floor, of the same power together. What else the scene takes is left out of the memory of a lamp,
/// which means something for many lamps only.
fn lamps() -> pt::Result<()> {
    println!("\n| lamps | ready in | slope | bytes a lamp | ns a sample | slope |\n|---|---|---|---|---|---|");
    let (mut build, mut sample) = (Slope(None), Slope(None));
    let bare = cost(|| subject(&outdoors(128, vec![])), 1, 1)?.scene;
    for side in [1u32, 3, 10, 32, 100, 316] {
        let count = f64::from(side * side);
        let spacing = 6.0 / f64::from(side);
        let lamp = |i: u32, j: u32| {
            let at = |k: u32| (f64::from(k) + 0.5) * spacing - 3.0;
            json!({ "type": "quad", "size": 0.2 * spacing, "material": "matte", "emission": 60.0,
                "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [at(i), 2, at(j)] }] })
        };
        let scene = outdoors(128, (0..side).flat_map(|i| (0..side).map(move |j| lamp(i, j))).collect());
        let cost = cost(|| subject(&scene), 16, 1)?;
        println!(
            "| {count:.0} | {:.4} s | {} | {:.0} | {:.0} | {} |",
            cost.build,
            build.to(count, cost.build),
            (cost.scene - bare) / count,
            cost.sample,
            sample.to(count, cost.sample),
        );
    }
    Ok(())
}

/// The Cornell box with more pixels.
fn pixels() -> pt::Result<()> {
    println!("\n| pixels | ns a sample | slope | bytes a pixel while rendering |\n|---|---|---|---|");
    let mut sample = Slope(None);
    for size in [64, 128, 256, 512, 1024, 2048] {
        let count = f64::from(size) * f64::from(size);
        let cost = cost(|| cornell(size, &[]), if size < 1024 { 16 } else { 4 }, 1)?;
        println!("| {size} × {size} | {:.0} | {} | {:.0} |", cost.sample, sample.to(count, cost.sample), cost.render / count);
    }
    Ok(())
}

/// The Cornell box with longer paths. Bright walls and no roulette let none of them end early.
fn depth() -> pt::Result<()> {
    println!("\n| most bounces | ns a sample | slope |\n|---|---|---|");
    let mut sample = Slope(None);
    let bright = ["white", "red", "green"].map(|name| format!("/materials/{name}/albedo"));
    for depth in ["1", "2", "4", "8", "16", "32", "64"] {
        let integrator = [("/integrator/max_depth", depth), ("/integrator/roulette_depth", depth)];
        let changes: Vec<_> = bright.iter().map(|pointer| (pointer.as_str(), "0.98")).chain(integrator).collect();
        let cost = cost(|| cornell(128, &changes), 16, 1)?;
        println!("| {depth} | {:.0} | {} |", cost.sample, sample.to(depth.parse().expect("a number"), cost.sample));
    }
    Ok(())
}

/// Three scenes with one thread, two, four and so on, and all that there are.
fn threads() -> pt::Result<()> {
    let all = available_parallelism().map_or(1, NonZero::get);
    let counts: Vec<usize> = (0..).map(|k| 1 << k).take_while(|count| *count < all).chain([all]).collect();
    write_ball(1e6, &Path::new(FOLDER).join("ball.obj"));
    let ball = json!({ "type": "mesh", "file": "ball.obj", "material": "matte", "transform": [{ "translate": [0, 1, 0] }] });
    let mut mesh = outdoors(512, vec![ball]);
    mesh["background"] = json!({ "radiance": 1 });
    println!("\n| scene | threads | ns a sample | speed-up | ready in | speed-up |\n|---|---|---|---|---|---|");
    scaling("Cornell box", &counts, 64, || cornell(512, &[]))?;
    scaling("a million triangles", &counts, 32, || subject(&mesh))
}

/// Renders a scene with each number of threads, of which the first is 1, and prints a row for each and the model.
fn scaling(name: &str, counts: &[usize], samples: u64, load: impl Fn() -> pt::Result<Subject> + Sync) -> pt::Result<()> {
    let costs: Vec<Cost> = counts.iter().map(|count| cost(&load, samples, *count)).collect::<pt::Result<_>>()?;
    for (count, cost) in counts.iter().zip(&costs) {
        let (render, build) = (costs[0].sample / cost.sample, costs[0].build / cost.build);
        println!("| {name} | {count} | {:.1} | {render:.2} | {:.3} s | {build:.2} |", cost.sample, cost.build);
    }
    let share = serial_share(counts.iter().zip(&costs).map(|(count, cost)| (*count as f64, cost.sample / costs[0].sample)));
    let on = |n: f64| 1.0 / (share + (1.0 - share) / n);
    let (percent, few, many) = (100.0 * share, on(32.0), on(128.0));
    println!("{name}: serial share {percent:.2} %; the model says {few:.0} times as fast on 32 threads, {many:.0} on 128");
    Ok(())
}

/// Share s for which s + (1 − s) / n is as near as can be to the times t of n threads, relative to the time of one.
fn serial_share(times: impl Iterator<Item = (f64, f64)>) -> f64 {
    // t − 1/n = s (1 − 1/n).
    let (above, below) = times.fold((0.0, 0.0), |(above, below), (n, t)| {
        let rest = 1.0 - 1.0 / n;
        (above + (t - 1.0 / n) * rest, below + rest * rest)
    });
    if below > 0.0 { above / below } else { 0.0 }
}
