//! Files outside of the scene's folder: every command refuses them, and accepts them with `--allow-outside`.

use std::fs;
use std::process::Command;

use super::bench::SQUARE;

#[test]
fn every_command_that_loads_a_scene_asks_before_it_looks_outside() {
    let above = tempfile::tempdir().expect("a temporary folder");
    let folder = above.path().join("scenes");
    fs::create_dir(&folder).expect("folder");
    fs::write(above.path().join("mesh.obj"), format!("{SQUARE}f 1 2 3 4\n")).expect("write");
    image::RgbImage::from_pixel(2, 2, image::Rgb([99; 3])).save(above.path().join("p.png")).expect("write");
    let scene = r#"{"pt": 1, "camera": {}, "film": {"width": 8, "height": 6}, "sampler": {"spp": 1}, "background": {"radiance": 1},
"materials": {"m": {"type": "diffuse", "albedo": {"type": "image", "file": "../p.png"}}},
"shapes": [{"type": "mesh", "file": "../mesh.obj", "material": "m"}]}"#;
    fs::write(folder.join("scene.json"), scene).expect("write");
    let material = ["sample", "material", "scene.json#m", "--samples", "1000"];
    for (args, files) in [(&["scene.json", "-o", "x.exr"][..], 2), (&["check", "scene.json"], 2), (&material, 1)] {
        let run = |more: &[&str]| {
            let output = Command::new(assert_cmd::cargo::cargo_bin("pt")).current_dir(&folder).args(args).args(more).output();
            let output = output.expect("it runs");
            (output.status.code(), String::from_utf8(output.stderr).expect("text"))
        };
        let (code, said) = run(&[]);
        assert_eq!((code, said.lines().count()), (Some(3), files), "{args:?}: {said}");
        assert!(said.contains("scene.json:2:76: /materials/m/albedo/file: ../p.png: leads out of the scene file's folder"), "{said}");
        assert_eq!(fs::read_dir(&folder).expect("list").count(), 1, "nothing is written");
        let (code, said) = run(&["--allow-outside"]);
        assert_eq!(code, Some(0), "{args:?}: {said}");
        fs::read_dir(&folder)
            .expect("list")
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| !path.ends_with("scene.json"))
            .for_each(|path| fs::remove_file(path).expect("removed"));
    }
}
