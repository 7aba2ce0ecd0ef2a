//! `pt SCENE`: load, render, write.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use super::display::Displayed;
use super::load::{Loaded, load};
use super::outputs::check_outputs;
use super::progress::Progress;
use super::stats::{Account, Counted};
use super::{args, note, say, signals};
use crate::describe::Built;
use crate::error::{Error, Result};
use crate::film::{Crop, Film, FilmSpec, Image, MomentFilm};
use crate::integrator::Entry;
use crate::output::{self, Attributes, Tonemap};
use crate::render::{self, Report, SampleId, Settings};
use crate::sampler::Kind;
use crate::scene::Scene;

pub fn render(args: &args::Render, tables: &[&[Entry]]) -> Result<()> {
    let start = Instant::now();
    let loaded = load(&args.scene, &overrides(args)?, args.integrator.as_deref(), tables)?;
    let load_seconds = start.elapsed().as_secs_f64();
    if !args.quiet {
        loaded.built.warnings.iter().for_each(|warning| note(&format!("warning: {warning}")));
        remark_missing_effects(&loaded);
    }
    let threads = args.threads.map_or(0, |n| n as usize);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| Error::Internal(format!("cannot start {threads} threads: {e}")))?;
    if let Some([x, y]) = args.pixel {
        return pool.install(|| pixel(args, loaded, x, y));
    }
    let outputs = outputs(args, &loaded.stem)?;
    signals::catch()?;
    let threads = pool.current_num_threads();
    pool.install(|| picture(args, loaded, &outputs, load_seconds, threads))
}

/// Renders, reports and writes.
fn picture(args: &args::Render, loaded: Loaded, outputs: &[PathBuf], load: f64, threads: usize) -> Result<()> {
    let Loaded { built, entry, integrator, stem, .. } = loaded;
    let (pixels, primitives) = (built.film.crop.pixel_count(), built.world.primitive_count());
    let mut settings = Settings { time: args.time, ..Settings::new(built.sampler) };
    if args.time.is_some() && args.spp.is_none() {
        settings.samples = u32::MAX.into();
    }
    let world: Arc<dyn Scene> = Arc::new(built.world);
    let counted = args.stats.map(|_| Arc::new(Counted::new(world.clone(), threads)));
    let scene = counted.clone().map_or(world, |counted| counted as Arc<dyn Scene>);

    let shown = if args.quiet && args.progress == args::Progress::Auto { args::Progress::None } else { args.progress };
    let progress = Progress::new(shown, pixels, settings.samples, args.time);
    let mut displayed = Displayed::new(MomentFilm::new(built.film), args.display_server.as_deref(), &stem, args.quiet);
    let report = render::render(scene, &*integrator, &mut displayed, &settings, &progress);
    progress.finish();
    let film = &displayed.film;

    if report.samples > 0 {
        let attributes = attributes(&entry, &settings, &report);
        let image = film.image(settings.sampler.kind == Kind::Independent);
        write_all(args, outputs, &image, &attributes)?;
        if !args.quiet && image.pixels().flatten().all(|value| value == 0.0) {
            note("warning: the image is black");
        }
    }
    if !args.quiet {
        summarise(film.spec(), &entry, &report, outputs);
    }
    if let (Some(format), Some(counted)) = (args.stats, counted) {
        let account = Account { report: &report, pixels, primitives, rays: counted.rays(), threads, load };
        say(&account.print(format))?;
    }
    displayed.finish();
    signals::caught().map_or(Ok(()), |signal| Err(Error::Interrupted(signal)))
}

/// One pixel, or one sample of it, printed.
fn pixel(args: &args::Render, loaded: Loaded, x: u32, y: u32) -> Result<()> {
    let Built { world, film, sampler, .. } = loaded.built;
    if x >= film.size.x || y >= film.size.y {
        return Err(Error::Usage(format!("--pixel {x},{y}: the picture is {} × {}", film.size.x, film.size.y)));
    }
    let scene: Arc<dyn Scene> = Arc::new(world);
    if let Some(index) = args.sample {
        let value = render::sample(scene, &*loaded.integrator, &film, &sampler, SampleId { pixel: (x, y), index });
        let [r, g, b] = value.to_rgb();
        return say(&format!("pixel {x},{y} sample {index}: {r:?} {g:?} {b:?}\n"));
    }
    let min = glam::UVec2::new(x, y);
    let mut film = MomentFilm::new(FilmSpec { crop: Crop { min, max: min + 1 }, ..film });
    render::render(scene, &*loaded.integrator, &mut film, &Settings::new(sampler), &render::Silent);
    let image = film.image(sampler.kind == Kind::Independent);
    let [r, g, b] = image.rgb(0, 0);
    let error = image.channel("StdErr.R").map(|_| {
        let [r, g, b] = ["StdErr.R", "StdErr.G", "StdErr.B"].map(|name| image.channel(name).map_or(0.0, |c| c[0]));
        format!("  standard error {r:?} {g:?} {b:?}")
    });
    say(&format!("pixel {x},{y} of {} samples: {r:?} {g:?} {b:?}{}\n", film.samples(), error.unwrap_or_default()))
}

/// Flags that say what a key of the scene says.
fn overrides(args: &args::Render) -> Result<Vec<(String, String)>> {
    let mut list = vec![];
    let mut set = |pointer: &str, value: Option<String>| list.extend(value.map(|value| (pointer.to_owned(), value)));
    set("/film/width", args.size.map(|s| s[0].to_string()));
    set("/film/height", args.size.map(|s| s[1].to_string()));
    let whole = args.size.map(|[w, h]| [0, w, 0, h]);
    set("/film/crop", args.crop.or(whole).map(|c| format!("{c:?}")));
    set("/sampler/spp", args.spp.map(|n| n.to_string()));
    set("/sampler/seed", args.seed.map(|n| n.to_string()));
    if let Some(name) = &args.sampler {
        let known: Vec<&str> = Kind::ALL.iter().map(|(_, name, _)| *name).collect();
        if !known.contains(&name.as_str()) {
            return Err(Error::Usage(crate::reader::unknown("sampler", name, &known)));
        }
    }
    set("/sampler/type", args.sampler.clone());
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
fn attributes(entry: &Entry, settings: &Settings, report: &Report) -> Attributes {
    let sampler = Kind::ALL.iter().find(|(kind, ..)| *kind == settings.sampler.kind).map_or("", |(_, name, _)| name);
    let pairs = [
        ("pt/version", env!("CARGO_PKG_VERSION").to_owned()),
        ("pt/integrator", entry.name.to_owned()),
        ("pt/sampler", sampler.to_owned()),
        ("pt/seed", settings.sampler.seed.to_string()),
        ("pt/spp", report.samples.to_string()),
    ];
    pairs.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

fn summarise(spec: &FilmSpec, entry: &Entry, report: &Report, outputs: &[PathBuf]) {
    let size = spec.crop.size();
    let files = outputs.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    let seconds = report.elapsed.as_secs_f64();
    let what = format!("{}×{} · {} · {} spp · {seconds:.2} s", size.x, size.y, entry.name, report.samples);
    match (report.samples, report.cancelled) {
        (0, _) => note(&format!("{what} · interrupted before the first sample: nothing written")),
        (_, true) => note(&format!("{what} · interrupted · {files}")),
        (_, false) => note(&format!("{what} · {files}")),
    }
    if let Some(first) = report.first_invalid.first() {
        let (x, y) = first.pixel;
        note(&format!("warning: {} invalid samples counted as black; the first: --pixel {x},{y} --sample {}", report.invalid, first.index));
    }
}
