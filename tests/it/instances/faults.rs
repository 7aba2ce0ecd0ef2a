//! What is wrong with groups and instances, and what they cannot be.

use glam::{DVec3, Vec3};
use pt::Error;
use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::math::Ray;
use pt::scene::Scene;
use serde_json::{Value, json};

use super::scene;
use crate::light_tracer::built;
use crate::marked::assert_fault_in_scene;

#[test]
fn groups_and_instances() {
    assert_fault_in_scene(&[
        (
            r#""groups": {"tree": []}, "shapes": [{"type": "instances", "group": ^"tre"}]"#,
            "/shapes/0/group: unknown group \"tre\", did you mean \"tree\"?",
        ),
        (
            r#""groups": {"a": [{"type": "instances", "group": "b"}], "b": [{"type": "group", "shapes": [{"type": "instances", "group": ^"a"}]}]}"#,
            "/groups/b/0/shapes/0/group: the group contains itself: a → b → a",
        ),
        (
            r#""groups": {"a": []}, "shapes": [{"type": "instances", "group": "a", "placements": [], "file": ^"p.ply"}]"#,
            "/shapes/0/file: give placements or a file with points, not both",
        ),
        (
            r#""groups": {"a": []}, "shapes": [{"type": "instances", "group": "a", "materials": ^["m"]}], "materials": {"m": {"type": "mirror"}}"#,
            "/shapes/0/materials: materials for the points of a file, but there is no \"file\"",
        ),
        (
            r#""groups": {"a": []}, "shapes": [{"type": "instances", "group": "a", "placements": [{"material": ^"m"}]}]"#,
            "/shapes/0/placements/0/material: unknown material \"m\"",
        ),
        (
            r#""groups": {"a": []}, "shapes": [{"type": "instances", "group": "a", "placements": [{"transform": [{"scale": ^0}]}]}]"#,
            "/shapes/0/placements/0/transform/0/scale: the transform has no inverse, because its determinant is 0",
        ),
        (
            r#""groups": {"a": [{"type": "sphere", "emission": 1}], "b": [{"type": "instances", "group": "a"}]},
               "shapes": [{"type": "instances", "group": "b", "material": ^{"type": "masked", "surface": {"type": "diffuse"}, "opacity": 0.5}}]"#,
            "/shapes/0/material: what emits can have no holes, and a shape of this group has \"emission\"",
        ),
    ]);
}

/// A group of nothing shows nothing; a group of lamps shows the lamps.
#[test]
fn groups_may_be_empty() {
    let instances =
        |group: &str| json!({ "type": "instances", "group": group, "placements": [{}, { "transform": [{ "translate": [3, 0, 0] }] }] });
    let groups =
        json!({ "nothing": [], "lamps": [{ "type": "sphere", "emission": 1 }], "both": [instances("nothing"), instances("lamps")] });
    let world = built(&scene(groups, json!([instances("nothing"), instances("lamps"), instances("both")])).to_string()).world;
    assert_eq!((world.instance_count(), world.lights().len()), (2 + 2 + 2 * (1 + 4), 2 + 2 * 2 + 1));
    let ray = Ray::new((DVec3::new(0.0, 9.0, 0.0) - world.origin()).as_vec3(), Vec3::NEG_Y);
    let hit = world.intersect(&ray).expect("a lamp");
    assert!(hit.instance.is_none() && world.surface(&ray, &hit).emission.is_some());
    let only_nothing = built(&scene(json!({ "nothing": [] }), json!([instances("nothing")])).to_string()).world;
    assert_eq!(only_nothing.intersect(&ray), None);
}

/// Groups, each of which shows the one before `copies` times; the first is `inner`.
fn chain(depth: usize, copies: usize, inner: Value) -> Value {
    let mut groups = json!({ "g0": [inner] });
    for level in 1..depth {
        let placements = vec![json!({}); copies];
        groups[format!("g{level}")] = json!([{ "type": "instances", "group": format!("g{}", level - 1), "placements": placements }]);
    }
    scene(groups, json!([{ "type": "instances", "group": format!("g{}", depth - 1) }]))
}

fn build(scene: &Value) -> pt::Result<Built> {
    let root = describe::root(scene.to_string().as_bytes(), "s.json")?;
    pt::build::build(&describe::read(&root, "s.json")?, Source { root: &root, file: "s.json", files: &Files::within("") })
}

/// Instances within instances cost no memory, so that 16⁷ of them are possible; what cannot be numbered, or would copy millions of lamps,
/// is refused with the exit code of limits, and what is nested too deeply is a fault.
#[test]
fn nesting_has_limits() {
    let ball = json!({ "type": "sphere" });
    let count = |copies: u64, levels: u32| (0..levels).map(|level| copies.pow(level)).sum::<u64>();
    let world = build(&chain(8, 16, ball.clone())).expect("a world").world;
    assert_eq!(u64::from(world.instance_count()), count(16, 8));
    assert!(matches!(build(&chain(8, 30, ball.clone())), Err(Error::Limit(_))), "30⁷ instances");
    let lamp = json!({ "type": "sphere", "emission": 1 });
    assert!(matches!(build(&chain(8, 16, lamp)), Err(Error::Limit(_))), "16⁷ lamps");
    let deep = build(&chain(9, 1, ball)).map(drop).expect_err("nine levels").to_string();
    assert!(deep.contains("/groups/g8: groups lie within each other deeper than 8"), "{deep}");
}

/// A ball of glass within another, and balls that overlap, are closed bodies, also as instances of one ball.
#[test]
fn glass_within_glass_is_no_open_glass() {
    let ball = json!([{ "type": "sphere", "material": { "type": "dielectric" } }]);
    for steps in [json!([{ "scale": -0.5 }]), json!([{ "scale": 0.5 }]), json!([{ "translate": [1, 0, 0] }])] {
        let instances = json!({ "type": "instances", "group": "ball", "placements": [{}, { "transform": steps }] });
        assert_eq!(built(&scene(json!({ "ball": ball }), json!([instances])).to_string()).warnings, Vec::<String>::new(), "{steps}");
    }
    // Glass that glows is copied.
    let lamp = json!([{ "type": "box", "material": { "type": "dielectric" }, "emission": 1 }]);
    let made = built(&scene(json!({ "lamp": lamp }), json!([{ "type": "instances", "group": "lamp" }])).to_string());
    assert_eq!((made.warnings, made.world.primitive_count()), (vec![], 6));
}

/// A group that nothing shows is warned of and not built, and so is one without placements.
#[test]
fn what_is_probably_a_mistake_is_said() {
    let lamp = json!({ "type": "disk", "emission": { "radiance": 1, "two_sided": true } });
    let unused = scene(json!({ "tree": [{ "type": "mesh", "file": "missing.ply" }] }), json!([lamp]));
    assert_eq!(built(&unused.to_string()).warnings, ["s.json: /groups/tree: no shape of type \"instances\" shows this group"]);
    let nothing = json!({ "type": "instances", "group": "lamp", "placements": [] });
    let warnings = built(&scene(json!({ "lamp": [lamp] }), json!([nothing, lamp])).to_string()).warnings;
    assert_eq!(warnings, ["s.json: /shapes/0: no placements: the group does not show"]);
}
