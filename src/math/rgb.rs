//! Stored colours.

use std::ops::{Add, Mul, Sub};

use glam::Vec3;

/// Colour as pictures, textures and settings store it: linear red, green and blue with the primaries of Rec. 709.
///
/// A stored colour becomes a [`Spectrum`](super::Spectrum) when it is looked up, which depends on what it stands for: a share of light
/// ([`Spectrum::from_albedo`](super::Spectrum::from_albedo)), light itself
/// ([`Spectrum::from_illuminant`](super::Spectrum::from_illuminant)) or a property such as an index of refraction
/// ([`Spectrum::from_coefficients`](super::Spectrum::from_coefficients)).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb(pub(super) Vec3);

impl Rgb {
    /// No red, green or blue.
    pub const BLACK: Rgb = Rgb(Vec3::ZERO);
    /// Red, green and blue of 1.
    pub const WHITE: Rgb = Rgb(Vec3::ONE);

    /// A colour from its components.
    pub const fn new(r: f32, g: f32, b: f32) -> Rgb {
        Rgb(Vec3::new(r, g, b))
    }

    /// A grey: the same value for red, green and blue.
    pub const fn gray(value: f32) -> Rgb {
        Rgb(Vec3::splat(value))
    }

    /// A colour from components in f64, rounded.
    pub fn from_f64(rgb: [f64; 3]) -> Rgb {
        let [r, g, b] = rgb.map(|c| c as f32);
        Rgb::new(r, g, b)
    }

    /// Red, green and blue.
    pub fn to_array(self) -> [f32; 3] {
        self.0.to_array()
    }

    /// Whether all components are 0.
    pub fn is_black(self) -> bool {
        self == Rgb::BLACK
    }

    /// The greatest component.
    pub fn max(self) -> f32 {
        self.0.max_element()
    }

    /// The mean of the components, for colours that stand for a number.
    pub fn average(self) -> f32 {
        (self.0.x + self.0.y + self.0.z) / 3.0
    }

    /// Applies `f` to each component.
    pub fn map(self, f: impl Fn(f32) -> f32) -> Rgb {
        Rgb(self.0.map(f))
    }

    /// Linear interpolation from `self` to `other` by `share`.
    pub fn mix(self, other: Rgb, share: f32) -> Rgb {
        self * (1.0 - share) + other * share
    }
}

impl Add for Rgb {
    type Output = Rgb;
    fn add(self, other: Rgb) -> Rgb {
        Rgb(self.0 + other.0)
    }
}

impl Sub for Rgb {
    type Output = Rgb;
    fn sub(self, other: Rgb) -> Rgb {
        Rgb(self.0 - other.0)
    }
}

impl Mul for Rgb {
    type Output = Rgb;
    fn mul(self, other: Rgb) -> Rgb {
        Rgb(self.0 * other.0)
    }
}

impl Mul<f32> for Rgb {
    type Output = Rgb;
    fn mul(self, factor: f32) -> Rgb {
        Rgb(self.0 * factor)
    }
}
