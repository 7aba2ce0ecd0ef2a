//! The path tracer in double precision, an oracle of whole paths: it shares no code for cameras, intersections, scattering and the walk with
//! the renderer.

use std::path::Path;
use std::process::{Command, Output};

use pt::double::{DoublePath, PrecisionReport, difference};
use pt::import::{ImportOptions, import_with};
use pt::integrators::ALL;
use pt::load::{Loaded, load};
use serde_json::{Value, json};
use tempfile::TempDir;

/// A loaded scene, and the folder of its files, which are read again.
struct Case {
    loaded: Loaded,
    _folder: Option<TempDir>,
}

/// A scene of `scenes/` in a small picture.
fn of_file(name: &str) -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.json"));
    let values = [("/film/width", "32"), ("/film/height", "24"), ("/sampler/spp", "64"), ("/film/texture_footprint", "0")];
    let small = |root: &mut pt::reader::Node, _: &str| values.iter().try_for_each(|(pointer, value)| root.set(pointer, value));
    let imported = import_with(&path, &ImportOptions::default(), small);
    let loaded = imported.and_then(|imported| load(imported, Some("path"), &[ALL])).unwrap_or_else(|error| panic!("{name}: {error}"));
    Case { loaded, _folder: None }
}

/// A mesh of two parts, each of a material of its own.
const PAIR: &str = "v -0.6 0.1 0\nv 0 0.1 0.3\nv -0.2 1 0\nv 0.6 0.1 0\nv 0.3 1 0.2\nusemtl left\nf 1 2 3\nusemtl right\nf 2 4 5\n";

/// A scene described here, in a file of a new folder.
fn of_json(scene: &Value) -> Case {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.json");
    std::fs::write(&path, scene.to_string()).expect("written");
    std::fs::write(folder.path().join("pair.obj"), PAIR).expect("written");
    let imported = import_with(&path, &ImportOptions::default(), |_, _| Ok(()));
    let loaded = imported.and_then(|imported| load(imported, Some("path"), &[ALL])).unwrap_or_else(|error| panic!("{error}: {scene}"));
    Case { loaded, _folder: Some(folder) }
}

fn measured(loaded: &Loaded) -> PrecisionReport {
    difference(loaded, &|| false).unwrap_or_else(|error| panic!("{}: {error}", loaded.file)).expect("not cancelled")
}

/// A floor, a white sky, and one thing on the floor, in the picture of a camera.
fn scene(camera: Value, thing: Value) -> Value {
    json!({
        "pt": 1, "camera": camera, "film": {"width": 24, "height": 18}, "sampler": {"type": "sobol", "spp": 64},
        "background": {"radiance": [0.8, 0.9, 1.0]},
        "shapes": [
            {"type": "quad", "size": 6, "material": {"type": "diffuse", "albedo": [0.6, 0.5, 0.4]},
             "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}}]},
            {"type": "sphere", "radius": 0.3, "center": [-1.2, 1.1, 0.4], "emission": [6, 4, 2], "material": {"type": "diffuse", "albedo": 0}},
            thing
        ]
    })
}

fn looking() -> Value {
    json!({"look_at": {"from": [0.3, 1.6, 4.1], "to": [0, 0.5, 0]}, "fov": 35})
}

/// Scenes with every camera, shape and material that double precision knows.
fn known() -> Vec<(&'static str, Case)> {
    let ball = |material: Value| json!({"type": "sphere", "radius": 0.6, "center": [0.1, 0.61, 0], "material": material});
    let cube = |material: Value| {
        json!({"type": "box", "size": [0.9, 0.8, 0.7], "center": [0, 0.41, 0], "material": material,
               "transform": [{"rotate": {"axis": [0, 1, 0], "degrees": 33}}]})
    };
    let gray = || ball(json!({"type": "diffuse", "albedo": 0.7}));
    let with = |more: Value| {
        let mut camera = looking();
        camera.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        camera
    };
    let prism = json!({"type": "mesh", "positions": [[-0.5, 0.01, -0.4], [0.5, 0.01, -0.4], [0, 0.01, 0.5], [0, 0.9, 0]],
                       "triangles": [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]});
    let mut rounded = prism.clone();
    rounded["normals"] = json!([[-0.7, -0.3, -0.6], [0.7, -0.3, -0.6], [0, -0.3, 0.9], [0, 1, 0]]);
    rounded["transform"] = json!([{"scale": [-1, 1, 1]}]);
    let group = json!({"type": "group", "transform": [{"translate": [0.2, 0, 0.3]}, {"scale": 1.2}], "shapes": [
        {"type": "disk", "radius": 0.5, "transform": [{"rotate": {"axis": [1, 1, 0], "degrees": 70}}, {"translate": [0, 0.7, 0]}]},
        {"type": "sphere", "radius": 0.3, "transform": [{"scale": [1, 2, 0.5]}, {"translate": [-0.6, 0.7, 0]}]}]});
    let mut all: Vec<(&str, Case)> = ["cornell-box", "statue", "caustic", "mirror-balls", "glass-panel", "pawns"]
        .map(|name| (name, of_file(name)))
        .into_iter()
        .collect();
    let described = [
        ("matte ball", looking(), gray()),
        ("mirror", looking(), ball(json!({"type": "mirror", "color": [0.9, 0.8, 0.7]}))),
        ("gold", looking(), cube(json!({"type": "conductor", "metal": "Au"}))),
        ("metal by its index", looking(), ball(json!({"type": "conductor", "eta": [0.2, 1, 2], "k": [3, 2, 1]}))),
        ("metal by its colour", looking(), ball(json!({"type": "conductor", "color": [0.9, 0.6, 0.3]}))),
        ("glass", looking(), ball(json!({"type": "dielectric", "eta": 1.5}))),
        (
            "coloured glass",
            looking(),
            cube(json!({"type": "dielectric", "eta": 1.7, "color": [1, 0.9, 0.8],
            "absorption": {"color": [0.2, 0.5, 0.9], "distance": 0.5}})),
        ),
        ("thin pane", looking(), cube(json!({"type": "thin_dielectric", "eta": 1.4, "color": 0.9}))),
        (
            "glass that absorbs all red",
            looking(),
            cube(json!({"type": "dielectric", "absorption": {"color": [0, 0.5, 0.9], "distance": 0.5}})),
        ),
        ("constant texture", looking(), ball(json!({"type": "diffuse", "albedo": {"type": "constant", "color": [0.2, 0.6, 0.4]}}))),
        (
            "lamp of two sides",
            looking(),
            json!({"type": "quad", "emission": {"radiance": [1, 2, 3], "two_sided": true},
            "transform": [{"rotate": {"axis": [0, 1, 0], "degrees": 150}}, {"translate": [0.2, 0.8, 0]}]}),
        ),
        (
            "parts of a mesh",
            looking(),
            json!({"type": "mesh", "file": "pair.obj", "material": {"type": "mirror"},
            "materials": {"left": {"type": "diffuse", "albedo": [0.9, 0.2, 0.1]}}}),
        ),
        (
            "turned camera",
            json!({"transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -15}}, {"scale": 2}, {"translate": [0.2, 1.7, 4]}]}),
            gray(),
        ),
        ("mesh", looking(), prism),
        ("mesh with normals, mirrored", looking(), rounded),
        ("group", looking(), group),
        ("thin lens", with(json!({"lens_radius": 0.2, "focus_distance": 3.5, "tilt": [20, -10]})), gray()),
        ("shifted view", with(json!({"shift": [0.2, -0.1], "horizontal_fov": 50})), gray()),
        (
            "focal length",
            json!({"look_at": {"from": [0.3, 1.6, 4.1], "to": [0, 0.5, 0]}, "focal_length": 35, "f_number": 1.4, "focus_distance": 3}),
            gray(),
        ),
        ("parallel view", json!({"type": "orthographic", "height": 3, "look_at": {"from": [0.3, 1.6, 4.1], "to": [0, 0.5, 0]}}), gray()),
    ];
    all.extend(described.map(|(name, camera, thing)| (name, of_json(&scene(camera, thing)))));
    let mut cropped = scene(looking(), ball(json!({"type": "dielectric"})));
    cropped["film"] = json!({"width": 40, "height": 30, "crop": [5, 30, 3, 20], "filter": {"type": "mitchell"}});
    all.push(("crop and a filter with negative weights", of_json(&cropped)));
    all
}

/// Single precision rounds each number of a path to 6·10⁻⁸ of itself, and a path has some hundred of them. Where a path meets an edge within
/// its rounding it goes another way, which less than one in ten thousand does in `scenes/`. The light of both ways is the same on average, so
/// that the brightness agrees within the noise of those few. What rounding does to a picture is far below its noise.
///
/// The bounds: three times as many paths that part as in `scenes/`; for the light of the others a hundred times the rounding of a path, because
/// curved mirrors magnify the error of a direction; for the brightness four standard errors, and the rounding of the scene's own numbers.
#[test]
fn pictures_in_double_precision_differ_by_rounding_alone() {
    for (name, case) in known() {
        let report = measured(&case.loaded);
        let parted = report.parted as f64 / report.paths as f64;
        assert!(parted < 3e-4, "{name}: {parted} of the paths went another way");
        assert!(report.same_way < 1e-4, "{name}: light differs by {}", report.same_way);
        let noise = report.noise.expect("several samples");
        assert!(report.picture < 0.1 * noise + 1e-6, "{name}: {} beside a noise of {noise}", report.picture);
        assert_eq!(report.invalid, [0, 0], "{name}");
        assert!(report.brightness_error < 1e-3, "{name}: {}", report.brightness_error);
        assert!(
            report.brightness.abs() < 4.0 * report.brightness_error + 1e-6,
            "{name}: {} ± {}",
            report.brightness,
            report.brightness_error
        );
    }
}

/// A mistake of a thousandth is seen, for each part of a path: the albedo, the index of refraction, the place of a lamp, the view.
#[test]
fn double_precision_notices_a_thousandth() {
    let glass = json!({"type": "sphere", "radius": 0.6, "center": [0.1, 0.61, 0], "material": {"type": "dielectric", "eta": 1.5}});
    let original = scene(looking(), glass);
    let changes = [
        ("/shapes/0/material/albedo", json!([0.6006, 0.5005, 0.4004])),
        ("/shapes/2/material/eta", json!(1.5015)),
        ("/shapes/1/radius", json!(0.3003)),
        ("/camera/fov", json!(35.035)),
    ];
    for (pointer, value) in changes {
        let mut changed = original.clone();
        *changed.pointer_mut(pointer).expect("a key") = value;
        // The world of one scene with the description of the other.
        let loaded = Loaded { description: of_json(&changed).loaded.description, ..of_json(&original).loaded };
        let (wrong, right) = (measured(&loaded), measured(&of_json(&original).loaded));
        assert!(wrong.picture > 20.0 * right.picture, "{pointer}: {} and {}", wrong.picture, right.picture);
    }
}

/// What is not known is refused, with its place.
#[test]
fn double_precision_refuses_what_it_does_not_know() {
    let ball = |material: Value| json!({"type": "sphere", "material": material});
    let cases = [
        ("/shapes/2/material", "rough materials", ball(json!({"type": "conductor", "metal": "Au", "roughness": 0.3}))),
        ("/shapes/2/material", "textures that are averaged", ball(json!({"type": "diffuse", "albedo": {"type": "checker", "scale": 4}}))),
        ("/shapes/2/material", "textures other than checkerboards", ball(json!({"type": "diffuse", "albedo": {"type": "noise"}}))),
        ("/shapes/2/material", "materials of the type plastic", ball(json!({"type": "plastic"}))),
        ("/shapes/2/material", "materials with dispersion", ball(json!({"type": "dielectric", "abbe": 30}))),
        (
            "/shapes/2/material",
            "textures on other shapes",
            json!({"type": "mesh", "file": "pair.obj",
            "materials": {"left": {"type": "diffuse", "albedo": {"type": "checker"}}}}),
        ),
        ("/shapes/2/emission", "textures", json!({"type": "quad", "emission": {"radiance": 1, "texture": {"type": "checker"}}})),
        ("/shapes/2", "meshes with subdivision", json!({"type": "mesh", "file": "pair.obj", "subdivision_levels": 1})),
        ("/shapes/2", "shapes of the type cylinder", json!({"type": "cylinder"})),
        ("/shapes/2", "parts of spheres", json!({"type": "sphere", "phi_max": 90})),
    ];
    for (pointer, what, thing) in cases {
        let mut scene = scene(looking(), thing);
        scene["film"]["texture_footprint"] = json!(if what.contains("averaged") { 1 } else { 0 });
        let case = of_json(&scene);
        let said = DoublePath::new(&case.loaded).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(said.contains(pointer) && said.contains(what) && said.lines().count() == 1, "{said}");
    }
    let mut lit = scene(looking(), ball(json!({"type": "mirror"})));
    lit["lights"] = json!([{"type": "point", "position": [0, 3, 0], "intensity": 1}]);
    assert!(DoublePath::new(&of_json(&lit).loaded).is_err_and(|error| error.to_string().contains("lights without a surface")));
    lit["lights"] = json!([]);
    lit["background"] = json!({"sky": {}});
    assert!(DoublePath::new(&of_json(&lit).loaded).is_err_and(|error| error.to_string().contains("/background")));
}

fn pt(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pt")).current_dir(folder).args(args).output().expect("pt runs")
}

/// A black picture has no differences, and another integrator is refused.
#[test]
fn black_pictures_have_no_differences_and_other_integrators_are_refused() {
    let mut black = scene(looking(), json!({"type": "sphere"}));
    black["background"] = json!({"radiance": 0});
    black["shapes"][1]["emission"] = json!(0);
    let report = measured(&of_json(&black).loaded);
    assert_eq!((report.picture, report.noise, report.brightness, report.brightness_error), (0.0, Some(0.0), 0.0, 0.0));
    let mut loaded = of_json(&black).loaded;
    (loaded.entry, loaded.integrator) = loaded.choose(&[ALL], "nee").expect("an integrator");
    assert!(difference(&loaded, &|| false).is_err_and(|error| error.to_string().contains("expected the integrator path")));
}

/// The command prints lines for people or an object, and writes the picture in double precision.
#[test]
fn the_command_tells_what_rounding_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let ball = json!({"type": "sphere", "radius": 0.6, "center": [0.1, 0.61, 0], "material": {"type": "mirror"}});
    std::fs::write(folder.path().join("s.json"), scene(looking(), ball).to_string()).expect("written");
    let args = ["precision", "s.json", "--spp", "16", "--size", "16x12", "-o", "double.exr"];
    let output = pt(folder.path(), &args);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{output:?}");
    assert_eq!(said.lines().count(), 5, "{said}");
    assert!(said.lines().all(|line| line.chars().count() <= 110), "{said}");
    assert!(folder.path().join("double.exr").exists());
    let json: Value = serde_json::from_slice(&pt(folder.path(), &[&args[..6], &["--json"]].concat()).stdout).expect("JSON");
    assert_eq!(json["paths"], 16 * 16 * 12);
    // The picture is the one of the renderer but for rounding, which may turn a path in a few of the 192 pixels.
    assert!(pt(folder.path(), &["s.json", "-i", "path", "--spp", "16", "--size", "16x12", "-o", "single.exr", "-q"]).status.success());
    let both = ["single.exr", "double.exr"].map(|name| pt::output::read(&folder.path().join(name)).expect("a picture").0);
    let values = both.each_ref().map(|image| image.channel("G").expect("a channel").to_vec());
    let apart = values[0].iter().zip(&values[1]).filter(|(a, b)| (*a - *b).abs() > 1e-3 * **b).count();
    assert!(apart <= 4, "{apart} pixels");
}

/// Double precision is one more method of a comparison, if `path` is among the methods.
#[test]
fn double_precision_is_a_method_of_comparisons() {
    let folder = tempfile::tempdir().expect("a folder");
    let ball = json!({"type": "sphere", "radius": 0.6, "center": [0.1, 0.61, 0], "material": {"type": "mirror"}});
    std::fs::write(folder.path().join("s.json"), scene(looking(), ball).to_string()).expect("written");
    let common =
        ["compare", "s.json", "--precision", "f32,f64", "--size", "16x12", "--spp", "16", "--replicates", "2", "--reference-time", "200ms"];
    let output = pt(folder.path(), &[&common[..], &["--integrators", "path", "-o", "report"]].concat());
    assert!(output.status.success(), "{output:?}");
    let text = std::fs::read_to_string(folder.path().join("report/convergence.json")).expect("a report");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    let methods = report["methods"].as_array().expect("methods");
    let names: Vec<&str> = methods.iter().filter_map(|method| method["name"].as_str()).collect();
    assert_eq!(names, ["path", "path (f64)"]);
    // Both methods have the same seeds and follow the same paths, so that their errors are nearly equal.
    let errors = methods.iter().map(|method| method["measurements"][0]["relmse"].as_f64().expect("an error")).collect::<Vec<f64>>();
    assert!((errors[0] / errors[1] - 1.0).abs() < 1e-3, "{errors:?}");
    let refused = pt(folder.path(), &[&common[..], &["--integrators", "nee"]].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("only the integrator path has it"));
    let alone = ["compare", "s.json", "--precision", "f64", "--integrators", "path,nee"];
    assert_eq!(pt(folder.path(), &alone).status.code(), Some(2));
}
