//! Do error bars and prices keep their word? The tables of docs/accuracy.md.
//!
//! `cargo bench --bench accuracy [-- SEEDS]`, 100 seeds without. Six scenes, three samplers each:
//!
//! - coverage: how often the interval of 95 % that a render states holds its true relative error
//! - price: the time foretold for 1 % by a short pilot, over the time that 1 % then takes
//! - cost: relMSE with two scramblings over relMSE with one, which is the ratio of time × relMSE: a sample takes as long

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use pt::describe::{self, Source};
use pt::film::{FilmSpec, MomentFilm};
use pt::integrator::{Integrator, choose};
use pt::measure::{Course, Distance, RelativeError, Until, follow};
use pt::render::{Render, Settings, Silent};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;

const SCENES: [&str; 6] = ["cornell-box", "mirror-balls", "mis-plates", "statue", "triangle-stacks", "matter"];
const SAMPLERS: [Kind; 3] = [Kind::Independent, Kind::Halton, Kind::Sobol];
const SAMPLES: u64 = 64;

struct Subject {
    scene: Arc<dyn Scene>,
    integrator: Box<dyn Integrator>,
    spec: FilmSpec,
}

impl Subject {
    fn load(name: &str) -> pt::Result<Subject> {
        let file = format!("scenes/{name}.json");
        let mut root = describe::load(Path::new(&file))?;
        for (pointer, value) in [("/film/width", "48"), ("/film/height", "36")] {
            root.set(pointer, value)?;
        }
        let described = describe::read(&root, &file)?;
        let built = describe::build(&described, Source { root: &root, file: &file, folder: Path::new("scenes"), allow_outside: false })?;
        let (_, integrator) = choose(&[pt::integrators::ALL], root.child("integrator"), Some("nee"), &file)?;
        Ok(Subject { scene: Arc::new(built.world), integrator, spec: built.film })
    }

    fn taken(&self, kind: Kind, scramblings: u32, seed: u64, until: &Until) -> (MomentFilm, Course) {
        let settings = Settings::new(SamplerSpec { kind, seed, spp: until.samples, scramblings });
        let mut film = MomentFilm::new(self.spec.clone());
        let mut render = Render::new(self.scene.clone(), &*self.integrator, &self.spec, &settings);
        let course = follow(&mut render, &mut film, until, &Silent);
        (film, course)
    }
}

fn main() -> pt::Result<()> {
    let seeds: u64 = std::env::args().filter_map(|arg| arg.parse().ok()).next().unwrap_or(100);
    let short = Until { samples: SAMPLES, time: None, target: None };
    println!(
        "| scene | sampler | error | interval holds | price foretold / taken | relMSE of 2 scramblings / 1 |\n|---|---|---|---|---|---|"
    );
    for name in SCENES {
        let subject = Subject::load(name)?;
        let (reference, _) = subject.taken(Kind::Sobol, 8, u64::MAX, &Until { samples: 128 * SAMPLES, ..short });
        let reference = reference.image();
        for kind in SAMPLERS {
            let (mut held, mut squares) = (0, [0.0; 2]);
            let mut error = 0.0;
            for seed in 0..seeds {
                let (film, _) = subject.taken(kind, 2, seed, &short);
                let stated = RelativeError::of(&film).expect("error bars");
                let truth = Distance::between(&film.image(), &reference).expect("a reference").relmse.max(0.0).sqrt();
                let [low, high] = stated.interval(0.95);
                held += u64::from((low..=high).contains(&truth));
                error += stated.value / seeds as f64;
                squares[0] += truth * truth;
                if kind != Kind::Independent {
                    let (plain, _) = subject.taken(kind, 1, seed, &short);
                    squares[1] += Distance::between(&plain.image(), &reference).expect("a reference").relmse;
                }
            }
            let cost = if squares[1] > 0.0 { format!("{:.2}", squares[0] / squares[1]) } else { "–".into() };
            println!(
                "| {name} | {kind:?} | {:.1} % | {:.0} % | {} | {cost} |",
                100.0 * error,
                100.0 * held as f64 / seeds as f64,
                price(&subject, kind)
            );
        }
    }
    Ok(())
}

/// Foretold by a pilot of a second, over what it takes.
fn price(subject: &Subject, kind: Kind) -> String {
    const TARGET: f64 = 0.01;
    let pilot = Until { samples: u32::MAX.into(), time: Some(Duration::from_secs(1)), target: None };
    let (_, course) = subject.taken(kind, 2, 1, &pilot);
    let Some(price) = course.price(TARGET, 0.95) else { return "cannot be established".into() };
    // As long as foretold and half as long again, then where the course crosses the target.
    let long = Until { time: Some(Duration::from_secs_f64(1.5 * price.seconds)), ..pilot };
    let (_, course) = subject.taken(kind, 2, 2, &long);
    let taken = course.price(TARGET, 0.95).map(|_| crossing(&course, TARGET));
    taken.flatten().map_or("not reached".into(), |taken| format!("{:.2}", price.seconds / taken))
}

/// When the error fell below the target, between checkpoints by the power law that joins them.
fn crossing(course: &Course, target: f64) -> Option<f64> {
    let points: Vec<(f64, f64)> = course.checkpoints.iter().filter_map(|c| c.error.map(|e| (c.seconds.ln(), e.value.ln()))).collect();
    let goal = target.ln();
    let pair = points.windows(2).find(|pair| pair[0].1 > goal && pair[1].1 <= goal)?;
    let share = (pair[0].1 - goal) / (pair[0].1 - pair[1].1);
    Some((pair[0].0 + share * (pair[1].0 - pair[0].0)).exp())
}
