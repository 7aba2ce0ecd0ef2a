//! Participating media: what fills the space between surfaces and absorbs, scatters or emits light on its way, such as fog, milk and
//! coloured water.
//!
//! [`Medium`] has the coefficients, [`Density`] how they vary, [`Phase`] the directions into which light is scattered, and [`Media`] says
//! where which medium is.

mod density;
mod grid;
mod majorants;
mod media;
mod phase;
pub mod subsurface;

use glam::DVec3;

use crate::math::{Spectrum, float};

pub use density::{Density, MOST_DEPTH, MOST_VALUES, value_count};
pub use grid::{Grid, Places};
pub use majorants::{Line, Segment};
pub use media::{Body, Boundaries, Boundary, Inside, InterfaceCrossing, MOST_BODIES, MOST_NESTED, Media};
pub use phase::{MOST_ASYMMETRY, Phase};

/// Medium: its coefficients, and its density, by which they are multiplied.
///
/// dL/ds = ρ [ −(σa + σs) L + σa Le + σs ∫ p(ω, ω') L(ω') dω' ]
///
/// Without a density, ρ is 1 everywhere.
///
/// Source: Chandrasekhar, *Radiative Transfer* (1960), §1.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// σa + σs, the share of the light that is absorbed or scattered on a unit of length (m⁻¹).
    extinction: Spectrum,
    /// σs, the share that is scattered (m⁻¹).
    scattering: Spectrum,
    /// σa Le / (σa + σs), the radiance of an infinitely thick layer that does not scatter light from elsewhere [W·m⁻²·sr⁻¹].
    emission: Spectrum,
    /// Directions of scattered light.
    pub phase: Phase,
    /// Where shapes with media overlap, the medium with the lowest priority number fills the common space.
    pub priority: i32,
    /// Whether the extinction is equal for all wavelengths.
    is_gray: bool,
    /// ρ; `None` where it is 1 everywhere.
    density: Option<Box<Density>>,
}

/// Index of a medium among the media of its scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MediumId(pub u32);

impl Medium {
    /// A medium that does not emit, with the priority 0.
    ///
    /// - `absorption`: σa (m⁻¹)
    /// - `scattering`: σs (m⁻¹)
    pub fn new(absorption: Spectrum, scattering: Spectrum, phase: Phase) -> Medium {
        let extinction = absorption + scattering;
        let is_gray = extinction.min() == extinction.max();
        Medium { extinction, scattering, emission: Spectrum::BLACK, phase, priority: 0, is_gray, density: None }
    }

    /// The medium with an emission of its own.
    ///
    /// - `radiance`: Le [W·m⁻²·sr⁻¹]; a unit of length emits σa Le
    pub fn emitting(self, radiance: Spectrum) -> Medium {
        let absorption = self.extinction - self.scattering;
        let share = absorption.zip(self.extinction, |absorbed, all| if all > 0.0 { absorbed / all } else { 0.0 });
        Medium { emission: radiance * share, ..self }
    }

    /// The medium with a priority.
    pub fn with_priority(self, priority: i32) -> Medium {
        Medium { priority, ..self }
    }

    /// The medium with a density that varies.
    pub fn with_density(self, density: Density) -> Medium {
        Medium { density: Some(Box::new(density)), ..self }
    }

    /// The medium in coordinates whose origin is at `origin` (m).
    pub(crate) fn recentred(self, origin: DVec3) -> Medium {
        Medium { density: self.density.map(|density| Box::new(density.recentred(origin))), ..self }
    }

    /// Density; `None` where it is 1 everywhere.
    #[inline]
    pub fn density(&self) -> Option<&Density> {
        self.density.as_deref()
    }

    /// σa + σs (m⁻¹), where the density is 1.
    pub fn extinction(&self) -> Spectrum {
        self.extinction
    }

    /// σs (m⁻¹), where the density is 1.
    pub fn scattering(&self) -> Spectrum {
        self.scattering
    }

    /// σs / (σa + σs), the share of the light taken from a ray that is scattered.
    pub fn albedo(&self) -> Spectrum {
        self.scattering.zip(self.extinction, |scattered, all| if all > 0.0 { scattered / all } else { 0.0 })
    }

    /// Whether the extinction is equal for all wavelengths.
    pub fn is_gray(&self) -> bool {
        self.is_gray
    }

    /// Whether the medium scatters light.
    pub fn scatters(&self) -> bool {
        !self.scattering.is_black()
    }

    /// Whether the medium emits light.
    pub fn emits(&self) -> bool {
        !self.emission.is_black()
    }

    /// σa Le / (σa + σs) [W·m⁻²·sr⁻¹].
    pub fn emission(&self) -> Spectrum {
        self.emission
    }

    /// τ = (σa + σs) s, the optical depth over a length where the density is 1; 0 without extinction, even if the length is infinite.
    ///
    /// - `length`: s (m)
    #[inline]
    pub fn depth(&self, length: f32) -> Spectrum {
        self.extinction.map(|extinction| optical_depth(extinction, length))
    }

    /// Radiance that the medium emits along a length where the density is 1, less what it absorbs and scatters of that: (1 − e^(−τ)) σa Le / (σa + σs).
    pub fn emitted(&self, length: f32) -> Spectrum {
        self.emission.zip(self.depth(length), |emission, depth| emission * -float::exp_m1_f64(-f64::from(depth)) as f32)
    }
}

/// Optical depth over a length.
#[inline]
fn optical_depth(extinction: f32, length: f32) -> f32 {
    if extinction > 0.0 { extinction * length } else { 0.0 }
}

/// e^(−τ), the share of the light that passes an optical depth.
#[inline]
pub fn transmittance(depth: Spectrum) -> Spectrum {
    depth.map(|depth| float::exp(-depth))
}
