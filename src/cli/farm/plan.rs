//! What is rendered and merged on a farm, as lines for a shell.

use std::path::PathBuf;

use crate::cli::quote::quoted;
use crate::error::{Error, Result};

/// An engine that runs jobs.
#[derive(Debug)]
pub struct Engine {
    /// Name on the command line.
    pub name: &'static str,
    /// One line about it.
    pub about: &'static str,
    /// Text of its file.
    pub text: fn(&FarmPlan) -> Result<String>,
}

/// A render in shards, and their merge.
pub struct FarmPlan {
    /// Scene file as the user gave it.
    pub scene: PathBuf,
    /// Name of the scene.
    pub stem: String,
    /// Samples per pixel.
    pub samples: u64,
    /// Number of shards.
    pub shards: u32,
    /// Words after `pt` that render the picture.
    pub render: Vec<String>,
    /// Files of the picture.
    pub outputs: Vec<PathBuf>,
    /// Options of the merge.
    pub merge: Vec<String>,
    /// Confidence of errors.
    pub confidence: f64,
}

/// Lines about shards in files.
pub const KEPT: &str = "A shard that is there is not rendered again. After a change of the scene, delete the shards: pt merge refuses those of\n\
                        different scenes.";

impl FarmPlan {
    /// First lines of every file, each after `# `.
    ///
    /// - `run`: how to run it, in lines
    pub fn head(&self, run: &str) -> String {
        let FarmPlan { stem, samples, shards, .. } = self;
        let text = format!(
            "{stem}: {samples} samples per pixel in {shards} shards, and their merge, which has the bits of one render.\n{run}\n\
             All paths start from the folder in which this is run."
        );
        text.lines().map(|line| format!("# {line}\n")).collect()
    }

    /// Name of the scene without characters that shells, make or templates would read in their own way.
    pub fn name(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
        self.stem.chars().map(plain).collect()
    }

    /// File of a shard.
    ///
    /// - `index`: number of the shard, or what an engine replaces by it
    pub fn part(&self, index: &str) -> String {
        format!("{}.{index}-of-{}.ptc", self.name(), self.shards)
    }

    /// Words that render a shard into its file, for a shell. pt writes the file under a temporary name and renames it when it is complete.
    ///
    /// - `index`: number of the shard, or an expression of the shell
    pub fn render_line(&self, index: &str) -> String {
        format!("{} --shard \"{index}/{}\" -o \"{}\"", shell(&self.render), self.shards, self.part(index))
    }

    /// Words that merge shards into the picture, for a shell.
    ///
    /// - `parts`: the files, or an expression of the shell
    pub fn merge_line(&self, parts: &str) -> String {
        let outputs = self.outputs.iter().flat_map(|path| ["-o".to_owned(), path.display().to_string()]);
        let confidence = ["--confidence".to_owned(), self.confidence.to_string()];
        let words: Vec<String> = outputs.chain(self.merge.iter().cloned()).chain(confidence).collect();
        format!("merge {parts} {}", shell(&words))
    }

    /// All shards, as bash spells them.
    pub fn all_parts(&self) -> String {
        self.part(&if self.shards == 1 { "1".to_owned() } else { format!("{{1..{}}}", self.shards) })
    }

    /// Refuses words and file names with characters that end a line or cannot be seen.
    ///
    /// # Errors
    /// `Usage`.
    pub fn check(&self) -> Result<()> {
        let outputs = self.outputs.iter().map(|path| path.display().to_string());
        let odd = self.render.iter().chain(&self.merge).cloned().chain(outputs).find(|word| word.chars().any(char::is_control));
        match odd {
            None => Ok(()),
            Some(word) => {
                Err(Error::Usage(format!("{word:?}: has a line break or another control character, which files of jobs cannot hold")))
            }
        }
    }
}

/// Words for a shell.
pub fn shell(words: &[String]) -> String {
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}
