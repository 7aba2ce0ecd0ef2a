//! Light that is held back, and counted.

use super::{Event, Witness};
use crate::math::Spectrum;

/// Holds back what indirect light exceeds a limit, and remembers the sum as it would have been.
///
/// ```text
/// L → L · min(1, limit / max L),   for light that scattered twice or more
/// ```
///
/// The hue stays. Emission and direct light pass: what is bright there is so on purpose.
pub struct Clamp<'a> {
    limit: f32,
    free: Spectrum,
    acted: bool,
    inner: Option<&'a mut dyn Witness>,
}

impl<'a> Clamp<'a> {
    /// - `inner`: someone else to be told
    pub fn new(limit: f32, inner: Option<&'a mut dyn Witness>) -> Clamp<'a> {
        Clamp { limit, free: Spectrum::BLACK, acted: false, inner }
    }

    /// Whether it held anything back.
    pub fn acted(&self) -> bool {
        self.acted
    }

    /// The radiance that would have been, bit for bit.
    pub fn free(&self) -> Spectrum {
        self.free
    }
}

impl Witness for Clamp<'_> {
    fn tell(&mut self, event: Event) {
        if let Some(inner) = &mut self.inner {
            inner.tell(event);
        }
    }

    fn admit(&mut self, light: Spectrum, depth: u32) -> Spectrum {
        self.free += light;
        // What is not finite is not hidden: the sample counts as invalid.
        let exceeds = depth > 1 && light.is_finite() && light.max() > self.limit;
        self.acted |= exceeds;
        if exceeds { light * (self.limit / light.max()) } else { light }
    }
}
