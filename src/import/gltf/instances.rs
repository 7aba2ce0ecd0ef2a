//! Instances of a node's mesh (EXT_mesh_gpu_instancing): each becomes a shape.

use glam::{DMat4, DQuat, DVec3, DVec4};

use super::document::Document;
use crate::import::json_cursor::JsonCursor;

impl Document<'_> {
    /// Transforms of the instances in the node's space, in the order of the file; the identity if there is no extension. `None`
    /// with a fault noted.
    pub fn instances(&self, node: &gltf::Node) -> Option<Vec<DMat4>> {
        let extension = self.item("nodes", node.index()).get(&["extensions"]).and_then(|all| all.get(&["EXT_mesh_gpu_instancing"]));
        let Some(attributes) = extension.and_then(|extension| extension.get(&["attributes"])) else { return Some(vec![DMat4::IDENTITY]) };
        let rotation = |r: [f32; 4]| DVec4::from(r.map(f64::from)).try_normalize().map_or(DQuat::IDENTITY, DQuat::from_vec4);
        let translations = self.instanced(&attributes, "TRANSLATION", |t: [f32; 3]| DVec3::from(t.map(f64::from)))?;
        let rotations = self.instanced(&attributes, "ROTATION", rotation)?;
        let scales = self.instanced(&attributes, "SCALE", |s: [f32; 3]| DVec3::from(s.map(f64::from)))?;
        let counts = [translations.len(), rotations.len(), scales.len()];
        let count = counts.into_iter().max().unwrap_or(0);
        if counts.iter().any(|n| *n != 0 && *n != count) {
            attributes.fault(format!("{} translations, {} rotations and {} scales", counts[0], counts[1], counts[2]));
            return None;
        }
        let at = |i: usize| {
            let translation = translations.get(i).copied().unwrap_or(DVec3::ZERO);
            let rotation = rotations.get(i).copied().unwrap_or(DQuat::IDENTITY);
            DMat4::from_scale_rotation_translation(scales.get(i).copied().unwrap_or(DVec3::ONE), rotation, translation)
        };
        Some((0..count).map(at).collect())
    }

    /// Rows of an attribute of the instances, empty if it is missing; `None` with a fault noted.
    fn instanced<const N: usize, T>(&self, attributes: &JsonCursor, key: &str, read: impl Fn([f32; N]) -> T) -> Option<Vec<T>> {
        let Some(at) = attributes.get(&[key]) else { return Some(vec![]) };
        let index = at.whole()?;
        let Some(accessor) = usize::try_from(index).ok().and_then(|i| self.gltf.accessors().nth(i)) else {
            at.fault(format!("accessor {index}, but there are {}", self.gltf.accessors().len()));
            return None;
        };
        Some(self.rows(&accessor)?.into_iter().map(read).collect())
    }
}
