//! `pt image denoise IN --with COMMAND -o OUT`: has another program remove the noise of a picture.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use super::select_layer;
use crate::cli::note;
use crate::cli::outputs::{OutputKinds, check_outputs};
use crate::cli::tone_mapping::ToneMapping;
use crate::error::{Error, Fault, Result};
use crate::film::{Channel, Image};
use crate::output::{self, Attributes, Pick, attributes};

#[derive(clap::Args, Debug)]
pub struct DenoiseArgs {
    /// Input file. An EXR with the layers Albedo and N (`pt scene.json --aov albedo,n`) keeps its edges and textures better.
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// The program, with its arguments. {color}, {albedo}, {normal} and {output} stand for PFM files. Without any of them, the arguments of
    /// Open Image Denoise are added: --hdr {color} --alb {albedo} --nrm {normal} -o {output}.
    #[arg(long, value_name = "COMMAND", required = true)]
    with: String,
    /// Output file: .exr, .hdr, .png, .ppm or .pfm. May be repeated.
    #[arg(short, long, value_name = "OUT", required = true)]
    pub output: Vec<PathBuf>,
    #[command(flatten)]
    pub tone_mapping: ToneMapping,
}

/// Layers that denoisers use, with the word for each in the command and its argument for Open Image Denoise.
const LAYERS: [(&str, &str, &str); 2] = [("Albedo", "{albedo}", "--alb"), ("N", "{normal}", "--nrm")];

/// Runs the command. The result has the colours of the program. Standard errors and sample counts are left out, because they are those of
/// the noisy picture.
pub fn denoise(args: &DenoiseArgs) -> Result<()> {
    check_outputs(&args.output, OutputKinds::Pictures, &[&args.input], "is the input")?;
    if split(&args.with)?.is_empty() {
        return Err(no_program());
    }
    let (all, attributes) = output::read(&args.input)?;
    let color = select_layer(&Pick::Colour, &all, &args.input)?;
    let broken = color.channels.iter().flat_map(|channel| &channel.values).filter(|value| !value.is_finite()).count();
    if broken > 0 {
        let message = format!("{broken} values are not finite, and a denoiser would spread them");
        return Err(Error::invalid(Fault::new(message).in_file(args.input.display().to_string())));
    }
    let folder = tempfile::tempdir().map_err(|e| Error::io("a folder for temporary files", e))?;
    let result = run(&args.with, &color, &all, folder.path())?;
    let denoised = with_colors(&all, &result);
    let attributes = void(attributes, &args.with);
    for path in &args.output {
        output::write(path, &denoised, &attributes, &args.tone_mapping.tonemap(&denoised))?;
    }
    note("denoised: the colours are a guess of the program, and no error is known of them; standard errors are left out");
    Ok(())
}

/// The words of a command, as a shell separates them.
fn split(command: &str) -> Result<Vec<String>> {
    shlex::split(command).ok_or_else(|| Error::Usage(format!("--with: a quote is not closed in {command:?}")))
}

fn no_program() -> Error {
    Error::Usage("--with: expected a program".to_owned())
}

/// Runs the program on a picture and reads its result.
///
/// - `folder`: for the files that it reads and writes
fn run(command: &str, color: &Image, all: &Image, folder: &Path) -> Result<Image> {
    let write = |name: &str, image: &Image| {
        let path = folder.join(name);
        output::write(&path, image, &vec![], &Default::default()).map(|()| path)
    };
    let mut files = vec![("{color}", Some(write("color.pfm", color)?))];
    for (layer, word, _) in LAYERS {
        let file = Pick::Layer(layer.to_owned()).of(all).ok().map(|image| write(&format!("{layer}.pfm"), &image)).transpose()?;
        if file.is_none() && command.contains(word) {
            let message = format!("no layer {layer}, which {word} asks for: render with --aov albedo,n");
            return Err(Error::invalid(Fault::new(message)));
        }
        files.push((word, file));
    }
    let made = folder.join("denoised.pfm");
    files.push(("{output}", Some(made.clone())));
    let missing: Vec<&str> =
        LAYERS.iter().zip(&files[1..]).filter(|(_, (_, file))| file.is_none()).map(|((layer, ..), _)| *layer).collect();
    let line = match files.iter().any(|(word, _)| command.contains(word)) {
        true => command.to_owned(),
        false => {
            if !missing.is_empty() {
                note(&format!("no layer {}: edges and textures may blur; render with --aov albedo,n", missing.join(", no layer ")));
            }
            let guides =
                LAYERS.iter().filter(|(layer, ..)| !missing.contains(layer)).map(|(_, word, argument)| format!(" {argument} {word}"));
            format!("{command} --hdr {{color}}{} -o {{output}}", guides.collect::<String>())
        }
    };
    let words = split(&line)?;
    let paths = files.iter().filter_map(|(word, file)| Some((*word, file.as_ref()?.to_str()?)));
    let words: Vec<String> =
        words.iter().map(|text| paths.clone().fold(text.clone(), |text, (word, path)| text.replace(word, path))).collect();
    let Some((program, arguments)) = words.split_first() else { return Err(no_program()) };
    let output = Command::new(program).args(arguments).stdin(Stdio::null()).output().map_err(|e| Error::io(program, e))?;
    if !output.status.success() {
        return Err(Error::io(program, std::io::Error::other(failure(&output))));
    }
    let result = output::read(&made).map(|(image, _)| image);
    let result = result.map_err(|_| Error::io(program, std::io::Error::other("it wrote no picture to {output}")))?;
    let same = result.size == color.size && result.channels.iter().flat_map(|channel| &channel.values).all(|value| value.is_finite());
    let message = "its picture has another size, or values that are not finite";
    if same { Ok(result) } else { Err(Error::io(program, std::io::Error::other(message))) }
}

/// Says how the program ended, with the last line of what it printed.
fn failure(output: &Output) -> String {
    let text = String::from_utf8_lossy(if output.stderr.is_empty() { &output.stdout } else { &output.stderr }).into_owned();
    let last = text.lines().rev().find(|line| !line.trim().is_empty()).map(|line| format!(": {}", line.trim()));
    format!("it ended with {}{}", output.status, last.unwrap_or_default())
}

/// The picture with other colours, and without what is known of its noise.
fn with_colors(all: &Image, result: &Image) -> Image {
    let is_void = |name: &str| ["StdErr.", "SampleCount.", "Time."].iter().any(|layer| name.starts_with(layer));
    let is_color = |name: &str| ["R", "G", "B"].contains(&name);
    let kept = all.channels.iter().filter(|channel| !is_void(&channel.name) && !is_color(&channel.name)).cloned();
    let colors = ["R", "G", "B"].map(|name| Channel { name: name.into(), values: result.channel(name).unwrap_or_default().to_vec() });
    Image { channels: colors.into_iter().chain(kept).collect(), ..*all }
}

/// Beginnings of the names of attributes about the error.
const VOID: [&str; 4] = ["pt/relativeError", "pt/mostPixels", "pt/confidence", "pt/standardErrorFreedom"];

/// The attributes without those about the error, and with the reason.
fn void(attributes: Attributes, command: &str) -> Attributes {
    let kept = attributes.into_iter().filter(|(name, _)| !VOID.iter().any(|about| name.starts_with(about)));
    let reason = (attributes::REFUSED.to_owned(), "the picture was denoised".into());
    kept.chain([reason, ("pt/denoisedWith".to_owned(), command.into())]).collect()
}
