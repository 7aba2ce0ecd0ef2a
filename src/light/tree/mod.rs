//! Light tree: chooses one of many lights in proportion to about what it brings to a point.
//!
//! Each node has up to eight children. The importance of a child is an estimate of the irradiance from its [`LightBounds`]; a child is
//! chosen with a probability proportional to it, down to a single light.
//!
//! Source: Conty Estevez and Kulla, *Importance Sampling of Many Lights with Adaptive Tree Splitting* (2018), with eight children in
//! the place of two, whose importances are computed side by side.
//! Tests: probabilities_add_up_and_are_stated_exactly, every_light_that_shines_can_be_chosen, choices_follow_what_lights_bring.

mod build;
mod lanes;
mod node;

use self::node::{Child, Node};
use super::bounds::LightBounds;
use crate::math::float::ONE_MINUS_EPSILON;
#[cfg(target_arch = "x86_64")]
use crate::math::simd::Whole;
use crate::math::simd::{Halves, Set};

pub(super) use self::lanes::ImportanceLanes;
pub(super) use self::node::{Receiver, Sides};

/// Greatest number of children of a node.
const WIDTH: usize = 8;

/// Number of bits of a child's place in its node.
const PLACE_BITS: u32 = WIDTH.ilog2();

/// Greatest number of levels, so that the places of all nodes on the way to a light fit in 64 bits.
const MAX_LEVELS: u32 = u64::BITS / PLACE_BITS;

/// Fraction of the choices that are made uniformly among the lights. A light that outshines others by far may be hidden, and those
/// others must then be found although a random number of 24 bits resolves no smaller probability. (Below this fraction lie 2¹⁹ of the 2²⁴
/// random numbers, so that up to 2¹⁹ lights can be chosen uniformly. Of more lights, some are chosen by their importance alone.)
const UNIFORM_FRACTION: f32 = 1.0 / 32.0;

/// Light tree over lights that are not infinitely far away.
pub(super) struct LightTree {
    /// The nodes; the first is the root.
    nodes: Vec<Node>,
    /// Index of each light in the list of lights.
    lights: Vec<u32>,
    /// Bit trail of each light of the list: the places of the children on the way to it, the uppermost in the lowest bits; `NOT_HERE` for
    /// lights that are not in the tree.
    trails: Vec<u64>,
    /// Instruction set for the importances.
    set: Set,
}

/// Bit trail of a light that is not in the tree.
const NOT_HERE: u64 = u64::MAX;

/// Importances of the children of a node.
#[derive(Clone, Copy)]
pub(super) struct Importances {
    of: [f32; WIDTH],
    /// Sum of the importance at a place and those before it.
    sums: [f32; WIDTH],
}

impl LightTree {
    /// A tree of lights.
    ///
    /// - `lights`: bounds of lights with an intensity above 0, with their indices in the list of lights
    /// - `count`: length of that list; `scale`: factor for the intensities
    pub fn new(lights: Vec<(LightBounds, u32)>, count: usize, scale: f64) -> LightTree {
        let order = lights.iter().map(|(_, light)| *light).collect();
        let mut tree = LightTree { nodes: vec![], lights: order, trails: vec![NOT_HERE; count], set: Set::detect() };
        build::build(lights, scale, &mut tree.nodes, &mut tree.trails);
        tree
    }

    /// Importances of the uppermost lights. Their sum estimates the irradiance from all lights.
    #[inline]
    pub fn importances(&self, at: &Receiver) -> Importances {
        self.importances_of(&self.nodes[0], at)
    }

    /// Importances of the children of a node.
    #[inline]
    fn importances_of(&self, node: &Node, at: &Receiver) -> Importances {
        Importances::new(match self.set {
            Set::Plain => node.importances::<Halves>(at),
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "the instructions exist only where the processor has AVX2")]
            // SAFETY: `Set::detect` has found AVX2.
            Set::Avx2 => unsafe { importances_avx2(node, at) },
        })
    }

    /// The importances, or the intensities where all importances are 0: the bounds of a node may promise light that those of none of
    /// its children promise.
    #[inline]
    fn importances_below(&self, node: &Node, at: &Receiver) -> Importances {
        let importances = self.importances_of(node, at);
        if importances.total() > 0.0 { importances } else { Importances::new(node.intensities()) }
    }

    /// Chooses a light, with its probability.
    ///
    /// - `uppermost`: result of [`LightTree::importances`], with a sum above 0
    /// - `choice`: uniform number in [0, 1)
    #[inline]
    pub fn sample(&self, at: &Receiver, uppermost: Importances, choice: f32) -> (u32, f32) {
        if choice < UNIFORM_FRACTION {
            let place = (choice * (1.0 / UNIFORM_FRACTION) * self.lights.len() as f32) as usize;
            let light = self.lights[place.min(self.lights.len() - 1)];
            return (light, self.probability(at, uppermost, light));
        }
        let mut choice = ((choice - UNIFORM_FRACTION) / (1.0 - UNIFORM_FRACTION)).min(ONE_MINUS_EPSILON);
        let (mut importances, mut node, mut probability) = (uppermost, &self.nodes[0], 1.0);
        loop {
            let (place, rest) = importances.choose(choice);
            probability *= importances.probability(place);
            choice = rest;
            match node.child(place) {
                Child::Light(light) => return (light, self.mixed(probability)),
                Child::Node(index) => node = &self.nodes[index as usize],
            }
            importances = self.importances_below(node, at);
        }
    }

    /// Probability with which [`LightTree::sample`] chooses a light: the same bits.
    #[inline]
    pub fn probability(&self, at: &Receiver, uppermost: Importances, light: u32) -> f32 {
        let mut trail = self.trails[light as usize];
        if trail == NOT_HERE {
            return 0.0;
        }
        let (mut importances, mut node, mut probability) = (uppermost, &self.nodes[0], 1.0);
        loop {
            let place = trail as usize % WIDTH;
            probability *= importances.probability(place);
            trail >>= PLACE_BITS;
            match node.child(place) {
                Child::Light(_) => return self.mixed(probability),
                Child::Node(index) => node = &self.nodes[index as usize],
            }
            importances = self.importances_below(node, at);
        }
    }

    /// Probability of a light that the descent chooses with the given probability.
    fn mixed(&self, probability: f32) -> f32 {
        (1.0 - UNIFORM_FRACTION) * probability + UNIFORM_FRACTION / self.lights.len() as f32
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn importances_avx2(node: &Node, at: &Receiver) -> [f32; WIDTH] {
    node.importances::<Whole>(at)
}

impl Importances {
    #[inline]
    fn new(of: [f32; WIDTH]) -> Importances {
        let mut sum = 0.0;
        let sums = of.map(|importance| {
            sum += importance;
            sum
        });
        Importances { of, sums }
    }

    /// Sum of all importances.
    #[inline]
    pub fn total(&self) -> f32 {
        self.sums[WIDTH - 1]
    }

    /// Chooses a child; returns its place and the number for the next choice.
    #[inline]
    fn choose(&self, choice: f32) -> (usize, f32) {
        let target = choice * self.total();
        // The sums grow, so that as many of them are at most the target as there are children before the one it falls on. That one has
        // an importance above 0. Rounding may put the target at the end.
        let place = self.sums.iter().map(|&sum| usize::from(sum <= target)).sum::<usize>();
        let place = if place < WIDTH { place } else { self.last() };
        let below = if place == 0 { 0.0 } else { self.sums[place - 1] };
        (place, ((target - below) / self.of[place]).clamp(0.0, ONE_MINUS_EPSILON))
    }

    /// Place of the last child with an importance above 0.
    #[cold]
    fn last(&self) -> usize {
        self.of.iter().rposition(|&importance| importance > 0.0).unwrap_or(0)
    }

    /// Probability of the child at a place.
    #[inline]
    fn probability(&self, place: usize) -> f32 {
        self.of[place] / self.total()
    }
}
