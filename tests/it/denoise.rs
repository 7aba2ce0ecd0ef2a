//! `pt image denoise`: the program gets the picture and its layers, and the result has no error bars.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use assert_cmd::Command;
use pt::output;

fn pt(folder: &Path, arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("pt").expect("built").current_dir(folder).args(arguments).output().expect("it runs")
}

/// A folder with a picture that has the layers, and a program that copies its first argument's file to that after `-o`, and lists its
/// arguments in the file `arguments`.
fn prepared(aov: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    fs::write(at.join("s.json"), r#"{"pt": 1, "camera": {"look_at": {"from": [0, 0, 4], "to": [0, 0, 0]}}, "shapes": [{"type": "sphere"}], "background": {"radiance": 1}}"#).expect("written");
    let render = ["s.json", "--size", "12x9", "--spp", "8", "-o", "noisy.exr", "-q"];
    let aov = if aov.is_empty() { vec![] } else { vec!["--aov", aov] };
    assert!(pt(at, &[&render[..], &aov].concat()).status.success());
    let script = "#!/bin/sh\necho \"$@\" > \"$(dirname \"$0\")/arguments\"\nwhile [ $# -gt 0 ]; do\n  case $1 in\n    --hdr) cp \"$2\" \"$(dirname \"$0\")/in.pfm\" ;;\n    -o) cp \"$(dirname \"$0\")/in.pfm\" \"$2\" ;;\n  esac\n  shift\ndone\n";
    fs::write(at.join("copy"), script).expect("written");
    fs::set_permissions(at.join("copy"), fs::Permissions::from_mode(0o755)).expect("allowed");
    folder
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A program that changes nothing: the colours are those of the picture, and the layers that it does not void are kept.
#[test]
fn the_program_gets_the_picture_and_its_layers() {
    let folder = prepared("albedo,n");
    let at = folder.path();
    let made = pt(at, &["image", "denoise", "noisy.exr", "--with", "./copy", "-o", "clean.exr", "-o", "clean.png"]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    assert!(text(&made.stderr).contains("no error is known"), "{}", text(&made.stderr));
    let arguments = fs::read_to_string(at.join("arguments")).expect("listed");
    assert!(["--hdr ", "--alb ", "--nrm ", "-o "].iter().all(|word| arguments.contains(word)), "{arguments}");
    let ((noisy, before), (clean, after)) =
        (output::read(&at.join("noisy.exr")).expect("a picture"), output::read(&at.join("clean.exr")).expect("a picture"));
    for name in ["R", "G", "B", "Albedo.R", "N.Z"] {
        assert_eq!(noisy.channel(name).expect("there"), clean.channel(name).expect("there"), "{name}");
    }
    let names: Vec<&str> = clean.channels.iter().map(|channel| channel.name.as_str()).collect();
    assert!(
        noisy.channel("StdErr.R").is_some() && names.iter().all(|name| !name.contains("StdErr") && !name.contains("SampleCount")),
        "{names:?}"
    );
    let has = |attributes: &output::Attributes, name: &str| attributes.iter().any(|(key, _)| key == name);
    assert!(has(&before, "pt/standardErrorFreedom") && !has(&after, "pt/standardErrorFreedom"));
    assert!(!has(&after, "pt/relativeError") && has(&after, "pt/relativeErrorRefused") && has(&after, "pt/denoisedWith"));
    assert!(at.join("clean.png").exists());
}

/// Without layers the program gets the colours alone, which is said. A command with words of its own gets these, in the places it says.
#[test]
fn missing_layers_are_said() {
    let folder = prepared("");
    let at = folder.path();
    let made = pt(at, &["image", "denoise", "noisy.exr", "--with", "./copy", "-o", "clean.exr"]);
    assert!(made.status.success() && text(&made.stderr).contains("no layer Albedo, no layer N"), "{}", text(&made.stderr));
    assert!(!fs::read_to_string(at.join("arguments")).expect("listed").contains("--alb"));
    let made = pt(at, &["image", "denoise", "noisy.exr", "--with", "cp {color} {output}", "-o", "own.exr"]);
    assert!(made.status.success() && !text(&made.stderr).contains("no layer"), "{}", text(&made.stderr));
    let made = pt(at, &["image", "denoise", "noisy.exr", "--with", "cp {albedo} {output}", "-o", "no.exr"]);
    assert_eq!(made.status.code(), Some(3));
    assert!(text(&made.stderr).contains("no layer Albedo, which {albedo} asks for"), "{}", text(&made.stderr));
}

/// Programs that are missing, fail, write nothing or something else end in one line, and no picture is written.
#[test]
fn failures_are_one_line() {
    let folder = prepared("");
    let at = folder.path();
    let cases = [
        ("no-such-denoiser", 5, "no-such-denoiser: "),
        ("sh -c 'echo it is broken >&2; exit 3'  {color}", 5, "sh: it ended with exit status: 3: it is broken"),
        ("true {color}", 5, "true: it wrote no picture to {output}"),
        ("cp s.json {output}", 5, "cp: it wrote no picture to {output}"),
        ("sh -c 'printf \"PF\\n1 1\\n-1.0\\n000000000000\" > {output}'", 5, "sh: its picture has another size"),
        ("a 'b", 2, "--with: a quote is not closed"),
        ("  ", 2, "--with: expected a program"),
    ];
    for (command, code, expected) in cases {
        let made = pt(at, &["image", "denoise", "noisy.exr", "--with", command, "-o", "clean.exr"]);
        let message = text(&made.stderr);
        assert_eq!(made.status.code(), Some(code), "{command}: {message}");
        assert!(message.lines().last().is_some_and(|line| line.starts_with("error: ") && line.contains(expected)), "{command}: {message}");
        assert!(!at.join("clean.exr").exists(), "{command}");
    }
}
