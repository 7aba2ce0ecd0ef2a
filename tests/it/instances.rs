//! Instances of a group are hit, shaded and lit as copies of its shapes are.

mod borders;
mod faults;
mod pictures;
mod points;

use glam::{DMat4, DVec3, Vec3};
use pt::build::Built;
use pt::math::Ray;
use pt::primitive::Hit;
use pt::scene::{Scene, Surface};
use pt::world::World;
use serde_json::{Value, json};

use crate::light_tracer::built;
use crate::random::Random;

/// Scene of some shapes and groups, seen from a corner.
fn scene(groups: Value, shapes: Value) -> Value {
    json!({
        "pt": 1,
        "camera": { "look_at": { "from": [6, 5, 7], "to": [0, 0, 0] } },
        "film": { "width": 24, "height": 18 },
        "background": { "radiance": 0.5 },
        "groups": groups,
        "shapes": shapes,
    })
}

fn world(scene: &Value) -> World {
    let Built { world, .. } = built(&scene.to_string());
    world
}

/// A transform: any affine map that stretches no direction more than about three times as much as another, half of them mirrored. Under
/// stronger ones the normals at the corners of a coarse mesh may disagree with its facets about the outside.
fn transform(random: &mut Random, reach: f64) -> Value {
    let [a, b] = [random.rotation(), random.rotation()];
    let mut stretch = DVec3::new(random.magnitude(0.6, 1.6), random.magnitude(0.6, 1.6), random.magnitude(0.6, 1.6));
    if random.below(2) == 0 {
        stretch.x = -stretch.x;
    }
    let linear = a.matrix().matrix3 * glam::DMat3::from_diagonal(stretch) * b.matrix().matrix3;
    let matrix = DMat4::from_mat3_translation(linear, random.in_cube() * reach);
    json!([{ "matrix": matrix.transpose().to_cols_array() }])
}

/// A mesh with smooth normals and texture coordinates: an octahedron with the normals of a ball, stretched.
fn octahedron() -> Value {
    json!({ "type": "mesh", "name": "octahedron", "smooth_shadows": true,
        "positions": [[1, 0, 0], [-1, 0, 0], [0, 1.5, 0], [0, -1.5, 0], [0, 0, 1], [0, 0, -1]],
        "normals": [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
        "uvs": [[0, 0], [1, 0], [0.5, 1], [0.5, 0], [0.25, 0.5], [0.75, 0.5]],
        "triangles": [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]] })
}

/// One shape of each kind, side by side.
pub fn one_of_each() -> Value {
    let bumped = json!({ "type": "bumped", "surface": { "type": "diffuse" }, "bump_map": { "type": "noise", "scale": 3 }, "scale": 0.1 });
    json!([
        octahedron(),
        { "type": "sphere", "name": "ball", "radius": 0.8, "center": [2, 0, 0], "material": bumped },
        { "type": "quad", "name": "quad", "size": [1, 2], "transform": [{ "translate": [0, 0, 2] }], "material": bumped },
        { "type": "disk", "name": "disk", "radius": 0.6, "transform": [{ "rotate": { "axis": [1, 1, 0], "degrees": 70 } }, { "translate": [0, 2, 0] }] },
        { "type": "mesh", "name": "no texture coordinates", "positions": [[0, -2, -2], [1, -2, -2], [0, -1, -2.5], [0.3, -1.5, -1]],
            "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], "material": bumped },
        { "type": "disk", "name": "lamp", "radius": 0.5, "emission": 2, "transform": [{ "translate": [2, 2, 0] }] },
        { "type": "box", "name": "box", "size": [1, 0.5, 2], "center": [-2, 0, 0] },
        { "type": "sdf", "name": "solid", "field": { "type": "torus", "radius": 0.6, "tube": 0.2 }, "transform": [{ "translate": [0, -2, 0] }] },
    ])
}

/// Name of the shape that was hit.
fn name(names: &[String], hit: &Hit) -> String {
    names[hit.shape as usize].clone()
}

/// The greatest relative error of f32 computations with a few dozen roundings, among coordinates of the size of the scene.
const ROUNDING: f32 = 1e-5;

fn assert_near(what: &str, a: Vec3, b: Vec3, tolerance: f32, seed: u64) {
    assert!((a - b).length() <= tolerance, "{what}: {a} and {b}, seed {seed}");
}

/// Two surfaces at the same hit are the same, up to rounding.
///
/// - `scale`: size of the scene (m)
pub fn assert_same(instance: &Surface, copy: &Surface, scale: f32, seed: u64) {
    assert_near("point", instance.point.p, copy.point.p, ROUNDING * scale, seed);
    assert_near("origin of shadow rays", instance.shadow_origin, copy.shadow_origin, 10.0 * ROUNDING * scale, seed);
    assert_near("normal", instance.point.ng, copy.point.ng, 1e-3, seed);
    // Bump maps divide differences of heights by 1/2048, which amplifies rounding as much.
    assert_near("shading normal", instance.point.ns, copy.point.ns, 2048.0 * ROUNDING, seed);
    let uv = instance.point.uv - copy.point.uv;
    // The texture coordinate of a ball jumps from 1 to 0.
    assert!(uv.abs().min(1.0 - uv.abs()).max_element() < 1e-3, "{} and {}, seed {seed}", instance.point.uv, copy.point.uv);
    assert_eq!(instance.emission, copy.emission, "seed {seed}");
    assert_near("tangent", instance.frame.x, copy.frame.x, 2.0 * 2048.0 * ROUNDING, seed);
}

/// Rays hit instances where they hit copies, at the same points with the same normals, texture coordinates and tangents: for every kind of
/// shape, under any transform, and in instances of instances.
#[test]
fn instances_are_hit_where_copies_are() {
    const SCENES: u64 = 40;
    const RAYS: u64 = 2000;
    let (mut hits, mut apart) = (0, 0);
    for seed in 0..SCENES {
        let mut random = Random::new(seed);
        let own = one_of_each();
        let inner: Vec<Value> = (0..3).map(|_| transform(&mut random, 4.0)).collect();
        let outer: Vec<Value> = (0..4).map(|_| transform(&mut random, 12.0)).collect();
        let placements = |transforms: &[Value]| transforms.iter().map(|t| json!({ "transform": t })).collect::<Vec<_>>();
        let copies = |shapes: &Value, transforms: &[Value]| {
            transforms.iter().map(|t| json!({ "type": "group", "shapes": shapes, "transform": t })).collect::<Vec<_>>()
        };
        let instances = json!({
            "things": own,
            "nested": [{ "type": "instances", "group": "things", "placements": placements(&inner) }, { "type": "sphere", "name": "inner", "radius": 0.5 }],
        });
        let [nested, many] =
            ["things", "nested"].map(|group| json!({ "type": "instances", "group": group, "placements": placements(&outer) }));
        let nested_copies = [copies(&own, &inner), vec![json!({ "type": "sphere", "name": "inner", "radius": 0.5 })]].concat();
        let all_copies = [copies(&own, &outer), copies(&json!(nested_copies), &outer)].concat();
        let [a, b] = [scene(instances, json!([nested, many])), scene(json!({}), json!(all_copies))].map(|text| built(&text.to_string()));
        assert_eq!(a.world.instance_count(), 4 + 4 * (1 + 3));
        assert!(a.world.primitive_count() < b.world.primitive_count() / 5);
        assert_eq!((a.world.lights().len(), b.world.lights().len()), (4 + 4 * 3 + 1, 4 + 4 * 3 + 1));
        let shift = (a.world.origin() - b.world.origin()).as_vec3();
        for _ in 0..RAYS {
            let from = (random.direction() * 40.0).as_vec3();
            let to = (random.in_cube() * 16.0).as_vec3();
            let ray = Ray::new(from, (to - from).normalize());
            let moved = Ray::new(from + shift, ray.direction);
            let (found, wanted) = (a.world.intersect(&ray), b.world.intersect(&moved));
            assert_eq!(a.world.occluded(&ray), found.is_some());
            let (Some(found), Some(wanted)) = (found, wanted) else {
                apart += u64::from(found.is_some() != wanted.is_some());
                continue;
            };
            // Where a ray grazes an outline, rounding decides what it hits.
            if (found.t - wanted.t).abs() > ROUNDING * 100.0 || name(&a.names.shapes, &found) != name(&b.names.shapes, &wanted) {
                apart += 1;
                continue;
            }
            hits += 1;
            let (instance, mut copy) = (a.world.surface(&ray, &found), b.world.surface(&moved, &wanted));
            copy.point.p -= shift;
            copy.shadow_origin -= shift;
            assert_same(&instance, &copy, 100.0, seed);
        }
    }
    assert!(hits > SCENES * RAYS / 10, "{hits} hits");
    // Outlines within rounding, 10⁻⁵ of a distance of 100 m, are seen by about one ray in a thousand.
    assert!(apart < SCENES * RAYS / 500, "{apart} of {} rays", SCENES * RAYS);
}

/// Each instance has a number of its own, from 1, also within others, and leads to its own place.
#[test]
fn instances_are_numbered_one_by_one() {
    let row = |count: u32, step: f64| {
        (0..count).map(|i| json!({ "transform": [{ "translate": [f64::from(i) * step, 0, 0] }] })).collect::<Vec<_>>()
    };
    let ball = json!({ "type": "sphere", "radius": 0.25 });
    let groups = json!({
        "ball": [ball],
        "pair": [{ "type": "instances", "group": "ball", "placements": row(2, 1.0) }],
        "row": [{ "type": "instances", "group": "pair", "placements": row(3, 2.0) }, { "type": "sphere", "radius": 0.25, "center": [6, 0, 0] }],
    });
    let shapes = json!([
        { "type": "instances", "group": "ball" },
        { "type": "instances", "group": "row", "placements": row(2, 7.0), "transform": [{ "translate": [1, 0, 0] }] },
        { "type": "instances", "group": "pair", "transform": [{ "translate": [15, 0, 0] }] },
    ]);
    let world = world(&scene(groups, shapes));
    // ball, 2 × (row + 3 × (pair + 2 balls)), pair + 2 balls
    assert_eq!(world.instance_count(), 1 + 2 * (1 + 3 * (1 + 2)) + (1 + 2));
    let origin = world.origin();
    let number = |x: i32| {
        let ray = Ray::new((DVec3::new(x.into(), 5.0, 0.0) - origin).as_vec3(), Vec3::NEG_Y);
        let hit = world.intersect(&ray).expect("a ball");
        assert_near("top of the ball", world.surface(&ray, &hit).point.p, (DVec3::new(x.into(), 0.25, 0.0) - origin).as_vec3(), 1e-5, 0);
        hit.instance.expect("an instance").get()
    };
    let found: Vec<u32> = (0..17).map(number).collect();
    assert_eq!(found, [1, 4, 5, 7, 8, 10, 11, 2, 14, 15, 17, 18, 20, 21, 12, 23, 24]);
}
