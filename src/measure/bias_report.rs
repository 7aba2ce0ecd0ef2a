//! Estimates of how much light the biases of an integrator remove from a picture.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::UVec2;
use rayon::prelude::*;

use super::Mean;
use crate::film::{Crop, FilmSpec};
use crate::integrator::{Bias, Integrator};
use crate::math::Spectrum;
use crate::render::{Render, SampleId, Settings};
use crate::sampler::{Kind, SamplerSpec, hash};
use crate::scene::Scene;

/// Light that one bias removes, as a share of the light that the picture would have without the bias.
#[derive(Clone, Debug, PartialEq)]
pub struct BiasEstimate {
    /// Setting that causes the bias, such as `max_depth 7`.
    pub setting: String,
    /// Share of the light; negative if the bias adds light.
    pub share: f64,
    /// Standard error of the share; 0 if the share was counted, not estimated.
    pub error: f64,
    /// Number of camera samples of the estimate; 0 if the share was counted.
    pub samples: u64,
}

/// Limits for the work of one bias estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiasBudget {
    /// Greatest number of camera samples.
    pub samples: u64,
    /// Samples per pixel of the picture. Sample indices of the estimate stay below it, so that texture footprints are as in the picture.
    pub per_pixel: u64,
    /// Greatest duration of the estimation. The clock is checked after every [`BATCH`] samples.
    pub time: Duration,
}

/// Camera samples between two checks of the clock; at least one batch is taken.
pub const BATCH: u64 = 32;

/// Estimates what each bias of an integrator removes, after a render.
///
/// ```text
/// share = D / (P + D),   D = E[L_without − L_with]
/// ```
///
/// P is the mean of the picture. D is estimated at random pixels by the integrator with and without its bias, on the same random
/// numbers, so that the two differ by the bias only and even a small share is found. Those numbers are not the picture's. The error
/// of the share is that of D, as P is known much better.
///
/// - `seed`: the picture's seed
/// - `mean`: P, over the pixels of the crop and the colours
///
/// Tests: `the_depth_limit_removes_what_the_series_says`.
pub fn bias_report(
    scene: &Arc<dyn Scene>,
    integrator: &dyn Integrator,
    spec: &FilmSpec,
    seed: u64,
    mean: f64,
    budget: BiasBudget,
) -> Vec<BiasEstimate> {
    let removed =
        |Bias { setting, without }: Bias| estimate_bias(setting, (scene, integrator, spec), (scene, &*without, spec), seed, mean, budget);
    integrator.biases().into_iter().map(removed).collect()
}

/// Estimates the light that one of two methods lacks. They differ by a bias: two integrators, one integrator on two scenes, or two settings
/// of the film that change neither its size nor its crop.
///
/// The share is negative where the bias adds light.
///
/// - `with`, `without`: the method with the bias and without it
/// - the other parameters are those of [`bias_report`]
pub fn estimate_bias(setting: String, with: Method, without: Method, seed: u64, mean: f64, budget: BiasBudget) -> BiasEstimate {
    let own = hash::dimension_key(!seed, OWN_NUMBERS);
    let settings = Settings::new(SamplerSpec { kind: Kind::Independent, seed: own, ..SamplerSpec::default() });
    let spec = with.2;
    let [with, without] = [with, without].map(|(scene, integrator, spec)| Render::new(scene.clone(), integrator, spec, &settings));
    let (mut sum, mut square, mut samples) = (0.0, 0.0, 0);
    let start = Instant::now();
    while samples < budget.samples && (samples == 0 || start.elapsed() < budget.time) {
        let batch = (samples..samples + BATCH)
            .into_par_iter()
            .map(|i| difference(&with, &without, spec, own, i, budget.per_pixel))
            .collect::<Vec<_>>();
        batch.into_iter().for_each(|d| (sum, square) = (sum + d, square + d * d));
        samples += BATCH;
    }
    let removed = Mean::from_sums(sum, square, samples);
    let part = |x: f64| if mean + removed.value > 0.0 { x / (mean + removed.value) } else { 0.0 };
    BiasEstimate { setting, share: part(removed.value), error: part(removed.standard_error()) * part(mean), samples }
}

/// A scene, the integrator that renders it, and the film.
pub type Method<'a> = (&'a Arc<dyn Scene>, &'a dyn Integrator, &'a FilmSpec);

/// Dimension of the key of an estimate's random numbers, which no scrambling of a picture uses.
const OWN_NUMBERS: u32 = u32::MAX;

/// Difference that sample i shows: the mean over the colours. Invalid samples count as 0 here, as the render itself reports them.
fn difference(with: &Render, without: &Render, spec: &FilmSpec, key: u64, i: u64, per_pixel: u64) -> f64 {
    // Every pixel of the whole picture has a path from the lights, which may bring light to the crop.
    let from = if with.splats() { Crop { min: UVec2::ZERO, max: spec.size } } else { spec.crop };
    let place = hash::dimension_key(key, i as u32) % from.pixel_count();
    let width = u64::from(from.size().x);
    let pixel = from.min + UVec2::new((place % width) as u32, (place / width) as u32);
    let id = SampleId { pixel: pixel.into(), index: i % per_pixel.max(1) };
    let share = from.pixel_count() as f64 / spec.crop.pixel_count() as f64;
    let [with, without] = [with, without].map(|render| contribution(render, spec.crop, id));
    let difference = without - with;
    if difference.is_finite() { share * difference } else { 0.0 }
}

/// What a sample adds to the pixels of the crop: the mean over the colours. Splats count where they arrive, without the filter, which
/// only distributes them.
fn contribution(render: &Render, crop: Crop, id: SampleId) -> f64 {
    let mean = |light: Spectrum| light.to_rgb().into_iter().map(f64::from).sum::<f64>() / 3.0;
    let (own, splats) = render.replay_with_splats(id, None);
    let own = if crop.contains(id.pixel.into()) { mean(own) } else { 0.0 };
    let [min, max] = [crop.min, crop.max].map(|corner| corner.as_vec2());
    let inside = splats.iter().filter(|splat| splat.raster.cmpge(min).all() && splat.raster.cmplt(max).all());
    own + inside.map(|splat| mean(splat.value)).sum::<f64>()
}
