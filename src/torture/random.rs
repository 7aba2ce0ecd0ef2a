//! Random numbers of the hard cases, from fixed seeds: a case gives the same result in every run.

use glam::{DVec3, Vec2};

use crate::math::Transform;
use crate::math::float::{ONE_MINUS_EPSILON, unit_f32};

/// A sequence of random numbers. A case that fails names its seed.
///
/// Source: Steele, Lea, Flood, *Fast Splittable Pseudorandom Number Generators* (2014), the finaliser.
pub struct Random(u64);

impl Random {
    /// Starts the sequence of this seed.
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0xd129_0d3d_4a6b_f9c5))
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// An index below `n`, each equally likely.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.bits()) * n as u128) >> 64) as usize
    }

    /// One of the choices, each equally likely.
    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// A number in [0, 1), a multiple of 2⁻⁵³.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * 2f64.powi(-53)
    }

    /// A number between `from` and `to`, uniform.
    pub fn range(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    /// A number whose logarithm is uniform.
    pub fn magnitude(&mut self, from: f64, to: f64) -> f64 {
        self.range(from.ln(), to.ln()).exp()
    }

    /// 10^x, where x is uniform between `from` and `to`.
    pub fn decade(&mut self, from: f64, to: f64) -> f64 {
        10f64.powf(self.range(from, to))
    }

    /// A point in [0, 1)², of multiples of 2⁻²⁴. Points at corners of the square are more frequent.
    pub fn square(&mut self) -> Vec2 {
        let mut one = || match self.below(64) {
            0 => 0.0,
            1 => ONE_MINUS_EPSILON,
            _ => unit_f32(self.bits() as u32),
        };
        Vec2::new(one(), one())
    }

    /// A uniform point in [0, 1)², for means.
    pub fn uniform_square(&mut self) -> Vec2 {
        Vec2::new(unit_f32(self.bits() as u32), unit_f32(self.bits() as u32))
    }

    /// A unit vector, uniform on the sphere.
    pub fn direction(&mut self) -> DVec3 {
        let (z, phi) = (self.range(-1.0, 1.0), self.range(0.0, std::f64::consts::TAU));
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * phi.cos(), r * phi.sin(), z)
    }

    /// A point in [−1, 1]³, uniform.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.range(-1.0, 1.0), self.range(-1.0, 1.0), self.range(-1.0, 1.0))
    }

    /// A rotation by up to 360° about any axis.
    pub fn rotation(&mut self) -> Transform {
        Transform::rotate(self.direction(), self.range(0.0, 360.0)).expect("an axis has a direction")
    }
}
