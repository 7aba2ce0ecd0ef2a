//! Faults of the surroundings: processes that are killed or stopped, memory and disks that end, folders that vanish. Saved progress stays
//! whole, and a picture that is written is right.
//!
//! More of them: `parts/program.rs` (signals and saved progress), `bad_input/disk.rs` (outputs), `fatal_errors.rs` (panics).

#![cfg(unix)]

mod folders;
mod kills;
mod limits;
mod soak;
mod stops;

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use pt::output::{exr, hash};
use tempfile::TempDir;

/// A ball on a triangle from a file, under a lamp and a sky.
const SCENE: &str = r#"{
  "pt": 1,
  "camera": { "look_at": { "from": [0, 1, 4], "to": [0, 0, 0] } },
  "film": { "width": 24, "height": 16 },
  "shapes": [{ "type": "sphere" }, { "type": "mesh", "file": "a.obj" }],
  "lights": [{ "type": "point", "position": [0, 3, 1], "intensity": 9 }],
  "background": { "radiance": 0.2 }
}"#;

/// The exit codes of the README, other than those of a bug and of signals.
const DOCUMENTED: [i32; 7] = [0, 1, 2, 3, 4, 5, 7];

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("s.json"), SCENE).expect("write");
    std::fs::write(folder.path().join("a.obj"), "v -2 -1 -2\nv 2 -1 -2\nv 0 -1 2\nf 1 3 2\n").expect("write");
    folder
}

/// `pt` with these words, on one thread, in a folder.
fn command(folder: &Path, args: &str) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("pt"));
    command.current_dir(folder).args(args.split_whitespace()).env("PT_THREADS", "1").stdin(Stdio::null()).env_remove("RUST_BACKTRACE");
    command
}

/// Runs `pt` with these words from a shell that has set a limit, or redirected something.
fn shell(folder: &Path, before: &str, args: &str, after: &str) -> Output {
    let pt = assert_cmd::cargo::cargo_bin("pt");
    let line = format!("{before} exec {} {args} {after}", pt.display());
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(folder).env("PT_THREADS", "1").env_remove("RUST_BACKTRACE");
    command.output().expect("it runs")
}

#[track_caller]
fn done(folder: &Path, args: &str) {
    let output = command(folder, args).output().expect("it runs");
    assert!(output.status.success(), "{args}: {}", said(&output));
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn picture(folder: &Path, name: &str) -> String {
    hash(&exr::read(&folder.join(name)).unwrap_or_else(|e| panic!("{e}")).0).to_string()
}

/// Waits until something holds; fails after a time in which it always does.
#[track_caller]
fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < Duration::from_secs(60), "waited in vain until {what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status();
    assert!(status.expect("kill").success());
}
