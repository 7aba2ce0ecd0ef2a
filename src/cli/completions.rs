//! `pt completions SHELL`: what a shell needs to complete pt's commands and options.

use clap::CommandFactory;

use super::args::{Args, Shell};
use super::say;
use crate::error::{Error, Result};

/// # Errors
/// `Io` where nobody takes the text.
pub fn completions(shell: Shell) -> Result<()> {
    let mut script = vec![];
    clap_complete::generate(clap_complete::Shell::from(shell), &mut Args::command(), "pt", &mut script);
    say(&String::from_utf8(script).map_err(|e| Error::Internal(format!("completions are no text: {e}")))?)
}
