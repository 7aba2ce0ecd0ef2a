//! Polynomials in Bernstein form, whose coefficients enclose their values.

/// Polynomial Σ cₖ C(n, k) sᵏ (1 − s)ⁿ⁻ᵏ of degree n = N − 1 on [0, 1].
///
/// Its values lie between the least and the greatest coefficient, and it has at most as many zeros as its coefficients change their sign.
/// Both hold for each part of [0, 1], with the coefficients of the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bernstein<const N: usize>(pub [f64; N]);

/// Number of times that [0, 1] is halved: what happens within 2⁻⁴⁰ cannot be told apart from rounding.
const MOST_HALVINGS: u32 = 40;

impl<const N: usize> Bernstein<N> {
    /// The binomial coefficients C(n, k).
    const BINOMIALS: [f64; N] = binomials();

    /// Σ of products of polynomials whose degrees add up to that of the result.
    ///
    /// The coefficients of a product are cₖ = Σ C(m, i) C(n, k − i) / C(m + n, k) aᵢ bₖ₋ᵢ.
    ///
    /// # Panics
    /// In debug builds, if the degrees do not add up.
    pub fn sum_of_products<const A: usize, const B: usize, const M: usize>(products: [([f64; A], [f64; B]); M]) -> Bernstein<N> {
        debug_assert_eq!(A + B, N + 1, "the degrees of the factors add up to that of the product");
        let (of_a, of_b) = (Bernstein::<A>::BINOMIALS, Bernstein::<B>::BINOMIALS);
        let mut sum = [0.0; N];
        for (i, j) in (0..A).flat_map(|i| (0..B).map(move |j| (i, j))) {
            sum[i + j] += of_a[i] * of_b[j] * products.iter().map(|(a, b)| a[i] * b[j]).sum::<f64>();
        }
        Bernstein(std::array::from_fn(|k| sum[k] / Self::BINOMIALS[k]))
    }

    /// The value at `s`, by de Casteljau's algorithm.
    pub fn at(&self, s: f64) -> f64 {
        let mut c = self.0;
        for last in (0..N - 1).rev() {
            for k in 0..=last {
                c[k] = c[k] * (1.0 - s) + c[k + 1] * s;
            }
        }
        c[0]
    }

    /// Whether the value is below 0 everywhere, as far as the coefficients tell.
    pub fn is_negative(&self) -> bool {
        self.0.iter().all(|c| *c < 0.0)
    }

    /// The halves of the polynomial, each on [0, 1].
    fn halves(&self) -> [Bernstein<N>; 2] {
        let (mut c, mut first, mut second) = (self.0, [0.0; N], [0.0; N]);
        for last in (0..N).rev() {
            (first[N - 1 - last], second[last]) = (c[0], c[last]);
            for k in 0..last {
                c[k] = 0.5 * (c[k] + c[k + 1]);
            }
        }
        [Bernstein(first), Bernstein(second)]
    }

    /// The number of changes of the sign from one coefficient to the next. Zero counts as positive.
    fn sign_changes(&self) -> usize {
        self.0.windows(2).filter(|pair| (pair[0] < 0.0) != (pair[1] < 0.0)).count()
    }

    /// Calls `visit` with each place in (0, 1) where the sign changes, in rising order. Zero counts as positive. A pair of zeros that are
    /// closer together than 2⁻⁴⁰ may be left out.
    ///
    /// - `precision`: of the places
    pub fn crossings(&self, precision: f64, mut visit: impl FnMut(f64)) {
        self.crossings_within([0.0, 1.0], precision, MOST_HALVINGS, &mut visit);
    }

    fn crossings_within(&self, [from, to]: [f64; 2], precision: f64, halvings: u32, visit: &mut impl FnMut(f64)) {
        let changes = self.sign_changes();
        if changes == 0 {
            return;
        }
        let middle = 0.5 * (from + to);
        if changes == 1 || halvings == 0 {
            if (self.0[0] < 0.0) != (self.0[N - 1] < 0.0) {
                visit(from + (to - from) * zero(|s| self.at(s), [0.0, 1.0], precision / (to - from)));
            }
            return;
        }
        let [first, second] = self.halves();
        first.crossings_within([from, middle], precision, halvings - 1, visit);
        second.crossings_within([middle, to], precision, halvings - 1, visit);
    }
}

/// The binomial coefficients C(N − 1, k).
const fn binomials<const N: usize>() -> [f64; N] {
    let mut row = [1.0; N];
    let mut k = 1;
    while k < N {
        row[k] = row[k - 1] * (N - k) as f64 / k as f64;
        k += 1;
    }
    row
}

/// Zero of a function whose sign differs at the ends of an interval, by the Illinois variant of regula falsi, with bisection if that
/// converges slowly.
///
/// - `precision`: of the result
pub fn zero(value: impl Fn(f64) -> f64, [mut a, mut b]: [f64; 2], precision: f64) -> f64 {
    let (mut fa, mut fb) = (value(a), value(b));
    let mut kept = 0;
    for n in 0..100 {
        if fb == 0.0 || (b - a).abs() <= precision {
            break;
        }
        let guess = b - fb * (b - a) / (fb - fa);
        let is_between = guess > a.min(b) && guess < a.max(b);
        let middle = if n < 40 && is_between { guess } else { 0.5 * (a + b) };
        let f = value(middle);
        if (f < 0.0) == (fa < 0.0) {
            (a, fa) = (middle, f);
            kept = i32::max(kept, 0) + 1;
        } else {
            (b, fb) = (middle, f);
            kept = i32::min(kept, 0) - 1;
        }
        // Where the same end was kept twice, its value counts half, so that the next guess moves towards it.
        match kept {
            2.. => fb *= 0.5,
            ..=-2 => fa *= 0.5,
            _ => {}
        }
    }
    b
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// (s − z₁)(s − z₂)… in Bernstein form, of degree 6: each factor has the coefficients −z and 1 − z.
    fn with_zeros(zeros: [f64; 6]) -> Bernstein<7> {
        let factor = |z: f64| [-z, 1.0 - z];
        let two = |a, b| Bernstein::<3>::sum_of_products([(factor(a), factor(b))]).0;
        let four = Bernstein::<5>::sum_of_products([(two(zeros[0], zeros[1]), two(zeros[2], zeros[3]))]).0;
        Bernstein::sum_of_products([(four, two(zeros[4], zeros[5]))])
    }

    proptest! {
        /// A polynomial changes its sign at its zeros, and nowhere else. Zeros that are at least 10⁻² apart are found to 10⁻⁴: rounding moves
        /// a zero by some 10⁻¹⁵ divided by the product of its distances from five others.
        #[test]
        fn crossings_are_the_zeros(mut zeros in prop::array::uniform6(-0.5f64..1.5)) {
            zeros.sort_by(f64::total_cmp);
            let gaps = zeros.windows(2).map(|pair| pair[1] - pair[0]).chain(zeros.iter().flat_map(|z| [z.abs(), (z - 1.0).abs()]));
            prop_assume!(gaps.fold(1.0, f64::min) > 1e-2);
            let mut found = vec![];
            with_zeros(zeros).crossings(1e-12, |s| found.push(s));
            let expected: Vec<f64> = zeros.into_iter().filter(|z| (0.0..1.0).contains(z)).collect();
            prop_assert_eq!(found.len(), expected.len());
            for (a, b) in found.iter().zip(&expected) {
                prop_assert!((a - b).abs() < 1e-4, "{} {}", a, b);
            }
        }

        /// Products and halves have the values of what they are made of.
        #[test]
        fn products_and_halves_have_their_values(
            a in prop::array::uniform4(-1.0f64..1.0), b in prop::array::uniform4(-1.0f64..1.0), s in 0.0f64..1.0,
        ) {
            let product = Bernstein::<7>::sum_of_products([(a, b), (b, b)]);
            let expected = Bernstein(a).at(s) * Bernstein(b).at(s) + Bernstein(b).at(s).powi(2);
            prop_assert!((product.at(s) - expected).abs() < 1e-14);
            let [first, second] = product.halves();
            prop_assert!((first.at(s) - product.at(0.5 * s)).abs() < 1e-14 && (second.at(s) - product.at(0.5 + 0.5 * s)).abs() < 1e-14);
        }
    }
}
