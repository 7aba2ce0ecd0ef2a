//! The air of the earth: what it scatters and absorbs at each height.

use crate::math::float::exp_f64;

/// Radius of the ground (m).
pub(super) const GROUND: f64 = 6_360e3;

/// Radius of the upper end of the atmosphere (m).
pub(super) const TOP: f64 = 6_420e3;

/// Kinds of particles: molecules of air, aerosols, ozone.
pub(super) const KINDS: usize = 3;

/// Height at which the density of molecules has fallen to 1/e of that at the ground (m).
const RAYLEIGH_HEIGHT: f64 = 8e3;

/// Height at which the density of aerosols has fallen to 1/e of that at the ground (m).
const MIE_HEIGHT: f64 = 1.2e3;

/// Height of the middle of the ozone layer, above and below which its density falls linearly to 0 within [`OZONE_WIDTH`] (m).
const OZONE_HEIGHT: f64 = 25e3;
const OZONE_WIDTH: f64 = 15e3;

/// Scattering of molecules at the ground, for red, green and blue [m⁻¹].
const RAYLEIGH: [f64; 3] = [5.802e-6, 13.558e-6, 33.1e-6];

/// Scattering and extinction of the aerosols of very clean air at the ground [m⁻¹].
const MIE_SCATTERING: f64 = 3.996e-6;
const MIE_EXTINCTION: f64 = 4.44e-6;

/// Absorption in the middle of the ozone layer [m⁻¹].
const OZONE: [f64; 3] = [0.650e-6, 1.881e-6, 0.085e-6];

/// Mean cosine of light scattered by aerosols.
const ASYMMETRY: f64 = 0.8;

/// Values for red, green and blue.
pub(super) type Color = [f64; 3];

/// Densities, relative to the greatest density of each kind; or their integrals along a path (m).
pub(super) type Amounts = [f64; KINDS];

/// Atmosphere with a certain amount of aerosols.
///
/// Source of the constants: Bruneton, *Precomputed Atmospheric Scattering: a New Implementation* (2017), and Hillaire, *A Scalable and
/// Production Ready Sky and Atmosphere Rendering Technique* (2020).
#[derive(Clone, Copy, Debug)]
pub(super) struct Atmosphere {
    /// Amount of aerosols, relative to very clean air.
    pub aerosols: f64,
}

impl Atmosphere {
    /// Air of a given turbidity: the ratio of the extinction by molecules and aerosols to that by molecules alone, along a vertical path
    /// through all of the atmosphere and for green light.
    pub fn of_turbidity(turbidity: f64) -> Atmosphere {
        Atmosphere { aerosols: (turbidity - 1.0) * (RAYLEIGH[1] * RAYLEIGH_HEIGHT) / (MIE_EXTINCTION * MIE_HEIGHT) }
    }

    /// Scattering by molecules and by aerosols where they have these densities [m⁻¹].
    pub fn scattering(&self, densities: &Amounts) -> [Color; 2] {
        let mie = self.aerosols * MIE_SCATTERING * densities[1];
        [RAYLEIGH.map(|rayleigh| rayleigh * densities[0]), [mie; 3]]
    }

    /// Share of light that passes these amounts of particles.
    pub fn transmittance(&self, amounts: &Amounts) -> Color {
        let mie = self.aerosols * MIE_EXTINCTION * amounts[1];
        std::array::from_fn(|k| exp_f64(-(RAYLEIGH[k] * amounts[0] + mie + OZONE[k] * amounts[2])))
    }
}

/// Relative densities at a distance from the centre of the earth.
pub(super) fn densities(radius: f64) -> Amounts {
    let height = radius - GROUND;
    let ozone = (1.0 - (height - OZONE_HEIGHT).abs() / OZONE_WIDTH).max(0.0);
    [exp_f64(-height / RAYLEIGH_HEIGHT), exp_f64(-height / MIE_HEIGHT), ozone]
}

/// Phase functions of molecules and of aerosols (Cornette and Shanks) at a cosine of the scattering angle [sr⁻¹].
pub(super) fn phases(cos: f64) -> [f64; 2] {
    use std::f64::consts::PI;
    let g = ASYMMETRY;
    let base = 1.0 + g * g - 2.0 * g * cos;
    let mie = 3.0 / (8.0 * PI) * (1.0 - g * g) * (1.0 + cos * cos) / ((2.0 + g * g) * base * base.sqrt());
    [3.0 / (16.0 * PI) * (1.0 + cos * cos), mie]
}
