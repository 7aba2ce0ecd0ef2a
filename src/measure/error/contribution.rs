//! Contribution of one colour of a pixel to relMSE, estimated from its own samples and from a reference value nearby.
//!
//! ```text
//! σ² g(r),   g(r) = 1/(r² + ε)
//! ```
//!
//! The true value r and the variance σ² are unknown; only their estimates x and v are known, and these are correlated: noise is
//! skewed, and one bright sample makes a pixel bright as well as noisy. The estimate v g(x) would be too small, since such a pixel
//! is divided by its own outlier. So g is expanded about c, a value from the neighbourhood,
//!
//! ```text
//! g(x) ≈ g + g′ (x − c) + ½ g″ (x − c)²,    g, g′, g″ at c
//! ```
//!
//! and the covariance of v and x is subtracted. For samples of any distribution
//!
//! ```text
//! E[v (x − r)] = κ₃        E[v ((x − r)² − v)] = −2σ⁴/ν
//! ```
//!
//! in which kurtosis cancels, so that
//!
//! ```text
//! contribution = v (g + g′ (x − c − κ₃/v) + ½ g″ ((x − c)² − v + 2w/ν)),    w near σ²
//! ```
//!
//! has the mean σ² g(r) to second order. κ₃ is estimated from the samples; for scrambled points it is scaled by a factor that is estimated
//! from the whole picture. The result holds if c is near r, even if c contains noise or the pixel differs from its neighbours. By the same cumulants, the difference between this estimate and the true contribution of this very picture, (x − r)²
//! g(r), has the variance
//!
//! ```text
//! σ⁴ g² (2 + 2/ν − 4 (1 − 2/ν) κ₃/σ² g′/g + (1 + 2/ν) σ² (g′/g)²)
//! ```
//!
//! Source: cumulants of k-statistics, Kendall and Stuart, *The Advanced Theory of Statistics*, vol. 1, ch. 12.

/// Estimates of the mean of one colour of a pixel, from its samples.
pub(super) struct PixelEstimate {
    /// x, the mean of the samples.
    pub value: f64,
    /// v, the estimated variance of the mean.
    pub variance: f64,
    /// Skewness ratio κ₃/v.
    pub skewness_ratio: f64,
    /// ν, the degrees of freedom of v.
    pub freedom: f64,
}

/// Value and variance about which the contribution of a pixel is expanded. They come from the neighbourhood, or from the pixel
/// itself where it differs from its neighbours.
pub(super) struct LocalReference {
    /// c, the value.
    pub value: f64,
    /// w, an estimate of σ² that is nearly independent of the pixel's own estimate v.
    pub variance: f64,
    /// Weight of the pixel's own value in c, from 0 to 1.
    pub own: f64,
}

/// Taylor expansion of 1/(r² + ε) about a local reference.
struct Expansion {
    /// 1/g = c² + ε
    below: f64,
    /// x − c
    away: f64,
    /// g′/g
    first: f64,
    /// g″/g
    second: f64,
    /// Factor from 0 to 1 of both derivatives: the series converges within √(c² + ε) of c, so it is faded out before. It depends on
    /// the variance around the pixel, and on the pixel's own only where that is its own reference: the corrections are right on average only
    /// if they count as much where the pixel's own variance came out large.
    reach: f64,
}

impl Expansion {
    fn new(pixel: &PixelEstimate, local: &LocalReference, floor: f64) -> Expansion {
        let c = local.value;
        let (below, away) = (c * c + floor, pixel.value - c);
        Expansion {
            below,
            away,
            first: -2.0 * c / below,
            second: (6.0 * c * c - 2.0 * floor) / (below * below),
            reach: (1.0 + (away * away + local.variance) / below).powi(-2),
        }
    }
}

/// Common part of brightness and noise of one colour of a pixel, v g′ (x − c): as it was found, and as the skewness ratio predicts it.
///
/// Where c contains x, both are smaller by the same factor.
pub(super) fn common_part(pixel: &PixelEstimate, local: &LocalReference, floor: f64) -> (f64, f64) {
    let Expansion { below, away, first, reach, .. } = Expansion::new(pixel, local, floor);
    let weight = pixel.variance / below * reach * first;
    (weight * away, weight * (1.0 - local.own) * pixel.skewness_ratio)
}

/// Estimated contribution of a pixel to relMSE. The mean over colours is a contribution too, since the errors of the colours move
/// together.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contribution {
    /// The estimate.
    pub value: f64,
    /// Variance of the difference between the estimate and the true contribution, divided by the estimate.
    pub variance_ratio: f64,
}

/// Variance of (x − r)² − v for symmetric noise, divided by σ⁴.
pub(super) fn residual_variance(freedom: f64) -> f64 {
    2.0 + 2.0 / freedom
}

/// Largest factor by which the expansion may change a contribution.
const FARTHEST: f64 = 4.0;

impl Contribution {
    /// Contribution of one colour of a pixel.
    ///
    /// - `floor`: ε
    pub fn new(pixel: &PixelEstimate, local: &LocalReference, floor: f64) -> Contribution {
        let (v, w, nu) = (pixel.variance, local.variance, pixel.freedom);
        let Expansion { below, away, first, second, reach } = Expansion::new(pixel, local, floor);
        let change = first * (away - pixel.skewness_ratio) + 0.5 * second * (away * away - v + 2.0 * w / nu);
        let factor = (1.0 + reach * change).clamp(1.0 / FARTHEST, FARTHEST);
        let slope = reach * first;
        let residual_variance = residual_variance(nu);
        let variance_ratio =
            residual_variance - 4.0 * (1.0 - 2.0 / nu) * slope * pixel.skewness_ratio + (1.0 + 2.0 / nu) * slope * slope * w;
        // The skewness is itself uncertain, so it may take away at most half of the variance.
        Contribution { value: v / below * factor, variance_ratio: w / below * variance_ratio.max(0.5 * residual_variance) }
    }

    /// Mean over the colours.
    pub fn mean(colors: [Contribution; 3]) -> Contribution {
        let mean = |f: fn(&Contribution) -> f64| colors.iter().map(f).sum::<f64>() / 3.0;
        Contribution { value: mean(|c| c.value), variance_ratio: mean(|c| c.variance_ratio) }
    }
}
