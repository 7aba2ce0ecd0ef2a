//! `pt schema`: prints the scene format, for editors and for readers.

use super::print_stdout;
use crate::describe;
use crate::error::Result;
use crate::integrator::Entry;

#[derive(clap::Args, Debug)]
pub struct SchemaArgs {
    /// Print the reference of all keys as Markdown instead.
    #[arg(long)]
    pub markdown: bool,
}

/// Runs the command.
pub fn schema(args: &SchemaArgs, tables: &[&[Entry]]) -> Result<()> {
    print_stdout(&if args.markdown { describe::reference(tables) } else { format!("{:#}\n", describe::schema(tables).as_value()) })
}
