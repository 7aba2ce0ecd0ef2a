//! `pt farm`: the files that it writes are run by the engines themselves, and the picture has the bits of one render.
//!
//! Engines that are not installed are skipped, which is told; `PT_REQUIRE_FARM=1` makes that a failure. The script for Slurm meets a stand-in
//! for `sbatch`, which runs the jobs at once, and with `PT_SLURM=1` the cluster that `SLURM_CONF` names: `.ci/slurm` starts one.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use pt::output::{Attributes, exr, hash};
use tempfile::TempDir;

const SCENE: &str = r#"{
  "pt": 1,
  "camera": { "look_at": { "from": [0, 1, 4], "to": [0, 0, 0] } },
  "film": { "width": 16, "height": 12 },
  "sampler": { "spp": 24 },
  "shapes": [{ "type": "sphere" }],
  "lights": [{ "type": "point", "position": [0, 3, 1], "intensity": 9 }],
  "background": { "radiance": 0.2 }
}"#;

/// A name with all that a shell, a template or GNU parallel might take for something else.
const ODD: &str = "it's {} {{x}} $HOME #1 %.json";

/// A name for the test of make, in whose rules names have no quotes: without the characters that make itself would read as its own.
const ODD_FOR_MAKE: &str = "a $HOME #1.json";

fn folder(scene: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join(scene), SCENE).expect("write");
    folder
}

fn program() -> std::path::PathBuf {
    assert_cmd::cargo::cargo_bin("pt")
}

fn pt(folder: &Path, args: &[&str]) -> Output {
    Command::new(program()).current_dir(folder).args(args).env_remove("PT_THREADS").output().expect("it runs")
}

#[track_caller]
fn succeeded(output: &Output) -> String {
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{said}");
    said
}

/// Hash and attributes of a picture.
fn picture(path: &Path) -> (String, Attributes) {
    let (image, attributes) = exr::read(path).unwrap_or_else(|e| panic!("{e}"));
    (hash(&image).to_string(), attributes)
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).expect("a folder").map(|e| e.expect("entry").file_name().to_string_lossy().into()).collect();
    names.sort();
    names
}

/// Whether a program can be started and says this of itself; where it cannot, that is told.
fn is_installed(program: &str, says: &str) -> bool {
    let output = Command::new(program).arg("--help").stdin(Stdio::null()).output();
    let found = output.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains(says));
    assert!(found || std::env::var_os("PT_REQUIRE_FARM").is_none(), "{program} is not installed");
    if !found {
        eprintln!("skipped: {program} is not installed");
    }
    found
}

/// Options whose values need quotes, and are part of every job.
const OPTIONS: [&str; 8] = ["--size", "20x15", "-D", r#"/background={"radiance":[0.2, 0.1, 0.3]}"#, "--seed", "5", "--exposure", "0.5"];

/// Writes the file of an engine, runs it, and compares the picture with that of one render.
#[track_caller]
fn farmed(engine: &str, scene: &str, run: impl Fn(&Path) -> Output) -> TempDir {
    let folder = folder(scene);
    let at = folder.path();
    succeeded(&pt(at, &[&[scene, "-o", "whole.exr", "-o", "whole.png"][..], &OPTIONS].concat()));
    let outputs = ["-o", "the picture.exr", "-o", "the picture.png"];
    succeeded(&pt(at, &[&["farm", scene, "--shards", "3", "--for", engine, "--file", "farm"][..], &OPTIONS, &outputs].concat()));
    succeeded(&run(at));
    assert_eq!(picture(&at.join("the picture.exr")), picture(&at.join("whole.exr")), "{engine}");
    let bytes = |name: &str| fs::read(at.join(name)).expect("written");
    assert!(bytes("the picture.png") == bytes("whole.png"), "{engine}: developed in another way");
    let parts = names(at).iter().filter(|name| name.ends_with("-of-3.ptc")).count();
    assert_eq!(parts, 3, "{:?}", names(at));
    folder
}

/// Runs a file that an engine's own program reads.
fn run(at: &Path, words: &[&str]) -> Output {
    Command::new(words[0]).args(&words[1..]).current_dir(at).env("PT", program()).env_remove("PARALLEL").output().expect("it runs")
}

#[cfg(unix)]
#[test]
fn make_renders_the_shards() {
    if is_installed("make", "make") {
        for scene in ["s.json", ODD_FOR_MAKE] {
            let folder = farmed("make", scene, |at| run(at, &["make", "-f", "farm", "-j", "2"]));
            let said = succeeded(&run(folder.path(), &["make", "-f", "farm"]));
            assert!(said.contains("up to date"), "{said}");
        }
    }
}

#[cfg(unix)]
#[test]
fn parallel_renders_the_shards() {
    if is_installed("parallel", "GNU") {
        for scene in ["s.json", ODD] {
            farmed("parallel", scene, |at| run(at, &["bash", "farm"]));
        }
    }
}

#[cfg(unix)]
#[test]
fn openjd_renders_the_shards() {
    if is_installed("openjd", "openjd") {
        for scene in ["s.json", ODD] {
            let parameter = format!("Pt={}", program().display());
            farmed("openjd", scene, |at| {
                fs::copy(at.join("farm"), at.join("template.yaml")).expect("copied");
                run(at, &["openjd", "run", "template.yaml", "-p", &parameter])
            });
        }
    }
}

/// `sbatch` that runs the jobs at once: all indices of an array, and then what depends on it.
const SBATCH: &str = r#"#!/bin/bash
set -e
job=$(mktemp)
cat > "$job"
for word in "$@"; do
    case $word in
        --array=1-*) last=${word#--array=1-} ;;
        --dependency=afterok:*) test "$word" = --dependency=afterok:17 ;;
        --parsable | --job-name=* | --requeue | --kill-on-invalid-dep=yes | --time=5) ;;
        *) echo "unknown: $word" >&2; exit 1 ;;
    esac
done
if [ -n "$last" ]; then
    for ((i = 1; i <= last; i++)); do SLURM_ARRAY_TASK_ID=$i bash "$job" >&2; done
else
    bash "$job" >&2
fi
echo 17
"#;

#[cfg(unix)]
#[test]
fn slurm_gets_an_array_and_a_merge() {
    use std::os::unix::fs::PermissionsExt;
    for scene in ["s.json", ODD] {
        farmed("slurm", scene, |at| {
            fs::create_dir(at.join("bin")).expect("a folder");
            fs::write(at.join("bin/sbatch"), SBATCH).expect("write");
            fs::set_permissions(at.join("bin/sbatch"), fs::Permissions::from_mode(0o755)).expect("allowed");
            let path = format!("{}:{}", at.join("bin").display(), std::env::var("PATH").expect("a path"));
            let command = &mut Command::new("bash");
            command.args(["farm", "--time=5"]).current_dir(at).env("PT", program()).env("PATH", path).output().expect("it runs")
        });
    }
}

/// The jobs of a cluster: an array of shards and the merge that waits for it.
#[cfg(unix)]
#[test]
fn a_cluster_of_slurm_renders_the_shards() {
    // Nobody's cluster gets jobs of a test unasked.
    if std::env::var_os("PT_SLURM").is_none() {
        eprintln!("skipped: PT_SLURM=1 submits jobs to a cluster of Slurm");
        return;
    }
    let folder = farmed("slurm", ODD, |at| run(at, &["timeout", "180", "bash", "farm", "--wait", "--time=5"]));
    let outputs = names(folder.path()).iter().filter(|name| name.starts_with("slurm-")).count();
    assert_eq!(outputs, 4, "three shards and a merge: {:?}", names(folder.path()));
}

/// make is killed with all its jobs while it renders. Run again, it leaves the shards that are there alone and makes the others.
#[cfg(unix)]
#[test]
fn make_goes_on_after_it_was_killed() {
    use std::os::unix::process::CommandExt;
    if !is_installed("make", "make") {
        return;
    }
    let folder = folder("s.json");
    let at = folder.path();
    let options = ["--size", "64x48", "--spp", "4096", "--threads", "1"];
    succeeded(&pt(at, &[&["farm", "s.json", "--shards", "8", "--for", "make", "--file", "Makefile"][..], &options].concat()));
    let command = &mut Command::new("make");
    command.args(["-j", "2"]).current_dir(at).env("PT", program()).stdout(Stdio::null()).stderr(Stdio::null()).process_group(0);
    let mut child = command.spawn().expect("it starts");
    let parts = || names(at).into_iter().filter(|name| name.ends_with("-of-8.ptc")).collect::<Vec<_>>();
    let start = Instant::now();
    while parts().is_empty() {
        assert!(start.elapsed() < Duration::from_secs(120), "no shard after two minutes");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]).status().expect("kill").success());
    child.wait().expect("it ends");
    let before: Vec<_> =
        parts().into_iter().map(|name| (fs::metadata(at.join(&name)).and_then(|file| file.modified()).expect("a time"), name)).collect();
    assert!((1..8).contains(&before.len()) && !at.join("s.exr").exists(), "killed too late: {before:?}");
    succeeded(&run(at, &["make", "-j", "2"]));
    for (time, name) in before {
        assert_eq!(fs::metadata(at.join(&name)).and_then(|file| file.modified()).expect("a time"), time, "{name} was there");
    }
    succeeded(&pt(at, &[&["s.json", "-o", "whole.exr"][..], &options].concat()));
    assert_eq!(picture(&at.join("s.exr")), picture(&at.join("whole.exr")));
}

/// What cannot be rendered in shards is refused with one line, and nothing is written.
#[test]
fn what_cannot_be_farmed_is_refused() {
    let folder = folder("s.json");
    let at = folder.path();
    fs::write(at.join("bad.json"), SCENE.replace("sphere", "spher")).expect("write");
    fs::write(at.join("a'b.json"), SCENE).expect("write");
    let before = names(at);
    for (args, code, phrase) in [
        (&["bad.json", "--shards", "4", "--for", "make"][..], 3, "bad.json:6:"),
        (&["none.json", "--shards", "4", "--for", "slurm"], 3, "none.json: no such file"),
        (&["s.json", "--shards", "25", "--for", "make"], 2, "--shards 25: there are only 24 samples per pixel"),
        (&["s.json", "--shards", "0", "--for", "make"], 2, "--shards"),
        (&["s.json", "--shards", "4", "--for", "condor"], 2, "possible values: openjd, slurm"),
        (&["s.json", "--for", "make"], 2, "--shards"),
        (&["-", "--shards", "4", "--for", "make"], 2, "stdin can be read only once"),
        (&["s.json", "--shards", "4", "--for", "make", "--time", "3"], 2, "farm --time"),
        (&["s.json", "--shards", "4", "--for", "make", "--adaptive"], 2, "farm --adaptive"),
        (&["s.json", "--shards", "4", "--for", "make", "--clamp", "3"], 2, "farm --clamp: shards do not keep what it removes"),
        (&["s.json", "--shards", "4", "--for", "make", "-o", "x.ptc"], 2, "x.ptc: expected a name that ends in .exr"),
        (&["s.json", "--shards", "4", "--for", "make", "-o", "a%b.exr"], 2, "a%b.exr: make cannot have files with % in their names"),
        (&["a'b.json", "--shards", "4", "--for", "make"], 2, "make cannot have files with ' in their names"),
        (&["s.json", "--shards", "4", "--for", "make", "-o", "a\nb.exr"], 2, "line break"),
        (&["s.json", "--shards", "4", "--for", "make", "-D", "/camera/fov=x"], 2, "/camera/fov"),
    ] {
        let output = pt(at, &[&["farm"][..], args, &["--file", "made"]].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
        assert!(said.lines().filter(|line| line.starts_with("error: ")).count() == 1 && said.contains(phrase), "{args:?}: {said}");
        assert_eq!(names(at), before, "{args:?}");
    }
    let output = pt(at, &["farm", "s.json", "--shards", "4", "--for", "make", "--file", "./s.json"]);
    assert!(output.status.code() == Some(2) && String::from_utf8_lossy(&output.stderr).contains("--file ./s.json: is the scene file"));
    assert_eq!(fs::read_to_string(at.join("s.json")).expect("read"), SCENE);
}
