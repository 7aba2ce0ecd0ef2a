//! relMSE, and time × relMSE, of adaptive samples over those of as many uniform ones.

use pt::film::MomentFilm;
use pt::measure::RelativeError;
use pt::measure::adaptive::pilot_allocation;
use pt::render::{Settings, Silent};
use pt::sampler::{Kind, SamplerSpec};

use super::share::Share;
use super::{REFERENCE, Request, after, reference, rounds, small, taken};

pub const SCENES: [&str; 6] = ["cornell-box", "mirror-balls", "mis-plates", "statue", "triangle-stacks", "matter"];
/// Samples per pixel on average.
const SAMPLES: u64 = 256;
const MOST_SEEDS: u64 = 16;

pub fn print(request: &Request) -> pt::Result<()> {
    let seeds = request.seeds.min(MOST_SEEDS);
    println!("| scene | relMSE adaptive / even | time × relMSE adaptive / even | interval holds, adaptive |\n|---|---|---|---|");
    for name in request.scenes {
        let mut subject = small(name)?;
        let even = subject.spec.clone();
        let reference = reference(&subject, REFERENCE);
        let relmse = |film: &MomentFilm| super::relmse(film, &reference);
        let (mut errors, mut seconds, mut share) = ([0.0; 2], [0.0; 2], Share::default());
        for seed in 0..seeds {
            subject.spec = even.clone();
            let (film, history) = taken(&subject, Kind::Sobol, 2, seed, &after(SAMPLES));
            errors[0] += relmse(&film);
            seconds[0] += history.last().map_or(0.0, |last| last.seconds);
            let settings = Settings::new(SamplerSpec { kind: Kind::Sobol, seed, spp: SAMPLES, scramblings: 2 });
            let (allocation, explored) = pilot_allocation(&subject.scene, &*subject.integrator, &even, &settings, SAMPLES, &Silent);
            subject.spec.allocation = allocation;
            let (film, history) = taken(&subject, Kind::Sobol, 2, seed, &after(rounds(SAMPLES, &subject.spec)));
            errors[1] += relmse(&film);
            seconds[1] += history.last().map_or(0.0, |last| last.seconds) + explored.as_secs_f64();
            if let Some(Ok(stated)) = RelativeError::of(&film).map(|error| error.stated(0.95)) {
                share.count((stated.low..=stated.high).contains(&relmse(&film).sqrt()));
            }
        }
        let (error, cost) = (errors[1] / errors[0], errors[1] * seconds[1] / (errors[0] * seconds[0]));
        println!("| {name} | {error:.2} | {cost:.2} | {share} |");
    }
    println!();
    Ok(())
}
