//! Stratified sampling.

use glam::{UVec2, Vec2};

use super::hash::{dimension_key, halves, mix, permute, pixel_key, within_cell};
use super::{SampleKey, Sampler};

/// Stratified numbers: each dimension is divided into as many strata as a sequence has planned samples in a pixel.
///
/// 1-D: sample i lies in stratum π(i) of n, where π is a random permutation for each dimension.
///
/// 2-D: sample i lies in cell π(i) of a nearly square grid of n cells. If n has no two factors within 2 : 1, the grid has a few more
/// cells, of which a random n are used.
///
/// Samples beyond the planned n begin a new stratification.
///
/// Source: Cook, Porter, Carpenter, *Distributed Ray Tracing* (1984). Tests: one sample per stratum, chi².
pub struct Stratified {
    seed: u64,
    strata: u32,
    grid: UVec2,
}

/// Greatest number of strata, so that each contains a few of the 2²⁴ uniform numbers.
const MAX_STRATA: u64 = 1 << 20;

impl Stratified {
    /// A sampler for `spp` planned samples per pixel.
    pub fn new(seed: u64, spp: u64) -> Stratified {
        let strata = spp.clamp(1, MAX_STRATA) as u32;
        Stratified { seed, strata, grid: grid(strata) }
    }
}

impl Sampler for Stratified {
    /// The index within the key is that within the stratification.
    fn key(&self, pixel: UVec2, index: u64) -> SampleKey {
        let n = u64::from(self.strata);
        SampleKey { hash: mix(pixel_key(self.seed, pixel) ^ (index / n)), index: index % n }
    }

    // Not inlined among the other samplers, whose registers it would take.
    #[inline(never)]
    fn get_1d(&self, SampleKey { hash, index }: SampleKey, dimension: u32) -> f32 {
        let key = dimension_key(hash, dimension);
        let stratum = permute(index as u32, self.strata, key);
        within_cell(stratum, self.strata, (mix(key ^ u64::from(stratum)) >> 32) as u32)
    }

    #[inline(never)]
    fn get_2d(&self, SampleKey { hash, index }: SampleKey, dimension: u32) -> Vec2 {
        let key = dimension_key(hash, dimension);
        let cell = permute(index as u32, self.grid.element_product(), key);
        let (x, y) = halves(mix(key ^ u64::from(cell)));
        Vec2::new(within_cell(cell % self.grid.x, self.grid.x, x), within_cell(cell / self.grid.x, self.grid.y, y))
    }
}

/// Grid of at least n cells: exactly n cells if n has two factors within 2 : 1, otherwise the smallest nearly square grid.
fn grid(n: u32) -> UVec2 {
    let root = n.isqrt();
    let exact = (1..=root).rev().take_while(|y| n / y <= 2 * y).find(|&y| n.is_multiple_of(y));
    match exact {
        Some(y) => UVec2::new(n / y, y),
        None => {
            let x = if root * root < n { root + 1 } else { root };
            UVec2::new(x, n.div_ceil(x))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_cover_closely_and_are_near_square() {
        for n in 1..5000 {
            let UVec2 { x, y } = grid(n);
            assert!(y <= x && x <= 2 * y.max(1) && x * y >= n, "{n}: {x} × {y}");
            assert!(x * y - n < x, "{n}: {x} × {y} has a superfluous row");
        }
        assert_eq!(grid(256), UVec2::new(16, 16));
        assert_eq!(grid(128), UVec2::new(16, 8));
        assert_eq!(grid(7), UVec2::new(3, 3));
    }
}
