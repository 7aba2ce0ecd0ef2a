//! What is fuzzed: functions of pt that read what others have written, each called as the program calls it.
//!
//! To add a target: a function in a file of this folder, a row in [`ALL`], and a folder with small seeds of that name in `seeds/`. The tests
//! and the program in `tests/fuzz/` take it from there.

mod assets;
mod parts;
mod scene;
mod words;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use pt::{Error, MAX_FAULTS};

use super::FROM_MANIFEST;

/// A reader of foreign bytes.
pub struct Target {
    /// Name, which is also that of the folder of its seeds.
    pub name: &'static str,
    /// Reads these bytes, with the files of `beside/` in a folder, and returns whether they were accepted. An error says what pt did wrong.
    run: fn(&Path, &[u8]) -> Result<bool, String>,
    /// Number of changed inputs in the tests.
    pub tries: usize,
}

/// All targets.
pub const ALL: &[Target] = &[
    Target { name: "scene", run: scene::render, tries: 1500 },
    Target { name: "exercises", run: scene::exercises, tries: 400 },
    Target { name: "library", run: |at, bytes| assets::within(at, "a.mtl", bytes, "a.obj"), tries: 400 },
    Target { name: "mesh", run: assets::mesh, tries: 600 },
    Target { name: "points", run: |at, bytes| assets::within(at, "points.ply", bytes, "points.json"), tries: 400 },
    Target { name: "lamp", run: |at, bytes| assets::within(at, "l.ies", bytes, "lamp.json"), tries: 400 },
    Target { name: "lens", run: |at, bytes| assets::within(at, "g.dat", bytes, "lens.json"), tries: 300 },
    Target { name: "texture", run: |at, bytes| assets::within(at, "p.png", bytes, "textures.json"), tries: 200 },
    Target { name: "volume", run: |at, bytes| assets::within(at, "v.vol", bytes, "volume.json"), tries: 400 },
    Target { name: "colors", run: |at, bytes| assets::within(at, "c.vol", bytes, "colors.json"), tries: 200 },
    Target { name: "grid", run: |at, bytes| assets::within(at, "v.pbrt", bytes, "grid.json"), tries: 400 },
    Target { name: "picture", run: assets::picture, tries: 600 },
    Target { name: "part", run: parts::merge, tries: 600 },
    Target { name: "rays", run: words::rays, tries: 400 },
    Target { name: "words", run: words::command_line, tries: 5000 },
];

/// Time after which an input counts as one that does not end.
const LONGEST: Duration = Duration::from_secs(60);

/// A temporary folder with the files that inputs may name.
pub struct Bench(tempfile::TempDir);

impl Bench {
    /// A new folder.
    pub fn new() -> Bench {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for (path, bytes) in files(&home().join("beside")) {
            fs::write(folder.path().join(path.file_name().expect("a name")), bytes).expect("write");
        }
        Bench(folder)
    }

    /// Gives these bytes to a target, and returns whether it accepts them.
    ///
    /// # Errors
    /// What pt did wrong.
    pub fn try_on(&self, target: &Target, bytes: &[u8]) -> Result<bool, String> {
        let start = Instant::now();
        let answer = catch_unwind(AssertUnwindSafe(|| (target.run)(self.0.path(), bytes)));
        let text = |payload: Box<dyn std::any::Any + Send>| {
            let text = payload.downcast_ref::<String>().cloned().or_else(|| payload.downcast_ref::<&str>().map(|text| (*text).to_owned()));
            format!("a panic: {}", text.unwrap_or_default())
        };
        let is_read = answer.map_err(text)??;
        if start.elapsed() > LONGEST { Err(format!("it took {:?}", start.elapsed())) } else { Ok(is_read) }
    }
}

/// The folder with seeds and findings.
pub fn home() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(FROM_MANIFEST)
}

/// Files of a folder and their contents, in the order of their names; none if there is no such folder.
pub fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut paths: Vec<PathBuf> = entries.filter(|path| path.is_file()).collect();
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), fs::read(path).expect("a file"))).collect()
}

/// The answer to an input; `None` if it was refused as inputs are: with messages, and not as a fault of pt or of the system.
fn judged<T>(answer: pt::Result<T>) -> Result<Option<T>, String> {
    let faults = match answer {
        Ok(value) => return Ok(Some(value)),
        Err(Error::Invalid(faults)) => faults,
        Err(Error::Limit(fault)) => vec![fault],
        Err(other) => return Err(format!("exit code {}: {other}", other.exit_code())),
    };
    let is_said = !faults.is_empty() && faults.len() <= MAX_FAULTS && faults.iter().all(|fault| !fault.message.trim().is_empty());
    if is_said { Ok(None) } else { Err(format!("refused without a message: {faults:?}")) }
}
