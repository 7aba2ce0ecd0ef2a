//! Shares with their confidence intervals.

use statrs::distribution::{Binomial, DiscreteCDF};

/// Number of times that something held.
#[derive(Clone, Copy, Default)]
pub struct Share {
    pub held: u32,
    pub of: u32,
}

impl Share {
    /// Counts one more case.
    pub fn count(&mut self, holds: bool) {
        self.held += u32::from(holds);
        self.of += 1;
    }

    pub fn add(&mut self, other: Share) {
        self.held += other.held;
        self.of += other.of;
    }

    /// Share in per cent with Wilson's 95 % confidence interval: `95.3 % (94.4–96.1)`.
    pub fn percent(self) -> String {
        let (n, p, z) = (f64::from(self.of), f64::from(self.held) / f64::from(self.of), 1.96);
        let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
        let reach = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        let [p, low, high] = [p, middle - reach, middle + reach].map(|share| 100.0 * share);
        format!("{p:.1} % ({low:.1}–{high:.1})")
    }
}

/// Probability that so many of `of` cases fail by chance, or more, if each of them fails with a probability of 5 %.
pub fn chance_of_failures(failures: u32, of: u32) -> f64 {
    let binomial = Binomial::new(0.05, of.into()).expect("a probability");
    if failures == 0 { 1.0 } else { binomial.sf(u64::from(failures) - 1) }
}

/// Writes `38 of 40`.
impl std::fmt::Display for Share {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{} of {}", self.held, self.of)
    }
}

/// Median of some numbers; NaN without any.
pub fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    if numbers.is_empty() { f64::NAN } else { numbers[numbers.len() / 2] }
}
