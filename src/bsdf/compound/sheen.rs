//! Velvet, satin, dust, peach fuzz: fibres that stand up from a material.

use std::f32::consts::PI;

use glam::{DVec3, Vec2};

use super::{Place, Scatter, choose};
use crate::bsdf::microfacet::upward_normal;
use crate::bsdf::{Bsdf, BsdfSample, DeltaLobes, Lobe, Material, TransportMode};
use crate::effects::Effects;
use crate::math::{Density, Local, SolidAnglePdf, Spectrum, float, warp};
use crate::texture::Texture;

/// A layer of fibres, bright where one looks along the surface, over any material.
///
/// f = color · s(wo, wi) + (1 − max(color) max(E(wo), E(wi))) f_ground                                      [sr⁻¹]
///
/// s = D(h) / (4 (μo + μi − μo μi)) / max(1, R(wo), R(wi)),    D(h) = (2 + 1/α) sin^(1/α) θh / 2π
///
/// with R the share that D alone would return: above 1 for narrow lobes along the surface, and s takes that back. E is the
/// share that s returns.
///
/// - `alpha`: how far the fibres spread, from 0.01 to 1; what users set is its root
/// - on both sides of the surface; s is zero when the directions lie on opposite sides
/// - sampling: fibres by what they return of wo, evenly over the hemisphere, else the ground
///
/// Source: Estevez and Kulla, *Production Friendly Microfacet Sheen* (2017); Neubelt and Pettineo for the denominator (2013).
/// Tests: sheen_returns_what_it_says, compounds_are_proved.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheen {
    ground: Material,
    color: Texture,
    alpha: f32,
    table: Box<Table>,
}

/// R and E over √μ.
#[derive(Clone, Debug, PartialEq)]
struct Table {
    raw: [f32; NODES],
    albedo: [f32; NODES],
}

const NODES: usize = 33;

/// The least alpha: narrower lobes are seen by none but rays along the surface.
pub const MIN_ALPHA: f32 = 0.01;

impl Sheen {
    pub fn new(ground: Material, color: impl Into<Texture>, alpha: f32) -> Sheen {
        let alpha = alpha.clamp(MIN_ALPHA, 1.0);
        let mut table = Box::new(Table { raw: [0.0; NODES], albedo: [0.0; NODES] });
        table.raw = std::array::from_fn(|node| returned(node, |wo, wi| raw(alpha, wo, wi)));
        let raws = table.raw;
        // What R between its nodes and the midpoint rule leave above 1 would be light taken from the ground that is not there.
        table.albedo = std::array::from_fn(|node| returned(node, |wo, wi| tamed(alpha, &raws, wo, wi)).min(1.0));
        Sheen { ground, color: color.into(), alpha, table }
    }

    /// s·|cos θi|, white.
    fn fibres(&self, wo: Local, wi: Local) -> f32 {
        if wo.same_side(wi) { tamed(self.alpha, &self.table.raw, wo, wi) } else { 0.0 }
    }

    /// 1 − max(color) max(E(wo), E(wi))
    fn through(&self, color: Spectrum, wo: Local, wi: Local) -> f32 {
        1.0 - color.max() * lookup(&self.table.albedo, wo).max(lookup(&self.table.albedo, wi))
    }

    /// Of the fibres to be sampled.
    fn chance(&self, color: Spectrum, wo: Local) -> f32 {
        color.max() * lookup(&self.table.albedo, wo)
    }

    fn at(&self, at: &Place) -> (Spectrum, Bsdf<'_>) {
        (self.color.at(&at.point), at.met(&self.ground))
    }

    pub(super) fn recentred(self, origin: DVec3) -> Sheen {
        Sheen { ground: self.ground.recentred(origin), color: self.color.recentred(origin), ..self }
    }
}

/// D(h)·|cos θi| / (4 (μo + μi − μo μi)), of directions on one side.
fn raw(alpha: f32, wo: Local, wi: Local) -> f32 {
    let Some((h, _)) = upward_normal(wo.0 + wi.0) else { return 0.0 };
    let (o, i) = (wo.abs_cos(), wi.abs_cos());
    let sine = h.0.truncate().length().min(1.0);
    let density = (2.0 + 1.0 / alpha) * float::powf(sine, 1.0 / alpha) / (2.0 * PI);
    // μi / (μo + μi − μo μi) ≤ 1, without a division of 0 by 0.
    density * 0.25 / (1.0 - o + o / i)
}

fn tamed(alpha: f32, raws: &[f32; NODES], wo: Local, wi: Local) -> f32 {
    raw(alpha, wo, wi) / lookup(raws, wo).max(lookup(raws, wi)).max(1.0)
}

/// ∫ f dwi for the direction of a node, by the midpoint rule in μ and φ.
fn returned(node: usize, f: impl Fn(Local, Local) -> f32) -> f32 {
    const STEPS: [usize; 2] = [128, 64];
    let root = node as f32 / (NODES - 1) as f32;
    let wo = direction((root * root).max(1e-6), 0.0);
    let at = |k: usize, n: usize| (k as f32 + 0.5) / n as f32;
    let row =
        |i: usize| (0..STEPS[1]).map(|j| f64::from(f(wo, direction(at(i, STEPS[0]), 180.0 * f64::from(at(j, STEPS[1])))))).sum::<f64>();
    let sum: f64 = (0..STEPS[0]).map(row).sum();
    (sum * 2.0 * std::f64::consts::PI / (STEPS[0] * STEPS[1]) as f64) as f32
}

fn direction(cos: f32, degrees: f64) -> Local {
    let (sin_phi, cos_phi) = float::sin_cos_degrees(degrees);
    let sine = ((1.0 - cos) * (1.0 + cos)).sqrt();
    Local::new(sine * cos_phi as f32, sine * sin_phi as f32, cos)
}

fn lookup(table: &[f32; NODES], w: Local) -> f32 {
    let x = w.abs_cos().min(1.0).sqrt() * (NODES - 1) as f32;
    let k = (x as usize).min(NODES - 2);
    table[k] + (table[k + 1] - table[k]) * (x - k as f32)
}

impl Scatter for Sheen {
    fn eval(&self, at: &Place, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        let (color, ground) = self.at(at);
        color * self.fibres(wo, wi) + ground.eval(wo, wi, mode) * self.through(color, wo, wi)
    }

    fn pdf(&self, at: &Place, wo: Local, wi: Local) -> SolidAnglePdf {
        let (color, ground) = self.at(at);
        let chance = self.chance(color, wo);
        let fibres = if wo.same_side(wi) { 0.5 / PI } else { 0.0 };
        SolidAnglePdf::new(fibres * chance + ground.pdf(wo, wi).get() * (1.0 - chance))
    }

    fn sample(&self, at: &Place, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let (color, ground) = self.at(at);
        let chance = self.chance(color, wo);
        let (fibres, choice) = choose(choice, chance);
        if !fibres {
            let sample = ground.sample(wo, choice, u, mode)?;
            return self.of_part(at, wo, sample, 1.0 - chance, |wi| Spectrum::gray(self.through(color, wo, wi)), mode);
        }
        let wi = Local(warp::uniform_hemisphere(u) * 1f32.copysign(wo.cos()));
        let density = Density::Smooth(SolidAnglePdf::ZERO);
        let sample = BsdfSample { wi, weight: Spectrum::ONE, density, lobe: Lobe::Reflection, eta: 1.0 };
        self.of_part(at, wo, sample, chance, |_| Spectrum::ONE, mode)
    }

    fn delta_lobes(&self, at: &Place, wo: Local, mode: TransportMode) -> DeltaLobes {
        let (color, ground) = self.at(at);
        let mut lobes = DeltaLobes::default();
        for lobe in ground.delta_lobes(wo, mode) {
            lobes.add(lobe, Spectrum::gray(self.through(color, wo, lobe.wi)));
        }
        lobes
    }

    fn has_smooth_lobe(&self, at: &Place) -> bool {
        let (color, ground) = self.at(at);
        !color.is_black() || ground.has_smooth_lobe()
    }

    fn reciprocal(&self, at: &Place) -> bool {
        at.met(&self.ground).reciprocal()
    }

    fn parts(&self) -> Vec<&Material> {
        vec![&self.ground]
    }

    fn textures(&self) -> Vec<&Texture> {
        vec![&self.color]
    }

    fn own_effects(&self) -> Effects {
        Effects::INTERREFLECTION
    }
}
