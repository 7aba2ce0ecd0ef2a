//! `pt stress`: scenes that are safe are called so, and a difference is found, with its place.

use std::path::Path;
use std::process::{Command, Output};

use glam::{DMat3, DVec3, UVec2};
use pt::build::{Source, build};
use pt::describe::{self, Files};
use pt::film::FilmSpec;
use pt::integrators::ALL;
use pt::reader::parse;
use pt::render::Silent;
use pt::sampler::SamplerSpec;
use pt::stress::pictures::Rendering;
use pt::stress::{Change, Edit, Similarity, Subject, Trial, Verdict, sentence};

/// One thing of each kind that has a length or a direction, large in the picture. The cubes of the floor do not end in its plane, where
/// rounding would choose among them.
const LENGTHS: &str = r#"{
  "pt": 1,
  "camera": { "look_at": { "from": [0, 2, 7], "to": [0, 0.8, 0] }, "fov": 40, "lens_radius": 0.1, "focus_distance": 6 },
  "film": { "width": 48, "height": 32 },
  "integrator": { "type": "nee", "max_depth": 6 },
  "textures": {
    "cubes": { "type": "checker", "even": 0.8, "odd": 0.2, "scale": 2, "on": "position",
      "transform": [{ "translate": [0, 0.1, 0] }] },
    "dents": { "type": "noise", "scale": 3, "octaves": 2 },
    "veins": { "type": "marble", "base": 0.9, "veins": 0.1, "scale": 4 }
  },
  "materials": {
    "floor": { "type": "bumped", "surface": { "type": "diffuse", "albedo": "cubes" }, "bump_map": "dents", "scale": 0.2 },
    "wine": { "type": "dielectric", "eta": 1.3, "absorption": { "color": [0.5, 0.1, 0.2], "distance": 0.8 } },
    "stone": { "type": "diffuse", "albedo": "veins" }
  },
  "groups": { "pair": [
    { "type": "sphere", "radius": 0.3, "center": [0, 0.3, 0], "material": "stone" },
    { "type": "box", "size": 0.4, "center": [0.6, 0.25, 0], "material": "stone" }
  ] },
  "shapes": [
    { "type": "quad", "size": 12, "material": "floor", "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }] },
    { "name": "wine", "type": "sphere", "radius": 0.9, "center": [-1.3, 0.95, 0], "material": "wine" },
    { "type": "sdf", "field": { "type": "torus", "radius": 0.5, "tube": 0.2, "center": [1.2, 0.8, 0] }, "material": "stone" },
    { "type": "group", "transform": [{ "translate": [0, 0, 1.5] }], "shapes": [
      { "type": "instances", "group": "pair", "placements": [{}, { "transform": [{ "translate": [1.2, 0, 0] }] }] }
    ] },
    { "type": "mesh", "positions": [[-3, 0, -2], [3, 0, -2], [0, 3, -2.5]], "triangles": [[0, 1, 2]], "material": "stone" },
    { "type": "mesh", "positions": [[2.2, 2, 1.5], [3.2, 2.1, 1.6], [2.6, 3, 1.5], [2.6, 2.4, 0.8]], "triangles": [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
      "subdivision_levels": 3, "displacement": { "texture": "dents", "scale": 0.3 }, "material": "stone" },
    { "type": "mesh", "positions": [[-0.6, 2.6, -1], [0.2, 2.6, -1.1], [-0.2, 3.2, -1]], "triangles": [[0, 1, 2]], "material": "stone",
      "keyframes": [{ "time": 0 }, { "time": 1, "positions": [[-0.5, 2.4, -1], [0.3, 2.7, -0.8], [-0.3, 3.3, -1.2]] }] },
    { "type": "box", "size": [0.7, 0.3, 0.4], "material": "stone", "transform": [{ "keyframes": [
      { "time": 0, "transform": [{ "translate": [-2.6, 2.1, -0.6] }] },
      { "time": 1, "transform": [{ "rotate": { "axis": [1, 2, 3], "degrees": 70 } }, { "translate": [-1.9, 2.4, -0.8] }] }
    ] }] },
    { "type": "cylinder", "radius": 0.3, "z_min": -0.1, "z_max": 0.7, "phi_max": 250, "material": "stone",
      "transform": [{ "rotate": { "axis": [1, 0.5, 0], "degrees": -80 } }, { "translate": [2.2, 0.3, 1] }] },
    { "type": "cone", "radius": 0.4, "height": 0.8, "material": "stone",
      "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }, { "translate": [-0.2, 0.01, 2.2] }] },
    { "type": "sphere", "radius": 0.5, "center": [0, 0, 0.1], "z_max": 0.2, "phi_max": 300, "material": "stone",
      "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -70 } }, { "translate": [-2.5, 0.6, 1] }] },
    { "type": "disk", "radius": 0.5, "inner_radius": 0.2, "phi_max": 280, "material": "stone", "transform": [{ "translate": [2.6, 1.6, 0] }] },
    { "type": "bilinear_patch", "corners": [[1.6, 2.2, 0.2], [2.4, 2.5, 0], [1.5, 3, -0.2], [2.3, 2.8, 0.4]], "material": "stone" },
    { "type": "curves", "points": [[[-2.9, 0.2, 1], [-2.8, 0.9, 1.1], [-2.4, 1.4, 0.8]], [[-2.6, 0.1, 1.3], [-2.3, 0.8, 1.6]]], "radius": [0.1, 0.03], "material": "stone" },
    { "type": "curves", "basis": "bspline", "points": [[[2.2, 0, 2], [2.3, 0.6, 1.9], [2.6, 1.2, 2], [2.4, 1.8, 2.2], [2.5, 2.2, 2]]], "radius": 0.15,
      "normals": [[[0, 0, 1], [0, 0, 1], [1, 0, 1], [1, 0, 0], [0, 0, 1]]], "material": "stone" },
    { "type": "disk", "radius": 0.7, "emission": 8, "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 4, 0] }] }
  ],
  "lights": [
    { "type": "point", "position": [3, 3, 3], "intensity": { "srgb": [0.9, 0.7, 0.6] } },
    { "type": "spot", "position": [-3, 4, 3], "to": [-1, 0, 0], "intensity": [9, 6, 9] },
    { "type": "spot", "position": [2, 4, 1], "to": [1, 0, 1], "intensity": [9, 3, 2], "transform": [
      { "keyframes": [{ "time": 0 }, { "time": 1, "transform": [{ "rotate": { "axis": [0, 0, 1], "degrees": 10 } }, { "translate": [0.5, 0, 0] }] }] }
    ] },
    { "type": "directional", "direction": [1, -2, -1], "irradiance": 0.5 }
  ],
  "background": { "sky": { "elevation": 30, "sun": false } }
}"#;

/// The changes that matter for it.
const LENGTH_CHANGES: [&str; 9] =
    ["size x 1e-2", "size x 1e3", "2^7", "1e2 diameters", "turned", "mirrored", "axes", "reverse", "thousands"];

/// Tries changes of a scene, as the library does it.
fn trial<T>(json: &str, [width, height]: [u32; 2], spp: u64, integrator: &str, ask: impl FnOnce(&Trial) -> T) -> T {
    let root = parse(json.as_bytes()).expect("JSON");
    let files = Files::within(Path::new("."));
    let description = describe::read_with(&root, "scene.json", &files).expect("a scene");
    let built = build(&description, Source { root: &root, file: "scene.json", files: &files }).expect("a world");
    let entry = ALL.iter().find(|entry| entry.name == integrator).expect("an integrator");
    let film = FilmSpec { filter: built.film.filter, ..FilmSpec::new(width, height) };
    let subject = Subject { description: &description, root: &root, file: "scene.json", files: &files, entry, tables: &[ALL] };
    let rendering = Rendering { film: &film, sampler: SamplerSpec { seed: 3, ..built.sampler }, spp, observer: &Silent };
    ask(&Trial::new(subject, rendering).expect("a trial"))
}

/// Everything that has a length or a direction is changed with the scene. Without the change of a single kind of it, a picture differs.
#[test]
fn lengths_and_directions_change_with_the_scene() {
    trial(LENGTHS, [48, 32], 4, "nee", |trial| {
        let is_asked = |change: &&Change| LENGTH_CHANGES.iter().any(|word| change.name.contains(word));
        let asked: Vec<&Change> = trial.changes().iter().filter(is_asked).collect();
        assert!(asked.len() >= 11, "{asked:?}");
        for change in asked {
            let outcome = trial.ask(change).expect("an outcome");
            assert_eq!(outcome.verdict, Verdict::Same, "{}", change.name);
        }
    });
}

/// Focal lengths and sensors are lengths in millimetres, also the sensor that is not mentioned; shifts and tilts stay.
#[test]
fn lenses_change_with_the_scene() {
    let view = r#""fov": 40, "lens_radius": 0.1, "focus_distance": 6"#;
    assert!(LENGTHS.contains(view));
    for lens in [
        r#""focal_length": 33, "f_number": 0.2, "focus_distance": 6, "tilt": [-50, 10], "shift": [0.1, -0.05]"#,
        r#""focal_length": 50, "sensor": [60, 40], "f_number": 0.3, "focus_distance": 6, "aperture": { "blades": 5, "rotation": 20 }"#,
        r#""fov": 40, "f_number": 0.2, "focus_distance": 6"#,
        r#""type": "fisheye", "fov": 70"#,
        r#""type": "realistic", "lens": [[1000, 40, 1.5, 350], [-1000, 0, 1, 350]], "sensor": [1100, 700], "focus_distance": 6.5"#,
        r#""type": "realistic", "lens": [[20, 0.8, 1.5, 7], [-20, 0.4, 1, 7], [0, 0, 1, 7]], "scale": 2, "aperture_diameter": 6, "focus_distance": 8"#,
    ] {
        trial(&LENGTHS.replace(view, lens), [24, 16], 4, "nee", |trial| {
            for change in
                trial.changes().iter().filter(|change| ["1e-2", "2^7", "turned", "mirrored"].iter().any(|word| change.name.contains(word)))
            {
                assert_eq!(trial.ask(change).expect("an outcome").verdict, Verdict::Same, "{lens}: {}", change.name);
            }
        });
    }
}

/// Densities of media are placed in the world, and those of groups by the instances; coefficients are per metre.
#[test]
fn densities_change_with_the_scene() {
    let json = r#"{ "pt": 1, "camera": { "look_at": { "from": [0, 1, 5], "to": [0, 0.5, 0] } }, "film": { "width": 24, "height": 16 },
      "background": { "radiance": 0.5 }, "lights": [{ "type": "point", "position": [1, 4, 2], "intensity": 40 }],
      "media": { "smoke": { "type": "heterogeneous", "scattering": 6, "density": { "type": "grid", "size": [2, 2, 1], "values": [2, 0, 1, 0.5],
        "bounds": { "low": [-0.5, 0, -0.5], "high": [0.5, 1, 0.5] } }, "albedo_grid": { "size": [1, 2, 1], "values": [1, [1, 0.6, 0.2]] } } },
      "groups": { "puff": [{ "type": "box", "size": 1, "center": [0, 0.5, 0], "medium": "smoke" }] },
      "shapes": [{ "type": "box", "size": 1, "center": [0, 0.5, 0], "medium": "smoke" },
        { "type": "instances", "group": "puff", "placements": [{ "transform": [{ "scale": 0.7 }, { "translate": [-1.2, 0.1, 0] }] },
          { "transform": [{ "rotate": { "axis": [1, 2, 3], "degrees": 70 } }, { "translate": [1.3, 0.2, 0] }] }] }] }"#;
    trial(json, [24, 16], 4, "nee", |trial| {
        for change in
            trial.changes().iter().filter(|change| ["1e-2", "2^7", "turned", "mirrored"].iter().any(|word| change.name.contains(word)))
        {
            assert_eq!(trial.ask(change).expect("an outcome").verdict, Verdict::Same, "{}", change.name);
        }
    });
}

/// The greatest distance of `ao` is a length too.
#[test]
fn options_of_integrators_change_with_the_scene() {
    let json = LENGTHS.replace(r#""type": "nee", "max_depth": 6"#, r#""type": "ao", "max_distance": 0.7"#);
    trial(&json, [48, 32], 4, "ao", |trial| {
        for change in trial.changes().iter().filter(|change| change.name.contains("1e-2") || change.name.contains("turned")) {
            assert_eq!(trial.ask(change).expect("an outcome").verdict, Verdict::Same, "{}", change.name);
        }
    });
}

/// A ball in front of the camera is no change that keeps the picture: the tile where it stands is named.
#[test]
fn an_object_in_view_is_noticed_with_its_place() {
    trial(LENGTHS, [48, 32], 4, "nee", |trial| {
        let edit = Edit::FarObject { center: DVec3::new(0.0, 1.5, 3.0), radius: 0.1 };
        let change = Change { name: "a ball".into(), range: None, keeps_bits: false, edit };
        let outcome = trial.ask(&change).expect("an outcome");
        let found = outcome.found.as_ref().expect("a picture");
        assert!(found.pictures.tiles > 0 && found.shown.contains(&"far object".to_owned()), "{:?} {:?}", found.pictures, found.shown);
        // The ball is seen near the middle of the picture.
        let middle = found.pictures.at + UVec2::splat(4);
        assert!((16..32).contains(&middle.x) && (8..24).contains(&middle.y), "{middle}");
        let Verdict::Differs(said) = &outcome.verdict else { panic!("{:?}", outcome.verdict) };
        assert!(said[0].contains("far object") && said[0].contains("% darker"), "{said:?}");
        let text = sentence("room", &[outcome]);
        assert_eq!(text, "It is not safe when a ball.");
    });
}

/// Bits count where they must stay.
#[test]
fn other_bits_are_noticed() {
    trial(LENGTHS, [48, 32], 4, "nee", |trial| {
        let place = Similarity { scale: 1.0, turn: DMat3::from_rotation_y(0.2), shift: DVec3::ZERO };
        let same = trial.ask(&Change { name: "turned".into(), range: None, keeps_bits: false, edit: Edit::Place(place) });
        assert_eq!(same.expect("an outcome").verdict, Verdict::Same);
        let bits = trial.ask(&Change { name: "turned".into(), range: None, keeps_bits: true, edit: Edit::Place(place) });
        let Verdict::Differs(said) = bits.expect("an outcome").verdict else { panic!("other bits are no difference") };
        assert_eq!(said, ["the picture does not have the same bits"]);
    });
}

/// A scene that pt refuses when it is changed is said to be refused, and is no error.
#[test]
fn a_refusal_is_told() {
    trial(LENGTHS, [8, 8], 1, "nee", |trial| {
        let place = Similarity { scale: 1e25, ..Similarity::IDENTITY };
        let outcome = trial.ask(&Change { name: "huge".into(), range: None, keeps_bits: false, edit: Edit::Place(place) });
        let Verdict::Refused(reason) = outcome.expect("an outcome").verdict else { panic!("not refused") };
        assert!(!reason.is_empty());
    });
}

fn pt(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pt")).args(arguments).env_remove("PT_THREADS").output().expect("pt runs")
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text")
}

/// The Cornell box is safe in all ways, the page shows each change, and lines fit 80 columns.
#[test]
fn the_cornell_box_is_safe() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("stress.html");
    let output = pt(&["stress", "scenes/cornell-box.json", "--size", "24x24", "--spp", "16", "-o", page.to_str().expect("a name")]);
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let safe = "cornell-box is safe from 1e-6 to 1e6 times its size, up to 1e7 diameters from the origin, and with objects up to 1e6 \
                diameters away.";
    assert!(words.contains(safe), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let html = std::fs::read_to_string(&page).expect("a page");
    let changes = text.lines().filter(|line| line.starts_with("  same ")).count();
    assert!(changes > 30 && html.matches("<section class=\"change same\">").count() == changes, "{changes}");
    assert!(!html.contains("{{"));
}

/// The written scene is one that pt reads, and renders to the same picture.
#[test]
fn a_changed_scene_can_be_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let changed = folder.path().join("changed.json");
    let name = changed.to_str().expect("a name");
    let output = pt(&["stress", "scenes/cornell-box.json", "--only", "size x 2^7", "--write", name]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let hash = |scene: &str| {
        let picture = folder.path().join("picture.pfm");
        let args = [scene, "--size", "16x16", "--spp", "2", "-q", "-o", picture.to_str().expect("a name")];
        assert_eq!(pt(&args).status.code(), Some(0));
        std::fs::read(&picture).expect("a picture")
    };
    assert_eq!(hash("scenes/cornell-box.json"), hash(name));
}

#[test]
fn mistakes_of_the_command_line() {
    let wrong = |arguments: &[&str], said: &str| {
        let output = pt(&[&["stress", "scenes/cornell-box.json"], arguments].concat());
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(said), "{error}");
    };
    wrong(&["--only", "colour"], "no such change, expected a part of: as it is; size x 1e-6;");
    wrong(&["-o", "page.pdf"], "page.pdf: expected a name that ends in .html");
    wrong(&["--only", "size", "--write", "x.json"], "expected one: size x 1e-6;");
}
