//! Many curves in world space, in pieces.

use glam::{DVec3, DVec4, Vec3, Vec4};

use super::Basis;
use super::piece::Cubic;

/// The control points of many curves, and where each of their spans begins.
pub(super) struct Strands {
    basis: Basis,
    /// Position (m) and radius (m) of the control points, curve after curve.
    points: Vec<Vec4>,
    /// Normals at the control points, for ribbons; empty for tubes.
    normals: Vec<Vec3>,
    /// First control point of each span, see [`FIRST`] and [`LAST`].
    spans: Vec<u32>,
    /// First span of each curve.
    curves: Vec<u32>,
    /// Number of pieces of a span, a power of two.
    parts: u32,
    /// Whether any two pieces meet in a kink.
    has_kinks: bool,
}

/// Mark of the first span of a curve.
const FIRST: u32 = 1 << 31;

/// Mark of the last span of a curve.
const LAST: u32 = 1 << 30;

/// Greatest number of control points.
pub(super) const MOST_POINTS: usize = LAST as usize;

/// Length of a span in radii above which it is worth two boxes.
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
    /// - `counts`: number of control points of each curve
    pub fn new(basis: Basis, points: Vec<Vec4>, normals: Vec<Vec3>, counts: &[u32]) -> Strands {
        let (mut spans, mut curves, mut first) = (vec![], Vec::with_capacity(counts.len()), 0);
        for &count in counts {
            curves.push(spans.len() as u32);
            let number = basis.spans(count as usize) as u32;
            let mark = |k: u32| if k == 0 { FIRST } else { 0 } | if k + 1 == number { LAST } else { 0 };
            spans.extend((0..number).map(|k| (first + k * basis.stride() as u32) | mark(k)));
            first += count;
        }
        let mut strands = Strands { basis, points, normals, spans, curves, parts: 1, has_kinks: false };
        strands.has_kinks = strands.finds_kinks();
        strands.parts = strands.fitting_parts();
        strands
    }

    /// Whether any two spans meet in a kink. Splines of the other bases are smooth.
    fn finds_kinks(&self) -> bool {
        let is_kink = |span: u32| self.spans[span as usize] & LAST == 0 && self.span(span).has_kink(&self.span(span + 1));
        matches!(self.basis, Basis::Linear | Basis::Bezier) && (0..self.spans.len() as u32).any(is_kink)
    }

    /// Whether any two pieces meet in a kink.
    pub fn has_kinks(&self) -> bool {
        self.has_kinks
    }

    /// The number of pieces of each span: two if most spans are slender, so that boxes fit them better, and one otherwise.
    fn fitting_parts(&self) -> u32 {
        let slender = |span: u32| {
            let Cubic(b) = self.span(span);
            let length = (b[3] - b[0]).truncate().length();
            length / (0.25 * (b[0] + b[1] + b[2] + b[3]).w.max(f64::MIN_POSITIVE)) > SLENDER
        };
        // Some of the spans stand for all.
        let step = (self.spans.len() / 1000).max(1);
        let seen = || (0..self.spans.len() as u32).step_by(step);
        if 2 * seen().filter(|span| slender(*span)).count() > seen().count() { 2 } else { 1 }
    }

    /// Lower and upper corner of a box around all curves (m).
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        (0..self.spans.len() as u32).map(|span| self.span(span).bounds()).fold(empty, |a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Number of pieces.
    pub fn count(&self) -> u32 {
        self.spans.len() as u32 * self.parts
    }

    /// A piece: its position and radius.
    pub fn piece(&self, i: u32) -> Cubic {
        self.part(self.span(i / self.parts), i)
    }

    /// Normals of a piece of a ribbon, as a cubic without a radius.
    pub fn normals(&self, i: u32) -> Cubic {
        let first = (self.spans[(i / self.parts) as usize] & !(FIRST | LAST)) as usize;
        let normal = |k: usize| self.normals[first + k].as_dvec3().extend(0.0);
        self.part(Cubic(self.basis.bezier(normal)), i)
    }

    /// The part of its span that a piece is, by halving the span.
    fn part(&self, mut span: Cubic, i: u32) -> Cubic {
        let mut bit = self.parts / 2;
        while bit > 0 {
            let [first, second] = span.halves();
            span = if i & bit == 0 { first } else { second };
            bit /= 2;
        }
        span
    }

    fn span(&self, span: u32) -> Cubic {
        let first = (self.spans[span as usize] & !(FIRST | LAST)) as usize;
        // Between points of very different radii, a smooth curve through them would fall below 0.
        Cubic(self.basis.bezier(|k| self.points[first + k].as_dvec4()).map(|b| DVec4 { w: b.w.max(0.0), ..b }))
    }

    /// The piece before this one on the same curve; `None` at its beginning.
    pub fn before(&self, i: u32) -> Option<u32> {
        let is_first = i.is_multiple_of(self.parts) && self.spans[(i / self.parts) as usize] & FIRST != 0;
        (!is_first).then(|| i - 1)
    }

    /// The piece after this one on the same curve; `None` at its end.
    pub fn after(&self, i: u32) -> Option<u32> {
        let is_last = (i + 1).is_multiple_of(self.parts) && self.spans[(i / self.parts) as usize] & LAST != 0;
        (!is_last).then(|| i + 1)
    }

    /// Where on its curve a piece lies.
    pub fn place(&self, i: u32) -> Place {
        let curve = self.curves.partition_point(|first| *first <= i / self.parts) - 1;
        let first = self.curves[curve];
        let end = self.curves.get(curve + 1).copied().unwrap_or(self.spans.len() as u32);
        let pieces = f64::from((end - first) * self.parts);
        Place { root: self.span(first).tangent(0.0), from: f64::from(i - first * self.parts) / pieces, length: 1.0 / pieces }
    }
}

impl Basis {
    /// Number of control points of a span.
    pub(super) fn order(self) -> usize {
        match self {
            Basis::Linear => 2,
            Basis::Bezier | Basis::Bspline | Basis::CatmullRom => 4,
        }
    }

    /// Number of control points from one span to the next.
    pub(super) fn stride(self) -> usize {
        match self {
            Basis::Bezier => 3,
            Basis::Linear | Basis::Bspline | Basis::CatmullRom => 1,
        }
    }

    /// Number of spans of a curve with some control points.
    pub(super) fn spans(self, points: usize) -> usize {
        (points.saturating_sub(self.order()) / self.stride()) + usize::from(points >= self.order())
    }

    /// The span as a Bézier curve.
    ///
    /// - `point`: the control points of the span
    fn bezier(self, point: impl Fn(usize) -> DVec4) -> [DVec4; 4] {
        if self == Basis::Linear {
            let (a, b) = (point(0), point(1));
            return [a, a + (b - a) / 3.0, b - (b - a) / 3.0, b];
        }
        let [a, b, c, d] = [0, 1, 2, 3].map(point);
        match self {
            Basis::Linear | Basis::Bezier => [a, b, c, d],
            Basis::Bspline => [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0],
            Basis::CatmullRom => [b, b + (c - a) / 6.0, c - (d - b) / 6.0, c],
        }
    }
}
