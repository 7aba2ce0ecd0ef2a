//! Disks that cannot be written to: reported with exit code 5. Other outputs are still written.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use super::bench::Bench;

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported() {
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

/// The folder of the first of two pictures is removed while they are rendered.
#[cfg(unix)]
#[test]
fn one_output_that_fails_does_not_take_the_other_with_it() {
    let bench = Bench::new();
    let at = bench.folder.path();
    fs::create_dir(at.join("gone")).expect("folder");
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("pt"))
        .current_dir(at)
        .args(["right.json", "-o", "gone/a.exr", "-o", "b.exr", "--spp", "4294967295", "--progress", "json"])
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines().map(|line| line.expect("text"));
    // The render has started, so that the outputs have been checked.
    lines.find(|line| line.starts_with('{')).expect("progress");
    fs::remove_dir(at.join("gone")).expect("it is empty");
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    let said: Vec<String> = lines.filter(|line| !line.starts_with('{')).collect();
    assert_eq!(child.wait().expect("it ends").code(), Some(5), "{said:?}");
    assert_eq!(said, ["error: gone/a.exr: No such file or directory (os error 2)"]);
    assert!(at.join("b.exr").exists());
}

/// A limit on the size of files is reported like a full disk, and leaves the old picture and nothing else.
#[cfg(target_os = "linux")]
#[test]
fn a_file_size_limit_is_reported() {
    let bench = Bench::new();
    let at = bench.folder.path();
    fs::write(at.join("x.pfm"), "old").expect("write");
    let before = fs::read_dir(at).expect("a folder").count();
    let pt = assert_cmd::cargo::cargo_bin("pt");
    for command in ["right.json --size 128x128 -q -o x.pfm", "image convert large.pfm -o x.pfm"] {
        fs::write(at.join("large.pfm"), [b"PF\n128 128\n-1.0\n".to_vec(), vec![0; 12 * 128 * 128]].concat()).expect("write");
        let limited = format!("ulimit -f 8 && exec {} {command}", pt.display());
        let output = Command::new("sh").args(["-c", &limited]).current_dir(at).output().expect("it runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), &*said), (Some(5), "error: x.pfm: File too large (os error 27)\n"), "{command}");
    }
    assert_eq!(fs::read(at.join("x.pfm")).expect("still there"), b"old");
    assert_eq!(fs::read_dir(at).expect("a folder").count(), before + 1, "large.pfm alone is new");
}

/// A picture can be written through a link and into a pipe, and the link and the pipe remain.
#[cfg(unix)]
#[test]
fn links_and_pipes_are_written_through() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let bench = Bench::new();
    let at = bench.folder.path();
    let render = |output: &str| {
        let output = bench.command().args(["right.json", "-q", "-o", output]).output().expect("it runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let done = (Some(0), String::new());
    assert_eq!(render("plain.pfm"), done);
    let picture = fs::read(at.join("plain.pfm")).expect("written");

    // A link, a link to that link from another folder, and a link to a file that does not exist yet.
    fs::write(at.join("real.pfm"), "old").expect("write");
    symlink("real.pfm", at.join("a.pfm")).expect("a link");
    symlink("../a.pfm", at.join("folder/b.pfm")).expect("a link");
    symlink(at.join("new.pfm"), at.join("c.pfm")).expect("a link");
    for (link, real) in [("a.pfm", "real.pfm"), ("folder/b.pfm", "real.pfm"), ("c.pfm", "new.pfm")] {
        fs::write(at.join("real.pfm"), "old").expect("write");
        assert_eq!(render(link), done);
        assert!(at.join(link).symlink_metadata().expect("there").is_symlink(), "{link} was replaced");
        assert!(!at.join(real).symlink_metadata().expect("there").is_symlink());
        assert_eq!(fs::read(at.join(real)).expect("written"), picture, "{link}");
    }
    let twice = bench.command().args(["right.json", "-o", "a.pfm", "-o", "real.pfm"]).output().expect("it runs");
    assert_eq!(twice.status.code(), Some(2));
    symlink("e.pfm", at.join("d.pfm")).expect("a link");
    symlink("d.pfm", at.join("e.pfm")).expect("a link");
    assert_eq!(render("d.pfm").0, Some(5));

    assert!(Command::new("mkfifo").arg(at.join("p.pfm")).status().expect("mkfifo runs").success());
    let reader = Command::new("cat").arg(at.join("p.pfm")).stdout(Stdio::piped()).spawn().expect("cat runs");
    assert_eq!(render("p.pfm"), done);
    assert_eq!(reader.wait_with_output().expect("it ends").stdout, picture);
    assert!(at.join("p.pfm").symlink_metadata().expect("there").file_type().is_fifo());
}
