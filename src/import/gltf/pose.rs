//! World transforms of the nodes: the product of the transforms from the root down.

use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::scene::Transform;

use super::document::Document;

/// Transforms from node space to the world, by node.
pub struct Pose(Vec<DMat4>);

impl Pose {
    /// Transforms of all nodes; `None` if the nodes are not trees, which is noted.
    pub fn new(document: &Document) -> Option<Pose> {
        let count = document.gltf.nodes().len();
        let mut has_parent = vec![false; count];
        for child in document.gltf.nodes().flat_map(|node| node.children()) {
            if std::mem::replace(&mut has_parent[child.index()], true) {
                document.item("nodes", child.index()).fault("a node with two parents");
                return None;
            }
        }
        let mut poses = vec![None; count];
        let roots = document.gltf.nodes().filter(|node| !has_parent[node.index()]);
        let mut open: Vec<_> = roots.map(|root| (root, DMat4::IDENTITY)).collect();
        while let Some((node, outer)) = open.pop() {
            let to_world = outer * own(&node);
            if !to_world.is_finite() {
                document.item("nodes", node.index()).fault("a transform that is not finite");
                return None;
            }
            poses[node.index()] = Some(to_world);
            open.extend(node.children().map(|child| (child, to_world)));
        }
        let all: Option<Vec<DMat4>> = poses.iter().copied().collect();
        if all.is_none() {
            let first = poses.iter().position(Option::is_none).unwrap_or(0);
            document.item("nodes", first).fault("a node within itself");
        }
        all.map(Pose)
    }

    /// Transform of a node.
    pub fn of(&self, node: &gltf::Node) -> DMat4 {
        self.0[node.index()]
    }
}

/// Transform from a node's space to its parent's, in f64.
fn own(node: &gltf::Node) -> DMat4 {
    match node.transform() {
        Transform::Matrix { matrix } => DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from))),
        Transform::Decomposed { translation, rotation, scale } => {
            let turn = DVec4::from(rotation.map(f64::from)).try_normalize().map_or(DQuat::IDENTITY, DQuat::from_vec4);
            DMat4::from_scale_rotation_translation(DVec3::from(scale.map(f64::from)), turn, DVec3::from(translation.map(f64::from)))
        }
    }
}
