//! How rough a surface is.

use glam::Vec2;

use crate::bsdf::microfacet::finish::{self, Alpha, Finish};
use crate::bsdf::microfacet::{Distribution, Microfacets};
use crate::describe::build::{Builder, spectrum};
use crate::describe::{self, Fraction, Textured};
use crate::texture::Texture;

impl Builder<'_> {
    /// A roughness too small to be told from none.
    pub(super) fn note_smooth(&mut self, pointer: &str, finish: describe::Finish) {
        let Textured::Color(color) = finish.roughness else { return };
        let value = spectrum(color).average();
        if value > 0.0 && Microfacets::new(finish::alpha(value, 0.0), Distribution::Ggx).is_none() {
            self.warnings.push(format!("{}: {pointer}/roughness: {value} is as good as 0, the surface is smooth", self.source.file));
        }
    }

    /// `None` for a surface that is smooth everywhere.
    pub(super) fn finish(&mut self, pointer: &str, finish: describe::Finish) -> Option<Finish> {
        let describe::Finish { roughness, anisotropy, alpha, distribution } = finish;
        self.roughened(&format!("{pointer}/roughness"), roughness, anisotropy, alpha, distribution)
    }

    /// - `pointer`: of the roughness
    pub(super) fn roughened(
        &mut self,
        pointer: &str,
        roughness: &Textured,
        anisotropy: Fraction,
        width: Option<describe::Alpha>,
        distribution: describe::Distribution,
    ) -> Option<Finish> {
        let anisotropy = anisotropy.get() as f32;
        let alpha = match (width, self.textured(pointer, roughness)) {
            (Some(describe::Alpha::Round(width)), _) => Alpha::Constant(Vec2::splat(width.get() as f32)),
            (Some(describe::Alpha::Along(widths)), _) => Alpha::Constant(Vec2::from(widths.map(|width| width.get() as f32))),
            (None, Texture::Constant(roughness)) => Alpha::Constant(finish::alpha(roughness.average(), anisotropy)),
            (None, roughness) => Alpha::Textured { roughness, anisotropy },
        };
        let distribution = match distribution {
            describe::Distribution::Ggx => Distribution::Ggx,
            describe::Distribution::Beckmann => Distribution::Beckmann,
        };
        let smooth = matches!(alpha, Alpha::Constant(alpha) if Microfacets::new(alpha, distribution).is_none());
        (!smooth).then_some(Finish { alpha, distribution })
    }
}

/// α = r²
pub(super) fn alpha_of(roughness: Fraction) -> f32 {
    let roughness = roughness.get() as f32;
    roughness * roughness
}
