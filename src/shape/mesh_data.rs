//! A triangle mesh as a file gives it, and the cleaning that makes it fit for rays.

use std::ops::Range;

use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::{Error, Fault, Result};

mod clean;

pub use clean::CleanReport;

/// The largest coordinate pt takes: the square of a distance must still fit an `f32` (3.4·10³⁸).
pub const MAX_COORDINATE: f32 = 1e18;

/// Beyond this ratio of extent to finest detail an `f32` (2²⁴ = 1.7·10⁷ steps) begins to lose the detail.
const MAX_DETAIL_RATIO: f64 = 1e7;

/// A triangle mesh as read: object space, f32 as in the file, not yet placed in the world.
///
/// - counter-clockwise triangles face the viewer: ng = (b − a) × (c − a)
/// - every index is below `positions.len()`
/// - a triangle with a zero normal at any of its corners is flat: its shading normal is ng
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshData {
    pub positions: Vec<Vec3>,
    /// Empty or one per position, of any length; zero means flat here.
    pub normals: Vec<Vec3>,
    /// Empty or one per position.
    pub uvs: Vec<Vec2>,
    /// Empty or one per position: linear red, green, blue and opacity, from 0 to 1.
    pub colors: Vec<Vec4>,
    pub triangles: Vec<[u32; 3]>,
    /// Cover all triangles in order; none is empty.
    pub parts: Vec<Part>,
}

/// A run of triangles that share a material name and a group name of the file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Part {
    pub material: Option<String>,
    pub group: Option<String>,
    pub triangles: Range<u32>,
}

impl MeshData {
    /// The corners of a triangle in double precision.
    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|i| self.positions[i as usize].as_dvec3())
    }

    /// Twice the triangle's area along its geometric normal: (b − a) × (c − a), in double precision.
    pub fn cross(&self, triangle: [u32; 3]) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// How many triangles have texture coordinates that span no area: in all three corners alike, or on a line.
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

    /// Removes what no ray should meet: degenerate and duplicate triangles, normals that are no numbers, unused vertices.
    ///
    /// - degenerate: the cross product is exactly zero in f64 (repeated or collinear corners); no epsilon
    /// - duplicate: the same three positions in any rotation, within one part; the first stays
    /// - a normal that is not finite becomes zero, that is flat
    pub fn clean(self) -> (MeshData, CleanReport) {
        clean::clean(self)
    }

    /// The mesh as it can be rendered: checked and cleaned; with warnings, sentences that begin with `name`.
    ///
    /// - `directionless`: normals that its reader has made zero already
    ///
    /// # Errors
    /// [`Error::Invalid`] where a triangle has a coordinate beyond [`MAX_COORDINATE`], or no triangle is left.
    pub fn usable(self, directionless: usize, name: &str) -> Result<(MeshData, Vec<String>)> {
        let fault = |message: String| Error::invalid(Fault::new(message).in_file(name));
        // Before the cleaning: so far out, f32 makes triangles degenerate that are not.
        let (reach, extent) = self.reach_and_extent();
        if reach > MAX_COORDINATE {
            return Err(fault(format!("extent {} exceeds {MAX_COORDINATE:e}", brief(extent))));
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

    /// Of all corners: the largest |coordinate| (infinite where one is no number), and the larger of it and the longest
    /// side of the bounding box.
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

    /// The length of the shortest edge.
    fn finest_detail(&self) -> f64 {
        let shortest = |t: &[u32; 3]| {
            let [a, b, c] = self.corners(*t);
            a.distance_squared(b).min(b.distance_squared(c)).min(c.distance_squared(a))
        };
        self.triangles.iter().map(shortest).fold(f64::INFINITY, f64::min).sqrt()
    }
}

/// Says so where `extent` is so much larger than `detail`, the size of something (`what`), that f32 loses it.
///
/// - `reach`: the largest |coordinate|
pub fn lost_detail(extent: f64, reach: f64, detail: f64, what: &str) -> Option<String> {
    if extent / detail <= MAX_DETAIL_RATIO {
        return None;
    }
    let reach = reach as f32;
    let ulp = f64::from(reach.next_up()) - f64::from(reach);
    let [extent, ratio, detail, ulp] = [extent, extent / detail, detail, ulp].map(brief);
    Some(format!("extent {extent} is {ratio} times the {what} {detail}; f32 steps by {ulp} out there (one ulp)"))
}

/// Three digits, without those that say nothing: 2e30, 1.25e-3.
fn brief(x: f64) -> String {
    format!("{:e}", format!("{x:.2e}").parse().unwrap_or(x))
}
