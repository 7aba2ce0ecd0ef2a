//! Nodes, cameras and lights.

use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::path::Path;

use serde_json::{Value, json};

use super::model::Model;
use crate::import::read::{Read, assert_near, met, read};

fn read_model(model: &Model) -> Read {
    let folder = tempfile::tempdir().expect("a folder");
    model.write(folder.path(), "scene.gltf");
    read(&folder.path().join("scene.gltf"))
}

/// A quarter turn about z, as a quaternion.
fn quarter() -> Value {
    json!([0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2])
}

/// p → 2 Rz(90°)(p + (1, 0, 0)) + (1, 2, 3), for a node within a node.
#[test]
fn nodes_stand_where_their_parents_put_them() {
    let mut model = Model::new();
    let mesh = model.square_mesh(Value::Null);
    model.doc["meshes"][mesh]["primitives"][0].as_object_mut().expect("an object").remove("material");
    let child = model.add("nodes", json!({ "mesh": mesh, "translation": [1, 0, 0] }));
    model.node(json!({ "translation": [1, 2, 3], "rotation": quarter(), "scale": [2, 2, 2], "children": [child] }));
    // The same, as a matrix, column by column; its mesh is the same file.
    model.node(json!({ "mesh": mesh, "matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 4, 13, 1] }));
    let scene = read_model(&model);
    let expected = |z: f64| [0.0, -2.0, 0.0, 1.0, 2.0, 0.0, 0.0, 4.0, 0.0, 0.0, 2.0, z, 0.0, 0.0, 0.0, 1.0];
    // The quaternion is read as f32.
    assert_near(&scene.numbers("/shapes/0/transform/0/matrix"), &expected(3.0), 1e-6, "of two nodes");
    assert_near(&scene.numbers("/shapes/1/transform/0/matrix"), &expected(13.0), 0.0, "of a matrix");
    assert_eq!(scene.at("/shapes/0/file"), scene.at("/shapes/1/file"));
    // (x, y) of the square is at (1 − 2 y, 4 + 2 x).
    let built = scene.built();
    met(&built, [0.5, 4.5, 20.0], [0.0, 0.0, -1.0], |surface, p| {
        assert_near(&p.to_array(), &[0.5, 4.5, 13.0], 1e-5, "place");
        assert_near(&surface.point.ng.as_dvec3().to_array(), &[0.0, 0.0, 1.0], 1e-6, "normal");
        assert_near(&surface.point.uv.as_dvec2().to_array(), &[0.25, 0.25], 1e-6, "texture coordinates, v upwards");
    });
}

#[test]
fn a_mirrored_node_keeps_its_front() {
    let mut model = Model::square(json!({}));
    model.doc["nodes"][0]["scale"] = json!([-1, 1, 1]);
    met(&read_model(&model).built(), [-0.5, 0.5, 3.0], [0.0, 0.0, -1.0], |surface, _| {
        assert!(surface.point.ng.z > 0.0 && surface.point.ns.z > 0.0, "{:?}", surface.point);
    });
}

/// Of several scenes the default one; nodes of others are not shown.
#[test]
fn the_default_scene_is_shown() {
    let mut model = Model::square(json!({}));
    let other = model.add("nodes", json!({ "mesh": 0, "name": "other" }));
    model.add("scenes", json!({ "nodes": [other] }));
    model.doc["scene"] = json!(1);
    let scene = read_model(&model);
    assert_eq!(scene.at("/shapes/0/name"), "other");
    assert!(scene.notes_say("/scenes: of 2 scenes number 1 is shown"), "{:?}", scene.notes);
}

#[test]
fn cameras_look_down_their_nodes() {
    let mut model = Model::square(json!({}));
    let camera = json!({ "type": "perspective", "perspective": { "yfov": PI / 3.0, "aspectRatio": 2.0, "znear": 0.1 } });
    let [first, second] = [
        model.add("cameras", camera),
        model.add("cameras", json!({ "type": "orthographic", "orthographic": { "xmag": 3, "ymag": 2, "zfar": 9, "znear": 1 } })),
    ];
    // A quarter turn about y: −z becomes −x. The scale is no part of a camera.
    model.node(
        json!({ "camera": first, "translation": [5, 1, 2], "rotation": [0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2], "scale": [3, 3, 3] }),
    );
    model.node(json!({ "camera": second }));
    let scene = read_model(&model);
    assert_near(&[scene.number("/camera/fov")], &[60.0], 1e-5, "fov");
    assert_near(&scene.numbers("/camera/look_at/from"), &[5.0, 1.0, 2.0], 0.0, "from");
    assert_near(&scene.numbers("/camera/look_at/to"), &[4.0, 1.0, 2.0], 1e-6, "to");
    assert_near(&scene.numbers("/camera/look_at/up"), &[0.0, 1.0, 0.0], 1e-6, "up");
    assert_eq!((scene.number("/film/width"), scene.number("/film/height")), (640.0, 320.0));
    assert!(scene.notes_say("/cameras: the first camera of the scene is used, not 1"), "{:?}", scene.notes);
    assert!(!scene.notes_say("no camera"));
    model.doc["scenes"][0]["nodes"] = json!([0, 2]);
    let scene = read_model(&model);
    assert_eq!(scene.at("/camera/type"), "orthographic");
    // xmag and ymag are half of the picture.
    assert_eq!((scene.number("/camera/height"), scene.number("/film/height")), (4.0, (640.0f64 / 1.5).round()));
}

/// A candela is 1/683 W·sr⁻¹, a lux 1/683 W·m⁻².
#[test]
fn lights_are_told_in_watts() {
    let mut model = Model::square(json!({}));
    model.doc["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    let lights = json!([
        { "type": "point", "intensity": 683, "color": [1, 0.5, 0.25], "name": "bulb" },
        { "type": "directional", "intensity": 1366 },
        { "type": "spot", "intensity": 2049, "spot": { "innerConeAngle": PI / 6.0, "outerConeAngle": PI / 4.0 } },
    ]);
    model.doc["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
    // A quarter turn about x: −z becomes +y.
    let upwards = json!([FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]);
    for light in 0..3 {
        model.node(json!({ "translation": [1, 2, 3], "rotation": upwards, "scale": [9, 9, 9], "extensions": { "KHR_lights_punctual": { "light": light } } }));
    }
    let scene = read_model(&model);
    assert_eq!(scene.at("/lights/0/type"), "point");
    assert_eq!(scene.at("/lights/0/name"), "bulb");
    assert_near(&scene.numbers("/lights/0/intensity"), &[1.0, 0.5, 0.25], 1e-15, "intensity");
    assert_near(&scene.numbers("/lights/0/position"), &[1.0, 2.0, 3.0], 0.0, "position");
    assert_near(&scene.numbers("/lights/1/irradiance"), &[2.0; 3], 1e-15, "irradiance");
    assert_near(&scene.numbers("/lights/1/direction"), &[0.0, 1.0, 0.0], 1e-6, "direction");
    assert_near(&scene.numbers("/lights/2/intensity"), &[3.0; 3], 1e-15, "intensity");
    assert_near(&[scene.number("/lights/2/inner_angle"), scene.number("/lights/2/outer_angle")], &[30.0, 45.0], 1e-12, "cone");
    assert_eq!(scene.at("/lights/2/falloff"), "squared");
    assert!(scene.notes_say("683 lm = 1 W") && !scene.notes_say("no light"), "{:?}", scene.notes);
    assert!(scene.tree.get("background").is_none(), "a file with lights gets no sky");
}

/// What only glows is no light: it was made for rasterisers, to which emission lights nothing. What is brighter than white is one.
#[test]
fn emission_that_is_brighter_than_white_is_a_light() {
    let strong = |strength: f64| {
        json!({ "emissiveFactor": [1, 0.5, 0], "doubleSided": true,
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": strength } } })
    };
    let dim = read_model(&Model::square(strong(1.0)));
    assert!(dim.notes_say("no light") && dim.tree.get("background").is_some());
    let bright = read_model(&Model::square(strong(8.0)));
    assert!(!bright.notes_say("no light") && bright.tree.get("background").is_none());
    assert_near(&bright.numbers("/shapes/0/emission/radiance"), &[8.0, 4.0, 0.0], 0.0, "radiance");
    assert_eq!(bright.at("/shapes/0/emission/two_sided"), true);
}

/// Files that are not ours, where they lie beside the package.
#[test]
fn shared_models_load() {
    let Some(folder) = crate::shared::shared("models") else { return };
    let mut found = vec![];
    let mut open = vec![folder];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
            if entry.path().is_dir() { open.push(entry.path()) } else { found.push(entry.path()) }
        }
    }
    let is_model = |path: &Path| path.extension().is_some_and(|e| e == "gltf" || e == "glb" || e == "obj");
    for path in found.iter().filter(|path| is_model(path)) {
        let scene = read(path);
        assert!(!scene.at("/shapes").as_array().expect("shapes").is_empty(), "{}", path.display());
    }
}
