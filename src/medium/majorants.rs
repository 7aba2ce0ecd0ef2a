//! Upper bounds of a density in the cells of a coarse grid, and rays through them.

use glam::{IVec3, UVec3, Vec3};

/// Upper bounds of a function in the unit cube: one for each cell of a coarse grid.
///
/// They let a ray pass empty parts in one step. Source: Pharr, Jakob and Humphreys, *Physically Based Rendering* (4th ed.), §11.4.
#[derive(Clone, Debug, PartialEq)]
pub struct Majorants {
    /// Number of cells along each axis.
    size: UVec3,
    bounds: Vec<f32>,
}

/// Part of a ray within a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Start and end along the ray (m).
    pub range: [f32; 2],
    /// Upper bound of the function.
    pub majorant: f32,
}

/// Line in the coordinates of the unit cube: the points `origin + t·direction`.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Point at t = 0.
    pub origin: Vec3,
    /// Step per metre of t.
    pub direction: Vec3,
}

impl Line {
    /// Point at a length (m).
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

impl Majorants {
    /// - `bound`: upper bound of the function in a box, by its lower and upper corner
    pub fn new(size: UVec3, bound: impl Fn(Vec3, Vec3) -> f32) -> Majorants {
        let cells = size.as_usizevec3().element_product();
        let of = |cell: usize| {
            let [x, y] = [size.x as usize, size.y as usize];
            let at = UVec3::new((cell % x) as u32, (cell / x % y) as u32, (cell / x / y) as u32);
            bound(at.as_vec3() / size.as_vec3(), (at + 1).as_vec3() / size.as_vec3())
        };
        Majorants { size, bounds: (0..cells).map(of).collect() }
    }

    /// Greatest bound.
    pub fn greatest(&self) -> f32 {
        self.bounds.iter().copied().fold(0.0, f32::max)
    }

    /// Number of cells along each axis.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    /// All bounds times a factor.
    pub fn scaled(&self, factor: f32) -> Majorants {
        Majorants { size: self.size, bounds: self.bounds.iter().map(|bound| bound * factor).collect() }
    }

    /// The parts of a line within the unit cube, cell by cell.
    ///
    /// - `length`: end of the line (m); it may be infinite
    pub fn along(&self, line: Line, length: f32) -> Segments<'_> {
        let range = within_unit_cube(line, length);
        let Some([start, end]) = range else { return Segments { of: self, at: 0.0, end: 0.0, cell: IVec3::ZERO, next: Vec3::ZERO, line } };
        let size = self.size.as_vec3();
        let place = (line.origin + line.direction * start) * size;
        let cell = place.floor().as_ivec3().clamp(IVec3::ZERO, self.size.as_ivec3() - 1);
        let mut segments = Segments { of: self, at: start, end, cell, next: Vec3::ZERO, line };
        segments.next = Vec3::from_array(std::array::from_fn(|axis| segments.far_side(axis)));
        segments
    }
}

/// Start and end of the part of a line within the unit cube.
fn within_unit_cube(Line { origin, direction }: Line, length: f32) -> Option<[f32; 2]> {
    let mut range = [0.0f32, length];
    for axis in 0..3 {
        let (o, d) = (origin[axis], direction[axis]);
        if d == 0.0 {
            if !(0.0..=1.0).contains(&o) {
                return None;
            }
            continue;
        }
        let sides = [-o / d, (1.0 - o) / d];
        range = [range[0].max(sides[0].min(sides[1])), range[1].min(sides[0].max(sides[1]))];
    }
    (range[0] < range[1]).then_some(range)
}

/// Parts of a line, from [`Majorants::along`].
pub struct Segments<'m> {
    of: &'m Majorants,
    at: f32,
    end: f32,
    cell: IVec3,
    /// Where the line leaves the cell along each axis (m).
    next: Vec3,
    line: Line,
}

impl Segments<'_> {
    /// Where the line reaches the far side of the cell along an axis (m).
    fn far_side(&self, axis: usize) -> f32 {
        let d = self.line.direction[axis];
        if d == 0.0 {
            return f32::INFINITY;
        }
        // From the number of the cell, not by adding up, which would round again and again.
        let side = (self.cell[axis] + i32::from(d > 0.0)) as f32 / self.of.size[axis] as f32;
        (side - self.line.origin[axis]) / d
    }
}

impl Iterator for Segments<'_> {
    type Item = Segment;

    #[inline]
    fn next(&mut self) -> Option<Segment> {
        let size = self.of.size.as_ivec3();
        while self.at < self.end && self.cell.cmpge(IVec3::ZERO).all() && self.cell.cmplt(size).all() {
            let axis = self.next.min_position();
            let to = self.next[axis].min(self.end);
            let cell = self.cell.as_uvec3();
            let index = (cell.z as usize * size.y as usize + cell.y as usize) * size.x as usize + cell.x as usize;
            let range = [self.at, to];
            self.cell[axis] += if self.line.direction[axis] > 0.0 { 1 } else { -1 };
            self.next[axis] = self.far_side(axis);
            if range[1] > range[0] {
                self.at = to;
                return Some(Segment { range, majorant: self.of.bounds[index] });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp::uniform_sphere;
    use glam::Vec2;

    /// Numbers spread over [0, 1)³ by multiples of irrational numbers.
    fn spread(i: u32) -> Vec3 {
        (Vec3::new(0.754_877_7, 0.569_840_3, 0.341_164) * i as f32).fract()
    }

    #[test]
    fn cells_follow_each_other_and_contain_the_line() {
        for size in [UVec3::ONE, UVec3::new(3, 5, 2), UVec3::splat(16)] {
            // The bound of a cell is its number.
            let number = |low: Vec3, _: Vec3| {
                let cell = (low * size.as_vec3()).round();
                cell.x + 100.0 * cell.y + 10_000.0 * cell.z
            };
            let majorants = Majorants::new(size, number);
            for i in 0..2000 {
                let direction = uniform_sphere(Vec2::new(spread(i + 7).x, spread(i + 7).y));
                let line = Line { origin: spread(i) * 3.0 - 1.0, direction: direction * 0.5 };
                let whole = within_unit_cube(line, 40.0);
                let parts: Vec<Segment> = majorants.along(line, 40.0).collect();
                assert_eq!(parts.is_empty(), whole.is_none());
                let Some([start, end]) = whole else { continue };
                assert_eq!((parts[0].range[0], parts[parts.len() - 1].range[1]), (start, end));
                assert!(parts.windows(2).all(|pair| pair[0].range[1] == pair[1].range[0]), "{parts:?}");
                for Segment { range: [from, to], majorant } in parts {
                    let middle = (line.origin + line.direction * (0.5 * (from + to))) * size.as_vec3();
                    let cell = Vec3::new(majorant % 100.0, (majorant / 100.0).floor() % 100.0, (majorant / 10_000.0).floor());
                    let outside = (cell - middle).max(middle - cell - 1.0).max_element();
                    assert!(outside < 1e-4, "{middle} is not in the cell {cell}");
                }
            }
        }
    }

    #[test]
    fn lines_along_axes_and_sides_are_found() {
        let majorants = Majorants::new(UVec3::splat(4), |_, _| 1.0);
        for origin in [Vec3::new(-1.0, 0.25, 0.5), Vec3::new(-1.0, 0.0, 1.0)] {
            let line = Line { origin, direction: Vec3::X };
            let parts: Vec<[f32; 2]> = majorants.along(line, f32::INFINITY).map(|part| part.range).collect();
            assert_eq!(parts, [[1.0, 1.25], [1.25, 1.5], [1.5, 1.75], [1.75, 2.0]]);
        }
        assert_eq!(majorants.along(Line { origin: Vec3::splat(-1.0), direction: Vec3::X }, 9.0).count(), 0);
        assert_eq!(majorants.along(Line { origin: Vec3::splat(0.5), direction: Vec3::X }, 0.125).count(), 1);
    }
}
