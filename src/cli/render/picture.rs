//! Render of a picture, or of a part of its samples, in steps.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::checkpoint::CheckpointObserver;
use super::forensics::{self, RenderedPicture};
use super::plan::{PriceList, RenderPlan, Start};
use super::remarks::{one_sided, remark_darkness, remark_exposure};
use crate::cli::display::DisplayedFilm;
use crate::cli::load::Loaded;
use crate::cli::progress::Progress;
use crate::cli::stats::{RayCounter, Summary};
use crate::cli::summary::{self, Accuracy, attributes, print_summary, scope_lines};
use crate::cli::watch::{Explainer, Watch};
use crate::cli::{INCONCLUSIVE, is_quiet, note, pilot, print_stderr, print_stdout, signals};
use crate::describe::Names;
use crate::error::{Error, Result};
use crate::film::{Allocation, FilmSpec, Image, MomentFilm};
use crate::integrator::{Entry, Integrator};
use crate::measure::{self, ErrorHistory, ErrorObserver, ErrorTarget, Outcome, Scope, StopCondition, format};
use crate::output::{self, Attributes, Tonemap};
use crate::render::{self, Render, RenderReport, Settings};
use crate::scene::Scene;
use crate::world::World;

/// A picture that is about to be rendered.
struct Picture<'a> {
    plan: &'a RenderPlan,
    entry: Entry,
    integrator: Arc<dyn Integrator>,
    world: Arc<dyn Scene>,
    /// World without smooth shadows, and the number of meshes that have them, if all biases are requested.
    facets: Option<(World, usize)>,
    names: Arc<Names>,
    /// Name of the scene.
    stem: String,
    spec: FilmSpec,
    settings: Settings,
    until: StopCondition,
    primitives: u64,
    instances: u32,
    /// Time for reading and building the scene (s).
    load_seconds: f64,
}

/// A picture after its last sample.
struct Rendered {
    render: Render,
    displayed: DisplayedFilm,
    /// The page, if there is one, and the progress that it shows.
    watch: Option<(Watch, Progress)>,
    /// The picture of the files, for the page.
    image: Option<Image>,
    history: ErrorHistory,
    /// What is stated about the error.
    accuracy: Accuracy,
    /// The target and its outcome, if there is one, and the history of the error of the pixels that it asks for.
    target: Option<(ErrorTarget, Outcome, ErrorHistory)>,
    /// Report of the runs before this one.
    before: RenderReport,
    /// Counter of the rays, if statistics are requested.
    counter: Option<Arc<RayCounter>>,
}

/// Renders a picture, writes its files and prints the reports.
///
/// # Errors
/// Those of [`RenderPlan::start`], `Io` for files that cannot be written, `Interrupted`.
pub fn render_picture(mut plan: RenderPlan, mut loaded: Loaded, load_seconds: f64) -> Result<ExitCode> {
    let of_pilot = if plan.adaptive { plan.allocate_samples(&mut loaded)? } else { Duration::ZERO };
    let mut picture = Picture::new(&plan, loaded, load_seconds)?;
    let mut start = plan.start(MomentFilm::new(picture.spec.clone()))?;
    start.report.elapsed += of_pilot;
    picture.print_price_list();
    let mut rendered = picture.take_samples(start);
    picture.write(&mut rendered)?;
    picture.report(&rendered)?;
    rendered.displayed.finish();
    picture.end_page(&mut rendered);
    match signals::caught() {
        Some(signal) => Err(Error::Interrupted(signal)),
        None => Ok(picture.exit_code(&rendered)),
    }
}

impl<'a> Picture<'a> {
    fn new(plan: &'a RenderPlan, loaded: Loaded, load_seconds: f64) -> Result<Picture<'a>> {
        let facets = if plan.reports.bias { loaded.without_smooth_shadows()? } else { None };
        let Loaded { world, film: spec, sampler, names, entry, integrator, stem, .. } = loaded;
        let settings = Settings { clamp: plan.clamp, wave_time: Some(render::SHORT_WAVE), ..Settings::new(sampler) };
        let (primitives, instances) = (world.primitive_count(), world.instance_count());
        let until = plan.until;
        let names = Arc::new(names);
        Ok(Picture { plan, entry, integrator, world, facets, names, stem, spec, settings, until, primitives, instances, load_seconds })
    }

    /// Prints the price list, if it is requested.
    fn print_price_list(&self) {
        let Some(PriceList { time, integrators }) = &self.plan.price_list else { return };
        let progress = Progress::new(self.plan.progress, &self.spec, u32::MAX.into(), Some(*time * integrators.len() as u32));
        // Prices are those of even samples, which every integrator can take.
        let spec = FilmSpec { allocation: Allocation::default(), ..self.spec.clone() };
        let list = pilot::price_list(&self.world, &spec, &self.settings, integrators, *time, self.plan.confidence, &progress);
        progress.finish();
        print_stderr(&list);
    }

    /// Takes the samples, with progress, checkpoints and the viewer.
    fn take_samples(&self, start: Start) -> Rendered {
        let Picture { plan, spec, until, .. } = self;
        let counter = plan.reports.stats.map(|_| Arc::new(RayCounter::new(self.world.clone(), rayon::current_num_threads())));
        let scene = counter.clone().map_or(self.world.clone(), |counter| counter as Arc<dyn Scene>);
        let before = start.report.clone();
        let watch = plan.page.as_ref().and_then(|page| Watch::start(page, &self.stem, self.explainer(), !plan.is_part, plan.confidence));
        let progress = Progress::new(plan.progress, spec, until.samples - plan.samples.start, until.time).resumed(&before);
        let observer = CheckpointObserver::new(&progress, plan, until.time.filter(|_| before.samples == 0));
        let is_whole = until.scope() == Scope::Picture;
        let tells_price = !is_quiet() && plan.price_list.is_none() && !plan.is_part && is_whole;
        let observer = if tells_price { observer.with_price(plan.confidence) } else { observer };
        let observer = observer.watched(watch.as_ref());
        let mut displayed = DisplayedFilm::new(start.film, plan.display_server.as_deref(), &self.stem);
        let mut render = Render::new(scene, &*self.integrator, spec, &self.settings).resumed(start.next, start.report);
        let history = match plan.is_part {
            true => take_part(&mut render, &mut displayed, until, &observer),
            false => measure::resume_until(start.history, &mut render, &mut displayed, until, &observer),
        };
        progress.finish();
        let target = until.target.map(|target| (target, target.outcome(&history), history.clone()));
        let film = &displayed.film;
        let history =
            if is_whole { history } else { ErrorHistory { checkpoints: vec![], ..history }.and_now(film, render.report().elapsed) };
        let accuracy = Accuracy::of(film, &history, plan.confidence);
        let watch = watch.map(|watch| (watch, progress));
        Rendered { render, displayed, watch, image: None, history, accuracy, target, before, counter }
    }

    /// What the page needs to explain pixels.
    fn explainer(&self) -> Explainer {
        Explainer {
            scene: self.world.clone(),
            integrator: self.integrator.clone(),
            name: self.entry.name,
            names: self.names.clone(),
            spec: self.spec.clone(),
            settings: self.settings.clone(),
            replay: self.plan.reports.replay.clone(),
            samples: Mutex::default(),
        }
    }

    /// Shows the last picture on the page, and ends the page.
    fn end_page(&self, rendered: &mut Rendered) {
        if let Some((watch, progress)) = rendered.watch.take() {
            let closing = self.closing_line(rendered);
            let image = rendered.image.take();
            watch.finish(&progress, &rendered.displayed.film, &rendered.history, image, closing);
        }
    }

    fn closing_line(&self, rendered: &Rendered) -> String {
        let Rendered { render, displayed, accuracy, history, .. } = rendered;
        let (plan, samples) = (self.plan, self.samples(&displayed.film));
        summary::closing_line(&plan.about, &samples, render.report(), (accuracy, history), plan.confidence, plan.written())
    }

    /// Number of samples, or which ones of a part.
    fn samples(&self, film: &MomentFilm) -> String {
        if self.plan.is_part { summary::part_samples(film) } else { summary::samples(film) }
    }

    /// Writes parts and pictures. Both are tried, so that a failure does not affect the others.
    fn write(&self, rendered: &mut Rendered) -> Result<()> {
        let Rendered { render, displayed, history, .. } = &*rendered;
        let (film, report) = (&displayed.film, render.report());
        if report.samples == 0 {
            return Ok(());
        }
        let parts = self.plan.write_parts(film, report, history);
        if !self.plan.is_part {
            self.write_pictures(rendered)?;
        }
        parts
    }

    fn write_pictures(&self, rendered: &mut Rendered) -> Result<()> {
        let (plan, film, report) = (self.plan, &rendered.displayed.film, rendered.render.report());
        let image = film.image();
        let clamped = forensics::clamped(plan.clamp, film, report);
        let attributes = attributes(&plan.about, film, &rendered.accuracy, plan.confidence, clamped.as_ref());
        let tonemap = plan.tone_mapping.tonemap(&image);
        write_all(&plan.pictures, &image, &attributes, &tonemap)?;
        if !is_quiet() {
            remark_darkness(&image, self.entry.name, || one_sided(&self.names, self.world.lights()));
            remark_exposure(&plan.tone_mapping, &plan.pictures, &image, &tonemap);
        }
        rendered.image = rendered.watch.is_some().then_some(image);
        Ok(())
    }

    /// Prints the closing line, the analysis and the statistics.
    fn report(&mut self, rendered: &Rendered) -> Result<()> {
        let Rendered { render, displayed, history, before, counter, .. } = rendered;
        let (plan, film, report) = (self.plan, &displayed.film, render.report());
        if !is_quiet() || rendered.is_late() {
            let samples = self.samples(film);
            print_summary(&plan.about, &samples, report, (&rendered.accuracy, history), plan.confidence, plan.written());
            if let Some((target, outcome, history)) = &rendered.target {
                note(&format::outcome(target, *outcome));
                if plan.until.is_given_up(history) {
                    note("given up: no error could be established for a long time; --time or --spp sets another limit");
                }
                scope_lines(film, &target.scope, history, plan.confidence).iter().for_each(|line| note(line));
            }
        }
        if report.samples > 0 && !report.cancelled && !plan.is_part {
            let facets = self.facets.take();
            forensics::print_reports(
                &RenderedPicture { plan, scene: &self.world, integrator: &*self.integrator, render, film, history },
                facets,
            )?;
        }
        if let (Some(format), Some(counter)) = (plan.reports.stats, counter) {
            let summary = Summary {
                report: &report.since(before),
                spp: film.mean_samples(),
                pixels: self.spec.crop.pixel_count(),
                primitives: self.primitives,
                instances: self.instances,
                rays: counter.rays(),
                threads: rayon::current_num_threads(),
                load: self.load_seconds,
            };
            print_stdout(&summary.print(format))?;
        }
        Ok(())
    }

    fn exit_code(&self, rendered: &Rendered) -> ExitCode {
        let is_missed = rendered.target.as_ref().is_some_and(|(_, outcome, _)| *outcome != Outcome::Met);
        if is_missed || rendered.is_late() { ExitCode::from(INCONCLUSIVE) } else { ExitCode::SUCCESS }
    }
}

impl Rendered {
    /// Whether time ran out before each pixel had a sample.
    fn is_late(&self) -> bool {
        self.render.report().samples == 0 && signals::caught().is_none()
    }
}

/// Renders some samples of each pixel. Their error is not reported, as they are not the whole picture.
fn take_part(render: &mut Render, displayed: &mut DisplayedFilm, until: &StopCondition, observer: &CheckpointObserver) -> ErrorHistory {
    while render.step(until.samples, None, displayed, observer) {
        observer.wave_finished(render.report(), &displayed.film, &ErrorHistory::default());
    }
    ErrorHistory::default()
}

fn write_all(outputs: &[PathBuf], image: &Image, attributes: &Attributes, tonemap: &Tonemap) -> Result<()> {
    // All files are tried, so that a failure does not affect the others.
    let results: Vec<Result<()>> = outputs.iter().map(|path| output::write(path, image, attributes, tonemap)).collect();
    results.into_iter().collect()
}
