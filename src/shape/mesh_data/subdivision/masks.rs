//! The weights of Loop subdivision.
//!
//! ```text
//! vertex     v' = (1 − s) v + s · mean of its neighbours           s = 3/8, and 9/16 with three neighbours
//!            limit:   the same with 1/2 for s, and 3/5 with three neighbours
//! edge       3/8 of both ends + 1/8 of both opposite corners
//! border     v' = 3/4 v + 1/8 of both neighbours on the border;    limit 2/3 and 1/6;    edge: 1/2 of both ends
//! ```
//!
//! Sources: Loop, *Smooth Subdivision Surfaces Based on Triangles* (1987), for edges; Warren, *Subdivision Methods for Geometric
//! Design* (1995), for vertices, as pbrt's `loopsubdiv` has them: β = s/n is 1/16 with six neighbours, where the surface is a box spline.
//! The border is a cubic B-spline of its vertices. The limit is s/(s + 3/8), from the left eigenvector of the subdivision matrix.
//!
//! At a border vertex with k triangles, an edge into the surface has 3/4 − γ of the vertex, γ of its other end and 1/8 of both opposite
//! corners, γ = 1/2 − cos(π/k)/4: with three triangles 3/8, as elsewhere. Source: Biermann, Levin and Zorin, *Piecewise Smooth Subdivision
//! Surfaces with Normal Control* (SIGGRAPH 2000). Without it the surface has no tangent plane where more than six triangles meet.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::connectivity::{Connectivity, NONE, previous};
use crate::math::float::sin_cos_f64;

/// A mesh while it is divided: its connectivity, and the position of each vertex.
pub(super) struct Vertices<'m> {
    pub mesh: &'m Connectivity,
    pub positions: &'m [DVec3],
}

impl Vertices<'_> {
    fn at(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize]
    }

    fn star(&self, vertex: u32) -> Star {
        let center = self.at(vertex);
        let spokes = self.mesh.ring(vertex).map(|neighbor| self.at(neighbor) - center).collect();
        Star { center, spokes, is_border: self.mesh.is_border(vertex) }
    }

    /// The one-ring of a vertex after one more division.
    ///
    /// After it, no neighbour needs the special weights of edges that end at a border vertex, so that the limit position follows from the
    /// one-ring alone.
    fn next_star(&self, vertex: u32) -> Star {
        let center = self.moved(vertex);
        let spokes = self.mesh.edges_around(vertex).map(|h| self.middle(h) - center).collect();
        Star { center, spokes, is_border: self.mesh.is_border(vertex) }
    }

    /// Position of a vertex after one more division.
    pub fn moved(&self, vertex: u32) -> DVec3 {
        let star = self.star(vertex);
        let share = if star.spokes.len() == 3 { 9.0 / 16.0 } else { 3.0 / 8.0 };
        if star.is_border { star.along_border(1.0 / 8.0) } else { star.towards_ring(share) }
    }

    /// Position of the vertex that divides an edge.
    pub fn middle(&self, h: u32) -> DVec3 {
        let ends = self.mesh.ends(h);
        let [a, b] = ends.map(|vertex| self.at(vertex));
        let twin = self.mesh.twin[h as usize];
        if twin == NONE {
            return 0.5 * (a + b);
        }
        let [c, d] = [h, twin].map(|h| self.at(self.mesh.vertex[previous(h) as usize]));
        let from_a = match ends.map(|vertex| self.mesh.is_border(vertex)) {
            [true, false] => 0.75 - self.border_share(ends[0]),
            [false, true] => self.border_share(ends[1]),
            _ => 0.375,
        };
        from_a * a + (0.75 - from_a) * b + 0.125 * (c + d)
    }

    /// The weight γ of the inner end of an edge from a border vertex into the surface.
    fn border_share(&self, vertex: u32) -> f64 {
        match self.mesh.triangles_at[vertex as usize] {
            3 => 0.375,
            count => 0.5 - 0.25 * sin_cos_f64(PI / f64::from(count)).1,
        }
    }

    /// Position of a vertex on the limit surface, and a vector along its normal there.
    pub fn limit(&self, vertex: u32) -> [DVec3; 2] {
        let star = self.next_star(vertex);
        let share = if star.spokes.len() == 3 { 3.0 / 5.0 } else { 1.0 / 2.0 };
        [if star.is_border { star.along_border(1.0 / 6.0) } else { star.towards_ring(share) }, star.normal()]
    }
}

/// A vertex, and the vectors from it to its neighbours, counter-clockwise; on the border from one neighbour there to the other.
struct Star {
    center: DVec3,
    spokes: Vec<DVec3>,
    is_border: bool,
}

impl Star {
    /// The centre moved by `share` towards the mean of its neighbours.
    fn towards_ring(&self, share: f64) -> DVec3 {
        self.center + self.spokes.iter().sum::<DVec3>() * (share / self.spokes.len() as f64)
    }

    /// The centre moved by `share` towards each of both neighbours on the border.
    fn along_border(&self, share: f64) -> DVec3 {
        let [first, last] = self.border();
        self.center + (first + last) * share
    }

    fn border(&self) -> [DVec3; 2] {
        [self.spokes.first(), self.spokes.last()].map(|spoke| spoke.copied().unwrap_or_default())
    }

    /// A vector along the normal of the limit surface, on the front; 0 where there is none.
    ///
    /// ```text
    /// inside        Σ cos(2π i/n) pᵢ × Σ sin(2π i/n) pᵢ
    /// border        (p₀ − pₖ) × ( Σ sin(iθ) pᵢ − sin θ v − C (1 + C) / (2 sin θ) (p₀ + pₖ) ),   θ = π/k,  C = cos θ
    /// one triangle  (p₀ − p₁) × (p₀ + p₁ − 2 v)
    /// ```
    ///
    /// for the neighbours pᵢ of v: the left eigenvectors of the second greatest eigenvalues. The weights of each sum add up to 0, so that the
    /// spokes pᵢ − v can stand for pᵢ.
    fn normal(&self) -> DVec3 {
        let (sin, cos) =
            if self.is_border { sin_cos_f64(PI / (self.spokes.len() - 1) as f64) } else { sin_cos_f64(TAU / self.spokes.len() as f64) };
        // The sine and cosine of i times the angle come by rotation.
        let (mut s, mut c) = (0.0, 1.0);
        let (mut by_cos, mut by_sin) = (DVec3::ZERO, DVec3::ZERO);
        for &spoke in &self.spokes {
            by_cos += c * spoke;
            by_sin += s * spoke;
            (s, c) = (s * cos + c * sin, c * cos - s * sin);
        }
        if !self.is_border {
            return by_cos.cross(by_sin);
        }
        let [first, last] = self.border();
        if self.spokes.len() == 2 {
            return (first - last).cross(first + last);
        }
        (first - last).cross(by_sin - cos * (1.0 + cos) / (2.0 * sin) * (first + last))
    }
}
