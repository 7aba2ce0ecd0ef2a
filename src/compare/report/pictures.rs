//! Pictures for the viewer of the page; the reference comes first.

use rayon::prelude::*;
use serde::Serialize;

use super::embedded_difference::{self, EmbeddedDifference};
use super::names;
use crate::compare::{Comparison, Method, Reference, Snapshot};
use crate::film::Image;
use crate::measure::Metric;
use crate::measure::error::EPSILON;
use crate::measure::metric::{ImagePair, Named};
use crate::output::Tonemap;
use crate::output::page::{EmbeddedImage, HalfFloats};

/// Pictures for the viewer.
#[derive(Serialize)]
pub struct Pictures {
    size: [u32; 2],
    /// First pixel of the pictures, in coordinates of the whole picture.
    origin: [u32; 2],
    epsilon: f64,
    /// FLIP of a byte q is 10^(decades · (q/255 − 1)); 0 stands for anything less.
    decades: f64,
    pictures: Vec<Picture>,
}

#[derive(Serialize)]
struct Picture {
    name: String,
    /// Index of the method's colour.
    color: Option<usize>,
    /// One replicate, as a user would get it; `None` for the reference.
    render: Option<View>,
    /// Mean of all replicates.
    mean: View,
    /// The replicate at its last checkpoints.
    checkpoints: Vec<Checkpoint>,
}

#[derive(Serialize)]
struct View {
    color: EmbeddedImage,
    error: Option<EmbeddedImage>,
    /// FLIP against the reference; `None` for the reference and where a value is not finite.
    flip: Option<String>,
}

#[derive(Serialize)]
struct Checkpoint {
    /// Samples per pixel, if known.
    samples: Option<u64>,
    seconds: f64,
    /// Relative error of the picture; `None` if it is below that of the reference.
    error: Option<f64>,
    /// Difference from the reference; `None` for the last checkpoint, whose picture is that of `render`.
    difference: Option<EmbeddedDifference>,
    flip: Option<String>,
}

/// Returns the pictures of a comparison.
///
/// - `has_flip`: whether FLIP is measured, which takes most of the time
pub fn pictures(comparison: &Comparison, has_flip: bool) -> Pictures {
    let reference = &comparison.reference;
    let mean = view(&reference.image, None);
    let first = Picture { name: names::REFERENCE.into(), color: None, render: None, mean, checkpoints: vec![] };
    let titles = names::titles(comparison).into_iter().enumerate();
    let methods: Vec<((usize, String), &Method)> = titles.zip(&comparison.methods).collect();
    // The order stays, and each picture is a function of its method alone.
    let one = |((index, name), method)| picture(index, name, method, reference, has_flip);
    let methods: Vec<Picture> = methods.into_par_iter().map(one).collect();
    Pictures {
        size: reference.image.size.to_array(),
        origin: reference.image.origin.to_array(),
        epsilon: EPSILON,
        decades: embedded_difference::DECADES,
        pictures: std::iter::once(first).chain(methods).collect(),
    }
}

fn picture(index: usize, name: String, method: &Method, reference: &Reference, has_flip: bool) -> Picture {
    let flip = |image: &Image| if has_flip { flip(image, reference) } else { None };
    let view = |image: &Image| view(image, flip(image));
    let last = method.snapshots.len().saturating_sub(1);
    let checkpoint = |(i, snapshot): (usize, &Snapshot)| Checkpoint {
        samples: method.spp(snapshot.samples),
        seconds: snapshot.seconds,
        error: snapshot.error,
        difference: (i < last).then(|| EmbeddedDifference::between(&snapshot.image, &reference.image)),
        flip: if i < last { flip(&snapshot.image) } else { None },
    };
    Picture {
        name,
        color: Some(index % 6),
        render: Some(view(&method.sample)),
        mean: view(&method.image),
        checkpoints: method.snapshots.iter().enumerate().map(checkpoint).collect(),
    }
}

fn view(image: &Image, flip: Option<String>) -> View {
    View { color: HalfFloats::color(image).into(), error: HalfFloats::error(image).map(EmbeddedImage::from), flip }
}

/// FLIP of every pixel in bytes; `None` for pictures that cannot be compared.
fn flip(image: &Image, reference: &Reference) -> Option<String> {
    let [image, reference] = [image, &reference.image].map(|image| Named { name: "", image });
    let pair = ImagePair::new(image, reference, Tonemap::default()).ok()?;
    Some(embedded_difference::logarithms(&Metric::parse("flip").ok()?.measure(&pair).map))
}
