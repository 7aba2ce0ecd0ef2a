//! Faults of descriptions of distance fields, and their messages.

use pt::build::Source;
use pt::describe::{self, Files};

use crate::marked::{assert_fault, assert_faults, read, scene};

fn with(field: &str) -> String {
    scene(&format!(r#""shapes": [{{"type": "sdf", "field": {field}}}]"#))
}

#[test]
fn fields() {
    let cases = [
        (r#"{"type": ^"spher", "radius": 1}"#, r#"/shapes/0/field/type: unknown type "spher", did you mean "sphere"?"#),
        (r#"{"type": "sphere", "radius": ^0}"#, "/shapes/0/field/radius: expected a number above 0, found 0"),
        (r#"^{"type": "sphere"}"#, "/shapes/0/field: missing key \"radius\""),
        (r#"{"type": "union", "of": ^[]}"#, "/shapes/0/field/of: expected at least one field"),
        (
            r#"{"type": "difference", "from": {"type": "sphere", "radius": 1}, "minus": ^[]}"#,
            "/shapes/0/field/minus: expected at least one",
        ),
        (
            r#"{"type": "union", "of": [{"type": "box", "low": [0, 0, 0], "high": [1, ^0, 1]}]}"#,
            "/shapes/0/field/of/0/high/1: expected a number above 0, that of low, found 0",
        ),
        (
            r#"{"type": "box", "low": [0, 0, 0], "high": [1, 2, 3], "rounding": ^0.6}"#,
            "/shapes/0/field/rounding: expected at most 0.5, half the shortest side, found 0.6",
        ),
        (r#"^{"type": "segment", "from": [0, 0, 0], "to": [1, 0, 0]}"#, "/shapes/0/field: expected a \"radius\" above 0"),
        (r#"^{"type": "half_ring", "radius": 1}"#, "/shapes/0/field: expected a \"tube\" above 0"),
        (r#"{"type": "segment", "from": [1, 0, 0], "to": ^[1, 0, 0], "radius": 1}"#, "/shapes/0/field/to: from and to are the same"),
        (r#"{"type": "plane", "normal": ^[0, 0, 0]}"#, "/shapes/0/field/normal: expected a direction"),
        (
            r#"{"type": "extrude", "half_thickness": 1, "power": ^3, "of": {"type": "sphere", "radius": 1}}"#,
            "/shapes/0/field/power: expected 2, 4, 8, 16, 32 or 64, found 3",
        ),
        (r#"{"type": "repeat", "axis": ^"w", "period": 3, "of": {"type": "sphere", "radius": 1}}"#, "/shapes/0/field/axis: unknown"),
        (
            r#"{"type": "repeat", "axis": "x", "period": 3, "first": 2, "last": ^1, "of": {"type": "sphere", "radius": 1}}"#,
            "/shapes/0/field/last: the last copy, 1, comes before the first, 2",
        ),
        (
            r#"{"type": "place", "transform": [{"scale": ^[1, 0, 1]}], "of": {"type": "sphere", "radius": 1}}"#,
            "/shapes/0/field/transform/0/scale: the transform has no inverse",
        ),
    ];
    for (text, expected) in cases {
        assert_fault(&[(&with(text), expected)]);
    }
}

#[test]
fn solids() {
    let cases = [
        (r#"^{"type": "sdf"}"#, r#"/shapes/0: an sdf needs either "field" or "parts""#),
        (r#"{"type": "sdf", "parts": ^[]}"#, "/shapes/0/parts: expected at least one part"),
        (
            r#"{"type": "sdf", "parts": [{"field": {"type": "sphere", "radius": 1}, "material": ^"m"}]}"#,
            "/shapes/0/parts/0/material: unknown material \"m\"",
        ),
        (
            r#"{"type": "sdf", "field": {"type": "sphere", "radius": 1}, "bounds": {"low": [0, 0, 0], "high": [1, 1, ^-1]}}"#,
            "/shapes/0/bounds/high/2: expected a number above 0, that of low, found -1",
        ),
        (
            r#"{"type": "sdf", "field": {"type": "sphere", "radius": 1}, "march": {"stop": ^0, "most_steps": 9, "reach": 1, "normal_step": 1}}"#,
            "/shapes/0/march/stop: expected a number above 0, found 0",
        ),
    ];
    for (text, expected) in cases {
        assert_fault(&[(&scene(&format!(r#""shapes": [{text}]"#)), expected)]);
    }
    // All faults are reported at once, each with its position.
    assert_faults(
        &with(r#"{"type": "union", "of": [{"type": "sphere", "radius": ^-1}, {"type": "torus", "radius": ^0, "tube": 1}]}"#),
        &["/shapes/0/field/of/0/radius: expected", "/shapes/0/field/of/1/radius: expected"],
    );
}

/// Faults that are found only when the scene is built.
#[test]
fn faults_of_field_bounds_are_reported() {
    let build = |text: &str| {
        let root = describe::root(text.as_bytes(), "s").unwrap_or_else(|e| panic!("{e}"));
        let source = Source { root: &root, file: "s", files: &Files::within("") };
        pt::build::build(&read(text).unwrap_or_else(|e| panic!("{e:?}")), source).map(drop).map_err(|e| e.to_string())
    };
    let ball = r#"{"type": "sphere", "radius": 1}"#;
    let cases = [
        (r#"{"type": "plane", "normal": [0, 1, 0]}"#.to_owned(), "/shapes/0: the field has no end along x, y, z: give it \"bounds\""),
        (
            format!(r#"{{"type": "repeat", "axis": "x", "period": 3, "of": {ball}}}"#),
            "/shapes/0: the field has no end along x: give it \"bounds\"",
        ),
        (format!(r#"{{"type": "complement", "of": {ball}}}"#), "/shapes/0: the field has no end along x, y, z"),
        (
            format!(r#"{{"type": "repeat", "axis": "x", "period": 1.5, "first": 0, "last": 3, "of": {ball}}}"#),
            "/shapes/0/field/of: what is repeated must be no longer than the period",
        ),
        (
            format!(r#"{{"type": "intersection", "of": [{ball}, {{"type": "sphere", "radius": 1, "center": [0, 9, 0]}}]}}"#),
            "/shapes/0: nothing of the field lies within its bounds",
        ),
    ];
    for (field, expected) in cases {
        let found = build(&with(&field)).expect_err(&field);
        assert!(found.contains(expected) && found.starts_with("s:2:"), "{field}: {found}");
    }
    let bounded = r#""shapes": [{"type": "sdf", "field": {"type": "plane", "normal": [0, 1, 0]}, "bounds": {"low": [-1, -1, -1], "high": [1, 1, 1]}}]"#;
    assert_eq!(build(&scene(bounded)), Ok(()));
    // Non-uniform scales are taken into account.
    let stretched = r#""shapes": [{"type": "sdf", "field": {"type": "sphere", "radius": 1}, "transform": [{"scale": [1, 2, 3]}]}]"#;
    assert_eq!(build(&scene(stretched)), Ok(()));
}
