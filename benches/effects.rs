//! What each effect costs: the time of a sample in a small scene with the effect, over that in the same scene without it.
//!
//! `cargo bench --bench effects` writes the table of docs/effects.md. Each scene is rendered with `nee` by one thread, in turn with its
//! partner, and the shortest of several times counts; once with single paths (`PT_LANES=1`), once with as many as the processor's
//! instructions take side by side.

use std::process::Command;
use std::sync::Arc;

use cpu_time::ProcessTime;
use pt::build::{Source, build};
use pt::describe::{self, Files};
use pt::effects::Effects;
use pt::film::MomentFilm;
use pt::integrators::nee::Nee;
use pt::render::{Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;
use serde_json::{Value, json};

/// Number of times that each scene is rendered.
const RUNS: u32 = 7;
const SAMPLES: u64 = 16;

/// An effect, and what is changed in the scene without and in the scene with it: JSON pointers and values.
struct Row {
    effect: Effects,
    change: &'static str,
    without: Vec<(&'static str, Value)>,
    with: Vec<(&'static str, Value)>,
}

fn rows() -> Vec<Row> {
    let ball = "/materials/ball";
    let row = |effect, change, without: &[(&'static str, Value)], with: &[(&'static str, Value)]| Row {
        effect,
        change,
        without: without.to_vec(),
        with: with.to_vec(),
    };
    let lamp = json!({ "type": "quad", "size": 1, "material": "walls", "emission": 8,
        "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 2.9, 0] }] });
    let checker = json!({ "type": "checker", "even": 0.8, "odd": 0.3, "scale": 20 });
    let matte = |albedo: Value| json!({ "type": "diffuse", "albedo": albedo });
    let solid = |emission: Value| {
        json!({ "type": "sdf", "material": "walls", "emission": emission, "field": { "type": "sphere", "radius": 0.3 },
            "transform": [{ "translate": [0, 1.7, 0] }] })
    };
    let pawn = |smooth: bool| {
        json!({ "type": "mesh", "file": "meshes/pawn.ply", "smooth_shadows": smooth, "material": "walls",
            "transform": [{ "translate": [0, 0, 1] }] })
    };
    let slide = |x: f64| {
        let key = |time: f64, by: f64| json!({ "time": time, "transform": [{ "translate": [x + by, 0.6, 0] }] });
        json!({ "keyframes": [key(0.0, -0.2), key(1.0, 0.2)] })
    };
    let wires = |are_curves: bool| {
        let at = |k: u32| [f64::from(k) * 0.15 - 1.4, 0.9];
        let cylinder = |[x, z]: [f64; 2]| {
            json!({ "type": "cylinder", "radius": 0.02, "z_min": 0, "z_max": 1.5, "material": "walls",
                "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }, { "translate": [x, 0, z] }] })
        };
        let line = |[x, z]: [f64; 2]| json!([[x, 0, z], [x, 0.5, z], [x, 1, z], [x, 1.5, z]]);
        match are_curves {
            true => {
                json!({ "type": "curves", "radius": 0.02, "material": "walls", "points": (0..20).map(|k| line(at(k))).collect::<Vec<_>>() })
            }
            false => json!({ "type": "group", "shapes": (0..20).map(|k| cylinder(at(k))).collect::<Vec<_>>() }),
        }
    };
    let mirrors = |walls: Value| [("/materials/walls", walls.clone()), (ball, walls)];
    let mirror = json!({ "type": "mirror", "color": 0.5 });
    vec![
        row(Effects::AREA_LIGHT, "a lamp under the sky", &[], &[("/shapes/-", lamp.clone())]),
        row(
            Effects::POINT_LIGHT,
            "a point light under the sky",
            &[],
            &[("/lights", json!([{ "type": "point", "position": [0.5, 2.5, 1], "intensity": 9 }]))],
        ),
        row(
            Effects::ENVIRONMENT,
            "a sky around a lamp",
            &[("/background", json!({ "radiance": 0 })), ("/shapes/-", lamp.clone())],
            &[("/shapes/-", lamp)],
        ),
        row(Effects::INTERREFLECTION, "everything matte, not a mirror", &mirrors(mirror.clone()), &mirrors(matte(json!(0.5)))),
        row(Effects::SPECULAR_REFLECTION, "mirror balls, not matte ones", &[], &[(ball, mirror)]),
        row(
            Effects::GLOSSY_REFLECTION,
            "balls of rough gold, not matte ones",
            &[],
            &[(ball, json!({ "type": "conductor", "metal": "Au", "roughness": 0.3 }))],
        ),
        row(Effects::REFRACTION, "glass balls, not matte ones", &[], &[(ball, json!({ "type": "dielectric" }))]),
        row(
            Effects::DISPERSION,
            "balls of glass with dispersion, not of plain glass",
            &[(ball, json!({ "type": "dielectric" }))],
            &[(ball, json!({ "type": "dielectric", "abbe": 40 }))],
        ),
        row(
            Effects::THIN_FILM,
            "a film on balls of gold, not bare gold",
            &[(ball, json!({ "type": "conductor", "metal": "Au", "roughness": 0.3 }))],
            &[(ball, json!({ "type": "conductor", "metal": "Au", "roughness": 0.3, "film": { "eta": 1.5, "thickness": 300 } }))],
        ),
        row(
            Effects::ROUGH_REFRACTION,
            "balls of rough glass, not matte ones",
            &[],
            &[(ball, json!({ "type": "dielectric", "roughness": 0.3 }))],
        ),
        row(Effects::THIN_LENS, "a lens", &[], &[("/camera/lens_radius", json!(0.05)), ("/camera/focus_distance", json!(4))]),
        row(
            Effects::REALISTIC_LENS,
            "a lens of eleven surfaces, not a thin one",
            &[("/camera", with_view(json!({ "focal_length": 50, "f_number": 2, "focus_distance": 4 })))],
            &[("/camera", with_view(json!({ "type": "realistic", "lens": DOUBLE_GAUSS, "focus_distance": 4 })))],
        ),
        row(Effects::CURVES, "twenty wires, not as many thin cylinders", &[("/shapes/-", wires(false))], &[("/shapes/-", wires(true))]),
        row(
            Effects::SHADING_NORMALS,
            "bumps on the balls",
            &[],
            &[(ball, json!({ "type": "bumped", "surface": matte(json!(0.6)), "bump_map": checker, "scale": 0.01 }))],
        ),
        row(
            Effects::TEXTURES,
            "a pattern of two similar colours on all surfaces",
            &[],
            &mirrors(matte(json!({ "type": "mix", "a": 0.59, "b": 0.61, "share": { "type": "threshold", "by": checker } }))),
        ),
        row(
            Effects::FOOTPRINTS,
            "a checkerboard on all surfaces, averaged over what a pixel shows",
            &[&mirrors(matte(checker.clone()))[..], &[("/film/texture_footprint", json!(0))]].concat(),
            &mirrors(matte(checker.clone())),
        ),
        row(
            Effects::CUT_OUTS,
            "holes in the balls",
            &[],
            &[(ball, json!({ "type": "masked", "surface": matte(json!(0.6)), "opacity": { "type": "threshold", "by": checker } }))],
        ),
        row(Effects::UNSAMPLED_EMITTER, "a solid that glows", &[("/shapes/-", solid(json!(0)))], &[("/shapes/-", solid(json!(3)))]),
        row(
            Effects::MEDIA,
            "haze in a box around everything",
            &[],
            &[("/shapes/-", json!({ "type": "box", "size": 40, "medium": { "type": "homogeneous", "scattering": 0.05 } }))],
        ),
        row(
            Effects::MOTION,
            "balls that move, not balls at rest",
            &[],
            &[("/shapes/2/transform/0", slide(-1.4)), ("/shapes/3/transform/0", slide(0.0)), ("/shapes/4/transform/0", slide(1.4))],
        ),
        row(Effects::SMOOTH_SHADOWS, "smooth shadows on a mesh", &[("/shapes/-", pawn(false))], &[("/shapes/-", pawn(true))]),
    ]
}

/// A double Gauss of f/2. Source: Tronnier, US patent 2,673,491 (1954), scaled to a focal length of 50 mm.
const DOUBLE_GAUSS: [[f64; 4]; 11] = [
    [29.475, 3.76, 1.67, 25.2],
    [84.83, 0.12, 1.0, 25.2],
    [19.275, 4.025, 1.67, 23.0],
    [40.77, 3.275, 1.699, 23.0],
    [12.75, 5.705, 1.0, 18.0],
    [0.0, 4.5, 1.0, 17.1],
    [-14.495, 1.18, 1.603, 17.0],
    [40.77, 6.065, 1.658, 20.0],
    [-20.385, 0.19, 1.0, 20.0],
    [437.065, 3.22, 1.717, 20.0],
    [-39.73, 0.0, 1.0, 20.0],
];

/// A camera with the view of the scene below.
fn with_view(mut camera: Value) -> Value {
    camera["look_at"] = base()["camera"]["look_at"].clone();
    camera
}

/// A matte floor with a wall and three balls under a sky of one colour.
fn base() -> Value {
    let ball = |x: f64| json!({ "type": "sphere", "radius": 0.6, "material": "ball", "transform": [{ "translate": [x, 0.6, 0] }] });
    json!({
        "pt": 1,
        "camera": { "look_at": { "from": [0, 1.4, 5], "to": [0, 0.8, 0] }, "fov": 40 },
        "film": { "width": 160, "height": 120 },
        "background": { "radiance": 0.7 },
        "materials": { "walls": { "type": "diffuse", "albedo": 0.6 }, "ball": { "type": "diffuse", "albedo": 0.6 } },
        "shapes": [
            { "type": "quad", "size": 8, "material": "walls", "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }] },
            { "type": "quad", "size": 8, "material": "walls", "transform": [{ "translate": [0, 0, -2] }] },
            ball(-1.4), ball(0.0), ball(1.4)
        ]
    })
}

fn scene(changes: &[(&'static str, Value)]) -> pt::Result<(Arc<dyn Scene>, pt::film::FilmSpec)> {
    let mut value = base();
    for (pointer, change) in changes {
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        match value.pointer_mut(parent).expect(pointer) {
            Value::Array(list) if key == "-" => list.push(change.clone()),
            Value::Array(list) => list[key.parse::<usize>().expect(pointer)] = change.clone(),
            parent => parent[key] = change.clone(),
        }
    }
    let (text, file) = (value.to_string(), "scenes/effect.json");
    let root = describe::root(text.as_bytes(), file)?;
    let built = build(&describe::read(&root, file)?, Source { root: &root, file, files: &Files::within("scenes") })?;
    Ok((Arc::new(built.world), built.film))
}

/// Measures all rows and prints the times of a sample without and with each effect (ns).
fn measure() -> pt::Result<()> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    for row in rows() {
        let scenes = [scene(&row.without)?, scene(&row.with)?];
        let has = scenes.each_ref().map(|(scene, _)| scene.effects().contains(row.effect));
        assert_eq!(has, [false, true], "{}: only the second scene has the effect", row.effect);
        let mut least = [f64::INFINITY; 2];
        for run in 0..u64::from(RUNS) {
            for (least, (scene, film)) in least.iter_mut().zip(&scenes) {
                let settings = Settings {
                    samples: SAMPLES,
                    ..Settings::new(SamplerSpec { kind: Kind::Independent, seed: run, ..SamplerSpec::default() })
                };
                let mut pixels = MomentFilm::new(film.clone());
                let start = ProcessTime::now();
                pool.install(|| render(scene.clone(), &Nee::default(), &mut pixels, &settings, &Silent));
                let samples = film.crop.pixel_count() * SAMPLES;
                *least = least.min(start.elapsed().as_nanos() as f64 / samples as f64);
            }
        }
        println!("{} {}", least[0], least[1]);
    }
    Ok(())
}

/// Times of a sample without and with each effect, measured by another process that follows so many paths side by side (ns).
fn measured(lanes: &str) -> Vec<[f64; 2]> {
    let program = std::env::current_exe().expect("this program");
    let output = Command::new(program).arg("--measure").env("PT_LANES", lanes).output().expect("it starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let pair = |line: &str| {
        let mut numbers = line.split(' ').map(|number| number.parse().expect("a number"));
        [numbers.next().expect("a time without"), numbers.next().expect("a time with")]
    };
    text.lines().map(pair).collect()
}

fn main() -> pt::Result<()> {
    if std::env::args().any(|arg| arg == "--measure") {
        return measure();
    }
    let (single, wide) = (measured("1"), measured("16"));
    println!("| effect | the change measured | ns per sample, without and with | ratio | ratio, side by side | what it consists of |");
    println!("|---|---|---|---|---|---|");
    for (row, ([without, with], [without_wide, with_wide])) in rows().iter().zip(single.into_iter().zip(wide)) {
        let (ratio, ratio_wide) = (with / without, with_wide / without_wide);
        let (effect, change, cost) = (row.effect, row.change, row.effect.cost());
        println!("| {effect} | {change} | {without:.0}, {with:.0} | {ratio:.2} | {ratio_wide:.2} | {cost} |");
    }
    Ok(())
}
