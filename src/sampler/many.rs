//! Random numbers of several samples side by side, one sample in each lane.
//!
//! Tests: lanes_have_the_numbers_of_their_samples.

use super::dimension::BLOCK;
use super::hash::{EVEN_A, EVEN_B, GOLDEN, ODD_A, ODD_B};
use super::{SampleNumbers, Sequence};
use crate::math::lanes::{Lanes, MAX_COUNT, each_lane};

/// Numbers of the samples of a batch, by their places in it.
pub struct BatchNumbers<'a> {
    samples: Vec<SampleNumbers<'a>>,
    /// Keys of the samples: upper and lower half of the hash, and the index.
    keys: [Vec<u32>; 3],
    /// Kind of all their sequences; `None` before the first sample.
    kind: Option<Kind>,
}

/// Kind of the sequences of a batch.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Sobol,
    Independent,
    Others,
}

/// Numbers of some samples of a batch, one in each lane.
pub enum NumberLanes<'b, 'a, L: Lanes> {
    /// Scrambled Sobol' sequences.
    Sobol {
        /// Hashes of the keys.
        hash: L::U64,
        /// Indices with reversed bits.
        index: L::U32,
    },
    /// Independent numbers.
    Independent(Blocks<L>),
    /// Samples of other sequences, whose numbers are computed one after the other.
    Others {
        /// All samples of the batch.
        samples: &'b mut [SampleNumbers<'a>],
        /// Places of the lanes' samples in the batch.
        places: [u32; MAX_COUNT],
        /// Bit mask of the lanes that have a sample.
        active: u32,
    },
}

impl<'a> BatchNumbers<'a> {
    /// No samples, with room for some.
    pub fn with_capacity(count: usize) -> BatchNumbers<'a> {
        let keys = std::array::from_fn(|_| Vec::with_capacity(count));
        BatchNumbers { samples: Vec::with_capacity(count), keys, kind: None }
    }

    /// Removes all samples.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.keys.iter_mut().for_each(Vec::clear);
        self.kind = None;
    }

    /// Adds a sample.
    pub fn push(&mut self, sample: SampleNumbers<'a>) {
        let key = sample.key();
        let kind = match sample.sequence {
            Sequence::Sobol(_) => Kind::Sobol,
            Sequence::Independent(_) => Kind::Independent,
            _ => Kind::Others,
        };
        self.kind = Some(if self.kind.is_none_or(|all| all == kind) { kind } else { Kind::Others });
        let words = [(key.hash >> 32) as u32, key.hash as u32, key.index as u32];
        self.keys.iter_mut().zip(words).for_each(|(keys, word)| keys.push(word));
        self.samples.push(sample);
    }

    /// Numbers of each sample.
    pub fn samples(&mut self) -> impl Iterator<Item = &mut SampleNumbers<'a>> {
        self.samples.iter_mut()
    }

    /// Numbers of the samples at some places.
    #[inline(always)]
    pub fn lanes<L: Lanes>(&mut self, places: L::U32, active: L::Mask) -> NumberLanes<'_, 'a, L> {
        match self.kind {
            Some(Kind::Sobol) => NumberLanes::Sobol { hash: self.hash::<L>(places), index: L::gather_u32(&self.keys[2], places) },
            Some(Kind::Independent) => NumberLanes::Independent(Blocks::new(self.hash::<L>(places))),
            Some(Kind::Others) | None => {
                let mut numbers = [0; MAX_COUNT];
                L::store_u32(places, &mut numbers);
                NumberLanes::Others { samples: &mut self.samples, places: numbers, active: L::bits(active) }
            }
        }
    }

    /// Hashes of the keys at some places.
    #[inline(always)]
    fn hash<L: Lanes>(&self, places: L::U32) -> L::U64 {
        let (high, low) = (L::gather_u32(&self.keys[0], places), L::gather_u32(&self.keys[1], places));
        L::rotate_32(L::wide(high)) | L::wide(low)
    }
}

impl<L: Lanes> NumberLanes<'_, '_, L> {
    /// Number of a dimension, as [`SampleNumbers::get_1d`].
    #[inline(always)]
    pub fn get_1d(&mut self, dimension: u32) -> L::F32 {
        match self {
            NumberLanes::Sobol { hash, index } => {
                let (key, place) = scrambled_index::<L>(*hash, *index, dimension);
                unit::<L>(scramble::<L>(place, mix::<L>(key)))
            }
            NumberLanes::Independent(blocks) => blocks.get(dimension),
            NumberLanes::Others { samples, places, active } => {
                let mut numbers = [0.0; MAX_COUNT];
                for lane in each_lane(*active) {
                    numbers[lane] = samples[places[lane] as usize].get_1d(dimension);
                }
                L::load(&numbers)
            }
        }
    }

    /// Numbers of a dimension and of the next one, as [`SampleNumbers::get_2d`].
    #[inline(always)]
    pub fn get_2d(&mut self, dimension: u32) -> [L::F32; 2] {
        match self {
            NumberLanes::Sobol { hash, index } => {
                let (key, place) = scrambled_index::<L>(*hash, *index, dimension);
                let key_x = mix::<L>(key);
                pair::<L>(place, key_x, mix::<L>(key_x))
            }
            NumberLanes::Independent(blocks) => [blocks.get(dimension), blocks.get(dimension.wrapping_add(1))],
            NumberLanes::Others { samples, places, active } => {
                let mut numbers = [[0.0; MAX_COUNT]; 2];
                for lane in each_lane(*active) {
                    let u = samples[places[lane] as usize].get_2d(dimension);
                    (numbers[0][lane], numbers[1][lane]) = (u.x, u.y);
                }
                [L::load(&numbers[0]), L::load(&numbers[1])]
            }
        }
    }

    /// Number of a dimension and the numbers of the next two, as [`SampleNumbers::get_3d`].
    #[inline(always)]
    pub fn get_3d(&mut self, dimension: u32) -> [L::F32; 3] {
        match self {
            NumberLanes::Sobol { hash, index } => {
                let (key, place) = scrambled_index::<L>(*hash, *index, dimension);
                let key_x = mix::<L>(key);
                let key_y = mix::<L>(key_x);
                let choice = unit::<L>(scramble::<L>(third_dimension::<L>(place), mix::<L>(key_y)));
                let [x, y] = pair::<L>(place, key_x, key_y);
                [choice, x, y]
            }
            NumberLanes::Independent(blocks) => {
                [blocks.get(dimension), blocks.get(dimension.wrapping_add(1)), blocks.get(dimension.wrapping_add(2))]
            }
            NumberLanes::Others { samples, places, active } => {
                let mut numbers = [[0.0; MAX_COUNT]; 3];
                for lane in each_lane(*active) {
                    let (choice, u) = samples[places[lane] as usize].get_3d(dimension);
                    (numbers[0][lane], numbers[1][lane], numbers[2][lane]) = (choice, u.x, u.y);
                }
                [L::load(&numbers[0]), L::load(&numbers[1]), L::load(&numbers[2])]
            }
        }
    }
}

/// Independent numbers, see [`Independent`](super::independent::Independent): the block of each lane's numbers that was asked for last.
pub struct Blocks<L: Lanes> {
    hash: L::U64,
    /// Index of the block; `None` before the first number.
    index: Option<u32>,
    /// Draws of the generators; each draw gives two numbers.
    draws: [L::U64; BLOCK as usize / 2],
}

impl<L: Lanes> Blocks<L> {
    #[inline(always)]
    fn new(hash: L::U64) -> Blocks<L> {
        // Until the first number is asked for, the draws have no meaning.
        Blocks { hash, index: None, draws: [hash; BLOCK as usize / 2] }
    }

    #[inline(always)]
    fn get(&mut self, dimension: u32) -> L::F32 {
        let (index, place) = (dimension / BLOCK, (dimension % BLOCK) as usize);
        if self.index != Some(index) {
            self.draws = draws::<L>(mix::<L>(self.hash ^ L::u64(index.into())));
            self.index = Some(index);
        }
        let draw = self.draws[place / 2];
        unit::<L>(if place % 2 == 0 { L::high(draw) } else { L::low(draw) })
    }
}

/// The first draws of xoshiro256++ generators, seeded by SplitMix64 as `seed_from_u64` of `rand_xoshiro` does.
///
/// Source: Blackman and Vigna, *Scrambled Linear Pseudorandom Number Generators* (2021); Steele, Lea and Flood, *Fast Splittable
/// Pseudorandom Number Generators* (2014).
#[inline(always)]
fn draws<L: Lanes>(mut seed: L::U64) -> [L::U64; BLOCK as usize / 2] {
    let mut s = [seed; 4];
    for word in &mut s {
        seed = seed + L::u64(GOLDEN);
        let x = (seed ^ L::shr_u64::<30>(seed)) * L::u64(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ L::shr_u64::<27>(x)) * L::u64(0x94d0_49bb_1331_11eb);
        *word = x ^ L::shr_u64::<31>(x);
    }
    let mut draws = [seed; BLOCK as usize / 2];
    for draw in &mut draws {
        let sum = s[0] + s[3];
        *draw = (L::shl_u64::<23>(sum) | L::shr_u64::<41>(sum)) + s[0];
        let shifted = L::shl_u64::<17>(s[1]);
        s[2] = s[2] ^ s[0];
        s[3] = s[3] ^ s[1];
        s[1] = s[1] ^ s[2];
        s[0] = s[0] ^ s[3];
        s[2] = s[2] ^ shifted;
        s[3] = L::shl_u64::<45>(s[3]) | L::shr_u64::<19>(s[3]);
    }
    draws
}

/// [`hash::mix`](super::hash::mix) in each lane.
#[inline(always)]
fn mix<L: Lanes>(x: L::U64) -> L::U64 {
    let x = x + L::u64(GOLDEN);
    let x = (x ^ L::shr_u64::<32>(x)) * L::u64(ODD_A);
    let x = (x ^ L::shr_u64::<29>(x)) * L::u64(ODD_B);
    x ^ L::shr_u64::<32>(x)
}

/// [`hash::scramble_reversed`](super::hash::scramble_reversed) in each lane.
#[inline(always)]
fn scramble_reversed<L: Lanes>(x: L::U32, key: L::U64) -> L::U32 {
    let (a, b) = (L::high(key), L::low(key));
    let second = key * L::u64(ODD_B);
    let (c, d) = (L::low(second), L::high(second));
    let x = x + a;
    let x = x ^ (x * L::u32(EVEN_A));
    let x = x * (b | L::u32(1));
    let x = x ^ (x * (c & L::u32(!1)));
    let x = x + d;
    let x = x ^ (x * L::u32(EVEN_B));
    x * ((L::shl::<16>(a) | L::shr::<16>(a)) | L::u32(1))
}

/// [`hash::scramble`](super::hash::scramble) in each lane.
#[inline(always)]
fn scramble<L: Lanes>(x: L::U32, key: L::U64) -> L::U32 {
    L::reverse_bits(scramble_reversed::<L>(L::reverse_bits(x), key))
}

/// [`unit_f32`](crate::math::float::unit_f32) in each lane.
#[inline(always)]
fn unit<L: Lanes>(x: L::U32) -> L::F32 {
    L::to_f32(L::shr::<8>(x)) * L::f32(1.0 / 16_777_216.0)
}

/// Key of a dimension's scrambling and the scrambled index, as in [`super::sobol`].
#[inline(always)]
fn scrambled_index<L: Lanes>(hash: L::U64, index: L::U32, dimension: u32) -> (L::U64, L::U32) {
    let key = mix::<L>(hash ^ L::u64(dimension.into()));
    (key, scramble_reversed::<L>(index, key))
}

/// The first two dimensions at a scrambled index, as in [`super::sobol`].
#[inline(always)]
fn pair<L: Lanes>(place: L::U32, key_x: L::U64, key_y: L::U64) -> [L::F32; 2] {
    [unit::<L>(scramble::<L>(place, key_x)), unit::<L>(scramble::<L>(second_dimension::<L>(place), key_y))]
}

/// Second Sobol' dimension, see [`super::sobol`].
#[inline(always)]
fn second_dimension<L: Lanes>(x: L::U32) -> L::U32 {
    let x = x ^ (L::shl::<1>(x) & L::u32(0xaaaa_aaaa));
    let x = x ^ (L::shl::<2>(x) & L::u32(0xcccc_cccc));
    let x = x ^ (L::shl::<4>(x) & L::u32(0xf0f0_f0f0));
    let x = x ^ (L::shl::<8>(x) & L::u32(0xff00_ff00));
    x ^ (L::shl::<16>(x) & L::u32(0xffff_0000))
}

/// Third Sobol' dimension, see [`super::sobol`].
#[inline(always)]
fn third_dimension<L: Lanes>(x: L::U32) -> L::U32 {
    let x = x ^ (L::shl::<8>(x) & L::u32(0x0000_ff00));
    let x = x ^ (L::shl::<16>(x) & L::u32(0xffff_0000)) ^ (L::shl::<8>(x) & L::u32(0x00ff_0000));
    let x = x ^ (L::shl::<4>(x) & L::u32(0x00f0_00f0));
    let x = x ^ (L::shl::<8>(x) & L::u32(0xff00_ff00)) ^ (L::shl::<4>(x) & L::u32(0x0f00_0f00));
    let x = x ^ (L::shl::<2>(x) & L::u32(0x0c0c_0c0c));
    let x = x ^ (L::shl::<4>(x) & L::u32(0xf0f0_f0f0)) ^ (L::shl::<2>(x) & L::u32(0x3030_3030));
    let x = x ^ (L::shl::<1>(x) & L::u32(0x2222_2222));
    x ^ (L::shl::<2>(x) & L::u32(0xcccc_cccc)) ^ (L::shl::<1>(x) & L::u32(0x4444_4444))
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;
    use crate::math::lanes::{Kernel, Width, get};
    use crate::sampler::{Kind, SamplerSpec};

    /// Numbers of the samples 3, 4, … of a batch, dimension by dimension: one, two, and three of each.
    struct Numbers<'n, 'a> {
        batch: &'n mut BatchNumbers<'a>,
        dimension: u32,
    }

    impl Kernel for Numbers<'_, '_> {
        type Output = Vec<[f32; 6]>;

        #[inline(always)]
        fn run<L: Lanes>(self) -> Vec<[f32; 6]> {
            let mut lanes = self.batch.lanes::<L>(L::lanes() + L::u32(3), L::mask(u32::MAX >> 16));
            let one = lanes.get_1d(self.dimension);
            let ([a, b], [c, d, e]) = (lanes.get_2d(self.dimension), lanes.get_3d(self.dimension));
            let mut all = vec![];
            for k in 0..L::COUNT {
                all.push([get::<L>(one, k), get::<L>(a, k), get::<L>(b, k), get::<L>(c, k), get::<L>(d, k), get::<L>(e, k)]);
            }
            all
        }
    }

    #[test]
    fn lanes_have_the_numbers_of_their_samples() {
        for (kind, ..) in Kind::ALL {
            let sequences = SamplerSpec { kind: *kind, spp: 64, ..SamplerSpec::default() }.sequences();
            let mut samples: Vec<SampleNumbers> = (0..40u64)
                .map(|i| sequences[i as usize % sequences.len()].sample(UVec2::new(i as u32 % 7, 5), (i * 0x1234_5678_9abc) >> 20))
                .collect();
            let mut batch = BatchNumbers::with_capacity(40);
            samples.iter().for_each(|sample| batch.push(*sample));
            for dimension in (0..40).chain([u32::MAX - 9, 1 << 31]) {
                for width in Width::available() {
                    let found = width.run(Numbers { batch: &mut batch, dimension });
                    for (k, found) in found.into_iter().enumerate() {
                        let sample = &mut samples[k + 3];
                        let (one, two, (choice, u)) = (sample.get_1d(dimension), sample.get_2d(dimension), sample.get_3d(dimension));
                        assert_eq!(found, [one, two.x, two.y, choice, u.x, u.y], "{kind:?}, dimension {dimension}, {width:?}, lane {k}");
                    }
                }
            }
        }
    }
}
