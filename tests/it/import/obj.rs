//! OBJ with MTL: a model gets a default camera and light, and the materials of its library.

use std::fs;
use std::path::Path;

use glam::DVec3;
use pt::import::AutoCamera;
use serde_json::json;

use super::convert::{same_bits, succeeds};
use super::read::{Read, assert_near, met, read, try_read, try_read_with};
use super::table::rows;
use crate::random::Random;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

/// A square of one material, and its library.
fn model(library: &str) -> Read {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), library);
    read(&folder.path().join("model.obj"))
}

fn write(folder: &Path, library: &str) {
    fs::write(folder.join("model.obj"), format!("# a model\nmtllib model.mtl\n{SQUARE}usemtl one\nf 1/1 2/2 3/3 4/4\n")).expect("a file");
    fs::write(folder.join("model.mtl"), format!("newmtl one\n{library}")).expect("a file");
}

fn vector(numbers: &[f64]) -> DVec3 {
    DVec3::from_slice(numbers)
}

/// Every vertex lies within 9/10 of the picture; along one axis two vertices reach that far on both sides, along the other they reach
/// equally far, and the camera looks from the front, the right and above.
#[test]
fn the_default_camera_fits_the_model() {
    let mut random = Random::new(11);
    let folder = tempfile::tempdir().expect("a folder");
    for round in 0..40 {
        let size = random.decade(-6.0, 6.0);
        let shape = DVec3::new(random.range(0.01, 1.0), random.range(0.01, 1.0), random.range(0.01, 1.0));
        let centre = random.in_cube() * 10.0;
        let points: Vec<DVec3> = (0..9).map(|_| (centre + random.in_cube() * shape) * size).collect();
        let vertices: String = points.iter().map(|p| format!("v {:?} {:?} {:?}\n", p.x as f32, p.y as f32, p.z as f32)).collect();
        fs::write(folder.path().join("cloud.obj"), vertices + "f 1 2 3\nf 4 5 6\nf 7 8 9\n").expect("a file");
        let scene = read(&folder.path().join("cloud.obj"));
        let [from, to] = ["from", "to"].map(|key| vector(&scene.numbers(&format!("/camera/look_at/{key}"))));
        let back = (from - to).normalize();
        let right = DVec3::Y.cross(back).normalize();
        let up = back.cross(right);
        assert!(back.x > 0.0 && back.y > 0.0 && back.z > back.x, "{back}");
        let tan = (scene.number("/camera/fov").to_radians() / 2.0).tan();
        let aspect = scene.number("/film/width") / scene.number("/film/height");
        let seen = |p: &DVec3| {
            let d = *p - from;
            [d.dot(right) / (aspect * tan), d.dot(up) / tan].map(|side| side / -d.dot(back))
        };
        let reach = |axis: usize, sign: f64| points.iter().map(|p| sign * seen(p)[axis]).fold(f64::NEG_INFINITY, f64::max);
        let [right, left, top, bottom] = [reach(0, 1.0), reach(0, -1.0), reach(1, 1.0), reach(1, -1.0)];
        // Vertices are f32, and ten times farther from the origin than they are large.
        let tolerance = 1e-4;
        let farthest = right.max(left).max(top).max(bottom);
        assert!((farthest - 0.9).abs() < tolerance, "round {round}: {farthest}");
        let (x, y) = (
            (right - 0.9).abs() < tolerance && (left - 0.9).abs() < tolerance,
            (top - 0.9).abs() < tolerance && (bottom - 0.9).abs() < tolerance,
        );
        assert!(x || y, "round {round}: right {right}, left {left}, top {top}, bottom {bottom}");
    }
}

/// E = π L sin² θ for a disk that is seen whole: 2.5 W·m⁻² in the middle of the box, at any size.
#[test]
fn key_lights_have_the_documented_irradiance() {
    let folder = tempfile::tempdir().expect("a folder");
    for size in [1e-6, 1.0, 1e6] {
        fs::write(folder.path().join("m.obj"), format!("v 0 0 0\nv {size:e} 0 0\nv 0 {size:e} {size:e}\nf 1 2 3\n")).expect("a file");
        let studio = AutoCamera { studio: true, ground: Some(false), ..AutoCamera::default() };
        let scene = try_read_with(&folder.path().join("m.obj"), studio, &[]).unwrap_or_else(|e| panic!("{e}"));
        let lamp = "/shapes/1";
        let from = vector(&scene.numbers(&format!("{lamp}/transform/1/look_at/from")));
        let middle = DVec3::splat(size / 2.0);
        let radius = scene.number(&format!("{lamp}/radius"));
        let sin2 = radius * radius / (radius * radius + (from - middle).length_squared());
        let radiance = scene.number(&format!("{lamp}/emission"));
        assert_near(&[std::f64::consts::PI * radiance * sin2], &[2.5], 1e-5, "irradiance");
        // The disk emits towards the model. A ray from half way back to the disk sees the light.
        let half_way = 0.5 * (middle + from);
        let back = (from - middle).normalize().as_vec3();
        let emitted = met(&scene.built(), half_way.to_array(), back.to_array(), |surface, _| surface.emitted(-back).to_rgb()[0]);
        assert_near(&[f64::from(emitted)], &[radiance], 1e-5, "radiance");
    }
}

#[test]
fn materials_by_their_library() {
    let one = |library: &str| model(library).at("/materials/one").clone();
    assert_eq!(one("Kd 0.25 0.5 1\n"), json!({ "type": "diffuse", "albedo": [0.25, 0.5, 1] }));
    // Ns 6: α² = 2/8, roughness = √α.
    let glossy = json!({ "type": "principled", "base_color": [0.5, 0.5, 0.5], "roughness": 0.25f64.powf(0.25), "eta": 1.25 });
    assert_eq!(one("Kd 0.5\nKs 0.1\nNs 6\nNi 1.25\nillum 2\n"), glossy);
    assert_eq!(
        one("Kd 0\nKs 0.9 0.5 0.1\nNs 30\n"),
        json!({ "type": "conductor", "color": [0.9, 0.5, 0.1], "roughness": (2.0f64 / 32.0).powf(0.25) })
    );
    assert_eq!(one("Kd 1 0 0\nKs 1\nillum 1\n")["type"], "diffuse");
    assert_eq!(
        one("Ni 1.33\nTf 1 0.5 1\nd 0.1\nillum 7\n"),
        json!({ "type": "dielectric", "color": [1, 0.5, 1], "roughness": 0, "eta": 1.33 })
    );
    assert_eq!(
        one("Kd 1\nPr 0.5\nPm 1\n"),
        json!({ "type": "principled", "base_color": [1, 1, 1], "metallic": 1, "roughness": 0.5, "eta": 1.5 })
    );
    assert_eq!(one("Kd 1\nd 0.25\n"), json!({ "type": "masked", "surface": { "type": "diffuse", "albedo": [1, 1, 1] }, "opacity": 0.25 }));
    assert_eq!(one("Kd 1\nTr 0.25\n")["opacity"], 0.75);
    let image = json!({ "type": "image", "file": "maps/wood.png" });
    assert_eq!(one("map_Kd -clamp on maps/wood.png\n")["albedo"], image);
    assert_eq!(one("Kd 0\nmap_Kd maps/wood.png\n")["albedo"], image);
    assert_eq!(one("Kd 0.5\nmap_Kd maps\\wood.png\n")["albedo"], json!({ "type": "product", "a": image, "b": [0.5, 0.5, 0.5] }));
    assert_eq!(one("norm maps/wood.png\n")["normal_map"], image);
}

/// Emitting faces become a shape of their own, and no other light is added. All other faces remain one mesh.
#[test]
fn lamps_of_the_library_light_the_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    let faces = format!(
        "mtllib a.mtl\n{SQUARE}v 0 0 2\nv 0 1 2\nv 1 0 2\nusemtl wall\nf 1/1 2/2 3/3\nusemtl lamp\nf 5/1 6/2 7/3\nusemtl none\nf 1/1 3/2 4/3\n"
    );
    fs::write(folder.path().join("room.obj"), faces).expect("a file");
    fs::write(folder.path().join("a.mtl"), "newmtl wall\nKd 0.5\nnewmtl lamp\nKe 4 2 1\n").expect("a file");
    let scene = read(&folder.path().join("room.obj"));
    assert_eq!(scene.at("/shapes/1/emission"), &json!({ "radiance": [4, 2, 1], "two_sided": true }));
    assert_eq!((scene.mesh(0).triangles.len(), scene.mesh(1).triangles.len()), (2, 1));
    assert!(scene.tree.get("background").is_none() && !scene.notes_say("no light"));
    assert!(scene.notes_say("materials that no library has, taken as matte, albedo 0.8: \"none\""), "{:?}", scene.notes);
    let built = scene.built();
    let out = |surface: &pt::scene::Surface, _| surface.emitted(-glam::Vec3::Z).to_rgb();
    assert_eq!(met(&built, [0.25, 0.25, 1.0], [0.0, 0.0, 1.0], out), [4.0, 2.0, 1.0]);
    succeeds(folder.path(), &["convert", "room.obj", "room.json"]);
    same_bits(folder.path(), "room.obj", "room.json");
}

/// A missing library causes one note, with its line and the consequence, and no note about missing materials of a scene.
#[test]
fn a_missing_material_library_is_reported_once() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("there.mtl"), "newmtl a\nKd 1 0 0\n").expect("a file");
    fs::write(folder.path().join("with space.mtl"), "newmtl b\n").expect("a file");
    for (line, is_missing) in
        [("mtllib there.mtl", false), ("mtllib with space.mtl", false), ("mtllib there.mtl none.mtl", true), ("mtllib", false)]
    {
        fs::write(folder.path().join("a.obj"), format!("{line}\n{SQUARE}f 1 2 3\n")).expect("a file");
        let scene = read(&folder.path().join("a.obj"));
        let mut told = scene.notes.clone();
        told.extend(scene.built().warnings);
        told.retain(|note| !note.contains("no camera") && !note.contains("no light"));
        assert_eq!(told.len(), usize::from(is_missing), "{line}: {told:?}");
        let sentence = "a.obj:1: material library none.mtl: no such file; its materials are left out";
        assert!(told.iter().all(|note| note.ends_with(sentence)), "{told:?}");
    }
}

#[test]
fn faults_have_their_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = |library: &str| {
        write(folder.path(), library);
        try_read(&folder.path().join("model.obj")).err().map_or(String::new(), |e| e.to_string())
    };
    assert_eq!(said("Kd 0.5 x 1\n"), "model.mtl:2: expected a number of at least 0, found \"x\"");
    assert_eq!(said("\n\nNs -1\n"), "model.mtl:4: expected a number of at least 0, found \"-1\"");
    assert_eq!(said("Kd spectral file.rfl\n"), "model.mtl:2: expected red, green and blue, found \"spectral\"");
    let broken = folder.path().join("broken.obj");
    fs::write(&broken, "v 0 0 0\nf 1 2 3\n").expect("a file");
    let found = try_read(&broken).err().map_or(String::new(), |e| e.to_string());
    assert!(found.contains("broken.obj:2: "), "{found}");
    fs::write(&broken, format!("mtllib ../secret.mtl\n{SQUARE}f 1 2 3\n")).expect("a file");
    let found = try_read(&broken).err().map_or(String::new(), |e| e.to_string());
    assert!(found.contains("broken.obj:1: ../secret.mtl: leads out of the scene file's folder"), "{found}");
}

#[test]
fn any_bytes_are_read_or_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), "Kd 0.5\nKs 0.1\nNs 6\nd 0.5\nKe 1\nmap_Kd -s 1 1 1 wood.png\nillum 2\n");
    let [obj, mtl] = ["model.obj", "model.mtl"].map(|name| fs::read(folder.path().join(name)).expect("a file"));
    let mut random = Random::new(5);
    for round in 0..600 {
        let mut files = [obj.clone(), mtl.clone()];
        let mutant = &mut files[round % 2];
        for _ in 0..=random.below(3) {
            let at = random.below(mutant.len());
            mutant[at] = if random.below(2) == 0 { random.below(256) as u8 } else { random.pick(b"\n /-.0189eKdfvnt\\#") };
        }
        fs::write(folder.path().join("fuzz.obj"), &files[0]).expect("a file");
        fs::write(folder.path().join("model.mtl"), &files[1]).expect("a file");
        if let Err(error) = try_read(&folder.path().join("fuzz.obj")) {
            assert!(matches!(error.exit_code(), 3 | 4), "round {round}: {error}");
        }
    }
}

/// Each row of the table of docs/import.md is tested with a library.
#[test]
fn every_row_of_the_obj_table_holds() {
    const ROWS: &[(&str, &str)] = &[
        ("the triangles, their normals, texture coordinates and materials", ""),
        ("`Kd`, `map_Kd`", "Kd 0.5\nmap_Kd a.png\n"),
        ("`Ks`, `Ns`", "Ks 0.5\nNs 10\n"),
        ("`Ni`, `Tf`", "Ni 1.5\nTf 1 1 1\nillum 4\n"),
        ("`illum`", "illum 2\n"),
        ("`Pr`, `Pm`", "Pr 0.5\nPm 1\n"),
        ("`Ke`", "Ke 1\n"),
        ("`d`, `Tr`, `map_d`", "d 0.5\n"),
        ("transparency of what shines", "Ke 1\nd 0.5\n"),
        ("`norm`", "norm a.png\n"),
        ("`Ka`", "Ka 1 1 1\n"),
        ("a colour above 1", "Kd 2\n"),
        ("options of maps", "map_Kd -s 2 2 2 a.png\n"),
        ("`map_Bump`, `bump`, `map_Ks`, `map_Ke` and whatever else", "map_Bump a.png\n"),
        ("a number that is none", "Kd red\n"),
        ("a material that no library has", "newmtl other\n"),
        ("a library that is not there", "missing"),
        ("a library that leads out of the folder", "escape"),
        ("no camera, no light", ""),
    ];
    let table = rows("OBJ");
    let said: Vec<&str> = table.iter().map(|row| &*row.construct).collect();
    assert_eq!(said, ROWS.iter().map(|(construct, _)| *construct).collect::<Vec<_>>());
    let folder = tempfile::tempdir().expect("a folder");
    for ((construct, library), row) in ROWS.iter().zip(&table) {
        write(folder.path(), library);
        if *library == "escape" {
            fs::write(folder.path().join("model.obj"), format!("mtllib /a.mtl\n{SQUARE}f 1 2 3\n")).expect("a file");
        } else if *library == "missing" {
            fs::write(folder.path().join("model.obj"), format!("mtllib none.mtl\n{SQUARE}f 1 2 3\n")).expect("a file");
        } else if *library == "newmtl other\n" {
            fs::write(folder.path().join("model.mtl"), library).expect("a file");
        }
        let outcome = match try_read(&folder.path().join("model.obj")) {
            Err(_) => "refused",
            Ok(scene) if scene.notes.iter().any(|note| !note.contains("no camera:") && !note.contains("no light:")) => "said",
            Ok(_) => "read",
        };
        assert_eq!(row.outcome, outcome, "{construct}");
    }
}
