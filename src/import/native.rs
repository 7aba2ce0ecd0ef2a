//! pt's own format, read without changes.

use super::context::{Content, ImportContext};
use super::{Dialect, unknown};
use crate::error::{Error, Fault, Result};
use crate::reader::Node;

/// Dialect `pt`.
pub const DIALECT: Dialect = Dialect { name: "pt", about: "pt's own scenes", is: |_| true, read };

fn read(content: &Content, context: &ImportContext) -> Result<Option<Node>> {
    if content.tree().is_none()
        && let Some(sentence) = unknown::explained(content)
    {
        return Err(Error::invalid(Fault::new(sentence).in_file(context.file)));
    }
    content.json(context).cloned().map(Some)
}
