//! Metals by name: published indices of refraction, reduced to red, green and blue.
//!
//! For each coefficient c of linear Rec. 709, with the CIE 1931 standard observer x̄ȳz̄ and the illuminant D65,
//!
//! R_c = ∫ w_c(λ) R(λ) dλ / ∫ w_c(λ) dλ,    R = ((n − 1)² + k²) / ((n + 1)² + k²),    w_c = (XYZ → Rec. 709)_c · x̄ȳz̄(λ) · D65(λ)
//!
//! is the coefficient of the metal's colour under white light, at normal incidence. The index with this reflectance is found from n̄
//! and k̄, the means of n and k over the positive part of w_c. Where n̄ < 1 (noble metals), k is k̄ and n is solved for R_c;
//! otherwise n is n̄ and k is solved for. Every coefficient of these metals is within 0.05 % of the integral with the observer and D65
//! at every nanometre from 380 to 780, and within 1 % (tested) of that for another observer, with one exception. Gold is redder than
//! Rec. 709 can show, with R_red = 1.038. No coefficient may be larger than the greatest R(λ), here 0.971, which is 6.4 % less.
//!
//! Published indices: Ag, Au, Cu: Johnson and Christy, *Optical constants of the noble metals*, Phys. Rev. B 6 (1972);
//! Cr, Fe, Ni, Ti: Johnson and Christy, *Optical constants of transition metals*, Phys. Rev. B 9 (1974); Al: Rakić, *Algorithm for
//! the determination of intrinsic optical constants of metal films*, Appl. Opt. 34 (1995); W: Weaver, Olson, Lynch, *Optical
//! properties of crystalline tungsten*, Phys. Rev. B 12 (1975). Room temperature, clean surfaces.
//! Observer and illuminant: CIE 15 (2004). Tests: metals_have_the_colour_of_their_spectrum.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::math::Rgb;
use crate::math::colorimetry::{D65, FIRST, OBSERVER, STEP, TO_REC_709};

/// A metal, by its chemical symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub enum Element {
    /// Silver.
    Ag,
    /// Aluminium.
    Al,
    /// Gold.
    Au,
    /// Chromium.
    Cr,
    /// Copper.
    Cu,
    /// Iron.
    Fe,
    /// Nickel.
    Ni,
    /// Titanium.
    Ti,
    /// Tungsten.
    W,
}

/// A wavelength (nm), n and k.
pub type Measured = (f64, f64, f64);

impl Element {
    /// All metals, in alphabetical order of their symbols.
    pub const ALL: [Element; 9] =
        [Element::Ag, Element::Al, Element::Au, Element::Cr, Element::Cu, Element::Fe, Element::Ni, Element::Ti, Element::W];

    /// η and k of the complex index, for red, green and blue.
    pub fn index(self) -> (Rgb, Rgb) {
        let [red, green, blue] = TO_REC_709.map(|row| self.reduced(row));
        let spectrum = |of: fn((f64, f64)) -> f64| Rgb::new(of(red) as f32, of(green) as f32, of(blue) as f32);
        (spectrum(|(n, _)| n), spectrum(|(_, k)| k))
    }

    /// n and k of one of red, green and blue, by its row of the matrix from CIE XYZ.
    fn reduced(self, row: [f64; 3]) -> (f64, f64) {
        let weight = |(i, observer): (usize, &[f64; 3])| D65[i] * (0..3).map(|j| row[j] * observer[j]).sum::<f64>();
        let at = |i: usize| self.at(FIRST + STEP * i as f64);
        let mean = |part: fn(f64) -> f64, value: &dyn Fn((f64, f64)) -> f64| {
            let (mut sum, mut total) = (0.0, 0.0);
            for (i, observer) in OBSERVER.iter().enumerate() {
                let weight = part(weight((i, observer)));
                (sum, total) = (sum + weight * value(at(i)), total + weight);
            }
            sum / total
        };
        let greatest = (0..OBSERVER.len()).map(|i| reflectance(at(i))).fold(0.0, f64::max);
        let r = mean(|w| w, &reflectance).min(greatest);
        let (n, k) = (mean(|w| w.max(0.0), &|(n, _)| n), mean(|w| w.max(0.0), &|(_, k)| k));
        if n < 1.0 {
            let half = (1.0 + r) / (1.0 - r);
            (half - (half * half - 1.0 - k * k).max(0.0).sqrt(), k)
        } else {
            (n, ((r * (n + 1.0) * (n + 1.0) - (n - 1.0) * (n - 1.0)) / (1.0 - r)).max(0.0).sqrt())
        }
    }

    /// n and k at a wavelength (nm), interpolated linearly between the published ones.
    fn at(self, wavelength: f64) -> (f64, f64) {
        let table = self.published();
        let above = table.partition_point(|(w, ..)| *w < wavelength).clamp(1, table.len() - 1);
        let ((w0, n0, k0), (w1, n1, k1)) = (table[above - 1], table[above]);
        let part = ((wavelength - w0) / (w1 - w0)).clamp(0.0, 1.0);
        (n0 + (n1 - n0) * part, k0 + (k1 - k0) * part)
    }

    /// The published measurements in the visible range, by wavelength.
    #[allow(clippy::approx_constant, reason = "chromium's k of 3.14 at 451 nm is not π")]
    pub const fn published(self) -> &'static [Measured] {
        match self {
            Element::Ag => &[
                (381.5, 0.05, 1.864),
                (397.4, 0.05, 2.070),
                (413.3, 0.05, 2.275),
                (430.5, 0.04, 2.462),
                (450.9, 0.04, 2.657),
                (471.4, 0.05, 2.869),
                (495.9, 0.05, 3.093),
                (520.9, 0.05, 3.324),
                (548.6, 0.06, 3.586),
                (582.1, 0.05, 3.858),
                (616.8, 0.06, 4.152),
                (659.5, 0.05, 4.483),
                (704.5, 0.04, 4.838),
            ],
            Element::Al => &[
                (364.66, 0.39877, 4.3957),
                (413.28, 0.52135, 5.0008),
                (442.80, 0.60790, 5.3676),
                (476.87, 0.72780, 5.7781),
                (516.60, 0.87340, 6.2418),
                (563.57, 1.0728, 6.7839),
                (619.93, 1.3660, 7.4052),
                (652.25, 1.5724, 7.7354),
                (688.81, 1.8301, 8.0601),
                (729.32, 2.1606, 8.3565),
            ],
            Element::Au => &[
                (381.5, 1.46, 1.933),
                (397.4, 1.47, 1.952),
                (413.3, 1.46, 1.958),
                (430.5, 1.45, 1.948),
                (450.9, 1.38, 1.914),
                (471.4, 1.31, 1.849),
                (495.9, 1.04, 1.833),
                (520.9, 0.62, 2.081),
                (548.6, 0.43, 2.455),
                (582.1, 0.29, 2.863),
                (616.8, 0.21, 3.272),
                (659.5, 0.14, 3.697),
                (704.5, 0.13, 4.103),
            ],
            Element::Cr => &[
                (381.0, 1.92, 2.74),
                (397.0, 2.00, 2.83),
                (413.0, 2.08, 2.93),
                (431.0, 2.19, 3.04),
                (451.0, 2.33, 3.14),
                (471.0, 2.51, 3.24),
                (496.0, 2.75, 3.30),
                (521.0, 2.94, 3.33),
                (549.0, 3.18, 3.33),
                (582.0, 3.22, 3.30),
                (617.0, 3.17, 3.30),
                (659.0, 3.09, 3.34),
                (704.0, 3.05, 3.39),
            ],
            Element::Cu => &[
                (381.5, 1.33, 2.045),
                (397.4, 1.32, 2.116),
                (413.3, 1.28, 2.207),
                (430.5, 1.25, 2.305),
                (450.9, 1.24, 2.397),
                (471.4, 1.25, 2.483),
                (495.9, 1.22, 2.564),
                (520.9, 1.18, 2.608),
                (548.6, 1.02, 2.577),
                (582.1, 0.70, 2.704),
                (616.8, 0.30, 3.205),
                (659.5, 0.22, 3.747),
                (704.5, 0.21, 4.205),
            ],
            Element::Fe => &[
                (381.0, 2.12, 2.50),
                (397.0, 2.24, 2.58),
                (413.0, 2.35, 2.65),
                (431.0, 2.48, 2.71),
                (451.0, 2.59, 2.77),
                (471.0, 2.67, 2.82),
                (496.0, 2.74, 2.88),
                (521.0, 2.86, 2.91),
                (549.0, 2.95, 2.93),
                (582.0, 2.94, 2.99),
                (617.0, 2.88, 3.05),
                (659.0, 2.92, 3.10),
                (704.0, 2.86, 3.19),
            ],
            Element::Ni => &[
                (381.0, 1.72, 2.48),
                (397.0, 1.72, 2.57),
                (413.0, 1.70, 2.69),
                (431.0, 1.71, 2.82),
                (451.0, 1.73, 2.95),
                (471.0, 1.78, 3.09),
                (496.0, 1.82, 3.25),
                (521.0, 1.85, 3.42),
                (549.0, 1.92, 3.61),
                (582.0, 1.96, 3.80),
                (617.0, 1.99, 4.02),
                (659.0, 1.99, 4.26),
                (704.0, 2.06, 4.50),
            ],
            Element::Ti => &[
                (381.0, 1.99, 2.93),
                (397.0, 2.08, 2.95),
                (413.0, 2.14, 2.98),
                (431.0, 2.21, 3.01),
                (451.0, 2.27, 3.04),
                (471.0, 2.32, 3.10),
                (496.0, 2.36, 3.19),
                (521.0, 2.44, 3.30),
                (549.0, 2.54, 3.43),
                (582.0, 2.60, 3.58),
                (617.0, 2.67, 3.72),
                (659.0, 2.76, 3.84),
                (704.0, 2.86, 3.96),
            ],
            Element::W => &[
                (386.6, 3.458, 2.490),
                (400.2, 3.406, 2.415),
                (425.3, 3.346, 2.439),
                (442.6, 3.317, 2.489),
                (465.0, 3.325, 2.574),
                (492.1, 3.380, 2.664),
                (511.1, 3.433, 2.700),
                (529.8, 3.490, 2.716),
                (548.9, 3.522, 2.739),
                (570.5, 3.524, 2.787),
                (599.7, 3.557, 2.860),
                (626.0, 3.607, 2.906),
                (646.0, 3.657, 2.925),
                (671.2, 3.746, 2.937),
                (700.8, 3.871, 2.879),
            ],
        }
    }
}

/// The reflectance at normal incidence.
fn reflectance((n, k): (f64, f64)) -> f64 {
    ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k)
}
