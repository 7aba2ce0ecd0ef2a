//! Layers with the light of the picture's own paths.

use std::sync::Arc;

use crate::film::Layer;
use crate::math::Spectrum;
use crate::recorder::{LightSplit, PathRecorder};

/// Light of a pixel's samples, for the layers that need it.
pub struct LightAovBuffer {
    layers: Vec<Layer>,
    split: LightSplit,
    /// Three numbers per layer for each sample.
    numbers: Vec<f64>,
}

impl LightAovBuffer {
    /// An empty buffer; `None` if no layer needs the light.
    ///
    /// - `light_of`: name of each light, see [`LightNames`](crate::film::LightNames)
    pub fn new(layers: &[Layer], light_of: &Arc<[u32]>) -> Option<LightAovBuffer> {
        let layers: Vec<Layer> = layers.iter().copied().filter(|layer| layer.is_light()).collect();
        (!layers.is_empty()).then(|| LightAovBuffer { layers, split: LightSplit::new(light_of.clone()), numbers: vec![] })
    }

    /// Removes all samples, for the next pixel.
    pub fn clear(&mut self) {
        self.numbers.clear();
    }

    /// Recorder for the next sample.
    pub fn recorder(&mut self) -> &mut dyn PathRecorder {
        self.split.clear();
        &mut self.split
    }

    /// Stores the light of the recorded sample. An invalid sample is black, as in the picture.
    pub fn store_sample(&mut self, is_valid: bool) {
        for layer in &self.layers {
            let light = if is_valid { self.split.of(*layer) } else { Spectrum::BLACK };
            self.numbers.extend(light.to_rgb().map(f64::from));
        }
    }

    /// Layer values of sample i of the pixel.
    pub fn sample(&self, i: usize) -> &[f64] {
        let width = 3 * self.layers.len();
        &self.numbers[i * width..(i + 1) * width]
    }
}

impl LightSplit {
    fn of(&self, layer: Layer) -> Spectrum {
        match layer {
            Layer::Emission => self.emission,
            Layer::Direct => self.direct,
            Layer::Indirect => self.indirect,
            Layer::Light(i) => self.groups.get(i as usize).copied().unwrap_or(Spectrum::BLACK),
            _ => Spectrum::BLACK,
        }
    }
}
