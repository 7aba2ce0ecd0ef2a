//! Separable convolutions over one channel of a picture.

/// Odd number of weights; the one in the middle is for the pixel itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel(Vec<f64>);

/// Treatment of pixels beyond the border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Border {
    /// Pixels beyond the border have the value of the nearest pixel of the picture.
    Nearest,
    /// Pixels beyond the border are left out; the weights of the pixels within are scaled up.
    Renormalise,
}

impl Kernel {
    /// Kernel with the weights `f(−radius) … f(radius)`.
    pub fn new(radius: i32, f: impl Fn(f64) -> f64) -> Kernel {
        Kernel((-radius..=radius).map(|x| f(x.into())).collect())
    }

    /// Gaussian exp(−x²/2σ²), scaled so that the weights add up to 1.
    pub fn gaussian(radius: i32, sigma: f64) -> Kernel {
        Kernel::new(radius, |x| (-x * x / (2.0 * sigma * sigma)).exp()).normalised()
    }

    /// Scales positive weights to a sum of 1, and negative ones, if there are any, to a sum of −1.
    pub fn normalised(mut self) -> Kernel {
        let sum = |sign: f64| self.0.iter().filter(|w| **w * sign > 0.0).sum::<f64>().abs();
        let (positive, negative) = (sum(1.0), sum(-1.0));
        self.0.iter_mut().for_each(|w| *w /= if *w < 0.0 { negative } else { positive });
        self
    }

    fn radius(&self) -> usize {
        self.0.len() / 2
    }
}

/// Convolves the rows with `along`, then the columns with `down`.
///
/// - `values`: rows of `width` values
pub fn convolve(values: &[f64], width: usize, along: &Kernel, down: &Kernel, border: Border) -> Vec<f64> {
    let rows: Vec<f64> = values.chunks(width).flat_map(|row| line(row, along, border)).collect();
    let height = values.len() / width;
    let mut result = vec![0.0; values.len()];
    for x in 0..width {
        let column: Vec<f64> = rows.iter().skip(x).step_by(width).copied().collect();
        for (y, value) in (0..height).zip(line(&column, down, border)) {
            result[y * width + x] = value;
        }
    }
    result
}

fn line(values: &[f64], kernel: &Kernel, border: Border) -> impl Iterator<Item = f64> {
    let (radius, last) = (kernel.radius(), values.len() - 1);
    (0..values.len()).map(move |i| {
        // Tap k lies at i + k − radius.
        let taps = kernel.0.iter().enumerate().map(|(k, w)| (i + k, w));
        match border {
            Border::Nearest => taps.map(|(at, w)| w * values[at.saturating_sub(radius).min(last)]).sum(),
            Border::Renormalise => {
                let inside = taps.filter(|(at, _)| (radius..=last + radius).contains(at));
                let (sum, weights) = inside.fold((0.0, 0.0), |(sum, weights), (at, w)| (sum + w * values[at - radius], weights + w));
                sum / weights
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights 1, 2, 1 over 1, 5, 3 with the ends repeated and with the ends cut off.
    #[test]
    fn a_line_by_hand() {
        let kernel = Kernel::new(1, |x| 2.0 - x.abs()).normalised();
        let one = Kernel::new(0, |_| 1.0);
        let filtered = |border| convolve(&[1.0, 5.0, 3.0], 3, &kernel, &one, border);
        assert_eq!(filtered(Border::Nearest), [2.0, 3.5, 3.5]);
        assert_eq!(filtered(Border::Renormalise), [7.0 / 3.0, 3.5, 11.0 / 3.0]);
        // Down a column the result is the same as along a row.
        assert_eq!(convolve(&[1.0, 5.0, 3.0], 1, &one, &kernel, Border::Nearest), [2.0, 3.5, 3.5]);
    }

    #[test]
    fn signs_are_normalised_apart() {
        assert_eq!(Kernel::new(2, |x| -x).normalised(), Kernel(vec![2.0 / 3.0, 1.0 / 3.0, 0.0, -1.0 / 3.0, -2.0 / 3.0]));
        let narrow = Kernel::gaussian(5, 1.5);
        assert!((narrow.0.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    }
}
