//! `pt sample`: points as numbers and pictures, and tests and pictures of materials.

use std::f64::consts::{FRAC_PI_3, PI};
use std::fs;
use std::path::Path;

use assert_cmd::Command;

const SCENE: &str = r#"{
  "pt": 1,
  "camera": { "look_at": { "from": [0, 0, 3], "to": [0, 0, 0] } },
  "materials": {
    "wall": { "type": "diffuse", "albedo": [0.2, 0.4, 0.8] },
    "brushed": { "type": "matte_cone", "color": 1, "mattness": 0.3 },
    "glass": { "type": "dielectric", "eta": 1.5 },
    "veil": { "type": "masked", "surface": "wall", "opacity": 0 }
  },
  "shapes": [{ "type": "sphere", "material": "wall" }],
  "background": { "radiance": 1 }
}"#;

fn pt(folder: &Path, args: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("pt").expect("the binary").current_dir(folder).arg("sample").args(args).assert()
}

fn stdout(folder: &Path, args: &[&str]) -> String {
    String::from_utf8(pt(folder, args).success().get_output().stdout.clone()).expect("text")
}

fn points(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().expect("a number")).collect()).collect()
}

/// The first word of each line of the list is a name that works, and gives as many points as asked for.
#[test]
fn every_listed_warp_gives_points() {
    let folder = tempfile::tempdir().expect("a folder");
    let list = stdout(folder.path(), &[]);
    let names: Vec<&str> = list
        .lines()
        .filter(|line| line.starts_with("  ") && !line.contains("pt sample"))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert!(names.len() >= 18, "{list}");
    for name in names {
        let drawn = points(&stdout(folder.path(), &[name, "-n", "37"]));
        assert_eq!(drawn.len(), 37, "{name}");
        assert!(drawn.iter().flatten().all(|x| x.abs() <= 1.0), "{name}");
    }
}

/// The mean of z agrees to five standard errors of 20,000 points: 1/2 for uniform in solid angle, 2/3 for cosine-weighted, 2/π for uniform
/// in the angle (a common mistake), (n + 1)/(n + 2) for cosⁿ. In the ball ⟨r²⟩ = 3/5, for both methods.
#[test]
fn points_have_the_mean_of_their_density() {
    let folder = tempfile::tempdir().expect("a folder");
    let mean = |args: &[&str], of: &dyn Fn(&[f64]) -> f64| {
        let drawn = points(&stdout(folder.path(), &[args, &["-n", "20000"]].concat()));
        drawn.iter().map(|p| of(p)).sum::<f64>() / drawn.len() as f64
    };
    let height = |p: &[f64]| p[2];
    let square = |p: &[f64]| p.iter().map(|x| x * x).sum();
    // The facets of GGX at α = 1 are those of a hemisphere. Seen from the side, normals have the density wo·h = x on a quarter of the
    // sphere, and ⟨z⟩ = (2/π) ∫ x z dω = 4/(3π). Seen from above ⟨z⟩ = 2/3. For Beckmann seen from above, tan² θ has an exponential
    // distribution, and ⟨cos θ⟩ = e √π erfc 1. The octant is symmetric in x, y and z, and ⟨z⟩ = 1/2. For the square, ⟨z⟩ by Lambert's sum
    // over its edges is 2 √2 atan(1/√2) over 2π/3. Standard deviations are below 0.31, so five standard errors of the mean are 0.011.
    for (args, expected) in [
        (&["hemisphere"][..], 0.5),
        (&["cosine"], 2.0 / 3.0),
        (&["hemisphere-angles"], std::f64::consts::FRAC_2_PI),
        (&["cosine-power", "--exponent", "8"], 0.9),
        (&["cone", "--angle", "60"], 0.75),
        (&["spherical-triangle", "--corners", "1,0,0 0,1,0 0,0,1"], 0.5),
        (&["spherical-rectangle", "--corners", "-1,-1,1 1,-1,1 -1,1,1"], 2f64.sqrt() * 0.5f64.sqrt().atan() / FRAC_PI_3),
        (&["visible-ggx", "--alpha", "1", "--wo", "0,0"], 2.0 / 3.0),
        (&["visible-ggx", "--alpha", "1,1", "--wo", "90,0"], 4.0 / (3.0 * PI)),
        (&["visible-beckmann", "--alpha", "1", "--wo", "0,0"], 0.757_872_156),
        (&["sphere"], 0.0),
    ] {
        // The standard deviation for the sphere is 1/√3.
        let tolerance = if expected == 0.0 { 0.021 } else { 0.011 };
        assert!((mean(args, &height) - expected).abs() < tolerance, "{args:?}");
    }
    for ball in ["ball", "ball-rejection"] {
        assert!((mean(&[ball], &square) - 0.6).abs() < 0.011, "{ball}");
    }
    assert!((mean(&["disk"], &square) - 0.5).abs() < 0.011);
    // For facets seen from the side, along x or y, ⟨wo·h⟩ = (2/π) ∫ x² dω over a quarter of the sphere.
    for (wo, axis) in [("90,0", 0), ("90,90", 1)] {
        let towards = mean(&["visible-ggx", "--alpha", "1", "--wo", wo], &|p| p[axis]);
        assert!((towards - 2.0 / 3.0).abs() < 0.011, "{wo}: {towards}");
    }
}

/// Every map to the sphere has its documented density, except for the one with the common mistake.
#[test]
fn directions_pass_the_chi2_test() {
    let folder = tempfile::tempdir().expect("a folder");
    for args in [
        &["sphere"][..],
        &["hemisphere"],
        &["cosine"],
        &["cosine-power", "--exponent", "8"],
        &["cone", "--angle", "50"],
        &["spherical-triangle"],
        &["spherical-rectangle"],
        &["visible-ggx", "--alpha", "0.2,0.7", "--wo", "75,20"],
        &["visible-beckmann", "--alpha", "0.4", "--wo", "60,-100"],
    ] {
        let text = stdout(folder.path(), &[args, &["--chi2", "--samples", "100000"]].concat());
        assert!(text.contains("∫ pdf          1.000") || text.contains("∫ pdf          0.9999"), "{args:?}: {text}");
    }
    let refused = pt(folder.path(), &["hemisphere-angles", "--chi2", "--samples", "100000"]).code(1);
    let text = String::from_utf8_lossy(&refused.get_output().stdout).into_owned();
    assert!(text.contains("chi² p         0.000 (80×160"), "{text}");
}

#[test]
fn pictures_and_tables_by_extension() {
    let folder = tempfile::tempdir().expect("a folder");
    for (file, start) in [("p.csv", "x,y,z\n"), ("p.svg", "<svg "), ("p.png", "\u{fffd}PNG")] {
        pt(folder.path(), &["sphere", "-n", "100", "-o", file]).success();
        let bytes = fs::read(folder.path().join(file)).expect("written");
        assert!(String::from_utf8_lossy(&bytes).starts_with(start), "{file}");
    }
    let svg = fs::read_to_string(folder.path().join("p.svg")).expect("text");
    assert_eq!(svg.matches("<circle").count(), 100);
}

#[test]
fn invalid_sample_requests_are_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("scene.json"), SCENE).expect("write");
    for (args, code, phrase) in [
        (&["spere"][..], 2, "unknown warp or sampler \"spere\", did you mean \"sphere\"?"),
        (&["sphere", "-o", "p.gif"], 2, "p.gif: expected a name that ends in .csv, .png or .svg"),
        (&["sphere", "--sampler", "sobel"], 2, "unknown sampler \"sobel\", did you mean \"sobol\"?"),
        (&["cone", "--angle", "0"], 2, "expected an angle above 0"),
        (&["spherical-triangle", "--corners", "1,0,0 0,1,0"], 2, "expected three points such as '1,0,0 0,1,0 0,0,1'"),
        (&["spherical-triangle", "--corners", "1,0,0 0,1,0 1,1,0"], 2, "not edge-on"),
        (&["spherical-rectangle", "--corners", "0,0,1 1,0,1 1,1,1"], 2, "expected a right angle at the first corner"),
        (&["visible-ggx", "--alpha", "-1"], 2, "expected one or two numbers from 0 to 100"),
        (&["visible-ggx", "--alpha", "0"], 2, "smoother than which is a mirror"),
        (&["visible-beckmann", "--wo", "91,0"], 2, "expected at most 90 degrees from the normal"),
        (&["disk", "--chi2"], 2, "--chi2: the points of disk are no directions"),
        (&["sobol", "--chi2"], 2, "--chi2: the points of square are no directions"),
        (&["material"], 2, "scene.json#glass"),
        (&["material", "scene.json"], 2, "scene.json#glass"),
        (&["material", "scene.json#glas"], 2, "unknown material \"glas\", did you mean \"glass\"?"),
        (&["material", "none.json#glass"], 3, "no such file"),
        (&["material", "scene.json#glass", "--wo", "200,0"], 2, "expected two angles"),
    ] {
        let output = pt(folder.path(), args).code(code).get_output().clone();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(stderr.contains(phrase), "{args:?}: expected {phrase:?} in\n{stderr}");
    }
    assert_eq!(fs::read_dir(folder.path()).expect("list").count(), 1, "nothing is written");
}

/// Correct materials of a scene give exit code 0, printed results, and three pictures of the same size.
#[test]
fn materials_are_proved_and_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("scene.json"), SCENE).expect("write");
    for (name, wo, phrases) in [
        ("wall", "30,0", ["furnace albedo 0.20000 ± 0.00000 (red), 0.40000", "valid samples  100.000 %"]),
        ("brushed", "70,45", ["furnace albedo 1.00000", "valid samples  100.000 % (100.000 % with a density"]),
        ("veil", "30,0", ["furnace albedo 0.20000 ± 0.00000 (red), 0.40000", "valid samples  100.000 %"]),
        ("glass", "120,-10", ["∫ pdf          0.00000", "delta"]),
    ] {
        let scene = format!("scene.json#{name}");
        let text = stdout(folder.path(), &["material", &scene, "--wo", wo, "--samples", "50000"]);
        phrases.iter().for_each(|phrase| assert!(text.contains(phrase), "expected {phrase:?} in\n{text}"));
        for picture in ["pdf", "sampled", "difference"] {
            let bytes = fs::read(folder.path().join(format!("{name}-{picture}.png"))).expect("written");
            // Width and height, read from the header of a PNG.
            assert_eq!(bytes[16..24], [0, 0, 2, 128, 0, 0, 1, 64], "{name}-{picture}");
        }
    }
}
