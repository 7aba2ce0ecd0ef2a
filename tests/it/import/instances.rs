//! Meshes that an imported scene shows several times are loaded once, and look as if each were loaded.

use glam::Vec3;
use pt::math::Ray;
use pt::scene::Scene;
use pt::world::World;

use super::dialect::{built, folder};
use crate::random::Random;

/// A scene of the Aalto path tracer with three objects of two materials and a lamp, of these mesh files.
fn aalto(files: [&str; 4]) -> String {
    let object = |(i, file): (usize, &str)| {
        let (material, x, turn) = ([1, 2, 2, 0][i], [-2, 0, 2, 0][i], 25 * i);
        let y = if i == 3 { 3 } else { 0 };
        format!(
            r#"{{ "type": "mesh", "path": "{file}", "materialIndex": {material}, "midpoint": {{ "x": {x}, "y": {y}, "z": 0.5 }},
                "height": {}, "xrot": {turn}, "yrot": 10, "zrot": -{turn} }}"#,
            1.0 + 0.3 * i as f64
        )
    };
    let objects: Vec<String> = files.into_iter().enumerate().map(object).collect();
    let color = |r: f64| format!(r#"{{ "r": {r}, "g": 0.5, "b": 0.5 }}"#);
    format!(
        r#"{{ "camera": {{ "focalPoint": {{ "x": 0, "y": -8, "z": 1 }}, "direction": {{ "x": 0, "y": 1, "z": 0 }}, "xAngle": 40, "yAngle": 30,
            "xReso": 8, "yReso": 6 }},
        "materials": [
            {{ "comment": "Light", "isLuminous": true, "color": {} }},
            {{ "comment": "Mirror", "type": "specular", "isLuminous": false, "color": {} }},
            {{ "comment": "Matte", "type": "diffuse", "mattness": 1, "isLuminous": false, "color": {} }}
        ],
        "objects": [{}] }}"#,
        color(1.0),
        color(0.9),
        color(0.7),
        objects.join(", ")
    )
}

const TETRAHEDRON: &str = "v 1 2 3\nv 3 2 3\nv 1.5 4 3\nv 1.5 2.5 5.5\nvn 0 0 1\nf 1//1 3//1 2//1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

fn world(files: [&str; 4]) -> World {
    let folder = folder(&[
        ("scene.json", &aalto(files)),
        ("a.obj", TETRAHEDRON),
        ("b.obj", TETRAHEDRON),
        ("c.obj", TETRAHEDRON),
        ("d.obj", TETRAHEDRON),
    ]);
    built(&folder.path().join("scene.json")).unwrap_or_else(|error| panic!("{error}")).1.world
}

/// Shapes of one mesh file become instances. Shapes of equal but separate files stay copies, and look the same: places, normals and
/// materials agree. The lamp is no instance.
#[test]
fn repeated_meshes_become_instances() {
    let [shared, copied] = [world(["a.obj"; 4]), world(["a.obj", "b.obj", "c.obj", "d.obj"])];
    assert_eq!((shared.instance_count(), copied.instance_count()), (3, 0));
    assert_eq!((shared.primitive_count(), copied.primitive_count()), (8, 16), "one mesh for the instances, and one for the lamp");
    assert_eq!(shared.lights().len(), copied.lights().len());
    let (mut hits, shift) = (0, (copied.origin() - shared.origin()).as_vec3());
    for seed in 0..4000 {
        let mut random = Random::new(seed);
        let from = (random.direction() * 9.0).as_vec3();
        let to = (random.in_cube() * 3.0).as_vec3();
        let ray = Ray::new(from, (to - from).normalize());
        let moved = Ray::new(from - shift, ray.direction);
        let (a, b) = (shared.intersect(&ray), copied.intersect(&moved));
        let (Some(a), Some(b)) = (a, b) else { continue };
        if (a.t - b.t).abs() > 1e-4 {
            continue; // an outline, within rounding
        }
        hits += 1;
        let (a, b) = (shared.surface(&ray, &a), copied.surface(&moved, &b));
        assert!((a.point.p - shift - b.point.p).length() < 1e-5 && (a.point.ng - b.point.ng).length() < 1e-4, "seed {seed}");
        assert_eq!((a.bsdf.name(), a.emitted(Vec3::Z)), (b.bsdf.name(), b.emitted(Vec3::Z)), "seed {seed}");
    }
    assert!(hits > 300, "{hits} hits");
}

/// A scene in pt's own format keeps its shapes as they are.
#[test]
fn own_scenes_are_not_changed() {
    let own = r#"{ "pt": 1, "camera": {}, "shapes": [{ "type": "mesh", "file": "a.obj" }, { "type": "mesh", "file": "a.obj" }], "background": { "radiance": 1 } }"#;
    let folder = folder(&[("scene.json", own), ("a.obj", TETRAHEDRON)]);
    let (_, made) = built(&folder.path().join("scene.json")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((made.world.instance_count(), made.world.primitive_count()), (0, 8));
}
