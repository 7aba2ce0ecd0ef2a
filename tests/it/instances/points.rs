//! Instances at the points of a PLY file.

use glam::{DQuat, DVec3, Vec3};
use pt::Error;
use pt::build::Source;
use pt::describe::mesh::points;
use pt::describe::{self, Files};
use pt::math::Ray;
use pt::scene::Scene;
use serde_json::json;

use super::{assert_near, scene};

/// The points of a text, read as a file.
fn read(properties: &str, rows: &str) -> pt::Result<(Vec<points::InstancePoint>, Vec<String>)> {
    let properties: String = properties.split(' ').map(|name| format!("property float {name}\n")).collect();
    let text = format!("ply\nformat ascii 1.0\nelement vertex {}\n{properties}end_header\n{rows}", rows.lines().count());
    points::read(std::io::Cursor::new(text.into_bytes()), "p.ply")
}

/// A point scales first, then rotates, then moves, and chooses its material.
#[test]
fn points_place_instances() {
    let (found, warnings) =
        read("x y z qx qy qz qw scale_x scale_y scale_z material", "1 2 3 0 0 1 1 2 3 -4 1\n0 0 0 0 0 0 9 1 1 1 0\n").expect("points");
    assert_eq!((found.len(), warnings.len(), found[0].material), (2, 0, 1));
    // (1, 1, 1) is scaled to (2, 3, −4), turned by 90° about z to (−3, 2, −4), and moved to (−2, 4, −1).
    let placed = found[0].matrix().transform_point3(DVec3::ONE);
    assert!((placed - DVec3::new(-2.0, 4.0, -1.0)).length() < 1e-12, "{placed}");
    assert_eq!(found[1].matrix().transform_point3(DVec3::ONE), DVec3::ONE);
    let (found, _) = read("x y z scale", "0 0 0 2.5\n").expect("points");
    assert_eq!(found[0].matrix().transform_point3(DVec3::ONE), DVec3::splat(2.5));
    let (_, warnings) = read("x y z rot_0 scale_0", "0 0 0 1 1\n").expect("points");
    assert_eq!(warnings, ["p.ply: instances have no property rot_0, scale_0: left out"]);
}

#[test]
fn unusable_points_are_refused() {
    let cases = [
        ("x y", "0 0\n", "p.ply: vertex has no property z"),
        ("x y z qx qy", "0 0 0 1 1\n", "p.ply: vertex has some of qx qy qz qw, expected all or none"),
        ("x y z scale scale_x scale_y scale_z", "0 0 0 1 1 1 1\n", "p.ply: vertex has scale and scale_x, expected one of them"),
        ("x y z scale", "0 0 0 1\n0 0 0 0\n", "p.ply:10: vertex 1: a scale of 0 makes the instance flat"),
        ("x y z scale", "0 0 0 nan\n", "p.ply:9: vertex 0: scale is not a finite f32 (NaN)"),
        ("x y z qx qy qz qw", "0 0 0 0 0 0 0\n", "p.ply:12: vertex 0: a quaternion of length 0 is no rotation"),
        ("x y z material", "0 0 0 -1\n", "p.ply:9: vertex 0: material: expected a whole number from 0, found -1"),
        ("x y z material", "0 0 0 0.5\n", "p.ply:9: vertex 0: material: expected a whole number from 0, found 0.5"),
        ("x y z", "0 inf 0\n", "p.ply:8: vertex 0: position is not a finite f32 (inf)"),
    ];
    for (properties, rows, expected) in cases {
        let error = read(properties, rows).expect_err(expected).to_string();
        assert!(error.starts_with(expected), "{error}, expected {expected}");
    }
    let many = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
        1 << 25
    );
    let source = std::io::Cursor::new([many.into_bytes(), vec![0; (1 << 25) * 12]].concat());
    assert!(matches!(points::read(source, "p.ply"), Err(Error::Limit(_))));
}

/// The instances of a file are those of placements.
#[test]
fn points_are_placements() {
    let folder = tempfile::tempdir().expect("a folder");
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, 1.0);
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex 2\n{}end_header\n1 0 0 {} {} {} {} 0.5 1\n-1 0 0 0 0 0 1 1 0\n",
        "x y z qx qy qz qw scale material".split(' ').map(|name| format!("property float {name}\n")).collect::<String>(),
        turn.x as f32,
        turn.y as f32,
        turn.z as f32,
        turn.w as f32
    );
    std::fs::write(folder.path().join("p.ply"), text).expect("written");
    let materials = json!([{ "type": "diffuse", "albedo": 0.1 }, { "type": "mirror" }]);
    let groups = json!({ "box": [{ "type": "box", "size": [1, 0.7, 0.4] }] });
    let degrees = 1f64.to_degrees();
    let placements = json!([
        { "transform": [{ "scale": 0.5 }, { "rotate": { "axis": [1, 2, 2], "degrees": degrees } }, { "translate": [1, 0, 0] }], "material": materials[1] },
        { "transform": [{ "translate": [-1, 0, 0] }], "material": materials[0] },
    ]);
    let worlds = [
        json!([{ "type": "instances", "group": "box", "file": "p.ply", "materials": materials }]),
        json!([{ "type": "instances", "group": "box", "placements": placements }]),
    ]
    .map(|shapes| {
        let root = describe::root(scene(groups.clone(), shapes).to_string().as_bytes(), "s.json").expect("JSON");
        let described = describe::read(&root, "s.json").expect("a scene");
        pt::build::build(&described, Source { root: &root, file: "s.json", files: &Files::within(folder.path()) }).expect("a world").world
    });
    let without = json!([{ "type": "instances", "group": "box", "file": "p.ply" }]);
    let root = describe::root(scene(groups, without).to_string().as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").expect("a scene");
    let warnings = pt::build::build(&described, Source { root: &root, file: "s.json", files: &Files::within(folder.path()) })
        .expect("a world")
        .warnings;
    assert_eq!(warnings, ["p.ply: the numbers of materials are left out: the instances have no \"materials\""]);
    let mut hits = 0;
    for k in 0..400 {
        let target = Vec3::new(-1.6 + 0.16 * (k % 20) as f32, -0.5 + 0.05 * (k / 20) as f32, 0.0);
        let ray = Ray::new(Vec3::new(0.3, 0.4, 5.0), (target - Vec3::new(0.3, 0.4, 5.0)).normalize());
        let [a, b] = worlds.each_ref().map(|world| world.intersect(&ray).map(|hit| (hit, world.surface(&ray, &hit))));
        let (Some((a, at)), Some((b, other))) = (&a, &b) else {
            assert_eq!(a.is_some(), b.is_some(), "ray {k}");
            continue;
        };
        hits += 1;
        assert_eq!((a.instance, at.bsdf.name()), (b.instance, other.bsdf.name()));
        assert_near("point", at.point.p, other.point.p, 1e-5, k);
    }
    assert!(hits > 50, "{hits} hits");
}
