//! What biases take out of a picture.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::Mean;
use crate::film::FilmSpec;
use crate::integrator::{Bias, Integrator};
use crate::render::{Render, SampleId, Settings};
use crate::sampler::{Kind, SamplerSpec, hash};
use crate::scene::Scene;

/// What one bias takes, as a share of the energy that the picture would have without it.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    /// What does it: `max_depth 7`.
    pub setting: String,
    pub share: f64,
    /// The standard error of the share; 0 where it was counted, not estimated.
    pub error: f64,
    /// By how many camera samples it was estimated; 0 where it was counted.
    pub samples: u64,
}

/// How much may be spent on a ledger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    pub samples: u64,
    /// Looked at between lots of [`LOT`] samples.
    pub time: Duration,
}

/// Camera samples between two looks at the clock; at least one lot is taken.
pub const LOT: u64 = 32;

/// What each bias of an integrator removes, estimated without bias after a render.
///
/// ```text
/// share = D / (P + D),   D = E[L_without − L_with]
/// ```
///
/// P is the mean of the picture, and D is estimated at random pixels by both integrators on the same random numbers, which are not
/// the picture's: they differ by nothing but the bias, so that a small share is seen well. The error is that of D; P is known much
/// better.
///
/// - `seed`: the picture's; `mean`: P, over the pixels of the crop and the colours
///
/// Tests: `the_depth_limit_removes_what_the_series_says`.
pub fn ledger(scene: &Arc<dyn Scene>, integrator: &dyn Integrator, spec: &FilmSpec, seed: u64, mean: f64, budget: Budget) -> Vec<Removed> {
    let removed = |Bias { setting, without }: Bias| compare(setting, (scene, integrator), (scene, &*without), spec, seed, mean, budget);
    integrator.biases().into_iter().map(removed).collect()
}

/// What one of two methods lacks that differ by a bias, or the same method on two scenes that do.
///
/// Negative where the bias adds light.
///
/// - as for [`ledger`]; `with` and `without` the bias
pub fn compare(setting: String, with: Method, without: Method, spec: &FilmSpec, seed: u64, mean: f64, budget: Budget) -> Removed {
    let own = hash::dimension_key(!seed, APART);
    let settings = Settings::new(SamplerSpec { kind: Kind::Independent, seed: own, ..SamplerSpec::default() });
    let [with, without] = [with, without].map(|(scene, integrator)| Render::new(scene.clone(), integrator, spec, &settings));
    let (mut sum, mut square, mut samples) = (0.0, 0.0, 0);
    let start = Instant::now();
    while samples < budget.samples && (samples == 0 || start.elapsed() < budget.time) {
        let lot = (samples..samples + LOT).into_par_iter().map(|i| difference(&with, &without, spec, own, i)).collect::<Vec<_>>();
        lot.into_iter().for_each(|d| (sum, square) = (sum + d, square + d * d));
        samples += LOT;
    }
    let removed = Mean::from_sums(sum, square, samples);
    let part = |x: f64| if mean + removed.value > 0.0 { x / (mean + removed.value) } else { 0.0 };
    Removed { setting, share: part(removed.value), error: part(removed.standard_error()) * part(mean), samples }
}

/// An integrator and what it renders.
pub type Method<'a> = (&'a Arc<dyn Scene>, &'a dyn Integrator);

/// No scrambling of a picture's pixel has this number.
const APART: u32 = u32::MAX;

/// What sample i of a ledger lacks: the mean of the colours. An invalid one lacks nothing here: the render counts those.
fn difference(with: &Render, without: &Render, spec: &FilmSpec, key: u64, i: u64) -> f64 {
    let crop = spec.crop;
    let place = hash::dimension_key(key, i as u32) % crop.pixel_count();
    let width = u64::from(crop.size().x);
    let (x, y) = ((place % width) as u32, (place / width) as u32);
    let id = SampleId { pixel: (crop.min.x + x, crop.min.y + y), index: i };
    let [with, without] = [with, without].map(|render| render.replay(id, None));
    let difference = without - with;
    if difference.is_finite() { difference.to_rgb().into_iter().map(f64::from).sum::<f64>() / 3.0 } else { 0.0 }
}
