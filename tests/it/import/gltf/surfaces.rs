//! Materials and textures of glTF: the parameters in pt's scene, and the values at ray hits.

use pt::texture::image::Pixels;
use serde_json::{Value, json};

use super::model::{Model, picture, png, webp};
use crate::import::read::{Read, assert_near, met, read, reflected};

fn read_model(model: &Model) -> Read {
    let folder = tempfile::tempdir().expect("a folder");
    model.write(folder.path(), "scene.gltf");
    read(&folder.path().join("scene.gltf"))
}

fn material(extensions: Value) -> Read {
    read_model(&Model::square(json!({ "pbrMetallicRoughness": { "metallicFactor": 0 }, "extensions": extensions })))
}

/// The inverse of the sRGB curve (IEC 61966-2-1).
fn linear(level: u8) -> f64 {
    let x = f64::from(level) / 255.0;
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// Each quarter of the square shows its pixel times the factor: the first row is the upper one.
#[test]
fn base_colour_textures_are_upright() {
    let pixels = [[[250, 10, 128, 255], [0, 255, 0, 255]], [[64, 64, 64, 255], [255, 255, 200, 255]]];
    let factor = [0.5, 1.0, 0.25];
    let mut model = Model::square(json!({}));
    let texture = model.texture(picture(pixels), json!({ "magFilter": 9728 }));
    let pbr = json!({ "baseColorFactor": [0.5, 1.0, 0.25, 1.0], "baseColorTexture": { "index": texture }, "metallicFactor": 1, "roughnessFactor": 0 });
    model.doc["materials"][0] = json!({ "pbrMetallicRoughness": pbr });
    let built = read_model(&model).built();
    for (row, y) in [(0, 0.75), (1, 0.25)] {
        for (column, x) in [(0, 0.25), (1, 0.75)] {
            let expected: Vec<f64> = (0..3).map(|k| linear(pixels[row][column][k]) * factor[k]).collect();
            let found = met(&built, [x, y, 2.0], [0.0, 0.0, -1.0], |surface, _| reflected(surface).to_rgb().map(f64::from));
            // At normal incidence a smooth metal has its base colour, up to rounding to f32.
            assert_near(&found, &expected, 1e-5, &format!("row {row}, column {column}"));
        }
    }
}

/// (u′, v′) = (0.5 + 2 (c u + s v), 0.25 + 3 (c v − s u)) for 90°, with v downwards. The transform is applied to the mesh's coordinates,
/// where v points upwards.
#[test]
fn texture_transforms_are_applied_to_coordinates() {
    let mut model = Model::square(json!({}));
    let texture = model.texture(picture([[[255; 4]]]), json!({}));
    let transform = json!({ "offset": [0.5, 0.25], "scale": [2, 3], "rotation": std::f64::consts::FRAC_PI_2 });
    model.doc["extensionsUsed"] = json!(["KHR_texture_transform"]);
    let info = json!({ "index": texture, "extensions": { "KHR_texture_transform": transform } });
    model.doc["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": info });
    let mesh = read_model(&model).mesh(0);
    // The file has the coordinates (0, 1), (1, 1), (1, 0), (0, 0); c = 0, s = 1.
    let expected = [[0, 1], [1, 1], [1, 0], [0, 0]].map(|[u, v]| [0.5 + 3.0 * f64::from(v), 1.0 - (0.25 - 2.0 * f64::from(u))]);
    for (uv, expected) in mesh.uvs.iter().zip(expected) {
        assert_near(&uv.as_dvec2().to_array(), &expected, 1e-6, "texture coordinates");
    }
}

/// Roughness is the green channel and metalness the blue one. Both are linear, and multiplied by their factors.
#[test]
fn metallic_and_roughness_are_read_from_their_channels() {
    let mut model = Model::square(json!({}));
    let texture = model.texture(picture([[[0, 102, 204, 255]]]), json!({ "wrapS": 33071, "wrapT": 33071 }));
    let pbr = json!({ "metallicRoughnessTexture": { "index": texture }, "roughnessFactor": 0.5 });
    model.doc["materials"][0] = json!({ "pbrMetallicRoughness": pbr });
    let scene = read_model(&model);
    let metallic = json!({ "type": "image", "file": "picture-0.png", "encoding": "linear", "channel": "b", "wrap": "clamp" });
    assert_eq!(scene.at("/materials/material 0/metallic"), &metallic);
    assert_eq!(scene.at("/materials/material 0/roughness/a/channel"), "g");
    assert_near(&scene.numbers("/materials/material 0/base_color"), &[1.0; 3], 0.0, "base colour");
    assert_eq!(scene.number("/materials/material 0/roughness/b"), 0.5);
    let values = |channel| -> Vec<[f32; 3]> {
        let (pixels, _) = scene.files.picture("picture-0.png", pt::describe::Encoding::Linear, channel).expect("a picture");
        Pixels::values(&pixels).to_vec()
    };
    use pt::describe::Channel;
    assert_eq!(values(Some(Channel::R)), [[0.0; 3]]);
    assert_eq!(values(Some(Channel::G)), [[0.4; 3]]);
    assert_eq!(values(Some(Channel::B)), [[0.8; 3]]);
    assert_eq!(values(Some(Channel::A)), [[1.0; 3]]);
}

/// n = normalize((2 r − 1) s, (2 g − 1) s, 2 b − 1) along u, along v upwards, and out.
#[test]
fn normal_maps_turn_normals() {
    for scale in [1.0, 0.5] {
        let mut model = Model::square(json!({}));
        let texture = model.texture(picture([[[204, 153, 230, 255]]]), json!({}));
        model.doc["materials"][0] = json!({ "normalTexture": { "index": texture, "scale": scale } });
        let share = |level: u8| 2.0 * f64::from(level) / 255.0 - 1.0;
        let expected = glam::DVec3::new(share(204) * scale, share(153) * scale, share(230)).normalize();
        let found = met(&read_model(&model).built(), [0.3, 0.6, 2.0], [0.0, 0.0, -1.0], |surface, _| surface.point.ns.as_dvec3());
        assert_near(&found.to_array(), &expected.to_array(), 1e-5, &format!("scale {scale}"));
    }
}

/// Red is above and green below where the alpha is at least the cutoff; through the rest a ray goes on.
#[test]
fn alpha_masks_make_holes() {
    // Alpha 127 · 0.9 / 255 = 0.448, 128 · 0.9 / 255 = 0.4518.
    let pixels = [[[255, 0, 0, 127], [0, 255, 0, 128]]];
    let masked = |alpha_mode: &str| {
        let mut model = Model::square(json!({}));
        let texture = model.texture(picture(pixels), json!({ "magFilter": 9728 }));
        let pbr = json!({ "baseColorFactor": [1, 1, 1, 0.9], "baseColorTexture": { "index": texture } });
        model.doc["materials"][0] = json!({ "pbrMetallicRoughness": pbr, "alphaMode": alpha_mode, "alphaCutoff": 0.45 });
        // The surface behind the hole.
        let behind = model.square_mesh(json!(1));
        model.add("materials", json!({}));
        model.node(json!({ "mesh": behind, "translation": [0, 0, -1] }));
        read_model(&model)
    };
    let depth = |scene: &Read, x: f64| met(&scene.built(), [x, 0.5, 2.0], [0.0, 0.0, -1.0], |_, p| p.z.round());
    let mask = masked("MASK");
    assert_eq!([depth(&mask, 0.25), depth(&mask, 0.75)], [-1.0, 0.0]);
    assert_eq!([depth(&masked("OPAQUE"), 0.25), depth(&masked("OPAQUE"), 0.75)], [0.0, 0.0]);
    let blend = masked("BLEND");
    assert_eq!(blend.at("/materials/material 0/type"), "masked");
    assert_eq!(blend.number("/materials/material 0/opacity/b"), 0.9);
    assert!(
        blend.notes_say("/materials/0/alphaMode: alphaMode BLEND: each ray hits the surface with the probability alpha"),
        "{:?}",
        blend.notes
    );
}

/// A texture of emission: what leaves each half.
#[test]
fn emission_follows_its_texture() {
    let mut model = Model::square(json!({}));
    let texture = model.texture(picture([[[255, 255, 255, 255], [128, 0, 0, 255]]]), json!({ "magFilter": 9728 }));
    model.doc["materials"][0] = json!({ "emissiveFactor": [1, 1, 0.5], "emissiveTexture": { "index": texture } });
    let built = read_model(&model).built();
    for (x, expected) in [(0.25, [1.0, 1.0, 0.5]), (0.75, [linear(128), 0.0, 0.0])] {
        let out = |surface: &pt::scene::Surface, _| surface.emitted(glam::Vec3::Z).to_rgb().map(f64::from);
        assert_near(&met(&built, [x, 0.5, 2.0], [0.0, 0.0, -1.0], out), &expected, 1e-6, "radiance");
    }
}

#[test]
fn extensions_become_parameters() {
    let coat = material(json!({ "KHR_materials_clearcoat": { "clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 0.25 } }));
    assert_eq!((coat.number("/materials/material 0/coat"), coat.number("/materials/material 0/coat_roughness")), (0.75, 0.25));
    let sheen = material(json!({ "KHR_materials_sheen": { "sheenColorFactor": [0.5, 0.25, 1], "sheenRoughnessFactor": 0.75 } }));
    assert_eq!(sheen.numbers("/materials/material 0/sheen_color"), [0.5, 0.25, 1.0]);
    assert_eq!(sheen.number("/materials/material 0/sheen_roughness"), 0.75);
    let specular = material(json!({ "KHR_materials_specular": { "specularFactor": 0.5 }, "KHR_materials_ior": { "ior": 1.25 } }));
    assert_eq!((specular.number("/materials/material 0/specular"), specular.number("/materials/material 0/eta")), (0.5, 1.25));
}

/// A film lies on metal, plastic, glass and panes; without a texture it is as thick as can be. Where its factor is 0 there is none.
#[test]
fn iridescence_is_a_thin_film() {
    let film = json!({ "iridescenceFactor": 0.5, "iridescenceIor": 1.75, "iridescenceThicknessMaximum": 250 });
    let surface = material(json!({ "KHR_materials_iridescence": film }));
    let of = |key: &str| surface.number(&format!("/materials/material 0/{key}"));
    assert_eq!((of("iridescence"), of("iridescence_eta"), of("iridescence_thickness")), (0.5, 1.75, 250.0));
    surface.built();
    let defaults = material(json!({ "KHR_materials_iridescence": { "iridescenceFactor": 1 } }));
    assert_eq!(defaults.number("/materials/material 0/iridescence_eta"), 1.3);
    assert_eq!(defaults.number("/materials/material 0/iridescence_thickness"), 400.0);
    assert!(material(json!({ "KHR_materials_iridescence": {} })).at("/materials/material 0").get("iridescence").is_none());
    let pane = |factor: f64| {
        let extensions = json!({
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_iridescence": { "iridescenceFactor": factor },
        });
        let pbr = json!({ "baseColorFactor": [0.5, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 0 });
        read_model(&Model::square(json!({ "pbrMetallicRoughness": pbr, "extensions": extensions })))
    };
    let covered = json!({ "type": "thin_film", "color": [0.5, 1, 1], "pane": 1.5, "eta": 1.3, "thickness": 400 });
    assert_eq!(pane(1.0).at("/materials/material 0"), &covered);
    let half = pane(0.5);
    assert_eq!((half.at("/materials/material 0/b"), half.number("/materials/material 0/share")), (&covered, 0.5));
    half.built();
    let solid = |factor: f64| {
        let extensions = json!({
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": { "thicknessFactor": 1 },
            "KHR_materials_iridescence": { "iridescenceFactor": factor },
        });
        let pbr = json!({ "metallicFactor": 0, "roughnessFactor": 0 });
        read_model(&Model::square(json!({ "pbrMetallicRoughness": pbr, "extensions": extensions })))
    };
    let film = json!({ "eta": 1.3, "thickness": 400 });
    assert_eq!(solid(1.0).at("/materials/material 0/film"), &film);
    let half = solid(0.5);
    assert_eq!((half.at("/materials/material 0/b/film"), half.number("/materials/material 0/share")), (&film, 0.5));
    assert!(half.at("/materials/material 0/a").get("film").is_none());
    half.built();
}

/// Films thicker or denser than pt's are as thick and dense as can be; both are said.
#[test]
fn what_is_left_out_of_iridescence_is_said() {
    let thick = material(json!({ "KHR_materials_iridescence": { "iridescenceFactor": 1, "iridescenceThicknessMaximum": 2500 } }));
    assert!(thick.notes_say("a film of more than 2000 nm is taken as one of 2000"));
    assert_eq!(thick.number("/materials/material 0/iridescence_thickness"), 2000.0);
    let dense = material(json!({ "KHR_materials_iridescence": { "iridescenceFactor": 1, "iridescenceIor": 5 } }));
    assert!(dense.notes_say("a film with an index of more than 4 is taken as 4"));
    assert_eq!(dense.number("/materials/material 0/iridescence_eta"), 4.0);
}

/// The thickness of a film varies from its minimum to its maximum by the green of a texture, and its share is the red of one.
#[test]
fn the_thickness_of_a_film_is_the_green_of_its_texture_and_its_share_the_red() {
    let mut model = Model::square(json!({ "extensions": { "KHR_materials_iridescence": { "iridescenceFactor": 1 } } }));
    let texture = model.texture(picture([[[0, 102, 204, 255]]]), json!({}));
    let film = &mut model.doc["materials"][0]["extensions"]["KHR_materials_iridescence"];
    film["iridescenceThicknessTexture"] = json!({ "index": texture });
    let scene = read_model(&model);
    let thickness = scene.at("/materials/material 0/iridescence_thickness");
    assert_eq!((&thickness["from"], &thickness["to"], &thickness["by"]["channel"]), (&json!(100), &json!(400), &json!("g")));
    scene.built();
    let film = &mut model.doc["materials"][0]["extensions"]["KHR_materials_iridescence"];
    film["iridescenceTexture"] = json!({ "index": texture });
    let scene = read_model(&model);
    assert_eq!(scene.at("/materials/material 0/iridescence/channel"), "r");
    scene.built();
}

/// Transmission with a thickness gives a body of glass, and without one a thin pane. A partial transmission gives a mix.
#[test]
fn transmission_distinguishes_bodies_and_panes() {
    let volume = json!({ "thicknessFactor": 1, "attenuationColor": [0.5, 0.25, 1], "attenuationDistance": 2 });
    let glass = |share: f64, volume: Option<&Value>| {
        let mut extensions = json!({ "KHR_materials_transmission": { "transmissionFactor": share }, "KHR_materials_ior": { "ior": 1.25 } });
        extensions["KHR_materials_volume"] = volume.cloned().unwrap_or(json!({}));
        let pbr = json!({ "baseColorFactor": [0.5, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 0.25 });
        read_model(&Model::square(json!({ "pbrMetallicRoughness": pbr, "extensions": extensions })))
    };
    let body = glass(1.0, Some(&volume));
    let expected = json!({ "type": "dielectric", "color": [0.5, 1, 1], "roughness": 0.25, "eta": 1.25,
        "absorption": { "color": [0.5, 0.25, 1], "distance": 2 } });
    assert_eq!(body.at("/materials/material 0"), &expected);
    let part = glass(0.5, Some(&volume));
    assert_eq!((part.at("/materials/material 0/type"), part.number("/materials/material 0/transmission")), (&json!("principled"), 0.5));
    assert!(part.notes_say("the absorption of a material that transmits only in part is left out"));
    let pane = glass(1.0, None);
    assert_eq!(pane.at("/materials/material 0"), &json!({ "type": "thin_dielectric", "color": [0.5, 1, 1], "eta": 1.25 }));
    assert!(pane.notes_say("a thin pane is clear"));
    let half = glass(0.5, None);
    assert_eq!((half.at("/materials/material 0/type"), half.number("/materials/material 0/share")), (&json!("mix"), 0.5));
    assert_eq!(half.at("/materials/material 0/b/type"), "thin_dielectric");
}

/// The dispersion of solid glass is 20 over its Abbe number; 0 is none.
#[test]
fn dispersion_is_the_abbe_number_of_solid_glass() {
    let glass = |share: f64, dispersion: f64| {
        let extensions = json!({
            "KHR_materials_transmission": { "transmissionFactor": share },
            "KHR_materials_volume": { "thicknessFactor": 1 },
            "KHR_materials_dispersion": { "dispersion": dispersion },
        });
        read_model(&Model::square(json!({ "pbrMetallicRoughness": { "metallicFactor": 0 }, "extensions": extensions })))
    };
    let solid = glass(1.0, 0.5);
    assert_eq!(solid.number("/materials/material 0/abbe"), 40.0);
    solid.built();
    assert!(!solid.notes_say("dispersion"));
    assert!(glass(1.0, 0.0).at("/materials/material 0").get("abbe").is_none());
    for impossible in [200.0, 1e-320] {
        let glass = glass(1.0, impossible);
        assert!(glass.notes_say("the dispersion is left out: it gives indices of refraction below 0.01 or above 100"));
        glass.built();
    }
    assert!(glass(0.5, 0.5).notes_say("the dispersion of a material that transmits only in part is left out"));
}

/// Pictures in files of their own are referenced by their names, with `%` escapes decoded.
#[test]
fn external_pictures_are_referenced_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut model = Model::square(json!({}));
    model.add("images", json!({ "uri": "my%20wood.png" }));
    model.add("textures", json!({ "source": 0 }));
    model.doc["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 0 } });
    model.write(folder.path(), "scene.gltf");
    std::fs::write(folder.path().join("my wood.png"), super::model::png(picture([[[255; 4]]]))).expect("a file");
    let scene = read(&folder.path().join("scene.gltf"));
    assert_eq!(scene.at("/materials/material 0/base_color"), &json!({ "type": "image", "file": "my wood.png" }));
    scene.built();
}

/// WebP is read like PNG. Of the pictures of a texture the first one that pt can read is used.
#[test]
fn pictures_of_texture_extensions_are_read() {
    let texels = || picture([[[9, 200, 30, 255]]]);
    let unread = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
    for (own, others) in [(None, vec![webp(texels())]), (Some(unread.clone()), vec![webp(texels())]), (Some(png(texels())), vec![unread])] {
        let mut model = Model::square(json!({}));
        let mut add = |bytes: &[u8]| {
            let view = model.bytes(bytes);
            model.add("images", json!({ "bufferView": view, "mimeType": "image/x" }))
        };
        let sources: Vec<usize> = others.iter().map(|bytes| add(bytes)).collect();
        let own = own.map(|bytes| add(&bytes));
        let mut texture = json!({ "extensions": { "EXT_texture_webp": { "source": sources[0] } } });
        own.into_iter().for_each(|own| texture["source"] = json!(own));
        model.add("textures", texture);
        model.doc["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 0 } });
        let scene = read_model(&model);
        let file = scene.at("/materials/material 0/base_color/file").as_str().expect("a file");
        let (pixels, _) = scene.files.picture(file, pt::describe::Encoding::Linear, None).expect("a picture");
        assert_eq!(pixels.values()[0], [9.0f32 / 255.0, 200.0 / 255.0, 30.0 / 255.0], "{file}");
    }
}

/// If pt cannot read the format of a picture, only its texture is replaced, with a note. Emission without its mask is left out, so that the
/// surface does not emit everywhere.
#[test]
fn an_unreadable_picture_is_left_out() {
    for (bytes, format) in [(&b"\xABKTX 20\xBB\r\n\x1A\n"[..], "KTX2"), (b"GIF89a", "GIF"), (b"?", "an unknown format")] {
        for (slot, sentence) in [
            ("/pbrMetallicRoughness/baseColorTexture", "a plain colour shows in its place"),
            ("/pbrMetallicRoughness/metallicRoughnessTexture", "its factor alone is used"),
            ("/normalTexture", "the surface is smooth there"),
            ("/emissiveTexture", "the surface does not emit"),
        ] {
            let mut model = Model::square(json!({ "pbrMetallicRoughness": { "baseColorTexture": null, "metallicRoughnessTexture": null },
                "normalTexture": null, "emissiveTexture": null, "emissiveFactor": [1, 1, 1] }));
            let view = model.bytes(bytes);
            model.add("images", json!({ "bufferView": view, "mimeType": "image/png" }));
            model.add("textures", json!({ "source": 0 }));
            *model.doc["materials"][0].pointer_mut(slot).expect("a slot") = json!({ "index": 0 });
            let scene = read_without_nulls(model);
            assert!(scene.notes_say(&format!("a picture in {format} is left out")) && scene.notes_say(sentence), "{:?}", scene.notes);
            assert_eq!(scene.at("/shapes/0").get("emission").is_some(), slot != "/emissiveTexture", "{slot}");
            scene.built();
        }
    }
}

fn read_without_nulls(mut model: Model) -> Read {
    let material = &mut model.doc["materials"][0];
    for part in ["", "/pbrMetallicRoughness"] {
        material.pointer_mut(part).and_then(|part| part.as_object_mut()).expect("an object").retain(|_, value| !value.is_null());
    }
    read_model(&model)
}

/// COLOR_0 multiplies the base colour, in each component type. Meshes of the same material without COLOR_0 are unchanged.
#[test]
fn vertex_colours_multiply_the_base_colour() {
    use super::model::{F32, U8, U16};
    let expected = [0.4 * 0.5, 0.6 * 1.0, 0.2 * 0.25];
    for (component, kind, bytes) in [
        (U8, "VEC3", [[102u8, 153, 51, 0]; 4].concat()),
        (U8, "VEC4", [[102u8, 153, 51, 255]; 4].concat()),
        (U16, "VEC4", [[26214u16, 39321, 13107, 65535]; 4].concat().iter().flat_map(|x| x.to_le_bytes()).collect()),
        (F32, "VEC3", [[0.4f32, 0.6, 0.2]; 4].concat().iter().flat_map(|x| x.to_le_bytes()).collect()),
    ] {
        let mut model =
            Model::square(json!({ "pbrMetallicRoughness": { "baseColorFactor": [0.5, 1.0, 0.25, 1.0], "roughnessFactor": 0 } }));
        let plain = model.square_mesh(json!(0));
        model.node(json!({ "mesh": plain, "translation": [5, 0, 0] }));
        let colors = model.accessor(&bytes, component, kind, 4);
        model.doc["accessors"][colors]["normalized"] = json!(component != F32);
        if (component, kind) == (U8, "VEC3") {
            let view = model.doc["accessors"][colors]["bufferView"].as_u64().expect("an index") as usize;
            model.doc["bufferViews"][view]["byteStride"] = json!(4);
        }
        model.doc["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
        let scene = read_model(&model);
        assert_eq!(
            scene.notes.iter().filter(|note| !note.contains("no camera") && !note.contains("no light")).count(),
            0,
            "{:?}",
            scene.notes
        );
        let built = scene.built();
        for (x, expected) in [(0.4, expected), (5.4, [0.5, 1.0, 0.25])] {
            let found = met(&built, [x, 0.3, 2.0], [0.0, 0.0, -1.0], |surface, _| reflected(surface).to_rgb().map(f64::from));
            assert_near(&found, &expected, 1e-5, &format!("{component} {kind} at {x}"));
        }
    }
}

/// The opacity of the vertices multiplies that of the material.
#[test]
fn vertex_opacity_blends() {
    let mut model = Model::square(json!({ "alphaMode": "BLEND", "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.5] } }));
    let colors = model.floats(&[[1.0, 1.0, 1.0, 0.5]; 4]);
    model.doc["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
    let vertices = json!({ "type": "vertex_color", "channel": "a" });
    assert_eq!(read_model(&model).at("/materials/material 0/opacity"), &json!({ "type": "product", "a": vertices, "b": 0.5 }));
}

/// A material that reflects 4 % becomes plastic of its diffuse colour, and one without a diffuse colour a metal of its specular colour,
/// both exactly. Pictures are converted pixel by pixel as factors are.
#[test]
fn specular_and_glossiness_become_metalness_and_roughness() {
    let gloss = |value: Value| read_model(&Model::square(json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": value } })));
    let of = |scene: &Read| {
        let base = scene.numbers("/materials/material 0/base_color");
        (base, scene.number("/materials/material 0/metallic"), scene.number("/materials/material 0/roughness"))
    };
    let plastic = gloss(json!({ "diffuseFactor": [0.5, 0.25, 0.75, 1], "specularFactor": [0.04, 0.04, 0.04], "glossinessFactor": 0.25 }));
    assert!(plastic.notes_say("specular and glossiness become metalness and roughness"), "{:?}", plastic.notes);
    let (base, metallic, roughness) = of(&plastic);
    assert_near(&base, &[0.5, 0.25, 0.75], 1e-6, "base colour");
    assert_near(&[metallic, roughness], &[0.0, 0.75], 1e-6, "plastic");
    for specular in [[1.0, 0.75, 0.25], [0.1, 0.3, 0.2], [0.5; 3]] {
        let metal = gloss(json!({ "diffuseFactor": [0, 0, 0, 1], "specularFactor": specular, "glossinessFactor": 1 }));
        let (base, metallic, roughness) = of(&metal);
        assert_near(&base, &specular, 1e-6, "base colour");
        assert_near(&[metallic, roughness], &[1.0, 0.0], 1e-6, "metal");
    }
    let texel = [200, 120, 40, 255];
    let shiny = [60, 90, 120, 51];
    let mut model = Model::square(json!({}));
    let [diffuse, specular] = [texel, shiny].map(|texel| model.texture(picture([[texel, texel]]), json!({})));
    model.doc["materials"][0]["extensions"] = json!({ "KHR_materials_pbrSpecularGlossiness":
        { "diffuseTexture": { "index": diffuse }, "specularGlossinessTexture": { "index": specular } } });
    let scene = read_model(&model);
    let rgb = |texel: [u8; 4]| [0, 1, 2].map(|k| linear(texel[k]));
    let [r, g, b] = rgb(texel);
    let plain = of(&gloss(json!({ "diffuseFactor": [r, g, b, 1.0], "specularFactor": rgb(shiny), "glossinessFactor": 0.2 })));
    let shown = |key: &str, channel| {
        let file = scene.at(&format!("/materials/material 0/{key}/file")).as_str().expect("a file");
        let (pixels, _) = scene.files.picture(file, pt::describe::Encoding::Auto, channel).expect("a picture");
        pixels.values()[0].map(f64::from)
    };
    // The tolerance is that of 8 bits: half a step where the curve is steepest, 1/255.
    assert_near(&shown("base_color", None), &plain.0, 1.0 / 255.0, "base colour");
    let shares = |key: &str| scene.at(&format!("/materials/material 0/{key}/channel")).as_str().map(str::to_owned);
    assert_eq!((shares("metallic"), shares("roughness")), (Some("b".into()), Some("g".into())));
    let linear_shares = |channel| {
        let file = scene.at("/materials/material 0/metallic/file").as_str().expect("a file");
        f64::from(scene.files.picture(file, pt::describe::Encoding::Linear, Some(channel)).expect("a picture").0.values()[0][0])
    };
    assert_near(&[linear_shares(pt::describe::Channel::B)], &[plain.1], 0.5 / 255.0 + 1e-6, "metalness");
    assert_near(&[linear_shares(pt::describe::Channel::G)], &[plain.2], 0.5 / 255.0 + 1e-6, "roughness");
    scene.built();
}
