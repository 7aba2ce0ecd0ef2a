//! Sampling of light in two parts: a flat part and peaks.

use glam::Vec2;

use crate::math::float::ONE_MINUS_EPSILON;
use crate::math::lanes::{Lanes, One};

/// Radiance from which on light counts as a peak, relative to the mean radiance. It is above 1, so that rounding errors do not create peaks
/// in light of constant radiance.
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
        let (is_flat, u) = self.choose_lanes::<One>(u.to_array());
        if is_flat { Part::Flat(u.into()) } else { Part::Peaks(u.into()) }
    }

    /// [`FlatShare::choose`] in each lane: which lanes have the flat part, and the random numbers of the part.
    #[inline(always)]
    pub fn choose_lanes<L: Lanes>(self, [x, y]: [L::F32; 2]) -> (L::Mask, [L::F32; 2]) {
        let share = L::f32(self.0);
        let is_flat = L::lt(x, share);
        let (low, high) = (L::select(is_flat, L::f32(0.0), share), L::select(is_flat, share, L::f32(1.0)));
        (is_flat, [L::min((x - low) / (high - low), L::f32(ONE_MINUS_EPSILON)), y])
    }

    /// Density of a sample, from the densities of both parts.
    pub fn density(self, flat: f32, peaks: f32) -> f32 {
        self.density_lanes::<One>(flat, peaks)
    }

    /// [`FlatShare::density`] in each lane.
    #[inline(always)]
    pub fn density_lanes<L: Lanes>(self, flat: L::F32, peaks: L::F32) -> L::F32 {
        L::f32(self.0) * flat + L::f32(1.0 - self.0) * peaks
    }
}
