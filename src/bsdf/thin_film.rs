//! Soap films and bubbles: a clear film so thin that its colours are those of interference.

use glam::{DVec3, Vec2};

use super::description::{Description, Prepare, given};
use super::film::{Film, FilmTable};
use super::parameter::Lookup;
use super::{Bsdf, BsdfSample, HitContext, Lobe, Material, Passage, ScatteringModel, TexturedModel, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Density, Local, Rgb, Spectrum, fresnel};
use crate::texture::{Number, Texture};

/// A clear film with the same medium on both sides, or a clear pane with a film on both faces, as one surface.
///
/// f(wo, wi) = R δ(wi − reflect(wo)) / |cos θi|  +  (1 − R) δ(wi + wo) / |cos θi|
///
/// with the reflectance R of all reflections between the faces of the film, whose waves add up. Transmitted light keeps its direction.
/// The film has no inside, and both sides are alike. A pane reflects 2R/(1 + R), because between its faces the waves do not add up; R is the mean of
/// the polarisations, as in [`ThinDielectric`](super::ThinDielectric).
///
/// - sampling: reflection with the mean q of R over red, green and blue, so that weight = colour · R/q, or colour · (1 − R)/(1 − q)
///
/// Source: Born and Wolf, *Principles of Optics*, §1.6.4. Tests: row O14 of `pt torture`, own_models_are_proved,
/// a_soap_film_keeps_all_light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinFilm {
    /// R for each angle.
    pub table: &'static FilmTable,
    /// The thickness of the film (nm).
    pub thickness: f32,
    /// The factor of all reflected and transmitted light: [0, 1]. A clear film has 1.
    pub color: Spectrum,
}

impl ScatteringModel for ThinFilm {
    fn sample(&self, wo: Local, choice: f32, _u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        let reflectance = self.reflectance(wo)?;
        let chance = reflectance.average();
        Some(if choice < chance {
            self.reflect(wo, reflectance / chance)
        } else {
            self.pass(wo, (Spectrum::ONE - reflectance) / (1.0 - chance))
        })
    }

    fn delta_lobes(&self, wo: Local, _mode: TransportMode) -> [Option<BsdfSample>; 2] {
        let Some(reflectance) = self.reflectance(wo) else { return [None, None] };
        let passed = Spectrum::ONE - reflectance;
        [(!reflectance.is_black()).then(|| self.reflect(wo, reflectance)), (!passed.is_black()).then(|| self.pass(wo, passed))]
    }

    fn has_smooth_lobe(&self) -> bool {
        false
    }
}

impl ThinFilm {
    /// R; `None` where nothing is scattered.
    fn reflectance(&self, wo: Local) -> Option<Spectrum> {
        (wo.cos() != 0.0 && !self.color.is_black()).then(|| self.table.at(wo.cos(), self.thickness))
    }

    fn reflect(&self, wo: Local, share: Spectrum) -> BsdfSample {
        BsdfSample::reflected(Local(fresnel::reflect(wo.0)), self.color * share)
    }

    fn pass(&self, wo: Local, share: Spectrum) -> BsdfSample {
        BsdfSample { wi: Local(-wo.0), weight: self.color * share, density: Density::Delta, lobe: Lobe::Transmission, eta: 1.0 }
    }
}

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    use crate::format::{CoatIndex, FilmIndex, FilmThickness, Textured, Varying};

    /// A soap film or bubble, or a coated pane, as one surface: a clear film whose colours are those of interference. Light that passes goes
    /// straight on.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields, default)]
    pub struct ThinFilm {
        /// The index of refraction of the film divided by that of its surroundings.
        pub eta: FilmIndex,
        /// The thickness of the film in nanometres. Below 50 it is dark, from 200 to 600 its colours are strongest, and beyond 1500 pale:
        /// `thin_dielectric` is a pane too thick for them. A film whose thickness varies needs a table over the thickness, once:
        /// it takes 0.2 s for up to 760 nm of soap, and 1 s for up to 2000 nm.
        pub thickness: Varying<FilmThickness>,
        /// A factor of all reflected and transmitted light.
        pub color: Textured,
        /// The index of refraction of a pane that has the film on both of its faces. Without it there is nothing but the film.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub pane: Option<CoatIndex>,
    }

    impl Default for ThinFilm {
        fn default() -> ThinFilm {
            ThinFilm {
                eta: FilmIndex::known(1.33),
                thickness: Varying::Same(FilmThickness::known(400.0)),
                color: Textured::white(),
                pane: None,
            }
        }
    }
}

/// The model with its textures.
pub mod textured {
    use super::{FilmTable, Number, Texture};

    /// A soap film with textures for parameters.
    #[derive(Clone, Debug, PartialEq)]
    pub struct ThinFilm {
        pub(super) table: &'static FilmTable,
        pub(super) thickness: Number,
        pub(super) color: Texture,
    }
}

impl textured::ThinFilm {
    /// A film with the index of refraction `eta`.
    ///
    /// - `thickness`: in nanometres
    pub fn new(eta: f32, thickness: impl Into<Number>, color: impl Into<Texture>) -> textured::ThinFilm {
        textured::ThinFilm::on_pane(eta, thickness, color, None)
    }

    /// A film on both faces of a pane; a film alone where there is none.
    ///
    /// - `pane`: the index of refraction of the pane
    pub fn on_pane(eta: f32, thickness: impl Into<Number>, color: impl Into<Texture>, pane: Option<f32>) -> textured::ThinFilm {
        let thickness = thickness.into();
        let base = [Rgb::gray(pane.unwrap_or(1.0)), Rgb::BLACK];
        let film = Film { eta, thickness: thickness.range(), base, on_both_faces: pane.is_some() };
        textured::ThinFilm { table: film.table(), thickness, color: color.into() }
    }
}

impl Description for described::ThinFilm {
    fn textures(&self) -> Vec<(String, &Textured)> {
        [("thickness/by", self.thickness.by()), ("color", Some(&self.color))].into_iter().filter_map(given).collect()
    }

    fn prepare(&self, builder: &mut dyn Prepare) -> Material {
        let (thickness, color) = (builder.number("thickness", &self.thickness), builder.texture("color", &self.color));
        textured::ThinFilm::on_pane(self.eta.get() as f32, thickness, color, self.pane.map(|pane| pane.get() as f32)).into()
    }
}

impl Lookup for textured::ThinFilm {
    type Model = Bsdf<'static>;

    fn at(&self, at: &HitContext) -> Bsdf<'static> {
        let (thickness, color) = (self.thickness.at(&at.texture), Spectrum::from_albedo(self.color.at(&at.texture)));
        Bsdf::ThinFilm(ThinFilm { table: self.table, thickness, color })
    }

    fn textures(&self) -> Vec<&Texture> {
        self.thickness.texture().into_iter().chain([&self.color]).collect()
    }

    fn recentred(self, origin: DVec3) -> textured::ThinFilm {
        textured::ThinFilm { thickness: self.thickness.recentred(origin), color: self.color.recentred(origin), ..self }
    }
}

impl TexturedModel for textured::ThinFilm {
    fn effects(&self) -> Effects {
        Effects::REFRACTION | Effects::SPECULAR_REFLECTION | Effects::THIN_FILM
    }

    fn passage(&self) -> Passage {
        Passage::Sheet
    }
}
