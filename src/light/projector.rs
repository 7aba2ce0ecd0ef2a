//! Spotlights that project a picture.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::bounds::LightBounds;
use super::emitted_ray::EmissionContext;
use super::{EmittedRay, LightLiSample, Spot};
use crate::math::{Rgb, SolidAnglePdf, Spectrum};
use crate::texture::image::{Filter, Image, Pixels, Wrap};

/// Spotlight whose intensity is multiplied by a picture, as a slide projector does: straight lines of the picture are straight on a wall.
///
/// Tests: projectors_show_their_picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Projector {
    /// The spotlight.
    pub spot: Spot,
    /// Unit vectors towards the right and the upper edge of the picture, as seen from the light.
    right: Vec3,
    up: Vec3,
    /// Tangents of half the angles under which the picture is seen from the light.
    half: Vec2,
    picture: Image,
    /// Mean of the picture.
    mean: f64,
    /// Cosine of half the angle of the smallest cone around the axis that contains all light: that of the spotlight, or of the corners.
    cos_outer: f64,
}

impl Projector {
    /// A projector; `None` if `up` is parallel to the axis of the spotlight.
    ///
    /// - `up`: direction towards the upper edge of the picture
    /// - `half_width`: tangent of half the angle of the picture's width; its pixels are square
    pub fn new(spot: Spot, up: Vec3, half_width: f32, pixels: Arc<Pixels>) -> Option<Projector> {
        let right = spot.axis.cross(up).try_normalize()?;
        let size = pixels.size().as_vec2();
        let sum = |value: &[f32; 3]| value.iter().map(|x| f64::from(*x)).sum::<f64>() / 3.0;
        let mean = pixels.values().iter().map(sum).sum::<f64>() / pixels.values().len() as f64;
        let half = Vec2::new(half_width, half_width * size.y / size.x);
        let picture = Image { pixels, pyramid: None, scale: Vec2::ONE, wrap: Wrap::Clamp, filter: Filter::Bilinear };
        // The directions of the corners are rounded to f32.
        let corner = half.as_dvec2().length() + 8.0 * f64::from(f32::EPSILON);
        let cos_outer = spot.cos_outer.max((1.0 + corner * corner).sqrt().recip());
        Some(Projector { up: right.cross(spot.axis), spot, right, half, picture, mean, cos_outer })
    }

    /// Value of the picture in the direction `w`; black beside it.
    fn picture(&self, w: Vec3) -> Spectrum {
        let ahead = w.dot(self.spot.axis);
        let place = Vec2::new(w.dot(self.right), w.dot(self.up)) / (self.half * ahead);
        if ahead <= 0.0 || place.abs().max_element() > 1.0 {
            return Spectrum::BLACK;
        }
        Spectrum::from_coefficients(self.picture.value(place * 0.5 + 0.5))
    }

    pub(super) fn sample(&self, from: Vec3) -> Option<LightLiSample> {
        let sample = self.spot.sample(from)?;
        let li = sample.li * self.picture(-sample.wi);
        (!li.is_black()).then_some(LightLiSample { li, ..sample })
    }

    /// A ray in a direction within the cone around the picture.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        let emitted = self.spot.emit_within(self.cos_outer, cx)?;
        let le = emitted.le * self.picture(emitted.ray.direction);
        (!le.is_black()).then_some(EmittedRay { le, ..emitted })
    }

    pub(super) fn emission_pdf(&self, w: Vec3) -> SolidAnglePdf {
        self.spot.emission_pdf_within(self.cos_outer, w)
    }

    /// Bounds for the choice of the light, with the mean of the picture.
    pub(super) fn bounds(&self) -> LightBounds {
        self.spot.bounds_within(self.cos_outer, self.mean)
    }

    /// Whether no light comes through the picture.
    pub(super) fn is_black(&self) -> bool {
        self.spot.intensity == Rgb::BLACK || self.mean == 0.0
    }

    /// Flux Φ ≈ I Ω mean, with the solid angle Ω of the cone around the picture (W).
    pub(super) fn power(&self) -> f64 {
        self.spot.peak() * TAU * (1.0 - self.cos_outer) * self.mean
    }
}
