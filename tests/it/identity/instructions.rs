//! The picture does not depend on the instruction set of the processor.

use std::fs;
use std::path::Path;

use assert_cmd::Command;

/// `PT_SIMD=sse2` selects the simplest instructions, `PT_LANES=1` single paths. No bit of any scene's picture changes.
#[test]
fn instruction_sets_agree() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = |scene: &Path, set: &str, lanes: &str| {
        let mut pt = Command::cargo_bin("pt").expect("the binary");
        let run = pt.env("PT_SIMD", set).env("PT_LANES", lanes).args(["--size", "32x24", "--spp", "4", "-q", "--progress", "none", "-o"]);
        run.arg(folder.path().join("picture.pfm")).arg(scene).assert().success();
        fs::read(folder.path().join("picture.pfm")).expect("a picture")
    };
    let scenes = fs::read_dir("scenes").expect("scenes").map(|entry| entry.expect("an entry").path());
    for scene in scenes.filter(|path| path.extension().is_some_and(|extension| extension == "json")) {
        let wanted = picture(&scene, "sse2", "");
        for (set, lanes) in [("avx2", "1"), ("avx2", "8"), ("", "")] {
            assert!(picture(&scene, set, lanes) == wanted, "{}, PT_SIMD={set}, PT_LANES={lanes}", scene.display());
        }
    }
}
