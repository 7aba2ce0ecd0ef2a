//! `pt image average A B... -o OUT`: averages independent pictures of the same scene.

use std::path::{Path, PathBuf};

use crate::cli::note;
use crate::cli::outputs::{OutputKinds, check_outputs};
use crate::cli::tone_mapping::ToneMapping;
use crate::error::Result;
use crate::film::Image;
use crate::measure::{self, metric::Named};
use crate::output::{self, Attributes, Value};

#[derive(clap::Args, Debug)]
pub struct AverageArgs {
    /// Input files.
    #[arg(required = true, value_name = "FILE")]
    pub inputs: Vec<PathBuf>,
    /// Output file: .exr, .hdr, .png, .ppm or .pfm. May be repeated.
    #[arg(short, long, value_name = "OUT", required = true)]
    pub output: Vec<PathBuf>,
    #[command(flatten)]
    pub tone_mapping: ToneMapping,
}

/// Runs the command.
pub fn average(args: &AverageArgs) -> Result<()> {
    let inputs: Vec<&Path> = args.inputs.iter().map(PathBuf::as_path).collect();
    check_outputs(&args.output, OutputKinds::Pictures, &inputs, "is one of the inputs")?;
    let read: Vec<(Image, Attributes)> = inputs.iter().map(|path| output::read(path)).collect::<Result<_>>()?;
    let names: Vec<String> = inputs.iter().map(|path| path.display().to_string()).collect();
    let named: Vec<Named> = names.iter().zip(&read).map(|(name, (image, _))| Named { name, image }).collect();
    let mean = measure::average(&named)?;
    named.iter().for_each(warn_of_broken);
    warn_of_copies(&names, &read);
    let attributes = common(&read);
    args.output.iter().try_for_each(|path| output::write(path, &mean, &attributes, &args.tone_mapping.tonemap(&mean)))
}

fn warn_of_broken(picture: &Named) {
    let broken = picture.image.channels.iter().flat_map(|c| &c.values).filter(|v| !v.is_finite()).count();
    if broken > 0 {
        note(&format!("warning: {}: values that are not finite, here and in the mean: {broken}", picture.name));
    }
}

/// Warns about pictures made of the same random numbers: their mean is no better.
fn warn_of_copies(names: &[String], read: &[(Image, Attributes)]) {
    let numbers = |attributes: &Attributes| ["pt/seed", "pt/sampler", "pt/integrator"].map(|name| value(attributes, name).cloned());
    for (i, (_, later)) in read.iter().enumerate() {
        let copy = read[..i].iter().position(|(_, earlier)| numbers(later)[0].is_some() && numbers(earlier) == numbers(later));
        if let Some(k) = copy {
            note(&format!(
                "warning: {} and {} are made of the same random numbers (pt/seed): their mean is no more accurate",
                names[k], names[i]
            ));
        }
    }
}

fn value<'a>(attributes: &'a Attributes, name: &str) -> Option<&'a Value> {
    attributes.iter().find(|(other, _)| other == name).map(|(_, value)| value)
}

/// Attributes that all pictures share; the numbers of samples per pixel add up.
fn common(read: &[(Image, Attributes)]) -> Attributes {
    let first = read.first().map(|(_, attributes)| attributes.as_slice()).unwrap_or_default();
    let is_common = |name: &str, own: &Value| read.iter().all(|(_, other)| value(other, name) == Some(own));
    let joined = |(name, own): &(String, Value)| match name.as_str() {
        "pt/spp" => sum(read, name).map(|spp| spp.to_string().into()),
        "samplesPerPixel" => sum(read, name).and_then(|spp| spp.try_into().ok()).map(Value::Integer),
        _ => is_common(name, own).then(|| own.clone()),
    };
    first.iter().filter_map(|pair| Some((pair.0.clone(), joined(pair)?))).collect()
}

/// Sum of whole numbers; `None` unless all pictures have the attribute.
fn sum(read: &[(Image, Attributes)], name: &str) -> Option<u64> {
    read.iter().map(|(_, attributes)| value(attributes, name)?.to_string().parse::<u64>().ok()).sum()
}
