//! Names and contents of files with control characters, which messages must escape.

use std::process::Command;

use pt::film::{Channel, Image};
use pt::output::{Attributes, exr};
use serde_json::json;

/// Text that would clear the screen, ring the bell, reverse the direction of writing, and imitate a message.
const OBEYED: &str = "a\u{1b}[2J\u{7}\r\u{9b}31m\u{202e}\nerror: forged\u{7f}";

/// Files of scenes that contain this name in different places. All scenes are refused or cause a warning.
fn scenes(name: &str) -> Vec<Vec<(&'static str, Vec<u8>)>> {
    let scene = |more: serde_json::Value| {
        let mut scene = json!({"pt": 1, "camera": {}});
        scene.as_object_mut().expect("an object").extend(more.as_object().cloned().expect("an object"));
        vec![("scene.json", scene.to_string().into_bytes())]
    };
    let with = |key: &str, value: serde_json::Value| scene(json!({key: value}));
    let mesh = |file: &'static str, bytes: String| {
        let mut files = with("shapes", json!([{"type": "mesh", "file": file}]));
        files.push((file, bytes.into_bytes()));
        files
    };
    let diffuse = |albedo: serde_json::Value| json!({"type": "diffuse", "albedo": albedo});
    let gltf = json!({"asset": {"version": "2.0"}, "extensionsRequired": [name], "extensionsUsed": [name]}).to_string();
    let mut container = [b"glTF".to_vec(), vec![2, 0, 0, 0]].concat();
    let padded = gltf.clone() + &" ".repeat(gltf.len().next_multiple_of(4) - gltf.len());
    container.extend((20 + padded.len() as u32).to_le_bytes());
    container.extend((padded.len() as u32).to_le_bytes());
    container.extend(b"JSON");
    container.extend(padded.bytes());
    vec![
        with(name, json!(1)),
        with("materials", json!({name: diffuse(json!(2))})),
        with("materials", json!({name: {"type": name}})),
        with("textures", json!({name: {"type": "image", "file": name}})),
        with("shapes", json!([{"type": "sphere", "material": name}])),
        with("integrator", json!({"type": name})),
        with("integrator", json!({"type": "nee", name: 1})),
        with("shapes", json!([{"type": "mesh", "file": name}])),
        with("camera", json!({"fov": name})),
        mesh("a.ply", format!("ply\nformat ascii 1.0\n{}\nend_header\n", name.replace('\n', " "))),
        mesh("a.obj", format!("v 0 0 {}\n", name.replace('\n', " "))),
        vec![("scene.json", gltf.into_bytes())],
        vec![("scene.json", container)],
        vec![("scene.json", format!("{{\"pt\": 1, \"camera\": {name:?}").into_bytes())],
    ]
}

fn run(folder: &std::path::Path, args: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(assert_cmd::cargo::cargo_bin("pt")).current_dir(folder).args(args).output().expect("it runs");
    (output.status.code(), String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned())
}

/// Maximum number of characters of the messages about one scene: at most twenty faults, each with a file, a pointer and a message.
const MOST: usize = 20 * 3200;

#[test]
fn messages_about_scenes_are_escaped_and_bounded() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    for name in [OBEYED.to_owned(), "x".repeat(1_000_000), OBEYED.repeat(20_000)] {
        for (i, files) in scenes(&name).into_iter().enumerate() {
            files.iter().for_each(|(file, bytes)| std::fs::write(at.join(file), bytes).expect("write"));
            let (code, said) = run(at, &["check", "scene.json"]);
            assert_eq!(code, Some(3), "{i}: {}", said.chars().take(500).collect::<String>());
            assert!(said.len() < MOST, "{i}: {} bytes are said", said.len());
            let is_obeyed = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
            assert!(!said.contains(is_obeyed), "{i}: {said:?}");
            assert!(!said.lines().any(|line| line.starts_with("error: forged")), "{i}: {said}");
            let (_, json) = run(at, &["check", "scene.json", "--json-errors"]);
            assert!(json.len() < 3 * MOST, "{i}: {} bytes of JSON are said", json.len());
            let object: serde_json::Value = serde_json::from_str(&json).unwrap_or_else(|e| panic!("{i}: {e}"));
            assert_eq!(object["exit_code"], 3, "{i}");
        }
    }
}

#[test]
fn messages_about_pictures_are_escaped() {
    let folder = tempfile::tempdir().expect("a folder");
    let size = glam::UVec2::ONE;
    let channels = vec![Channel { name: OBEYED.into(), values: vec![1.0] }];
    let image = Image { full_size: size, origin: glam::UVec2::ZERO, size, channels };
    let attributes: Attributes = vec![(OBEYED.into(), OBEYED.into())];
    let bytes = exr::encode(&image, &attributes).expect("encoded");
    std::fs::write(folder.path().join("a.exr"), bytes).expect("write");
    let (code, said) = run(folder.path(), &["image", "info", "a.exr"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("\\u001b[2J") && !said.contains(|c: char| c.is_control() && c != '\n'), "{said:?}");
}
