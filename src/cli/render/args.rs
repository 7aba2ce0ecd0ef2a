//! Arguments of a render.

use std::ops::{Range, RangeInclusive};
use std::path::PathBuf;
use std::time::Duration;

use super::pixel::PixelPlan;
use super::resized;
use crate::cli::load::{Override, SceneArgs};
use crate::cli::parse::{above_zero, duration, numbers, share, size, whole};
use crate::cli::progress::WorkArgs;
use crate::cli::stats::TextOrJson;
use crate::cli::tone_mapping::ToneMapping;
use crate::cli::watch::PageAddress;
use crate::error::Result;
use crate::load::{layers_named, sampler_named};

/// Value of `--integrator` and `--sampler` that asks for a choice by a pilot.
pub const AUTO: &str = "auto";

/// Render SCENE.
#[derive(clap::Args, Clone, Debug)]
pub struct RenderArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Samples per pixel, the same as --spp.
    #[arg(value_name = "SPP", value_parser = whole(1, u32::MAX), conflicts_with = "spp", allow_negative_numbers = true)]
    count: Option<u32>,
    /// Integrator: see `pt list integrators`. `auto` tries all that simulate what the scene calls for, and takes the one that reaches an
    /// error soonest. Default: the scene's, or nee.
    #[arg(short, long, value_name = "NAME")]
    pub integrator: Option<String>,
    /// Output file: .exr (linear, float), .hdr, .png, .ppm, .pfm. May be repeated. Default: SCENE.exr and SCENE.png here.
    #[arg(short, long, value_name = "FILE", alias = "outfile")]
    pub output: Vec<PathBuf>,
    /// Name the picture by the time at which it is begun, YY_MM_DD-hh_mm_ss.exr and .png.
    #[arg(long, conflicts_with_all = ["output", "shard", "samples", "pixel"])]
    pub clock_name: bool,
    /// Render the pictures A to B of a sequence, both included, or one: 1..48, 7. In picture n the shutter opens n / --fps seconds later, and
    /// names have the number of the picture: x.0001.exr. With --resume, pictures of the same scene that are there with all samples (as .exr) are
    /// left alone.
    #[arg(long, visible_alias = "frame", value_name = "A..B", value_parser = frames, conflicts_with_all = ["clock_name", "pixel"])]
    pub frames: Option<RangeInclusive<u32>>,
    /// Pictures per second, for --frames. Where the scene has no shutter, it is open for half of the time of a picture.
    #[arg(long, value_name = "N", value_parser = rate, default_value_t = 24.0, requires = "frames")]
    pub fps: f64,
    /// Samples per pixel.
    #[arg(long, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    spp: Option<u32>,
    /// Render until this time has passed (or until --spp): `30s`, `1h30m`, or a number of seconds. Reading and building do not
    /// count. The first sample of every pixel is finished, unless even that takes over twice as long, and over 10 s: then nothing
    /// is written, exit code 7.
    #[arg(long, value_name = "DURATION", value_parser = duration, allow_negative_numbers = true, alias = "timeout")]
    pub time: Option<Duration>,
    /// Seed of the random numbers: another seed gives another, independent picture.
    #[arg(long, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Sampler of the random numbers: see `pt list samplers`. `auto` tries them, and takes the one that reaches an error soonest.
    #[arg(long, value_name = "NAME")]
    pub sampler: Option<String>,
    /// Number of independent scramblings that share the samples of a pixel, from which the error is estimated (all samplers but
    /// `independent`): 1 to 64.
    #[arg(long, value_name = "K")]
    pub scramblings: Option<u32>,
    /// Stop when the relative error of the picture is at most this, such as 1% or 0.01. Exit code 7 if it is not reached. Without --spp and --time it is given up where no error can be established, as in a black picture.
    #[arg(long, value_name = "ERROR", value_parser = share)]
    pub target: Option<f64>,
    /// With --target: it holds for these pixels, as for a picture of them alone; the others are rendered, too.
    #[arg(long, value_name = "X0,X1,Y0,Y1", requires = "target", value_parser = numbers::<4>, allow_hyphen_values = true,
        conflicts_with_all = ["tiles", "adaptive", "checkpoint", "resume", "serve"])]
    pub region: Option<[u32; 4]>,
    /// With --target: it holds for this share of the tiles of about 32×32 pixels, each by itself. The worst tile is named.
    #[arg(long, value_name = "SHARE", requires = "target", value_parser = share,
        conflicts_with_all = ["adaptive", "checkpoint", "resume", "serve"])]
    pub tiles: Option<f64>,
    /// Adaptive sampling by a short pilot: noisy pixels get up to 64 times as many samples as others. Unbiased, and with the right
    /// error bars.
    #[arg(long, conflicts_with_all = ["pixel", "clamp", "checkpoint", "resume"])]
    pub adaptive: bool,
    /// Confidence of errors and targets.
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = share)]
    pub confidence: f64,
    /// Render part I of N of the samples, I from 1, into a .ptc file for `pt merge`: 3/8 in the third of eight jobs.
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with_all = ["time", "target", "pixel", "pilot"], allow_hyphen_values = true)]
    pub shard: Option<Shard>,
    /// Render samples A to B - 1 of every pixel, A from 0, into a .ptc file for `pt merge`. With --adaptive they are rounds, in each of which
    /// a pixel takes 1 to 64 samples.
    #[arg(long, value_name = "A..B", value_parser = samples, conflicts_with_all = ["shard", "time", "target", "pixel", "pilot"], allow_hyphen_values = true)]
    pub samples: Option<Range<u64>>,
    /// Write the state of the render this often, on an interrupt and at the end, to the .ptc beside the first output.
    #[arg(long, value_name = "DURATION", value_parser = duration, conflicts_with = "pixel", allow_negative_numbers = true)]
    pub checkpoint: Option<Duration>,
    /// Continue from a saved state, bit for bit as if the render had never paused: --resume takes the .ptc beside the first output,
    /// if it exists; --resume=FILE takes that file. The time spent before counts for --time.
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, conflicts_with = "pixel")]
    pub resume: Option<Option<PathBuf>>,
    /// First render this long with each of --integrators, and list what errors of 10 %, 3 %, 1 % and 0.3 % cost in time.
    #[arg(long, value_name = "DURATION", value_parser = duration, conflicts_with = "pixel")]
    pub pilot: Option<Duration>,
    /// With --pilot: integrators to list, such as path,nee. Default: the one that renders.
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
    /// Compute and print only this pixel; no file is written.
    #[arg(long, value_name = "X,Y", value_parser = numbers::<2>, conflicts_with_all = ["output", "crop", "time"], allow_hyphen_values = true)]
    pub pixel: Option<[u32; 2]>,
    /// With --pixel: only this sample.
    #[arg(long, value_name = "K", requires = "pixel", value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    pub sample: Option<u64>,
    /// With --sample: print its paths, vertex by vertex: the point, the sampled direction, the light that counted and why the path
    /// ended. As text, or with =json as JSON.
    #[arg(long, value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "text", value_name = "FORMAT", requires = "sample")]
    pub trace: Option<TextOrJson>,
    /// After the render: list the N samples that add most to the noise, each with the command that shows its paths.
    #[arg(long, value_name = "N", conflicts_with = "pixel", value_parser = whole(1_u32, 1000), allow_negative_numbers = true)]
    pub worst: Option<u32>,
    /// After the render: estimate how much light each limit of the method removes. This takes up to 5 % of the render time; without
    /// it 1 % is spent, and only what is found is reported.
    #[arg(long, conflicts_with = "pixel")]
    pub ledger: bool,
    /// Limit the radiance of each contribution of indirect light to this. It removes noise and adds bias; the removed light is
    /// counted and reported.
    #[arg(long, conflicts_with_all = ["shard", "samples", "checkpoint", "resume"], value_name = "RADIANCE", value_parser = above_zero, allow_negative_numbers = true)]
    pub clamp: Option<f32>,
    #[command(flatten)]
    pub work: WorkArgs,
    #[command(flatten)]
    pub tone_mapping: ToneMapping,
    /// Show the picture in tev while it renders. tev usually listens at 127.0.0.1:14158.
    #[arg(long, value_name = "HOST:PORT", alias = "tev", conflicts_with = "pixel")]
    pub display_server: Option<String>,
    /// Show the picture in a browser while it renders, with its error, the time that is left and a button that ends the render. The
    /// address of the page is printed; 127.0.0.1:0 is any free port of this machine. Only in a build with --features serve.
    #[arg(long, value_name = "HOST:PORT", conflicts_with_all = ["pixel", "frames"])]
    pub serve: Option<String>,
    /// With --serve: an address that other machines reach. Who has the printed address with its token may watch, and end the render.
    #[arg(long, requires = "serve")]
    pub serve_any: bool,
    /// Print time, rays and memory of the render: as text, or with =json as JSON.
    #[arg(long, value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "text", value_name = "FORMAT")]
    pub stats: Option<TextOrJson>,
    /// Print more: before rendering the output of `pt check`.
    #[arg(short, long, conflicts_with = "quiet")]
    pub verbose: bool,
}

impl RenderArgs {
    /// Name of the integrator that is asked for, and not chosen by a pilot.
    pub fn named_integrator(&self) -> Option<&str> {
        self.integrator.as_deref().filter(|name| *name != AUTO)
    }

    /// Samples per pixel, however they were asked for.
    pub fn spp(&self) -> Option<u32> {
        self.spp.or(self.count)
    }

    /// Overrides by flags that replace a key of the scene.
    pub fn overrides(&self) -> Result<Vec<Override>> {
        let mut list = self.size.map(resized).unwrap_or_default();
        let mut set = |words: String, pointer, value: String| list.push(Override { words, pointer, value });
        if let Some([x0, x1, y0, y1]) = self.crop {
            set(format!("--crop {x0},{x1},{y0},{y1}"), "/film/crop", format!("{:?}", [x0, x1, y0, y1]));
        }
        if let Some(spp) = self.spp() {
            set(format!("--spp {spp}"), "/sampler/spp", spp.to_string());
        }
        if let Some(seed) = self.seed {
            set(format!("--seed {seed}"), "/sampler/seed", seed.to_string());
        }
        if let Some(k) = self.scramblings {
            set(format!("--scramblings {k}"), "/sampler/scramblings", k.to_string());
        }
        if !self.aov.is_empty() {
            let names = layers_named("--aov", &self.aov)?;
            set(format!("--aov {}", self.aov.join(",")), "/film/layers", format!("{names:?}"));
        }
        if let Some(name) = self.sampler.as_ref().filter(|name| *name != AUTO) {
            sampler_named(name)?;
            set(format!("--sampler {name}"), "/sampler/type", name.clone());
        }
        Ok(list)
    }

    /// Address of the page, if one is to be served.
    ///
    /// # Errors
    /// Those of [`PageAddress::new`].
    pub fn page(&self) -> Result<Option<PageAddress>> {
        self.serve.as_ref().map(|text| PageAddress::new(text, self.serve_any)).transpose()
    }

    /// Plan for `--pixel`, if it is given.
    pub fn pixel_plan(&self) -> Option<PixelPlan> {
        let pixel = self.pixel.map(<(u32, u32)>::from)?;
        Some(PixelPlan { pixel, sample: self.sample, trace: self.trace, clamp: self.clamp })
    }
}

/// Part `index` of `count` parts, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    pub index: u32,
    pub count: u32,
}

impl Shard {
    /// Samples of the part, out of `spp`; `None` if there are fewer samples than parts.
    ///
    /// Parts begin at multiples of 2^k, where few blocks of the tree of samples meet, and files are small: k is as large as it can be with no
    /// part longer than an eighth above the shortest possible length.
    pub fn samples(&self, spp: u64) -> Option<Range<u64>> {
        let count = u64::from(self.count);
        let longest = |step: u64| spp.div_ceil(step).div_ceil(count).saturating_mul(step);
        let is_fair = |step: &u64| spp / step >= count && longest(*step) - longest(1) <= longest(1) / 8;
        let step = (0..64).map(|k| 1 << k).filter(is_fair).max()?;
        let steps = u128::from(spp.div_ceil(step));
        let at = |i: u32| spp.min((steps * u128::from(i) / u128::from(count)) as u64 * step);
        Some(at(self.index - 1)..at(self.index))
    }
}

fn shard(text: &str) -> std::result::Result<Shard, String> {
    let parsed = text.split_once('/').and_then(|(index, count)| Some(Shard { index: index.parse().ok()?, count: count.parse().ok()? }));
    let counted = parsed.filter(|shard| (1..=shard.count).contains(&shard.index));
    counted.ok_or("expected a part and how many there are, such as 1/8; the last is 8/8".to_owned())
}

fn rate(text: &str) -> std::result::Result<f64, String> {
    let parsed = text.parse().ok().filter(|rate| (1e-6..=1e6).contains(rate));
    parsed.ok_or("expected a number of pictures per second, such as 24".to_owned())
}

fn frames(text: &str) -> std::result::Result<RangeInclusive<u32>, String> {
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    let parsed = first.parse().ok().and_then(|first| Some(first..=last.parse().ok()?));
    parsed
        .filter(|frames: &RangeInclusive<u32>| !frames.is_empty())
        .ok_or("expected pictures such as 1..48, the first and the last, or one such as 7".to_owned())
}

fn samples(text: &str) -> std::result::Result<Range<u64>, String> {
    let parsed = text.split_once("..").and_then(|(start, end)| Some(start.parse().ok()?..end.parse().ok()?));
    let some = parsed.filter(|samples: &Range<u64>| !samples.is_empty() && samples.end <= u32::MAX.into());
    some.ok_or(format!("expected samples such as 64..128: from the first to before the last, at most {}", u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::Shard;

    /// Parts follow one another without gaps, none is empty, none is an eighth longer than it must be, and those of a power of two of samples
    /// in a power of two of parts are single blocks.
    #[test]
    fn parts_are_fair_and_begin_at_blocks() {
        for (spp, count) in
            (1..200).flat_map(|spp| (1..=spp as u32).map(move |count| (spp, count))).chain([(1000, 64), (1024, 64), (4_294_967_295, 7)])
        {
            let parts: Vec<_> = (1..=count).map(|index| Shard { index, count }.samples(spp).expect("enough samples")).collect();
            assert_eq!((parts[0].start, parts[parts.len() - 1].end), (0, spp));
            assert!(parts.windows(2).all(|pair| pair[0].end == pair[1].start));
            let shortest = spp.div_ceil(count.into());
            assert!(
                parts.iter().all(|part| part.start < part.end && part.end - part.start <= shortest + shortest / 8),
                "{spp} in {count}: {parts:?}"
            );
            if spp.is_power_of_two() && count.is_power_of_two() {
                assert!(parts.iter().all(|part| part.end - part.start == spp / u64::from(count)));
            }
        }
        assert_eq!(Shard { index: 1, count: 3 }.samples(2), None);
        // 200 = 8 · 25 samples in 8 parts: at multiples of 4, as parts may be 28 samples long where 25 are the fewest.
        let starts = (1..=8).map(|index| Shard { index, count: 8 }.samples(200).expect("enough samples").start);
        assert_eq!(starts.collect::<Vec<_>>(), [0, 24, 48, 72, 100, 124, 148, 172]);
    }
}
