//! A pawn of a chess set: a profile turned about the y axis.

use glam::{DVec2, DVec3};
use pt::math::float::sin_cos_degrees;
use pt::shape::mesh_data::{MeshData, MeshPart};

/// Facets around the axis.
const SECTORS: u32 = 72;
/// Number of pieces of the curve between two points of the profile.
const PIECES: u32 = 4;

/// Makes the mesh of a pawn, 1 m high, that stands on y = 0 at the origin.
pub fn pawn() -> MeshData {
    let rings: Vec<(DVec2, DVec2)> = curve(&profile());
    let mut mesh = MeshData::default();
    for &(point, normal) in &rings {
        add_ring(&mut mesh, point, normal);
    }
    let last = rings.len() as u32 - 1;
    for ring in 0..last {
        for sector in 0..SECTORS {
            let next = (sector + 1) % SECTORS;
            let at = |ring: u32, sector: u32| ring * SECTORS + sector;
            let [a, b, c, d] = [at(ring, sector), at(ring, next), at(ring + 1, next), at(ring + 1, sector)];
            // Where a ring is a single point, one of the two triangles has no area.
            mesh.triangles.extend((ring > 0).then_some([a, b, c]));
            mesh.triangles.extend((ring + 1 < last).then_some([a, c, d]));
        }
    }
    mesh.parts = vec![MeshPart { triangles: 0..mesh.triangles.len() as u32, ..MeshPart::default() }];
    mesh.clean().0
}

/// Returns the profile as points (radius, height) from the middle of the foot to the top: foot, stem, collar, head.
fn profile() -> Vec<DVec2> {
    let turned = [
        [0.0, 0.0],
        [0.15, 0.0],
        [0.29, 0.0],
        [0.325, 0.008],
        [0.335, 0.035],
        [0.335, 0.065],
        [0.32, 0.095],
        [0.285, 0.11],
        [0.272, 0.122],
        [0.278, 0.14],
        [0.268, 0.165],
        [0.225, 0.2],
        [0.17, 0.255],
        [0.13, 0.33],
        [0.108, 0.42],
        [0.097, 0.52],
        [0.096, 0.585],
        [0.11, 0.615],
        [0.165, 0.632],
        [0.192, 0.645],
        [0.194, 0.66],
        [0.17, 0.675],
        [0.125, 0.69],
    ];
    const HEAD: (f64, f64) = (0.165, 0.835);
    let head = (3..=13).map(|i| {
        let (sin, cos) = sin_cos_degrees(f64::from(i) * 180.0 / 13.0);
        DVec2::new(HEAD.0 * sin, HEAD.1 - HEAD.0 * cos)
    });
    turned.into_iter().map(DVec2::from).chain(head).collect()
}

/// Points and outward unit normals of a smooth curve through the given points.
///
/// Source: Catmull and Rom, *A Class of Local Interpolating Splines* (1974).
fn curve(points: &[DVec2]) -> Vec<(DVec2, DVec2)> {
    let at = |i: i64| points[i.clamp(0, points.len() as i64 - 1) as usize];
    let slope = |i: i64| (at(i + 1) - at(i - 1)) / 2.0;
    let piece = |k: u32| {
        let (i, t) = (i64::from(k / PIECES), f64::from(k % PIECES) / f64::from(PIECES));
        let (p, q, m, n) = (at(i), at(i + 1), slope(i), slope(i + 1));
        let point = p + t * (m + t * (3.0 * (q - p) - 2.0 * m - n + t * (2.0 * (p - q) + m + n)));
        let along = m + t * (2.0 * (3.0 * (q - p) - 2.0 * m - n) + t * 3.0 * (2.0 * (p - q) + m + n));
        let outward = DVec2::new(along.y, -along.x).normalize();
        (point, outward)
    };
    (0..=(points.len() as u32 - 1) * PIECES).map(piece).collect()
}

fn add_ring(mesh: &mut MeshData, point: DVec2, normal: DVec2) {
    for sector in 0..SECTORS {
        let (sin, cos) = sin_cos_degrees(f64::from(sector) * 360.0 / f64::from(SECTORS));
        let turned = |v: DVec2| DVec3::new(v.x * cos, v.y, -v.x * sin).as_vec3();
        mesh.positions.push(turned(point));
        mesh.normals.push(turned(normal));
    }
}
