//! The glTF table of docs/import.md: each row is tested with a file.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::model::{Model, picture, webp};
use crate::import::read::try_read;
use crate::import::table::rows;

/// The row's construct, and a file that has it.
type Row = (&'static str, fn(&mut Model));

fn textured(model: &mut Model, slot: &str, sampler: Value) {
    let texture = model.texture(picture([[[128, 128, 255, 128]]]), sampler);
    *model.doc["materials"][0].pointer_mut(slot).expect("a slot") = json!({ "index": texture });
}

fn picture_of(model: &mut Model, kind: &str, bytes: &[u8]) {
    let view = model.bytes(bytes);
    model.add("images", json!({ "bufferView": view, "mimeType": kind }));
}

fn extended(model: &mut Model, extension: &str, value: Value) {
    model.doc["materials"][0]["extensions"][extension] = value;
}

fn light(model: &mut Model, value: Value) {
    model.doc["extensions"] = json!({ "KHR_lights_punctual": { "lights": [value] } });
    model.node(json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
}

fn attribute(model: &mut Model, name: &str) {
    let accessor = model.floats(&[[1.0, 0.5, 0.25, 1.0]; 4]);
    model.doc["meshes"][0]["primitives"][0]["attributes"][name] = json!(accessor);
}

fn mode(model: &mut Model, mode: u32) {
    model.doc["meshes"][0]["primitives"][0]["mode"] = json!(mode);
}

const ROWS: &[Row] = &[
    ("`.gltf` with data uris, `.glb`", |_| {}),
    ("a uri that leads out of the folder", |m| {
        m.add("images", json!({ "uri": "../a.png" }));
        m.add("textures", json!({ "source": 0 }));
        m.doc["materials"][0]["normalTexture"] = json!({ "index": 0 });
    }),
    ("`asset.version` other than 2", |m| m.doc["asset"]["version"] = json!("1.0")),
    ("`extensionsRequired` with an extension that is not in this table (Draco, meshopt, …)", |m| {
        m.doc["extensionsRequired"] = json!(["KHR_draco_mesh_compression"])
    }),
    ("`extensionsUsed` with one", |m| m.doc["extensionsUsed"] = json!(["ACME_something"])),
    ("`extras`, attributes of applications (`_TEMPERATURE`)", |m| attribute(m, "_TEMPERATURE")),
    ("triangles or a buffer that only Draco or meshopt holds", |m| {
        m.doc["accessors"][0].as_object_mut().expect("an object").remove("bufferView");
        m.doc["meshes"][0]["primitives"][0]["extensions"] = json!({ "KHR_draco_mesh_compression": {} });
    }),
    ("several `scenes`", |m| {
        m.add("scenes", json!({ "nodes": [] }));
    }),
    ("`nodes`, their `matrix` or `translation`, `rotation` and `scale`", |m| m.doc["nodes"][0]["rotation"] = json!([0, 0, 1, 0])),
    ("a node that is scaled to nothing", |m| m.doc["nodes"][0]["scale"] = json!([1, 0, 1])),
    ("nodes that are no trees", |m| m.doc["nodes"][0]["children"] = json!([0])),
    ("`animations`", |m| {
        let times = m.floats(&[[0.0]]);
        let values = m.floats(&[[0.0, 0.0, 0.0]]);
        let channel = json!({ "sampler": 0, "target": { "node": 0, "path": "translation" } });
        m.add("animations", json!({ "channels": [channel], "samplers": [{ "input": times, "output": values }] }));
    }),
    ("`skins`, morph targets", |m| m.doc["nodes"][0]["weights"] = json!([])),
    ("triangles, strips, fans; normals, `TEXCOORD_n`", |m| mode(m, 5)),
    ("integer and `sparse` accessors, KHR_mesh_quantization", |m| m.doc["extensionsRequired"] = json!(["KHR_mesh_quantization"])),
    ("points and lines", |m| mode(m, 1)),
    ("`TANGENT`", |m| attribute(m, "TANGENT")),
    ("`COLOR_0`", |m| attribute(m, "COLOR_0")),
    ("EXT_mesh_gpu_instancing", |m| {
        let translations = m.floats(&[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        let attributes = json!({ "TRANSLATION": translations });
        m.doc["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    }),
    ("an accessor that reaches beyond its buffer", |m| m.doc["accessors"][0]["count"] = json!(99)),
    ("the first camera", |m| {
        m.add("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }));
        m.node(json!({ "camera": 0 }));
    }),
    ("more cameras", |m| {
        m.add("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }));
        m.node(json!({ "camera": 0 }));
        m.node(json!({ "camera": 0 }));
    }),
    ("KHR_lights_punctual", |m| light(m, json!({ "type": "point" }))),
    ("`range` of a light", |m| light(m, json!({ "type": "point", "range": 3 }))),
    ("`pbrMetallicRoughness`, factors and textures", |m| textured(m, "/pbrMetallicRoughness/metallicRoughnessTexture", json!({}))),
    ("`normalTexture` and its `scale`", |m| textured(m, "/normalTexture", json!({}))),
    ("`occlusionTexture`", |m| textured(m, "/occlusionTexture", json!({}))),
    ("`emissiveFactor`, `emissiveTexture`, KHR_materials_emissive_strength", |m| {
        m.doc["materials"][0]["emissiveFactor"] = json!([1, 1, 1])
    }),
    ("`alphaMode` MASK", |m| {
        m.doc["materials"][0]["alphaMode"] = json!("MASK");
        textured(m, "/pbrMetallicRoughness/baseColorTexture", json!({}));
    }),
    ("`alphaMode` BLEND", |m| m.doc["materials"][0]["alphaMode"] = json!("BLEND")),
    ("either on what emits", |m| {
        m.doc["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
        m.doc["materials"][0]["alphaMode"] = json!("MASK");
        textured(m, "/pbrMetallicRoughness/baseColorTexture", json!({}));
    }),
    ("`doubleSided`", |m| m.doc["materials"][0]["doubleSided"] = json!(true)),
    ("`samplers`: wrapping, `magFilter`", |m| {
        textured(m, "/pbrMetallicRoughness/baseColorTexture", json!({ "magFilter": 9728, "wrapS": 33071, "wrapT": 33071 }))
    }),
    ("`wrapS` and `wrapT` that differ", |m| {
        textured(m, "/pbrMetallicRoughness/baseColorTexture", json!({ "wrapS": 33071, "wrapT": 10497 }))
    }),
    ("KHR_texture_transform, `texCoord`, the same for all textures of a material", |m| {
        textured(m, "/pbrMetallicRoughness/baseColorTexture", json!({}));
        m.doc["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
            json!({ "KHR_texture_transform": { "scale": [2, 2] } });
    }),
    ("different ones within a material", |m| {
        textured(m, "/pbrMetallicRoughness/baseColorTexture", json!({}));
        textured(m, "/normalTexture", json!({}));
        m.doc["materials"][0]["normalTexture"]["texCoord"] = json!(1);
    }),
    ("pictures in PNG, JPEG, and WebP (EXT_texture_webp)", |m| {
        picture_of(m, "image/webp", &webp(picture([[[128, 128, 255, 128]]])));
        m.add("textures", json!({ "extensions": { "EXT_texture_webp": { "source": 0 } } }));
        m.doc["materials"][0]["normalTexture"] = json!({ "index": 0 });
    }),
    ("pictures in KTX2 (KHR_texture_basisu) or any other format, where there is no other", |m| {
        picture_of(m, "image/ktx2", b"\xABKTX 20\xBB\r\n\x1A\n");
        m.add("textures", json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } }));
        m.doc["materials"][0]["normalTexture"] = json!({ "index": 0 });
    }),
    ("KHR_materials_transmission with KHR_materials_volume", |m| {
        extended(m, "KHR_materials_transmission", json!({ "transmissionFactor": 1 }));
        extended(m, "KHR_materials_volume", json!({ "thicknessFactor": 1 }));
        m.doc["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(0);
    }),
    ("the attenuation of what is glass in part", |m| {
        extended(m, "KHR_materials_transmission", json!({ "transmissionFactor": 0.5 }));
        extended(m, "KHR_materials_volume", json!({ "thicknessFactor": 1, "attenuationColor": [1, 0, 0], "attenuationDistance": 1 }));
    }),
    ("KHR_materials_transmission by itself, smooth", |m| {
        extended(m, "KHR_materials_transmission", json!({ "transmissionFactor": 1 }));
        m.doc["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = json!(0);
    }),
    ("KHR_materials_transmission by itself, rough", |m| extended(m, "KHR_materials_transmission", json!({ "transmissionFactor": 1 }))),
    ("KHR_materials_ior", |m| extended(m, "KHR_materials_ior", json!({ "ior": 1.3 }))),
    ("an `ior` of 0", |m| extended(m, "KHR_materials_ior", json!({ "ior": 0 }))),
    ("KHR_materials_clearcoat", |m| extended(m, "KHR_materials_clearcoat", json!({ "clearcoatFactor": 1 }))),
    ("`clearcoatNormalTexture`", |m| {
        extended(m, "KHR_materials_clearcoat", json!({ "clearcoatFactor": 1, "clearcoatNormalTexture": null }));
        textured(m, "/extensions/KHR_materials_clearcoat/clearcoatNormalTexture", json!({}));
    }),
    ("KHR_materials_sheen", |m| extended(m, "KHR_materials_sheen", json!({ "sheenColorFactor": [1, 1, 1] }))),
    ("KHR_materials_specular", |m| extended(m, "KHR_materials_specular", json!({ "specularFactor": 0.5 }))),
    ("`specularColorFactor`", |m| extended(m, "KHR_materials_specular", json!({ "specularColorFactor": [1, 0, 0] }))),
    ("KHR_materials_anisotropy", |m| extended(m, "KHR_materials_anisotropy", json!({ "anisotropyStrength": 0.5 }))),
    ("coat, sheen and anisotropy of glass", |m| {
        extended(m, "KHR_materials_transmission", json!({ "transmissionFactor": 1 }));
        extended(m, "KHR_materials_volume", json!({ "thicknessFactor": 1 }));
        extended(m, "KHR_materials_clearcoat", json!({ "clearcoatFactor": 1 }));
        m.doc["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(0);
    }),
    ("KHR_materials_unlit", |m| extended(m, "KHR_materials_unlit", json!({}))),
    ("KHR_materials_iridescence", |m| extended(m, "KHR_materials_iridescence", json!({ "iridescenceFactor": 1 }))),
    ("a film of more than 2000 nm, or of an index above 4", |m| {
        extended(m, "KHR_materials_iridescence", json!({ "iridescenceFactor": 1, "iridescenceIor": 5 }));
    }),
    ("the film on glass with an index of refraction below 1", |m| {
        extended(m, "KHR_materials_transmission", json!({ "transmissionFactor": 1 }));
        extended(m, "KHR_materials_volume", json!({ "thicknessFactor": 1 }));
        extended(m, "KHR_materials_dispersion", json!({ "dispersion": 100 }));
        extended(m, "KHR_materials_iridescence", json!({ "iridescenceFactor": 1 }));
        m.doc["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(0);
    }),
    ("KHR_materials_dispersion", |m| {
        extended(m, "KHR_materials_transmission", json!({ "transmissionFactor": 1 }));
        extended(m, "KHR_materials_volume", json!({ "thicknessFactor": 1 }));
        extended(m, "KHR_materials_dispersion", json!({ "dispersion": 0.3 }));
        m.doc["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(0);
    }),
    ("the dispersion of what is glass in part", |m| {
        extended(m, "KHR_materials_transmission", json!({ "transmissionFactor": 0.5 }));
        extended(m, "KHR_materials_volume", json!({ "thicknessFactor": 1 }));
        extended(m, "KHR_materials_dispersion", json!({ "dispersion": 0.3 }));
    }),
    ("KHR_materials_diffuse_transmission", |m| extended(m, "KHR_materials_diffuse_transmission", json!({}))),
    ("KHR_materials_pbrSpecularGlossiness", |m| extended(m, "KHR_materials_pbrSpecularGlossiness", json!({}))),
    ("KHR_materials_variants", |m| m.doc["extensionsUsed"] = json!(["KHR_materials_variants"])),
    ("no camera, no light", |m| m.doc["nodes"][0] = json!({ "mesh": 0 })),
];

#[test]
fn every_row_of_the_gltf_table_holds() {
    let table = rows("glTF 2.0");
    let known: BTreeSet<&str> = ROWS.iter().map(|(construct, _)| *construct).collect();
    let said: BTreeSet<&str> = table.iter().map(|row| &*row.construct).collect();
    assert_eq!(said.symmetric_difference(&known).collect::<Vec<_>>(), Vec::<&&str>::new(), "rows of the page, and files of this test");
    let folder = tempfile::tempdir().expect("a folder");
    for (construct, edit) in ROWS {
        let mut model = Model::square(
            json!({ "pbrMetallicRoughness": { "metallicRoughnessTexture": null, "baseColorTexture": null }, "normalTexture": null, "occlusionTexture": null, "extensions": {} }),
        );
        edit(&mut model);
        // Placeholders that no row has replaced.
        let material = model.doc["materials"][0].as_object_mut().expect("an object");
        material.retain(|_, value| !value.is_null());
        material["pbrMetallicRoughness"].as_object_mut().expect("an object").retain(|_, value| !value.is_null());
        model.write(folder.path(), "row.gltf");
        let outcome = match try_read(&folder.path().join("row.gltf")) {
            Err(_) => "refused",
            Ok(scene) => {
                let of_itself = ["no camera:", "no light:", "683 lm = 1 W"];
                let told = scene.notes.iter().any(|note| !of_itself.iter().any(|sentence| note.contains(sentence)));
                if told { "said" } else { "read" }
            }
        };
        let row = table.iter().find(|row| row.construct == *construct).expect("a row");
        assert_eq!(row.outcome, outcome, "{construct}");
    }
}
