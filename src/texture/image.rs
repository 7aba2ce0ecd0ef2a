//! A picture stretched over a surface.

use std::sync::Arc;

use glam::{UVec2, Vec2};

use crate::math::Rgb;
use crate::shape::SurfacePoint;

/// Pixels, interpolated between their centres.
///
/// (u, v) = (0, 0) is the lower left corner of the picture, (1, 1) the upper right one, before `scale`.
///
/// Tests: pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    pub pixels: Arc<Pixels>,
    /// How often the picture goes into one unit of the texture coordinates.
    pub scale: Vec2,
    pub wrap: Wrap,
    pub filter: Filter,
}

/// Linear colours, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    size: UVec2,
    values: Vec<[f32; 3]>,
    most: f32,
}

/// What lies beyond the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// Its mirror image.
    Mirror,
    /// Its border.
    Clamp,
}

/// What lies between the pixels' centres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The four nearest, weighted by distance along each axis.
    Bilinear,
    /// The nearest.
    Nearest,
}

impl Pixels {
    /// `None` where there are not as many values as the size says, or none.
    pub fn new(size: UVec2, values: Vec<[f32; 3]>) -> Option<Pixels> {
        let count = size.x as usize * size.y as usize;
        let most = values.as_flattened().iter().copied().fold(0.0, f32::max);
        (count > 0 && values.len() == count).then_some(Pixels { size, values, most })
    }

    /// The largest value.
    pub fn most(&self) -> f32 {
        self.most
    }

    pub fn size(&self) -> UVec2 {
        self.size
    }

    pub fn values(&self) -> &[[f32; 3]] {
        &self.values
    }

    fn get(&self, x: usize, y: usize) -> Rgb {
        let [r, g, b] = self.values[y * self.size.x as usize + x];
        Rgb::new(r, g, b)
    }
}

impl Image {
    pub fn at(&self, point: &SurfacePoint) -> Rgb {
        let size = self.pixels.size;
        // In f64: far from the origin of the coordinates there is still a place within the picture.
        let uv = point.uv.as_dvec2() * self.scale.as_dvec2();
        let (x, y) = (uv.x * f64::from(size.x), (1.0 - uv.y) * f64::from(size.y));
        let column = |x: f64| self.wrap.index(x, size.x);
        let row = |y: f64| self.wrap.index(y, size.y);
        if self.filter == Filter::Nearest {
            return self.pixels.get(column(x.floor()), row(y.floor()));
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (right_share, low_share) = ((x - left) as f32, (y - top) as f32);
        let line = |y| self.pixels.get(column(left), y).mix(self.pixels.get(column(left + 1.0), y), right_share);
        line(row(top)).mix(line(row(top + 1.0)), low_share)
    }
}

impl Wrap {
    /// The pixel that stands for number `i`, a whole number, of `n`.
    fn index(self, i: f64, n: u32) -> usize {
        let n = f64::from(n);
        let inside = match self {
            Wrap::Repeat => i.rem_euclid(n),
            Wrap::Mirror => {
                let i = i.rem_euclid(2.0 * n);
                if i < n { i } else { 2.0 * n - 1.0 - i }
            }
            Wrap::Clamp => i,
        };
        inside.clamp(0.0, n - 1.0) as usize
    }
}
