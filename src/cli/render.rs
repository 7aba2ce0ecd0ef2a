//! `pt SCENE`: load, render, write.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use super::account::{self, attributes, summarise};
use super::display::Displayed;
use super::forensics::Taken;
use super::keep::Keeper;
use super::load::{Loaded, Override, load};
use super::plan::{self, Plan};
use super::progress::Progress;
use super::stats::{Account, Counted};
use super::trace::Trace;
use super::{INCONCLUSIVE, args, check, forensics, insist, is_quiet, note, pilot, say, signals};
use crate::describe::{Built, Names};
use crate::error::{Error, Fault, Result};
use crate::film::{Crop, FilmSpec, Image, Layer, MomentFilm};
use crate::integrator::{Entry, Integrator};
use crate::light::{Light, Lights};
use crate::measure::{self, Course, Outcome, Until, Watcher, adaptive, words};
use crate::output::{self, Attributes, Curve, Format, Tonemap, exposure};
use crate::render::{self, Render, SampleId, Settings};
use crate::sampler::Kind;
use crate::scene::Scene;
use crate::witness::Event;

pub fn render(args: &args::Render, tables: &[&[Entry]]) -> Result<ExitCode> {
    let start = Instant::now();
    let loaded = load(&args.scene, &overrides(args)?, args.integrator.as_deref(), tables)?;
    let load_seconds = start.elapsed().as_secs_f64();
    loaded.built.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
    remark_missing_effects(&loaded);
    if args.verbose {
        note(&check::contents(&loaded));
    }
    let pool = pool(args.work.threads)?;
    if let Some([x, y]) = args.pixel {
        return pool.install(|| pixel(args, loaded, x, y)).map(|()| ExitCode::SUCCESS);
    }
    let plan = Plan::new(args, &loaded)?;
    if !loaded.built.film.layers.is_empty() && !plan.pictures.iter().any(|path| Format::of(path) == Some(Format::Exr)) {
        note("warning: layers are written to .exr files, and none is asked for");
    }
    let whom = pilot::whom(&loaded, &args.integrators, tables)?;
    signals::catch()?;
    let threads = pool.current_num_threads();
    pool.install(|| picture(args, loaded, &whom, &plan, load_seconds, threads))
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
    pool.map_err(|e| Error::Limit(Fault::new(format!("cannot start {threads} threads: {e}"))))
}

/// The sampler of this name.
pub fn sampler_named(name: &str) -> Result<Kind> {
    let known: Vec<&str> = Kind::ALL.iter().map(|(_, name, _)| *name).collect();
    let found = Kind::ALL.iter().find(|row| row.1 == name).map(|row| row.0);
    found.ok_or_else(|| Error::Usage(crate::reader::unknown("sampler", name, &known)))
}

/// The layers of these names; `all` are those that do not depend on the clock.
fn layers_named(names: &[String]) -> Result<Vec<&'static str>> {
    const EVERY: &str = "all";
    let known: Vec<&str> = Layer::ALL.iter().map(|row| row.1).chain([EVERY]).collect();
    if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(Error::Usage(format!("--aov: {}", crate::reader::unknown("layer", name, &known))));
    }
    let has = |name: &str| names.iter().any(|other| other == name);
    let rows = Layer::ALL.iter().filter(|(layer, name, _)| has(name) || has(EVERY) && layer.is_reproducible());
    Ok(rows.map(|row| row.1).collect())
}

/// Renders, reports and writes.
fn picture(
    args: &args::Render,
    loaded: Loaded,
    whom: &[(Entry, Arc<dyn Integrator>)],
    plan: &Plan,
    load: f64,
    threads: usize,
) -> Result<ExitCode> {
    let facets = if args.ledger { loaded.without_smooth_shadows()? } else { None };
    let Loaded { built, entry, integrator, stem, description, .. } = loaded;
    let (pixels, primitives) = (built.film.crop.pixel_count(), built.world.primitive_count());
    let settings = Settings { clamp: args.clamp, wave_time: Some(render::SHORT_WAVE), ..Settings::new(built.sampler) };
    let mut until = plan.until(args);
    let mut spec = built.film;
    let mut start = plan.start(MomentFilm::new(spec.clone()), &until)?;
    let world: Arc<dyn Scene> = Arc::new(built.world);
    let shown = args.work.progress;
    if let Some(time) = args.pilot {
        let progress = Progress::new(shown, &spec, u32::MAX.into(), Some(time * whom.len() as u32));
        let list = pilot::price_list(&world, &spec, &settings, whom, time, args.confidence, &progress);
        progress.finish();
        insist(&list);
    }
    let counted = args.stats.map(|_| Arc::new(Counted::new(world.clone(), threads)));
    let scene = counted.clone().map_or(world.clone(), |counted| counted as Arc<dyn Scene>);

    if args.adaptive {
        let progress = Progress::new(args::Progress::None, &spec, until.samples, None);
        (spec.allocation, start.report.elapsed) = adaptive::explore(&world, &*integrator, &spec, &settings, until.samples, &progress);
        until.samples = ((until.samples as f64 / spec.allocation.mean()).round() as u64).max(1);
        start.film = MomentFilm::new(spec.clone());
    }
    let before = start.report.clone();
    let progress = Progress::new(shown, &spec, until.samples - plan.samples.start, until.time).resumed(&before);
    let keeper = Keeper::new(&progress, plan, args.checkpoint, until.time.filter(|_| before.samples == 0));
    let keeper = if is_quiet() || args.pilot.is_some() || plan.is_part { keeper } else { keeper.with_prices(entry.name, args.confidence) };
    let mut displayed = Displayed::new(start.film, args.display_server.as_deref(), &stem);
    let mut render = Render::new(scene, &*integrator, &spec, &settings).resumed(start.next, start.report);
    let course = match plan.is_part {
        true => part(&mut render, &mut displayed, &until, &keeper),
        false => measure::follow_on(start.course, &mut render, &mut displayed, &until, &keeper),
    };
    let film = &displayed.film;
    progress.finish();
    let report = render.report();
    let outcome = until.target.map(|target| (target, target.outcome(&course)));
    let is_late = report.samples == 0 && signals::caught().is_none();

    // Parts and pictures: what cannot be written does not take the other with it.
    let kept = if report.samples > 0 { plan.write_parts(film, report, &course) } else { Ok(()) };
    if report.samples > 0 && !plan.is_part {
        let image = film.image();
        let error = course.last().and_then(|last| last.error);
        let clamped = forensics::clamped(args, film, report);
        let attributes = attributes(&plan.about, film, error, args.confidence, clamped.as_ref());
        let tonemap = args.develop.tonemap(&image);
        write_all(&plan.pictures, &image, &attributes, &tonemap)?;
        if !is_quiet() {
            remark_darkness(&image, entry.name, || one_sided(&Names::of(&description), world.lights()));
            remark_exposure(args, &plan.pictures, &image, &tonemap);
        }
    }
    kept?;
    if !is_quiet() || is_late {
        let samples = if plan.is_part { format!("samples {}", plan::ranges(&[film.range()])) } else { account::samples(film) };
        summarise(&plan.about, &samples, report, &course, args.confidence, plan.written());
        outcome.iter().for_each(|(target, outcome)| note(&words::outcome(target, *outcome)));
    }
    if report.samples > 0 && !report.cancelled && !plan.is_part {
        forensics::tell(&Taken { args, scene: &world, integrator: &*integrator, render: &render, film, course: &course }, facets)?;
    }
    if let (Some(format), Some(counted)) = (args.stats, counted) {
        let account =
            Account { report: &report.since(&before), spp: film.mean_samples(), pixels, primitives, rays: counted.rays(), threads, load };
        say(&account.print(format))?;
    }
    displayed.finish();
    if let Some(signal) = signals::caught() {
        return Err(Error::Interrupted(signal));
    }
    Ok(if is_late || outcome.is_some_and(|(_, outcome)| outcome != Outcome::Met) {
        ExitCode::from(INCONCLUSIVE)
    } else {
        ExitCode::SUCCESS
    })
}

/// Some samples of each pixel: nothing is said of the error of a picture that they are not.
fn part(render: &mut Render, displayed: &mut Displayed, until: &Until, keeper: &Keeper) -> Course {
    while render.step(until.samples, None, displayed, keeper) {
        keeper.stepped(render.report(), &displayed.film, &Course::default());
    }
    Course::default()
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
    let mut film = MomentFilm::new(FilmSpec { crop: Crop { min, max: min + 1 }, ..film.without_layers() });
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
    if let Some(spp) = args.spp() {
        set(format!("--spp {spp}"), "/sampler/spp", spp.to_string());
    }
    if let Some(seed) = args.seed {
        set(format!("--seed {seed}"), "/sampler/seed", seed.to_string());
    }
    if let Some(k) = args.scramblings {
        set(format!("--scramblings {k}"), "/sampler/scramblings", k.to_string());
    }
    if !args.aov.is_empty() {
        let names = layers_named(&args.aov)?;
        set(format!("--aov {}", args.aov.join(",")), "/film/layers", format!("{names:?}"));
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

/// Where light is missing: in the picture, or in its layers of light.
///
/// - `why`: what a black picture may come from, as far as one can tell
fn remark_darkness(image: &Image, integrator: &str, why: impl FnOnce() -> Option<String>) {
    let is_black = |names: &[&str]| names.iter().filter_map(|name| image.channel(name)).flatten().all(|value| *value == 0.0);
    let told: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).filter(|name| is_of_light(name)).collect();
    if is_black(&["R", "G", "B"]) {
        note("warning: the image is black");
        why().iter().for_each(|reason| note(&format!("note: {reason}")));
    } else if !told.is_empty() && is_black(&told) {
        note(&format!("warning: {integrator} tells nothing of its light, or there is none in the layers asked for: they are black"));
    }
}

/// The lamps that shine to one side only, which may be the wrong one.
fn one_sided(names: &Names, lights: &Lights) -> Option<String> {
    const NAMED: usize = 3;
    let is_one_sided = |light: &Light| matches!(light, Light::Area(area) if !area.emitter.emission.two_sided);
    let mut lamps: Vec<&str> =
        (0..).zip(lights.iter()).filter(|(_, light)| is_one_sided(light)).map(|(i, _)| names.light(lights, i)).collect();
    lamps.dedup();
    let more = if lamps.len() > NAMED { format!(" and {} more", lamps.len() - NAMED) } else { String::new() };
    let verb = if lamps.len() > 1 { "shine" } else { "shines" };
    lamps.truncate(NAMED);
    let named = lamps.join(", ");
    (!lamps.is_empty()).then(|| format!("{named}{more} {verb} to one side only, that of the normal: turn it, or say \"two_sided\": true"))
}

fn is_of_light(channel: &str) -> bool {
    ["Emission.", "Direct.", "Indirect.", "Light."].iter().any(|layer| channel.starts_with(layer))
}

/// Which exposure was chosen, or that another would show more, where a picture is developed.
fn remark_exposure(args: &args::Render, outputs: &[PathBuf], image: &Image, tonemap: &Tonemap) {
    let developed = outputs.iter().find(|path| matches!(Format::of(path), Some(Format::Png | Format::Ppm)));
    let Some(developed) = developed.filter(|_| matches!(tonemap.curve, Curve::None | Curve::Filmic)) else { return };
    if args.develop.exposure == args::Exposure::Auto {
        note(&format!("note: developed with --exposure {}", tonemap.exposure));
    } else if let Some(fault) = exposure::fault(image, tonemap) {
        let raw = outputs.iter().find(|path| Format::of(path) == Some(Format::Exr));
        let again = raw.map_or(String::new(), |raw| {
            format!("; without a new render:\n  pt image convert {} -o {} --exposure auto", raw.display(), developed.display())
        });
        note(&format!("note: {} is {fault}: --exposure {}, or auto, shows it{again}", developed.display(), exposure::automatic(image)));
    }
}

fn write_all(outputs: &[PathBuf], image: &Image, attributes: &Attributes, tonemap: &Tonemap) -> Result<()> {
    // All are tried, so that one that fails does not take the others with it.
    let results: Vec<Result<()>> = outputs.iter().map(|path| output::write(path, image, attributes, tonemap)).collect();
    results.into_iter().collect()
}
