//! Indices of refraction that depend on the wavelength.

use arrayvec::ArrayVec;

use crate::math::Wavelength;

/// The index of refraction n of a clear material as a function of the wavelength λ in micrometres.
///
/// Source: Born and Wolf, *Principles of Optics*, §2.3.4. Tests: glasses_have_the_index_of_their_catalogue, row O12 of `pt torture`.
#[derive(Clone, Debug, PartialEq)]
pub enum Dispersion {
    /// Cauchy's formula n = A + B/λ².
    Cauchy {
        /// A.
        a: f64,
        /// B (µm²).
        b: f64,
    },
    /// Sellmeier's formula n² = 1 + Σ B λ²/(λ² − C).
    Sellmeier {
        /// B, and C (µm²), of each term.
        terms: ArrayVec<[f64; 2], MOST_TERMS>,
    },
}

/// The largest number of terms in Sellmeier's formula.
pub const MOST_TERMS: usize = 6;

impl Dispersion {
    /// Cauchy's formula for a glass with the Abbe number V = (n_d − 1)/(n_F − n_C).
    ///
    /// - `index`: n_d, the index at the yellow line d of helium
    pub fn of_abbe_number(index: f64, abbe: f64) -> Dispersion {
        let [d, f, c] = [Wavelength::D_LINE, Wavelength::F_LINE, Wavelength::C_LINE].map(inverse_square);
        let b = (index - 1.0) / (abbe * (f - c));
        Dispersion::Cauchy { a: index - b * d, b }
    }

    /// Sellmeier's formula with the terms (B, C) that are given, of which those beyond the largest number are left out.
    pub fn sellmeier(terms: impl IntoIterator<Item = [f64; 2]>) -> Dispersion {
        Dispersion::Sellmeier { terms: terms.into_iter().take(MOST_TERMS).collect() }
    }

    /// The index of refraction, limited to the range from 0.01 to 100; 1 where the formula gives no number.
    pub fn index(&self, wavelength: Wavelength) -> f64 {
        let index = self.formula(wavelength);
        if index.is_nan() { 1.0 } else { index.clamp(0.01, 100.0) }
    }

    fn formula(&self, wavelength: Wavelength) -> f64 {
        let x = inverse_square(wavelength);
        match self {
            Dispersion::Cauchy { a, b } => a + b * x,
            Dispersion::Sellmeier { terms } => (1.0 + terms.iter().map(|[b, c]| b / (1.0 - c * x)).sum::<f64>()).sqrt(),
        }
    }

    /// The least and the greatest index for which tables are made.
    pub(super) fn tabulated(&self) -> [f32; 2] {
        let ends = [Wavelength::LONGEST, Wavelength::SHORTEST].map(|wavelength| self.index(wavelength));
        self.range().unwrap_or([ends[0].min(ends[1]), ends[0].max(ends[1])]).map(|index| index as f32)
    }

    /// The least and the greatest index of visible light; `None` if the formula has a pole among the visible wavelengths or gives no
    /// positive number there.
    pub fn range(&self) -> Option<[f64; 2]> {
        let ends = [Wavelength::LONGEST, Wavelength::SHORTEST].map(inverse_square);
        let has_pole = match self {
            Dispersion::Cauchy { .. } => false,
            Dispersion::Sellmeier { terms } => terms.iter().any(|[_, c]| (ends[0]..=ends[1]).contains(&(1.0 / c))),
        };
        let indices = (0..=VISIBLE).map(|i| self.formula(Wavelength::new(Wavelength::SHORTEST.nanometres() + i as f32)));
        let mut range = [f64::INFINITY, 0.0];
        for index in indices {
            if has_pole || !index.is_finite() || index <= 0.0 {
                return None;
            }
            range = [range[0].min(index), range[1].max(index)];
        }
        Some(range)
    }
}

/// The number of nanometres from the shortest to the longest wavelength.
const VISIBLE: usize = 320;

/// 1/λ² (µm⁻²).
fn inverse_square(wavelength: Wavelength) -> f64 {
    let micrometres = f64::from(wavelength.nanometres()) * 1e-3;
    1.0 / (micrometres * micrometres)
}
