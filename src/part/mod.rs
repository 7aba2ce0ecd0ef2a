//! Parts of a render: files with the sums over some samples of every pixel, and their merging.
//!
//! One kind of file (`.ptc`) serves as the result of one of several jobs, as a checkpoint, and as the result of a merge. The file
//! contains the blocks of the dyadic tree that lie within its samples (see [`Tree`](crate::film::Tree)). Joining siblings gives the
//! blocks of the complete tree with the same rounding, so that merging parts in any order gives the bits of a single render.

mod file;
mod merge;
mod planes;

use std::ops::Range;
use std::path::PathBuf;

use glam::UVec2;

use crate::describe::Identity;
use crate::film::{Allocation, Crop, FilmSpec, Layer, LightNames, MomentFilm, PixelLayout, layer};
use crate::measure::ErrorHistory;
use crate::output::Attributes;
use crate::render::RenderReport;
use crate::sampler::ErrorEstimator;

pub use file::{Stored, write, write_to};
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
    /// Numbers of samples of the pixels. The samples of a part are rounds of it.
    pub allocation: Allocation,
    /// Attributes of the camera.
    pub view: Attributes,
    /// Command that renders the picture. It is no property of the picture.
    pub job: Job,
}

/// Command that renders a picture, for those who look for its missing samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Job {
    /// Words after `pt`; empty if they are not known.
    pub command: Vec<String>,
    /// Rounds of samples that it renders: samples per pixel, unless their numbers differ. 0 if they are not known.
    pub samples: u64,
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
            allocation: film.allocation.clone(),
            view,
            job: Job::default(),
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
        if self.allocation != other.allocation {
            return Some("its pixels have other numbers of samples; adaptive parts need the same --spp".into());
        }
        let pixels = |about: &About| (about.size, about.crop, about.error_estimator, about.layers.clone(), about.lights.clone());
        let is_same = pixels(self) == pixels(other);
        (!is_same).then(|| "it has other pixels or layers".into())
    }

    /// An empty film for the blocks of the parts. Its filter is not used, because filter weights are in the samples.
    pub fn film(&self) -> MomentFilm {
        let lights = LightNames { names: self.lights.clone(), ..LightNames::default() };
        let (layers, allocation) = (self.layers.clone(), self.allocation.clone());
        MomentFilm::new(FilmSpec { crop: self.crop, layers, lights, allocation, ..FilmSpec::new(self.size.x, self.size.y) })
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
    /// The sums.
    pub film: MomentFilm,
    /// Sum of the reports of all renders.
    pub report: RenderReport,
    /// Checkpoints of the render; empty for the samples of several renders.
    pub history: ErrorHistory,
    /// Names of parts that do not count, because another has the same numbers.
    pub copies: Vec<PathBuf>,
}

impl Part {
    /// History of the error, with that of the sum.
    pub fn error_history(&self) -> ErrorHistory {
        let is_known = self.history.last().is_some_and(|last| last.samples == self.film.samples());
        if is_known { self.history.clone() } else { self.history.and_now(&self.film, self.report.elapsed) }
    }

    /// Film of a complete picture with the samples 0 … M − 1. With the sampler `stratified`, M is the number of samples that it spreads.
    ///
    /// # Errors
    /// The first range of missing samples.
    pub fn whole(&self) -> Result<&MomentFilm, Range<u64>> {
        // Only for `stratified` is the number of samples a fact of the picture.
        let planned = self.about.identity.fact("/sampler/spp").and_then(|spp| spp.parse().ok()).unwrap_or(0);
        match self.film.sample_set().missing(self.film.range().end.max(planned)).into_iter().next() {
            Some(gap) => Err(gap),
            None => Ok(&self.film),
        }
    }
}
