//! A generator of small glTF files, each for one feature.

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

pub const U8: u32 = 5121;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// A glTF file under construction.
#[derive(Clone)]
pub struct Model {
    pub doc: Value,
    pub buffer: Vec<u8>,
}

impl Model {
    /// A file with one scene that has no nodes.
    pub fn new() -> Model {
        let doc = json!({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [] }] });
        Model { doc, buffer: vec![] }
    }

    /// A file with one node, a square of one metre: [0, 1]² at z = 0, with the normal +z and upright texture coordinates.
    pub fn square(material: Value) -> Model {
        let mut model = Model::new();
        let mesh = model.square_mesh(json!(0));
        model.add("materials", material);
        model.node(json!({ "mesh": mesh }));
        model
    }

    /// Adds a member to a list of the file, and returns its index.
    pub fn add(&mut self, list: &str, value: Value) -> usize {
        let list = &mut self.doc[list];
        if list.is_null() {
            *list = json!([]);
        }
        let members = list.as_array_mut().expect("a list");
        members.push(value);
        members.len() - 1
    }

    /// A node of the scene.
    pub fn node(&mut self, node: Value) -> usize {
        let index = self.add("nodes", node);
        self.doc["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(index));
        index
    }

    /// Adds a buffer view of these bytes, and returns its index.
    pub fn bytes(&mut self, bytes: &[u8]) -> usize {
        let start = self.buffer.len().next_multiple_of(4);
        self.buffer.resize(start, 0);
        self.buffer.extend(bytes);
        self.add("bufferViews", json!({ "buffer": 0, "byteOffset": start, "byteLength": bytes.len() }))
    }

    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.bytes(bytes);
        self.add("accessors", json!({ "bufferView": view, "componentType": component, "type": kind, "count": count }))
    }

    pub fn floats<const N: usize>(&mut self, rows: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let kind = ["", "SCALAR", "VEC2", "VEC3", "VEC4", "", "", "", "", "", "", "", "", "", "", "", "MAT4"][N];
        self.accessor(&bytes, F32, kind, rows.len())
    }

    pub fn square_mesh(&mut self, material: Value) -> usize {
        let position = self.floats(&CORNERS);
        let normal = self.floats(&[[0.0, 0.0, 1.0]; 4]);
        let uv = self.floats(&[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
        let indices = self.accessor(&[0, 1, 2, 0, 2, 3], U8, "SCALAR", 6);
        let attributes = json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv });
        let primitive = json!({ "attributes": attributes, "indices": indices, "material": material });
        self.add("meshes", json!({ "primitives": [primitive] }))
    }

    /// Adds a texture with a picture in the buffer, and returns its index.
    pub fn texture(&mut self, picture: image::RgbaImage, sampler: Value) -> usize {
        let view = self.bytes(&png(picture));
        let image = self.add("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        let sampler = self.add("samplers", sampler);
        self.add("textures", json!({ "source": image, "sampler": sampler }))
    }

    fn with_buffer(&self, buffer: Value) -> Value {
        let mut doc = self.doc.clone();
        if !self.buffer.is_empty() {
            doc["buffers"] = json!([buffer]);
        }
        doc
    }

    /// The model as a `.gltf` file with the buffer as a data URI.
    pub fn gltf(&self) -> Vec<u8> {
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.buffer));
        let doc = self.with_buffer(json!({ "byteLength": self.buffer.len(), "uri": uri }));
        serde_json::to_vec_pretty(&doc).expect("JSON")
    }

    /// The model as a binary container: a header, a chunk of JSON and a chunk of bytes. Source: glTF 2.0, §4.4.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = serde_json::to_vec(&self.with_buffer(json!({ "byteLength": self.buffer.len() }))).expect("JSON");
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut binary = self.buffer.clone();
        binary.resize(binary.len().next_multiple_of(4), 0);
        let whole = |n: usize| u32::try_from(n).expect("small").to_le_bytes();
        let chunk = |kind: &[u8; 4], bytes: &[u8]| [&whole(bytes.len()), &kind[..], bytes].concat();
        let chunks = [chunk(b"JSON", &json), chunk(b"BIN\0", &binary)].concat();
        [&b"glTF"[..], &2u32.to_le_bytes(), &whole(12 + chunks.len()), &chunks].concat()
    }

    pub fn write(&self, folder: &Path, name: &str) {
        let bytes = if name.ends_with(".glb") { self.glb() } else { self.gltf() };
        fs::write(folder.join(name), bytes).expect("a file");
    }
}

pub const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

pub fn png(picture: image::RgbaImage) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(vec![]);
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("encodes");
    bytes.into_inner()
}

pub fn webp(picture: image::RgbaImage) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(vec![]);
    picture.write_to(&mut bytes, image::ImageFormat::WebP).expect("encodes");
    bytes.into_inner()
}

/// A picture with these rows from the top.
pub fn picture<const W: usize, const H: usize>(rows: [[[u8; 4]; W]; H]) -> image::RgbaImage {
    image::RgbaImage::from_fn(W as u32, H as u32, |x, y| image::Rgba(rows[y as usize][x as usize]))
}
