//! pt's own format, which is read as it stands.

use super::Dialect;

pub const DIALECT: Dialect =
    Dialect { name: "pt", about: "pt's own scenes", is: |_| true, read: |content, foreign| content.json(foreign).cloned().map(Some) };
