//! `.ptc`: what is in it, byte by byte.
//!
//! ```text
//! 89 50 54 43 0d 0a 1a 0a     so that no other file is taken for one, nor one that went through a text filter
//! u64   bytes of the file     so that a truncated file is known
//! u32   bytes of the header
//! header, JSON in UTF-8       see `Header`
//! f64 … block after block, pixel after pixel, as `Block::numbers`
//! u128  XXH3 of all before
//! ```
//!
//! All numbers are little-endian.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

use glam::UVec2;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::About;
use crate::describe::Identity;
use crate::error::memory::fallible;
use crate::error::{Error, Fault, Result};
use crate::film::layer::with_lights;
use crate::film::{Block, Crop, Layer, MomentFilm, Wave};
use crate::math::hash::Hasher;
use crate::measure::{Checkpoint, Course, RelativeError};
use crate::output::{self, Attributes};
use crate::render::{Report, SampleId};
use crate::sampler::Spread;

const MAGIC: [u8; 8] = *b"\x89PTC\r\n\x1a\n";
/// Before the header.
const PRELUDE: u64 = 8 + 8 + 4;
const CHECKSUM: u64 = 16;
/// No picture has a longer one (pixels).
const LONGEST_SIDE: u32 = 1 << 16;

/// What a file says of its numbers.
#[derive(Serialize, Deserialize)]
struct Header {
    build: String,
    /// The hash of the facts.
    scene: String,
    facts: Value,
    size: [u32; 2],
    /// `[x0, x1, y0, y1]`
    crop: [u32; 4],
    /// How many; `null` where each sample is independent of all others.
    scramblings: Option<u32>,
    /// Names of the layers, that of the lights once.
    layers: Vec<String>,
    lights: Vec<String>,
    view: Attributes,
    /// Of each pixel of a block.
    numbers: usize,
    /// `[first sample, level]`
    blocks: Vec<(u64, u32)>,
    /// Of rendering.
    seconds: f64,
    invalid: u64,
    first_invalid: Vec<((u32, u32), u64)>,
    course: Vec<Look>,
}

fn names(layers: &[Layer]) -> Vec<String> {
    let mut names: Vec<String> = layers.iter().map(|layer| layer.name().to_owned()).collect();
    names.dedup();
    names
}

/// A checkpoint; its numbers as text, which keeps all their digits, and infinities.
#[derive(Serialize, Deserialize)]
struct Look {
    samples: u64,
    seconds: String,
    /// Value, spread, effective pixels.
    error: Option<[String; 3]>,
}

/// Writes the sums of some samples; an existing file is replaced when the new one is complete.
///
/// - `films`: runs of samples in their order
///
/// # Errors
/// `Io`.
pub fn write(path: &Path, about: &About, films: &[&MomentFilm], report: &Report, course: &Course) -> Result<()> {
    let blocks = || films.iter().flat_map(|film| film.blocks());
    let crop = about.crop;
    let header = Header {
        build: about.build.clone(),
        scene: about.identity.hash().to_string(),
        facts: about.identity.facts().clone(),
        size: about.size.to_array(),
        crop: [crop.min.x, crop.max.x, crop.min.y, crop.max.y],
        scramblings: match about.spread {
            Spread::Samples => None,
            Spread::Scramblings(k) => Some(k),
        },
        layers: names(&about.layers),
        lights: about.lights.clone(),
        view: about.view.clone(),
        numbers: about.slots().all(),
        blocks: blocks().map(|(wave, _)| (wave.first, wave.level)).collect(),
        seconds: report.elapsed.as_secs_f64(),
        invalid: report.invalid,
        first_invalid: report.first_invalid.iter().map(|id| (id.pixel, id.index)).collect(),
        course: course.planned().map(Look::new).collect(),
    };
    let header = serde_json::to_vec(&header).map_err(|e| Error::Internal(format!("a header cannot be written: {e}")))?;
    let numbers: u64 = blocks().map(|(_, block)| 8 * block.numbers().len() as u64).sum();
    let length = PRELUDE + header.len() as u64 + numbers + CHECKSUM;
    output::replace_with(path, |file| {
        let mut file = Summed { to: BufWriter::with_capacity(1 << 18, file), sum: Hasher::default() };
        file.put(&MAGIC)?;
        file.put(&length.to_le_bytes())?;
        file.put(&(header.len() as u32).to_le_bytes())?;
        file.put(&header)?;
        for chunk in blocks().flat_map(|(_, block)| block.numbers().chunks(1 << 12)) {
            file.put(&chunk.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>())?;
        }
        let sum = file.sum.finish().0.to_le_bytes();
        file.put(&sum)?;
        file.to.flush()
    })
}

struct Summed<W> {
    to: W,
    sum: Hasher,
}

impl<W: Write> Summed<W> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sum.bytes(bytes);
        self.to.write_all(bytes)
    }
}

/// A file that is whole and makes sense; its numbers are still in it.
#[derive(Debug)]
pub struct Stored {
    pub path: PathBuf,
    pub about: About,
    pub report: Report,
    pub course: Course,
    waves: Vec<Wave>,
    /// Where the numbers begin.
    start: u64,
}

impl Stored {
    /// Reads and checks all but the numbers' meaning.
    ///
    /// # Errors
    /// `Invalid` for what is missing, no such file, truncated, damaged or of another version; `Io`.
    pub fn open(path: &Path) -> Result<Stored> {
        let refused = |message: String| Error::invalid(Fault::new(message).in_file(path));
        let mut file = BufReader::with_capacity(1 << 18, output::regular(path)?);
        let found = file.get_ref().metadata().map_err(|e| Error::io(path, e))?.len();
        let mut prelude = [0; PRELUDE as usize];
        let known = file.read_exact(&mut prelude).is_ok() && prelude.starts_with(&MAGIC);
        if !known {
            return Err(refused("expected a part of a render (.ptc)".into()));
        }
        let [length, header] = [&prelude[8..16], &prelude[16..]].map(number);
        if found < length {
            return Err(refused(format!("truncated: {found} of {length} bytes")));
        }
        if found != length || PRELUDE + header + CHECKSUM > length {
            return Err(refused(DAMAGED.into()));
        }
        let header = checked(&mut file, &prelude, length, header).map_err(|e| match e.kind() {
            ErrorKind::InvalidData | ErrorKind::UnexpectedEof => refused(DAMAGED.into()),
            _ => Error::io(path, e),
        })?;
        let start = PRELUDE + header.len() as u64;
        let header: Header = serde_json::from_slice(&header).map_err(|e| refused(format!("not of this version of pt: {e}")))?;
        header.stored(path, start, length).ok_or_else(|| refused("what it says of itself makes no sense".into()))
    }

    /// Runs of samples without a gap.
    pub fn ranges(&self) -> Vec<Range<u64>> {
        let mut runs: Vec<Range<u64>> = vec![];
        for wave in &self.waves {
            match runs.last_mut() {
                Some(last) if last.end == wave.first => last.end = wave.range().end,
                _ => runs.push(wave.range()),
            }
        }
        runs
    }

    /// Which blocks it holds.
    pub(super) fn waves(&self) -> &[Wave] {
        &self.waves
    }

    /// The numbers of one block.
    ///
    /// # Errors
    /// `Io`; `Limit` where they do not fit into memory.
    pub(super) fn block(&self, index: usize) -> Result<Block> {
        let count = self.about.slots().all() * self.about.crop.pixel_count() as usize;
        let mut numbers: Vec<f64> = vec![];
        let full = |_| Error::Limit(Fault::new("its numbers do not fit into memory").in_file(&self.path));
        fallible(|| numbers.try_reserve_exact(count)).map_err(full)?;
        let mut read = || -> io::Result<()> {
            let mut file = File::open(&self.path)?;
            file.seek(SeekFrom::Start(self.start + 8 * (index * count) as u64))?;
            let mut file = BufReader::with_capacity(1 << 18, file);
            let mut bytes = [0; 8];
            for _ in 0..count {
                file.read_exact(&mut bytes)?;
                numbers.push(f64::from_le_bytes(bytes));
            }
            Ok(())
        };
        read().map_err(|e| Error::io(&self.path, e))?;
        Block::from_numbers(self.about.slots(), numbers).ok_or_else(|| Error::Internal("a share of a pixel".into()))
    }
}

const DAMAGED: &str = "damaged: its checksum is wrong";

fn number(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |sum, byte| (sum << 8) | u64::from(*byte))
}

/// The bytes of the header, where the checksum of the whole file is right.
fn checked(file: &mut impl Read, prelude: &[u8], length: u64, header: u64) -> io::Result<Vec<u8>> {
    let mut sum = Hasher::default();
    sum.bytes(prelude);
    let mut bytes = vec![];
    file.by_ref().take(header).read_to_end(&mut bytes)?;
    sum.bytes(&bytes);
    let (mut left, mut chunk) = (length - PRELUDE - header - CHECKSUM, vec![0; 1 << 16]);
    while left > 0 {
        let count = left.min(chunk.len() as u64) as usize;
        file.read_exact(&mut chunk[..count])?;
        sum.bytes(&chunk[..count]);
        left -= count as u64;
    }
    let mut stated = [0; CHECKSUM as usize];
    file.read_exact(&mut stated)?;
    if sum.finish().0.to_le_bytes() == stated { Ok(bytes) } else { Err(ErrorKind::InvalidData.into()) }
}

impl Header {
    /// `None` where it contradicts itself or the length of the file.
    fn stored(self, path: &Path, start: u64, length: u64) -> Option<Stored> {
        let [x0, x1, y0, y1] = self.crop;
        let [width, height] = self.size;
        let is_crop = x0 < x1 && x1 <= width && y0 < y1 && y1 <= height && width.max(height) <= LONGEST_SIDE;
        let spread = self.scramblings.map_or(Spread::Samples, Spread::Scramblings);
        let is_spread = self.scramblings.is_none_or(|k| k.is_power_of_two() && k <= 64);
        let layers = self.layers.iter().map(|name| Layer::named(name)).collect::<Option<Vec<Layer>>>()?;
        let layers = with_lights(&layers, self.lights.len());
        let crop = Crop { min: UVec2::new(x0, y0), max: UVec2::new(x1, y1) };
        let waves: Vec<Wave> = self.blocks.iter().map(|(first, level)| Wave { first: *first, level: *level }).collect();
        let is_wave = |wave: &Wave| wave.level < 63 && wave.first < 1 << 62 && wave.first.is_multiple_of(wave.samples());
        let in_order = |pair: &[Wave]| pair[0].range().end <= pair[1].first;
        let are_waves = !waves.is_empty() && waves.iter().all(is_wave) && waves.windows(2).all(in_order);
        let identity = Identity::from_facts(self.facts);
        let size = UVec2::new(width, height);
        let about = About { identity, build: self.build, size, crop, spread, layers, lights: self.lights, view: self.view };
        let is_complete = is_crop && is_spread && are_waves && self.numbers == about.slots().all();
        if !is_complete || about.identity.hash().to_string() != self.scene {
            return None;
        }
        let bytes = u128::from(crop.pixel_count()) * self.numbers as u128 * 8 * waves.len() as u128;
        let seconds = Duration::try_from_secs_f64(self.seconds).ok().filter(|_| u128::from(length - start - CHECKSUM) == bytes)?;
        let first_invalid = self.first_invalid.into_iter().map(|(pixel, index)| SampleId { pixel, index }).collect();
        let samples = waves.iter().map(Wave::samples).sum();
        Some(Stored {
            path: path.to_owned(),
            about,
            report: Report { samples, invalid: self.invalid, first_invalid, elapsed: seconds, ..Report::default() },
            course: Course { checkpoints: self.course.into_iter().map(|look| look.checkpoint()).collect::<Option<_>>()? },
            waves,
            start,
        })
    }
}

impl Look {
    fn new(checkpoint: &Checkpoint) -> Look {
        let error = |error: RelativeError| [error.value, error.spread, error.effective_pixels].map(|x| x.to_string());
        Look { samples: checkpoint.samples, seconds: checkpoint.seconds.to_string(), error: checkpoint.error.map(error) }
    }

    fn checkpoint(self) -> Option<Checkpoint> {
        let error = match self.error {
            None => None,
            Some([value, spread, effective]) => {
                Some(RelativeError { value: value.parse().ok()?, spread: spread.parse().ok()?, effective_pixels: effective.parse().ok()? })
            }
        };
        Some(Checkpoint { samples: self.samples, seconds: self.seconds.parse().ok()?, error })
    }
}
