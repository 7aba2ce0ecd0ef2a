//! Translucent bodies: coefficients of a medium from what one sees of it, and measured ones.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Single-scattering albedo ω of an infinitely thick medium whose diffuse reflectance is `albedo`: the share that it reflects of light that
/// is equal from all directions.
///
/// albedo = (1 − s)(1 − 0.139 s) / (1 + 1.17 s),  s = √((1 − ω) / (1 − g ω))
///
/// The formula has an error of at most 0.003 for isotropic scattering, and of 0.01 for g from −0.5 to 0.9. It is that of a medium without a surface:
/// glass around it sends light back into it, which makes it darker.
///
/// - `albedo`: from 0 to 1
/// - `g`: mean cosine of the angle of scattering
///
/// Source: van de Hulst, *Multiple Light Scattering* (1980), §14.4.
pub fn single_scattering_albedo(albedo: f64, g: f64) -> f64 {
    // The root between 0 and 1 of 0.139 s² − b s + (1 − albedo), in the form without cancellation.
    let (b, c) = (1.139 + 1.17 * albedo, 1.0 - albedo);
    let s = 2.0 * c / (b + (b * b - 4.0 * 0.139 * c).sqrt());
    let s = s.clamp(0.0, 1.0);
    (1.0 - s * s) / (1.0 - g * s * s)
}

/// A material whose scattering and absorption were measured.
///
/// Source: Jensen, Marschner, Levoy and Hanrahan, *A Practical Model for Subsurface Light Transport* (2001).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "the names say it")]
pub enum Measured {
    Apple,
    Chicken1,
    Chicken2,
    Cream,
    Ketchup,
    Marble,
    Potato,
    SkimMilk,
    Skin1,
    Skin2,
    Spectralon,
    WholeMilk,
}

impl Measured {
    /// Reduced scattering and absorption for red, green and blue (m⁻¹). Reduced scattering, σs (1 − g), is that of a medium which scatters
    /// isotropically and looks the same.
    pub fn coefficients(self) -> [[f64; 3]; 2] {
        let per_millimetre = match self {
            Measured::Apple => [[2.29, 2.39, 1.97], [0.0030, 0.0034, 0.046]],
            Measured::Chicken1 => [[0.15, 0.21, 0.38], [0.015, 0.077, 0.19]],
            Measured::Chicken2 => [[0.19, 0.25, 0.32], [0.018, 0.088, 0.20]],
            Measured::Cream => [[7.38, 5.47, 3.15], [0.0002, 0.0028, 0.0163]],
            Measured::Ketchup => [[0.18, 0.07, 0.03], [0.061, 0.97, 1.45]],
            Measured::Marble => [[2.19, 2.62, 3.00], [0.0021, 0.0041, 0.0071]],
            Measured::Potato => [[0.68, 0.70, 0.55], [0.0024, 0.0090, 0.12]],
            Measured::SkimMilk => [[0.70, 1.22, 1.90], [0.0014, 0.0025, 0.0142]],
            Measured::Skin1 => [[0.74, 0.88, 1.01], [0.032, 0.17, 0.48]],
            Measured::Skin2 => [[1.09, 1.59, 1.79], [0.013, 0.070, 0.145]],
            Measured::Spectralon => [[11.6, 20.4, 14.9], [0.0; 3]],
            Measured::WholeMilk => [[2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]],
        };
        per_millimetre.map(|color| color.map(|x| 1e3 * x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torture::Random;

    /// Diffuse reflectance of a half space that scatters isotropically: 1 − 2 √(1 − ω) ∫ H(μ) μ dμ, with Chandrasekhar's
    /// equation 1/H(μ) = √(1 − ω) + ω/2 ∫ μ' H(μ')/(μ + μ') dμ', solved by iteration.
    fn isotropic_half_space(albedo: f64) -> f64 {
        const STEPS: usize = 400;
        // The substitution μ = x² has more places near 0, where H is steep.
        let places: Vec<(f64, f64)> = (0..STEPS)
            .map(|k| {
                let x = (k as f64 + 0.5) / STEPS as f64;
                (x * x, 2.0 * x / STEPS as f64)
            })
            .collect();
        let root = (1.0 - albedo).sqrt();
        let mut h = vec![1.0; STEPS];
        for _ in 0..400 {
            let integral = |mu: f64| places.iter().zip(&h).map(|((at, weight), h)| weight * at * h / (mu + at)).sum::<f64>();
            h = places.iter().map(|(mu, _)| 1.0 / (root + 0.5 * albedo * integral(*mu))).collect();
        }
        1.0 - 2.0 * root * places.iter().zip(&h).map(|((mu, weight), h)| weight * mu * h).sum::<f64>()
    }

    #[test]
    fn isotropic_media_have_the_albedo_that_was_asked_for() {
        // Known: H's first moment for ω = 0.9 gives the albedo 0.4781.
        assert!((isotropic_half_space(0.9) - 0.478).abs() < 1e-3, "{}", isotropic_half_space(0.9));
        for albedo in [0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97] {
            let found = isotropic_half_space(single_scattering_albedo(albedo, 0.0));
            println!("albedo {albedo}, g = 0: {found:.4}");
            assert!((found - albedo).abs() < 3e-3, "{albedo}: {found}");
        }
        assert_eq!([0.0, 1.0].map(|albedo| single_scattering_albedo(albedo, 0.7)), [0.0, 1.0]);
    }

    /// Diffuse reflectance of a half space, by a walk of photons in the depth alone.
    fn walked_half_space(albedo: f64, g: f64, photons: u32) -> f64 {
        let mut random = Random::new(5);
        let mut next = || f64::from(random.uniform_square().x).max(1e-12);
        let mut reflected = 0.0;
        for _ in 0..photons {
            let (mut depth, mut cosine, mut weight) = (0.0, next().sqrt(), 1.0);
            loop {
                depth -= cosine * next().ln();
                if depth < 0.0 {
                    reflected += weight;
                    break;
                }
                weight *= albedo;
                if weight < 1e-4 {
                    break;
                }
                let along = if g == 0.0 {
                    2.0 * next() - 1.0
                } else {
                    let k = (1.0 - g * g) / (1.0 - g + 2.0 * g * next());
                    (1.0 + g * g - k * k) / (2.0 * g)
                };
                let across = ((1.0 - cosine * cosine) * (1.0 - along * along)).max(0.0).sqrt();
                cosine = cosine * along + across * (std::f64::consts::TAU * next()).cos();
            }
        }
        reflected / f64::from(photons)
    }

    #[test]
    fn media_that_scatter_forwards_have_the_albedo_that_was_asked_for() {
        for (albedo, g) in [(0.5, 0.0), (0.2, 0.5), (0.5, 0.8), (0.8, 0.8), (0.6, 0.9), (0.5, -0.5)] {
            const PHOTONS: u32 = 20_000;
            let found = walked_half_space(single_scattering_albedo(albedo, g), g, PHOTONS);
            println!("albedo {albedo}, g = {g}: {found:.4}");
            // The mean of weights between 0 and 1 has a standard error of at most 1/2√n: 4 of them.
            let tolerance = 0.01 + 2.0 / f64::from(PHOTONS).sqrt();
            assert!((found - albedo).abs() < tolerance, "{albedo}, g = {g}: {found}");
        }
    }
}
