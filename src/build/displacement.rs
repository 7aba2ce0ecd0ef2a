//! Displaces meshes by textures.

use glam::{DVec3, Vec2};
use rayon::prelude::*;

use super::Builder;
use super::material::Use;
use crate::describe::Displacement;
use crate::math::Transform;
use crate::shape::{MeshData, VertexColor};
use crate::texture::TextureContext;

impl Builder<'_> {
    /// Moves the vertices of a mesh along their normals. Returns `None` after adding a fault.
    ///
    /// - `pointer`: JSON pointer of the displacement
    pub(super) fn displaced(&mut self, pointer: &str, described: &Displacement, data: MeshData, to_world: &Transform) -> Option<MeshData> {
        let at = format!("{pointer}/texture");
        let texture = self.texture_for(&at, &described.texture, Use::Points);
        if texture.needs_uv() && data.uvs.is_empty() {
            let message = "the mesh has no texture coordinates, over which this texture varies: give it some, or vary it over the position";
            self.fault(&at, message);
            return None;
        }
        // Positions count from the middle of the mesh, so that they are precise wherever it is.
        let place = |v: usize| to_world.point(data.positions[v].as_dvec3());
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = (0..data.positions.len()).map(place).fold(empty, |(low, high), p| (low.min(p), high.max(p)));
        let middle = 0.5 * low + 0.5 * high;
        let texture = texture.recentred(middle);
        let [scale, midlevel] = [described.scale.get(), described.midlevel.get()];
        let height = |v: usize| {
            let context = TextureContext {
                p: (place(v) - middle).as_vec3(),
                uv: data.uvs.get(v).copied().unwrap_or(Vec2::ZERO),
                color: data.colors.get(v).map_or(VertexColor::WHITE, |color| VertexColor::new(*color)),
                footprint: None,
            };
            scale * (f64::from(texture.scalar(&context)) - midlevel)
        };
        let heights: Vec<f64> = (0..data.positions.len()).into_par_iter().map(height).collect();
        let data = data.displaced(&heights);
        if let Some(message) = data.too_large() {
            self.fault(&format!("{pointer}/scale"), &message);
            return None;
        }
        Some(data)
    }
}
