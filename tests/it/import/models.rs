//! PLY and STL files as models, and messages about files of unknown formats.

use std::fs;
use std::path::Path;

use pt::describe::mesh;

use super::read::{read, try_read};
use super::table::rows;
use crate::random::Random;

const TETRAHEDRON: [[[f32; 3]; 3]; 4] = {
    let [o, x, y, z] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5]];
    [[o, y, x], [o, x, z], [o, z, y], [x, y, z]]
};

/// A binary STL file: a header of 80 bytes, the count, and for each triangle the normal, the corners and two bytes.
fn binary_stl(header: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, 0);
    bytes.extend(4u32.to_le_bytes());
    for triangle in TETRAHEDRON {
        bytes.extend([0; 12]);
        bytes.extend(triangle.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ascii_stl(name: &str) -> String {
    let vertex = |p: &[f32; 3]| format!("vertex {} {} {:e}\n", p[0], p[1], p[2]);
    let facet =
        |t: &[[f32; 3]; 3]| format!("facet normal 0 0 0\n outer loop\n{}endloop\nendfacet\n", t.iter().map(vertex).collect::<String>());
    format!("solid{name}\n{}endsolid{name}\n", TETRAHEDRON.iter().map(facet).collect::<String>())
}

fn ply() -> String {
    ply_with("", "")
}

/// A PLY file whose vertices have further properties, with these values.
fn ply_with(properties: &str, values: &str) -> String {
    let (mut vertices, mut faces) = (String::new(), String::new());
    for (i, triangle) in TETRAHEDRON.iter().enumerate() {
        triangle.iter().for_each(|p| vertices += &format!("{} {} {}{values}\n", p[0], p[1], p[2]));
        faces += &format!("3 {} {} {}\n", 3 * i, 3 * i + 1, 3 * i + 2);
    }
    let properties: String =
        ["x", "y", "z"].into_iter().chain(properties.split_whitespace()).map(|p| format!("property float {p}\n")).collect();
    let header = format!("format ascii 1.0\nelement vertex 12\n{properties}element face 4\nproperty list uchar int vertex_indices\n");
    format!("ply\n{header}end_header\n{vertices}{faces}")
}

/// One tetrahedron, written in each variant of the model formats and under any file name, is read as the same four triangles.
#[test]
fn models_of_every_format_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let upper = ascii_stl(" part").to_uppercase().replace('\n', "\r\n");
    for (name, bytes) in [
        ("a.ply", ply().into_bytes()),
        ("noname", ply().into_bytes()),
        ("a.stl", binary_stl(b"exported by a program")),
        // The header of this binary file begins like an ASCII file.
        ("b.stl", binary_stl(b"solid exported by a program facet")),
        ("B.STL", ascii_stl(" part").into_bytes()),
        ("c.stl", ascii_stl("").into_bytes()),
        ("d.stl", upper.into_bytes()),
        ("stl", binary_stl(b"")),
    ] {
        fs::write(folder.path().join(name), bytes).expect("a file");
        let scene = read(&folder.path().join(name));
        let shown = scene.at("/shapes/0/file").as_str().expect("a file");
        let mesh = if scene.files.made.contains_key(shown) {
            scene.mesh(0)
        } else {
            mesh::load(&folder.path().join(shown), shown).expect("a mesh").0
        };
        let places: Vec<[[f32; 3]; 3]> = mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize].to_array())).collect();
        assert_eq!(places, TETRAHEDRON, "{name}");
        assert!(scene.notes_say("no camera: placed at") && scene.notes_say("no light: a clear sky"), "{name}: {:?}", scene.notes);
        // STL files have z up, as for 3D printers.
        assert_eq!(scene.at("/camera/look_at").get("up").is_some(), name.to_lowercase().contains("stl"), "{name}");
        assert_eq!(mesh.positions.len(), if name.contains("stl") || name.contains("STL") { 4 } else { 12 }, "{name}: equal corners");
    }
}

fn said(path: &Path, bytes: &[u8]) -> String {
    fs::write(path, bytes).expect("a file");
    match try_read(path) {
        Ok(_) => String::new(),
        Err(error) => {
            assert!(matches!(error.exit_code(), 3 | 4), "{error}");
            error.to_string()
        }
    }
}

#[test]
fn faults_of_stl_files_have_a_position() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.stl");
    let whole = binary_stl(b"");
    let mut not_finite = whole.clone();
    not_finite[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    let text = |from: &str, to: &str| ascii_stl("").replacen(from, to, 1).into_bytes();
    for (bytes, expected) in [
        (not_finite, "triangle 1: a coordinate that is not finite (NaN)"),
        (text("vertex 0 0 0", "vertex 0 x 0"), "a.stl:4: expected a number, found x"),
        (text("vertex 0 0 0", "vertex 0 0"), "a.stl:4: a vertex of 2 numbers, expected x, y and z"),
        (text("endloop", "vertex 1 2 3"), "a.stl:8: a facet of 4 vertices, expected 3"),
        (text("outer loop", "other words"), "a.stl:3: expected facet, vertex or endsolid, found other"),
        (ascii_stl("").split("endloop").next().unwrap_or_default().into(), "the file ends within a facet"),
        (b"solid\nendsolid\n".to_vec(), "no faces"),
    ] {
        let found = said(&path, &bytes);
        assert!(found.contains(expected), "expected {expected}, found {found:?}");
    }
    // The file as a mesh of a scene, where its extension gives the format.
    fs::write(&path, &whole[..whole.len() - 1]).expect("a file");
    let found = mesh::load(&path, "a.stl").err().map(|e| e.to_string()).unwrap_or_default();
    assert!(found.contains("the header promises 4 triangles of 50 bytes, but 199 bytes follow"), "{found}");
}

#[test]
fn any_bytes_of_an_stl_are_read_or_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.stl");
    let mut random = Random::new(7);
    for round in 0..400 {
        let mut bytes = if round % 2 == 0 { binary_stl(b"solid") } else { ascii_stl(" a").into_bytes() };
        for _ in 0..=random.below(3) {
            let at = random.below(bytes.len());
            bytes[at] = random.below(256) as u8;
        }
        if round % 5 == 0 {
            bytes.truncate(random.below(bytes.len()));
        }
        fs::write(&path, &bytes).expect("a file");
        for error in [mesh::load(&path, "a.stl").err(), try_read(&path).err()].into_iter().flatten() {
            assert!(matches!(error.exit_code(), 3 | 4), "round {round}: {error}");
        }
    }
}

/// Files of other formats, recognised by their first bytes.
#[test]
fn files_of_other_formats_are_recognised() {
    let folder = tempfile::tempdir().expect("a folder");
    let noise: Vec<u8> = {
        let mut random = Random::new(3);
        (0..4096).map(|_| random.below(256) as u8).collect()
    };
    let cases: [(&[u8], &str, &str); 24] = [
        (b"LookAt 3 4 1.5  .5 .5 0  0 0 1\nCamera \"perspective\"\nWorldBegin\n", "a pbrt scene", "pt reads its own JSON"),
        (b"# made by hand\n\nFilm \"rgb\" \"string filename\" \"a.exr\"\n", "a pbrt scene", "OBJ, PLY and STL"),
        (b"<?xml version='1.0'?>\n<scene version=\"3.0.0\"></scene>", "a Mitsuba scene", "glTF"),
        (b"\xEF\xBB\xBF<scene>\n <integrator type=\"normals\"/></scene>", "a Nori or Mitsuba scene", "glTF"),
        (b"<scene\n  version=\"3.0.0\"></scene>", "a Mitsuba scene", "glTF"),
        (b"<COLLADA xmlns=\"http://x\">", "a COLLADA scene", "export it as glTF"),
        (b"<?xml?>\n<COLLADA version=\"1.4.1\">\n<scene>\n</scene></COLLADA>", "a COLLADA scene", "export it as glTF"),
        (b"<!DOCTYPE HTML>\n<!-- <scene version> -->\n<HTML><svg></svg></HTML>", "a web page", "glTF"),
        (b"<!DOCTYPE svg [<!ENTITY x \"<scene>\">]><svg/>", "an SVG drawing", "glTF"),
        (b"<!-- no end", "an XML file", "glTF"),
        (b"<note/>", "an XML file", "pt reads"),
        (b"#usda 1.0\n(\n)\n", "a USD scene", "export it as glTF"),
        (b"PXR-USDC\0\x08\0\xFF", "a USD scene", "export it as glTF"),
        (b"BLENDER-v305\xFF\0", "a Blender file", "export it as glTF"),
        (b"\x28\xB5\x2F\xFD\x04\0", "a Zstandard archive", "export it as glTF"),
        (b"Kaydara FBX Binary  \0\x1A\0\xFF", "an FBX model", "export it as glTF"),
        (b"; FBX 7.3.0 project file\n", "an FBX model", "export it as glTF"),
        (b"PK\x03\x04\x14\0\xFF", "a ZIP archive", "unpack it"),
        (b"\x1F\x8B\x08\0\xFF", "a gzip archive", "unpack it"),
        (b"\x89PNG\r\n\x1a\n\0\0", "a picture", "pt image --help"),
        (b"\x76\x2F\x31\x01\x02\0\0\0", "a picture", "pt image --help"),
        (b"\x89PTC\r\n\x1a\n\0", "a part of a render", "pt merge --help"),
        (b"newmtl a\nKd 1 1 1\n", "a library of materials (MTL)", "name the .obj file"),
        (&noise, "no text, and no file of a kind that pt knows", "pt reads its own JSON"),
    ];
    for (bytes, what, advice) in cases {
        let found = said(&folder.path().join("file"), bytes);
        assert!(found.contains(what) && found.contains(advice) && found.lines().count() == 1, "{what}: {found}");
    }
    // A file that may be JSON gets the error message of JSON, with its position.
    for json in [r#"{"pt": 1, "camera": tru}"#, "[1, 2", "NaN"] {
        let found = said(&folder.path().join("file"), json.as_bytes());
        assert!(found.contains("file:") && !found.contains("does not render"), "{json}: {found}");
    }
}

/// Each row of the table of docs/import.md is tested with a file.
#[test]
fn every_row_of_the_ply_and_stl_tables_holds() {
    let files: [(&str, Vec<u8>); 9] = [
        ("the triangles of a PLY, ASCII or binary; polygons as fans", ply().into_bytes()),
        ("its `nx`, `ny`, `nz`", ply_with("nx ny nz", " 0 0 1").into_bytes()),
        ("its texture coordinates `u`, `v` (or `s`, `t`; `texture_u`, `texture_v`)", ply_with("s t", " 0.5 1").into_bytes()),
        ("its colours `red`, `green`, `blue`, `alpha`", ply_with("red green blue", " 0.5 1 0").into_bytes()),
        ("any other property of a PLY", ply_with("confidence", " 1").into_bytes()),
        ("the triangles of an STL, ASCII or binary", binary_stl(b"")),
        ("the normals and the two bytes of each triangle of an STL", ascii_stl("").into_bytes()),
        ("a number that is none, or fewer triangles than promised", ascii_stl("").replace("vertex 0", "vertex x").into_bytes()),
        ("no camera, no light", ply().into_bytes()),
    ];
    let table = rows("PLY and STL");
    let constructs: Vec<&str> = table.iter().map(|row| &*row.construct).collect();
    assert_eq!(constructs, files.each_ref().map(|(construct, _)| *construct));
    let folder = tempfile::tempdir().expect("a folder");
    for ((construct, bytes), row) in files.iter().zip(&table) {
        fs::write(folder.path().join("model"), bytes).expect("a file");
        let outcome = match try_read(&folder.path().join("model")) {
            Err(_) => "refused",
            Ok(scene) if scene.notes.iter().any(|note| !note.contains("no camera:") && !note.contains("no light:")) => "said",
            Ok(_) => "read",
        };
        assert_eq!(row.outcome, outcome, "{construct}");
    }
}
