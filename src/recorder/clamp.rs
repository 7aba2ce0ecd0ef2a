//! Clamping of indirect light, and the amount that it removes.

use super::{Event, PathRecorder};
use crate::math::Spectrum;

/// Recorder that clamps each contribution of indirect light to a limit and keeps the unclamped sum.
///
/// ```text
/// L → L · min(1, limit / max L),   for light that scattered twice or more
/// ```
///
/// The hue is kept. Emission and direct light are not clamped, because bright values there are intended.
pub struct Clamp<'a> {
    limit: f32,
    unclamped: Spectrum,
    acted: bool,
    inner: Option<&'a mut dyn PathRecorder>,
}

impl<'a> Clamp<'a> {
    /// A clamp that has seen no light yet.
    ///
    /// - `limit`: greatest component of one contribution of indirect light
    /// - `inner`: another recorder that receives every event
    pub fn new(limit: f32, inner: Option<&'a mut dyn PathRecorder>) -> Clamp<'a> {
        Clamp { limit, unclamped: Spectrum::BLACK, acted: false, inner }
    }

    /// Whether any contribution was reduced.
    pub fn acted(&self) -> bool {
        self.acted
    }

    /// Radiance without clamping, bit for bit.
    pub fn unclamped(&self) -> Spectrum {
        self.unclamped
    }
}

impl PathRecorder for Clamp<'_> {
    fn record(&mut self, event: Event) {
        if let Some(inner) = &mut self.inner {
            inner.record(event);
        }
    }

    fn clamp(&mut self, light: Spectrum, depth: u32) -> Spectrum {
        self.unclamped += light;
        // A value that is not finite passes unchanged, so that the sample is still counted as invalid.
        let exceeds = depth > 1 && light.is_finite() && light.max() > self.limit;
        self.acted |= exceeds;
        if exceeds { light * (self.limit / light.max()) } else { light }
    }
}
