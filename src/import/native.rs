//! pt's own format, which is read as it stands.

use super::foreign::{Content, Foreign};
use super::{Dialect, unknown};
use crate::error::{Error, Fault, Result};
use crate::reader::Node;

pub const DIALECT: Dialect = Dialect { name: "pt", about: "pt's own scenes", is: |_| true, read };

fn read(content: &Content, foreign: &Foreign) -> Result<Option<Node>> {
    if content.tree().is_none()
        && let Some(sentence) = unknown::explained(content)
    {
        return Err(Error::invalid(Fault::new(sentence).in_file(foreign.file)));
    }
    content.json(foreign).cloned().map(Some)
}
