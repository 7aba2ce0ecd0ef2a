//! Choice of a light for several points at once, where there are few lights.
//!
//! Tests: side_by_side_paths_have_the_bits_of_single_ones.

use glam::Vec3;

use super::{Choice, EQUAL_FRACTION, Infinite};
use crate::light::InfiniteIrradiance;
use crate::light::tree::{ImportanceLanes, Receiver, Sides};
use crate::math::float::ONE_MINUS_EPSILON;
use crate::math::lanes::{Lanes, MAX_COUNT, Vector, each_lane};

/// Surfaces that receive light on one side, one in each lane.
pub(crate) struct OneSidedLanes<L: Lanes> {
    /// Positions (m).
    pub p: Vector<L>,
    /// Unit normals on the side of the viewer.
    pub normal: Vector<L>,
    /// Lanes that have one.
    pub active: L::Mask,
}

/// Chosen lights, one in each lane.
pub(crate) struct ChosenLanes<L: Lanes> {
    /// Indices of the lights.
    pub light: L::U32,
    /// Their probabilities.
    pub probability: L::F32,
    /// Lanes that have one.
    pub found: L::Mask,
}

/// [`Parts`](super::Parts) of several points.
struct PartLanes<L: Lanes> {
    sum: L::F32,
    count: L::F32,
    tree: Option<ImportanceLanes<L>>,
}

impl Choice {
    /// Whether there are so few lights that they can be chosen in lanes.
    pub fn has_lanes(&self) -> bool {
        self.tree.as_ref().is_none_or(|tree| tree.is_single_node())
    }

    /// [`Choice::sample`] in each lane.
    #[inline(always)]
    pub fn sample_lanes<L: Lanes>(&self, at: &OneSidedLanes<L>, choice: L::F32) -> ChosenLanes<L> {
        let (zero, none) = (L::f32(0.0), L::u32(0));
        let parts = self.part_lanes(at);
        let (mut choice, mut pending) = (choice, at.active);
        let (mut light, mut probability) = (none, zero);
        let (mut last, mut last_share) = (none, zero);
        for infinite in &self.infinite {
            let (index, share) = (L::u32(infinite.light), parts.share(infinite.importance_lanes(at)));
            let is_possible = L::lt(zero, share);
            (last, last_share) = (L::select_u32(is_possible, index, last), L::select(is_possible, share, last_share));
            let is_chosen = pending & is_possible & L::lt(choice, share);
            (light, probability) = (L::select_u32(is_chosen, index, light), L::select(is_chosen, share, probability));
            pending = pending & !is_chosen;
            choice = choice - share;
        }
        if let (Some(tree), Some(uppermost)) = (&self.tree, &parts.tree) {
            let share = parts.share(uppermost.total);
            let rest = L::min(L::max(choice / share, zero), L::f32(ONE_MINUS_EPSILON));
            let (index, among) = tree.sample_lanes(uppermost, rest);
            let is_chosen = pending & L::lt(zero, uppermost.total);
            (light, probability) = (L::select_u32(is_chosen, index, light), L::select(is_chosen, share * among, probability));
            pending = pending & !is_chosen;
        }
        // The rounded shares of the infinite lights may add up to less than 1.
        let is_last = pending & L::lt(zero, last_share);
        let found = (at.active & !pending) | is_last;
        ChosenLanes { light: L::select_u32(is_last, last, light), probability: L::select(is_last, last_share, probability), found }
    }

    /// [`Choice::probability`] in each lane, of a light that is infinitely far away.
    #[inline(always)]
    pub fn infinite_probability_lanes<L: Lanes>(&self, at: &OneSidedLanes<L>, light: u32) -> L::F32 {
        let parts = self.part_lanes(at);
        let found = self.infinite.iter().find(|infinite| infinite.light == light);
        let Some(infinite) = found else { return L::f32(0.0) };
        parts.share(infinite.importance_lanes(at))
    }

    #[inline(always)]
    fn part_lanes<L: Lanes>(&self, at: &OneSidedLanes<L>) -> PartLanes<L> {
        let mut parts = PartLanes { sum: L::f32(0.0), count: L::f32(0.0), tree: None };
        for infinite in &self.infinite {
            parts.add(infinite.importance_lanes(at));
        }
        if let Some(tree) = &self.tree {
            let importances = tree.importances_lanes(at.p, at.normal);
            parts.add(importances.total);
            parts.tree = Some(importances);
        }
        parts
    }
}

impl<L: Lanes> PartLanes<L> {
    /// Counts a part with the given importance.
    #[inline(always)]
    fn add(&mut self, importance: L::F32) {
        let (zero, one) = (L::f32(0.0), L::f32(1.0));
        let counts = L::lt(zero, importance);
        self.sum = self.sum + L::select(counts, importance, zero);
        self.count = self.count + L::select(counts, one, zero);
    }

    /// Probability of a part with the given importance.
    #[inline(always)]
    fn share(&self, importance: L::F32) -> L::F32 {
        let (zero, one) = (L::f32(0.0), L::f32(1.0));
        let mixed = L::f32(1.0 - EQUAL_FRACTION) * (importance / self.sum) + L::f32(EQUAL_FRACTION) / self.count;
        let share = L::select(L::lt(one, self.count), mixed, one);
        L::select(L::lt(zero, importance), share, zero)
    }
}

impl Infinite {
    /// [`Infinite::importance`] in each lane.
    #[inline(always)]
    fn importance_lanes<L: Lanes>(&self, at: &OneSidedLanes<L>) -> L::F32 {
        if let InfiniteIrradiance::Equal(irradiance) = &self.irradiance {
            return L::f32(*irradiance as f32);
        }
        let mut importances = [0.0; MAX_COUNT];
        for lane in each_lane(L::bits(at.active)) {
            importances[lane] = self.importance_of_one(at.normal.get(lane));
        }
        L::load(&importances)
    }

    /// Importance for a surface that receives light on one side. It does not depend on the position.
    #[inline(never)]
    fn importance_of_one(&self, normal: Vec3) -> f32 {
        self.importance(&Receiver { p: Vec3::ZERO, normal, sides: Sides::One })
    }
}
