//! How often the stated 95 % interval contains the true relative error.

use pt::film::Image;
use pt::measure::{Distance, MostPixels, RelativeError};
use pt::sampler::Kind;
use rayon::prelude::*;

use super::share::{Share, chance_of_failures, median};
use super::subject::Subject;
use super::{REFERENCE, Request, SAMPLERS, after, reference, relmse, small, taken};

/// A room with a lamp, mirrors, small lamps in rough plates, a mesh, clear and rough glass, matte models, dozens of lamps, glossy metals, a
/// signed distance field, panes of glass, and an environment map. `caustic` is not among them: `nee` has no reference for it that is better
/// than the pictures. Nor are `macro-lens` and `fog`: hardly any picture of so few samples states an error.
pub const SCENES: [&str; 11] = [
    "cornell-box",
    "mirror-balls",
    "mis-plates",
    "statue",
    "triangle-stacks",
    "matter",
    "lanterns",
    "metals",
    "postcard",
    "glass-panel",
    "reflections",
];
pub const LARGE_SCENES: [&str; 2] = ["cornell-box", "statue"];
/// Samples per pixel at an early and at a late check of the error.
const SAMPLES: [u64; 2] = [64, 256];
/// Probability that any row is called too wrong although all intervals are right.
const RISK: f64 = 0.01;
/// One picture of so many is rendered without error bars too, to know what they cost.
const PLAIN: u64 = 4;
/// Number of samples of a large reference picture. Its variance is subtracted from the distances.
const LARGE_REFERENCE: u64 = 1 << 11;

pub fn print(request: &Request) -> pt::Result<()> {
    tabulate(request, &SAMPLES, &SAMPLERS, REFERENCE, small)
}

/// Pictures of 512 × 512 pixels: one sampler and one number of samples, since each takes as long as 150 small ones.
pub fn print_large(request: &Request) -> pt::Result<()> {
    let large = |name: &str| Subject::load(name, &[("/film/width", "512"), ("/film/height", "512")]);
    tabulate(request, &SAMPLES[..1], &[Kind::Sobol], LARGE_REFERENCE, large)
}

fn tabulate(
    request: &Request,
    samples: &[u64],
    samplers: &[Kind],
    of_reference: u64,
    load: impl Fn(&str) -> pt::Result<Subject>,
) -> pt::Result<()> {
    let (mut intervals, mut bounds, mut rows) = (Share::default(), Share::default(), vec![]);
    println!(
        "| scene | spp | sampler | error | stated / true | interval holds | bound of most pixels holds, median true / bound | relMSE of 2 scramblings / 1, a quarter of the pictures |\n\
         |---|---|---|---|---|---|---|---|"
    );
    for name in request.scenes {
        let subject = load(name)?;
        let reference = reference(&subject, of_reference);
        for &samples in samples {
            for &kind in samplers {
                let count = counted(&subject, kind, samples, &reference, request.seeds);
                println!("| {name} | {samples} | {kind:?} | {} |", count.row(request.seeds));
                intervals.add(count.interval);
                bounds.add(count.bound);
                rows.push((format!("{name} {samples} {kind:?}"), count.interval));
            }
        }
    }
    println!("\nThe interval holds in {intervals} pictures that state one: {}.", intervals.percent());
    println!("Where none is stated, the bound of most pixels holds in {bounds} pictures: {}.", bounds.percent());
    let seeds = request.seeds as u32;
    for (what, of_row) in
        [("all pictures", &(|_| seeds) as &dyn Fn(Share) -> u32), ("those that state an interval", &|interval: Share| interval.of)]
    {
        let too_wrong = |interval: Share| chance_of_failures(interval.of - interval.held, of_row(interval)) < RISK / rows.len() as f64;
        let names: Vec<String> = rows.iter().filter(|(_, interval)| too_wrong(*interval)).map(|(name, _)| name.clone()).collect();
        let names = if names.is_empty() { "none".into() } else { names.join(", ") };
        println!("Rows with more wrong intervals among {what} than 5 % and chance explain: {names}.");
    }
    println!();
    Ok(())
}

fn counted(subject: &Subject, kind: Kind, samples: u64, reference: &Image, seeds: u64) -> Count {
    let look = |seed: u64| {
        let (film, _) = taken(subject, kind, 2, seed, &after(samples));
        let is_plain = kind != Kind::Independent && seed.is_multiple_of(PLAIN);
        let plain = is_plain.then(|| relmse(&taken(subject, kind, 1, seed, &after(samples)).0, reference));
        let most = MostPixels::of(&film).map(|most| {
            let truth = Distance::without(&film.image(), reference, &most.aside).expect("a reference").relmse.max(0.0);
            (most.at_least(0.95), truth.sqrt())
        });
        (RelativeError::of(&film).expect("error bars"), most, relmse(&film, reference), plain)
    };
    let looks: Vec<_> = (0..seeds).into_par_iter().map(look).collect();
    let mut count = Count::default();
    for (error, most, truth, plain) in looks {
        count.square += truth;
        if let Some(plain) = plain {
            count.plain_square += plain;
            count.beside_plain += truth;
        }
        match (error.stated(0.95), most) {
            (Ok(stated), _) => {
                count.interval.count((stated.low..=stated.high).contains(&truth.sqrt()));
                count.stated_square += stated.value * stated.value;
                count.true_square += truth;
            }
            (Err(_), Some((at_least, truth))) => {
                count.bound.count(truth >= at_least);
                count.above_bound.push(truth / at_least);
            }
            (Err(_), None) => {}
        }
    }
    count
}

/// Comparison of stated and true errors over some seeds.
#[derive(Default)]
struct Count {
    /// Pictures that state an interval.
    interval: Share,
    /// Pictures that state a bound for most pixels.
    bound: Share,
    /// True errors of most pixels divided by their bounds.
    above_bound: Vec<f64>,
    stated_square: f64,
    /// Sum over the pictures that state an interval.
    true_square: f64,
    square: f64,
    /// Sum over pictures without error bars.
    plain_square: f64,
    /// Sum over the pictures of the same seeds with error bars.
    beside_plain: f64,
}

impl Count {
    fn row(&self, seeds: u64) -> String {
        let error = 100.0 * (self.square / seeds as f64).sqrt();
        let ratio = if self.interval.of > 0 { format!("{:.3}", (self.stated_square / self.true_square).sqrt()) } else { "–".into() };
        let cost = if self.plain_square > 0.0 { format!("{:.2}", self.beside_plain / self.plain_square) } else { "–".into() };
        let above = if self.bound.of > 0 { format!(", {:.2}", median(self.above_bound.clone())) } else { String::new() };
        format!("{error:.1} % | {ratio} | {} | {}{above} | {cost}", self.interval, self.bound)
    }
}
