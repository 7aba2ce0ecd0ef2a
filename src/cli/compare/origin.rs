//! Origin of a comparison: command, machine, seeds and hashes.

use std::path::Path;

use super::super::load::Loaded;
use super::super::quote::quoted;
use super::{Commands, CompareArgs, Provenance};
use crate::error::Result;
use crate::film::Image;
use crate::part::BUILD;

/// Collects what is known before the reference is.
pub fn provenance(args: &CompareArgs, loaded: &Loaded) -> Result<Provenance> {
    let arguments: Vec<String> = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let command: Vec<String> = std::iter::once("pt".to_owned()).chain(arguments.iter().map(|word| quoted(word))).collect();
    let seed = loaded.built.sampler.seed;
    Ok(Provenance {
        version: BUILD.into(),
        command: command.join(" "),
        arguments,
        folder: std::env::current_dir().map(|folder| folder.display().to_string()).unwrap_or_default(),
        cpu: cpu(),
        threads: rayon::current_num_threads(),
        seeds: (0..args.replicates).map(|replicate| seed.wrapping_add(1 + u64::from(replicate))).collect(),
        scene_hash: loaded.identity()?.hash().to_string(),
        reference_hash: String::new(),
    })
}

/// Commands for the conclusions.
pub fn commands(args: &CompareArgs, provenance: &Provenance, image: &Image, folder: &Path) -> Result<Commands> {
    let mut scene = vec![quoted(&args.scene.path()?.display().to_string())];
    scene.extend(args.scene.overrides.iter().map(|text| format!("-D {}", quoted(text))));
    scene.extend(args.scene.flags());
    let [width, height] = image.full_size.to_array();
    Ok(Commands {
        whole: provenance.command.clone(),
        scene: scene.join(" "),
        size: format!("--size {width}x{height}"),
        reference: quoted(&folder.join("reference.exr").display().to_string()),
    })
}

/// Name of the processor: that of Linux where there is one, and the architecture otherwise.
fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':')).map(|(_, name)| name.trim());
    let other = || format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    name.filter(|name| !name.is_empty()).map_or_else(other, str::to_owned)
}
