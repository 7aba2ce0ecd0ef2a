//! Scenes of dirt and darts.

mod commands;
mod coursework;
mod media;
mod shared_scenes;
mod table;
mod textures;

use std::fs;
use std::path::Path;
use std::sync::Arc;

use pt::build::Source;
use pt::describe;
use pt::film::{Image, MomentFilm};
use pt::import::{Imported, import};
use pt::integrator::choose;
use pt::measure::{SampledImage, agreement, sidak};
use pt::render::{Settings, Silent, render};
use pt::sampler::SamplerSpec;

use super::convert::{same_bits, succeeds};

const DIALECTS: [(&str, &str, &str); 3] = [
    ("dirt", "dirt.json", include_str!("darts/dirt.json")),
    ("darts 2021", "darts-2021.json", include_str!("darts/darts-2021.json")),
    ("darts", "darts.json", include_str!("darts/darts.json")),
];

const PYRAMID: &str = "v -0.5 0 -0.5\nv 0.5 0 -0.5\nv 0.5 0 0.5\nv -0.5 0 0.5\nv 0 1 0\n\
    usemtl red\nf 1 5 2\nf 2 5 3\nusemtl none\nf -3 -1 -2\nf 4 5 1\nf 4 3 2 1\n";

/// A folder with the scene in the three dialects, and the mesh that they name.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("pyramid.obj"), PYRAMID).expect("a mesh");
    for (_, file, scene) in DIALECTS {
        fs::write(folder.path().join(file), scene).expect("a scene");
    }
    let map = image::RgbImage::from_fn(8, 4, |x, y| image::Rgb([30 * x as u8, 60 * y as u8, 90]));
    map.save(folder.path().join("map.png")).expect("a picture");
    folder
}

fn imported(folder: &Path, file: &str) -> Imported {
    import(&folder.join(file), false).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn each_dialect_is_recognised_by_its_keywords() {
    let folder = folder();
    for (name, file, _) in DIALECTS {
        let found = imported(folder.path(), file);
        assert_eq!(found.dialect.name, name);
        // The veins of the marble have other positions in this dialect.
        let others = found.notes.iter().filter(|note| !note.message.contains("veins are approximated"));
        assert_eq!(others.count(), 0, "{file}: {:?}", found.notes);
    }
}

#[test]
fn the_same_scene_in_three_dialects_has_the_same_bits() {
    let folder = folder();
    same_bits(folder.path(), "dirt.json", "darts-2021.json");
    same_bits(folder.path(), "dirt.json", "darts.json");
    let picture = fs::read(folder.path().join("picture.pfm")).expect("a picture");
    assert!(picture.iter().skip(20).any(|byte| *byte != picture[20]), "there is something to see");
}

#[test]
fn what_is_converted_has_the_same_bits() {
    let folder = folder();
    succeeds(folder.path(), &["convert", "darts.json", "converted.json"]);
    same_bits(folder.path(), "darts.json", "converted.json");
}

/// Faces under a material name that the scene defines have that material; the others have the material of the mesh.
#[test]
fn scene_materials_replace_those_of_a_mesh_file() {
    let folder = folder();
    let root = imported(folder.path(), "dirt.json").root;
    let mesh = root.get("/shapes/4").expect("a mesh");
    assert_eq!(mesh.child("materials").expect("names").to_string(), "{\n  \"red\": \"red\"\n}");
    assert_eq!(mesh.child("material").expect("its own").as_str(), Some("lacquer"));
}

/// A picture of the box by one of the dialect's integrators, with sixteen scramblings for the error estimate.
fn by(method: &str, bounces: u32, seed: u64) -> Image {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = include_str!("darts/box.json")
        .replace("path tracer mis", method)
        .replace("\"max bounces\": 5", &format!("\"max bounces\": {bounces}"));
    fs::write(folder.path().join("box.json"), scene).expect("a scene");
    picture(folder.path(), "box.json", SAMPLES, seed)
}

/// A picture of a scene by its own integrator.
fn picture(folder: &Path, file: &str, spp: u64, seed: u64) -> Image {
    let Imported { root, file, files, .. } = imported(folder, file);
    let source = Source { root: &root, file: &file, files: &files };
    let described = describe::read(&root, &file).unwrap_or_else(|error| panic!("{error}"));
    let built = pt::build::build(&described, source).unwrap_or_else(|error| panic!("{error}"));
    let (_, integrator) = choose(&[pt::integrators::ALL], root.child("integrator"), None, &file).expect("known");
    let mut film = MomentFilm::new(built.film);
    let sampler = SamplerSpec { spp, seed, ..built.sampler };
    let report = render(Arc::new(built.world), &*integrator, &mut film, &Settings::new(sampler), &Silent);
    assert_eq!(report.invalid, 0);
    film.image()
}

const SAMPLES: u64 = 512;

/// The integrators of the dialect find light in different ways, and agree.
#[test]
fn its_integrators_agree_within_their_error_bars() {
    let methods = ["path tracer mats", "path tracer nee", "path tracer mis", "path tracer mixture", "path tracer simple"];
    let images: Vec<Image> = methods.iter().zip(1..).map(|(method, seed)| by(method, 5, seed)).collect();
    let pairs = methods.len() - 1;
    for (method, image) in methods.iter().zip(&images).filter(|(method, _)| **method != "path tracer mis") {
        let side = |image| SampledImage { image, samples: SAMPLES };
        let found = agreement(side(image), side(&images[2]), sidak(0.01, pairs)).expect("two sides");
        assert!(found.accepts(), "{method}: {found}");
    }
    // The comparison is able to detect a difference: a picture with one bounce less differs.
    let short = by("path tracer nee", 4, 9);
    let side = |image| SampledImage { image, samples: SAMPLES };
    assert!(!agreement(side(&short), side(&images[2]), 0.01).expect("two sides").accepts());
}

/// Random numbers without high requirements: a linear congruential generator with Knuth's MMIX constants.
struct Noise(u64);

impl Noise {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % n.max(1)
    }
}

#[test]
fn mutated_scenes_never_panic() {
    const WORDS: [&str; 20] = [
        "",
        "{",
        "}",
        "[",
        "]",
        ",",
        ":",
        "\"",
        "0",
        "-1",
        "1e39",
        "null",
        "\"type\"",
        "\"transform\"",
        "\"matrix\"",
        "[1]",
        "{}",
        "\"name\"",
        "\"material\"",
        "\u{1f431}",
    ];
    let folder = folder();
    let mutant = folder.path().join("mutant.json");
    let mut noise = Noise(1);
    let mut survivors = 0;
    for round in 0..6000 {
        let mut bytes = DIALECTS[round % 3].2.as_bytes().to_vec();
        for _ in 0..1 + noise.below(3) {
            let (start, other) = (noise.below(bytes.len()), noise.below(bytes.len()));
            let removed = noise.below(8).min(bytes.len() - start);
            let inserted = match noise.below(3) {
                0 => WORDS[noise.below(WORDS.len())].as_bytes().to_vec(),
                1 => bytes[other..(other + noise.below(30)).min(bytes.len())].to_vec(),
                _ => vec![noise.below(256) as u8],
            };
            bytes.splice(start..start + removed, inserted);
        }
        fs::write(&mutant, &bytes).expect("a scene");
        let read = import(&mutant, false).and_then(|found| describe::read(&found.root, &found.file));
        match read {
            Ok(_) => survivors += 1,
            Err(error) => assert!(matches!(error.exit_code(), 3 | 4) && !error.to_string().is_empty(), "{error:?}"),
        }
    }
    assert!(survivors > 100, "some mutations leave a scene, else only the parser is tested: {survivors}");
}
