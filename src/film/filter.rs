//! Reconstruction filters, by importance sampling: a sample is moved, not spread.
//!
//! Instead of weighting samples around a pixel by f, one is drawn at a distance x from the pixel's
//! middle with density |f|/∫|f| and counts with weight f/(p ∫f): each sample touches one pixel only,
//! so that pixels are independent and error bars mean something.
//!
//! Source: Ernst, Stamminger, Greiner, *Filter Importance Sampling* (2006).

use glam::Vec2;

use crate::math::float;

/// A separable filter f(x)·f(y).
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Box { radius: f32 },
    Tent { radius: f32 },
    Table(Table),
}

impl Default for Filter {
    fn default() -> Filter {
        Filter::pixel_box(0.5)
    }
}

impl Filter {
    /// f = 1 for |x| ≤ r; r = ½ is the pixel itself.
    pub fn pixel_box(radius: f32) -> Filter {
        Filter { kind: Kind::Box { radius } }
    }

    /// f = 1 − |x|/r
    pub fn tent(radius: f32) -> Filter {
        Filter { kind: Kind::Tent { radius } }
    }

    /// f = exp(−x²/2σ²) − exp(−r²/2σ²), which ends at 0.
    ///
    /// Computed as exp(−x²/2σ²)·(1 − exp(−(r² − x²)/2σ²)): where σ ≫ r the difference would be lost.
    pub fn gaussian(radius: f32, sigma: f32) -> Filter {
        let (radius_squared, twice_variance) = ((radius as f64).powi(2), 2.0 * (sigma as f64).powi(2));
        let f = move |x: f64| float::exp_f64(-x * x / twice_variance) * -float::exp_m1_f64((x * x - radius_squared) / twice_variance);
        Filter { kind: Kind::Table(Table::new(radius, f)) }
    }

    /// Mitchell and Netravali's cubic, stretched to the given radius; it has negative lobes.
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
        Filter { kind: Kind::Table(Table::new(radius, f)) }
    }

    /// Whether it is nowhere negative.
    pub fn is_positive(&self) -> bool {
        match &self.kind {
            Kind::Box { .. } | Kind::Tent { .. } => true,
            Kind::Table(table) => table.value.iter().all(|value| *value >= 0.0),
        }
    }

    /// An offset from the pixel's middle (pixels), and the weight of what is found there.
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        match &self.kind {
            Kind::Box { radius } => ((2.0 * u - 1.0) * *radius, 1.0),
            Kind::Tent { radius } => (Vec2::new(tent(u.x), tent(u.y)) * *radius, 1.0),
            Kind::Table(table) => {
                let ((x, wx), (y, wy)) = (table.sample(u.x), table.sample(u.y));
                (Vec2::new(x, y), wx * wy)
            }
        }
    }
}

/// Distributed as 1 − |x|.
fn tent(u: f32) -> f32 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() }
}

const CELLS: usize = 128;

/// A piecewise constant density proportional to |f|, f kept beside it for the weight.
#[derive(Clone, Debug, PartialEq)]
struct Table {
    radius: f32,
    /// Cumulative, from 0 to 1 over the cells.
    cdf: Vec<f64>,
    /// f at the borders of the cells, over ∫f.
    value: Vec<f64>,
}

impl Table {
    fn new(radius: f32, f: impl Fn(f64) -> f64) -> Table {
        let width = 2.0 * radius as f64 / CELLS as f64;
        let at = |k: usize| f(k as f64 * width - radius as f64);
        let value: Vec<f64> = (0..=CELLS).map(at).collect();
        let cell = |k: usize| 0.5 * (value[k].abs() + value[k + 1].abs()) * width;
        let absolute: f64 = (0..CELLS).map(cell).sum();
        let signed: f64 = (0..CELLS).map(|k| 0.5 * (value[k] + value[k + 1]) * width).sum();
        let mut cdf = vec![0.0];
        for k in 0..CELLS {
            cdf.push(cdf[k] + cell(k) / absolute);
        }
        Table { radius, cdf, value: value.into_iter().map(|v| v / signed).collect() }
    }

    /// The filter itself is the broken line through the table, so that this sampling is exact for it.
    fn sample(&self, u: f32) -> (f32, f32) {
        let u = u as f64;
        let k = self.cdf.partition_point(|&c| c <= u).clamp(1, CELLS) - 1;
        let share = self.cdf[k + 1] - self.cdf[k];
        let inside = ((u - self.cdf[k]) / share).clamp(0.0, float::ONE_MINUS_EPSILON as f64);
        let width = 2.0 * self.radius as f64 / CELLS as f64;
        let value = self.value[k] * (1.0 - inside) + self.value[k + 1] * inside;
        let x = (k as f64 + inside) * width - self.radius as f64;
        (x as f32, (value * width / share) as f32)
    }
}
