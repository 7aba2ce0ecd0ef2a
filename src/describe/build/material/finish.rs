//! How rough a surface is.

use glam::Vec2;

use crate::bsdf::microfacet::finish::{self, Alpha, Finish};
use crate::bsdf::microfacet::{Distribution, Microfacets};
use crate::describe::build::{Builder, spectrum};
use crate::describe::{self, Textured};
use crate::math::Spectrum;
use crate::texture::Texture;

impl Builder<'_> {
    /// Roughnesses too small to be told from none.
    pub(super) fn note_smooth(&mut self, pointer: &str, described: &describe::Material) {
        for (key, roughness) in described.roughnesses() {
            let Textured::Color(color) = roughness else { continue };
            let value = spectrum(color).average();
            if value > 0.0 && Microfacets::new(finish::alpha(value, 0.0), Distribution::Ggx).is_none() {
                self.warnings.push(format!("{}: {pointer}/{key}: {value} is as good as 0, the surface is smooth", self.source.file));
            }
        }
    }

    /// `None` for a surface that is smooth everywhere.
    pub(super) fn finish(&mut self, pointer: &str, finish: describe::Finish) -> Option<Finish> {
        let mut textured = |key: &str, described: &Textured| self.textured(&format!("{pointer}/{key}"), described);
        let widths = match finish.alpha {
            None => {
                return self.roughened(pointer, ["roughness", "anisotropy"], [finish.roughness, finish.anisotropy], finish.distribution);
            }
            Some(describe::Alpha::Round(width)) => [textured("alpha", width), textured("alpha", width)],
            Some(describe::Alpha::Along([u, v])) => [textured("alpha/0", u), textured("alpha/1", v)],
        };
        let alpha = match widths {
            [Texture::Constant(x), Texture::Constant(y)] => Alpha::Constant(Vec2::new(x.average(), y.average())),
            widths => Alpha::Widths(widths),
        };
        rough(alpha, finish.distribution)
    }

    /// - `keys`: of roughness and anisotropy, which come next
    pub(super) fn roughened(
        &mut self,
        pointer: &str,
        keys: [&str; 2],
        described: [&Textured; 2],
        distribution: describe::Distribution,
    ) -> Option<Finish> {
        let [roughness, anisotropy] = [0, 1].map(|k| self.textured(&format!("{pointer}/{}", keys[k]), described[k]));
        let alpha = match (roughness, anisotropy) {
            (Texture::Constant(roughness), Texture::Constant(anisotropy)) => {
                Alpha::Constant(finish::alpha(roughness.average(), anisotropy.average()))
            }
            (Texture::Constant(smooth), _) if smooth == Spectrum::BLACK => Alpha::Constant(Vec2::ZERO),
            (roughness, anisotropy) => Alpha::Textured { roughness, anisotropy },
        };
        rough(alpha, distribution)
    }
}

/// `None` for a surface that is smooth everywhere.
fn rough(alpha: Alpha, distribution: describe::Distribution) -> Option<Finish> {
    let distribution = match distribution {
        describe::Distribution::Ggx => Distribution::Ggx,
        describe::Distribution::Beckmann => Distribution::Beckmann,
    };
    let smooth = matches!(alpha, Alpha::Constant(alpha) if Microfacets::new(alpha, distribution).is_none());
    (!smooth).then_some(Finish { alpha, distribution })
}
