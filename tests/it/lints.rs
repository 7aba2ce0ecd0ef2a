//! Warnings about mistakes that only the built scene shows: bodies that overlap, surfaces in the same place, cameras and lights inside of
//! things. Each is shown by a scene that has the mistake, and by one that nearly has it and gets no warning.

use std::fs;

use assert_cmd::Command;
use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::torture::Random;
use serde_json::{Value, json};

fn built(scene: &Value) -> Built {
    let text = scene.to_string();
    let root = describe::root(text.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").unwrap_or_else(|e| panic!("{e}: {text}"));
    pt::build::build(&described, Source { root: &root, file: "s.json", files: &Files::within("") })
        .unwrap_or_else(|e| panic!("{e}: {text}"))
}

/// All warnings about a scene, those for paths from the camera last.
fn said(scene: &Value) -> Vec<String> {
    let Built { mut warnings, warnings_for_camera_paths, .. } = built(scene);
    warnings.extend(warnings_for_camera_paths);
    warnings
}

/// Ground, a lamp over it and the sky, with more shapes.
fn with(shapes: &[Value]) -> Value {
    let ground = json!({"type": "quad", "name": "ground", "size": 20, "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}}]});
    let lamp = json!({"type": "sphere", "name": "lamp", "radius": 0.3, "center": [0, 6, 0], "emission": {"radiance": 9}});
    json!({
        "pt": 1,
        "camera": {"look_at": {"from": [0, 2, 9], "to": [0, 1, 0]}, "fov": 50},
        "film": {"width": 16, "height": 16},
        "sampler": {"spp": 64},
        "integrator": {"type": "nee"},
        "background": {"radiance": 0.1},
        "shapes": ([&[ground, lamp], shapes].concat()),
    })
}

fn ball(name: &str, center: [f64; 3], radius: f64, material: &str) -> Value {
    json!({"type": "sphere", "name": name, "center": center, "radius": radius, "material": {"type": material}})
}

fn block(name: &str, center: [f64; 3], size: [f64; 3], material: Value) -> Value {
    json!({"type": "box", "name": name, "center": center, "size": size, "material": material})
}

fn glass() -> Value {
    json!({"type": "dielectric"})
}

fn matte(albedo: f64) -> Value {
    json!({"type": "diffuse", "albedo": albedo})
}

/// The scene with another camera position, looking along −z.
fn seen_from(mut scene: Value, from: [f64; 3]) -> Value {
    scene["camera"]["look_at"] = json!({"from": from, "to": [from[0], from[1], from[2] - 1.0]});
    scene
}

/// The scene in the dark but for a light.
fn lit_only_by(mut scene: Value, light: Value) -> Value {
    scene["background"]["radiance"] = json!(0);
    scene["shapes"].as_array_mut().expect("shapes").remove(1);
    scene["lights"] = json!([light]);
    scene
}

/// Checks that a scene has one warning with certain words, and that another one has none.
fn is_told(wrong: &Value, words: &[&str], right: &Value) {
    let warnings = said(wrong);
    assert_eq!(warnings.len(), 1, "{words:?}: {warnings:?}");
    words.iter().for_each(|word| assert!(warnings[0].contains(word), "{word}: {warnings:?}"));
    assert_eq!(said(right), Vec::<String>::new(), "the scene without the mistake: {words:?}");
}

/// The mean of a scene's picture by an integrator, and what the program says to the error stream.
fn rendered(scene: &Value, integrator: &str) -> (f64, String) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("s.json"), scene.to_string()).expect("written");
    let args = ["s.json", "-i", integrator, "--progress", "none", "-o", "x.exr"];
    let run = Command::cargo_bin("pt").expect("the program").current_dir(folder.path()).args(args).assert().success();
    let picture = pt::output::exr::read(&folder.path().join("x.exr")).expect("a picture").0;
    let values: Vec<f64> = picture.pixels().flatten().map(f64::from).collect();
    (values.iter().sum::<f64>() / values.len() as f64, String::from_utf8_lossy(&run.get_output().stderr).into_owned())
}

/// A solid glass cylinder of a wall and two disks, as a closed body; without the upper disk it is open.
#[test]
fn glass_bodies_of_several_shapes_are_closed_or_told() {
    let lid = |turn: f64, height: f64| {
        let place = json!([{"rotate": {"axis": [1, 0, 0], "degrees": turn}}, {"translate": [0, height, 0]}]);
        json!({"type": "disk", "radius": 0.7, "material": "glass", "transform": place})
    };
    let wall = json!({"type": "cylinder", "name": "wall", "radius": 0.7, "z_min": 1, "z_max": 2, "material": "glass",
        "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}}]});
    let of = |shapes: &[Value]| {
        let mut scene = with(shapes);
        scene["materials"] = json!({"glass": glass()});
        scene
    };
    let warnings = said(&of(&[wall.clone(), lid(90.0, 1.0)]));
    assert!(!warnings.is_empty() && warnings.iter().all(|warning| warning.contains("open or inconsistently wound glass")), "{warnings:?}");
    assert_eq!(said(&of(&[wall, lid(90.0, 1.0), lid(-90.0, 2.0)])), Vec::<String>::new());
}

/// Two bodies of which one reaches out of the other; they may touch by a gap, lie in one another, or hold something opaque.
#[test]
fn bodies_that_overlap_are_named() {
    let pair =
        |x: f64, radius: f64| with(&[ball("big", [0.0, 1.5, 0.0], 1.0, "dielectric"), ball("small", [x, 1.5, 0.0], radius, "dielectric")]);
    for (x, radius) in [(1.2, 0.5), (1.4, 0.5), (0.6, 0.5), (-0.2, 1.0)] {
        is_told(&pair(x, radius), &["big", "small", "overlaps", "leave a gap"], &pair(1.501, 0.5));
    }
    for (x, radius) in [(0.0, 0.5), (0.45, 0.5), (3.0, 1.0)] {
        assert_eq!(said(&pair(x, radius)), Vec::<String>::new(), "{x} {radius}");
    }
    // What is opaque may reach out of glass.
    let stuck = with(&[ball("glass", [0.0, 1.5, 0.0], 1.0, "dielectric"), ball("bead", [0.9, 1.5, 0.0], 0.3, "diffuse")]);
    assert_eq!(said(&stuck), Vec::<String>::new());
}

/// Faces of two shapes in one place, where the camera sees them; not where a thing hides them, and not where both look the same.
#[test]
fn visible_faces_in_one_place_are_named() {
    let at = |gap: f64, material: Value| {
        let wall = block("wall", [0.0, 1.5, -1.0], [4.0, 3.0, 1.0], matte(0.8));
        let picture =
            json!({"type": "quad", "name": "picture", "size": 1, "material": material, "transform": [{"translate": [0, 1.5, -0.5 + gap]}]});
        [wall, picture]
    };
    is_told(&with(&at(0.0, matte(0.2))), &["picture", "wall", "same place", "move them apart"], &with(&at(1e-3, matte(0.2))));
    // Within the rounding of coordinates is as bad as none.
    assert_eq!(said(&with(&at(1e-7, matte(0.2)))).len(), 1);
    // Blocks on the ground and on each other hide their common faces.
    let stack = |material: fn() -> Value, y: f64| {
        [block("lower", [0.0, 0.5, 0.0], [2.0, 1.0, 2.0], matte(0.5)), block("upper", [0.0, y, 0.0], [1.0; 3], material())]
    };
    assert_eq!(said(&with(&stack(|| matte(0.1), 1.5))), Vec::<String>::new());
    // Glass does not.
    is_told(&with(&stack(glass, 1.5)), &["upper", "lower", "same place"], &with(&stack(glass, 1.5001)));
    // Two faces that look the same, whether or not they name one material; and two that look different by their texture alone.
    assert_eq!(said(&with(&at(0.0, matte(0.8)))), Vec::<String>::new());
    let checker = json!({"type": "diffuse", "albedo": {"type": "checker", "even": 0.1, "odd": 0.9, "scale": 4}});
    let tile = |x: f64| json!({"type": "quad", "size": 2, "material": checker, "transform": [{"translate": [x, 1.5, 0]}]});
    assert_eq!(said(&with(&[tile(0.0), tile(0.3)])).len(), 1);
    // Two parts of one floor, of one material.
    let mut floor = with(&[]);
    floor["materials"] = json!({"stone": matte(0.4)});
    let part = |x: f64| {
        let steps = json!([{"rotate": {"axis": [1, 0, 0], "degrees": -90}}, {"translate": [x, 1, 0]}]);
        json!({"type": "quad", "size": [2, 3], "material": "stone", "transform": steps})
    };
    floor["shapes"].as_array_mut().expect("shapes").extend([part(-0.5), part(0.5)]);
    assert_eq!(said(&floor), Vec::<String>::new());
}

/// A camera in glass, and one in a solid thing, whose picture is black.
#[test]
fn cameras_inside_of_things_are_told() {
    let glass_ball = || with(&[ball("drop", [0.0, 2.0, 0.0], 1.0, "dielectric")]);
    is_told(&seen_from(glass_ball(), [0.1, 2.1, 0.3]), &["camera", "drop", "within the glass"], &seen_from(glass_ball(), [0.1, 2.1, 1.1]));
    let solid = |material| with(&[block("stone", [0.0, 1.5, 0.0], [2.0; 3], material)]);
    let (inside, outside) = (seen_from(solid(matte(0.5)), [0.2, 1.4, 0.3]), seen_from(solid(matte(0.5)), [0.2, 1.4, 1.3]));
    is_told(&inside, &["camera", "stone", "black"], &outside);
    assert_eq!(rendered(&inside, "nee").0, 0.0);
    assert!(rendered(&outside, "nee").0 > 0.0);
    // A lamp that only chance finds lights the room too.
    let mut by_chance = inside.clone();
    let field = json!({"type": "sdf", "field": {"type": "sphere", "radius": 0.2}, "emission": {"radiance": 9}, "transform": [{"translate": [0, 1.5, -0.7]}]});
    by_chance["shapes"].as_array_mut().expect("shapes").push(field);
    assert_eq!(said(&by_chance), Vec::<String>::new());
    // A room with a lamp in it is a closed opaque thing too, and a fine place for a camera.
    let mut room = inside;
    let bulb = json!({"type": "point", "position": [0.0, 2.0, 0.0], "intensity": 1});
    room["lights"] = json!([bulb]);
    assert_eq!(said(&room), Vec::<String>::new());
    assert!(rendered(&room, "nee").0 > 0.0);
}

/// A lamp in a closed opaque thing brings nothing to a camera outside of it.
#[test]
fn lights_inside_of_things_are_told() {
    let bulb = |y: f64| {
        let bulb = json!({"type": "point", "name": "bulb", "position": [0, y, 0], "intensity": 30});
        lit_only_by(with(&[block("stone", [0.0, 1.5, 0.0], [2.0; 3], matte(0.5))]), bulb)
    };
    is_told(&bulb(2.0), &["bulb", "stone", "none of it gets out"], &bulb(5.0));
    assert_eq!(rendered(&bulb(2.0), "nee").0, 0.0);
    assert!(rendered(&bulb(5.0), "nee").0 > 0.0);
    // A floor whose normal points down is met from its inner side, and is no thing around the lamp.
    let spot = json!({"type": "spot", "position": [0, 3, 0], "to": [0, 0, 0], "intensity": 30, "inner_angle": 10, "outer_angle": 20});
    let mut upside_down = lit_only_by(with(&[]), spot);
    upside_down["shapes"][0]["transform"] = json!([{"rotate": {"axis": [1, 0, 0], "degrees": 90}}]);
    assert_eq!(said(&upside_down), Vec::<String>::new());
    assert!(rendered(&upside_down, "nee").0 > 0.0);
    // A lamp with a surface, in a ball.
    let lamp = |x: f64| {
        let lamp = json!({"type": "sphere", "name": "bulb", "radius": 0.2, "center": [x, 1.5, 0], "emission": {"radiance": 5}});
        with(&[ball("shell", [0.0, 1.5, 0.0], 1.0, "diffuse"), lamp])
    };
    is_told(&lamp(0.0), &["bulb", "shell", "none of it gets out"], &lamp(1.5));
}

/// A point light in a glass bulb: `nee` misses it, the light tracer finds it, and a small sphere is found by chance.
#[test]
fn points_behind_clear_glass_are_told() {
    let point = |glass: &str| {
        let filament = json!({"type": "point", "name": "filament", "position": [0, 2, 0], "intensity": 30});
        lit_only_by(with(&[ball("bulb", [0.0, 2.0, 0.0], 0.5, glass)]), filament)
    };
    let bulb = point("dielectric");
    is_told(&bulb, &["filament", "shadow rays do not pass", "\"light\""], &{
        let mut open = point("dielectric");
        open["lights"][0]["position"] = json!([0, 3, 0]);
        open
    });
    let ((by_nee, told), (by_light, other)) = (rendered(&bulb, "nee"), rendered(&bulb, "light"));
    assert_eq!(by_nee, 0.0);
    assert!(by_light > 0.0);
    assert!(told.contains("\"filament\": all of this light meets clear glass") && !other.contains("filament"), "{told} {other}");
    // Rays that meet nothing do not show that nothing is lit.
    let far = lit_only_by(
        with(&[ball("mirror", [2.0, 2.0, 0.0], 0.5, "mirror")]),
        json!({"type": "point", "position": [0, 2, 0], "intensity": 30}),
    );
    assert_eq!(said(&far), Vec::<String>::new());
    // Frosted glass scatters, so that shadow rays start on it.
    let mut frosted = bulb;
    frosted["shapes"][1]["material"]["roughness"] = json!(0.3);
    assert_eq!(said(&frosted), Vec::<String>::new());
    assert!(rendered(&frosted, "nee").0 > 0.0);
}

/// Fifty scenes as people build them, without mistakes: things that stand on the ground or on one another, glass with bubbles and cores,
/// water in a basin, instances, lamps in lampshades, in rooms and in the open. None has a warning.
#[test]
fn healthy_scenes_have_no_warning() {
    for seed in 0..50 {
        let scene = healthy(&mut Random::new(seed));
        assert_eq!(said(&scene), Vec::<String>::new(), "scene {seed}: {scene}");
    }
}

/// A scene with something in each field of a grid.
fn healthy(random: &mut Random) -> Value {
    let mut scene = with(&[]);
    let shapes = scene["shapes"].as_array_mut().expect("shapes");
    for field in 0..9 {
        let (x, z) = (f64::from(field % 3 - 1) * 2.5, f64::from(field / 3 - 1) * 2.5);
        let size = 0.4 + 0.6 * random.unit();
        let turn = json!({"rotate": {"axis": [0, 1, 0], "degrees": 90.0 * random.unit()}});
        let to_field = json!({"translate": [x, 0, z]});
        let placed = |mut shape: Value| {
            shape["transform"] = json!([turn, to_field]);
            shape
        };
        let opaque = || json!({"type": (["diffuse", "mirror", "plastic", "oren_nayar"][field as usize % 4])});
        shapes.extend(match (random.unit() * 9.0) as u32 {
            // A block on the ground, and a smaller one on it.
            0 => vec![
                placed(block("block", [0.0, size / 2.0, 0.0], [size; 3], opaque())),
                placed(block("on it", [0.0, 1.25 * size, 0.0], [size / 2.0; 3], opaque())),
            ],
            // A ball that touches the ground, and one sunk into it.
            1 => vec![placed(ball("ball", [0.0, size, 0.0], size, "diffuse"))],
            2 => vec![placed(ball("sunk", [0.0, 0.3 * size, 0.0], size, "mirror"))],
            // A glass ball with a bubble or a core, a little above the ground.
            3 => vec![
                placed(ball("glass", [0.0, size + 1e-3, 0.0], size, "dielectric")),
                placed(ball("core", [0.1 * size, size, 0.0], 0.5 * size, if size < 0.7 { "dielectric" } else { "diffuse" })),
            ],
            // A glass block near another.
            4 => vec![
                placed(block("glass block", [0.0, size / 2.0 + 1e-3, 0.0], [size; 3], glass())),
                placed(block("glass plate", [0.0, 1.06 * size + 2e-3, 0.0], [size, 0.1 * size, size], glass())),
            ],
            // A basin of four walls and a floor, with water on top.
            5 => {
                let wall = |x: f64, z: f64, sx: f64, sz: f64| block("wall", [x, 0.25, z], [sx, 0.5, sz], matte(0.4));
                let walls = [wall(-0.8, 0.0, 0.2, 1.8), wall(0.8, 0.0, 0.2, 1.8), wall(0.0, -0.8, 1.4, 0.2), wall(0.0, 0.8, 1.4, 0.2)];
                let flat = json!({"rotate": {"axis": [1, 0, 0], "degrees": -90}});
                let water = json!({"type": "quad", "name": "water", "size": 1.4, "material": {"type": "dielectric", "eta": 1.33},
                    "transform": [flat, {"translate": [0, 0.4, 0]}, turn, to_field]});
                walls.map(placed).into_iter().chain([water]).collect()
            }
            // A lamp with a shade that is open below, and a pane.
            6 => {
                let shade = json!({"type": "quad", "name": "shade", "size": size,
                    "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 90}}, {"translate": [0, 2, 0]}, to_field]});
                let bulb = json!({"type": "sphere", "radius": 0.1, "center": [0, 1.8, 0], "emission": {"radiance": 20},
                    "transform": [to_field]});
                vec![shade, bulb]
            }
            7 => vec![json!({"type": "quad", "name": "pane", "size": size, "material": {"type": "thin_dielectric"},
                "transform": [{"translate": [0, 0.5 * size + 0.01, 0]}, turn, to_field]})],
            // A block sunk into another one of the same height, so that corners stick out; both opaque, of one material.
            _ => vec![placed(block("long", [0.0, size / 2.0, 0.0], [2.0 * size, size, 0.5 * size], matte(0.3)))],
        });
    }
    if random.unit() < 0.5 {
        // In a room with its own lamp.
        shapes.push(block("room", [0.0, 3.99, 0.0], [24.0, 8.0, 24.0], matte(0.7)));
    }
    if random.unit() < 0.3 {
        scene["lights"] = json!([{"type": "point", "position": [1, 5, 2], "intensity": 10}]);
    }
    scene["camera"]["look_at"] =
        json!({"from": [8.0 * random.unit() - 4.0, 1.0 + 3.0 * random.unit(), 7.0 + 2.0 * random.unit()], "to": [0, 0.8, 0]});
    scene
}

/// A body with a medium whose surface has a hole; glass with a medium is told of as glass.
#[test]
fn open_bodies_with_media_are_named() {
    let crate_of = |faces: usize, material: Value| {
        let positions = json!([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]);
        let all = [
            [0, 2, 1],
            [0, 3, 2],
            [4, 5, 6],
            [4, 6, 7],
            [0, 1, 5],
            [0, 5, 4],
            [3, 7, 6],
            [3, 6, 2],
            [1, 2, 6],
            [1, 6, 5],
            [0, 4, 7],
            [0, 7, 3],
        ];
        let mut shape = json!({"type": "mesh", "name": "cloud", "positions": positions, "triangles": all[..faces],
            "medium": {"type": "homogeneous", "scattering": 1}, "transform": [{"translate": [0, 0.5, 0]}]});
        if !material.is_null() {
            shape["material"] = material;
        }
        with(&[shape])
    };
    is_told(
        &crate_of(11, Value::Null),
        &["cloud", "boundary of a medium", "open or inconsistently wound", "close it"],
        &crate_of(12, Value::Null),
    );
    is_told(&crate_of(11, glass()), &["cloud", "open or inconsistently wound glass"], &crate_of(12, glass()));
}

/// Absorbing glass with something in it, or in fog; with the thing beside it there is no warning. It is true: a lamp behind 1 m of such glass
/// is as bright as without, and has the right colour with the medium that the warning asks for.
#[test]
fn tinted_glass_with_something_in_it_is_named() {
    let tinted = |eta: f64| json!({"type": "dielectric", "eta": eta, "absorption": {"color": [0.5, 0.2, 0.1], "distance": 0.5}});
    let bottle = block("bottle", [0.0, 1.5, 0.0], [1.4; 3], tinted(1.5));
    let words = ["bottle", "contains an object", "\"medium\": {\"type\": \"homogeneous\", \"absorption\": [1.386"];
    let and = |thing: Value| with(&[bottle.clone(), thing]);
    is_told(&and(ball("pearl", [0.2, 1.5, 0.0], 0.3, "diffuse")), &words, &and(ball("pearl", [1.2, 1.5, 0.0], 0.3, "diffuse")));
    is_told(&and(ball("bubble", [0.2, 1.5, 0.0], 0.3, "dielectric")), &words, &and(ball("bubble", [1.2, 1.5, 0.0], 0.3, "dielectric")));
    let fog = |y: f64, size: f64| {
        let medium = json!({"type": "homogeneous", "scattering": 0.1});
        and(json!({"type": "box", "name": "fog", "center": [0, y, 0], "size": size, "medium": medium}))
    };
    is_told(&fog(1.5, 0.5), &words, &fog(3.5, 0.5));
    is_told(&fog(1.5, 2.0), &words, &fog(4.0, 2.0));

    let lamp = json!({"type": "quad", "size": 1.8, "emission": {"radiance": 1}});
    let seen = |mut glass: Value, medium: Value| {
        let mut scene = json!({"pt": 1, "camera": {"type": "orthographic", "height": 0.5, "look_at": {"from": [0, 0, 4], "to": [0, 0, 0]}},
            "film": {"width": 4, "height": 4}, "sampler": {"spp": 4}});
        if !medium.is_null() {
            glass["medium"] = medium;
        }
        scene["shapes"] = json!([lamp, glass]);
        scene
    };
    let clear = block("block", [0.0; 3], [2.0; 3], json!({"type": "dielectric", "eta": 1}));
    let wrong = seen(block("block", [0.0; 3], [2.0; 3], tinted(1.0)), Value::Null);
    let told = said(&wrong).into_iter().find(|warning| warning.contains("contains an object")).expect("a warning");
    let advice = &told[told.find("{").expect("a medium")..];
    let right = seen(clear, serde_json::from_str(advice).expect("a medium"));
    assert!(!said(&right).iter().any(|warning| warning.contains("contains an object")));
    assert!((rendered(&wrong, "nee").0 - 1.0).abs() < 1e-6);
    let exact = (0.5f64.powi(2) + 0.2f64.powi(2) + 0.1f64.powi(2)) / 3.0;
    assert!((rendered(&right, "nee").0 / exact - 1.0).abs() < 1e-5);
}

/// A medium without end under a sky, which hides it; in a box, and without a sky, there is no warning.
#[test]
fn media_that_hide_the_sky_are_told() {
    let mut under_sky = with(&[]);
    under_sky["medium"] = json!({"type": "homogeneous", "scattering": 0.1});
    let mut indoors = lit_only_by(under_sky.clone(), json!({"type": "point", "position": [0, 1.5, 0.2], "intensity": 1}));
    indoors["background"]["radiance"] = json!(0);
    is_told(&under_sky, &["/medium", "no light from infinitely far away", "put the medium into a large box"], &indoors);
    let parallel = lit_only_by(under_sky.clone(), json!({"type": "directional", "direction": [0, -1, 0], "irradiance": 1}));
    assert!(said(&parallel).iter().any(|warning| warning.contains("infinitely far away")));
    // It is true: the picture under the sky is black but for what is near.
    let dense = |extinction: f64| {
        let mut scene =
            json!({"pt": 1, "camera": {}, "film": {"width": 8, "height": 8}, "sampler": {"spp": 4}, "background": {"radiance": 1}});
        scene["medium"] = json!({"type": "homogeneous", "scattering": extinction});
        scene
    };
    assert!(rendered(&dense(0.1), "nee").0 == 0.0 && rendered(&dense(0.0), "nee").0 == 1.0);
}

/// The blades of an iris and a tilted plane of focus do nothing where no lens is open.
#[test]
fn what_counts_only_with_a_lens_is_told() {
    let with_camera = |key: &str, value: Value, radius: f64| {
        let mut scene = with(&[]);
        scene["camera"][key] = value;
        scene["camera"]["lens_radius"] = json!(radius);
        scene
    };
    for (key, value) in [("aperture", json!({"blades": 5})), ("tilt", json!([10, 0]))] {
        is_told(&with_camera(key, value.clone(), 0.0), &[&format!("/camera/{key}: "), "is a pinhole"], &with_camera(key, value, 0.1));
    }
    assert_eq!(said(&with_camera("aperture", json!({"blades": 0}), 0.0)), Vec::<String>::new());
}

/// A body that turns by half a turn or more between two keyframes turns another way than its angles say.
#[test]
fn keyframes_half_a_turn_apart_are_told() {
    let turning = |degrees: f64, axis: [f64; 3]| {
        let key =
            |time: f64, degrees: f64, axis: [f64; 3]| json!({"time": time, "transform": [{"rotate": {"axis": axis, "degrees": degrees}}]});
        let mut body = block("body", [0.0, 1.0, 0.0], [0.5, 1.0, 0.7], matte(0.5));
        body["transform"] = json!([{"keyframes": [key(0.0, 10.0, [0.0, 1.0, 0.0]), key(1.0, 10.0 + degrees, axis)]}]);
        let mut scene = with(&[body]);
        scene["shutter"] = json!({"open": 0, "close": 1});
        scene
    };
    let (up, aside) = ([0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    for degrees in [270.0, -180.0] {
        is_told(&turning(degrees, up), &["/shapes/2/transform/0/keyframes/1: ", &format!("by {degrees}°")], &turning(179.0, up));
    }
    assert_eq!(said(&turning(270.0, aside)), Vec::<String>::new());
    is_told(&turning(-210.2, [0.0, -3.0, 0.0]), &["by 190.2°"], &turning(-180.0, [0.0, -3.0, 0.0]));
}
