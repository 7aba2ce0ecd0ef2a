//! Reading and writing of `.ptc` files.
//!
//! ```text
//! 89 50 54 32 0d 0a 1a 0a     signature, which also detects damage by text filters
//! u32   bytes of the header
//! header, JSON in UTF-8       see `Header`
//! u32, bytes                  if the numbers of samples differ: the level of each pixel, a byte each, packed by deflate (RFC 1951)
//! u32, bytes …                chunk after chunk of each block, pixel after pixel, as `planes::encode`
//! u128  XXH3                  hash of all bytes before it
//! ```
//!
//! All numbers are little-endian. The sizes of all chunks but in bytes follow from the header, so that a file never takes more memory than
//! the picture that it tells of.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Cursor, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use glam::UVec2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tempfile::{NamedTempFile, TempPath};

use super::planes::{chunk_pixels, decode, deflated, encode, inflated};
use super::{About, Job};
use crate::describe::Identity;
use crate::error::{Error, Fault, Result};
use crate::film::layer::with_lights;
use crate::film::{Allocation, Crop, Film, Layer, MomentFilm, PixelSums, SampleSet, Wave};
use crate::math::hash::{Hash, Hasher};
use crate::measure::{Checkpoint, ErrorHistory, RelativeError};
use crate::output::{self, Attributes};
use crate::render::{RenderReport, SampleId};
use crate::sampler::{ErrorEstimator, Kind};

const MAGIC: [u8; 8] = *b"\x89PT2\r\n\x1a\n";
/// Signature of the files of earlier versions, whose numbers were not packed.
const OLD_MAGIC: [u8; 8] = *b"\x89PTC\r\n\x1a\n";
/// Bytes before the header.
const PRELUDE: u64 = 8 + 4;
/// Bytes of the hash.
const CHECKSUM: u64 = 16;
/// Greatest number of bytes that deflate packs into one, by its format.
const MOST_PACKED: u64 = 1032;
/// Samples of a block at most, and index of its first sample, as powers of two. A round may have 2⁶ samples of a pixel.
const MAX_WAVE: u32 = 56;
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
    /// Whether the pixels have different numbers of samples.
    #[serde(default)]
    adaptive: bool,
    view: Attributes,
    /// Words of the command that renders the picture, after `pt`, and its rounds of samples.
    command: Vec<String>,
    planned: u64,
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
/// # Errors
/// `Io`.
pub fn write(path: &Path, about: &About, film: &MomentFilm, report: &RenderReport, history: &ErrorHistory) -> Result<()> {
    let header = header(about, film, report, history)?;
    output::replace_with(path, |file| put(file, &header, film))
}

/// Writes the sums of some samples to a pipe or the like.
///
/// - `name`: name of it, for messages
///
/// # Errors
/// `Io`.
pub fn write_to(to: impl Write, name: &str, about: &About, film: &MomentFilm, report: &RenderReport, history: &ErrorHistory) -> Result<()> {
    put(to, &header(about, film, report, history)?, film).map_err(|e| Error::io(name, e))
}

/// The bytes of the header.
fn header(about: &About, film: &MomentFilm, report: &RenderReport, history: &ErrorHistory) -> Result<Vec<u8>> {
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
        adaptive: !film.spec().allocation.is_even(),
        view: about.view.clone(),
        command: about.job.command.clone(),
        planned: about.job.samples,
        numbers: about.layout().all(),
        blocks: film.blocks().map(|(wave, _)| (wave.first, wave.level)).collect(),
        seconds: report.elapsed.as_secs_f64(),
        invalid: report.invalid,
        first_invalid: report.first_invalid.iter().map(|id| (id.pixel, id.index)).collect(),
        history: history.planned().map(StoredCheckpoint::new).collect(),
    };
    serde_json::to_vec(&header).map_err(|e| Error::Internal(format!("a header cannot be written: {e}")))
}

/// Chunks that each thread packs before they are written.
const CHUNKS_PER_THREAD: usize = 4;

/// Writes all bytes of a file.
fn put(to: impl Write, header: &[u8], film: &MomentFilm) -> io::Result<()> {
    let mut file = Summed { to: BufWriter::with_capacity(1 << 18, to), sum: Hasher::default() };
    file.put(&MAGIC)?;
    file.put(&(header.len() as u32).to_le_bytes())?;
    file.put(header)?;
    if let Some(levels) = film.spec().allocation.all() {
        file.put_chunk(&deflated(levels))?;
    }
    for (_, block) in film.blocks() {
        let width = block.layout().all();
        let chunks: Vec<&[f64]> = block.numbers().chunks(chunk_pixels(width) * width).collect();
        for some in chunks.chunks(CHUNKS_PER_THREAD * rayon::current_num_threads()) {
            for bytes in some.par_iter().map(|numbers| encode(numbers, width)).collect::<Vec<_>>() {
                file.put_chunk(&bytes)?;
            }
        }
    }
    let sum = file.sum.finish().0.to_le_bytes();
    file.put(&sum)?;
    file.to.flush()
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

    /// Writes the length of some bytes, and then the bytes.
    fn put_chunk(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.put(&(bytes.len() as u32).to_le_bytes())?;
        self.put(bytes)
    }
}

/// File that was checked. Its numbers are not in memory.
#[derive(Debug)]
pub struct Stored {
    /// Path of the file, or what stands for it in messages.
    pub path: PathBuf,
    /// Picture that the file belongs to.
    pub about: About,
    /// Report of the render.
    pub report: RenderReport,
    /// Checkpoints of the render.
    pub history: ErrorHistory,
    waves: Vec<Wave>,
    chunks: Chunks,
    source: Source,
}

/// Where the numbers of a part are.
#[derive(Debug)]
enum Source {
    /// In its file, which is opened for each chunk, so that there may be more parts than open files.
    Path,
    /// In a file with what came from a pipe.
    Spooled(TempPath),
    /// In a file that was kept open.
    Held(Mutex<File>),
    /// In memory.
    Memory(Arc<Vec<u8>>),
}

/// Places of the chunks in a file.
#[derive(Debug)]
struct Chunks {
    /// Position and length of each chunk, block after block (bytes).
    places: Vec<(u64, u32)>,
    /// Hash of all of them.
    hash: Hash,
}

impl Stored {
    /// Opens a file and checks everything but the values of the numbers.
    ///
    /// # Errors
    /// `Invalid` for files that are missing, of another kind, truncated, damaged or of another version; `Io`.
    pub fn open(path: &Path) -> Result<Stored> {
        Stored::checked(output::regular(path)?, path, Source::Path)
    }

    /// Opens a file as [`Stored::open`] does, and keeps it open: if another process replaces it, the numbers are still those of the file that
    /// was checked.
    ///
    /// # Errors
    /// Those of [`Stored::open`].
    pub fn hold(path: &Path) -> Result<Stored> {
        let file = output::regular(path)?;
        let held = file.try_clone().map_err(|e| Error::io(path, e))?;
        Stored::checked(file, path, Source::Held(Mutex::new(held)))
    }

    /// Takes a file from a pipe into a temporary file, and checks it as [`Stored::open`] does.
    ///
    /// - `name`: name of the pipe, for messages
    ///
    /// # Errors
    /// Those of [`Stored::open`].
    pub fn receive(from: &mut impl Read, name: &str) -> Result<Stored> {
        let failed = |e| Error::io(name, e);
        let mut file = NamedTempFile::new().map_err(failed)?;
        io::copy(from, file.as_file_mut()).map_err(failed)?;
        let spooled = file.into_temp_path();
        Stored::checked(output::regular(&spooled)?, Path::new(name), Source::Spooled(spooled))
    }

    /// Takes the bytes of a file, and checks them as [`Stored::open`] does.
    ///
    /// - `name`: what they are called in messages
    ///
    /// # Errors
    /// Those of [`Stored::open`].
    pub fn of_bytes(bytes: &Arc<Vec<u8>>, name: &str) -> Result<Stored> {
        Stored::checked(Cursor::new(&bytes[..]), Path::new(name), Source::Memory(bytes.clone()))
    }

    /// Checks a file.
    ///
    /// - `path`: its name, for messages
    fn checked(mut file: impl Read + Seek, path: &Path, source: Source) -> Result<Stored> {
        let refused = |message: String| Error::invalid(Fault::new(message).in_file(path));
        let failed = |e: io::Error| match e.kind() {
            // It has become shorter.
            io::ErrorKind::UnexpectedEof => refused(DAMAGED.into()),
            _ => Error::io(path, e),
        };
        let length = file.seek(SeekFrom::End(0)).map_err(failed)?;
        file.rewind().map_err(failed)?;
        let mut file = BufReader::with_capacity(1 << 18, file);
        let mut prelude = [0; PRELUDE as usize];
        let is_read = file.read_exact(&mut prelude).is_ok();
        if is_read && prelude.starts_with(&OLD_MAGIC) {
            return Err(refused("of an earlier version of pt, expected a part of this one: merge it with the pt that rendered it".into()));
        }
        if !is_read || !prelude.starts_with(&MAGIC) {
            return Err(refused("expected a part of a render (.ptc)".into()));
        }
        let start = PRELUDE + number(&prelude[8..]);
        let truncated = || refused(format!("truncated: {length} bytes are not all"));
        let end = length.checked_sub(CHECKSUM).filter(|end| start <= *end).ok_or_else(truncated)?;
        let mut header = vec![];
        file.by_ref().take(start - PRELUDE).read_to_end(&mut header).map_err(failed)?;
        let (is_right, hash) = hashes(&mut file, [&prelude, &header], end - start).map_err(failed)?;
        let parsed = serde_json::from_slice::<Header>(&header);
        let places = match parsed.as_ref().ok().and_then(Header::chunk_count) {
            None => None,
            Some(count) => Some(places(&mut file, start..end, count).map_err(failed)?),
        };
        match (is_right, parsed, places) {
            (false, _, Some(Places::Beyond)) => Err(truncated()),
            (false, ..) => Err(refused(DAMAGED.into())),
            (true, Err(e), _) => Err(refused(format!("not of this version of pt: {e}"))),
            (true, Ok(header), Some(Places::All(mut places))) => {
                let allocation = match header.adaptive {
                    true => header.allocation(&mut file, places.remove(0)).map_err(failed)?,
                    false => Some(Allocation::default()),
                };
                let stored = allocation.and_then(|allocation| header.stored(path, allocation, Chunks { places, hash }, source));
                stored.ok_or_else(|| refused(NONSENSE.into()))
            }
            (true, Ok(_), _) => Err(refused(NONSENSE.into())),
        }
    }

    /// Ranges of samples without gaps.
    pub fn ranges(&self) -> Vec<Range<u64>> {
        SampleSet::of(self.waves.iter().map(Wave::range)).ranges().to_vec()
    }

    /// Shares the memory of the numbers of samples of the pixels with another part, if both have the same.
    pub fn share_allocation(&mut self, other: &Stored) {
        if self.about.allocation == other.about.allocation {
            self.about.allocation = other.about.allocation.clone();
        }
    }

    /// Blocks in the file.
    pub(super) fn waves(&self) -> &[Wave] {
        &self.waves
    }

    /// Whether the other part has the same numbers for the same samples.
    pub(super) fn is_same(&self, other: &Stored) -> bool {
        (&self.waves, self.chunks.hash) == (&other.waves, other.chunks.hash)
    }

    /// Reads the sums of the pixels of one chunk of a block.
    ///
    /// # Errors
    /// `Io`; `Invalid` for bytes that are no sums, or for which there is no memory.
    pub(super) fn chunk(&self, block: usize, chunk: Range<usize>) -> Result<PixelSums> {
        let layout = self.about.layout();
        let each = (self.about.crop.pixel_count() as usize).div_ceil(chunk_pixels(layout.all()));
        let index = block * each + chunk.start / chunk_pixels(layout.all());
        let (start, length) = self.chunks.places.get(index).copied().ok_or_else(|| Error::Internal("a chunk beyond the last".into()))?;
        let read = |file: &mut File| -> io::Result<Cow<[u8]>> {
            file.seek(SeekFrom::Start(start))?;
            let mut bytes = vec![];
            file.take(length.into()).read_to_end(&mut bytes)?;
            Ok(Cow::Owned(bytes))
        };
        let bytes = match &self.source {
            Source::Path => File::open(&self.path).and_then(|mut file| read(&mut file)),
            Source::Spooled(path) => File::open(path).and_then(|mut file| read(&mut file)),
            Source::Held(file) => read(&mut file.lock().unwrap_or_else(PoisonError::into_inner)),
            Source::Memory(bytes) => Ok(Cow::Borrowed(&bytes[start as usize..][..length as usize])),
        };
        let bytes = bytes.map_err(|e| Error::io(&self.path, e))?;
        let numbers = decode(&bytes, layout.all(), chunk.len());
        let sums = numbers.and_then(|numbers| PixelSums::from_numbers(layout, numbers));
        sums.ok_or_else(|| Error::invalid(Fault::new(NO_SUMS).in_file(&self.path)))
    }
}

const DAMAGED: &str = "damaged: its checksum is wrong";
const NONSENSE: &str = "what it says of itself makes no sense";
const NO_SUMS: &str = "its numbers cannot be unpacked: they make no sense, have changed, or memory is full";

/// Little-endian number.
fn number(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |sum, byte| (sum << 8) | u64::from(*byte))
}

/// Reads the rest of a file. Returns whether its checksum is right, and the hash of what it read.
///
/// - `before`: bytes before the rest; `length`: bytes of the rest without the checksum
fn hashes(file: &mut impl Read, before: [&[u8]; 2], length: u64) -> io::Result<(bool, Hash)> {
    let (mut all, mut rest) = (Hasher::default(), Hasher::default());
    before.iter().for_each(|bytes| all.bytes(bytes));
    let (mut left, mut piece) = (length, vec![0; 1 << 16]);
    while left > 0 {
        let count = left.min(piece.len() as u64) as usize;
        file.read_exact(&mut piece[..count])?;
        all.bytes(&piece[..count]);
        rest.bytes(&piece[..count]);
        left -= count as u64;
    }
    let mut stated = [0; CHECKSUM as usize];
    file.read_exact(&mut stated)?;
    Ok((all.finish().0.to_le_bytes() == stated, rest.finish()))
}

/// Chunks that were looked for in a file.
enum Places {
    /// Position and length of each (bytes). They fill the file.
    All(Vec<(u64, u32)>),
    /// They do not end within the file.
    Beyond,
    /// They end before the file does.
    Short,
}

/// Finds `count` chunks.
///
/// - `bytes`: range of the file that they fill
fn places(file: &mut BufReader<impl Read + Seek>, bytes: Range<u64>, count: u64) -> io::Result<Places> {
    // Each takes four bytes at least, so that no more of them are remembered than the file has room for.
    let (mut places, mut at) = (vec![], bytes.start);
    file.seek(SeekFrom::Start(at))?;
    for _ in 0..count {
        let mut length = [0; 4];
        if at + 4 > bytes.end {
            return Ok(Places::Beyond);
        }
        file.read_exact(&mut length)?;
        let length = u32::from_le_bytes(length);
        places.push((at + 4, length));
        at += 4 + u64::from(length);
        file.seek_relative(length.into())?;
    }
    Ok(match at.cmp(&bytes.end) {
        std::cmp::Ordering::Equal => Places::All(places),
        std::cmp::Ordering::Greater => Places::Beyond,
        std::cmp::Ordering::Less => Places::Short,
    })
}

impl Header {
    /// Number of chunks that the header asks for; `None` for more than any file has.
    fn chunk_count(&self) -> Option<u64> {
        let of_blocks = self.pixels()?.div_ceil(chunk_pixels(self.numbers) as u64).checked_mul(self.blocks.len() as u64)?;
        of_blocks.checked_add(self.adaptive.into())
    }

    /// Number of pixels; `None` for a crop that is empty or not within the picture, and for pictures that are too large.
    fn pixels(&self) -> Option<u64> {
        let ([x0, x1, y0, y1], [width, height]) = (self.crop, self.size);
        let is_crop = x0 < x1 && x1 <= width && y0 < y1 && y1 <= height && width.max(height) <= MAX_SIDE;
        is_crop.then(|| u64::from(x1 - x0) * u64::from(y1 - y0))
    }

    /// Reads the numbers of samples of the pixels; `None` for bytes that are none.
    ///
    /// - `place`: position and length of their chunk (bytes)
    fn allocation(&self, file: &mut BufReader<impl Read + Seek>, (start, length): (u64, u32)) -> io::Result<Option<Allocation>> {
        let mut bytes = vec![];
        file.seek(SeekFrom::Start(start))?;
        file.take(length.into()).read_to_end(&mut bytes)?;
        let pixels = self.pixels().filter(|pixels| *pixels <= MOST_PACKED * u64::from(length));
        let levels = pixels.and_then(|pixels| inflated(&bytes, pixels as usize));
        let levels = levels.filter(|levels| levels.iter().all(|level| *level <= Allocation::MAX_LEVEL));
        Ok(levels.map(Allocation::new))
    }

    /// The file with this header and these chunks; `None` if the header contradicts itself.
    fn stored(self, path: &Path, allocation: Allocation, chunks: Chunks, source: Source) -> Option<Stored> {
        let [x0, x1, y0, y1] = self.crop;
        let [width, height] = self.size;
        let is_crop = self.pixels().is_some();
        let error_estimator = self.scramblings.map_or(ErrorEstimator::Samples, ErrorEstimator::Scramblings);
        let is_scrambled = self.scramblings.is_none_or(|k| k.is_power_of_two() && k <= 64);
        let layers = self.layers.iter().map(|name| Layer::named(name)).collect::<Option<Vec<Layer>>>()?;
        let layers = with_lights(&layers, self.lights.len());
        let crop = Crop { min: UVec2::new(x0, y0), max: UVec2::new(x1, y1) };
        let waves: Vec<Wave> = self.blocks.iter().map(|(first, level)| Wave { first: *first, level: *level }).collect();
        let is_wave = |wave: &Wave| wave.level <= MAX_WAVE && wave.first < 1 << MAX_WAVE && wave.first.is_multiple_of(wave.samples());
        let in_order = |pair: &[Wave]| pair[0].range().end <= pair[1].first;
        let are_waves = !waves.is_empty() && waves.iter().all(is_wave) && waves.windows(2).all(in_order);
        let identity = Identity::from_facts(self.facts);
        let job = Job { command: self.command, samples: self.planned };
        let size = UVec2::new(width, height);
        let (build, lights, view) = (self.build, self.lights, self.view);
        let about = About { identity, build, size, crop, error_estimator, layers, lights, allocation, view, job };
        let is_complete = is_crop && is_scrambled && are_waves && self.numbers == about.layout().all();
        if !is_complete || about.identity.hash().to_string() != self.scene {
            return None;
        }
        let seconds = Duration::try_from_secs_f64(self.seconds).ok()?;
        let sampler = about.identity.fact("/sampler/type").and_then(|name| Kind::named(&name)).unwrap_or_default();
        let first_invalid = self.first_invalid.into_iter().map(|(pixel, index)| SampleId { pixel, index }).collect();
        let samples = waves.iter().map(Wave::samples).sum();
        Some(Stored {
            path: path.to_owned(),
            about,
            report: RenderReport { samples, invalid: self.invalid, first_invalid, elapsed: seconds, ..RenderReport::default() },
            history: ErrorHistory {
                checkpoints: self.history.into_iter().map(|stored| stored.checkpoint()).collect::<Option<_>>()?,
                sampler,
            },
            waves,
            chunks,
            source,
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
