//! Velvet, satin, dust, peach fuzz: fibres that stand up from a material.

use std::f32::consts::PI;

use glam::{DVec3, Vec2};

use super::veil::{Cover, NODES as PASSAGES, nodes};
use super::{Compound, Scatter, Veil, choose};
use crate::bsdf::description::{Description, MaterialRef, Prepare};
use crate::bsdf::microfacet::energy_loss::Cache;
use crate::bsdf::microfacet::{LerpedTable, Scale, TableRange, upward_normal};
use crate::bsdf::{Bsdf, BsdfSample, DeltaLobes, HitContext, Lobe, Material, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Density, Local, SolidAnglePdf, Spectrum, float, warp};
use crate::texture::Texture;

/// A layer of fibres, bright where one looks along the surface, over any material.
///
/// f = color · s(wo, wi) + T f_ground                                                                       [sr⁻¹]
///
/// with T by `Veil`, p(w) = 1 − max(color) E(w). White fibres lose nothing over matte grounds and mirrors; coloured ones keep
/// light of all colours from the ground as their brightest one does.
///
/// s = D(h) / (4 (μo + μi − μo μi)) / max(1, R(wo), R(wi)),    D(h) = (2 + 1/α) sin^(1/α) θh / 2π
///
/// with R the share that D alone would return: above 1 for narrow lobes along the surface, and s takes that back. E is the
/// share that s returns. α is the square of the roughness that users set: how far the fibres spread, from 0.01 to 1. Where a
/// texture sets it s is interpolated between the fibres of 17 α, each as above: so are R and E, and no light is made.
///
/// - on both sides of the surface; s is zero when the directions lie on opposite sides
/// - sampling: fibres by what they return of wo, evenly over the hemisphere, else the ground
///
/// Source: Estevez and Kulla, *Production Friendly Microfacet Sheen* (2017); Neubelt and Pettineo for the denominator (2013).
/// Tests: sheen_returns_what_it_says, layers_on_white_are_white, compounds_are_proved.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheen {
    ground: Material,
    color: Texture,
    roughness: Texture,
    tables: TableRange<Table>,
}

/// R and E over √μ.
#[derive(Debug, PartialEq)]
struct Table {
    alpha: f32,
    raw: [f32; NODES],
    albedo: [f32; NODES],
    /// 2 ∫₀¹ E μ dμ
    mean: f32,
    /// E at the nodes of means over layers.
    at_nodes: [f32; PASSAGES],
}

/// The fibres at a point.
struct Fibres {
    color: Spectrum,
    tables: LerpedTable<Table>,
}

const NODES: usize = 33;

/// The least alpha: narrower lobes are seen by none but rays along the surface.
pub const MIN_ALPHA: f32 = 0.01;

impl Sheen {
    /// - `roughness`: from 0 to 1
    pub fn new(ground: Material, color: impl Into<Texture>, roughness: impl Into<Texture>) -> Sheen {
        let roughness = roughness.into();
        let range = match roughness {
            Texture::Constant(roughness) => [alpha(roughness.average()); 2],
            _ => [MIN_ALPHA, 1.0],
        };
        Sheen { ground, color: color.into(), roughness, tables: TableRange::new(range, Scale::Ratio, table) }
    }

    fn at(&self, at: &HitContext) -> (Fibres, Bsdf<'_>) {
        let tables = self.tables.at(alpha(self.roughness.scalar(&at.point)));
        (Fibres { color: Spectrum::from_albedo(self.color.at(&at.point)), tables }, at.bsdf_of(&self.ground))
    }

    pub(super) fn recentred(self, origin: DVec3) -> Sheen {
        let (color, roughness) = (self.color.recentred(origin), self.roughness.recentred(origin));
        Sheen { ground: self.ground.recentred(origin), color, roughness, ..self }
    }
}

impl Fibres {
    /// color · s·|cos θi|
    fn eval(&self, wo: Local, wi: Local) -> Spectrum {
        if wo.same_side(wi) { self.color * self.tables.value(|table| table.tamed(wo, wi)) } else { Spectrum::BLACK }
    }

    /// Of the fibres to be sampled: max(color) E(wo).
    fn chance(&self, wo: Local) -> f32 {
        self.color.max() * self.tables.value(|table| lookup(&table.albedo, wo))
    }
}

impl Cover for Fibres {
    fn passed(&self, w: Local) -> f32 {
        1.0 - self.chance(w)
    }

    fn mean(&self) -> f32 {
        1.0 - self.color.max() * self.tables.value(|table| table.mean)
    }

    fn passed_at_nodes(&self) -> [f32; PASSAGES] {
        std::array::from_fn(|k| 1.0 - self.color.max() * self.tables.value(|table| table.at_nodes[k]))
    }
}

impl Table {
    /// s·|cos θi|, of directions on one side.
    fn tamed(&self, wo: Local, wi: Local) -> f32 {
        raw(self.alpha, wo, wi) / lookup(&self.raw, wo).max(lookup(&self.raw, wi)).max(1.0)
    }
}

fn alpha(roughness: f32) -> f32 {
    (roughness * roughness).clamp(MIN_ALPHA, 1.0)
}

/// Made once for each α.
fn table(alpha: f32) -> &'static Table {
    static CACHE: Cache<u32, Table> = Cache::new();
    CACHE.get(alpha.to_bits(), || {
        let raw = std::array::from_fn(|node| returned(node, |wo, wi| raw(alpha, wo, wi)));
        let table = Table { alpha, raw, albedo: [0.0; NODES], mean: 0.0, at_nodes: [0.0; PASSAGES] };
        // What R between its nodes and the midpoint rule leave above 1 would be light taken from the ground that is not there.
        let albedo = std::array::from_fn(|node| returned(node, |wo, wi| table.tamed(wo, wi)).min(1.0));
        Table { albedo, mean: mean(&albedo), at_nodes: nodes().map(|w| lookup(&albedo, w)), ..table }
    })
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

/// 2 ∫₀¹ E μ dμ of a table as it is looked up.
fn mean(albedo: &[f32; NODES]) -> f32 {
    const STEPS: usize = 1024;
    let at = |k: usize| ((k as f32 + 0.5) / STEPS as f32).sqrt();
    ((0..STEPS).map(|k| f64::from(lookup(albedo, direction(at(k), 0.0)))).sum::<f64>() / STEPS as f64) as f32
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
    fn eval(&self, at: &HitContext, wo: Local, wi: Local, mode: TransportMode, above: Option<&Veil>) -> Spectrum {
        let (fibres, ground) = self.at(at);
        let veil = Veil::new(&fibres, above, wo, wi);
        fibres.eval(wo, wi) * above.map_or(1.0, Veil::glossy) + ground.beneath(Some(&veil), wo, wi, mode)
    }

    fn pdf(&self, at: &HitContext, wo: Local, wi: Local) -> SolidAnglePdf {
        let (fibres, ground) = self.at(at);
        let chance = fibres.chance(wo);
        let fibres = if wo.same_side(wi) { 0.5 / PI } else { 0.0 };
        SolidAnglePdf::new(fibres * chance + ground.pdf(wo, wi).get() * (1.0 - chance))
    }

    fn sample(&self, at: &HitContext, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let (fibres, ground) = self.at(at);
        let chance = fibres.chance(wo);
        let (chosen, choice) = choose(choice, chance);
        if !chosen {
            let sample = ground.sample(wo, choice, u, mode)?;
            return self.of_part(at, wo, sample, 1.0 - chance, |wi| Spectrum::gray(Veil::new(&fibres, None, wo, wi).glossy()), mode);
        }
        let wi = Local(warp::uniform_hemisphere(u) * 1f32.copysign(wo.cos()));
        let density = Density::Smooth(SolidAnglePdf::ZERO);
        let sample = BsdfSample { wi, weight: Spectrum::ONE, density, lobe: Lobe::Reflection, eta: 1.0 };
        self.of_part(at, wo, sample, chance, |_| Spectrum::ONE, mode)
    }

    fn delta_lobes(&self, at: &HitContext, wo: Local, mode: TransportMode) -> DeltaLobes {
        let (fibres, ground) = self.at(at);
        let mut lobes = DeltaLobes::default();
        for lobe in ground.delta_lobes(wo, mode) {
            lobes.add(lobe, Spectrum::gray(Veil::new(&fibres, None, wo, lobe.wi).glossy()));
        }
        lobes
    }

    fn has_smooth_lobe(&self, at: &HitContext) -> bool {
        let (fibres, ground) = self.at(at);
        !fibres.color.is_black() || ground.has_smooth_lobe()
    }

    fn reciprocal(&self, at: &HitContext) -> bool {
        at.bsdf_of(&self.ground).reciprocal()
    }

    fn parts(&self) -> Vec<&Material> {
        vec![&self.ground]
    }

    fn textures(&self) -> Vec<&Texture> {
        vec![&self.color, &self.roughness]
    }

    fn own_effects(&self) -> Effects {
        Effects::INTERREFLECTION
    }
}

/// As a scene file says it.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::description::MaterialRef;
    use crate::format::Textured;

    /// Fibres that stand up from a material and catch the light where one looks along it: velvet, dust. White ones lose no energy over
    /// matte grounds and mirrors. Others that scatter widely lose some under them: white `oren_nayar` and metal of roughness 1 up to
    /// 13 %, white plastic up to 0.6 %. Coloured fibres keep light of all colours from the ground as their brightest one does.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Sheen {
        /// What the fibres stand on.
        pub ground: MaterialRef,
        /// Of the fibres.
        #[serde(default = "Textured::white")]
        pub color: Textured,
        /// 0.1 (and below) are fibres that stand straight, 1 lie all ways. (Of a colour, the mean.)
        #[serde(default = "half")]
        pub roughness: Textured,
    }

    fn half() -> Textured {
        Textured::gray(0.5)
    }
}

impl Description for described::Sheen {
    fn textures(&self) -> Vec<(String, &Textured)> {
        vec![("color".into(), &self.color), ("roughness".into(), &self.roughness)]
    }

    fn parts(&self) -> Vec<(&'static str, &MaterialRef)> {
        vec![("ground", &self.ground)]
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let (color, roughness) = (builder.texture("color", &self.color), builder.texture("roughness", &self.roughness));
        Compound::Sheen(Sheen::new(builder.part("ground", &self.ground), color, roughness)).into()
    }
}
