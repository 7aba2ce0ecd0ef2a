//! What is told beside the picture: which samples are to blame for its noise, and what its biases took.

use std::sync::Arc;

use super::{args, insist, is_quiet, note, say};
use crate::error::Result;
use crate::film::{Film, MomentFilm};
use crate::integrator::Integrator;
use crate::measure::ledger::{Budget, LOT, compare};
use crate::measure::words::per_cent;
use crate::measure::{Course, Removed, Worst, ledger, worst};
use crate::render::{Render, Report, SampleId};
use crate::scene::Scene;
use crate::world::World;

/// The command that shows the paths of a sample of this render.
pub fn replay(args: &args::Render, id: SampleId) -> Result<String> {
    let mut words = vec!["pt".to_owned(), args.scene.path()?.display().to_string()];
    let mut flag = |name: &str, value: Option<String>| words.extend(value.into_iter().flat_map(|value| [name.to_owned(), value]));
    args.scene.overrides.iter().for_each(|text| flag("-D", Some(text.clone())));
    flag("--integrator", args.integrator.clone());
    flag("--size", args.size.map(|[width, height]| format!("{width}x{height}")));
    flag("--spp", args.spp().map(|spp| spp.to_string()));
    flag("--seed", args.seed.map(|seed| seed.to_string()));
    flag("--sampler", args.sampler.clone());
    flag("--scramblings", args.scramblings.map(|k| k.to_string()));
    flag("--clamp", args.clamp.map(|limit| limit.to_string()));
    let mut command: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    if args.scene.allow_outside {
        command.push("--allow-outside".into());
    }
    let (x, y) = id.pixel;
    Ok(format!("{} --pixel {x},{y} --sample {} --trace", command.join(" "), id.index))
}

/// As a shell reads it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

/// A picture that was taken.
pub struct Taken<'a> {
    pub args: &'a args::Render,
    pub scene: &'a Arc<dyn Scene>,
    pub integrator: &'a dyn Integrator,
    pub render: &'a Render,
    pub film: &'a MomentFilm,
    pub course: &'a Course,
}

/// All that was asked for, and what one should know without asking.
///
/// - `facets`: the scene without smooth shadows, and how many meshes have them
pub fn tell(taken: &Taken, facets: Option<(World, usize)>) -> Result<()> {
    let Taken { args, render, film, course, .. } = *taken;
    if !is_quiet() || args.ledger {
        let matters = |removed: &Removed| args.ledger || args.verbose || removed.samples == 0 || removed.share > 0.0;
        taken.biases(facets).iter().filter(|removed| matters(removed)).for_each(|removed| insist(&told(removed)));
    }
    let unknown = course.last().and_then(|last| last.error).is_some_and(|error| !error.is_established());
    match args.worst {
        Some(count) => say(&worst_samples(args, &worst(render, film, count as usize))?),
        None if unknown && !is_quiet() => taken.culprit().map(|line| line.iter().for_each(|line| note(line))),
        None => Ok(()),
    }
}

impl Taken<'_> {
    /// Where the error cannot be established: who is to blame.
    fn culprit(&self) -> Result<Option<String>> {
        let Some(first) = worst(self.render, self.film, 1).samples.first().copied() else { return Ok(None) };
        let share = per_cent(first.share);
        Ok(Some(format!(
            "one sample makes {share} % of the noise (--worst 10 lists more); how it came about:\n  {}",
            replay(self.args, first.id)?
        )))
    }

    /// What clamping took, counted; then what is estimated by a few samples more.
    fn biases(&self, facets: Option<(World, usize)>) -> Vec<Removed> {
        let Taken { args, scene, integrator, render, film, .. } = *self;
        let (spec, seed, mean) = (film.spec(), render.sampler().seed, mean(film));
        let part = if args.ledger { 20 } else { 100 };
        // Two walks a sample.
        let samples = film.samples() * spec.crop.pixel_count() / (2 * part);
        let budget = Budget { samples: samples.max(LOT), time: render.report().elapsed / part as u32 };
        let mut removed: Vec<Removed> = clamped(args, film, render.report()).into_iter().collect();
        removed.extend(ledger(scene, integrator, spec, seed, mean, budget));
        if let Some((facets, count)) = facets {
            let (facets, setting): (Arc<dyn Scene>, _) = (Arc::new(facets), format!("smooth_shadows (meshes: {count})"));
            removed.push(compare(setting, (scene, integrator), (&facets, integrator), spec, seed, mean, budget));
        }
        removed
    }
}

/// `--worst N`: share of the noise, value, and the command that shows how it came about.
fn worst_samples(args: &args::Render, found: &Worst) -> Result<String> {
    let mut text = "the worst samples: share of the noise, value, how it came about\n".to_owned();
    for sample in &found.samples {
        let [r, g, b] = sample.value.to_rgb();
        text += &format!("{:>6} %  {r:?} {g:?} {b:?}  {}\n", per_cent(sample.share), replay(args, sample.id)?);
    }
    match (found.samples.is_empty(), found.complete) {
        (true, _) => text = "no noise: no sample is worse than another\n".into(),
        (_, true) => {}
        (_, false) => text += "no few samples make the noise: these are the worst of the pixels searched\n",
    }
    Ok(text)
}

/// What `--clamp` took, exactly.
pub fn clamped(args: &args::Render, film: &MomentFilm, report: &Report) -> Option<Removed> {
    let limit = args.clamp?;
    let taken = report.clamped.get() / numbers(film);
    let total = mean(film) + taken;
    Some(Removed { setting: format!("clamp {limit}"), share: if total > 0.0 { taken / total } else { 0.0 }, error: 0.0, samples: 0 })
}

/// Of the picture, over its pixels and colours.
fn mean(film: &MomentFilm) -> f64 {
    let pixel = |(i, sum): (usize, [f64; 3])| sum.iter().sum::<f64>() / film.samples_of(i).max(1) as f64;
    film.total().sums().enumerate().map(pixel).sum::<f64>() / (3.0 * film.spec().crop.pixel_count() as f64)
}

/// How many numbers were added up, where all pixels have as many samples: a colour of a sample of a pixel is one.
fn numbers(film: &MomentFilm) -> f64 {
    3.0 * film.samples().max(1) as f64 * film.spec().crop.pixel_count() as f64
}

/// `bias: max_depth 3 removes 4.1 ± 0.2 % of the energy`
pub fn told(removed: &Removed) -> String {
    let Removed { setting, share, error, samples } = removed;
    let verb = if *share < 0.0 { "adds" } else { "removes" };
    let energy = per_cent(share.abs());
    let what = match (*samples, *share != 0.0 || *error != 0.0) {
        (0, true) => format!("{verb} {energy} % of the energy"),
        (0, false) => "removes nothing".into(),
        (_, true) => format!("{verb} {energy} ± {} % of the energy", per_cent(*error)),
        (n, false) => format!("removes nothing that {n} camera samples would show"),
    };
    format!("bias: {setting} {what}")
}
