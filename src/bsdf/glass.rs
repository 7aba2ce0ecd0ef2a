//! Clear materials by name: published formulas of their indices of refraction.
//!
//! Optical glasses: the data sheets of Schott AG (2017). Fused silica: Malitson, *Interspecimen Comparison of the Refractive Index of Fused
//! Silica*, J. Opt. Soc. Am. 55 (1965). Sapphire, ordinary ray: Malitson and Dodge, *Refractive Index and Birefringence of Synthetic
//! Sapphire*, J. Opt. Soc. Am. 62 (1972). Diamond: Peter, *Über Brechungsindizes und Absorptionskonstanten des Diamanten*, Z. Phys. 15
//! (1923). Water at 20 °C: Daimon and Masumura, *Measurement of the refractive index of distilled water*, Appl. Opt. 46 (2007).
//! All relative to air. Tests: glasses_have_the_index_of_their_catalogue.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::dispersion::Dispersion;

/// A clear material with a published index of refraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub enum Glass {
    /// Borosilicate crown glass, the most common optical glass: index 1.5168, Abbe number 64.2.
    #[serde(rename = "BK7")]
    Bk7,
    /// Barium flint glass: index 1.6700, Abbe number 47.1.
    #[serde(rename = "BAF10")]
    Baf10,
    /// Flint glass: index 1.6200, Abbe number 36.4.
    #[serde(rename = "F2")]
    F2,
    /// Fluorite crown glass, with very little dispersion: index 1.4866, Abbe number 84.5.
    #[serde(rename = "FK51A")]
    Fk51a,
    /// Dense lanthanum flint glass: index 1.8503, Abbe number 32.2.
    #[serde(rename = "LASF9")]
    Lasf9,
    /// Dense flint glass: index 1.6727, Abbe number 32.2.
    #[serde(rename = "SF5")]
    Sf5,
    /// Dense flint glass: index 1.7283, Abbe number 28.5.
    #[serde(rename = "SF10")]
    Sf10,
    /// Dense flint glass, with much dispersion: index 1.7847, Abbe number 25.7.
    #[serde(rename = "SF11")]
    Sf11,
    /// Diamond: index 2.4175, Abbe number 55.3.
    #[serde(rename = "diamond")]
    Diamond,
    /// Fused silica, the glass of quartz: index 1.4585, Abbe number 67.8.
    #[serde(rename = "fused_silica")]
    FusedSilica,
    /// Sapphire, without its birefringence: index 1.7682, Abbe number 72.3.
    #[serde(rename = "sapphire")]
    Sapphire,
    /// Water: index 1.3334, Abbe number 55.8.
    #[serde(rename = "water")]
    Water,
}

impl Glass {
    /// All glasses.
    pub const ALL: [Glass; 12] = [
        Glass::Bk7,
        Glass::Baf10,
        Glass::F2,
        Glass::Fk51a,
        Glass::Lasf9,
        Glass::Sf5,
        Glass::Sf10,
        Glass::Sf11,
        Glass::Diamond,
        Glass::FusedSilica,
        Glass::Sapphire,
        Glass::Water,
    ];

    /// The formula of the index of refraction.
    pub fn dispersion(self) -> Dispersion {
        Dispersion::sellmeier(self.terms().iter().copied())
    }

    /// B, and C (µm²), of the terms of Sellmeier's formula.
    fn terms(self) -> &'static [[f64; 2]] {
        match self {
            Glass::Bk7 => &[[1.03961212, 0.00600069867], [0.231792344, 0.0200179144], [1.01046945, 103.560653]],
            Glass::Baf10 => &[[1.5851495, 0.00926681282], [0.143559385, 0.0424489805], [1.08521269, 105.613573]],
            Glass::F2 => &[[1.34533359, 0.00997743871], [0.209073176, 0.0470450767], [0.937357162, 111.886764]],
            Glass::Fk51a => &[[0.971247817, 0.00472301995], [0.216901417, 0.0153575612], [0.904651666, 168.68133]],
            Glass::Lasf9 => &[[2.00029547, 0.0121426017], [0.298926886, 0.0538736236], [1.80691843, 156.530829]],
            Glass::Sf5 => &[[1.52481889, 0.011254756], [0.187085527, 0.0588995392], [1.42729015, 129.141675]],
            Glass::Sf10 => &[[1.62153902, 0.0122241457], [0.256287842, 0.0595736775], [1.64447552, 147.468793]],
            Glass::Sf11 => &[[1.73759695, 0.013188707], [0.313747346, 0.0623068142], [1.89878101, 155.23629]],
            Glass::Diamond => &[[0.3306, 0.1750 * 0.1750], [4.3356, 0.1060 * 0.1060]],
            Glass::FusedSilica => {
                &[[0.6961663, 0.0684043 * 0.0684043], [0.4079426, 0.1162414 * 0.1162414], [0.8974794, 9.896161 * 9.896161]]
            }
            Glass::Sapphire => {
                &[[1.4313493, 0.0726631 * 0.0726631], [0.65054713, 0.1193242 * 0.1193242], [5.3414021, 18.028251 * 18.028251]]
            }
            Glass::Water => &[
                [0.5684027565, 0.005101829712],
                [0.1726177391, 0.01821153936],
                [0.02086189578, 0.02620722293],
                [0.1130748688, 10.69792721],
            ],
        }
    }
}
