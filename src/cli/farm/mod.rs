//! `pt farm SCENE`: writes a file with which an engine renders the shards of a picture and merges them.
//!
//! To add an engine: a file beside these with its [`Engine`], and a row in [`ENGINES`].

mod make;
mod openjd;
mod parallel;
mod plan;
mod ray;
mod slurm;

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use super::load::load;
use super::outputs::{OutputKinds, check_outputs, is_same_file};
use super::parse::whole;
use super::render::{self, RenderArgs};
use super::{note, print_stdout};
use crate::error::{Error, Result};
use crate::integrator::Entry;
use crate::output;
use plan::{Engine, FarmPlan};

/// All engines.
const ENGINES: &[Engine] = &[openjd::OPENJD, slurm::SLURM, parallel::PARALLEL, make::MAKE, ray::RAY];

#[derive(clap::Args, Debug)]
pub struct FarmArgs {
    #[command(flatten)]
    pub render: RenderArgs,
    /// Number of shards into which the samples are divided.
    #[arg(long, value_name = "N", value_parser = whole(1_u32, 100_000), allow_negative_numbers = true, required = true)]
    pub shards: u32,
    /// Engine that runs the jobs.
    #[arg(long = "for", value_name = "ENGINE", value_parser = engines(), required = true)]
    pub engine: &'static Engine,
    /// Write to this file. Default: stdout.
    #[arg(long, value_name = "FILE")]
    pub file: Option<PathBuf>,
}

/// Writes the file.
///
/// # Errors
/// Those of loading the scene, which is checked first; `Usage` for options that a part of a picture cannot have, and for more shards than
/// samples; `Io`.
pub fn farm(args: &FarmArgs, tables: &[&[Entry]]) -> Result<()> {
    refuse_options(&args.render)?;
    let scene = args.render.scene.path()?;
    if scene.as_os_str() == "-" {
        return Err(Error::Usage("farm: every shard reads the scene, and stdin can be read only once".into()));
    }
    let loaded = load(&args.render.scene, &args.render.overrides()?, args.render.named_integrator(), tables)?;
    loaded.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    let loaded = render::choose_methods(&args.render, loaded, tables)?;
    let first = render::Shard { index: 1, count: args.shards };
    if first.samples(loaded.sampler.spp).is_none() {
        let (shards, spp) = (args.shards, loaded.sampler.spp);
        return Err(Error::Usage(format!("--shards {shards}: there are only {spp} samples per pixel to share out")));
    }
    let outputs = match &args.render.output[..] {
        [] => vec![format!("{}.exr", loaded.stem).into(), format!("{}.png", loaded.stem).into()],
        given => given.to_vec(),
    };
    check_outputs(&outputs, OutputKinds::Pictures, &[scene], "is the scene file")?;
    if let Some(path) = args.file.as_ref().filter(|path| is_same_file(path, scene)) {
        return Err(Error::Usage(format!("--file {}: is the scene file", path.display())));
    }
    // The number of threads is that of the machine that renders, unless it is said here.
    let threads = args.render.work.threads.filter(|_| std::env::var_os("PT_THREADS").is_none());
    let threads = threads.iter().flat_map(|n| ["--threads".to_owned(), n.to_string()]);
    let plan = FarmPlan {
        scene: scene.to_owned(),
        samples: loaded.sampler.spp,
        shards: args.shards,
        render: render::words(&args.render, &loaded)?.into_iter().chain(threads).collect(),
        outputs,
        merge: args.render.tone_mapping.words(),
        confidence: args.render.confidence,
        stem: loaded.stem,
    };
    plan.check()?;
    let text = (args.engine.text)(&plan)?;
    match &args.file {
        None => print_stdout(&text),
        Some(path) => output::replace(path, text.as_bytes()),
    }
}

/// The names of the engines.
fn engines() -> impl TypedValueParser<Value = &'static Engine> {
    let names = ENGINES.iter().map(|engine| PossibleValue::new(engine.name).help(engine.about));
    // No other name comes here.
    PossibleValuesParser::new(names).map(|name| ENGINES.iter().find(|engine| engine.name == name).unwrap_or(&ENGINES[0]))
}

/// Refuses options of a render that parts of it cannot have, or that tell of a render while it goes on.
///
/// # Errors
/// `Usage`.
fn refuse_options(args: &RenderArgs) -> Result<()> {
    const SINGLE_RUN: &str = "not with shards, which only render a fixed number of samples; see pt farm --help";
    const ADAPTIVE: &str = "how many rounds of samples there are to share out is known only after the pilot; see docs/parts.md";
    let flags = [
        ("--adaptive", args.adaptive, ADAPTIVE),
        ("--clamp", args.clamp.is_some(), "shards do not keep what it removes"),
        ("--shard", args.shard.is_some(), SINGLE_RUN),
        ("--samples", args.samples.is_some(), SINGLE_RUN),
        ("--time", args.time.is_some(), SINGLE_RUN),
        ("--target", args.target.is_some(), SINGLE_RUN),
        ("--checkpoint", args.checkpoint.is_some(), SINGLE_RUN),
        ("--resume", args.resume.is_some(), SINGLE_RUN),
        ("--frames", args.frames.is_some(), SINGLE_RUN),
        ("--clock-name", args.clock_name, SINGLE_RUN),
        ("--pixel", args.pixel.is_some(), SINGLE_RUN),
        ("--pilot", args.pilot.is_some(), SINGLE_RUN),
        ("--worst", args.worst.is_some(), SINGLE_RUN),
        ("--ledger", args.ledger, SINGLE_RUN),
        ("--stats", args.stats.is_some(), SINGLE_RUN),
        ("--display-server", args.display_server.is_some(), SINGLE_RUN),
        ("--serve", args.serve.is_some(), SINGLE_RUN),
        ("--verbose", args.verbose, SINGLE_RUN),
    ];
    match flags.into_iter().find(|(_, is_given, _)| *is_given) {
        Some((flag, _, reason)) => Err(Error::Usage(format!("farm {flag}: {reason}"))),
        None => Ok(()),
    }
}
