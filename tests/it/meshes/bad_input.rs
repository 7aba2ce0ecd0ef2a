//! Mesh files that are refused, in more detail than the table of `bad_input`, and unusual files that are valid.

use super::*;

/// Asserts that an OBJ after the square (lines 1–4) is refused at a line with a phrase, as exit code 3.
fn refused_after_square(rows: &[(&str, usize, &str)]) {
    for &(statements, line, phrase) in rows {
        refused(format!("{SQUARE}{statements}"), &format!("mesh.obj:{line}: "), phrase);
    }
}

fn refused(bytes: impl AsRef<[u8]>, place: &str, phrase: &str) {
    let bytes = bytes.as_ref();
    let shown = String::from_utf8_lossy(&bytes[..bytes.len().min(400)]);
    match read(bytes) {
        Ok(_) => panic!("not refused ({phrase}):\n{shown}"),
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with(place) && message.contains(phrase), "{message}\nwanted {place}…{phrase}, of\n{shown}");
            assert_eq!(error.exit_code(), 3, "{message}");
        }
    }
}

/// Asserts that a file is read, with a warning that contains the phrase.
fn warned(bytes: impl AsRef<[u8]>, phrase: &str) -> MeshData {
    let (mesh, warnings) = read(bytes).unwrap_or_else(|error| panic!("{error}"));
    let with_phrase = warnings.iter().filter(|w| w.contains(phrase)).count();
    assert_eq!(with_phrase, 1, "one warning with \"{phrase}\" in {warnings:?}");
    mesh
}

#[test]
fn face_indices_that_name_nothing() {
    refused_after_square(&[
        ("f 1 2 99999999999999999999999", 5, "expected a vertex index, found 99999999999999999999999"),
        ("f 1 2 -9223372036854775808", 5, "vertex index -9223372036854775808"),
        ("f 1 2 9223372036854775807", 5, "vertex index 9223372036854775807"),
        ("f 1 2 x", 5, "expected a vertex index, found x"),
        ("f 1 2 3.0", 5, "expected a vertex index, found 3.0"),
        ("f 1 2 /3", 5, "expected a vertex index"),
        ("f 1/1/1/1 2 3", 5, "texture coordinate index 1, but only 0"),
        ("vt 0 0\nvn 0 0 1\nf 1/1/1/1 2/1/1/1 3/1/1/1", 7, "has more than vertex/texture coordinate/normal"),
        ("vn 0 0 1\nf 1//1 2//1 3", 6, "corner 3 is written 3, unlike those before it"),
        ("f 1 2 3\nf 1 2 5\nv 1 1 1", 6, "only 4 vertices so far"),
    ]);
}

#[test]
fn coordinates_that_are_no_numbers() {
    for number in ["nan", "NaN", "-nan", "inf", "-Infinity", "-1.#IND00", "1.#INF", "nan(ind)"] {
        refused_after_square(&[
            (&format!("v 0 {number} 0"), 5, &format!("y: {number} is not a finite number")),
            (&format!("vt {number} 0"), 5, &format!("u: {number} is not a finite number")),
        ]);
    }
    refused_after_square(&[
        ("v 0 0 -1e400", 5, "z: -1e400 is beyond the range of f32"),
        ("vn 1,5 0 0", 5, "x: expected a number, found 1,5"),
        ("v 0x10 0 0", 5, "x: expected a number, found 0x10"),
        ("v 1 2 3 blue", 5, "expected a number, found blue"),
    ]);
    refused(b"v 1 2 \xff\xfe\n", "mesh.obj:1: ", "z: expected a number, found \u{fffd}\u{fffd}");
}

#[test]
fn too_few_components_and_empty_arrays() {
    refused_after_square(&[
        ("v", 5, "x is missing"),
        ("vn 0 1", 5, "a normal needs x, y and z, but z is missing"),
        ("vt", 5, "a texture coordinate needs u"),
        ("f 1//-1 2//-1 3//-1", 5, "normal index -1, but only 0 normals so far"),
    ]);
}

#[test]
fn faces_of_any_number_of_corners() {
    refused_after_square(&[
        ("f", 5, "a face with 0 corners, at least 3 are needed"),
        ("f 1 2 # 3", 5, "a face with 2 corners, at least 3 are needed"),
    ]);
    // A face of five corners with one repeated: one of its three triangles has no area.
    let mesh = warned(format!("{SQUARE}f 1 2 2 3 4"), "mesh.obj: 1 degenerate triangle dropped");
    assert_eq!((mesh.triangles.len(), area(&mesh)), (2, 1.0));
    // A self-crossing quad (bow tie) gives two triangles, whatever their orientation.
    assert_eq!(mesh_of(format!("{SQUARE}f 1 3 2 4")).triangles.len(), 2);
    let corners = 1_000_000;
    let mut polygon = String::new();
    for i in 0..corners {
        // A parabola is convex, and no three of its points lie on a line, in f32 too for whole numbers below 2²⁴.
        let x = (i % 4096) as f64;
        polygon += &format!("v {x} {} {}\n", x * x, i / 4096);
    }
    polygon += "f";
    (1..=corners).for_each(|i| polygon += &format!(" {i}"));
    let (mesh, warnings) = read(polygon).expect("a million-gon is a face");
    let dropped: usize = warnings.iter().filter_map(|w| w.split(' ').nth(1)?.parse::<usize>().ok()).sum();
    assert_eq!(mesh.triangles.len() + dropped, corners - 2);
}

#[test]
fn files_without_faces_are_refused_and_unusual_ones_read() {
    for nothing in ["", "\n\n", "# only\n# comments", SQUARE, "\u{feff}", "l 1 2 3"] {
        let error = read(nothing).expect_err("nothing to render");
        assert_eq!((error.to_string().as_str(), error.exit_code()), ("mesh.obj: no faces", 3));
    }
    let long_comment = format!("{SQUARE}# {}\nf 1 2 3 4", "x".repeat(10_000_000));
    let long_line = format!("{SQUARE}f 1 2 3{}4", " ".repeat(10_000_000));
    for right in [long_comment, long_line, format!("\u{feff}{SQUARE}f 1 2 3 4"), format!("{SQUARE}f 1 2 3 4\\")] {
        assert_eq!(area(&mesh_of(right)), 1.0);
    }
    // A backslash at the end of a comment does not continue it, so that a path in a comment does not hide the next line.
    assert_eq!(area(&mesh_of(format!("{SQUARE}# C:\\meshes\\\nf 1 2 3 4"))), 1.0);
    // A fault is reported with the line on which its statement begins.
    refused_after_square(&[("f 1 2 \\\n 3\nf 1 2 \\\n 9\n", 7, "vertex index 9")]);
}

#[test]
fn a_file_that_ends_within_a_statement() {
    refused_after_square(&[
        ("f 1 2 3\nv 1 -", 6, "y: expected a number, found -"),
        ("f 1 2 3\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/", 8, "corner 3 is written 3/1/, unlike those before it"),
        ("f 1 2 3\nv 1 2\\", 6, "z is missing"),
    ]);
}

#[test]
fn normals_without_direction_are_flat() {
    for normal in ["0 0 0", "-0 0 0", "nan 0 1", "-1.#IND00 0 0", "1e39 0 0"] {
        let file = format!("{SQUARE}vn {normal}\nvn 0 0 2\nf 1//1 2//2 3//2\nf 1//2 3//2 4//2");
        let mesh = warned(file, "mesh.obj: 1 normal without direction replaced by the face normal");
        let normals: Vec<_> = seen(&mesh).iter().map(|t| t.map(|corner| corner.1)).collect();
        assert_eq!(normals, [[None; 3], [Some(Vec3::new(0.0, 0.0, 2.0)); 3]]);
    }
    let tiny = mesh_of(format!("{SQUARE}vn 0 0 1e-45\nf 1//1 2//1 3//1"));
    assert_eq!(tiny.normals[0], Vec3::new(0.0, 0.0, 1e-45), "a short normal is a direction: no epsilon");
    let ply = ply("ascii", "nx ny nz", &["0 0 0 0 0 1", "1 0 0 0 0 0", "0 1 0 0 0 1"], &["3 0 1 2"]);
    let mesh = warned(ply, "1 normal without direction");
    assert_eq!(seen(&mesh)[0].map(|corner| corner.1), [None; 3]);
}

#[test]
fn all_triangles_degenerate() {
    for (faces, count) in [("f 1 1 2", 1), ("f 1 2 2\nf 3 3 3", 2), ("v 2 0 0\nf 1 2 5", 1), ("v 0 0 0\nf 1 5 2 2", 2)] {
        refused(format!("{SQUARE}{faces}"), "mesh.obj: ", &format!("no usable triangles (all {count} are degenerate)"));
    }
}

#[test]
fn a_hundred_thousand_times_the_same_triangle() {
    let file = format!("{SQUARE}{}", "f 1 2 3\nf 2 3 1\nf 3 1 2\n".repeat(33_334));
    let mesh = warned(file, "mesh.obj: 100001 duplicate triangles dropped");
    assert_eq!(mesh.triangles.len(), 1);
}

#[test]
fn coordinates_too_large_to_square() {
    let mut rows = Vec::new();
    for (size, extent) in [("1e30", "2e30"), ("3e38", "6e38"), ("1.5e18", "3e18")] {
        rows.push((format!("v -{size} 0 0\nv {size} 0 0\nv 0 1 0\nf 1 2 3"), format!("extent {extent} exceeds 1e18")));
    }
    rows.push(("v 2e18 0 0\nv 2e18 1 0\nv 2e18 0 1\nf 1 2 3".to_string(), "extent 2e18 exceeds 1e18".to_string()));
    rows.iter().for_each(|(file, phrase)| refused(file, "mesh.obj: ", phrase));
    assert_eq!(mesh_of("v -1e18 0 0\nv 1e18 0 0\nv 0 1e18 0\nf 1 2 3").triangles.len(), 1);
    // Only vertices that a triangle uses matter.
    assert_eq!(mesh_of(format!("v 1e30 0 0\n{SQUARE}f 2 3 4 5")).positions.len(), 4);
}

#[test]
fn detail_that_f32_resolves_gets_no_warning() {
    let wide = format!("{SQUARE}f 1 2 3\nv 9000000 0 0\nv 9000000 1 0\nf 5 6 1");
    let (_, warnings) = read(wide).expect("the mesh is sound");
    assert!(!warnings.iter().any(|w| w.contains("detail")), "{warnings:?}");
}

/// A PLY file of ascii rows, or of their binary form (`f32` coordinates, `u8` counts, `i32` indices).
fn ply(encoding: &str, more: &str, vertices: &[&str], faces: &[&str]) -> Vec<u8> {
    let properties: String = format!("x y z {more}").split_whitespace().map(|name| format!("property float {name}\n")).collect();
    let header = format!(
        "ply\nformat {encoding} 1.0\ncomment a test\nelement vertex {}\n{properties}element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.len(),
        faces.len()
    );
    let mut file = header.into_bytes();
    for (row, is_face) in vertices.iter().map(|row| (row, false)).chain(faces.iter().map(|row| (row, true))) {
        if encoding == "ascii" {
            file.extend(format!("{row}\n").bytes());
            continue;
        }
        for (i, word) in row.split(' ').enumerate() {
            let bits = match is_face {
                true if i == 0 => {
                    file.push(word.parse().expect("a small count"));
                    continue;
                }
                true => word.parse::<i32>().expect("an index") as u32,
                false => word.parse::<f32>().expect("a coordinate").to_bits(),
            };
            file.extend(if encoding == "binary_big_endian" { bits.to_be_bytes() } else { bits.to_le_bytes() });
        }
    }
    file
}

const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];
const CORNERS: [&str; 4] = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"];

#[test]
fn ply_headers_that_promise_too_much() {
    for encoding in ENCODINGS {
        let honest = String::from_utf8_lossy(&ply(encoding, "", &CORNERS, &["4 0 1 2 3"])).into_owned();
        assert_eq!(area(&mesh_of(ply(encoding, "", &CORNERS, &["4 0 1 2 3"]))), 1.0);
        let lie = |from: &str, to: &str| {
            let mut bytes = ply(encoding, "", &CORNERS, &["4 0 1 2 3"]);
            let at = honest.find(from).expect("the header has it");
            bytes.splice(at..at + from.len(), to.bytes());
            bytes
        };
        refused(lie("vertex 4", "vertex 4000000000"), "mesh.obj: ", "the header promises 4000000000 vertex, 1 face elements, at least ");
        refused(lie("face 1", "face 4000000000"), "mesh.obj: ", "the header promises 4 vertex, 4000000000 face elements");
        refused(lie("vertex 4", "extra 4000000000\nelement vertex 4"), "mesh.obj: ", "element extra has no properties");
        refused(lie("vertex 4", "vertex 3"), "mesh.obj", "");
        let error = read(lie("vertex 4", "vertex 5000000000")).expect_err("too many to number");
        assert_eq!((error.exit_code(), error.to_string().contains("at most 2^32 - 1")), (4, true), "{error}");
    }
}

#[test]
fn ply_rows_that_are_wrong() {
    let nan = ["0 0 0", "1 nan 0", "1 1 0", "0 1 0"];
    let (place, nothing) = ("mesh.obj:15: ", "mesh.obj: ");
    for (i, encoding) in ENCODINGS.into_iter().enumerate() {
        let line = |line: usize| if i == 0 { format!("mesh.obj:{line}: ") } else { nothing.to_string() };
        refused(ply(encoding, "", &nan, &["3 0 1 2"]), &line(12), "vertex 1: y is not a finite f32 (NaN)");
        refused(ply(encoding, "", &CORNERS, &["3 0 1 4"]), &line(15), "face 0: vertex index 4, but there are 4 vertices");
        refused(ply(encoding, "", &CORNERS, &["3 0 1 2", "2 0 1"]), &line(16), "face 1: 2 corners, at least 3 are needed");
        refused(ply(encoding, "", &CORNERS, &[]), nothing, "no faces");
        let mut cut = ply(encoding, "", &CORNERS, &["3 0 1 2", "3 0 2 3"]);
        cut.truncate(cut.len() - 3);
        refused(
            &cut,
            &if i == 0 { "mesh.obj:16: ".to_string() } else { nothing.to_string() },
            if i == 0 { "3 values promised, only 2 there" } else { "the file ends within face 1, 2 were promised" },
        );
    }
    refused(ply("binary_little_endian", "", &CORNERS, &["3 0 1 -1"]), nothing, "face 0: vertex index -1, but there are 4 vertices");
    refused(ply("ascii", "", &CORNERS, &["3 0 1 -1"]), place, "face 0: vertex_indices: expected a vertex index, found -1");
    refused(ply("ascii", "", &CORNERS, &["-3 0 1 2"]), place, "face 0: vertex_indices: expected a count, found -3");
    refused(ply("ascii", "", &CORNERS, &["4000000000 0 1 2"]), place, "4000000000 values promised, only 3 there");
    refused(ply("ascii", "", &["1,5 0 0"], &["3 0 0 0"]), "mesh.obj:11: ", "vertex 0: x: expected a number, found 1,5");
    refused(ply("ascii", "", &["1e39 0 0"], &["3 0 0 0"]), "mesh.obj:11: ", "vertex 0: x is not a finite f32 (inf)");
    let mut negative_count = String::from_utf8_lossy(&ply("binary_little_endian", "", &CORNERS, &[]))
        .replace("list uchar", "list char")
        .replace("face 0", "face 1")
        .into_bytes();
    negative_count.extend([0xff; 13]);
    refused(negative_count, nothing, "face 0: list length cannot be negative");
}

#[test]
fn ply_headers_that_are_wrong() {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n.5 0 0\n0 1. 0\n\n3 0 1 2\n";
    assert_eq!(area(&mesh_of(header)), 0.25, "numbers as C and Python write them");
    for (from, to, place, phrase) in [
        ("end_header\n", "", "mesh.obj: ", "the header has no line \"end_header\""),
        ("format ascii 1.0\n", "", "mesh.obj: ", "no format line found"),
        ("ascii 1.0", "text 1.0", "mesh.obj:2: ", "not a PLY header line: format text 1.0"),
        ("property float z\n", "", "mesh.obj: ", "vertex has no property z"),
        ("property float z\n", "property list uchar float z\n", "mesh.obj: ", "vertex has no property z"),
        ("property float z\n", "property float x\n", "mesh.obj:6: ", "property x comes twice"),
        ("element face 1", "element vertex 1", "mesh.obj:7: ", "comes twice"),
        ("element face 1", "element fan 1", "mesh.obj: ", "no element face"),
        ("element vertex 3", "element point 3", "mesh.obj: ", "no element vertex"),
        ("vertex_index", "vertices", "mesh.obj: ", "face needs one integer list vertex_indices (or vertex_index)"),
        ("uchar int", "uchar float", "mesh.obj: ", "face needs one integer list"),
        ("uchar int", "float int", "mesh.obj: ", "the length of list vertex_index is no integer"),
    ] {
        refused(header.replacen(from, to, 1), place, phrase);
    }
}
