//! `pt stress SCENE`: tries changes of a scene that must not change its picture.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use super::load::{Loaded, SceneArgs, load};
use super::messages::indented;
use super::parse::{size, threads};
use super::{note, print_stdout, render, signals};
use crate::error::{Error, Result};
use crate::film::FilmSpec;
use crate::integrator::Entry;
use crate::measure::format::{duration, per_cent};
use crate::output::{self, Tonemap};
use crate::render::Observer;
use crate::stress::pictures::{DIFFERENCE, PICTURES, Rendering};
use crate::stress::{Change, Found, Outcome, Subject, Trial, Verdict, html, sentence};

#[derive(clap::Args, Debug)]
pub struct StressArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Integrator. Default: the scene's, or nee.
    #[arg(short, long, value_name = "NAME")]
    pub integrator: Option<String>,
    /// Size of the pictures. Default: the scene's, reduced to at most 96 pixels a side.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Samples per pixel of the pictures of each change, all together.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: u32,
    /// Try only changes whose name contains this word, such as size or diameters. May be given several times.
    #[arg(long, value_name = "WORD")]
    pub only: Vec<String>,
    /// Write the changed scene as JSON to this file, with one --only that names one change.
    #[arg(long, value_name = "FILE", requires = "only")]
    pub write: Option<PathBuf>,
    /// Output file: a page with the picture after each change (.html).
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Number of threads. Default: all cores. The result does not depend on it.
    #[arg(short, long, env = "PT_THREADS", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<u32>,
}

/// The longest side of the pictures, if the user gives no size.
const LONGEST: u32 = 96;

const HEADING: &str = "  verdict  change                                       picture       rays*\n";

const FOOTNOTE: &str = "* rays that hit the surface they leave, lines through one side of a closed shape, paths that meet another surface";

/// Passes interrupts on to the render.
struct Interrupts;

impl Observer for Interrupts {
    fn cancelled(&self) -> bool {
        signals::caught().is_some()
    }
}

/// Runs the command. Exit code 1 if a change makes a difference.
pub fn stress(args: &StressArgs, tables: &[&[Entry]]) -> Result<ExitCode> {
    if let Some(path) = &args.output {
        if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("html")) {
            return Err(Error::Usage(format!("{}: expected a name that ends in .html", path.display())));
        }
        output::check_folder(path)?;
    }
    args.write.as_deref().map(output::check_folder).transpose()?;
    let resized = args.size.map(render::resized).unwrap_or_default();
    let loaded = load(&args.scene, &resized, args.integrator.as_deref(), tables)?;
    loaded.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    signals::catch()?;
    render::pool(args.threads)?.install(|| run(args, &loaded, tables))
}

fn run(args: &StressArgs, loaded: &Loaded, tables: &[&[Entry]]) -> Result<ExitCode> {
    let start = Instant::now();
    let film = reduced(&loaded.film, args.size.is_some());
    let spp = u64::from(args.spp).div_ceil(PICTURES as u64);
    let subject = Subject {
        description: &loaded.description,
        root: &loaded.root,
        file: &loaded.file,
        files: &loaded.files,
        entry: &loaded.entry,
        tables,
    };
    let trial = Trial::new(subject, Rendering { film: &film, sampler: loaded.sampler, spp, observer: &Interrupts })?;
    let changes = chosen(args, trial.changes())?;
    if let Some(path) = &args.write {
        return write_changed(&changes, loaded, path);
    }
    print_stdout(HEADING)?;
    let mut outcomes = vec![];
    for change in changes {
        let outcome = trial.ask(change)?;
        if let Some(signal) = signals::caught() {
            return Err(Error::Interrupted(signal));
        }
        print_stdout(&text(&outcome))?;
        outcomes.push(outcome);
    }
    let safe = sentence(&loaded.stem, &outcomes);
    let limit = outcomes.iter().filter_map(|o| o.found.as_ref()).map(|found| found.pictures.would_show).fold(0.0, f64::max);
    let facts = format!(
        "{}x{} pixels, {} samples each, by {}: a difference of {} % of the whole picture's light would have shown in each change, and {} % \
         is taken for rounding.",
        film.crop.size().x,
        film.crop.size().y,
        spp * PICTURES as u64,
        loaded.entry.name,
        per_cent(limit),
        per_cent(DIFFERENCE)
    );
    if let Some(path) = &args.output {
        let page = html(&loaded.stem, &safe, &facts, &trial, &outcomes, &Tonemap::default())?;
        output::replace(path, page.as_bytes())?;
    }
    print_stdout(&format!(
        "{}\n{}{}",
        indented("", FOOTNOTE),
        indented("", &safe),
        indented("", &format!("{facts} ({})", duration(start.elapsed().as_secs_f64())))
    ))?;
    Ok(if outcomes.iter().all(|outcome| outcome.verdict.is_same()) { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The film without layers and, unless the user chose its size, with at most [`LONGEST`] pixels a side.
fn reduced(film: &FilmSpec, is_chosen: bool) -> FilmSpec {
    let film = film.clone().without_layers();
    let longest = film.size.max_element();
    if is_chosen || longest <= LONGEST {
        return film;
    }
    let size = (film.size * LONGEST / longest).max(glam::UVec2::ONE);
    FilmSpec { filter: film.filter, texture_footprint: film.texture_footprint, ..FilmSpec::new(size.x, size.y) }
}

fn chosen<'c>(args: &StressArgs, all: &'c [Change]) -> Result<Vec<&'c Change>> {
    let fits = |change: &&Change| args.only.is_empty() || args.only.iter().any(|word| change.name.contains(word.as_str()));
    let chosen: Vec<&Change> = all.iter().filter(fits).collect();
    match chosen.is_empty() {
        false => Ok(chosen),
        true => {
            let names: Vec<&str> = all.iter().map(|change| change.name.as_str()).collect();
            Err(Error::Usage(format!("--only {}: no such change, expected a part of: {}", args.only.join(" --only "), names.join("; "))))
        }
    }
}

fn write_changed(changes: &[&Change], loaded: &Loaded, path: &std::path::Path) -> Result<ExitCode> {
    let [change] = changes else {
        let names: Vec<&str> = changes.iter().map(|change| change.name.as_str()).collect();
        return Err(Error::Usage(format!("--write: --only names {} changes, expected one: {}", names.len(), names.join("; "))));
    };
    let changed = change.edit.apply(&loaded.description, &loaded.root, &loaded.files)?;
    output::replace(path, format!("{changed:#}\n").as_bytes())?;
    Ok(ExitCode::SUCCESS)
}

/// Line of a change, and lines of what differs.
fn text(outcome: &Outcome) -> String {
    let word = match outcome.verdict {
        Verdict::Same => "same",
        Verdict::Differs(_) => "DIFFERS",
        Verdict::Refused(_) => "REFUSED",
    };
    let (picture, rays) = match &outcome.found {
        None => (String::new(), String::new()),
        Some(Found { pictures, paths, .. }) => {
            let picture = if pictures.same_bits { "same bits".into() } else { format!("{} %", per_cent(pictures.whole.0)) };
            (picture, format!("{} {} {}", paths.self_hits, paths.broken, paths.others))
        }
    };
    let line = format!("  {word:<9}{:<42}{picture:>10}{rays:>12}", outcome.change.name);
    let said: &[String] = match &outcome.verdict {
        Verdict::Same => &[],
        Verdict::Differs(said) => said,
        Verdict::Refused(reason) => std::slice::from_ref(reason),
    };
    said.iter().fold(line.trim_end().to_owned() + "\n", |text, said| text + &indented("           ", said))
}
