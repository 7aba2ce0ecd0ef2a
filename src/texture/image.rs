//! Image textures.

use std::sync::Arc;

use glam::{UVec2, Vec2};

use crate::math::Rgb;
use crate::shape::SurfacePoint;

/// A picture over the texture coordinates, with values interpolated between the centres of pixels.
///
/// For `scale` 1 the lower left corner of the picture is at (u, v) = (0, 0), the upper right corner at (1, 1).
///
/// Tests: pixel_centres_show_their_pixel, pixels_are_interpolated_and_wrapped.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The pixels, which several textures may share.
    pub pixels: Arc<Pixels>,
    /// How often the picture repeats in one unit of the texture coordinates, along u and v.
    pub scale: Vec2,
    /// The continuation beyond the borders.
    pub wrap: Wrap,
    /// The interpolation between the centres of pixels.
    pub filter: Filter,
}

/// The pixels of a picture: linear Rec. 709 colours, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    size: UVec2,
    values: Vec<[f32; 3]>,
    most: f32,
}

/// How a picture continues beyond its borders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The picture is repeated.
    Repeat,
    /// The picture is repeated, mirrored every second time.
    Mirror,
    /// The pixels of the border continue.
    Clamp,
}

/// How values between the centres of pixels are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Bilinear interpolation of the four nearest pixels.
    Bilinear,
    /// The value of the nearest pixel.
    Nearest,
}

impl Pixels {
    /// The pixels of a picture; `None` where the number of values does not fit the size, or is 0.
    pub fn new(size: UVec2, values: Vec<[f32; 3]>) -> Option<Pixels> {
        let count = size.x as usize * size.y as usize;
        let most = values.as_flattened().iter().copied().fold(0.0, f32::max);
        (count > 0 && values.len() == count).then_some(Pixels { size, values, most })
    }

    /// The largest component of all pixels.
    pub fn most(&self) -> f32 {
        self.most
    }

    /// Width and height, in pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Red, green and blue of all pixels, row by row from the top.
    pub fn values(&self) -> &[[f32; 3]] {
        &self.values
    }

    /// Colour of a pixel, counted from the upper left corner.
    #[inline]
    pub(crate) fn get(&self, x: usize, y: usize) -> Rgb {
        let [r, g, b] = self.values[y * self.size.x as usize + x];
        Rgb::new(r, g, b)
    }
}

impl Image {
    /// Looks up the colour at a point.
    pub fn at(&self, point: &SurfacePoint) -> Rgb {
        let size = self.pixels.size;
        // f64, so that large texture coordinates keep their position within the picture.
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
    /// The pixel from 0 to `n` − 1 for the whole number `i`.
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
