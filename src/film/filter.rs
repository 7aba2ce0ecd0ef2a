//! Reconstruction filters by filter importance sampling.
//!
//! Instead of weighting samples around a pixel by f, a sample is drawn at a distance x from the pixel's centre with density
//! |f|/∫|f| and has the weight ±∫|f|/∫f. Each sample contributes to one pixel only, so that pixels are independent and their standard
//! errors are valid. The weight of a filter without negative lobes is exactly 1, and a constant picture stays constant.
//!
//! Source: Ernst, Stamminger, Greiner, *Filter Importance Sampling* (2006).

use glam::Vec2;

use crate::math::float;

/// Separable reconstruction filter f(x)·f(y).
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Box { radius: f32 },
    Tent { radius: f32 },
    Curve(Curve),
}

impl Default for Filter {
    fn default() -> Filter {
        Filter::pixel_box(0.5)
    }
}

impl Filter {
    /// Box filter f = 1 for |x| ≤ r; r = ½ is the pixel itself.
    pub fn pixel_box(radius: f32) -> Filter {
        Filter { kind: Kind::Box { radius } }
    }

    /// Tent filter f = 1 − |x|/r.
    pub fn tent(radius: f32) -> Filter {
        Filter { kind: Kind::Tent { radius } }
    }

    /// Gaussian filter f = exp(−x²/2σ²) − exp(−r²/2σ²), which is 0 at r.
    ///
    /// The value is computed as exp(−x²/2σ²)·(1 − exp(−(r² − x²)/2σ²)), because the difference would lose its digits for σ ≫ r.
    pub fn gaussian(radius: f32, sigma: f32) -> Filter {
        let (radius_squared, twice_variance) = ((radius as f64).powi(2), 2.0 * (sigma as f64).powi(2));
        let f = move |x: f64| float::exp_f64(-x * x / twice_variance) * -float::exp_m1_f64((x * x - radius_squared) / twice_variance);
        // Only 10⁻¹⁸ of the integral lies beyond 9 σ.
        let end = (radius as f64).min(9.0 * sigma as f64);
        let borders: Vec<f64> = (0..=GAUSSIAN_PIECES).map(|k| end * k as f64 / GAUSSIAN_PIECES as f64).collect();
        Filter { kind: Kind::Curve(Curve::new(&borders, f)) }
    }

    /// Mitchell and Netravali's cubic filter, stretched to the given radius. It has negative lobes unless c = 0.
    ///
    /// For 1 ≤ x ≤ 2, f = (2 − x)² (2b + 6c − (b + 6c) x)/6, whose only change of sign is at x = 1 + b/(b + 6c).
    ///
    /// Source: *Reconstruction Filters in Computer Graphics* (1988).
    pub fn mitchell(radius: f32, b: f32, c: f32) -> Filter {
        let (b, c) = (b as f64, c as f64);
        let f = move |x: f64| {
            let x = (2.0 * x / radius as f64).abs();
            if x < 1.0 {
                ((12.0 - 9.0 * b - 6.0 * c) * x * x * x + (-18.0 + 12.0 * b + 6.0 * c) * x * x + (6.0 - 2.0 * b)) / 6.0
            } else {
                let cubic = (-b - 6.0 * c) * x * x * x + (6.0 * b + 30.0 * c) * x * x;
                (cubic + (-12.0 * b - 48.0 * c) * x + (8.0 * b + 24.0 * c)) / 6.0
            }
        };
        let root = if b > 0.0 { 1.0 + b / (b + 6.0 * c) } else { 1.0 };
        Filter { kind: Kind::Curve(Curve::new(&[0.0, 1.0, root, 2.0].map(|x| 0.5 * radius as f64 * x), f)) }
    }

    /// Whether the filter is nowhere negative.
    pub fn is_positive(&self) -> bool {
        match &self.kind {
            Kind::Box { .. } | Kind::Tent { .. } => true,
            Kind::Curve(curve) => curve.pieces.iter().all(|piece| piece.sign > 0.0),
        }
    }

    /// Radius of a box filter; `None` for other filters.
    pub(crate) fn box_radius(&self) -> Option<f32> {
        match self.kind {
            Kind::Box { radius } => Some(radius),
            _ => None,
        }
    }

    /// Distance from the pixel's centre, along x or y, beyond which the filter is 0 (pixels).
    pub fn radius(&self) -> f32 {
        match &self.kind {
            Kind::Box { radius } | Kind::Tent { radius } => *radius,
            Kind::Curve(curve) => curve.pieces.last().map_or(0.0, |piece| (piece.start + piece.width) as f32),
        }
    }

    /// Value of the filter, whose integral is 1, at an offset from the pixel's centre (pixels): the weight of light that arrives
    /// there from elsewhere than the pixel's own samples.
    ///
    /// Tests: the_filter_is_the_density_of_its_samples.
    pub fn eval(&self, offset: Vec2) -> f64 {
        let [x, y] = offset.to_array().map(f64::from);
        match &self.kind {
            Kind::Box { radius } => box_value(x, f64::from(*radius)) * box_value(y, f64::from(*radius)),
            Kind::Tent { radius } => tent_value(x, f64::from(*radius)) * tent_value(y, f64::from(*radius)),
            Kind::Curve(curve) => curve.value(x) * curve.value(y),
        }
    }

    /// Samples an offset from the pixel's centre (pixels), and returns it with the weight of a sample there.
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        match &self.kind {
            Kind::Box { radius } => ((2.0 * u - 1.0) * *radius, 1.0),
            Kind::Tent { radius } => (Vec2::new(tent(u.x), tent(u.y)) * *radius, 1.0),
            Kind::Curve(curve) => {
                let ((x, wx), (y, wy)) = (curve.sample(u.x), curve.sample(u.y));
                (Vec2::new(x, y), wx * wy)
            }
        }
    }
}

/// Samples the density 1 − |x|.
fn tent(u: f32) -> f32 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() }
}

/// Density of the samples of a box filter. The upper end belongs to the next pixel.
fn box_value(x: f64, radius: f64) -> f64 {
    if x >= -radius && x < radius { 0.5 / radius } else { 0.0 }
}

/// Density of the samples of a tent filter.
fn tent_value(x: f64, radius: f64) -> f64 {
    (1.0 - x.abs() / radius).max(0.0) / radius
}

/// Number of intervals that approximate a Gaussian. Cubics through four values on each interval have an error of at most 5·10⁻⁸ of
/// the Gaussian's height, for any σ.
const GAUSSIAN_PIECES: usize = 128;

/// Even filter as cubics on intervals from 0 to its radius.
#[derive(Clone, Debug, PartialEq)]
struct Curve {
    pieces: Vec<Piece>,
    /// Ratio ∫|f| / ∫f, exactly 1 if f is nowhere negative.
    weight: f64,
    /// Integral ∫f over both sides of 0.
    integral: f64,
}

/// Approximation of |f| on an interval where f keeps its sign.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    start: f64,
    width: f64,
    /// Coefficients of |f| = c₀ + c₁ t + c₂ t² + c₃ t³, from t = 0 at the start to t = 1 at the end.
    cubic: [f64; 4],
    /// Integral ∫|f| dt over the interval.
    size: f64,
    /// Fractions of the whole ∫|f|: on all pieces nearer to 0, and on this piece.
    shares: [f64; 2],
    sign: f64,
}

impl Curve {
    /// Approximates f on the intervals between `borders`, which start at 0. The sign of f must not change within an interval.
    fn new(borders: &[f64], f: impl Fn(f64) -> f64) -> Curve {
        let pieces = borders.windows(2).map(|ends| Piece::new(ends[0], ends[1], &f));
        let mut pieces: Vec<Piece> = pieces.filter(|piece| piece.width * piece.size > 0.0).collect();
        let size = |piece: &Piece| piece.width * piece.size;
        let total: f64 = pieces.iter().map(size).sum();
        let signed: f64 = pieces.iter().map(|piece| piece.sign * size(piece)).sum();
        let mut nearer = 0.0;
        for piece in &mut pieces {
            piece.shares = [nearer / total, size(piece) / total];
            nearer += size(piece);
        }
        Curve { pieces, weight: total / signed, integral: 2.0 * signed }
    }

    /// Value f(x) / ∫f.
    fn value(&self, x: f64) -> f64 {
        let x = x.abs();
        let k = self.pieces.partition_point(|piece| piece.start <= x).max(1) - 1;
        let Some(piece) = self.pieces.get(k) else { return 0.0 };
        let t = (x - piece.start) / piece.width;
        let [a, b, c, d] = piece.cubic;
        if (0.0..1.0).contains(&t) { piece.sign * (a + t * (b + t * (c + t * d))) / self.integral } else { 0.0 }
    }

    /// Samples a signed distance with density |f|/∫|f| by inversion, and returns it with the weight of a sample there.
    fn sample(&self, u: f32) -> (f32, f32) {
        let signed = 2.0 * f64::from(u) - 1.0;
        let k = self.pieces.partition_point(|piece| piece.shares[0] <= signed.abs()).max(1) - 1;
        let piece = &self.pieces[k];
        let t = piece.inverse((signed.abs() - piece.shares[0]) / piece.shares[1]);
        ((piece.start + piece.width * t).copysign(signed) as f32, (piece.sign * self.weight) as f32)
    }
}

impl Piece {
    /// Cubic that interpolates f at both ends and at the thirds between them. It equals f if f is a cubic.
    fn new(start: f64, end: f64, f: impl Fn(f64) -> f64) -> Piece {
        let width = end - start;
        let [a, b, c, d] = [f(start), f(start + width / 3.0), f(start + width * (2.0 / 3.0)), f(end)];
        let sign = 1f64.copysign(a + 3.0 * b + 3.0 * c + d);
        let [a, b, c, d] = [a, b, c, d].map(|value| sign * value);
        let linear = 0.5 * (-11.0 * a + 18.0 * b - 9.0 * c + 2.0 * d);
        let cubic = [a, linear, 4.5 * (2.0 * a - 5.0 * b + 4.0 * c - d), 4.5 * (-a + 3.0 * b - 3.0 * c + d)];
        Piece { start, width, cubic, size: (a + 3.0 * b + 3.0 * c + d) / 8.0, shares: [0.0; 2], sign }
    }

    /// The t below which the fraction `q` of the piece's integral lies, by Newton's method with bisection where a step leaves the
    /// bracket.
    fn inverse(&self, q: f64) -> f64 {
        let [a, b, c, d] = self.cubic;
        let (mut low, mut high, mut t) = (0.0, 1.0, q.clamp(0.0, 1.0));
        for _ in 0..MAX_STEPS {
            let excess = t * (a + t * (b / 2.0 + t * (c / 3.0 + t * (d / 4.0)))) - q * self.size;
            if excess < 0.0 {
                low = t
            } else {
                high = t
            }
            let next = t - excess / (a + t * (b + t * (c + t * d)));
            let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
            let has_converged = (next - t).abs() <= PRECISION;
            t = next;
            if has_converged {
                break;
            }
        }
        t
    }
}

/// Precision of t, below the rounding of a distance in f32.
const PRECISION: f64 = 1e-9;
/// Greatest number of iterations. Newton's method takes 2 to 5, and bisection down to [`PRECISION`] takes 30.
const MAX_STEPS: u32 = 32;
