//! Warnings about lamps that face away from everything in the scene.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use pt::build::Source;
use pt::describe::{self, Files};

fn scene(lamp: &str, others: &str, camera: &str) -> String {
    format!(
        r#"{{"pt": 1, "camera": {camera}, "film": {{"width": 8, "height": 8}}, "sampler": {{"spp": 16}},
"shapes": [{lamp}{others}]}}"#
    )
}

/// Lamp at y = 2, which emits along +z rotated by the `steps`.
fn lamp(shape: &str, steps: &str, two_sided: bool) -> String {
    format!(
        r#"{{"type": {shape}, "emission": {{"radiance": 9, "two_sided": {two_sided}}}, "transform": [{steps}{{"translate": [0, 2, 0]}}]}}"#
    )
}

const UP: &str = r#"{"rotate": {"axis": [1, 0, 0], "degrees": -90}},"#;
const DOWN: &str = r#"{"rotate": {"axis": [1, 0, 0], "degrees": 90}},"#;
const FLOOR: &str = r#", {"type": "quad", "size": 4, "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}}]}"#;
const BALL: &str = r#", {"type": "sphere", "radius": 0.5, "center": [0, 1, 0]}"#;
const FROM_BELOW: &str = r#"{"fov": 90, "look_at": {"from": [0, 1, 3], "to": [0, 0.5, 0]}}"#;
const FROM_ABOVE: &str = r#"{"fov": 90, "look_at": {"from": [0, 5, 3], "to": [0, 1, 0]}}"#;
const AS_A_PLAN: &str = r#"{"type": "orthographic", "height": 4, "look_at": {"from": [0, 5, 0], "to": [0, 0, 0], "up": [0, 0, 1]}}"#;

/// Warnings of a scene about lamps.
fn warnings(text: &str) -> Vec<String> {
    let root = describe::root(text.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").unwrap_or_else(|e| panic!("{e}"));
    let source = Source { root: &root, file: "s.json", files: &Files::within("") };
    let built = pt::build::build(&described, source).unwrap_or_else(|e| panic!("{e}"));
    built.warnings.into_iter().filter(|warning| warning.contains("faces away")).collect()
}

fn is_black(folder: &Path, text: &str) -> bool {
    fs::write(folder.join("s.json"), text).expect("written");
    Command::cargo_bin("pt").expect("the binary").current_dir(folder).args(["s.json", "-q", "-o", "x.exr"]).assert().success();
    pt::output::exr::read(&folder.join("x.exr")).expect("a picture").0.pixels().flatten().all(|value| value == 0.0)
}

/// There is a warning exactly if the picture is black because of the lamp.
#[test]
fn a_lamp_that_lights_nothing_is_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    // Positions and sines that are not exact because of rounding.
    let odd = r#", {"type": "quad", "size": 4, "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}}, {"translate": [0, 2, 0]}]}"#;
    let tilted = r#"{"rotate": {"axis": [1, 0, 0], "degrees": -53}},"#;
    let mirrored = r#"{"scale": [1, 1, -1]}, {"rotate": {"axis": [1, 0, 0], "degrees": 90}},"#;
    for (shape, steps, two_sided, others, camera, expected) in [
        (r#""quad""#, UP, false, FLOOR, FROM_BELOW, true),
        (r#""disk""#, UP, false, FLOOR, FROM_BELOW, true),
        (r#""quad""#, DOWN, false, FLOOR, FROM_BELOW, false),
        (r#""quad""#, UP, true, FLOOR, FROM_BELOW, false),
        // A lamp that is mirrored along its normal emits in the opposite direction.
        (r#""quad""#, mirrored, false, FLOOR, FROM_BELOW, true),
        // A lamp in the plane of the ceiling, over the floor.
        (r#""quad""#, UP, false, &[FLOOR, odd].concat(), FROM_BELOW, true),
        // The floor extends in front of the lamp, or the camera sees it.
        (r#""quad""#, tilted, false, FLOOR, FROM_BELOW, false),
        (r#""quad""#, UP, false, FLOOR, FROM_ABOVE, false),
        (r#""quad""#, UP, false, FLOOR, AS_A_PLAN, false),
        (r#""quad""#, DOWN, false, FLOOR, AS_A_PLAN, false),
        (r#""disk""#, UP, false, BALL, FROM_BELOW, true),
        // A curved lamp always emits towards the scene with some part.
        (r#""sphere", "radius": 0.2"#, UP, false, FLOOR, FROM_BELOW, false),
    ] {
        let text = scene(&lamp(shape, steps, two_sided), others, camera);
        let told = warnings(&text);
        assert_eq!(told.len(), usize::from(expected), "{text}\n{told:?}");
        assert_eq!(is_black(folder.path(), &text), expected, "{text}");
        let place = "s.json:2:";
        assert!(
            told.iter()
                .all(|text| text.starts_with(place) && text.contains("/shapes/0/emission: ") && text.contains("\"two_sided\": true"))
        );
    }
}

/// For a black picture, the lamps that may emit to the wrong side are named.
#[test]
fn a_black_picture_names_its_one_sided_lamps() {
    let folder = tempfile::tempdir().expect("a folder");
    // The lamp lights a ball that the camera does not see.
    let others =
        r#", {"type": "sphere", "center": [0, 9, 0]}, {"type": "quad", "name": "floor", "transform": [{"translate": [0, 0, -9]}]}"#;
    let lamp = lamp(r#""quad", "name": "lamp", "size": 0.1"#, UP, false);
    fs::write(folder.path().join("s.json"), scene(&lamp, others, r#"{"look_at": {"from": [0, 0, 0], "to": [0, -1, 0], "up": [1, 0, 0]}}"#))
        .expect("written");
    let run =
        Command::cargo_bin("pt").expect("the binary").current_dir(folder.path()).args(["s.json", "-o", "x.exr"]).output().expect("a run");
    let text = String::from_utf8_lossy(&run.stderr);
    assert!(
        text.contains("warning: the image is black\nnote: lamp shines to one side only") && text.contains("\"two_sided\": true"),
        "{text}"
    );
}
