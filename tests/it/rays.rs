//! The ray caster in double precision: its decisions are those of exact arithmetic, also on edges and at vertices.

use std::io::Write;
use std::process::{Command, Output, Stdio};
use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4};
use pt::bsdf::Material;
use pt::camera::{Camera, Perspective, Pose};
use pt::light::Emitter;
use pt::math::{Keyframes, Rgb, Transform};
use pt::rays::{Hit, Ray, RayCaster, SceneCaster};
use pt::shape::{Cuboid, Quad, Sphere};
use pt::torture::meshes::icosphere;
use pt::world::{Objects, World};

use crate::random::Random;

type Int3 = [i128; 3];

fn sub(a: Int3, b: Int3) -> Int3 {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn determinant(a: Int3, b: Int3, c: Int3) -> i128 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

fn real(a: Int3) -> DVec3 {
    DVec3::from_array(a.map(|x| x as f64))
}

/// Whether a ray meets a triangle, in integers. The direction d is replaced by K³ d + (K², K, 1) with K = 10⁶, which for coordinates up to 4
/// has the signs that an infinitely small turn towards x, then y, then z has: determinants without K are below 10⁴.
fn meets(origin: Int3, direction: Int3, corners: [Int3; 3]) -> Option<bool> {
    const K: i128 = 1_000_000;
    let turned = [0, 1, 2].map(|i| K.pow(3) * direction[i] + K.pow(2 - i as u32));
    let [a, b, c] = corners.map(|corner| sub(corner, origin));
    let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| determinant(turned, p, q).signum());
    let height = determinant(a, b, c).signum();
    let is_met = sides[0] != 0 && sides.iter().all(|side| *side == sides[0]) && height == sides[0];
    is_met.then_some(sides[0] < 0)
}

/// Small integers, where most rays pass through edges, vertices and within planes.
#[test]
fn the_caster_agrees_with_a_search_in_integers() {
    let mut met = 0;
    for seed in 0..4000 {
        let mut random = Random::new(seed);
        let mut integers = |size: i128| [(); 3].map(|()| random.below(2 * size as usize + 1) as i128 - size);
        let corners: Vec<[Int3; 3]> = (0..12).map(|_| [(); 3].map(|()| integers(2))).collect();
        let positions = corners.as_flattened().iter().map(|p| real(*p)).collect();
        let triangles = (0..12).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let caster = RayCaster::new(positions, triangles).expect("a mesh");
        for _ in 0..50 {
            let (origin, direction) = (integers(4), integers(2));
            if direction == [0; 3] {
                continue;
            }
            let exact: Vec<(u32, bool)> =
                (0..12).filter_map(|k| meets(origin, direction, corners[k]).map(|enters| (k as u32, enters))).collect();
            let ray = Ray::new(real(origin), real(direction));
            let mut found: Vec<(u32, bool)> = caster.all(&ray).iter().map(|hit| (hit.triangle, hit.enters)).collect();
            found.sort_unstable();
            assert_eq!(found, exact, "seed {seed}: {origin:?} {direction:?}");
            assert_eq!(caster.any(&ray), !exact.is_empty());
            assert_eq!(caster.closest(&ray), caster.all(&ray).first().copied());
            met += exact.len();
        }
    }
    assert!(met > 20_000, "{met}");
}

/// Closed meshes at any scale and place: rays aimed exactly at vertices, edges and centroids cross the mesh an even number of times from
/// outside, and an odd number from inside; entries and exits alternate.
#[test]
fn rays_through_features_cross_once() {
    for (scale, centre) in [(1.0, 0.0), (2f64.powi(-20), 0.0), (2f64.powi(20), 0.0), (1.0, 1e6), (1e3, -1e9)] {
        let (points, triangles) = icosphere(2);
        let points: Vec<DVec3> = points.iter().map(|p| *p * scale + DVec3::splat(centre)).collect();
        let caster = RayCaster::new(points.clone(), triangles.clone()).expect("a mesh");
        let mut random = Random::new(5);
        for _ in 0..5000 {
            let mut feature = || {
                let [a, b, c] = random.pick(&triangles).map(|v| points[v as usize]);
                random.pick(&[a, 0.5 * (a + b), (a + b + c) / 3.0])
            };
            let (near, far) = (feature(), feature());
            let direction = far - near;
            if direction == DVec3::ZERO {
                continue;
            }
            // From outside, on the line through both or nearly so.
            let outside = caster.all(&Ray::new(near - direction * (4.0 * scale / direction.length()), direction));
            assert!(outside.len().is_multiple_of(2), "{near} {far}: {outside:?}");
            let within = DVec3::splat(centre) + random.in_cube() * (0.5 * scale);
            let inside = caster.all(&Ray::new(within, far - within));
            assert!(inside.len() % 2 == 1, "{within} {far}: {inside:?}");
            assert!(caster.contains(within) && caster.winding(within) == 1);
        }
    }
}

/// Distances, weights and points agree with one another and with the plane.
#[test]
fn hits_lie_on_their_triangles() {
    let (points, triangles) = icosphere(1);
    let caster = RayCaster::new(points, triangles).expect("a mesh");
    let mut random = Random::new(6);
    for _ in 0..20_000 {
        let (origin, target) = (random.direction() * 3.0, random.in_cube() * 0.5);
        let ray = Ray::new(origin, (target - origin) * random.magnitude(1e-3, 1e3));
        let Some(Hit { t, triangle, uv, enters }) = caster.closest(&ray) else { continue };
        let [a, b, c] = caster.corners(triangle);
        let point = a * (1.0 - uv.x - uv.y) + b * uv.x + c * uv.y;
        assert!((point - ray.at(t)).length() < 1e-13 && enters, "{ray:?}");
        assert!(caster.normal(triangle).dot(ray.direction) < 0.0);
        // Cut off just before and just behind the hit.
        assert!(!caster.any(&Ray { t_max: t * (1.0 - 1e-12), ..ray }) && caster.any(&Ray { t_max: t * (1.0 + 1e-12), ..ray }));
    }
}

/// Batches give what single rays give; rays with numbers that are none, and meshes without triangles, have no hits.
#[test]
fn unusual_input() {
    let (points, triangles) = icosphere(1);
    let caster = RayCaster::new(points.clone(), triangles.clone()).expect("a mesh");
    let mut random = Random::new(7);
    let rays: Vec<Ray> = (0..1000).map(|_| Ray::new(random.in_cube() * 2.0, random.direction())).collect();
    assert_eq!(caster.closest_of(&rays), rays.iter().map(|ray| caster.closest(ray)).collect::<Vec<_>>());
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e200] {
        let rays = [Ray::new(DVec3::splat(bad), DVec3::X), Ray::new(DVec3::ZERO, DVec3::new(bad, 0.0, 1.0))];
        assert!(rays.iter().all(|ray| caster.closest(ray).is_none() && !caster.any(ray) && caster.all(ray).is_empty()), "{bad}");
    }
    assert!(caster.closest(&Ray::new(DVec3::ZERO, DVec3::ZERO)).is_none());
    assert!(caster.closest(&Ray { t_max: f64::NAN, ..Ray::new(DVec3::ZERO, DVec3::X) }).is_none());
    let empty = RayCaster::new(vec![], vec![]).expect("a mesh");
    assert!(empty.is_empty() && empty.closest(&Ray::new(DVec3::ZERO, DVec3::X)).is_none() && !empty.contains(DVec3::ZERO));
    let said = |positions: Vec<DVec3>, triangles| RayCaster::new(positions, triangles).err().expect("no mesh").to_string();
    assert!(said(points, vec![[0, 1, 99]]).contains("triangle [0, 1, 99]: there are only 42 vertices"));
    assert!(said(vec![DVec3::new(0.0, 1e70, 0.0)], vec![]).contains("vertex 0"));
}

fn pt(args: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_pt"))
        .arg("rays")
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a run");
    child.stdin.take().expect("a pipe").write_all(input.as_bytes()).expect("it reads");
    child.wait_with_output().expect("it ends")
}

#[test]
fn the_command_reads_rays_and_points() {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = folder.path().join("unit.obj");
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    std::fs::write(&mesh, format!("{corners}f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")).expect("a file");
    let mesh = mesh.to_str().expect("a name");

    let output = pt(&[mesh, "--from", "-", "--all"], "\u{feff}ox,oy,oz,dx,dy,dz\n.25,.25,-1,0,0,2\n# a comment\n\n5 5 5 0 0 1\n");
    let text = String::from_utf8(output.stdout).expect("text");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 4, "{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(lines[1].starts_with("0,0.5,0.25,0.25,0,0,") && lines[1].ends_with(",0,0,-1,front"), "{text}");
    assert!(lines[2].starts_with("0,0.75,0.25,0.25,0.5,3,") && lines[2].ends_with(",back"), "{text}");
    assert_eq!(lines[3], "1,,,,,,,,,,,");

    let output = pt(&[mesh, "--inside", "-"], ".1 .1 .1\n1,1,1\n");
    assert_eq!(String::from_utf8(output.stdout).expect("text"), "x,y,z,inside,winding\n0.1,0.1,0.1,1,1\n1,1,1,0,0\n");

    let told = |input: &str| {
        let output = pt(&[mesh, "--from", "-"], input);
        (output.status.code(), String::from_utf8(output.stderr).expect("text"))
    };
    assert_eq!(told("0 0 0 0 0\n"), (Some(3), "error: -:1: found \"0 0 0 0 0\", expected 6 numbers\n".into()));
    assert_eq!(told("0 0 0 0 0 1\n0 0 0 0 0 x\n").0, Some(3));
    assert!(pt(&[mesh], "").status.code() == Some(2));
}

/// A tetrahedron at the origin, and its mirror image further along x. The mirror reverses the order of the corners: without a correction the
/// winding number there would be -1.
#[test]
fn all_triangles_of_a_model_are_met() {
    let positions: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let corners: [u16; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    let bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).chain(corners.iter().flat_map(|i| i.to_le_bytes())).collect();
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("data.bin"), bytes).expect("numbers");
    let model = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"mesh": 0, "scale": [-1, 1, 1], "translation": [5, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "buffers": [{"uri": "data.bin", "byteLength": 72}]}"#;
    let path = folder.path().join("model.gltf");
    std::fs::write(&path, model).expect("a model");
    let (caster, _) = RayCaster::load(&path).expect("a mesh");
    let at = |x: f64| DVec3::new(x, 0.1, 0.1);
    assert_eq!((caster.len(), caster.winding(at(0.1)), caster.winding(at(4.9)), caster.winding(at(2.0))), (8, 1, 1, 0));
    let distances: Vec<f64> = caster.all(&Ray::new(at(-1.0), DVec3::X)).iter().map(|hit| hit.t).collect();
    // Faces at x = 0 and x + y + z = 1, and their mirror images.
    let expected = [1.0, 1.8, 5.2, 6.0];
    assert!(distances.len() == 4 && distances.iter().zip(expected).all(|(t, x)| (t - x).abs() < 1e-6), "{distances:?}");
    let output = pt(&[path.to_str().expect("a name"), "--inside", "-"], "0.1 0.1 0.1\n2 0 0\n");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "x,y,z,inside,winding\n0.1,0.1,0.1,1,1\n2,0,0,0,0\n");
}

/// A transform, and its matrix by other code.
fn placed(random: &mut Random) -> (Transform, DMat4) {
    let (axis, degrees) = (random.direction(), 360.0 * random.unit());
    let scale = DVec3::new(random.range(0.5, 2.0), random.range(0.5, 2.0), -random.range(0.5, 2.0));
    let by = random.in_cube() * 8.0;
    let transform = Transform::rotate(axis, degrees).expect("an axis").then(&Transform::scale(scale).expect("not zero"));
    let turn = DMat4::from_axis_angle(axis, degrees.to_radians());
    (transform.then(&Transform::translate(by).expect("finite")), DMat4::from_translation(by) * DMat4::from_scale(scale) * turn)
}

/// Distance and outward normal, in its own space, of the cube from −1 to 1.
fn meets_cube(origin: DVec3, direction: DVec3) -> Option<(f64, DVec3)> {
    let faces = (0..3).flat_map(|axis| [-1.0, 1.0].map(|side| (axis, side)));
    let hits = faces.filter_map(|(axis, side)| {
        let t = (side - origin[axis]) / direction[axis];
        let mut p = origin + direction * t;
        p[axis] = 0.0;
        let normal = DVec3::AXES[axis] * side;
        (t > 0.0 && p.abs().max_element() <= 1.0).then_some((t, normal))
    });
    hits.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Distance and outward normal, in its own space, of the unit sphere.
fn meets_sphere(origin: DVec3, direction: DVec3) -> Option<(f64, DVec3)> {
    let (a, b) = (direction.length_squared(), origin.dot(direction));
    let root = (b * b - a * (origin.length_squared() - 1.0)).sqrt();
    let t = [(-b - root) / a, (-b + root) / a].into_iter().find(|t| *t > 0.0)?;
    Some((t, origin + direction * t))
}

/// Whether a ray passes within 0.001 of the edge of a transformed unit sphere.
fn is_at_edge(ray: &Ray, matrix: DMat4) -> bool {
    let inverse = matrix.inverse();
    let [origin, direction] = [inverse.transform_point3(ray.origin), inverse.transform_vector3(ray.direction).normalize()];
    (origin.cross(direction).length() - 1.0).abs() < 1e-3
}

/// A camera of which only its being there matters.
fn pinhole() -> Camera {
    Camera::Perspective(Perspective::new(Pose::new(&Transform::IDENTITY), 40.0, 0.0, 1.0))
}

/// Cubes and spheres, which instances show turned, stretched, mirrored and within each other, are met where their matrices say.
#[test]
fn instances_are_met_where_they_are() {
    let mut random = Random::new(11);
    for _ in 0..20 {
        let mut builder = World::builder(pinhole());
        let gray = builder.material(Material::diffuse(Rgb::gray(0.5)));
        let (mut cube, mut both, mut scene) = (Objects::default(), Objects::default(), Objects::default());
        scene.shape(Cuboid { size: [2.0; 3] }, Transform::IDENTITY, gray, None);
        cube.shape(Cuboid { size: [2.0; 3] }, Transform::IDENTITY, gray, None);
        let cube = builder.group(cube);
        both.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, gray, None);
        let within = placed(&mut random);
        both.instance(cube, within.0, None);
        let both = builder.group(both);
        // Shape and instance, place, and which of the two it is. Instances within others follow them.
        let mut known = vec![(0, None, DMat4::IDENTITY, true)];
        for k in 0..3 {
            let (transform, matrix) = placed(&mut random);
            known.extend([(2, Some(2 * k), matrix, false), (1, Some(2 * k + 1), matrix * within.1, true)]);
            scene.instance(both, transform, None);
        }
        builder.objects(scene);
        let caster = SceneCaster::new(Arc::new(builder.build().expect("a world"))).expect("a caster");
        let mut hits = 0;
        for _ in 0..2000 {
            let (from, aim) = (random.in_cube() * 20.0, known[random.below(known.len())].2.transform_point3(random.in_cube() * 1.5));
            let ray = Ray::new(from, (aim - from) * random.range(0.1, 10.0));
            // At the edge of a sphere single precision may decide either way.
            if known.iter().any(|known| !known.3 && is_at_edge(&ray, known.2)) {
                continue;
            }
            let expected = known.iter().filter_map(|&(shape, instance, matrix, is_cube)| {
                let inverse = matrix.inverse();
                let [origin, direction] = [inverse.transform_point3(ray.origin), inverse.transform_vector3(ray.direction)];
                let (t, normal) = if is_cube { meets_cube(origin, direction) } else { meets_sphere(origin, direction) }?;
                let normal = inverse.transpose() * DVec4::from((normal, 0.0));
                Some((t, shape, instance, is_cube, normal.truncate().normalize()))
            });
            let expected = expected.min_by(|a, b| a.0.total_cmp(&b.0));
            let found = caster.closest(&ray);
            let (Some((t, shape, instance, is_exact, normal)), Some(hit)) = (expected, found) else {
                assert_eq!(found.map(|hit| hit.t), expected.map(|expected| expected.0), "{ray:?}");
                continue;
            };
            hits += 1;
            assert_eq!((hit.shape, hit.instance, hit.is_exact), (shape, instance, is_exact), "{ray:?}: {hit:?}");
            // The corners of cubes are rounded to f32, which counts more where rays graze them. Spheres are met in single precision.
            let least = if is_exact { 2e-5 } else { 2e-4 };
            let far = 1.0 + t * ray.direction.length();
            assert!((hit.t - t).abs() * ray.direction.length() < least * far, "{t} {hit:?} {ray:?}");
            assert!(hit.normal.distance(normal) < 10.0 * least, "{normal} {hit:?} {ray:?}");
        }
        assert!(hits > 200, "{hits}");
    }
}

/// Copies of lamps belong to no instance, what moves is where it is when the shutter opens, and of two instances in one place the first is met.
#[test]
fn lamps_and_what_moves_are_met() {
    let by = |x: f64, z: f64| Transform::translate(DVec3::new(x, 0.0, z)).expect("finite");
    let mut builder = World::builder(pinhole());
    let gray = builder.material(Material::diffuse(Rgb::gray(0.5)));
    let (mut lamp, mut square, mut mover) = (Objects::default(), Objects::default(), Objects::default());
    lamp.shape(Quad { size: [1.0; 2] }, Transform::IDENTITY, gray, Some(Emitter::new(Rgb::gray(1.0))));
    square.shape(Quad { size: [1.0; 2] }, Transform::IDENTITY, gray, None);
    mover.shape(Quad { size: [1.0; 2] }, Transform::IDENTITY, gray, None);
    let (lamp, square) = (builder.group(lamp), builder.group(square));
    let mut scene = Objects::default();
    scene.moving(mover, Keyframes::new(&[(0.0, by(4.0, -3.0)), (1.0, by(8.0, -3.0))]).expect("neither mirrors").into());
    for place in [by(0.0, -1.0), by(2.0, -2.0)] {
        scene.instance(lamp, place, None);
    }
    for _ in 0..2 {
        scene.instance(square, by(6.0, -4.0), None);
    }
    builder.objects(scene);
    let caster = SceneCaster::new(Arc::new(builder.build().expect("a world"))).expect("a caster");
    let met = |x: f64| {
        let hit = caster.closest(&Ray::new(DVec3::new(x + 0.1, 0.2, 0.0), DVec3::NEG_Z))?;
        // Corners are rounded to f32.
        assert!((hit.t - hit.t.round()).abs() < 1e-5, "{hit:?}");
        Some((hit.t.round(), hit.shape, hit.instance))
    };
    // The shape that moves was added first; the instances of lamps are numbers 0 and 1, and the moving shape comes after those of squares.
    assert_eq!(met(0.0), Some((1.0, 1, None)));
    assert_eq!(met(2.0), Some((2.0, 1, None)));
    assert_eq!(met(4.0), Some((3.0, 0, Some(4))));
    assert_eq!(met(6.0), Some((4.0, 2, Some(2))));
    assert_eq!(met(8.0), None);
}
