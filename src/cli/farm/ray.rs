//! A Python script for Ray.

use super::plan::{Engine, FarmPlan};
use crate::error::{Error, Result};
use crate::output::Format;

/// Ray.
pub const RAY: Engine = Engine { name: "ray", about: "Ray: a Python script, also for rounds until an error is reached.", text };

fn text(plan: &FarmPlan) -> Result<String> {
    let head = plan.head(
        "    python FILE                     once\n    \
         python FILE --target 0.01       until the relative error is 1 %\n\
         Parts are in Ray's memory, so that a run begins anew. All machines see this folder and have pt, or PT says where it is.",
    );
    let words = |words: &[String]| serde_json::json!(words).to_string();
    let outputs = plan.outputs.iter().flat_map(|path| ["-o".to_owned(), path.display().to_string()]);
    let merge: Vec<String> = outputs.chain(plan.merge.iter().cloned()).collect();
    let picture = plan.outputs.iter().find(|path| Format::of(path) == Some(Format::Exr));
    let picture =
        picture.ok_or_else(|| Error::Usage("ray: expected an .exr among the outputs, in which the script finds the error".into()))?;
    // What the user says goes in last: no placeholder is looked for in it.
    Ok(include_str!("ray.py")
        .replace("@HEAD@\n", &head)
        .replace("@SAMPLES@", &plan.samples.to_string())
        .replace("@SHARDS@", &plan.shards.to_string())
        .replace("@CONFIDENCE@", &plan.confidence.to_string())
        .replacen("@PICTURE@", &serde_json::json!(picture.display().to_string()).to_string(), 1)
        .replacen("@MERGE@", &words(&merge), 1)
        .replacen("@RENDER@", &words(&plan.render), 1))
}
