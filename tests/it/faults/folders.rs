//! Folders that may not be written to, or vanish during a render.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::Stdio;

use super::{command, done, folder, picture, said, wait_until};

/// A folder without the permission to write refuses a render before it begins. Skipped where permissions do not count, as for root.
#[test]
fn a_read_only_folder_is_refused_at_once() {
    let folder = folder();
    let at = folder.path();
    let shut = at.join("shut");
    fs::create_dir(&shut).expect("folder");
    fs::set_permissions(&shut, fs::Permissions::from_mode(0o555)).expect("permissions");
    if fs::File::create(shut.join("x")).is_ok() {
        eprintln!("skipped: permissions do not count here");
        return;
    }
    for outputs in ["-o shut/x.exr", "-o x.exr -o shut/x.ptc", "-o shut/x.exr --checkpoint 1h"] {
        let output = command(at, &format!("s.json --spp 4294967295 {outputs}")).output().expect("it runs");
        assert_eq!(output.status.code(), Some(5), "{outputs}: {}", said(&output));
        assert!(said(&output).contains("Permission denied") && said(&output).lines().count() == 1, "{outputs}: {}", said(&output));
        assert!(!at.join("x.exr").exists());
    }
}

/// A folder for the state that vanishes is told once in a while, and used again when it is back. The picture is right.
#[test]
fn a_folder_that_vanishes_and_comes_back() {
    let folder = folder();
    let at = folder.path();
    let states = at.join("states");
    fs::create_dir(&states).expect("folder");
    let line = "s.json --spp 4294967295 -o states/x.ptc -o x.exr --checkpoint 0.001 --progress none";
    let child = command(at, line).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().expect("it starts");
    let state = states.join("x.ptc");
    wait_until("there is a state", || state.exists());
    // A state may be written into the folder while it is emptied.
    wait_until("the folder is gone", || fs::remove_dir_all(&states).is_ok() && !states.exists());
    // Longer than a wave of samples takes on a busy machine, so that a state is due meanwhile.
    std::thread::sleep(std::time::Duration::from_millis(500));
    fs::create_dir(&states).expect("folder");
    wait_until("there is a state again", || state.exists());
    super::send("INT", &child);
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130), "{}", said(&output));
    assert!(said(&output).contains("warning: no checkpoint: states/x.ptc: "), "{}", said(&output));
    let samples = pt::part::Stored::open(&state).unwrap_or_else(|e| panic!("{e}")).ranges()[0].end;
    done(at, &format!("s.json --spp {samples} -q -o whole.exr"));
    assert_eq!(picture(at, "x.exr"), picture(at, "whole.exr"));
}

/// The scene and its mesh are read once: what becomes of them later changes nothing.
#[test]
fn a_scene_that_vanishes_during_its_render() {
    let folder = folder();
    let at = folder.path();
    let child = command(at, "s.json --spp 4294967295 -q -o x.exr -o x.ptc --checkpoint 0.001").spawn().expect("it starts");
    wait_until("there is a state", || at.join("x.ptc").exists());
    for name in ["s.json", "a.obj"] {
        fs::rename(at.join(name), at.join(format!("{name}.away"))).expect("renamed");
    }
    super::send("INT", &child);
    assert_eq!(child.wait_with_output().expect("it ends").status.code(), Some(130));
    for name in ["s.json", "a.obj"] {
        fs::rename(at.join(format!("{name}.away")), at.join(name)).expect("renamed");
    }
    let samples = pt::part::Stored::open(&at.join("x.ptc")).unwrap_or_else(|e| panic!("{e}")).ranges()[0].end;
    done(at, &format!("s.json --spp {samples} -q -o whole.exr"));
    assert_eq!(picture(at, "x.exr"), picture(at, "whole.exr"));
}
