//! `pt man`: prints the manual page of pt or of a command.

use clap::{Command, CommandFactory};

use super::CommandLine;
use super::print_stdout;
use crate::error::{Error, Result};
use crate::reader::unknown;

/// Runs the command.
///
/// - `command`: command whose page is printed; pt's own page without one
///
/// # Errors
/// `Usage` for an unknown command; `Io` if stdout cannot be written.
pub fn man(command: Option<&str>) -> Result<()> {
    let mut pt = CommandLine::command();
    // Building the parser gives the commands their full names.
    pt.build();
    let page = match command {
        None => pt,
        Some(name) => subcommand(&pt, name)?,
    };
    let mut roff = vec![];
    clap_mangen::Man::new(page).render(&mut roff).map_err(|e| Error::Internal(format!("the manual page cannot be written: {e}")))?;
    print_stdout(&String::from_utf8(roff).map_err(|e| Error::Internal(format!("the manual page is no text: {e}")))?)
}

fn subcommand(pt: &Command, name: &str) -> Result<Command> {
    let found = pt.find_subcommand(name).cloned();
    let names: Vec<&str> = pt.get_subcommands().map(Command::get_name).collect();
    found.ok_or_else(|| Error::Usage(unknown("command", name, &names)))
}
