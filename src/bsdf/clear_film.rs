//! The colours of thin films between media that take no light, without a table for each film.

use std::sync::OnceLock;

use glam::DVec3;

use crate::math::{Spectrum, Wavelength, float};
use crate::texture::Number;

/// A thin clear film on a surface, which may vary over it.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmLayer {
    /// The index of refraction of the film over that outside: at least 1.
    pub eta: f32,
    /// The thickness of the film (nm).
    pub thickness: Number,
}

impl FilmLayer {
    pub(super) fn recentred(self, origin: DVec3) -> FilmLayer {
        FilmLayer { thickness: self.thickness.recentred(origin), ..self }
    }
}

/// A thin clear film on a clear base, at a point. The indices of refraction are the same for all wavelengths.
///
/// With Fresnel's amplitudes r₁ at the front of the film and r₂ at the base, which are real, and tₖ = 1 − rₖ², the reflectance for one
/// wavelength and polarisation is
///
/// R(λ) = 1 − t₁ t₂ / |1 + r₁ r₂ e^{iφ}|² = 1 − t₁ t₂/(1 − ρ²) · (1 + 2 Σ ρᵐ cos mφ),    m = 1, 2, …
///
/// ρ = −r₁ r₂,    φ = 2π D/λ,    D = 2d √(n² − sin²θ)
///
/// Only cos mφ depends on the wavelength. In daylight, for red, green or blue, it has the mean
///
/// C_c(mD) = ∫ w_c(λ) cos(2π mD/λ) dλ
///
/// by the functions w_c of [`Wavelength::matching`]: one table for all films, bases and angles. The result is limited to [0, 1], because
/// Rec. 709 cannot show all colours. Between 1 and 3 the indices need 5 to 30 terms, and near grazing incidence up to 2000.
///
/// Source: Born and Wolf, *Principles of Optics*, §1.6.4 and §7.6.1 (the series); Belcour and Barla, *A Practical Extension to Microfacet
/// Theory for the Modeling of Varying Iridescence* (2017), for its mean over the wavelength. Tests: clear_films_are_integrals_over_the_wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearFilm {
    /// n, the index of refraction of the film over that outside: at least 1.
    pub eta: f32,
    /// d, the thickness of the film (nm).
    pub thickness: f32,
    /// The index of refraction of the base over that outside, for red, green and blue: at least 1.
    pub base: Spectrum,
}

/// The series ends where its next term is below this share of 1 − |ρ|, or its next block of g terms of 1 − |ρᵍ|.
const LEAST: f32 = 1e-5;
/// The least cosine. At grazing incidence a film of index 1 would have the amplitude 0/0.
const GRAZING: f32 = 1e-4;
/// The number of terms that are added one by one.
const SINGLE: u32 = 64;
/// The greatest path difference between terms that are added as one (nm): a fiftieth of a turn of violet light.
const BLOCK: f32 = 8.0;
/// The greatest number of terms that are added as one.
const MOST: u32 = 1 << 20;

impl ClearFilm {
    /// The reflectance at an angle.
    ///
    /// - `cos`: the cosine of the angle to the normal; its sign does not matter
    pub fn at(&self, cos: f32) -> Spectrum {
        let cos = cos.abs().clamp(GRAZING, 1.0);
        let within = normal_part(self.eta, cos);
        let first = front(cos, within, self.eta);
        let second = self.base.coefficients().map(|index| inner(within, normal_part(index, cos), self.eta, index));
        // For each polarisation and colour: t₁ t₂/(1 − ρ²), and ρ.
        let of = |p: usize| {
            second.map(|second| {
                let both = first[p].passed * second[p].passed;
                let either = first[p].passed + second[p].passed - both;
                (both / either, -first[p].amplitude * second[p].amplitude)
            })
        };
        let terms = [of(0), of(1)];
        let sums = series(terms.map(|of| of.map(|(_, rho)| rho)), 2.0 * within * self.thickness);
        let passed = |p: usize, c: usize| terms[p][c].0 * (1.0 + 2.0 * sums[p][c]);
        Spectrum::from_array([0, 1, 2].map(|c| (1.0 - 0.5 * (passed(0, c) + passed(1, c))).clamp(0.0, 1.0)))
    }

    /// The greatest reflectance of films of any thickness, for any wavelength.
    ///
    /// max R = ((|r₁| + |r₂|)/(1 + |r₁ r₂|))² for each polarisation
    ///
    /// - `film`, `base`: the indices of refraction of the film and of what is below
    pub fn greatest(cos: f32, film: f32, base: f32) -> f32 {
        let cos = cos.abs().clamp(GRAZING, 1.0);
        let within = normal_part(film, cos);
        let (first, second) = (front(cos, within, film), inner(within, normal_part(base, cos), film, base));
        let of = |p: usize| {
            let [a, b] = [first[p].amplitude.abs(), second[p].amplitude.abs()];
            ((a + b) / (1.0 + a * b)).powi(2)
        };
        (0.5 * (of(0) + of(1))).min(1.0)
    }

    /// The index of refraction of a clear base that reflects this share of the light at normal incidence, with nothing on it.
    pub fn base_of_reflectance(share: f32) -> f32 {
        // White would have an infinite index.
        let root = share.max(0.0).sqrt().min(0.9999);
        (1.0 + root) / (1.0 - root)
    }
}

/// Fresnel's amplitude of reflection at a face for one polarisation, and the share of the light that passes, 1 minus its square.
#[derive(Clone, Copy)]
struct Face {
    amplitude: f32,
    passed: f32,
}

impl Face {
    /// r = (a − b)/(a + b). The share that passes is not computed from it, which would cancel near grazing incidence.
    fn new(a: f32, b: f32) -> Face {
        let sum = a + b;
        Face { amplitude: (a - b) / sum, passed: 4.0 * a * b / (sum * sum) }
    }
}

/// √(n² − sin²θ) = n cos θ′, with the angle θ′ in the medium of index n: the component of the wave vector along the normal, relative to the
/// wave number outside. It is computed without cancellation for n near 1.
fn normal_part(index: f32, cos: f32) -> f32 {
    ((index - 1.0) * (index + 1.0) + cos * cos).sqrt()
}

/// The front of a film, for both polarisations.
fn front(cos: f32, within: f32, film: f32) -> [Face; 2] {
    [Face::new(cos, within), Face::new(film * film * cos, within)]
}

/// The face between a film and its base, for both polarisations.
fn inner(within: f32, beyond: f32, film: f32, base: f32) -> [Face; 2] {
    [Face::new(within, beyond), Face::new(base * base * within, film * film * beyond)]
}

/// Σ ρᵐ C_c(mD) for two polarisations and three colours.
///
/// The first [`SINGLE`] terms are added one by one. Further ones are needed where |ρ| is above about 0.84: near grazing incidence, and for films of
/// high index on bright metal at oblique angles. Of these, terms whose phases hardly differ are added as one, with the phase of their middle: g
/// terms from the m-th on are ρᵐ (1 − ρᵍ)/(1 − ρ) C_c((m + (g − 1)/2) D). This is exact for a film without thickness, and changes the
/// reflectance of others by up to three thousandths, most where ρ is negative, because the terms of a block then have different signs.
fn series(rho: [[f32; 3]; 2], difference: f32) -> [[f32; 3]; 2] {
    let mut series = Series { terms: rho, sums: [[0.0; 3]; 2] };
    for m in 1..=SINGLE {
        let place = m as f32 * difference;
        if place >= FARTHEST || series.is_over(&rho) {
            return series.sums;
        }
        series.add(place, &rho);
    }
    let count = ((BLOCK / difference.max(f32::MIN_POSITIVE)) as u32).clamp(1, MOST);
    let step = rho.map(|of| of.map(|rho| power(rho, count)));
    series.terms = [0, 1].map(|p: usize| [0, 1, 2].map(|c: usize| series.terms[p][c] * (1.0 - step[p][c]) / (1.0 - rho[p][c])));
    let mut place = (SINGLE as f32 + 0.5 * (count + 1) as f32) * difference;
    while place < FARTHEST && !series.is_over(&step) {
        series.add(place, &step);
        place += count as f32 * difference;
    }
    series.sums
}

/// The next terms of a series, and the sums of those before.
struct Series {
    terms: [[f32; 3]; 2],
    sums: [[f32; 3]; 2],
}

impl Series {
    /// Adds the next terms, at a path difference (nm).
    fn add(&mut self, place: f32, step: &[[f32; 3]; 2]) {
        let wave = Waves::table().at(place);
        for ((sums, terms), step) in self.sums.iter_mut().zip(&mut self.terms).zip(step) {
            for c in 0..3 {
                sums[c] += terms[c] * wave[c];
                terms[c] *= step[c];
            }
        }
    }

    /// All further terms together are at most the next one over 1 − |ρ|.
    fn is_over(&self, step: &[[f32; 3]; 2]) -> bool {
        (0..6).all(|k| self.terms[k / 3][k % 3].abs() < LEAST * (1.0 - step[k / 3][k % 3].abs()))
    }
}

/// xⁿ
fn power(x: f32, n: u32) -> f32 {
    let (mut result, mut square, mut rest) = (1.0, x, n);
    while rest > 0 {
        if rest % 2 == 1 {
            result *= square;
        }
        square *= square;
        rest /= 2;
    }
    result
}

/// Computes what all films share. Otherwise the first hit of a render would do so.
pub(super) fn prepare() {
    Waves::table();
}

/// C_c at equal steps of the path difference.
struct Waves(Vec<[f32; 3]>);

/// The step of the path difference (nm): violet light turns by a two-hundredth.
const STEP: f64 = 2.0;
/// The number of steps.
const STEPS: usize = 8000;
/// The greatest path difference (nm). Beyond, waves of different colours cancel each other to less than a thousandth.
const FARTHEST: f32 = (STEP * STEPS as f64) as f32;

impl Waves {
    fn table() -> &'static Waves {
        static TABLE: OnceLock<Waves> = OnceLock::new();
        TABLE.get_or_init(Waves::new)
    }

    fn new() -> Waves {
        const WAVELENGTHS: usize = 640;
        let (first, last) = (f64::from(Wavelength::SHORTEST.nanometres()), f64::from(Wavelength::LONGEST.nanometres()));
        let (mut sums, mut totals) = (vec![[0.0; 3]; STEPS + 1], [0.0; 3]);
        for i in 0..WAVELENGTHS {
            let wavelength = Wavelength::new((first + (last - first) * (i as f64 + 0.5) / WAVELENGTHS as f64) as f32);
            let shares = wavelength.matching();
            totals = [0, 1, 2].map(|c: usize| totals[c] + shares[c]);
            // cos (k + 1)x = 2 cos x cos kx − cos (k − 1)x
            let (_, turn) = float::sin_cos_degrees(360.0 * STEP / f64::from(wavelength.nanometres()));
            let (mut before, mut wave) = (turn, 1.0);
            for sum in &mut sums {
                *sum = [0, 1, 2].map(|c: usize| sum[c] + shares[c] * wave);
                (before, wave) = (wave, 2.0 * turn * wave - before);
            }
        }
        Waves(sums.into_iter().map(|sum| [0, 1, 2].map(|c: usize| (sum[c] / totals[c]) as f32)).collect())
    }

    fn at(&self, difference: f32) -> [f32; 3] {
        let along = difference * (1.0 / STEP as f32);
        let i = (along as usize).min(STEPS - 1);
        let (low, high, t) = (self.0[i], self.0[i + 1], along - i as f32);
        [0, 1, 2].map(|c: usize| low[c] + (high[c] - low[c]) * t)
    }
}
