//! Triangle meshes as read from files, and their cleaning.

use std::ops::Range;

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::triangle;
use crate::{Error, Fault, Result};

mod clean;
mod displacement;
mod places;
mod subdivision;

pub use clean::CleanReport;
pub use subdivision::MOST_TRIANGLES;

/// Greatest coordinate of a mesh (m). The square of a distance must be within the range of `f32` (3.4·10³⁸).
pub const MAX_COORDINATE: f32 = 1e18;

/// Ratio of extent to finest detail beyond which an `f32` (2²⁴ = 1.7·10⁷ steps) begins to lose the detail.
const MAX_DETAIL_RATIO: f64 = 1e7;

/// Triangle mesh in object space, in f32 as in its file.
///
/// - counter-clockwise triangles face the viewer: ng = (b − a) × (c − a)
/// - every index is below `positions.len()`
/// - a triangle with a zero normal at any corner is flat: its shading normal is ng
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshData {
    /// Positions of the vertices.
    pub positions: Vec<Vec3>,
    /// Empty or one normal per position, of any length; a zero vector marks a flat surface.
    pub normals: Vec<Vec3>,
    /// Empty or one pair of texture coordinates per position.
    pub uvs: Vec<Vec2>,
    /// Empty or one colour per position: linear red, green, blue and opacity, from 0 to 1.
    pub colors: Vec<Vec4>,
    /// Vertex indices of the triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Parts that cover all triangles in order. No part is empty.
    pub parts: Vec<MeshPart>,
}

/// Range of triangles with the same material name and group name in the file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MeshPart {
    /// Material name.
    pub material: Option<String>,
    /// Group name.
    pub group: Option<String>,
    /// Indices of the triangles.
    pub triangles: Range<u32>,
}

impl MeshData {
    /// Corners of a triangle in double precision.
    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|i| self.positions[i as usize].as_dvec3())
    }

    /// Vector along the geometric normal with twice the triangle's area as length: (b − a) × (c − a), in double precision.
    pub fn cross(&self, triangle: [u32; 3]) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// The triangle with its corners counter-clockwise as seen from the side that its vertex normals point to, if it has any.
    pub fn outward(&self, triangle: [u32; 3]) -> [u32; 3] {
        outward(triangle, false, &self.positions, &self.normals)
    }

    /// Number of triangles whose texture coordinates span no area, because they are equal or lie on a line.
    pub fn flat_uvs(&self) -> usize {
        if self.uvs.is_empty() {
            return 0;
        }
        let is_flat = |triangle: &&[u32; 3]| {
            let [a, b, c] = triangle.map(|v| self.uvs[v as usize].as_dvec2());
            (b - a).perp_dot(c - a) == 0.0
        };
        self.triangles.iter().filter(is_flat).count()
    }

    /// Removes degenerate and duplicate triangles, normals that are not finite, and unused vertices.
    ///
    /// - degenerate: the cross product is exactly zero in f64 (repeated or collinear corners), without an epsilon
    /// - duplicate: the same three positions in any rotation, within one part; the first is kept
    /// - a normal that is not finite becomes zero, which marks a flat surface
    pub fn clean(self) -> (MeshData, CleanReport) {
        clean::clean(self)
    }

    /// Checks and cleans the mesh for rendering, and returns it with warnings, which are sentences that begin with `name`.
    ///
    /// - `directionless`: number of normals that the reader has already set to zero
    ///
    /// # Errors
    /// [`Error::Invalid`] if a triangle has a coordinate beyond [`MAX_COORDINATE`], or no triangle is left.
    pub fn usable(self, directionless: usize, name: &str) -> Result<(MeshData, Vec<String>)> {
        let fault = |message: String| Error::invalid(Fault::new(message).in_file(name));
        // This check comes before the cleaning, because far from the origin f32 makes sound triangles degenerate.
        if let Some(message) = self.too_large() {
            return Err(fault(message));
        }
        let (mesh, report) = self.clean();
        if mesh.triangles.is_empty() {
            return Err(fault(format!("no usable triangles (all {} are degenerate)", report.degenerate)));
        }
        let mut warnings = CleanReport { directionless: report.directionless + directionless, ..report }.warnings(name);
        let (reach, extent) = mesh.reach_and_extent();
        let lost = lost_detail(extent, reach.into(), mesh.finest_detail(), "finest detail");
        warnings.extend(lost.map(|sentence| format!("{name}: {sentence}")));
        Ok((mesh, warnings))
    }

    /// Says that a corner has a coordinate beyond [`MAX_COORDINATE`], if one has.
    pub fn too_large(&self) -> Option<String> {
        let (reach, extent) = self.reach_and_extent();
        (reach > MAX_COORDINATE).then(|| format!("extent {} exceeds {MAX_COORDINATE:e}", brief(extent)))
    }

    /// Greatest |coordinate| of all corners (infinite if one is not finite), and the greater of it and the longest side of the bounding
    /// box.
    fn reach_and_extent(&self) -> (f32, f64) {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut finite = true;
        for &i in self.triangles.as_flattened() {
            let p = self.positions[i as usize];
            (low, high) = (low.min(p), high.max(p));
            finite &= p.is_finite();
        }
        let reach = if finite { low.abs().max(high.abs()).max_element() } else { f32::INFINITY };
        let sides = high.as_dvec3() - low.as_dvec3();
        (reach, f64::from(reach).max(sides.max_element()))
    }

    /// Length of the shortest edge.
    fn finest_detail(&self) -> f64 {
        let shortest = |t: &[u32; 3]| {
            let [a, b, c] = self.corners(*t);
            a.distance_squared(b).min(b.distance_squared(c)).min(c.distance_squared(a))
        };
        self.triangles.iter().map(shortest).fold(f64::INFINITY, f64::min).sqrt()
    }
}

/// Triangle with the winding for which its geometric normal points outwards.
///
/// A mirroring transform reverses the winding of every triangle. Where vertex normals and winding disagree, the vertex normals decide,
/// because they are more often correct.
pub(super) fn outward([a, b, c]: [u32; 3], mirrored: bool, positions: &[Vec3], normals: &[Vec3]) -> [u32; 3] {
    let wound = if mirrored { [a, c, b] } else { [a, b, c] };
    let modelled: Vec3 = if normals.is_empty() { Vec3::ZERO } else { wound.iter().map(|&v| normals[v as usize]).sum() };
    let against = triangle::normal(wound.map(|v| positions[v as usize])).is_some_and(|n| n.dot(modelled) < 0.0);
    if against { [wound[0], wound[2], wound[1]] } else { wound }
}

/// Warning if `extent` is so much larger than `detail` that f32 loses the detail.
///
/// - `reach`: greatest |coordinate|
/// - `what`: name of the detail
pub fn lost_detail(extent: f64, reach: f64, detail: f64, what: &str) -> Option<String> {
    if extent / detail <= MAX_DETAIL_RATIO {
        return None;
    }
    let reach = reach as f32;
    let ulp = f64::from(reach.next_up()) - f64::from(reach);
    let [extent, ratio, detail, ulp] = [extent, extent / detail, detail, ulp].map(brief);
    Some(format!("extent {extent} is {ratio} times the {what} {detail}; f32 steps by {ulp} out there (one ulp)"))
}

/// Number with three significant digits, without trailing zeros: 2e30, 1.25e-3.
fn brief(x: f64) -> String {
    format!("{:e}", format!("{x:.2e}").parse().unwrap_or(x))
}
