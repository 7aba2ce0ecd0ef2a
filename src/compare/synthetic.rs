//! Synthetic measurements and pictures for the tests.

use glam::UVec2;

use super::{Measurement, Method};
use crate::film::{Channel, Image};

/// relMSE = v t⁻ᵇ at 1, 2, 4, … seconds.
pub fn history(replicate: u32, v: f64, b: f64, checkpoints: u32) -> Vec<Measurement> {
    let at = |k: u32| {
        let seconds = f64::from(1u32 << k);
        let relmse = v * seconds.powf(-b);
        Measurement { replicate, samples: 1 << k, seconds, mse: relmse, relmse, trimmed: relmse, others: vec![] }
    };
    (0..checkpoints).map(at).collect()
}

/// Picture of 32 × 32 grey pixels with the same standard error everywhere.
pub fn image(value: impl Fn(usize) -> f32, error: f32) -> Image {
    let size = UVec2::new(32, 32);
    let channel = |name: &str, values: Vec<f32>| Channel { name: name.into(), values };
    let colors = ["R", "G", "B"].map(|name| channel(name, (0..1024).map(&value).collect()));
    let errors = ["StdErr.R", "StdErr.G", "StdErr.B"].map(|name| channel(name, vec![error; 1024]));
    Image { full_size: size, origin: UVec2::ZERO, size, channels: colors.into_iter().chain(errors).collect() }
}

/// Method without results.
pub fn method(name: &str) -> Method {
    let image = Image { full_size: UVec2::ZERO, origin: UVec2::ZERO, size: UVec2::ZERO, channels: vec![] };
    Method {
        name: name.into(),
        integrator: name.into(),
        sampler: "sobol".into(),
        measurements: vec![],
        curve: vec![],
        image: image.clone(),
        sample: image,
        snapshots: vec![],
        spectrum: vec![],
        slope: None,
        bias: None,
        bias_bound: None,
        prices: vec![],
        lacks: String::new(),
        scene_file: None,
        files: vec![],
    }
}
