//! Triangles in glTF, in every component type and every topology.

use glam::{Vec2, Vec3};
use pt::shape::MeshData;
use serde_json::{Value, json};

use super::model::{CORNERS, F32, Model, U8, U16, U32};
use crate::import::read::{Read, assert_near, read};

fn read_model(model: &Model) -> Read {
    let folder = tempfile::tempdir().expect("a folder");
    model.write(folder.path(), "scene.glb");
    read(&folder.path().join("scene.glb"))
}

/// A node with one primitive.
fn shown(mut model: Model, primitive: Value) -> MeshData {
    let mesh = model.add("meshes", json!({ "primitives": [primitive] }));
    model.node(json!({ "mesh": mesh }));
    read_model(&model).mesh(0)
}

fn corners() -> Vec<Vec3> {
    CORNERS.map(Vec3::from).to_vec()
}

/// Triangles as the positions of their corners, so that the order of vertices does not matter.
fn places(mesh: &MeshData) -> Vec<[Vec3; 3]> {
    mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])).collect()
}

#[test]
fn indices_of_every_width() {
    let [a, b, c, d]: [Vec3; 4] = corners().try_into().expect("four");
    for (component, width) in [(U8, 1), (U16, 2), (U32, 4)] {
        let mut model = Model::new();
        let position = model.floats(&CORNERS);
        let bytes: Vec<u8> = [0u32, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()[..width].to_vec()).collect();
        let indices = model.accessor(&bytes, component, "SCALAR", 6);
        let mesh = shown(model, json!({ "attributes": { "POSITION": position }, "indices": indices }));
        assert_eq!(places(&mesh), [[a, b, c], [a, c, d]], "{width} bytes");
        assert!(mesh.normals.is_empty(), "what has no normals is faceted");
    }
}

/// Strips and fans as §3.7.2.1 numbers them; every triangle faces +z.
#[test]
fn strips_and_fans() {
    let [a, b, c, d]: [Vec3; 4] = corners().try_into().expect("four");
    for (mode, order, expected) in [(5, [a, b, d, c], [[a, b, d], [b, c, d]]), (6, [a, b, c, d], [[b, c, a], [c, d, a]])] {
        let mut model = Model::new();
        let position = model.floats(&order.map(|p| p.to_array()));
        let mesh = shown(model, json!({ "attributes": { "POSITION": position }, "mode": mode }));
        assert_eq!(places(&mesh), expected, "mode {mode}");
        assert!(mesh.triangles.iter().all(|&t| mesh.cross(t).z > 0.0));
    }
}

/// An accessor with a stride of 20 bytes and an offset of 4 bytes.
#[test]
fn strided_accessors_are_read() {
    let mut model = Model::new();
    let mut bytes = vec![0xff; 4];
    for corner in CORNERS {
        bytes.extend(corner.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0xff; 8]);
    }
    let position = model.accessor(&bytes, F32, "VEC3", 4);
    model.doc["bufferViews"][0]["byteStride"] = json!(20);
    model.doc["accessors"][position]["byteOffset"] = json!(4);
    let mesh = shown(model, json!({ "attributes": { "POSITION": position }, "mode": 6 }));
    assert_eq!(mesh.positions, corners());
}

/// Sparse accessors: one without a buffer, in which two elements are replaced, and one with a buffer, in which one is.
#[test]
fn sparse_accessors_replace_rows() {
    for with_view in [false, true] {
        let mut model = Model::new();
        let base = [[0.0f32; 3], [9.0, 9.0, 9.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let (base, places, values): (_, &[u8], &[[f32; 3]]) = match with_view {
            true => (base.to_vec(), &[1], &[CORNERS[1]]),
            false => (vec![], &[1, 2, 3], &[CORNERS[1], CORNERS[2], CORNERS[3]]),
        };
        let indices = model.bytes(places);
        let floats: Vec<u8> = values.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let replacements = model.bytes(&floats);
        let sparse = json!({ "count": places.len(), "indices": { "bufferView": indices, "componentType": U8 }, "values": { "bufferView": replacements } });
        let mut accessor = json!({ "componentType": F32, "type": "VEC3", "count": 4, "sparse": sparse });
        if with_view {
            let bytes: Vec<u8> = base.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
            accessor["bufferView"] = json!(model.bytes(&bytes));
        }
        let position = model.add("accessors", accessor);
        let mesh = shown(model, json!({ "attributes": { "POSITION": position }, "mode": 6 }));
        assert_eq!(mesh.positions, corners(), "{with_view}");
    }
}

/// Normalized integers are c/255, c/65535 and max(c/127, −1), and others keep their values (KHR_mesh_quantization).
#[test]
fn normalized_and_plain_integers_are_decoded() {
    let mut model = Model::new();
    model.doc["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    model.doc["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let shorts: Vec<u8> =
        [[0u16, 0, 0, 0], [30, 0, 0, 0], [30, 20, 0, 0], [0, 20, 0, 0]].as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let position = model.accessor(&shorts, U16, "VEC3", 4);
    model.doc["bufferViews"][0]["byteStride"] = json!(8);
    let normal = model.accessor(&[0, 0x80, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0], 5120, "VEC3", 4);
    model.doc["bufferViews"][1]["byteStride"] = json!(4);
    let uv = model.accessor(&[0, 51, 255, 51, 255, 0, 0, 0], U8, "VEC2", 4);
    for accessor in [normal, uv] {
        model.doc["accessors"][accessor]["normalized"] = json!(true);
    }
    let mesh = shown(model, json!({ "attributes": { "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv }, "mode": 6 }));
    assert_eq!(mesh.positions[2], Vec3::new(30.0, 20.0, 0.0));
    // −128/127 is clamped to −1.
    assert_eq!(mesh.normals[..2], [Vec3::new(0.0, -1.0, 1.0), Vec3::Z]);
    // v upwards: 1 − 51/255.
    assert_eq!(mesh.uvs[..2], [Vec2::new(0.0, 0.8), Vec2::new(1.0, 0.8)]);
}

/// Vertices with a morph target of weight w are at p + w Δ.
#[test]
fn morph_targets_are_weighted() {
    let mut model = Model::new();
    let position = model.floats(&CORNERS);
    let moves = [[0.0, 0.0, 4.0], [0.0, 0.0, 2.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
    let target = model.floats(&moves);
    let primitive = json!({ "attributes": { "POSITION": position }, "mode": 6, "targets": [{ "POSITION": target }] });
    let mesh = model.add("meshes", json!({ "primitives": [primitive], "weights": [0.5] }));
    model.node(json!({ "mesh": mesh }));
    // A node's own weights go before the mesh's.
    model.node(json!({ "mesh": mesh, "weights": [1.0] }));
    let scene = read_model(&model);
    for (shape, weight) in [(0, 0.5), (1, 1.0)] {
        let expected: Vec<Vec3> = CORNERS.iter().zip(moves).map(|(p, by)| Vec3::from(*p) + Vec3::from(by) * weight).collect();
        assert_eq!(scene.mesh(shape).positions, expected, "weight {weight}");
    }
}

/// Vertices depend in equal parts on joint A, which moves by (2, 0, 0), and on joint B, which rotates by 90° about z. The transform of the
/// mesh's own node is ignored.
#[test]
fn skins_follow_their_joints() {
    let mut model = Model::new();
    let position = model.floats(&CORNERS);
    let normal = model.floats(&[[1.0, 0.0, 0.0]; 4]);
    let joints = model.accessor(&[0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0], U8, "VEC4", 4);
    let weights = model.floats(&[[0.5, 0.5, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]);
    let mut bind = [0.0f32; 16];
    [0, 5, 10, 15].into_iter().for_each(|i| bind[i] = 1.0);
    let mut lifted = bind;
    lifted[14] = 3.0;
    let binds = model.floats(&[bind, lifted]);
    let primitive =
        json!({ "attributes": { "POSITION": position, "NORMAL": normal, "JOINTS_0": joints, "WEIGHTS_0": weights }, "mode": 6 });
    let mesh = model.add("meshes", json!({ "primitives": [primitive] }));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let a = model.node(json!({ "translation": [2, 0, 0] }));
    let b = model.node(json!({ "rotation": [0.0, 0.0, half, half] }));
    let skin = model.add("skins", json!({ "joints": [a, b], "inverseBindMatrices": binds }));
    model.node(json!({ "mesh": mesh, "skin": skin, "translation": [100, 0, 0] }));
    let scene = read_model(&model);
    assert!(scene.at("/shapes/0").get("transform").is_none());
    let found = scene.mesh(0);
    // A: p + (2, 0, 0). B: (−y, x, z + 3).
    let expected = [[1.0, 0.0, 1.5], [1.5, 0.5, 1.5], [3.0, 1.0, 0.0], [-1.0, 0.0, 3.0]];
    for (found, expected) in found.positions.iter().zip(expected) {
        assert_near(&found.as_dvec3().to_array(), &expected, 1e-6, "place");
    }
    // The normal of the last vertex rotates with B.
    assert_near(&found.normals[3].as_dvec3().to_array(), &[0.0, 1.0, 0.0], 1e-6, "normal");
}

/// Points, lines, and triangles without area are left out, with a note.
#[test]
fn points_lines_and_degenerate_triangles_are_left_out() {
    let mut model = Model::square(json!({}));
    let flat = model.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    for (mode, attributes) in [(1, json!({ "POSITION": flat })), (4, json!({ "POSITION": flat })), (4, json!({}))] {
        let mesh = model.add("meshes", json!({ "primitives": [{ "attributes": attributes, "mode": mode }] }));
        model.node(json!({ "mesh": mesh }));
    }
    model.node(json!({ "mesh": 0, "scale": [1, 1, 0] }));
    let scene = read_model(&model);
    // The shapes are the square and the ground.
    assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(2));
    for sentence in
        ["points and lines are left out", "without area is left out", "without positions is left out", "scaled to nothing is left out"]
    {
        assert!(scene.notes_say(sentence), "{sentence}: {:?}", scene.notes);
    }
}
