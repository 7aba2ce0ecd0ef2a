//! Commands of transforms, checked by the intersection tests of the courses of dirt and darts.

use std::fs;
use std::process::Command;

/// Whether a ray along −z through (x, y) meets a quad of size 2, placed by `transform`, at this height and with this normal.
fn meets(transform: &str, [x, y]: [f64; 2], z: f64, normal: [f64; 3]) -> bool {
    let folder = tempfile::tempdir().expect("a folder");
    let (t, n) = (10.0 - z, format!("{normal:?}"));
    let test = format!(
        r#"{{ "type": "tests", "tests": [{{ "type": "intersection", "name": "quad", "surface": {{ "type": "quad", "size": 2, "transform": {transform} }},
            "ray": {{ "origin": [{x}, {y}, 10], "direction": [0, 0, -1] }}, "t": {t}, "p": [{x}, {y}, {z}], "gn": {n}, "sn": {n} }}] }}"#
    );
    fs::write(folder.path().join("tests.json"), &test).expect("a file");
    let output =
        Command::new(env!("CARGO_BIN_EXE_pt")).current_dir(folder.path()).args(["sample", "tests.json"]).output().expect("pt runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.is_empty(), "{test}: {said}");
    output.status.code() == Some(0)
}

const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// M = new · M: the last command of the list is applied last. The position of the quad's corner (1, 1) depends on the order.
#[test]
fn commands_act_in_listed_order() {
    assert!(meets(r#"[{ "translate": [1, 0, 2] }, { "scale": 3 }]"#, [5.9, 2.9], 6.0, UP));
    assert!(!meets(r#"[{ "translate": [1, 0, 2] }, { "scale": 3 }]"#, [6.1, 2.9], 6.0, UP));
    assert!(meets(r#"[{ "scale": 3 }, { "translate": [1, 0, 2] }]"#, [3.9, 2.9], 2.0, UP));
    assert!(!meets(r#"[{ "scale": 3 }, { "translate": [1, 0, 2] }]"#, [4.1, 2.9], 2.0, UP));
}

#[test]
fn each_command_does_what_it_says() {
    // Half a turn about the first diagonal of the plane swaps x and y; the normal turns over.
    let turned = [0.0, 0.0, -1.0];
    for transform in [
        r#"[{ "scale": [3, 1, 1] }, { "axis": [1, 1, 0], "angle": 180 }]"#,
        r#"[{ "scale": [3, 1, 1] }, { "rotate": [180, 1, 1, 0] }]"#,
        r#"{ "o": [0, 0, 0], "x": [0, 3, 0], "y": [1, 0, 0], "z": [0, 0, -1] }"#,
        r#"{ "matrix": [0, 1, 0, 0, 3, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1] }"#,
    ] {
        assert!(meets(transform, [0.9, 2.9], 0.0, turned), "{transform}");
        assert!(!meets(transform, [1.1, 0.0], 0.0, turned), "{transform}");
    }
    // The z axis is from − at, and the normal points along it.
    let slope = [0.0, 0.6, 0.8];
    assert!(meets(r#"{ "from": [0, 3, 4], "at": 0 }"#, [0.9, 3.0], 4.0, slope));
    assert!(meets(r#"{ "from": [0, 3, 4], "to": [0], "up": [0, 1, 0] }"#, [0.9, 3.0], 4.0, slope));
    // A single number stands for three equal ones.
    assert!(meets(r#"{ "translate": 2 }"#, [2.9, 2.9], 2.0, UP) && meets(r#"{ "translate": [2] }"#, [2.9, 2.9], 2.0, UP));
    assert!(meets(r#"{ "matrix": 2 }"#, [1.9, 1.9], 0.0, UP) && meets(r#"{ "matrix": [2] }"#, [1.9, -1.9], 0.0, UP));
    assert!(meets(r#"{ "o": [0, 0, 5] }"#, [0.9, 0.9], 5.0, UP) && meets(r#"[]"#, [0.9, 0.9], 0.0, UP));
}
