//! Light by the way it came.

use std::sync::Arc;

use super::{Event, Witness};
use crate::math::Spectrum;

/// The radiance of one camera sample, sorted: what the layers `Direct`, `Indirect` and `Light.<name>` of a picture are sums of.
///
/// ```text
/// L = emission + direct + indirect = Σ groups
/// ```
///
/// but for the rounding of sums, and without the filter's weight.
///
/// Tests: `sorted_light_is_all_the_light`.
#[derive(Clone, Debug, PartialEq)]
pub struct Sorted {
    /// Seen by the camera itself.
    pub emission: Spectrum,
    /// Scattered once.
    pub direct: Spectrum,
    /// Scattered more than once.
    pub indirect: Spectrum,
    /// However it came, by the group of the light that it comes from.
    pub groups: Vec<Spectrum>,
    group_of: Arc<[u32]>,
}

impl Sorted {
    /// - `group_of`: the group of each light, as [`LightNames`](crate::film::LightNames) has it
    pub fn new(group_of: Arc<[u32]>) -> Sorted {
        let count = group_of.iter().max().map_or(0, |last| *last as usize + 1);
        Sorted {
            emission: Spectrum::BLACK,
            direct: Spectrum::BLACK,
            indirect: Spectrum::BLACK,
            groups: vec![Spectrum::BLACK; count],
            group_of,
        }
    }

    /// For the next camera sample.
    pub fn clear(&mut self) {
        (self.emission, self.direct, self.indirect) = (Spectrum::BLACK, Spectrum::BLACK, Spectrum::BLACK);
        self.groups.fill(Spectrum::BLACK);
    }
}

impl Witness for Sorted {
    fn tell(&mut self, event: Event) {
        let Event::Light(light) = event else { return };
        match light.depth {
            0 => self.emission += light.value,
            1 => self.direct += light.value,
            _ => self.indirect += light.value,
        }
        let group = light.origin.light.and_then(|light| self.group_of.get(light as usize));
        if let Some(sum) = group.and_then(|group| self.groups.get_mut(*group as usize)) {
            *sum += light.value;
        }
    }
}
