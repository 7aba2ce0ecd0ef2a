//! `pt completions SHELL`: prints completions for a shell.

use clap::CommandFactory;

use super::CommandLine;
use super::print_stdout;
use crate::error::{Error, Result};
use clap::ValueEnum;

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shell {
    Bash,
    Zsh,
    Fish,
}

impl From<Shell> for clap_complete::Shell {
    fn from(shell: Shell) -> clap_complete::Shell {
        match shell {
            Shell::Bash => clap_complete::Shell::Bash,
            Shell::Zsh => clap_complete::Shell::Zsh,
            Shell::Fish => clap_complete::Shell::Fish,
        }
    }
}

/// Runs the command.
///
/// # Errors
/// `Io` if stdout cannot be written.
pub fn completions(shell: Shell) -> Result<()> {
    let mut script = vec![];
    clap_complete::generate(clap_complete::Shell::from(shell), &mut CommandLine::command(), "pt", &mut script);
    print_stdout(&String::from_utf8(script).map_err(|e| Error::Internal(format!("completions are no text: {e}")))?)
}
