//! Choice among the lights of a single node, for several points at once.
//!
//! Tests: side_by_side_paths_have_the_bits_of_single_ones.

use super::{Child, LightTree, UNIFORM_FRACTION, WIDTH};
use crate::math::float::ONE_MINUS_EPSILON;
use crate::math::lanes::{Lanes, Vector};

/// [`Importances`](super::Importances) of the lights of a node for the points of several lanes.
#[derive(Clone, Copy)]
pub(in crate::light) struct ImportanceLanes<L: Lanes> {
    of: [L::F32; WIDTH],
    sums: [L::F32; WIDTH],
    /// Sum of all.
    pub total: L::F32,
}

impl LightTree {
    /// Whether all lights are children of the uppermost node. Only then may lights be chosen in lanes.
    pub fn is_single_node(&self) -> bool {
        self.nodes.len() == 1
    }

    /// [`LightTree::importances`] for surfaces that receive light on one side.
    ///
    /// - `p`: positions (m); `normal`: unit normals on the side of the viewer
    #[inline(always)]
    pub fn importances_lanes<L: Lanes>(&self, p: Vector<L>, normal: Vector<L>) -> ImportanceLanes<L> {
        let zero = L::f32(0.0);
        let mut found = ImportanceLanes { of: [zero; WIDTH], sums: [zero; WIDTH], total: zero };
        for place in 0..self.lights.len().min(WIDTH) {
            found.of[place] = self.nodes[0].importance_lanes::<L>(place, p, normal);
            found.total = found.total + found.of[place];
            found.sums[place] = found.total;
        }
        found
    }

    /// [`LightTree::sample`] in each lane: lights and their probabilities. Where all importances are 0, the results mean nothing.
    #[inline(always)]
    pub fn sample_lanes<L: Lanes>(&self, importances: &ImportanceLanes<L>, choice: L::F32) -> (L::U32, L::F32) {
        let count = self.lights.len().min(WIDTH);
        let (fraction, all) = (L::f32(UNIFORM_FRACTION), L::f32(self.lights.len() as f32));
        let among_all = L::to_u32(choice * L::f32(1.0 / UNIFORM_FRACTION) * all);
        let rest = L::min((choice - fraction) / L::f32(1.0 - UNIFORM_FRACTION), L::f32(ONE_MINUS_EPSILON));
        let target = rest * importances.total;
        // The place of the chosen child is the number of sums that are at most the target, as in `Importances::choose`. If all of them are,
        // because of rounding, the last child with an importance is chosen.
        let (mut place, mut last, mut uniform) = (L::u32(0), L::u32(0), L::u32(self.place(count - 1)));
        for k in 0..count {
            let here = L::u32(k as u32);
            place = place + L::select_u32(L::le(importances.sums[k], target), L::u32(1), L::u32(0));
            last = L::select_u32(L::lt(L::f32(0.0), importances.of[k]), here, last);
            uniform = L::select_u32(L::eq_u32(among_all, here), L::u32(self.place(k)), uniform);
        }
        let place = L::select_u32(L::eq_u32(place, L::u32(count as u32)), last, place);
        let place = L::select_u32(L::lt(choice, fraction), uniform, place);
        let (mut light, mut importance) = (L::u32(0), L::f32(0.0));
        for k in 0..count {
            let Child::Light(index) = self.nodes[0].child(k) else { continue };
            let is_here = L::eq_u32(place, L::u32(k as u32));
            light = L::select_u32(is_here, L::u32(index), light);
            importance = L::select(is_here, importances.of[k], importance);
        }
        let probability = importance / importances.total;
        (light, L::f32(1.0 - UNIFORM_FRACTION) * probability + fraction / all)
    }

    /// Place in the uppermost node of a light of the list from which lights are chosen uniformly.
    fn place(&self, k: usize) -> u32 {
        self.trails[self.lights[k] as usize] as u32 % WIDTH as u32
    }
}
