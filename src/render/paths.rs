//! The layers that paths tell: the picture's own light, by the way it came.

use std::sync::Arc;

use crate::film::Layer;
use crate::math::Spectrum;
use crate::witness::{Sorted, Witness};

/// The light of one pixel's samples, as far as layers ask for it.
pub struct Told {
    layers: Vec<Layer>,
    sorted: Sorted,
    /// Sample after sample, three numbers for each of the layers.
    numbers: Vec<f64>,
}

impl Told {
    /// - `light_of`: of [`LightNames`](crate::film::LightNames)
    ///
    /// `None` where no layer asks.
    pub fn new(layers: &[Layer], light_of: &Arc<[u32]>) -> Option<Told> {
        let layers: Vec<Layer> = layers.iter().copied().filter(|layer| layer.is_light()).collect();
        (!layers.is_empty()).then(|| Told { layers, sorted: Sorted::new(light_of.clone()), numbers: vec![] })
    }

    /// For the next pixel.
    pub fn clear(&mut self) {
        self.numbers.clear();
    }

    /// For the next sample.
    pub fn witness(&mut self) -> &mut dyn Witness {
        self.sorted.clear();
        &mut self.sorted
    }

    /// The sample is done.
    ///
    /// - `counts`: whether it is a valid one; else it is black here as in the picture
    pub fn keep(&mut self, counts: bool) {
        for layer in &self.layers {
            let light = if counts { self.sorted.of(*layer) } else { Spectrum::BLACK };
            self.numbers.extend(light.to_rgb().map(f64::from));
        }
    }

    /// The numbers of sample i of the pixel.
    pub fn sample(&self, i: usize) -> &[f64] {
        let width = 3 * self.layers.len();
        &self.numbers[i * width..(i + 1) * width]
    }
}

impl Sorted {
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
