//! `pt meter`: irradiance, radiance and their photometric forms agree with formulas, and the stated intervals hold them.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;

use assert_cmd::Command;
use glam::Vec3;
use pt::build::Source;
use pt::describe::{self, Files};
use pt::film::FilmSpec;
use pt::integrator::{Estimator, choose};
use pt::integrators::ALL;
use pt::measure::meter::{Meter, Quantity, Reading, Response, measure};
use pt::sampler::SamplerSpec;
use pt::scene::Scene;
use serde_json::{Value, json};

fn built(scene: &Value) -> (Arc<dyn Scene>, FilmSpec) {
    let text = scene.to_string();
    let root = describe::root(text.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").unwrap_or_else(|e| panic!("{e}: {text}"));
    let source = Source { root: &root, file: "s.json", files: &Files::within("") };
    let built = pt::build::build(&described, source).unwrap_or_else(|e| panic!("{e}: {text}"));
    (Arc::new(built.world), built.film)
}

/// A scene with these shapes and lights, seen from nowhere.
fn scene(more: Value) -> Value {
    let mut scene = json!({"pt": 1, "camera": {"look_at": {"from": [0, 0, 0], "to": [0, 0, 1]}}, "film": {"width": 1, "height": 1}});
    scene.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
    scene
}

/// An integrator that follows paths to their end, for a scene.
fn estimator(scene: &Arc<dyn Scene>, film: &FilmSpec, name: &str) -> Box<dyn Estimator> {
    let settings = describe::root(br#"{"max_depth": 1000}"#, "i").expect("JSON");
    let (_, integrator) = choose(&[ALL], Some(&settings), Some(name), "i").unwrap_or_else(|e| panic!("{e}"));
    integrator.prepare(scene.clone(), film)
}

/// A reading after so many samples.
fn reading(scene: &Value, integrator: &str, meter: &Meter, seed: u64, samples: u64) -> Reading {
    let (scene, film) = built(scene);
    let estimator = estimator(&scene, &film, integrator);
    let origin = scene.origin().as_vec3();
    let meter = Meter { position: meter.position - origin, ..*meter };
    let sampler = SamplerSpec { seed, ..SamplerSpec::default() };
    measure(&*scene, &*estimator, &meter, (sampler, 0), &|| false, |reading| match reading.samples >= samples {
        true => ControlFlow::Break(reading.clone()),
        false => ControlFlow::Continue(()),
    })
}

/// A meter at the origin that faces up.
fn facing_up(radius: f32) -> Meter {
    Meter { position: Vec3::ZERO, quantity: Quantity::Irradiance { normal: Vec3::Y, radius }, response: Response::Radiometric }
}

/// A quad or disk lamp at a height, facing down.
fn overhead(mut lamp: Value, height: f64) -> Value {
    lamp["transform"] = json!([{"rotate": {"axis": [1, 0, 0], "degrees": 90}}, {"translate": [0, height, 0]}]);
    scene(json!({"shapes": [lamp]}))
}

/// Checks a reading against a formula, within 4.5 standard errors and the rounding of f32. With 31 degrees of freedom a right reading fails
/// in fewer than 1 of 10⁴ cases.
fn agrees(scene: &Value, integrator: &str, meter: &Meter, truth: f64) {
    let reading = reading(scene, integrator, meter, 7, 1 << 14);
    let mean = reading.values[3];
    assert_eq!(reading.invalid, 0);
    let off = (mean.value - truth).abs();
    // Positions, directions and radiances are f32: ten roundings.
    let rounding = 10.0 * f64::from(f32::EPSILON) * truth;
    assert!(
        off <= 4.5 * mean.standard_error() + rounding,
        "{integrator}: {} ± {}, not {truth}: {scene}",
        mean.value,
        mean.standard_error()
    );
    assert!(mean.standard_error() < 0.02 * truth, "{integrator}: too noisy to show anything: {scene}");
}

/// Lamps of each kind, above a meter, by formula.
#[test]
fn irradiance_is_that_of_the_formula() {
    let up = facing_up(0.0);
    let (l, r, h): (f64, f64, f64) = (3.0, 0.5, 2.0);
    let sphere = scene(json!({"shapes": [{"type": "sphere", "radius": r, "center": [0, h, 0], "emission": {"radiance": l}}]}));
    let disk = overhead(json!({"type": "disk", "radius": r, "emission": {"radiance": l}}), h);
    // A square of side s overhead: 4·(2/π)·x/√(1 + x²)·atan(x/√(1 + x²)) of π L, x = s/2h, by Lambert's formula for its four corners.
    let x: f64 = 1.0 / (2.0 * h);
    let square = overhead(json!({"type": "quad", "size": 1, "emission": {"radiance": l}}), h);
    let of_square = PI * l * (4.0 / (2.0 * PI)) * 2.0 * (x / (1.0 + x * x).sqrt()) * (x / (1.0 + x * x).sqrt()).atan();
    let sky = scene(json!({"background": {"radiance": l}}));
    for integrator in ["nee", "path"] {
        agrees(&sphere, integrator, &up, PI * l * r * r / (h * h));
        agrees(&disk, integrator, &up, PI * l * r * r / (r * r + h * h));
        agrees(&square, integrator, &up, of_square);
        agrees(&sky, integrator, &up, PI * l);
    }
    let point = scene(json!({"lights": [{"type": "point", "position": [1, 2, 0], "intensity": l}]}));
    agrees(&point, "nee", &up, l * 2.0 / 5f64.powf(1.5));
    let sun = scene(json!({"lights": [{"type": "directional", "direction": [0.6, -0.8, 0], "irradiance": l}]}));
    agrees(&sun, "nee", &up, 0.8 * l);
    let below = scene(json!({"lights": [{"type": "point", "position": [1, -2, 0], "intensity": l}]}));
    assert_eq!(reading(&below, "nee", &up, 7, 1024).values[3].value, 0.0);
}

/// The mean over a disk under a point light: 2 I/r² (1 − h/√(h² + r²)).
#[test]
fn irradiance_over_a_disk_is_the_mean() {
    let (i, h, r): (f64, f64, f64) = (5.0, 1.5, 2.0);
    let point = scene(json!({"lights": [{"type": "point", "position": [0, h, 0], "intensity": i}]}));
    agrees(&point, "nee", &facing_up(r as f32), 2.0 * i / (r * r) * (1.0 - h / h.hypot(r)));
}

/// In a closed sphere of albedo ρ that emits L everywhere the radiance is L/(1 − ρ) from everywhere, at each point and on the wall.
#[test]
fn interreflection_is_counted() {
    let (l, rho) = (0.5, 0.75);
    let ball = json!({"type": "sphere", "radius": 2, "material": {"type": "diffuse", "albedo": rho},
        "emission": {"radiance": l, "two_sided": true}});
    let closed = scene(json!({"shapes": [ball]}));
    for integrator in ["nee", "path"] {
        for position in [Vec3::ZERO, Vec3::new(0.3, -1.1, 0.4), Vec3::new(0.0, -2.0, 0.0)] {
            agrees(&closed, integrator, &Meter { position, ..facing_up(0.0) }, PI * l / (1.0 - rho));
        }
        let looking = Quantity::Radiance { direction: Vec3::new(0.6, 0.0, 0.8), one_minus_cos: 0.0 };
        agrees(&closed, integrator, &Meter { quantity: looking, ..facing_up(0.0) }, l / (1.0 - rho));
    }
}

/// E₃(x) = ∫₁^∞ e^(−x t) t⁻³ dt = ∫₀¹ e^(−x/μ) μ dμ, by the midpoint rule.
fn e3(x: f64) -> f64 {
    const STEPS: u32 = 100_000;
    (0..STEPS).map(|k| (f64::from(k) + 0.5) / f64::from(STEPS)).map(|mu| (-x / mu).exp() * mu).sum::<f64>() / f64::from(STEPS)
}

/// Light passes media on its way to a meter: below a slab that absorbs, a white sky has the irradiance 2π L E₃(τ); a lamp in absorbing air
/// has e^(−τ) times that without. In a white sky a medium that only scatters changes nothing, whether the meter is outside or within, and
/// with an even density or one that varies.
#[test]
fn media_weaken_light_on_its_way() {
    let up = facing_up(0.0);
    let absorbing = scene(json!({"background": {"radiance": 2}, "shapes": [{"type": "box", "size": [1e5, 1, 1e5], "center": [0, 1.5, 0],
        "medium": {"type": "homogeneous", "absorption": 0.7}}]}));
    let air = |mut more: Value| {
        more["medium"] = json!({"type": "homogeneous", "absorption": 0.3});
        scene(more)
    };
    let ball = |density: Option<Value>| {
        let mut medium = json!({"type": "homogeneous", "scattering": 3, "phase": {"type": "henyey_greenstein", "g": 0.5}});
        if let Some(density) = density {
            medium["type"] = json!("heterogeneous");
            medium["density"] = density;
        }
        scene(
            json!({"background": {"radiance": 2}, "shapes": [{"type": "sphere", "radius": 0.8, "center": [0, 0.3, 0], "medium": medium}]}),
        )
    };
    for integrator in ["nee", "path"] {
        agrees(&absorbing, integrator, &up, 2.0 * PI * 2.0 * e3(0.7));
        for scene in [ball(None), ball(Some(json!({"type": "noise", "bounds": {"low": [-1, -1, -1], "high": [1, 1.5, 1]}, "size": 0.5})))] {
            agrees(&scene, integrator, &up, PI * 2.0);
            agrees(&scene, integrator, &facing_up(0.2), PI * 2.0);
            let radiance = Quantity::Radiance { direction: Vec3::new(0.6, 0.8, 0.0), one_minus_cos: 0.1 };
            agrees(&scene, integrator, &Meter { quantity: radiance, ..facing_up(0.0) }, 2.0);
        }
    }
    // In the middle of a ball that absorbs.
    let within = scene(
        json!({"background": {"radiance": 2}, "shapes": [{"type": "sphere", "radius": 0.8, "medium": {"type": "homogeneous", "absorption": 1.5}}]}),
    );
    agrees(&within, "nee", &up, PI * 2.0 * (-1.2f64).exp());
    let (r, h): (f64, f64) = (1e-2, 2.0);
    let small = air(json!({"shapes": [{"type": "sphere", "radius": r, "center": [0, h, 0], "emission": {"radiance": 5e3}}]}));
    // The part of the ball that the meter sees is nearer than its middle by its radius at most: half of that changes e^(−τ) by 0.15 %.
    let seen = reading(&small, "nee", &up, 7, 1 << 14).values[3].value;
    let wanted = PI * 5e3 * r * r / (h * h) * (-0.3 * (h - r)).exp();
    assert!((seen / wanted - 1.0).abs() < 2e-3, "{seen}, not {wanted}");
    let point = air(json!({"lights": [{"type": "point", "position": [1, 2, 0], "intensity": 3}]}));
    agrees(&point, "nee", &up, 3.0 * 2.0 / 5f64.powf(1.5) * (-0.3 * 5f64.sqrt()).exp());
}

/// A meter on a surface measures what falls on the surface, also where f32 cannot hold the surface's coordinates.
#[test]
fn a_meter_on_a_surface_is_not_in_its_shadow() {
    for height in [0.1, 0.3, 7.7, 1000.1] {
        let floor = json!({"type": "quad", "size": 4, "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}},
            {"rotate": {"axis": [0, 0, 1], "degrees": 20}}, {"translate": [0.7, height, -0.9]}]});
        let lit = scene(json!({"shapes": [floor], "background": {"radiance": 1}}));
        let normal = Vec3::new(-(20f32.to_radians().sin()), 20f32.to_radians().cos(), 0.0);
        let quantity = Quantity::Irradiance { normal, radius: 0.0 };
        let meter = Meter { position: Vec3::new(0.7, height as f32, -0.9), quantity, ..facing_up(0.0) };
        agrees(&lit, "nee", &meter, PI);
    }
}

/// A disk of directions of half angle α around a ball of half angle β shows (1 − cos β)/(1 − cos α) of its radiance.
#[test]
fn radiance_is_the_mean_over_directions() {
    let ball = scene(json!({"shapes": [{"type": "sphere", "radius": 1, "center": [0, 0, 4], "emission": {"radiance": 6}}]}));
    let one_minus_cos_of_ball = 1.0 - (15f64 / 16.0).sqrt();
    let meter = |one_minus_cos: f32| Meter { quantity: Quantity::Radiance { direction: Vec3::Z, one_minus_cos }, ..facing_up(0.0) };
    for integrator in ["nee", "path", "whitted"] {
        agrees(&ball, integrator, &meter(0.0), 6.0);
        agrees(&ball, integrator, &meter(0.1), 6.0 * one_minus_cos_of_ball / f64::from(0.1f32));
    }
}

/// Illuminance and luminance under a coloured disk: E = π Lv r²/(r² + h²) and Lv, with Lv = 683 lm/W · Y.
#[test]
fn lux_and_candela_are_what_the_eye_sees() {
    let (l, r, h) = ([3.0, 2.0, 1.0], 0.5f64, 2.0);
    let disk = overhead(json!({"type": "disk", "radius": r, "emission": {"radiance": l}}), h);
    // Y of Rec. 709.
    let luminance = 683.0 * (0.2126 * l[0] + 0.7152 * l[1] + 0.0722 * l[2]);
    let lux = Meter { response: Response::Photometric, ..facing_up(0.0) };
    let candela = Meter { quantity: Quantity::Radiance { direction: Vec3::Y, one_minus_cos: 0.0 }, ..lux };
    for integrator in ["nee", "path"] {
        agrees(&disk, integrator, &lux, PI * luminance * r * r / (r * r + h * h));
        agrees(&disk, integrator, &candela, luminance);
    }
}

/// Stated intervals of 95 % hold the truth in 95 % of 400 readings that stop at a target: from 363 to 394 of them, within which a
/// binomial number stays but for 1 in 500.
#[test]
fn intervals_hold_the_truth() {
    let (l, r, h) = (3.0, 0.5, 2.0);
    let disk = overhead(json!({"type": "disk", "radius": r, "emission": {"radiance": l}}), h);
    let truth = PI * l * r * r / (r * r + h * h);
    let (scene, film) = built(&disk);
    let estimator = estimator(&scene, &film, "nee");
    let meter = Meter { position: -scene.origin().as_vec3(), ..facing_up(0.0) };
    let holds = |seed: &u64| {
        let sampler = SamplerSpec { seed: *seed, ..SamplerSpec::default() };
        let reading = measure(&*scene, &*estimator, &meter, (sampler, 0), &|| false, |reading| {
            match reading.relative_half_width(0.95) <= 0.002 || reading.samples > 1 << 14 {
                true => ControlFlow::Break(reading.clone()),
                false => ControlFlow::Continue(()),
            }
        });
        assert!(!reading.has_heavy_tail);
        (reading.values[3].value - truth).abs() <= reading.half_width(3, 0.95)
    };
    let held = (0..400).filter(holds).count();
    assert!((363..=394).contains(&held), "{held} of 400");
}

fn pt(folder: &std::path::Path, args: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::cargo_bin("pt").expect("the program").current_dir(folder).arg("meter").args(args).output().expect("it runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// The command prints every meter, the same with any number of threads, says what it lacks, and tells a target that is not reached.
#[test]
fn the_command_measures() {
    let folder = tempfile::tempdir().expect("a folder");
    let lamp = json!({"type": "disk", "radius": 0.5, "emission": {"radiance": [3, 2, 1]},
        "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 90}}, {"translate": [0, 2, 0]}]});
    let lit = scene(json!({
        "shapes": [lamp],
        "meters": [
            {"type": "irradiance", "name": "desk", "position": [0, 0, 0], "normal": [0, 2, 0], "radius": 0.1},
            {"type": "radiance", "position": [0, 0, 0], "direction": [0, 1, 0], "angle": 1},
            {"type": "luminance", "name": "glare", "position": [0, 0, 0], "direction": [0, 1, 0], "angle": 1},
        ],
    }));
    std::fs::write(folder.path().join("s.json"), lit.to_string()).expect("written");
    let without_times = |text: &str| {
        let mut all: Value = serde_json::from_str(text).expect("JSON");
        all["meters"].as_array_mut().expect("meters").iter_mut().for_each(|meter| meter["seconds"] = Value::Null);
        all
    };
    let (code, one, _) = pt(folder.path(), &["s.json", "--json", "-t", "1", "--samples", "4096"]);
    let two = pt(folder.path(), &["s.json", "--json", "-t", "2", "--samples", "4096"]).1;
    assert_eq!((code, without_times(&one)), (Some(0), without_times(&two)));
    let (desk, spot) = (&without_times(&one)["meters"][0], &without_times(&one)["meters"][1]);
    assert_eq!(
        (&desk["name"], &desk["samples"], &spot["name"], &spot["value"]),
        (&json!("desk"), &json!(4096), &json!("/meters/1"), &json!(2.0))
    );
    let glare = &without_times(&one)["meters"][2];
    assert_eq!((&glare["unit"], &glare["rgb"], &glare["rgb_unit"]), (&json!("cd/m²"), &json!([3.0, 2.0, 1.0]), &json!("W/(m² sr)")));
    let (code, table, _) = pt(folder.path(), &["s.json", "--target", "1%"]);
    assert_eq!(code, Some(0));
    // 683 (0.2126 · 3 + 0.7152 · 2 + 0.0722 · 1) = 1461.9
    assert!(table.contains("glare, luminance in cd/m²") && table.contains("value       1461.9"), "{table}");
    assert!(table.contains("desk, irradiance in W/m²") && table.lines().all(|line| line.chars().count() <= 80), "{table}");
    assert_eq!(pt(folder.path(), &["s.json", "--target", "0.001%", "--samples", "1024"]).0, Some(7));
    let (code, dark, _) = pt(folder.path(), &["s.json", "-D", "/meters/0/normal=[0, -1, 0]", "--target", "1%"]);
    assert!(code == Some(7) && dark.contains("no light has arrived"), "{code:?} {dark}");
    let dark: Value = serde_json::from_str(&pt(folder.path(), &["s.json", "-D", "/meters/0/normal=[0, -1, 0]", "--json"]).1).expect("JSON");
    assert_eq!((&dark["meters"][0]["half_width"], &dark["meters"][0]["refusal"]), (&Value::Null, &json!("no light has arrived")));
    assert_eq!(pt(folder.path(), &["s.json", "--target", "0.00001%"]).0, Some(2));
    let (code, _, refused) = pt(folder.path(), &["s.json", "-i", "light"]);
    assert!(code == Some(2) && refused.contains("expected an integrator"), "{code:?} {refused}");
    std::fs::write(folder.path().join("none.json"), scene(json!({"shapes": [lamp]})).to_string()).expect("written");
    let (code, _, refused) = pt(folder.path(), &["none.json"]);
    assert!(code == Some(3) && refused.contains("none.json: the scene has no \"meters\""), "{code:?} {refused}");
}
