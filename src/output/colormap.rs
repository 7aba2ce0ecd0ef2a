//! Perceptually uniform colour maps: equal steps look equal, and brightness alone shows the order.

use colorous::Gradient;

/// Map from 0 … 1 to colours. Source: matplotlib (Smith, van der Walt, Firing; cividis: Nuñez, Anderton, Renslow).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colormap {
    /// Black, purple, orange, pale yellow.
    #[default]
    Magma,
    /// Black, purple, red, yellow.
    Inferno,
    /// Blue, purple, orange, yellow.
    Plasma,
    /// Purple, green, yellow.
    Viridis,
    /// Blue, grey, yellow: looks the same with and without red-green colour blindness.
    Cividis,
}

impl Colormap {
    /// Colour of a value from 0 to 1, as sRGB in 8 bits. Values outside get the colour of the nearest end.
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
