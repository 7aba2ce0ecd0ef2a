//! Layers: numbers beside the colours of a pixel.
//!
//! ```text
//! Samples   Σ w x / n          as the picture: w weighs by the pixel's filter, what met nothing counts as 0
//! Hits      Σ |w| x / Σ |w|    over the samples that met a surface; 0 where none did
//! Sum       Σ x
//! ```
//!
//! All three come from sums, so that layers join as the picture does. |w|: a filter with negative lobes has no say
//! in where things are, and a mean of places lies among them.
//!
//! To add one: a variant here, its row in [`Layer::ALL`], its arms, and where its numbers come from: for what the first
//! surface tells, an arm in `render::first_hit`, for what paths tell in `render::paths`.

use std::sync::Arc;

/// What there is beside the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Layer {
    Albedo,
    Normal,
    ShadingNormal,
    Position,
    Depth,
    Uv,
    /// Seen by the camera itself.
    Emission,
    /// Scattered once.
    Direct,
    /// Scattered more than once.
    Indirect,
    /// However it came, of the lights of one name: see [`LightNames`].
    Light(u32),
    Time,
}

/// The names of a scene's lights.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LightNames {
    /// Each once: a mesh that shines is many lights of one name.
    pub names: Vec<String>,
    /// Which of them each light has.
    pub of: Arc<[u32]>,
}

/// How the samples of a pixel become one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    Samples,
    Hits,
    Sum,
}

/// The most channels of a layer.
pub const MAX_CHANNELS: usize = 3;

impl Layer {
    /// Each layer with the name by which it is asked for and one line about it.
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

    /// Its name in [`Layer::ALL`].
    pub fn name(self) -> &'static str {
        let row = match self {
            Layer::Light(_) => Layer::Light(0),
            other => other,
        };
        Layer::ALL.iter().find(|(layer, ..)| *layer == row).map_or("", |row| row.1)
    }

    /// By the name in [`Layer::ALL`].
    pub fn named(name: &str) -> Option<Layer> {
        Layer::ALL.iter().find(|row| row.1 == name).map(|row| row.0)
    }

    /// The full names of its channels in a picture.
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

    /// Whether the picture's own paths tell its numbers.
    pub fn is_light(self) -> bool {
        matches!(self, Layer::Emission | Layer::Direct | Layer::Indirect | Layer::Light(_))
    }

    pub fn rule(self) -> Rule {
        match self {
            Layer::Albedo | Layer::Normal | Layer::ShadingNormal => Rule::Samples,
            Layer::Emission | Layer::Direct | Layer::Indirect | Layer::Light(_) => Rule::Samples,
            Layer::Position | Layer::Depth | Layer::Uv => Rule::Hits,
            Layer::Time => Rule::Sum,
        }
    }

    /// Whether it depends on scene and settings alone.
    pub fn is_reproducible(self) -> bool {
        self != Layer::Time
    }

    /// How many numbers of a pixel it adds up.
    pub fn slots(self) -> usize {
        self.components().len() + usize::from(self.rule() == Rule::Hits)
    }

    /// Appends what one sample adds to them.
    ///
    /// - `weight`: of the filter
    /// - `values`: one per channel; `None` where the sample met nothing
    pub fn add_terms(self, weight: f64, values: Option<&[f64]>, terms: &mut Vec<f64>) {
        let Some(values) = values else { return terms.extend(std::iter::repeat_n(0.0, self.slots())) };
        match self.rule() {
            Rule::Samples => terms.extend(values.iter().map(|x| weight * x)),
            Rule::Sum => terms.extend(values),
            Rule::Hits => {
                terms.extend(values.iter().map(|x| weight.abs() * x));
                terms.push(weight.abs());
            }
        }
    }

    /// The number of channel `c` in the picture, from its sums over n samples.
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

/// The layers, with one for each of `count` lights in the place of the one for all of them.
pub fn with_lights(layers: &[Layer], count: usize) -> Vec<Layer> {
    let each = |layer: &Layer| match layer {
        Layer::Light(_) => (0..count as u32).map(Layer::Light).collect(),
        other => vec![*other],
    };
    layers.iter().flat_map(each).collect()
}

/// Where the numbers of each layer lie among those of a pixel.
pub fn places(layers: &[Layer]) -> impl Iterator<Item = (Layer, std::ops::Range<usize>)> {
    layers.iter().scan(0, |start, layer| {
        let from = *start;
        *start += layer.slots();
        Some((*layer, from..*start))
    })
}

/// How many numbers per pixel the layers add up.
pub fn slots(layers: &[Layer]) -> usize {
    layers.iter().map(|layer| layer.slots()).sum()
}
