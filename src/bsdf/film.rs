//! Tables of the colours that thin films reflect.

use std::fmt;

use rayon::prelude::*;

use super::table_cache::TableCache;
use crate::math::{Rgb, Spectrum, Wavelength, thin_film};

/// The reflectance of a thin film on a base in daylight, for red, green and blue, over the angle and the thickness.
///
/// R_c(θ, d) = ∫ w_c(λ) R(λ, θ, d) dλ,    limited to [0, 1]
///
/// with the functions w_c of [`Wavelength::matching`] and the reflectance R of [`thin_film::reflectance`]. This is the colour that an
/// observer sees, unless Rec. 709 cannot show it. The index of the base may differ between red, green and blue. Between the nodes of the
/// table it is interpolated linearly; they lie at equal steps of the roots of the cosine and of the thickness, because near grazing
/// incidence and for the thinnest films the reflectance changes most.
///
/// Tests: tables_of_films_are_integrals_over_the_wavelength, metal_under_no_film_is_bare.
#[derive(PartialEq)]
pub struct FilmTable {
    /// The reflectance at each thickness and cosine.
    rows: Vec<[[f32; 3]; NODES]>,
    /// 2 ∫ R μ dμ at each thickness.
    means: Vec<[f32; 3]>,
    /// Roots of the thickness of the first and the last row (√nm).
    ends: [f32; 2],
}

/// The number of cosines of a row.
const NODES: usize = 128;

/// The largest product of the film's index and the step of the thickness from one row to the next (nm): the phase differs by a fiftieth
/// of a turn of violet light.
const STEP: f32 = 4.0;

/// A film, and the base that it lies on. A film on both faces of a pane reflects 2R/(1 + R), where R is the reflectance of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// The index of refraction of the film, at least 1.
    pub eta: f32,
    /// The least and the greatest thickness (nm).
    pub thickness: [f32; 2],
    /// η and k of the base, for red, green and blue.
    pub base: [Rgb; 2],
    /// Whether the base is a clear pane with such films on both faces. Between the faces light has no phase.
    pub on_both_faces: bool,
}

impl Film {
    /// The table of the film. Tables of the same film are computed once.
    pub fn table(&self) -> &'static FilmTable {
        static CACHE: TableCache<([u32; 9], bool), FilmTable> = TableCache::new();
        let ([eta, k], [from, to]) = (self.base.map(|of| of.to_array()), self.thickness);
        let key = [self.eta, from, to, eta[0], eta[1], eta[2], k[0], k[1], k[2]].map(f32::to_bits);
        CACHE.get((key, self.on_both_faces), || FilmTable::new(self))
    }

    /// The reflectance for red, green and blue.
    ///
    /// - `light`: from [`Film::light`]
    fn reflectance(&self, cos: f64, thickness: f64, light: &[(Wavelength, [f64; 3])]) -> [f32; 3] {
        let [eta, k] = self.base.map(|of| of.to_array());
        let base = [0, 1, 2].map(|c: usize| [f64::from(eta[c]), f64::from(k[c])]);
        let mut sum = [0.0; 3];
        for (wavelength, shares) in light {
            let of = |base| {
                let once = thin_film::reflectance(*wavelength, cos, thickness, f64::from(self.eta), base);
                if self.on_both_faces { 2.0 * once / (1.0 + once) } else { once }
            };
            let first = of(base[0]);
            for c in 0..3 {
                sum[c] += shares[c] * if base[c] == base[0] { first } else { of(base[c]) };
            }
        }
        sum.map(|r| r.clamp(0.0, 1.0) as f32)
    }

    /// Wavelengths with their shares of red, green and blue light, so close that the phase differs by less than a sixteenth of a turn
    /// from one to the next.
    fn light(&self, thickness: f64) -> Vec<(Wavelength, [f64; 3])> {
        let (first, last) = (f64::from(Wavelength::SHORTEST.nanometres()), f64::from(Wavelength::LONGEST.nanometres()));
        // The phase is at most 2nd/λ turns, and changes by 2nd/λ² for each nanometre.
        let turns = 2.0 * f64::from(self.eta) * thickness / (first * first);
        let steps = 32 * (10.0 * 16.0 * turns).ceil().max(2.0) as usize;
        let at = |i: usize| Wavelength::new((first + (last - first) * (i as f64 + 0.5) / steps as f64) as f32);
        let all: Vec<_> = (0..steps).map(|i| (at(i), at(i).matching())).collect();
        let totals = [0, 1, 2].map(|c: usize| all.iter().map(|(_, matching)| matching[c]).sum::<f64>());
        all.into_iter().map(|(wavelength, matching)| (wavelength, [0, 1, 2].map(|c| matching[c] / totals[c]))).collect()
    }
}

impl FilmTable {
    fn new(film: &Film) -> FilmTable {
        let ends = film.thickness.map(f32::sqrt);
        let [from, to] = ends.map(f64::from);
        // Where the root s grows by one step, the thickness s² grows by 2s times the step.
        let step = f64::from(STEP / film.eta) / (2.0 * to);
        let count = if to > from { ((to - from) / step).ceil() as usize + 1 } else { 1 };
        let thickness = |i: usize| if i == 0 { from * from } else { (from + (to - from) * (i as f64 / (count - 1) as f64)).powi(2) };
        let row = |i| {
            let (thickness, light) = (thickness(i), film.light(thickness(i)));
            std::array::from_fn(|j| film.reflectance(cosine(j), thickness, &light))
        };
        let rows: Vec<[[f32; 3]; NODES]> = (0..count).into_par_iter().map(row).collect();
        FilmTable { means: rows.iter().map(mean).collect(), rows, ends }
    }

    /// The reflectance at an angle.
    ///
    /// - `cos`: the cosine of the angle to the normal; its sign does not matter
    /// - `thickness`: in nanometres, limited to the range of the table
    pub fn at(&self, cos: f32, thickness: f32) -> Spectrum {
        let along = cos.abs().min(1.0).sqrt() * (NODES - 1) as f32;
        let j = (along as usize).min(NODES - 2);
        let t = along - j as f32;
        self.between(thickness, |i| lerp(self.rows[i][j], self.rows[i][j + 1], t))
    }

    /// The mean 2 ∫ R μ dμ over the hemisphere.
    pub fn mean(&self, thickness: f32) -> Spectrum {
        self.between(thickness, |i| self.means[i])
    }

    fn between(&self, thickness: f32, row: impl Fn(usize) -> [f32; 3]) -> Spectrum {
        let last = self.rows.len() - 1;
        if last == 0 {
            return Spectrum::from_array(row(0));
        }
        let [from, to] = self.ends;
        let along = ((thickness.max(0.0).sqrt() - from) / (to - from)).clamp(0.0, 1.0) * last as f32;
        let i = (along as usize).min(last - 1);
        Spectrum::from_array(lerp(row(i), row(i + 1), along - i as f32))
    }
}

/// The cosine of a node.
fn cosine(j: usize) -> f64 {
    (j as f64 / (NODES - 1) as f64).powi(2)
}

/// 2 ∫ R μ dμ of a row. With μ = s² it is 4 ∫ R s³ ds, and R is linear in s between the nodes: each node counts for 4 ∫ (1 − |s − sⱼ|/h) s³ ds,
/// whose exact value is 4h (sⱼ³ + h² sⱼ/2) within the row.
fn mean(row: &[[f32; 3]; NODES]) -> [f32; 3] {
    let h = 1.0 / (NODES - 1) as f64;
    let weight = |j: usize| {
        let s = j as f64 * h;
        match j {
            0 => h.powi(4) / 5.0,
            // Half of the node's hat: 4 ∫ (1 − t) (1 − ht)³ h dt for t from 0 to 1.
            _ if j == NODES - 1 => 4.0 * h * (0.5 - 0.5 * h + 0.25 * h * h - 0.05 * h * h * h),
            _ => 4.0 * h * (s * s * s + 0.5 * h * h * s),
        }
    };
    [0, 1, 2].map(|c| (0..NODES).map(|j| weight(j) * f64::from(row[j][c])).sum::<f64>() as f32)
}

fn lerp(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    [0, 1, 2].map(|c| a[c] + (b[c] - a[c]) * t)
}

/// Leaves out the thousands of numbers in the table.
impl fmt::Debug for FilmTable {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("FilmTable").field("ends", &self.ends).finish_non_exhaustive()
    }
}
