//! Where a line meets a distance field.

use glam::DVec3;

use super::{Dual, Sdf};

/// How a surface is looked for along a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum March {
    /// To where the field changes its sign, within rounding.
    #[default]
    Exact,
    Fixed(Fixed),
}

/// As short programs do it: at a fixed distance before the surface, with numbers that suit one scene.
///
/// A step is the whole distance; what is nearer than `stop` is hit, inside too, and so is what has not been reached
/// after `most_steps`. The surface that is met is `stop` thicker than it is said to be, and its edges are as round as
/// `normal_step`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed {
    /// (m)
    pub stop: f64,
    pub most_steps: u32,
    /// How far a ray sees (m).
    pub reach: f64,
    /// Normals are differences over this (m), forward along each axis.
    pub normal_step: f64,
}

/// The points origin + t direction with from ≤ t ≤ to, in the field's own space; t is the world's.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub origin: DVec3,
    /// Of any length.
    pub direction: DVec3,
    pub from: f64,
    pub to: f64,
}

impl Line {
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

impl Sdf {
    /// The first t at which the field changes its sign.
    ///
    /// Sphere tracing: at the distance d nothing is nearer than |d|, so the line may go on by it. Such steps shrink for
    /// ever as the surface comes near. Below `floor`, the rounding of the points from which rays come, one step of
    /// Newton's and as far again crosses it, if anything does there; what is between is found by its sign. So a hit is
    /// a change of sign between two places, never a small distance.
    ///
    /// - `floor`: in the field's space (m); no step is shorter, nor shorter than what f64 resolves of t
    ///
    /// A line that stays very near to the surface without meeting it would take steps for ever: after every 128 the
    /// shortest step doubles, and with it what may be passed unseen. Few lines take more than a hundred, and none more than
    /// 128 · 53, whatever the scale: then the shortest step is the whole line.
    ///
    /// Source: Hart, *Sphere Tracing* (1996). Tests: hits_are_the_analytic_ones, hits_lie_on_the_surface.
    pub(super) fn crossing(&self, line: &Line, floor: f64) -> Option<f64> {
        let speed = line.direction.length();
        let floor = floor.max(line.to * f64::EPSILON * speed);
        let value = |t: f64| self.distance(line.at(t).to_array());
        let mut t = line.from;
        let mut d = value(t);
        let side = if d == 0.0 { self.heading(line, t) } else { 1f64.copysign(d) };
        for n in 0.. {
            let shortest = floor * 2f64.powi(n / PATIENCE);
            if side * d <= floor
                && let Some(ahead) = self.ahead(line, t, side, floor / speed)
            {
                return Some(root(value, side, t, ahead));
            }
            let next = t + (side * d).max(shortest) / speed;
            if !(next > t && next <= line.to) {
                // The end itself may lie beyond the surface.
                return (side * value(line.to) < 0.0).then(|| root(value, side, t, line.to));
            }
            d = value(next);
            if side * d <= 0.0 {
                return Some(root(value, side, t, next));
            }
            t = next;
        }
        None
    }

    /// The side on which a line that starts on the surface is about to be: 1 outside, −1 inside.
    fn heading(&self, line: &Line, t: f64) -> f64 {
        let slope = self.distance(Dual::coordinates(line.at(t))).gradient.dot(line.direction);
        if slope < 0.0 { -1.0 } else { 1.0 }
    }

    /// A place on the other side of the surface, twice as far as the slope says that the surface is.
    fn ahead(&self, line: &Line, t: f64, side: f64, floor: f64) -> Option<f64> {
        let here = self.distance(Dual::coordinates(line.at(t)));
        let slope = side * here.gradient.dot(line.direction);
        let far = t + (-2.0 * side * here.value / slope).min(16.0 * floor);
        let crosses = slope < 0.0 && far <= line.to && side * self.distance(line.at(far).to_array()) <= 0.0;
        crosses.then_some(far)
    }

    /// As [`Fixed`] has it: t of the place that counts as hit.
    pub(super) fn stop(&self, line: &Line, fixed: &Fixed) -> Option<f64> {
        let speed = line.direction.length();
        let mut way = 0.0;
        for step in 0.. {
            let t = way / speed;
            if !(way < fixed.reach && t <= line.to) {
                return None;
            }
            let d = self.distance(line.at(t).to_array());
            if d < fixed.stop || step >= fixed.most_steps {
                return Some(t);
            }
            // Where t no longer changes, nothing does until the steps are used up.
            if way + d == way {
                return Some(t);
            }
            way += d;
        }
        None
    }
}

/// Steps after which the shortest one doubles.
const PATIENCE: i32 = 128;

/// A zero between `a`, where the value has the sign `side`, and `b`, where it has not: regula falsi, where the end
/// that stays counts half each time (Illinois), and bisection should that be slow.
///
/// To 2⁻⁴⁸ of t, far below what f32 holds.
fn root(value: impl Fn(f64) -> f64, side: f64, mut a: f64, mut b: f64) -> f64 {
    let (mut fa, mut fb) = (side * value(a), side * value(b));
    let mut stayed = 0;
    for n in 0..200 {
        if fb == 0.0 || (b - a).abs() <= 2f64.powi(-48) * b.abs() {
            break;
        }
        let guess = b - fb * (b - a) / (fb - fa);
        let middle = if n < 64 && guess > a && guess < b { guess } else { 0.5 * (a + b) };
        let f = side * value(middle);
        let outside = f > 0.0;
        if outside {
            (a, fa) = (middle, f);
        } else {
            (b, fb) = (middle, f);
        }
        // Positive: the far end stayed this often in a row; negative: the near end.
        stayed = if outside { i32::max(stayed, 0) + 1 } else { i32::min(stayed, 0) - 1 };
        if stayed >= 2 {
            fb *= 0.5;
        } else if stayed <= -2 {
            fa *= 0.5;
        }
    }
    b
}
