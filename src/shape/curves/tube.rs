//! Tubes: the surfaces of all balls whose centres lie on a curve.
//!
//! The ball at s, with the centre c(s) and the radius r(s), touches the surface in a circle. With the unit tangent T, it is
//!
//! p(s, φ) = c + r n,    n = sin α T + cos α ρ(φ),    sin α = −r′/|c′|
//!
//! where ρ runs through the unit vectors perpendicular to T. Part of a ball closes each end of a curve, and the outside of each kink.

use std::f32::consts::TAU;
use std::f64::consts::TAU as TAU_F64;

use arrayvec::ArrayVec;
use glam::{DVec3, DVec4, Vec2, Vec3, Vec4Swizzles as _};

use super::line::Line;
use super::piece::{Cubic, Local};
use super::strands::Strands;
use crate::math::bernstein::{Bernstein, zero};
use crate::math::{Aabb, AreaPdf, Ray, float};
use crate::shape::{Capsule, Facet, Shape, ShapeHit, SurfacePoint, VertexColor, gauss_nodes, offset_bound};

/// Tubes in world space. The `uv` of a hit are s, and φ from 0 to 1 as a share of a turn. On the balls that close a piece, s runs from 0 to −1
/// and from 1 to 2 in proportion to the height above the circle in which the ball touches the tube.
pub(super) struct Tubes(pub Strands);

/// The circle in which the ball at s touches the surface.
struct Circle {
    centre: DVec3,
    radius: f64,
    /// Unit tangent T of the curve.
    tangent: DVec3,
    sin: f64,
    cos: f64,
    /// Length of c′ (m).
    speed: f64,
    /// T′.
    turn: DVec3,
    /// Derivative of r.
    widening: f64,
    /// Derivative of sin α.
    tilt: f64,
}

impl Circle {
    fn new(piece: &Cubic, s: f64) -> Circle {
        let Local { value, first, second } = piece.at(s);
        let (tangent, speed) = (piece.tangent(s), first.xyz().length());
        let along = second.xyz().dot(tangent);
        // Where the control points of an end coincide, the curve does not move, and the circle is that of a cylinder. Where the radius changes
        // faster than the place, balls lie within each other, and nothing of the surface is there.
        let [sin, tilt] = match speed {
            0.0 => [0.0; 2],
            _ if first.w.abs() >= speed => [-first.w.signum(), 0.0],
            _ => [-first.w / speed, -second.w / speed + first.w * along / (speed * speed)],
        };
        let turn = if speed > 0.0 { (second.xyz() - tangent * along) / speed } else { DVec3::ZERO };
        let cos = (1.0 - sin * sin).sqrt();
        Circle { centre: value.xyz(), radius: value.w, tangent, sin, cos, speed, turn, widening: first.w, tilt }
    }

    /// The direction ρ with an angle, as a share of a turn.
    fn around(&self, share: f32) -> DVec3 {
        let ((x, y), (sin, cos)) = (self.tangent.any_orthonormal_pair(), float::sin_cos(share * TAU));
        (x * f64::from(cos) + y * f64::from(sin)).normalize()
    }

    /// Normal in the direction ρ.
    fn normal(&self, around: DVec3) -> DVec3 {
        self.tangent * self.sin + around * self.cos
    }

    /// Change of the normal by s, if ρ turns about the curve as little as possible: ρ′ = −(T′·ρ) T.
    fn normal_by_s(&self, around: DVec3) -> DVec3 {
        let cos_change = if self.cos > 0.0 { -self.sin * self.tilt / self.cos } else { 0.0 };
        let turned = self.turn.dot(around);
        self.tangent * (self.tilt - self.cos * turned) + self.turn * self.sin + around * cos_change
    }

    /// Derivatives of the point by s, with ρ as in [`Circle::normal_by_s`], and by φ in radians.
    fn derivatives(&self, around: DVec3) -> [DVec3; 2] {
        let by_s = self.tangent * self.speed + self.normal(around) * self.widening + self.normal_by_s(around) * self.radius;
        [by_s, self.tangent.cross(around) * (self.radius * self.cos)]
    }

    /// Area of the surface by s and φ: r (|c′| cos² α + r (sin α)′ − r cos α T′·ρ), the length of the cross product of the derivatives. The
    /// last term vanishes in the mean over all ρ. It is negative where balls hide what should be surface.
    fn stretch(&self, around: DVec3) -> f64 {
        self.mean_stretch() - self.radius * self.radius * self.cos * self.turn.dot(around)
    }

    fn mean_stretch(&self) -> f64 {
        self.radius * (self.speed * self.cos * self.cos + self.radius * self.tilt)
    }
}

/// A point on a tube with all that follows from its coordinates.
struct Spot {
    circle: Circle,
    around: DVec3,
    normal: DVec3,
    /// Whether it lies on a ball that closes the piece.
    is_on_ball: bool,
}

impl Spot {
    fn new(piece: &Cubic, uv: Vec2) -> Spot {
        let s = f64::from(uv.x);
        let circle = Circle::new(piece, s.clamp(0.0, 1.0));
        let around = circle.around(uv.y);
        let height = match s {
            ..0.0 => circle.sin + (circle.sin + 1.0) * s.max(-1.0),
            0.0..=1.0 => circle.sin,
            _ => circle.sin + (1.0 - circle.sin) * (s - 1.0).min(1.0),
        };
        let normal = circle.tangent * height + around * (1.0 - height * height).max(0.0).sqrt();
        Spot { circle, around, normal, is_on_ball: !(0.0..=1.0).contains(&s) }
    }
}

/// Areas of a piece (m²): of the ball that closes its start, of the tube, and of the ball that closes its end.
struct Areas {
    start: f64,
    side: f64,
    end: f64,
}

impl Areas {
    fn sum(&self) -> f64 {
        self.start + self.side + self.end
    }
}

impl Tubes {
    fn areas(&self, i: u32) -> Areas {
        let piece = self.0.piece(i);
        let nodes = gauss_nodes(8).map(|s| Circle::new(&piece, s).mean_stretch().max(0.0));
        let side = TAU_F64 * nodes.sum::<f64>() / 16.0;
        let cap = |s: f64, side: f64| {
            let circle = Circle::new(&piece, s);
            TAU_F64 * circle.radius * circle.radius * (1.0 + side * circle.sin)
        };
        Areas {
            start: if self.0.before(i).is_none() { cap(0.0, 1.0) } else { 0.0 },
            side,
            end: if self.has_end(i, &piece) { cap(1.0, -1.0) } else { 0.0 },
        }
    }

    /// Whether the ball at the end of a piece may show: at the end of the curve, and where the tube has a kink. The one at the start of a
    /// piece belongs to the piece before.
    fn has_end(&self, i: u32, piece: &Cubic) -> bool {
        self.0.after(i).is_none_or(|next| self.0.has_kinks() && piece.has_kink(&self.0.piece(next)))
    }

    /// Coordinates of a point with the unit normal `n` whose ball has the centre c(s).
    fn uv(&self, i: u32, piece: &Cubic, s: f64, n: DVec3) -> Vec2 {
        let circle = Circle::new(piece, s);
        let height = n.dot(circle.tangent) - circle.sin;
        let extended = if s == 0.0 && height < 0.0 && self.0.before(i).is_none() {
            height / (1.0 + circle.sin)
        } else if s == 1.0 && height > 0.0 && self.has_end(i, piece) {
            1.0 + height / (1.0 - circle.sin)
        } else {
            s
        };
        Vec2::new(extended as f32, share(n, circle.tangent))
    }

    /// Coordinates of a point of the surface, from its texture coordinates and its normal.
    fn uv_of(&self, i: u32, point: &SurfacePoint) -> Vec2 {
        let (piece, place) = (self.0.piece(i), self.0.place(i));
        // Rounded coordinates of an end are at the end.
        let s = match point.uv.y {
            v if v == place.at(0.0) => 0.0,
            v if v == place.at(1.0) => 1.0,
            v => ((f64::from(v) - place.from) / place.length).clamp(0.0, 1.0),
        };
        self.uv(i, &piece, s, point.ng.as_dvec3())
    }

    fn pdf_at(&self, i: u32, uv: Vec2) -> AreaPdf {
        let (areas, spot) = (self.areas(i), Spot::new(&self.0.piece(i), uv));
        let stretch = spot.circle.stretch(spot.around).abs();
        let ratio = if spot.is_on_ball || stretch == 0.0 { 1.0 } else { areas.side / (TAU_F64 * stretch) };
        AreaPdf::new((ratio / areas.sum()) as f32)
    }

    fn at(&self, i: u32, uv: Vec2) -> SurfacePoint {
        let (piece, place) = (self.0.piece(i), self.0.place(i));
        let Spot { circle, around, normal, .. } = Spot::new(&piece, uv);
        let ng = normal.as_vec3();
        // The angle counts from one direction at the root, which turns with the tangent as little as possible.
        let at_root = turned(around, circle.tangent, place.root);
        SurfacePoint {
            p: (circle.centre + normal * circle.radius).as_vec3(),
            offset: offset_bound(ng, piece.aabb().magnitude()),
            ng,
            ns: ng,
            uv: Vec2::new(share(at_root, place.root), place.at(uv.x.into())),
            color: VertexColor::WHITE,
        }
    }
}

/// The angle of a direction around an axis, as a share of a turn.
fn share(direction: DVec3, axis: DVec3) -> f32 {
    let (x, y) = axis.any_orthonormal_pair();
    let share = float::atan2(direction.dot(y) as f32, direction.dot(x) as f32) / TAU;
    if share < 0.0 { share + 1.0 } else { share }
}

/// The vector `v`, perpendicular to the unit vector `from`, after the least rotation that leads from there to the unit vector `to`.
///
/// v − (to·v)/(1 + from·to) (from + to); between opposite directions no rotation is the least, and the vector stays.
fn turned(v: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    let above = 1.0 + from.dot(to);
    if above > 0.0 { v - (from + to) * (to.dot(v) / above) } else { v }
}

/// An end of the part of a ray that lies within a tube.
#[derive(Clone, Copy)]
struct Passage {
    /// Height on the ray (m).
    z: f64,
    /// Coordinate s of the ball.
    s: f64,
    /// Whether it is on the surface, and not within another piece.
    counts: bool,
}

/// A piece as a ray sees it.
///
/// The ball at s contains the heights from z − √h to z + √h of the ray, with h = r² − x² − y². The balls of an interval of s contain those
/// from the least of the former to the greatest of the latter.
struct Crossing<'a> {
    strands: &'a Strands,
    i: u32,
    line: &'a Line,
    seen: Cubic,
}

/// Depth below the surface of a neighbour, relative to the radius, from which on a point counts as within it: more than heights are rounded in
/// f64, so that a ball that both pieces share does not hide its own surface.
const SURFACE: f64 = 1e-9;

/// Precision of the ends of intervals, relative to the range in which they are looked for.
const COARSE: f64 = 1e-3;

/// Precision of s at an extreme. Heights differ by its square.
const FINE: f64 = 1e-10;

/// Number of parts of an interval in which extremes are looked for.
const PARTS: u32 = 4;

impl Crossing<'_> {
    /// The intervals of s whose balls the ray meets.
    ///
    /// - `range`: of s, outside of which it meets none
    fn intervals(&self, range @ [start, end]: [f64; 2]) -> ArrayVec<[f64; 2], 4> {
        let part = if range == [0.0, 1.0] { self.seen } else { self.seen.part(range) };
        let [x, y, _, r] = [0, 1, 2, 3].map(|axis| part.0.map(|b| b[axis]));
        let h = Bernstein::<7>::sum_of_products([(r, r), (x.map(|x| -x), x), (y.map(|y| -y), y)]);
        if h.is_negative() {
            return ArrayVec::new();
        }
        let mut ends = ArrayVec::<f64, 8>::new();
        if h.0[0] >= 0.0 {
            ends.push(start);
        }
        // A polynomial of degree 6 has at most six zeros. They only limit where extremes are looked for, so that a coarse place is enough.
        h.crossings(COARSE, |s| ends.push(start + (end - start) * s));
        if ends.len() % 2 == 1 {
            ends.push(end);
        }
        ends.chunks_exact(2).map(|ends| [ends[0], ends[1]]).collect()
    }

    /// Where the ray enters (`side` = 1) or leaves (`side` = −1) the balls of an interval.
    fn passage(&self, interval: [f64; 2], side: f64) -> Passage {
        let least = self.least(interval, side);
        Passage { z: side * least.z, ..least }
    }

    /// The parts of the ray within the balls of the piece, in order. Those of several intervals may overlap.
    fn parts(&self, intervals: impl Iterator<Item = [f64; 2]>) -> ArrayVec<[Passage; 2], 4> {
        let mut parts: ArrayVec<_, 4> = intervals.map(|interval| [self.passage(interval, 1.0), self.passage(interval, -1.0)]).collect();
        parts.sort_by(|a, b| a[0].z.total_cmp(&b[0].z));
        let mut joined = ArrayVec::<[Passage; 2], 4>::new();
        for part in parts {
            match joined.last_mut() {
                Some(last) if part[0].z <= last[1].z => last[1] = if part[1].z > last[1].z { part[1] } else { last[1] },
                _ => joined.push(part),
            }
        }
        joined
    }

    /// Whether a point of the ray lies within a neighbour of the piece, which happens at the inner side of a kink only.
    fn is_within_neighbour(&self, z: f64) -> bool {
        let slack = SURFACE * self.seen.greatest_radius();
        let neighbours = [self.strands.before(self.i), self.strands.after(self.i)];
        self.strands.has_kinks()
            && neighbours.into_iter().flatten().any(|i| {
                let crossing = Crossing { seen: self.line.seen(&self.strands.piece(i)), i, ..*self };
                crossing
                    .parts(crossing.intervals([0.0, 1.0]).into_iter())
                    .iter()
                    .any(|[enter, leave]| enter.z + slack < z && z < leave.z - slack)
            })
    }

    /// Least height of the balls' lower ends (`side` = 1), or minus the greatest of their upper ends (`side` = −1).
    fn least(&self, [from, to]: [f64; 2], side: f64) -> Passage {
        let slope = |s: f64| slope(&self.seen.at(s), side);
        let at = |s: f64, counts: bool| {
            let b = self.seen.at(s).value;
            Passage { z: side * b.z - root(b), s, counts }
        };
        let mut found = ArrayVec::<Passage, { PARTS as usize + 2 }>::new();
        let (mut a, mut falls) = (from, slope(from) < 0.0);
        if from == 0.0 && !falls {
            found.push(at(from, self.strands.before(self.i).is_none()));
        }
        for k in 1..=PARTS {
            let b = if k == PARTS { to } else { from + (to - from) * (f64::from(k) / f64::from(PARTS)) };
            let still_falls = slope(b) < 0.0;
            if falls && !still_falls {
                found.push(at(zero(slope, [a, b], FINE), true));
            }
            (a, falls) = (b, still_falls);
        }
        if to == 1.0 && falls {
            found.push(at(to, self.is_end_outside(side)));
        }
        // Rounding hides the extreme only where the ray grazes the tube.
        let least = found.into_iter().reduce(|a, b| if b.z < a.z { b } else { a });
        least.unwrap_or_else(|| at(0.5 * (from + to), true))
    }

    /// Whether the ball at the end of the piece is on the surface: heights do not fall further in the next piece.
    fn is_end_outside(&self, side: f64) -> bool {
        self.strands.after(self.i).is_none_or(|next| {
            let at = self.line.seen(&self.strands.piece(next)).at(0.0);
            slope(&at, side) >= -slope_error(&at, self.line.rounding)
        })
    }
}

/// √h at a point of a curve.
fn root(v: DVec4) -> f64 {
    (v.w * v.w - v.x * v.x - v.y * v.y).max(0.0).sqrt()
}

/// Derivative of the height of a ball's lower or upper end, times √h: side z′ √h + x x′ + y y′ − r r′.
fn slope(at: &Local, side: f64) -> f64 {
    let (v, d) = (at.value, at.first);
    side * d.z * root(v) + v.x * d.x + v.y * d.y - v.w * d.w
}

/// Error of [`slope`] if positions have a rounding error: ∂√h/∂x = −x/√h, which is at most r/√h.
fn slope_error(at: &Local, rounding: f64) -> f64 {
    let (v, d) = (at.value, at.first);
    2.0 * rounding * d.length() * (1.0 + v.w / root(v))
}

impl Shape for Tubes {
    fn is_of_curves(&self) -> bool {
        true
    }

    fn count(&self) -> u32 {
        self.0.count()
    }

    fn bounds(&self, i: u32) -> Aabb {
        self.0.piece(i).aabb()
    }

    fn capsule(&self, i: u32) -> Option<Capsule> {
        Some(self.0.piece(i).capsule())
    }

    fn area(&self, i: u32) -> f32 {
        self.areas(i).sum() as f32
    }

    fn facet(&self, _: u32) -> Facet {
        Facet::Curved
    }

    /// Finds the intervals of s whose balls the ray meets, from the zeros of the polynomial h(s), and where the ray enters and leaves the
    /// balls of each. What lies within the balls of another interval, or of the next piece, is no surface.
    ///
    /// Compare: Reshetov and Luebke, *Phantom Ray-Hair Intersector* (2018), who iterate on the curve with cones.
    fn intersect(&self, i: u32, ray: &Ray) -> Option<ShapeHit> {
        let piece = self.0.piece(i);
        let line = Line::new(ray, 0.5 * (piece.0[0] + piece.0[3]).xyz());
        let seen = line.seen(&piece);
        let range = line.near(&seen, ray.t_max)?;
        let crossing = Crossing { strands: &self.0, i, line: &line, seen };
        let hit = |passage: Passage| {
            let t = line.t(passage.z) as f32;
            let is_hit = passage.counts && t > 0.0 && t < ray.t_max && !crossing.is_within_neighbour(passage.z);
            is_hit.then_some((t, passage))
        };
        let (t, Passage { z, s, .. }) = match crossing.intervals(range)[..] {
            [interval] => [1.0, -1.0].into_iter().find_map(|side| hit(crossing.passage(interval, side)))?,
            ref intervals => crossing.parts(intervals.iter().copied()).into_iter().flatten().find_map(hit)?,
        };
        let n = (line.point(z) - piece.at(s).value.xyz()).try_normalize().unwrap_or_else(|| piece.tangent(s));
        Some(ShapeHit { t, uv: self.uv(i, &piece, s, n) })
    }

    fn point(&self, i: u32, _: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.at(i, hit.uv)
    }

    /// Around the curve, and along it at one angle from the root.
    fn tangents(&self, i: u32, point: &SurfacePoint, _: f32) -> Option<[Vec3; 2]> {
        let place = self.0.place(i);
        let Spot { circle, around, is_on_ball, .. } = Spot::new(&self.0.piece(i), self.uv_of(i, point));
        let [along, by_angle] = circle.derivatives(around);
        // The rotation that leads from the tangent at the root to that at s turns about the latter too.
        let twist = circle.tangent.dot(place.root.cross(circle.turn)) / (1.0 + place.root.dot(circle.tangent));
        (!is_on_ball).then(|| [(by_angle * TAU_F64).as_vec3(), ((along + by_angle * twist) / place.length).as_vec3()])
    }

    fn normal_change(&self, i: u32, uv: Vec2, _: &SurfacePoint, along: Vec3, _: f32) -> Option<Vec3> {
        let Spot { circle, around, is_on_ball, .. } = Spot::new(&self.0.piece(i), uv);
        let along = along.as_dvec3();
        if is_on_ball {
            return (circle.radius > 0.0).then(|| (along / circle.radius).as_vec3());
        }
        let [by_s, by_angle] = circle.derivatives(around);
        let normal = by_s.cross(by_angle);
        let [ds, dphi] = [along.cross(by_angle), by_s.cross(along)].map(|part| part.dot(normal) / normal.length_squared());
        let change = circle.normal_by_s(around) * ds + circle.tangent.cross(around) * (circle.cos * dphi);
        (normal.length_squared() > 0.0).then(|| change.as_vec3())
    }

    /// Samples the tube and the balls that close it in proportion to their areas: the balls uniformly, the tube uniformly in s and φ, which is
    /// nearly uniform by area.
    fn sample_area(&self, i: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        let areas = self.areas(i);
        let place = f64::from(u.x) * areas.sum();
        let s = if place < areas.start {
            place / areas.start - 1.0
        } else if place < areas.start + areas.side || areas.end == 0.0 {
            ((place - areas.start) / areas.side).min(1.0)
        } else {
            1.0 + (place - areas.start - areas.side) / areas.end
        };
        let uv = Vec2::new(s as f32, u.y);
        (self.at(i, uv), self.pdf_at(i, uv))
    }

    fn area_pdf(&self, i: u32, point: &SurfacePoint) -> AreaPdf {
        self.pdf_at(i, self.uv_of(i, point))
    }

    fn area_coordinates(&self, i: u32, point: &SurfacePoint) -> Option<Vec2> {
        let (areas, uv) = (self.areas(i), self.uv_of(i, point));
        let s = f64::from(uv.x);
        let place = match s {
            ..0.0 => areas.start * (1.0 + s),
            0.0..=1.0 => areas.start + areas.side * s,
            _ => areas.start + areas.side + areas.end * (s - 1.0),
        };
        let u = Vec2::new((place / areas.sum()) as f32, uv.y);
        Some(u.clamp(Vec2::ZERO, Vec2::splat(float::ONE_MINUS_EPSILON)))
    }
}
