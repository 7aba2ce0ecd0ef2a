//! A job template in the format Open Job Description, which AWS Deadline Cloud and the program `openjd` run.
//!
//! Source: <https://github.com/OpenJobDescription/openjd-specifications>, template schemas 2023-09.

use super::plan::{Engine, FarmPlan, KEPT};
use crate::error::Result;

/// Open Job Description.
pub const OPENJD: Engine = Engine { name: "openjd", about: "Open Job Description: AWS Deadline Cloud, and openjd run.", text };

fn text(plan: &FarmPlan) -> Result<String> {
    let head = plan.head(&format!(
        "    openjd run FILE                      on this machine\n    \
         deadline bundle submit FOLDER        with this file as template.yaml of the folder, beside the scene\n\
         The folder of the job is the one of this file, unless the parameter Folder names another.\n{KEPT}"
    ));
    Ok(format!(
        "{head}specificationVersion: jobtemplate-2023-09
name: {name}
parameterDefinitions:
  - name: Folder
    type: PATH
    objectType: DIRECTORY
    dataFlow: INOUT
    default: .
    description: Folder of the scene, the shards and the picture.
  - name: Pt
    type: STRING
    default: pt
    description: The program pt.
steps:
  - name: Render
    parameterSpace:
      taskParameterDefinitions:
        - name: Shard
          type: INT
          range: \"1-{count}\"
    script:
      actions:
        onRun:
          command: bash
          args: [\"{{{{Task.File.Run}}}}\"]
      embeddedFiles:
        - name: Run
          type: TEXT
          data: |
            set -euo pipefail
            cd \"{{{{Param.Folder}}}}\"
            shard={{{{Task.Param.Shard}}}}
            test -e \"{part}\" || \"{{{{Param.Pt}}}}\" {render}
  - name: Merge
    dependencies:
      - dependsOn: Render
    script:
      actions:
        onRun:
          command: bash
          args: [\"{{{{Task.File.Run}}}}\"]
      embeddedFiles:
        - name: Run
          type: TEXT
          data: |
            set -euo pipefail
            cd \"{{{{Param.Folder}}}}\"
            \"{{{{Param.Pt}}}}\" {merge}
",
        name = plan.name(),
        count = plan.shards,
        part = plan.part("$shard"),
        render = braces(&plan.render_line("$shard")),
        merge = braces(&plan.merge_line(&plan.all_parts())),
    ))
}

/// Words of a shell without two braces side by side, which begin or end an expression of the template: the quotes around them are closed and
/// opened again between the two.
fn braces(words: &str) -> String {
    let mut text = String::new();
    for c in words.chars() {
        if "{}".contains(c) && text.ends_with(c) {
            text += "''";
        }
        text.push(c);
    }
    text
}
