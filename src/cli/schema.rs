//! `pt schema`: the scene format, for editors and for readers.

use super::{args, say};
use crate::describe;
use crate::error::Result;
use crate::integrator::Entry;

pub fn schema(args: &args::Schema, tables: &[&[Entry]]) -> Result<()> {
    say(&if args.markdown { describe::reference(tables) } else { format!("{:#}\n", describe::schema(tables).as_value()) })
}
