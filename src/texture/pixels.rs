//! The pixels of a picture.

use glam::UVec2;

use crate::math::Rgb;

/// The pixels of a picture: linear Rec. 709 colours, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    size: UVec2,
    values: Vec<[f32; 3]>,
    most: f32,
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
