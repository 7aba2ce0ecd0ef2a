//! World transforms of the nodes at a time: the product of the transforms from the root down.

use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::scene::Transform;

use super::animation::{Animated, Animations};
use super::document::Document;

/// Transforms from node space to the world, by node, and the weights of morph targets that animations set.
pub struct Pose {
    to_world: Vec<DMat4>,
    weights: Vec<Option<Vec<f32>>>,
}

impl Pose {
    /// Transforms of all nodes; `None` if the nodes are not trees, which is noted.
    ///
    /// - `time`: in seconds, for nodes that are animated
    pub fn new(document: &Document, animations: &Animations, time: f64) -> Option<Pose> {
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
            let to_world = outer * own(&node, animations, time);
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
        let weights = |node: gltf::Node| {
            let weights = animations.at(node.index(), Animated::Weights, time)?;
            Some(weights.into_iter().map(|weight| weight as f32).collect())
        };
        Some(Pose { to_world: all?, weights: document.gltf.nodes().map(weights).collect() })
    }

    /// Transform of a node.
    pub fn of(&self, node: &gltf::Node) -> DMat4 {
        self.to_world[node.index()]
    }

    /// Weights of the morph targets of a node's mesh, if an animation sets them.
    pub fn weights(&self, node: &gltf::Node) -> Option<&[f32]> {
        self.weights[node.index()].as_deref()
    }
}

/// Transform from a node's space to its parent's, in f64.
fn own(node: &gltf::Node, animations: &Animations, time: f64) -> DMat4 {
    let [moved, turned, scaled] =
        [Animated::Translation, Animated::Rotation, Animated::Scale].map(|property| animations.at(node.index(), property, time));
    if let (Transform::Matrix { matrix }, None, None, None) = (node.transform(), &moved, &turned, &scaled) {
        return DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from)));
    }
    // A matrix of which animations replace a part is taken apart.
    let (translation, rotation, scale) = node.transform().decomposed();
    let vector = |animated: Option<Vec<f64>>, own: [f32; 3]| {
        animated.map_or_else(|| DVec3::from(own.map(f64::from)), |values| DVec3::from_slice(&values))
    };
    let rotation = turned.map_or_else(|| DVec4::from(rotation.map(f64::from)), |values| DVec4::from_slice(&values));
    let turn = rotation.try_normalize().map_or(DQuat::IDENTITY, DQuat::from_vec4);
    DMat4::from_scale_rotation_translation(vector(scaled, scale), turn, vector(moved, translation))
}

/// Poses while the shutter is open.
pub struct Poses {
    /// Pose in the middle of the exposure. Without a time of exposure it is that of the nodes without animation.
    pub middle: Pose,
    /// Poses at times from the opening of the shutter to its closing; empty if nothing can move.
    keys: Vec<(f64, Pose)>,
    /// Poses from the first key of the animations to the last; empty without a time of exposure.
    all: Vec<Pose>,
}

impl Poses {
    /// Poses for the exposure of the import; `None` with a fault noted.
    pub fn new(document: &Document) -> Option<Poses> {
        let Some([open, close]) = document.root.context().exposure else {
            return Some(Poses { middle: Pose::new(document, &Animations::default(), 0.0)?, keys: vec![], all: vec![] });
        };
        let animations = Animations::read(document)?;
        let pose = |time| Pose::new(document, &animations, time);
        let middle = pose(0.5 * open + 0.5 * close)?;
        let [first, last] = animations.span().unwrap_or_default();
        let moments = if animations.is_empty() { 0 } else { MOMENTS + 1 };
        let all = (0..moments).map(|k| pose(first + (last - first) * (f64::from(k) / f64::from(MOMENTS)))).collect::<Option<_>>()?;
        if animations.is_empty() || open >= close {
            return Some(Poses { middle, keys: vec![], all });
        }
        let mut times: Vec<f64> = (0..=STEPS).map(|k| open + (close - open) * (f64::from(k) / f64::from(STEPS))).collect();
        let within = animations.keys_within([open, close]);
        if within.len() > MOST_KEYS {
            let message = format!(
                "{} keyframes while the shutter is open: movement follows the first {MOST_KEYS} exactly, and the others to a 64th of its time",
                within.len()
            );
            document.note(&document.at(&["animations"]), message);
        }
        times.extend(within.into_iter().take(MOST_KEYS));
        times.sort_by(f64::total_cmp);
        times.dedup();
        let keys: Option<Vec<_>> = times.into_iter().map(|time| Some((time, pose(time)?))).collect();
        Some(Poses { middle, keys: keys?, all })
    }

    /// Transforms of a node at several times of the exposure (s); a single one if it does not move.
    pub fn of(&self, node: &gltf::Node) -> Vec<(f64, DMat4)> {
        let all: Vec<(f64, DMat4)> = self.keys.iter().map(|(time, pose)| (*time, pose.of(node))).collect();
        if all.windows(2).all(|pair| pair[0].1 == pair[1].1) { vec![(0.0, self.middle.of(node))] } else { all }
    }

    /// Poses during all the time that the animations take, for a camera that sees all of it; none without animations.
    pub fn all(&self) -> &[Pose] {
        &self.all
    }

    /// Poses at times from the opening of the shutter to its closing (s); none if nothing can move.
    pub fn keys(&self) -> &[(f64, Pose)] {
        &self.keys
    }
}

/// Number of equal parts of the exposure between which transforms are interpolated. A node that goes round another on a circle
/// deviates from it by 1/3000 of the radius if it makes half a turn.
const STEPS: u32 = 64;

/// Number of equal parts of the animations between which the places of all nodes are looked up.
const MOMENTS: u32 = 16;

/// Largest number of the animations' own keys within the exposure that count.
const MOST_KEYS: usize = 240;
