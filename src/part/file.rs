//! Reading and writing of `.ptc` files.
//!
//! ```text
//! 89 50 54 43 0d 0a 1a 0a     signature, which also detects damage by text filters
//! u64   bytes of the file     detects truncated files
//! u32   bytes of the header
//! header, JSON in UTF-8       see `Header`
//! f64 …                       block after block, pixel after pixel, as `PixelSums::numbers`
//! u128  XXH3                  hash of all bytes before it
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
use crate::film::{Crop, Layer, MomentFilm, PixelSums, Wave};
use crate::math::hash::Hasher;
use crate::measure::{Checkpoint, ErrorHistory, RelativeError};
use crate::output::{self, Attributes};
use crate::render::{RenderReport, SampleId};
use crate::sampler::ErrorEstimator;

const MAGIC: [u8; 8] = *b"\x89PTC\r\n\x1a\n";
/// Bytes before the header.
const PRELUDE: u64 = 8 + 8 + 4;
/// Bytes of the hash.
const CHECKSUM: u64 = 16;
/// Greatest width and height of a picture (pixels).
const MAX_SIDE: u32 = 1 << 16;

/// Header of a file.
#[derive(Serialize, Deserialize)]
struct Header {
    build: String,
    /// Hash of `facts`.
    scene: String,
    facts: Value,
    size: [u32; 2],
    /// `[x0, x1, y0, y1]`
    crop: [u32; 4],
    /// Number of scramblings; `null` if all samples are independent.
    scramblings: Option<u32>,
    /// Names of the layers. The layers of all lights share one name.
    layers: Vec<String>,
    lights: Vec<String>,
    view: Attributes,
    /// Numbers per pixel of a block.
    numbers: usize,
    /// `[first sample, level]`
    blocks: Vec<(u64, u32)>,
    /// Time of rendering (s).
    seconds: f64,
    invalid: u64,
    first_invalid: Vec<((u32, u32), u64)>,
    #[serde(rename = "course")]
    history: Vec<StoredCheckpoint>,
}

fn names(layers: &[Layer]) -> Vec<String> {
    let mut names: Vec<String> = layers.iter().map(|layer| layer.name().to_owned()).collect();
    names.dedup();
    names
}

/// Checkpoint with its numbers as text, which keeps all digits and infinities.
#[derive(Serialize, Deserialize)]
struct StoredCheckpoint {
    samples: u64,
    seconds: String,
    /// Value, spread, effective pixels.
    error: Option<[String; 3]>,
}

/// Writes the sums of some samples. An existing file is replaced when the new one is complete.
///
/// - `films`: runs of samples, in order
///
/// # Errors
/// `Io`.
pub fn write(path: &Path, about: &About, films: &[&MomentFilm], report: &RenderReport, history: &ErrorHistory) -> Result<()> {
    let blocks = || films.iter().flat_map(|film| film.blocks());
    let crop = about.crop;
    let header = Header {
        build: about.build.clone(),
        scene: about.identity.hash().to_string(),
        facts: about.identity.facts().clone(),
        size: about.size.to_array(),
        crop: [crop.min.x, crop.max.x, crop.min.y, crop.max.y],
        scramblings: match about.error_estimator {
            ErrorEstimator::Samples => None,
            ErrorEstimator::Scramblings(k) => Some(k),
        },
        layers: names(&about.layers),
        lights: about.lights.clone(),
        view: about.view.clone(),
        numbers: about.layout().all(),
        blocks: blocks().map(|(wave, _)| (wave.first, wave.level)).collect(),
        seconds: report.elapsed.as_secs_f64(),
        invalid: report.invalid,
        first_invalid: report.first_invalid.iter().map(|id| (id.pixel, id.index)).collect(),
        history: history.planned().map(StoredCheckpoint::new).collect(),
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

/// Writer that hashes what it writes.
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

/// File that was checked. Its numbers are not in memory.
#[derive(Debug)]
pub struct Stored {
    /// Path of the file.
    pub path: PathBuf,
    /// Picture that the file belongs to.
    pub about: About,
    /// Report of the render.
    pub report: RenderReport,
    /// Checkpoints of the render.
    pub history: ErrorHistory,
    waves: Vec<Wave>,
    /// Position of the first number in the file (bytes).
    start: u64,
}

impl Stored {
    /// Opens a file and checks everything but the values of the numbers.
    ///
    /// # Errors
    /// `Invalid` for files that are missing, of another kind, truncated, damaged or of another version; `Io`.
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

    /// Ranges of samples without gaps.
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

    /// Blocks in the file.
    pub(super) fn waves(&self) -> &[Wave] {
        &self.waves
    }

    /// Reads the sums of one block.
    ///
    /// # Errors
    /// `Io`; `Limit` if the numbers do not fit into memory.
    pub(super) fn block(&self, index: usize) -> Result<PixelSums> {
        let count = self.about.layout().all() * self.about.crop.pixel_count() as usize;
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
        PixelSums::from_numbers(self.about.layout(), numbers).ok_or_else(|| Error::Internal("a share of a pixel".into()))
    }
}

const DAMAGED: &str = "damaged: its checksum is wrong";

/// Little-endian number.
fn number(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |sum, byte| (sum << 8) | u64::from(*byte))
}

/// Reads the header, and the rest of the file to check its hash.
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
    /// The file with this header; `None` if the header contradicts itself or the length of the file.
    fn stored(self, path: &Path, start: u64, length: u64) -> Option<Stored> {
        let [x0, x1, y0, y1] = self.crop;
        let [width, height] = self.size;
        let is_crop = x0 < x1 && x1 <= width && y0 < y1 && y1 <= height && width.max(height) <= MAX_SIDE;
        let error_estimator = self.scramblings.map_or(ErrorEstimator::Samples, ErrorEstimator::Scramblings);
        let is_scrambled = self.scramblings.is_none_or(|k| k.is_power_of_two() && k <= 64);
        let layers = self.layers.iter().map(|name| Layer::named(name)).collect::<Option<Vec<Layer>>>()?;
        let layers = with_lights(&layers, self.lights.len());
        let crop = Crop { min: UVec2::new(x0, y0), max: UVec2::new(x1, y1) };
        let waves: Vec<Wave> = self.blocks.iter().map(|(first, level)| Wave { first: *first, level: *level }).collect();
        let is_wave = |wave: &Wave| wave.level < 63 && wave.first < 1 << 62 && wave.first.is_multiple_of(wave.samples());
        let in_order = |pair: &[Wave]| pair[0].range().end <= pair[1].first;
        let are_waves = !waves.is_empty() && waves.iter().all(is_wave) && waves.windows(2).all(in_order);
        let identity = Identity::from_facts(self.facts);
        let size = UVec2::new(width, height);
        let about = About { identity, build: self.build, size, crop, error_estimator, layers, lights: self.lights, view: self.view };
        let is_complete = is_crop && is_scrambled && are_waves && self.numbers == about.layout().all();
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
            report: RenderReport { samples, invalid: self.invalid, first_invalid, elapsed: seconds, ..RenderReport::default() },
            history: ErrorHistory {
                checkpoints: self.history.into_iter().map(|stored| stored.checkpoint()).collect::<Option<_>>()?,
                is_independent: error_estimator == ErrorEstimator::Samples,
            },
            waves,
            start,
        })
    }
}

impl StoredCheckpoint {
    fn new(checkpoint: &Checkpoint) -> StoredCheckpoint {
        let error = |error: RelativeError| [error.value, error.spread, error.effective_pixels].map(|x| x.to_string());
        StoredCheckpoint { samples: checkpoint.samples, seconds: checkpoint.seconds.to_string(), error: checkpoint.error.map(error) }
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
