//! What can be said on the command line.

use std::fmt::Display;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use clap::{Parser, Subcommand, ValueEnum};

use super::image::args::Verb;
use crate::error::{Error, Result};
use crate::film::Image;
use crate::import::{Framing, Up, Viewpoint};
use crate::output;

const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("PT_BUILD_ID"), ")");

/// A physically based renderer that shows what accuracy costs in time.
#[derive(Parser, Debug)]
#[command(name = "pt", version = VERSION, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Args {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub render: Render,
    /// Errors as one JSON object on stderr.
    #[arg(long, global = true)]
    pub json_errors: bool,
    /// Say nothing but errors and what was asked for: no notes, no warnings, no progress.
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

#[derive(Subcommand, Debug)]
pub enum Command {
    /// Validate a scene without rendering; say what it contains and which effects it calls for.
    Check(Check),
    /// What there is to choose from, with one line each.
    List {
        /// Only these.
        what: Option<Family>,
    },
    /// Write a scene of another program, or one with -D, in pt's own format; what is changed or left out is said.
    Convert(Convert),
    /// The JSON Schema of the scene format, on stdout.
    Schema(Schema),
    /// Whether two integrators, or an integrator and a picture, converge to the same picture: exit code 0 yes, 1 no, 7 no telling.
    Verify(Verify),
    /// What accuracy costs in time: several methods on one scene, measured at doubling checkpoints, told in a report.
    Compare(Compare),
    /// Add parts of a render (.ptc), in any order, to the picture of the whole: the same bits as in one go.
    Merge(Merge),
    /// A picture to measure others by, its own error stated; kept by scene, and made better when more is asked.
    Reference(Reference),
    /// Points of warps and samplers, and how a material scatters, as numbers and pictures. Without arguments: what there is.
    Sample(Sample),
    /// Compare, look into and convert pictures: .exr, .png, .ppm, .pfm, and .jpg to read.
    Image {
        #[command(subcommand)]
        verb: Verb,
    },
    /// What a shell needs to complete commands and options, on stdout: `pt completions bash > ~/.local/share/bash-completion/completions/pt`.
    Completions { shell: Shell },
    /// The manual page, or that of a command, on stdout: `pt man | man -l -`.
    Man {
        /// The command whose page is shown, such as compare.
        command: Option<String>,
    },
}

#[derive(clap::Args, Debug)]
pub struct Convert {
    #[command(flatten)]
    pub scene: Scene,
    /// Where the scene goes: .json. Files that came with it go into a folder beside it, others stay where they are.
    #[arg(value_name = "OUT", required = true)]
    pub output: PathBuf,
}

#[derive(clap::Args, Debug)]
pub struct Sample {
    /// A warp or a sampler, or `material`, or a file of tests (.json) as the courses of dirt and darts have them.
    #[arg(value_name = "WARP")]
    pub what: Option<String>,
    /// With `material`: which.
    #[arg(value_name = "SCENE#NAME")]
    pub scene: Option<String>,
    /// How many points.
    #[arg(short = 'n', long, default_value_t = 1000, value_parser = whole(1_u32, 10_000_000), allow_negative_numbers = true)]
    pub count: u32,
    /// Where the points go: .csv, .png or .svg; default: CSV to stdout. With `material` what its three pictures' names begin with,
    /// with tests what goes before the names of theirs.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Where the random numbers of a warp come from: see `pt list samplers`.
    #[arg(long, value_name = "NAME")]
    pub sampler: Option<String>,
    /// Which random numbers.
    #[arg(long, default_value_t = 1, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    pub seed: u64,
    /// n of cosine-power.
    #[arg(long, value_name = "N", default_value = "20", value_parser = exponent)]
    pub exponent: f32,
    /// The half angle of a cone, in degrees.
    #[arg(long, value_name = "DEGREES", default_value = "30", value_parser = cone)]
    pub angle: f64,
    /// Of spherical-triangle and spherical-rectangle: three corners as seen from the origin, such as '1,0,0 0,1,0 0,0,1'. The right
    /// angle of a rectangle is at the first.
    #[arg(long, value_name = "A B C", default_value = "-1,-1,0.7 1,-1,0.7 -1,1,0.7", value_parser = corners, allow_hyphen_values = true)]
    pub corners: [[f32; 3]; 3],
    /// Of visible normals: the roughness α of the facets, along x and along y or the same for both.
    #[arg(long, value_name = "X[,Y]", default_value = "0.5", value_parser = alpha, allow_hyphen_values = true)]
    pub alpha: [f32; 2],
    /// With `material` and of visible normals: the angle from the normal (beyond 90 it is below the surface) and the azimuth, in
    /// degrees.
    #[arg(long, value_name = "THETA,PHI", default_value = "30,0", value_parser = angles, allow_hyphen_values = true)]
    pub wo: [f64; 2],
    /// Instead of points: whether the directions of a warp follow the density that they should have. Exit code 1 if they do not.
    #[arg(long, conflicts_with = "output")]
    pub chi2: bool,
    /// With `material` or tests: let the scene name meshes and pictures that lie outside of its own folder.
    #[arg(long)]
    pub allow_outside: bool,
    /// With `material` or --chi2: how many directions are drawn.
    #[arg(long, default_value_t = 1_000_000, value_parser = whole(2_u64, 1_000_000_000), allow_negative_numbers = true)]
    pub samples: u64,
}

#[derive(clap::Args, Debug)]
pub struct Compare {
    #[command(flatten)]
    pub scene: Scene,
    /// Which integrators.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "path,nee,whitted")]
    pub integrators: Vec<String>,
    /// Which samplers. Default: the scene's.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub samplers: Vec<String>,
    /// The folder of the report. Default: SCENE-report here.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Samples per pixel of each replicate at most; without --time all of them.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Render time of each method, and of a reference that is to be computed. Default: 8s.
    #[arg(long, value_name = "DURATION", value_parser = duration)]
    pub time: Option<Duration>,
    /// Independent renders of each method.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(2..=256))]
    pub replicates: u32,
    /// The picture to measure against, an EXR of the same pixels. Default: one is computed.
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    /// Where `pt reference` keeps its references: one of this scene and size is used, and made better if it took less than --reference-time.
    #[arg(long, value_name = "FOLDER", env = "PT_CACHE")]
    pub cache: Option<PathBuf>,
    /// By which integrator a reference is computed. Default: nee.
    #[arg(long, value_name = "NAME", conflicts_with = "reference")]
    pub reference_integrator: Option<String>,
    /// For how long. Default: as long as each method.
    #[arg(long, value_name = "DURATION", value_parser = duration, conflicts_with = "reference")]
    pub reference_time: Option<Duration>,
    /// Size of the pictures. Default: the scene's, at most 65536 pixels.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// How sure to be of intervals.
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = share)]
    pub confidence: f64,
    /// Also this error measure: see `pt list metrics`. May be repeated.
    #[arg(short, long, value_name = "NAME")]
    pub metric: Vec<String>,
    /// Also the data that the viewer JERI reads.
    #[arg(long)]
    pub jeri: bool,
    #[command(flatten)]
    pub work: Work,
}

#[derive(clap::Args, Debug)]
pub struct Verify {
    #[command(flatten)]
    pub scene: Scene,
    /// Two integrators, or an integrator and an EXR with error bars.
    #[arg(value_name = "SIDE", num_args = 2, required = true)]
    pub sides: Vec<String>,
    /// Samples per pixel of each side that is rendered. Default: the scene's.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Render time of each side.
    #[arg(long, value_name = "DURATION", value_parser = duration)]
    pub time: Option<Duration>,
    /// The risk of calling two sides different that are the same.
    #[arg(long, value_name = "SHARE", default_value = "1%", value_parser = share)]
    pub alpha: f64,
    /// Where the probabilities go, pixel by pixel.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Size of the pictures.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    #[command(flatten)]
    pub work: Work,
}

#[derive(clap::Args, Debug)]
pub struct Reference {
    #[command(flatten)]
    pub scene: Scene,
    /// Until its relative error is at most this, such as 0.3%. Exit code 7 if it is not reached.
    #[arg(long, value_name = "ERROR", value_parser = share)]
    pub error: Option<f64>,
    /// Samples per pixel.
    #[arg(long, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    pub spp: Option<u32>,
    /// For so long, with what was spent on it before. Default, without --error and --spp: 60s.
    #[arg(long, value_name = "DURATION", value_parser = duration, allow_negative_numbers = true)]
    pub time: Option<Duration>,
    /// By which integrator. Default: nee.
    #[arg(short, long, value_name = "NAME")]
    pub integrator: Option<String>,
    /// Where the picture goes besides: .exr, .png, .ppm, .pfm. May be repeated.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Where references are kept. Default: pt in the user's folder for caches.
    #[arg(long, value_name = "FOLDER", env = "PT_CACHE")]
    pub cache: Option<PathBuf>,
    /// How sure to be of errors.
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = share)]
    pub confidence: f64,
    /// Size of the picture.
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    #[command(flatten)]
    pub work: Work,
}

#[derive(clap::Args, Debug)]
pub struct Merge {
    /// Parts of one picture.
    #[arg(value_name = "PART", required = true)]
    pub parts: Vec<PathBuf>,
    /// Where the sum goes: .exr, .png, .ppm, .pfm, or .ptc, which may lack samples. May be repeated.
    #[arg(short, long, value_name = "FILE", required = true)]
    pub output: Vec<PathBuf>,
    /// How sure to be of errors.
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = share)]
    pub confidence: f64,
    #[command(flatten)]
    pub develop: Develop,
}

/// From radiance to 8 bits.
#[derive(clap::Args, Debug)]
pub struct Develop {
    /// Stops of exposure, for 8-bit files only; `auto` chooses them so that 95 % of the lit pixels are below white.
    #[arg(long, value_name = "STOPS", default_value = "0", allow_negative_numbers = true, value_parser = exposure)]
    pub exposure: Exposure,
    /// The curve from radiance to display, for 8-bit files only.
    #[arg(long, value_enum, default_value_t = Curve::None)]
    pub tonemap: Curve,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    Stops(f32),
    Auto,
}

#[derive(clap::Args, Debug)]
pub struct Check {
    #[command(flatten)]
    pub scene: Scene,
    /// The integrator to check the scene for; default: the scene's.
    #[arg(short, long, value_name = "NAME")]
    pub integrator: Option<String>,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shell {
    Bash,
    Zsh,
    Fish,
}

impl From<Shell> for clap_complete::Shell {
    fn from(shell: Shell) -> clap_complete::Shell {
        match shell {
            Shell::Bash => clap_complete::Shell::Bash,
            Shell::Zsh => clap_complete::Shell::Zsh,
            Shell::Fish => clap_complete::Shell::Fish,
        }
    }
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    Integrators,
    Samplers,
    Shapes,
    Materials,
    Textures,
    Lights,
    Cameras,
    Filters,
    /// Layers beside the picture.
    Aovs,
    Metrics,
    /// Scene files that can be read.
    Dialects,
}

#[derive(clap::Args, Debug)]
pub struct Schema {
    /// The reference of all keys as Markdown instead.
    #[arg(long)]
    pub markdown: bool,
}

/// Which scene.
#[derive(clap::Args, Debug)]
pub struct Scene {
    /// The scene file; `-` reads it from stdin, with paths relative to the working directory.
    #[arg(value_name = "SCENE")]
    path: Option<PathBuf>,
    /// Override what the scene file says: a JSON pointer and a JSON value. May be repeated.
    #[arg(short = 'D', value_name = "/POINTER=VALUE")]
    pub overrides: Vec<String>,
    /// Let the scene name meshes and pictures that lie outside of its own folder.
    #[arg(long)]
    pub allow_outside: bool,
    /// The side from which a model (glTF, OBJ, PLY, STL) is seen, by a camera that shows all of it. Default: the file's camera, else
    /// three-quarter.
    #[arg(long, value_name = "SIDE", value_parser = viewpoint)]
    view: Option<Viewpoint>,
    /// The axis of a model that points up, y or z. Default: y, for STL z.
    #[arg(long, value_name = "AXIS", value_parser = up)]
    up: Option<Up>,
    /// Put a matte ground under a model, which catches its shadow.
    #[arg(long)]
    ground: bool,
}

/// How the work is done, and shown.
#[derive(clap::Args, Debug)]
pub struct Work {
    /// Threads. Default: all cores. The picture does not depend on it.
    #[arg(short, long, env = "PT_THREADS", alias = "nthreads", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<u32>,
    /// How progress shows on stderr; `auto` is a bar on a terminal and a line every few seconds elsewhere.
    #[arg(long, value_enum, default_value_t = Progress::Auto)]
    pub progress: Progress,
}

/// Render SCENE.
#[derive(clap::Args, Debug)]
pub struct Render {
    #[command(flatten)]
    pub scene: Scene,
    /// Samples per pixel, as --spp says them.
    #[arg(value_name = "SPP", value_parser = whole(1, u32::MAX), conflicts_with = "spp", allow_negative_numbers = true)]
    count: Option<u32>,
    /// How light transport is computed: see `pt list integrators`. Default: the scene's, else nee.
    #[arg(short, long, value_name = "NAME")]
    pub integrator: Option<String>,
    /// Where the picture goes: .exr (linear, float), .png, .ppm, .pfm. May be repeated. Default: SCENE.exr and SCENE.png here.
    #[arg(short, long, value_name = "FILE", alias = "outfile")]
    pub output: Vec<PathBuf>,
    /// Name the picture by the clock when it is begun, YY_MM_DD-hh_mm_ss.exr and .png.
    #[arg(long, conflicts_with_all = ["output", "shard", "samples", "pixel"])]
    pub clock_name: bool,
    /// Samples per pixel.
    #[arg(long, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    spp: Option<u32>,
    /// Render until this long has passed, however many samples that is (or until --spp): `30s`, `1h30m`, a bare number
    /// of seconds. Reading and building do not count. The first sample of every pixel is finished, unless even that takes over
    /// twice as long, and over 10 s: then nothing is written, exit code 7.
    #[arg(long, value_name = "DURATION", value_parser = duration, allow_negative_numbers = true, alias = "timeout")]
    pub time: Option<Duration>,
    /// Which random numbers: another seed, another independent picture.
    #[arg(long, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Where the random numbers come from: see `pt list samplers`.
    #[arg(long, value_name = "NAME")]
    pub sampler: Option<String>,
    /// How many independent scramblings share the samples of a pixel, to tell the error of all samplers but `independent`: 1 to 64.
    #[arg(long, value_name = "K")]
    pub scramblings: Option<u32>,
    /// Stop when the relative error of the picture is at most this, such as 1% or 0.01. Exit code 7 if it is not reached.
    #[arg(long, value_name = "ERROR", value_parser = share)]
    pub target: Option<f64>,
    /// Samples go where they are worth most, as a short pilot tells: up to 64 times as many in noisy pixels as in calm ones.
    /// Unbiased, and with the right error bars.
    #[arg(long, conflicts_with_all = ["pixel", "clamp", "shard", "samples", "checkpoint", "resume"])]
    pub adaptive: bool,
    /// How sure to be of errors and targets.
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = share)]
    pub confidence: f64,
    /// Render part I of N of the samples, I from 1, into a .ptc file for `pt merge`: 3/8 in the third of eight jobs.
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with_all = ["time", "target", "pixel", "pilot"], allow_hyphen_values = true)]
    pub shard: Option<Shard>,
    /// Render samples A to B - 1 of every pixel, A from 0, into a .ptc file for `pt merge`.
    #[arg(long, value_name = "A..B", value_parser = samples, conflicts_with_all = ["shard", "time", "target", "pixel", "pilot"], allow_hyphen_values = true)]
    pub samples: Option<Range<u64>>,
    /// Write the state of the render this often, on an interrupt and at the end: to the .ptc beside the first output.
    #[arg(long, value_name = "DURATION", value_parser = duration, conflicts_with = "pixel", allow_negative_numbers = true)]
    pub checkpoint: Option<Duration>,
    /// Go on from a state, to the bits of a render that never paused: --resume takes the .ptc beside the first output, if it is
    /// there; --resume=FILE takes that one. What it took so far counts for --time.
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, conflicts_with = "pixel")]
    pub resume: Option<Option<PathBuf>>,
    /// First find out for so long what 10 %, 3 %, 1 % and 0.3 % of error cost, for each of --integrators.
    #[arg(long, value_name = "DURATION", value_parser = duration, conflicts_with = "pixel")]
    pub pilot: Option<Duration>,
    /// With --pilot: whose prices, such as path,nee. Default: the one that renders.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "pilot")]
    pub integrators: Vec<String>,
    /// Layers beside the picture in .exr files, such as albedo,n,z, or `all`: see `pt list aovs`. The picture does not change.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', alias = "layers")]
    pub aov: Vec<String>,
    /// Size of the picture, such as 640x480.
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    /// Render only these pixels of the picture.
    #[arg(long, value_name = "X0,X1,Y0,Y1", value_parser = numbers::<4>, alias = "pixelbounds", allow_hyphen_values = true)]
    pub crop: Option<[u32; 4]>,
    /// Compute this pixel alone and print it; no file is written.
    #[arg(long, value_name = "X,Y", value_parser = numbers::<2>, conflicts_with_all = ["output", "crop", "time"], allow_hyphen_values = true)]
    pub pixel: Option<[u32; 2]>,
    /// With --pixel: this sample alone.
    #[arg(long, value_name = "K", requires = "pixel", value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    pub sample: Option<u64>,
    /// With --sample: its paths, vertex by vertex: where, what was sampled, which light counted by how much, why the path ended. As
    /// text, or with =json as JSON.
    #[arg(long, value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "text", value_name = "FORMAT", requires = "sample")]
    pub trace: Option<Form>,
    /// After the render: the N samples that add most to the noise, each with the command that shows its paths.
    #[arg(long, value_name = "N", conflicts_with = "pixel", value_parser = whole(1_u32, 1000), allow_negative_numbers = true)]
    pub worst: Option<u32>,
    /// After the render: what each limit of the method takes out of the picture. May take 5 % as long as the render; without it
    /// 1 % is spent, and only what is found to be missing is told.
    #[arg(long, conflicts_with = "pixel")]
    pub ledger: bool,
    /// Hold back what a single piece of indirect light exceeds this radiance by. Less noise, and a bias: what it takes is counted
    /// and told.
    #[arg(long, conflicts_with_all = ["shard", "samples", "checkpoint", "resume"], value_name = "RADIANCE", value_parser = above_zero, allow_negative_numbers = true)]
    pub clamp: Option<f32>,
    #[command(flatten)]
    pub work: Work,
    #[command(flatten)]
    pub develop: Develop,
    /// Show the picture in tev while it is rendered. tev listens at 127.0.0.1:14158 unless it is told otherwise.
    #[arg(long, value_name = "HOST:PORT", alias = "tev", conflicts_with = "pixel")]
    pub display_server: Option<String>,
    /// Print what the render took: as text, or with =json as JSON.
    #[arg(long, value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "text", value_name = "FORMAT")]
    pub stats: Option<Form>,
    /// Say more: before rendering what `pt check` says of the scene.
    #[arg(short, long, conflicts_with = "quiet")]
    pub verbose: bool,
}

/// Part `index` of `count`, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    pub index: u32,
    pub count: u32,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// Clip at 1.
    None,
    /// A shoulder like film's.
    Filmic,
    /// Divide by the brightest value; no transfer curve.
    Normalize,
    /// The curve of the postcard path tracer.
    Postcard,
}

impl Render {
    /// Samples per pixel, however they were asked for.
    pub fn spp(&self) -> Option<u32> {
        self.spp.or(self.count)
    }
}

impl Develop {
    /// How a picture is developed.
    pub fn tonemap(&self, image: &Image) -> output::Tonemap {
        let exposure = match self.exposure {
            Exposure::Stops(stops) => stops,
            Exposure::Auto => output::exposure::automatic(image),
        };
        output::Tonemap { exposure, curve: self.tonemap.into() }
    }
}

impl From<Curve> for output::Curve {
    fn from(curve: Curve) -> output::Curve {
        match curve {
            Curve::None => output::Curve::None,
            Curve::Filmic => output::Curve::Filmic,
            Curve::Normalize => output::Curve::Normalize,
            Curve::Postcard => output::Curve::Postcard,
        }
    }
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    Auto,
    Bar,
    /// One JSON object per line.
    Json,
    None,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Text,
    Json,
}

impl Args {
    /// The files that the command is about, as messages call them.
    pub fn file(&self) -> String {
        let scene = |scene: &Scene| scene.path.iter().cloned().collect();
        let files: Vec<PathBuf> = match &self.command {
            None => scene(&self.render.scene),
            Some(Command::Check(args)) => scene(&args.scene),
            Some(Command::Compare(args)) => scene(&args.scene),
            Some(Command::Convert(args)) => scene(&args.scene),
            Some(Command::Reference(args)) => scene(&args.scene),
            Some(Command::Verify(args)) => scene(&args.scene),
            Some(Command::Merge(args)) => args.parts.clone(),
            Some(Command::Image { verb }) => verb.files(),
            Some(Command::Sample(args)) => args.scene.iter().chain(&args.what).take(1).map(PathBuf::from).collect(),
            Some(_) => vec![],
        };
        files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>().join(", ")
    }
}

impl Scene {
    /// clap cannot require it: a subcommand has a scene of its own, or none.
    pub fn path(&self) -> Result<&Path> {
        self.path.as_deref().ok_or_else(|| Error::Usage("expected a scene file, such as scenes/cornell-box.json; see pt --help".into()))
    }

    /// How a model is shown that says it not itself.
    pub fn framing(&self) -> Framing {
        Framing { up: self.up, view: self.view, ground: self.ground }
    }

    /// The overrides, split at the first `=`.
    pub fn overrides(&self) -> Result<Vec<(&str, &str)>> {
        let split = |text: &String| format!("-D {text}: expected /POINTER=VALUE, such as -D /camera/fov=60");
        self.overrides.iter().map(|text| text.split_once('=').ok_or_else(|| Error::Usage(split(text)))).collect()
    }
}

fn viewpoint(text: &str) -> std::result::Result<Viewpoint, String> {
    let names = Viewpoint::ALL.map(|view| view.name).join(", ");
    Viewpoint::ALL.into_iter().find(|view| view.name == text).ok_or_else(|| format!("expected one of {names}"))
}

fn up(text: &str) -> std::result::Result<Up, String> {
    match text {
        "y" => Ok(Up::Y),
        "z" => Ok(Up::Z),
        _ => Err("expected y or z".to_owned()),
    }
}

/// A size that a film can have: sides as in the scene format.
fn size(text: &str) -> std::result::Result<[u32; 2], String> {
    let sides = numbers(&text.replace(['x', '×'], ",")).map_err(|_| "expected a size such as 640x480".to_owned())?;
    let right = sides.iter().all(|side| (1..=65536).contains(side));
    right.then_some(sides).ok_or("expected a size from 1x1 to 65536x65536".to_owned())
}

/// A whole number within bounds; clap's own parser would tell of invalid digits and not of what is expected.
fn whole<N>(low: N, high: N) -> impl Fn(&str) -> std::result::Result<N, String> + Clone
where
    N: FromStr + PartialOrd + Display + Copy,
{
    move |text| {
        let inside = |n: &N| (low..=high).contains(n);
        text.parse().ok().filter(inside).ok_or_else(|| format!("expected a whole number from {low} to {high}"))
    }
}

fn numbers<const N: usize>(text: &str) -> std::result::Result<[u32; N], String> {
    let parsed: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let example = (1..=N).map(|n| (100 * n).to_string()).collect::<Vec<_>>().join(",");
    parsed.and_then(|numbers| numbers.try_into().ok()).ok_or(format!("expected {N} whole numbers such as {example}"))
}

/// clap's own message would not say that the environment may have given the value.
fn threads(text: &str) -> std::result::Result<u32, String> {
    let expected = "expected a whole number from 1 to 1024 (in --threads or PT_THREADS)".to_owned();
    text.parse().ok().filter(|n| (1..=1024).contains(n)).ok_or(expected)
}

fn exponent(text: &str) -> std::result::Result<f32, String> {
    text.parse().ok().filter(|n: &f32| (0.0..=1e9).contains(n)).ok_or("expected a number from 0 to 1e9".to_owned())
}

fn cone(text: &str) -> std::result::Result<f64, String> {
    text.parse().ok().filter(|angle: &f64| *angle > 0.0 && *angle <= 180.0).ok_or("expected an angle above 0 and at most 180".to_owned())
}

fn corners(text: &str) -> std::result::Result<[[f32; 3]; 3], String> {
    let numbers =
        |point: &str| -> Option<Vec<f32>> { point.split(',').map(|part| part.parse().ok().filter(|x: &f32| x.is_finite())).collect() };
    let point = |point: &str| numbers(point).and_then(|coordinates| coordinates.try_into().ok());
    let parsed: Option<Vec<[f32; 3]>> = text.split_whitespace().map(point).collect();
    parsed.and_then(|points| points.try_into().ok()).ok_or("expected three points such as '1,0,0 0,1,0 0,0,1'".to_owned())
}

fn alpha(text: &str) -> std::result::Result<[f32; 2], String> {
    let (x, y) = text.split_once(',').unwrap_or((text, text));
    let parsed = [x, y].map(|part| part.trim().parse().ok().filter(|alpha| (0.0..=100.0).contains(alpha)));
    Option::zip(parsed[0], parsed[1])
        .map(|(x, y)| [x, y])
        .ok_or("expected one or two numbers from 0 to 100 such as 0.5 or 0.1,0.5".to_owned())
}

fn angles(text: &str) -> std::result::Result<[f64; 2], String> {
    let parsed = text.split_once(',').and_then(|(theta, phi)| Some([theta.trim().parse().ok()?, phi.trim().parse().ok()?]));
    let inside = |[theta, phi]: &[f64; 2]| (0.0..=180.0).contains(theta) && phi.is_finite();
    parsed.filter(inside).ok_or("expected two angles in degrees such as 60,0; the first from 0 to 180".to_owned())
}

fn exposure(text: &str) -> std::result::Result<Exposure, String> {
    let stops = finite(text).map(Exposure::Stops);
    if text == "auto" { Ok(Exposure::Auto) } else { stops.map_err(|_| "expected a number of stops, or auto".to_owned()) }
}

pub(super) fn finite(text: &str) -> std::result::Result<f32, String> {
    text.parse().ok().filter(|x: &f32| x.is_finite()).ok_or("expected a number".to_owned())
}

fn above_zero(text: &str) -> std::result::Result<f32, String> {
    text.parse().ok().filter(|x: &f32| x.is_finite() && *x > 0.0).ok_or("expected a number above 0".to_owned())
}

/// Above 0 and below 1, in per cent or not.
fn share(text: &str) -> std::result::Result<f64, String> {
    let (number, unit) = text.trim().strip_suffix('%').map_or((text, 1.0), |number| (number, 100.0));
    let parsed = number.trim().parse().ok().map(|x: f64| x / unit);
    parsed.filter(|x| *x > 0.0 && *x < 1.0).ok_or("expected a share such as 1% or 0.01, above 0 and below 1".to_owned())
}

fn shard(text: &str) -> std::result::Result<Shard, String> {
    let parsed = text.split_once('/').and_then(|(index, count)| Some(Shard { index: index.parse().ok()?, count: count.parse().ok()? }));
    let counted = parsed.filter(|shard| (1..=shard.count).contains(&shard.index));
    counted.ok_or("expected a part and how many there are, such as 1/8; the last is 8/8".to_owned())
}

fn samples(text: &str) -> std::result::Result<Range<u64>, String> {
    let parsed = text.split_once("..").and_then(|(start, end)| Some(start.parse().ok()?..end.parse().ok()?));
    let some = parsed.filter(|samples: &Range<u64>| !samples.is_empty() && samples.end <= u32::MAX.into());
    some.ok_or(format!("expected samples such as 64..128: from the first to before the last, at most {}", u32::MAX))
}

fn duration(text: &str) -> std::result::Result<Duration, String> {
    let seconds = text.parse().ok().and_then(|s: f64| Duration::try_from_secs_f64(s).ok());
    let parsed = seconds.or_else(|| humantime::parse_duration(text).ok());
    parsed.filter(|d| !d.is_zero()).ok_or("expected a duration such as 30s, 1h30m or 0.5".to_owned())
}
