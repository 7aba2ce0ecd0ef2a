//! Origin of a comparison: command, machine, seeds and hashes.

use std::path::Path;

use super::super::load::Loaded;
use super::super::quote::quoted;
use super::{Commands, CompareArgs, Provenance};
use crate::error::Result;
use crate::film::Image;

/// Collects what is known before the reference is.
pub fn provenance(args: &CompareArgs, loaded: &Loaded) -> Result<Provenance> {
    let arguments: Vec<String> = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let command: Vec<String> = std::iter::once("pt".to_owned()).chain(arguments.iter().map(|word| quoted(word))).collect();
    Provenance::new(loaded, command.join(" "), arguments, args.replicates)
}

/// Commands for the conclusions.
pub fn commands(args: &CompareArgs, provenance: &Provenance, image: &Image, folder: &Path) -> Result<Commands> {
    let mut scene = vec![quoted(&args.scene.path()?.display().to_string())];
    scene.extend(args.scene.overrides.iter().map(|text| format!("-D {}", quoted(text))));
    scene.extend(args.scene.flags().iter().map(|word| quoted(word)));
    let [width, height] = image.full_size.to_array();
    Ok(Commands {
        whole: provenance.command.clone(),
        scene: scene.join(" "),
        size: format!("--size {width}x{height}"),
        reference: quoted(&folder.join("reference.exr").display().to_string()),
    })
}
