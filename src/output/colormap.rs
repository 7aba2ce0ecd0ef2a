//! Colours for numbers, perceptually uniform: equal steps look equal, and the brightness alone tells more from less.

use colorous::Gradient;

/// A map from 0 … 1 to colours. Source: matplotlib (Smith, van der Walt, Firing; cividis: Nuñez, Anderton, Renslow).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colormap {
    #[default]
    Magma,
    Inferno,
    Plasma,
    Viridis,
    /// The same to eyes that do not tell red from green.
    Cividis,
}

impl Colormap {
    /// sRGB in 8 bits; what lies outside of 0 … 1 gets the colour of the nearest end.
    pub fn color(self, x: f64) -> [u8; 3] {
        let gradient: Gradient = match self {
            Colormap::Magma => colorous::MAGMA,
            Colormap::Inferno => colorous::INFERNO,
            Colormap::Plasma => colorous::PLASMA,
            Colormap::Viridis => colorous::VIRIDIS,
            Colormap::Cividis => colorous::CIVIDIS,
        };
        gradient.eval_continuous(x.clamp(0.0, 1.0)).as_array()
    }
}
