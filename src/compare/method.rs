//! Results of one method, from its measurements and pictures.

use super::bias::SquaredBias;
use super::curve::{mean, one, points, slope};
use super::price::Priced;
use super::spectrum::error_spectrum;
use super::{Measurement, Method, MethodConfig, Reference, Snapshot, TARGETS};
use crate::film::Image;

/// What a report says of a method beside its results.
pub struct About {
    /// Name in the report.
    pub name: String,
    /// Name of the integrator.
    pub integrator: String,
    /// Name of the sampler.
    pub sampler: String,
    /// Effects that the scene needs and the method leaves out, in words.
    pub lacks: String,
    /// File of the scene that it renders; `None` for the scene of the comparison.
    pub scene_file: Option<String>,
    /// Files of its pictures; empty for a method that is rendered.
    pub files: Vec<String>,
}

impl From<&MethodConfig> for About {
    fn from(config: &MethodConfig) -> About {
        let MethodConfig { name, integrator_name, sampler_name, lacks, scene_file, .. } = config;
        About {
            name: name.clone(),
            integrator: integrator_name.clone(),
            sampler: sampler_name.clone(),
            lacks: lacks.clone(),
            scene_file: scene_file.clone(),
            files: vec![],
        }
    }
}

/// Combines the measurements of one method.
///
/// - `pictures`: pictures of the replicates after the last checkpoint
/// - `snapshots`: pictures of the first replicate at its last checkpoints
pub fn method(
    about: About,
    pictures: &[Image],
    snapshots: Vec<Snapshot>,
    measurements: Vec<Measurement>,
    reference: &Reference,
    confidence: f64,
) -> Method {
    let (curve, slope) = (points(&measurements), slope(&measurements));
    let image = mean(pictures);
    // The noise of a single picture is not known and cannot be told from bias.
    let bias = SquaredBias::between(&image, &reference.image).filter(|_| pictures.len() > 1);
    let lacks = !about.lacks.is_empty();
    let priced = Priced { measurements: &measurements, curve: &curve, slope, bias, lacks, reference, confidence };
    let prices = TARGETS.iter().map(|target| priced.price(*target)).collect();
    let detected = priced.detected_bias();
    Method {
        name: about.name,
        integrator: about.integrator,
        sampler: about.sampler,
        curve,
        sample: one(pictures, &image),
        snapshots,
        spectrum: error_spectrum(pictures, &reference.image),
        image,
        slope,
        bias: detected,
        bias_bound: bias.map(|bias| bias.bound()),
        prices,
        lacks: about.lacks,
        scene_file: about.scene_file,
        files: about.files,
        measurements,
    }
}
