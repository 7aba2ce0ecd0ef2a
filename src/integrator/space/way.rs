//! Points on the way to the next surface at which media scatter light into a path.

use std::ops::ControlFlow;

use arrayvec::ArrayVec;

use super::distances::{Equiangular, Truncated};
use super::stretches::{Stretch, stretches};
use crate::integrator::CameraPath;
use crate::math::{Ray, Spectrum, float};
use crate::medium::{Inside, Media, transmittance};
use crate::primitive::Hit;
use crate::sampler::SampleNumbers;
use crate::sampler::dimension::{self, OnWay};
use crate::scene::{MediumPoint, Scene};

/// Greatest number of stretches for which a point on the way is chosen.
const MOST_STRETCHES: usize = 16;

/// A point is chosen with a probability of this number times that of scattering on the way, and always where this exceeds 1. A point costs as
/// much as a vertex, and in thin media hardly any path scatters.
pub const POINTS_PER_SCATTERING: f32 = 4.0;

/// Way from a vertex to the next surface through media of which one at least scatters light.
///
/// The distance t of the point has the mean of two densities, each sampled half of the time:
/// - distances at which paths scatter, truncated at the end of the way: σ T(t) / (1 − T(end)), for a channel chosen at random
/// - equiangular sampling towards a point y of a light: D / ((θ₁ − θ₀) (D² + (t − δ)²)), where D is the distance of y from the ray, δ the
///   distance along the ray of the point nearest to y, and θ₀ and θ₁ the angles of the two ends seen from y
///
/// Without such a y, only the first is used.
///
/// Source: Kulla and Fajardo, *Importance Sampling Techniques for Path Tracing in Participating Media* (2012).
pub struct Way<'s> {
    stretches: ArrayVec<Stretch<'s>, MOST_STRETCHES>,
    /// Ends of the part with media that scatter (m).
    range: [f32; 2],
    /// Optical depth of the media that scatter.
    depth: Spectrum,
}

impl<'s> Way<'s> {
    /// A way of no length.
    pub fn new() -> Way<'s> {
        Way { stretches: ArrayVec::new(), range: [f32::INFINITY, 0.0], depth: Spectrum::BLACK }
    }

    /// Adds the stretches along a ray up to a hit. Returns whether something scatters on it, nothing has a density that varies, and there
    /// are not too many stretches.
    // In place, because moving a way would take as long as all else.
    pub fn follow(&mut self, scene: &dyn Scene, media: &'s Media, inside: &Inside, ray: &Ray, hit: Option<&Hit>) -> bool {
        let add = |stretch: &Stretch<'s>| {
            if stretch.medium.is_some_and(|(_, medium)| medium.density().is_some()) {
                return ControlFlow::Break(());
            }
            if let Some((_, medium)) = stretch.medium.filter(|(_, medium)| medium.scatters()) {
                self.range = [self.range[0].min(stretch.start), stretch.start + stretch.length];
                self.depth += medium.depth(stretch.length);
            }
            match self.stretches.try_push(stretch.clone()) {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        };
        let t_max = hit.map_or(f32::INFINITY, |hit| hit.t);
        let all = stretches(scene, media, &mut inside.clone(), ray, t_max, add);
        all.is_continue() && self.range[0] < self.range[1]
    }

    /// A point, the weight of the light that arrives there, and the bodies around it; `None` if no point is chosen.
    pub fn sample(
        &self,
        scene: &dyn Scene,
        media: &Media,
        path: &CameraPath,
        numbers: &mut SampleNumbers,
    ) -> Option<(MediumPoint<'s>, Spectrum, Inside)> {
        let ray = &path.ray;
        let shift = (ray.origin - ray.from).dot(ray.direction);
        let flight = Truncated::new(media, path.beta, self.depth)?;
        let v = numbers.get_1d(dimension::on_way(path.depth, OnWay::Distance));
        let chance = (POINTS_PER_SCATTERING * flight.scattered()).min(1.0);
        if v >= chance {
            return None;
        }
        let v = (v / chance).min(float::ONE_MINUS_EPSILON);
        // Lights are chosen by their power and not by what they bring to one point of the ray: the cone of a spotlight may miss that point and
        // cross the ray elsewhere.
        let (choice, u) = numbers.get_3d(dimension::on_way(path.depth, OnWay::Guide));
        let guide = scene.lights().place(choice, u, ray.time);
        let angular = guide.and_then(|guide| Equiangular::new(guide - ray.at(-shift), ray.direction, self.range));
        let t = match &angular {
            Some(angular) if v < 0.5 => angular.sample(2.0 * v),
            Some(_) => self.along(&flight, 2.0 * v - 1.0),
            None => self.along(&flight, v),
        };
        let stretch = self.stretches.iter().find(|stretch| t < stretch.start + stretch.length)?;
        let (_, medium) = stretch.medium.filter(|(_, medium)| medium.scatters())?;
        let (mut all, mut scattering) = (Spectrum::BLACK, Spectrum::BLACK);
        for before in self.stretches.iter().take_while(|before| before.start <= stretch.start) {
            let Some((_, medium)) = before.medium else { continue };
            let depth = medium.depth(before.length.min(t - before.start).max(0.0));
            all += depth;
            scattering += if medium.scatters() { depth } else { Spectrum::BLACK };
        }
        let by_flight = flight.density(medium, scattering);
        let density = angular.map_or(by_flight, |angular| 0.5 * (by_flight + angular.density(t)));
        let point = MediumPoint { p: ray.at((t - shift).max(0.0)), phase: &medium.phase };
        let weight = 1.0 / (chance * density);
        (density > 0.0).then(|| (point, transmittance(all) * medium.scattering() * weight, stretch.inside))
    }

    /// Distance of a point that is chosen as paths scatter.
    fn along(&self, flight: &Truncated, u: f32) -> f32 {
        let (channel, mut left) = flight.sample(u);
        let mut last = self.range[0];
        for stretch in &self.stretches {
            let Some((_, medium)) = stretch.medium.filter(|(_, medium)| medium.scatters()) else { continue };
            let extinction = medium.extinction().coefficients()[channel];
            let depth = medium.depth(stretch.length).coefficients()[channel];
            if left < depth {
                return stretch.start + left / extinction;
            }
            left -= depth;
            last = stretch.start + stretch.length;
        }
        // Rounding may lead past the end.
        last
    }
}
