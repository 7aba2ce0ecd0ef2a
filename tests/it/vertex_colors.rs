//! Colours at the vertices of a mesh: they are interpolated, for every file format, and white where there are none.

use std::io::Cursor;

use glam::{Vec3, Vec4};
use pt::build::{Built, Source};
use pt::describe::{self, Files, mesh};
use pt::shape::MeshData;
use pt::shape::mesh_data::MeshPart;

use crate::import::{met, reflected};

fn built(shape: &str) -> Built {
    let scene = format!(
        r#"{{ "pt": 1, "camera": {{}}, "materials": {{ "m": {{ "type": "mirror", "color": {{ "type": "vertex_color" }} }},
        "g": {{ "type": "mirror", "color": {{ "type": "vertex_color", "channel": "g" }} }} }}, "shapes": [{shape}] }}"#
    );
    let root = describe::root(scene.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").unwrap_or_else(|e| panic!("{e}"));
    pt::build::build(&described, Source { root: &root, file: "s.json", files: &Files::default() }).unwrap_or_else(|e| panic!("{e}"))
}

/// Vertex colours that are an affine function of the position give that function everywhere.
#[test]
fn colours_are_interpolated_over_triangles() {
    let shape = |material: &str| {
        format!(
            r#"{{ "type": "mesh", "material": "{material}", "positions": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "triangles": [[0,1,2],[0,2,3]],
                "colors": [[0.25,0,1],[0.75,0,0.5],[0.75,1,0],[0.25,1,0.5]] }}"#
        )
    };
    for (material, expected) in
        [("m", (|x, y| [0.25 + 0.5 * x, y, 1.0 - 0.5 * x - 0.5 * y]) as fn(f64, f64) -> [f64; 3]), ("g", |_, y| [y; 3])]
    {
        let built = built(&shape(material));
        for (x, y) in [(0.1, 0.2), (0.7, 0.1), (0.3, 0.9), (0.5, 0.5), (0.99, 0.98)] {
            let found = met(&built, [x, y, 2.0], [0.0, 0.0, -1.0], |surface, _| reflected(surface).to_rgb().map(f64::from));
            let near = found.iter().zip(expected(x, y)).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(near, "({x}, {y}): {found:?}, expected {:?}", expected(x, y));
        }
    }
}

#[test]
fn meshes_without_colours_are_white() {
    for shape in
        [r#"{ "type": "quad", "material": "m" }"#, r#"{ "type": "sphere", "material": "m" }"#, r#"{ "type": "disk", "material": "g" }"#]
    {
        let found = met(&built(shape), [0.0, 0.0, 3.0], [0.0, 0.0, -1.0], |surface, _| reflected(surface).to_rgb());
        assert_eq!(found, [1.0; 3], "{shape}");
    }
}

fn triangle(colors: Vec<Vec4>) -> MeshData {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let parts = vec![MeshPart { triangles: 0..1, ..MeshPart::default() }];
    MeshData { positions, colors, triangles: vec![[0, 1, 2]], parts, ..MeshData::default() }
}

/// A written PLY file is read back with the same bits, except for what cleaning removes.
#[test]
fn a_ply_keeps_its_colours() {
    let colors = vec![Vec4::new(0.1, 0.2, 0.3, 0.4), Vec4::new(1.0, 0.0, 1e-7, 1.0), Vec4::splat(0.7)];
    let mut whole = triangle(colors.clone());
    // A vertex that no triangle uses is removed, with its colour.
    whole.positions.insert(0, Vec3::Z);
    whole.colors.insert(0, Vec4::ONE);
    whole.triangles = vec![[1, 2, 3]];
    let mut bytes = vec![];
    whole.write_ply_binary(&mut bytes).expect("memory takes it");
    let (back, _) = mesh::read(Cursor::new(bytes), "a.ply").expect("a mesh");
    assert_eq!(back, triangle(colors));
}

/// Integers are encoded in sRGB (IEC 61966-2-1) except for the opacity. Floats are linear, and values outside of 0 to 1 are clamped.
#[test]
fn colours_of_a_ply_by_their_types() {
    let srgb = |x: f64| if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
    let ply = |kind: &str, color: &str, alpha: bool| {
        let names: String =
            ["red", "green", "blue", "alpha"][..3 + usize::from(alpha)].iter().map(|c| format!("property {kind} {c}\n")).collect();
        let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
        let text = format!(
            "{header}{names}element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 {color}\n1 0 0 {color}\n0 1 0 {color}\n3 0 1 2\n"
        );
        mesh::read(Cursor::new(text), "a.ply").unwrap_or_else(|e| panic!("{e}")).0.colors
    };
    for (kind, color, alpha, expected) in [
        ("uchar", "0 51 255", false, [0.0, srgb(0.2), 1.0, 1.0]),
        ("uchar", "9 51 255 51", true, [srgb(9.0 / 255.0), srgb(0.2), 1.0, 0.2]),
        ("ushort", "0 13107 65535", false, [0.0, srgb(0.2), 1.0, 1.0]),
        ("float", "0.25 0.5 1", false, [0.25, 0.5, 1.0, 1.0]),
        ("float", "-3 7 0.5 2", true, [0.0, 1.0, 0.5, 1.0]),
    ] {
        for found in ply(kind, color, alpha) {
            let near = found.to_array().iter().zip(expected).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-6);
            assert!(near, "{kind} {color}: {found}, expected {expected:?}");
        }
    }
}
