//! Densities of media that vary from place to place.

use std::sync::Arc;

use glam::{Affine3A, DAffine3, DVec3, UVec3, Vec3};

use super::grid::Grid;
use super::majorants::{Line, Majorants, Segments};
use crate::math::Transform;

/// Density of a medium: the factor of its coefficients at each point of a box, and 0 outside.
///
/// With upper bounds of it, points at which a ray collides with the medium are sampled without knowing its integral: tentative points are
/// as dense as the bounds say, and each is real with the probability density / bound (delta tracking).
///
/// Source: Woodcock, Murphy, Hemmings and Longworth, *Techniques Used in the GEM Code for Monte Carlo Neutronics Calculations* (1965).
#[derive(Clone, Debug, PartialEq)]
pub struct Density {
    grid: Arc<Grid>,
    majorants: Arc<Majorants>,
    /// From the unit cube to the world, in the coordinates of the scene file.
    to_world: DAffine3,
    /// From the world to the unit cube.
    from_world: Affine3A,
}

/// Number of values along an axis that share an upper bound, or more where there would be more than [`MOST_BOUNDS`].
const VALUES_PER_BOUND: u32 = 8;
/// Greatest number of upper bounds along an axis.
const MOST_BOUNDS: u32 = 64;

impl Density {
    /// The density of a grid.
    ///
    /// - `to_world`: where the unit cube of the grid lies
    pub fn new(grid: Grid, to_world: &Transform) -> Density {
        let size = grid.size().map(|n| n.div_ceil(VALUES_PER_BOUND).clamp(1, MOST_BOUNDS));
        let majorants = Majorants::new(size, |low, high| grid.max_within(low, high));
        let (grid, majorants) = (Arc::new(grid), Arc::new(majorants));
        Density { grid, majorants, to_world: DAffine3::IDENTITY, from_world: Affine3A::IDENTITY }.moved(to_world.matrix())
    }

    /// The density after a transform. The two share their numbers.
    pub fn moved(&self, transform: DAffine3) -> Density {
        let to_world = transform * self.to_world;
        let (grid, majorants) = (self.grid.clone(), self.majorants.clone());
        Density { grid, majorants, to_world, from_world: to_world.inverse().as_affine3a() }
    }

    /// The density with upper bounds times a factor. Pictures do not depend on it if it is at least 1; their cost does.
    pub fn with_bounds_scaled(self, factor: f32) -> Density {
        Density { majorants: Arc::new(self.majorants.scaled(factor)), ..self }
    }

    /// Greatest integral of the upper bounds along a line within one of their cells (m): the greatest bound times the diagonal.
    ///
    /// Times the extinction, it is about the number of tentative collisions of a ray that meets no real one.
    pub fn most_per_cell(&self) -> f64 {
        let sides = self.to_world.matrix3.to_cols_array_2d().map(DVec3::from);
        let longest = [1.0, -1.0].into_iter().flat_map(|y| [1.0, -1.0].map(|z| [1.0, y, z])).map(|signs| {
            let diagonal = (0..3).map(|axis| sides[axis] * (signs[axis] / f64::from(self.majorants.size()[axis]))).sum::<DVec3>();
            diagonal.length()
        });
        f64::from(self.majorants.greatest()) * longest.fold(0.0, f64::max)
    }

    /// A ray in the unit cube of the density.
    #[inline]
    pub fn line(&self, origin: Vec3, direction: Vec3) -> Line {
        Line { origin: self.from_world.transform_point3(origin), direction: self.from_world.transform_vector3(direction) }
    }

    /// Density at a point of the unit cube.
    #[inline]
    pub fn at(&self, p: Vec3) -> f32 {
        self.grid.at(p)
    }

    /// Upper bounds along a line, up to a length (m).
    #[inline]
    pub fn bounds_along(&self, line: Line, length: f32) -> Segments<'_> {
        self.majorants.along(line, length)
    }
}

/// Greatest optical depth of the upper bounds within one of their cells. Beyond it rays could take seconds to pass places where the
/// density is far below its bound.
pub const MOST_DEPTH: f64 = 1e6;

/// Number of values that a grid may have: their memory is 4 bytes for each.
pub const MOST_VALUES: u64 = 1 << 31;

/// Number of values of a grid of a size; `None` beyond [`MOST_VALUES`].
pub fn value_count(size: UVec3) -> Option<usize> {
    let count = size.to_array().into_iter().try_fold(1u64, |product, n| product.checked_mul(n.into()))?;
    (count <= MOST_VALUES).then_some(count as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::grid::Places;

    /// Optical depth of the density along +x through the middle of a box [0, 1] × …, up to a length, by small steps.
    fn column(density: &Density, length: f32) -> f64 {
        const STEPS: u32 = 1 << 12;
        let line = density.line(Vec3::new(0.0, 0.5, 0.5), Vec3::X);
        let at = |k: u32| f64::from(density.at(line.at(length * (k as f32 + 0.5) / STEPS as f32)));
        (0..STEPS).map(at).sum::<f64>() * f64::from(length) / f64::from(STEPS)
    }

    #[test]
    fn ramps_have_their_integrals() {
        // σ = 3 over d = 2: the first half of the ramp holds σ d/8 with values in the corners, σ d/16 with values in the centres, and the
        // whole of it σ d/2 either way.
        let to_world = Transform::scale(DVec3::new(2.0, 1.0, 1.0)).expect("a scale");
        for (places, first_half) in [(Places::Corners, 3.0 * 2.0 / 8.0), (Places::Centers, 3.0 * 2.0 / 16.0)] {
            let density = Density::new(Grid::new(UVec3::new(2, 1, 1), vec![0.0, 3.0], places), &to_world);
            assert!((column(&density, 1.0) - first_half).abs() < 1e-6 * first_half, "{places:?}: {}", column(&density, 1.0));
            assert!((column(&density, 2.0) - 3.0).abs() < 1e-6 * 3.0);
        }
    }

    #[test]
    fn bounds_are_upper_bounds() {
        let size = UVec3::new(23, 9, 17);
        let values = (0..size.element_product()).map(|i| (i.wrapping_mul(2_654_435_761) >> 8) as f32 / 65_536.0).collect();
        let density = Density::new(Grid::new(size, values, Places::Centers), &Transform::IDENTITY);
        for i in 0..3000u32 {
            let from = (Vec3::new(0.754_877_7, 0.569_840_3, 0.341_164) * i as f32).fract();
            let to = (Vec3::new(0.341_164, 0.754_877_7, 0.569_840_3) * (i + 5) as f32).fract();
            let line = density.line(from, (to - from).normalize());
            for segment in density.bounds_along(line, (to - from).length()) {
                let [start, end] = segment.range;
                let found = (0..=8).map(|k| density.at(line.at(start + (end - start) * k as f32 / 8.0))).fold(0.0, f32::max);
                assert!(found <= segment.majorant, "{found} above {}", segment.majorant);
            }
        }
    }
}
