//! Spectral quantities.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub};

use glam::{Vec3, Vec3A};

use super::Rgb;

/// Spectral quantity such as radiance, reflectance or throughput.
///
/// It has three coefficients: linear RGB with the primaries of Rec. 709. Only the film uses the coefficients ([`Spectrum::to_rgb`]).
/// All other code multiplies and adds, so that another spectral representation changes only this file and the film.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spectrum(Vec3);

impl Spectrum {
    /// Spectrum that is 0 at every wavelength.
    pub const BLACK: Spectrum = Spectrum(Vec3::ZERO);
    /// Spectrum that is 1 at every wavelength.
    pub const ONE: Spectrum = Spectrum(Vec3::ONE);

    /// A spectrum with the same value at every wavelength.
    pub const fn gray(value: f32) -> Spectrum {
        Spectrum(Vec3::splat(value))
    }

    /// A spectrum from linear RGB (Rec. 709).
    pub const fn rgb(r: f32, g: f32, b: f32) -> Spectrum {
        Spectrum(Vec3::new(r, g, b))
    }

    /// The spectrum of a stored colour that is a share of light: reflected, transmitted or left over.
    pub fn from_albedo(color: Rgb) -> Spectrum {
        Spectrum(color.0)
    }

    /// The spectrum of a stored colour that is light: what a lamp emits.
    pub fn from_illuminant(color: Rgb) -> Spectrum {
        Spectrum(color.0)
    }

    /// The spectrum of a property that is stored for red, green and blue, such as an index of refraction.
    pub fn from_coefficients(color: Rgb) -> Spectrum {
        Spectrum(color.0)
    }

    /// Linear RGB (Rec. 709), for the film.
    pub fn to_rgb(self) -> [f32; 3] {
        self.0.to_array()
    }

    /// The spectrum with these coefficients, see [`Spectrum::coefficients`].
    pub(crate) fn from_array(coefficients: [f32; 3]) -> Spectrum {
        Spectrum(coefficients.into())
    }

    /// Coefficients, for code that keeps those of several spectra side by side.
    pub(crate) fn coefficients(self) -> [f32; 3] {
        self.0.to_array()
    }

    /// Whether all coefficients are 0.
    pub fn is_black(self) -> bool {
        // One test for all coefficients: all bits except the signs are 0.
        let bits = self.0.to_array().map(f32::to_bits);
        (bits[0] | bits[1] | bits[2]) << 1 == 0
    }

    /// Whether all coefficients are finite and not negative, as those of radiance must be.
    pub fn is_valid(self) -> bool {
        self.0.is_finite() && self.0.min_element() >= 0.0
    }

    /// Whether all coefficients are finite.
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// Greatest coefficient.
    pub fn max(self) -> f32 {
        self.0.max_element()
    }

    /// Least coefficient.
    pub fn min(self) -> f32 {
        self.0.min_element()
    }

    /// Mean of the coefficients. It is a measure of size for the choice of lights, not a luminance.
    pub fn average(self) -> f32 {
        (self.0.x + self.0.y + self.0.z) / 3.0
    }

    /// f(self), coefficient by coefficient.
    pub fn map(self, f: impl Fn(f32) -> f32) -> Spectrum {
        Spectrum(self.0.map(f))
    }

    /// f(self, other), coefficient by coefficient.
    pub fn zip(self, other: Spectrum, f: impl Fn(f32, f32) -> f32) -> Spectrum {
        Spectrum(Vec3::new(f(self.0.x, other.0.x), f(self.0.y, other.0.y), f(self.0.z, other.0.z)))
    }

    /// f(self, other) for a function of all coefficients at once.
    #[inline(always)]
    pub fn zip_all(self, other: Spectrum, f: impl Fn(Vec3A, Vec3A) -> Vec3A) -> Spectrum {
        Spectrum(f(self.0.into(), other.0.into()).into())
    }
}

impl Add for Spectrum {
    type Output = Spectrum;
    fn add(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 + other.0)
    }
}

impl AddAssign for Spectrum {
    fn add_assign(&mut self, other: Spectrum) {
        self.0 += other.0;
    }
}

impl Sub for Spectrum {
    type Output = Spectrum;
    fn sub(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 - other.0)
    }
}

impl Mul for Spectrum {
    type Output = Spectrum;
    fn mul(self, other: Spectrum) -> Spectrum {
        Spectrum(self.0 * other.0)
    }
}

impl MulAssign for Spectrum {
    fn mul_assign(&mut self, other: Spectrum) {
        self.0 *= other.0;
    }
}

impl Mul<f32> for Spectrum {
    type Output = Spectrum;
    fn mul(self, factor: f32) -> Spectrum {
        Spectrum(self.0 * factor)
    }
}

impl MulAssign<f32> for Spectrum {
    fn mul_assign(&mut self, factor: f32) {
        self.0 *= factor;
    }
}

impl Div<f32> for Spectrum {
    type Output = Spectrum;
    fn div(self, divisor: f32) -> Spectrum {
        Spectrum(self.0 / divisor)
    }
}

impl Sum for Spectrum {
    fn sum<I: Iterator<Item = Spectrum>>(iter: I) -> Spectrum {
        iter.fold(Spectrum::BLACK, Add::add)
    }
}
