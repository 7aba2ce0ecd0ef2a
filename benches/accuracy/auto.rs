//! What `--integrator auto --sampler auto` costs beside the best fixed choice.
//!
//! Each choice is measured by time × relMSE, which does not depend on the number of samples where relMSE falls as 1/n. The best choice is found
//! afterwards, among all that the pilots could choose, so that noise favours it a little.

use std::process::Command;
use std::time::Duration;

use pt::film::Image;
use pt::measure::StopCondition;
use pt::sampler::Kind;

use super::share::Share;
use super::subject::Subject;
use super::{REFERENCE, Request, SAMPLERS, reference, relmse, taken};

/// Scenes whose own method shows the same picture as the others. (That of `postcard` shows another light.)
pub const SCENES: [&str; 11] = [
    "cornell-box",
    "mirror-balls",
    "statue",
    "triangle-stacks",
    "matter",
    "glass-panel",
    "metals",
    "lanterns",
    "reflections",
    "macro-lens",
    "fog",
];
const CHANGES: [(&str, &str); 2] = [("/film/width", "48"), ("/film/height", "36")];
/// Render time of each picture.
const TIME: Duration = Duration::from_millis(700);
/// Render time for which the pilot is counted (s).
const RENDER: f64 = 30.0;
/// Ratio that a choice may have.
const MOST: f64 = 1.1;

pub fn print(request: &Request) -> pt::Result<()> {
    // The default number of seeds is that of tables of shares.
    let seeds = request.seeds.min(6);
    println!("| scene | chosen | best | time × relMSE chosen / best | with the pilot, in {RENDER} s |");
    println!("|---|---|---|---|---|");
    let mut good = Share::default();
    for name in request.scenes {
        let told = Told::of(name);
        let reference = reference(&Subject::load(name, &CHANGES)?, REFERENCE);
        let mut costs = vec![];
        for integrator in &told.integrators {
            let subject = Subject::load_with(name, &CHANGES, integrator)?;
            for kind in SAMPLERS {
                costs.push(((integrator.clone(), kind.name().to_owned()), cost(&subject, kind, &reference, seeds)));
            }
        }
        let of = |choice: &(String, String)| costs.iter().find(|(name, _)| name == choice).map_or(f64::NAN, |(_, cost)| *cost);
        let (best, least) = costs.iter().min_by(|a, b| a.1.total_cmp(&b.1)).expect("a choice");
        let ratio = of(&told.chosen) / least;
        let whole = ratio * RENDER / (RENDER - told.pilot);
        good.count(whole <= MOST);
        let words = |(integrator, sampler): &(String, String)| format!("{integrator} · {sampler}");
        println!("| {name} | {} | {} | {ratio:.2} | {whole:.2} |", words(&told.chosen), words(best));
    }
    println!("\nWithin {MOST} of the best choice: {good} scenes.\n");
    Ok(())
}

/// Time × relMSE, the mean over some seeds.
fn cost(subject: &Subject, kind: Kind, reference: &Image, seeds: u64) -> f64 {
    let until = StopCondition { samples: u32::MAX.into(), time: Some(TIME), target: None, patience: None };
    let one = |seed: u64| {
        let scramblings = if subject.integrator.splats() { 8 } else { 2 };
        let (film, history) = taken(subject, kind, scramblings, seed, &until);
        history.last().map_or(f64::NAN, |last| last.seconds) * relmse(&film, reference)
    };
    (0..seeds).map(one).sum::<f64>() / seeds as f64
}

/// What the program says of its choice.
struct Told {
    /// Integrator and sampler.
    chosen: (String, String),
    /// All integrators that it tried.
    integrators: Vec<String>,
    /// Time of the pilots (s).
    pilot: f64,
}

impl Told {
    fn of(scene: &str) -> Told {
        let folder = tempfile::tempdir().expect("a folder");
        let file = format!("scenes/{scene}.json");
        let output = folder.path().join("x.pfm").display().to_string();
        let args = [&file, "-i", "auto", "--sampler", "auto", "--spp", "1", "--size", "48x36", "--progress", "none", "-o", &output];
        let run = Command::new(env!("CARGO_BIN_EXE_pt")).args(args).output().expect("pt runs");
        let text = String::from_utf8_lossy(&run.stderr).into_owned();
        let words = |flag: &str| {
            let rest = text.split(&format!("{flag} auto: ")).nth(1).unwrap_or_else(|| panic!("no {flag} in {text}"));
            rest.lines().next().unwrap_or_default().to_owned()
        };
        let first = |line: &str| line.split([';', ',', ' ']).next().unwrap_or_default().to_owned();
        let seconds = |line: &str| {
            let time = line.rsplit("(pilot of ").next().and_then(|rest| rest.strip_suffix(" s)"));
            time.and_then(|time| time.parse::<f64>().ok()).unwrap_or(0.0)
        };
        let [integrator, sampler] = ["--integrator", "--sampler"].map(words);
        let integrator = integrator.replace("found no light", "");
        let known = ["nee", "path", "light", "whitted", "card"];
        let is_told = |name: &&&str| integrator.split([' ', ';', ',']).any(|word| word == **name);
        Told {
            chosen: (first(&integrator), first(&sampler)),
            integrators: known.iter().filter(is_told).map(|name| (*name).to_owned()).collect(),
            pilot: seconds(&integrator) + seconds(&sampler),
        }
    }
}
