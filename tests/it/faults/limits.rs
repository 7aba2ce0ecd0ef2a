//! Limits of memory, of files and of their size, set by the shell (`ulimit`).

use std::fs;

use pt::part::Stored;

use super::{DOCUMENTED, done, folder, picture, said, shell};

/// From a limit at which the program is hardly loaded to one at which the render runs: it runs, or it says that memory is lacking. It is
/// never ended by a signal, and never calls that a bug.
#[cfg(target_os = "linux")]
#[test]
fn any_limit_of_memory() {
    let folder = folder();
    let at = folder.path();
    let line = "s.json --spp 4 -q -t 2 -o x.exr -o x.png --checkpoint 1h";
    done(at, line);
    let whole = picture(at, "x.exr");
    let mut codes = vec![];
    for kib in (10_000..100_000).step_by(1000) {
        fs::remove_file(at.join("x.exr")).ok();
        let output = shell(at, &format!("ulimit -v {kib};"), line, "");
        let (code, said) = (output.status.code(), said(&output));
        // Below that the system does not start it: the kernel ends it, or its libraries do not fit.
        let is_started = code.is_some_and(|code| code < 126);
        assert!(is_started || codes.is_empty() || codes == [4], "{kib} KiB: {code:?} {said}");
        match code {
            Some(0) => assert_eq!(picture(at, "x.exr"), whole, "{kib} KiB"),
            Some(4) => assert!(said.starts_with("error: ") && said.lines().count() == 1, "{kib} KiB: {said}"),
            _ => assert!(!is_started, "{kib} KiB: {code:?} {said}"),
        }
        codes.extend(code.filter(|code| is_started && codes.last() != Some(code)));
    }
    assert_eq!(codes.last(), Some(&0), "{codes:?}");
}

/// A limit on the number of open files.
#[cfg(target_os = "linux")]
#[test]
fn any_limit_of_open_files() {
    let folder = folder();
    let at = folder.path();
    let line = "s.json --spp 4 -q -o x.exr -o x.png --checkpoint 1h";
    done(at, line);
    let whole = picture(at, "x.exr");
    for files in 3..12 {
        fs::remove_file(at.join("x.exr")).ok();
        let output = shell(at, &format!("ulimit -n {files};"), line, "");
        let (code, said) = (output.status.code().unwrap_or(-1), said(&output));
        // 127: the libraries of the program could not be opened.
        assert!(code == 127 || DOCUMENTED.contains(&code), "{files} files: {code} {said}");
        assert_eq!(code == 0, at.join("x.exr").exists(), "{files} files: {said}");
        if code == 0 {
            assert_eq!(picture(at, "x.exr"), whole, "{files} files");
        }
    }
}

/// Where the state is larger than a file may be, the old state stays, the smaller picture is written, and the end is told.
#[cfg(target_os = "linux")]
#[test]
fn a_state_that_is_too_large_leaves_the_old_one() {
    let folder = folder();
    let at = folder.path();
    done(at, "s.json --size 160x128 --spp 4 -q -o x.png --checkpoint 1h");
    // A pixel has 8 numbers, two of which are means of three colours and powers of them: 53 digits that look like noise.
    let old = fs::read(at.join("x.ptc")).expect("written");
    assert!(old.len() > 100 * 1024);
    fs::remove_file(at.join("x.png")).expect("there");
    // In units of 512 bytes or of 1 KiB, as the shell has it.
    let line = "s.json --size 160x128 --spp 8 --resume -o x.png --checkpoint 0.001";
    let output = shell(at, "ulimit -f 100;", line, "");
    let told = said(&output);
    assert_eq!(output.status.code(), Some(5), "{told}");
    assert!(told.lines().any(|line| line == "error: x.ptc: File too large (os error 27)"), "{told}");
    assert_eq!(fs::read(at.join("x.ptc")).expect("still there"), old);
    assert!(at.join("x.png").exists(), "{told}");
    let left: Vec<_> = fs::read_dir(at).expect("a folder").map(|entry| entry.expect("an entry").file_name()).collect();
    assert_eq!(left.len(), 4, "{left:?}");
    done(at, "s.json --size 160x128 --spp 8 --resume -q -o x.exr -o x.ptc");
    done(at, "s.json --size 160x128 --spp 8 -q -o whole.exr");
    assert_eq!(picture(at, "x.exr"), picture(at, "whole.exr"));
    assert_eq!(Stored::open(&at.join("x.ptc")).unwrap_or_else(|e| panic!("{e}")).ranges()[0], 0..8);
}

/// A disk that is full, in the place of an output.
#[cfg(target_os = "linux")]
#[test]
fn outputs_on_a_full_disk() {
    let folder = folder();
    let at = folder.path();
    for extension in ["exr", "png", "pfm", "hdr", "ppm", "ptc"] {
        std::os::unix::fs::symlink("/dev/full", at.join(format!("full.{extension}"))).expect("a link");
        let output = shell(at, "", &format!("s.json --spp 4 -q -o full.{extension} -o ok-{extension}.exr"), "");
        let expected = format!("error: full.{extension}: No space left on device (os error 28)\n");
        assert_eq!((output.status.code(), said(&output)), (Some(5), expected));
        assert!(at.join(format!("ok-{extension}.exr")).exists(), "{extension}: the other output is written");
    }
}
