//! Test of whether two methods, or a method and a picture, converge to the same picture.

use std::path::Path;
use std::sync::Arc;

use super::agreement::{p_values, smallest_bias};
use super::{Agreement, ErrorHistory, ErrorObserver, Refusal, SampledImage, StopCondition, agreement, render_until};
use crate::error::{Error, Fault, Result};
use crate::film::{FilmSpec, Image, MomentFilm};
use crate::integrator::Integrator;
use crate::output::attributes::REFUSED;
use crate::output::{Attributes, exr, same_pixels};
use crate::render::{Render, RenderReport, Settings};
use crate::sampler::SamplerSpec;
use crate::scene::Scene;

/// Independent scramblings of each rendered side; the test uses their variance.
const SCRAMBLINGS: u32 = 16;

/// One of the two pictures.
#[derive(Clone, Debug)]
pub struct Side {
    /// Name of the integrator or of the file.
    pub name: String,
    /// Picture with standard errors.
    pub image: Image,
    /// Number n of independent values behind each mean; its variance has n − 1 degrees of freedom.
    pub samples: u64,
    /// Whether its own error cannot be established because a few pixels hold all the noise. Then the pixels' standard errors prove nothing.
    pub is_heavy: bool,
}

/// How a side was rendered.
#[derive(Clone, Debug)]
pub struct RenderedSide {
    /// The side; `None` if the samples tell no error, or if the render was cancelled.
    pub side: Option<Side>,
    /// Samples per pixel.
    pub samples: u64,
    /// Report of the render.
    pub report: RenderReport,
    /// History of the error.
    pub history: ErrorHistory,
}

/// Result of the test of two sides.
#[derive(Clone, Debug)]
pub struct Verification {
    /// Verdicts of all tests.
    pub agreement: Agreement,
    /// Smallest relative difference of the whole pictures that would have shown; `None` where a few samples hold the noise, so that normal
    /// statistics do not tell it.
    pub smallest_bias: Option<f64>,
}

impl Side {
    /// Reads a picture with standard errors, which must have the pixels of `film`.
    ///
    /// # Errors
    /// `Invalid` for other pixels, missing channels and values that are not finite; those of [`exr::read`].
    pub fn read(path: &Path, film: &FilmSpec) -> Result<Side> {
        let (image, attributes) = exr::read(path)?;
        same_pixels(path, &image, film)?;
        Side::new(path.display().to_string(), image, &attributes).map_err(|message| Error::invalid(Fault::new(message).in_file(path)))
    }

    /// A picture with standard errors, and the attributes that pt's pictures have.
    ///
    /// # Errors
    /// A message about what the picture lacks.
    pub fn new(name: String, image: Image, attributes: &Attributes) -> Result<Side, String> {
        if let Some(missing) = ["R", "G", "B", "StdErr.R", "StdErr.G", "StdErr.B"].into_iter().find(|name| image.channel(name).is_none()) {
            return Err(format!("has no channel {missing}: without standard errors nothing can be concluded"));
        }
        let broken = image.channels.iter().flat_map(|channel| &channel.values).filter(|value| !value.is_finite()).count();
        if broken > 0 {
            return Err(format!("has {broken} values that are not finite"));
        }
        let value = |name: &str| attributes.iter().find(|(other, _)| other == name).map(|(_, value)| value.to_string());
        let freedom = value("pt/standardErrorFreedom").and_then(|text| text.parse::<u64>().ok());
        let freedom = freedom.ok_or("does not say how sure its standard errors are (pt/standardErrorFreedom)")?;
        // The standard errors of a pixel are shared with those around it, which hides that a few samples make them.
        let is_heavy = value(REFUSED).is_some_and(|refusal| refusal == Refusal::HeavyTail.to_string());
        Ok(Side { name, image, samples: freedom + 1, is_heavy })
    }

    /// Renders side `k` of a test.
    ///
    /// The random numbers differ from those of the other side, and from those of a picture with the scene's own seed: with shared numbers
    /// the sides would agree more than chance allows.
    pub fn render(
        scene: &Arc<dyn Scene>,
        film: &FilmSpec,
        (name, integrator): (&str, &dyn Integrator),
        (sampler, k): (SamplerSpec, u64),
        until: &StopCondition,
        observer: &dyn ErrorObserver,
    ) -> RenderedSide {
        let seed = sampler.seed.wrapping_add(0x5eed * (k + 1));
        let sampler = SamplerSpec { seed, scramblings: SCRAMBLINGS, spp: until.samples, ..sampler };
        let mut moments = MomentFilm::new(film.clone());
        let mut render = Render::new(scene.clone(), integrator, film, &Settings::new(sampler));
        let history = render_until(&mut render, &mut moments, until, observer);
        let (freedom, report) = (moments.freedom(), render.report().clone());
        let is_heavy = history.last().and_then(|last| last.error?.refusal()) == Some(Refusal::HeavyTail);
        let side = || Side { name: name.to_owned(), image: moments.image(), samples: freedom as u64 + 1, is_heavy };
        let is_usable = freedom > 0.0 && !report.cancelled;
        RenderedSide { side: is_usable.then(side), samples: moments.samples(), report, history }
    }

    /// The picture with its number of samples.
    pub fn as_sampled_image(&self) -> SampledImage<'_> {
        SampledImage { image: &self.image, samples: self.samples }
    }

    /// The refusal of a side that was rendered with too few samples to tell an error.
    pub fn too_few(samples: u64) -> String {
        format!("{samples} samples per pixel tell no error: at least {} are needed", 2 * SCRAMBLINGS)
    }
}

/// Tests whether two sides are estimates of the same picture.
///
/// - `alpha`: risk of calling two sides different that are the same
///
/// # Errors
/// Those of [`agreement()`](super::agreement::agreement).
pub fn verify(a: &Side, b: &Side, alpha: f64) -> Result<Verification> {
    let mut agreement = agreement(a.as_sampled_image(), b.as_sampled_image(), alpha)?;
    [a, b].into_iter().zip(&mut agreement.heavy).for_each(|(side, heavy)| *heavy |= side.is_heavy);
    let seen = smallest_bias(a.as_sampled_image(), b.as_sampled_image(), alpha)?;
    Ok(Verification { agreement, smallest_bias: (!agreement.heavy.contains(&true)).then_some(seen) })
}

/// Picture of the p-values of two sides, pixel by pixel, see [`p_values`].
///
/// # Errors
/// Those of [`p_values`].
pub fn p_value_picture(a: &Side, b: &Side) -> Result<Image> {
    p_values(a.as_sampled_image(), b.as_sampled_image())
}
