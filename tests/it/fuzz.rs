//! Fuzzing: readers of foreign bytes never panic, and refuse an input with a message. Hours of it: `tests/fuzz/run.sh`.

mod change;
mod program;
mod targets;

use std::fs;
use std::path::Path;

use crate::random::Random;
use targets::{ALL, Bench, Target, files, home};

/// From the folder of `Cargo.toml` to seeds and findings.
const FROM_MANIFEST: &str = "tests/it/fuzz";

fn seeds(target: &Target) -> Vec<Vec<u8>> {
    let seeds: Vec<Vec<u8>> = files(&home().join("seeds").join(target.name)).into_iter().map(|(_, bytes)| bytes).collect();
    assert!(!seeds.is_empty(), "{} has no seeds", target.name);
    seeds
}

/// What a target does wrong with an input, and the file that keeps the input.
fn wrong(target: &Target, number: usize, input: &[u8], why: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{}-{number}", target.name));
    fs::write(&path, input).expect("write");
    format!("{}: {why}\n  input: {}", target.name, path.display())
}

/// A seed that is refused leads nowhere.
#[test]
fn seeds_are_accepted() {
    let bench = Bench::new();
    for target in ALL {
        for (path, bytes) in files(&home().join("seeds").join(target.name)) {
            assert_eq!(bench.try_on(target, &bytes), Ok(true), "{}", path.display());
        }
    }
}

/// Inputs that once made pt fail.
#[test]
fn findings_are_answered() {
    let bench = Bench::new();
    for target in ALL {
        for (path, bytes) in files(&home().join("findings").join(target.name)) {
            let answer = bench.try_on(target, &bytes);
            assert!(answer.is_ok(), "{}: {answer:?}", path.display());
        }
    }
}

#[test]
fn changed_inputs_are_answered() {
    let bench = Bench::new();
    let mut all = vec![];
    for (k, target) in ALL.iter().enumerate() {
        let (seeds, mut random) = (seeds(target), Random::new(k as u64));
        for number in 0..target.tries {
            let [input, other] = [0; 2].map(|_| &seeds[random.below(seeds.len())]);
            let input = change::changed(input, other, &mut random);
            all.extend(bench.try_on(target, &input).err().map(|why| wrong(target, number, &input, &why)));
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// Seeds that end early, and seeds with a wrong bit: at every place with `PT_FUZZ_ALL`, and otherwise at some.
#[test]
fn cut_and_flipped_seeds_are_answered() {
    let bench = Bench::new();
    let mut all = vec![];
    for target in ALL {
        for seed in seeds(target) {
            let step = if std::env::var_os("PT_FUZZ_ALL").is_some() { 1 } else { seed.len().div_ceil(24) };
            for at in (0..seed.len()).step_by(step) {
                let mut flipped = seed.clone();
                flipped[at] ^= 1 << (at / step % 8);
                for input in [&seed[..at], &flipped[..]] {
                    all.extend(bench.try_on(target, input).err().map(|why| wrong(target, at, input, &why)));
                }
            }
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// The time of each target, to choose their numbers of tries.
#[test]
#[ignore = "a measurement"]
fn times_of_targets() {
    let bench = Bench::new();
    for target in ALL {
        let start = std::time::Instant::now();
        let (seeds, mut random) = (seeds(target), Random::new(1));
        for _ in 0..target.tries {
            let input = change::changed(&seeds[random.below(seeds.len())], &seeds[0], &mut random);
            let _ = bench.try_on(target, &input);
        }
        println!("{}: {:?}", target.name, start.elapsed());
    }
}
