//! Messages on stderr: none with -q, progress if loading takes long, and notes about pictures that are too dark or too bright.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Output, Stdio};

use tempfile::TempDir;

/// A ball in a white room, with emission `light`, and a lamp that faces away and so causes a warning.
fn scene(light: f64) -> String {
    format!(
        r#"{{"pt": 1, "camera": {{"look_at": {{"from": [0, 0, 3], "to": [0, 0, 0]}}}}, "film": {{"width": 16, "height": 16}},
        "sampler": {{"spp": 32}}, "shapes": [{{"type": "sphere"}},
        {{"type": "quad", "size": 0.1, "emission": {light}, "transform": [{{"translate": [0, 0, 5]}}]}}], "background": {{"radiance": {light}}}}}"#
    )
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("s.json"), scene(0.5)).expect("written");
    folder
}

fn pt(folder: &Path, args: &str) -> Output {
    let binary = assert_cmd::cargo::cargo_bin("pt");
    std::process::Command::new(binary).current_dir(folder).args(args.split_whitespace()).output().expect("a run")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Options that all commands share may also precede the command.
#[test]
fn shared_options_may_come_first() {
    let folder = folder();
    let after = pt(folder.path(), "check s.json -q --json-errors");
    assert!(after.status.success() && after.stderr.is_empty());
    for before in ["-q --json-errors check s.json", "--json-errors check -q s.json", "--quiet check s.json"] {
        let output = pt(folder.path(), before);
        assert_eq!((output.status, &output.stdout, &output.stderr), (after.status, &after.stdout, &after.stderr), "{before}");
    }
    // A scene needs no command: options with values stay together.
    for (file, words) in
        [("x.pfm", "-q s.json --spp 1 -o x.pfm"), ("y.pfm", "-q --spp 1 -o y.pfm s.json"), ("z.pfm", "-q -t 1 s.json --spp 1 -o z.pfm")]
    {
        let scene = pt(folder.path(), words);
        assert!(scene.status.success() && scene.stderr.is_empty() && folder.path().join(file).is_file(), "{words}: {}", stderr(&scene));
    }
}

/// Every command accepts -q and then prints nothing on stderr. Without -q most of these print something.
#[test]
fn every_command_respects_quiet() {
    let folder = folder();
    let at = folder.path();
    let mut remarks = 0;
    for (command, code) in [
        ("s.json -o a.exr", 0),
        ("s.json --seed 2 -o b.exr", 0),
        ("s.json --adaptive -o c.exr", 0),
        ("s.json --shard 1/2 -o 1.ptc", 0),
        ("s.json --shard 2/2 -o 2.ptc", 0),
        ("merge 1.ptc 2.ptc -o m.exr", 0),
        ("check s.json", 0),
        ("convert s.json t.json", 0),
        ("compare s.json --integrators nee,path --spp 4 --reference a.exr -o report", 0),
        ("verify s.json nee path --spp 32", 0),
        ("reference s.json --spp 4 --cache kept", 0),
        ("image diff a.exr b.exr", 0),
        ("image info a.exr", 0),
        ("image hash a.exr", 0),
        ("image convert a.exr -o a.png", 0),
        ("image average a.exr b.exr -o m.exr", 0),
        ("image falsecolor a.exr -o f.png", 0),
        ("sample hemisphere -n 4", 0),
        ("list samplers", 0),
        ("schema", 0),
    ] {
        let quiet = pt(at, &format!("{command} -q"));
        assert_eq!((quiet.status.code(), stderr(&quiet)), (Some(code), String::new()), "{command}");
        remarks += usize::from(!stderr(&pt(at, command)).is_empty());
    }
    assert!(remarks > 8, "{remarks} commands have something to say");
    // Errors are printed nevertheless.
    assert!(stderr(&pt(at, "check none.json -q")).starts_with("error: "));
}

/// The scene comes through a pipe, which the test fills only after it has read the first line of progress.
#[test]
fn slow_loading_is_announced() {
    let folder = folder();
    let binary = assert_cmd::cargo::cargo_bin("pt");
    let command = &mut std::process::Command::new(binary);
    let pipes = command.current_dir(folder.path()).args(["-", "-o", "x.exr"]).stdin(Stdio::piped()).stderr(Stdio::piped());
    let mut child = pipes.spawn().expect("it starts");
    let mut first = String::new();
    let mut said = BufReader::new(child.stderr.take().expect("a pipe"));
    said.read_line(&mut first).expect("a line");
    assert!(first.starts_with("loading stdin: ") && first.ends_with(" s so far\n"), "{first:?}");
    child.stdin.take().expect("a pipe").write_all(scene(0.5).as_bytes()).expect("it reads");
    said.lines().for_each(|line| drop(line.expect("text")));
    assert!(child.wait().expect("it ends").success());
}

/// With automatic exposure, light that is 2^k times as bright gives the same picture, up to one level of 8 bits, because stops are rounded
/// to tenths in f32.
#[test]
fn automatic_exposure_does_not_depend_on_brightness() {
    let folder = folder();
    let at = folder.path();
    let shown = |name: &str| image::open(at.join(name)).expect("a picture").to_rgb8().into_raw();
    let bytes = |light: f64, exposure: &str| {
        fs::write(at.join("s.json"), scene(light)).expect("written");
        let output = pt(at, &format!("s.json --exposure {exposure} -o x.png -o x.exr"));
        assert!(output.status.success(), "{}", stderr(&output));
        (shown("x.png"), stderr(&output))
    };
    let near = |a: &[u8], b: &[u8]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 1);
    let (expected, said) = bytes(0.5, "auto");
    assert!(said.contains("note: developed with --exposure "), "{said}");
    for k in [-30, -8, 3, 14] {
        assert!(near(&bytes(0.5 * 2f64.powi(k), "auto").0, &expected), "2^{k}");
    }
    // The exposure in the note gives the same picture if it is set by hand, and so does `pt image convert`.
    let stops = said.split("--exposure ").nth(1).and_then(|rest| rest.split_whitespace().next()).expect("stops").to_owned();
    assert!(bytes(0.5, &stops).0 == expected);
    assert!(pt(at, "image convert x.exr -o y.png --exposure auto").status.success());
    assert_eq!(shown("y.png"), expected);
    assert!(stderr(&pt(at, "s.json --exposure much")).contains("expected a number of stops, or auto"));
    for (options, said) in [
        ("--iso 100", "--shutter <SECONDS>"),
        ("--shutter 1/50", "--iso <ISO>"),
        ("--iso 100 --shutter 1/0 --f-number 8", "expected seconds such as 0.01 or 1/100"),
        ("--iso 0 --shutter 1 --f-number 8", "expected a number above 0"),
        ("--iso 100 --shutter 1 --f-number 8 --exposure 1", "cannot be used with"),
    ] {
        let output = pt(at, &format!("s.json -o x.png {options}"));
        assert!(output.status.code() == Some(2) && stderr(&output).contains(said), "{options}: {}", stderr(&output));
    }
}

/// A picture that is too dark or too bright causes a note that gives a better exposure.
#[test]
fn pictures_too_dark_or_too_bright_get_a_note() {
    let folder = folder();
    let at = folder.path();
    for (light, expected) in [(0.5, None), (1.0, None), (1e-3, Some("nearly black")), (100.0, Some("burnt out"))] {
        fs::write(at.join("s.json"), scene(light)).expect("written");
        let said = stderr(&pt(at, "s.json"));
        let told = ["nearly black", "burnt out"].into_iter().find(|word| said.contains(&format!("note: s.png is {word}: --exposure ")));
        assert_eq!(told, expected, "{said}");
        assert_eq!(said.contains("\n  pt image convert s.exr -o s.png --exposure auto\n"), expected.is_some(), "{said}");
        // There is no note if no 8-bit picture is written.
        assert!(!stderr(&pt(at, "s.json -o x.exr")).contains("--exposure"));
    }
}

/// Whole numbers are written without a decimal point.
#[test]
fn converted_scenes_have_whole_numbers() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("t.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
    assert!(pt(at, "convert t.obj t.json").status.success());
    let text = fs::read_to_string(at.join("t.json")).expect("a scene");
    assert!(text.contains("\"pt\": 1,") && text.contains("\"width\": 640,"), "{text}");
    let is_pointless = |word: &str| word.trim_matches(|c: char| "[],".contains(c)).ends_with(".0");
    assert!(!text.split_whitespace().any(is_pointless), "{text}");
    assert!(pt(at, "check t.json").status.success());
}
