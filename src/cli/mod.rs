//! Command line: one file per subcommand.
//!
//! To add one: a file beside these, a variant in `Command`, an arm in `run`.

mod check;
mod compare;
mod completions;
mod convert;
mod display;
mod effects;
mod farm;
mod image;
mod list;
mod load;
mod man;
mod merge;
mod messages;
mod meter;
mod outputs;
mod parse;
mod pilot;
mod precision;
mod progress;
mod quote;
mod rays;
mod reference;
mod render;
mod sample;
mod schema;
mod signals;
mod stats;
mod stress;
mod summary;
mod tone_mapping;
mod torture;
mod trace;
mod usage_error;
mod verify;
mod watch;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use crate::error::allocator::set_message;
use crate::error::text::printable;
use crate::error::{Error, Fault, Result, panic};
use crate::integrator::Entry;
use check::CheckArgs;
use compare::CompareArgs;
use convert::ConvertArgs;
use farm::FarmArgs;
use load::SceneArgs;
use merge::MergeArgs;
use messages::{is_quiet, note, print_stderr};
use meter::MeterArgs;
use precision::PrecisionArgs;
use progress::{ProgressForm, WorkArgs};
use rays::RaysArgs;
use reference::ReferenceArgs;
use render::RenderArgs;
use sample::SampleArgs;
use schema::SchemaArgs;
use std::path::PathBuf;
use stress::StressArgs;
use torture::TortureArgs;
use verify::VerifyArgs;

const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("PT_BUILD_ID"), ")");

/// A physically based renderer that shows what accuracy costs in time.
#[derive(Parser, Debug)]
#[command(name = "pt", version = VERSION, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
struct CommandLine {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    render: RenderArgs,
    /// Errors as one JSON object on stderr.
    #[arg(long, global = true)]
    json_errors: bool,
    /// Print only errors and what was asked for: no notes, no warnings, no progress.
    #[arg(short, long, global = true)]
    quiet: bool,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Validate a scene without rendering; list what it contains and which effects it needs.
    Check(CheckArgs),
    /// List what can be chosen: integrators, samplers, materials and more, with one line each.
    List {
        /// List only these.
        what: Option<list::Family>,
    },
    /// Write a scene of another program, or one with -D, in pt's own format; note what is changed or left out.
    Convert(ConvertArgs),
    /// Print the JSON Schema of the scene format.
    Schema(SchemaArgs),
    /// Test whether two integrators, or an integrator and a picture, converge to the same picture: exit code 0 yes, 1 no, 7
    /// inconclusive.
    Verify(VerifyArgs),
    /// Measure what accuracy costs in time: several methods on one scene, compared at doubling checkpoints in a report.
    Compare(Box<CompareArgs>),
    /// Add parts of a render (.ptc), in any order, to the whole picture, bit for bit as if rendered at once.
    Merge(MergeArgs),
    /// Write a file with which an engine renders a picture in shards and merges them: Open Job Description, Slurm, GNU parallel, make,
    /// Ray.
    Farm(Box<FarmArgs>),
    /// Compute a reference picture with its own error stated; it is cached by scene, and improved when more is asked.
    Reference(ReferenceArgs),
    /// Sample warps, samplers or a material, as numbers and pictures. Without arguments: list them.
    Sample(SampleArgs),
    /// Test that hard cases stay numerically stable: scenes and formulas with exact answers, put to this program. Exit code 1 if
    /// one fails.
    Torture(TortureArgs),
    /// Try changes of a scene that must not change its picture: its size, its place, far objects and more. Exit code 1 if one does.
    Stress(StressArgs),
    /// Measure what rounding to single precision does to a picture: every path is followed again in double precision.
    Precision(PrecisionArgs),
    /// Measure irradiance and radiance at the scene's meters, with error bars.
    Meter(MeterArgs),
    /// Find where rays meet a mesh, and which points it contains, in double precision, without pictures.
    Rays(RaysArgs),
    /// Compare, inspect and convert pictures: .exr, .hdr, .png, .ppm, .pfm, and .jpg to read.
    Image {
        #[command(subcommand)]
        verb: image::Verb,
    },
    /// Print completions for a shell: `pt completions bash > ~/.local/share/bash-completion/completions/pt`.
    Completions { shell: completions::Shell },
    /// Print the manual page of pt or of a command: `pt man | man -l -`.
    Man {
        /// The command whose page is shown, such as compare.
        command: Option<String>,
    },
}

impl CommandLine {
    /// Returns the files that the command reads, for messages.
    fn file(&self) -> String {
        let scene = |scene: &SceneArgs| scene.path.iter().cloned().collect();
        let files: Vec<PathBuf> = match &self.command {
            None => scene(&self.render.scene),
            Some(Command::Check(args)) => scene(&args.scene),
            Some(Command::Compare(args)) => args.replay.iter().cloned().chain(scene(&args.scene)).collect(),
            Some(Command::Convert(args)) => scene(&args.scene),
            Some(Command::Reference(args)) => scene(&args.scene),
            Some(Command::Farm(args)) => scene(&args.render.scene),
            Some(Command::Verify(args)) => scene(&args.scene),
            Some(Command::Stress(args)) => scene(&args.scene),
            Some(Command::Meter(args)) => scene(&args.scene),
            Some(Command::Precision(args)) => scene(&args.scene),
            Some(Command::Merge(args)) => args.parts.clone(),
            Some(Command::Rays(args)) => vec![args.mesh.clone()],
            Some(Command::Image { verb }) => verb.files(),
            Some(Command::Sample(args)) => args.scene.iter().chain(&args.what).take(1).map(PathBuf::from).collect(),
            Some(_) => vec![],
        };
        files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>().join(", ")
    }

    /// Options for threads and progress; `None` for a command without them.
    fn work(&self) -> Option<&WorkArgs> {
        match &self.command {
            None => Some(&self.render.work),
            Some(Command::Compare(args)) => Some(&args.work),
            Some(Command::Verify(args)) => Some(&args.work),
            Some(Command::Reference(args)) => Some(&args.work),
            Some(Command::Farm(args)) => Some(&args.render.work),
            Some(_) => None,
        }
    }

    /// Number of threads that is asked for.
    fn threads(&self) -> Option<u32> {
        match &self.command {
            Some(Command::Check(args)) => args.threads,
            Some(Command::Meter(args)) => args.threads,
            Some(Command::Precision(args)) => args.threads,
            Some(Command::Rays(args)) => args.threads,
            Some(Command::Stress(args)) => args.threads,
            Some(Command::Torture(args)) => args.threads,
            _ => self.work()?.threads,
        }
    }
}

/// Exit code of a question without an answer: a target that was not reached, a test without power.
const INCONCLUSIVE: u8 = 7;

/// Reads the words of a command line, without the name of the program. Returns the files that the command would read, for messages. Tests
/// that try many words use it.
///
/// # Errors
/// What pt prints when it refuses the words, or when they ask for help.
pub fn files_of(words: &[&str]) -> Result<String, String> {
    let parsed = CommandLine::try_parse_from(["pt"].iter().chain(words));
    parsed.map(|args| args.file()).map_err(|refusal| refusal.to_string())
}

/// Runs the whole program with these tables of integrators. An integrator of another crate gets every command with
/// `main_with(&[pt::integrators::ALL, &[MINE]])`.
pub fn main_with(tables: &[&[Entry]]) -> ExitCode {
    let args = match CommandLine::try_parse_from(command_first(std::env::args_os().collect())) {
        Ok(args) => args,
        Err(usage_error) => return usage_error::print(&usage_error),
    };
    let (json, file) = (args.json_errors, args.file());
    let shows_progress = args.work().is_none_or(|work| work.progress != ProgressForm::None);
    messages::configure(args.quiet, !args.quiet && shows_progress);
    panic::silence();
    signals::let_writing_fail();
    set_message(lines(&Error::Limit(Fault::new("out of memory").in_file(&file)), json));
    finish(panic::caught(&file, || run(args, tables)), json)
}

/// Moves options that all commands share behind the name of the command: `pt -q check` becomes `pt check -q`.
fn command_first(mut words: Vec<OsString>) -> Vec<OsString> {
    let is_shared = |word: &&OsString| ["-q", "--quiet", "--json-errors"].iter().any(|shared| *word == *shared);
    let shared = words.iter().skip(1).take_while(is_shared).count();
    if let Some(moved) = words.get_mut(1..shared + 2)
        && CommandLine::command().find_subcommand(&moved[shared]).is_some()
    {
        moved.rotate_right(1);
    }
    words
}

fn finish(result: Result<ExitCode>, json: bool) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(error) => {
            print_stderr(&lines(&error, json));
            ExitCode::from(error.exit_code())
        }
    }
}

/// Runs the command. A subcommand that tests something has exit codes of its own.
fn run(args: CommandLine, tables: &[&[Entry]]) -> Result<ExitCode> {
    if !matches!(args.command, Some(Command::List { .. } | Command::Schema(_) | Command::Completions { .. } | Command::Man { .. })) {
        render::start_threads(args.threads())?;
    }
    match args.command {
        Some(Command::Sample(args)) => return sample::sample(&args),
        Some(Command::Compare(args)) => return compare::compare(&args, tables),
        Some(Command::Image { verb }) => return image::image(&verb),
        Some(Command::Reference(args)) => return reference::reference(&args, tables),
        Some(Command::Merge(args)) => return merge::merge(&args),
        Some(Command::Verify(args)) => return verify::verify(&args, tables),
        Some(Command::Torture(args)) => return torture::torture(&args),
        Some(Command::Stress(args)) => return stress::stress(&args, tables),
        Some(Command::Meter(args)) => return meter::meter(&args, tables),
        Some(Command::Precision(args)) => return precision::precision(&args, tables),
        Some(Command::Farm(args)) => farm::farm(&args, tables)?,
        Some(Command::Check(check)) => check::check(&check, tables)?,
        Some(Command::Rays(args)) => rays::rays(&args)?,
        Some(Command::Convert(args)) => convert::convert(&args, tables)?,
        Some(Command::List { what }) => list::list(what, tables)?,
        Some(Command::Schema(args)) => schema::schema(&args, tables)?,
        Some(Command::Completions { shell }) => completions::completions(shell)?,
        Some(Command::Man { command }) => man::man(command.as_deref())?,
        None => return render::render(&args.render, tables),
    }
    Ok(ExitCode::SUCCESS)
}

/// Text of an error: one line per fault, or one JSON object.
fn lines(error: &Error, json: bool) -> String {
    if json {
        return serde_json::json!({ "exit_code": error.exit_code(), "errors": error.faults() }).to_string();
    }
    error.to_string().lines().map(|line| format!("error: {}", printable(line))).collect::<Vec<_>>().join("\n")
}

/// Prints to stdout. It is not an error if the reader closes the pipe. Control characters, such as those of names from files, are
/// made harmless.
fn print_stdout(text: &str) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    printed(stdout.write_all(printable(text).as_bytes()).and_then(|()| stdout.flush()))
}

fn printed(result: std::io::Result<()>) -> Result<()> {
    match result {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Error::io("stdout", error)),
        _ => Ok(()),
    }
}
