//! Sheen: a layer of fibres on a material, as on velvet, satin, dust or peach fuzz.

use std::f32::consts::PI;

use glam::{DVec3, Vec2};

use super::layer_stack::{Cover, NODES as PASSAGES, nodes};
use super::{Compound, LayerStack, Scatter, choose};
use crate::bsdf::description::{Description, MaterialRef, Prepare};
use crate::bsdf::microfacet::{LerpedTable, Scale, TableRange, upward_normal};
use crate::bsdf::table_cache::TableCache;
use crate::bsdf::{Bsdf, BsdfSample, DeltaLobes, HitContext, Lobe, Material, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Density, Local, SolidAnglePdf, Spectrum, float, warp};
use crate::texture::Texture;

/// A material under a layer of fibres, which is bright at grazing view.
///
/// f = color · s(wo, wi) + T f_base                                                                       [sr⁻¹]
///
/// with T by `LayerStack`, p(w) = 1 − max(color) E(w). White fibres lose no light over matte bases and mirrors. Coloured fibres block all
/// colours of the base as much as their largest coefficient does.
///
/// s = D(h) / (4 (μo + μi − μo μi)) / max(1, R(wo), R(wi)),    D(h) = (2 + 1/α) sin^(1/α) θh / 2π
///
/// R is the albedo of s without its last denominator, which exceeds 1 for narrow lobes at grazing angles. E is the albedo of s. α, the
/// spread of the fibres, is the square of the roughness that users set, limited to 0.01 to 1. Where a texture sets the roughness, s and
/// E are interpolated between those of 17 values of α, so that energy is conserved there too.
///
/// - on both sides of the surface; s is zero when the directions lie on opposite sides
/// - sampling: the fibres with the probability max(color) E(wo), uniformly over the hemisphere; otherwise the base
///
/// Source: Estevez and Kulla, *Production Friendly Microfacet Sheen* (2017); Neubelt and Pettineo for the denominator (2013).
/// Tests: sheen_reflects_its_tabulated_albedo, layers_on_white_are_white, compounds_are_proved.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheen {
    base: Material,
    color: Texture,
    roughness: Texture,
    tables: TableRange<Table>,
}

/// Tables of R and E at equal steps of √μ, for one α.
#[derive(Debug, PartialEq)]
struct Table {
    /// α, the spread of the fibres.
    alpha: f32,
    /// R at the nodes.
    raw: [f32; NODES],
    /// E at the nodes.
    albedo: [f32; NODES],
    /// Ē = 2 ∫₀¹ E μ dμ.
    mean: f32,
    /// E at the nodes of the quadrature over layers.
    at_nodes: [f32; PASSAGES],
}

/// The layer of fibres at a hit.
struct Fibres {
    color: Spectrum,
    tables: LerpedTable<Table>,
}

const NODES: usize = 33;

/// The smallest α. Narrower lobes would be visible only to rays along the surface.
pub const MIN_ALPHA: f32 = 0.01;

impl Sheen {
    /// A layer of fibres on a material.
    ///
    /// - `color`: of the fibres: [0, 1]
    /// - `roughness`: from 0 to 1, the root of α
    pub fn new(base: Material, color: impl Into<Texture>, roughness: impl Into<Texture>) -> Sheen {
        let roughness = roughness.into();
        let range = match roughness {
            Texture::Constant(roughness) => [alpha(roughness.average()); 2],
            _ => [MIN_ALPHA, 1.0],
        };
        Sheen { base, color: color.into(), roughness, tables: TableRange::new(range, Scale::Ratio, table) }
    }

    fn at(&self, at: &HitContext) -> (Fibres, Bsdf<'_>) {
        let tables = self.tables.at(alpha(self.roughness.scalar(&at.texture)));
        (Fibres { color: Spectrum::from_albedo(self.color.at(&at.texture)), tables }, at.bsdf_of(&self.base))
    }

    pub(super) fn recentred(self, origin: DVec3) -> Sheen {
        let (color, roughness) = (self.color.recentred(origin), self.roughness.recentred(origin));
        Sheen { base: self.base.recentred(origin), color, roughness, ..self }
    }
}

impl Fibres {
    /// color · s·|cos θi| [sr⁻¹].
    fn eval(&self, wo: Local, wi: Local) -> Spectrum {
        if wo.same_side(wi) { self.color * self.tables.value(|table| table.bounded(wo, wi)) } else { Spectrum::BLACK }
    }

    /// The probability of sampling the fibres: max(color) E(wo).
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
    /// s·|cos θi| for directions on one side.
    fn bounded(&self, wo: Local, wi: Local) -> f32 {
        raw(self.alpha, wo, wi) / lookup(&self.raw, wo).max(lookup(&self.raw, wi)).max(1.0)
    }
}

fn alpha(roughness: f32) -> f32 {
    (roughness * roughness).clamp(MIN_ALPHA, 1.0)
}

/// Returns the table of an α, which is computed once.
fn table(alpha: f32) -> &'static Table {
    static CACHE: TableCache<u32, Table> = TableCache::new();
    CACHE.get(alpha.to_bits(), || {
        let raw = std::array::from_fn(|node| returned(node, |wo, wi| raw(alpha, wo, wi)));
        let table = Table { alpha, raw, albedo: [0.0; NODES], mean: 0.0, at_nodes: [0.0; PASSAGES] };
        // The errors of interpolation and of the midpoint rule may leave E above 1, which would make p negative.
        let albedo = std::array::from_fn(|node| returned(node, |wo, wi| table.bounded(wo, wi)).min(1.0));
        Table { albedo, mean: mean(&albedo), at_nodes: nodes().map(|w| lookup(&albedo, w)), ..table }
    })
}

/// D(h)·|cos θi| / (4 (μo + μi − μo μi)) for directions on one side.
fn raw(alpha: f32, wo: Local, wi: Local) -> f32 {
    let Some((h, _)) = upward_normal(wo.0 + wi.0) else { return 0.0 };
    let (o, i) = (wo.abs_cos(), wi.abs_cos());
    let sine = h.0.truncate().length().min(1.0);
    let density = (2.0 + 1.0 / alpha) * float::powf(sine, 1.0 / alpha) / (2.0 * PI);
    // μi / (μo + μi − μo μi), at most 1, without a division of 0 by 0.
    density * 0.25 / (1.0 - o + o / i)
}

/// ∫ f dwi for wo at a node, by the midpoint rule in μ and φ.
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

/// 2 ∫₀¹ E μ dμ of the interpolated table.
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
    fn eval(&self, at: &HitContext, wo: Local, wi: Local, mode: TransportMode, above: Option<&LayerStack>) -> Spectrum {
        let (fibres, base) = self.at(at);
        let stack = LayerStack::new(&fibres, above, wo, wi);
        fibres.eval(wo, wi) * above.map_or(1.0, LayerStack::glossy) + base.beneath(Some(&stack), wo, wi, mode)
    }

    fn pdf(&self, at: &HitContext, wo: Local, wi: Local) -> SolidAnglePdf {
        let (fibres, base) = self.at(at);
        let chance = fibres.chance(wo);
        let fibres = if wo.same_side(wi) { 0.5 / PI } else { 0.0 };
        SolidAnglePdf::new(fibres * chance + base.pdf(wo, wi).get() * (1.0 - chance))
    }

    fn sample(&self, at: &HitContext, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let (fibres, base) = self.at(at);
        let chance = fibres.chance(wo);
        let (chosen, choice) = choose(choice, chance);
        if !chosen {
            let sample = base.sample(wo, choice, u, mode)?;
            return self.of_part(at, wo, sample, 1.0 - chance, |wi| Spectrum::gray(LayerStack::new(&fibres, None, wo, wi).glossy()), mode);
        }
        let wi = Local(warp::uniform_hemisphere(u) * 1f32.copysign(wo.cos()));
        let density = Density::Smooth(SolidAnglePdf::ZERO);
        let sample = BsdfSample { wi, weight: Spectrum::ONE, density, lobe: Lobe::Reflection, eta: 1.0 };
        self.of_part(at, wo, sample, chance, |_| Spectrum::ONE, mode)
    }

    fn delta_lobes(&self, at: &HitContext, wo: Local, mode: TransportMode) -> DeltaLobes {
        let (fibres, base) = self.at(at);
        let mut lobes = DeltaLobes::default();
        for lobe in base.delta_lobes(wo, mode) {
            lobes.add(lobe, Spectrum::gray(LayerStack::new(&fibres, None, wo, lobe.wi).glossy()));
        }
        lobes
    }

    fn has_smooth_lobe(&self, at: &HitContext) -> bool {
        let (fibres, base) = self.at(at);
        !fibres.color.is_black() || base.has_smooth_lobe()
    }

    fn reciprocal(&self, at: &HitContext) -> bool {
        at.bsdf_of(&self.base).reciprocal()
    }

    fn parts(&self) -> Vec<&Material> {
        vec![&self.base]
    }

    fn textures(&self) -> Vec<&Texture> {
        vec![&self.color, &self.roughness]
    }

    fn own_effects(&self) -> Effects {
        Effects::INTERREFLECTION
    }
}

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::bsdf::description::MaterialRef;
    use crate::format::Textured;

    /// A layer of fibres on a material, which is bright at grazing view: velvet, dust. White fibres lose no energy over matte bases and
    /// mirrors. They lose some over other materials with wide lobes: up to 13 % over white `oren_nayar` and metal of roughness 1, and up to
    /// 0.6 % over white plastic. Coloured fibres block all colours of the base as much as their largest coefficient does.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Sheen {
        /// The material under the fibres.
        #[serde(rename = "ground")]
        pub base: MaterialRef,
        /// The colour of the fibres.
        #[serde(default = "Textured::white")]
        pub color: Textured,
        /// The spread of the fibres: at 0.1 and below they stand upright, at 1 they lie in all directions. A colour counts by its mean.
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
        vec![("ground", &self.base)]
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let (color, roughness) = (builder.texture("color", &self.color), builder.texture("roughness", &self.roughness));
        Compound::Sheen(Sheen::new(builder.part("ground", &self.base), color, roughness)).into()
    }
}
