//! A script that submits jobs to Slurm.

use super::plan::{Engine, FarmPlan, KEPT};
use crate::error::Result;

/// Slurm.
pub const SLURM: Engine = Engine { name: "slurm", about: "Slurm: an array of jobs, and a merge that waits for it.", text };

fn text(plan: &FarmPlan) -> Result<String> {
    let head = plan.head(&format!(
        "    bash FILE                                      submits both jobs; options of sbatch may follow:\n    \
         bash FILE --time=1:00:00 --cpus-per-task=8     limits of every job\n\
         If a shard fails, the merge is not run. The same line again goes on.\n{KEPT}"
    ));
    Ok(format!(
        "#!/usr/bin/env bash
{head}set -euo pipefail
export PT=${{PT:-pt}}

shards=$(sbatch --parsable --job-name={name} --array=1-{count} --requeue \"$@\" <<'END_OF_JOB'
#!/bin/bash
shard=$SLURM_ARRAY_TASK_ID
export PT_THREADS=${{SLURM_CPUS_PER_TASK:-${{PT_THREADS:-$(nproc)}}}}
test -e \"{part}\" || \"$PT\" {render}
END_OF_JOB
)
merge=$(sbatch --parsable --job-name={name}-merge --dependency=\"afterok:${{shards%%;*}}\" --kill-on-invalid-dep=yes \"$@\" <<'END_OF_JOB'
#!/bin/bash
\"$PT\" {merge}
END_OF_JOB
)
echo \"jobs: $shards, then $merge\"
",
        name = plan.name(),
        count = plan.shards,
        part = plan.part("$shard"),
        render = plan.render_line("$shard"),
        merge = plan.merge_line(&plan.all_parts()),
    ))
}
