//! The size of a rectangle, and how often an image texture repeats.

use schemars::JsonSchema;
use serde::Serialize;

use super::value::Positive;
use crate::reader::by_kind;

/// Full width and height: one number, or `[x, y]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Size {
    /// One number for both width and height.
    Square(Positive),
    /// The numbers `[x, y]`.
    Sides([Positive; 2]),
}

by_kind!(Size { Number => Square(Positive), Array => Sides([Positive; 2]) });
