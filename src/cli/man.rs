//! `pt man`: the manual page, or that of a command.

use clap::{Command, CommandFactory};

use super::args::Args;
use super::say;
use crate::error::{Error, Result};
use crate::reader::unknown;

/// - `command`: whose page; pt's own where none is named
///
/// # Errors
/// `Usage` for an unknown command; `Io` where nobody takes the text.
pub fn man(command: Option<&str>) -> Result<()> {
    let mut pt = Args::command();
    // Building the parser tells the commands their full names.
    pt.build();
    let page = match command {
        None => pt,
        Some(name) => subcommand(&pt, name)?,
    };
    let mut roff = vec![];
    clap_mangen::Man::new(page).render(&mut roff).map_err(|e| Error::Internal(format!("the manual page cannot be written: {e}")))?;
    say(&String::from_utf8(roff).map_err(|e| Error::Internal(format!("the manual page is no text: {e}")))?)
}

fn subcommand(pt: &Command, name: &str) -> Result<Command> {
    let found = pt.find_subcommand(name).cloned();
    let names: Vec<&str> = pt.get_subcommands().map(Command::get_name).collect();
    found.ok_or_else(|| Error::Usage(unknown("command", name, &names)))
}
