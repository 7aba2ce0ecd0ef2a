//! Instances of a node's mesh (EXT_mesh_gpu_instancing).

use super::document::Document;
use crate::describe::mesh::points::InstancePoint;
use crate::import::json_cursor::JsonCursor;

impl Document<'_> {
    /// The instances of a node's mesh in the node's space, in the order of the file; `Some(None)` if there is no extension. `None` with
    /// a fault noted.
    pub fn instances(&self, node: &gltf::Node) -> Option<Option<Vec<InstancePoint>>> {
        let at = self.item("nodes", node.index());
        let extension = at.get(&["extensions"]).and_then(|all| all.get(&["EXT_mesh_gpu_instancing"]));
        let Some(attributes) = extension.and_then(|extension| extension.get(&["attributes"])) else { return Some(None) };
        let translations: Vec<[f32; 3]> = self.instanced(&attributes, "TRANSLATION")?;
        let rotations: Vec<[f32; 4]> = self.instanced(&attributes, "ROTATION")?;
        let scales: Vec<[f32; 3]> = self.instanced(&attributes, "SCALE")?;
        let counts = [translations.len(), rotations.len(), scales.len()];
        let count = counts.into_iter().max().unwrap_or(0);
        if counts.iter().any(|n| *n != 0 && *n != count) {
            attributes.fault(format!("{} translations, {} rotations and {} scales", counts[0], counts[1], counts[2]));
            return None;
        }
        let point = |i: usize| InstancePoint {
            position: translations.get(i).copied().unwrap_or([0.0; 3]),
            rotation: rotations.get(i).copied().filter(|rotation| *rotation != [0.0; 4]).unwrap_or([0.0, 0.0, 0.0, 1.0]),
            scale: scales.get(i).copied().unwrap_or([1.0; 3]),
            material: 0,
        };
        let (shown, hidden): (Vec<_>, Vec<_>) = (0..count).map(point).partition(|point| !point.scale.contains(&0.0));
        if !hidden.is_empty() {
            self.note(&attributes, NOT_SHOWN);
        }
        if count == 0 {
            self.note(&attributes, "no instances: the mesh does not show");
        }
        Some(Some(shown))
    }

    /// Rows of an attribute of the instances, empty if it is missing; `None` with a fault noted.
    fn instanced<const N: usize>(&self, attributes: &JsonCursor, key: &str) -> Option<Vec<[f32; N]>> {
        let Some(at) = attributes.get(&[key]) else { return Some(vec![]) };
        let index = at.whole()?;
        let Some(accessor) = usize::try_from(index).ok().and_then(|i| self.gltf.accessors().nth(i)) else {
            at.fault(format!("accessor {index}, but there are {}", self.gltf.accessors().len()));
            return None;
        };
        self.rows(&accessor)
    }
}

/// Note about meshes that their transform makes flat.
pub const NOT_SHOWN: &str = "what is scaled to nothing is left out: it does not show";
