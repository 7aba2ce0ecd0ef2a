//! Two pictures that can be compared.

use crate::film::Image;
use crate::output::{Tonemap, window};
use crate::{Error, Fault, Result};

/// A picture with the name that messages use.
#[derive(Clone, Copy, Debug)]
pub struct Named<'a> {
    /// Name for messages, such as a file name.
    pub name: &'a str,
    /// The picture.
    pub image: &'a Image,
}

/// Two pictures of the same window with finite `R`, `G`, `B`.
#[derive(Clone, Debug)]
pub struct ImagePair<'a> {
    first: &'a Image,
    second: &'a Image,
    /// Tone mapping for FLIP and SSIM.
    tonemap: Tonemap,
    /// Red, green and blue of both pictures, for every pixel, rows from the top.
    pixels: Vec<[[f32; 3]; 2]>,
}

impl<'a> ImagePair<'a> {
    /// Checks that two pictures can be compared.
    ///
    /// - `first`: the picture whose error is measured
    /// - `second`: the reference
    /// - `tonemap`: for the measures of visible differences
    ///
    /// # Errors
    /// `Invalid`, one fault that names the file: other sizes or crops, no pixels, channels that are missing, values that are not
    /// finite. A NaN is not an error of any size, and leaving it out would make the error of the picture too small.
    pub fn new(first: Named<'a>, second: Named<'a>, tonemap: Tonemap) -> Result<ImagePair<'a>> {
        first.check()?;
        second.check()?;
        if window(first.image) != window(second.image) {
            let (found, expected) = (window(second.image), window(first.image));
            return Err(second.wrong(format!("expected the window of {}, {expected}; found {found}", first.name)));
        }
        let pixels = first.image.pixels().zip(second.image.pixels()).map(|(a, r)| [a, r]).collect();
        Ok(ImagePair { first: first.image, second: second.image, tonemap, pixels })
    }

    /// Width and height (pixels).
    pub fn size(&self) -> [usize; 2] {
        self.first.size.to_array().map(|n| n as usize)
    }

    /// Mean over red, green and blue of `error(a, r)`, for every pixel.
    pub fn map(&self, error: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let value = |[a, r]: &[[f32; 3]; 2], c: usize| error(a[c].into(), r[c].into());
        self.pixels.iter().map(|pixel| (value(pixel, 0) + value(pixel, 1) + value(pixel, 2)) / 3.0).collect()
    }

    /// Mean of the second picture, over all pixels and colours.
    pub fn reference_mean(&self) -> f64 {
        let sum: f64 = self.pixels.iter().flat_map(|[_, r]| r).map(|&r| f64::from(r)).sum();
        sum / (3 * self.pixels.len()) as f64
    }

    /// Both pictures as a screen shows them: sRGB, 0 to 1.
    pub fn displayed(&self) -> [Vec<[f32; 3]>; 2] {
        [self.first, self.second].map(|image| self.tonemap.display(image))
    }
}

impl Named<'_> {
    fn wrong(&self, message: impl Into<String>) -> Error {
        Error::invalid(Fault::new(message).in_file(self.name))
    }

    fn check(&self) -> Result<()> {
        let Named { image, .. } = self;
        if let Some(missing) = ["R", "G", "B"].iter().find(|name| image.channel(name).is_none()) {
            let found: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
            return Err(self.wrong(format!("expected channels R, G and B, found no {missing} among {}", found.join(", "))));
        }
        let is_broken = |pixel: &[f32; 3]| !pixel.iter().all(|v| v.is_finite());
        let count = image.pixels().filter(is_broken).count();
        if let Some((at, [r, g, b])) = image.pixels().enumerate().find(|(_, pixel)| is_broken(pixel)) {
            let (x, y) = (at as u32 % image.size.x + image.origin.x, at as u32 / image.size.x + image.origin.y);
            let many = if count == 1 { "1 pixel is".to_owned() } else { format!("{count} pixels are") };
            return Err(self.wrong(format!("{many} not finite; the first: ({x}, {y}) with {r}, {g}, {b}")));
        }
        if image.size.x == 0 || image.size.y == 0 {
            return Err(self.wrong("a picture without pixels"));
        }
        Ok(())
    }
}
