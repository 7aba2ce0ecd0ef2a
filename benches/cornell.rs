//! Speed of the Cornell box at 512², 64 samples per pixel, max_depth 7, per CPU second.
//!
//! `cargo bench --bench cornell [-- SPP]`. Rates are per second of CPU time, so that a busy machine
//! disturbs them less; quote ratios within one run.

use std::sync::Arc;

use cpu_time::ProcessTime;
use pt::build::Source;
use pt::describe::{self, Files};
use pt::film::MomentFilm;
use pt::integrator::choose;
use pt::render::{Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;

fn main() -> pt::Result<()> {
    let spp = std::env::args().filter_map(|arg| arg.parse().ok()).next().unwrap_or(64);
    let file = "scenes/cornell-box.json";
    let bytes = std::fs::read(file).map_err(|e| pt::Error::io(file, e))?;
    let root = describe::root(&bytes, file)?;
    let built = pt::build::build(&describe::read(&root, file)?, Source { root: &root, file, files: &Files::within("scenes") })?;
    let scene: Arc<dyn Scene> = Arc::new(built.world);
    let cpu_seconds = |name: &str, kind: Kind, threads: usize| -> pt::Result<f64> {
        let (_, integrator) = choose(&[pt::integrators::ALL], root.child("integrator"), Some(name), file)?;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let settings = Settings::new(SamplerSpec { kind, spp, ..built.sampler });
        let mut film = MomentFilm::new(built.film.clone());
        let start = ProcessTime::now();
        pool.install(|| render(scene.clone(), &*integrator, &mut film, &settings, &Silent));
        Ok(start.elapsed().as_secs_f64())
    };
    let samples = (built.film.crop.pixel_count() * spp) as f64;
    println!("Cornell box, {} × {}, {spp} spp, max_depth 7", built.film.size.x, built.film.size.y);
    for (kind, sampler, _) in Kind::ALL {
        let seconds = cpu_seconds("nee", *kind, 1)?;
        println!("nee, {sampler:12} {:6.3} M camera samples per CPU second", samples / seconds * 1e-6);
    }
    for name in ["path", "whitted"] {
        let seconds = cpu_seconds(name, Kind::Independent, 1)?;
        println!("{name:7}, independent {:6.3} M camera samples per CPU second", samples / seconds * 1e-6);
    }
    let (one, two) = (cpu_seconds("nee", Kind::Independent, 1)?, cpu_seconds("nee", Kind::Independent, 2)?);
    println!("two threads take {:.3} × the CPU time of one", two / one);
    Ok(())
}
