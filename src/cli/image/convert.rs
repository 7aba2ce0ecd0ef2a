//! `pt image convert IN -o OUT`: converts to another format, or extracts a layer.

use super::LayerArgs;
use super::select_layer;
use crate::cli::outputs::{OutputKinds, check_outputs};
use crate::cli::tone_mapping::ToneMapping;
use crate::error::Result;
use crate::output::{self, Format, Pick};
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct ConvertArgs {
    /// Input file.
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Output file: .exr, .hdr, .png, .ppm or .pfm. May be repeated.
    #[arg(short, long, value_name = "OUT", required = true)]
    pub output: Vec<PathBuf>,
    #[command(flatten)]
    pub layer: LayerArgs,
    #[command(flatten)]
    pub tone_mapping: ToneMapping,
}

/// Runs the command. An EXR keeps all its channels in another EXR unless a layer is selected; other formats hold red, green and
/// blue only.
pub fn convert(args: &ConvertArgs) -> Result<()> {
    check_outputs(&args.output, OutputKinds::Pictures, &[&args.input], "is the input")?;
    let pick = args.layer.pick();
    let (all, attributes) = output::read(&args.input)?;
    for path in &args.output {
        let keeps_all = Format::of(path) == Some(Format::Exr) && pick == Pick::Colour;
        let image = if keeps_all { all.clone() } else { select_layer(&pick, &all, &args.input)? };
        output::write(path, &image, &attributes, &args.tone_mapping.tonemap(&image))?;
    }
    Ok(())
}
