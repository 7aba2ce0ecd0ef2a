//! A flag that waves: at the pole (x = 0) it is held, and waves run along it.

use glam::{Vec2, Vec3};
use pt::math::float::sin_cos;
use pt::shape::mesh_data::{MeshData, MeshPart};

const COLUMNS: u32 = 32;
const ROWS: u32 = 20;
/// Width and height (m).
const SIZE: Vec2 = Vec2::new(1.5, 1.0);

/// The flag in the plane z = 0 but for its waves, from the pole to +x and from y = 0 up.
///
/// - `phase`: that of the waves (rad)
pub fn flag(phase: f32) -> MeshData {
    let mut mesh = MeshData::default();
    for (i, j) in (0..=ROWS).flat_map(|j| (0..=COLUMNS).map(move |i| (i, j))) {
        let uv = Vec2::new(i as f32 / COLUMNS as f32, j as f32 / ROWS as f32);
        let p = uv * SIZE;
        // z = a x sin(k x + m y − phase)
        let (a, k, m) = (0.15, 6.0, 1.5);
        let (sin, cos) = sin_cos(k * p.x + m * p.y - phase);
        let slope = Vec2::new(a * (sin + k * p.x * cos), a * m * p.x * cos);
        mesh.positions.push(p.extend(a * p.x * sin));
        mesh.normals.push(Vec3::new(-slope.x, -slope.y, 1.0));
        mesh.uvs.push(uv);
    }
    for (i, j) in (0..ROWS).flat_map(|j| (0..COLUMNS).map(move |i| (i, j))) {
        let at = |i: u32, j: u32| j * (COLUMNS + 1) + i;
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh.parts = vec![MeshPart { triangles: 0..mesh.triangles.len() as u32, ..MeshPart::default() }];
    mesh
}
