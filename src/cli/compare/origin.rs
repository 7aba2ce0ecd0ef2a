//! Origin of a comparison: command, machine, seeds and hashes.

use std::path::Path;

use super::super::load::Loaded;
use super::super::quote::quoted;
use super::scenes::OtherScene;
use super::{CompareArgs, Provenance};
use crate::compare::Commands;
use crate::error::Result;
use crate::film::Image;

/// Collects what is known before the reference is.
///
/// - `others`: the further scenes
pub fn provenance(args: &CompareArgs, loaded: &Loaded, others: &[OtherScene]) -> Result<Provenance> {
    let arguments: Vec<String> = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let command: Vec<String> = std::iter::once("pt".to_owned()).chain(arguments.iter().map(|word| quoted(word))).collect();
    let mut provenance = Provenance::new(loaded, command.join(" "), arguments, args.replicates)?;
    for other in others {
        provenance.scene_hash += &format!(", {}", other.loaded.identity()?.hash());
    }
    Ok(provenance)
}

/// Commands for the conclusions.
pub fn commands(args: &CompareArgs, provenance: &Provenance, image: &Image, folder: &Path) -> Result<Commands> {
    let overrides = args.scene.overrides.iter().map(|text| format!("-D {}", quoted(text)));
    let options: Vec<String> = overrides.chain(args.scene.flags().iter().map(|word| quoted(word))).collect();
    let [width, height] = image.full_size.to_array();
    Ok(Commands {
        whole: provenance.command.clone(),
        scene: quoted(&args.scene.path()?.display().to_string()),
        options: options.join(" "),
        size: format!("--size {width}x{height}"),
        reference: quoted(&folder.join("reference.exr").display().to_string()),
    })
}
