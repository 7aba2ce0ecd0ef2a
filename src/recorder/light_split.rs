//! Radiance split by path length and by light.

use std::sync::Arc;

use super::{Event, PathRecorder};
use crate::math::Spectrum;

/// Recorder that splits the radiance of one camera sample into the parts that the layers `Emission`, `Direct`, `Indirect` and
/// `Light.<name>` add up.
///
/// ```text
/// L = emission + direct + indirect = Σ groups
/// ```
///
/// up to the rounding of the sums. The weight of the reconstruction filter is not included.
///
/// Tests: `split_light_adds_up_to_all_light`.
#[derive(Clone, Debug, PartialEq)]
pub struct LightSplit {
    /// Light that reaches the camera without scattering.
    pub emission: Spectrum,
    /// Light that scattered once.
    pub direct: Spectrum,
    /// Light that scattered more than once.
    pub indirect: Spectrum,
    /// All light, summed for each group of lights.
    pub groups: Vec<Spectrum>,
    group_of: Arc<[u32]>,
}

impl LightSplit {
    /// A split without light.
    ///
    /// - `group_of`: group of each light, and then of the media if they emit, see [`LightNames`](crate::film::LightNames)
    pub fn new(group_of: Arc<[u32]>) -> LightSplit {
        let count = group_of.iter().max().map_or(0, |last| *last as usize + 1);
        LightSplit {
            emission: Spectrum::BLACK,
            direct: Spectrum::BLACK,
            indirect: Spectrum::BLACK,
            groups: vec![Spectrum::BLACK; count],
            group_of,
        }
    }

    /// Resets all sums for the next camera sample.
    pub fn clear(&mut self) {
        (self.emission, self.direct, self.indirect) = (Spectrum::BLACK, Spectrum::BLACK, Spectrum::BLACK);
        self.groups.fill(Spectrum::BLACK);
    }
}

impl PathRecorder for LightSplit {
    fn record(&mut self, event: Event) {
        let Event::Light(light) = event else { return };
        match light.depth {
            0 => self.emission += light.value,
            1 => self.direct += light.value,
            _ => self.indirect += light.value,
        }
        // What media emit comes after the lights.
        let source = light.origin.light.map_or(self.group_of.len().saturating_sub(1), |light| light as usize);
        let group = self.group_of.get(source);
        if let Some(sum) = group.and_then(|group| self.groups.get_mut(*group as usize)) {
            *sum += light.value;
        }
    }
}
