//! `--pixel`: computes and prints one pixel, or one sample of it.

use std::sync::Arc;

use crate::cli::load::Loaded;
use crate::cli::print_stdout;
use crate::cli::stats::TextOrJson;
use crate::cli::trace::{self, Trace};
use crate::error::{Error, Result};
use crate::film::{Crop, FilmSpec, MomentFilm};
use crate::recorder::Event;
use crate::render::{self, Render, SampleId, Settings};
use crate::scene::Scene;

/// Plan for one pixel.
pub struct PixelPlan {
    /// The pixel.
    pub pixel: (u32, u32),
    /// The only sample to compute; `None` for all.
    pub sample: Option<u64>,
    /// Format of the paths of the sample, if they are to be printed.
    pub trace: Option<TextOrJson>,
    /// Limit of the radiance of indirect contributions.
    pub clamp: Option<f32>,
}

/// Computes and prints one pixel, or one sample of it.
pub fn pixel(plan: &PixelPlan, loaded: Loaded) -> Result<()> {
    let (x, y) = plan.pixel;
    let Loaded { world, film, sampler, names, integrator, .. } = loaded;
    let settings = Settings { clamp: plan.clamp, ..Settings::new(sampler) };
    if x >= film.size.x || y >= film.size.y {
        return Err(Error::Usage(format!("--pixel {x},{y}: the picture is {} × {}", film.size.x, film.size.y)));
    }
    let origin = world.origin();
    let scene: Arc<dyn Scene> = world;
    if let Some(index) = plan.sample {
        let (id, render) = (SampleId { pixel: (x, y), index }, Render::new(scene.clone(), &*integrator, &film, &settings));
        let mut events: Vec<Event> = vec![];
        let (value, splats) = render.replay_with_splats(id, plan.trace.is_some().then_some(&mut events));
        let Some(form) = plan.trace else {
            let [r, g, b] = value.to_rgb();
            let splats: String = splats.iter().map(|splat| format!("  + {}\n", trace::splatted(splat))).collect();
            return print_stdout(&format!("pixel {x},{y} sample {index}: {r:?} {g:?} {b:?}\n{splats}"));
        };
        let (camera, integrator) = (render.camera(id), loaded.entry.name);
        let trace = Trace { integrator, id, camera, value, events: &events, names: &names, lights: scene.lights(), origin };
        return print_stdout(&trace.print(form));
    }
    let min = glam::UVec2::new(x, y);
    let mut film = MomentFilm::new(FilmSpec { crop: Crop { min, max: min + 1 }, ..film.without_layers() });
    render::render(scene, &*integrator, &mut film, &settings, &render::Silent);
    let image = film.image();
    let [r, g, b] = image.rgb(0, 0);
    let error = image.channel("StdErr.R").map(|_| {
        let [r, g, b] = ["StdErr.R", "StdErr.G", "StdErr.B"].map(|name| image.channel(name).map_or(0.0, |c| c[0]));
        format!("  standard error {r:?} {g:?} {b:?}")
    });
    print_stdout(&format!("pixel {x},{y} of {} samples: {r:?} {g:?} {b:?}{}\n", film.samples(), error.unwrap_or_default()))
}
