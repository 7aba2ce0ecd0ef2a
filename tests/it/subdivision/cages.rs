//! Coarse meshes.

use glam::DVec3;
use pt::shape::MeshData;
use pt::torture::meshes::{icosphere, mesh};

use super::{places, shaken};

/// A mesh by vertices and triangles. Coordinates are at most 2.
#[derive(Clone)]
pub struct Cage {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl Cage {
    pub fn data(&self) -> MeshData {
        mesh(places(&self.positions), self.triangles.clone())
    }
}

pub fn tetrahedron() -> Cage {
    let positions = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]].map(|p: [i32; 3]| DVec3::from(p.map(f64::from))).to_vec();
    Cage { positions, triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]] }
}

pub fn cube() -> Cage {
    let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) * 2.0 - 1.0;
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Cage { positions: (0..8).map(corner).collect(), triangles: faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect() }
}

pub fn icosahedron() -> Cage {
    let (positions, triangles) = icosphere(0);
    Cage { positions, triangles }
}

/// Two tips and a ring of n vertices between them. The first vertex is a tip with the valence n.
pub fn bipyramid(n: u32) -> Cage {
    let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let ring = (0..n).map(|i| DVec3::new(angle(i).cos(), angle(i).sin(), 0.0));
    let positions = [DVec3::Z, -DVec3::Z].into_iter().chain(ring).collect();
    let sides = |i: u32| [[0, 2 + i, 2 + (i + 1) % n], [1, 2 + (i + 1) % n, 2 + i]];
    Cage { positions, triangles: (0..n).flat_map(sides).collect() }
}

/// Two tips on the border and k + 1 vertices between them, k triangles at each tip. The first vertex is a tip.
pub fn half_bipyramid(k: u32) -> Cage {
    let angle = |i: u32| std::f64::consts::PI * f64::from(i) / f64::from(k);
    let ring = (0..=k).map(|i| DVec3::new(angle(i).cos(), angle(i).sin(), 0.0));
    let positions = [DVec3::Z, -DVec3::Z].into_iter().chain(ring).collect();
    let sides = |i: u32| [[0, 2 + i, 3 + i], [1, 3 + i, 2 + i]];
    Cage { positions, triangles: (0..k).flat_map(sides).collect() }
}

/// A ring with a hole, of n × m vertices with six neighbours each.
pub fn torus(n: u32, m: u32) -> Cage {
    let point = |i: u32, j: u32| {
        let [a, b] = [(i, n), (j, m)].map(|(i, n)| std::f64::consts::TAU * f64::from(i) / f64::from(n));
        let r = 1.0 + 0.4 * b.cos();
        DVec3::new(r * a.cos(), r * a.sin(), 0.4 * b.sin())
    };
    let at = |i: u32, j: u32| (i % n) * m + j % m;
    let cells = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let halves = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    Cage { positions: (0..n).flat_map(|i| (0..m).map(move |j| point(i, j))).collect(), triangles: cells.flat_map(halves).collect() }
}

/// A square of n × n cells in the plane z = 1/8, from −1 to 1.
pub fn square(n: u32) -> Cage {
    let point = |i: u32, j: u32| DVec3::new(2.0 * f64::from(i) / f64::from(n) - 1.0, 2.0 * f64::from(j) / f64::from(n) - 1.0, 0.125);
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let halves = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    Cage {
        positions: (0..=n).flat_map(|i| (0..=n).map(move |j| point(i, j))).collect(),
        triangles: (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).flat_map(halves).collect(),
    }
}

/// Closed cages with their Euler characteristics.
pub fn closed() -> Vec<(Cage, i64)> {
    vec![(tetrahedron(), 2), (cube(), 2), (icosahedron(), 2), (bipyramid(9), 2), (torus(5, 4), 0)]
}

/// Closed and open cages without symmetries, with vertices of many valences inside and on the border.
pub fn irregular() -> Vec<Cage> {
    let closed = closed().into_iter().map(|(cage, _)| cage);
    let open = [square(1), square(3), half_bipyramid(1), half_bipyramid(2), half_bipyramid(5), half_bipyramid(11)];
    closed.chain(open).enumerate().map(|(seed, cage)| shaken(cage, seed as u64, 0.2)).collect()
}
