//! `pt check --measure`: shares of light and changes by leaving effects out, compared with formulas, and the coverage of their intervals.

use std::time::Duration;

use assert_cmd::Command;
use pt::import::{ImportOptions, import_bytes};
use pt::integrators::ALL;
use pt::load::{Loaded, load};
use pt::measure::Interval;
use pt::measure::effects::{EffectFigures, EffectReport, Extent, Plan, measure_effects};
use pt::measure::sidak;
use pt::render::Silent;
use serde_json::{Value, json};
use statrs::distribution::{Binomial, DiscreteCDF};

const PLAN: Plan = Plan { pixels: 144, samples: 1, replicates: 12, time: None };

fn loaded(scene: &Value, integrator: Option<&str>) -> Loaded {
    let text = scene.to_string();
    let imported = import_bytes(text.clone().into_bytes(), "s.json".as_ref(), &ImportOptions::default(), |_, _| Ok(()));
    let loaded = imported.and_then(|imported| load(imported, integrator, &[ALL]));
    loaded.unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn measured(scene: &Value, plan: Plan) -> EffectReport {
    let report = measure_effects(&loaded(scene, None), &[ALL], Extent::Plan(plan), &Silent);
    report.unwrap_or_else(|error| panic!("{error}")).expect("nobody interrupts")
}

fn row<'r>(report: &'r EffectReport, name: &str) -> &'r EffectFigures {
    report.rows.iter().find(|row| row.name == name).unwrap_or_else(|| panic!("no {name}: {report:?}"))
}

fn stated(figure: Option<pt::measure::effects::Figure>) -> Interval {
    figure.expect("a figure").expect("a figure that can be stated")
}

/// A scene with the camera at the origin, and more keys.
fn scene(more: Value) -> Value {
    let mut scene = json!({
        "pt": 1, "camera": { "look_at": { "from": [0, 0, 0], "to": [0, 0, -1] } }, "film": { "width": 12, "height": 12 },
        "sampler": { "type": "independent", "spp": 16 }
    });
    scene.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
    scene
}

/// Inside of a ball that emits 1 and reflects the share ρ: the light of depth k is ρᵏ of 1/(1 − ρ).
fn furnace(albedo: f64, seed: u64) -> Value {
    scene(json!({
        "sampler": { "type": "independent", "spp": 16, "seed": seed },
        "shapes": [{ "type": "sphere", "radius": 2, "center": [0.3, 0.2, -0.5], "material": { "type": "diffuse", "albedo": albedo },
            "emission": { "radiance": 1, "two_sided": true } }]
    }))
}

/// The intervals of 100 measurements hold the shares of a furnace as often as they say, and no rarer than chance allows: six kinds of figures
/// have a false alarm of 1 % together. ε adds a hundredth of m² to the squares, so that the picture changes by ρ²/√1.01.
#[test]
fn intervals_hold_the_shares_of_a_furnace() {
    const MEASUREMENTS: u64 = 100;
    let albedo: f64 = 0.5;
    let indirect = albedo * albedo;
    let truths = [1.0 - albedo, albedo * (1.0 - albedo), indirect, indirect, -indirect, indirect / 1.01f64.sqrt()];
    let mut misses = [0u64; 6];
    for seed in 0..MEASUREMENTS {
        let report = measured(&furnace(albedo, 1000 * seed), PLAN);
        let light = |name: &str| stated(row(&report, name).light);
        let absent = row(&report, "indirect light");
        let parts = [light("light seen at its source"), light("direct light"), light("indirect light")];
        let others = [light("diffuse interreflection"), stated(absent.mean), stated(absent.picture)];
        // f32 pictures are rounded, and the shares add up to 1 but for that.
        assert!((parts.iter().map(|part| part.value).sum::<f64>() - 1.0).abs() < 1e-6, "{parts:?}");
        for ((misses, truth), found) in misses.iter_mut().zip(truths).zip(parts.iter().chain(&others)) {
            *misses += u64::from(truth < found.low || truth > found.high);
        }
        assert!((light("area lights").value - 1.0).abs() < 1e-6, "all light is that of the ball");
    }
    let allowed = Binomial::new(0.05, MEASUREMENTS).expect("a distribution").inverse_cdf(1.0 - sidak(0.01, misses.len()));
    assert!(misses.iter().all(|misses| *misses <= allowed), "{misses:?} of {MEASUREMENTS}, allowed {allowed}");
}

/// A lens makes no difference where light is the same everywhere: the interval of the change of the picture reaches to 0, and that of the mean
/// holds 0. Without an aperture there is nothing to leave out.
#[test]
fn a_lens_changes_nothing_in_a_furnace() {
    let mut scene = furnace(0.5, 3);
    scene["camera"]["focus_distance"] = 1.5.into();
    scene["camera"]["lens_radius"] = 0.1.into();
    let report = measured(&scene, PLAN);
    let lens = row(&report, "depth of field");
    let (picture, mean) = (stated(lens.picture), stated(lens.mean));
    // Twice the half width of the intervals: with 5 degrees of freedom chance exceeds it in 4 of 1000 cases, and there is one seed.
    let square = |x: f64| x * x;
    assert!(mean.value.abs() < 2.0 * (mean.high - mean.value), "{lens:?}");
    assert!(square(picture.value) < 2.0 * (square(picture.high) - square(picture.value)), "{lens:?}");
    assert!(lens.light.is_none() && lens.time.is_some() && lens.price.is_some(), "{lens:?}");
    scene["camera"]["lens_radius"] = 0.into();
    assert!(measured(&scene, PLAN).rows.iter().all(|row| row.name != "depth of field"));
}

/// Light of a lamp straight ahead passes 0.7 m of a medium that absorbs σ = 0.5/m: without it the picture is brighter by e^0.35 everywhere.
#[test]
fn without_a_medium_nothing_is_absorbed() {
    let report = measured(
        &scene(json!({
            "camera": { "type": "orthographic", "height": 1, "look_at": { "from": [0, 0, 0], "to": [0, 0, -1] } },
            "medium": { "type": "homogeneous", "absorption": 0.5 },
            "shapes": [{ "type": "quad", "size": 2, "emission": 3, "material": { "type": "diffuse", "albedo": 0 },
                "transform": [{ "translate": [0, 0, -0.7] }] }]
        })),
        PLAN,
    );
    let media = row(&report, "participating media");
    let more = 0.35f64.exp() - 1.0;
    let close = |figure: Interval, truth: f64| (figure.value - truth).abs() < 1e-5 && figure.high - figure.low < 1e-5;
    assert!(close(stated(media.mean), more) && close(stated(media.picture), more / 1.01f64.sqrt()), "{media:?}");
    assert!(close(stated(media.light), 0.0), "no path is scattered: {media:?}");
}

/// A floor under a lamp in a ball of glass: all light passes the glass, on a way that no sample of the lamp finds.
#[test]
fn light_through_glass_is_a_caustic() {
    let report = measured(
        &scene(json!({
            "camera": { "look_at": { "from": [0, 1, 0], "to": [0, 0, 0], "up": [0, 0, 1] } },
            "shapes": [
                { "type": "quad", "size": 4, "material": { "type": "diffuse" }, "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }] },
                { "type": "sphere", "radius": 1, "center": [0, 3, 0], "material": { "type": "thin_dielectric" } },
                { "type": "sphere", "radius": 0.8, "center": [0, 3, 0], "material": { "type": "diffuse", "albedo": 0 }, "emission": 3 }
            ]
        })),
        Plan { samples: 4, ..PLAN },
    );
    let light = |name: &str| stated(row(&report, name).light).value;
    assert!(["caustics", "refraction in clear glass", "indirect light"].iter().all(|name| (light(name) - 1.0).abs() < 1e-6), "{report:?}");
    let others = ["direct light", "light seen at its source"];
    assert!(report.rows.iter().all(|row| !others.contains(&row.name.as_str())), "no light, no row: {report:?}");
}

/// A wall of one material and a floor of another under a lamp and a sky, and more shapes.
fn corner(wall: Value, more: Vec<Value>) -> Value {
    let mut shapes = vec![
        json!({ "type": "quad", "size": 6, "material": "wall", "transform": [{ "translate": [0, 0, -3] }] }),
        json!({ "type": "quad", "size": 6, "material": { "type": "diffuse" },
            "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }, { "translate": [0, -1, 0] }] }),
        json!({ "type": "sphere", "radius": 0.4, "center": [1, 2, -1], "material": { "type": "diffuse", "albedo": 0 }, "emission": 9 }),
    ];
    shapes.extend(more);
    scene(json!({ "materials": { "wall": wall }, "shapes": shapes, "background": { "radiance": 0.5 } }))
}

/// Each change takes its effect out, and is measured.
#[test]
fn every_change_takes_its_effect_out() {
    let diffuse = json!({ "type": "diffuse" });
    let sphere = |material: Value| json!({ "type": "sphere", "radius": 0.5, "center": [0, 0, -2], "material": material });
    let checker = json!({ "type": "checker", "even": 0.8, "odd": 0.2 });
    let fan = json!({ "type": "mesh", "smooth_shadows": true, "material": "wall", "positions": [[-1, 0, -2], [1, 0, -2], [0, 1, -2]],
        "normals": [[-0.6, 0, 0.8], [0.6, 0, 0.8], [0, 0.6, 0.8]], "triangles": [[0, 1, 2]] });
    let key = |time: f64, x: f64| json!({ "time": time, "transform": [{ "translate": [x, 0, -2] }] });
    let moving =
        json!({ "type": "sphere", "radius": 0.5, "material": "wall", "transform": [{ "keyframes": [key(0.0, -0.2), key(1.0, 0.2)] }] });
    let moved = |mut scene: Value, pointer: &str, value: Value| {
        scene[pointer] = value;
        scene
    };
    let lens = json!([[50, 3, 1.5, 20], [-50, 1, 1, 20], [0, 0, 1, 18]]);
    let realistic = json!({ "type": "realistic", "lens": lens, "focus_distance": 2, "look_at": { "from": [0, 0, 2], "to": [0, 0, 0] } });
    let wire = json!({ "type": "curves", "points": [[[-0.5, 0, -2], [0.5, 0.2, -2]]], "radius": 0.2, "material": "wall" });
    let cases = [
        ("mirror reflection", corner(json!({ "type": "mirror", "color": 0.9 }), vec![])),
        ("mirror reflection", corner(json!({ "type": "conductor", "metal": "Au" }), vec![])),
        ("glossy reflection", corner(json!({ "type": "conductor", "metal": "Au", "roughness": 0.5 }), vec![])),
        ("glossy reflection", corner(json!({ "type": "phong", "color": 0.5 }), vec![])),
        ("diffuse interreflection", corner(diffuse.clone(), vec![])),
        ("indirect light", corner(json!({ "type": "plastic" }), vec![])),
        ("environment", corner(diffuse.clone(), vec![])),
        ("area lights", corner(diffuse.clone(), vec![])),
        (
            "point lights",
            moved(corner(diffuse.clone(), vec![]), "lights", json!([{ "type": "point", "position": [0, 1, 0], "intensity": 3 }])),
        ),
        ("realistic lens", moved(corner(diffuse.clone(), vec![]), "camera", realistic.clone())),
        ("depth of field", moved(corner(diffuse.clone(), vec![]), "camera", realistic)),
        (
            "depth of field",
            moved(
                corner(diffuse.clone(), vec![]),
                "camera",
                json!({ "f_number": 1, "focal_length": 50, "look_at": { "from": [0, 0, 0], "to": [0, 0, -1] } }),
            ),
        ),
        ("motion blur", corner(diffuse.clone(), vec![moving])),
        (
            "participating media",
            corner(
                diffuse.clone(),
                vec![json!({ "type": "sphere", "radius": 0.5, "center": [0, 0, -2],
            "medium": { "type": "homogeneous", "scattering": 3 } })],
            ),
        ),
        ("texture footprints", corner(json!({ "type": "diffuse", "albedo": checker }), vec![])),
        ("shading normals", corner(json!({ "type": "bumped", "surface": diffuse, "bump_map": { "type": "noise" }, "scale": 0.1 }), vec![])),
        ("smooth shadows of coarse meshes", corner(diffuse.clone(), vec![fan])),
        ("cut-outs", corner(diffuse.clone(), vec![sphere(json!({ "type": "masked", "surface": "wall", "opacity": 0.5 }))])),
        (
            "dispersion",
            corner(
                diffuse.clone(),
                vec![sphere(json!({ "type": "dielectric", "glass": "F2", "absorption": { "color": 0.9, "distance": 1 } }))],
            ),
        ),
        ("curves", corner(diffuse.clone(), vec![wire])),
        ("thin films", corner(diffuse.clone(), vec![sphere(json!({ "type": "thin_film" }))])),
        ("thin films", corner(diffuse.clone(), vec![sphere(json!({ "type": "thin_film", "pane": 1.5 }))])),
        ("thin films", corner(json!({ "type": "principled", "iridescence": 0.5 }), vec![])),
        ("thin films", corner(diffuse.clone(), vec![sphere(json!({ "type": "dielectric", "film": { "eta": 1.4, "thickness": 300 } }))])),
        ("thin films", corner(json!({ "type": "conductor", "metal": "Ti", "film": { "eta": 1.5, "thickness": 300 } }), vec![])),
    ];
    let plan = Plan { pixels: 64, samples: 2, replicates: 4, time: None };
    for (name, scene) in cases {
        let report = measured(&scene, plan);
        let found = row(&report, name);
        assert!(found.time.is_some() && found.price.is_some() && found.mean.is_some(), "{name}: {found:?}");
        // Where light is only removed, the same random numbers lose that of the recorded paths, but for rounding.
        let removes = ["mirror reflection", "glossy reflection", "diffuse interreflection", "indirect light"].contains(&name);
        if let (true, Some(Ok(light)), Some(Ok(mean))) = (removes, found.light, found.mean) {
            assert!(light.value > 0.0 && (light.value + mean.value).abs() < 1e-5, "{name}: {found:?}");
        } else {
            assert!(!removes, "{name} is not told: {found:?}");
        }
    }
}

/// Parts that every scene has come first; other rows are effects of the scene.
#[test]
fn a_scene_has_rows_for_its_own_effects_only() {
    let names = |scene: &Value| measured(scene, Plan { replicates: 4, ..PLAN }).rows.into_iter().map(|row| row.name).collect::<Vec<_>>();
    let own = ["light seen at its source", "direct light", "indirect light", "area lights", "diffuse interreflection"];
    assert_eq!(names(&furnace(0.5, 1)), own);
    let glossy = names(&corner(json!({ "type": "phong" }), vec![]));
    assert!(glossy.iter().any(|name| name == "glossy reflection") && glossy.iter().any(|name| name == "caustics"), "{glossy:?}");
}

/// A measurement takes about the time that it was given.
#[test]
fn the_time_is_kept() {
    let scene = loaded(&corner(json!({ "type": "phong" }), vec![]), None);
    let reports = (0..5).map(|_| {
        let report = measure_effects(&scene, &[ALL], Extent::Time(Duration::from_secs(1)), &Silent);
        report.unwrap_or_else(|error| panic!("{error}")).expect("nobody interrupts")
    });
    // The number of samples is planned from a first render. Other programs and tests on the same machine make either of the two slower, so
    // that one measurement of five must keep its time.
    let mut missed = vec![];
    for report in reports {
        if (0.5..1.5).contains(&report.seconds) && report.replicates >= 8 {
            return;
        }
        missed.push((report.seconds, report.replicates));
    }
    panic!("seconds and replicates: {missed:?}");
}

/// The command prints tables of 80 columns, or JSON with the same rows; integrators whose paths are no single ones from the camera are refused.
#[test]
fn check_measures_and_advises() {
    let scene = corner(json!({ "type": "mirror" }), vec![]).to_string();
    let check = |flags: &[&str]| {
        let mut command = Command::cargo_bin("pt").expect("the binary");
        let output = command.args(["check", "-"]).args(flags).write_stdin(scene.clone()).output().expect("pt runs");
        let [out, said] = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        (output.status.code(), out, said)
    };
    let (code, text, said) = check(&["--measure", "0.3s"]);
    assert_eq!(code, Some(0), "{said}");
    let (_, tables) = text.split_once("\nmeasured in ").unwrap_or_else(|| panic!("{text}"));
    assert!(tables.lines().all(|line| line.chars().count() <= 80), "{tables}");
    assert!(tables.contains("  mirror reflection ") && tables.contains("leave out") | tables.contains("left out"), "{tables}");
    let (code, text, said) = check(&["--measure", "0.3s", "--json"]);
    assert_eq!(code, Some(0), "{said}");
    let json: Value = serde_json::from_str(&text).expect("JSON");
    let names: Vec<&str> = json["effects"].as_array().expect("rows").iter().filter_map(|row| row["name"].as_str()).collect();
    assert!(names.contains(&"mirror reflection") && json["effects"][0]["light"]["low"].is_f64(), "{json}");
    for integrator in ["light", "whitted", "ao"] {
        let (code, _, said) = check(&["--measure", "0.3s", "-i", integrator]);
        assert!(code == Some(2) && said.contains("expected an integrator that follows single paths"), "{said}");
    }
    assert_eq!(check(&["--json"]).0, Some(2));
}
