//! Environment map: a picture of the surroundings, infinitely far away.

mod irradiance;
mod mapping;

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{IVec2, Mat3, UVec2, Vec2, Vec3};
use rayon::prelude::*;

use self::irradiance::COUNT;
use super::distribution::{Distribution, Weights, bilinear};
use super::emitted_ray::EmissionContext;
use super::environment::{flat_pdf, flat_sample};
use super::{EmittedRay, LightLiSample, LightSampleContext, ShadowTarget};
use crate::math::float::ONE_MINUS_EPSILON;
use crate::math::{Density, Rgb, SolidAnglePdf, Spectrum, warp};
use crate::texture::image::Pixels;

pub(crate) use self::irradiance::IrradianceMap;
pub use self::mapping::Mapping;

/// Light from all directions as a picture shows it, interpolated between the centres of pixels.
///
/// The radiance L is divided into a flat part min(L, t) and peaks max(0, L − t), t being a little above the mean of L. Directions are
/// sampled with the density
///
/// p(ω) = s p_flat(ω) + (1 − s) p_peaks(ω),
///
/// where s is the share of the flat part in the light. The flat part is sampled as the light of a constant environment is, also with the
/// cosine of a surface; the peaks in proportion to their interpolated radiance. So dim directions keep a density above 0 beside a sun, and
/// a picture of one colour is sampled as a constant environment: with the same bits.
///
/// Tests: one_bright_pixel_is_sampled_without_noise, dark_maps_are_never_chosen, maps_of_one_colour_are_constant_environments,
/// turned_maps_keep_their_bits, scaled_maps_keep_their_bits, densities_integrate_to_one.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    picture: Picture,
    /// Rotation from the world to the picture's coordinates.
    to_picture: Mat3,
    /// Distribution of the peaks; `None` if there are none.
    peaks: Option<Distribution>,
    /// Share s of the flat part.
    flat_share: f32,
    /// Mean radiance over all directions and colour components [W·m⁻²·sr⁻¹].
    mean: f64,
    /// Irradiance in the picture's coordinates.
    irradiance: IrradianceMap,
}

/// Picture that surrounds a scene.
#[derive(Clone, Debug)]
struct Picture {
    pixels: Arc<Pixels>,
    mapping: Mapping,
    /// Factor for the pixels.
    scale: Rgb,
    /// Mean of the colour components from which on radiance counts as a peak [W·m⁻²·sr⁻¹].
    threshold: f32,
    /// [`Mapping::row_weight`] of all rows, from that before the first to that behind the last.
    row_weights: Vec<f32>,
}

/// Two maps are equal if they have the same settings and the same pixels.
impl PartialEq for EnvironmentMap {
    fn eq(&self, other: &EnvironmentMap) -> bool {
        let settings = |map: &EnvironmentMap| (map.picture.mapping, map.picture.scale, map.to_picture);
        settings(self) == settings(other) && self.picture.pixels == other.picture.pixels
    }
}

/// Ratio of the threshold between flat part and peaks to the mean radiance. Above 1, so that rounding makes no peaks of one colour.
const THRESHOLD: f64 = 1.0 + 1.0 / 16.0;

impl EnvironmentMap {
    /// An environment map.
    ///
    /// - `scale`: factor for the values of the picture, which are radiances after it [W·m⁻²·sr⁻¹]
    /// - `to_world`: rotation from the coordinates of [`Mapping`] to the world; it may mirror
    pub fn new(pixels: Arc<Pixels>, mapping: Mapping, scale: Rgb, to_world: Mat3) -> EnvironmentMap {
        let rows = pixels.size().y;
        let row_weights = (-1..=rows as i32).map(|row| mapping.row_weight(row, rows)).collect();
        let mut picture = Picture { pixels, mapping, scale, threshold: f32::INFINITY, row_weights };
        let Moments { mean, harmonics } = picture.moments();
        picture.threshold = (THRESHOLD * mean) as f32;
        let flat = picture.mean_of_rows(|rgb| rgb.average().min(picture.threshold));
        let peaks = Distribution::new(&picture);
        let flat_share = if peaks.is_some() { (flat / mean) as f32 } else { 1.0 };
        EnvironmentMap { picture, to_picture: to_world.transpose(), peaks, flat_share, mean, irradiance: IrradianceMap::new(harmonics) }
    }

    /// Mean radiance over all directions and colour components [W·m⁻²·sr⁻¹].
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Radiance that arrives from a direction.
    pub fn radiance(&self, direction: Vec3) -> Spectrum {
        let w = self.to_picture * direction;
        Spectrum::from_illuminant(self.picture.at(self.picture.mapping.coordinates(w)))
    }

    /// Samples a direction for a point.
    pub(super) fn sample(&self, cx: &LightSampleContext, u: Vec2) -> Option<LightLiSample> {
        let wi = match self.part(u) {
            Part::Flat(u) => flat_sample(cx, u),
            Part::Peak(wi) => wi,
        };
        let (li, pdf) = (self.radiance(wi), self.pdf(cx, wi));
        let is_possible = pdf.get() > 0.0 && !li.is_black();
        is_possible.then_some(LightLiSample { wi, li, density: Density::Smooth(pdf), target: ShadowTarget::Infinity })
    }

    /// Density of a sampled direction.
    pub(super) fn pdf(&self, cx: &LightSampleContext, wi: Vec3) -> SolidAnglePdf {
        self.mixture(flat_pdf(cx, wi), wi)
    }

    /// Density with which the light emits rays that come from the direction `wi`.
    pub(super) fn emission_pdf(&self, wi: Vec3) -> SolidAnglePdf {
        self.mixture(SolidAnglePdf::new(warp::uniform_sphere_pdf()), wi)
    }

    /// A ray through the scene.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        let wi = match self.part(cx.direction) {
            Part::Flat(u) => warp::uniform_sphere(u),
            Part::Peak(wi) => wi,
        };
        let pdf = self.emission_pdf(wi);
        cx.ray_from_infinity(-wi, self.radiance(wi), Density::Smooth(pdf)).filter(|_| pdf.get() > 0.0)
    }

    /// Flux Φ = π R² · 4π L through a scene of radius R, with the mean radiance L (W).
    pub(super) fn power(&self, radius: f64) -> f64 {
        4.0 * PI * PI * radius * radius * self.mean
    }

    /// Irradiance on surfaces [W·m⁻²], by their normals in the coordinates that the returned rotation leads to.
    pub(super) fn irradiance(&self) -> (Mat3, IrradianceMap) {
        (self.to_picture, self.irradiance)
    }

    /// Chooses between the flat part and the peaks, and samples the peaks.
    fn part(&self, u: Vec2) -> Part {
        match &self.peaks {
            Some(peaks) if u.x >= self.flat_share => {
                let x = ((u.x - self.flat_share) / (1.0 - self.flat_share)).min(ONE_MINUS_EPSILON);
                let uv = peaks.sample(&self.picture, Vec2::new(x, u.y));
                let w = self.to_picture.transpose() * self.picture.mapping.direction(uv);
                // In f64 the length does not depend on the order of the axes, which rotations by quarter turns exchange.
                Part::Peak(w.as_dvec3().normalize().as_vec3())
            }
            _ => Part::Flat(Vec2::new((u.x / self.flat_share).min(ONE_MINUS_EPSILON), u.y)),
        }
    }

    /// Density of both parts together.
    ///
    /// - `flat`: density of the flat part
    fn mixture(&self, flat: SolidAnglePdf, wi: Vec3) -> SolidAnglePdf {
        let Some(peaks) = &self.peaks else { return flat };
        let w = self.to_picture * wi;
        let weight = self.picture.interpolated_weight(self.picture.mapping.coordinates(w));
        let peak = self.picture.mapping.by_solid_angle(w, peaks.density(weight));
        SolidAnglePdf::new(self.flat_share * flat.get() + (1.0 - self.flat_share) * peak)
    }
}

/// Part of the light that a direction is sampled for.
enum Part {
    /// The flat part, with random numbers for the direction.
    Flat(Vec2),
    /// The peaks, with the direction.
    Peak(Vec3),
}

/// Integrals of the radiance over all directions.
struct Moments {
    /// Mean over directions and colour components.
    mean: f64,
    /// Integrals of the mean of the components times spherical harmonics.
    harmonics: [f64; COUNT],
}

/// Greatest number of pieces that a row is divided into for [`Moments`]: 0.7° are fine enough for the irradiance.
const PIECES: usize = 512;

impl Picture {
    /// Radiance at coordinates of the picture.
    fn at(&self, uv: Vec2) -> Rgb {
        let ([left, top], share) = self.place(uv);
        // Between equal values, this form has no rounding.
        let between = |a: Rgb, b: Rgb, share: f32| a + (b - a) * share;
        let line = |y| between(self.pixel(IVec2::new(left, y)), self.pixel(IVec2::new(left + 1, y)), share.x);
        between(line(top), line(top + 1), share.y) * self.scale
    }

    /// Weight of the peaks at coordinates of the picture.
    fn interpolated_weight(&self, uv: Vec2) -> f32 {
        let (pixel, share) = self.place(uv);
        bilinear(self.around(pixel), share).max(0.0)
    }

    /// Pixel to the left of coordinates and above them, and their position between its centre and that of the pixels to the right and
    /// below.
    fn place(&self, uv: Vec2) -> ([i32; 2], Vec2) {
        let size = self.pixels.size();
        let at = uv * size.as_vec2() - 0.5;
        let pixel = at.floor().clamp(Vec2::NEG_ONE, size.as_vec2() - 1.0);
        (pixel.as_ivec2().to_array(), (at - pixel).clamp(Vec2::ZERO, Vec2::ONE))
    }

    #[inline]
    fn pixel(&self, pixel: IVec2) -> Rgb {
        let UVec2 { x, y } = self.mapping.wrap(pixel, self.pixels.size());
        self.pixels.get(x as usize, y as usize)
    }

    /// Weight of the pixels of a row in means over all directions.
    fn row_weight(&self, row: u32) -> f64 {
        self.row_weights[row as usize + 1].into()
    }

    /// Mean over all directions of a function of the radiance in the pixels.
    ///
    /// The rows are added up in their order, so that the sum has the same bits with any number of threads.
    fn mean_of_rows(&self, of: impl Fn(Rgb) -> f32 + Sync) -> f64 {
        let UVec2 { x: columns, y: rows } = self.pixels.size();
        let row = |y: u32| {
            let line = (0..columns).map(|x| f64::from(of(self.pixels.get(x as usize, y as usize) * self.scale)));
            self.row_weight(y) * line.sum::<f64>()
        };
        let sums: Vec<f64> = (0..rows).into_par_iter().map(row).collect();
        let weights: f64 = (0..rows).map(|y| self.row_weight(y)).sum();
        sums.iter().sum::<f64>() / (weights * f64::from(columns))
    }

    fn moments(&self) -> Moments {
        let UVec2 { x: columns, y: rows } = self.pixels.size();
        let pieces = (columns as usize).min(PIECES);
        let row = |y: u32| {
            let mut sums = [0.0; COUNT];
            let weight = self.row_weight(y);
            for piece in 0..pieces {
                let [from, to] = [piece, piece + 1].map(|k| k * columns as usize / pieces);
                let radiance: f64 = (from..to).map(|x| f64::from((self.pixels.get(x, y as usize) * self.scale).average())).sum();
                let middle = Vec2::new((from + to) as f32 / (2 * columns) as f32, (y as f32 + 0.5) / rows as f32);
                let harmonics = irradiance::basis(self.mapping.direction(middle).as_dvec3());
                sums.iter_mut().zip(harmonics).for_each(|(sum, harmonic)| *sum += weight * radiance * harmonic);
            }
            sums
        };
        let lines: Vec<[f64; COUNT]> = (0..rows).into_par_iter().map(row).collect();
        let weights: f64 = (0..rows).map(|y| self.row_weight(y)).sum();
        let unit = 4.0 * PI / (weights * f64::from(columns));
        let harmonics: [f64; COUNT] = std::array::from_fn(|k| unit * lines.iter().map(|line| line[k]).sum::<f64>());
        Moments { mean: harmonics[0] / (4.0 * PI * irradiance::basis(glam::DVec3::Y)[0]), harmonics }
    }
}

impl Weights for Picture {
    fn size(&self) -> UVec2 {
        self.pixels.size()
    }

    #[inline]
    fn weight(&self, pixel: IVec2) -> f32 {
        let peak = ((self.pixel(pixel) * self.scale).average() - self.threshold).max(0.0);
        // The sign of a row beyond a pole lets the interpolation be 0 at the pole.
        peak * self.row_weights[(pixel.y + 1) as usize]
    }
}
