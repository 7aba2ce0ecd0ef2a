//! Displacement of meshes: sizes, slopes and lights with formulas, and surfaces that stay closed.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use pt::accel;
use pt::bsdf::Material;
use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::rays::{Ray, RayCaster, SceneCaster};
use pt::scene::Scene as _;
use pt::shape::{MeshData, Quad, TriangleMesh};
use pt::torture::meshes::{baked, icosphere, mesh, shapes};
use pt::world::World;

use crate::random::Random;
use crate::scenes::{Depth, Effort, KnownRadiance, at, black, confirm, facing, glow, gray, probe, stored, two_sided};
use crate::subdivision::cages::{closed, cube, icosahedron};
use crate::subdivision::{border, edges, places, shaken, welded};

/// A picture of two pixels, 0 and 1/2, as Radiance HDR. Between their centres, at u = 1/4 and 3/4, it is a ramp.
const RAMP: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\0\0\0\0\x80\x80\x80\x80";

fn build(shape: &str) -> pt::Result<Built> {
    let text = format!(r#"{{"pt": 1, "camera": {{}}, "shapes": [{shape}]}}"#);
    let root = describe::root(text.as_bytes(), "s")?;
    let files = Files { made: BTreeMap::from([("ramp.hdr".to_owned(), RAMP.to_vec())]), ..Files::within("scenes") };
    pt::build::build(&describe::read(&root, "s")?, Source { root: &root, file: "s", files: &files })
}

/// A mesh with further keys.
fn described(data: &MeshData, keys: &str) -> String {
    let [positions, normals] =
        [&data.positions, &data.normals].map(|list| format!("{:?}", list.iter().map(|p| p.to_array()).collect::<Vec<_>>()));
    let uvs = format!("{:?}", data.uvs.iter().map(|uv| uv.to_array()).collect::<Vec<_>>());
    let mut text = format!(r#"{{"type": "mesh", "positions": {positions}, "triangles": {:?}"#, data.triangles);
    if !data.normals.is_empty() {
        text += &format!(r#", "normals": {normals}"#);
    }
    if !data.uvs.is_empty() {
        text += &format!(r#", "uvs": {uvs}"#);
    }
    text + ", " + keys + "}"
}

/// The unit sphere, with its normals.
fn sphere(splits: u32) -> MeshData {
    let (points, triangles) = icosphere(splits);
    let positions = places(&points);
    MeshData { normals: positions.clone(), ..mesh(positions, triangles) }
}

/// A constant moves each vertex of a sphere to a sphere of another radius, and the normals stay radial as far as the triangles around a vertex
/// are symmetric: within the square of their size. The same by a scene's texture, where 0.4 · (0.5 − 0.25) = 0.1.
#[test]
fn a_sphere_grows_by_a_constant() {
    let round = sphere(3);
    for height in [-0.75, 0.1, 3.0] {
        let grown = round.clone().displaced(&vec![height; round.positions.len()]);
        for (p, n) in grown.positions.iter().zip(&grown.normals) {
            assert!((f64::from(p.length()) - 1.0 - height).abs() < 3e-7 * (1.0 + height), "{p}");
            assert!(n.distance(p.normalize()) < 0.01 && (n.length() - 1.0).abs() < 1e-6, "{p} {n}");
        }
        assert_eq!(grown.triangles, round.triangles);
    }
    let keys = r#""displacement": {"texture": 0.5, "scale": 0.4, "midlevel": 0.25}"#;
    let built = build(&described(&round, keys)).expect("a scene");
    let (origin, shape) = (built.world.origin(), &built.world.shapes()[0]);
    let corners = |i| shape.facet(i).triangles().flat_map(|(t, _)| t).collect::<Vec<_>>();
    let radii = (0..shape.count()).flat_map(corners).map(|p| (p.as_dvec3() + origin).length());
    radii.for_each(|radius| assert!((radius - 1.1).abs() < 1e-6, "{radius}"));
}

/// A grid of n × n cells over [−1, 1]², facing +z, with u from 1/4 to 3/4 along x.
fn plane(n: u32) -> MeshData {
    let share = |i: u32| f64::from(i) / f64::from(n);
    let corners = || (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let halves = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    let positions: Vec<Vec3> = corners().map(|(i, j)| DVec3::new(2.0 * share(i) - 1.0, 2.0 * share(j) - 1.0, 0.0).as_vec3()).collect();
    MeshData {
        uvs: corners().map(|(i, j)| Vec2::new((0.25 + 0.5 * share(i)) as f32, share(j) as f32)).collect(),
        normals: vec![Vec3::Z; positions.len()],
        ..mesh(positions, (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).flat_map(halves).collect())
    }
}

/// A picture that is a ramp makes a slope: its values go from 0 to 1/2 over two metres, so that with the scale s the height is s (x + 1) / 4, and
/// the normal is along (−s/4, 0, 1).
#[test]
fn a_ramp_has_the_normal_of_its_slope() {
    for scale in [0.7, -3.0, 20.0] {
        let keys = format!(
            r#""displacement": {{"texture": {{"type": "image", "file": "ramp.hdr", "wrap": "clamp"}}, "scale": {scale}, "midlevel": 0.25}}"#
        );
        let built = build(&described(&plane(6), &keys)).expect("a scene");
        let (origin, shape) = (built.world.origin(), &built.world.shapes()[0]);
        let expected = DVec3::new(-scale / 4.0, 0.0, 1.0).normalize();
        let mut random = Random::new(1);
        for i in 0..shape.count() {
            let (point, _) = shape.sample_area(i, random.square());
            let p = point.p.as_dvec3() + origin;
            let height = scale * ((p.x + 1.0) / 4.0 - 0.25);
            assert!((p.z - height).abs() < 1e-6 * (1.0 + scale.abs()), "{p} instead of {height}");
            let turned = point.ns.as_dvec3().distance(expected).max(point.ng.as_dvec3().distance(expected));
            assert!(turned < 2e-6, "{} instead of {expected}", point.ns);
        }
    }
}

/// A ball whose texture coordinates jump along each edge, so that every edge is a seam.
fn torn(data: &MeshData) -> MeshData {
    let corners: Vec<u32> = data.triangles.as_flattened().to_vec();
    let list = |values: &[Vec3]| corners.iter().filter_map(|v| values.get(*v as usize).copied()).collect();
    let count = corners.len() as u32 / 3;
    MeshData { normals: list(&data.normals), ..mesh(list(&data.positions), (0..count).map(|t| [0, 1, 2].map(|k| 3 * t + k)).collect()) }
}

/// Where the two sides of a seam read different heights, both are moved to the same place, smooth or faceted, and the surface around the
/// middle stays closed: the winding number is 1 in the middle, rays from there through vertices and edges hit, and normals of the two sides
/// are the same.
#[test]
fn seams_with_different_heights_stay_closed() {
    for (k, (cage, _)) in closed().into_iter().take(4).enumerate() {
        let smooth = shaken(cage, k as u64, 0.1).data().subdivided(2).expect("a surface");
        for data in [torn(&smooth), MeshData { normals: vec![], ..torn(&smooth) }] {
            let mut random = Random::new(k as u64);
            let heights: Vec<f64> = data.positions.iter().map(|_| random.range(-0.05, 0.1)).collect();
            let moved = data.clone().displaced(&heights);
            assert!(border(&welded(&moved)).is_empty() && moved.positions != data.positions);
            let mut normals = BTreeMap::new();
            for (p, n) in moved.positions.iter().zip(&moved.normals) {
                assert_eq!(*normals.entry(p.to_array().map(f32::to_bits)).or_insert(*n), *n);
            }
            let caster =
                RayCaster::new(moved.positions.iter().map(|p| p.as_dvec3()).collect(), moved.triangles.clone()).expect("triangles");
            assert_eq!([caster.winding(DVec3::ZERO), caster.winding(DVec3::X * 9.0)], [1, 0]);
            let targets: Vec<DVec3> = edges(&moved.triangles)
                .keys()
                .flat_map(|edge| {
                    let [a, b] = edge.map(|v| moved.positions[v as usize].as_dvec3());
                    [a, 0.5 * (a + b)]
                })
                .collect();
            let hierarchy = accel::build(shapes(vec![baked(moved)]));
            for target in targets {
                let origin = (random.in_cube() * 0.05).as_vec3();
                let ray = pt::math::Ray::new(origin, (target - origin.as_dvec3()).as_vec3());
                assert!(hierarchy.intersect(&ray).is_some() && hierarchy.occluded(&ray), "{ray:?}");
            }
        }
    }
}

/// Where both sides of a seam read the same height, the seam makes no difference to any bit of positions and normals.
#[test]
fn seams_with_equal_heights_change_no_bit() {
    for (k, (cage, _)) in closed().into_iter().enumerate() {
        let whole = shaken(cage, k as u64, 0.1).data().subdivided(2).expect("a surface");
        let mut random = Random::new(k as u64);
        let heights: Vec<f64> = whole.positions.iter().map(|_| random.range(-0.05, 0.1)).collect();
        let of_corners: Vec<f64> = whole.triangles.as_flattened().iter().map(|v| heights[*v as usize]).collect();
        let [torn, whole] = [torn(&whole).displaced(&of_corners), whole.displaced(&heights)].map(|data| {
            let corner = |v: &u32| (data.positions[*v as usize], data.normals[*v as usize]);
            data.triangles.as_flattened().iter().map(corner).collect::<Vec<_>>()
        });
        assert!(torn == whole, "cage {k}");
    }
}

/// Seams in a scene: a checkerboard over the texture coordinates that jumps at the seam of a ball with 20 meridians, and at its poles, where
/// each triangle has a u of its own. Every ray from inside is stopped, and parity says inside and outside.
#[test]
fn a_ball_with_a_seam_has_no_crack() {
    let (n, m) = (20, 10);
    let at = |i: u32, j: u32| i * (m + 1) + j;
    let point = |i: u32, j: u32| {
        let [a, b] = [2.0 * PI * f64::from(i % n) / f64::from(n), PI * f64::from(j) / f64::from(m)];
        if j == 0 || j == m { DVec3::Z * (1.0 - 2.0 * f64::from(j / m)) } else { DVec3::new(b.sin() * a.cos(), b.sin() * a.sin(), b.cos()) }
    };
    let corners = || (0..=n).flat_map(|i| (0..=m).map(move |j| (i, j)));
    let halves = |(i, j)| [[at(i, j), at(i, j + 1), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i + 1, j)]];
    let positions: Vec<Vec3> = corners().map(|(i, j)| point(i, j).as_vec3()).collect();
    let ball = MeshData {
        uvs: corners().map(|(i, j)| Vec2::new(i as f32 / n as f32, j as f32 / m as f32)).collect(),
        ..mesh(positions, (0..n).flat_map(|i| (0..m).map(move |j| (i, j))).flat_map(halves).collect())
    };
    let (ball, _) = ball.clean();
    for levels in [0, 2] {
        let keys =
            format!(r#""subdivision_levels": {levels}, "displacement": {{"texture": {{"type": "checker", "scale": 7.3}}, "scale": 0.1}}"#);
        let built = build(&described(&ball, &keys)).expect("a scene");
        let caster = SceneCaster::new(Arc::new(built.world)).expect("flat shapes");
        let mut random = Random::new(5);
        for _ in 0..2000 {
            let (inside, direction) = (random.in_cube() * 0.1, random.direction());
            let count = |origin: DVec3| {
                let (mut from, mut hits) = (origin, 0);
                while let Some(hit) = caster.closest(&Ray::new(from, direction)) {
                    (from, hits) = (from + direction * (hit.t + 1e-9), hits + 1);
                }
                hits
            };
            let outside = direction * -3.0 + random.in_cube() * 0.2;
            assert_eq!((count(inside) % 2, count(outside) % 2), (1, 0), "{inside} {outside} {direction}");
        }
    }
}

/// Without height nothing changes, and a scale of 0 gives the bits of a scene without displacement, also where normals disagree with the
/// winding.
#[test]
fn no_height_changes_no_bit() {
    let mut data = sphere(1);
    assert_eq!(data.clone().displaced(&vec![0.0; data.positions.len()]), data);
    data.triangles.iter_mut().step_by(3).for_each(|t| t.swap(0, 1));
    for place in ["", r#""transform": [{"scale": [-2, 1, 0.5]}, {"translate": [0.1, 0.2, 0.3]}], "#] {
        let [with, without] = [r#""displacement": {"texture": {"type": "noise"}, "scale": 0}, "#, ""].map(|keys| {
            let built = build(&described(&data, &format!(r#"{place}{keys}"smooth_shadows": false"#))).expect("a scene");
            let shape = &built.world.shapes()[0];
            let corners = |i| shape.facet(i).triangles().flat_map(|(t, _)| t).map(|p| p.to_array()).collect::<Vec<_>>();
            (0..shape.count()).map(|i| (corners(i), shape.sample_area(i, Vec2::splat(0.25)).0.ns.to_array())).collect::<Vec<_>>()
        });
        assert!(with == without);
    }
}

/// The corners of a cube with a normal for each face move along its diagonals, however the faces are divided, and each face keeps its normal.
#[test]
fn hard_edges_stay_hard_and_closed() {
    let soft = cube();
    let corners: Vec<u32> = soft.triangles.as_flattened().to_vec();
    let data = torn(&soft.data());
    let normal = |k: usize| data.cross([k / 3 * 3, k / 3 * 3 + 1, k / 3 * 3 + 2].map(|v| v as u32)).normalize().as_vec3();
    let data = MeshData { normals: (0..corners.len()).map(normal).collect(), ..data };
    let h = 0.5;
    let moved = data.clone().displaced(&vec![h; corners.len()]);
    for (before, after) in data.positions.iter().zip(&moved.positions) {
        let expected = before.as_dvec3() * (1.0 + h / 3f64.sqrt());
        assert!(after.as_dvec3().distance(expected) < 3e-7, "{after} instead of {expected}");
    }
    assert!(moved.normals.iter().zip(&data.normals).all(|(a, b)| a.distance(*b) < 3e-7));
    let faceted = MeshData { normals: vec![], ..data.clone() }.displaced(&vec![h; corners.len()]);
    assert_eq!((&faceted.positions, faceted.normals.len()), (&moved.positions, 0));
}

/// What is twice as large, and moved by twice the height, is the same but for the exponents.
#[test]
fn powers_of_two_change_no_bit_but_exponents() {
    let data = icosahedron().data().subdivided(2).expect("a surface");
    let mut random = Random::new(3);
    let heights: Vec<f64> = data.positions.iter().map(|_| random.range(-0.2, 0.3)).collect();
    let moved = data.clone().displaced(&heights);
    for power in [-40, -3, 9, 50] {
        let scale = 2f32.powi(power);
        let scaled = MeshData { positions: data.positions.iter().map(|p| *p * scale).collect(), ..data.clone() };
        let scaled = scaled.displaced(&heights.iter().map(|h| h * f64::from(scale)).collect::<Vec<_>>());
        assert!(scaled.positions.iter().zip(&moved.positions).all(|(a, b)| *a == *b * scale) && scaled.normals == moved.normals);
    }
}

/// A rounded and displaced lamp lights a tile by the area that it has: the sum of cos θ cos θ′ dA / d² over its triangles, each divided into 256.
/// It is convex, so that what faces the tile is seen. Sheets above the tile, turned away from it, shine on both sides and hide nothing of
/// themselves. Within a triangle of 1/16 of its size the terms vary by less than 10⁻³.
#[test]
fn lamps_emit_by_the_area_that_they_have() {
    let base = icosahedron().data().subdivided(1).expect("a surface");
    let ball = base.clone().displaced(&vec![-0.45; base.positions.len()]);
    let subdivided = sheet().subdivided(2).expect("a surface");
    let heights: Vec<f64> = subdivided.positions.iter().map(|p| 0.05 * f64::from(5.0 * p.x).sin()).collect();
    let displaced = subdivided.clone().displaced(&heights);
    let lamps = [
        ("a displaced ball", ball, false),
        ("a rounded sheet, on both sides", subdivided, true),
        ("a displaced sheet, on both sides", displaced, true),
    ];
    let laws = lamps.into_iter().map(|(name, data, on_both)| {
        let place = at(DVec3::new(0.3, 1.5, -0.2));
        let pieces = data.triangles.iter().flat_map(|&t| divided(data.corners(t).map(|p| place.point(p)), 4));
        let irradiance: f64 = pieces.map(|piece| seen_from_the_origin(piece, on_both)).sum();
        let mut world = World::builder(probe(DVec3::new(3f64.sqrt(), 1.0, 0.0) * 0.002, DVec3::ZERO));
        let white = world.material(Material::diffuse(stored(gray(1.0))));
        world.shape(Quad { size: [0.002; 2] }, facing(DVec3::ZERO, DVec3::Y), white, None);
        let dark = world.material(black());
        let emitter = if on_both { two_sided(1.0) } else { glow(1.0) };
        world.shape(TriangleMesh { keeps_winding: true, ..TriangleMesh::new(data) }, place, dark, emitter);
        let depth = Depth { max: 1, roulette: u32::MAX };
        KnownRadiance::new(name, world, irradiance / PI, depth).resolution(2e-3, 4e-3).by_chance(1e-2)
    });
    confirm(laws.collect(), Effort::Standard);
}

/// A bent sheet whose front looks upwards.
fn sheet() -> MeshData {
    let corners = [[-0.7, 0.2, 0.6], [0.6, -0.1, 0.7], [0.7, 0.2, -0.6], [-0.6, 0.0, -0.7]].map(Vec3::from);
    mesh(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

fn divided([a, b, c]: [DVec3; 3], levels: u32) -> Vec<[DVec3; 3]> {
    if levels == 0 {
        return vec![[a, b, c]];
    }
    let [ab, bc, ca] = [a + b, b + c, c + a].map(|sum| sum / 2.0);
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].into_iter().flat_map(|t| divided(t, levels - 1)).collect()
}

/// cos θ cos θ′ dA / d² of a triangle that is bright on its front or on both sides, at a tile in the origin that faces +y.
fn seen_from_the_origin([a, b, c]: [DVec3; 3], on_both: bool) -> f64 {
    let (middle, normal) = ((a + b + c) / 3.0, 0.5 * (b - a).cross(c - a));
    let w = middle.normalize();
    let facing = if on_both { normal.dot(w).abs() } else { (-normal.dot(w)).max(0.0) };
    facing * w.y.max(0.0) / middle.length_squared()
}

#[test]
fn scenes_say_what_is_wrong() {
    let sound = r#""displacement": {"texture": {"type": "noise"}, "scale": 1}"#;
    let plain = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    assert!(build(&described(&plain, sound)).is_ok());
    for (keys, expected) in [
        (r#""displacement": {"scale": 1}"#, "/shapes/0/displacement: missing key \"texture\""),
        (r#""displacement": {"texture": 0.5}"#, "/shapes/0/displacement: missing key \"scale\""),
        (r#""displacement": {"texture": "none", "scale": 1}"#, "/shapes/0/displacement/texture: unknown texture \"none\""),
        (r#""displacement": {"texture": 1, "scale": "much"}"#, "/shapes/0/displacement/scale: expected a number"),
        (
            r#""displacement": {"texture": 1, "scale": 1, "midlevel": 2}"#,
            "/shapes/0/displacement/midlevel: expected a number from 0 to 1, found 2",
        ),
        (r#""displacement": {"texture": 1, "scale": 1e30}"#, "/shapes/0/displacement/scale: extent 1e30 exceeds 1e18"),
        (r#""displacement": {"texture": 1, "scale": 3e38}"#, "/shapes/0/displacement/scale: extent 3e38 exceeds 1e18"),
        (
            r#""displacement": {"texture": {"type": "image", "file": "ramp.hdr"}, "scale": 1}"#,
            "/shapes/0/displacement/texture: the mesh has no texture coordinates, over which this texture varies",
        ),
        (
            r#""displacement": {"texture": {"type": "mix", "a": 0, "b": 1, "share": {"type": "noise", "on": "uv"}}, "scale": 1}"#,
            "/shapes/0/displacement/texture: the mesh has no texture coordinates",
        ),
        (
            r#""displacement": {"texture": {"type": "image", "file": "none.png"}, "scale": 1}"#,
            "/shapes/0/displacement/texture/file: none.png: no such file",
        ),
        (
            r#""displacement": {"texture": {"type": "image", "file": "../none.png"}, "scale": 1}"#,
            "/shapes/0/displacement/texture/file: ../none.png: leads out of the scene file's folder",
        ),
    ] {
        let said = build(&described(&plain, keys)).map(drop).expect_err(keys).to_string();
        assert!(said.lines().count() == 1 && said.contains(expected), "{keys}: {said}");
    }
    // An octahedron that is moved into one point.
    let tips: Vec<Vec3> = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z].into();
    let faces = vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    let octahedron = MeshData { normals: tips.clone(), ..mesh(tips, faces) };
    let gone = build(&described(&octahedron, r#""displacement": {"texture": 1, "scale": -1}"#)).map(drop).expect_err("no area");
    assert!(gone.to_string().contains("no usable triangles"), "{gone}");
}
