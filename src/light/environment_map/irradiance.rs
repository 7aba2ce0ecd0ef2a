//! Irradiance from a picture of the surroundings, for the choice among lights.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

/// Number of spherical harmonics of the bands 0 to 2.
pub(super) const COUNT: usize = 9;

/// Irradiance from all directions on one side of a surface, as a function of its normal.
///
/// A cosine lobe keeps hardly more than the first three bands of spherical harmonics: for maps without small bright parts the error is below a
/// tenth.
///
/// Source: Ramamoorthi and Hanrahan, *An Efficient Representation for Irradiance Environment Maps* (2001).
/// Tests: irradiance_by_harmonics_is_near_the_integral.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct IrradianceMap {
    /// Coefficients of [`basis`], the factors of the cosine lobe included [W·m⁻²].
    coefficients: [f32; COUNT],
    /// Mean over all normals: π times the mean radiance [W·m⁻²].
    mean: f32,
}

/// Share of the mean irradiance below which no irradiance is taken to be. The sum of the harmonics may be too low where little light
/// arrives, even negative.
const LEAST: f32 = 1.0 / 16.0;

impl IrradianceMap {
    /// Irradiance from radiance in spherical harmonics.
    ///
    /// - `radiance`: integrals over the sphere of the radiance times each function of [`basis`]
    pub(super) fn new(radiance: [f64; COUNT]) -> IrradianceMap {
        // ∫ of a cosine lobe times the harmonic of each band around its axis: π, 2π/3, π/4.
        let lobe = |k: usize| match k {
            0 => PI,
            1..=3 => 2.0 * PI / 3.0,
            _ => PI / 4.0,
        };
        let coefficients = std::array::from_fn(|k| (lobe(k) * radiance[k]) as f32);
        IrradianceMap { coefficients, mean: (PI * radiance[0] * basis(DVec3::Y)[0]) as f32 }
    }

    /// Irradiance for radiance times a factor. Its mean is not rounded to 0, so that the light can be chosen.
    pub(crate) fn scaled(&self, factor: f64) -> IrradianceMap {
        let scaled = |x: f32| (f64::from(x) * factor) as f32;
        IrradianceMap { coefficients: self.coefficients.map(scaled), mean: scaled(self.mean).max(f32::MIN_POSITIVE) }
    }

    /// Mean irradiance over all normals [W·m⁻²].
    pub(crate) fn mean(&self) -> f32 {
        self.mean
    }

    /// Irradiance on the side of a unit normal [W·m⁻²].
    pub(crate) fn at(&self, normal: Vec3) -> f32 {
        let sum: f32 = basis32(normal).iter().zip(&self.coefficients).map(|(y, c)| y * c).sum();
        sum.max(LEAST * self.mean).max(f32::MIN_POSITIVE)
    }
}

/// Real spherical harmonics of the bands 0 to 2 at a unit direction, orthonormal over the sphere.
pub(super) fn basis(w: DVec3) -> [f64; COUNT] {
    let DVec3 { x, y, z } = w;
    let [a, b] = [(3.0 / (4.0 * PI)).sqrt(), (15.0 / (4.0 * PI)).sqrt()];
    [
        (1.0 / (4.0 * PI)).sqrt(),
        a * x,
        a * y,
        a * z,
        b * x * y,
        b * y * z,
        b * x * z,
        (5.0 / (16.0 * PI)).sqrt() * (3.0 * z * z - 1.0),
        b / 2.0 * (x * x - y * y),
    ]
}

/// [`basis`] in single precision.
fn basis32(w: Vec3) -> [f32; COUNT] {
    const A: f32 = 0.488_602_5;
    const B: f32 = 1.092_548_4;
    let Vec3 { x, y, z } = w;
    let square = (3.0 * z * z - 1.0) * 0.315_391_57;
    [0.282_094_8, A * x, A * y, A * z, B * x * y, B * y * z, B * x * z, square, B / 2.0 * (x * x - y * y)]
}
