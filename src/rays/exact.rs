//! Signs of determinants of `f64` coordinates, as exact arithmetic has them.
//!
//! A determinant is first computed in `f64` with a bound of its rounding error. Where that does not tell the sign, it is computed
//! again with expansions: sums of `f64` that do not overlap, which hold all digits.
//!
//! Source: Shewchuk, *Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates* (1997).

use std::cmp::Ordering;

use glam::DVec3;

/// Sum of `f64` that do not overlap, the smallest first, without zeros.
#[derive(Clone, Debug, Default)]
struct Expansion(Vec<f64>);

impl Expansion {
    /// a − b, exactly.
    fn difference(a: f64, b: f64) -> Expansion {
        Expansion::default().plus(a).plus(-b)
    }

    fn plus(self, x: f64) -> Expansion {
        let mut sum = x;
        let mut terms = Vec::with_capacity(self.0.len() + 1);
        for term in self.0 {
            let (rounded, error) = two_sum(sum, term);
            terms.extend((error != 0.0).then_some(error));
            sum = rounded;
        }
        terms.extend((sum != 0.0).then_some(sum));
        Expansion(terms)
    }

    fn plus_all(self, other: &Expansion) -> Expansion {
        other.0.iter().fold(self, |sum, &term| sum.plus(term))
    }

    fn times(&self, other: &Expansion) -> Expansion {
        let pairs = self.0.iter().flat_map(|a| other.0.iter().map(move |b| (*a, *b)));
        pairs.fold(Expansion::default(), |sum, (a, b)| {
            let product = a * b;
            // Fused, and so the exact error on every machine.
            sum.plus(a.mul_add(b, -product)).plus(product)
        })
    }

    fn minus(self, other: &Expansion) -> Expansion {
        other.0.iter().fold(self, |sum, &term| sum.plus(-term))
    }

    /// The sign is that of the largest term.
    fn sign(&self) -> Ordering {
        self.0.last().map_or(Ordering::Equal, |largest| largest.total_cmp(&0.0))
    }
}

/// a + b rounded, and the error of the rounding.
///
/// Source: Knuth, *The Art of Computer Programming*, vol. 2, 4.2.2.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let (of_b, of_a) = (sum - a, sum - (sum - a));
    (sum, (a - of_a) + (b - of_b))
}

/// A vector whose components are expansions.
type Exact = [Expansion; 3];

fn difference(a: DVec3, b: DVec3) -> Exact {
    std::array::from_fn(|i| Expansion::difference(a[i], b[i]))
}

/// Component `i` of a cross product.
fn cross(a: &Exact, b: &Exact, i: usize) -> Expansion {
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    a[j].times(&b[k]).minus(&a[k].times(&b[j]))
}

fn determinant(a: &Exact, b: &Exact, c: &Exact) -> Expansion {
    (0..3).fold(Expansion::default(), |sum, i| sum.plus_all(&a[i].times(&cross(b, c, i))))
}

/// Determinant of three vectors that each carry at most one rounding, and its sign if it exceeds its rounding error.
fn rounded(a: DVec3, b: DVec3, c: DVec3) -> Option<Ordering> {
    let value = a.dot(b.cross(c));
    let (a, b, c) = (a.abs(), b.abs(), c.abs());
    let magnitude = a.x * (b.y * c.z + b.z * c.y) + a.y * (b.z * c.x + b.x * c.z) + a.z * (b.x * c.y + b.y * c.x);
    // Nine roundings of 2⁻⁵³ on the way of each product, and those of the bound itself.
    let error = 6.0 * f64::EPSILON * magnitude;
    // The comparisons are false also for NaN.
    (value > error).then_some(Ordering::Greater).or((value < -error).then_some(Ordering::Less))
}

/// On which side of the edge from `p` to `q` a ray passes: the sign of the determinant of its direction and the vectors from its origin to
/// the corners. Where it is 0, the direction is turned towards +x, then +y, then +z by an infinitely small angle.
///
/// `Equal` if the origin lies on the line through the corners.
pub fn side(origin: DVec3, direction: DVec3, p: DVec3, q: DVec3) -> Ordering {
    if let Some(sign) = rounded(direction, p - origin, q - origin) {
        return sign;
    }
    let (to_p, to_q) = (difference(p, origin), difference(q, origin));
    let along = direction.to_array().map(|x| Expansion::default().plus(x));
    let turned = (0..3).map(|i| cross(&to_p, &to_q, i).sign());
    std::iter::once(determinant(&along, &to_p, &to_q).sign()).chain(turned).find(|sign| *sign != Ordering::Equal).unwrap_or(Ordering::Equal)
}

/// On which side of a triangle's plane a point lies: the sign of the determinant of the vectors to its corners, `Greater` behind it.
pub fn height(point: DVec3, [a, b, c]: [DVec3; 3]) -> Ordering {
    rounded(a - point, b - point, c - point)
        .unwrap_or_else(|| determinant(&difference(a, point), &difference(b, point), &difference(c, point)).sign())
}
