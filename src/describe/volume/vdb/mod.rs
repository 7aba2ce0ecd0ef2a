//! Grids of OpenVDB files (`.vdb`): sparse trees of values, which become dense grids in the box around them.
//!
//! A voxel (i, j, k) has its value at scale · (i, j, k) + translation. Between the outermost voxels and the ones around them the value falls to
//! the background, which is 0, as OpenVDB interpolates it; so the box has one voxel more on each side.
//!
//! The file: a header, a descriptor of each grid with the places of its parts, and the grids. A grid has its own compression, metadata,
//! transform and tree. Source: OpenVDB 10, `io/Archive.cc`, `io/GridDescriptor.cc`, `math/Maps.h`.
//!
//! The reader is our own: the only one for Rust (`vdb-rs` 0.6) panics at files that it does not expect, and leaves out tiles of the root and
//! the background without a word.

mod bytes;
mod compression;
mod tree;

use std::collections::BTreeMap;

use glam::DVec3;

use self::bytes::Bytes;
use self::compression::Compression;
use self::tree::{Number, Region, Tree, Values};
use super::{Quantity, Request, Volume, by_axis, counted, invalid};
use crate::describe::ValuesAt;
use crate::{Error, Fault, Result};

/// First bytes of such a file.
pub const MAGIC: &[u8] = &[0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0];
/// Versions of the format, of the years since 2013.
const VERSIONS: std::ops::RangeInclusive<u32> = 222..=224;
/// Length of the identifier that a file has.
const UUID: usize = 36;
/// Number of values that a box may have for each byte of the file, and that it may have in any case: a damaged file of few bytes must not take
/// all memory. Clouds and smoke of films have about one for each byte; only files that consist of large tiles have more than a thousand.
const MOST_PER_BYTE: u64 = 1 << 10;
const ALWAYS: u64 = 1 << 24;
/// Character between the name of a grid and a number, where several grids have the same name.
const SEPARATOR: char = '\u{1e}';

/// Where the parts of a grid are.
struct Descriptor {
    /// The name, with the number in brackets where several grids have the same name.
    name: String,
    /// Type of the tree.
    kind: String,
    /// Unique name of the grid whose tree this one shares, or nothing.
    parent: String,
    /// The name, and a number after a separator where several grids have the same name.
    unique_name: String,
    grid: u64,
    of_leaves: u64,
}

/// Reads a grid.
///
/// # Errors
/// `Invalid` where the content is not that of such a file; `Limit` for too many values.
pub fn read(content: &[u8], request: Request) -> Result<Volume> {
    let Request { quantity, grid, bounds: expected, values_at, .. } = request;
    if values_at == ValuesAt::Corners {
        return invalid("the values of an OpenVDB file are in the centres of its voxels: leave \"values_at\" out");
    }
    let mut bytes = Bytes::new(content);
    let descriptors = descriptors(&mut bytes)?;
    let descriptor = selected(&descriptors, quantity, grid)?;
    let name = &descriptor.name;
    let mut values = values(descriptor, quantity)?;

    let mut header = bytes.at(descriptor.grid)?;
    values.compression = Compression::read_flags(&mut header)?;
    let metadata = metadata(&mut header)?;
    if metadata.get("class").is_some_and(|class| *class == b"level set") {
        return invalid(format!("the grid {name:?} is a level set, which holds distances from a surface: expected a fog volume"));
    }
    let map = Map::read(&mut header)?;
    let mut of_leaves = bytes.at(descriptor.of_leaves)?;
    if !descriptor.parent.is_empty() {
        let parent = descriptors.iter().find(|other| other.unique_name == descriptor.parent && other.parent.is_empty());
        let Some(parent) = parent else { return invalid(format!("the grid {name:?} shares the tree of a missing one")) };
        header = bytes.at(parent.grid)?;
        values.compression = Compression::read_flags(&mut header)?;
        self::metadata(&mut header)?;
        Map::read(&mut header)?;
        of_leaves = bytes.at(parent.of_leaves)?;
    }
    let tree = Tree::read(&mut header, values, of_leaves)?;
    if tree.background.iter().any(|x| *x != 0.0) {
        return invalid(format!("the grid {name:?} has the background {:?}: expected 0, as outside of the grid's box", tree.background));
    }
    let region = match expected {
        None => tree.occupied()?.map(|region| Region { low: region.low - 1, high: region.high + 1 }),
        Some([low, high]) => Some(map.region([low, high]).ok_or_else(|| {
            let message = format!("the grid {name:?} has no voxels that fill the box of the density, from {low} to {high}");
            Error::invalid(Fault::new(format!("{message}: expected voxels of the same size and place, as in one file with the density")))
        })?),
    };
    let Some(region) = region else { return invalid(format!("the grid {name:?} has no values but the background")) };
    let size = region.size();
    let most = ALWAYS.max(MOST_PER_BYTE * content.len() as u64);
    if counted(size)? as u64 > most {
        let (size, bytes) = (by_axis(size), content.len());
        let message = format!("the grid {name:?} has a box of {size} voxels: at most {most} are made from a file of {bytes} bytes");
        return Err(Error::Limit(Fault::new(message)));
    }
    let bounds = Some(map.bounds(region));
    Ok(Volume { size, channels: values.channels, values: tree.dense(region)?, bounds })
}

/// Reads the header of the file and the descriptors of all grids.
fn descriptors(bytes: &mut Bytes) -> Result<Vec<Descriptor>> {
    bytes.take(MAGIC.len())?;
    let version = bytes.u32()?;
    if !VERSIONS.contains(&version) {
        return invalid(format!("expected a version of OpenVDB's format from {} to {}, found {version}", VERSIONS.start(), VERSIONS.end()));
    }
    // The version of the library.
    bytes.take(8)?;
    if bytes.u8()? == 0 {
        return invalid("a stream of OpenVDB, which does not say where its grids are: save it as a file");
    }
    bytes.take(UUID)?;
    metadata(bytes)?;
    let count = bytes.u32()?;
    let mut descriptors = vec![];
    for _ in 0..count {
        let (unique_name, kind, parent) = (bytes.string()?, bytes.string()?, bytes.string()?);
        let [grid, of_leaves, end] = [bytes.u64()?, bytes.u64()?, bytes.u64()?];
        // OpenVDB's own programs print such a name with its number in brackets, as "density[1]".
        let name = match unique_name.split_once(SEPARATOR) {
            Some((name, number)) => format!("{name}[{number}]"),
            None => unique_name.clone(),
        };
        descriptors.push(Descriptor { name, kind, parent, unique_name, grid, of_leaves });
        let after = bytes.at(end)?;
        if !after.is_beyond(bytes) {
            return invalid(format!("the descriptor of the grid {:?} ends before it begins", descriptors[descriptors.len() - 1].name));
        }
        *bytes = after;
    }
    Ok(descriptors)
}

/// The grid of that name; without a name that of the density, or the only one.
fn selected<'d>(descriptors: &'d [Descriptor], quantity: Quantity, name: Option<&str>) -> Result<&'d Descriptor> {
    let wanted = name.or_else(|| (quantity == Quantity::Density && descriptors.len() > 1).then_some("density"));
    // A name without a number is enough where only one grid has it.
    let has_name = |descriptor: &&Descriptor| {
        wanted.is_none_or(|wanted| wanted == descriptor.name || descriptor.unique_name.split(SEPARATOR).next() == Some(wanted))
    };
    let of_name: Vec<&Descriptor> = descriptors.iter().filter(has_name).collect();
    if let [only] = of_name[..] {
        return Ok(only);
    }
    if let Some(exact) = of_name.iter().find(|descriptor| wanted == Some(&descriptor.name)) {
        return Ok(exact);
    }
    let names: Vec<String> = descriptors.iter().map(|descriptor| format!("{:?}", descriptor.name)).collect();
    let names = if names.is_empty() { "no grids".to_owned() } else { format!("the grids {}", names.join(", ")) };
    match name {
        Some(name) if of_name.is_empty() => invalid(format!("no grid {name:?}: the file has {names}")),
        _ => invalid(format!("the file has {names}: say which one by \"grid\"")),
    }
}

/// How the values of a grid are stored, but for their compression.
fn values(Descriptor { name, kind, .. }: &Descriptor, quantity: Quantity) -> Result<Values> {
    let (tree, is_half) = kind.strip_suffix("_HalfFloat").map_or((kind.as_str(), false), |tree| (tree, true));
    let known = match tree {
        "Tree_float_5_4_3" => Some((if is_half { Number::Half } else { Number::Single }, 1)),
        "Tree_vec3s_5_4_3" => Some((if is_half { Number::Half } else { Number::Single }, 3)),
        // Doubles saved as halves are not read: single values, such as the background, would have 64 bits there, and not 32.
        "Tree_double_5_4_3" if !is_half => Some((Number::Double, 1)),
        _ => None,
    };
    match known {
        Some((number, channels)) if quantity.has_channels(channels) => Ok(Values { number, channels, compression: Compression::default() }),
        Some(_) => invalid(format!("the grid {name:?} has three channels: expected {}", quantity.possible_channels())),
        None => invalid(format!("the grid {name:?} is of type {kind:?}: expected Tree_float_5_4_3, Tree_double_5_4_3 or Tree_vec3s_5_4_3")),
    }
}

/// Reads metadata: names and the bytes of their values.
fn metadata<'c>(bytes: &mut Bytes<'c>) -> Result<BTreeMap<String, &'c [u8]>> {
    let count = bytes.u32()?;
    let mut metadata = BTreeMap::new();
    for _ in 0..count {
        let (name, _) = (bytes.string()?, bytes.string()?);
        let length = bytes.u32()? as usize;
        metadata.insert(name, bytes.take(length)?);
    }
    Ok(metadata)
}

/// Places the voxels: scale · (i, j, k) + translation (m).
struct Map {
    scale: DVec3,
    translation: DVec3,
}

impl Map {
    fn read(bytes: &mut Bytes) -> Result<Map> {
        let kind = bytes.string()?;
        let mut vector = || Ok(DVec3::new(bytes.f64()?, bytes.f64()?, bytes.f64()?));
        let map = match kind.as_str() {
            "UniformScaleMap" | "ScaleMap" => {
                let scale = vector()?;
                // The size of a voxel and three vectors that follow from the scale.
                (0..4).try_for_each(|_| vector().map(drop))?;
                Map { scale, translation: DVec3::ZERO }
            }
            "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
                let (translation, scale) = (vector()?, vector()?);
                (0..4).try_for_each(|_| vector().map(drop))?;
                Map { scale, translation }
            }
            "TranslationMap" => Map { scale: DVec3::ONE, translation: vector()? },
            "AffineMap" => {
                let mut rows = [[0.0; 4]; 4];
                rows.iter_mut().flatten().try_for_each(|x| bytes.f64().map(|number| *x = number))?;
                let [[a, b, c, _], [d, e, f, _], [g, h, i, _], [x, y, z, _]] = rows;
                if [b, c, d, f, g, h].iter().any(|x| *x != 0.0) {
                    return invalid("a turned grid: expected one along the axes, which the \"transform\" of the density may turn");
                }
                Map { scale: DVec3::new(a, e, i), translation: DVec3::new(x, y, z) }
            }
            _ => return invalid(format!("voxels placed by {kind:?}: expected a scale and a translation")),
        };
        // Boxes of voxels must have finite corners too.
        let is_possible = map.scale.min_element() > 0.0 && (map.scale * f64::from(u32::MAX)).is_finite() && map.translation.is_finite();
        if is_possible { Ok(map) } else { invalid(format!("expected voxels of finite sizes above 0, found {}", map.scale)) }
    }

    /// The box of the voxels of a region.
    fn bounds(&self, region: Region) -> [DVec3; 2] {
        [region.low.as_dvec3() - 0.5, region.high.as_dvec3() + 0.5].map(|corner| self.scale * corner + self.translation)
    }

    /// The region that has this box; `None` if none has.
    fn region(&self, bounds: [DVec3; 2]) -> Option<Region> {
        let voxel = |corner: DVec3, step: f64| ((corner - self.translation) / self.scale + step).round();
        let [low, high] = [voxel(bounds[0], 0.5), voxel(bounds[1], -0.5)];
        let limit = f64::from(i32::MAX / 2);
        let is_possible = [low, high].iter().all(|corner| corner.abs().max_element() < limit) && low.cmple(high).all();
        let region = Region { low: low.as_ivec3(), high: high.as_ivec3() };
        (is_possible && self.bounds(region) == bounds).then_some(region)
    }
}
