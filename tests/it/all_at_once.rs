//! All mistakes of a scene, missing files among them, are reported at once, in helpful words.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use pt::describe;
use tempfile::TempDir;

use crate::marked::assert_fault_in_scene;

/// Text on stderr of a call, which must end with this exit code.
#[track_caller]
fn said(folder: &Path, code: i32, args: &[&str]) -> String {
    let output = Command::cargo_bin("pt").expect("the binary").current_dir(folder).args(args).output().expect("a run");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{args:?}\n{text}");
    text
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Lines of a scene: the correct line, the faulty line with a mark at its fault, and the message about it.
const LINES: [[&str; 3]; 8] = [
    [r#""camera": { "fov": 60 },"#, r#""camera": { "fov": ^180 },"#, "/camera/fov: expected an angle"],
    [
        r#""integrator": { "type": "nee", "max_depth": 3 },"#,
        r#""integrator": { "type": "nee", ^"max_deph": 3 },"#,
        "/integrator/max_deph: unknown key \"max_deph\", did you mean \"max_depth\"?",
    ],
    [
        r#""textures": { "t": { "type": "constant", "color": 1 } },"#,
        r#""textures": { "t": { "type": "image", "file": ^"none.png" } },"#,
        "/textures/t/file: none.png: no such file",
    ],
    [
        r#""materials": { "m": { "type": "diffuse" } },"#,
        r#""materials": { "m": { "type": "diffuse", "albedo": { "type": "image", "file": ^"parts" } } },"#,
        "/materials/m/albedo/file: parts: not a regular file",
    ],
    [
        r#""shapes": [ { "type": "quad" },"#,
        r#""shapes": [ { "type": "mesh", "file": ^"none.obj" },"#,
        "/shapes/0/file: none.obj: no such file",
    ],
    [r#"{ "type": "quad" },"#, r#"{ "type": "mesh", "file": ^"../a.obj" },"#, "/shapes/1/file: ../a.obj: leads out of"],
    [
        r#"{ "type": "group", "shapes": [] },"#,
        r#"{ "type": "group", "shapes": [{ "type": "mesh", "file": ^"no.ply" }] },"#,
        "/shapes/2/shapes/0/file: no.ply: no such file",
    ],
    [
        r#"{ "type": "disk", "material": "m" } ]"#,
        r#"{ "type": "disk", "material": ^"n" } ]"#,
        "/shapes/3/material: unknown material \"n\", did you mean \"m\"?",
    ],
];

/// Error messages for a scene in which the lines that `is_wrong` selects are wrong.
fn faults(folder: &Path, is_wrong: impl Fn(usize) -> bool) -> Vec<String> {
    let lines: Vec<&str> = LINES.iter().enumerate().map(|(i, [right, wrong, _])| if is_wrong(i) { *wrong } else { *right }).collect();
    fs::write(folder.join("s.json"), format!("{{ \"pt\": 1,\n{}\n}}", lines.join("\n").replace('^', ""))).expect("written");
    let code = if (0..LINES.len()).any(&is_wrong) { 3 } else { 0 };
    said(folder, code, &["check", "s.json"]).lines().filter(|line| line.starts_with("error")).map(str::to_owned).collect()
}

/// Each mistake has the same message alone and together with all others, and mistakes are reported in the order of the file.
#[test]
fn mistakes_of_all_kinds_are_reported_together() {
    let folder = folder();
    fs::create_dir(folder.path().join("parts")).expect("a folder");
    assert_eq!(faults(folder.path(), |_| false), [""; 0]);
    let together = faults(folder.path(), |_| true);
    assert_eq!(together.len(), LINES.len(), "{together:#?}");
    for (i, [_, marked, expected]) in LINES.iter().enumerate() {
        let column = marked.find('^').expect("a mark") + 1;
        assert!(together[i].starts_with(&format!("error: s.json:{}:{column}: {expected}", i + 2)), "{}\n{expected}", together[i]);
        assert_eq!(faults(folder.path(), |k| k == i), together[i..=i]);
    }
}

/// Mistakes inside of the files that a scene names are reported when those files are read, also all at once.
#[test]
fn unusable_files_are_reported_together() {
    let folder = folder();
    fs::write(folder.path().join("a.ply"), "nonsense").expect("written");
    fs::write(folder.path().join("b.png"), "nonsense").expect("written");
    let scene = r#"{ "pt": 1, "camera": {}, "shapes": [ { "type": "mesh", "file": "a.ply" },
        { "type": "disk", "material": { "type": "diffuse", "albedo": { "type": "image", "file": "b.png" } } } ] }"#;
    fs::write(folder.path().join("s.json"), scene).expect("written");
    let text = said(folder.path(), 3, &["check", "s.json"]);
    assert!(text.lines().count() == 2 && text.contains("a.ply: ") && text.contains("b.png: "), "{text}");
}

/// A missing file that an override on the command line names is reported as a mistake of the command line.
#[test]
fn a_missing_file_in_an_override_is_a_command_line_error() {
    let folder = folder();
    fs::write(folder.path().join("s.json"), r#"{ "pt": 1, "camera": {}, "shapes": [{ "type": "mesh", "file": "a.ply" }] }"#)
        .expect("written");
    let text = said(folder.path(), 2, &["check", "s.json", "-D", "/shapes/0/file=none.obj"]);
    assert_eq!(text, "error: -D /shapes/0/file=none.obj: /shapes/0/file: none.obj: no such file\n");
}

#[test]
fn a_missing_scene_suggests_a_similar_name() {
    let folder = folder();
    fs::create_dir(folder.path().join("scenes")).expect("a folder");
    fs::write(folder.path().join("scenes/cornell-box.json"), "").expect("written");
    for (wanted, near) in [
        ("scenes/cornel-box.json", "scenes/cornell-box.json"),
        ("scenes/cornell-box", "scenes/cornell-box.json"),
        ("scenes/Cornell-Box.json", "scenes/cornell-box.json"),
    ] {
        assert_eq!(said(folder.path(), 3, &[wanted]), format!("error: {wanted}: no such file, did you mean {near:?}?\n"));
    }
    for alone in ["scenes/furnace.json", "nowhere/cornell-box.json", "none"] {
        assert_eq!(said(folder.path(), 3, &[alone]), format!("error: {alone}: no such file\n"));
    }
}

/// Every word that pt suggests in place of another program's word exists in the scene format.
#[test]
fn suggested_keys_exist_in_the_scene_format() {
    let schema = describe::schema(&[pt::integrators::ALL]).as_value().to_string();
    for (other, own) in pt::reader::SYNONYMS {
        for own in *own {
            assert!(schema.contains(&format!("{own:?}")), "{other}: {own}");
        }
    }
}

#[test]
fn keys_of_other_programs_get_suggestions() {
    assert_fault_in_scene(&[
        (r#"^"image": {}"#, r#"/image: unknown key "image", did you mean "film"?"#),
        (r#""shapes": [{"type": ^"plane"}]"#, r#"/shapes/0/type: unknown type "plane", did you mean "quad"?"#),
        (r#""materials": {"m": {"type": ^"lambertian"}}"#, r#"/materials/m/type: unknown type "lambertian", did you mean "diffuse"?"#),
        (r#""materials": {"m": {"type": "diffuse", ^"color": 1}}"#, r#"/materials/m/color: unknown key "color", did you mean "albedo"?"#),
        (
            r##""materials": {"m": {"type": "diffuse", "albedo": ^"#ff0000"}}"##,
            r##"/materials/m/albedo: unknown texture "#ff0000"; a colour is written {"srgb": "#ff0000"}"##,
        ),
        (
            r##""textures": {"m": {"type": "checker", "even": ^"#f00"}}"##,
            r##"/textures/m/even: unknown texture "#f00"; a colour is written {"srgb": "#ff8000"}"##,
        ),
    ]);
    let camera = |keys: &str| format!(r#"{{"pt": 1, "camera": {{{keys}}}}}"#);
    crate::marked::assert_fault(&[
        (&camera(r#"^"origin": [0, 0, 1]"#), r#"/camera/origin: unknown key "origin", did you mean "look_at"?"#),
        (&camera(r#"^"target": [0, 0, 1]"#), r#"/camera/target: unknown key "target", did you mean "look_at"?"#),
        (
            &camera(r#""look_at": {"from": [0, 0, 1], "to": [0, 0, 0], ^"target": [0, 0, 0]}"#),
            r#"/camera/look_at/target: unknown key "target", did you mean "to"?"#,
        ),
    ]);
}
