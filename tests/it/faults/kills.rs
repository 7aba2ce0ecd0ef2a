//! SIGKILL at random moments of a render that saves its progress, and its resumption.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use pt::part::Stored;
use pt::sampler::Kind;

use super::{command, done, folder, picture};
use crate::random::Random;

/// Number of kills of each render: a few, or as many as this variable says.
fn wanted() -> usize {
    std::env::var("PT_KILLS").ok().map_or(2, |text| text.parse().expect("PT_KILLS is a number"))
}

/// Kills `line` at random moments, and starts it again, until it was killed often enough and has ended by itself. If it ends before
/// that, `ended` is called and it begins anew.
fn kill_often(at: &Path, line: &str, random: &mut Random, ended: impl Fn()) {
    let (mut kills, mut longest) = (0, Duration::from_millis(400));
    loop {
        let start = Instant::now();
        let mut child = command(at, line).stderr(Stdio::null()).spawn().expect("it starts");
        if kills < wanted() {
            std::thread::sleep(longest.mul_f64(random.unit()));
            kills += usize::from(child.try_wait().expect("a child").is_none());
            child.kill().expect("killed");
        }
        let status = child.wait().expect("it ends");
        if let Some(code) = status.code() {
            assert_eq!(code, 0, "{line}");
            longest = start.elapsed();
            ended();
            if kills >= wanted() {
                return;
            }
            fs::remove_file(at.join("x.ptc")).expect("there");
        }
        // Whenever it was killed, what is there is a whole state.
        let state = at.join("x.ptc");
        if state.exists() {
            Stored::open(&state).unwrap_or_else(|e| panic!("{line}: {e}"));
        }
    }
}

/// The picture after any number of kills has the bits of a render without any, with each sampler, with paths from the lights, and with
/// uneven filters and layers.
#[test]
fn kills_change_no_bit() {
    let folder = folder();
    let at = folder.path();
    let samplers = Kind::ALL.iter().map(|row| format!("--sampler {}", row.1));
    let rows = samplers.chain(["-i light --size 12x8".to_owned(), "--aov all --crop 3,20,2,9 --scramblings 8".to_owned()]);
    for (k, flags) in rows.enumerate() {
        let line = format!("s.json {flags} --spp 4000 -q -o x.exr");
        done(at, &line);
        let whole = picture(at, "x.exr");
        let line = format!("{line} --checkpoint 0.001 --resume");
        kill_often(at, &line, &mut Random::new(k as u64), || assert_eq!(picture(at, "x.exr"), whole, "{flags}"));
        fs::remove_file(at.join("x.ptc")).expect("there");
    }
}

/// A shard that is killed and resumed merges with the others to the picture of the whole render, bit for bit.
#[test]
fn kills_of_a_shard_change_no_bit() {
    let folder = folder();
    let at = folder.path();
    for (k, sampler) in Kind::ALL.iter().map(|row| row.1).enumerate() {
        let all = format!("s.json --sampler {sampler} --spp 9000 -q");
        for shard in [1, 3] {
            done(at, &format!("{all} --shard {shard}/3 -o {shard}.ptc"));
        }
        done(at, &format!("{all} -o whole.exr"));
        let whole = picture(at, "whole.exr");
        let line = format!("{all} --shard 2/3 -o x.ptc --checkpoint 0.001 --resume");
        kill_often(at, &line, &mut Random::new(100 + k as u64), || {
            done(at, "merge 3.ptc x.ptc 1.ptc -o sum.exr");
            assert_eq!(picture(at, "sum.exr"), whole, "{sampler}");
        });
        fs::remove_file(at.join("x.ptc")).expect("there");
    }
}

/// Two processes that save to one file do not spoil it, and both write the right picture.
#[test]
fn two_processes_with_one_state() {
    let folder = folder();
    let at = folder.path();
    done(at, "s.json --spp 4000 -q -o whole.exr");
    let start = |picture: &str| {
        let mut command: Command = command(at, &format!("s.json --spp 4000 -q -o {picture} -o x.ptc --checkpoint 0.001 --resume"));
        command.spawn().expect("it starts")
    };
    let mut both = ["a.exr", "b.exr"].map(start);
    while both.iter_mut().any(|child| child.try_wait().expect("a child").is_none()) {
        if at.join("x.ptc").exists() {
            Stored::open(&at.join("x.ptc")).unwrap_or_else(|e| panic!("{e}"));
        }
    }
    assert!(both.iter_mut().all(|child| child.wait().expect("it ended").success()));
    done(at, "s.json --spp 4000 -q -o c.exr --resume=x.ptc");
    for name in ["a.exr", "b.exr", "c.exr"] {
        assert_eq!(picture(at, name), picture(at, "whole.exr"), "{name}");
    }
}

/// A state that is kept open is read as it was when it was opened, even if another process has replaced the file.
#[test]
fn a_held_state_does_not_change() {
    let folder = folder();
    let at = folder.path();
    let path = at.join("x.ptc");
    let hash = |stored: Stored| pt::output::hash(&pt::part::merge(vec![stored]).expect("a part").film.image()).to_string();
    done(at, "s.json --spp 64 -q -o x.ptc");
    let [before, held] = [(); 2].map(|()| Stored::hold(&path).expect("a part"));
    let before = hash(before);
    done(at, "s.json --spp 100 --seed 7 -q -o x.ptc");
    assert_eq!(hash(held), before);
    assert_ne!(hash(Stored::open(&path).expect("a part")), before);
}
