//! Command lines with changed words, given to the program itself, which ends with a documented exit code and says why.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use super::change::changed;
use super::targets::{files, home};
use crate::random::Random;

/// Number of command lines, or as many as `PT_FUZZ_LINES` says.
fn tries() -> usize {
    std::env::var("PT_FUZZ_LINES").ok().map_or(120, |text| text.parse().expect("PT_FUZZ_LINES is a number"))
}

/// Whether all files of a command line lie in the folder where it runs.
fn stays_here(words: &[&str]) -> bool {
    let is_away = |word: &str| word.starts_with(['/', '~']) || word.contains("..") || word.contains("=/") || word.contains("://");
    let values = words.iter().zip(words.iter().skip(1)).filter(|(flag, _)| **flag == "-D").map(|(_, value)| *value);
    let values: Vec<&str> = values.collect();
    words.iter().all(|word| values.contains(word) || word.split_once("..").is_some_and(|(a, _)| a.parse::<u32>().is_ok()) || !is_away(word))
}

/// A line with a number or an option of another line, or with any change.
fn rewritten(line: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let [mut words, others] = [line, other].map(|line| line.split(|byte| *byte == b'\n').collect::<Vec<_>>());
    match random.below(3) {
        0 => return changed(line, other, random),
        1 => {
            let numbers: Vec<usize> = (0..words.len()).filter(|k| words[*k].first().is_some_and(u8::is_ascii_digit)).collect();
            if !numbers.is_empty() {
                words[random.pick(&numbers)] =
                    random.pick(&[&b"0"[..], b"1", b"2", b"3", b"17", b"65536", b"4294967295", b"0.5", b"1e9", b"-1", b"nan"]);
            }
        }
        _ => {
            let at = random.below(others.len());
            let is_flag = |word: &[u8]| word.starts_with(b"-");
            let option =
                others[at..].iter().skip_while(|word| !is_flag(word)).enumerate().take_while(|(k, word)| *k == 0 || !is_flag(word));
            words.extend(option.map(|(_, word)| *word));
        }
    }
    words.join(&b'\n')
}

#[cfg(unix)]
#[test]
fn changed_command_lines_are_answered() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let seeds: Vec<Vec<u8>> = files(&home().join("seeds/words")).into_iter().map(|(_, bytes)| bytes).collect();
    let scene = r#"{"pt": 1, "camera": {"look_at": {"from": [0, 0, 3], "to": [0, 0, 0]}}, "film": {"width": 4, "height": 4},
        "materials": {"m": {"type": "diffuse"}}, "shapes": [{"type": "sphere", "material": "m"}], "sampler": {"spp": 4}, "background": {"radiance": 1}}"#;
    fs::write(at.join("scene.json"), scene).expect("write");
    fs::write(at.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("write");
    fs::write(at.join("r.csv"), "0,0,1,0,0,-1\n").expect("write");
    let pt = assert_cmd::cargo::cargo_bin("pt");
    let made = Command::new(&pt).current_dir(at).args(["scene.json", "-q", "-o", "a.exr", "-o", "a.ptc"]).status();
    assert!(made.expect("it runs").success());
    for [from, to] in [["a.exr", "b.exr"], ["a.ptc", "b.ptc"]] {
        fs::copy(at.join(from), at.join(to)).expect("copied");
    }
    let (mut random, mut wrong, mut codes) = (Random::new(5), vec![], BTreeMap::new());
    for _ in 0..tries() {
        let [input, other] = [0; 2].map(|_| &seeds[random.below(seeds.len())]);
        let text = String::from_utf8_lossy(&rewritten(input, other, &mut random)).replace('\0', "");
        let words: Vec<&str> = text.split('\n').collect();
        if !stays_here(&words) {
            continue;
        }
        // A command that is asked for much work is interrupted, and ends then.
        let mut command = Command::new("timeout");
        command.args(["-k", "20", "-s", "INT", "2"]).arg(&pt).args(&words).current_dir(at);
        let output = command.env_remove("RUST_BACKTRACE").env("PT_CACHE", at.join("cache")).stdin(std::process::Stdio::null()).output();
        let output = output.expect("timeout runs");
        let (code, said) = (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned());
        let is_refused = code.is_some_and(|code| (2..=5).contains(&code));
        let is_told = said.contains("error") || said.contains("Usage");
        *codes.entry(code).or_insert(0) += 1;
        // 124: it was interrupted, and ended.
        if !matches!(code, Some(0..=5 | 7 | 124 | 130)) || is_refused && !is_told {
            wrong.push(format!("{words:?}: {code:?} {said}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(codes.get(&Some(0)) > Some(&(tries() / 20)), "too few lines were accepted: {codes:?}");
}
