//! Meshes that are no surfaces, fronts, and limits.

use glam::{DVec3, Vec3};
use pt::Error;
use pt::build::Source;
use pt::describe::{self, Files};
use pt::shape::{MeshData, MeshPart};
use pt::torture::meshes::mesh;

use super::cages::{cube, tetrahedron};
use super::{border, subdivided, welded};

fn corner(k: u32) -> Vec3 {
    [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE, -Vec3::ONE][k as usize]
}

fn refused(triangles: &[[u32; 3]]) -> String {
    let data = mesh((0..6).map(corner).collect(), triangles.to_vec());
    match data.subdivided(1).expect_err("no surface") {
        Error::Invalid(faults) => faults[0].message.clone(),
        other => panic!("{other}"),
    }
}

#[test]
fn what_is_no_surface_is_refused() {
    let edge = "the edge from [0.0, 0.0, 0.0] to [1.0, 0.0, 0.0]";
    assert_eq!(refused(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]), format!("3 triangles meet at {edge}, expected at most two"));
    assert_eq!(refused(&[[0, 1, 2], [0, 1, 3]]), format!("the two triangles at {edge} are wound in opposite ways"));
    // A triangle with a corner that is named twice runs along its edge to and fro.
    assert_eq!(refused(&[[0, 0, 1]]), format!("the two triangles at {edge} are wound in opposite ways"));
}

/// Bodies that touch along an edge, each with vertices of its own, stay two bodies. Fans of triangles that meet in one point only are
/// rounded off by themselves.
#[test]
fn surfaces_that_touch_stay_apart() {
    let one = cube();
    let shifted: Vec<DVec3> = one.positions.iter().map(|p| *p + DVec3::new(2.0, 2.0, 0.0)).collect();
    let both = super::Cage {
        positions: [one.positions.clone(), shifted].concat(),
        triangles: one.triangles.iter().copied().chain(one.triangles.iter().map(|t| t.map(|v| v + 8))).collect(),
    };
    let (both, one) = (subdivided(&both, 2), subdivided(&one, 2));
    assert_eq!(both.positions.len(), 2 * one.positions.len());
    let corners = |data: &MeshData| data.triangles.as_flattened().iter().map(|v| data.positions[*v as usize]).collect::<Vec<_>>();
    assert_eq!(corners(&both)[..corners(&one).len()], corners(&one));
    assert!(border(&both.triangles).is_empty());

    let tetrahedron = tetrahedron();
    let mirrored = tetrahedron.positions.iter().skip(1).map(|p| 2.0 * tetrahedron.positions[0] - *p);
    let number = |v: u32| if v == 0 { 0 } else { v + 3 };
    let hourglass = super::Cage {
        positions: tetrahedron.positions.iter().copied().chain(mirrored).collect(),
        triangles: tetrahedron
            .triangles
            .iter()
            .copied()
            .chain(tetrahedron.triangles.iter().map(|&[a, b, c]| [a, c, b].map(number)))
            .collect(),
    };
    let (pair, single) = (subdivided(&hourglass, 2), subdivided(&tetrahedron, 2));
    assert_eq!(pair.positions.len(), 2 * single.positions.len());
    assert!(border(&welded(&pair)).is_empty());
}

/// The front is the side that the normals point to, as without subdivision: a mesh that is wound against its normals is turned over.
#[test]
fn normals_decide_which_side_is_the_front() {
    let cage = cube();
    let outwards = |sign: f32| cage.positions.iter().map(|p| sign * p.as_vec3()).collect();
    let plain = subdivided(&cage, 1);
    for sign in [1.0, -1.0] {
        let mut data = MeshData { normals: outwards(sign), ..cage.data() };
        data.triangles.iter_mut().step_by(3).for_each(|t| t.swap(1, 2));
        let data = data.subdivided(1).expect("a surface");
        let volume: f64 = data.triangles.iter().map(|&t| data.corners(t)[0].dot(data.cross(t)) / 6.0).sum();
        let expected: f64 = plain.triangles.iter().map(|&t| plain.corners(t)[0].dot(plain.cross(t)) / 6.0).sum();
        assert!((volume - expected * f64::from(sign)).abs() < 1e-5, "{volume} {expected}");
        assert!(data.positions.iter().zip(&data.normals).all(|(p, n)| p.dot(*n) * sign > 0.0));
    }
}

/// Parts keep their triangles.
#[test]
fn parts_keep_their_triangles() {
    let part = |name: &str, triangles| MeshPart { material: Some(name.into()), group: None, triangles };
    let data = MeshData { parts: vec![part("a", 0..5), part("b", 5..12)], ..cube().data() };
    let data = data.subdivided(2).expect("a surface");
    assert_eq!(data.parts, [part("a", 0..80), part("b", 80..192)]);
}

#[test]
fn too_many_triangles_are_refused_before_they_are_made() {
    for levels in [11, 40, u32::MAX] {
        let error = cube().data().subdivided(levels).expect_err("many triangles");
        assert_eq!(error.exit_code(), 4);
        assert!(error.to_string().contains("expected at most 16777216"), "{error}");
    }
}

/// Builds a scene with one mesh.
fn built(keys: &str) -> pt::Result<()> {
    let text = format!(
        r#"{{"pt": 1, "camera": {{}}, "shapes": [{{"type": "mesh", "positions": [[0,0,0], [1,0,0], [0,1,0], [0,0,1], [1,1,1]], {keys}}}]}}"#
    );
    let root = describe::root(text.as_bytes(), "s")?;
    pt::build::build(&describe::read(&root, "s")?, Source { root: &root, file: "s", files: &Files::within("") }).map(drop)
}

#[test]
fn scenes_say_what_is_wrong() {
    for (keys, expected) in [
        (
            r#""triangles": [[0,1,2]], "subdivision_levels": 11"#,
            "/shapes/0/subdivision_levels: expected a whole number from 0 to 10, found 11",
        ),
        (r#""triangles": [[0,1,2]], "subdivision_levels": 1.5"#, "/shapes/0/subdivision_levels: "),
        (
            r#""triangles": [[0,1,2], [1,0,3], [0,1,4]], "subdivision_levels": 1"#,
            "/shapes/0/subdivision_levels: 3 triangles meet at the edge from [0.0, 0.0, 0.0] to [1.0, 0.0, 0.0]",
        ),
        (r#""triangles": [[0,1,2], [0,1,3]], "subdivision_levels": 1"#, "/shapes/0/subdivision_levels: the two triangles at the edge"),
    ] {
        let said = built(keys).expect_err(keys).to_string();
        assert!(said.lines().count() == 1 && said.contains(expected), "{keys}: {said}");
    }
    assert!(built(r#""triangles": [[0,1,2], [0,1,3]], "subdivision_levels": 0"#).is_ok());
    // Different triangles: equal ones would be one.
    let corners = (0..5).flat_map(|a| (0..5).flat_map(move |b| (0..5).map(move |c| [a, b, c])));
    let triangles = corners.filter(|[a, b, c]| a < b && a < c && b != c).take(17).map(|t| format!("{t:?}"));
    let many = triangles.collect::<Vec<_>>().join(", ");
    let most = built(&format!(r#""triangles": [{many}], "subdivision_levels": 10"#)).expect_err("17 · 4¹⁰ > 2²⁴");
    assert_eq!(most.exit_code(), 4);
    let place = "/shapes/0/subdivision_levels: 10 levels make 17825792 triangles, expected at most 16777216";
    assert!(most.to_string().contains(place), "{most}");
}
