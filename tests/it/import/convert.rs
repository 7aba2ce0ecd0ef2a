//! `pt convert`: the picture of the written scene has the same bits as that of the read scene.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn pt(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pt")).current_dir(folder).args(args).output().expect("pt runs")
}

/// Runs pt, which must succeed, and returns its stderr.
pub fn succeeds(folder: &Path, args: &[&str]) -> String {
    let output = pt(folder, args);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "pt {args:?}: {said}");
    said
}

/// Two scene files whose pictures have the same bits.
pub fn same_bits(folder: &Path, a: &str, b: &str) {
    let bits = |scene: &str| {
        succeeds(folder, &[scene, "--spp", "4", "-o", "picture.pfm", "--progress", "none", "--allow-outside"]);
        fs::read(folder.join("picture.pfm")).expect("a picture")
    };
    assert!(bits(a) == bits(b), "{a} and {b} differ");
}

const SCENE: &str = r#"{ "pt": 1, "camera": { "look_at": { "from": [0, 0, 3], "to": [0, 0, 0] } }, "film": { "width": 12, "height": 12 },
    "shapes": [{ "type": "mesh", "file": "parts/corner.obj", "material": { "type": "diffuse", "albedo": 0.1 } }],
    "background": { "radiance": [0.30000000000000004, 0.5, 1e-1] } }"#;

const CORNER: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0.1\nf 1 2 3\n";

fn scene(folder: &Path) {
    fs::create_dir_all(folder.join("parts")).expect("a folder");
    fs::write(folder.join("scene.json"), SCENE).expect("a scene");
    fs::write(folder.join("parts/corner.obj"), CORNER).expect("a mesh");
}

#[test]
fn what_is_written_renders_to_the_same_bits() {
    let folder = tempfile::tempdir().expect("a folder");
    scene(folder.path());
    fs::create_dir(folder.path().join("other")).expect("a folder");
    assert_eq!(succeeds(folder.path(), &["convert", "scene.json", "here.json"]), "");
    let said = succeeds(folder.path(), &["convert", "scene.json", "other/there.json"]);
    assert_eq!(said, "note: other/there.json names files outside of its folder: to render it, add --allow-outside\n");
    same_bits(folder.path(), "scene.json", "here.json");
    same_bits(folder.path(), "scene.json", "other/there.json");
    let there = fs::read_to_string(folder.path().join("other/there.json")).expect("a scene");
    assert!(there.contains(r#""file": "../parts/corner.obj""#), "{there}");
}

#[test]
fn overrides_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    scene(folder.path());
    succeeds(folder.path(), &["convert", "scene.json", "bright.json", "-D", "/background/radiance=2"]);
    let bright = fs::read_to_string(folder.path().join("bright.json")).expect("a scene");
    assert!(bright.contains(r#""radiance": 2"#), "{bright}");
}

#[test]
fn a_scene_is_not_overwritten_and_a_wrong_one_not_written() {
    let folder = tempfile::tempdir().expect("a folder");
    scene(folder.path());
    fs::write(folder.path().join("wrong.json"), r#"{ "pt": 1, "camera": {}, "shapes": 3 }"#).expect("a scene");
    for (args, code, says) in [
        (["convert", "scene.json", "./scene.json"], 2, "is the scene file"),
        (["convert", "scene.json", "out.txt"], 2, "expected a name that ends in .json"),
        (["convert", "scene.json", "none/out.json"], 5, "none/out.json: "),
        (["convert", "wrong.json", "out.json"], 3, "wrong.json:1:36: /shapes: expected"),
    ] {
        let output = pt(folder.path(), &args);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
        assert!(said.contains(says), "{args:?}: {said}");
        assert!(!folder.path().join("out.json").exists());
    }
}

/// `--environment FILE` is the scene with that picture as its background, wherever the file lies; `convert` takes the picture along.
#[test]
fn a_picture_of_the_surroundings_from_the_command_line_comes_with_the_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    scene(folder.path());
    fs::create_dir(folder.path().join("maps")).expect("a folder");
    // Any picture will do: here it is the scene itself, with its bright background.
    succeeds(folder.path(), &["scene.json", "--spp", "4", "-o", "maps/around.exr", "--progress", "none"]);
    succeeds(folder.path(), &["convert", "scene.json", "wanted.json", "-D", r#"/background={"image": "maps/around.exr"}"#]);
    succeeds(folder.path(), &["convert", "scene.json", "parts/given.json", "--environment", "maps/around.exr"]);
    assert!(folder.path().join("parts/given-files/environment/around.exr").is_file());
    same_bits(folder.path(), "wanted.json", "parts/given.json");
    let output = pt(folder.path(), &["check", "scene.json", "--environment", "maps/arounf.exr"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(said, "error: maps/arounf.exr: no such file, did you mean \"maps/around.exr\"?\n");
    assert_eq!(output.status.code(), Some(3));
    let output = pt(folder.path(), &["check", "scene.json", "--environment", "maps/around.exr", "--sky"]);
    assert_eq!(output.status.code(), Some(2), "two backgrounds");
}
