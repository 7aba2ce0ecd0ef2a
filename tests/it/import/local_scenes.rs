//! All scenes of other programs in folders beside the project, if there are any: `cargo test --test it local_scenes -- --nocapture` prints
//! the list.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shared::shared;

/// Scene files of a folder and those within it, in order.
fn scenes(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    let is_scene = |path: &Path| path.extension().is_some_and(|e| ["json", "obj", "gltf", "glb"].iter().any(|known| e == *known));
    let within = |path: PathBuf| if path.is_dir() { scenes(&path) } else { Vec::from_iter(Some(path).filter(|path| is_scene(path))) };
    entries.into_iter().flat_map(within).collect()
}

/// Every scene whose files exist renders; the others say which file is missing. One scene is known to be malformed.
#[test]
fn every_available_scene_renders() {
    let target = tempfile::tempdir().expect("a folder");
    let picture = target.path().join("picture.pfm");
    let mut wrong = vec![];
    for folder in ["aalto", "dirt", "darts", "models"].map(shared).into_iter().flatten() {
        for scene in scenes(&folder) {
            let is_tests = scene.ends_with("test_materials.json");
            let mut pt = Command::new(env!("CARGO_BIN_EXE_pt"));
            let pt = if is_tests {
                pt.arg("sample").arg(&scene).arg("-o").arg(target.path().join("t"))
            } else {
                pt.arg(&scene).arg("-o").arg(&picture)
            };
            let size = ["--size", "32x24", "--spp", "1", "--progress", "none", "--allow-outside"];
            let output = if is_tests { pt.output() } else { pt.args(size).output() }.expect("pt runs");
            let said = String::from_utf8_lossy(&output.stderr);
            let error = said.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
            let (is_missing, is_malformed) = (error.contains("no such file"), scene.ends_with("transparent_test.json"));
            let outcome = match output.status.code() {
                Some(0) if is_tests => "its tests pass",
                Some(0) => "renders",
                Some(3) if is_missing || is_malformed => error,
                code => {
                    wrong.push(format!("{}: {code:?} {said}", scene.display()));
                    error
                }
            };
            println!("{}  {outcome}", scene.strip_prefix(folder.parent().unwrap_or(&folder)).unwrap_or(&scene).display());
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
