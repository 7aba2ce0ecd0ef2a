//! Sampling tests of the courses of dirt and darts: verdicts, figures and pictures.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use pt::output::Colormap;

use crate::shared::shared;

fn run(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pt")).current_dir(folder).arg("sample").args(args).output().expect("pt runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// The exit code of one test, and what is said about it.
fn verdict(test: &str) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("tests.json"), format!(r#"{{ "type": "tests", "tests": [{test}] }}"#)).expect("a file");
    let output = run(folder.path(), &["tests.json"]);
    (output.status.code(), said(&output))
}

/// Values from 0 to 1 of a picture in the courses' colours: Inferno's shares of red, green and blue, taken as light and written as sRGB.
///
/// The value is that of the nearest of a thousand colours. A channel is rounded by up to 1/255, which is up to 1/50 of the range where the
/// map changes slowly.
struct Picture {
    width: usize,
    values: Vec<f64>,
}

impl Picture {
    fn read(path: &Path) -> Picture {
        let picture = image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).to_rgb8();
        let encoded = |c: f64| if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        let color = |i: usize| Colormap::Inferno.color(i as f64 / 1000.0).map(|c| encoded(f64::from(c) / 255.0));
        let table: Vec<[f64; 3]> = (0..=1000).map(color).collect();
        let distance = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let mut known = std::collections::HashMap::new();
        let value = |pixel: &image::Rgb<u8>| {
            *known.entry(pixel.0).or_insert_with(|| {
                let found = pixel.0.map(|c| f64::from(c) / 255.0);
                let nearest = (0..table.len()).min_by(|&a, &b| distance(&table[a], &found).total_cmp(&distance(&table[b], &found)));
                nearest.expect("a colour") as f64 / 1000.0
            })
        };
        Picture { width: picture.width() as usize, values: picture.pixels().map(value).collect() }
    }

    /// Means over 64 × 32 blocks.
    fn blocks(&self) -> Vec<f64> {
        let edge = self.width / 64;
        let block = |(row, column): (usize, usize)| {
            let within = (0..edge).flat_map(|y| (0..edge).map(move |x| (row * edge + y) * self.width + column * edge + x));
            within.map(|i| self.values[i]).sum::<f64>() / (edge * edge) as f64
        };
        (0..32).flat_map(|row| (0..64).map(move |column| (row, column))).map(block).collect()
    }
}

/// Difference of two pictures relative to the maximum of the second: the root mean square over blocks. The first picture is scaled to fit
/// best.
fn apart(a: &Picture, b: &Picture) -> f64 {
    let (a, b) = (a.blocks(), b.blocks());
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scale = product(&a, &b) / product(&a, &a);
    let square: f64 = a.iter().zip(&b).map(|(a, b)| (scale * a - b).powi(2)).sum();
    (square / a.len() as f64).sqrt() / b.iter().fold(0.0, |m: f64, x| m.max(*x))
}

#[test]
fn correct_materials_surfaces_and_intersections_pass() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("tests.json"), include_str!("tests.json")).expect("a file");
    let output = run(folder.path(), &["tests.json", "-o", "of-"]);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("12 of 12 tests passed"), "{said}");
    assert!(said.contains("warning: some directions are mirrored"), "{said}");
    // Lambert's law in the pictures: every row has the value cos θ, in both pictures.
    let pdf = Picture::read(&folder.path().join("of-diffuse-pdf.png"));
    assert_eq!((pdf.width, pdf.values.len()), (512, 512 * 256));
    for row in 0..256 {
        let expected = ((row as f64 + 0.5) / 256.0 * PI).cos().max(0.0);
        assert!((pdf.values[row * 512 + 77] - expected).abs() < 0.02, "row {row}: {}, expected {expected}", pdf.values[row * 512 + 77]);
    }
    for name in ["diffuse-turned", "phong", "phong-turned", "blinn-phong", "blinn-phong-turned", "mixed", "ball", "lamps"] {
        let [pdf, sampled] = ["pdf", "sampled"].map(|what| Picture::read(&folder.path().join(format!("of-{name}-{what}.png"))));
        // A block is four cells of 800 samples on average, which gives an error of 2 %. Blocks with fewer samples have less weight.
        let off = apart(&sampled, &pdf);
        assert!(off < 0.02, "{name}: what is drawn is {off} off what should be");
    }
}

/// The integral of Lambert's density is 1. That of Phong's is the share of the lobe above the surface: (1 + cos θ)/2 for a lobe of exponent
/// 1 whose axis is at θ from the normal.
#[test]
fn the_integral_counts_directions_above_the_surface() {
    let integral = |material: &str, incoming: &str| {
        let test =
            format!(r#"{{ "type": "sample material", "name": "m", "normal": [0, 0, 1], "incoming": {incoming}, "material": {material} }}"#);
        let (_, said) = verdict(&test);
        let figure = said.split("integral of the pdf").nth(1).and_then(|rest| rest.split_whitespace().next()).map(str::to_owned);
        figure.and_then(|figure| figure.parse::<f64>().ok()).unwrap_or_else(|| panic!("{said}"))
    };
    // Four digits are printed.
    assert!((integral(r#"{ "type": "diffuse" }"#, "[0.25, 0, -1]") - 1.0).abs() < 2e-4);
    let cos = 1.0 / (1.0f64 + 1.0).sqrt();
    assert!((integral(r#"{ "type": "phong", "exponent": 1 }"#, "[1, 0, -1]") - 0.5 * (1.0 + cos)).abs() < 2e-3);
}

#[test]
fn faulty_tests_fail_with_a_message() {
    let material = |material: &str, more: &str| {
        verdict(&format!(r#"{{ "type": "sample material", "name": "m", "normal": [0, 0, 1], "material": {material} {more} }}"#))
    };
    for ((code, said), word) in [
        (material(r#"{ "type": "metal", "roughness": 0 }"#, ""), "some directions are mirrored"),
        (material(r#"{ "type": "dielectric", "ior": 1.5 }"#, ""), "below the surface"),
        (material(r#"{ "type": "phong", "exponent": 1 }"#, r#", "incoming": [1, 0, -1]"#), "FAILED"),
        (
            verdict(
                r#"{ "type": "intersection", "surface": { "type": "sphere" }, "ray": { "origin": [0, 0, 3], "direction": [0, 0, -1] },
            "t": 2.1, "p": [0, 0, 1], "gn": [0, 0, 1], "sn": [0, 0, 1] }"#,
            ),
            "t should be 2.1, but is 2.0",
        ),
        (
            verdict(
                r#"{ "type": "intersection", "surface": { "type": "sphere" }, "ray": { "origin": [2, 0, 3], "direction": [0, 0, -1] },
            "t": 2, "p": [0, 0, 1], "gn": [0, 0, 1], "sn": [0, 0, 1] }"#,
            ),
            "meets none",
        ),
    ] {
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains(word) && said.contains("0 of 1 tests passed"), "{word}: {said}");
    }
    for (test, word) in [
        (r#"{ "type": "sample material", "name": "m", "material": { "type": "diffuse" } }"#, "missing key \"normal\""),
        (r#"{ "type": "sample material", "name": "m", "normal": 0, "material": { "type": "diffuse" } }"#, "expected a direction"),
        (r#"{ "type": "sample materiel", "name": "m" }"#, "did you mean \"sample material\"?"),
        (
            r#"{ "type": "sample material", "name": "m", "normal": [0, 0, 1], "material": { "type": "emission" } }"#,
            "/tests/0/material: a light",
        ),
    ] {
        let (code, said) = verdict(test);
        assert_eq!(code, Some(3), "{said}");
        assert!(said.contains("tests.json:1:") && said.contains(word), "{word}: {said}");
    }
}

/// The difference is large for a sampler with a slightly different exponent or normal.
#[test]
fn pictures_of_other_samplers_differ() {
    let folder = tempfile::tempdir().expect("a folder");
    let test = |name: &str, normal: &str, exponent: f64| {
        let material = format!(r#"{{ "type": "phong", "color": 1, "exponent": {exponent} }}"#);
        format!(r#"{{ "type": "sample material", "name": "{name}", "normal": {normal}, "material": {material} }}"#)
    };
    let tests = [test("it", "[0, 0, 1]", 5.0), test("sharper", "[0, 0, 1]", 6.0), test("turned", "[0.1, 0, 1]", 5.0)].join(", ");
    fs::write(folder.path().join("tests.json"), format!(r#"{{ "type": "tests", "tests": [{tests}] }}"#)).expect("a file");
    let output = run(folder.path(), &["tests.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let picture = |name: &str| Picture::read(&folder.path().join(format!("{name}-pdf.png")));
    for other in ["sharper", "turned"] {
        let off = apart(&picture(other), &picture("it"));
        assert!(off > 0.02, "{other}: {off}");
    }
}

/// The test files of the courses give the verdicts and pictures that come with them.
#[test]
fn the_courses_tests_give_the_courses_pictures() {
    let Some(darts) = shared("darts") else { return };
    for year in ["2021", "2025"] {
        let from = darts.join(year).join("assignment4");
        let folder = tempfile::tempdir().expect("a folder");
        let file = from.join("test_materials.json");
        let output = run(folder.path(), &[file.to_str().expect("text")]);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(0), "{said}");
        assert!(said.contains("6 of 6 tests passed"), "{said}");
        let pictures: Vec<_> = fs::read_dir(folder.path()).expect("list").map(|entry| entry.expect("entry").path()).collect();
        assert_eq!(pictures.len(), 12);
        for ours in pictures {
            let name = ours.file_stem().expect("a name").to_str().expect("text").to_owned();
            let off = apart(&Picture::read(&ours), &Picture::read(&from.join(format!("{name}-ref.png"))));
            // Colours differ by some per mille, since a cell of the original pictures holds 50 or 1000 samples.
            let limit = if name.ends_with("pdf") { 0.012 } else { 0.02 };
            assert!(off < limit, "{year} {name}: {off}");
        }
    }
}
