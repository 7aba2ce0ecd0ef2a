//! Triangles with their attributes, in the pose that the file shows.

use glam::{DMat3, DMat4, DVec3, Vec2, Vec3, Vec4};
use gltf::Semantic;
use gltf::mesh::Mode;

use super::document::Document;
use super::extension::is_compressed;
use super::pose::Pose;
use super::texture::Mapping;
use crate::import::json_cursor::JsonCursor;
use crate::shape::MeshData;
use crate::shape::mesh_data::MeshPart;

/// Triangles of a primitive.
pub struct Geometry {
    /// The mesh.
    pub mesh: MeshData,
    /// Whether a skin has placed the mesh in the world, so that the transform of its node does not count.
    pub is_posed: bool,
}

impl<'a> Document<'a> {
    /// Triangles of a primitive of a node's mesh; `None` if there are none, with a note, or a fault.
    ///
    /// - `mapping`: map from the file's texture coordinates to those of the material
    pub fn geometry(
        &self,
        node: &gltf::Node,
        mesh: &gltf::Mesh,
        primitive: &gltf::Primitive,
        mapping: &Mapping,
        pose: &Pose,
    ) -> Option<Geometry> {
        let at = self.at(&["meshes", &mesh.index().to_string(), "primitives", &primitive.index().to_string()]);
        if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.note(&at, "points and lines are left out: they do not show");
            return None;
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            self.note(&at, "a primitive without positions is left out");
            return None;
        };
        let has_bytes = positions.view().is_some() || positions.sparse().is_some();
        if !has_bytes && is_compressed(&at) {
            return None;
        }
        let mut positions = self.vectors(&positions)?;
        let mut normals = match primitive.get(&Semantic::Normals) {
            Some(accessor) => self.vectors(&accessor)?,
            None => vec![],
        };
        let uvs = match primitive.get(&Semantic::TexCoords(mapping.set)) {
            Some(accessor) => self.rows(&accessor)?.into_iter().map(|uv| mapping.upwards(Vec2::from(uv))).collect(),
            None => vec![],
        };
        let colors = match primitive.get(&Semantic::Colors(0)) {
            Some(accessor) => self.colors(&accessor)?,
            None => vec![],
        };
        let count = positions.len();
        for (name, found) in [("NORMAL", normals.len()), ("TEXCOORD", uvs.len()), ("COLOR_0", colors.len())] {
            if found != 0 && found != count {
                at.fault(format!("{found} rows of {name}, but there are {count} positions"));
                return None;
            }
        }
        let triangles = self.triangles(primitive, count, &at)?;
        let weights = pose.weights(node).or_else(|| node.weights()).or_else(|| mesh.weights()).unwrap_or_default();
        self.morph(weights, primitive, &mut positions, &mut normals, &at)?;
        let is_posed = self.bend(node, primitive, pose, &mut positions, &mut normals, &at)?;
        let whole = MeshPart { triangles: 0..triangles.len() as u32, ..MeshPart::default() };
        let mesh = MeshData { positions, normals, uvs, colors, triangles, parts: vec![whole] };
        if !mesh.triangles.iter().any(|&triangle| mesh.cross(triangle) != DVec3::ZERO) {
            self.note(&at, "a primitive without area is left out");
            return None;
        }
        Some(Geometry { mesh, is_posed })
    }

    fn vectors(&self, accessor: &gltf::Accessor) -> Option<Vec<Vec3>> {
        Some(self.rows(accessor)?.into_iter().map(Vec3::from).collect())
    }

    /// Linear red, green, blue and opacity, if there is one.
    fn colors(&self, accessor: &gltf::Accessor) -> Option<Vec<Vec4>> {
        let share = |color: Vec4| color.clamp(Vec4::ZERO, Vec4::ONE);
        Some(match accessor.dimensions().multiplicity() {
            3 => self.rows(accessor)?.into_iter().map(|rgb| share(Vec3::from(rgb).extend(1.0))).collect(),
            _ => self.rows(accessor)?.into_iter().map(|rgba| share(Vec4::from(rgba))).collect(),
        })
    }

    /// Indices of the triangles. Source: glTF 2.0, §3.7.2.1: every second triangle of strips and fans is reversed, so that all have
    /// the same orientation.
    fn triangles(&self, primitive: &gltf::Primitive, count: usize, at: &JsonCursor<'a>) -> Option<Vec<[u32; 3]>> {
        let corners: Vec<u32> = match primitive.indices() {
            Some(accessor) => self.indices(&accessor)?,
            None => (0..u32::try_from(count).ok()?).collect(),
        };
        if let Some(beyond) = corners.iter().find(|&&i| i as usize >= count) {
            at.fault(format!("vertex index {beyond}, but there are {count} vertices"));
            return None;
        }
        match primitive.mode() {
            Mode::Triangles => Some(corners.as_chunks().0.to_vec()),
            Mode::TriangleStrip => {
                let turned = |(i, w): (usize, &[u32])| [w[0], w[1 + i % 2], w[2 - i % 2]];
                Some(corners.windows(3).enumerate().map(turned).collect())
            }
            Mode::TriangleFan => Some(corners.windows(2).skip(1).map(|w| [w[0], w[1], corners[0]]).collect()),
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => None,
        }
    }

    /// Morphed positions p + Σ wₖ Δₖ.
    fn morph(
        &self,
        weights: &[f32],
        primitive: &gltf::Primitive,
        positions: &mut [Vec3],
        normals: &mut [Vec3],
        at: &JsonCursor<'a>,
    ) -> Option<()> {
        for (target, &weight) in primitive.morph_targets().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            for (values, moves) in [(&mut *positions, target.positions()), (&mut *normals, target.normals())] {
                let Some(moves) = moves else { continue };
                let moves = self.vectors(&moves)?;
                if !values.is_empty() && moves.len() != values.len() {
                    at.fault(format!("a morph target of {} rows, but there are {} vertices", moves.len(), values.len()));
                    return None;
                }
                values.iter_mut().zip(moves).for_each(|(value, by)| *value += by * weight);
            }
        }
        Some(())
    }

    /// Skinned positions Σ wₖ Jₖ Bₖ p, with Jₖ a joint's pose and Bₖ its inverse bind matrix; returns whether there is a skin.
    fn bend(
        &self,
        node: &gltf::Node,
        primitive: &gltf::Primitive,
        pose: &Pose,
        positions: &mut [Vec3],
        normals: &mut [Vec3],
        at: &JsonCursor<'a>,
    ) -> Option<bool> {
        let attributes = primitive.get(&Semantic::Joints(0)).zip(primitive.get(&Semantic::Weights(0)));
        let Some((skin, (joints, weights))) = node.skin().zip(attributes) else { return Some(false) };
        let binds: Vec<[f32; 16]> = match skin.inverse_bind_matrices() {
            Some(accessor) => self.rows(&accessor)?,
            None => vec![],
        };
        let bind = |k: usize| binds.get(k).map_or(DMat4::IDENTITY, |b| DMat4::from_cols_array(&b.map(f64::from)));
        let poses: Vec<DMat4> = skin.joints().enumerate().map(|(k, joint)| pose.of(&joint) * bind(k)).collect();
        let (joints, weights): (Vec<[f32; 4]>, Vec<[f32; 4]>) = (self.rows(&joints)?, self.rows(&weights)?);
        if joints.len() != positions.len() || weights.len() != positions.len() {
            at.fault(format!("{} rows of JOINTS_0 and {} of WEIGHTS_0 for {} vertices", joints.len(), weights.len(), positions.len()));
            return None;
        }
        for (i, (joints, weights)) in joints.iter().zip(&weights).enumerate() {
            let (mut sum, mut total) = (DMat4::ZERO, 0.0);
            for (joint, weight) in joints.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
                let Some(pose) = poses.get(*joint as usize) else {
                    at.fault(format!("vertex {i} has joint {joint}, but the skin has {}", poses.len()));
                    return None;
                };
                sum += *pose * f64::from(*weight);
                total += f64::from(*weight);
            }
            if total == 0.0 {
                continue;
            }
            let bent = sum * (1.0 / total);
            positions[i] = bent.transform_point3(positions[i].as_dvec3()).as_vec3();
            if let Some(normal) = normals.get_mut(i) {
                let turned = DMat3::from_mat4(bent).inverse().transpose() * normal.as_dvec3();
                *normal = turned.try_normalize().map_or(*normal, |n| n.as_vec3());
            }
        }
        Some(true)
    }
}
