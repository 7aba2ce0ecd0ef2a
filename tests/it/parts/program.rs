//! Parts of a render on the command line.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use pt::output::{Attributes, exr, hash};
use pt::part::Stored;
use tempfile::TempDir;

const SCENE: &str = r#"{
  "pt": 1,
  "camera": { "look_at": { "from": [0, 1, 4], "to": [0, 0, 0] } },
  "film": { "width": 16, "height": 12 },
  "sampler": { "spp": 20 },
  "shapes": [{ "type": "sphere" }, { "type": "mesh", "file": "a.obj" }],
  "lights": [{ "type": "point", "position": [0, 3, 1], "intensity": 9 }],
  "background": { "radiance": 0.2 }
}"#;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("s.json"), SCENE).expect("write");
    fs::write(folder.path().join("a.obj"), "v -2 -1 -2\nv 2 -1 -2\nv 0 -1 2\nf 1 3 2\n").expect("write");
    folder
}

fn pt(folder: &Path, args: &str) -> Output {
    let words = args.split_whitespace();
    Command::new(assert_cmd::cargo::cargo_bin("pt")).current_dir(folder).args(words).env_remove("PT_CACHE").output().expect("it runs")
}

#[track_caller]
fn done(folder: &Path, args: &str) -> String {
    let output = pt(folder, args);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{args}: {said}");
    said
}

#[track_caller]
fn refused(folder: &Path, args: &str, code: i32, phrase: &str) {
    let before = names(folder);
    let output = pt(folder, args);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{args}: {said}");
    assert!(
        said.lines().filter(|line| line.starts_with("error: ")).count() == 1 && said.contains(phrase),
        "{args}: expected {phrase:?} in\n{said}"
    );
    assert_eq!(names(folder), before, "{args}");
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).expect("a folder").map(|e| e.expect("entry").file_name().to_string_lossy().into()).collect();
    names.sort();
    names
}

/// A picture whose pixels are so unevenly noisy that `--adaptive` pays.
const UNEVEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box.json --size 32x32 --adaptive");

/// Shards of an adaptive render have the same pilot, so that they merge to its picture: with the numbers of samples, the error bars and what it
/// says about itself. Missing rounds are made by the command that the merge prints.
#[test]
fn shards_of_adaptive_renders_merge_to_the_whole() {
    let folder = folder();
    let at = folder.path();
    let whole = done(at, &format!("{UNEVEN} --spp 64 -o whole.exr -o whole.ptc -t 1"));
    assert!(whole.contains(" spp (") && !whole.contains("the same number of samples"), "{whole}");
    let counts = exr::read(&at.join("whole.exr")).unwrap_or_else(|e| panic!("{e}")).0.channel("SampleCount.Y").expect("counts").to_vec();
    assert!(counts.iter().any(|n| *n != counts[0]));
    for i in 1..=3 {
        let said = done(at, &format!("{UNEVEN} --spp 64 --shard {i}/3"));
        assert!(said.contains("rounds "), "{said}");
    }
    let parts: Vec<String> = (1..=3).map(|i| format!("cornell-box.{i}-of-3.ptc")).collect();
    let [first, second, third] = &parts[..] else { unreachable!() };
    let said = done(at, &format!("merge {third} {first} {second} -o sum.exr"));
    assert_eq!(picture(at, "sum.exr"), picture(at, "whole.exr"));
    let numbers = |said: &str| said.split(" · ").find(|words| words.contains(" spp (")).map(str::to_owned);
    assert_eq!(numbers(&said), numbers(&whole), "{said}");
    done(at, "merge whole.ptc -o again.exr");
    assert_eq!(picture(at, "again.exr"), picture(at, "whole.exr"));

    refused(at, &format!("merge {first} {third} -o x.exr"), 3, " are missing; --partial");
    let said = done(at, &format!("merge {first} {third} -o some.exr --partial"));
    assert!(said.contains("warning: rounds "), "{said}");
    let command = said.lines().find_map(|line| line.trim().strip_prefix("pt ")).expect("a command");
    assert!(command.contains("--adaptive") && command.contains("--samples "), "{command}");
    done(at, &format!("{command} -o made.ptc"));
    done(at, &format!("merge {first} made.ptc {third} -o sum.exr"));
    assert_eq!(picture(at, "sum.exr"), picture(at, "whole.exr"));

    done(at, &format!("{UNEVEN} --spp 64 --shard 1/3 --seed 8 -o other.ptc"));
    refused(at, &format!("merge other.ptc {second} {third} -o x.exr"), 3, "/sampler/seed");
    done(at, &format!("{UNEVEN} --spp 128 --shard 1/3 -o other.ptc"));
    refused(at, &format!("merge other.ptc {second} {third} -o x.exr"), 3, "its pixels have other numbers of samples");
    refused(at, &format!("merge {first} {first} whole.ptc -o x.exr"), 3, "rounds 0..");
    refused(
        at,
        &format!("{} --spp 64 --resume=whole.ptc -o x.exr", UNEVEN.replace(" --adaptive", "")),
        3,
        "its pixels have other numbers of samples",
    );
    refused(at, &format!("{UNEVEN} --time 9 -o x.ptc"), 2, "x.ptc: a part of an adaptive render has a planned number of samples");
    // The prices of integrators are those of even samples: paths from the lights cannot have uneven ones.
    done(at, &format!("{UNEVEN} --spp 64 --pilot 0.1s --integrators nee,light -o priced.exr"));
    assert_eq!(picture(at, "priced.exr"), picture(at, "whole.exr"));
    refused(at, &format!("{UNEVEN} --spp 64 --shard 1/60"), 2, "rounds of samples to share out");
}

/// The hash of a picture, and what it says about itself.
fn picture(folder: &Path, name: &str) -> (String, Attributes) {
    let (image, attributes) = exr::read(&folder.join(name)).unwrap_or_else(|e| panic!("{e}"));
    (hash(&image).to_string(), attributes)
}

#[test]
fn shards_merge_to_the_picture_of_the_whole() {
    let folder = folder();
    let at = folder.path();
    for sampler in ["independent", "stratified", "halton", "sobol"] {
        done(at, &format!("s.json --sampler {sampler} -o whole.exr -t 1"));
        for i in 1..=3 {
            done(at, &format!("s.json --sampler {sampler} --shard {i}/3 -q -o {i}.ptc"));
        }
        let said = done(at, "merge 3.ptc 1.ptc 2.ptc -o sum.exr -o sum.png -o sum.ptc");
        assert!(said.contains("16×12 · nee · 20 spp · ") && said.contains(" · relative error "), "{said}");
        assert_eq!(picture(at, "sum.exr"), picture(at, "whole.exr"), "{sampler}");
        done(at, "merge sum.ptc -o again.exr");
        assert_eq!(picture(at, "again.exr"), picture(at, "whole.exr"), "{sampler}");
    }
    let said = done(at, "s.json --samples 3..5");
    assert!(said.contains("· samples 3..5 ·") && at.join("s.3-5.ptc").exists(), "{said}");
}

/// Parts go through pipes: `-o -` is stdout, `-` is stdin.
#[test]
fn parts_go_through_pipes() {
    let folder = folder();
    let at = folder.path();
    done(at, "s.json -o whole.exr");
    done(at, "s.json --shard 2/2 -o 2.ptc");
    let piped = pt(at, "s.json --shard 1/2 -o -");
    assert!(piped.status.success(), "{}", String::from_utf8_lossy(&piped.stderr));
    fs::write(at.join("1.ptc"), &piped.stdout).expect("write");
    // The times of the two differ, and nothing else.
    done(at, "s.json --shard 1/2 -o again.ptc");
    let said = done(at, "merge 1.ptc again.ptc 2.ptc -o sum.exr");
    assert!(said.contains("note: again.ptc: counts once, another part has the same numbers"), "{said}");
    assert_eq!(picture(at, "sum.exr"), picture(at, "whole.exr"));
    let merge = |first: &[u8]| {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("pt"));
        command
            .current_dir(at)
            .args(["merge", "2.ptc", "-", "-o", "-"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = command.spawn().expect("it starts");
        // A refusal may close the pipe early.
        let _ = child.stdin.take().expect("a pipe").write_all(first);
        child.wait_with_output().expect("it ends")
    };
    fs::write(at.join("both.ptc"), merge(&piped.stdout).stdout).expect("write");
    done(at, "merge both.ptc -o piped.exr");
    assert_eq!(picture(at, "piped.exr"), picture(at, "whole.exr"));
    for (wrong, what) in [(&piped.stdout[..400], "truncated"), (b"", "expected a part of a render (.ptc)"), (b"{}", "expected a part")] {
        let output = merge(wrong);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(3) && said.contains(&format!("error: stdin: {what}")) && output.stdout.is_empty(), "{said}");
    }
}

/// A picture of the samples that there are has the mean and the error of these samples, and the commands that are told make the others.
#[test]
fn a_partial_picture_tells_what_is_missing() {
    let folder = folder();
    let at = folder.path();
    let options = "--size 8x6 --crop 0,8,1,6 --seed 3 -D /camera/fov=41";
    done(at, &format!("s.json {options} -o whole.exr"));
    for i in [1, 2, 4] {
        done(at, &format!("s.json {options} --shard {i}/5 -q -o {i}.ptc"));
    }
    let said = done(at, "merge 4.ptc 1.ptc 2.ptc --partial -o some.exr -o some.png -o some.ptc");
    let missing: Vec<&str> = said.lines().filter_map(|line| line.strip_prefix("  pt ")).collect();
    assert!(said.contains("warning: samples 8..12, 16..20 are missing; to make them:") && missing.len() == 2, "{said}");
    assert!(said.contains("· 12 spp, samples 0..8, 12..16 ·") && said.contains("relative error"), "{said}");
    let attributes = picture(at, "some.exr").1;
    let samples = |name: &str| attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.to_string());
    assert_eq!([samples("pt/spp"), samples("pt/samples")], [Some("12".into()), Some("0..8, 12..16".into())]);
    for command in missing {
        done(at, command);
    }
    done(at, "merge some.ptc s.8-12.ptc s.16-20.ptc --partial -o sum.exr");
    assert_eq!(picture(at, "sum.exr"), picture(at, "whole.exr"));
    // A name that a shell would take apart is quoted.
    fs::rename(at.join("s.json"), at.join("a b.json")).expect("renamed");
    let output = Command::new(assert_cmd::cargo::cargo_bin("pt")).current_dir(at).args(["a b.json", "--samples", "4..8"]).output();
    assert!(output.expect("it runs").status.success());
    let command = Command::new(assert_cmd::cargo::cargo_bin("pt"))
        .current_dir(at)
        .args(["merge", "a b.4-8.ptc", "--partial", "-o", "x.exr"])
        .output();
    let said = String::from_utf8_lossy(&command.expect("it runs").stderr).into_owned();
    assert!(said.contains("\n  pt 'a b.json' --samples 0..4\n"), "{said}");
}

/// A merged part can be resumed, and a picture can get more samples than were planned.
#[test]
fn a_render_goes_on_from_any_state() {
    let folder = folder();
    let at = folder.path();
    done(at, "s.json --spp 50 -o whole.exr");
    done(at, "s.json --shard 1/2 -o 1.ptc");
    done(at, "s.json --shard 2/2 -o 2.ptc");
    done(at, "merge 2.ptc 1.ptc -o sum.ptc");
    done(at, "s.json --spp 50 --resume=sum.ptc -o more.exr");
    assert_eq!(picture(at, "more.exr"), picture(at, "whole.exr"));
    // A shard can be resumed too.
    done(at, "s.json --samples 20..31 -o 3.ptc");
    done(at, "s.json --samples 20..50 --resume -o 3.ptc");
    done(at, "merge 3.ptc sum.ptc -o sum.exr");
    assert_eq!(picture(at, "sum.exr"), picture(at, "whole.exr"));
    // A finished render is written again. Without a stored state the render starts from the beginning.
    done(at, "s.json --checkpoint 1h -o x.exr");
    done(at, "s.json --checkpoint 1h --resume -o x.exr");
    let said = done(at, "s.json --resume -o y.exr");
    assert!(said.contains("y.ptc: not there, so this starts at the beginning"), "{said}");
    assert_eq!(picture(at, "x.exr"), picture(at, "y.exr"));
}

#[test]
fn parts_of_another_picture_are_refused() {
    let folder = folder();
    let at = folder.path();
    done(at, "s.json --samples 0..4 -o a.ptc");
    done(at, "s.json --samples 4..8 -o b.ptc");
    done(at, "s.json --samples 12..16 -o d.ptc");
    done(at, "merge a.ptc d.ptc -o gap.ptc");
    let other = |flags: &str, what: &str| {
        done(at, &format!("s.json --samples 4..8 -o other.ptc {flags}"));
        refused(at, "merge a.ptc other.ptc -o x.exr", 3, &format!("error: other.ptc: not of the same picture as a.ptc: {what}"));
        refused(
            at,
            &format!("s.json --resume=a.ptc -o x.exr {flags}"),
            3,
            &format!("error: a.ptc: not of this picture: {}", what.split(' ').next().expect("a word")),
        );
    };
    other("--seed 7", "/sampler/seed is 7, not 0");
    other("--size 12x16", "/film/crop/1 is 12, not 16");
    other("--integrator path", "/integrator/type is \"path\", not \"nee\"");
    other("--sampler halton", "/sampler/type is \"halton\", not \"sobol\"");
    other("--scramblings 4", "/sampler/scramblings is 4, not 2");
    other("-D /camera/fov=30", "/camera/fov is 30.0, not");
    other("--crop 0,4,0,4", "/film/crop/1 is 4, not 16");
    // The scene file is the same, but the mesh has changed.
    fs::write(at.join("a.obj"), "v -2 -1 -2\nv 2 -1 -2\nv 0 -1 2.5\nf 1 3 2\n").expect("write");
    refused(at, "s.json --resume=a.ptc -o x.exr", 3, "a.ptc: not of this picture: /files/a.obj is ");
    fs::write(at.join("a.obj"), "v -2 -1 -2\nv 2 -1 -2\nv 0 -1 2\nf 1 3 2\n").expect("write");

    done(at, "s.json --samples 3..5 -o c.ptc");
    refused(at, "merge a.ptc c.ptc -o x.exr", 3, "error: c.ptc: samples 3..4 are in a.ptc too");
    refused(at, "merge - - -o x.exr", 2, "-: given twice, but stdin is a single part");
    refused(at, "merge a.ptc d.ptc -o x.exr", 3, "a.ptc, d.ptc: samples 4..12 are missing; --partial makes a picture of the others");
    for flag in ["--checkpoint 1h", "--resume", "--stats"] {
        refused(at, &format!("s.json --shard 1/2 -o - {flag}"), 2, "not with -o -");
    }
    refused(at, "reference s.json --spp 4 -o -", 2, "-: expected a name that ends in .exr");
    refused(at, "merge b.ptc -o x.exr -o x.ptc", 3, "b.ptc: samples 0..4 are missing");
    refused(at, "merge a.ptc b.ptc -o a.ptc", 2, "a.ptc: is one of the parts, which would be overwritten");
    refused(at, "merge a.ptc s.json -o x.exr", 3, "s.json: expected a part of a render (.ptc)");
    refused(at, "merge a.ptc no.ptc -o x.exr", 3, "no.ptc: no such file");
    refused(at, "merge a.ptc", 2, "--output");
    refused(at, "s.json --resume=gap.ptc -o x.exr", 3, "gap.ptc: has gaps: it holds samples 0..4, 12..16");
    refused(at, "s.json --resume=b.ptc -o x.exr", 3, "b.ptc: begins at sample 4, expected 0");
    refused(at, "s.json --spp 2 --resume=a.ptc -o x.exr", 2, "a.ptc holds 4 samples per pixel, more than the 2 that are asked for");
    refused(at, "s.json --resume=no.ptc -o x.exr", 3, "no.ptc: no such file");
    for shard in ["0/4", "5/4", "1", "1/0", "-1/4", "a/b", "1/2/3"] {
        refused(at, &format!("s.json --shard {shard}"), 2, "expected a part and how many there are");
    }
    refused(at, "s.json --shard 1/21", 2, "--shard 1/21: there are only 20 samples per pixel to share out");
    for samples in ["4..4", "8..4", "4", "-1..4", "..4", "0..5000000000"] {
        refused(at, &format!("s.json --samples {samples}"), 2, "expected samples such as 64..128");
    }
    refused(at, "s.json --samples 0..21 --sampler stratified", 2, "stratified spreads 20 samples");
    refused(at, "s.json --shard 1/2 -o x.exr", 2, "x.exr: expected a name that ends in .ptc");
    refused(at, "s.json --shard 1/2 --time 3", 2, "cannot be used with");
    refused(at, "s.json --checkpoint 0 -o x.exr", 2, "expected a duration");
}

/// References are cached by scene, continued if more samples are requested, and used by `pt compare`. Nothing else is written.
#[test]
fn references_are_kept() {
    let folder = folder();
    let at = folder.path();
    let said = done(at, "reference s.json --spp 64 --cache kept -o 64.exr");
    assert!(said.contains("16×12 · nee · 64 spp, 0 of them kept · ") && said.contains(" · relative error "), "{said}");
    let kept = names(&at.join("kept"));
    assert!(kept.len() == 1 && kept[0].ends_with(".ptc"), "{kept:?}");
    let said = done(at, "reference s.json --spp 100 --cache kept -o more.exr");
    assert!(said.contains("· 100 spp, 64 of them kept ·"), "{said}");
    done(at, "reference s.json --spp 100 --cache other -o once.exr");
    assert_eq!(picture(at, "more.exr"), picture(at, "once.exr"));
    let said = done(at, "reference s.json --spp 8 --cache kept");
    assert!(said.contains("· 100 spp, 100 of them kept ·"), "{said}");
    assert_eq!(names(&at.join("kept")), kept);
    // Another scene has another cached reference.
    done(at, "reference s.json --spp 8 --cache kept -D /camera/fov=30");
    assert_eq!(names(&at.join("kept")).len(), 2);

    let output = pt(at, "compare s.json --integrators nee,whitted --spp 4 --time 0.05 --cache kept -o report --progress none");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success() && said.starts_with("against the kept reference by nee, "),
        "{said}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let output = pt(at, "compare s.json --integrators nee,whitted --spp 4 --time 0.05 --cache none -o report --progress none");
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("against a reference by nee, "));
    assert!(!at.join("none").exists());
    // A damaged cached reference is rendered again.
    let path = at.join("kept").join(&kept[0]);
    fs::write(&path, "no reference").expect("write");
    let said = done(at, "reference s.json --spp 8 --cache kept");
    assert!(said.contains("of no use") && said.contains("8 spp, 0 of them kept"), "{said}");
}

/// Starts a long render, and waits until it has begun.
fn started(folder: &Path, args: &str) -> Child {
    let command = &mut Command::new(assert_cmd::cargo::cargo_bin("pt"));
    let mut child =
        command.current_dir(folder).args(args.split(' ')).args(["--progress", "json"]).stderr(Stdio::piped()).spawn().expect("it starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    lines.find(|line| line.as_ref().is_ok_and(|line| line.starts_with('{'))).expect("progress").expect("text");
    // The output is read to the end, so that the program does not block.
    std::thread::spawn(move || lines.for_each(drop));
    child
}

/// A render that is ended by a signal writes its state, also if the next checkpoint is far away. Resumed, it gives the same picture as one
/// render.
#[cfg(unix)]
#[test]
fn an_interrupted_render_goes_on() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let folder = folder();
        let at = folder.path();
        let mut child = started(at, "s.json --spp 100000000 --checkpoint 1h -o x.exr");
        Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status().expect("kill");
        assert_eq!(child.wait().expect("it ends").code(), Some(code), "{signal}");
        let samples = Stored::open(&at.join("x.ptc")).unwrap_or_else(|e| panic!("{e}")).ranges()[0].end;
        let total = samples + 37;
        done(at, &format!("s.json --spp {total} --resume -o x.exr"));
        done(at, &format!("s.json --spp {total} -o whole.exr"));
        assert_eq!(picture(at, "x.exr"), picture(at, "whole.exr"), "{signal}: {samples} samples");
    }
}

/// If a render is killed at any moment, also while it writes, the stored state is complete.
#[cfg(unix)]
#[test]
fn a_killed_render_leaves_a_complete_state() {
    let folder = folder();
    let at = folder.path();
    let mut last = 0;
    for wait in [3, 7, 11, 19, 23, 31] {
        let resume = if last == 0 { "" } else { " --resume" };
        let mut child = started(at, &format!("s.json --spp 100000000 --checkpoint 0.001 -o x.exr{resume}"));
        while !at.join("x.ptc").exists() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        std::thread::sleep(std::time::Duration::from_millis(wait));
        child.kill().expect("killed");
        child.wait().expect("it ends");
        let samples = Stored::open(&at.join("x.ptc")).unwrap_or_else(|e| panic!("{e}")).ranges()[0].end;
        assert!(samples >= last, "{samples} after {last}");
        last = samples;
    }
    done(at, &format!("s.json --spp {} --resume -o x.exr", last + 5));
    done(at, &format!("s.json --spp {} -o whole.exr", last + 5));
    assert_eq!(picture(at, "x.exr"), picture(at, "whole.exr"));
}

/// If the state cannot be written to disk, there is a message, and the picture is rendered nevertheless.
#[cfg(target_os = "linux")]
#[test]
fn a_state_that_cannot_be_written_is_reported() {
    let folder = folder();
    let at = folder.path();
    fs::create_dir(at.join("gone")).expect("folder");
    let mut child = started(at, "s.json --spp 100000000 -o gone/x.ptc -o b.exr --checkpoint 1h");
    fs::remove_dir(at.join("gone")).expect("it is empty");
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert_eq!(child.wait().expect("it ends").code(), Some(5));
    assert!(at.join("b.exr").exists());
}
