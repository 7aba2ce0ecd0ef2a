//! Animations: what moves is where the specification says, at a time and while the shutter is open.

use std::f64::consts::FRAC_PI_2;

use assert_cmd::Command;
use glam::{DMat4, DQuat, DVec3, Vec3};
use pt::math::Ray;
use pt::scene::Scene;
use serde_json::{Value, json};

use super::model::{CORNERS, Model, U8};
use crate::import::read::{Read, assert_near, met, read, try_read_with};

/// Adds an animation of one property of a node.
fn animate<const N: usize>(model: &mut Model, node: usize, path: &str, interpolation: &str, times: &[f32], values: &[[f32; N]]) {
    let times: Vec<[f32; 1]> = times.iter().map(|time| [*time]).collect();
    let (input, output) = (model.floats(&times), model.floats(values));
    let sampler = json!({ "input": input, "output": output, "interpolation": interpolation });
    let channel = json!({ "sampler": 0, "target": { "node": node, "path": path } });
    model.add("animations", json!({ "channels": [channel], "samplers": [sampler] }));
}

fn try_exposed(model: &Model, open: f64, close: f64) -> pt::Result<Read> {
    let folder = tempfile::tempdir().expect("a folder");
    model.write(folder.path(), "m.glb");
    let shutter = json!({ "open": open, "close": close }).to_string();
    try_read_with(&folder.path().join("m.glb"), Default::default(), &[("/shutter", &shutter)])
}

/// The scene without a time of exposure.
fn unexposed(model: &Model) -> Read {
    let folder = tempfile::tempdir().expect("a folder");
    model.write(folder.path(), "m.glb");
    read(&folder.path().join("m.glb"))
}

fn exposed(model: &Model, open: f64, close: f64) -> Read {
    try_exposed(model, open, close).unwrap_or_else(|e| panic!("{e}"))
}

/// Transform of the first shape that does not move.
fn placed(scene: &Read) -> DMat4 {
    matrix(scene.at("/shapes/0").get("transform").map_or(&Value::Null, |steps| &steps[0]["matrix"]))
}

fn matrix(rows: &Value) -> DMat4 {
    let Some(rows) = rows.as_array() else { return DMat4::IDENTITY };
    let rows: Vec<f64> = rows.iter().map(|x| x.as_f64().expect("a number")).collect();
    DMat4::from_cols_slice(&rows).transpose()
}

/// Times and transforms of the keyframes of the first shape.
fn keyframes(scene: &Read) -> Vec<(f64, DMat4)> {
    let keys = scene.at("/shapes/0/transform/0/keyframes").as_array().expect("keyframes");
    keys.iter().map(|key| (key["time"].as_f64().expect("a time"), matrix(&key["transform"][0]["matrix"]))).collect()
}

/// Values between keys are interpolated as the animation says, and stay as they are before the first key and after the last.
#[test]
fn values_are_interpolated_as_the_animation_says() {
    let keys = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 4.0, 0.0]];
    // Tangent before, value, tangent after, for each of two keys.
    let splines = [[9.0, 0.0, 0.0], [0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [9.0, 0.0, 0.0]];
    for (time, linear, step) in [
        (0.5, [0.0; 3], [0.0; 3]),
        (1.5, [1.0, 0.0, 0.0], [0.0; 3]),
        (2.25, [2.0, 1.0, 0.0], keys[1].map(f64::from)),
        (9.0, keys[2].map(f64::from), keys[2].map(f64::from)),
    ] {
        for (interpolation, expected) in [("LINEAR", linear), ("STEP", step)] {
            let mut model = Model::square(json!({}));
            animate(&mut model, 0, "translation", interpolation, &[1.0, 2.0, 3.0], &keys);
            let found = placed(&exposed(&model, time, time)).w_axis.truncate();
            assert_near(&found.to_array(), &expected, 1e-12, &format!("{interpolation} at {time}"));
        }
    }
    // Hermite's polynomial between 1 s and 3 s: p = 2 (3t² − 2t³) + 2·3 (t³ − 2t² + t) + 2·1 (t³ − t²).
    for t in [0.0f64, 0.25, 0.5, 0.9, 1.0] {
        let mut model = Model::square(json!({}));
        animate(&mut model, 0, "translation", "CUBICSPLINE", &[1.0, 3.0], &splines);
        let expected = 2.0 * (3.0 * t.powi(2) - 2.0 * t.powi(3)) + 6.0 * (t.powi(3) - 2.0 * t * t + t) + 2.0 * (t.powi(3) - t * t);
        let found = placed(&exposed(&model, 1.0 + 2.0 * t, 1.0 + 2.0 * t)).w_axis;
        assert_near(&[found.x], &[expected], 1e-12, &format!("a spline at {t}"));
    }
    // Rotations turn at an even speed by the shorter way, and take the place of a part of a matrix.
    let half = FRAC_PI_2 / 2.0;
    let mut model = Model::square(json!({}));
    model.doc["nodes"][0]["matrix"] = json!([2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]);
    animate(&mut model, 0, "rotation", "LINEAR", &[0.0, 1.0], &[[0.0, 0.0, 0.0, -1.0], [0.0, 0.0, half.sin() as f32, half.cos() as f32]]);
    let found = placed(&exposed(&model, 0.25, 0.25));
    let expected =
        DMat4::from_translation(DVec3::new(5.0, 6.0, 7.0)) * DMat4::from_rotation_z(FRAC_PI_2 / 4.0) * DMat4::from_scale(DVec3::splat(2.0));
    assert_near(&found.to_cols_array(), &expected.to_cols_array(), 1e-6, "a rotation");
}

/// While the shutter is open the nodes move: a child goes round its parent that turns, and each key of the animation counts. Without a time of
/// exposure nothing is animated, which is said.
#[test]
fn nodes_move_while_the_shutter_is_open() {
    let half = FRAC_PI_2 / 2.0;
    let mut model = Model::new();
    let mesh = model.square_mesh(json!(0));
    model.add("materials", json!({}));
    let child = model.add("nodes", json!({ "mesh": mesh, "translation": [3, 0, 0] }));
    let parent = model.node(json!({ "children": [child] }));
    animate(
        &mut model,
        parent,
        "rotation",
        "LINEAR",
        &[0.0, 1.0],
        &[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, half.sin() as f32, half.cos() as f32]],
    );
    animate(&mut model, child, "scale", "STEP", &[0.0, 0.333], &[[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]);
    let scene = exposed(&model, 0.25, 0.75);
    let keys = keyframes(&scene);
    assert!(keys.first().expect("keys").0 == 0.25 && keys.last().expect("keys").0 == 0.75);
    assert!(keys.iter().any(|(time, _)| (*time - 0.333).abs() < 1e-6), "the key of the scale");
    for (time, to_world) in &keys {
        let scale = if *time < f64::from(0.333f32) { 1.0 } else { 2.0 };
        let expected =
            DMat4::from_rotation_z(FRAC_PI_2 * time) * DMat4::from_translation(DVec3::X * 3.0) * DMat4::from_scale(DVec3::splat(scale));
        assert_near(&to_world.to_cols_array(), &expected.to_cols_array(), 1e-6, &format!("at {time}"));
    }
    scene.built();
    let still = unexposed(&model);
    assert!(still.notes_say("animations are left out"));
    assert_near(&placed(&still).w_axis.to_array(), &[3.0, 0.0, 0.0, 1.0], 0.0, "without exposure");
    assert!(!scene.notes_say("animations"));
    // A moment has no keyframes.
    assert!(exposed(&model, 0.5, 0.5).at("/shapes/0/transform/0").get("keyframes").is_none());
}

/// Times and corners of the keyframes of the first mesh.
fn bent(scene: &Read) -> Vec<(f64, Vec<Vec3>)> {
    let keys = scene.at("/shapes/0/keyframes").as_array().expect("keyframes").len();
    let time = |k: usize| scene.at(&format!("/shapes/0/keyframes/{k}/time")).as_f64().expect("a time");
    (0..keys).map(|k| (time(k), scene.mesh_at(&format!("/shapes/0/keyframes/{k}/file")).positions)).collect()
}

/// Without a camera in the file, the camera sees all that the animations show, and stands still while they do.
#[test]
fn the_camera_stands_still_in_a_sequence() {
    let mut model = Model::square(json!({}));
    animate(&mut model, 0, "translation", "LINEAR", &[0.0, 2.0], &[[-3.0, 0.0, 0.0], [5.0, 0.0, 0.0]]);
    let cameras = [[0.0, 0.0], [0.5, 0.75], [2.0, 2.0]].map(|[open, close]| exposed(&model, open, close).at("/camera").clone());
    assert_eq!(cameras[0], cameras[1]);
    assert_eq!(cameras[0], cameras[2]);
    let scene = exposed(&model, 0.0, 0.0);
    let point = |at: &str| DVec3::from_slice(&scene.numbers(at));
    let (from, to) = (point("/camera/look_at/from"), point("/camera/look_at/to"));
    let aspect = scene.number("/film/width") / scene.number("/film/height");
    let half_diagonal = ((0.5 * scene.number("/camera/fov")).to_radians().tan() * aspect.hypot(1.0)).atan();
    for shift in [-3.0, 5.0] {
        for corner in CORNERS {
            let p = DVec3::from(corner.map(f64::from)) + DVec3::X * shift;
            assert!((p - from).angle_between(to - from) < half_diagonal, "{p} is seen from {from} towards {to}");
        }
    }
    assert_ne!(unexposed(&model).at("/camera"), &cameras[0], "without a time of exposure nothing moves");
}

/// `--frame 5 --fps 10` shows the animation from 0.5 s on, with the shutter open for half of the time of a picture.
#[test]
fn frames_are_moments_of_the_animation() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut model = Model::square(json!({}));
    animate(&mut model, 0, "translation", "LINEAR", &[0.0, 2.0], &[[-3.0, 0.0, 0.0], [5.0, 0.0, 0.0]]);
    model.write(folder.path(), "m.glb");
    let picture = |args: &[&str], name: &str| {
        let mut pt = Command::cargo_bin("pt").expect("the program");
        pt.current_dir(folder.path()).args(["m.glb", "--size", "24x16", "--spp", "2", "-q", "--progress", "none"]);
        pt.args(args).args(["-o", "x.pfm"]).assert().success();
        std::fs::read(folder.path().join(name)).expect(name)
    };
    let frame = picture(&["--frame", "5", "--fps", "10"], "x.0005.pfm");
    assert!(frame == picture(&["-D", r#"/shutter={"open":0.5,"close":0.55}"#], "x.pfm"));
    assert!(frame != picture(&["--frame", "6", "--fps", "10"], "x.0006.pfm"), "the square moves");
}

/// Weights of morph targets bend a mesh while the shutter is open. Where they change evenly two keyframes say it.
#[test]
fn morph_targets_are_blurred() {
    let mut model = Model::new();
    let (position, target) = (model.floats(&CORNERS), model.floats(&[[0.0, 0.0, 4.0]; 4]));
    let primitive = json!({ "attributes": { "POSITION": position }, "mode": 6, "targets": [{ "POSITION": target }] });
    let mesh = model.add("meshes", json!({ "primitives": [primitive] }));
    let node = model.node(json!({ "mesh": mesh }));
    animate(&mut model, node, "weights", "LINEAR", &[0.0, 2.0], &[[0.0], [1.0]]);
    let raised = |z: f32| CORNERS.iter().map(|p| Vec3::from(*p) + Vec3::Z * z).collect::<Vec<_>>();
    let scene = exposed(&model, 0.5, 1.5);
    assert_eq!(bent(&scene), [(0.5, raised(1.0)), (1.5, raised(3.0))]);
    let built = scene.built();
    for (time, z) in [(0.0, 1.0), (0.25, 1.5), (0.9, 2.8)] {
        let origin = Vec3::new(0.5, 0.5, 9.0) - built.world.origin().as_vec3();
        let hit = built.world.intersect(&Ray { time, ..Ray::new(origin, Vec3::NEG_Z) }).expect("a hit");
        assert_near(&[f64::from(9.0 - hit.t)], &[z], 1e-5, &format!("at {time}"));
    }
    // A moment, and a time at which nothing changes, have no keyframes.
    let moment = exposed(&model, 1.0, 1.0);
    assert_eq!(moment.mesh(0).positions, raised(2.0));
    assert!(moment.at("/shapes/0").get("keyframes").is_none());
    assert!(exposed(&model, 3.0, 4.0).at("/shapes/0").get("keyframes").is_none());
}

/// The joints of skins bend a mesh while the shutter is open. Vertices that turn about a joint stay on their circles, to within 1/4096 of the
/// size of the mesh.
#[test]
fn skins_are_blurred() {
    let mut model = Model::new();
    let position = model.floats(&CORNERS);
    let joints = model.accessor(&[0; 16], U8, "VEC4", 4);
    let weights = model.floats(&[[1.0, 0.0, 0.0, 0.0]; 4]);
    let primitive = json!({ "attributes": { "POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights }, "mode": 6 });
    let mesh = model.add("meshes", json!({ "primitives": [primitive] }));
    let joint = model.node(json!({}));
    let skin = model.add("skins", json!({ "joints": [joint] }));
    model.node(json!({ "mesh": mesh, "skin": skin }));
    let turned = |degrees: f64| DQuat::from_rotation_z(degrees.to_radians()).as_quat().to_array();
    animate(&mut model, joint, "rotation", "LINEAR", &[0.0, 2.0], &[turned(0.0), turned(120.0)]);
    let at =
        |degrees: f64| CORNERS.iter().map(move |p| (DQuat::from_rotation_z(degrees.to_radians()) * Vec3::from(*p).as_dvec3()).as_vec3());
    let moment = exposed(&model, 0.5, 0.5);
    for (found, wanted) in moment.mesh(0).positions.iter().zip(at(30.0)) {
        assert!(found.distance(wanted) < 1e-6, "{found}, not {wanted}");
    }
    let keys = bent(&exposed(&model, 0.0, 1.0));
    assert!((5..=33).contains(&keys.len()), "{} keyframes", keys.len());
    for time in (0..=500).map(|k| f64::from(k) / 500.0) {
        let after = keys.partition_point(|(key, _)| *key <= time).min(keys.len() - 1);
        let ((start, a), (end, b)) = (&keys[after - 1], &keys[after]);
        let share = ((time - start) / (end - start)) as f32;
        for ((a, b), wanted) in a.iter().zip(b).zip(at(60.0 * time)) {
            // The times that are tried are 1/64 of the exposure apart.
            assert!(a.lerp(*b, share).distance(wanted) < 2.0 * 1.5 / 4096.0, "at {time}");
        }
    }
}

/// The camera and lights move with their nodes: the camera sees what it would from where it is at each time.
#[test]
fn cameras_and_lights_move_with_their_nodes() {
    let mut model = Model::square(json!({}));
    let camera = model.add("cameras", json!({ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } }));
    let camera = model.node(json!({ "camera": camera, "translation": [0, 0, 5] }));
    model.doc["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "intensity": 683 }] } });
    model.doc["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    let light = model.node(json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
    for (node, to) in [(camera, [4.0, 0.0, 5.0]), (light, [0.0, 2.0, 6.0])] {
        animate(&mut model, node, "translation", "LINEAR", &[0.0, 1.0], &[[0.0, 0.0, 5.0], to]);
    }
    let scene = exposed(&model, 0.25, 0.75);
    let built = scene.built();
    let eye = built.world.camera().eye_at(0.5) + built.world.origin();
    assert_near(&eye.to_array(), &[2.0, 0.0, 5.0], 1e-6, "the camera in the middle");
    let steps = scene.at("/lights/0/transform/0/keyframes").as_array().expect("keyframes");
    let last = &steps[steps.len() - 1]["transform"][0]["look_at"];
    for (key, expected) in [("from", [0.0, 1.5, 5.75]), ("to", [0.0, 1.5, 4.75])] {
        let found: Vec<f64> = last[key].as_array().expect("a point").iter().map(|x| x.as_f64().expect("a number")).collect();
        assert_near(&found, &expected, 1e-6, key);
    }
    met(&built, [0.5, 0.5, 3.0], [0.0, 0.0, -1.0], |_, p| assert_near(&p.to_array(), &[0.5, 0.5, 0.0], 1e-6, "the square"));
}

/// Animations whose numbers do not fit are refused, if they are asked for.
#[test]
fn faults_of_animations_are_told() {
    let with = |times: &[f32], values: &[[f32; 3]]| {
        let mut model = Model::square(json!({}));
        animate(&mut model, 0, "translation", "LINEAR", times, values);
        model
    };
    let told = |model: &Model| try_exposed(model, 0.0, 1.0).err().map(|e| e.to_string()).unwrap_or_default();
    assert!(told(&with(&[0.0, 1.0], &[[0.0; 3]])).contains("/animations/0/channels/0: 2 times for 3 numbers of an animation"));
    assert!(told(&with(&[1.0, 1.0], &[[0.0; 3]; 2])).contains("the times of an animation are finite and increase"));
    let mut lost = with(&[0.0, 1.0], &[[0.0; 3]; 2]);
    lost.doc["animations"][0]["channels"][0]["target"]["node"] = json!(9);
    assert!(told(&lost).contains("/animations/0/channels/0/target: node 9, but there are 1"), "{}", told(&lost));
    let mut no_sampler = with(&[0.0, 1.0], &[[0.0; 3]; 2]);
    no_sampler.doc["animations"][0]["channels"][0]["sampler"] = json!(3);
    assert!(
        told(&no_sampler).contains("sampler 3, but there are 1") || told(&no_sampler).contains("beyond the end"),
        "{}",
        told(&no_sampler)
    );
    let mut no_accessor = with(&[0.0, 1.0], &[[0.0; 3]; 2]);
    no_accessor.doc["animations"][0]["samplers"][0]["input"] = json!(99);
    assert!(told(&no_accessor).contains("accessor 99") || told(&no_accessor).contains("beyond the end"), "{}", told(&no_accessor));
    unexposed(&lost);
    // Two animations of one property: the first counts.
    let mut twice = with(&[0.0, 1.0], &[[0.0; 3], [2.0, 0.0, 0.0]]);
    animate(&mut twice, 0, "translation", "LINEAR", &[0.0, 1.0], &[[9.0; 3]; 2]);
    let scene = exposed(&twice, 0.5, 0.5);
    assert!(scene.notes_say("of several animations of the same property of a node the first is shown"));
    assert_near(&placed(&scene).w_axis.to_array(), &[1.0, 0.0, 0.0, 1.0], 1e-12, "the first");
    // What is scaled to nothing for a part of the time stands still.
    let mut shrinks = Model::square(json!({}));
    animate(&mut shrinks, 0, "scale", "LINEAR", &[0.0, 1.0], &[[1.0; 3], [0.0; 3]]);
    let scene = exposed(&shrinks, 0.5, 1.0);
    assert!(scene.notes_say("its scale is 0 during a part of the exposure: it is shown at rest"));
    assert_near(&placed(&scene).x_axis.to_array(), &[0.5, 0.0, 0.0, 0.0], 1e-12, "the size at the opening");
}
