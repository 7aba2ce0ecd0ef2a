//! Image textures.

use std::sync::Arc;

use glam::{DVec2, UVec2, Vec2};

use super::TextureContext;
pub use super::pixels::Pixels;
use super::pyramid::Pyramid;
use crate::math::Rgb;

/// A picture over the texture coordinates, with values interpolated between the centres of pixels.
///
/// For `scale` 1 the lower left corner of the picture is at (u, v) = (0, 0), the upper right corner at (1, 1).
///
/// Tests: pixel_centres_show_their_pixel, pixels_are_interpolated_and_wrapped.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The pixels, which several textures may share.
    pub pixels: Arc<Pixels>,
    /// The picture at lower resolutions; without it lookups are not averaged over footprints.
    pub pyramid: Option<Arc<Pyramid>>,
    /// How often the picture repeats in one unit of the texture coordinates, along u and v.
    pub scale: Vec2,
    /// The continuation beyond the borders.
    pub wrap: Wrap,
    /// The interpolation between the centres of pixels.
    pub filter: Filter,
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

impl Image {
    /// Looks up the colour at a point: averaged over the footprint if that is larger than a pixel of the picture.
    pub fn at(&self, at: &TextureContext) -> Rgb {
        if let (Some(pyramid), Some(sides)) = (&self.pyramid, at.footprint.map(|footprint| footprint.uv)) {
            let (size, uv) = (self.pixels.size(), self.scaled(at.uv));
            let sides = sides.map(|side| side.as_dvec2() * self.scale.as_dvec2() * size.as_dvec2() * DVec2::new(1.0, -1.0));
            if let Some(ellipse) = pyramid.ellipse(&self.pixels, sides) {
                let UVec2 { x: width, y: height } = ellipse.size;
                let (x, y) = (uv.x * f64::from(width), (1.0 - uv.y) * f64::from(height));
                let place = DVec2::new(self.wrap.nearer(x, width), self.wrap.nearer(y, height));
                return ellipse.average(place, |x| self.wrap.index(x, width), |y| self.wrap.index(y, height));
            }
        }
        self.value(at.uv)
    }

    /// Texture coordinates in units of the picture. f64, so that large ones keep their position within the picture.
    fn scaled(&self, uv: Vec2) -> DVec2 {
        uv.as_dvec2() * self.scale.as_dvec2()
    }

    /// Looks up the colour at texture coordinates.
    pub fn value(&self, uv: Vec2) -> Rgb {
        let (size, uv) = (self.pixels.size(), self.scaled(uv));
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

/// Distance from the picture beyond which positions are replaced by nearer ones (pixels): from 2⁵³ on, x + 1 is x.
const FAR: f64 = (1u64 << 40) as f64;

impl Wrap {
    /// A position within [`FAR`] that shows the same.
    fn nearer(self, x: f64, n: u32) -> f64 {
        match self {
            _ if x.abs() <= FAR => x,
            Wrap::Clamp => x.clamp(-FAR, FAR),
            Wrap::Repeat | Wrap::Mirror => x % (2.0 * f64::from(n)),
        }
    }

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
