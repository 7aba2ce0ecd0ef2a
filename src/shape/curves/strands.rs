//! Many curves in world space, in pieces.

use std::ops::Range;

use glam::{DVec3, DVec4, Vec4};

use super::Basis;
use super::packed_normal::PackedNormal;
use super::piece::Cubic;

/// The control points of many curves, and where each curve begins.
pub(super) struct Strands {
    basis: Basis,
    /// Position (m) and radius (m) of the control points, curve after curve.
    points: Vec<Vec4>,
    /// Normals at the control points, for ribbons; empty for tubes.
    normals: Vec<PackedNormal>,
    /// First span of each curve; at the end, the number of all spans.
    curves: Vec<u32>,
    /// Curve of each [`STEP`]th span.
    curve_at: Vec<u32>,
    /// Number of pieces of a span.
    parts: u32,
    /// Whether any two pieces meet in a kink.
    has_kinks: bool,
}

/// Number of spans from one entry of [`Strands::curve_at`] to the next.
const STEP: usize = 16;

/// Greatest number of control points.
pub(super) const MOST_POINTS: usize = 1 << 30;

/// Length of a span in radii above which it is worth several pieces.
const SLENDER: f64 = 32.0;

/// Place of a piece: on which curve, and on which part of it.
pub(super) struct Place {
    /// Unit tangent at the beginning of the curve.
    pub root: DVec3,
    /// Share of the curve at which the piece begins, by its spans.
    pub from: f64,
    /// Share of the curve that the piece is.
    pub length: f64,
}

impl Place {
    /// The share of the curve at the coordinate s of the piece, limited to the piece.
    pub fn at(&self, s: f64) -> f32 {
        (self.from + self.length * s.clamp(0.0, 1.0)) as f32
    }
}

impl Strands {
    /// - `counts`: number of control points of each curve, which are no more and no less than those of its spans
    pub fn new(basis: Basis, points: Vec<Vec4>, normals: Vec<PackedNormal>, counts: impl Iterator<Item = usize>) -> Strands {
        let mut curves = vec![0];
        let mut spans = 0;
        curves.extend(counts.map(|count| {
            spans += basis.spans(count) as u32;
            spans
        }));
        curves.shrink_to_fit();
        let mut strands = Strands { basis, points, normals, curves, curve_at: vec![], parts: 1, has_kinks: false };
        let starts = (0..spans).step_by(STEP);
        strands.curve_at = starts.map(|span| strands.curves.partition_point(|first| *first <= span) as u32 - 1).collect();
        strands.has_kinks = strands.finds_kinks();
        strands.parts = strands.fitting_parts();
        strands
    }

    /// Number of spans.
    fn spans(&self) -> u32 {
        self.curves.last().copied().unwrap_or(0)
    }

    /// The curve of a span.
    fn curve(&self, span: u32) -> usize {
        let mut curve = self.curve_at[span as usize / STEP] as usize;
        while self.curves[curve + 1] <= span {
            curve += 1;
        }
        curve
    }

    /// Places of the control points of a curve.
    fn points(&self, curve: usize) -> Range<usize> {
        let start = |curve: usize| self.basis.stride() * self.curves[curve] as usize + self.basis.rest() * curve;
        start(curve)..start(curve + 1)
    }

    /// Whether any two spans meet in a kink. Splines of the other bases are smooth.
    fn finds_kinks(&self) -> bool {
        let has_kink = |curve: &[u32]| (curve[0] + 1..curve[1]).any(|span| self.span(span - 1).has_kink(&self.span(span)));
        matches!(self.basis, Basis::Linear | Basis::Bezier) && self.curves.windows(2).any(has_kink)
    }

    /// Whether any two pieces meet in a kink.
    pub fn has_kinks(&self) -> bool {
        self.has_kinks
    }

    /// The number of pieces of each span: [`Basis::most_parts`] if most spans are slender, so that capsules and boxes fit well; otherwise 1.
    fn fitting_parts(&self) -> u32 {
        let slender = |span: u32| {
            let Cubic(b) = self.span(span);
            let length = (b[3] - b[0]).truncate().length();
            length / (0.25 * (b[0] + b[1] + b[2] + b[3]).w.max(f64::MIN_POSITIVE)) > SLENDER
        };
        // Some of the spans stand for all.
        let step = (self.spans() / 1000).max(1) as usize;
        let seen = || (0..self.spans()).step_by(step);
        if 2 * seen().filter(|span| slender(*span)).count() > seen().count() { self.basis.most_parts() } else { 1 }
    }

    /// Number of pieces.
    pub fn count(&self) -> u32 {
        self.spans() * self.parts
    }

    /// A piece: its position and radius.
    pub fn piece(&self, i: u32) -> Cubic {
        self.part(self.span(i / self.parts), i)
    }

    /// Normals of a piece of a ribbon, as a cubic without a radius.
    pub fn normals(&self, i: u32) -> Cubic {
        let span = i / self.parts;
        let curve = self.curve(span);
        let of_curve = &self.normals[self.points(curve)];
        self.part(Cubic(self.basis.bezier(of_curve, (span - self.curves[curve]) as usize, |n| n.unit().extend(0.0))), i)
    }

    /// The part of its span that a piece is.
    fn part(&self, span: Cubic, i: u32) -> Cubic {
        let at = |k: u32| f64::from(k) / f64::from(self.parts);
        let k = i % self.parts;
        if self.parts == 1 { span } else { span.part([at(k), at(k + 1)]) }
    }

    fn span(&self, span: u32) -> Cubic {
        let curve = self.curve(span);
        self.basis.span(&self.points[self.points(curve)], (span - self.curves[curve]) as usize)
    }

    /// The piece before this one on the same curve; `None` at its beginning.
    pub fn before(&self, i: u32) -> Option<u32> {
        let span = i / self.parts;
        let is_first = i.is_multiple_of(self.parts) && self.curves[self.curve(span)] == span;
        (!is_first).then(|| i - 1)
    }

    /// The piece after this one on the same curve; `None` at its end.
    pub fn after(&self, i: u32) -> Option<u32> {
        let span = i / self.parts;
        let is_last = (i + 1).is_multiple_of(self.parts) && self.curves[self.curve(span) + 1] == span + 1;
        (!is_last).then(|| i + 1)
    }

    /// Where on its curve a piece lies.
    pub fn place(&self, i: u32) -> Place {
        let curve = self.curve(i / self.parts);
        let (first, end) = (self.curves[curve], self.curves[curve + 1]);
        let pieces = f64::from((end - first) * self.parts);
        Place { root: self.span(first).tangent(0.0), from: f64::from(i - first * self.parts) / pieces, length: 1.0 / pieces }
    }
}

impl Basis {
    /// Number of control points from one span to the next.
    fn stride(self) -> usize {
        match self {
            Basis::Bezier => 3,
            Basis::Linear | Basis::Bspline | Basis::CatmullRom => 1,
        }
    }

    /// Greatest number of pieces of a span. A hair of four points then takes at most 200 bytes: 68, and 40 to 60 for each piece.
    fn most_parts(self) -> u32 {
        match self {
            Basis::Bezier => 3,
            Basis::Bspline => 2,
            // Four points are three spans.
            Basis::Linear | Basis::CatmullRom => 1,
        }
    }

    /// Number of control points of a curve beyond those from one span to the next.
    fn rest(self) -> usize {
        match self {
            Basis::Linear | Basis::Bezier | Basis::CatmullRom => 1,
            Basis::Bspline => 3,
        }
    }

    /// Number of spans of a curve with some control points.
    pub(super) fn spans(self, points: usize) -> usize {
        points.saturating_sub(self.rest()) / self.stride()
    }

    /// Number of control points that are part of a span, of some control points.
    pub(super) fn used(self, points: usize) -> usize {
        match self.spans(points) {
            0 => 0,
            spans => spans * self.stride() + self.rest(),
        }
    }

    /// A span of a curve.
    ///
    /// - `points`: all control points of the curve
    /// - `k`: number of the span
    pub(super) fn span(self, points: &[Vec4], k: usize) -> Cubic {
        // Between points of very different radii, a smooth curve through them would fall below 0.
        Cubic(self.bezier(points, k, |b| b.as_dvec4()).map(|b| DVec4 { w: b.w.max(0.0), ..b }))
    }

    /// A span of a curve as a Bézier curve, see [`Basis::span`].
    ///
    /// A Catmull–Rom spline reaches its first point and its last because the mirror images of the second and the second to last follow them.
    fn bezier<T: Copy>(self, points: &[T], k: usize, wide: impl Fn(T) -> DVec4) -> [DVec4; 4] {
        let at = |j: usize| wide(points[k * self.stride() + j]);
        let mirrored = |end: usize, next: usize| 2.0 * wide(points[end]) - wide(points[next]);
        match self {
            Basis::Linear => {
                let (a, b) = (at(0), at(1));
                [a, a + (b - a) / 3.0, b - (b - a) / 3.0, b]
            }
            Basis::Bezier => [0, 1, 2, 3].map(at),
            Basis::Bspline => {
                let [a, b, c, d] = [0, 1, 2, 3].map(at);
                [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0]
            }
            Basis::CatmullRom => {
                let (b, c) = (at(0), at(1));
                let a = if k == 0 { mirrored(0, 1) } else { wide(points[k - 1]) };
                let d = if k + 2 == points.len() { mirrored(k + 1, k) } else { at(2) };
                [b, b + (c - a) / 6.0, c - (d - b) / 6.0, c]
            }
        }
    }
}
