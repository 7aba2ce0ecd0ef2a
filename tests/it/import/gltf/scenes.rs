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
fn nodes_inherit_the_transforms_of_their_parents() {
    let mut model = Model::new();
    let mesh = model.square_mesh(Value::Null);
    model.doc["meshes"][mesh]["primitives"][0].as_object_mut().expect("an object").remove("material");
    let child = model.add("nodes", json!({ "mesh": mesh, "translation": [1, 0, 0] }));
    model.node(json!({ "translation": [1, 2, 3], "rotation": quarter(), "scale": [2, 2, 2], "children": [child] }));
    // A second node has the composed transform as a matrix in column order, 10 m further along z, and the same mesh.
    model.node(json!({ "mesh": mesh, "matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 4, 13, 1] }));
    let scene = read_model(&model);
    let expected = |z: f64| [0.0, -2.0, 0.0, 1.0, 2.0, 0.0, 0.0, 4.0, 0.0, 0.0, 2.0, z, 0.0, 0.0, 0.0, 1.0];
    // The quaternion is read as f32.
    assert_near(&scene.numbers("/shapes/0/transform/0/matrix"), &expected(3.0), 1e-6, "of two nodes");
    assert_near(&scene.numbers("/shapes/1/transform/0/matrix"), &expected(13.0), 0.0, "of a matrix");
    assert_eq!(scene.at("/shapes/0/group"), scene.at("/shapes/1/group"));
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

/// The default scene of several is shown, without the nodes of the others.
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
    // The camera is rotated by 90° about y: −z becomes −x. The scale of the node does not apply to cameras.
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
fn light_intensities_become_watts() {
    let mut model = Model::square(json!({}));
    model.doc["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    let lights = json!([
        { "type": "point", "intensity": 683, "color": [1, 0.5, 0.25], "name": "bulb" },
        { "type": "directional", "intensity": 1366 },
        { "type": "spot", "intensity": 2049, "spot": { "innerConeAngle": PI / 6.0, "outerConeAngle": PI / 4.0 } },
    ]);
    model.doc["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
    // The light is rotated by 90° about x: −z becomes +y.
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

/// Emission without a strength is no light: such files were made for rasterisers, where emission does not light other surfaces. Emission
/// with a strength is a light, even if it is weak.
#[test]
fn emission_with_a_strength_is_a_light() {
    let strong = |strength: f64| {
        json!({ "emissiveFactor": [1, 0.5, 0], "doubleSided": true,
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": strength } } })
    };
    for plain in [json!({ "emissiveFactor": [1, 0.5, 0] }), strong(0.0)] {
        let dim = read_model(&Model::square(plain));
        assert!(dim.notes_say("no light") && dim.tree.get("background").is_some());
    }
    for strength in [0.25, 1.0, 8.0] {
        let lamp = read_model(&Model::square(strong(strength)));
        assert!(!lamp.notes_say("no light") && lamp.tree.get("background").is_none());
        assert_near(&lamp.numbers("/shapes/0/emission/radiance"), &[strength, 0.5 * strength, 0.0], 0.0, "radiance");
        assert_eq!(lamp.at("/shapes/0/emission/two_sided"), true);
    }
}

/// Each copy stands at node · T · R · S: the square's corner (1, 0, 0), turned a quarter about z and scaled, lies at t + s (0, 1, 0).
#[test]
fn instances_of_a_mesh_are_placed() {
    let mut model = Model::square(json!({}));
    let translations = model.floats(&[[0.0, 0.0, 0.0], [5.0, 0.0, 1.0], [0.0, 7.0, 2.0]]);
    let turn = [0.0, 0.0, FRAC_1_SQRT_2 as f32, FRAC_1_SQRT_2 as f32];
    let rotations = model.floats(&[turn; 3]);
    let scales = model.floats(&[[1.0, 1.0, 1.0], [2.0, 2.0, 2.0], [3.0, 3.0, 3.0]]);
    let attributes = json!({ "TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales });
    model.doc["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    model.doc["nodes"][0]["translation"] = json!([100, 0, 0]);
    model.doc["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    // A second node shows the same mesh once.
    model.node(json!({ "mesh": 0, "translation": [0, 0, -50] }));
    let scene = read_model(&model);
    assert_eq!(scene.notes.iter().filter(|note| !note.contains("no camera") && !note.contains("no light")).count(), 0, "{:?}", scene.notes);
    let built = scene.built();
    for (t, s) in [([0.0, 0.0, 0.0], 1.0), ([5.0, 0.0, 1.0], 2.0), ([0.0, 7.0, 2.0], 3.0)] {
        // (x, y) of the square lies at t + s (−y, x): its middle at t + s (−½, ½).
        let middle = [100.0 + t[0] - 0.45 * s, t[1] + 0.55 * s, t[2] + 0.5];
        met(&built, middle, [0.0, 0.0, -1.0], |surface, p| {
            assert_near(&p.to_array(), &[middle[0], middle[1], t[2]], 1e-4, "place");
            assert_near(&surface.point.uv.as_dvec2().to_array(), &[0.55, 0.45], 1e-4, "which place of the square");
        });
    }
    assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(3), "the instances of both nodes and the ground");
    assert_eq!((built.world.instance_count(), built.world.primitive_count()), (4, 2 + 1), "one square, and the ground");
    // Counts that do not agree are refused.
    model.doc["accessors"][scales]["count"] = json!(2);
    let folder = tempfile::tempdir().expect("a folder");
    model.write(folder.path(), "scene.gltf");
    let said = crate::import::read::try_read(&folder.path().join("scene.gltf")).err().map(|e| e.to_string()).unwrap_or_default();
    assert!(said.contains("EXT_mesh_gpu_instancing/attributes: 3 translations, 3 rotations and 2 scales"), "{said}");
}

/// Models of other programs, if they are available beside the project.
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
