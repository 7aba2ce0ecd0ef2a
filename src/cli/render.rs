//! `pt SCENE`: load, render, write.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use super::display::Displayed;
use super::forensics::Taken;
use super::load::{Loaded, Override, load};
use super::outputs::check_outputs;
use super::progress::Progress;
use super::stats::{Account, Counted};
use super::trace::Trace;
use super::{INCONCLUSIVE, args, check, forensics, note, pilot, say, signals};
use crate::describe::{Built, Names};
use crate::error::{Error, Fault, Result};
use crate::film::{Crop, Film, FilmSpec, Image, MomentFilm};
use crate::integrator::{Entry, Integrator};
use crate::measure::{self, Course, Outcome, Removed, Target, Until, words};
use crate::output::{self, Attributes, Tonemap};
use crate::render::{self, Render, Report, SampleId, Settings};
use crate::sampler::Kind;
use crate::scene::Scene;
use crate::witness::Event;

pub fn render(args: &args::Render, tables: &[&[Entry]]) -> Result<ExitCode> {
    let start = Instant::now();
    let loaded = load(&args.scene, &overrides(args)?, args.integrator.as_deref(), tables)?;
    let load_seconds = start.elapsed().as_secs_f64();
    if !args.quiet {
        loaded.built.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
        remark_missing_effects(&loaded);
    }
    if args.verbose {
        note(&check::contents(&loaded));
    }
    let pool = pool(args.threads)?;
    if let Some([x, y]) = args.pixel {
        return pool.install(|| pixel(args, loaded, x, y)).map(|()| ExitCode::SUCCESS);
    }
    let outputs = outputs(args, &loaded.stem)?;
    let whom = pilot::whom(&loaded, &args.integrators, tables)?;
    signals::catch()?;
    let threads = pool.current_num_threads();
    pool.install(|| picture(args, loaded, &whom, &outputs, load_seconds, threads))
}

/// What `--size` says.
pub fn resized([width, height]: [u32; 2]) -> Vec<Override> {
    let set = |pointer, value: String| Override { words: format!("--size {width}x{height}"), pointer, value };
    // The scene's own crop is of a picture of another size.
    let crop = format!("{:?}", [0, width, 0, height]);
    vec![set("/film/width", width.to_string()), set("/film/height", height.to_string()), set("/film/crop", crop)]
}

/// Whether a picture from a file shows the pixels that the scene asks for.
///
/// # Errors
/// `Invalid` where it does not.
pub fn same_pixels(path: &Path, image: &Image, film: &FilmSpec) -> Result<()> {
    let (expected, found) = (film.crop.size(), image.size);
    if (found, image.origin) == (expected, film.crop.min) {
        return Ok(());
    }
    let text = format!("expected {} × {} pixels as the scene has, found {} × {}", expected.x, expected.y, found.x, found.y);
    Err(Error::invalid(Fault::new(text).in_file(path)))
}

/// So many threads, or one for each core.
pub fn pool(threads: Option<u32>) -> Result<rayon::ThreadPool> {
    let threads = threads.map_or(0, |n| n as usize);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| Error::Internal(format!("cannot start {threads} threads: {e}")))
}

/// The sampler of this name.
pub fn sampler_named(name: &str) -> Result<Kind> {
    let known: Vec<&str> = Kind::ALL.iter().map(|(_, name, _)| *name).collect();
    let found = Kind::ALL.iter().find(|row| row.1 == name).map(|row| row.0);
    found.ok_or_else(|| Error::Usage(crate::reader::unknown("sampler", name, &known)))
}

/// Renders, reports and writes.
fn picture(
    args: &args::Render,
    loaded: Loaded,
    whom: &[(Entry, Arc<dyn Integrator>)],
    outputs: &[PathBuf],
    load: f64,
    threads: usize,
) -> Result<ExitCode> {
    let facets = if args.ledger { loaded.without_smooth_shadows()? } else { None };
    let Loaded { built, entry, integrator, stem, .. } = loaded;
    let (pixels, primitives) = (built.film.crop.pixel_count(), built.world.primitive_count());
    let settings = Settings { clamp: args.clamp, ..Settings::new(built.sampler) };
    let until = until(args, &settings);
    let world: Arc<dyn Scene> = Arc::new(built.world);
    let shown = if args.quiet && args.progress == args::Progress::Auto { args::Progress::None } else { args.progress };
    if let Some(time) = args.pilot {
        let progress = Progress::new(shown, pixels, u32::MAX.into(), Some(time * whom.len() as u32));
        let list = pilot::price_list(&world, &built.film, &settings, whom, time, args.confidence, &progress);
        progress.finish();
        note(&list);
    }
    let counted = args.stats.map(|_| Arc::new(Counted::new(world.clone(), threads)));
    let scene = counted.clone().map_or(world.clone(), |counted| counted as Arc<dyn Scene>);

    let progress = Progress::new(shown, pixels, until.samples, until.time);
    let mut displayed = Displayed::new(MomentFilm::new(built.film), args.display_server.as_deref(), &stem, args.quiet);
    let mut render = Render::new(scene, &*integrator, displayed.spec(), &settings);
    let course = measure::follow(&mut render, &mut displayed, &until, &progress);
    let film = &displayed.film;
    progress.finish();
    let report = render.report();
    let outcome = until.target.map(|target| (target, target.outcome(&course)));

    if report.samples > 0 {
        let image = film.image();
        let freedom = film.freedom();
        let clamped = forensics::clamped(args, film, report);
        write_all(args, outputs, &image, &attributes(args, &entry, &settings, &course, freedom, clamped.as_ref()))?;
        if !args.quiet && image.pixels().flatten().all(|value| value == 0.0) {
            note("warning: the image is black");
        }
    }
    if !args.quiet {
        summarise(film.spec(), &entry, report, &course, args.confidence, outputs);
        outcome.iter().for_each(|(target, outcome)| note(&words::outcome(target, *outcome)));
    }
    if report.samples > 0 && !report.cancelled {
        forensics::tell(&Taken { args, scene: &world, integrator: &*integrator, render: &render, film, course: &course }, facets)?;
    }
    if let (Some(format), Some(counted)) = (args.stats, counted) {
        let account = Account { report, pixels, primitives, rays: counted.rays(), threads, load };
        say(&account.print(format))?;
    }
    displayed.finish();
    if let Some(signal) = signals::caught() {
        return Err(Error::Interrupted(signal));
    }
    Ok(if outcome.is_some_and(|(_, outcome)| outcome != Outcome::Met) { ExitCode::from(INCONCLUSIVE) } else { ExitCode::SUCCESS })
}

/// When a render ends: where only a time or an accuracy is asked for, the samples that the scene plans are no limit.
fn until(args: &args::Render, settings: &Settings) -> Until {
    let free = (args.time.is_some() || args.target.is_some()) && args.spp.is_none();
    let samples = if free { u32::MAX.into() } else { settings.samples };
    Until { samples, time: args.time, target: args.target.map(|error| Target { error, confidence: args.confidence }) }
}

/// One pixel, or one sample of it, printed.
fn pixel(args: &args::Render, loaded: Loaded, x: u32, y: u32) -> Result<()> {
    let Built { world, film, sampler, .. } = loaded.built;
    let settings = Settings { clamp: args.clamp, ..Settings::new(sampler) };
    if x >= film.size.x || y >= film.size.y {
        return Err(Error::Usage(format!("--pixel {x},{y}: the picture is {} × {}", film.size.x, film.size.y)));
    }
    let origin = world.origin();
    let scene: Arc<dyn Scene> = Arc::new(world);
    if let Some(index) = args.sample {
        let (id, render) = (SampleId { pixel: (x, y), index }, Render::new(scene.clone(), &*loaded.integrator, &film, &settings));
        let mut events: Vec<Event> = vec![];
        let value = render.replay(id, args.trace.is_some().then_some(&mut events));
        let Some(form) = args.trace else {
            let [r, g, b] = value.to_rgb();
            return say(&format!("pixel {x},{y} sample {index}: {r:?} {g:?} {b:?}\n"));
        };
        let (camera, names, integrator) = (render.camera(id), Names::of(&loaded.description), loaded.entry.name);
        let trace = Trace { integrator, id, camera, value, events: &events, names: &names, lights: scene.lights(), origin };
        return say(&trace.print(form));
    }
    let min = glam::UVec2::new(x, y);
    let mut film = MomentFilm::new(FilmSpec { crop: Crop { min, max: min + 1 }, ..film });
    render::render(scene, &*loaded.integrator, &mut film, &settings, &render::Silent);
    let image = film.image();
    let [r, g, b] = image.rgb(0, 0);
    let error = image.channel("StdErr.R").map(|_| {
        let [r, g, b] = ["StdErr.R", "StdErr.G", "StdErr.B"].map(|name| image.channel(name).map_or(0.0, |c| c[0]));
        format!("  standard error {r:?} {g:?} {b:?}")
    });
    say(&format!("pixel {x},{y} of {} samples: {r:?} {g:?} {b:?}{}\n", film.samples(), error.unwrap_or_default()))
}

/// Flags that say what a key of the scene says.
fn overrides(args: &args::Render) -> Result<Vec<Override>> {
    let mut list = args.size.map(resized).unwrap_or_default();
    let mut set = |words: String, pointer, value: String| list.push(Override { words, pointer, value });
    if let Some([x0, x1, y0, y1]) = args.crop {
        set(format!("--crop {x0},{x1},{y0},{y1}"), "/film/crop", format!("{:?}", [x0, x1, y0, y1]));
    }
    if let Some(spp) = args.spp {
        set(format!("--spp {spp}"), "/sampler/spp", spp.to_string());
    }
    if let Some(seed) = args.seed {
        set(format!("--seed {seed}"), "/sampler/seed", seed.to_string());
    }
    if let Some(k) = args.scramblings {
        set(format!("--scramblings {k}"), "/sampler/scramblings", k.to_string());
    }
    if let Some(name) = &args.sampler {
        sampler_named(name)?;
        set(format!("--sampler {name}"), "/sampler/type", name.clone());
    }
    Ok(list)
}

/// What the picture will lack, in one line.
fn remark_missing_effects(loaded: &Loaded) {
    let missing = loaded.built.world.effects() - loaded.entry.simulates;
    if !missing.is_empty() {
        note(&format!("note: {} does not simulate what this scene calls for: {missing}", loaded.entry.name));
    }
}

/// Where to write; refused now rather than after an hour of rendering.
fn outputs(args: &args::Render, stem: &str) -> Result<Vec<PathBuf>> {
    let default = || vec![PathBuf::from(format!("{stem}.exr")), PathBuf::from(format!("{stem}.png"))];
    let outputs = if args.output.is_empty() { default() } else { args.output.clone() };
    check_outputs(&outputs, &[args.scene.path()?], "is the scene file")?;
    Ok(outputs)
}

fn write_all(args: &args::Render, outputs: &[PathBuf], image: &Image, attributes: &Attributes) -> Result<()> {
    let tonemap = Tonemap { exposure: args.exposure, curve: args.tonemap.into() };
    // All are tried, so that one that fails does not take the others with it.
    let results: Vec<Result<()>> = outputs.iter().map(|path| output::write(path, image, attributes, &tonemap)).collect();
    results.into_iter().collect()
}

/// What the file says about itself: functions of scene and settings alone.
fn attributes(
    args: &args::Render,
    entry: &Entry,
    settings: &Settings,
    course: &Course,
    freedom: f64,
    clamped: Option<&Removed>,
) -> Attributes {
    let sampler = Kind::ALL.iter().find(|(kind, ..)| *kind == settings.sampler.kind).map_or("", |(_, name, _)| name);
    let samples = course.last().map_or(0, |last| last.samples);
    let mut pairs = vec![
        ("pt/version", env!("CARGO_PKG_VERSION").to_owned()),
        ("pt/integrator", entry.name.to_owned()),
        ("pt/sampler", sampler.to_owned()),
        ("pt/seed", settings.sampler.seed.to_string()),
        ("pt/scramblings", settings.sampler.spread().sequences().to_string()),
        ("pt/spp", samples.to_string()),
        ("pt/confidence", args.confidence.to_string()),
        ("pt/standardErrorFreedom", freedom.to_string()),
    ];
    if let Some(error) = course.last().and_then(|last| last.error) {
        let [low, high] = error.interval(args.confidence);
        pairs.extend(
            [("pt/relativeError", error.value), ("pt/relativeErrorLow", low), ("pt/relativeErrorHigh", high)]
                .map(|(k, v)| (k, v.to_string())),
        );
    }
    if let Some(Removed { setting, share, .. }) = clamped {
        pairs.extend([("pt/bias", setting.clone()), ("pt/biasRemoved", share.to_string())]);
    }
    pairs.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

fn summarise(spec: &FilmSpec, entry: &Entry, report: &Report, course: &Course, confidence: f64, outputs: &[PathBuf]) {
    let size = spec.crop.size();
    let files = outputs.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    let time = words::duration(report.elapsed.as_secs_f64());
    let what = format!("{}×{} · {} · {} spp · {time}", size.x, size.y, entry.name, report.samples);
    match (report.samples, report.cancelled) {
        (0, _) => note(&format!("{what} · interrupted before the first sample: nothing written")),
        (_, true) => note(&format!("{what} · interrupted{} · {files}", accuracy(course, confidence))),
        (_, false) => note(&format!("{what}{} · {files}", accuracy(course, confidence))),
    }
    if let Some(first) = report.first_invalid.first() {
        let (x, y) = first.pixel;
        note(&format!("warning: {} invalid samples counted as black; the first: --pixel {x},{y} --sample {}", report.invalid, first.index));
    }
}

/// ` · relative error 2.1 % (95 %: 2.0–2.2) · 1 % would take about 14 s`, as far as it is known.
fn accuracy(course: &Course, confidence: f64) -> String {
    match course.last().and_then(|last| last.error) {
        None => String::new(),
        Some(error) if !error.is_established() => " · relative error cannot be established (heavy tail)".into(),
        Some(error) => {
            let price = words::next_price(course, confidence).map_or(String::new(), |price| format!(" · {price}"));
            format!(" · relative error {}{price}", words::error(&error, confidence))
        }
    }
}
