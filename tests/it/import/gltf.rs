//! glTF import: a small generated file for each feature, with known colours, normals, positions and numbers.

mod animations;
mod faults;
mod geometry;
mod model;
mod scenes;
mod surfaces;
mod table;

use model::Model;
use serde_json::json;

use super::convert::{same_bits, succeeds};
use super::read::read;

/// Both kinds of file hold the same scene, which converts to a scene of pt with the same picture.
#[test]
fn both_kinds_of_file_and_what_is_converted_have_one_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut model = Model::square(json!({ "pbrMetallicRoughness": { "metallicFactor": 0.0 } }));
    let texture =
        model.texture(model::picture([[[255, 0, 0, 255], [0, 255, 0, 255]], [[0, 0, 255, 255], [255, 255, 255, 255]]]), json!({}));
    model.doc["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": texture });
    model.write(folder.path(), "square.gltf");
    model.write(folder.path(), "square.glb");
    assert_eq!(read(&folder.path().join("square.gltf")).tree, read(&folder.path().join("square.glb")).tree);
    let said = succeeds(folder.path(), &["convert", "square.glb", "square.json"]);
    assert!(said.contains("square.glb: no camera: placed at (") && said.contains("square.glb: no light: a clear sky was added"), "{said}");
    assert!(folder.path().join("square-files/mesh-0-0.ply").is_file() && folder.path().join("square-files/picture-0.png").is_file());
    same_bits(folder.path(), "square.glb", "square.json");
    same_bits(folder.path(), "square.gltf", "square.json");
}
