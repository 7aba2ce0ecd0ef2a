//! Parts of a render: files with the sums over some samples of every pixel, and their merging.
//!
//! One kind of file (`.ptc`) serves as the result of one of several jobs, as a checkpoint, and as the result of a merge. The file
//! contains the blocks of the dyadic tree that lie within its samples (see [`Tree`](crate::film::Tree)). Joining siblings gives the
//! blocks of the complete tree with the same rounding, so that merging parts in any order gives the bits of a single render.

mod file;
mod merge;

use std::ops::Range;

use glam::UVec2;

use crate::describe::Identity;
use crate::film::{Crop, FilmSpec, Layer, LightNames, MomentFilm, PixelLayout, layer};
use crate::measure::ErrorHistory;
use crate::output::Attributes;
use crate::render::RenderReport;
use crate::sampler::ErrorEstimator;

pub use file::{Stored, write};
pub use merge::merge;

/// Properties that all parts of a picture have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// Identity of the scene and its settings.
    pub identity: Identity,
    /// Version and commit of the pt that rendered it.
    pub build: String,
    /// Width and height of the whole picture (pixels).
    pub size: UVec2,
    /// Part of the picture that is rendered.
    pub crop: Crop,
    /// Estimator of the error.
    pub error_estimator: ErrorEstimator,
    /// Layers of the picture.
    pub layers: Vec<Layer>,
    /// Names of the lights that have layers.
    pub lights: Vec<String>,
    /// Attributes of the camera.
    pub view: Attributes,
}

/// Version and commit of this program.
pub const BUILD: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("PT_BUILD_ID"), ")");

impl About {
    /// Properties of a picture that this program renders.
    pub fn new(identity: Identity, film: &FilmSpec, error_estimator: ErrorEstimator, view: Attributes) -> About {
        About {
            identity,
            build: BUILD.into(),
            size: film.size,
            crop: film.crop,
            error_estimator,
            layers: film.layers.clone(),
            lights: film.lights.names.clone(),
            view,
        }
    }

    /// Description of the first difference, such as `/sampler/seed is 7, not 0`; `None` if both belong to one picture.
    pub fn difference(&self, other: &About) -> Option<String> {
        if let Some([pointer, own, others]) = self.identity.difference(&other.identity) {
            return Some(format!("{pointer} is {own}, not {others}"));
        }
        if self.build != other.build {
            return Some(format!("it was rendered by pt {}, not {}", self.build, other.build));
        }
        let pixels = |about: &About| (about.size, about.crop, about.error_estimator, about.layers.clone(), about.lights.clone());
        let is_same = pixels(self) == pixels(other);
        (!is_same).then(|| "it has other pixels or layers".into())
    }

    /// An empty film for the blocks of the parts. Its filter is not used, because filter weights are in the samples.
    pub fn film(&self) -> MomentFilm {
        let lights = LightNames { names: self.lights.clone(), ..LightNames::default() };
        MomentFilm::new(FilmSpec { crop: self.crop, layers: self.layers.clone(), lights, ..FilmSpec::new(self.size.x, self.size.y) })
    }

    /// Layout of the sums of a pixel.
    pub fn layout(&self) -> PixelLayout {
        PixelLayout { error_estimator: self.error_estimator, layers: layer::sum_count(&self.layers) }
    }
}

/// Sums over some samples of a picture, with the reports of their renders.
pub struct Part {
    /// Properties of the picture.
    pub about: About,
    /// One film for each range of samples without gaps, in order.
    pub films: Vec<MomentFilm>,
    /// Sum of the reports of all renders.
    pub report: RenderReport,
    /// Checkpoints of the render; empty for the samples of several renders.
    pub history: ErrorHistory,
}

impl Part {
    /// Ranges of samples without gaps.
    pub fn runs(&self) -> Vec<Range<u64>> {
        self.films.iter().map(MomentFilm::range).collect()
    }

    /// Film of a complete picture with the samples 0 … M − 1.
    ///
    /// # Errors
    /// The first range of missing samples.
    pub fn whole(&self) -> Result<&MomentFilm, Range<u64>> {
        let runs = self.runs();
        let gaps = [0].into_iter().chain(runs.iter().map(|run| run.end)).zip(runs.iter().map(|run| run.start));
        match gaps.map(|(end, start)| end..start).find(|gap| !gap.is_empty()) {
            Some(gap) => Err(gap),
            None => self.films.first().ok_or(0..1),
        }
    }
}
