//! A coarse cage with six arms, for subdivision to round off.

use glam::{IVec3, Vec3};
use pt::shape::mesh_data::{MeshData, MeshPart};

/// Makes the cage: the hull of a cube from −1 to 1 m with an arm of the same width, 1.5 m long, on each of its faces. It is closed, of 60
/// triangles, and each of its corners is a vertex.
pub fn cage() -> MeshData {
    let mut mesh = MeshData::default();
    for axis in 0..3 {
        for sign in [-1, 1] {
            // Two directions along the face, so that u × v points outwards.
            let along = |k: usize| IVec3::AXES[(axis + k) % 3];
            let (out, u, v) = if sign > 0 { (along(0), along(1), along(2)) } else { (-along(0), along(2), along(1)) };
            let square = [-u - v, u - v, u + v, v - u];
            let base: Vec<u32> = square.iter().map(|corner| vertex(&mut mesh, 2 * (*corner + out))).collect();
            let tip: Vec<u32> = square.iter().map(|corner| vertex(&mut mesh, 2 * *corner + 5 * out)).collect();
            for k in 0..4 {
                let next = (k + 1) % 4;
                mesh.triangles.extend([[base[k], base[next], tip[next]], [base[k], tip[next], tip[k]]]);
            }
            mesh.triangles.extend([[tip[0], tip[1], tip[2]], [tip[0], tip[2], tip[3]]]);
        }
    }
    mesh.parts = vec![MeshPart { triangles: 0..mesh.triangles.len() as u32, ..MeshPart::default() }];
    mesh
}

/// The number of the vertex at a place, in half metres.
fn vertex(mesh: &mut MeshData, place: IVec3) -> u32 {
    let position: Vec3 = place.as_vec3() / 2.0;
    let number = mesh.positions.iter().position(|p| *p == position).unwrap_or(mesh.positions.len());
    if number == mesh.positions.len() {
        mesh.positions.push(position);
    }
    number as u32
}
