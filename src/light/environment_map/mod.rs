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
use super::environment::FlatLight;
use super::flat_share::{FlatShare, THRESHOLD};
use super::{EmittedRay, LightLiSample, LightSampleContext, ShadowTarget};
use crate::math::lanes::{Lanes, One, Vector};
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
        spectrum(self.radiance_lanes(direction.into()))
    }

    /// Samples a direction for a point.
    pub(super) fn sample(&self, cx: &LightSampleContext, u: Vec2) -> Option<LightLiSample> {
        let (wi, li, pdf) = self.sample_lanes::<One>(cx, u.to_array());
        let is_possible = pdf > 0.0 && !li.is_black();
        is_possible.then_some(LightLiSample {
            wi: wi.into(),
            li: spectrum(li),
            density: Density::Smooth(SolidAnglePdf::new(pdf)),
            target: ShadowTarget::Infinity,
        })
    }

    /// Density of a sampled direction.
    pub(super) fn pdf(&self, cx: &LightSampleContext, wi: Vec3) -> SolidAnglePdf {
        SolidAnglePdf::new(self.radiance_and_pdf_lanes::<One>(cx, wi.into()).1)
    }

    /// Density with which the light emits rays that come from the direction `wi`.
    pub(super) fn emission_pdf(&self, wi: Vec3) -> SolidAnglePdf {
        SolidAnglePdf::new(self.radiance_and_density::<One>(self.flat_share, Uniform.pdf(wi.into()), wi.into()).1)
    }

    /// A ray through the scene.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        let u = cx.direction.to_array();
        let (wi, radiance, pdf) = self.sample_parts::<One>(self.flat_share, &Uniform, u);
        cx.ray_from_infinity(-Vec3::from(wi), spectrum(radiance), Density::Smooth(SolidAnglePdf::new(pdf))).filter(|_| pdf > 0.0)
    }

    /// Flux Φ = π R² · 4π L through a scene of radius R, with the mean radiance L (W).
    pub(super) fn power(&self, radius: f64) -> f64 {
        4.0 * PI * PI * radius * radius * self.mean
    }

    /// Irradiance on surfaces [W·m⁻²], by their normals in the coordinates that the returned rotation leads to.
    pub(super) fn irradiance(&self) -> (Mat3, IrradianceMap) {
        (self.to_picture, self.irradiance)
    }
}

/// Lookups and samples in each lane; one lane is the code for single directions.
impl EnvironmentMap {
    /// Radiance that arrives from unit directions.
    #[inline(always)]
    pub(crate) fn radiance_lanes<L: Lanes>(&self, directions: Vector<L>) -> Vector<L> {
        let w = directions.transformed(&self.to_picture);
        let place = self.picture.place::<L>(self.picture.mapping.coordinates_lanes(w));
        self.picture.radiance(&self.picture.around(place.cell), place.share)
    }

    /// Directions for points, their radiance and their densities [sr⁻¹]. Where the radiance or the density is 0 there is no sample.
    ///
    /// - `flat`: how light of one radiance is sampled for the points
    #[inline(always)]
    pub(crate) fn sample_lanes<L: Lanes>(&self, flat: &impl FlatLight<L>, u: [L::F32; 2]) -> (Vector<L>, Vector<L>, L::F32) {
        self.sample_parts(self.surface_share, flat, u)
    }

    /// Radiance that arrives from the directions `wi`, and the densities with which [`EnvironmentMap::sample_lanes`] samples them.
    #[inline(always)]
    pub(crate) fn radiance_and_pdf_lanes<L: Lanes>(&self, flat: &impl FlatLight<L>, wi: Vector<L>) -> (Vector<L>, L::F32) {
        self.radiance_and_density(self.surface_share, flat.pdf(wi), wi)
    }

    /// Directions of both parts together, their radiance and their densities.
    #[inline(always)]
    fn sample_parts<L: Lanes>(&self, share: FlatShare, flat: &impl FlatLight<L>, u: [L::F32; 2]) -> (Vector<L>, Vector<L>, L::F32) {
        let (is_flat, u) = share.choose_lanes::<L>(u);
        let mut wi = Vector::splat(Vec3::Y);
        if L::any(is_flat) {
            wi = flat.sample(u);
        }
        if let Some(peaks) = &self.peaks
            && L::any(!is_flat)
        {
            wi = Vector::select(is_flat, wi, self.sample_peaks(peaks, u));
        }
        let (radiance, pdf) = self.radiance_and_density(share, flat.pdf(wi), wi);
        (wi, radiance, pdf)
    }

    /// Directions of the peaks.
    #[inline(always)]
    fn sample_peaks<L: Lanes>(&self, peaks: &Distribution, u: [L::F32; 2]) -> Vector<L> {
        let uv = peaks.sample_lanes::<L>(&self.picture, u);
        let w = self.picture.mapping.direction_lanes::<L>(uv).transformed(&self.to_picture.transpose());
        // In f64 the length does not depend on the order of the axes, which rotations by quarter turns exchange.
        w.widened().normalized().narrowed()
    }

    /// Radiance from directions, and the densities of both parts together.
    ///
    /// - `flat`: densities of the flat part
    #[inline(always)]
    fn radiance_and_density<L: Lanes>(&self, share: FlatShare, flat: L::F32, wi: Vector<L>) -> (Vector<L>, L::F32) {
        let w = wi.transformed(&self.to_picture);
        let place = self.picture.place::<L>(self.picture.mapping.coordinates_lanes(w));
        let pixels = self.picture.around(place.cell);
        let radiance = self.picture.radiance(&pixels, place.share);
        let Some(peaks) = &self.peaks else { return (radiance, flat) };
        let weight = self.picture.peak_weight(&pixels, &place);
        let peak = self.picture.mapping.by_solid_angle::<L>(w, peaks.density_lanes::<L>(weight));
        (radiance, share.density_lanes::<L>(flat, peak))
    }
}

/// The radiance of a single direction.
fn spectrum(radiance: Vector<One>) -> Spectrum {
    let [r, g, b] = Vec3::from(radiance).to_array();
    Spectrum::from_illuminant(Rgb::new(r, g, b))
}

/// Rays that light of one radiance emits.
struct Uniform;

impl FlatLight<One> for Uniform {
    fn sample(&self, u: [f32; 2]) -> Vector<One> {
        warp::uniform_sphere(u.into()).into()
    }

    fn pdf(&self, _wi: Vector<One>) -> f32 {
        warp::uniform_sphere_pdf()
    }
}

/// Cells of coordinates along an axis of `count` pixels, and the positions between the centres of the pixels.
#[inline(always)]
fn place_along<L: Lanes>(coordinate: L::F32, count: u32) -> (L::U32, L::F32) {
    let one = L::f32(1.0);
    let at = coordinate * L::f32(count as f32) - L::f32(0.5);
    let cell = L::to_u32(at + one);
    let share = at - (L::to_f32(cell) - one);
    (cell, L::min(L::max(share, L::f32(0.0)), one))
}

/// Places between the centres of four pixels, one in each lane.
struct Place<L: Lanes> {
    /// Column and row of the cell between these centres, as in [`Weights::around`].
    cell: [L::U32; 2],
    /// Position between the centre of the pixel to the left and above and that of the pixel to the right and below, in [0, 1]².
    share: [L::F32; 2],
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
    /// Radiance between four pixels, [`Picture::around`].
    #[inline(always)]
    fn radiance<L: Lanes>(&self, &[a, b, c, d]: &[Vector<L>; 4], [x, y]: [L::F32; 2]) -> Vector<L> {
        // Between equal values, this form has no rounding.
        let (above, below) = (a + (b - a).scaled(x), c + (d - c).scaled(x));
        (above + (below - above).scaled(y)) * self.scale()
    }

    /// Weights of the peaks between four pixels, [`Picture::around`].
    #[inline(always)]
    fn peak_weight<L: Lanes>(&self, pixels: &[Vector<L>; 4], place: &Place<L>) -> L::F32 {
        L::max(bilinear::<L>(self.peaks(pixels, place.cell[1]), place.share), L::f32(0.0))
    }

    /// Weights of four pixels as peaks.
    ///
    /// - `row`: row of the cell between them
    #[inline(always)]
    fn peaks<L: Lanes>(&self, &[a, b, c, d]: &[Vector<L>; 4], row: L::U32) -> [L::F32; 4] {
        let below = row + L::u32(1);
        [self.peak(a, row), self.peak(b, row), self.peak(c, below), self.peak(d, below)]
    }

    /// Places of coordinates.
    #[inline(always)]
    fn place<L: Lanes>(&self, uv: [L::F32; 2]) -> Place<L> {
        let size = self.pixels.size();
        let ((column, x), (row, y)) = (place_along::<L>(uv[0], size.x), place_along::<L>(uv[1], size.y));
        Place { cell: [column, row], share: [x, y] }
    }

    /// Values of the four pixels around cells, as in [`Weights::around`].
    #[inline(always)]
    fn around<L: Lanes>(&self, [column, row]: [L::U32; 2]) -> [Vector<L>; 4] {
        let (right, below) = (column + L::u32(1), row + L::u32(1));
        [self.pixel([column, row]), self.pixel([right, row]), self.pixel([column, below]), self.pixel([right, below])]
    }

    /// Weights of values as peaks.
    ///
    /// - `row`: their rows, plus 1
    #[inline(always)]
    fn peak<L: Lanes>(&self, value: Vector<L>, row: L::U32) -> L::F32 {
        let value = value * self.scale();
        let average = (value.x + value.y + value.z) / L::f32(3.0);
        // The sign of a row beyond a pole lets the interpolation be 0 at the pole.
        L::max(average - L::f32(self.threshold), L::f32(0.0)) * L::gather(&self.row_weights, row)
    }

    /// Values of pixels.
    ///
    /// - `place`: column and row, plus 1
    #[inline(always)]
    fn pixel<L: Lanes>(&self, place: [L::U32; 2]) -> Vector<L> {
        let size = self.pixels.size();
        let [x, y] = self.mapping.wrap::<L>(place, size);
        let (values, first) = (self.pixels.values().as_flattened(), (y * L::u32(size.x) + x) * L::u32(3));
        let (second, third) = (first + L::u32(1), first + L::u32(2));
        Vector { x: L::gather(values, first), y: L::gather(values, second), z: L::gather(values, third) }
    }

    /// The factor for the pixels.
    #[inline(always)]
    fn scale<L: Lanes>(&self) -> Vector<L> {
        Vector::splat(self.scale.to_array().into())
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

    fn weight(&self, pixel: IVec2) -> f32 {
        let [x, y] = (pixel + 1).to_array().map(|k| One::u32(k as u32));
        self.peak::<One>(self.pixel([x, y]), y)
    }

    #[inline(always)]
    fn around<L: Lanes>(&self, cell: [L::U32; 2]) -> [L::F32; 4] {
        self.peaks::<L>(&Picture::around(self, cell), cell[1])
    }
}
