//! What each effect of a scene holds of its light, its noise and its time, and what leaving it out would change.
//!
//! Small pictures of the scene are rendered several times, each time with and without each effect that a change of the scene can leave out,
//! on the same random numbers. The paths of the scene's own picture are recorded and sorted by what they meet. What the columns mean is in
//! `figures.rs`, which paths and changes belong to an effect in `subjects.rs`.
//!
//! Tests: `tests/it/effects.rs`: shares of a furnace, coverage of the intervals, effects that a scene does not have.

mod figures;
mod paths;
mod pictures;
mod subjects;
mod without;

use std::time::{Duration, Instant};

use glam::UVec2;

use crate::effects::Effects;
use crate::error::{Error, Result};
use crate::integrator::Entry;
use crate::load::Loaded;
use crate::render::Observer;
use crate::scene::Scene as _;
use figures::Scale;
use pictures::{Contains, Pixels, Replicate, Way, replicates};
use subjects::Subject;
use without::without;

pub use figures::Figure;
pub use pictures::Plan;

/// Confidence of all intervals.
pub const CONFIDENCE: f64 = 0.95;

/// Relative error of a picture below which an effect counts as invisible.
const LEAST: f64 = 1e-3;

/// Figures of an effect, or of a part of the light. `None` where it has no such figure.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectFigures {
    /// Name of the effect or of the part.
    pub name: String,
    /// Share of the light that paths with it bring: the mean of the colours and pixels.
    pub light: Option<Figure>,
    /// Share of the noise (relMSE of the same number of samples) that goes without it.
    pub noise: Option<Figure>,
    /// Share of the render time that goes without it.
    pub time: Option<Figure>,
    /// Change of the mean of the picture without it, relative to the mean.
    pub mean: Option<Figure>,
    /// Relative error of the picture without it: √relMSE that no number of samples removes.
    pub picture: Option<Figure>,
    /// Time to the same noise without it, as a multiple of that with it.
    pub price: Option<Figure>,
}

/// Figures of all effects of a scene.
#[derive(Clone, Debug)]
pub struct EffectReport {
    /// Width and height of the measured pictures (pixels).
    pub size: UVec2,
    /// Samples per pixel of each replicate.
    pub samples: u64,
    /// Number of replicates.
    pub replicates: u32,
    /// Time of the measurement, without the loading of the scene (s).
    pub seconds: f64,
    /// Samples per pixel of the scene, and the relative error of a picture with so many, extrapolated from the measured pictures by 1/√n as
    /// for independent samples; `None` if their error cannot be stated.
    pub noise_of_scene: (u64, Option<f64>),
    /// The figures: parts of the light first, then effects.
    pub rows: Vec<EffectFigures>,
}

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub enum Extent {
    /// For about this time. It includes building the scenes without the effects, but at least half of it goes into pictures.
    Time(Duration),
    /// A fixed number of pictures and samples.
    Plan(Plan),
}

/// Measures the effects of a scene. `None` if the observer ended it.
///
/// # Errors
/// `Usage` for an integrator whose paths cannot be sorted: one that follows paths from the lights, branches, or shows no light; `Invalid` for a
/// scene whose picture is black; those of loading the scene without an effect.
pub fn measure_effects(loaded: &Loaded, tables: &[&[Entry]], extent: Extent, observer: &dyn Observer) -> Result<Option<EffectReport>> {
    if loaded.integrator.splats() || !loaded.entry.simulates.contains(Effects::INTERREFLECTION) {
        let message = format!("{}: expected an integrator that follows single paths from the camera, such as nee", loaded.entry.name);
        return Err(Error::Usage(message));
    }
    let start = Instant::now();
    let subjects = Subject::of(loaded.world.effects());
    let mut ways = vec![Way::of(loaded)];
    let mut measured = vec![];
    for subject in subjects {
        let changed = match subject.change {
            Some(change) => without(loaded, subject.gone(), change, tables)?,
            None => None,
        };
        let way = changed.map(|changed| {
            ways.push(Way::of(&changed));
            ways.len() - 1
        });
        measured.push((subject, way));
    }
    let paths: Vec<Contains> = measured.iter().filter_map(|(subject, _)| subject.contains).collect();
    let plan = match extent {
        Extent::Plan(plan) => plan,
        Extent::Time(time) => {
            let left = time.saturating_sub(start.elapsed()).max(time / 2);
            Plan::for_time(left, &ways[0], ways.len(), loaded.sampler, observer)
        }
    };
    let Some(all) = replicates(&ways, &paths, &plan, loaded.sampler, observer) else { return Ok(None) };
    let of_way = |way: usize| all.iter().map(|replicate| &replicate.of_ways[way].0).collect::<Vec<_>>();
    let with = of_way(0);
    let scale = Scale::new(&with, CONFIDENCE).ok_or_else(|| {
        let message = "the picture is black: there is no light to be measured";
        Error::invalid(crate::error::Fault::new(message).in_file(&loaded.file))
    })?;
    let mut index = 0..;
    let mut row = |(subject, way): &(Subject, Option<usize>)| {
        let parts = subject.contains.and_then(|_| index.next()).map(|k| all.iter().map(|of| &of.of_paths[k]).collect::<Vec<_>>());
        figures(&scale, &all, &with, subject, parts.as_deref(), *way)
    };
    // Parts of the light that a scene lacks are no effects of it.
    let is_there = |(subject, row): &(&Subject, EffectFigures)| {
        !subject.effect.is_empty() || !matches!(row.light, Some(Ok(light)) if light.value == 0.0)
    };
    let rows = measured.iter().map(|of| (&of.0, row(of))).filter(is_there).map(|(_, row)| row).collect();
    let error = scale.error(&with);
    let spp = loaded.sampler.spp;
    let noise = error.refusal().is_none().then(|| error.value * (plan.samples as f64 / spp as f64).sqrt());
    Ok(Some(EffectReport {
        size: loaded.film.with_pixels(plan.pixels as f32).crop.size(),
        samples: plan.samples,
        replicates: all.len() as u32,
        seconds: start.elapsed().as_secs_f64(),
        noise_of_scene: (spp, noise),
        rows,
    }))
}

/// Figures of one subject.
///
/// - `parts`: the light of the paths that contain it, in each replicate
/// - `way`: the way to render the scene without it
fn figures(
    scale: &Scale,
    all: &[Replicate],
    with: &[&Pixels],
    subject: &Subject,
    parts: Option<&[&Pixels]>,
    way: Option<usize>,
) -> EffectFigures {
    let light = parts.map(|parts| scale.light(with, parts));
    // Without a change of the scene, the picture without the effect is the one without its paths.
    let subtracted: Option<Vec<Pixels>> = parts.filter(|_| subject.is_light && way.is_none()).map(|parts| {
        let less = |(x, part): (&&Pixels, &&Pixels)| x.iter().zip(part.iter()).map(|(x, part)| x - part).collect();
        with.iter().zip(parts).map(less).collect()
    });
    let without: Option<Vec<&Pixels>> = match (way, &subtracted) {
        (Some(way), _) => Some(all.iter().map(|of| &of.of_ways[way].0).collect()),
        (None, Some(pictures)) => Some(pictures.iter().collect()),
        (None, None) => None,
    };
    let absence = without.map(|without| scale.absence(with, &without));
    let seconds = |way: usize| all.iter().map(|of| of.of_ways[way].1).collect::<Vec<_>>();
    let time = way.map(|way| scale.time(&seconds(0), &seconds(way)));
    EffectFigures {
        name: subject.name(),
        light,
        noise: absence.as_ref().map(|absence| absence.noise),
        time: time.map(Ok),
        mean: absence.as_ref().map(|absence| absence.mean),
        picture: absence.as_ref().map(|absence| absence.picture),
        price: absence.as_ref().zip(time).map(|(absence, time)| absence.price(time)),
    }
}

impl EffectReport {
    /// Effects that may be left out: the picture changes by less than 0.1 % or less than the noise of the scene's samples, and rendering takes
    /// less time. Both must hold at the unfavourable end of the interval.
    pub fn dispensable(&self) -> impl Iterator<Item = &EffectFigures> {
        let most = self.noise_of_scene.1.unwrap_or(0.0).max(LEAST);
        self.rows.iter().filter(move |row| {
            let is_invisible = matches!(row.picture, Some(Ok(picture)) if picture.high < most);
            is_invisible && matches!(row.time, Some(Ok(time)) if time.low > 0.0)
        })
    }
}
