//! `pt SCENE`: loads, renders and writes.

mod args;
mod auto;
mod checkpoint;
mod forensics;
mod frames;
mod picture;
mod pixel;
pub mod plan;
mod remarks;

use std::process::ExitCode;
use std::time::Instant;

use super::load::{Override, load};
use super::{check, note, signals};
use crate::error::{Error, Fault, Result};
use crate::integrator::Entry;

pub use args::{RenderArgs, Shard};
pub use auto::choose as choose_methods;
use picture::render_picture;
use plan::RenderPlan;
pub use plan::words;
use remarks::remark_missing_effects;

/// Runs the command.
pub fn render(args: &RenderArgs, tables: &[&[Entry]]) -> Result<ExitCode> {
    match &args.frames {
        Some(frames) => frames::render(args, frames.clone(), tables),
        None => render_one(args, None, tables),
    }
}

/// Renders one picture, or a part of it.
///
/// - `frame`: number of the picture in a sequence
fn render_one(args: &RenderArgs, frame: Option<u32>, tables: &[&[Entry]]) -> Result<ExitCode> {
    // Refused before the scene is loaded, which may take long.
    args.page()?;
    let start = Instant::now();
    let mut loaded = load(&args.scene, &args.overrides()?, args.named_integrator(), tables)?;
    frame.iter().for_each(|frame| loaded.stem = frames::numbered_stem(&loaded.stem, *frame));
    let load_seconds = start.elapsed().as_secs_f64();
    loaded.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    let pool = pool(args.work.threads)?;
    let loaded = pool.install(|| auto::choose(args, loaded, tables))?;
    remark_missing_effects(&loaded);
    if args.verbose {
        note(&check::contents(&loaded));
    }
    plan::refuse_for_splats(args, &loaded)?;
    if let Some(plan) = args.pixel_plan() {
        return pool.install(|| pixel::pixel(&plan, loaded)).map(|()| ExitCode::SUCCESS);
    }
    let plan = RenderPlan::new(args, &loaded, tables)?;
    if frame.is_some() && args.resume.is_some() && plan.is_done() {
        note(&format!("{}: is there with all samples", plan.pictures[0].display()));
        return Ok(ExitCode::SUCCESS);
    }
    signals::catch()?;
    pool.install(|| render_picture(plan, loaded, load_seconds))
}

/// Overrides of `--size`.
pub fn resized([width, height]: [u32; 2]) -> Vec<Override> {
    let set = |pointer, value: String| Override { words: format!("--size {width}x{height}"), pointer, value };
    // The scene's own crop belongs to a picture of another size.
    let crop = format!("{:?}", [0, width, 0, height]);
    vec![set("/film/width", width.to_string()), set("/film/height", height.to_string()), set("/film/crop", crop)]
}

/// Override of `--spp`.
pub fn with_samples(spp: u32) -> Override {
    Override { words: format!("--spp {spp}"), pointer: "/sampler/spp", value: spp.to_string() }
}

/// Thread pool with this number of threads, or one for each core.
pub fn pool(threads: Option<u32>) -> Result<rayon::ThreadPool> {
    builder(threads).build().map_err(|refusal| no_threads(threads, &refusal))
}

/// Starts the threads that work of rayon takes outside of any pool, such as the building of scenes. Without this, rayon panics where
/// the system has no threads left.
///
/// # Errors
/// `Limit` if the system has none.
pub fn start_threads(threads: Option<u32>) -> Result<()> {
    match builder(threads).build_global() {
        // An error without a source says that they are running already.
        Err(refusal) if std::error::Error::source(&refusal).is_some() => Err(no_threads(threads, &refusal)),
        _ => Ok(()),
    }
}

/// Stack of each thread (bytes): builds without optimization overflow the default of 2 MiB.
const STACK: usize = 8 << 20;

fn builder(threads: Option<u32>) -> rayon::ThreadPoolBuilder {
    rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, |n| n as usize)).stack_size(STACK)
}

fn no_threads(threads: Option<u32>, refusal: &rayon::ThreadPoolBuildError) -> Error {
    let wanted = threads.map_or("a thread for each core".to_owned(), |n| format!("{n} threads"));
    Error::Limit(Fault::new(format!("cannot start {wanted}: {refusal}")))
}
