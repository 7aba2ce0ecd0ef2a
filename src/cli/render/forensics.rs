//! Analysis after a render: the noisiest samples, and the light that biases removed.

use std::sync::Arc;

use super::plan::RenderPlan;
use crate::cli::{is_quiet, note, print_stderr, print_stdout, trace};
use crate::error::Result;
use crate::film::{Film, MomentFilm};
use crate::integrator::Integrator;
use crate::measure::bias_report::{BATCH, BiasBudget, estimate_bias};
use crate::measure::format::per_cent;
use crate::measure::{BiasEstimate, ErrorHistory, Outliers, Refusal, bias_report, find_outliers};
use crate::render::{Render, RenderReport};
use crate::scene::Scene;
use crate::world::World;

/// A finished render with its parts.
pub struct RenderedPicture<'a> {
    /// Plan of the render.
    pub plan: &'a RenderPlan,
    /// The scene.
    pub scene: &'a Arc<dyn Scene>,
    /// The integrator.
    pub integrator: &'a dyn Integrator,
    /// The render.
    pub render: &'a Render,
    /// Film with the samples.
    pub film: &'a MomentFilm,
    /// Errors at the checkpoints.
    pub history: &'a ErrorHistory,
}

/// Prints what the arguments ask for, and what the user should know in any case.
///
/// - `facets`: the scene without smooth shadows, and the number of meshes that have them
pub fn print_reports(picture: &RenderedPicture, facets: Option<(World, usize)>) -> Result<()> {
    let RenderedPicture { plan, render, film, history, .. } = *picture;
    if !is_quiet() || plan.reports.bias {
        let matters = |removed: &BiasEstimate| plan.reports.bias || plan.reports.is_verbose || removed.samples == 0 || removed.share > 0.0;
        picture.biases(facets).iter().filter(|removed| matters(removed)).for_each(|removed| print_stderr(&bias_line(removed)));
    }
    let unknown = history.last().and_then(|last| last.error).is_some_and(|error| error.refusal() == Some(Refusal::HeavyTail));
    match plan.reports.outliers {
        Some(count) => print_stdout(&worst_samples(plan, &find_outliers(render, film, count as usize))),
        None if unknown && !is_quiet() && !render.splats() => {
            picture.noisiest_sample().iter().for_each(|line| note(line));
            Ok(())
        }
        None => Ok(()),
    }
}

impl RenderedPicture<'_> {
    /// Note about the noisiest sample, for a picture whose error cannot be established.
    fn noisiest_sample(&self) -> Option<String> {
        let first = find_outliers(self.render, self.film, 1).samples.first().copied()?;
        let share = per_cent(first.share);
        Some(format!(
            "one sample makes {share} % of the noise (--worst 10 lists more); how it came about:\n  {}",
            trace::command(&self.plan.reports.replay, first.id)
        ))
    }

    /// Biases: that of clamping, which was counted, and those that are estimated by additional samples.
    fn biases(&self, facets: Option<(World, usize)>) -> Vec<BiasEstimate> {
        let RenderedPicture { plan, scene, integrator, render, film, .. } = *self;
        let (spec, seed, mean) = (film.spec(), render.sampler().seed, mean(film));
        let part = if plan.reports.bias { 20 } else { 100 };
        // Each sample traces two paths.
        let samples = film.samples() * spec.crop.pixel_count() / (2 * part);
        let per_pixel = film.samples();
        let budget = BiasBudget { samples: samples.max(BATCH), per_pixel, time: render.report().elapsed / part as u32 };
        let mut removed: Vec<BiasEstimate> = clamped(plan.clamp, film, render.report()).into_iter().collect();
        removed.extend(bias_report(scene, integrator, spec, seed, mean, budget));
        if let Some((facets, count)) = facets {
            let (facets, setting): (Arc<dyn Scene>, _) = (Arc::new(facets), format!("smooth_shadows (meshes: {count})"));
            removed.push(estimate_bias(setting, (scene, integrator, spec), (&facets, integrator, spec), seed, mean, budget));
        }
        // It moves light over some pixels and removes none, so that its share of all light is of interest to those who ask.
        if (plan.reports.bias || plan.reports.is_verbose) && render.has_footprints() {
            let (exact, setting) = (spec.clone().without_footprints(), "texture_footprint".to_owned());
            removed.push(estimate_bias(setting, (scene, integrator, spec), (scene, integrator, &exact), seed, mean, budget));
        }
        removed
    }
}

/// Text for `--worst N`: share of the noise, value, and the command that shows the paths.
fn worst_samples(plan: &RenderPlan, found: &Outliers) -> String {
    let mut text = "the worst samples: share of the noise, value, how it came about\n".to_owned();
    for sample in &found.samples {
        let [r, g, b] = sample.value.to_rgb();
        text += &format!("{:>6} %  {r:?} {g:?} {b:?}  {}\n", per_cent(sample.share), trace::command(&plan.reports.replay, sample.id));
    }
    match (found.samples.is_empty(), found.complete) {
        (true, _) => text = "no noise: no sample is worse than another\n".into(),
        (_, true) => {}
        (_, false) => text += "the noise does not come from a few samples: these are the worst of the pixels searched\n",
    }
    text
}

/// Light that `--clamp` removed, which is counted exactly.
pub fn clamped(limit: Option<f32>, film: &MomentFilm, report: &RenderReport) -> Option<BiasEstimate> {
    let limit = limit?;
    let removed = report.clamped.get() / numbers(film);
    let total = mean(film) + removed;
    Some(BiasEstimate { setting: format!("clamp {limit}"), share: if total > 0.0 { removed / total } else { 0.0 }, error: 0.0, samples: 0 })
}

/// Mean of the picture over its pixels and colours.
fn mean(film: &MomentFilm) -> f64 {
    let pixel = |(i, sum): (usize, [f64; 3])| sum.iter().sum::<f64>() / film.samples_of(i).max(1) as f64;
    film.total().sums().enumerate().map(pixel).sum::<f64>() / (3.0 * film.spec().crop.pixel_count() as f64)
}

/// Number of summed values if all pixels have the same number of samples: one per colour, sample and pixel.
fn numbers(film: &MomentFilm) -> f64 {
    3.0 * film.samples().max(1) as f64 * film.spec().crop.pixel_count() as f64
}

/// Text of a bias: `bias: max_depth 3 removes 4.1 ± 0.2 % of the energy`.
pub fn bias_line(removed: &BiasEstimate) -> String {
    let BiasEstimate { setting, share, error, samples } = removed;
    let verb = if *share < 0.0 { "adds" } else { "removes" };
    let energy = per_cent(share.abs());
    let what = match (*samples, *share != 0.0 || *error != 0.0) {
        (0, true) => format!("{verb} {energy} % of the energy"),
        (0, false) => "removes nothing".into(),
        (_, true) => format!("{verb} {energy} ± {} % of the energy", per_cent(*error)),
        (n, false) => format!("removes nothing that {n} camera samples could detect"),
    };
    format!("bias: {setting} {what}")
}
