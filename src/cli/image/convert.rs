//! `pt image convert IN -o OUT`: another format, or one layer alone.

use super::args::Convert;
use super::only;
use crate::cli::outputs::{Takes, check_outputs};
use crate::error::Result;
use crate::output::{self, Format, Pick};

/// An EXR to an EXR keeps all channels unless a layer is picked; all other formats have room for red, green and blue.
pub fn convert(args: &Convert) -> Result<()> {
    check_outputs(&args.output, Takes::Pictures, &[&args.input], "is the input")?;
    let pick = args.layer.pick();
    let (all, attributes) = output::read(&args.input)?;
    for path in &args.output {
        let keeps_all = Format::of(path) == Some(Format::Exr) && pick == Pick::Colour;
        let image = if keeps_all { all.clone() } else { only(&pick, &all, &args.input)? };
        output::write(path, &image, &attributes, &args.develop.tonemap(&image))?;
    }
    Ok(())
}
