//! The wavelength of a path, which dispersive glass asks for.

use crate::math::{Spectrum, Wavelength};
use crate::recorder::{Event, Recorder};
use crate::sampler::SampleNumbers;
use crate::sampler::dimension;
use crate::scene::Surface;

/// The wavelength of a path. A path carries light of all wavelengths until it meets a surface whose scattering depends on the wavelength.
/// There it takes one, which it keeps, and its light is multiplied by [`Wavelength::factors`].
///
/// The random number belongs to the sample, so that all branches of a path take the same wavelength.
///
/// Tests: tests/it/dispersion.rs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathWavelength(Option<Wavelength>);

impl PathWavelength {
    /// Gives a dispersive surface the wavelength of the path. Returns the factors of the path's light: 1 if it had its wavelength before.
    ///
    /// - `depth`: scattering events before the surface
    #[cold]
    #[inline(never)]
    pub fn take<R: Recorder + ?Sized>(
        &mut self,
        surface: &mut Surface,
        depth: u32,
        numbers: &mut SampleNumbers,
        recorder: &mut R,
    ) -> Spectrum {
        let (wavelength, factors) = match self.0 {
            Some(wavelength) => (wavelength, Spectrum::ONE),
            None => Wavelength::sample(numbers.get_1d(dimension::WAVELENGTH)),
        };
        if self.0.is_none() {
            recorder.record(|| Event::Wavelength { depth, wavelength, factors });
        }
        self.0 = Some(wavelength);
        surface.bsdf = surface.bsdf.at_wavelength(wavelength);
        factors
    }

    /// The wavelength, if the path has one.
    pub fn get(self) -> Option<Wavelength> {
        self.0
    }
}
