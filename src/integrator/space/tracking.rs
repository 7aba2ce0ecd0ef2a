//! Collisions of a ray with a medium whose density varies.

use std::ops::ControlFlow;

use super::stretches::Stretch;
use crate::math::{Ray, Spectrum, Vec3, float};
use crate::medium::{Density, Medium, Segment};
use crate::sampler::Stream;

/// Tentative collision of a ray with a medium.
pub struct Collision {
    /// Length of the way from the point that the ray leaves (m).
    pub length: f32,
    /// The point, in the unit cube of the density.
    pub place: Vec3,
    /// Probability of each channel that the collision is real: ρ (σa + σs) / μ, with the density μ of tentative collisions.
    pub real: Spectrum,
}

/// Calls `visit` for each tentative collision on a stretch of a ray, in their order, until it breaks.
///
/// Tentative collisions are a Poisson process with the density μ = σ ρ̄ per metre, where ρ̄ is the upper bound of the density and σ the
/// greatest extinction of a channel at the density 1.
pub fn collisions<T>(
    medium: &Medium,
    density: &Density,
    ray: &Ray,
    stretch: &Stretch,
    numbers: &mut Stream,
    mut visit: impl FnMut(Collision, &mut Stream) -> ControlFlow<T>,
) -> ControlFlow<T> {
    let extinction = medium.extinction();
    let greatest = extinction.max();
    if greatest <= 0.0 {
        return ControlFlow::Continue(());
    }
    let relative = extinction * (1.0 / greatest);
    // Lengths count from the start of the stretch, where the origin of the ray may be far away.
    let shift = (ray.origin - ray.from).dot(ray.direction);
    let line = density.line(ray.origin + ray.direction * (stretch.start - shift), ray.direction);
    let mut left = optical_depth(numbers);
    for Segment { range: [mut at, end], majorant } in density.bounds_along(line, stretch.length) {
        let per_metre = greatest * majorant;
        if per_metre <= 0.0 {
            continue;
        }
        loop {
            let depth = (end - at) * per_metre;
            if left >= depth {
                left -= depth;
                break;
            }
            at += left / per_metre;
            let place = line.at(at);
            let share = (density.at(place) / majorant).min(1.0);
            visit(Collision { length: stretch.start + at, place, real: relative * share }, numbers)?;
            left = optical_depth(numbers);
        }
    }
    ControlFlow::Continue(())
}

/// Optical depth up to the next tentative collision: P(τ > t) = e^(−t).
fn optical_depth(numbers: &mut Stream) -> f32 {
    -float::ln(1.0 - numbers.next_1d())
}

/// Transmittance below which Russian roulette may end the ray at a collision.
const FAINT: f32 = 1.0 / 64.0;
/// Probability that the ray survives Russian roulette.
const SURVIVAL: f32 = 0.5;

/// Estimate of the share of the light that passes a stretch, whose mean is e^(−τ) (ratio tracking).
///
/// T = Π (1 − ρ (σa + σs) / μ) over all tentative collisions
///
/// It is never noisier than the estimate that is 1 without a real collision and otherwise 0.
///
/// Source: Novák, Selle and Jarosz, *Residual Ratio Tracking for Estimating Attenuation in Participating Media* (2014).
pub fn ratio(medium: &Medium, density: &Density, ray: &Ray, stretch: &Stretch, numbers: &mut Stream) -> Spectrum {
    let mut passed = Spectrum::ONE;
    let _ = collisions(medium, density, ray, stretch, numbers, |collision, numbers| {
        passed *= Spectrum::ONE - collision.real;
        if passed.max() >= FAINT {
            return ControlFlow::Continue(());
        }
        if passed.is_black() || numbers.next_1d() >= SURVIVAL {
            passed = Spectrum::BLACK;
            return ControlFlow::Break(());
        }
        passed *= Spectrum::gray(1.0 / SURVIVAL);
        ControlFlow::Continue(())
    });
    passed
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, UVec3, Vec3};

    use super::*;
    use crate::math::Transform;
    use crate::medium::{Grid, Inside, Phase, Places};
    use crate::sampler::{Kind, SamplerSpec};

    /// Mean and variance of an estimate for many rays through a medium of density 1 and thickness 1 in the direction +x.
    ///
    /// - `depth`: optical depth
    /// - `factor`: of the upper bounds
    fn moments(depth: f32, factor: f32, estimate: impl Fn(&Medium, &Density, &Ray, &Stretch, &mut Stream) -> f32) -> [f64; 2] {
        const RAYS: u64 = 1 << 18;
        let density = Density::new(Grid::new(UVec3::splat(3), vec![1.0; 27], Places::Centers), &Transform::IDENTITY);
        let medium = Medium::new(Spectrum::gray(depth), Spectrum::BLACK, Phase::Isotropic).with_density(density.with_bounds_scaled(factor));
        let density = medium.density().expect("a density");
        let ray = Ray::new(Vec3::new(-1.0, 0.3, 0.7), Vec3::X);
        let stretch = Stretch { medium: None, start: 0.5, length: 2.0, inside: Inside::default() };
        let sequence = SamplerSpec { kind: Kind::Independent, ..SamplerSpec::default() }.build();
        let mut sums = [0.0; 2];
        for index in 0..RAYS {
            let mut numbers = sequence.sample(UVec2::ZERO, index).stream(7);
            let found = f64::from(estimate(&medium, density, &ray, &stretch, &mut numbers));
            sums = [sums[0] + found, sums[1] + found * found];
        }
        let mean = sums[0] / RAYS as f64;
        [mean, sums[1] / RAYS as f64 - mean * mean]
    }

    #[test]
    fn estimates_of_the_transmittance_have_their_mean_and_variance() {
        let ratio = |medium: &Medium, density: &Density, ray: &Ray, stretch: &Stretch, numbers: &mut Stream| {
            super::ratio(medium, density, ray, stretch, numbers).max()
        };
        let delta = |medium: &Medium, density: &Density, ray: &Ray, stretch: &Stretch, numbers: &mut Stream| {
            let met = collisions(medium, density, ray, stretch, numbers, |collision, numbers| {
                if numbers.next_1d() < collision.real.max() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            f32::from(u8::from(met.is_continue()))
        };
        // Mean e^−τ; variance e^−2τ (e^(τ/k) − 1) of ratio tracking, and e^−τ (1 − e^−τ) of delta tracking. Of 2^18 rays, the mean has a
        // standard error of √(variance / 2^18), and the variance of an estimate between 0 and 1 one of at most √(variance / 2^18): 5 of
        // them, since there are 12 numbers. Rays that end by chance add at most 2 % to the variance here.
        let check = |[mean, variance]: [f64; 2], expected: [f64; 2], what: &str| {
            let error = 5.0 * (expected[1] / f64::from(1 << 18)).sqrt();
            assert!((mean - expected[0]).abs() < error, "{what}: {mean}, not {}", expected[0]);
            assert!((variance - expected[1]).abs() < error + 0.02 * expected[1], "{what}: variance {variance}, not {}", expected[1]);
        };
        for (depth, factor, variance) in [(1.0, 1.0, 0.232_544_158), (1.0, 2.0, 0.087_794_877), (1.0, 4.0, 0.038_438_660)] {
            check(moments(depth, factor, ratio), [f64::from(-depth).exp(), variance], &format!("ratio tracking, {depth}, {factor}"));
        }
        // Bounds 2 % too small let more light pass: by 2 % of the optical depth, which is 8 standard errors here.
        let [mean, _] = moments(1.0, 0.98, ratio);
        assert!((mean - f64::from(-0.98f32).exp()).abs() < 0.005 && mean > f64::from(-1.0f32).exp() + 0.005, "{mean}");
        for (depth, factor, variance) in [(1.0, 1.0, 0.232_544_158), (1.0, 3.0, 0.232_544_158), (5.0, 2.0, 0.006_692_547)] {
            check(moments(depth, factor, delta), [f64::from(-depth).exp(), variance], &format!("delta tracking, {depth}, {factor}"));
        }
    }

    /// The cost of a ray is in proportion to the factor k of the upper bounds: it meets k τ tentative collisions in the mean with a variance of
    /// k τ (Poisson), and k (1 − e^−τ) up to the first real one, as one of k is real.
    #[test]
    fn cost_is_in_proportion_to_the_upper_bounds() {
        let count = |until_real: bool| {
            move |medium: &Medium, density: &Density, ray: &Ray, stretch: &Stretch, numbers: &mut Stream| {
                let mut met = 0u16;
                let _ = collisions(medium, density, ray, stretch, numbers, |collision, numbers| {
                    met += 1;
                    let is_real = numbers.next_1d() < collision.real.max();
                    if until_real && is_real { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                });
                f32::from(met)
            }
        };
        for (depth, factor) in [(0.5f32, 1.0f32), (0.5, 2.0), (0.5, 10.0), (0.5, 100.0)] {
            let most = f64::from(depth * factor);
            let until_real = f64::from(factor) * (1.0 - f64::from(-depth).exp());
            // Four factors with two numbers each: 5 standard errors of 2^18 rays. Breaking off makes no count longer.
            let error = 5.0 * (most / f64::from(1 << 18)).sqrt();
            let [mean, variance] = moments(depth, factor, count(false));
            assert!((mean - most).abs() < error, "{factor}: {mean}, not {most}");
            // The variance of a Poisson variable's sample variance is (λ + 2 λ²)/n.
            let off = 5.0 * ((most + 2.0 * most * most) / f64::from(1 << 18)).sqrt();
            assert!((variance - most).abs() < off, "{factor}: variance {variance}, not {most}");
            let [mean, variance] = moments(depth, factor, count(true));
            let error = 5.0 * (variance / f64::from(1 << 18)).sqrt();
            assert!((mean - until_real).abs() < error, "{factor}: {mean} up to a real one, not {until_real}");
        }
    }
}
