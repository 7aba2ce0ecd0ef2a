//! How many pixels are as far from the truth as their standard errors say: |z| < 1.96 for 95 % of them.

use pt::film::Image;
use pt::sampler::Kind;
use rayon::prelude::*;

use super::subject::Subject;
use super::{REFERENCE, Request, SAMPLERS, after, reference, small, taken};

pub const SCENES: [&str; 6] = ["cornell-box", "mirror-balls", "statue", "triangle-stacks", "matter", "lanterns"];
const SAMPLES: [u64; 2] = [64, 256];
/// Seeds that suffice: each has 48 × 36 pixels in three colours.
const MOST_SEEDS: u64 = 20;

pub fn print(request: &Request) -> pt::Result<()> {
    println!("| scene | spp | sampler | pixels within 1.96 σ | beyond 6 σ | Σ σ² / Σ (x − r)² |\n|---|---|---|---|---|---|");
    for name in request.scenes {
        let subject = small(name)?;
        let reference = reference(&subject, REFERENCE);
        for samples in SAMPLES {
            for kind in SAMPLERS {
                let [within, beyond, ratio] = shares(&subject, kind, samples, &reference, request.seeds.min(MOST_SEEDS));
                println!("| {name} | {samples} | {kind:?} | {:.1} % | {:.2} % | {ratio:.2} |", 100.0 * within, 100.0 * beyond);
            }
        }
    }
    println!();
    Ok(())
}

/// Share of the pixels within 1.96 σ, share of those beyond 6 σ, and Σ σ² / Σ (x − r)². Pixels without noise do not count.
fn shares(subject: &Subject, kind: Kind, samples: u64, reference: &Image, seeds: u64) -> [f64; 3] {
    let channels = ["R", "G", "B"];
    let deviations = |seed: u64| -> Vec<(f64, f64)> {
        let image = taken(subject, kind, 2, seed, &after(samples)).0.image();
        let channel = |image: &Image, name: &str| image.channel(name).expect("a channel").to_vec();
        let of = |name: &&str| {
            let error = format!("StdErr.{name}");
            let [x, r] = [&image, reference].map(|picture| channel(picture, name));
            let [own, other] = [&image, reference].map(|picture| channel(picture, &error));
            let one = move |i: usize| {
                let of_reference = f64::from(other[i]).powi(2);
                ((f64::from(x[i]) - f64::from(r[i])).powi(2) - of_reference, f64::from(own[i]).powi(2), of_reference)
            };
            (0..image.pixels().count()).map(one).collect::<Vec<_>>()
        };
        let all = channels.iter().flat_map(of).filter(|(square, own, _)| *own > 0.0 || *square > 0.0);
        all.map(|(square, own, other)| (square + other, own + other)).collect()
    };
    let all: Vec<(f64, f64)> = (0..seeds).into_par_iter().flat_map(deviations).collect();
    let share = |limit: f64, beyond: bool| {
        all.iter().filter(|(square, variance)| (*square > limit * limit * variance) == beyond).count() as f64 / all.len() as f64
    };
    let sum = |of: fn(&(f64, f64)) -> f64| all.iter().map(of).sum::<f64>();
    [share(1.96, false), share(6.0, true), sum(|p| p.1) / sum(|p| p.0)]
}
