//! Exit pupil: the part of a lens through which a point of the film sees the scene.
//!
//! It is bounded by a rectangle in the plane at the rear vertex, for film points on the x axis. That of other film points is turned about
//! the axis. Bounds are found by rays on grids, each finer than the one before, and are one cell of the last grid wider than needed.
//!
//! Source: Steinert, Dammertz, Hanika and Lensch, *General Spectral Camera Lens Simulation* (2011); Pharr, Jakob and Humphreys,
//! *Physically Based Rendering* (2023), §5.4.5.

use std::f64::consts::PI;

use glam::DVec2;

use super::stack::{Edges, LensStack};

/// Number of parts of the film's radius, each with its own bounds.
const PARTS: usize = 32;

/// Number of cells of a grid across the bounds; half of them along y, because the pupil is symmetrical.
const CELLS: i32 = 48;

/// Greatest number of grids.
const ROUNDS: u32 = 8;

/// Rectangle in the plane at the rear vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PupilBounds {
    low: DVec2,
    high: DVec2,
}

impl PupilBounds {
    /// The bounds `radius` around a point.
    fn around(center: DVec2, radius: f64) -> PupilBounds {
        PupilBounds { low: center - radius, high: center + radius }
    }

    fn union(self, other: PupilBounds) -> PupilBounds {
        PupilBounds { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Area.
    pub fn area(&self) -> f64 {
        let size = self.high - self.low;
        size.x * size.y
    }

    /// Point for numbers in [0, 1)².
    pub fn point(&self, u: DVec2) -> DVec2 {
        self.low + (self.high - self.low) * u
    }
}

/// Bounds of the exit pupil for all points of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct ExitPupils {
    /// Distance of the farthest point from the middle of the film.
    radius: f64,
    /// Bounds for each part of the radius; `None` where no light arrives.
    parts: Vec<Option<PupilBounds>>,
    /// Bounds of all pupils, also of points beyond the film.
    widest: PupilBounds,
}

impl ExitPupils {
    /// The exit pupils of a film within `radius` of its middle.
    pub fn new(stack: &LensStack, radius: f64) -> ExitPupils {
        let at: Vec<_> = (0..=PARTS).map(|k| bounds(stack, radius * k as f64 / PARTS as f64)).collect();
        let widest = PupilBounds::around(DVec2::ZERO, widest(stack));
        // Between two points the bounds change evenly, but for the width of a cell, by which they are too wide.
        let part = |ends: &[Option<PupilBounds>]| match *ends {
            [Some(a), Some(b)] => Some(a.union(b)),
            [None, None] => None,
            // The pupil vanishes somewhere in this part.
            _ => Some(widest),
        };
        ExitPupils { radius, parts: at.windows(2).map(part).collect(), widest }
    }

    /// Bounds for a film point at a distance from the middle; `None` if no light arrives.
    pub fn bounds(&self, distance: f64) -> Option<PupilBounds> {
        match self.parts.get((distance / self.radius * PARTS as f64) as usize) {
            Some(part) => *part,
            // A film of another shape than that for which the pupils were computed reaches farther.
            None => Some(self.widest),
        }
    }
}

/// π sin² θ of the cone of light that arrives at the middle of the film (sr): the irradiance there for a radiance of 1.
///
/// The edge of the pupil is found by bisection along the x axis.
pub fn projected_solid_angle(stack: &LensStack) -> f64 {
    const STEPS: u32 = 256;
    let passes = |x: f64| stack.trace(DVec2::ZERO, DVec2::new(x, 0.0), Edges::Opaque).is_some();
    let place = |k: u32| widest(stack) * f64::from(k) / f64::from(STEPS);
    let last = (0..STEPS).take_while(|k| passes(place(*k))).last().unwrap_or(0);
    let edge = bisected(place(last), place(last + 1), passes);
    let distance = stack.rear_distance();
    PI * edge * edge / (edge * edge + distance * distance)
}

/// Radius that pupils do not exceed in the plane at the rear vertex. The opening of the rear surface is beside that plane, so that rays at an
/// angle cross it farther out.
fn widest(stack: &LensStack) -> f64 {
    1.5 * stack.rear_aperture()
}

/// Last point from `inside` to `outside` at which a condition holds.
fn bisected(mut inside: f64, mut outside: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..64 {
        let middle = 0.5 * (inside + outside);
        *(if holds(middle) { &mut inside } else { &mut outside }) = middle;
    }
    inside
}

/// Bounds for the film point (x, 0); `None` if no ray gets through.
fn bounds(stack: &LensStack, x: f64) -> Option<PupilBounds> {
    let film = DVec2::new(x, 0.0);
    let mut region = PupilBounds::around(DVec2::ZERO, widest(stack));
    for round in 0..ROUNDS {
        let Some(found) = hits(stack, film, region) else {
            // A small stop may lie between the rays of the first grid.
            region = around_chief(stack, film).filter(|_| round == 0)?;
            continue;
        };
        let (before, now) = (region.high - region.low, found.high - found.low);
        region = found;
        if now.cmpge(0.5 * before).all() {
            break;
        }
    }
    Some(region)
}

/// Bounds of the cells of a grid whose rays get through, and of the cells around them.
fn hits(stack: &LensStack, film: DVec2, region: PupilBounds) -> Option<PupilBounds> {
    let cell = DVec2::new(region.high.x - region.low.x, 2.0 * region.high.y) / f64::from(CELLS);
    let place = |i: i32, j: i32| DVec2::new(region.low.x, 0.0) + cell * DVec2::new(f64::from(i), f64::from(j));
    let mut found: Option<PupilBounds> = None;
    for (i, j) in (0..CELLS).flat_map(|i| (0..CELLS / 2).map(move |j| (i, j))) {
        if stack.trace(film, place(i, j) + 0.5 * cell, Edges::Opaque).is_some() {
            let high = place(i + 2, j + 2);
            let around = PupilBounds { low: DVec2::new(place(i - 1, j).x, -high.y), high };
            found = Some(found.map_or(around, |found| found.union(around)));
        }
    }
    found
}

/// Bounds around the ray through the middle of the stop, twice as wide as the stop seen from the film.
fn around_chief(stack: &LensStack, film: DVec2) -> Option<PupilBounds> {
    const STEPS: i32 = 256;
    let stop = stack.stop_aperture()?;
    let at_stop = |x: f64| Some(stack.at_stop(film, DVec2::new(x, 0.0))?.x);
    let place = |k: i32| widest(stack) * f64::from(k) / f64::from(STEPS);
    let mut pairs = (-STEPS..STEPS).filter_map(|k| Some(((place(k), at_stop(place(k))?), (place(k + 1), at_stop(place(k + 1))?))));
    let ((from, at_from), (to, at_to)) = pairs.find(|((_, a), (_, b))| (*a < 0.0) != (*b < 0.0))?;
    let side = at_from < 0.0;
    let chief = bisected(from, to, |x| at_stop(x).is_some_and(|at| (at < 0.0) == side));
    let radius = 2.0 * stop * ((to - from) / (at_to - at_from)).abs();
    Some(PupilBounds { low: DVec2::new(chief - radius, -radius), high: DVec2::new(chief + radius, radius) })
}
