//! Half-edges of a mesh: which triangles are neighbours, and which triangles surround a vertex.

use std::fmt::Display;

use glam::DVec3;
use rayon::prelude::*;

use super::super::MeshData;
use super::super::places::places;

/// Number that stands for the missing half-edge on the other side of a border.
pub(super) const NONE: u32 = u32::MAX;

/// Neighbours of triangles, by half-edges: number 3t + k runs from corner k of triangle t to the next corner, counter-clockwise.
///
/// Two triangles are neighbours if an edge of one has the ends of an edge of the other: the same vertices, or otherwise vertices in the
/// same place, as on both sides of a seam of texture coordinates. A vertex is a fan of triangles of which each is the neighbour of the
/// next. Where several fans meet in one point only, each has a vertex of its own.
pub(super) struct Connectivity {
    /// Vertex at the start of each half-edge.
    pub vertex: Vec<u32>,
    /// Half-edge of the neighbour along the same edge, in the opposite direction; [`NONE`] at the border of the surface.
    pub twin: Vec<u32>,
    /// One half-edge that starts at each vertex; at the border the one without a twin.
    pub start: Vec<u32>,
    /// Number of triangles around each vertex.
    pub triangles_at: Vec<u32>,
}

/// Next half-edge of the same triangle.
pub(super) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// Previous half-edge of the same triangle.
pub(super) fn previous(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl Connectivity {
    /// Finds the neighbours of triangles.
    ///
    /// - `triangles`: wound consistently
    ///
    /// # Errors
    /// A sentence about an edge that no surface has: where more than two triangles meet, or two that are wound in opposite ways.
    pub fn new(mesh: &MeshData, triangles: &[[u32; 3]]) -> Result<Connectivity, String> {
        let mut twin = vec![NONE; 3 * triangles.len()];
        let all: Vec<u32> = (0..twin.len() as u32).collect();
        for edge in edges(triangles, all, |v| v).chunk_by(|a, b| a.0 == b.0) {
            if let &[(_, a), (_, b)] = edge
                && are_opposite(triangles, a, b, |v| v)
            {
                (twin[a as usize], twin[b as usize]) = (b, a);
            }
        }
        let places = places(&mesh.positions);
        let place = |v: u32| places[v as usize];
        let single = (0..twin.len() as u32).filter(|&h| twin[h as usize] == NONE).collect();
        for edge in edges(triangles, single, place).chunk_by(|a, b| a.0 == b.0) {
            match *edge {
                [_] => {}
                [(_, a), (_, b)] if are_opposite(triangles, a, b, place) => (twin[a as usize], twin[b as usize]) = (b, a),
                [(_, a), _] => return Err(format!("the two triangles at {} are wound in opposite ways", Edge::of(mesh, triangles, a))),
                [(_, a), ..] => {
                    let (count, edge) = (edge.len(), Edge::of(mesh, triangles, a));
                    return Err(format!("{count} triangles meet at {edge}, expected at most two"));
                }
                [] => {}
            }
        }
        Ok(Connectivity::of_twins(twin))
    }

    /// Numbers the vertices: one for each fan of triangles, in the order of their first half-edges.
    fn of_twins(twin: Vec<u32>) -> Connectivity {
        let mut fans = Connectivity { vertex: vec![NONE; twin.len()], twin, start: vec![], triangles_at: vec![] };
        for h in 0..fans.twin.len() as u32 {
            if fans.vertex[h as usize] == NONE {
                let start = fans.first_of_fan(h);
                let around: Vec<u32> = fans.fan(start).collect();
                around.iter().for_each(|&h| fans.vertex[h as usize] = fans.start.len() as u32);
                fans.start.push(start);
                fans.triangles_at.push(around.len() as u32);
            }
        }
        fans
    }

    /// The half-edge at the border with which the fan around the start of `h` begins; `h` itself within the surface.
    fn first_of_fan(&self, h: u32) -> u32 {
        let mut first = h;
        loop {
            match self.twin[first as usize] {
                NONE => return first,
                twin if next(twin) == h => return h,
                twin => first = next(twin),
            }
        }
    }

    /// Half-edges that start at the same vertex, counter-clockwise from `start`.
    fn fan(&self, start: u32) -> impl Iterator<Item = u32> {
        std::iter::successors(Some(start), move |&h| {
            let turned = self.twin[previous(h) as usize];
            (turned != NONE && turned != start).then_some(turned)
        })
    }

    /// One half-edge of each edge around a vertex, counter-clockwise as seen from the front; at the border from one edge on the border to the
    /// other. They start at the vertex, except the last one at the border, which ends there.
    pub fn edges_around(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let start = self.start[vertex as usize];
        let last = self.is_border(vertex).then(|| previous(self.fan(start).last().unwrap_or(start)));
        self.fan(start).chain(last)
    }

    /// Neighbours of a vertex, in the order of [`Connectivity::edges_around`].
    pub fn ring(&self, vertex: u32) -> impl Iterator<Item = u32> {
        self.edges_around(vertex).map(move |h| {
            let [from, to] = self.ends(h);
            if from == vertex { to } else { from }
        })
    }

    /// Whether a vertex is on the border of the surface.
    pub fn is_border(&self, vertex: u32) -> bool {
        self.twin[self.start[vertex as usize] as usize] == NONE
    }

    /// Both ends of a half-edge.
    pub fn ends(&self, h: u32) -> [u32; 2] {
        [self.vertex[h as usize], self.vertex[next(h) as usize]]
    }

    /// One half-edge of each edge, and the number of the edge of each half-edge.
    pub fn numbered_edges(&self) -> (Vec<u32>, Vec<u32>) {
        let (mut edges, mut number) = (vec![], vec![NONE; self.twin.len()]);
        for h in 0..self.twin.len() as u32 {
            let twin = self.twin[h as usize];
            if h < twin {
                number[h as usize] = edges.len() as u32;
                edges.push(h);
            } else {
                number[h as usize] = number[twin as usize];
            }
        }
        (edges, number)
    }

    /// The connectivity after each triangle t has become four: 4t + k at its corner k, and 4t + 3 in the middle.
    ///
    /// - `edges`, `number`: those of [`Connectivity::numbered_edges`]; the vertex on edge e gets the number of vertices + e
    pub fn divided(&self, edges: &[u32], number: &[u32]) -> Connectivity {
        let count = self.start.len() as u32;
        let vertex = divided_corners(&self.vertex, |h| count + number[h as usize]);
        let mut twin = vec![0; 4 * self.twin.len()];
        twin.par_chunks_exact_mut(12).enumerate().for_each(|(t, twins)| {
            let first = 12 * t as u32;
            for k in 0..3u32 {
                let before = (k + 2) % 3;
                // From corner k to the middle of its edge, across to the edge before it, and back to the corner.
                let corner =
                    [self.twin_of_half(3 * t as u32 + k, false), first + 9 + before, self.twin_of_half(3 * t as u32 + before, true)];
                twins[3 * k as usize..][..3].copy_from_slice(&corner);
                twins[9 + k as usize] = first + 3 * ((k + 1) % 3) + 1;
            }
        });
        let half = |&h: &u32, second: bool| half_of(h, second);
        let start = self.start.iter().map(|h| half(h, false)).chain(edges.iter().map(|h| half(h, true))).collect();
        let around = |h: &u32| if self.twin[*h as usize] == NONE { 3 } else { 6 };
        let triangles_at = self.triangles_at.iter().copied().chain(edges.iter().map(around)).collect();
        Connectivity { vertex, twin, start, triangles_at }
    }

    /// The twin of one half of a half-edge.
    fn twin_of_half(&self, h: u32, second: bool) -> u32 {
        match self.twin[h as usize] {
            NONE => NONE,
            twin => half_of(twin, !second),
        }
    }
}

/// What is at the start of each half-edge after each triangle has become four.
///
/// - `starts`: what is at the start of each half-edge before
/// - `middle`: what is in the middle of a half-edge
pub(super) fn divided_corners(starts: &[u32], middle: impl Fn(u32) -> u32 + Sync) -> Vec<u32> {
    let mut divided = vec![0; 4 * starts.len()];
    divided.par_chunks_exact_mut(12).enumerate().for_each(|(t, corners)| {
        let h = [0, 1, 2].map(|k| 3 * t as u32 + k);
        for k in 0..3 {
            corners[3 * k..][..3].copy_from_slice(&[starts[h[k] as usize], middle(h[k]), middle(h[(k + 2) % 3])]);
        }
        corners[9..].copy_from_slice(&h.map(&middle));
    });
    divided
}

/// The number that the first or the second half of a half-edge has after the division of all triangles.
fn half_of(h: u32, second: bool) -> u32 {
    let (t, k) = (h / 3, h % 3);
    if second { 12 * t + 3 * ((k + 1) % 3) + 2 } else { 12 * t + 3 * k }
}

/// Ends of some half-edges, the lesser number first, with the half-edge; sorted.
fn edges(triangles: &[[u32; 3]], half_edges: Vec<u32>, name: impl Fn(u32) -> u32 + Sync) -> Vec<([u32; 2], u32)> {
    let ends = |h: u32| {
        let [a, b] = ends(triangles, h).map(&name);
        ([a.min(b), a.max(b)], h)
    };
    let mut edges: Vec<([u32; 2], u32)> = half_edges.into_par_iter().map(ends).collect();
    edges.par_sort_unstable();
    edges
}

fn ends(triangles: &[[u32; 3]], h: u32) -> [u32; 2] {
    let corners = triangles[h as usize / 3];
    [corners[h as usize % 3], corners[next(h) as usize % 3]]
}

/// Whether two half-edges with the same ends run in opposite directions.
fn are_opposite(triangles: &[[u32; 3]], a: u32, b: u32, name: impl Fn(u32) -> u32) -> bool {
    let ([start, _], [_, end]) = (ends(triangles, a).map(&name), ends(triangles, b).map(&name));
    start == end && a / 3 != b / 3
}

/// An edge in a message.
struct Edge([DVec3; 2]);

impl Edge {
    fn of(mesh: &MeshData, triangles: &[[u32; 3]], h: u32) -> Edge {
        Edge(ends(triangles, h).map(|v| mesh.positions[v as usize].as_dvec3()))
    }
}

impl Display for Edge {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let [a, b] = self.0.map(|p| p.as_vec3());
        write!(f, "the edge from {:?} to {:?}", a.to_array(), b.to_array())
    }
}
