//! Ten triangles, one above the other, each turned by 10° more than the one below.

use glam::DVec3;
use pt::math::float::sin_cos_degrees;
use pt::shape::mesh_data::{MeshData, MeshPart};

const COUNT: u32 = 10;

/// Makes the mesh: right-angled triangles with legs of 1 m, stacked 1 m apart in height. The lowest faces +z.
pub fn triangles() -> MeshData {
    stacked(&[DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.5, 0.0, 0.0), DVec3::new(-0.5, 1.0, 0.0)], &[[0, 1, 2]])
}

/// Makes the triangles as closed prisms 10 cm thick, because glass must have an inside.
pub fn prisms() -> MeshData {
    let face = [[-0.5, 0.0], [0.5, 0.0], [-0.5, 1.0]];
    let corners: Vec<DVec3> = [0.05, -0.05].into_iter().flat_map(|z| face.map(|[x, y]| DVec3::new(x, y, z))).collect();
    let sides = [[0, 1, 2], [3, 5, 4], [0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]];
    stacked(&corners, &sides)
}

fn stacked(corners: &[DVec3], triangles: &[[u32; 3]]) -> MeshData {
    let mut mesh = MeshData::default();
    for i in 0..COUNT {
        let (sin, cos) = sin_cos_degrees(f64::from(10 * i));
        let first = mesh.positions.len() as u32;
        mesh.triangles.extend(triangles.iter().map(|t| t.map(|corner| first + corner)));
        let turned = |p: &DVec3| DVec3::new(cos * p.x + sin * p.z, p.y + f64::from(i), cos * p.z - sin * p.x).as_vec3();
        mesh.positions.extend(corners.iter().map(turned));
    }
    mesh.parts = vec![MeshPart { triangles: 0..mesh.triangles.len() as u32, ..MeshPart::default() }];
    mesh
}
