//! `pt compare --replay FILE`: repeats a comparison and says what changed beyond chance.

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;

use super::super::messages::fitted;
use super::super::progress::{Progress, WorkArgs};
use super::super::{Command, CommandLine, note, print_stdout, render, signals};
use super::scenes::{contestants, load_others};
use super::{CompareArgs, load_resized, origin, read_reference};
use crate::compare::replay::{Recorded, changes};
use crate::compare::{self, Budget, Reference};
use crate::error::{Error, Fault, Result};
use crate::integrator::Entry;
use crate::output;

/// Runs the command.
pub fn replay(file: &Path, work: &WorkArgs, tables: &[&[Entry]]) -> Result<ExitCode> {
    let text = std::fs::read_to_string(file).map_err(|e| Error::io(file, e))?;
    let refused = |text: String| Error::invalid(Fault::new(text).in_file(file));
    let expected = "expected the convergence.json of a report of pt compare";
    let recorded: Recorded = serde_json::from_str(&text).map_err(|e| refused(format!("{expected}; {e}")))?;
    let args = arguments(&recorded).ok_or_else(|| refused(format!("{expected}; found the command {:?}", recorded.provenance.command)))?;
    if args.scene.path.as_deref() == Some(Path::new("-")) {
        return Err(refused("its scene was read from stdin and cannot be read again".into()));
    }
    let path = output::folder(file).join("reference.exr");
    let path = std::path::absolute(&path).map_err(|e| Error::io(&path, e))?;
    // Relative paths of the command begin in the folder where it ran. Where that is gone they begin here.
    let _ = std::env::set_current_dir(&recorded.provenance.folder);
    let loaded = load_resized(&args, tables)?;
    loaded.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    let reference = read_reference(&path, &loaded.film)?;
    let found = output::hash(&reference.image).to_string();
    if found != recorded.provenance.reference_hash {
        let hash = &recorded.provenance.reference_hash;
        return Err(Error::invalid(Fault::new(format!("expected the reference of the report, hash {hash}; found {found}")).in_file(&path)));
    }
    signals::catch()?;
    render::pool(work.threads)?.install(|| repeat(&recorded, &args, loaded, &reference, work, tables))
}

/// Options of the recorded command; `None` if it is none of `pt compare`.
fn arguments(recorded: &Recorded) -> Option<CompareArgs> {
    let words = std::iter::once("pt").chain(recorded.provenance.arguments.iter().map(String::as_str));
    match CommandLine::try_parse_from(words).ok()?.command {
        Some(Command::Compare(args)) if args.replay.is_none() => Some(*args),
        _ => None,
    }
}

fn repeat(
    recorded: &Recorded,
    args: &CompareArgs,
    loaded: super::Loaded,
    reference: &Reference,
    work: &WorkArgs,
    tables: &[&[Entry]],
) -> Result<ExitCode> {
    let others = load_others(args, &loaded, tables)?;
    let mut provenance = origin::provenance(args, &loaded, &others)?;
    provenance.reference_hash = recorded.provenance.reference_hash.clone();
    let spec = loaded.film.clone().without_layers();
    let mut configs = contestants(args, &loaded, &others, tables)?;
    // A method without a recorded number of samples would be rendered without end.
    configs.retain_mut(|config| {
        let before = recorded.methods.iter().find(|method| method.name == config.name);
        config.most = before.and_then(|method| method.last());
        config.most.is_some()
    });
    if configs.is_empty() {
        return Err(Error::Usage("--replay: the recorded command renders none of the recorded methods".into()));
    }
    let samples = args.spp.map_or(super::UNLIMITED, u64::from);
    let budget = Budget { replicates: args.replicates, samples, time: None, metrics: vec![] };
    let progress = Progress::new(work.progress, &spec, u32::MAX.into(), None);
    let methods = compare::run(&configs, &budget, reference, args.confidence, &progress, &())
        .ok_or_else(|| Error::Interrupted(signals::caught().unwrap_or_default()))?;
    progress.finish();
    let mut text = String::new();
    for (name, now, then) in provenance.changes(&recorded.provenance) {
        text += &format!("{name}: {now}, was {then}\n");
    }
    let changes = changes(&recorded.methods, &methods, |method| output::hash(&method.image).to_string());
    changes.iter().for_each(|change| text += &format!("{}\n", change.text));
    let changed = changes.iter().any(|change| change.error);
    text += if changed { "an error changed beyond chance\n" } else { "no error changed beyond chance\n" };
    print_stdout(&fitted(&text))?;
    Ok(ExitCode::from(u8::from(changed)))
}
