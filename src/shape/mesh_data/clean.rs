//! Cleaning of meshes, and the report about it.

use glam::{DVec3, Vec3};

use super::MeshData;

/// Numbers of changes by cleaning; all zero for a sound mesh.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CleanReport {
    /// Removed triangles without area.
    pub degenerate: usize,
    /// Removed triangles that were equal to another.
    pub duplicate: usize,
    /// Normals without direction (zero or not finite), which now mark a flat surface.
    pub directionless: usize,
    /// Triangles whose corner normals all point away from their geometric normal. They are not changed.
    pub opposed: usize,
}

impl CleanReport {
    /// One sentence for each kind of change.
    pub fn warnings(&self, name: &str) -> Vec<String> {
        let kinds = [
            (self.degenerate, "degenerate triangle", " dropped"),
            (self.duplicate, "duplicate triangle", " dropped"),
            (self.directionless, "normal", " without direction replaced by the face normal"),
            (self.opposed, "triangle", " wound against its normals (the winding decides which side is front)"),
        ];
        let sentence = |(count, what, then): (usize, &str, &str)| {
            let plural = if count == 1 { "" } else { "s" };
            let then = if count == 1 { then.to_string() } else { then.replace("its normals", "their normals") };
            format!("{name}: {count} {what}{plural}{then}")
        };
        kinds.into_iter().filter(|kind| kind.0 > 0).map(sentence).collect()
    }
}

/// See [`MeshData::clean`].
pub(super) fn clean(mut mesh: MeshData) -> (MeshData, CleanReport) {
    let mut report = CleanReport { directionless: flatten_directionless(&mut mesh.normals), ..CleanReport::default() };
    let crosses = mesh.triangles.iter().map(|&t| mesh.cross(t));
    let mut keep = Vec::with_capacity(mesh.triangles.len());
    for (&triangle, cross) in mesh.triangles.iter().zip(crosses) {
        let usable = cross != DVec3::ZERO;
        report.degenerate += usize::from(!usable);
        report.opposed += usize::from(usable && opposes_normals(&mesh, triangle, cross));
        keep.push(usable);
    }
    for triangle in duplicates(&mesh, &keep) {
        keep[triangle as usize] = false;
        report.duplicate += 1;
    }
    if report.degenerate + report.duplicate > 0 {
        retain(&mut mesh, &keep);
    }
    drop_unused_vertices(&mut mesh);
    (mesh, report)
}

/// Sets normals that are not finite to zero and counts them. Empties an array of zeros, which has no information.
fn flatten_directionless(normals: &mut Vec<Vec3>) -> usize {
    let mut count = 0;
    for normal in normals.iter_mut().filter(|n| !n.is_finite()) {
        *normal = Vec3::ZERO;
        count += 1;
    }
    if normals.iter().all(|&n| n == Vec3::ZERO) {
        *normals = Vec::new();
    }
    count
}

/// Whether all corner normals point away from the geometric normal.
fn opposes_normals(mesh: &MeshData, triangle: [u32; 3], cross: DVec3) -> bool {
    !mesh.normals.is_empty() && triangle.iter().all(|&i| mesh.normals[i as usize].as_dvec3().dot(cross) < 0.0)
}

/// Bits of the positions, rotated so that the smallest comes first. They are equal for equal triangles, and −0 equals 0.
fn outline(mesh: &MeshData, triangle: [u32; 3]) -> [[u32; 3]; 3] {
    let mut corners = triangle.map(|i| (mesh.positions[i as usize] + 0.0).to_array().map(f32::to_bits));
    let first = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
    corners.rotate_left(first);
    corners
}

/// Kept triangles that are equal to an earlier one of their part.
///
/// Sorting by hash groups equal triangles with 12 bytes per triangle. Triangles with equal hashes are compared in full by sorting
/// again, so that no input takes quadratic time.
fn duplicates(mesh: &MeshData, keep: &[bool]) -> Vec<u32> {
    let key = |part: usize, t: u32| (part, outline(mesh, mesh.triangles[t as usize]));
    let mut hashed = Vec::with_capacity(mesh.triangles.len());
    for (part, range) in mesh.parts.iter().map(|p| p.triangles.clone()).enumerate() {
        for t in range.filter(|&t| keep[t as usize]) {
            hashed.push((hash(key(part, t)), t));
        }
    }
    hashed.sort_unstable();
    let part_of = |t: u32| mesh.parts.partition_point(|p| p.triangles.end <= t);
    let mut repeated = Vec::new();
    for equal_hash in hashed.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        let mut run: Vec<_> = equal_hash.iter().map(|&(_, t)| (key(part_of(t), t), t)).collect();
        run.sort_unstable();
        repeated.extend(run.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| pair[1].1));
    }
    repeated
}

/// Multiplicative hash (Knuth) of a triangle.
fn hash((part, outline): (usize, [[u32; 3]; 3])) -> u64 {
    let mix = |hash: u64, &word: &u32| (hash ^ u64::from(word)).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    outline.as_flattened().iter().fold(part as u64, mix)
}

/// Removes the triangles that are not marked, and the parts that become empty.
fn retain(mesh: &mut MeshData, keep: &[bool]) {
    let mut kept = 0;
    for part in &mut mesh.parts {
        let start = kept;
        kept += part.triangles.clone().filter(|&t| keep[t as usize]).count() as u32;
        part.triangles = start..kept;
    }
    mesh.parts.retain(|part| !part.triangles.is_empty());
    let mut marks = keep.iter();
    mesh.triangles.retain(|_| marks.next() == Some(&true));
}

/// Removes the vertices that no triangle uses, because they would enlarge the bounds.
fn drop_unused_vertices(mesh: &mut MeshData) {
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&i| used[i as usize] = true);
    if used.iter().all(|&u| u) {
        return;
    }
    let mut used_before = 0;
    let new_index = |&is_used: &bool| {
        used_before += u32::from(is_used);
        used_before - u32::from(is_used)
    };
    let renamed: Vec<u32> = used.iter().map(new_index).collect();
    mesh.triangles.iter_mut().flatten().for_each(|i| *i = renamed[*i as usize]);
    keep_used(&mut mesh.positions, &used);
    keep_used(&mut mesh.normals, &used);
    keep_used(&mut mesh.uvs, &used);
    keep_used(&mut mesh.colors, &used);
}

fn keep_used<T>(values: &mut Vec<T>, used: &[bool]) {
    let mut marks = used.iter();
    values.retain(|_| marks.next() == Some(&true));
}
