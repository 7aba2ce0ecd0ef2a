//! Layers (arbitrary output variables): numbers that a pixel has in addition to its colours.
//!
//! ```text
//! Samples   Σ w x / n          like the picture: w is the weight of the sample, samples that hit nothing count as 0
//! Hits      Σ |w| x / Σ |w|    over the samples that hit a surface; 0 if none did
//! Sum       Σ x
//! ```
//!
//! All three are computed from sums, so that layers are joined like the picture. `Hits` uses |w|, because a mean of positions with
//! negative weights may lie far from all of them.
//!
//! A new layer is a variant here with its row in [`Layer::ALL`] and its arms, and the source of its numbers: an arm in
//! `render::aovs`.

use std::sync::Arc;

/// Layer of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Layer {
    /// Fraction of light that the first surface scatters.
    Albedo,
    /// Geometric normal of the first surface.
    Normal,
    /// Shading normal of the first surface.
    ShadingNormal,
    /// Position on the first surface in world space (m).
    Position,
    /// Depth of the first surface (m).
    Depth,
    /// Texture coordinates of the first surface.
    Uv,
    /// Light that reaches the camera without scattering.
    Emission,
    /// Light that scattered once.
    Direct,
    /// Light that scattered more than once.
    Indirect,
    /// All light of the lights with one name: see [`LightNames`].
    Light(u32),
    /// Time that the samples took (s).
    Time,
}

/// Names of a scene's lights.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LightNames {
    /// Distinct names. An emitting mesh is many lights with one name.
    pub names: Vec<String>,
    /// Index into `names` for each light, and then for the media if they emit.
    pub of: Arc<[u32]>,
}

/// Rule by which the samples of a pixel become one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Weighted mean over all samples.
    Samples,
    /// Weighted mean over the samples that hit a surface.
    Hits,
    /// Sum over all samples.
    Sum,
}

/// Greatest number of channels of a layer.
pub const MAX_CHANNELS: usize = 3;

impl Layer {
    /// Each layer with its name on the command line and a description in one line.
    pub const ALL: &[(Layer, &str, &str)] = &[
        (
            Layer::Albedo,
            "albedo",
            "Albedo.R/G/B: the share of light that the first surface scatters; what shines has the colour of its light.",
        ),
        (Layer::Normal, "n", "N.X/Y/Z: geometric normal of the first surface, to its outside, in world space."),
        (Layer::ShadingNormal, "ns", "Ns.X/Y/Z: its shading normal, with smooth meshes, normal and bump maps."),
        (Layer::Position, "p", "P.X/Y/Z: where the first surface is, in world space (m), over the samples that meet one."),
        (Layer::Depth, "z", "Z: how far it is along the camera's axis (m), for panoramas from the camera; over the samples that meet one."),
        (Layer::Uv, "uv", "uv.U/V: its texture coordinates, over the samples that meet one."),
        (Layer::Emission, "emission", "Emission.R/G/B: the light that the camera sees at its source."),
        (Layer::Direct, "direct", "Direct.R/G/B: the light that was scattered once on its way."),
        (Layer::Indirect, "indirect", "Indirect.R/G/B: the light that was scattered more often. The three add up to the picture."),
        (Layer::Light(0), "lights", "Light.NAME.R/G/B: the light of each light, however it came. All of them add up to the picture."),
        (Layer::Time, "time", "Time.Y: seconds that the picture's samples took. By the clock, so no part of `all` nor of hashes."),
    ];

    /// Name in [`Layer::ALL`].
    pub fn name(self) -> &'static str {
        let row = match self {
            Layer::Light(_) => Layer::Light(0),
            other => other,
        };
        Layer::ALL.iter().find(|(layer, ..)| *layer == row).map_or("", |row| row.1)
    }

    /// The layer with a name of [`Layer::ALL`].
    pub fn named(name: &str) -> Option<Layer> {
        Layer::ALL.iter().find(|row| row.1 == name).map(|row| row.0)
    }

    /// Full names of the channels in a picture.
    pub fn channels(self, lights: &LightNames) -> Vec<String> {
        let name = match self {
            Layer::Albedo => "Albedo",
            Layer::Normal => "N",
            Layer::ShadingNormal => "Ns",
            Layer::Position => "P",
            Layer::Depth => return vec!["Z".into()],
            Layer::Uv => "uv",
            Layer::Emission => "Emission",
            Layer::Direct => "Direct",
            Layer::Indirect => "Indirect",
            Layer::Light(i) => &format!("Light.{}", lights.names.get(i as usize).map_or("?", String::as_str)),
            Layer::Time => "Time",
        };
        self.components().iter().map(|component| format!("{name}.{component}")).collect()
    }

    fn components(self) -> &'static [&'static str] {
        match self {
            Layer::Albedo | Layer::Emission | Layer::Direct | Layer::Indirect | Layer::Light(_) => &["R", "G", "B"],
            Layer::Normal | Layer::ShadingNormal | Layer::Position => &["X", "Y", "Z"],
            Layer::Uv => &["U", "V"],
            Layer::Depth => &["Z"],
            Layer::Time => &["Y"],
        }
    }

    /// Whether the numbers are recorded along the picture's own paths.
    pub fn is_light(self) -> bool {
        matches!(self, Layer::Emission | Layer::Direct | Layer::Indirect | Layer::Light(_))
    }

    /// Rule by which samples become one number.
    pub fn rule(self) -> Rule {
        match self {
            Layer::Albedo | Layer::Normal | Layer::ShadingNormal => Rule::Samples,
            Layer::Emission | Layer::Direct | Layer::Indirect | Layer::Light(_) => Rule::Samples,
            Layer::Position | Layer::Depth | Layer::Uv => Rule::Hits,
            Layer::Time => Rule::Sum,
        }
    }

    /// Whether the layer depends on scene and settings alone.
    pub fn is_reproducible(self) -> bool {
        self != Layer::Time
    }

    /// Number of sums per pixel.
    pub fn sum_count(self) -> usize {
        self.components().len() + usize::from(self.rule() == Rule::Hits)
    }

    /// Appends the terms that one sample adds to the sums.
    ///
    /// - `weight`: that of the reconstruction filter and of the camera ray
    /// - `values`: one per channel; `None` if the sample hit nothing
    pub fn add_terms(self, weight: f64, values: Option<&[f64]>, terms: &mut Vec<f64>) {
        let Some(values) = values else { return terms.extend(std::iter::repeat_n(0.0, self.sum_count())) };
        match self.rule() {
            Rule::Samples => terms.extend(values.iter().map(|x| weight * x)),
            Rule::Sum => terms.extend(values),
            Rule::Hits => {
                terms.extend(values.iter().map(|x| weight.abs() * x));
                terms.push(weight.abs());
            }
        }
    }

    /// Value of channel `c` in the picture, from the sums over n samples.
    pub fn value(self, sums: &[f64], c: usize, n: u64) -> f64 {
        match self.rule() {
            Rule::Samples => sums[c] / n.max(1) as f64,
            Rule::Sum => sums[c],
            Rule::Hits => match sums.last() {
                Some(&weight) if weight > 0.0 => sums[c] / weight,
                _ => 0.0,
            },
        }
    }
}

/// The layers with [`Layer::Light`] replaced by one layer for each of `count` light names.
pub fn with_lights(layers: &[Layer], count: usize) -> Vec<Layer> {
    let each = |layer: &Layer| match layer {
        Layer::Light(_) => (0..count as u32).map(Layer::Light).collect(),
        other => vec![*other],
    };
    layers.iter().flat_map(each).collect()
}

/// Each layer with the range of its sums among the layer sums of a pixel.
pub fn places(layers: &[Layer]) -> impl Iterator<Item = (Layer, std::ops::Range<usize>)> {
    layers.iter().scan(0, |start, layer| {
        let from = *start;
        *start += layer.sum_count();
        Some((*layer, from..*start))
    })
}

/// Number of sums per pixel of all layers.
pub fn sum_count(layers: &[Layer]) -> usize {
    layers.iter().map(|layer| layer.sum_count()).sum()
}
