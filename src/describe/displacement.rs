//! Description of displacement.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Fraction, Real, Textured};

/// Moves each vertex of a mesh by `scale` · (texture − `midlevel`) along its normal when the scene is built, after subdivision. Vertices in the
/// same place stay together, so that no crack opens where texture coordinates have a seam. Normals are computed anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Displacement {
    /// The texture, with values from 0 to 1, looked up at the vertices alone. Colours count by their mean. A picture of 8 bits that holds
    /// heights needs the `encoding` `linear`. One on the `position` is looked up where the vertices are in the scene before they move, and
    /// in the coordinates of the group if instances show the mesh or it moves.
    pub texture: Textured,
    /// The height of the value 1 above the value 0, in metres, before the `transform` of the shape. Outwards, or inwards if negative.
    pub scale: Real,
    /// The value of the texture that leaves a vertex where it is.
    #[serde(default = "zero")]
    pub midlevel: Fraction,
}

fn zero() -> Fraction {
    Fraction::known(0.0)
}
