//! Transmittance of layers above a material.

use std::cell::OnceCell;

use crate::bsdf::{Bsdf, Plastic, TransportMode};
use crate::math::{Local, Spectrum, float};

/// A layer without thickness. It transmits all light that it does not reflect.
pub(super) trait Cover {
    /// p(w), the transmittance for light from a direction.
    fn passed(&self, w: Local) -> f32;

    /// p̄ = 2 ∫₀¹ p μ dμ, the transmittance for diffuse light.
    fn mean(&self) -> f32;

    /// p at the [`nodes`].
    fn passed_at_nodes(&self) -> [f32; NODES] {
        nodes().map(|w| self.passed(w))
    }
}

/// The layers above a material, and a pair of directions.
///
/// Light that passes all layers, is scattered by a base with f and passes all layers again is T f, with
///
/// T = Π pₖ(wo) pₖ(wi) / m,    m = 2 ∫₀¹ Π pₖ(μ) μ dμ        for a matte base,
///
/// T = Π min(pₖ(wo), pₖ(wi))                                  for any other base
///
/// Both are reciprocal. The first loses no light: over a white base ∫ T |cos θi|/π dwi = Π pₖ(wo). The second never returns more than
/// Π pₖ(wo), and exactly that over a mirror. Over a base with a wide lobe it loses light where p differs between wo and wi.
pub(super) struct LayerStack<'a> {
    /// The layer next to the material.
    lowest: &'a dyn Cover,
    /// The layers above that one.
    above: Option<&'a LayerStack<'a>>,
    /// The directions wo and wi.
    ways: [Local; 2],
    /// p of the lowest layer for wo and wi, computed when it is needed.
    passed: OnceCell<[f32; 2]>,
}

impl<'a> LayerStack<'a> {
    pub fn new(lowest: &'a dyn Cover, above: Option<&'a LayerStack<'a>>, wo: Local, wi: Local) -> LayerStack<'a> {
        LayerStack { lowest, above, ways: [wo, wi], passed: OnceCell::new() }
    }

    /// T for a base that is not matte.
    pub fn glossy(&self) -> f32 {
        self.layers().map(|stack| stack.passed()).map(|[o, i]| o.min(i)).product()
    }

    /// T for a base.
    fn over(&self, base: &Bsdf) -> f32 {
        match base {
            Bsdf::Diffuse(_) | Bsdf::DiffuseTransmission(_) => self.matte(),
            Bsdf::Plastic(plastic) => self.within(plastic),
            _ => self.glossy(),
        }
    }

    /// T for a matte base.
    fn matte(&self) -> f32 {
        let mean = self.mean();
        if mean > 0.0 { self.both_ways() / mean } else { 0.0 }
    }

    /// T for the matte base of a plastic. The plastic's f already includes its own coat.
    fn within(&self, plastic: &Plastic) -> f32 {
        let mean = LayerStack::new(plastic, Some(self), self.ways[0], self.ways[1]).mean();
        if mean > 0.0 { self.both_ways() * plastic.mean() / mean } else { 0.0 }
    }

    /// Π pₖ(wo) pₖ(wi)
    fn both_ways(&self) -> f32 {
        self.layers().map(|stack| stack.passed()).map(|[o, i]| o * i).product()
    }

    fn passed(&self) -> [f32; 2] {
        *self.passed.get_or_init(|| self.ways.map(|w| self.lowest.passed(w)))
    }

    /// m. For several layers it is the product of their means, corrected by the correlation of p between layers at the nodes.
    fn mean(&self) -> f32 {
        if self.above.is_none() {
            return self.lowest.mean();
        }
        let (mut means, mut all) = (1.0, [1.0; NODES]);
        for stack in self.layers() {
            let passed = stack.lowest.passed_at_nodes();
            means *= stack.lowest.mean() / average(&passed);
            all.iter_mut().zip(passed).for_each(|(all, passed)| *all *= passed);
        }
        means * average(&all)
    }

    /// The layers from the lowest upwards.
    fn layers(&self) -> impl Iterator<Item = &LayerStack<'a>> {
        std::iter::successors(Some(self), |stack| stack.above)
    }
}

impl Bsdf<'_> {
    /// f(wo, wi)·|cos θi| times the transmittance of the layers above on the way in and out.
    pub(super) fn beneath(&self, above: Option<&LayerStack>, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        if let Bsdf::Compound(at) = self {
            return at.beneath(above, wo, wi, mode);
        }
        let f = self.eval(wo, wi, mode);
        if f.is_black() { f } else { f * above.map_or(1.0, |stack| stack.over(self)) }
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

/// The number of nodes of the quadrature.
pub(super) const NODES: usize = COSINES.len();

/// The nodes of Gauss–Legendre quadrature on [0, 1], and their weights.
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

/// The directions with the cosines of the nodes, halfway between the tangents, where an anisotropic surface is about average.
pub(super) fn nodes() -> [Local; NODES] {
    let (sin, cos) = float::sin_cos_degrees(45.0);
    COSINES.map(|[mu, _]| {
        let sine = ((1.0 - mu) * (1.0 + mu)).sqrt();
        Local::new(sine * cos as f32, sine * sin as f32, mu)
    })
}

/// 2 ∫₀¹ p μ dμ by quadrature.
fn average(passed: &[f32; NODES]) -> f32 {
    passed.iter().zip(COSINES).map(|(passed, [mu, weight])| 2.0 * mu * weight * passed).sum()
}
