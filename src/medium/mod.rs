//! Participating media: what fills the space between surfaces and absorbs, scatters or emits light on its way, such as fog, milk and
//! coloured water.
//!
//! [`Medium`] has the coefficients, [`Density`] how they vary, [`Phase`] the directions into which light is scattered, and [`Media`] says
//! where which medium is.

mod density;
mod grid;
mod lanes;
mod majorants;
mod media;
mod phase;
pub mod subsurface;

use std::sync::Arc;

use glam::{DAffine3, Vec3};

use crate::math::{Spectrum, float};

pub use density::{Density, MOST_DEPTH, MOST_VALUES, value_count};
pub use grid::{ColorGrid, Grid, Places};
pub use lanes::{lost_lanes, transmittance_lanes};
pub use majorants::{Line, Segment};
pub use media::{Body, Boundaries, Boundary, Inside, InterfaceCrossing, MOST_BODIES, MOST_NESTED, Media};
pub use phase::{MOST_ASYMMETRY, Phase};

/// Medium: its coefficients, and its density, by which they are multiplied.
///
/// dL/ds = ρ [ −(σa + σs) L + σa Le + σs ∫ p(ω, ω') L(ω') dω' ]
///
/// Without a density, ρ is 1 everywhere. In the box of a density, the albedo σs / (σa + σs) and Le may vary too.
///
/// Source: Chandrasekhar, *Radiative Transfer* (1960), §1.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// Extinction coefficient σt = σa + σs (m⁻¹): of the light on a short length ds the share σt ds is absorbed or scattered.
    extinction: Spectrum,
    /// Scattering coefficient σs (m⁻¹).
    scattering: Spectrum,
    /// σa / (σa + σs), the share of what is taken from a ray that is absorbed.
    absorbed: Spectrum,
    /// Le [W·m⁻²·sr⁻¹].
    radiance: Spectrum,
    /// Directions of scattered light.
    pub phase: Phase,
    /// Where shapes with media overlap, the medium with the lowest priority number fills the common space.
    pub priority: i32,
    /// Whether the extinction is equal for all wavelengths.
    is_gray: bool,
    /// ρ; `None` where it is 1 everywhere.
    density: Option<Box<Density>>,
    /// What varies in the box of the density besides it.
    varying: Option<Arc<Varying>>,
}

/// Factors of properties of a medium at each point of the box of its density.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Varying {
    /// Factor of the albedo.
    pub albedo: Option<ColorGrid>,
    /// Factor of the radiance that is emitted.
    pub emission: Option<ColorGrid>,
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
        let absorbed = (extinction - scattering).zip(extinction, share);
        let is_gray = extinction.min() == extinction.max();
        let radiance = Spectrum::BLACK;
        Medium { extinction, scattering, absorbed, radiance, phase, priority: 0, is_gray, density: None, varying: None }
    }

    /// The medium with an emission of its own.
    ///
    /// - `radiance`: Le [W·m⁻²·sr⁻¹]; a unit of length emits σa Le
    pub fn emitting(self, radiance: Spectrum) -> Medium {
        Medium { radiance, ..self }
    }

    /// The medium with a priority.
    pub fn with_priority(self, priority: i32) -> Medium {
        Medium { priority, ..self }
    }

    /// The medium with a density that varies.
    pub fn with_density(self, density: Density) -> Medium {
        Medium { density: Some(Box::new(density)), ..self }
    }

    /// The medium with an albedo and an emission that vary in the box of its density.
    pub fn with_varying(self, varying: Varying) -> Medium {
        Medium { varying: Some(Arc::new(varying)), ..self }
    }

    /// The medium with its density after a transform. Its coefficients remain what they are, per metre of the world.
    pub(crate) fn moved(&self, transform: DAffine3) -> Medium {
        Medium { density: self.density.as_ref().map(|density| Box::new(density.moved(transform))), ..self.clone() }
    }

    /// Density; `None` where it is 1 everywhere.
    #[inline]
    pub fn density(&self) -> Option<&Density> {
        self.density.as_deref()
    }

    /// Greatest optical depth of the upper bounds of the density along a line within one of their cells, see [`MOST_DEPTH`].
    pub fn most_per_cell(&self) -> f64 {
        self.density().map_or(0.0, |density| density.most_per_cell() * f64::from(self.extinction.max()))
    }

    /// σa + σs (m⁻¹), where the density is 1.
    pub fn extinction(&self) -> Spectrum {
        self.extinction
    }

    /// σs (m⁻¹), where the density is 1.
    pub fn scattering(&self) -> Spectrum {
        self.scattering
    }

    /// σs / (σa + σs), the share of the light taken from a ray that is scattered, before the factor by which it varies.
    pub fn albedo(&self) -> Spectrum {
        self.scattering.zip(self.extinction, share)
    }

    /// Factor of the albedo at a point, if it varies.
    ///
    /// - `p`: point in the unit cube of the density
    #[inline]
    fn albedo_factor(&self, p: Vec3) -> Option<Spectrum> {
        Some(Spectrum::from_albedo(self.varying.as_ref()?.albedo.as_ref()?.at(p)))
    }

    /// Albedo at a point.
    ///
    /// - `p`: point in the unit cube of the density
    #[inline]
    pub fn albedo_at(&self, p: Vec3) -> Spectrum {
        self.albedo_factor(p).map_or_else(|| self.albedo(), |factor| self.albedo() * factor)
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
        // A factor of the albedo below 1 makes a medium absorb, and so emit, that only scatters where the factor is 1.
        let varies = self.varying.as_ref().is_some_and(|varying| varying.albedo.is_some());
        !(if varies { self.radiance } else { self.emission() }).is_black()
    }

    /// σa Le / (σa + σs), the radiance of an infinitely thick layer that does not scatter light from elsewhere [W·m⁻²·sr⁻¹].
    pub fn emission(&self) -> Spectrum {
        self.radiance * self.absorbed
    }

    /// σa Le / (σa + σs) at a point [W·m⁻²·sr⁻¹].
    ///
    /// - `p`: point in the unit cube of the density
    pub fn emission_at(&self, p: Vec3) -> Spectrum {
        let absorbed = self.albedo_factor(p).map_or(self.absorbed, |factor| Spectrum::ONE - self.albedo() * factor);
        let factor = self.varying.as_ref().and_then(|varying| varying.emission.as_ref()).map(|grid| grid.at(p));
        let emitted = self.radiance * absorbed;
        factor.map_or(emitted, |factor| emitted * Spectrum::from_coefficients(factor))
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
        self.emission().zip(self.depth(length), |emission, depth| emission * -float::exp_m1_f64(-f64::from(depth)) as f32)
    }
}

/// Share of a part in a whole that may be 0.
fn share(part: f32, whole: f32) -> f32 {
    if whole > 0.0 { part / whole } else { 0.0 }
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
