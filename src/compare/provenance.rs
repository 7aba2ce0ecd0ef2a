//! How a comparison was made: what one needs to repeat it.

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::load::Loaded;
use crate::part::BUILD;

/// How a comparison was made.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version and commit of pt.
    pub version: String,
    /// Command, to copy into a shell.
    pub command: String,
    /// Words of the command after the name of the program.
    pub arguments: Vec<String>,
    /// Folder in which the command ran: its relative paths begin there.
    pub folder: String,
    /// Processor.
    pub cpu: String,
    /// Number of threads.
    pub threads: usize,
    /// Seeds of the replicates.
    pub seeds: Vec<u64>,
    /// Hash of the scene with its files and its size.
    pub scene_hash: String,
    /// Hash of the picture of the reference.
    pub reference_hash: String,
}

impl Provenance {
    /// Provenance of a comparison whose reference is not known yet: `reference_hash` is empty.
    ///
    /// - `command`: command of the comparison, to copy into a shell
    /// - `arguments`: its words after the name of the program
    ///
    /// # Errors
    /// `Internal`.
    pub fn new(loaded: &Loaded, command: String, arguments: Vec<String>, replicates: u32) -> Result<Provenance> {
        let seed = loaded.sampler.seed;
        Ok(Provenance {
            version: BUILD.into(),
            command,
            arguments,
            folder: std::env::current_dir().map(|folder| folder.display().to_string()).unwrap_or_default(),
            cpu: cpu(),
            threads: rayon::current_num_threads(),
            seeds: (0..replicates).map(|replicate| seed.wrapping_add(1 + u64::from(replicate))).collect(),
            scene_hash: loaded.identity()?.hash().to_string(),
            reference_hash: String::new(),
        })
    }

    /// Facts for people: a name and a value each. What is not known is left out.
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let seeds: Vec<String> = self.seeds.iter().map(u64::to_string).collect();
        let facts = [
            ("Version", self.version.clone()),
            ("Processor", self.cpu.clone()),
            ("Threads", if self.threads > 0 { self.threads.to_string() } else { String::new() }),
            ("Seeds", seeds.join(", ")),
            ("Hash of the scene", self.scene_hash.clone()),
            ("Hash of the reference", self.reference_hash.clone()),
        ];
        facts.into_iter().filter(|(_, value)| !value.is_empty()).collect()
    }

    /// Facts that differ from those of an earlier run: name, value now, value then.
    pub fn changes(&self, before: &Provenance) -> Vec<(&'static str, String, String)> {
        let then = before.facts();
        let other = |(name, now): (&'static str, String)| {
            let (_, then) = then.iter().find(|(own, _)| *own == name)?;
            (*then != now).then(|| (name, now, then.clone()))
        };
        self.facts().into_iter().filter_map(other).collect()
    }
}

/// Name of the processor: that of Linux where there is one, and the architecture otherwise.
fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':')).map(|(_, name)| name.trim());
    let other = || format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    name.filter(|name| !name.is_empty()).map_or_else(other, str::to_owned)
}
