//! Contestants from files: pictures of another renderer, or of another scene, with the time that each took.
//!
//! Pictures of one name whose times differ by less than a factor of √2 are repeats of one checkpoint; they give error bars. The others
//! are checkpoints of one curve. Their samples per pixel are not known.

use std::f64::consts::SQRT_2;

use super::method::{About, method};
use super::run::others;
use super::snapshot::{self, Snapshot};
use super::{Measurement, Method, Reference};
use crate::film::Image;
use crate::measure::{Distance, Metric};

/// Picture with the time that it took.
#[derive(Clone, Debug)]
pub struct GivenPicture {
    /// Name of the contestant.
    pub name: String,
    /// Name of the file, quoted for a shell.
    pub file: String,
    /// Render time (seconds).
    pub seconds: f64,
    /// The picture, of the reference's size.
    pub image: Image,
}

/// Measures the contestants, in the order of their first pictures. `None` if pictures cannot be compared with the reference.
pub fn given(pictures: Vec<GivenPicture>, metrics: &[Metric], reference: &Reference, confidence: f64) -> Option<Vec<Method>> {
    let mut names: Vec<String> = vec![];
    for picture in &pictures {
        if !names.contains(&picture.name) {
            names.push(picture.name.clone());
        }
    }
    let own = |name: &String| pictures.iter().filter(|picture| picture.name == *name).cloned().collect();
    names.iter().map(|name| contestant(name, own(name), metrics, reference, confidence)).collect()
}

fn contestant(name: &str, pictures: Vec<GivenPicture>, metrics: &[Metric], reference: &Reference, confidence: f64) -> Option<Method> {
    let files: Vec<String> = pictures.iter().map(|picture| picture.file.clone()).collect();
    let checkpoints = checkpoints(pictures);
    let (mut measurements, mut snapshots) = (vec![], std::collections::VecDeque::new());
    // The place of a checkpoint stands for its samples, which only order the checkpoints.
    for (place, repeats) in (1u64..).zip(&checkpoints) {
        for (replicate, GivenPicture { seconds, image, .. }) in (0u32..).zip(repeats) {
            let Distance { mse, relmse, trimmed } = Distance::between(image, &reference.image)?;
            let others = others(metrics, name, image, reference)?;
            measurements.push(Measurement { replicate, samples: place, seconds: *seconds, mse, relmse, trimmed, others });
            if replicate == 0 {
                snapshot::keep(&mut snapshots, Snapshot::new(place, *seconds, relmse, image.clone()));
            }
        }
    }
    let last: Vec<Image> = checkpoints.last()?.iter().map(|picture| picture.image.clone()).collect();
    let about =
        About { name: name.into(), integrator: "pictures".into(), sampler: "–".into(), lacks: String::new(), scene_file: None, files };
    Some(method(about, &last, snapshots.into(), measurements, reference, confidence))
}

/// Pictures by checkpoint, in order of time.
fn checkpoints(mut pictures: Vec<GivenPicture>) -> Vec<Vec<GivenPicture>> {
    pictures.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let mut groups: Vec<Vec<GivenPicture>> = vec![];
    for picture in pictures {
        match groups.last_mut() {
            Some(group) if picture.seconds < SQRT_2 * group[0].seconds => group.push(picture),
            _ => groups.push(vec![picture]),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::super::synthetic::image;
    use super::super::{CostKind, NoPrice};
    use super::*;

    fn picture(seconds: f64, relative: f32) -> GivenPicture {
        let image = image(move |i| 1.0 + if (i * 7919) % 1024 < 512 { relative } else { -relative }, 0.0);
        GivenPicture { name: "other".into(), file: "x.exr".into(), seconds, image }
    }

    fn measured(pictures: Vec<GivenPicture>) -> Method {
        let reference = Reference { image: image(|_| 1.0, 0.0), origin: "r".into(), error: None, attributes: vec![] };
        given(pictures, &[], &reference, 0.95).expect("a contestant").remove(0)
    }

    /// 1, 1.1 and 1.4 s are repeats; 1.5 s begins another checkpoint.
    #[test]
    fn repeats_share_a_checkpoint() {
        let groups = checkpoints([1.5, 1.0, 4.0, 1.4, 1.1].map(|seconds| picture(seconds, 0.1)).into());
        let times: Vec<Vec<f64>> = groups.iter().map(|group| group.iter().map(|one| one.seconds).collect()).collect();
        assert_eq!(times, [vec![1.0, 1.1, 1.4], vec![1.5], vec![4.0]]);
    }

    /// relMSE = d²/(1 + ε) with ε = 0.01. From 0.2 at 1 s to 0.05 at 16 s the error falls as t^−½: 0.1 · √1.01 is reached after 4 s, and
    /// the slope needs a third checkpoint.
    #[test]
    fn pictures_have_rows_and_prices_like_methods() {
        let all = [(1.0, 0.2 * 1.02), (1.0, 0.2 / 1.02), (4.0, 0.1 * 1.02), (4.0, 0.1 / 1.02), (16.0, 0.05 * 1.02), (16.0, 0.05 / 1.02)];
        let method = measured(all.map(|(seconds, error)| picture(seconds, error)).into());
        assert_eq!((method.curve.len(), method.measurements.len(), method.snapshots.len()), (3, 6, 3));
        assert_relative_eq!(method.measurements[0].relmse, (0.2f64 * 1.02).powi(2) / 1.01, max_relative = 1e-5);
        assert_relative_eq!(method.slope.expect("a slope").0, -0.5, max_relative = 1e-4);
        // √relMSE = 0.1 where d = 0.1 √1.01: the replicates are 1.02² times as early and late as 4 s / 1.01.
        let price = method.prices[0].expect("a price");
        assert_relative_eq!(price.seconds, 4.0 / 1.01, max_relative = 1e-4);
        assert_eq!(price.kind, CostKind::Measured);
    }

    /// One picture has an error and no error bar: no time and no bias is stated, though its noise looks like bias.
    #[test]
    fn one_picture_alone_states_no_time() {
        let method = measured(vec![picture(2.0, 0.2)]);
        assert_eq!(method.prices[0], Err(NoPrice::Single));
        assert!(method.bias.is_none() && method.bias_bound.is_none());
        assert!(method.image.channel("StdErr.R").is_none());
    }

    /// Two repeats that are a fifth too bright, with opposite noise of 0.01: b² = (0.2² − 0.01²)/1.01.
    #[test]
    fn the_bias_of_pictures_is_told() {
        let brighter = |i: usize, noise: f32| 1.2 + if i.is_multiple_of(2) { noise } else { -noise };
        let one = |noise: f32| GivenPicture { image: image(|i| brighter(i, noise), 0.0), ..picture(1.0, 0.0) };
        let (bias, _) = measured(vec![one(0.01), one(-0.01)]).bias.expect("a bias");
        assert_relative_eq!(bias, ((0.04f64 - 1e-4) / 1.01).sqrt(), max_relative = 1e-5);
    }
}
