//! A render that needs more memory than is available is refused before it starts, with exit code 4.

use std::process::Command;

use super::bench::Bench;

/// The picture needs 4000² pixels of 260 bytes, and the process is limited to 2 GB.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_that_does_not_fit_is_refused() {
    let bench = Bench::new();
    let pt = assert_cmd::cargo::cargo_bin("pt");
    let limited = format!("ulimit -v 2000000 && exec {} right.json --size 4000x4000 -t 1 -o x.exr", pt.display());
    let output = Command::new("sh").args(["-c", &limited]).current_dir(bench.folder.path()).output().expect("it runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert!(said.starts_with("error: --size 4000x4000: /film/width: the picture needs 4 GiB of memory, "), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(!bench.folder.path().join("x.exr").exists());
}
