//! Sampling of light in two parts: a flat part and peaks.

use glam::Vec2;

use crate::math::float::ONE_MINUS_EPSILON;

/// Ratio of the radiance from which on light counts as a peak to the mean radiance. Above 1, so that rounding makes no peaks of one
/// colour.
pub(super) const THRESHOLD: f32 = 1.0 + 1.0 / 16.0;

/// Share s of the samples of a light that are of its flat part.
///
/// The radiance L of a light is divided into a flat part min(L, t) and peaks max(0, L − t), where t is [`THRESHOLD`] times the mean of L.
/// The flat part is sampled as light of one radiance is, and the peaks by a table, which gives the density
///
/// p = s p_flat + (1 − s) p_peaks.
///
/// Each place that emits light can be sampled, however dim it is beside others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FlatShare(f32);

/// The part of a light that a sample is of, with its random numbers in [0, 1)².
pub(super) enum Part {
    Flat(Vec2),
    Peaks(Vec2),
}

impl FlatShare {
    /// Light without peaks.
    pub const ALL: FlatShare = FlatShare(1.0);

    /// - `share`: in (0, 1]
    pub fn new(share: f32) -> FlatShare {
        debug_assert!(share > 0.0 && share <= 1.0, "{share}");
        FlatShare(share)
    }

    /// Chooses a part, with the first of two random numbers in [0, 1).
    pub fn choose(self, u: Vec2) -> Part {
        let of_interval = |low: f32, high: f32| Vec2::new(((u.x - low) / (high - low)).min(ONE_MINUS_EPSILON), u.y);
        if u.x < self.0 { Part::Flat(of_interval(0.0, self.0)) } else { Part::Peaks(of_interval(self.0, 1.0)) }
    }

    /// Density of a sample, from the densities of both parts.
    pub fn density(self, flat: f32, peaks: f32) -> f32 {
        self.0 * flat + (1.0 - self.0) * peaks
    }
}
