//! A Makefile: what is there is not made again, so that a run that was stopped goes on.

use super::plan::{Engine, FarmPlan};
use crate::error::{Error, Result};

/// GNU make.
pub const MAKE: Engine = Engine { name: "make", about: "GNU make: goes on where it was stopped, and knows when the scene is newer.", text };

fn text(plan: &FarmPlan) -> Result<String> {
    let name = plan.name();
    let picture = plan.outputs[0].display().to_string();
    let head = plan.head(&format!(
        "    make -f FILE                         one shard at a time, with all cores\n    \
         PT_THREADS=2 make -f FILE -j 4       four at a time, with two threads each\n\
         The other files of the picture are made with {picture}. Shards that are newer than the scene are not rendered again."
    ));
    let shards: Vec<String> = (1..=plan.shards).map(|shard| shard.to_string()).collect();
    Ok(format!(
        "{head}
PT ?= pt
PARTS := $(addprefix {name}.,$(addsuffix -of-{count}.ptc,{shards}))

{target}: $(PARTS)
\t$(PT) {merge}

$(PARTS): {name}.%-of-{count}.ptc: {scene}
\t$(PT) {render}

.DELETE_ON_ERROR:
",
        count = plan.shards,
        shards = shards.join(" "),
        target = file(&picture)?,
        scene = file(&plan.scene.display().to_string())?,
        merge = dollars(&plan.merge_line("\0")).replace('\0', "$(PARTS)"),
        render = dollars(&plan.render_line("\0")).replace('\0', "$*"),
    ))
}

/// A recipe of these words. make passes everything on to the shell but dollars.
fn dollars(words: &str) -> String {
    words.replace('$', "$$")
}

/// Name of a file as a target.
///
/// # Errors
/// `Usage` for characters that cannot stand there.
fn file(name: &str) -> Result<String> {
    const REFUSED: &str = "%:;=|&*?[]~\\\"'`<>()!";
    if let Some(c) = name.chars().find(|c| REFUSED.contains(*c)) {
        return Err(Error::Usage(format!("{name}: make cannot have files with {c} in their names")));
    }
    Ok(name.replace('$', "$$").replace('#', "\\#").replace(' ', "\\ "))
}
