//! `--integrator auto` and `--sampler auto`: the choice is the better method where they differ much, and the picture is the one that the
//! chosen names give.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn pt(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pt")).current_dir(folder).args(args).args(["--progress", "none"]).output().expect("pt runs")
}

/// A matte floor, evenly lit by a small lamp that the camera does not see. Of paths that must hit it by chance, one in thousands does; paths
/// that sample it have so little noise that a few of them suffice to tell the two apart, however busy the machine is.
const SMALL_LAMP: &str = r#"{ "pt": 1, "camera": { "look_at": { "from": [0, 3, 6], "to": [0, 0, 0] }, "fov": 20 },
    "film": { "width": 40, "height": 30 }, "integrator": { "type": "path" },
    "shapes": [
        { "type": "quad", "size": [40, 40], "material": { "type": "diffuse" },
          "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }] },
        { "type": "sphere", "radius": 0.1, "emission": 50, "material": { "type": "diffuse" }, "transform": [{ "translate": [0, 2, 0] }] }
    ] }"#;

/// Asserts that two runs, each with its flags, write the same pixels and the same facts about them. Returns what the first one says.
fn same_picture(folder: &Path, a: &[&str], b: &dyn Fn(&str) -> Vec<String>) -> String {
    let run = |flags: &[&str], name: &str| {
        let files = [format!("{name}.pfm"), format!("{name}.exr")];
        let outputs = ["lamp.json", "--spp", "8", "--worst", "1", "-o", &files[0], "-o", &files[1]];
        let output = pt(folder, &[&outputs[..], flags].concat());
        let said = [output.stderr, output.stdout].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
        assert!(output.status.success(), "{said}");
        let info = Command::new(env!("CARGO_BIN_EXE_pt")).current_dir(folder).args(["image", "info", &files[1]]).output();
        let info = String::from_utf8_lossy(&info.expect("pt runs").stdout).into_owned();
        // The first line has the name of the file.
        let facts = info.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
        (fs::read(folder.join(&files[0])).expect("a picture"), facts, said)
    };
    let (pixels, facts, said) = run(a, "a");
    let others = b(&said);
    let (other_pixels, other_facts, _) = run(&others.iter().map(String::as_str).collect::<Vec<_>>(), "b");
    assert!(pixels == other_pixels, "{said}");
    assert_eq!(facts, other_facts, "{said}");
    said
}

/// `nee` replaces the scene's own `path`; the picture, its hash and the command for one sample are those of `nee` by name.
#[test]
fn the_cheaper_integrator_is_chosen_and_gives_its_own_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("lamp.json"), SMALL_LAMP).expect("a scene");
    let said = same_picture(folder.path(), &["-i", "auto"], &|_| vec!["-i".into(), "nee".into()]);
    assert!(said.contains("note: --integrator auto: nee"), "{said}");
    assert!(said.contains("lamp.json --integrator nee --spp 8"), "the commands name what was chosen: {said}");
}

/// The picture is that of the sampler which was chosen, whichever it is.
#[test]
fn a_sampler_is_chosen() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("lamp.json"), SMALL_LAMP).expect("a scene");
    let named = |said: &str| {
        let chosen = said.split("--sampler auto: ").nth(1).and_then(|rest| rest.split([';', ',']).next());
        ["-i", "nee", "--sampler", chosen.unwrap_or_else(|| panic!("{said}"))].map(str::to_owned).to_vec()
    };
    same_picture(folder.path(), &["-i", "nee", "--sampler", "auto"], &named);
}

/// An integrator that lacks an effect of the scene is no candidate, even if the scene names it: `path` meets no point light.
#[test]
fn integrators_that_lack_an_effect_are_no_candidates() {
    let folder = tempfile::tempdir().expect("a folder");
    let point = r#""lights": [{ "type": "point", "position": [0, 2, 0], "intensity": 5 }], "shapes": ["#;
    fs::write(folder.path().join("lamp.json"), SMALL_LAMP.replace(r#""shapes": ["#, point)).expect("a scene");
    let output = pt(folder.path(), &["lamp.json", "-i", "auto", "--spp", "4", "-o", "a.pfm"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("note: --integrator auto: nee") && !said.contains("path"), "{said}");
    assert!(output.status.success(), "{said}");
}

/// Parts must be of one method, which two runs might choose differently.
#[test]
fn parts_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("lamp.json"), SMALL_LAMP).expect("a scene");
    for (flag, value) in [("--shard", "1/2"), ("--samples", "0..4")] {
        let output = pt(folder.path(), &["lamp.json", "-i", "auto", flag, value]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.starts_with(&format!("error: auto with {flag}: another run may choose otherwise")), "{said}");
    }
}
