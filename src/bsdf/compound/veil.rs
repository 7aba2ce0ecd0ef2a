//! What layers let pass of the light that lies under them.

use std::cell::OnceCell;

use crate::bsdf::{Bsdf, Plastic, TransportMode};
use crate::math::{Local, Spectrum, float};

/// A layer without thickness: what it does not reflect of light from a direction goes through.
pub(super) trait Cover {
    /// The share p(w) that goes through.
    fn passed(&self, w: Local) -> f32;

    /// p̄ = 2 ∫₀¹ p μ dμ: what goes through of light from everywhere.
    fn mean(&self) -> f32;

    /// p at the [`nodes`].
    fn passed_at_nodes(&self) -> [f32; NODES] {
        nodes().map(|w| self.passed(w))
    }
}

/// The layers above a material, for two directions.
///
/// Light that goes through all of them, is scattered by a ground f and goes through them again is T f, with
///
/// T = Π pₖ(wo) pₖ(wi) / m,    m = 2 ∫₀¹ Π pₖ(μ) μ dμ        for a matte ground,
///
/// T = Π min(pₖ(wo), pₖ(wi))                                  for all others
///
/// Both go back the way they came. The first loses nothing: over a white ground ∫ T |cos θi|/π dwi = Π pₖ(wo). The second is
/// at most that, whatever the ground, and is all of it over a mirror; over a ground that scatters widely it loses what goes
/// through one way and not the other.
pub(super) struct Veil<'a> {
    lowest: &'a dyn Cover,
    above: Option<&'a Veil<'a>>,
    ways: [Local; 2],
    /// p of the lowest for both ways, once it is asked for.
    passed: OnceCell<[f32; 2]>,
}

impl<'a> Veil<'a> {
    pub fn new(lowest: &'a dyn Cover, above: Option<&'a Veil<'a>>, wo: Local, wi: Local) -> Veil<'a> {
        Veil { lowest, above, ways: [wo, wi], passed: OnceCell::new() }
    }

    /// T of what is not matte.
    pub fn glossy(&self) -> f32 {
        self.layers().map(|veil| veil.passed()).map(|[o, i]| o.min(i)).product()
    }

    /// T of a ground.
    fn over(&self, ground: &Bsdf) -> f32 {
        match ground {
            Bsdf::Diffuse(_) | Bsdf::DiffuseTransmission(_) => self.matte(),
            Bsdf::Plastic(plastic) => self.within(plastic),
            _ => self.glossy(),
        }
    }

    /// T of a matte ground.
    fn matte(&self) -> f32 {
        let mean = self.mean();
        if mean > 0.0 { self.both_ways() / mean } else { 0.0 }
    }

    /// T of the ground of a plastic, whose own coat is in its f already.
    fn within(&self, plastic: &Plastic) -> f32 {
        let mean = Veil::new(plastic, Some(self), self.ways[0], self.ways[1]).mean();
        if mean > 0.0 { self.both_ways() * plastic.mean() / mean } else { 0.0 }
    }

    /// Π pₖ(wo) pₖ(wi)
    fn both_ways(&self) -> f32 {
        self.layers().map(|veil| veil.passed()).map(|[o, i]| o * i).product()
    }

    fn passed(&self) -> [f32; 2] {
        *self.passed.get_or_init(|| self.ways.map(|w| self.lowest.passed(w)))
    }

    /// m: of a single layer known, of several the product of their means, corrected by how alike they are at the nodes.
    fn mean(&self) -> f32 {
        if self.above.is_none() {
            return self.lowest.mean();
        }
        let (mut means, mut all) = (1.0, [1.0; NODES]);
        for veil in self.layers() {
            let passed = veil.lowest.passed_at_nodes();
            means *= veil.lowest.mean() / average(&passed);
            all.iter_mut().zip(passed).for_each(|(all, passed)| *all *= passed);
        }
        means * average(&all)
    }

    /// From the lowest upwards.
    fn layers(&self) -> impl Iterator<Item = &Veil<'a>> {
        std::iter::successors(Some(self), |veil| veil.above)
    }
}

impl Bsdf<'_> {
    /// f(wo, wi)·|cos θi| of the light that passes the layers above, both ways.
    pub(super) fn beneath(&self, above: Option<&Veil>, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        if let Bsdf::Compound(at) = self {
            return at.beneath(above, wo, wi, mode);
        }
        let f = self.eval(wo, wi, mode);
        if f.is_black() { f } else { f * above.map_or(1.0, |veil| veil.over(self)) }
    }
}

impl Cover for Plastic {
    fn passed(&self, w: Local) -> f32 {
        1.0 - self.surface(w)
    }

    fn mean(&self) -> f32 {
        (1.0 - self.internal) * self.eta * self.eta
    }
}

pub(super) const NODES: usize = COSINES.len();

/// Gauss and Legendre's nodes on [0, 1], and their weights.
const COSINES: [[f32; 2]; 8] = [
    [0.019855072, 0.050614268],
    [0.10166676, 0.11119052],
    [0.23723379, 0.15685332],
    [0.40828268, 0.18134189],
    [0.5917173, 0.18134189],
    [0.7627662, 0.15685332],
    [0.89833324, 0.11119052],
    [0.9801449, 0.050614268],
];

/// Directions of all inclinations, halfway between the axes: what is rougher one way than the other is about at its mean there.
pub(super) fn nodes() -> [Local; NODES] {
    let (sin, cos) = float::sin_cos_degrees(45.0);
    COSINES.map(|[mu, _]| {
        let sine = ((1.0 - mu) * (1.0 + mu)).sqrt();
        Local::new(sine * cos as f32, sine * sin as f32, mu)
    })
}

/// 2 ∫₀¹ p μ dμ
fn average(passed: &[f32; NODES]) -> f32 {
    passed.iter().zip(COSINES).map(|(passed, [mu, weight])| 2.0 * mu * weight * passed).sum()
}
