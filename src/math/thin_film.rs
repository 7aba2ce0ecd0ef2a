//! Reflection at a film that is about as thin as a wavelength.

use std::ops::{Add, Div, Mul, Sub};

use super::{Wavelength, float};

/// Reflectance of a film on a base for unpolarised light of one wavelength.
///
/// r = (r₁ + r₂ e^{iφ}) / (1 + r₁ r₂ e^{iφ}),    φ = 4π q d / λ,    R = (|r_s|² + |r_p|²)/2
///
/// r₁ and r₂ are Fresnel's amplitudes at the front of the film and at the base. With q = √(n² − sin²θ) for each of the three media,
///
/// r_s = (q_a − q_b)/(q_a + q_b),    r_p = (n_b² q_a − n_a² q_b)/(n_b² q_a + n_a² q_b)
///
/// - `cos`: |cos θ| outside, where the index is 1; angles closer to grazing than a cosine of 10⁻⁶ count as that
/// - `thickness`: d (nm)
/// - `film`: n, the index of refraction of the film; less than 1 counts as 1
/// - `base`: real and imaginary part of the index η + ik of the base
///
/// Source: Born and Wolf, *Principles of Optics*, §1.6.4. Tests: row O14 of `pt torture`, clear_films_follow_airys_formula.
pub fn reflectance(wavelength: Wavelength, cos: f64, thickness: f64, film: f64, base: [f64; 2]) -> f64 {
    let (cos, film) = (cos.clamp(GRAZING, 1.0), film.max(1.0));
    let sin2 = 1.0 - cos * cos;
    let within = (film * film - sin2).sqrt();
    // The phase in turns. Whole turns do not count.
    let turns = 2.0 * within * thickness / f64::from(wavelength.nanometres());
    let (sin, cosine) = float::sin_cos_degrees(360.0 * (turns - turns.floor()));
    let phase = Complex([cosine, sin]);
    let squares = [Complex::real(1.0), Complex::real(film * film), Complex(base) * Complex(base)];
    let [outside, within, below] = [Complex::real(cos), Complex::real(within), (squares[2] - Complex::real(sin2)).sqrt()];
    let amplitude = |a: Complex, b: Complex| (a - b) / (a + b);
    let both = |first: Complex, second: Complex| {
        let second = second * phase;
        ((first + second) / (Complex::real(1.0) + first * second)).norm_squared()
    };
    let s = both(amplitude(outside, within), amplitude(within, below));
    let p = both(amplitude(squares[1] * outside, squares[0] * within), amplitude(squares[2] * within, squares[1] * below));
    (0.5 * (s + p)).clamp(0.0, 1.0)
}

/// The least cosine. At grazing incidence a film with the index of the outside, 1, would have the reflectance 0/0.
const GRAZING: f64 = 1e-6;

/// A complex number: its real and its imaginary part.
#[derive(Clone, Copy)]
struct Complex([f64; 2]);

impl Complex {
    fn real(x: f64) -> Complex {
        Complex([x, 0.0])
    }

    fn norm_squared(self) -> f64 {
        let Complex([re, im]) = self;
        re * re + im * im
    }

    /// The root with a real and an imaginary part that are not negative, for numbers whose imaginary part is not.
    fn sqrt(self) -> Complex {
        let Complex([re, im]) = self;
        let norm = self.norm_squared().sqrt();
        // The larger part is computed without cancellation, and the other from the product.
        let larger = (0.5 * (norm + re.abs())).sqrt();
        let smaller = if larger == 0.0 { 0.0 } else { 0.5 * im / larger };
        if re >= 0.0 { Complex([larger, smaller]) } else { Complex([smaller, larger]) }
    }
}

impl Add for Complex {
    type Output = Complex;
    fn add(self, other: Complex) -> Complex {
        Complex([self.0[0] + other.0[0], self.0[1] + other.0[1]])
    }
}

impl Sub for Complex {
    type Output = Complex;
    fn sub(self, other: Complex) -> Complex {
        Complex([self.0[0] - other.0[0], self.0[1] - other.0[1]])
    }
}

impl Mul for Complex {
    type Output = Complex;
    fn mul(self, other: Complex) -> Complex {
        let (Complex([a, b]), Complex([c, d])) = (self, other);
        Complex([a * c - b * d, a * d + b * c])
    }
}

impl Div for Complex {
    type Output = Complex;
    fn div(self, other: Complex) -> Complex {
        let (Complex([a, b]), Complex([c, d])) = (self, other);
        let square = other.norm_squared();
        Complex([(a * c + b * d) / square, (b * c - a * d) / square])
    }
}
