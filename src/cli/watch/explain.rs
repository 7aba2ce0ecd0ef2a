//! How the noise of a pixel came about: its worst sample, and the path of that, while the render goes on.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use glam::UVec2;

use crate::cli::signals;
use crate::cli::stats::TextOrJson;
use crate::cli::trace::{self, Trace};
use crate::describe::Names;
use crate::film::{FilmSpec, SampleSet};
use crate::integrator::Integrator;
use crate::measure::format::{number, per_cent};
use crate::measure::{PixelOutlier, worst_of_pixel};
use crate::output::serve::Watched;
use crate::recorder::Event;
use crate::render::{Render, Settings};
use crate::scene::Scene;

/// Longest time that the samples of a pixel are computed again.
const SEARCH: Duration = Duration::from_secs(2);

/// What is needed to compute samples of a render again.
pub struct Explainer {
    /// The scene.
    pub scene: Arc<dyn Scene>,
    /// The integrator.
    pub integrator: Arc<dyn Integrator>,
    /// Name of the integrator.
    pub name: &'static str,
    /// Names of what the scene contains.
    pub names: Arc<Names>,
    /// Film.
    pub spec: FilmSpec,
    /// Settings of the sampling.
    pub settings: Settings,
    /// Start of the command that replays a sample.
    pub replay: String,
    /// Samples that the picture has.
    pub samples: Mutex<SampleSet>,
}

impl Explainer {
    /// Sets which samples the picture has.
    pub fn takes(&self, samples: SampleSet) {
        *self.samples.lock().unwrap_or_else(PoisonError::into_inner) = samples;
    }

    /// Whether the noise of a pixel comes from its own samples.
    pub fn explains(&self) -> bool {
        !self.integrator.splats()
    }

    /// Indices of the samples of a pixel.
    fn indices(&self, pixel: UVec2) -> impl Iterator<Item = u64> + use<> {
        let rounds = self.samples.lock().unwrap_or_else(PoisonError::into_inner).ranges().to_vec();
        let level = self.spec.allocation.level(self.spec.crop.index(pixel));
        rounds.into_iter().flat_map(move |range| range.start << level..range.end << level)
    }

    /// The worst sample in words, and its paths.
    fn told(&self, render: &Render, found: &PixelOutlier, count: usize) -> String {
        let PixelOutlier { worst, mean, searched } = *found;
        let [r, g, b] = worst.value.to_rgb();
        let (x, y) = worst.id.pixel;
        let which =
            if searched < count as u64 { format!("the first {searched} of its {count} samples") } else { format!("its {count} samples") };
        let mut events: Vec<Event> = vec![];
        let (value, _) = render.replay_with_splats(worst.id, Some(&mut events));
        let trace = Trace {
            integrator: self.name,
            id: worst.id,
            camera: render.camera(worst.id),
            value,
            events: &events,
            names: &self.names,
            lights: self.scene.lights(),
            origin: self.scene.origin(),
        };
        format!(
            "Pixel {x}, {y}: the mean of {which} is {}.\n\
             Sample {} is farthest from it: {r:?} {g:?} {b:?}. It makes {} % of the noise of the pixel.\n\
             The same in a terminal:\n  {}\n\n{}",
            number(mean, 4),
            worst.id.index,
            per_cent(worst.share),
            trace::command(&self.replay, worst.id),
            trace.print(TextOrJson::Text),
        )
    }
}

impl Watched for Explainer {
    fn stop(&self) {
        signals::interrupt();
    }

    fn explain(&self, [x, y]: [u32; 2]) -> Option<String> {
        let pixel = UVec2::new(x, y);
        if !self.spec.crop.contains(pixel) {
            return None;
        }
        if !self.explains() {
            return Some(format!("With {} the paths from the lights reach any pixel: no sample of this one explains it.\n", self.name));
        }
        let count = self.indices(pixel).count();
        // Paths are followed one by one, without layers.
        let render = Render::new(self.scene.clone(), &*self.integrator, &self.spec.clone().without_layers(), &self.settings);
        let found = worst_of_pixel(&render, (x, y), self.indices(pixel), Instant::now() + SEARCH);
        Some(found.map_or_else(|| "The pixel has no sample yet.\n".to_owned(), |found| self.told(&render, &found, count)))
    }
}
