//! The command line: one file per subcommand.
//!
//! To add one: a file beside these, a variant in `args::Command`, an arm in `run`.

mod account;
mod args;
mod check;
mod compare;
mod completions;
mod convert;
mod display;
mod forensics;
mod image;
mod keep;
mod list;
mod load;
mod man;
mod memory;
mod merge;
mod outputs;
mod pilot;
mod plan;
mod progress;
mod reference;
mod refusal;
mod render;
mod sample;
mod schema;
mod signals;
mod stats;
mod trace;
mod verify;
mod voice;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

use crate::error::memory::set_message;
use crate::error::text::printable;
use crate::error::{Error, Fault, Result, panic};
use crate::integrator::Entry;
use args::{Args, Command};
use voice::{insist, is_quiet, note};

/// The exit code of a question that was not answered: a target not reached, a test without power.
const INCONCLUSIVE: u8 = 7;

/// The whole program, for these tables of integrators: an outside integrator gets every command
/// with `main_with(&[pt::integrators::ALL, &[MINE]])`.
pub fn main_with(tables: &[&[Entry]]) -> ExitCode {
    let args = match Args::try_parse_from(command_first(std::env::args_os().collect())) {
        Ok(args) => args,
        Err(refusal) => return refusal::answer(&refusal),
    };
    let (json, file) = (args.json_errors, args.file());
    voice::follow(&args);
    panic::silence();
    signals::let_writing_fail();
    set_message(lines(&Error::Limit(Fault::new("out of memory").in_file(&file)), json));
    finish(panic::caught(&file, || run(args, tables)), json)
}

/// The words of a command line with those options after the command that all commands share: `pt -q check` is `pt check -q`.
fn command_first(mut words: Vec<OsString>) -> Vec<OsString> {
    let is_shared = |word: &&OsString| ["-q", "--quiet", "--json-errors"].iter().any(|shared| *word == *shared);
    let shared = words.iter().skip(1).take_while(is_shared).count();
    if let Some(moved) = words.get_mut(1..shared + 2) {
        moved.rotate_right(1);
    }
    words
}

fn finish(result: Result<ExitCode>, json: bool) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(error) => {
            insist(&lines(&error, json));
            ExitCode::from(error.exit_code())
        }
    }
}

/// What was asked for; a subcommand that judges may say no with an exit code of its own.
fn run(args: Args, tables: &[&[Entry]]) -> Result<ExitCode> {
    match args.command {
        Some(Command::Sample(args)) => return sample::sample(&args),
        Some(Command::Compare(args)) => return compare::compare(&args, tables),
        Some(Command::Image { verb }) => return image::image(&verb),
        Some(Command::Reference(args)) => return reference::reference(&args, tables),
        Some(Command::Merge(args)) => return merge::merge(&args),
        Some(Command::Verify(args)) => return verify::verify(&args, tables),
        Some(Command::Check(check)) => check::check(&check, tables)?,
        Some(Command::Convert(args)) => convert::convert(&args, tables)?,
        Some(Command::List { what }) => list::list(what, tables)?,
        Some(Command::Schema(args)) => schema::schema(&args, tables)?,
        Some(Command::Completions { shell }) => completions::completions(shell)?,
        Some(Command::Man { command }) => man::man(command.as_deref())?,
        None => return render::render(&args.render, tables),
    }
    Ok(ExitCode::SUCCESS)
}

/// What is told of an error: one line per fault, or one JSON object.
fn lines(error: &Error, json: bool) -> String {
    if json {
        return serde_json::json!({ "exit_code": error.exit_code(), "errors": error.faults() }).to_string();
    }
    error.to_string().lines().map(|line| format!("error: {}", printable(line))).collect::<Vec<_>>().join("\n")
}

/// What goes to stdout; that nobody reads it to the end is no error. Nothing in it, such as names from files, moves a terminal.
fn say(text: &str) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    printed(stdout.write_all(printable(text).as_bytes()).and_then(|()| stdout.flush()))
}

fn printed(result: std::io::Result<()>) -> Result<()> {
    match result {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Error::io("stdout", error)),
        _ => Ok(()),
    }
}
