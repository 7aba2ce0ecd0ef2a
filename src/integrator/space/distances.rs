//! Distributions of distances along a ray through media.

use crate::math::lanes::{Lanes, Vector};
use crate::math::{Spectrum, Vec3, float};
use crate::medium::{Media, Medium, lost_lanes, transmittance, transmittance_lanes};

/// Distribution of free-flight distances, under the condition that the path scatters before an end.
pub struct Truncated {
    /// Probabilities of the channels, of which those without extinction cannot be chosen.
    chances: [f32; 3],
    /// 1 − T(end) for each channel.
    scattered: [f32; 3],
}

impl Truncated {
    /// - `depth`: optical depth up to the end
    ///
    /// `None` if no path scatters.
    pub fn new(media: &Media, beta: Spectrum, depth: Spectrum) -> Option<Truncated> {
        let scattered = depth.coefficients().map(|depth| -float::exp_m1_f64(-f64::from(depth)) as f32);
        let beta = if media.is_gray() { [1.0, 0.0, 0.0] } else { beta.coefficients() };
        let mut chances: [f32; 3] = std::array::from_fn(|c| if scattered[c] > 0.0 { beta[c] } else { 0.0 });
        let sum: f32 = chances.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        chances = chances.map(|chance| chance / sum);
        Some(Truncated { chances, scattered })
    }

    /// Probability that a path scatters before the end.
    pub fn scattered(&self) -> f32 {
        (0..3).map(|c| self.chances[c] * self.scattered[c]).sum()
    }

    /// A channel, and the optical depth in it.
    pub fn sample(&self, mut u: f32) -> (usize, f32) {
        let last = self.chances.iter().rposition(|chance| *chance > 0.0).unwrap_or(0);
        let mut channel = 0;
        while channel < last && u >= self.chances[channel] {
            u -= self.chances[channel];
            channel += 1;
        }
        let u = (u / self.chances[channel]).min(float::ONE_MINUS_EPSILON);
        (channel, -float::ln(1.0 - u * self.scattered[channel]))
    }

    /// Density of a point in a medium behind an optical depth (m⁻¹).
    pub fn density(&self, medium: &Medium, depth: Spectrum) -> f32 {
        let (extinction, passed) = (medium.extinction().coefficients(), transmittance(depth).coefficients());
        let of = |c: usize| if self.chances[c] > 0.0 { self.chances[c] * extinction[c] * passed[c] / self.scattered[c] } else { 0.0 };
        (0..3).map(of).sum()
    }
}

/// [`Truncated`] in each lane, for a medium that is the same everywhere and gray.
pub struct TruncatedLanes<L: Lanes> {
    /// σa + σs (m⁻¹).
    extinction: L::F32,
    /// Optical depth up to the end.
    end: L::F32,
    /// 1 − T(end), the probability that a path scatters before the end. Where it is 0, the other values mean nothing.
    pub scattered: L::F32,
}

impl<L: Lanes> TruncatedLanes<L> {
    /// - `end`: optical depth up to the end
    #[inline(always)]
    pub fn new(extinction: L::F32, end: L::F32) -> TruncatedLanes<L> {
        TruncatedLanes { extinction, end, scattered: lost_lanes::<L>(end) }
    }

    /// A distance (m).
    ///
    /// - `length`: that of the end (m)
    #[inline(always)]
    pub fn sample(&self, u: L::F32, length: L::F32) -> L::F32 {
        let u = L::min(u, L::f32(float::ONE_MINUS_EPSILON));
        let depth = -float::ln_lanes::<L>(L::f32(1.0) - u * self.scattered);
        // Rounding may lead past the end.
        L::select(L::lt(depth, self.end), depth / self.extinction, length)
    }

    /// Density of a point behind an optical depth (m⁻¹).
    #[inline(always)]
    pub fn density(&self, depth: L::F32) -> L::F32 {
        self.extinction * transmittance_lanes::<L>(depth) / self.scattered
    }
}

/// Equiangular distribution of distances along a ray: uniform in the angle at which a point beside the ray sees them.
pub struct Equiangular {
    /// Distance of the point from the ray, and its place along the ray (m).
    distance: f32,
    place: f32,
    /// Angles of the two ends.
    angles: [f32; 2],
    range: [f32; 2],
}

impl Equiangular {
    /// - `point`: position of the point relative to the point of the ray at distance 0 (m)
    /// - `range`: the two ends (m)
    ///
    /// `None` if the point is on the ray, or so far away that its distance cannot be told.
    pub fn new(point: Vec3, direction: Vec3, range: [f32; 2]) -> Option<Equiangular> {
        let place = point.dot(direction);
        let distance = (point - direction * place).length();
        let angles = range.map(|end| float::atan2(end - place, distance));
        let is_usable = distance > 1e-6 * place.abs() && distance.is_finite() && angles[1] > angles[0];
        is_usable.then_some(Equiangular { distance, place, angles, range })
    }

    pub fn sample(&self, u: f32) -> f32 {
        let (sin, cos) = float::sin_cos(self.angles[0] + u * (self.angles[1] - self.angles[0]));
        (self.place + self.distance * (sin / cos)).clamp(self.range[0], self.range[1])
    }

    /// Density of a distance (m⁻¹).
    pub fn density(&self, t: f32) -> f32 {
        let along = (t - self.place) / self.distance;
        1.0 / ((self.angles[1] - self.angles[0]) * self.distance * (1.0 + along * along))
    }
}

/// [`Equiangular`] in each lane, with 0 as the first end.
pub struct EquiangularLanes<L: Lanes> {
    distance: L::F32,
    place: L::F32,
    /// Angle of the first end, and that between the two ends.
    first: L::F32,
    angle: L::F32,
    /// Second end (m).
    end: L::F32,
}

impl<L: Lanes> EquiangularLanes<L> {
    /// See [`Equiangular::new`]. The second value is true where the distribution can be used.
    ///
    /// - `end`: the second end (m)
    #[inline(always)]
    pub fn new(point: Vector<L>, direction: Vector<L>, end: L::F32) -> (EquiangularLanes<L>, L::Mask) {
        let zero = L::f32(0.0);
        let place = point.dot(direction);
        let distance = (point - direction.scaled(place)).length();
        let first = float::atan2_lanes::<L>(zero - place, distance);
        let last = float::atan2_lanes::<L>(end - place, distance);
        let is_finite = L::lt(distance, L::f32(f32::INFINITY));
        let is_usable = L::lt(L::f32(1e-6) * L::abs(place), distance) & is_finite & L::lt(first, last);
        (EquiangularLanes { distance, place, first, angle: last - first, end }, is_usable)
    }

    #[inline(always)]
    pub fn sample(&self, u: L::F32) -> L::F32 {
        let (sin, cos) = float::sin_cos_lanes::<L>(self.first + u * self.angle);
        let t = self.place + self.distance * (sin / cos);
        L::min(L::max(t, L::f32(0.0)), self.end)
    }

    /// Density of a distance (m⁻¹).
    #[inline(always)]
    pub fn density(&self, t: L::F32) -> L::F32 {
        let one = L::f32(1.0);
        let along = (t - self.place) / self.distance;
        one / (self.angle * self.distance * (one + along * along))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::medium::Phase;

    /// Density times the length between the distances of two near numbers is the difference of the numbers.
    fn assert_is_density(sample: impl Fn(f32) -> f32, density: impl Fn(f32) -> f32) {
        const STEPS: u32 = 64;
        for k in 1..STEPS - 1 {
            let [before, at, after] = [-0.5, 0.0, 0.5].map(|half| f64::from(sample((k as f32 + half) / STEPS as f32)));
            let share = (after - before) * f64::from(density(at as f32)) * f64::from(STEPS);
            // Rounding of angles, which are near to each other for a point near the ray; and the curvature within a step, of which that of
            // 1/x near an infinite end is the most.
            let tolerance = 1e-2 + 0.3 / f64::from(STEPS - k).powi(2);
            assert!((share - 1.0).abs() < tolerance, "{k}: {before} to {after}: {share}");
        }
    }

    #[test]
    fn distances_have_their_densities() {
        for (point, range) in [([0.5, 0.0, 3.0], [1.0, 9.0]), ([0.01, 0.0, -2.0], [0.0, 4.0]), ([2.0, 1.0, 5.0], [0.0, f32::INFINITY])] {
            let angular = Equiangular::new(Vec3::from(point), Vec3::Z, range).expect("a point beside the ray");
            assert_is_density(|u| angular.sample(u), |t| angular.density(t));
        }
        let media = Media::new(vec![], vec![], None, DVec3::ZERO);
        for (extinction, length) in [(2.0, 1.5), (1e-3, 1.0), (1.0, f32::INFINITY)] {
            let medium = Medium::new(Spectrum::BLACK, Spectrum::gray(extinction), Phase::Isotropic);
            let flight = Truncated::new(&media, Spectrum::ONE, medium.depth(length)).expect("a medium that scatters");
            assert_is_density(|u| flight.sample(u).1 / extinction, |t| flight.density(&medium, medium.depth(t)));
        }
    }

    #[test]
    fn channels_are_chosen_by_what_they_carry() {
        let mut media = vec![Medium::new(Spectrum::BLACK, Spectrum::rgb(1.0, 0.5, 0.0), Phase::Isotropic)];
        let medium = media[0].clone();
        let media = Media::new(std::mem::take(&mut media), vec![], Some(crate::medium::MediumId(0)), DVec3::ZERO);
        let flight = Truncated::new(&media, Spectrum::rgb(1.0, 3.0, 5.0), medium.depth(2.0)).expect("a medium that scatters");
        // The third channel does not scatter.
        assert_eq!([0.1, 0.24, 0.26, 0.99].map(|u| flight.sample(u).0), [0, 0, 1, 1]);
        assert!(Truncated::new(&media, Spectrum::rgb(0.0, 0.0, 1.0), medium.depth(2.0)).is_none());
    }
}
