//! What rounding does to a picture: every path is followed in single and in double precision.

use std::time::{Duration, Instant};

use glam::{DVec3, UVec2};
use rayon::prelude::*;

use super::DoublePath;
use crate::error::{Error, Result};
use crate::film::{Channel, FilmSpec, Image};
use crate::integrator::Integrator;
use crate::load::Loaded;
use crate::measure::EPSILON;
use crate::render::{Render, SampleId, Settings};

/// Difference of two samples, relative to the greater one, above which they count as two ways.
const ANOTHER_WAY: f64 = 1e-2;

/// The differences between a picture in single precision and the same picture in double precision.
#[derive(Clone, Debug)]
pub struct PrecisionReport {
    /// Number of paths.
    pub paths: u64,
    /// Number of paths whose light differs by more than 1 %: rounding led them to another surface, or through glass instead of off it.
    pub parted: u64,
    /// Number of paths whose light is not finite in single and in double precision. They count as parted, and nowhere else.
    pub invalid: [u64; 2],
    /// Root mean square of the relative difference of the other paths' light.
    pub same_way: f64,
    /// √relMSE of the picture in single precision, with that in double precision as the reference.
    pub picture: f64,
    /// √relMSE of the noise of so many independent samples; `None` for a single sample per pixel.
    pub noise: Option<f64>,
    /// Mean of the picture in single precision over that in double precision, less 1.
    pub brightness: f64,
    /// Standard error of `brightness`, from the differences of the paths.
    pub brightness_error: f64,
    /// Time of all paths in single and in double precision, one path at a time, summed over the threads.
    pub times: [Duration; 2],
    /// The picture in double precision.
    pub image: Image,
}

/// Follows all paths of a picture twice: by the scene's integrator, which must be `path`, and in double precision.
///
/// - `is_cancelled`: asked for each row of pixels; a cancelled measurement has no result
///
/// # Errors
/// `Usage` for another integrator; those of [`DoublePath::new`].
pub fn difference(loaded: &Loaded, is_cancelled: &(dyn Fn() -> bool + Sync)) -> Result<Option<PrecisionReport>> {
    if loaded.entry.name != "path" {
        return Err(Error::Usage(format!("expected the integrator path, found {}", loaded.entry.name)));
    }
    let double = DoublePath::new(loaded)?;
    let spec = loaded.film.clone().without_layers();
    let settings = Settings::new(loaded.sampler);
    let render = |integrator: &dyn Integrator| Render::new(loaded.world.clone(), integrator, &spec, &settings);
    let renders = [render(&*loaded.integrator), render(&double)];
    let row = |y: u32| {
        let pixels = (spec.crop.min.x..spec.crop.max.x).map(|x| Pixel::of(&renders, UVec2::new(x, y), loaded.sampler.spp));
        (!is_cancelled()).then(|| pixels.collect::<Vec<Pixel>>())
    };
    let rows: Option<Vec<Vec<Pixel>>> = (spec.crop.min.y..spec.crop.max.y).into_par_iter().map(row).collect();
    Ok(rows.map(|rows| report(&rows.concat(), &spec, loaded.sampler.spp)))
}

/// Sums over the paths of a pixel.
#[derive(Clone, Copy, Default)]
struct Pixel {
    /// Light in single and in double precision.
    sums: [DVec3; 2],
    /// Squares of the light in double precision.
    squares: DVec3,
    /// Sum of the squares of the difference of the mean of the colours.
    difference_squares: f64,
    parted: u64,
    invalid: [u64; 2],
    /// Sum of the squares of the relative differences, over the paths that did not part.
    same_way: f64,
    times: [Duration; 2],
}

impl Pixel {
    fn of(renders: &[Render; 2], pixel: UVec2, spp: u64) -> Pixel {
        let mut all = Pixel::default();
        // All paths in one precision and then all in the other, so that the clock is not read for each path.
        let timed = |render: &Render| {
            let start = Instant::now();
            let sample = |index| DVec3::from(render.replay(SampleId { pixel: pixel.into(), index }, None).to_rgb().map(f64::from));
            let samples: Vec<DVec3> = (0..spp).map(sample).collect();
            (samples, start.elapsed())
        };
        let [(single, of_single), (double, of_double)] = [timed(&renders[0]), timed(&renders[1])];
        all.times = [of_single, of_double];
        single.into_iter().zip(double).for_each(|(a, b)| all.add(a, b));
        all
    }

    /// Adds the light of a path in single and in double precision.
    fn add(&mut self, a: DVec3, b: DVec3) {
        let is_invalid = [!a.is_finite(), !b.is_finite()];
        if is_invalid[0] || is_invalid[1] {
            self.invalid = [0, 1].map(|k| self.invalid[k] + u64::from(is_invalid[k]));
            self.parted += 1;
            return;
        }
        self.sums = [self.sums[0] + a, self.sums[1] + b];
        self.squares += b * b;
        self.difference_squares += ((a - b).element_sum() / 3.0).powi(2);
        // Reconstruction filters may make light negative.
        let greatest = a.abs().max(b.abs()).max_element();
        let relative = if greatest > 0.0 { (a - b).abs().max_element() / greatest } else { 0.0 };
        if relative > ANOTHER_WAY { self.parted += 1 } else { self.same_way += relative * relative }
    }
}

fn report(pixels: &[Pixel], spec: &FilmSpec, spp: u64) -> PrecisionReport {
    let (n, count) = (spp as f64, pixels.len() as f64);
    let paths = pixels.len() as u64 * spp;
    let sum = |of: &dyn Fn(&Pixel) -> f64| pixels.iter().map(of).sum::<f64>();
    let total = [0, 1].map(|k| sum(&|pixel| pixel.sums[k].element_sum() / 3.0));
    let mean = total[1] / (n * count);
    let floor = EPSILON * mean * mean;
    // √(1/3P Σ square / (reference² + ε)); nothing is 0 of black.
    let relative = |square: &dyn Fn(&Pixel) -> DVec3| {
        let of = |pixel: &Pixel| {
            let (square, reference) = (square(pixel), pixel.sums[1] / n);
            let term = |c: usize| if square[c] > 0.0 { square[c] / (reference[c] * reference[c] + floor) } else { 0.0 };
            (term(0) + term(1) + term(2)) / 3.0
        };
        (sum(&of) / count).sqrt()
    };
    let parted = pixels.iter().map(|pixel| pixel.parted).sum();
    // Standard deviation of the sum of all differences, as if the paths were independent. Their mean is small beside each of them, so that
    // the sum of their squares is the variance.
    let deviation = sum(&|pixel| pixel.difference_squares).sqrt();
    let of_light = |difference: f64| if difference == 0.0 { 0.0 } else { difference / total[1] };
    let variance = |pixel: &Pixel| (pixel.squares / n - (pixel.sums[1] / n).powf(2.0)) / (n - 1.0);
    let channel = |name: &str, of: fn(DVec3) -> f64| Channel {
        name: name.into(),
        values: pixels.iter().map(|pixel| of(pixel.sums[1] / n) as f32).collect(),
    };
    let channels = vec![channel("R", |c| c.x), channel("G", |c| c.y), channel("B", |c| c.z)];
    PrecisionReport {
        paths,
        parted,
        invalid: [0, 1].map(|k| pixels.iter().map(|pixel| pixel.invalid[k]).sum()),
        same_way: (sum(&|pixel| pixel.same_way) / (paths - parted).max(1) as f64).sqrt(),
        picture: relative(&|pixel| ((pixel.sums[0] - pixel.sums[1]) / n).powf(2.0)),
        noise: (spp > 1).then(|| relative(&variance)),
        brightness: of_light(total[0] - total[1]),
        brightness_error: of_light(deviation),
        times: [0, 1].map(|k| pixels.iter().map(|pixel| pixel.times[k]).sum()),
        image: Image { full_size: spec.size, origin: spec.crop.min, size: spec.crop.size(), channels },
    }
}
