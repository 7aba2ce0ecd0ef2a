//! How far a path goes before a medium scatters it.

use crate::math::{Spectrum, float};
use crate::medium::{Media, Medium};

/// The way from a vertex to the next one, which may lead through several media.
///
/// One number decides for the whole way at which optical depth τ the path scatters: P(τ > t) = e^(−t). A boundary within a medium
/// therefore changes nothing.
///
/// Where the extinction differs between wavelengths, the depth is that of one channel, which is chosen by the throughput, and the weight
/// is that of the balance heuristic for all channels c that might have been chosen, with their probabilities q:
///
/// scattered: σs T / Σ_c q_c σ_c T_c,  not scattered: T / Σ_c q_c T_c
///
/// Where the density varies, T and σ are those of the tentative collisions (see `tracking`), and the same weights follow.
///
/// Source: Kutz, Habel, Li and Novák, *Spectral and Decomposition Tracking for Rendering Heterogeneous Volumes* (2017); Miller,
/// Georgiev and Jarosz, *A Null-Scattering Path Integral Formulation of Light Transport* (2019).
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// Channel whose optical depth counts.
    pub channel: usize,
    /// Optical depth, in that channel, that is left until the path scatters.
    pub left: f32,
    /// Probabilities of the channels, given that the path was not scattered so far.
    chances: [f32; 3],
}

impl Flight {
    pub fn new(media: &Media, beta: Spectrum, mut u: f32) -> Flight {
        let sum: f32 = beta.coefficients().into_iter().sum();
        let mut chances = beta.coefficients().map(|coefficient| coefficient / sum);
        if !(sum > 0.0 && sum.is_finite()) {
            chances = [1.0 / 3.0; 3];
        }
        let mut channel = 0;
        if !media.is_gray() {
            let last = chances.iter().rposition(|chance| *chance > 0.0).unwrap_or(0);
            while channel < last && u >= chances[channel] {
                u -= chances[channel];
                channel += 1;
            }
            u = (u / chances[channel]).min(float::ONE_MINUS_EPSILON);
        }
        Flight { channel, left: -float::ln(1.0 - u), chances }
    }

    /// Transmittances of the channels, relative to that of the least optical depth of a channel with any light; 0 for channels without.
    fn relative(&self, depth: Spectrum) -> [f32; 3] {
        let depths = depth.coefficients();
        let has_light = |c: usize| self.chances[c] > 0.0;
        let least = (0..3).filter(|c| has_light(*c)).map(|c| depths[c]).fold(f32::INFINITY, f32::min);
        std::array::from_fn(|c| match depths[c] {
            _ if !has_light(c) => 0.0,
            same if same == least => 1.0,
            more => float::exp(least - more),
        })
    }

    /// Weight of a path that is scattered after `length` (m).
    pub fn scattered(&self, medium: &Medium, length: f32) -> Spectrum {
        if medium.is_gray() {
            return medium.albedo();
        }
        let passed = self.relative(medium.depth(length));
        let extinction = medium.extinction().coefficients();
        let density: f32 = (0..3).map(|c| self.chances[c] * extinction[c] * passed[c]).sum();
        medium.scattering() * Spectrum::from_array(passed.map(|passed| passed / density))
    }

    /// Weight of a path that passes `length` (m) without being scattered.
    pub fn pass(&mut self, medium: &Medium, length: f32) -> Spectrum {
        let depth = medium.depth(length);
        self.left = (self.left - depth.coefficients()[self.channel]).max(0.0);
        if medium.is_gray() {
            return Spectrum::ONE;
        }
        self.given(self.relative(depth))
    }

    /// Weight of a path that collides with the medium at a point and is scattered there.
    ///
    /// - `albedo`: share of its light that is scattered there
    /// - `real`: probability of each channel to collide there
    pub fn collided(&self, medium: &Medium, albedo: Spectrum, real: Spectrum) -> Spectrum {
        if medium.is_gray() {
            return albedo;
        }
        let real = real.coefficients();
        let chance: f32 = (0..3).map(|c| self.chances[c] * real[c]).sum();
        albedo * Spectrum::from_array(real.map(|real| real / chance))
    }

    /// Weight of a path that does not collide with the medium at a point.
    ///
    /// - `real`: probability of each channel to collide there
    pub fn missed(&mut self, medium: &Medium, real: Spectrum) -> Spectrum {
        if medium.is_gray() {
            return Spectrum::ONE;
        }
        self.given(real.coefficients().map(|real| 1.0 - real))
    }

    /// Weight of a path after an event, and the new probabilities of the channels (Bayes' theorem).
    ///
    /// - `of`: probability of the event in each channel, or numbers proportional to it
    fn given(&mut self, of: [f32; 3]) -> Spectrum {
        let chance: f32 = (0..3).map(|c| self.chances[c] * of[c]).sum();
        self.chances = std::array::from_fn(|c| self.chances[c] * of[c] / chance);
        Spectrum::from_array(of.map(|of| of / chance))
    }
}
