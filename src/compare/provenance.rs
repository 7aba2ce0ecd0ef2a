//! How a comparison was made: what one needs to repeat it.

use serde::{Deserialize, Serialize};

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
