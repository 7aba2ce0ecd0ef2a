//! Meshes whose vertices move while the shutter is open. That rays hit them where they are at each time is a test of `motion.rs`.

use std::fs;

use glam::{DVec3, Vec3};
use pt::effects::Effects;
use pt::math::Ray;
use pt::primitive::Hit;
use pt::scene::Scene;
use pt::shape::MeshData;
use pt::world::World;
use serde_json::{Value, json};

use crate::light_tracer::built;
use crate::marked::assert_fault_in_scene;
use crate::motion::rendered;
use crate::random::Random;

/// A scene of one mesh. Its camera looks along −z.
fn scene(mesh: &Value, shutter: [f64; 2]) -> Value {
    json!({ "pt": 1, "camera": { "look_at": { "from": [0, 0, 6], "to": [0, 0, 0] }, "fov": 40 }, "film": { "width": 24, "height": 16 },
        "shutter": { "open": shutter[0], "close": shutter[1] }, "background": { "radiance": 0.3 },
        "lights": [{ "type": "point", "position": [1, 3, 2], "intensity": 20 }], "shapes": [mesh] })
}

/// Corners of a square in the plane z = 0.
fn square(middle: [f64; 2], half: [f64; 2]) -> Value {
    let corner = |x: f64, y: f64| json!([middle[0] + x * half[0], middle[1] + y * half[1], 0]);
    json!([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)])
}

fn hit(world: &World, ray: Ray) -> Option<Hit> {
    let origin = (ray.origin.as_dvec3() - world.origin()).as_vec3();
    world.intersect(&Ray { origin, from: origin, ..ray })
}

/// A rectangle whose corners go from place to place, at different speeds, covers a point for the share of the time in which the point is
/// between its sides, which are linear functions of the time between two keyframes.
#[test]
fn moving_vertices_cover_for_their_share_of_time() {
    const TIMES: u32 = 1 << 14;
    // Times (s), and the middle and the half sides of the rectangle.
    let keys =
        [(-1.0, [-3.0, 0.0], [0.4, 0.5]), (0.5, [0.2, 0.1], [0.6, 0.8]), (1.0, [0.3, -0.4], [0.2, 1.5]), (4.0, [9.0, 0.0], [0.5, 0.5])];
    let (open, close) = (-0.5, 2.0);
    let keyframes: Vec<Value> =
        keys.iter().map(|(time, middle, half)| json!({ "time": time, "positions": square(*middle, *half) })).collect();
    let mesh =
        json!({ "type": "mesh", "positions": square([0.0; 2], [1.0; 2]), "triangles": [[0, 1, 2], [0, 2, 3]], "keyframes": keyframes });
    let world = built(&scene(&mesh, [open, close]).to_string()).world;
    assert!(world.effects().contains(Effects::MOTION));
    let place = |time: f64| {
        let after = keys.iter().position(|(key, ..)| *key > time).expect("a later keyframe");
        let ([(start, m0, h0), (end, m1, h1)], between) = ([keys[after - 1], keys[after]], |a: f64, b: f64, w: f64| a + (b - a) * w);
        let w = (time - start) / (end - start);
        [0, 1].map(|axis| [between(m0[axis], m1[axis], w), between(h0[axis], h1[axis], w)])
    };
    for (x, y) in [(0.1, 0.2), (-1.2, 0.3), (0.35, -1.1), (2.0, 0.6), (0.5, 0.85), (-2.9, 0.0), (3.9, 0.3)] {
        let time = |k: u32| (f64::from(k) + 0.5) / f64::from(TIMES);
        let covers =
            |time: f64| place(open + time * (close - open)).into_iter().zip([x, y]).all(|([m, h], p): ([f64; 2], f64)| (p - m).abs() < h);
        let wanted = (0..TIMES).filter(|k| covers(time(*k))).count();
        let ray = |k: u32| Ray { time: time(k) as f32, ..Ray::new(Vec3::new(x as f32, y as f32, 2.0), Vec3::NEG_Z) };
        let found = (0..TIMES).filter(|k| hit(&world, ray(*k)).is_some()).count();
        // Each side crosses the point at most once between two keyframes, to within rounding of the time.
        assert!(found.abs_diff(wanted) <= 6, "at {x}, {y}: {found}, not {wanted}");
    }
}

/// A closed mesh of 320 triangles whose vertices are anywhere near the unit sphere.
fn ball(random: &mut Random) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let octahedron = MeshData {
        positions: [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].to_vec(),
        triangles: vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
        ..MeshData::default()
    };
    let fine = octahedron.subdivided(3).expect("a mesh");
    let mut places: Vec<(Vec3, Vec3)> = vec![];
    let mut moved = |p: Vec3| match places.iter().find(|(known, _)| *known == p) {
        Some((_, moved)) => *moved,
        None => {
            let moved = p.normalize() * random.range(0.8, 1.2) as f32 + (random.in_cube() * 0.05).as_vec3();
            places.push((p, moved));
            moved
        }
    };
    (fine.positions.iter().map(|p| moved(*p)).collect(), fine.triangles)
}

/// No ray from within a closed mesh passes between its triangles, at any time, and none of those that aim at vertices and edges.
#[test]
fn moving_meshes_are_watertight() {
    let mut random = Random::new(8);
    let rows = |positions: &[Vec3]| json!(positions.iter().map(|p| p.as_dvec3().to_array()).collect::<Vec<_>>());
    let (first, triangles) = ball(&mut random);
    let others = [ball(&mut random).0, ball(&mut random).0];
    let keyframes = json!([{ "time": 0 }, { "time": 0.3, "positions": rows(&others[0]) }, { "time": 1, "positions": rows(&others[1]) }]);
    let mesh = json!({ "type": "mesh", "positions": rows(&first), "triangles": triangles, "keyframes": keyframes });
    let world = built(&scene(&mesh, [0.0, 1.0]).to_string()).world;
    let poses = [&first, &others[0], &others[1]];
    for _ in 0..300_000 {
        let time = random.unit();
        let (k, w) = if time < 0.3 { (0, time / 0.3) } else { (1, (time - 0.3) / 0.7) };
        let vertex = |v: u32| poses[k][v as usize].as_dvec3().lerp(poses[k + 1][v as usize].as_dvec3(), w);
        let [a, b, _] = random.pick(&triangles).map(vertex);
        let target = if random.unit() < 0.3 { a } else { a.lerp(b, random.unit()) };
        let from = (random.in_cube() * 0.3).as_vec3();
        let ray = Ray { time: time as f32, ..Ray::new(from, (target - from.as_dvec3()).normalize().as_vec3()) };
        let found = hit(&world, ray);
        assert!(found.is_some(), "from {from} to {target} at {time}");
    }
}

/// A shutter that closes when it opens shows the moment, with the bits of the mesh as it is then; and so do keyframes that change nothing.
#[test]
fn moments_of_moving_meshes_have_the_bits_of_still_ones() {
    let corners = [
        json!([[-1, -1, 0], [1, -1, 0.2], [1, 1, 0], [-1, 1, -0.3]]),
        json!([[-1.1, -0.7, 0], [1, -0.6, 0.9], [0.8, 1, 0], [-1, 1.2, -0.3]]),
    ];
    let normals = [json!([[0, 0, 1], [0.1, 0, 1], [0, 0.2, 1], [0, 0, 1]]), json!([[0.3, 0, 1], [0.1, 0, 1], [0, 0.4, 1], [0, 0, 1]])];
    let still = |k: usize| {
        json!({ "type": "mesh", "positions": corners[k], "normals": normals[k], "triangles": [[0, 1, 2], [0, 2, 3]],
            "transform": [{ "rotate": { "axis": [1, 2, 3], "degrees": 20 } }] })
    };
    let moving = |first: usize, last: usize| {
        let mut mesh = still(0);
        let key = |time: f64, k: usize| json!({ "time": time, "positions": corners[k], "normals": normals[k] });
        mesh["keyframes"] = json!([key(1.0, first), key(3.0, last)]);
        mesh
    };
    let wanted = rendered(&scene(&still(1), [0.0, 1.0])).0;
    assert!(rendered(&scene(&moving(0, 1), [3.0, 3.0])).0 == wanted, "a moment");
    assert!(rendered(&scene(&moving(0, 1), [3.5, 4.0])).0 == wanted, "after the last keyframe");
    assert!(rendered(&scene(&moving(1, 0), [0.0, 0.5])).0 == wanted, "before the first keyframe");
    assert!(rendered(&scene(&moving(1, 1), [0.0, 9.0])).0 == wanted, "keyframes that are the same");
    assert!(rendered(&scene(&moving(0, 1), [1.0, 3.0])).0 != wanted, "the motion itself");
}

/// Which side of a triangle is its front is decided by the mesh itself, and is the same at all times, whatever the normals of a keyframe say.
#[test]
fn fronts_are_those_of_the_mesh() {
    let corners = json!([[-1, -1, 0], [1, -1, 0], [0, 1, 0]]);
    // The normals say +z, the winding −z; the last keyframe has the opposite normals.
    let mesh = json!({ "type": "mesh", "positions": corners, "normals": [[0, 0, 1], [0, 0, 1], [0, 0, 1]], "triangles": [[0, 2, 1]],
        "keyframes": [{ "time": 0 }, { "time": 1, "positions": corners, "normals": [[0, 0, -1], [0, 0, -1], [0, 0, -1]] }] });
    for (shutter, time) in [([0.0, 1.0], 0.0), ([0.0, 1.0], 0.7), ([1.0, 1.0], 0.0)] {
        let world = built(&scene(&mesh, shutter).to_string()).world;
        let origin = (DVec3::Z * 2.0 - world.origin()).as_vec3();
        let ray = Ray { time, ..Ray::new(origin, Vec3::NEG_Z) };
        let hit = world.intersect(&ray).expect("a hit");
        assert_eq!(world.surface(&ray, &hit).point.ng, Vec3::Z, "{shutter:?} at {time}");
    }
}

/// The picture of a scene of 64 times the size, and of 1/64 of it, has the same bits.
#[test]
fn moving_meshes_scale_exactly() {
    let corners = |size: f64| {
        let row = |p: [f64; 3]| json!(p.map(|x| x * size));
        [
            json!([row([-1.0, -1.0, 0.0]), row([1.0, -1.0, 0.2]), row([0.3, 1.0, 0.0])]),
            json!([row([-1.1, -0.7, 0.0]), row([1.3, -0.6, 0.9]), row([0.8, 1.0, 0.1])]),
        ]
    };
    let at_size = |size: f64| {
        let [first, last] = corners(size);
        let mesh = json!({ "type": "mesh", "positions": first, "triangles": [[0, 1, 2]], "keyframes": [{ "time": 0 }, { "time": 1, "positions": last }] });
        let mut scene = scene(&mesh, [0.0, 1.0]);
        scene["camera"]["look_at"] = json!({ "from": [0, 0, 6.0 * size], "to": [0, 0, 0] });
        scene["lights"][0]["position"] = json!([size, 3.0 * size, 2.0 * size]);
        scene["lights"][0]["intensity"] = json!(20.0 * size * size);
        rendered(&scene).0
    };
    let wanted = at_size(1.0);
    assert!(at_size(64.0) == wanted && at_size(1.0 / 64.0) == wanted);
}

/// Keyframes of a mesh from a file are files with the same triangles.
#[test]
fn keyframes_come_from_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    write("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
    write("b.obj", "v 0 0 2\nv 1 0 2\nv 1 1 2\nv 0 1 2\nf 1 2 3\nf 1 3 4\n");
    write("other.obj", "v 0 0 2\nv 1 0 2\nv 0 1 2\nf 1 2 3\n");
    write("turned.obj", "v 0 0 2\nv 1 0 2\nv 1 1 2\nv 0 1 2\nf 1 2 3\nf 2 3 4\n");
    write("smooth.obj", "v 0 0 2\nv 1 0 2\nv 1 1 2\nv 0 1 2\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n");
    let load = |file: &str| {
        let mesh = json!({ "type": "mesh", "file": "a.obj", "keyframes": [{ "time": 0 }, { "time": 1, "file": file }] });
        let text = scene(&mesh, [0.0, 1.0]).to_string();
        let root = pt::describe::root(text.as_bytes(), "s.json").expect("JSON");
        let described = pt::describe::read(&root, "s.json").unwrap_or_else(|e| panic!("{e}"));
        let files = pt::describe::Files::within(folder.path());
        pt::build::build(&described, pt::build::Source { root: &root, file: "s.json", files: &files })
    };
    let moving = load("b.obj").unwrap_or_else(|e| panic!("{e}"));
    for time in [0.0f32, 0.25, 0.75] {
        let ray = Ray { time, ..Ray::new(Vec3::new(0.2, 0.2, 5.0), Vec3::NEG_Z) };
        let hit = hit(&moving.world, ray).expect("a hit");
        let z = 5.0 - f64::from(hit.t);
        assert!((z - 2.0 * f64::from(time)).abs() < 1e-6, "{z} at {time}");
    }
    let told = |file: &str| load(file).err().map_or_else(String::new, |error| error.to_string());
    for (file, wanted) in [
        ("other.obj", "expected the triangles of the mesh, 2 that have an area, found 1"),
        ("turned.obj", "expected the triangles of the mesh in the same order, with the same vertices"),
        ("smooth.obj", "the mesh has no normals, so that its keyframes can have none"),
        ("gone.obj", "gone.obj"),
    ] {
        let message = told(file);
        assert!(message.contains(wanted), "{file}: {message}");
        assert!(file == "gone.obj" || message.contains("/shapes/0/keyframes/1/file"), "{message}");
    }
}

/// What is wrong with keyframes of meshes is said at its place.
#[test]
fn impossible_keyframes_of_meshes_are_refused() {
    let mesh = |keys: &str| {
        format!("\"shapes\": [{{\"type\": \"mesh\", \"positions\": [[0,0,0],[1,0,0],[0,1,0]], \"triangles\": [[0,1,2]], {keys}}}]")
    };
    let file = |keys: &str| format!("\"shapes\": [{{\"type\": \"mesh\", \"file\": \"a.obj\", {keys}}}]");
    let at = "/shapes/0/keyframes";
    assert_fault_in_scene(&[
        (
            &mesh("\"keyframes\": [{\"time\": 1}, {\"time\": ^0}]"),
            &format!("{at}/1/time: expected a time after that of the keyframe before it"),
        ),
        (&mesh("\"keyframes\": [{\"time\": ^\"now\"}]"), &format!("{at}/0/time: expected")),
        (
            &mesh("\"keyframes\": [{\"time\": 0, \"file\": ^\"a.obj\"}]"),
            &format!("{at}/0/file: a mesh given here has keyframes with \"positions\""),
        ),
        (
            &file("\"keyframes\": [{\"time\": 0, \"positions\": ^[[0,0,0]]}]"),
            &format!("{at}/0/positions: a mesh from a file has keyframes with a \"file\""),
        ),
        (
            &mesh("\"keyframes\": [{\"time\": 0, \"positions\": ^[[0,0,0]]}]"),
            &format!("{at}/0/positions: expected one for each of 3 positions, found 1"),
        ),
        (
            &mesh("\"keyframes\": [{\"time\": 0, \"positions\": [[0,0,0],[1,0,0],[0,1,0]], \"normals\": ^[[0,0,1],[0,0,1],[0,0,1]]}]"),
            &format!("{at}/0/normals: the mesh has no normals, so that its keyframes can have none"),
        ),
        (&mesh("\"keyframes\": ^[{\"time\": 0}], \"subdivision_levels\": 1"), &format!("{at}: a mesh with keyframes can have neither")),
        (
            &mesh("\"keyframes\": [{\"time\": 0}], \"medium\": ^{\"type\": \"homogeneous\"}"),
            "/shapes/0/medium: a shape that contains a medium cannot move",
        ),
    ]);
}
