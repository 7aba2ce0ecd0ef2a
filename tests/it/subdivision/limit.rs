//! Where the limit surface is, and its normals.

use std::f64::consts::PI;

use glam::{DAffine3, DMat3, DVec3, Vec3};
use pt::shape::MeshData;

use super::cages::{Cage, bipyramid, half_bipyramid, irregular, square, torus};
use super::{ROUNDING, border, edges, largest_difference, places, shaken, subdivided};
use crate::random::Random;

/// Another level keeps the vertices that are there, because they are on the limit already, and their normals. That is true only if the
/// weights of the limit belong to those of the levels.
#[test]
fn the_limit_does_not_depend_on_the_level() {
    for (k, cage) in irregular().into_iter().enumerate() {
        let levels = [1, 2, 4].map(|levels| subdivided(&cage, levels));
        for finer in &levels[1..] {
            let moved = largest_difference(&levels[0].positions, &finer.positions);
            assert!(moved <= ROUNDING, "cage {k}: {moved:e}");
            // Normals are rounded once; their sums have few terms, of which none is far greater than the sum.
            let turned = largest_difference(&levels[0].normals, &finer.normals);
            assert!(turned <= ROUNDING, "cage {k}: {turned:e}");
        }
    }
}

/// A vertex and its neighbours, counter-clockwise; on the border from one neighbour there to the other.
struct Star {
    center: DVec3,
    ring: Vec<DVec3>,
    is_border: bool,
}

impl Star {
    /// The star of the first vertex of a cage, whose ring has the numbers from 2 on.
    fn of(cage: &Cage, is_border: bool) -> Star {
        let rounded = |p: &DVec3| p.as_vec3().as_dvec3();
        Star { center: rounded(&cage.positions[0]), ring: cage.positions[2..].iter().map(rounded).collect(), is_border }
    }

    /// The star after one level, by the rules for vertices and edges.
    fn next(&self) -> Star {
        let (v, p, n) = (self.center, &self.ring, self.ring.len());
        if self.is_border {
            let inner = 0.5 - 0.25 * (PI / (n - 1) as f64).cos();
            let spoke = |i: usize| match i {
                i if i == 0 || i == n - 1 => 0.5 * (v + p[i]),
                i => (0.75 - inner) * v + inner * p[i] + 0.125 * (p[i - 1] + p[i + 1]),
            };
            return Star { center: 0.75 * v + 0.125 * (p[0] + p[n - 1]), ring: (0..n).map(spoke).collect(), is_border: true };
        }
        // Warren's weights.
        let beta = if n == 3 { 3.0 / 16.0 } else { 3.0 / (8.0 * n as f64) };
        let spoke = |i: usize| 0.375 * (v + p[i]) + 0.125 * (p[(i + 1) % n] + p[(i + n - 1) % n]);
        let center = (1.0 - n as f64 * beta) * v + beta * p.iter().sum::<DVec3>();
        Star { center, ring: (0..n).map(spoke).collect(), is_border: false }
    }

    /// The mean normal of the triangles around the centre.
    fn normal(&self) -> DVec3 {
        let (n, v) = (self.ring.len(), self.center);
        let count = if self.is_border { n - 1 } else { n };
        (0..count).map(|i| (self.ring[i] - v).cross(self.ring[(i + 1) % n] - v)).sum::<DVec3>().normalize()
    }
}

/// The limit of a vertex with any number of neighbours, and its normal, are those that repeated subdivision approaches. Positions
/// approach it by at least 0.61 with each level, normals by the ratio of the third and the second eigenvalue, at most 0.988 for up to 24
/// neighbours.
#[test]
fn vertices_of_any_valence_are_where_repeated_subdivision_leads() {
    for n in 3..=24 {
        for (is_border, cage) in [(false, bipyramid(n)), (true, half_bipyramid(n)), (true, half_bipyramid(n - 2))] {
            let cage = shaken(cage, n.into(), 0.1);
            let mut star = Star::of(&cage, is_border);
            (0..200).for_each(|_| star = star.next());
            // Differences of the star are kept at their size, which changes no direction.
            let mut directions = Star::of(&cage, is_border);
            for _ in 0..2000 {
                directions = directions.next();
                let size = directions.ring.iter().map(|p| p.distance(directions.center)).fold(0.0, f64::max);
                let center = directions.center;
                directions.ring.iter_mut().for_each(|p| *p = (*p - center) / size);
                directions.center = DVec3::ZERO;
            }
            for levels in 1..=2 {
                let data = subdivided(&cage, levels);
                let error = data.positions[0].as_dvec3().distance(star.center);
                assert!(error <= ROUNDING, "{n} neighbours, border: {is_border}, {levels} levels: {error:e}");
                // One triangle alone at the border has no directions besides the tangent of the border that repetition would show.
                if cage.positions.len() > 4 {
                    let (found, expected) = (data.normals[0].as_dvec3(), directions.normal());
                    assert!(found.distance(expected) < 1e-5, "{n} neighbours, border: {is_border}: {found} instead of {expected}");
                }
            }
        }
    }
}

/// With six neighbours everywhere the surface is a box spline: at a vertex 1/2 of it and 1/12 of each neighbour.
#[test]
fn regular_meshes_are_box_splines() {
    let (n, m) = (6, 5);
    let cage = shaken(torus(n, m), 1, 0.1);
    let at = |i: u32, j: u32| cage.positions[((i % n) * m + j % m) as usize].as_vec3().as_dvec3();
    let data = subdivided(&cage, 1);
    // The vertices of the cage come first, in the order in which triangles begin or continue with them.
    let mut order: Vec<u32> = vec![];
    cage.triangles.iter().flatten().for_each(|v| order.extend(Some(*v).filter(|v| !order.contains(v))));
    for (k, v) in order.into_iter().enumerate() {
        let (i, j) = (v / m + n, v % m + m);
        let neighbors = [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), at(i - 1, j), at(i - 1, j - 1), at(i, j - 1)];
        let expected = at(i, j) / 2.0 + neighbors.into_iter().sum::<DVec3>() / 12.0;
        let error = data.positions[k].as_dvec3().distance(expected);
        assert!(error <= ROUNDING, "{v}: {error:e}");
    }
}

/// A point of the closed uniform cubic B-spline with these control points, at the parameter i + t.
fn spline(points: &[DVec3], i: usize, t: f64) -> DVec3 {
    let p = [points.len() - 1, 0, 1, 2].map(|k| points[(i + k) % points.len()]);
    let weights = [(1.0 - t).powi(3), 3.0 * t.powi(3) - 6.0 * t * t + 4.0, -3.0 * t.powi(3) + 3.0 * t * t + 3.0 * t + 1.0, t.powi(3)];
    (0..4).map(|k| weights[k] / 6.0 * p[k]).sum()
}

/// The vertices of a border, in order.
fn border_points(data: &MeshData) -> Vec<DVec3> {
    let border = border(&data.triangles);
    let first = *border.keys().next().expect("a border");
    let mut points = vec![];
    let mut at = first;
    loop {
        points.push(data.positions[at as usize].as_dvec3());
        at = border[&at];
        if at == first {
            return points;
        }
    }
}

/// The border is the B-spline of the border vertices of the cage, at parameters of equal distance.
#[test]
fn borders_are_cubic_b_splines() {
    for (k, cage) in [square(3), half_bipyramid(1), half_bipyramid(7)].into_iter().enumerate() {
        let cage = shaken(cage, k as u64, 0.1);
        let controls = border_points(&cage.data());
        for levels in 1..=4 {
            let parts = 1 << levels;
            let expected: Vec<DVec3> = (0..controls.len())
                .flat_map(|i| (0..parts).map(move |k| (i, f64::from(k) / f64::from(parts))))
                .map(|(i, t)| spline(&controls, i, t))
                .collect();
            let found = border_points(&subdivided(&cage, levels));
            assert_eq!(found.len(), expected.len());
            // The two may begin at different vertices.
            let shift =
                (0..expected.len()).min_by(|&a, &b| found[0].distance(expected[a]).total_cmp(&found[0].distance(expected[b]))).unwrap();
            for (i, p) in found.iter().enumerate() {
                let error = p.distance(expected[(i + shift) % expected.len()]);
                assert!(error <= ROUNDING, "border {k}, level {levels}: {error:e}");
            }
        }
    }
}

/// A flat mesh stays in its plane to the bit, with its normal. Its area is that within the border, because nothing folds. Away from the
/// border a regular mesh stays as it is, divided evenly.
#[test]
fn a_flat_mesh_stays_flat() {
    for levels in 1..=4 {
        let data = subdivided(&square(8), levels);
        assert!(data.positions.iter().all(|p| p.z == 0.125) && data.normals.iter().all(|n| *n == Vec3::Z));
        let triangles: f64 = data.triangles.iter().map(|&t| 0.5 * data.cross(t).z).sum();
        let border = border_points(&data);
        let next = |i: usize| border[(i + 1) % border.len()];
        let within: f64 = border.iter().enumerate().map(|(i, p)| 0.5 * p.truncate().perp_dot(next(i).truncate())).sum();
        assert!((triangles - within).abs() < 1e-5 && within > 3.9 && within < 4.0, "{triangles} {within}");
        assert!(data.triangles.iter().all(|&t| data.cross(t).z > 0.0));
        let step = 8.0 / f64::from(1 << levels) / 32.0;
        for p in data.positions.iter().filter(|p| p.truncate().abs().max_element() < 0.5) {
            let cells = (p.truncate().as_dvec2() + 1.0) / step;
            assert!((cells - cells.round()).abs().max_element() * step < ROUNDING, "{p} is between the points of the grid");
        }
        let inner = |v: u32| data.positions[v as usize].truncate().abs().max_element() < 0.5;
        let sides = edges(&data.triangles).into_keys().filter(|edge| edge.iter().all(|v| inner(*v)));
        for [a, b] in sides {
            let side = (data.positions[a as usize] - data.positions[b as usize]).as_dvec3().abs();
            assert!(side.max_element() < step + ROUNDING, "{side} is not {step} long");
        }
    }
}

/// Subdivision takes weighted means, so that it makes no difference whether a transform acts before or after it. A power of two changes no
/// bit but that of the exponent.
#[test]
fn transforms_may_act_before_or_after() {
    for (k, cage) in irregular().into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        let matrix = DMat3::from_cols(random.in_cube(), random.in_cube(), random.in_cube());
        let place = DAffine3::from_mat3_translation(matrix, random.in_cube());
        let data = subdivided(&cage, 2);
        let rounded = |p: &DVec3| place.transform_point3(p.as_vec3().as_dvec3());
        let placed = subdivided(&Cage { positions: cage.positions.iter().map(rounded).collect(), ..cage.clone() }, 2);
        let after: Vec<DVec3> = data.positions.iter().map(|p| place.transform_point3(p.as_dvec3())).collect();
        // Coordinates are up to 7 after the transform.
        let error = largest_difference(&placed.positions, &places(&after));
        assert!(error < 16.0 * ROUNDING, "{error:e}");
        for power in [-60, -1, 7, 40] {
            let scale = 2f32.powi(power);
            let scaled = Cage { positions: cage.positions.iter().map(|p| *p * f64::from(scale)).collect(), ..cage.clone() };
            let scaled = subdivided(&scaled, 2);
            assert!(scaled.positions.iter().zip(&data.positions).all(|(a, b)| *a == *b * scale) && scaled.normals == data.normals);
        }
    }
}
