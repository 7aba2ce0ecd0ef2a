//! Coverage-guided fuzzing of one target: libFuzzer chooses inputs that reach new code. See `run.sh`.

#![no_main]

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::sync::{LazyLock, Mutex};

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use pt::torture::Random;

#[path = "../../it/fuzz/change.rs"]
mod change;
#[allow(dead_code, reason = "the tests use more of it")]
#[path = "../../it/fuzz/targets/mod.rs"]
mod targets;

use targets::{ALL, Bench, Target, files, home};

/// From the folder of `Cargo.toml` to seeds and findings.
const FROM_MANIFEST: &str = "../it/fuzz";

static BENCH: LazyLock<Bench> = LazyLock::new(Bench::new);
static TARGET: LazyLock<&Target> = LazyLock::new(|| {
    let name = std::env::var("PT_FUZZ_TARGET").expect("PT_FUZZ_TARGET names a target");
    ALL.iter().find(|target| target.name == name).unwrap_or_else(|| panic!("no target {name:?}"))
});
static SEEDS: LazyLock<Vec<Vec<u8>>> =
    LazyLock::new(|| files(&home().join("seeds").join(TARGET.name)).into_iter().map(|(_, bytes)| bytes).collect());
/// Messages so far, without their numbers: a fault is saved once.
static KNOWN: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

fuzz_target!(init: std::panic::set_hook(Box::new(|_| {})), |bytes: &[u8]| {
    // The hook of libfuzzer-sys ends the process at any panic, also of decoders of pictures, which pt catches.
    if let Err(why) = BENCH.try_on(&TARGET, bytes) {
        let kind: String = why.chars().filter(|c| c.is_alphabetic()).take(60).collect();
        let mut known = KNOWN.lock().expect("no panic");
        if known.insert(kind) {
            let folder = PathBuf::from(std::env::var_os("PT_FUZZ_FINDINGS").unwrap_or_else(|| "findings".into()));
            fs::create_dir_all(&folder).expect("a folder");
            let path = folder.join(format!("{}-{}-{}", TARGET.name, std::process::id(), known.len()));
            fs::write(&path, bytes).expect("write");
            eprintln!("FINDING {}: {why}", path.display());
        }
    }
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    let mut random = Random::new(seed.into());
    if random.below(2) == 0 {
        return fuzzer_mutate(data, size, max_size);
    }
    let other = &SEEDS[random.below(SEEDS.len())];
    let new = change::changed(&data[..size], other, &mut random);
    let length = new.len().min(max_size);
    data[..length].copy_from_slice(&new[..length]);
    length
});
