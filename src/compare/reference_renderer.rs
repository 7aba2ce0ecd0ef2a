//! Rendering of references.

use std::sync::Arc;

use serde_json::json;

use super::Reference;
use crate::describe::Identity;
use crate::error::Result;
use crate::film::{FilmSpec, MomentFilm};
use crate::integrator::{self, Entry, Integrator};
use crate::load::Loaded;
use crate::measure::{ErrorHistory, ErrorObserver, Refusal, RelativeError, StopCondition, resume_until};
use crate::output::attributes::of_camera;
use crate::part::About;
use crate::render::{Render, RenderReport, SHORT_WAVE, Settings};
use crate::sampler::{Kind, SamplerSpec};
use crate::scene::Scene;
use crate::summary::{Accuracy, attributes};

/// Number of scramblings; with 8 the standard deviation of an error estimate is 1/√14.
const SCRAMBLINGS: u32 = 8;

/// Renderer of references of a scene.
pub struct ReferenceRenderer {
    /// Table row of the integrator.
    pub entry: Entry,
    integrator: Arc<dyn Integrator>,
    sampler: SamplerSpec,
    /// Film of the reference.
    pub spec: FilmSpec,
    /// Facts about the reference, as its files state them.
    pub about: About,
}

/// State of a reference.
pub struct CachedReference {
    /// Film with the samples so far.
    pub film: MomentFilm,
    /// Report so far.
    pub report: RenderReport,
    /// History so far.
    pub history: ErrorHistory,
}

impl ReferenceRenderer {
    /// Renderer with an integrator.
    ///
    /// - `name`: name of the integrator; the default integrator without one
    ///
    /// # Errors
    /// `Usage` for an unknown name, `Invalid` for options of the scene that it refuses.
    pub fn new(loaded: &Loaded, name: Option<&str>, tables: &[&[Entry]]) -> Result<ReferenceRenderer> {
        let (entry, integrator) = loaded.choose(tables, name.unwrap_or(integrator::DEFAULT))?;
        // The random numbers differ from those of a picture with the scene's own seed.
        let seed = loaded.sampler.seed.wrapping_sub(1);
        let sampler = SamplerSpec { kind: Kind::Sobol, seed, spp: 0, scramblings: SCRAMBLINGS };
        let identity = Identity::new(&loaded.description, &loaded.contents, &entry)?;
        let identity = identity.with("sampler", json!({ "type": "sobol", "seed": seed, "scramblings": SCRAMBLINGS }));
        let spec = loaded.film.clone().without_layers();
        let about = About::new(identity, &spec, sampler.error_estimator(), of_camera(&*loaded.world, &spec));
        Ok(ReferenceRenderer { entry, integrator, sampler, about, spec })
    }

    /// Renders a reference, from the beginning or from a cached one.
    pub fn render(
        &self,
        scene: &Arc<dyn Scene>,
        cached: Option<CachedReference>,
        until: &StopCondition,
        observer: &dyn ErrorObserver,
    ) -> CachedReference {
        let nothing = || CachedReference {
            film: MomentFilm::new(self.spec.clone()),
            report: RenderReport::default(),
            history: ErrorHistory::default(),
        };
        let CachedReference { mut film, report, history } = cached.unwrap_or_else(nothing);
        let settings = Settings { wave_time: Some(SHORT_WAVE), ..Settings::new(self.sampler) };
        let render = Render::new(scene.clone(), &*self.integrator, &self.spec, &settings);
        let mut render = render.resumed(film.samples(), report);
        let history = resume_until(history, &mut render, &mut film, until, observer);
        CachedReference { film, report: render.report().clone(), history }
    }

    /// The reference for a comparison.
    ///
    /// - `origin`: what it is, such as `a reference`
    /// - `confidence`: confidence of the error that its attributes state
    pub fn reference(&self, made: &CachedReference, origin: &str, confidence: f64) -> Reference {
        // A reference whose samples tell no error is no truth either.
        let error = RelativeError::of(&made.film).or(Some(RelativeError::refused(Refusal::TooNoisy)));
        let accuracy = Accuracy::of(&made.film, &made.history, confidence);
        let attributes = attributes(&self.about, &made.film, &accuracy, confidence, None);
        let origin = format!("{origin} by {}, {} spp", self.entry.name, made.film.samples());
        Reference { image: made.film.image(), origin, error, attributes }
    }
}
