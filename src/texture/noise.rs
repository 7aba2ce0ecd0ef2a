//! Fractal noise.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DVec3, IVec3};

use super::{Space, Texture, TextureContext};
use crate::math::Rgb;

/// A blend from `low` to `high` by the share ½ (1 + fbm), limited to 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// The colour where the noise is least.
    pub low: Texture,
    /// The colour where the noise is greatest.
    pub high: Texture,
    /// Cells of the first octave per unit of the coordinates.
    pub scale: f64,
    /// The number of octaves, from 1 to 16.
    pub octaves: u32,
    /// The coordinates of the noise.
    pub space: Space,
}

impl Noise {
    /// Looks up the colour at a point.
    pub fn at(&self, at: &TextureContext) -> Rgb {
        let p = self.space.coordinates(at) * self.scale;
        let share = 0.5
            * (1.0
                + match self.space.widths(at) {
                    None => fbm(p, self.octaves),
                    Some(widths) => filtered_fbm(p, self.octaves, (widths * self.scale).max_element()),
                });
        self.low.at(at).mix(self.high.at(at), share.clamp(0.0, 1.0) as f32)
    }

    pub(super) fn recentred(self, origin: DVec3) -> Noise {
        let (low, high, space) = (self.low.recentred(origin), self.high.recentred(origin), self.space.recentred(origin));
        Noise { low, high, space, ..self }
    }
}

/// Perlin's gradient noise: 0 at the lattice points, from −1 to 1, with a continuous second derivative.
///
/// n(p) = Σ over the 8 corners of p's cell of  w(p − corner) · g(corner)·(p − corner),   w = Π (1 − fade(|x|))
///
/// fade(t) = t³ (6 t² − 15 t + 10);   g: one of the 12 directions to the edges of a cube, selected by a hash of the corner
///
/// - `p`: position in cells; the lattice repeats after 2³² cells
///
/// Source: Perlin, *Improving Noise* (2002), with an integer hash instead of his table. Tests: noise_is_smooth_and_centred.
pub fn perlin(p: DVec3) -> f64 {
    let cell = p.floor();
    let (from, corner) = (p - cell, cell.as_i64vec3().as_ivec3());
    let at = |dx: i32, dy: i32, dz: i32| {
        let offset = from - DVec3::new(dx.into(), dy.into(), dz.into());
        slope(corner.wrapping_add(IVec3::new(dx, dy, dz)), offset)
    };
    let [x, y, z] = from.to_array().map(fade);
    let line = |dy, dz| lerp(at(0, dy, dz), at(1, dy, dz), x);
    let face = |dz| lerp(line(0, dz), line(1, dz), y);
    lerp(face(0), face(1), z)
}

/// Fractional Brownian motion: Σ over `octaves` of 2⁻ᵏ n(2ᵏ p). Each octave has twice the frequency and half the amplitude.
///
/// - result: from −2 to 2
pub fn fbm(p: DVec3, octaves: u32) -> f64 {
    octave_sum(p, octaves, perlin)
}

/// [`fbm`] averaged over a box, about: each octave counts times (1 − w²/2)³, where w is the width of the box in cells of the octave.
///
/// The box filter multiplies a wave of frequency f by sin(πfw)/(πfw) for each axis. For the frequencies of gradient noise, near 1/√3 along
/// each of three axes, the product is that factor within .04, up to w = 1. From √2 on it counts as 0.
///
/// - `width`: width of the box, in cells of the first octave
pub fn filtered_fbm(p: DVec3, octaves: u32, width: f64) -> f64 {
    let mut w = width;
    octave_sum(p, octaves, |p| {
        let left = (1.0 - 0.5 * w * w).max(0.0);
        w *= 2.0;
        if left > 0.0 { perlin(p) * left * left * left } else { 0.0 }
    })
}

/// Turbulence: Σ over `octaves` of 2⁻ᵏ |n(2ᵏ p)|, with creases where an octave of [`fbm`] passes through zero.
///
/// - result: from 0 to 2
pub fn turbulence(p: DVec3, octaves: u32) -> f64 {
    octave_sum(p, octaves, |p| perlin(p).abs())
}

/// How octaves of noise are combined into a turbulence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turbulence {
    /// The sum of absolute values, Σ 2⁻ᵏ |n(2ᵏ p)|: [`turbulence`].
    SumOfAbsolutes,
    /// The absolute value of the sum, |Σ 2⁻ᵏ n(2ᵏ p)| / √2, without shifts between octaves. The root normalizes the directions at lattice
    /// points, which have the length √2.
    ///
    /// Source: Shirley, *Ray Tracing: The Next Week*.
    AbsoluteOfSum,
}

impl Turbulence {
    /// The turbulence at a position in cells.
    pub fn at(self, p: DVec3, octaves: u32) -> f64 {
        match self {
            Turbulence::SumOfAbsolutes => turbulence(p, octaves),
            Turbulence::AbsoluteOfSum => {
                let octave = |k: u32| perlin(p * f64::from(1u32 << k)) / f64::from(1u32 << k);
                (0..octaves).map(octave).sum::<f64>().abs() * FRAC_1_SQRT_2
            }
        }
    }
}

fn octave_sum(p: DVec3, octaves: u32, mut n: impl FnMut(DVec3) -> f64) -> f64 {
    let octave = |k: u32| {
        let scale = f64::from(1u32 << k);
        // Octaves are shifted, because they would all be 0 at the lattice points otherwise.
        n(p * scale + DVec3::splat(0.5 * f64::from(k))) / scale
    };
    (0..octaves).map(octave).sum()
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (6.0 * t - 15.0) + 10.0)
}

fn lerp(a: f64, b: f64, share: f64) -> f64 {
    a + (b - a) * share
}

/// The dot product of a corner's direction and the offset from the corner.
fn slope(corner: IVec3, DVec3 { x, y, z }: DVec3) -> f64 {
    match hash(corner) % 12 {
        0 => x + y,
        1 => x - y,
        2 => -x + y,
        3 => -x - y,
        4 => x + z,
        5 => x - z,
        6 => -x + z,
        7 => -x - z,
        8 => y + z,
        9 => y - z,
        10 => -y + z,
        _ => -y - z,
    }
}

/// A hash of a lattice point.
///
/// Source of the finaliser: Steele, Lea, Flood, *Fast Splittable Pseudorandom Number Generators* (2014).
fn hash(IVec3 { x, y, z }: IVec3) -> u64 {
    let mut h = 0x9e37_79b9_7f4a_7c15u64;
    for part in [x, y, z] {
        h = (h ^ u64::from(part as u32)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        h ^= h >> 27;
    }
    h = h.wrapping_mul(0x94d0_49bb_1331_11eb);
    h ^ (h >> 31)
}
