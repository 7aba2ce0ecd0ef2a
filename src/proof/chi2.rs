//! Pearson's χ² test of counts against expectations.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Statistic, p-value, and the largest deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chi2 {
    /// Σ (o − e)²/e
    pub statistic: f64,
    /// Degrees of freedom: the number of cells less one, as the total is given.
    pub freedom: usize,
    /// Probability of a statistic at least this large if the expectations are right.
    pub p: f64,
    /// Bin with the largest deviation, in the cell with the largest term.
    pub worst: usize,
}

/// Smallest expected count of a cell; with fewer the statistic does not follow χ².
const FEWEST: f64 = 5.0;

/// X² = Σ (o − e)²/e over the bins; bins with an expectation below 5 are pooled. X² ~ χ² with one degree of freedom less than there
/// are cells.
///
/// - `shares`: expected share of each bin, up to a common factor
/// - `counts`: counts of independent draws
/// - returns p = 1 if fewer than two cells remain, as the test then tells nothing
///
/// Source: Pearson (1900), Cochran, *Some Methods for Strengthening the Common χ² Tests* (1954), for the pooling.
/// Tests: by hand, p uniform under the null hypothesis.
pub fn chi2(shares: &[f64], counts: &[u64]) -> Chi2 {
    let total: u64 = counts.iter().sum();
    let scale = total as f64 / shares.iter().sum::<f64>();
    let expected = |i: usize| shares[i] * scale;
    let mut order: Vec<usize> = (0..shares.len()).collect();
    order.sort_by(|&i, &j| shares[i].total_cmp(&shares[j]));
    let (mut statistic, mut cells, mut worst) = (0.0, 0usize, (f64::NEG_INFINITY, 0));
    let off = |i: usize| (counts[i] as f64 - expected(i)).abs();
    let (mut pool, mut first) = ((0.0, 0.0), 0);
    for (rank, &i) in order.iter().enumerate() {
        pool = (pool.0 + expected(i), pool.1 + counts[i] as f64);
        // The rest at the end is a cell in any case: it contains the largest bin.
        if pool.0 < FEWEST && rank + 1 < order.len() {
            continue;
        }
        let term = (pool.1 - pool.0).powi(2) / pool.0;
        if term > worst.0 {
            let farthest = order[first..=rank].iter().copied().max_by(|&i, &j| off(i).total_cmp(&off(j)));
            worst = (term, farthest.unwrap_or(i));
        }
        statistic += term;
        cells += 1;
        (pool, first) = ((0.0, 0.0), rank + 1);
    }
    let freedom = cells.saturating_sub(1);
    let p = match ChiSquared::new(freedom as f64) {
        _ if total == 0 || freedom == 0 => 1.0,
        Ok(distribution) if statistic.is_finite() => distribution.sf(statistic),
        _ => 0.0,
    };
    Chi2 { statistic, freedom, p, worst: worst.1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected 20, 30, 50 and found 25, 25, 50: 25/20 + 25/30 = 2.0833 with 2 degrees of freedom, p = e^(−X²/2).
    #[test]
    fn by_hand() {
        let found = chi2(&[0.2, 0.3, 0.5], &[25, 25, 50]);
        assert_eq!((found.freedom, found.worst), (2, 0));
        assert!((found.statistic - (1.25 + 25.0 / 30.0)).abs() < 1e-12);
        assert!((found.p - (-0.5 * found.statistic).exp()).abs() < 1e-9);
    }

    /// 1, 2 and 3 are pooled to a cell of 6; 94 is another cell.
    #[test]
    fn sparse_bins_are_pooled() {
        let found = chi2(&[0.94, 0.01, 0.02, 0.03], &[94, 6, 0, 0]);
        assert_eq!((found.freedom, found.statistic), (1, 0.0));
        assert_eq!(chi2(&[1.0, 0.0], &[100, 0]).p, 1.0);
        assert_eq!(chi2(&[1.0], &[0]).p, 1.0);
    }
}
