//! Description of meshes whose vertices move.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Point, Real, Vector};

/// The vertices of a mesh at a time. Between two of them each vertex moves evenly along a straight line. Before the first and after the last
/// nothing moves. A keyframe without `file` and `positions` has the vertices of the mesh itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshKeyframe {
    /// The time, in seconds; later than that of the keyframe before it.
    pub time: Real,
    /// For a mesh from a file: the path of a file with the same triangles in the same order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// For a mesh given here: the positions of its vertices, in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub positions: Option<Vec<Point>>,
    /// For a mesh given here with `normals`: those of its vertices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normals: Option<Vec<Vector>>,
}
