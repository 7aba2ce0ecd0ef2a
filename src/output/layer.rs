//! Layers of a picture, each of which can be viewed as red, green and blue.

use std::fmt;

use glam::UVec2;

use crate::film::{Channel, Image};
use crate::reader::unknown;

/// Selection of a layer of a picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Pick {
    /// The colours: `R`, `G`, `B`, or the only channel.
    #[default]
    Colour,
    /// A layer by its name: `StdErr` for `StdErr.R`, `StdErr.G`, `StdErr.B`; `N` for `N.X`, `N.Y`, `N.Z`; `uv` for `uv.U`, `uv.V` and a
    /// blue of 0; `SampleCount` for `SampleCount.Y`; `Z` for `Z`.
    Layer(String),
    /// One channel by its full name.
    Channel(String),
}

const TRIPLES: [[&str; 3]; 4] = [["R", "G", "B"], ["r", "g", "b"], ["X", "Y", "Z"], ["x", "y", "z"]];
const PAIRS: [[&str; 2]; 2] = [["U", "V"], ["u", "v"]];

impl fmt::Display for Pick {
    /// Name of the selection: `R, G, B`, `layer StdErr`, `channel Z`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Pick::Colour => f.write_str("R, G, B"),
            Pick::Layer(name) => write!(f, "layer {name}"),
            Pick::Channel(name) => write!(f, "channel {name}"),
        }
    }
}

impl Pick {
    /// Picture whose `R`, `G`, `B` are the selected channels; a single channel becomes grey.
    ///
    /// # Errors
    /// A sentence that lists the layers of the picture.
    pub fn of(&self, image: &Image) -> Result<Image, String> {
        let [r, g, b] = self.names(image)?;
        let nothing = || vec![0.0; image.size.x as usize * image.size.y as usize];
        let values = |from: Option<&str>| from.and_then(|name| image.channel(name)).map_or_else(nothing, <[f32]>::to_vec);
        let channels = [("R", r), ("G", g), ("B", b)].map(|(name, from)| Channel { name: name.into(), values: values(from) });
        Ok(Image { channels: channels.into(), ..*image })
    }

    /// Channels that become red, green and blue; `None` for one that is 0.
    fn names<'i>(&self, image: &'i Image) -> Result<[Option<&'i str>; 3], String> {
        let all: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
        let (layer, what) = match self {
            Pick::Colour => ("", "colours"),
            Pick::Layer(name) => (name.as_str(), "layer"),
            Pick::Channel(name) => {
                let found = all.iter().find(|channel| *channel == name);
                return found.map(|name| [Some(*name); 3]).ok_or_else(|| unknown("channel", name, &all));
            }
        };
        let within: Vec<(&str, &str)> =
            all.iter().map(|name| (*name, split(name))).filter(|(_, (l, _))| *l == layer).map(|(name, (_, c))| (name, c)).collect();
        let named = |component: &str| within.iter().find(|(_, c)| *c == component).map(|(name, _)| *name);
        let triple = TRIPLES.iter().find_map(|[r, g, b]| Some([Some(named(r)?), Some(named(g)?), Some(named(b)?)]));
        let pair = PAIRS.iter().find_map(|[u, v]| Some([Some(named(u)?), Some(named(v)?), None]));
        let single = match (within.as_slice(), layer) {
            ([(only, _)], _) => Some([Some(*only); 3]),
            // The only channel of a picture may have any name.
            ([], "") if all.len() == 1 => Some([Some(all[0]); 3]),
            // A layer with one channel may have the name of the layer alone, such as Z.
            ([], _) => all.iter().find(|name| **name == layer).map(|name| [Some(*name); 3]),
            _ => None,
        };
        triple.or(pair).or(single).ok_or_else(|| match (self, within.is_empty()) {
            (Pick::Layer(_), true) => {
                let mut layers: Vec<&str> = all.iter().map(|name| split(name).0).filter(|layer| !layer.is_empty()).collect();
                layers.dedup();
                unknown("layer", layer, &layers)
            }
            _ => format!("expected R, G and B among the {what}, found {}", all.join(", ")),
        })
    }
}

/// Splits `a.b.R` into the layer `a.b` and the component R.
fn split(name: &str) -> (&str, &str) {
    name.rsplit_once('.').unwrap_or(("", name))
}

/// Window of a picture: `8 × 6`, or `4 × 2 at (1, 0) of 8 × 6`. Pictures can be compared if their windows are equal.
pub fn window(image: &Image) -> String {
    let (size, full, origin) = (image.size, image.full_size, image.origin);
    if size == full && origin == UVec2::ZERO {
        return format!("{} × {}", size.x, size.y);
    }
    format!("{} × {} at ({}, {}) of {} × {}", size.x, size.y, origin.x, origin.y, full.x, full.y)
}
