//! Faults of glTF files are reported with their position, and no input causes a panic.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::model::{Model, picture};
use crate::import::read::try_read;
use crate::random::Random;

/// A file with an object of each kind.
fn whole() -> Model {
    let mut model = Model::square(json!({}));
    let texture = model.texture(picture([[[200; 4], [9; 4]]]), json!({}));
    let pbr = json!({ "baseColorFactor": [0.5, 0.5, 0.5, 1], "baseColorTexture": { "index": texture }, "metallicFactor": 0 });
    model.doc["materials"][0] = json!({ "name": "wood", "pbrMetallicRoughness": pbr, "alphaMode": "MASK" });
    let camera = model.add("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }));
    model.node(json!({ "camera": camera, "translation": [0, 0, 3] }));
    model.doc["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 100 }] } });
    model.node(json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } }, "rotation": [0, 0, 1, 0] }));
    model
}

type Edit = fn(&mut Value);

/// Changes of the file, and the messages about them.
const FAULTS: &[(Edit, &str)] = &[
    (|doc| doc["asset"]["version"] = json!("1.0"), "/asset/version: expected glTF of version 2, found \"1.0\""),
    (
        |doc| doc["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]),
        "/extensionsRequired/0: the file needs the extension KHR_draco_mesh_compression, which pt does not read: save the file without",
    ),
    (|doc| doc["scene"] = json!(7), "/scene: an index beyond the end of its list"),
    (
        |doc| doc["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(99),
        "/meshes/0/primitives/0/attributes/POSITION: an index beyond",
    ),
    (|doc| doc["meshes"][0]["primitives"][0]["material"] = json!(5), "/meshes/0/primitives/0/material: an index beyond"),
    (|doc| doc["meshes"][0]["primitives"][0]["mode"] = json!(9), "/meshes/0/primitives/0/mode: a value that glTF does not allow"),
    (|doc| doc["meshes"][0]["primitives"] = json!(3), "/meshes/0/primitives: expected an array, found 3"),
    (|doc| doc["accessors"][0]["count"] = json!(5000), "/accessors/0: 5000 rows of 12 bytes reach beyond bufferView 0"),
    (|doc| doc["accessors"][0]["count"] = json!(u64::MAX / 2), "/accessors/0: 9223372036854775807 rows of 12 bytes reach beyond"),
    (|doc| doc["accessors"][0]["byteOffset"] = json!(u64::MAX / 2), "/accessors/0: 4 rows of 12 bytes reach beyond"),
    (|doc| doc["accessors"][0]["type"] = json!("VEC2"), "/accessors/0: expected rows of 3 numbers, found 2"),
    (|doc| doc["accessors"][0]["componentType"] = json!(1), "/accessors/0/componentType: a value that glTF does not allow"),
    (|doc| doc["accessors"][1]["count"] = json!(3), "/meshes/0/primitives/0: 3 rows of NORMAL, but there are 4 positions"),
    (|doc| doc["accessors"][3]["componentType"] = json!(5126), "/accessors/3: expected whole numbers"),
    (
        |doc| doc["accessors"][0] = json!({ "componentType": 5126, "type": "VEC3", "count": 3 }),
        "/meshes/0/primitives/0: 4 rows of NORMAL, but there are 3 positions",
    ),
    (
        |doc| {
            // The file lists the extension only in `extensionsUsed`, and its accessors have no bytes.
            drop(doc["accessors"][0].as_object_mut().and_then(|a| a.remove("bufferView")));
            doc["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
            doc["meshes"][0]["primitives"][0]["extensions"] =
                json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": {} } });
        },
        "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression: compressed by KHR_draco_mesh_compression, which pt does not read",
    ),
    (
        |doc| {
            drop(doc["buffers"][0].as_object_mut().and_then(|b| b.remove("uri")));
            doc["buffers"][0]["extensions"] = json!({ "EXT_meshopt_compression": { "fallback": true } });
        },
        "/buffers/0/extensions/EXT_meshopt_compression: compressed by EXT_meshopt_compression, which pt does not read",
    ),
    (|doc| doc["bufferViews"][0]["byteLength"] = json!(u64::MAX), "/accessors/0: 4 rows of 12 bytes reach beyond bufferView 0"),
    (|doc| doc["bufferViews"][0]["byteStride"] = json!(4), "/accessors/0: rows of 12 bytes, 4 bytes apart"),
    (|doc| doc["bufferViews"][0]["buffer"] = json!(1), "/bufferViews/0/buffer: an index beyond"),
    (|doc| doc["buffers"][0]["byteLength"] = json!(100_000), "/buffers/0: 100000 bytes are promised, found"),
    (|doc| doc["buffers"][0]["uri"] = json!("data:application/octet-stream;base64,@@"), "/buffers/0/uri: no base64"),
    (|doc| doc["buffers"][0]["uri"] = json!("data:text/plain,abc"), "/buffers/0/uri: expected a data uri in base64"),
    (|doc| doc["buffers"][0]["uri"] = json!("none.bin"), "/buffers/0/uri: none.bin: no such file"),
    (|doc| doc["buffers"][0]["uri"] = json!("../secret.bin"), "/buffers/0/uri: ../secret.bin: leads out of the scene file's folder"),
    (|doc| doc["buffers"][0]["uri"] = json!("%2e%2e/secret.bin"), "/buffers/0/uri: ../secret.bin: leads out of the scene file's folder"),
    (|doc| doc["buffers"][0]["uri"] = json!("https://example.org/a.bin"), "/buffers/0/uri: expected the name of a file"),
    (|doc| drop(doc["buffers"][0].as_object_mut().and_then(|b| b.remove("uri"))), "/buffers/0: expected a uri, or a .glb"),
    (|doc| doc["images"][0] = json!({ "uri": "/etc/passwd" }), "/images/0/uri: /etc/passwd: is no path from the scene file's folder"),
    (
        |doc| doc["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = json!(4),
        "/materials/0/pbrMetallicRoughness/baseColorTexture/index: an index beyond",
    ),
    (
        |doc| doc["materials"][0]["extensions"] = json!({ "KHR_materials_clearcoat": { "clearcoatTexture": { "index": 4 } } }),
        "/materials/0/extensions/KHR_materials_clearcoat/clearcoatTexture/index: texture 4, but there are 1",
    ),
    (
        |doc| doc["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = json!([2, 0, 0, 1]),
        "/materials/0/pbrMetallicRoughness/baseColorFactor: expected a number from 0 to 1, found 2",
    ),
    (
        |doc| doc["materials"][0]["extensions"] = json!({ "KHR_materials_sheen": { "sheenColorFactor": [1, 2] } }),
        "/materials/0/extensions/KHR_materials_sheen/sheenColorFactor: expected 3 numbers, found 2",
    ),
    (|doc| doc["nodes"][1]["children"] = json!([1]), "/nodes/1: a node within itself"),
    (|doc| doc["nodes"][1]["children"] = json!([2, 2]), "/nodes/2: a node with two parents"),
    (
        |doc| doc["nodes"][2]["extensions"]["KHR_lights_punctual"]["light"] = json!(3),
        "/nodes/2/extensions/KHR_lights_punctual/light: light 3, which is not there",
    ),
    (
        |doc| doc["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = json!("laser"),
        "/extensions/KHR_lights_punctual/lights/0/type: expected \"directional\", \"point\" or \"spot\"",
    ),
    (|doc| doc["cameras"][0]["type"] = json!("orthographic"), "/cameras/0: missing key \"orthographic\""),
    (|doc| doc["images"][0] = json!({}), "/images/0: a picture needs a uri or a bufferView"),
    (|doc| doc["images"][0] = json!({ "bufferView": 0, "uri": "../a.png" }), "/images/0/uri: ../a.png: leads out"),
    (|doc| doc["textures"][0]["source"] = json!(8), "/textures/0/source: an index beyond"),
    (|doc| doc["cameras"][0]["perspective"]["yfov"] = json!(4), "/cameras/0/perspective: expected an angle in degrees"),
    (|doc| doc["cameras"][0]["perspective"]["aspectRatio"] = json!(0), "/cameras/0/perspective: a picture without width or height"),
];

/// The error message about a file; empty if it is read.
fn said(folder: &Path, name: &str, bytes: &[u8]) -> String {
    let path = folder.join(name);
    fs::write(&path, bytes).expect("a file");
    match try_read(&path) {
        Ok(_) => String::new(),
        Err(error) => {
            assert!(matches!(error.exit_code(), 3 | 4), "{name}: exit code {}: {error}", error.exit_code());
            error.to_string()
        }
    }
}

#[test]
fn every_fault_has_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(said(folder.path(), "whole.gltf", &whole().gltf()), "");
    for (edit, expected) in FAULTS {
        let mut model = whole();
        let mut doc: Value = serde_json::from_slice(&model.gltf()).expect("JSON");
        edit(&mut doc);
        let found = said(folder.path(), "edited.gltf", &serde_json::to_vec_pretty(&doc).expect("JSON"));
        assert!(found.contains(expected), "expected {expected}, found {found:?}");
        let has_line = found.lines().all(|line| line.split(':').nth(1).is_some_and(|number| number.parse::<u32>().is_ok()));
        assert!(has_line, "no line in {found}");
        // The fault is also found in a container, which has no lines (and whose buffer is its own).
        if !expected.contains("/buffers/") {
            doc.as_object_mut().expect("an object").remove("buffers");
            model.doc = doc;
            let found = said(folder.path(), "edited.glb", &model.glb());
            assert!(found.contains(expected), "in a container: expected {expected}, found {found:?}");
        }
    }
}

/// Faults in parts that are left out of the picture are no reason to refuse the file.
#[test]
fn faults_in_unread_parts_are_ignored() {
    let edits: &[(Edit, &str)] = &[
        (|doc| doc["animations"] = json!([{ "channels": [], "samplers": [{ "input": 99, "output": 0, "interpolation": 0 }] }]), ""),
        (|doc| doc["animations"] = json!(7), ""),
        (|doc| doc["extras"] = json!("text"), ""),
        (|doc| doc["nodes"][0]["extras"] = json!([1, null, "text"]), ""),
        (|doc| doc["extensionsUsed"] = json!(["ACME_a"]), "what it adds does not show"),
        (|doc| doc["nodes"][0]["extensions"] = json!({ "ACME_a": 5 }), ""),
        (|doc| doc["meshes"][0]["primitives"][0]["extensions"] = json!({ "ACME_a": [{}] }), ""),
        (|doc| doc["meshes"][0]["primitives"][0]["attributes"]["_TEMPERATURE"] = json!(0), ""),
        (|doc| doc["meshes"][0]["primitives"][0]["attributes"]["_FEATURE_ID_0"] = json!(99), ""),
        (|doc| doc["meshes"][0]["primitives"][0]["attributes"]["TEMPERATURE"] = json!(0), ""),
        (|doc| doc["meshes"][0]["name"] = Value::Null, ""),
        (
            // Lines are not read, so that their invalid indices do not matter.
            |doc| {
                let primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 1, "mode": 3 });
                doc["meshes"][0]["primitives"].as_array_mut().expect("a list").push(primitive)
            },
            "points and lines are left out",
        ),
    ];
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("edited.gltf");
    for (edit, note) in edits {
        let mut doc: Value = serde_json::from_slice(&whole().gltf()).expect("JSON");
        edit(&mut doc);
        fs::write(&path, serde_json::to_vec_pretty(&doc).expect("JSON")).expect("a file");
        let scene = try_read(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene.at("/shapes").as_array().map(Vec::len), Some(1), "the square is there");
        assert!(scene.notes_say(note), "{note}: {:?}", scene.notes);
    }
}

/// A file with Draco compression that also has the uncompressed triangles is read from those.
#[test]
fn compressed_triangles_with_uncompressed_copies_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut model = whole();
    model.doc["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    model.doc["meshes"][0]["primitives"][0]["extensions"] = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": {} } });
    assert_eq!(said(folder.path(), "both.gltf", &model.gltf()), "");
}

#[test]
fn invalid_containers_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = whole().glb();
    let changed = |at: usize, to: [u8; 4]| [&bytes[..at], &to, &bytes[at + 4..]].concat();
    for (bytes, expected) in [
        (b"glTF".to_vec(), "the .glb ends within its header"),
        (bytes[..11].to_vec(), "the .glb ends within its header"),
        (changed(8, [3, 0, 0, 0]), "the .glb ends within its header"),
        (changed(4, [1, 0, 0, 0]), "a .glb of version 1, expected version 2"),
        (bytes[..bytes.len() - 8].to_vec(), "bytes after its header, found"),
        (changed(12, [0xff; 4]), "a chunk of the .glb promises 4294967295 bytes"),
        (changed(16, *b"BIN\0"), "the chunks of the .glb are not JSON"),
        (changed(20, *b"[[[["), "broken.glb:1:5: in the JSON of the .glb: "),
    ] {
        let found = said(folder.path(), "broken.glb", &bytes);
        assert!(found.contains(expected), "expected {expected}, found {found:?}");
    }
}

/// Files with changed bytes, and truncated files, are read or refused with one of two exit codes, and cause no panic.
#[test]
fn any_bytes_are_read_or_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut random = Random::new(7);
    for (name, bytes) in [("fuzz.gltf", whole().gltf()), ("fuzz.glb", whole().glb())] {
        for round in 0..600 {
            let mut mutant = bytes.clone();
            for _ in 0..=random.below(3) {
                let at = random.below(mutant.len());
                match random.below(4) {
                    0 => mutant[at] = random.below(256) as u8,
                    1 => mutant[at] ^= 1 << random.below(8),
                    2 => mutant[at] = random.pick(b"0189-.[]{},:\"e"),
                    _ => drop(mutant.remove(at)),
                }
            }
            if round % 10 == 0 {
                mutant.truncate(random.below(mutant.len()));
            }
            let path = folder.path().join(name);
            fs::write(&path, &mutant).expect("a file");
            // A file that no longer looks like glTF is refused by another reader.
            match try_read(&path) {
                Ok(scene) => scene.files.made.keys().filter(|file| file.ends_with(".ply")).for_each(|file| drop(scene.files.mesh(file))),
                Err(error) => assert!(matches!(error.exit_code(), 3 | 4), "{name}, round {round}: {error}"),
            }
        }
    }
}

/// Ten thousand nested nodes do not overflow the stack.
#[test]
fn long_chains_of_nodes_do_not_overflow_the_stack() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut model = Model::square(json!({}));
    const COUNT: usize = 10_000;
    for i in 1..COUNT {
        model.add("nodes", json!({ "children": [i + 1] }));
    }
    model.add("nodes", json!({ "mesh": 0 }));
    model.doc["scenes"][0]["nodes"] = json!([1]);
    assert_eq!(said(folder.path(), "chain.gltf", &model.gltf()), "");
}
