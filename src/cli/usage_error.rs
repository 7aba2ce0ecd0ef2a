//! Answers to what clap refuses or prints itself: wrong arguments, help and the version.

use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, ValueEnum};

use super::CommandLine;
use super::stats::TextOrJson;
use super::{finish, printed};
use crate::error::Error;
use crate::reader::closest;

/// Prints help and version on stdout, and errors of the call on stderr.
pub fn print(usage_error: &clap::Error) -> ExitCode {
    // Words that are no Unicode are refused like others.
    let words: Vec<String> = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let json = words.iter().take_while(|word| *word != "--").any(|word| word == "--json-errors");
    if !usage_error.use_stderr() {
        return finish(printed(usage_error.print()).map(|()| ExitCode::SUCCESS), json);
    }
    if let Some(message) = unexpected_word(usage_error, &words) {
        return finish(Err(Error::Usage(message)), json);
    }
    if json {
        return finish(Err(Error::Usage(sentence(usage_error))), json);
    }
    let _ = usage_error.print();
    ExitCode::from(usage_error.exit_code() as u8)
}

/// clap's name of the number of samples after the scene.
const SPP: &str = "[SPP]";

/// Message for an unexpected word after the scene. clap would call it a command that "cannot be used with" the scene, or an invalid
/// number of samples, whatever was meant.
fn unexpected_word(usage_error: &clap::Error, words: &[String]) -> Option<String> {
    let context = |kind| match usage_error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    let word = match usage_error.kind() {
        ErrorKind::ArgumentConflict => context(ContextKind::InvalidSubcommand)?,
        // A word that is not a number was not meant as a number of samples.
        ErrorKind::ValueValidation if context(ContextKind::InvalidArg) == Some(SPP) => {
            context(ContextKind::InvalidValue).filter(|word| word.parse::<f64>().is_err())?
        }
        _ => return None,
    };
    let parser = CommandLine::command();
    let commands: Vec<&str> = parser.get_subcommands().map(|command| command.get_name()).collect();
    let before = words.iter().position(|other| other == word).and_then(|at| words[..at].last());
    let is_command = |typed: &&String| commands.contains(&typed.as_str());
    let misspelt = || {
        let others = words.iter().filter(|typed| !is_command(typed));
        others.filter_map(|typed| Some((typed, closest(typed, commands.iter().copied())?))).next()
    };
    let formed = before.filter(|flag| ["--stats", "--trace"].contains(&flag.as_str()) && TextOrJson::from_str(word, false).is_ok());
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

/// clap's message without the usage and the hints that follow it.
fn sentence(usage_error: &clap::Error) -> String {
    let text = usage_error.to_string();
    let paragraph = text.split("\n\n").next().unwrap_or_default();
    paragraph.trim_start_matches("error: ").split_whitespace().collect::<Vec<_>>().join(" ")
}
