//! Test of the directions of a warp against their density.

use std::fmt;
use std::process::ExitCode;

use glam::Vec2;

use super::SampleArgs;
use super::points::{Directions, Map, Parameters, Warp};
use crate::bsdf::{BsdfSample, Lobe, TransportMode};
use crate::cli::print_stdout;
use crate::error::{Error, Result};
use crate::math::{Density, Local, SolidAnglePdf, Spectrum};
use crate::measure::sidak;
use crate::proof::{Chi2, Model, Options, SampledDirections, chi2};

/// Tests the sampled directions of a warp on three divisions of the sphere, and prints the results. The exit code is 1 if one test
/// rejects the density, at a significance of 1 % for all three together.
pub fn print_tests(warp: &Warp, parameters: &Parameters, args: &SampleArgs) -> Result<ExitCode> {
    let Map::Sphere(directions) = (warp.map)(parameters)? else {
        return Err(Error::Usage(format!("--chi2: the points of {} are no directions", warp.name)));
    };
    let options = Options { samples: args.samples, seed: args.seed, ..Options::default() };
    let sampled = SampledDirections::new(&Scattering { warp, directions }, Local::NORMAL, 0, &options);
    let tests = tests(&sampled);
    print_stdout(&format!("samples        {}\n∫ pdf          {:.5}\nchi² p         {}\n", sampled.samples, sampled.mass, figures(&tests)))?;
    let refused = tests.iter().any(|(_, test)| test.p < sidak(options.alpha, tests.len()));
    Ok(ExitCode::from(u8::from(refused)))
}

/// Tests of each division.
pub fn tests(sampled: &SampledDirections) -> Vec<(&'static str, Chi2)> {
    sampled.divisions.iter().map(|division| (division.name, chi2(&division.shares, &division.counts))).collect()
}

/// Text of the tests.
pub fn figures(tests: &[(&str, Chi2)]) -> String {
    let figures: Vec<String> =
        tests.iter().map(|(name, test)| format!("{:.3} ({name}, {} degrees of freedom)", test.p, test.freedom)).collect();
    figures.join(", ")
}

/// Surface that scatters all light into the directions of a warp, with its density, whatever the incidence.
struct Scattering<'a> {
    warp: &'a Warp,
    directions: Directions,
}

impl fmt::Debug for Scattering<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.warp.name)
    }
}

impl Model for Scattering<'_> {
    fn eval(&self, wo: Local, wi: Local, _mode: TransportMode) -> Spectrum {
        Spectrum::gray(self.pdf(wo, wi).get())
    }

    fn pdf(&self, _wo: Local, wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::new((self.directions.pdf)(wi.0))
    }

    fn sample(&self, wo: Local, _choice: f32, u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        let wi = Local((self.directions.map)(u));
        let density = Density::Smooth(self.pdf(wo, wi));
        Some(BsdfSample { wi, weight: Spectrum::ONE, density, lobe: Lobe::Reflection, eta: 1.0 })
    }
}
