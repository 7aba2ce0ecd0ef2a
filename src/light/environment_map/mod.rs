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
use super::flat_share::{FlatShare, Part, THRESHOLD};
use super::{EmittedRay, LightLiSample, LightSampleContext, ShadowTarget};
use crate::math::{Density, Rgb, SolidAnglePdf, Spectrum, warp};
use crate::texture::image::Pixels;

pub(crate) use self::irradiance::IrradianceMap;
pub use self::mapping::Mapping;

/// Light from all directions as a picture shows it, interpolated between the centres of pixels.
///
/// Its light is sampled in two parts. The flat part, radiance up to a little above the mean, is sampled as the light of a constant
/// environment is, also with the cosine of a surface; the peaks above it in proportion to their interpolated radiance. A picture of one
/// colour is sampled as a constant environment: with the same bits.
///
/// Tests: row W17 of `pt torture`, dark_maps_are_never_chosen, maps_of_one_colour_are_constant_environments,
/// turned_maps_keep_their_bits, scaled_maps_keep_their_bits, densities_integrate_to_one.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    picture: Picture,
    /// Rotation from the world to the picture's coordinates.
    to_picture: Mat3,
    /// Distribution of the peaks; `None` if there are none.
    peaks: Option<Distribution>,
    /// Share of the flat part in the light, and in the rays that the map emits.
    flat_share: FlatShare,
    /// Share of the flat part in the samples for surfaces.
    surface_share: FlatShare,
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

/// Share of the flat part in the samples for surfaces, relative to its share in the light.
///
/// Paths meet the flat part by the sampling of materials too, so that fewer samples of it are needed: MIS compensation (Karlík et al.,
/// MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling, 2019). It is not 0, so that a direction with light has
/// a density above 0 also for integrators that sample nothing but lights; the mean square of their samples is at most doubled.
const COMPENSATION: f32 = 0.5;

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
        picture.threshold = (f64::from(THRESHOLD) * mean) as f32;
        let flat = picture.mean_of_rows(|rgb| rgb.average().min(picture.threshold));
        // Numbers below the normal ones are too coarse to divide: light that faint is sampled as light of one radiance.
        let peaks = if picture.threshold.is_normal() { Distribution::new(&picture) } else { None };
        let [flat_share, surface_share] = match peaks {
            Some(_) => [1.0, COMPENSATION].map(|factor| FlatShare::new(factor * (flat / mean) as f32)),
            None => [FlatShare::ALL; 2],
        };
        let irradiance = IrradianceMap::new(harmonics);
        EnvironmentMap { picture, to_picture: to_world.transpose(), peaks, flat_share, surface_share, mean, irradiance }
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
        let wi = match self.surface_share.choose(u) {
            Part::Flat(u) => flat_sample(cx, u),
            Part::Peaks(u) => self.sample_peaks(u)?,
        };
        let (li, pdf) = self.radiance_and_density(self.surface_share, flat_pdf(cx, wi), wi);
        let is_possible = pdf.get() > 0.0 && !li.is_black();
        is_possible.then_some(LightLiSample { wi, li, density: Density::Smooth(pdf), target: ShadowTarget::Infinity })
    }

    /// Density of a sampled direction.
    pub(super) fn pdf(&self, cx: &LightSampleContext, wi: Vec3) -> SolidAnglePdf {
        self.radiance_and_density(self.surface_share, flat_pdf(cx, wi), wi).1
    }

    /// Density with which the light emits rays that come from the direction `wi`.
    pub(super) fn emission_pdf(&self, wi: Vec3) -> SolidAnglePdf {
        self.emitted(wi).1
    }

    /// Radiance from the direction `wi`, and the density of a ray that the light emits from there.
    fn emitted(&self, wi: Vec3) -> (Spectrum, SolidAnglePdf) {
        self.radiance_and_density(self.flat_share, SolidAnglePdf::new(warp::uniform_sphere_pdf()), wi)
    }

    /// A ray through the scene.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        let wi = match self.flat_share.choose(cx.direction) {
            Part::Flat(u) => warp::uniform_sphere(u),
            Part::Peaks(u) => self.sample_peaks(u)?,
        };
        let (radiance, pdf) = self.emitted(wi);
        cx.ray_from_infinity(-wi, radiance, Density::Smooth(pdf)).filter(|_| pdf.get() > 0.0)
    }

    /// Flux Φ = π R² · 4π L through a scene of radius R, with the mean radiance L (W).
    pub(super) fn power(&self, radius: f64) -> f64 {
        4.0 * PI * PI * radius * radius * self.mean
    }

    /// Irradiance on surfaces [W·m⁻²], by their normals in the coordinates that the returned rotation leads to.
    pub(super) fn irradiance(&self) -> (Mat3, IrradianceMap) {
        (self.to_picture, self.irradiance)
    }

    /// Samples a direction of the peaks.
    fn sample_peaks(&self, u: Vec2) -> Option<Vec3> {
        let uv = self.peaks.as_ref()?.sample(&self.picture, u);
        let w = self.to_picture.transpose() * self.picture.mapping.direction(uv);
        // In f64 the length does not depend on the order of the axes, which rotations by quarter turns exchange.
        Some(w.as_dvec3().normalize().as_vec3())
    }

    /// Radiance from a direction, and the density of both parts together.
    ///
    /// - `flat`: density of the flat part
    fn radiance_and_density(&self, share: FlatShare, flat: SolidAnglePdf, wi: Vec3) -> (Spectrum, SolidAnglePdf) {
        let w = self.to_picture * wi;
        let place = self.picture.place(self.picture.mapping.coordinates(w));
        let pixels = self.picture.around(place.pixel);
        let radiance = Spectrum::from_illuminant(self.picture.radiance(&pixels, place.share));
        let Some(peaks) = &self.peaks else { return (radiance, flat) };
        let weight = self.picture.peak_weight(&pixels, &place);
        let peak = self.picture.mapping.by_solid_angle(w, peaks.density(weight));
        (radiance, SolidAnglePdf::new(share.density(flat.get(), peak)))
    }
}

/// A place between the centres of four pixels.
struct Place {
    /// The pixel to the left and above.
    pixel: IVec2,
    /// Position between its centre and that of the pixel to the right and below, in [0, 1]².
    share: Vec2,
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
        let Place { pixel, share } = self.place(uv);
        self.radiance(&self.around(pixel), share)
    }

    /// Radiance between four pixels, [`Picture::around`].
    #[inline]
    fn radiance(&self, &[a, b, c, d]: &[Rgb; 4], share: Vec2) -> Rgb {
        // Between equal values, this form has no rounding.
        let between = |a: Rgb, b: Rgb, share: f32| a + (b - a) * share;
        between(between(a, b, share.x), between(c, d, share.x), share.y) * self.scale
    }

    /// Weight of the peaks between four pixels, [`Picture::around`].
    #[inline]
    fn peak_weight(&self, &[a, b, c, d]: &[Rgb; 4], Place { pixel, share }: &Place) -> f32 {
        let [above, below] = [pixel.y, pixel.y + 1];
        let corners = [self.peak(a, above), self.peak(b, above), self.peak(c, below), self.peak(d, below)];
        bilinear(corners, *share).max(0.0)
    }

    /// Place of coordinates.
    #[inline]
    fn place(&self, uv: Vec2) -> Place {
        let size = self.pixels.size();
        let at = uv * size.as_vec2() - 0.5;
        // Rounds down, as numbers from −1 on allow, since `floor` is a call where the compiler may use no SSE 4.1.
        let pixel = ((at + 1.0).as_ivec2() - 1).clamp(IVec2::NEG_ONE, size.as_ivec2() - 1);
        Place { pixel, share: (at - pixel.as_vec2()).clamp(Vec2::ZERO, Vec2::ONE) }
    }

    /// Values of a pixel, of that to its right, and of the two below.
    #[inline]
    fn around(&self, first: IVec2) -> [Rgb; 4] {
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|step| self.pixel(first + IVec2::from(step)))
    }

    /// Weight of a value of a row as a peak.
    #[inline]
    fn peak(&self, value: Rgb, row: i32) -> f32 {
        let peak = ((value * self.scale).average() - self.threshold).max(0.0);
        // The sign of a row beyond a pole lets the interpolation be 0 at the pole.
        peak * self.row_weights[(row + 1) as usize]
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
        self.peak(self.pixel(pixel), pixel.y)
    }
}
