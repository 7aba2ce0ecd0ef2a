//! Wavelengths of light, and how much each of them contributes to red, green and blue.

use super::Spectrum;
use super::colorimetry::{COUNT, D65, FIRST, OBSERVER, STEP, TO_REC_709};

/// A wavelength of visible light (nm), from 380 to 700.
///
/// White light of which each of red, green and blue has the amount 1 consists of light of all wavelengths. The share of it that lies
/// in dλ is, for the coefficient c,
///
/// c̄(λ) dλ = max(0, w_c(λ)) dλ / ∫ max(0, w_c) dλ,    w_c = (XYZ → Rec. 709)_c · x̄ȳz̄(λ) · D65(λ)
///
/// These responses are never negative and their integrals are 1. A path that takes a single wavelength draws it with the density
/// p = (r̄ + ḡ + b̄)/3, and its light is multiplied by (r̄, ḡ, b̄)/p. The factors are between 0 and 3, their mean over red, green and
/// blue is 1, and so is the expected value of each: what does not depend on the wavelength keeps its colour in the mean.
///
/// The colours of single wavelengths lie outside of Rec. 709, where the observer's w_c is negative for one or two of the coefficients.
/// There the response is 0. Without its negative part w_c would have an integral that is larger by 1.49 for red, 1.12 for green and 1.12
/// for blue, by which it is divided: a spectrum is less saturated than the eye sees it, and its red is darker by a third.
///
/// Between the wavelengths of the tables the responses are interpolated linearly.
///
/// Source: of the observer, the illuminant and the primaries, see [`colorimetry`](super::colorimetry).
/// Tests: responses_are_those_of_the_observer, wavelengths_have_their_density.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Wavelength(f32);

impl Wavelength {
    /// The yellow line d of helium, for which catalogues state the index of refraction.
    pub const D_LINE: Wavelength = Wavelength(587.5618);
    /// The blue line F of hydrogen.
    pub const F_LINE: Wavelength = Wavelength(486.1327);
    /// The red line C of hydrogen.
    pub const C_LINE: Wavelength = Wavelength(656.2725);
    /// The shortest wavelength.
    pub const SHORTEST: Wavelength = Wavelength(FIRST as f32);
    /// The longest wavelength.
    pub const LONGEST: Wavelength = Wavelength((FIRST + STEP * (COUNT - 1) as f64) as f32);

    /// A wavelength in nanometres, which is limited to the visible ones.
    pub fn new(nanometres: f32) -> Wavelength {
        Wavelength(nanometres.clamp(Self::SHORTEST.0, Self::LONGEST.0))
    }

    /// The wavelength in nanometres.
    pub fn nanometres(self) -> f32 {
        self.0
    }

    /// Draws a wavelength by a uniform number, and returns it with the factors of its light.
    pub fn sample(u: f32) -> (Wavelength, Spectrum) {
        let u = f64::from(u);
        let segment = TABLE.cumulative.partition_point(|&below| below <= u).clamp(1, COUNT - 1) - 1;
        let [low, high] = [0, 1].map(|k| TABLE.density(segment + k));
        let rest = ((u - TABLE.cumulative[segment]) / STEP).max(0.0);
        // The place t in the segment for which the integral of the density, low t + (high - low) t²/2, is the rest.
        let t = (2.0 * rest / (low + (low * low + 2.0 * (high - low) * rest).max(0.0).sqrt())).min(1.0);
        let nanometres = FIRST + STEP * (segment as f64 + t);
        let wavelength = Wavelength::new(nanometres as f32);
        (wavelength, wavelength.factors())
    }

    /// The factors (r̄, ḡ, b̄)/p of the light of a path that has this wavelength.
    pub fn factors(self) -> Spectrum {
        let [red, green, blue] = self.responses();
        let p = (red + green + blue) / 3.0;
        Spectrum::rgb((red / p) as f32, (green / p) as f32, (blue / p) as f32)
    }

    /// r̄, ḡ and b̄ (1/nm).
    pub fn responses(self) -> [f64; 3] {
        self.interpolated(&TABLE.responses)
    }

    /// w_c with an integral of 1 for each of red, green and blue (1/nm), also where it is negative. A product with it is the colour of
    /// light or of a surface in daylight, but not a density.
    pub fn matching(self) -> [f64; 3] {
        self.interpolated(&TABLE.matching)
    }

    fn interpolated(self, table: &[[f64; 3]; COUNT]) -> [f64; 3] {
        let place = (f64::from(self.0) - FIRST) / STEP;
        let segment = (place as usize).min(COUNT - 2);
        let t = place - segment as f64;
        let [low, high] = [table[segment], table[segment + 1]];
        [0, 1, 2].map(|c| low[c] + (high[c] - low[c]) * t)
    }
}

/// The responses at the wavelengths of the tables, and the probability of all shorter wavelengths.
struct Table {
    matching: [[f64; 3]; COUNT],
    responses: [[f64; 3]; COUNT],
    cumulative: [f64; COUNT],
}

static TABLE: Table = Table::new();

impl Table {
    const fn new() -> Table {
        let (mut matching, mut responses) = ([[0.0; 3]; COUNT], [[0.0; 3]; COUNT]);
        let mut i = 0;
        while i < COUNT {
            let mut c = 0;
            while c < 3 {
                let row = TO_REC_709[c];
                let w = (row[0] * OBSERVER[i][0] + row[1] * OBSERVER[i][1] + row[2] * OBSERVER[i][2]) * D65[i];
                matching[i][c] = w;
                responses[i][c] = if w > 0.0 { w } else { 0.0 };
                c += 1;
            }
            i += 1;
        }
        let mut table = Table { matching: normalized(matching), responses: normalized(responses), cumulative: [0.0; COUNT] };
        let mut i = 1;
        while i < COUNT {
            table.cumulative[i] = table.cumulative[i - 1] + 0.5 * STEP * (table.density(i - 1) + table.density(i));
            i += 1;
        }
        table
    }

    /// p at a wavelength of the table (1/nm).
    const fn density(&self, i: usize) -> f64 {
        let [red, green, blue] = self.responses[i];
        (red + green + blue) / 3.0
    }
}

/// Divides each column by its integral, with linear interpolation between the rows.
const fn normalized(mut table: [[f64; 3]; COUNT]) -> [[f64; 3]; COUNT] {
    let mut c = 0;
    while c < 3 {
        let (mut total, mut i) = (0.0, 0);
        while i < COUNT {
            total += table[i][c] * STEP * if i == 0 || i == COUNT - 1 { 0.5 } else { 1.0 };
            i += 1;
        }
        let mut i = 0;
        while i < COUNT {
            table[i][c] /= total;
            i += 1;
        }
        c += 1;
    }
    table
}
