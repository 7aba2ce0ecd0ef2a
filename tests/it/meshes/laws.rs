//! Laws of reading meshes: areas are kept, spelling does not matter, and a written mesh reads back the same.

use std::f64::consts::TAU;

use proptest::prelude::*;

use super::*;

/// A mesh of random triangles over few vertices; some without normals.
fn meshes() -> impl Strategy<Value = MeshData> {
    let number = || prop_oneof![-100.0_f32..100.0, (-3_i8..3).prop_map(f32::from)];
    let vector = move || [number(), number(), number()].prop_map(Vec3::from);
    let vertices = proptest::collection::vec((vector(), vector(), [number(), number()].prop_map(Vec2::from)), 3..20);
    (vertices, proptest::collection::vec([0..1000_u32, 0..1000, 0..1000], 1..40), any::<[bool; 2]>(), 0..40_u32)
        .prop_map(|(vertices, triangles, [has_normals, has_uvs], cut)| {
            let count = vertices.len() as u32;
            let triangles: Vec<_> = triangles.into_iter().map(|t| t.map(|i| i % count)).collect();
            let (end, cut) = (triangles.len() as u32, cut.min(triangles.len() as u32));
            let name = |s: &str| Some(s.to_string());
            let part = |range, material| pt::shape::mesh_data::MeshPart { material, group: name("group of parts"), triangles: range };
            MeshData {
                positions: vertices.iter().map(|v| v.0).collect(),
                normals: vertices.iter().filter(|_| has_normals).map(|v| v.1).collect(),
                uvs: vertices.iter().filter(|_| has_uvs).map(|v| v.2).collect(),
                colors: vertices.iter().filter(|_| has_uvs).map(|v| (v.0.abs() / (1.0 + v.0.abs())).extend(0.5)).collect(),
                triangles,
                parts: [part(0..cut, name("järvi 1")), part(cut..end, None)].into_iter().filter(|p| !p.triangles.is_empty()).collect(),
            }
        })
        .prop_map(|mesh| mesh.clean().0)
        .prop_filter("a mesh has triangles", |mesh| !mesh.triangles.is_empty())
}

proptest! {
    #![proptest_config(cases(2000))]

    /// OBJ keeps everything except the numbering of vertices.
    #[test]
    fn obj_round_trip(mesh in meshes()) {
        let mut file = Vec::new();
        mesh.write_obj(&mut file).expect("memory takes it");
        let back = mesh_of(&file);
        assert_sound(&back);
        prop_assert_eq!(seen(&back), seen(&mesh));
        prop_assert_eq!(back.parts, mesh.parts);
    }

    /// Binary PLY keeps everything except parts, numbering included; OBJ → PLY → OBJ too.
    #[test]
    fn ply_round_trip(mesh in meshes()) {
        let mut file = Vec::new();
        mesh.write_ply_binary(&mut file).expect("memory takes it");
        let back = mesh_of(&file);
        // Without parts, a triangle that was in two parts is a duplicate.
        if back.triangles.len() == mesh.triangles.len() {
            prop_assert_eq!(&MeshData { parts: mesh.parts.clone(), ..back.clone() }, &mesh);
        }
        let mut again = Vec::new();
        back.write_obj(&mut again).expect("memory takes it");
        prop_assert_eq!(seen(&mesh_of(&again)), seen(&back));
    }

    /// The triangles of a convex polygon have its area together: ½ |Σ pᵢ × pᵢ₊₁|.
    #[test]
    fn polygons_keep_their_area(corners in 3..40_usize, axes in [[-10.0_f64..10.0, -10.0..10.0, -10.0..10.0], [-10.0..10.0, -10.0..10.0, -10.0..10.0]]) {
        let [a, b] = axes.map(DVec3::from);
        let points: Vec<Vec3> = (0..corners).map(|i| TAU * i as f64 / corners as f64).map(|t| (a * t.cos() + b * t.sin()).as_vec3()).collect();
        let polygon_area = 0.5 * (0..corners).map(|i| points[i].as_dvec3().cross(points[(i + 1) % corners].as_dvec3())).sum::<DVec3>().length();
        let mut file: String = points.iter().map(|p| format!("v {:?} {:?} {:?}\n", p.x, p.y, p.z)).collect();
        file += &format!("f {}\n", (1..=corners).map(|i| i.to_string()).collect::<Vec<_>>().join(" "));
        // The corners are rounded to f32 (2⁻²⁴ of 20), which tilts triangles out of the plane. Their areas then differ from the projected
        // one by the rounding error times the perimeter (< 130), also where the ellipse degenerates to a line.
        let tolerance = 20.0 * 2_f64.powi(-24) * 130.0;
        let measured = read(file).map_or(0.0, |(mesh, _)| area(&mesh));
        prop_assert!((measured - polygon_area).abs() <= tolerance, "{measured} against {polygon_area}");
    }

    /// A file has the same meaning with relative indices, other line ends, continuations, blanks and comments.
    #[test]
    fn spelling_changes_nothing(mesh in meshes(), breaks in proptest::collection::vec(0..6_usize, 64)) {
        let mut file = Vec::new();
        mesh.write_obj(&mut file).expect("memory takes it");
        let plain = String::from_utf8(file).expect("the writer writes UTF-8");
        let expected = mesh_of(&plain);
        prop_assert_eq!(&mesh_of(plain.replace('\n', "\r\n")), &expected);
        prop_assert_eq!(&mesh_of(plain.trim_end()), &expected);
        prop_assert_eq!(&mesh_of(relative(&plain, &mesh)), &expected);
        let mut odd = String::new();
        let mut breaks = breaks.iter().cycle();
        for line in plain.lines() {
            let is_name = line.starts_with('g') || line.starts_with('u');
            let blank = |i: &usize| ["  ", "\t", " \\\n", " \\\r\n\t", " \\\n\\\n ", " "][if is_name { 5 } else { *i }];
            let words: Vec<_> = line.split(' ').collect();
            words.iter().for_each(|word| { odd += word; odd += blank(breaks.next().unwrap_or(&0)) });
            odd += if is_name { "\n" } else { " \n#comment\n\n" };
        }
        // A continuation may precede the comment. It must not hide the next statement.
        prop_assert_eq!(&mesh_of(odd.replace("\\\n \n", "\n").replace("\\\r\n\t \n", "\n")), &expected);
    }
}

/// The file `plain` with relative indices, which count backwards from −1.
fn relative(plain: &str, mesh: &MeshData) -> String {
    let counts = [mesh.positions.len(), mesh.uvs.len(), mesh.normals.len()];
    let backwards = |corner: &str| {
        let fields = corner.split('/').zip(counts);
        let fields = fields.map(|(field, count)| field.parse::<usize>().map_or(String::new(), |i| format!("-{}", count + 1 - i)));
        fields.collect::<Vec<_>>().join("/")
    };
    let line = |line: &str| match line.strip_prefix("f ") {
        Some(corners) => format!("f {}\n", corners.split(' ').map(backwards).collect::<Vec<_>>().join(" ")),
        None => format!("{line}\n"),
    };
    plain.lines().map(line).collect()
}

#[test]
fn faces_with_and_without_normals_and_uvs_mix() {
    let normal = Vec3::new(0.0, 0.0, 1.0);
    let file =
        format!("{SQUARE}f 1 2 3\nvn 0 0 1\nf 1//1 3//1 4//1\nvt 0.5 0.25\nf 2/1 3/1 4/1\nf -3/-1/-1 -2/-1/-1 -1/-1/-1\nf 1// 2// 4//\n");
    let mesh = mesh_of(file);
    assert_sound(&mesh);
    let seen: Vec<_> = seen(&mesh).iter().map(|t| (t[0].1, t[2].2)).collect();
    let (zero, uv) = (Some(Vec2::ZERO), Some(Vec2::new(0.5, 0.25)));
    // The fourth face repeats the third's positions and is dropped.
    assert_eq!(seen, [(None, zero), (Some(normal), zero), (None, uv), (None, zero)]);
}

#[test]
fn groups_and_materials_become_parts() {
    let file = format!(
        "{SQUARE}f 1 2 3\ng  left wing \nusemtl a b\nf 1 2 4\no body\nusemtl a b\nf 1 3 4\ng body\nusemtl\nusemtl a b\nf 2 3 4\ng\nusemtl z\nusemtl\nf 2 4 3"
    );
    let parts: Vec<_> = mesh_of(file).parts.into_iter().map(|p| (p.group, p.material, p.triangles)).collect();
    let name = |s: &str| Some(s.to_string());
    assert_eq!(parts, [(None, None, 0..1), (name("left wing"), name("a b"), 1..2), (name("body"), name("a b"), 2..4), (None, None, 4..5)]);
    let broken = [SQUARE.as_bytes(), b"g \xe4\xff\nf 1 2 3"].concat();
    assert_eq!(mesh_of(broken).parts[0].group, name("\u{fffd}\u{fffd}"));
}

#[test]
fn what_is_no_triangle_is_ignored_with_one_warning() {
    let file =
        format!("{SQUARE}s 1\nl 1 2 3 4\np 1\nl 1 2\ncurv2 1 2\nvp 0 0\nv 5 5 5 1 0 0\nv 6 6 6 2\nvt 1\nvt 1 2 3\nvn 0 0 1 9\nf 1 2 3 4");
    let (mesh, warnings) = read(file).expect("only faces matter");
    assert_eq!((mesh.triangles.len(), area(&mesh)), (2, 1.0));
    assert_eq!(warnings, ["mesh.obj: ignored statements: curv2 (1), l (2), p (1), vp (1)"]);
}

#[test]
fn many_faults_come_at_once_in_order() {
    let file = "f 1 2\nv 0 x 0\n".repeat(30);
    let Err(pt::Error::Invalid(faults)) = read(file) else { panic!("refused with faults") };
    let lines: Vec<_> = faults.iter().filter_map(|f| f.line).collect();
    assert_eq!(lines, (1..=pt::MAX_FAULTS).collect::<Vec<_>>());
}
