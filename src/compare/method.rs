//! Results of one method, from its measurements and pictures.

use super::bias::SquaredBias;
use super::curve::{mean, one, points, slope};
use super::price::Priced;
use super::{Measurement, Method, MethodConfig, Reference, Snapshot, TARGETS};
use crate::film::Image;

/// Combines the measurements of one method.
///
/// - `pictures`: pictures of the replicates after the last checkpoint
/// - `snapshots`: pictures of the first replicate at its last checkpoints
pub fn method(
    config: MethodConfig,
    pictures: &[Image],
    snapshots: Vec<Snapshot>,
    measurements: Vec<Measurement>,
    reference: &Reference,
    confidence: f64,
) -> Method {
    let (curve, slope) = (points(&measurements), slope(&measurements));
    let image = mean(pictures);
    let bias = SquaredBias::between(&image, &reference.image);
    let lacks = !config.lacks.is_empty();
    let priced = Priced { measurements: &measurements, curve: &curve, slope, bias, lacks, reference, confidence };
    let prices = TARGETS.iter().map(|target| priced.price(*target)).collect();
    let detected = priced.detected_bias();
    Method {
        name: config.name,
        integrator: config.integrator_name,
        sampler: config.sampler_name,
        curve,
        sample: one(pictures, &image),
        snapshots,
        image,
        slope,
        bias: detected,
        bias_bound: bias.map(|bias| bias.bound()),
        prices,
        lacks: config.lacks,
        measurements,
    }
}
