//! Pictures of a scene and of a changed one, compared tile by tile with the same random numbers.

use std::sync::Arc;

use glam::UVec2;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::film::{FilmSpec, Image, MomentFilm};
use crate::integrator::Integrator;
use crate::measure::sidak;
use crate::render::{Observer, Settings, render};
use crate::sampler::SamplerSpec;
use crate::scene::Scene;

/// Number of pictures of each scene, with different random numbers.
pub const PICTURES: usize = 16;
/// Width and height of a tile, in pixels.
pub const TILE: u32 = 8;
/// Relative difference that counts: smaller ones are rounding.
pub const DIFFERENCE: f64 = 1e-3;
/// Probability that any of all tiles of all changes is called different although none is.
pub const RISK: f64 = 0.01;
/// Share of the whole picture's brightness that is added to that of a tile, so that black tiles have a relative difference.
const FLOOR: f64 = 0.01;

/// Pictures of one scene.
pub struct Pictures {
    images: Vec<Image>,
    /// Number of samples that were no numbers.
    pub invalid: u64,
}

/// How the pictures of two scenes differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Greatest relative difference of a tile that is established, in the sense of [`Pictures::difference`]; 0 if there is none.
    pub tile: f64,
    /// First pixel of that tile.
    pub at: UVec2,
    /// Number of tiles with established differences.
    pub tiles: usize,
    /// Relative difference of the whole picture, and its standard error.
    pub whole: (f64, f64),
    /// Whether the whole picture differs.
    pub is_whole: bool,
    /// Whether all pictures have the same bits.
    pub same_bits: bool,
    /// Relative difference of the whole picture that would have shown.
    pub would_show: f64,
}

impl Difference {
    /// Whether the pictures differ.
    pub fn is_established(&self) -> bool {
        self.tiles > 0 || self.is_whole
    }
}

/// How the pictures are rendered.
pub struct Rendering<'a> {
    /// Size and filter.
    pub film: &'a FilmSpec,
    /// Kind of random numbers and the first seed.
    pub sampler: SamplerSpec,
    /// Samples per pixel of each picture.
    pub spp: u64,
    /// Who is told of progress, and may cancel.
    pub observer: &'a dyn Observer,
}

impl Pictures {
    /// Renders the pictures of a scene.
    pub fn render(scene: &Arc<dyn Scene>, integrator: &dyn Integrator, how: &Rendering) -> Pictures {
        let mut pictures = Pictures { images: vec![], invalid: 0 };
        for k in 0..PICTURES as u64 {
            let mut film = MomentFilm::new(how.film.clone());
            let sampler = SamplerSpec { seed: how.sampler.seed.wrapping_add(k), spp: how.spp, scramblings: 1, ..how.sampler };
            let report = render(scene.clone(), integrator, &mut film, &Settings::new(sampler), how.observer);
            pictures.invalid += report.invalid;
            pictures.images.push(film.image());
        }
        pictures
    }

    /// The mean of all pictures.
    pub fn mean(&self) -> Image {
        let mut mean = self.images[0].clone();
        mean.channels.truncate(3);
        for (c, channel) in mean.channels.iter_mut().enumerate() {
            for (i, value) in channel.values.iter_mut().enumerate() {
                let sum: f64 = self.images.iter().map(|image| f64::from(image.channels[c].values[i])).sum();
                *value = (sum / PICTURES as f64) as f32;
            }
        }
        mean
    }

    /// How these pictures differ from those of the scene as it is.
    ///
    /// Both have the same random numbers, so that most paths are nearly the same and the differences of the pairs vary little. A
    /// difference is established if the confidence interval of its mean, by Student's distribution, is beyond ±[`DIFFERENCE`] times the
    /// brightness. The level of each of the `tests` intervals is such that together they are wrong with a probability of [`RISK`].
    pub fn difference(&self, unchanged: &Pictures, tests: usize) -> Difference {
        let values =
            |image: &Image| -> Vec<u32> { image.channels.iter().take(3).flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect() };
        let same_bits = self.images.iter().zip(&unchanged.images).all(|(a, b)| values(a) == values(b));
        let (own, other) = (self.brightness(), unchanged.brightness());
        let tiles = own[0].len();
        let whole: Vec<[f64; 2]> =
            own.iter().zip(&other).map(|(a, b)| [a, b].map(|tiles| tiles.iter().sum::<f64>() / tiles.len() as f64)).collect();
        let brightness = whole.iter().map(|[_, b]| b).sum::<f64>() / PICTURES as f64;
        let student = StudentsT::new(0.0, 1.0, PICTURES as f64 - 1.0).expect("degrees of freedom");
        let quantile = -student.inverse_cdf(0.5 * sidak(RISK, tests * (tiles + 1)));
        let (relative, error) = compared(&whole, 0.0);
        let mut found = Difference {
            tile: 0.0,
            at: UVec2::ZERO,
            tiles: 0,
            whole: (relative, error),
            is_whole: relative.abs() - quantile * error > DIFFERENCE,
            same_bits,
            would_show: DIFFERENCE + quantile * error,
        };
        let across = self.images[0].size.x.div_ceil(TILE) as usize;
        for tile in 0..tiles {
            let pairs: Vec<[f64; 2]> = own.iter().zip(&other).map(|(a, b)| [a[tile], b[tile]]).collect();
            let (relative, error) = compared(&pairs, FLOOR * brightness);
            if relative.abs() - quantile * error > DIFFERENCE {
                found.tiles += 1;
                if relative.abs() > found.tile.abs() {
                    found.tile = relative;
                    found.at = UVec2::new((tile % across) as u32, (tile / across) as u32) * TILE;
                }
            }
        }
        found
    }

    /// For each picture, the mean radiance of each tile, over the colours.
    fn brightness(&self) -> Vec<Vec<f64>> {
        self.images.iter().map(tile_means).collect()
    }
}

fn tile_means(image: &Image) -> Vec<f64> {
    let across = image.size.x.div_ceil(TILE) as usize;
    let mut sums = vec![(0.0, 0u32); across * image.size.y.div_ceil(TILE) as usize];
    for (i, rgb) in image.pixels().enumerate() {
        let (x, y) = (i % image.size.x as usize, i / image.size.x as usize);
        let (sum, count) = &mut sums[y / TILE as usize * across + x / TILE as usize];
        *sum += rgb.iter().map(|v| f64::from(*v)).sum::<f64>() / 3.0;
        *count += 1;
    }
    sums.into_iter().map(|(sum, count)| sum / f64::from(count)).collect()
}

/// Mean difference of pairs relative to the mean of their second values plus `floor`, and its standard error.
fn compared(pairs: &[[f64; 2]], floor: f64) -> (f64, f64) {
    let n = pairs.len() as f64;
    let mean = pairs.iter().map(|[a, b]| a - b).sum::<f64>() / n;
    let variance = pairs.iter().map(|[a, b]| (a - b - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let brightness = pairs.iter().map(|[_, b]| b).sum::<f64>() / n + floor;
    match brightness > 0.0 {
        true => (mean / brightness, (variance / n).sqrt() / brightness),
        // Both black is no difference; light where there was none is as large as can be.
        false => (if mean == 0.0 { 0.0 } else { f64::INFINITY }, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Channel;
    use crate::torture::Random;

    /// Sixteen pictures of noise around 1, the second half of each row multiplied by `factor`.
    fn noise(seed: u64, shared: f64, factor: f64) -> Pictures {
        let size = UVec2::new(32, 8);
        let image = |k: u64| {
            let (mut common, mut own) = (Random::new(k), Random::new(1000 + seed * 100 + k));
            let values = (0..size.x * size.y).map(|i| {
                let value = 1.0 + common.unit() - 0.5 + shared * (own.unit() - 0.5);
                (if i % size.x >= 16 { value * factor } else { value }) as f32
            });
            let values: Vec<f32> = values.collect();
            let channels = ["R", "G", "B"].map(|name| Channel { name: name.into(), values: values.clone() }).into();
            Image { full_size: size, origin: UVec2::ZERO, size, channels }
        };
        Pictures { images: (0..PICTURES as u64).map(image).collect(), invalid: 0 }
    }

    #[test]
    fn a_difference_is_found_in_its_tiles_and_noise_is_none() {
        let difference = noise(1, 0.01, 1.01).difference(&noise(2, 0.01, 1.0), 30);
        assert_eq!((difference.tiles, difference.at.x >= 16, difference.is_whole), (2, true, true), "{difference:?}");
        assert!((difference.tile - 0.01).abs() < 0.005, "{difference:?}");
        for seed in 0..200 {
            let none = noise(seed, 0.2, 1.0).difference(&noise(seed + 500, 0.2, 1.0), 30);
            assert!(!none.is_established() && !none.same_bits, "{seed}: {none:?}");
        }
        assert!(noise(1, 0.0, 1.0).difference(&noise(2, 0.0, 1.0), 30).same_bits);
    }

    #[test]
    fn differences_below_the_stated_one_do_not_count() {
        let none = noise(1, 0.0, 1.0009).difference(&noise(1, 0.0, 1.0), 30);
        assert!(!none.is_established(), "{none:?}");
        assert!(noise(1, 0.0, 1.002).difference(&noise(1, 0.0, 1.0), 30).is_established());
    }
}
