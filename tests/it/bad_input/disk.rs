//! Disks that take nothing: said with exit code 5, and what can be written elsewhere is.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use super::bench::Bench;

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said() {
    let bench = Bench::new();
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
    for args in
        [&["check", "right.json"][..], &["right.json", "-q", "-o", "x.exr", "--stats"], &["list"], &["schema"], &["--help"], &["--version"]]
    {
        let output = Command::new(assert_cmd::cargo::cargo_bin("pt")).current_dir(bench.folder.path()).args(args).stdout(full()).output();
        let output = output.expect("it runs");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!((output.status.code(), said.as_str()), (Some(5), "error: stdout: No space left on device (os error 28)\n"), "{args:?}");
    }
}

/// The folder of the first of two pictures goes while they are rendered.
#[cfg(unix)]
#[test]
fn one_output_that_fails_does_not_take_the_other_with_it() {
    let bench = Bench::new();
    let at = bench.folder.path();
    fs::create_dir(at.join("gone")).expect("folder");
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("pt"))
        .current_dir(at)
        .args(["right.json", "-o", "gone/a.exr", "-o", "b.exr", "--time", "60", "--progress", "json"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines().map(|line| line.expect("text"));
    // It renders: the outputs have been checked.
    lines.find(|line| line.starts_with('{')).expect("progress");
    fs::remove_dir(at.join("gone")).expect("it is empty");
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    let said: Vec<String> = lines.filter(|line| !line.starts_with('{')).collect();
    assert_eq!(child.wait().expect("it ends").code(), Some(5), "{said:?}");
    assert_eq!(said, ["error: gone/a.exr: No such file or directory (os error 2)"]);
    assert!(at.join("b.exr").exists());
}
