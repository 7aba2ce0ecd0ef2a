//! The tree of a grid: a root, nodes of 32³ and of 16³ entries, and leaves of 8³ voxels. An entry is a node of the next level, or a tile, which
//! has the same value everywhere. Voxels and tiles are active or not; what the tree does not have has the background's value.
//!
//! ```text
//! root → entry of a node of 32³: 128³ voxels → entry of a node of 16³: 8³ voxels → leaf: 8³ voxels
//! ```
//!
//! In a file the nodes and the masks of the leaves come first, and the values of the leaves after them.
//!
//! Source: OpenVDB, `tree/RootNode.h`, `tree/InternalNode.h`, `tree/LeafNode.h`, `io/Compression.h`.

use std::collections::BTreeSet;

use glam::{IVec3, UVec3};

use super::bytes::Bytes;
use super::compression::Compression;
use crate::Result;
use crate::describe::volume::{counted, invalid};

/// Voxels along the side of an entry of a node of 32³, of one of 16³, and of a leaf, as powers of two.
const LEVELS: [u32; 3] = [7, 3, 0];
/// Entries along the side of a node of each level, as powers of two.
const ENTRIES: [u32; 3] = [5, 4, 3];
/// Voxels along the side of an entry of the root.
const ROOT: i32 = 1 << 12;
/// Greatest coordinate of a node of the root (voxels), so that sizes of regions are numbers of 32 bits.
const FARTHEST: i32 = 1 << 29;

/// How the values of a tree are stored.
#[derive(Clone, Copy)]
pub struct Values {
    pub number: Number,
    /// The numbers of a value: 1 or 3.
    pub channels: usize,
    pub compression: Compression,
}

/// How a number is stored.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Number {
    /// 16 bits in arrays of voxels, 32 bits in single values, such as the background.
    Half,
    /// 32 bits.
    Single,
    /// 64 bits.
    Double,
}

impl Number {
    fn bytes(self) -> usize {
        match self {
            Number::Half => 2,
            Number::Single => 4,
            Number::Double => 8,
        }
    }

    /// How a number of a single value, such as the background, is stored.
    fn alone(self) -> Number {
        if self == Number::Half { Number::Single } else { self }
    }

    fn read(self, stored: &[u8]) -> f32 {
        match (self, stored) {
            (Number::Half, &[a, b]) => half::f16::from_le_bytes([a, b]).to_f32(),
            (Number::Single, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
            (Number::Double, &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32,
            _ => unreachable!("chunks of this number of bytes"),
        }
    }
}

/// The voxels from a lower corner to an upper one, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    pub low: IVec3,
    pub high: IVec3,
}

impl Region {
    fn cube(origin: IVec3, side: u32) -> Region {
        Region { low: origin, high: origin + (1 << side) - 1 }
    }

    fn is_empty(self) -> bool {
        self.low.cmpgt(self.high).any()
    }

    fn common(self, other: Region) -> Region {
        Region { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    /// The number of voxels along each axis.
    pub fn size(self) -> UVec3 {
        (self.high - self.low + 1).as_uvec3()
    }
}

/// A bit for each entry of a node.
struct Mask(Vec<u64>);

impl Mask {
    fn read(bytes: &mut Bytes, level: usize) -> Result<Mask> {
        let words = 1 << (3 * ENTRIES[level] - 6);
        (0..words).map(|_| bytes.u64()).collect::<Result<_>>().map(Mask)
    }

    fn has(&self, entry: usize) -> bool {
        self.0[entry / 64] >> (entry % 64) & 1 == 1
    }

    fn count(&self) -> usize {
        self.0.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The entries whose bit is set, in order.
    fn entries(&self) -> impl Iterator<Item = usize> {
        (0..64 * self.0.len()).filter(|&entry| self.has(entry))
    }
}

/// An entry of the root that has the same value everywhere.
struct Tile {
    region: Region,
    value: Vec<f32>,
    is_active: bool,
}

/// Tiles of a node: the entries that are no nodes, with a value for each entry.
struct Tiles {
    origin: IVec3,
    level: usize,
    children: Mask,
    active: Mask,
    values: Vec<f32>,
}

/// The tree but for the values of its leaves.
pub struct Tree<'c> {
    values: Values,
    /// The value of what the tree does not have.
    pub background: Vec<f32>,
    /// Tiles of the root.
    root: Vec<Tile>,
    tiles: Vec<Tiles>,
    /// Origins of the leaves, in the order of their values.
    leaves: Vec<IVec3>,
    /// Where the values of the leaves are.
    of_leaves: Bytes<'c>,
}

impl<'c> Tree<'c> {
    /// Reads a tree.
    ///
    /// - `of_leaves`: where the values of its leaves begin
    ///
    /// # Errors
    /// `Invalid` where the file does not have such a tree.
    pub fn read(bytes: &mut Bytes<'c>, values: Values, of_leaves: Bytes<'c>) -> Result<Tree<'c>> {
        let buffers = bytes.u32()?;
        if buffers != 1 {
            return invalid(format!("expected leaves with one value for each voxel, found {buffers}"));
        }
        let background = values.alone(bytes)?;
        let mut tree = Tree { values, background, root: vec![], tiles: vec![], leaves: vec![], of_leaves };
        let [tiles, nodes] = [bytes.u32()?, bytes.u32()?];
        let mut origins = BTreeSet::new();
        for _ in 0..tiles {
            let region = Region::cube(root_origin(bytes, &mut origins)?, 12);
            let value = values.alone(bytes)?;
            let is_active = bytes.u8()? != 0;
            tree.root.push(Tile { region, value, is_active });
        }
        for _ in 0..nodes {
            let origin = root_origin(bytes, &mut origins)?;
            tree.read_node(bytes, origin, 0)?;
        }
        Ok(tree)
    }

    /// Reads a node of 32³ or 16³ entries, and those under it.
    fn read_node(&mut self, bytes: &mut Bytes, origin: IVec3, level: usize) -> Result<()> {
        let (children, active) = (Mask::read(bytes, level)?, Mask::read(bytes, level)?);
        let values = self.values.read(bytes, &active, &self.background)?;
        for entry in children.entries() {
            let origin = origin + place(entry, level);
            if level == 0 {
                self.read_node(bytes, origin, 1)?;
                continue;
            }
            // The mask of a leaf is stored with its values, too.
            Mask::read(bytes, 2)?;
            self.leaves.push(origin);
        }
        self.tiles.push(Tiles { origin, level, children, active, values });
        Ok(())
    }

    /// The smallest region with all that is active or has another value than the background; `None` if there is nothing.
    ///
    /// # Errors
    /// `Invalid` where the values of the leaves cannot be read.
    pub fn occupied(&self) -> Result<Option<Region>> {
        let mut occupied = Region { low: IVec3::MAX, high: IVec3::MIN };
        self.each(|region, value, is_active| {
            if is_active || value != self.background {
                occupied = Region { low: occupied.low.min(region.low), high: occupied.high.max(region.high) };
            }
        })?;
        Ok((!occupied.is_empty()).then_some(occupied))
    }

    /// The values of a region: x varies fastest, then y, then z.
    ///
    /// # Errors
    /// `Limit` for too many values; `Invalid` where those of the leaves cannot be read.
    pub fn dense(&self, region: Region) -> Result<Vec<f32>> {
        let mut dense = Dense::new(region, &self.background)?;
        self.each(|region, value, _| {
            if value != self.background {
                dense.fill(region, value);
            }
        })?;
        Ok(dense.values)
    }

    /// Calls a function with each tile and each voxel of the leaves: its region, its value and whether it is active.
    fn each(&self, mut visit: impl FnMut(Region, &[f32], bool)) -> Result<()> {
        let channels = self.values.channels;
        for Tile { region, value, is_active } in &self.root {
            visit(*region, value, *is_active);
        }
        for Tiles { origin, level, children, active, values } in &self.tiles {
            for (entry, value) in values.chunks_exact(channels).enumerate().filter(|(entry, _)| !children.has(*entry)) {
                visit(Region::cube(origin + place(entry, *level), LEVELS[*level]), value, active.has(entry));
            }
        }
        let mut bytes = self.of_leaves.clone();
        for origin in &self.leaves {
            let active = Mask::read(&mut bytes, 2)?;
            let values = self.values.read(&mut bytes, &active, &self.background)?;
            for (voxel, value) in values.chunks_exact(channels).enumerate() {
                visit(Region::cube(origin + place(voxel, 2), 0), value, active.has(voxel));
            }
        }
        Ok(())
    }
}

/// The origin of an entry of the root, which no other one has.
fn root_origin(bytes: &mut Bytes, known: &mut BTreeSet<[i32; 3]>) -> Result<IVec3> {
    let origin = [bytes.i32()?, bytes.i32()?, bytes.i32()?];
    if origin.iter().any(|x| x % ROOT != 0 || !(-FARTHEST..FARTHEST).contains(x)) {
        return invalid(format!("a node at voxel {origin:?}: expected multiples of {ROOT} from -{FARTHEST} to {FARTHEST}"));
    }
    if known.insert(origin) { Ok(origin.into()) } else { invalid(format!("two nodes at voxel {origin:?}")) }
}

/// Lower corner of an entry of a node, from that of the node (voxels). In a node z varies fastest.
fn place(entry: usize, level: usize) -> IVec3 {
    let (side, last) = (ENTRIES[level], (1 << ENTRIES[level]) - 1);
    IVec3::from_array([entry >> (2 * side), entry >> side & last, entry & last].map(|k| (k as i32) << LEVELS[level]))
}

impl Values {
    /// A single value, such as the background.
    fn alone(self, bytes: &mut Bytes) -> Result<Vec<f32>> {
        let number = self.number.alone();
        (0..self.channels).map(|_| Ok(number.read(bytes.take(number.bytes())?))).collect()
    }

    /// The values of all entries of a node.
    ///
    /// Those of inactive entries are often the background and its negative, or two others: then a mask chooses between them.
    fn read(self, bytes: &mut Bytes, active: &Mask, background: &[f32]) -> Result<Vec<f32>> {
        let kind = bytes.u8()?;
        let entries = 64 * active.0.len();
        // What inactive entries have where the mask does not choose them, and where it does.
        let mut inactive = [background.iter().map(|x| -x).collect(), background.to_vec()];
        match kind {
            0 => inactive[0] = background.to_vec(),
            1 | 3 | 6 => {}
            2 | 4 => inactive[0] = self.alone(bytes)?,
            5 => inactive = [self.alone(bytes)?, self.alone(bytes)?],
            _ => return invalid(format!("expected a node whose inactive values are of a kind from 0 to 6, found {kind}")),
        }
        let chosen =
            if matches!(kind, 3..=5) { Mask((0..active.0.len()).map(|_| bytes.u64()).collect::<Result<_>>()?) } else { Mask(vec![]) };
        let is_chosen = |entry: usize| matches!(kind, 3..=5) && chosen.has(entry);
        let has_all = kind == 6 || !self.compression.leaves_out_inactive();
        let count = self.channels * if has_all { entries } else { active.count() };
        // Runs of halves are left out where they would be empty.
        let run =
            if count == 0 && self.number == Number::Half { vec![] } else { self.compression.read(bytes, self.number.bytes() * count)? };
        let mut stored = run.chunks_exact(self.number.bytes()).map(|number| self.number.read(number));
        let mut values = Vec::with_capacity(self.channels * entries);
        for entry in 0..entries {
            if has_all || active.has(entry) {
                values.extend(stored.by_ref().take(self.channels));
            } else {
                values.extend(&inactive[usize::from(is_chosen(entry))]);
            }
        }
        Ok(values)
    }
}

/// The values of a region.
struct Dense {
    region: Region,
    values: Vec<f32>,
    channels: usize,
}

impl Dense {
    fn new(region: Region, background: &[f32]) -> Result<Dense> {
        Ok(Dense { region, values: background.repeat(counted(region.size())?), channels: background.len() })
    }

    /// Gives a value to the voxels that both regions have.
    fn fill(&mut self, tile: Region, value: &[f32]) {
        let common = tile.common(self.region);
        if common.is_empty() {
            return;
        }
        let [low, high] = [common.low, common.high].map(|corner| (corner - self.region.low).as_u64vec3().to_array().map(|x| x as usize));
        let [x, y, _] = self.region.size().as_u64vec3().to_array().map(|x| x as usize);
        for plane in low[2]..=high[2] {
            for row in low[1]..=high[1] {
                let start = (plane * y + row) * x;
                let voxels = self.channels * (start + low[0])..self.channels * (start + high[0] + 1);
                self.values[voxels].chunks_exact_mut(self.channels).for_each(|voxel| voxel.copy_from_slice(value));
            }
        }
    }
}
