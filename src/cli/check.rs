//! `pt check SCENE`: validates a scene, and lists its content and the effects it needs. With `--measure` it measures them too.

use std::time::Duration;

use super::load::SceneArgs;
use super::load::{Loaded, load};
use super::messages::broken;
use super::parse::{duration as parse_duration, threads};
use super::{effects, print_stdout, signals};
use crate::describe;
use crate::effects::Effects;
use crate::error::Result;
use crate::error::text::one_line;
use crate::integrator::Entry;
use crate::measure::effects::{Extent, measure_effects};
use crate::scene::Scene;
use crate::world::World;

#[derive(clap::Args, Debug)]
pub struct CheckArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The integrator to check the scene for; default: the scene's.
    #[arg(short, long, value_name = "NAME")]
    pub integrator: Option<String>,
    /// Measure for this long, such as 5s, what each effect holds of the light, the noise and the time, and what leaving it out would change.
    #[arg(long, value_name = "DURATION", value_parser = parse_duration)]
    pub measure: Option<Duration>,
    /// Print what was measured, and nothing else, as one JSON object.
    #[arg(long, requires = "measure")]
    pub json: bool,
    /// Number of threads of the measurement. Default: all cores.
    #[arg(short, long, env = "PT_THREADS", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<u32>,
}

/// Runs the command.
pub fn check(args: &CheckArgs, tables: &[&[Entry]]) -> Result<()> {
    let loaded = load(&args.scene, &[], args.integrator.as_deref(), tables)?;
    let mut text = format!("{}: valid\n\n{}", describe::name(args.scene.path()?), contents(&loaded));
    for warning in &loaded.warnings {
        text += &format!("\nwarning: {warning}");
    }
    let Some(time) = args.measure else { return print_stdout(&text) };
    signals::catch()?;
    let report = effects::finished(measure_effects(&loaded, tables, Extent::Time(time), &effects::Interrupts)?)?;
    print_stdout(&if args.json { effects::as_json(&report) } else { format!("{text}\n{}", effects::text(&report)) })
}

/// Returns what is in the scene, which effects it needs and which parts need them. `--verbose` prints it too.
pub fn contents(loaded: &Loaded) -> String {
    let size = loaded.film.size;
    let mut text = format!(
        "film        {} × {}, {} samples per pixel\nintegrator  {}: {}\n\
         shapes      {}, {} primitives in all{}\nmaterials   {} named\nlights      {}\n",
        size.x,
        size.y,
        loaded.sampler.spp,
        loaded.entry.name,
        loaded.entry.about,
        loaded.world.shapes().len(),
        loaded.world.primitive_count(),
        instances(&loaded.world),
        loaded.description.materials.len(),
        lights(&loaded.world),
    );
    let effects = loaded.world.effects();
    text += "\ncalled for\n";
    for effect in effects.iter() {
        text += &line(effect, &needed_by(&loaded.needs, effect), loaded.entry.simulates);
    }
    let off = format!("  {}", Effects::ALL - effects);
    text + &format!("\nnot called for, and off\n{}\n", broken(&off, ",", COLUMNS))
}

/// Width of the list of effects.
const COLUMNS: usize = 80;

/// Number of lights, and of those that emit nothing, if there are any.
fn lights(world: &World) -> String {
    let (count, black) = (world.lights().len(), world.lights().black_count());
    if black == 0 { count.to_string() } else { format!("{}, and {black} that emit nothing", count - black) }
}

/// Number of instances, if there are any.
fn instances(world: &World) -> String {
    match world.instance_count() {
        0 => String::new(),
        count => format!(", {count} instances"),
    }
}

/// Line of an effect: the parts that need it, its cost, and whether the integrator simulates it.
fn line(effect: Effects, needed_by: &[&str], simulates: Effects) -> String {
    const SHOWN: usize = 4;
    let more = needed_by.len().saturating_sub(SHOWN);
    let mut who = needed_by[..needed_by.len() - more].iter().map(|name| one_line(name)).collect::<Vec<_>>().join("; ");
    if more > 0 {
        who += &format!("; and {more} more");
    }
    let lacks = if simulates.contains(effect) { "" } else { "\n      NOT SIMULATED by this integrator: the picture will lack it" };
    format!("  {effect}\n      by    {who}\n      costs {}{lacks}\n", effect.cost())
}

fn needed_by(needs: &[(String, Effects)], effect: Effects) -> Vec<&str> {
    needs.iter().filter(|(_, needed)| needed.contains(effect)).map(|(name, _)| name.as_str()).collect()
}
