//! Parts of a render: what some samples of every pixel add up to, in a file, and the sum of such files.
//!
//! One kind of file (`.ptc`) is what a job of many leaves behind, what a render goes on from, and what parts merge to.
//! It holds the blocks of the dyadic tree that lie within its samples (see [`Tree`](crate::film::Tree)). Joining
//! siblings gives the blocks of the whole, rounded as the whole rounds them: whoever adds the parts, in whatever order,
//! gets the bits of the render in one go.

mod file;
mod merge;

use std::ops::Range;

use glam::UVec2;

use crate::describe::Identity;
use crate::film::{Crop, FilmSpec, Layer, LightNames, MomentFilm, Slots, layer};
use crate::measure::Course;
use crate::output::Attributes;
use crate::render::Report;
use crate::sampler::Spread;

pub use file::{Stored, write};
pub use merge::merge;

/// What all parts of a picture have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    pub identity: Identity,
    /// Which pt made it: its version and its commit.
    pub build: String,
    pub size: UVec2,
    pub crop: Crop,
    pub spread: Spread,
    pub layers: Vec<Layer>,
    /// Of the lights that have layers.
    pub lights: Vec<String>,
    /// How the picture shows the world.
    pub view: Attributes,
}

/// This very program.
pub const BUILD: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("PT_BUILD_ID"), ")");

impl About {
    /// What this pt renders of a scene.
    pub fn new(identity: Identity, film: &FilmSpec, spread: Spread, view: Attributes) -> About {
        About {
            identity,
            build: BUILD.into(),
            size: film.size,
            crop: film.crop,
            spread,
            layers: film.layers.clone(),
            lights: film.lights.names.clone(),
            view,
        }
    }

    /// In what another differs: `/sampler/seed is 7, not 0`; `None` where both are of one picture.
    pub fn difference(&self, other: &About) -> Option<String> {
        if let Some([pointer, own, others]) = self.identity.difference(&other.identity) {
            return Some(format!("{pointer} is {own}, not {others}"));
        }
        if self.build != other.build {
            return Some(format!("it was rendered by pt {}, not {}", self.build, other.build));
        }
        let pixels = |about: &About| (about.size, about.crop, about.spread, about.layers.clone(), about.lights.clone());
        let is_same = pixels(self) == pixels(other);
        (!is_same).then(|| "it has other pixels or layers".into())
    }

    /// A film that takes its blocks; the filter has had its say when the samples were taken.
    pub fn film(&self) -> MomentFilm {
        let lights = LightNames { names: self.lights.clone(), ..LightNames::default() };
        MomentFilm::new(FilmSpec { crop: self.crop, layers: self.layers.clone(), lights, ..FilmSpec::new(self.size.x, self.size.y) })
    }

    /// Which numbers a pixel has.
    pub fn slots(&self) -> Slots {
        Slots { spread: self.spread, layers: layer::slots(&self.layers) }
    }
}

/// The sums of some samples, and how they came about.
pub struct Part {
    pub about: About,
    /// One for each unbroken run of samples, in their order.
    pub films: Vec<MomentFilm>,
    /// Of all runs of pt that it took.
    pub report: Report,
    /// Looks at the error on the way; empty where no single render made them.
    pub course: Course,
}

impl Part {
    /// Which samples it has.
    pub fn runs(&self) -> Vec<Range<u64>> {
        self.films.iter().map(MomentFilm::range).collect()
    }

    /// The film of a picture: samples 0 … M − 1.
    ///
    /// # Errors
    /// The first samples that are missing.
    pub fn whole(&self) -> Result<&MomentFilm, Range<u64>> {
        let runs = self.runs();
        let gaps = [0].into_iter().chain(runs.iter().map(|run| run.end)).zip(runs.iter().map(|run| run.start));
        match gaps.map(|(end, start)| end..start).find(|gap| !gap.is_empty()) {
            Some(gap) => Err(gap),
            None => self.films.first().ok_or(0..1),
        }
    }
}
