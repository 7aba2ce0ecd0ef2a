//! Loop subdivision: the smooth surface that a coarse mesh of triangles controls.
//!
//! Each level divides every triangle into four and moves the vertices by the weights of `masks.rs`. The vertices of the last level are
//! moved to the limit, the surface that further levels approach, and get its normals. Everything is computed in f64.
//!
//! Tests: a_flat_mesh_stays_flat, the_limit_does_not_depend_on_the_level.

mod connectivity;
mod masks;

use glam::{DVec3, Vec2, Vec3, Vec4};
use rayon::prelude::*;

use super::{MeshData, MeshPart};
use crate::error::memory::can_be_had;
use crate::error::{Error, Fault, Result};
use connectivity::{Connectivity, NONE, divided_corners, next};
use masks::Vertices;

/// The largest number of triangles that subdivision makes of a mesh.
pub const MOST_TRIANGLES: u64 = 1 << 24;

/// Bytes for each triangle of the last level: half-edges (24), half a vertex in f64 with its fan (16), attributes (28), and the mesh that is
/// made of it (36).
const BYTES_PER_TRIANGLE: u64 = 104;

impl MeshData {
    /// The limit surface of Loop subdivision at the vertices of the mesh after `levels` divisions, with its normals.
    ///
    /// - A mesh without degenerate triangles, as it is after [`MeshData::clean`]. Each triangle has the front that it would have without
    ///   subdivision; nothing else depends on the normals of the mesh.
    /// - Vertices in the same place move together. Texture coordinates and colours are interpolated linearly over each triangle of the
    ///   mesh, on both sides of a seam.
    /// - No level returns the mesh as it is.
    ///
    /// # Errors
    /// [`Error::Invalid`] where more than two triangles meet at an edge, or two that are wound in opposite ways; [`Error::Limit`] for
    /// more than [`MOST_TRIANGLES`] triangles, or more than fit into memory.
    pub fn subdivided(self, levels: u32) -> Result<MeshData> {
        if levels == 0 {
            return Ok(self);
        }
        let count = (self.triangles.len() as u128) << (2 * levels.min(32));
        if count > MOST_TRIANGLES.into() {
            let message = format!("{levels} levels make {count} triangles, expected at most {MOST_TRIANGLES}");
            return Err(Error::Limit(Fault::new(message)));
        }
        if !can_be_had(count * u128::from(BYTES_PER_TRIANGLE)) {
            return Err(Error::Limit(Fault::new(format!("{count} triangles do not fit into memory"))));
        }
        let mut level = Level::new(&self).map_err(|message| Error::invalid(Fault::new(message)))?;
        for _ in 0..levels {
            level = level.divided();
        }
        let scaled = |n: u32| n << (2 * levels);
        let part = |p: MeshPart| MeshPart { triangles: scaled(p.triangles.start)..scaled(p.triangles.end), ..p };
        Ok(MeshData { parts: self.parts.into_iter().map(part).collect(), ..level.limit() })
    }
}

/// The mesh after some divisions.
struct Level {
    mesh: Connectivity,
    positions: Vec<DVec3>,
    attributes: Attributes,
}

/// What is interpolated linearly. A vertex on a seam has several sets of it.
struct Attributes {
    /// Set of each half-edge's start; empty if there are no attributes.
    set: Vec<u32>,
    /// Vertex of each set.
    vertex: Vec<u32>,
    /// Empty, or texture coordinates of each set.
    uvs: Vec<Vec2>,
    /// Empty, or colour of each set.
    colors: Vec<Vec4>,
}

impl Level {
    fn new(data: &MeshData) -> Result<Level, String> {
        let triangles: Vec<[u32; 3]> = data.triangles.iter().map(|&t| data.outward(t)).collect();
        let mesh = Connectivity::new(data, &triangles)?;
        let corners = triangles.as_flattened();
        let positions = mesh.start.iter().map(|&h| data.positions[corners[h as usize] as usize].as_dvec3()).collect();
        let attributes = Attributes::new(data, corners, &mesh);
        Ok(Level { mesh, positions, attributes })
    }

    fn divided(&self) -> Level {
        let (edges, number) = self.mesh.numbered_edges();
        let vertices = Vertices { mesh: &self.mesh, positions: &self.positions };
        let count = self.positions.len();
        let position = |i: usize| if i < count { vertices.moved(i as u32) } else { vertices.middle(edges[i - count]) };
        Level {
            positions: (0..count + edges.len()).into_par_iter().map(position).collect(),
            attributes: self.attributes.divided(&self.mesh, &edges),
            mesh: self.mesh.divided(&edges, &number),
        }
    }

    /// The mesh with its vertices on the limit surface.
    fn limit(self) -> MeshData {
        let Level { mesh, positions, attributes } = self;
        let vertices = Vertices { mesh: &mesh, positions: &positions };
        let limit = |v: usize| {
            let [position, normal] = vertices.limit(v as u32);
            // A normal without direction marks a flat surface.
            (position.as_vec3(), normal.try_normalize().unwrap_or_default().as_vec3())
        };
        let (mut positions, mut normals): (Vec<Vec3>, Vec<Vec3>) = (0..mesh.start.len()).into_par_iter().map(limit).unzip();
        let corners = if attributes.set.is_empty() { &mesh.vertex } else { &attributes.set };
        if !attributes.set.is_empty() {
            let of_sets = |values: &[Vec3]| attributes.vertex.iter().map(|&v| values[v as usize]).collect();
            (positions, normals) = (of_sets(&positions), of_sets(&normals));
        }
        let triangles = corners.as_chunks().0.to_vec();
        MeshData { positions, normals, triangles, uvs: attributes.uvs, colors: attributes.colors, parts: vec![] }
    }
}

impl Attributes {
    /// Gives each vertex a set for each different value at its corners.
    fn new(data: &MeshData, corners: &[u32], mesh: &Connectivity) -> Attributes {
        let mut sets = Attributes { set: vec![], vertex: vec![], uvs: vec![], colors: vec![] };
        if data.uvs.is_empty() && data.colors.is_empty() {
            return sets;
        }
        let value = |h: u32| {
            let (uv, color) = (data.uvs.get(corners[h as usize] as usize), data.colors.get(corners[h as usize] as usize));
            (uv.map(|uv| uv.to_array().map(f32::to_bits)), color.map(|color| color.to_array().map(f32::to_bits)))
        };
        let key = |&h: &u32| (mesh.vertex[h as usize], value(h), h);
        let mut sorted: Vec<u32> = (0..corners.len() as u32).collect();
        sorted.par_sort_unstable_by_key(key);
        sets.set = vec![0; corners.len()];
        for same in sorted.chunk_by(|a, b| (key(a).0, key(a).1) == (key(b).0, key(b).1)) {
            same.iter().for_each(|&h| sets.set[h as usize] = sets.vertex.len() as u32);
            let (vertex, of) = (mesh.vertex[same[0] as usize], corners[same[0] as usize] as usize);
            sets.vertex.push(vertex);
            sets.uvs.extend(data.uvs.get(of));
            sets.colors.extend(data.colors.get(of));
        }
        sets
    }

    /// The sets after the division of all triangles. An edge that is no seam gets one set in its middle, a seam two.
    fn divided(&self, mesh: &Connectivity, edges: &[u32]) -> Attributes {
        if self.set.is_empty() {
            return Attributes { set: vec![], vertex: vec![], uvs: vec![], colors: vec![] };
        }
        let mut sets = Attributes { set: vec![], vertex: self.vertex.clone(), uvs: self.uvs.clone(), colors: self.colors.clone() };
        let ends = |h: u32| [self.set[h as usize], self.set[next(h) as usize]];
        let mut middles = vec![NONE; self.set.len()];
        for (number, &h) in edges.iter().enumerate() {
            let vertex = (mesh.start.len() + number) as u32;
            middles[h as usize] = sets.push_mean(vertex, ends(h));
            let twin = mesh.twin[h as usize];
            if twin != NONE {
                let [b, a] = ends(twin);
                middles[twin as usize] = if [a, b] == ends(h) { middles[h as usize] } else { sets.push_mean(vertex, [a, b]) };
            }
        }
        sets.set = divided_corners(&self.set, |h| middles[h as usize]);
        sets
    }

    /// Adds the mean of two sets as a set of a vertex, and returns its number.
    fn push_mean(&mut self, vertex: u32, ends: [u32; 2]) -> u32 {
        let [a, b] = ends.map(|set| set as usize);
        if !self.uvs.is_empty() {
            self.uvs.push(0.5 * self.uvs[a] + 0.5 * self.uvs[b]);
        }
        if !self.colors.is_empty() {
            self.colors.push(0.5 * self.colors[a] + 0.5 * self.colors[b]);
        }
        self.vertex.push(vertex);
        self.vertex.len() as u32 - 1
    }
}
