//! A script for GNU parallel.

use super::plan::{Engine, FarmPlan, KEPT};
use crate::error::Result;

/// GNU parallel.
pub const PARALLEL: Engine = Engine { name: "parallel", about: "GNU parallel: on this machine, or on others by ssh.", text };

fn text(plan: &FarmPlan) -> Result<String> {
    let head = plan.head(&format!(
        "    bash FILE                                                              one shard at a time, with all cores\n    \
         PARALLEL='--jobs 4' PT_THREADS=2 bash FILE                             four at a time, with two threads each\n    \
         PARALLEL='--sshloginfile machines --workdir .' bash FILE               on the machines of that file, which share this folder\n{KEPT}"
    ));
    Ok(format!(
        "#!/usr/bin/env bash
{head}set -euo pipefail
export PT=${{PT:-pt}}

shard() {{
    test -e \"{part}\" || \"$PT\" {render}
}}
export -f shard

# An option in PARALLEL goes before this one.
case ${{PARALLEL:-}} in *jobs*) ;; *) export PARALLEL=\"--jobs 1 ${{PARALLEL:-}}\" ;; esac
parallel --env shard --env PT --env PT_THREADS --halt soon,fail=1 shard ::: {{1..{count}}}
\"$PT\" {merge}
",
        part = plan.part("$1"),
        render = plan.render_line("$1"),
        count = plan.shards,
        merge = plan.merge_line(&plan.all_parts()),
    ))
}
