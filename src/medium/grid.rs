//! Numbers on a grid.

use std::ops::{Add, Mul, Sub};

use glam::{UVec3, Vec3};

use crate::math::Rgb;

/// Numbers or colours on a grid in the unit cube, linear between neighbours along each axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<T = f32> {
    /// Number of values along each axis.
    size: UVec3,
    /// The values: x varies fastest, then y, then z.
    values: Vec<T>,
    places: Places,
}

/// Colours on a grid.
#[derive(Clone, Debug, PartialEq)]
pub enum ColorGrid {
    /// Greys, as one number each.
    Gray(Grid),
    /// Linear red, green and blue.
    Rgb(Grid<Rgb>),
}

/// Where in the unit cube the values of a grid are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Places {
    /// In the centres of equal cells. Between the outermost centres and the sides of the cube the value stays the same.
    #[default]
    Centers,
    /// In the corners of equal cells, so that the outermost values are on the sides of the cube.
    Corners,
}

/// Share of a cell by which a region is extended where the values around it are sought: more than the rounding of places within it.
const ROOM: f32 = 1e-3;

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>> Grid<T> {
    /// A grid.
    ///
    /// - `size`: number of values along each axis, at least 1
    /// - `values`: x varies fastest, then y, then z
    pub fn new(size: UVec3, values: Vec<T>, places: Places) -> Grid<T> {
        debug_assert_eq!(values.len(), size.as_usizevec3().element_product());
        Grid { size, values, places }
    }

    /// Number of values along each axis.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    /// Value at a point of the unit cube; points outside have that of the nearest point of the cube.
    #[inline]
    pub fn at(&self, p: Vec3) -> T {
        let place = self.place(p);
        let first = place.as_uvec3().min(self.size.saturating_sub(UVec3::splat(2)));
        let share = place - first.as_vec3();
        let [step_y, step_z] = self.steps();
        let base = first.x as usize + first.y as usize * step_y + first.z as usize * step_z;
        let [dx, dy, dz] =
            [(self.size.x > 1, 1), (self.size.y > 1, step_y), (self.size.z > 1, step_z)].map(|(is, step)| usize::from(is) * step);
        // Between equal values, this form has no rounding.
        let between = |a: T, b: T, share: f32| a + (b - a) * share;
        let along_x = |at: usize| between(self.values[at], self.values[at + dx], share.x);
        let along_y = |at: usize| between(along_x(at), along_x(at + dy), share.y);
        between(along_y(base), along_y(base + dz), share.z)
    }

    /// Place of a point among the values, which are at whole numbers.
    #[inline]
    fn place(&self, p: Vec3) -> Vec3 {
        let last = (self.size - 1).as_vec3();
        let place = match self.places {
            Places::Centers => p * self.size.as_vec3() - 0.5,
            Places::Corners => p * last,
        };
        place.clamp(Vec3::ZERO, last)
    }

    /// Distances between values that are neighbours along y and along z.
    #[inline]
    fn steps(&self) -> [usize; 2] {
        [self.size.x as usize, self.size.x as usize * self.size.y as usize]
    }
}

impl Grid {
    /// Greatest value in a box within the unit cube.
    pub fn max_within(&self, low: Vec3, high: Vec3) -> f32 {
        let last = self.size - 1;
        let from = (self.place(low) - ROOM).max(Vec3::ZERO).floor().as_uvec3();
        let to = (self.place(high) + ROOM).ceil().as_uvec3().min(last);
        let [step_y, step_z] = self.steps();
        let mut max = f32::NEG_INFINITY;
        for (z, y) in (from.z..=to.z).flat_map(|z| (from.y..=to.y).map(move |y| (z, y))) {
            let row = y as usize * step_y + z as usize * step_z;
            let values = &self.values[row + from.x as usize..=row + to.x as usize];
            max = values.iter().copied().fold(max, f32::max);
        }
        max
    }
}

impl ColorGrid {
    /// Colour at a point of the unit cube; points outside have that of the nearest point of the cube.
    #[inline]
    pub fn at(&self, p: Vec3) -> Rgb {
        match self {
            ColorGrid::Gray(grid) => Rgb::gray(grid.at(p)),
            ColorGrid::Rgb(grid) => grid.at(p),
        }
    }

    /// Greatest value of all colour channels.
    pub fn max(&self) -> f32 {
        match self {
            ColorGrid::Gray(grid) => grid.values.iter().copied().fold(0.0, f32::max),
            ColorGrid::Rgb(grid) => grid.values.iter().map(|color| color.max()).fold(0.0, f32::max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_values_grids_are_linear() {
        let size = UVec3::new(3, 4, 5);
        // A linear function of the place.
        let of = |p: Vec3| 1.0 + p.x + 2.0 * p.y + 4.0 * p.z;
        for places in [Places::Centers, Places::Corners] {
            let whole = (0..60).map(|i| Vec3::new((i % 3) as f32, (i / 3 % 4) as f32, (i / 12) as f32));
            let grid = Grid::new(size, whole.map(of).collect(), places);
            for p in [Vec3::new(0.2, 0.3, 0.4), Vec3::new(0.81, 0.77, 0.5), Vec3::splat(0.5)] {
                let place = if places == Places::Centers { p * size.as_vec3() - 0.5 } else { p * (size - 1).as_vec3() };
                assert!((grid.at(p) - of(place)).abs() < 1e-5, "{places:?} {p}");
            }
            assert_eq!([grid.at(Vec3::splat(-1.0)), grid.at(Vec3::splat(2.0))], [1.0, of(Vec3::new(2.0, 3.0, 4.0))]);
        }
        assert_eq!(Grid::new(UVec3::ONE, vec![7.0], Places::Corners).at(Vec3::splat(0.3)), 7.0);
    }
}
