//! Renders `reference/*.exr`: `cargo run --release --example make_references [-- NAME …]`.
//!
//! Each picture is made by another integrator than the one it is compared with, with at least 64 times the samples, so that its own noise
//! is negligible. The `.json` file next to it describes how it was made.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pt::build::Source;
use pt::describe::{self, Files};
use pt::film::{Image, MomentFilm};
use pt::integrator::choose;
use pt::render::{Settings, Silent, render};
use serde_json::json;

/// A reference picture: the scene, the integrator and samples per pixel of the reference, and those of the picture that it judges.
struct Reference {
    scene: &'static str,
    maker: (&'static str, u32),
    judged: (&'static str, u32),
}

const fn by(scene: &'static str, maker: (&'static str, u32), judged: (&'static str, u32)) -> Reference {
    Reference { scene, maker, judged }
}

const REFERENCES: &[Reference] = &[
    by("cornell-box", ("path", 8192), ("nee", 128)),
    by("mirror-balls", ("path", 8192), ("nee", 128)),
    by("mattness", ("path", 8192), ("nee", 128)),
    by("glass-panel", ("path", 8192), ("nee", 128)),
    by("triangle-stacks", ("nee", 8192), ("path", 128)),
    by("statue", ("nee", 4096), ("path", 64)),
    by("shapes", ("path", 8192), ("nee", 128)),
    by("media", ("path", 8192), ("nee", 128)),
    by("motion", ("path", 8192), ("nee", 128)),
    by("bubbles", ("path", 8192), ("nee", 128)),
    by("fur", ("path", 4096), ("nee", 64)),
    by("macro-lens", ("path", 8192), ("nee", 128)),
    by("double-gauss", ("path", 8192), ("nee", 128)),
    by("gallery", ("light", 16384), ("nee", 64)),
    by("reflections", ("path", 16384), ("nee", 64)),
];

/// Seed that no test uses.
const SEED: u64 = 20_260_101;
const SIZE: [u32; 2] = [64, 64];

fn main() -> pt::Result<()> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    for reference in REFERENCES.iter().filter(|of| wanted.is_empty() || wanted.iter().any(|name| name == of.scene)) {
        let start = std::time::Instant::now();
        make(reference)?;
        println!("{}: {:.0} s", reference.scene, start.elapsed().as_secs_f64());
    }
    Ok(())
}

fn make(reference: &Reference) -> pt::Result<()> {
    let Reference { scene: name, maker: (maker, spp), judged } = *reference;
    let file = format!("scenes/{name}.json");
    let mut root = describe::load(Path::new(&file))?;
    let [width, height] = SIZE;
    let overrides = [
        ("/film/width", width.to_string()),
        ("/film/height", height.to_string()),
        ("/sampler/type", "independent".into()),
        ("/sampler/spp", spp.to_string()),
        ("/sampler/seed", SEED.to_string()),
    ];
    for (pointer, value) in &overrides {
        root.set(pointer, value)?;
    }
    let scene = describe::read(&root, &file)?;
    let (_, integrator) = choose(&[pt::integrators::ALL], root.child("integrator"), Some(maker), &file)?;
    let built = pt::build::build(&scene, Source { root: &root, file: &file, files: &Files::within("scenes") })?;
    let mut film = MomentFilm::new(built.film);
    let report = render(Arc::new(built.world), &*integrator, &mut film, &Settings::new(built.sampler), &Silent);
    assert_eq!(report.invalid, 0, "{name}: invalid samples, the first {:?}", report.first_invalid.first());

    let image = film.image();
    let path = PathBuf::from(format!("reference/{name}.exr"));
    pt::output::write(&path, &image, &vec![], &Default::default())?;
    let command =
        format!("pt {file} -i {maker} --size {width}x{height} --sampler independent --spp {spp} --seed {SEED} -o {}", path.display());
    let provenance = json!({
        "scene": file, "command": command, "integrator": maker, "seed": SEED, "spp": spp,
        "mean": RGB.map(|name| mean(&image, name, |v| v)),
        "standard_error": RGB.map(|name| standard_error(&image, name)),
        "judges": { "integrator": judged.0, "spp": judged.1 },
    });
    pt::output::replace(&path.with_extension("json"), format!("{provenance:#}\n").as_bytes())
}

const RGB: [&str; 3] = ["R", "G", "B"];

fn mean(image: &Image, name: &str, f: impl Fn(f64) -> f64) -> f64 {
    let values = image.channel(name).unwrap_or(&[]);
    values.iter().map(|&v| f(v.into())).sum::<f64>() / values.len() as f64
}

/// Standard error of the mean over the picture, whose pixels are independent.
fn standard_error(image: &Image, name: &str) -> f64 {
    (mean(image, &format!("StdErr.{name}"), |e| e * e) / (image.size.x * image.size.y) as f64).sqrt()
}
