//! What is told beside the picture: which samples are to blame for its noise, and what its biases took.

use std::sync::Arc;
use std::time::Duration;

use super::args;
use crate::error::Result;
use crate::film::{Film, MomentFilm};
use crate::integrator::Integrator;
use crate::measure::ledger::{Budget, LOT};
use crate::measure::words::per_cent;
use crate::measure::{Removed, Worst, ledger, worst};
use crate::render::{Render, SampleId, Settings};
use crate::scene::Scene;

/// The command that shows the paths of a sample of this render.
pub fn replay(args: &args::Render, id: SampleId) -> Result<String> {
    let mut words = vec!["pt".to_owned(), args.scene.path()?.display().to_string()];
    let mut flag = |name: &str, value: Option<String>| words.extend(value.into_iter().flat_map(|value| [name.to_owned(), value]));
    args.scene.overrides.iter().for_each(|text| flag("-D", Some(text.clone())));
    flag("--integrator", args.integrator.clone());
    flag("--size", args.size.map(|[width, height]| format!("{width}x{height}")));
    flag("--spp", args.spp.map(|spp| spp.to_string()));
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

/// `--worst N`: share of the noise, value, and the command that shows how it came about.
pub fn worst_samples(args: &args::Render, found: &Worst) -> Result<String> {
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

/// Where the error cannot be established: who is to blame.
pub fn culprit(args: &args::Render, render: &Render, film: &MomentFilm) -> Result<Option<String>> {
    let Some(first) = worst(render, film, 1).samples.first().copied() else { return Ok(None) };
    let share = per_cent(first.share);
    Ok(Some(format!("one sample makes {share} % of the noise: {} (--worst 10 lists more)", replay(args, first.id)?)))
}

/// What the biases of a render took out of its picture: what clamping took, counted, then what was estimated.
pub fn biases(
    args: &args::Render,
    scene: &Arc<dyn Scene>,
    integrator: &dyn Integrator,
    settings: &Settings,
    film: &MomentFilm,
    render: &Render,
) -> Vec<Removed> {
    let mean = mean(film);
    let (samples, elapsed) = (film.samples() * film.spec().crop.pixel_count(), render.report().elapsed);
    let part = if args.ledger { 20 } else { 100 };
    // Two walks a sample.
    let budget = Budget { samples: (samples / (2 * part)).max(LOT), time: elapsed / part as u32 + Duration::from_millis(1) };
    let clamped = clamped(args, film, render).into_iter();
    clamped.chain(ledger(scene, integrator, film.spec(), settings.sampler.seed, mean, budget)).collect()
}

/// What `--clamp` took, exactly.
pub fn clamped(args: &args::Render, film: &MomentFilm, render: &Render) -> Option<Removed> {
    let limit = args.clamp?;
    let taken = render.report().clamped.get() / (3.0 * film.samples().max(1) as f64 * film.spec().crop.pixel_count() as f64);
    let total = mean(film) + taken;
    Some(Removed { setting: format!("clamp {limit}"), share: if total > 0.0 { taken / total } else { 0.0 }, error: 0.0, samples: 0 })
}

/// Of the picture, over its pixels and colours.
fn mean(film: &MomentFilm) -> f64 {
    let count = 3.0 * film.samples().max(1) as f64 * film.spec().crop.pixel_count() as f64;
    film.total().sums().flatten().sum::<f64>() / count
}

/// `bias: max_depth 3 removes 4.1 ± 0.2 % of the energy`
pub fn told(removed: &Removed) -> String {
    let Removed { setting, share, error, samples } = removed;
    let what = match (*samples, *share != 0.0 || *error != 0.0) {
        (0, true) => format!("removes {} % of the energy", per_cent(*share)),
        (0, false) => "removes nothing".into(),
        (_, true) => format!("removes {} ± {} % of the energy", per_cent(*share), per_cent(*error)),
        (n, false) => format!("removes nothing that {n} camera samples would show"),
    };
    format!("bias: {setting} {what}")
}
