//! What clap refuses, and what it answers itself: help and the version.

use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, ValueEnum};

use super::args::{Args, Form};
use super::{finish, printed};
use crate::error::Error;
use crate::reader::closest;

/// Help and version on stdout, what is wrong with the call on stderr.
pub fn answer(refusal: &clap::Error) -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let json = words.iter().take_while(|word| *word != "--").any(|word| word == "--json-errors");
    if !refusal.use_stderr() {
        return finish(printed(refusal.print()).map(|()| ExitCode::SUCCESS), json);
    }
    if let Some(message) = stray(refusal, &words) {
        return finish(Err(Error::Usage(message)), json);
    }
    if json {
        return finish(Err(Error::Usage(sentence(refusal))), json);
    }
    let _ = refusal.print();
    ExitCode::from(refusal.exit_code() as u8)
}

/// What clap calls the samples per pixel after the scene.
const SPP: &str = "[SPP]";

/// A word after the scene: to clap it is a command that "cannot be used with" the scene, or no number of samples, whatever was meant
/// by it.
fn stray(refusal: &clap::Error, words: &[String]) -> Option<String> {
    let told = |kind| match refusal.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    let word = match refusal.kind() {
        ErrorKind::ArgumentConflict => told(ContextKind::InvalidSubcommand)?,
        // What is no number was not meant as one.
        ErrorKind::ValueValidation if told(ContextKind::InvalidArg) == Some(SPP) => {
            told(ContextKind::InvalidValue).filter(|word| word.parse::<f64>().is_err())?
        }
        _ => return None,
    };
    let parser = Args::command();
    let commands: Vec<&str> = parser.get_subcommands().map(|command| command.get_name()).collect();
    let before = words.iter().position(|other| other == word).and_then(|at| words[..at].last());
    let misspelt = || words.iter().find_map(|typed| closest(typed, commands.iter().copied()).map(|near| (typed, near)));
    let formed = before.filter(|flag| ["--stats", "--trace"].contains(&flag.as_str()) && Form::from_str(word, false).is_ok());
    let file = before.filter(|flag| *flag == "--resume");
    Some(if let Some(flag) = formed.or(file) {
        format!("{flag} {word}: expected {flag}={word}")
    } else if commands.contains(&word) {
        format!("{word}: a command comes first, as in pt {word} scene.json; see pt --help")
    } else if let Some((typed, near)) = misspelt() {
        format!("unknown command {typed:?}, did you mean {near:?}? See pt --help")
    } else {
        format!("unexpected {word:?}: one scene at a time, and options before a --; see pt --help")
    })
}

/// What is wrong, without the usage and the hints that follow it.
fn sentence(refusal: &clap::Error) -> String {
    let text = refusal.to_string();
    let paragraph = text.split("\n\n").next().unwrap_or_default();
    paragraph.trim_start_matches("error: ").split_whitespace().collect::<Vec<_>>().join(" ")
}
