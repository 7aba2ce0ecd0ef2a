//! Cleaning of meshes: the parts that are removed or kept, and the report.

use super::*;
use pt::shape::mesh_data::{CleanReport, MeshPart};

fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> MeshData {
    let part = MeshPart { triangles: 0..triangles.len() as u32, ..MeshPart::default() };
    MeshData {
        positions: positions.iter().copied().map(Vec3::from).collect(),
        triangles: triangles.to_vec(),
        parts: vec![part],
        ..MeshData::default()
    }
}

#[test]
fn degeneracy_is_decided_exactly() {
    // Triangles of any size are kept: 2⁻¹⁴⁰ is subnormal in f32, and its square underflows to 0.
    for exponent in [-140, -60, -20, 0, 20, 59] {
        let s = 2_f64.powi(exponent) as f32;
        let (kept, report) = mesh(&[[0.0; 3], [s, 0.0, 0.0], [0.0, s, 0.0]], &[[0, 1, 2]]).clean();
        assert_eq!((kept.triangles.len(), report), (1, CleanReport::default()), "2^{exponent}");
        // A corner that is one ulp off the line makes a triangle. One on the line does not, although the corners differ.
        let off = mesh(&[[s, s, 0.0], [2.0 * s, 2.0 * s, 0.0], [4.0 * s, (4.0 * s).next_up(), 0.0]], &[[0, 1, 2]]).clean();
        assert_eq!(off.1.degenerate, 0, "2^{exponent}");
        let on = mesh(&[[s, s, 0.0], [2.0 * s, 2.0 * s, 0.0], [4.0 * s, 4.0 * s, 0.0]], &[[0, 1, 2]]).clean();
        assert_eq!(on.1.degenerate, 1, "2^{exponent}");
    }
}

#[test]
fn duplicates_merge_within_their_part_only() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, -0.0, 0.0]];
    // The last vertex equals the first. The reversed triangle has the other orientation and is kept.
    let triangles = [[0, 1, 2], [1, 2, 3], [2, 0, 1], [0, 2, 1], [0, 1, 2], [3, 1, 2]];
    let mut two_parts = mesh(&corners, &triangles);
    two_parts.parts = vec![MeshPart { triangles: 0..4, ..MeshPart::default() }, MeshPart { triangles: 4..6, ..MeshPart::default() }];
    let (clean, report) = two_parts.clean();
    assert_eq!(report, CleanReport { duplicate: 3, ..CleanReport::default() });
    assert_eq!(clean.triangles, [[0, 1, 2], [0, 2, 1], [0, 1, 2]]);
    assert_eq!(clean.parts.iter().map(|p| p.triangles.clone()).collect::<Vec<_>>(), [0..2, 2..3]);
    assert_eq!(clean.positions.len(), 3, "the unused vertex is gone");
}

#[test]
fn empty_parts_and_unused_vertices_are_removed() {
    let mut spotty = mesh(&[[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[1, 1, 2], [1, 2, 3]]);
    spotty.parts = vec![MeshPart { triangles: 0..1, ..MeshPart::default() }, MeshPart { triangles: 1..2, ..MeshPart::default() }];
    spotty.uvs = (0..4).map(|i| Vec2::splat(i as f32)).collect();
    let (clean, report) = spotty.clean();
    assert_sound(&clean);
    assert_eq!(report.degenerate, 1);
    assert_eq!((clean.parts.len(), clean.uvs), (1, vec![Vec2::ONE, Vec2::splat(2.0), Vec2::splat(3.0)]));
}

#[test]
fn normals_that_are_no_numbers_become_flat() {
    let mut odd = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    odd.normals = vec![Vec3::NAN, Vec3::new(0.0, f32::INFINITY, 0.0), Vec3::Z];
    let (clean, report) = odd.clone().clean();
    assert_eq!((clean.normals, report.directionless), (vec![Vec3::ZERO, Vec3::ZERO, Vec3::Z], 2));
    odd.normals = vec![Vec3::ZERO; 3];
    assert_eq!(odd.clone().clean().0.normals, [], "all flat is no normals");
    odd.normals = vec![Vec3::NEG_Z; 3];
    let (clean, report) = odd.clean();
    assert_eq!((clean.normals.len(), report), (3, CleanReport { opposed: 1, ..CleanReport::default() }));
}

#[test]
fn the_cleaning_report_is_in_sentences() {
    let report = CleanReport { degenerate: 12, duplicate: 1, directionless: 2, opposed: 3 };
    assert_eq!(
        report.warnings("mesh.obj"),
        [
            "mesh.obj: 12 degenerate triangles dropped",
            "mesh.obj: 1 duplicate triangle dropped",
            "mesh.obj: 2 normals without direction replaced by the face normal",
            "mesh.obj: 3 triangles wound against their normals (the winding decides which side is front)",
        ]
    );
    assert_eq!(CleanReport::default().warnings("mesh.obj"), [""; 0]);
}
