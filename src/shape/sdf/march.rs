//! Intersection of lines with distance fields.

use glam::DVec3;

use super::{Dual, Sdf};

/// Method of finding the surface along a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum March {
    /// Finds the change of sign of the field, up to rounding.
    #[default]
    Exact,
    /// Stops at a fixed distance from the surface.
    Fixed(Fixed),
}

/// Sphere tracing with a fixed stop distance, as in very short programs, with constants that suit one scene.
///
/// Each step is the whole distance. A ray hits where the distance is below `stop`, also inside, or after `most_steps` steps. The solid
/// is thicker than described by `stop`, and its edges are rounded by about `normal_step`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed {
    /// Distance below which the surface counts as hit (m).
    pub stop: f64,
    /// Number of steps after which the surface counts as hit.
    pub most_steps: u32,
    /// Greatest length of a ray (m).
    pub reach: f64,
    /// Step of the forward differences that give normals (m).
    pub normal_step: f64,
}

/// Points origin + t direction with from ≤ t ≤ to in the space of the field. t is that of world space.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Point at t = 0.
    pub origin: DVec3,
    /// Direction, of any length.
    pub direction: DVec3,
    /// Least t.
    pub from: f64,
    /// Greatest t.
    pub to: f64,
}

impl Line {
    /// Point at t.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

impl Sdf {
    /// The first t at which the field changes its sign.
    ///
    /// Sphere tracing: the surface is no nearer than |d|, so that the line may advance by |d|. These steps become ever smaller near the
    /// surface. Where the distance is below `floor`, the rounding error of the points from which rays start, twice a Newton step leads
    /// to the other side if the line crosses the surface there, and the zero is found between the two signs. A hit is therefore always
    /// a change of sign between two points, never merely a small distance.
    ///
    /// - `floor`: least step in the space of the field (m); a step is also no shorter than f64 resolves t
    ///
    /// A line that stays very near to the surface without hitting it would never end. The least step is therefore doubled after every
    /// 128 steps, and thinner features may then be missed. Few lines take more than a hundred steps, and none more than 128 · 53, because
    /// the least step is then the whole line, whatever the scale.
    ///
    /// Source: Hart, *Sphere Tracing* (1996). Tests: hits_match_the_analytic_ones, hits_lie_on_the_surface.
    pub(super) fn crossing(&self, line: &Line, floor: f64) -> Option<f64> {
        let speed = line.direction.length();
        let floor = floor.max(line.to * f64::EPSILON * speed);
        let value = |t: f64| self.distance(line.at(t).to_array());
        let mut t = line.from;
        let mut d = value(t);
        let side = if d == 0.0 { self.heading(line, t) } else { 1f64.copysign(d) };
        for n in 0.. {
            let shortest = floor * 2f64.powi(n / STEPS_PER_DOUBLING);
            if side * d <= floor
                && let Some(ahead) = self.ahead(line, t, side, floor / speed)
            {
                return Some(root(value, side, t, ahead));
            }
            let next = t + (side * d).max(shortest) / speed;
            if !(next > t && next <= line.to) {
                // The end of the line may lie beyond the surface.
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

    /// Side to which a line leads that starts on the surface: 1 outside, −1 inside.
    fn heading(&self, line: &Line, t: f64) -> f64 {
        let slope = self.distance(Dual::coordinates(line.at(t))).gradient.dot(line.direction);
        if slope < 0.0 { -1.0 } else { 1.0 }
    }

    /// Point on the other side of the surface, at twice the distance to the surface that the slope predicts; `None` if there is none.
    fn ahead(&self, line: &Line, t: f64, side: f64, floor: f64) -> Option<f64> {
        let here = self.distance(Dual::coordinates(line.at(t)));
        let slope = side * here.gradient.dot(line.direction);
        let far = t + (-2.0 * side * here.value / slope).min(16.0 * floor);
        let crosses = slope < 0.0 && far <= line.to && side * self.distance(line.at(far).to_array()) <= 0.0;
        crosses.then_some(far)
    }

    /// Ray parameter t of the hit by the method of [`Fixed`].
    pub(super) fn stop(&self, line: &Line, fixed: &Fixed) -> Option<f64> {
        let speed = line.direction.length();
        let mut length = 0.0;
        for step in 0.. {
            let t = length / speed;
            if !(length < fixed.reach && t <= line.to) {
                return None;
            }
            let d = self.distance(line.at(t).to_array());
            if d < fixed.stop || step >= fixed.most_steps {
                return Some(t);
            }
            // If t no longer changes, the result is the same after all steps.
            if length + d == length {
                return Some(t);
            }
            length += d;
        }
        None
    }
}

/// Number of steps after which the least step is doubled.
const STEPS_PER_DOUBLING: i32 = 128;

/// Zero between `a`, where the value has the sign `side`, and `b`, where it has not, with a relative precision of 2⁻⁴⁸. The method is
/// the Illinois variant of regula falsi, with bisection if it converges slowly.
fn root(value: impl Fn(f64) -> f64, side: f64, mut a: f64, mut b: f64) -> f64 {
    let (mut fa, mut fb) = (side * value(a), side * value(b));
    let mut kept = 0;
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
        // Number of consecutive iterations that kept the far end (positive) or the near end (negative).
        kept = if outside { i32::max(kept, 0) + 1 } else { i32::min(kept, 0) - 1 };
        if kept >= 2 {
            fb *= 0.5;
        } else if kept <= -2 {
            fa *= 0.5;
        }
    }
    b
}
