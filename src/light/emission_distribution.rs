//! Distribution of the light that a textured primitive emits.

use glam::{IVec2, UVec2, Vec2, Vec3};

use super::distribution::{Distribution, Weights, bilinear};
use super::emitter::Emitter;
use super::flat_share::{FlatShare, Part, THRESHOLD};
use crate::math::float::ONE_MINUS_EPSILON;
use crate::math::lanes::{Lanes, One};
use crate::math::{AreaPdf, SolidAnglePdf};
use crate::shape::{Shape, SurfacePoint};
use crate::texture::{Footprint, TextureContext};

/// Distribution of the light that a textured primitive emits.
///
/// Points are sampled in two parts ([`FlatShare`]). The flat part is sampled as the shape samples light of one radiance; the peaks by a
/// table of their radiance over the unit square of [`Shape::sample_area`], which is interpolated. A coarse table only costs noise, since
/// the flat part reaches every point.
///
/// Tests: emission_is_sampled_in_proportion_to_its_texture, given_rays_have_the_densities_of_emitted_rays.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EmissionDistribution {
    /// Mean radiance over the primitive and over the colour components [W·m⁻²·sr⁻¹].
    pub mean: f32,
    /// Share of the flat part in the light and in the samples.
    flat_share: FlatShare,
    /// Distribution of the peaks; `None` if there are none, or the shape knows no inverse of its sampling.
    peaks: Option<(Table, Distribution)>,
}

/// Greatest share of the flat part for which peaks are sampled by themselves. Beyond it they bring less than sampling them costs.
const MAX_FLAT_SHARE: f32 = 0.95;

/// Least number of entries along each side of a table.
const MIN_SIDE: u32 = 4;
/// Greatest number of entries along each side of a table.
const MAX_SIDE: u32 = 256;

impl EmissionDistribution {
    /// The distribution for a primitive.
    ///
    /// - `lookups`: number of texture lookups that it may take
    pub fn new(shape: &dyn Shape, primitive: u32, emitter: &Emitter, lookups: u32) -> EmissionDistribution {
        let side = lookups.isqrt().clamp(MIN_SIDE, MAX_SIDE);
        let mut table = Table::new(shape, primitive, emitter, side);
        let mean = table.mean();
        let mut flat = Table { side, weights: table.weights.clone() };
        for (flat, weight) in flat.weights.iter_mut().zip(&mut table.weights) {
            *flat = weight.min(THRESHOLD * mean);
            *weight -= *flat;
        }
        // Numbers below the normal ones are too coarse to divide: light that faint is sampled as light of one radiance.
        let flat_share = if mean.is_normal() { flat.mean() / mean } else { 1.0 };
        let has_inverse = || shape.area_coordinates(primitive, &shape.sample_area(primitive, Vec2::splat(0.5)).0).is_some();
        let pays = side > MIN_SIDE && flat_share < MAX_FLAT_SHARE && has_inverse();
        let peaks = if pays { Distribution::new(&table).map(|distribution| (table, distribution)) } else { None };
        EmissionDistribution { mean, flat_share: if peaks.is_some() { FlatShare::new(flat_share) } else { FlatShare::ALL }, peaks }
    }

    /// Samples a point that lights `from`, with its density by solid angle.
    #[inline(never)]
    pub fn sample_from(&self, shape: &dyn Shape, primitive: u32, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAnglePdf)> {
        if self.peaks.is_none() {
            return shape.sample_from(primitive, from, u);
        }
        let point = match self.flat_share.choose(u) {
            Part::Flat(u) => shape.sample_from(primitive, from, u)?.0,
            Part::Peaks(u) => shape.sample_area(primitive, self.sample_peaks(u)?).0,
        };
        let pdf = self.pdf_from(shape, primitive, from, &point);
        (pdf.get() > 0.0).then_some((point, pdf))
    }

    /// Density by solid angle of a point for the point `from`.
    #[inline(never)]
    pub fn pdf_from(&self, shape: &dyn Shape, primitive: u32, from: Vec3, point: &SurfacePoint) -> SolidAnglePdf {
        let flat = shape.pdf_from(primitive, from, point);
        let Some(peak) = self.peak_density(shape, primitive, point) else { return flat };
        let by_area = AreaPdf::new(shape.area_pdf(primitive, point).get() * peak);
        let by_angle = by_area.to_solid_angle((point.p - from).as_dvec3(), point.ng.as_dvec3()).map_or(0.0, SolidAnglePdf::get);
        SolidAnglePdf::new(self.flat_share.density(flat.get(), by_angle))
    }

    /// Samples a point, with its density by area.
    pub fn sample_area(&self, shape: &dyn Shape, primitive: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        let u = match self.flat_share.choose(u) {
            Part::Flat(u) => u,
            Part::Peaks(u) => self.sample_peaks(u).unwrap_or(u),
        };
        let (point, _) = shape.sample_area(primitive, u);
        (point, self.area_pdf(shape, primitive, &point))
    }

    /// Density by area of a point.
    pub fn area_pdf(&self, shape: &dyn Shape, primitive: u32, point: &SurfacePoint) -> AreaPdf {
        let flat = shape.area_pdf(primitive, point);
        let Some(peak) = self.peak_density(shape, primitive, point) else { return flat };
        AreaPdf::new(flat.get() * self.flat_share.density(1.0, peak))
    }

    /// A sample of the unit square in proportion to the peaks; `None` if all light is flat.
    fn sample_peaks(&self, u: Vec2) -> Option<Vec2> {
        let (table, distribution) = self.peaks.as_ref()?;
        Some(distribution.sample(table, u))
    }

    /// Density of the peaks at a point by the area of the unit square; `None` if all light is flat.
    fn peak_density(&self, shape: &dyn Shape, primitive: u32, point: &SurfacePoint) -> Option<f32> {
        let (table, distribution) = self.peaks.as_ref()?;
        let u = shape.area_coordinates(primitive, point)?;
        Some(distribution.density(table.at(u)))
    }
}

/// Radiance over the unit square of [`Shape::sample_area`], interpolated between the centres of square cells.
#[derive(Clone, Debug, PartialEq)]
struct Table {
    /// Number of cells along each side.
    side: u32,
    /// Mean of the colour components in each cell, times the area of the primitive that a unit of the square stands for.
    weights: Vec<f32>,
}

impl Table {
    /// Looks the emission up in each cell, averaged over the cell where the texture can be.
    fn new(shape: &dyn Shape, primitive: u32, emitter: &Emitter, side: u32) -> Table {
        let area = shape.area(primitive);
        // Both coordinates stay below 1.
        let sample = |x: f32, y: f32| {
            let u = Vec2::new(x, y) / side as f32;
            shape.sample_area(primitive, u.min(Vec2::splat(ONE_MINUS_EPSILON)))
        };
        // Middles of the edges between the cells. Neighbours share them, since finding a point of a curved shape costs more than looking up a
        // plain texture.
        let edges = |count: u32, at: &dyn Fn(f32) -> (SurfacePoint, AreaPdf)| (0..count).map(|k| at(k as f32).0.p).collect::<Vec<Vec3>>();
        let across = |y: f32| edges(side, &|x| sample(x + 0.5, y));
        let (mut weights, mut above) = (Vec::with_capacity((side * side) as usize), across(0.0));
        for y in (0..side).map(|y| y as f32) {
            let (below, beside) = (across(y + 1.0), edges(side + 1, &|x| sample(x, y + 0.5)));
            for x in 0..side as usize {
                let (point, pdf) = sample(x as f32 + 0.5, y + 0.5);
                let sides = [beside[x + 1] - beside[x], below[x] - above[x]];
                let footprint = Some(Footprint::new(sides, shape.tangents(primitive, &point, 0.0)));
                let at = TextureContext { footprint, ..TextureContext::exact(&point) };
                weights.push(emitter.at(&at).radiance.average() / (pdf.get() * area));
            }
            above = below;
        }
        Table { side, weights }
    }

    fn mean(&self) -> f32 {
        (self.weights.iter().map(|&weight| f64::from(weight)).sum::<f64>() / self.weights.len() as f64) as f32
    }

    /// The interpolated weight at a point of the unit square.
    fn at(&self, u: Vec2) -> f32 {
        let place = u * self.side as f32 - 0.5;
        let first = place.floor();
        let cell = (first + 1.0).as_uvec2().to_array().map(One::u32);
        bilinear::<One>(self.around::<One>(cell), (place - first).to_array())
    }
}

impl Weights for Table {
    fn size(&self) -> UVec2 {
        UVec2::splat(self.side)
    }

    /// Beyond the borders, the weight of the nearest cell.
    fn weight(&self, cell: IVec2) -> f32 {
        let last = IVec2::splat(self.side as i32 - 1);
        let cell = cell.clamp(IVec2::ZERO, last).as_uvec2();
        self.weights[(cell.y * self.side + cell.x) as usize]
    }

    #[inline(always)]
    fn around<L: Lanes>(&self, cell: [L::U32; 2]) -> [L::F32; 4] {
        let (left, right) = neighbours::<L>(cell[0], self.side);
        let (above, below) = neighbours::<L>(cell[1], self.side);
        let (above, below) = (above * L::u32(self.side), below * L::u32(self.side));
        let weights = &self.weights;
        [
            L::gather(weights, above + left),
            L::gather(weights, above + right),
            L::gather(weights, below + left),
            L::gather(weights, below + right),
        ]
    }
}

/// Pixels before and after cells along an axis of `side` pixels; at the borders, both are the nearest one.
#[inline(always)]
fn neighbours<L: Lanes>(cell: L::U32, side: u32) -> (L::U32, L::U32) {
    let before = cell - L::u32(1);
    (L::select_u32(L::eq_u32(cell, L::u32(0)), cell, before), L::select_u32(L::eq_u32(cell, L::u32(side)), before, cell))
}
