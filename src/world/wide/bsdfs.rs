//! Scattering by the surfaces of several lanes.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3};

use super::{SurfaceLanes, WideWorld, on_one_side};
use crate::bsdf::{Bsdf, BsdfSample, TransportMode};
use crate::math::lanes::{Lanes, MAX_COUNT, Vector, each_lane};
use crate::math::{Density, Local, warp};

/// Sampled directions, one in each lane.
pub struct ScatteredLanes<L: Lanes> {
    /// Which lanes have one.
    pub found: L::Mask,
    /// Unit directions in world space.
    pub wi: Vector<L>,
    /// Weights f · |cos θi| / pdf.
    pub weight: Vector<L>,
    /// Densities [sr⁻¹]; negative for delta lobes.
    pub pdf: L::F32,
    /// Relative indices of refraction, see [`BsdfSample::eta`].
    pub eta: L::F32,
}

/// Samples of lanes that have no vector code.
struct Samples {
    found: u32,
    wi: [[f32; MAX_COUNT]; 3],
    weight: [[f32; MAX_COUNT]; 3],
    pdf: [f32; MAX_COUNT],
    eta: [f32; MAX_COUNT],
}

impl<'a> WideWorld<'a> {
    /// Scattering model of a lane.
    #[inline(always)]
    fn bsdf<'s, L: Lanes>(&'s self, surface: &'s SurfaceLanes<'_, L>, lane: usize) -> Option<&'s Bsdf<'s>> {
        if surface.modelled >> lane & 1 == 1 {
            let place = (surface.modelled & ((1 << lane) - 1)).count_ones();
            return surface.models.get(place as usize);
        }
        self.world.materials[surface.materials[lane] as usize].uniform.as_ref()
    }

    /// Lanes whose material has more than delta lobes.
    #[inline(always)]
    pub fn has_smooth_lobe<L: Lanes>(&self, surface: &SurfaceLanes<'_, L>) -> L::Mask {
        let mut delta = 0;
        for lane in each_lane(L::bits(surface.found & !surface.is_diffuse)) {
            let is_smooth = self.bsdf(surface, lane).is_some_and(|bsdf| bsdf.has_smooth_lobe());
            delta |= u32::from(!is_smooth) << lane;
        }
        surface.found & !L::mask(delta)
    }

    /// f(wo, wi)·|cos θi| [sr⁻¹] and the density with which [`WideWorld::scatter`] samples `wi`, as
    /// [`Surface::eval`](crate::scene::Surface::eval) and [`Surface::pdf`](crate::scene::Surface::pdf).
    #[inline(always)]
    pub fn eval<L: Lanes>(&self, surface: &SurfaceLanes<'_, L>, wo: Vector<L>, wi: Vector<L>, active: L::Mask) -> (Vector<L>, L::F32) {
        let (lo, li) = (surface.to_local(wo), surface.to_local(wi));
        let (black, zero) = (Vector::splat(Vec3::ZERO), L::f32(0.0));
        let reflects = on_one_side::<L>(lo.z, li.z);
        let cosine = L::f32(FRAC_1_PI) * L::abs(li.z);
        let mut f = Vector::select(reflects, surface.albedo.scaled(cosine), black);
        let mut pdf = L::select(reflects, cosine, zero);
        let others = L::bits(active & !surface.is_diffuse);
        if others != 0 {
            let (mut values, mut pdfs) = (f.to_arrays(), [0.0; MAX_COUNT]);
            L::store(pdf, &mut pdfs);
            for lane in each_lane(others) {
                let Some(bsdf) = self.bsdf(surface, lane) else { continue };
                let (value, density) = eval(bsdf, Local(lo.get(lane)), Local(li.get(lane)));
                (0..3).for_each(|axis| values[axis][lane] = value[axis]);
                pdfs[lane] = density;
            }
            (f, pdf) = (Vector::from_arrays(&values), L::load(&pdfs));
        }
        (Vector::select(surface.normals_agree(wo, lo.z, wi, li.z), f, black), pdf)
    }

    /// Samples a direction in each lane, as [`Surface::sample`](crate::scene::Surface::sample).
    #[inline(always)]
    pub fn scatter<L: Lanes>(
        &self,
        surface: &SurfaceLanes<'_, L>,
        wo: Vector<L>,
        [choice, u, v]: [L::F32; 3],
        active: L::Mask,
    ) -> ScatteredLanes<L> {
        let lo = surface.to_local(wo);
        let zero = L::f32(0.0);
        let up = warp::cosine_hemisphere_lanes::<L>([u, v]);
        let mut pdf = L::f32(FRAC_1_PI) * L::max(up.z, zero);
        let mut local = Vector { z: L::copysign(up.z, lo.z), ..up };
        let mut weight = surface.albedo;
        let is_along = L::le(L::abs(lo.z), zero);
        let mut found = active & !is_along & !weight.is_black() & L::lt(zero, pdf);
        let mut eta = L::f32(1.0);
        let others = L::bits(active & !surface.is_diffuse);
        if others != 0 {
            let mut samples = Samples {
                found: L::bits(found) & !others,
                wi: local.to_arrays(),
                weight: weight.to_arrays(),
                pdf: [0.0; MAX_COUNT],
                eta: [1.0; MAX_COUNT],
            };
            L::store(pdf, &mut samples.pdf);
            let mut numbers = [[0.0; MAX_COUNT]; 3];
            L::store(choice, &mut numbers[0]);
            L::store(u, &mut numbers[1]);
            L::store(v, &mut numbers[2]);
            for lane in each_lane(others) {
                let Some(bsdf) = self.bsdf(surface, lane) else { continue };
                let numbers = [numbers[0][lane], numbers[1][lane], numbers[2][lane]];
                if let Some(sample) = sample(bsdf, Local(lo.get(lane)), numbers) {
                    samples.set(lane, &sample);
                }
            }
            found = L::mask(samples.found);
            (local, weight) = (Vector::from_arrays(&samples.wi), Vector::from_arrays(&samples.weight));
            (pdf, eta) = (L::load(&samples.pdf), L::load(&samples.eta));
        }
        let [x, y] = surface.tangents;
        let w = x.scaled(local.x) + y.scaled(local.y) + surface.ns.scaled(local.z);
        // One Newton step for 1/√x, see `Surface::sample`.
        let wi = w.scaled(L::f32(1.5) - L::f32(0.5) * w.length_squared());
        let found = found & surface.normals_agree(wo, lo.z, wi, local.z);
        ScatteredLanes { found, wi, weight, pdf, eta }
    }
}

impl Samples {
    #[inline(always)]
    fn set(&mut self, lane: usize, sample: &BsdfSample) {
        let (wi, weight) = (sample.wi.0.to_array(), sample.weight.coefficients());
        (self.wi[0][lane], self.wi[1][lane], self.wi[2][lane]) = (wi[0], wi[1], wi[2]);
        (self.weight[0][lane], self.weight[1][lane], self.weight[2][lane]) = (weight[0], weight[1], weight[2]);
        self.pdf[lane] = match sample.density {
            Density::Smooth(pdf) => pdf.get(),
            Density::Delta => -1.0,
        };
        self.eta[lane] = sample.eta;
        self.found |= 1 << lane;
    }
}

#[inline(never)]
fn eval(bsdf: &Bsdf, lo: Local, li: Local) -> ([f32; 3], f32) {
    (bsdf.eval(lo, li, TransportMode::Radiance).coefficients(), bsdf.pdf(lo, li).get())
}

#[inline(never)]
fn sample(bsdf: &Bsdf, lo: Local, [choice, u, v]: [f32; 3]) -> Option<BsdfSample> {
    bsdf.sample(lo, choice, Vec2::new(u, v), TransportMode::Radiance)
}
