//! Scenes of the Aalto path tracer: every row of the documentation, the positions of objects, and comparisons with its pictures.

mod pictures;
mod rows;
mod slab;

use std::path::Path;

use glam::{DVec3, Vec2};
use pt::math::Ray;
use pt::reader::Node;
use pt::scene::Scene;
use pt::world::World;

use super::convert::{same_bits, succeeds};
use super::dialect::{built, folder};
use crate::random::Random;

/// A scene of every construct that is read without a note. The mesh is [`TETRAHEDRON`].
const SCENE: &str = r#"{
  "camera": {
    "focalPoint": { "x": -8, "y": 0.5, "z": 1 }, "direction": { "x": 2, "y": 0, "z": -0.25 },
    "xAngle": 20, "yAngle": 35, "xReso": 12, "yReso": 16
  },
  "materials": [
    { "comment": "Light", "isLuminous": true, "color": { "r": 1, "g": 0.75, "b": 0.5 } },
    { "comment": "Mirror", "type": "specular", "isLuminous": false, "color": { "r": 0, "g": 1, "b": 0.25 } },
    { "comment": "Mirror", "type": "diffuse", "mattness": 0.4, "isLuminous": "false", "color": { "r": 0.8, "g": 0.8, "b": 0.8 } },
    { "type": "transparent", "refIndex": 1.5, "isLuminous": false, "color": { "r": 1, "g": 1, "b": 1 } }
  ],
  "objects": [
    { "comment": "Lamp", "type": "mesh", "path": "./tetrahedron.obj", "materialIndex": 0,
      "midpoint": { "x": 4, "y": 3, "z": 2 }, "height": 4, "xrot": 0, "yrot": 0, "zrot": 0 },
    { "comment": "Ball", "type": "mesh", "path": "./tetrahedron.obj", "materialIndex": 2,
      "midpoint": { "x": 1, "y": -0.5, "z": 0.25 }, "height": 2, "xrot": 20, "yrot": -30, "zrot": 100 },
    { "type": "mesh", "path": "./tetrahedron.obj", "materialIndex": 3,
      "midpoint": { "x": -2, "y": 0, "z": 0 }, "height": 1, "xrot": 0, "yrot": 0, "zrot": 0 }
  ]
}"#;

/// A mesh in the style of the program: with carriage returns, exponents of three digits, and spaces at the ends of lines.
const TETRAHEDRON: &str = "# a comment\r\nmtllib tetrahedron.mtl\r\nv 1 2 3 \r\nv 3 2 3\r\nv 1.5e+000 4 3\r\nv 1.5 2500e-003 5.5\r\n\
    f 1 3 2 \r\nf 1 2 4\r\nf 2 3 4\r\nf 3 1 4\r\n";
const CORNERS: [[f64; 3]; 4] = [[1.0, 2.0, 3.0], [3.0, 2.0, 3.0], [1.5, 4.0, 3.0], [1.5, 2.5, 5.5]];
/// Components of a unit direction, and the tangents from which they are computed, have an error of a few roundings of 2⁻²⁴.
const FEW_ROUNDINGS: f64 = 32.0 / 16_777_216.0;
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn files(scene: &str) -> tempfile::TempDir {
    folder(&[("scene.json", scene), ("tetrahedron.obj", TETRAHEDRON), ("tetrahedron.mtl", "")])
}

fn world(folder: &Path) -> World {
    built(&folder.join("scene.json")).unwrap_or_else(|error| panic!("{error}")).1.world
}

/// The value at a pointer of the converted scene.
fn became(scene: &str, pointer: &str) -> String {
    let (imported, _) = built(&files(scene).path().join("scene.json")).unwrap_or_else(|error| panic!("{error}"));
    imported.root.get(pointer).map(Node::to_string).unwrap_or_else(|| panic!("{pointer} in {}", imported.root))
}

#[test]
fn what_is_converted_has_the_same_bits() {
    let folder = files(SCENE);
    std::fs::create_dir(folder.path().join("other")).expect("a folder");
    let said = succeeds(folder.path(), &["convert", "scene.json", "other/scene.json"]);
    assert_eq!(said, "note: other/scene.json names files outside of its folder: to render it, add --allow-outside\n");
    same_bits(folder.path(), "scene.json", "other/scene.json");
}

/// Names are kept, and materials with equal names are renamed.
#[test]
fn comments_are_names() {
    assert_eq!(became(SCENE, "/shapes/1/name"), "\"Ball\"");
    // The second and the third object show the same mesh: the first of them gives its material to the group.
    let group = "/groups/.~1tetrahedron.obj/0";
    for (shape, name) in [("/shapes/0", "\"Light\""), (group, "\"Mirror (2)\""), ("/shapes/2", "\"material 3\"")] {
        assert_eq!(became(SCENE, &format!("{shape}/material")), name);
    }
    assert_eq!(became(SCENE, "/materials/Mirror/type"), "\"mirror\"");
    assert_eq!(became(SCENE, "/materials/Mirror (2)/mattness"), "0.4");
}

/// Lamps emit their colour, which is at most 1, on both sides. Their `type` is ignored.
#[test]
fn lamps() {
    let lamp = SCENE.replace(r#""Light", "isLuminous": true"#, r#""Light", "isLuminous": "true", "type": "what?""#).replace("0.75", "1.75");
    for scene in [SCENE, &lamp] {
        assert_eq!(became(scene, "/shapes/0/emission/two_sided"), "true");
        let green = became(scene, "/shapes/0/emission/radiance/1");
        assert_eq!(green, if scene == SCENE { "0.75" } else { "1" });
    }
    let (imported, _) = built(&files(&lamp).path().join("scene.json")).expect("a scene");
    let notes: Vec<String> = imported.notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes.len(), 1);
    assert!(notes[0].contains("/materials/0/color/g: 1.75 is taken as 1"), "{notes:?}");
}

/// Camera rays have right = z × direction and up = direction × right, with separate tangents for the horizontal and the vertical angle.
#[test]
fn camera_rays_are_those_of_the_program() {
    let mut random = Random::new(3);
    for _ in 0..50 {
        let mut between = |low: f64, high: f64| low + (high - low) * random.unit();
        let eye = DVec3::from_array([0, 1, 2].map(|_| between(-9.0, 9.0)));
        let direction = DVec3::new(between(-2.0, 2.0), between(0.1, 2.0), between(-1.0, 1.0));
        let [x_angle, y_angle] = [0, 1].map(|_| between(2.0, 120.0));
        let [tan_x, tan_y] = [x_angle, y_angle].map(|angle| (0.5 * angle).to_radians().tan());
        let ahead = direction.normalize();
        let right = DVec3::Z.cross(ahead).normalize();
        let up = ahead.cross(right);
        let vector = |v: DVec3| format!(r#"{{ "x": {:?}, "y": {:?}, "z": {:?} }}"#, v.x, v.y, v.z);
        let angles = format!(r#""direction": {}, "xAngle": {x_angle:?}, "yAngle": {y_angle:?}"#, vector(direction));
        let corner = |side: f64| vector(eye + 1.5 * (ahead + side * (up * tan_y - right * tan_x)));
        let corners = format!(r#""tlCorner": {}, "brCorner": {}"#, corner(1.0), corner(-1.0));
        for view in [angles, corners] {
            let camera = format!(r#"{{ "focalPoint": {}, {view}, "xReso": 7, "yReso": 5 }}"#, vector(eye));
            let start = SCENE.find("{\n    \"focal").expect("a camera");
            let end = SCENE.find(",\n  \"materials").expect("materials");
            let scene = [&SCENE[..start], &camera, &SCENE[end..]].concat();
            let world = world(files(&scene).path());
            for _ in 0..20 {
                let [x, y] = [0, 1].map(|_| random.unit());
                let expected = (ahead + right * (2.0 * x - 1.0) * tan_x + up * (1.0 - 2.0 * y) * tan_y).normalize();
                let ray = world.camera().ray(Vec2::new(x as f32, y as f32), 1.4, Vec2::splat(0.5), 0.0);
                assert!((ray.direction.as_dvec3() - expected).length() < FEW_ROUNDINGS, "{camera}: {} for {expected}", ray.direction);
                assert!((ray.origin.as_dvec3() + world.origin() - eye).length() < 1e-5, "{camera}: {}", ray.origin);
            }
        }
    }
}

/// A mesh is rotated about x, y and z, centred by its box, scaled to `height` and moved to the midpoint, as explicit matrices say.
#[test]
fn meshes_are_placed_as_by_the_program() {
    let mut random = Random::new(4);
    for _ in 0..20 {
        let turns = [0, 1, 2].map(|_| (random.below(73) as f64 - 36.0) * 5.0);
        let (midpoint, height) = ([1.0, -0.5, 0.25], 2.0);
        let [x, y, z] = turns;
        let scene = SCENE.replace(r#""xrot": 20, "yrot": -30, "zrot": 100"#, &format!(r#""xrot": {x}, "yrot": {y}, "zrot": {z}"#));
        let [x, y, z] = turns.map(f64::to_radians);
        let turned = CORNERS.map(|[a, b, c]| {
            let [b, c] = [b * x.cos() - c * x.sin(), b * x.sin() + c * x.cos()];
            let [a, c] = [a * y.cos() + c * y.sin(), -a * y.sin() + c * y.cos()];
            DVec3::new(a * z.cos() - b * z.sin(), a * z.sin() + b * z.cos(), c)
        });
        let low = turned.into_iter().reduce(DVec3::min).expect("corners");
        let high = turned.into_iter().reduce(DVec3::max).expect("corners");
        let placed = turned.map(|p| (p - 0.5 * (low + high)) * (height / (high.z - low.z)) + DVec3::from(midpoint));
        let world = world(files(&scene).path());
        for [a, b, c] in FACES.map(|face| face.map(|i| placed[i])) {
            let (middle, normal) = ((a + b + c) / 3.0, (b - a).cross(c - a).normalize());
            let from = middle + 0.125 * normal - world.origin();
            let hit = world.intersect(&Ray::new(from.as_vec3(), -normal.as_vec3())).unwrap_or_else(|| panic!("{turns:?}: no face"));
            let found = world.surface(&Ray::new(from.as_vec3(), -normal.as_vec3()), &hit);
            assert!((f64::from(hit.t) - 0.125).abs() < 1e-5, "{turns:?}: a face at {} beyond", hit.t);
            assert!(found.point.ng.as_dvec3().dot(normal) > 1.0 - 1e-5, "{turns:?}: the face looks along {}", found.point.ng);
        }
    }
}

/// Names that are not ASCII, in the scene and of files.
#[test]
fn names_may_have_any_letters() {
    let scene = SCENE.replace("./tetrahedron.obj", "./seinät.obj").replace("\"Ball\"", "\"Pöytä\"");
    let folder = folder(&[("scene.json", &scene), ("seinät.obj", &format!("{TETRAHEDRON}curv 1\n"))]);
    let (imported, built) = built(&folder.path().join("scene.json")).expect("a scene");
    assert_eq!(imported.root.get("/shapes/1/name").map(Node::to_string).as_deref(), Some("\"Pöytä\""));
    assert_eq!(built.warnings, ["./seinät.obj: ignored statements: curv (1)"], "told once, though three shapes are made of it");
}

/// A scene with a shape in the list of materials causes one error message, and no other.
#[test]
fn one_misplaced_object_is_one_error() {
    let object = r#"{ "comment": "Lamp", "type": "mesh", "path": "./none.obj", "materialIndex": 0,
      "midpoint": { "x": 4, "y": 3, "z": 2 }, "height": 4, "xrot": 0, "yrot": 0, "zrot": 0 }"#;
    let start = SCENE.find("{ \"comment\": \"Light\"").expect("a lamp");
    let end = start + SCENE[start..].find(",\n").expect("its end");
    let scene = [&SCENE[..start], object, &SCENE[end..]].concat();
    let error = built(&files(&scene).path().join("scene.json")).map(|_| ()).expect_err("a fault");
    let expected = "scene.json:7:5: /materials/0: expected a material, found an object: those are listed in /objects";
    assert!(error.to_string().ends_with(expected) && error.faults().len() == 1, "{error}");
    assert_eq!(error.exit_code(), 3);
}

/// Faults are reported with the keys of the original file, not those of pt's format.
#[test]
fn faults_are_located_in_the_original_file() {
    for (from, to, expected) in [
        ("\"xAngle\": 20", "\"xAngle\": 200", "/camera/xAngle: expected an angle in degrees above 0 and below 180, found 200"),
        ("\"xReso\": 12", "\"xReso\": 1.5", "/camera/xReso: expected a whole number, found 1.5"),
        ("\"yAngle\": 35, ", "", "/camera: missing key \"yAngle\""),
        ("\"x\": 2, ", "\"x\": 0, ", "/camera/direction: expected a direction that is not along z, which is up"),
        ("\"mattness\": 0.4", "\"mattness\": 4", "/materials/2/mattness: expected a number from 0 to 1, found 4"),
        ("\"refIndex\": 1.5", "\"reflIndex\": -1", "/materials/3/reflIndex: expected an index of refraction from 0.01 to 100, found -1"),
        ("specular", "specula", "/materials/1/type: unknown material type \"specula\", did you mean \"specular\"?"),
        ("\"materialIndex\": 3", "\"materialIndex\": 4", "/objects/2/materialIndex: expected the number of a material, below 4, found 4"),
        ("\"height\": 2", "\"height\": 0", "/objects/1/height: expected a number above 0, found 0"),
        ("\"path\": \"./", "\"path\": \"../", "/objects/0/path: ../tetrahedron.obj: leads out of the scene file's folder"),
        ("tetrahedron.obj", "none.obj", "/objects/0/path: ./none.obj: no such file"),
        ("\"g\": 0.75", "\"g\": \"0.75\"", "/materials/0/color/g: expected a number, found the string \"0.75\""),
    ] {
        let scene = SCENE.replacen(from, to, 1);
        assert_ne!(scene, SCENE, "{from}");
        let error = built(&files(&scene).path().join("scene.json")).map(|_| ()).expect_err(to);
        let (text, faults) = (error.to_string(), error.faults());
        let line = 1 + scene[..scene.find(to).filter(|_| !to.is_empty()).unwrap_or(0)].matches('\n').count();
        assert!(text.contains(expected) && faults.len() == 1, "{to}: {text}");
        assert!(faults[0].line.is_some_and(|found| to.is_empty() || found.abs_diff(line) <= 1), "{to} in line {line}: {text}");
    }
}

/// A scene file with random changes is either read, or refused with a message. It never causes a panic.
#[test]
fn mutated_scenes_never_panic() {
    const WORDS: [&str; 18] = [
        "",
        "{",
        "}",
        "[",
        "]",
        ",",
        ":",
        "\"",
        "0",
        "-1",
        "1e39",
        "null",
        "1e300",
        "\"type\"",
        "\"x\"",
        "\"tlCorner\"",
        "\"pt\"",
        "\u{1f431}",
    ];
    let folder = files("");
    let path = folder.path().join("scene.json");
    let mut random = Random::new(1);
    let mut survivors = 0;
    for _ in 0..6_000 {
        let mut bytes = SCENE.as_bytes().to_vec();
        for _ in 0..1 + random.below(2) {
            let (start, other) = (random.below(bytes.len()), random.below(bytes.len()));
            let removed = random.below(8).min(bytes.len() - start);
            let inserted = match random.below(3) {
                0 => random.pick(&WORDS).as_bytes().to_vec(),
                1 => bytes[other..(other + random.below(30)).min(bytes.len())].to_vec(),
                _ => vec![random.below(256) as u8],
            };
            bytes.splice(start..start + removed, inserted);
        }
        std::fs::write(&path, &bytes).expect("a file");
        match built(&path) {
            Ok(_) => survivors += 1,
            Err(error) => assert!(matches!(error.exit_code(), 3 | 4) && !error.to_string().is_empty(), "{error:?}"),
        }
    }
    assert!(survivors > 40, "some mutations leave a scene, else only the parser is tested: {survivors}");
}
