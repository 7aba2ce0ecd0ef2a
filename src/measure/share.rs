//! What one colour of a pixel adds to relMSE, told by its own samples and by a calm place nearby.
//!
//! ```text
//! σ² g(r),   g(r) = 1/(r² + ε)
//! ```
//!
//! Of r and σ² nothing is known but x and v, and these vary together: noise is skewed, and a pixel that one bright sample made
//! bright looks noisy as well. v g(x) would be too small, for such a pixel excuses itself. So g is expanded about the calm place c,
//!
//! ```text
//! g(x) ≈ g + g′ (x − c) + ½ g″ (x − c)²,    g, g′, g″ at c
//! ```
//!
//! and what v and x have in common is taken off. For samples of any distribution
//!
//! ```text
//! E[v (x − r)] = κ₃        E[v ((x − r)² − v)] = −2σ⁴/ν
//! ```
//!
//! in which kurtosis cancels, so that
//!
//! ```text
//! share = v (g + g′ (x − c − κ₃/v) + ½ g″ ((x − c)² − v + 2w/ν)),    w near σ²
//! ```
//!
//! has the mean σ² g(r) to second order, whether c is near r or noise has moved it or the pixel is of another kind. By the same
//! cumulants its distance from what this very picture adds, (x − r)² g(r), has the variance
//!
//! ```text
//! σ⁴ g² (2 + 2/ν − 4 (1 − 2/ν) κ₃/σ² g′/g + (1 + 2/ν) σ² (g′/g)²)
//! ```
//!
//! Source: cumulants of k-statistics, Kendall and Stuart, *The Advanced Theory of Statistics*, vol. 1, ch. 12.

/// What is known of one colour of a pixel.
pub(super) struct Known {
    /// x, the mean of the samples.
    pub value: f64,
    /// v, its estimated variance.
    pub variance: f64,
    /// κ₃/v
    pub pull: f64,
    /// ν of v.
    pub freedom: f64,
}

/// Where noise is small, or at least not the pixel's own.
pub(super) struct Calm {
    /// c
    pub value: f64,
    /// w, about as large as v, and hardly knowing of it.
    pub variance: f64,
}

/// Estimated; means over colours that move together are shares again.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Share {
    pub value: f64,
    /// Times the value: the variance of its distance from what the picture really adds.
    pub doubt: f64,
}

/// Of (x − r)² and its estimate v: the variance of their difference, over σ⁴, where noise is even.
pub(super) fn chance(freedom: f64) -> f64 {
    2.0 + 2.0 / freedom
}

/// How far the expansion may move the share.
const FARTHEST: f64 = 4.0;

impl Share {
    /// - `floor`: ε
    pub fn new(pixel: &Known, calm: &Calm, floor: f64) -> Share {
        let (v, w, nu, c) = (pixel.variance, calm.variance, pixel.freedom, calm.value);
        let below = c * c + floor;
        // g′/g and g″/g
        let (first, second) = (-2.0 * c / below, (6.0 * c * c - 2.0 * floor) / (below * below));
        let away = pixel.value - c;
        // The series converges within √(c² + ε) of c: it fades out before.
        let reach = (1.0 + (away * away + v) / below).powi(-2);
        let change = first * (away - pixel.pull) + 0.5 * second * (away * away - v + 2.0 * w / nu);
        let factor = (1.0 + reach * change).clamp(1.0 / FARTHEST, FARTHEST);
        let slope = reach * first;
        let chance = chance(nu);
        let doubt = chance - 4.0 * (1.0 - 2.0 / nu) * slope * pixel.pull + (1.0 + 2.0 / nu) * slope * slope * w;
        // Skewness itself is a guess: it may not take away more than half.
        Share { value: v / below * factor, doubt: w / below * doubt.max(0.5 * chance) }
    }

    pub fn mean(colors: [Share; 3]) -> Share {
        let mean = |f: fn(&Share) -> f64| colors.iter().map(f).sum::<f64>() / 3.0;
        Share { value: mean(|c| c.value), doubt: mean(|c| c.doubt) }
    }
}
