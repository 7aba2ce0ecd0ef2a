//! Outliers: all samples that cause the noise are found by rendering a few pixels again.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;
use pt::film::{Film, FilmSpec, MomentFilm};
use pt::integrator::{CameraSample, Context, Estimator, Integrator};
use pt::math::{Spectrum, Vec2};
use pt::measure::{Outliers, find_outliers, noisiest_pixels, worst_of_pixel};
use pt::render::{Render, SampleId, Settings, Silent};
use pt::sampler::dimension::{self, Use};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;
use pt::world::World;

use crate::scenes::probe;

/// Integrator of pictures that are only noise.
#[derive(Clone, Copy)]
enum Speckle {
    /// The radiance 1 everywhere.
    Even,
    /// Uniform noise, with one bright sample at this position.
    Firefly(Vec2),
    /// Noise of 1/(u + 10⁻⁴), twice as bright in the right half.
    Heavy,
}

impl Integrator for Speckle {
    fn prepare(&self, _: Arc<dyn Scene>, _: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(*self)
    }
}

impl Estimator for Speckle {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        let u = cx.numbers.get_1d(dimension::vertex(0, Use::Bsdf));
        Spectrum::gray(match *self {
            Speckle::Even => 1.0,
            Speckle::Firefly(raster) if camera.raster == raster => 1000.0,
            Speckle::Firefly(_) => u,
            Speckle::Heavy => (1.0 + (camera.raster.x / WIDTH as f32).round()) / (u + 1e-4),
        })
    }
}

const WIDTH: u32 = 90;
const HEIGHT: u32 = 70;

fn rendered(speckle: Speckle, kind: Kind) -> (Render, MomentFilm) {
    let scene: Arc<dyn Scene> = Arc::new(World::builder(probe(DVec3::ZERO, DVec3::X)).build().expect("an empty scene"));
    let sampler = SamplerSpec { kind, seed: 9, spp: 20, scramblings: 2 };
    let mut film = MomentFilm::new(FilmSpec::new(WIDTH, HEIGHT));
    let mut render = Render::new(scene, &speckle, film.spec(), &Settings::new(sampler));
    render.advance(20, &mut film, &Silent);
    (render, film)
}

fn on(threads: usize, work: impl FnOnce() -> Outliers + Send) -> Outliers {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had").install(work)
}

#[test]
fn a_planted_firefly_is_the_worst_sample() {
    for kind in [Kind::Independent, Kind::Sobol] {
        let id = SampleId { pixel: (61, 7), index: 13 };
        let raster = rendered(Speckle::Even, kind).0.camera(id).raster;
        let (render, film) = rendered(Speckle::Firefly(raster), kind);
        let found = on(1, || find_outliers(&render, &film, 3));
        let first = found.samples[0];
        assert_eq!((first.id, first.value), (id, Spectrum::gray(1000.0)));
        // The bright sample contributes 1000² · 19/20 to the variance, and the other 126000 samples 1/12 each, relative to the same mean.
        assert!((0.9..1.0).contains(&first.share), "{first:?}");
        assert_eq!(on(3, || find_outliers(&render, &film, 3)), found);
    }
}

/// Among the samples of its pixel a bright one makes nearly all of the noise; the samples that are asked for are searched, and a deadline
/// ends the search after one sample.
#[test]
fn a_planted_firefly_is_the_worst_sample_of_its_pixel() {
    let id = SampleId { pixel: (61, 7), index: 13 };
    let raster = rendered(Speckle::Even, Kind::Sobol).0.camera(id).raster;
    let (render, film) = rendered(Speckle::Firefly(raster), Kind::Sobol);
    let later = Instant::now() + Duration::from_secs(600);
    let found = worst_of_pixel(&render, id.pixel, 0..20, later).expect("samples");
    assert_eq!((found.worst.id, found.worst.value, found.searched), (id, Spectrum::gray(1000.0), 20));
    // The others are below 1: their mean is below 1000/20 + 1, and the firefly's part of Σ(y − m)² = 1000²·19/20 is 19/20.
    assert!((50.0..51.0).contains(&found.mean) && (0.94..0.96).contains(&found.worst.share), "{found:?}");
    let early = worst_of_pixel(&render, id.pixel, 14..20, later).expect("samples");
    assert!(early.searched == 6 && (14..20).contains(&early.worst.id.index) && early.worst.value.to_rgb()[0] < 1.0, "{early:?}");
    assert_eq!(worst_of_pixel(&render, id.pixel, 0..20, Instant::now()).expect("one sample").searched, 1);
    assert_eq!(worst_of_pixel(&render, id.pixel, 0..0, later), None);
    assert_eq!(noisiest_pixels(&film, 1)[0].0, id.pixel);
}

/// A search of all samples by the formula gives the noise of each pixel: the list is in its order, and the shares of all pixels add up to 1.
#[test]
fn the_noisiest_pixels_are_those_of_all_samples() {
    let (render, film) = rendered(Speckle::Heavy, Kind::Independent);
    let later = Instant::now() + Duration::from_secs(600);
    let all = noisiest_pixels(&film, usize::MAX);
    assert_eq!(all.len(), (WIDTH * HEIGHT) as usize, "each pixel has noise");
    assert!((all.iter().map(|(_, share)| share).sum::<f64>() - 1.0).abs() < 1e-9);
    assert!(all.windows(2).all(|pair| pair[0].1 >= pair[1].1), "the noisiest come first");
    assert_eq!(noisiest_pixels(&film, 12), all[..12]);
    assert_eq!(noisiest_pixels(&film, 0), []);
    // The worst sample has the same share of the picture by both ways: of the picture, and of its pixel.
    let worst = find_outliers(&render, &film, 1).samples[0];
    let pixel = all.iter().find(|(pixel, _)| *pixel == worst.id.pixel).expect("a share").1;
    let within = worst_of_pixel(&render, worst.id.pixel, 0..20, later).expect("samples").worst;
    assert!(within.id == worst.id && (pixel * within.share / worst.share - 1.0).abs() < 1e-9, "{worst:?} {within:?}");
    assert_eq!(noisiest_pixels(&rendered(Speckle::Even, Kind::Independent).1, 5), []);
}

/// A search of all samples by the formula gives the same list, and the shares of all samples add up to 1.
#[test]
fn the_worst_are_those_of_a_search_of_all_samples() {
    let (render, film) = rendered(Speckle::Heavy, Kind::Independent);
    let values: Vec<Vec<f64>> = (0..WIDTH * HEIGHT)
        .map(|p| {
            (0..20).map(|index| f64::from(render.replay(SampleId { pixel: (p % WIDTH, p / WIDTH), index }, None).to_rgb()[0])).collect()
        })
        .collect();
    let means: Vec<f64> = values.iter().map(|pixel| pixel.iter().sum::<f64>() / 20.0).collect();
    let floor = 0.01 * (means.iter().sum::<f64>() / means.len() as f64).powi(2);
    let below = |p: u32| {
        let near = |q: &u32| (q % WIDTH).abs_diff(p % WIDTH) <= 1 && (q / WIDTH).abs_diff(p / WIDTH) <= 1;
        let mut around: Vec<f64> = (0..WIDTH * HEIGHT).filter(near).map(|q| means[q as usize].powi(2)).collect();
        around.sort_by(f64::total_cmp);
        around[around.len() / 2] + floor
    };
    let mut all: Vec<(f64, SampleId)> = vec![];
    for p in 0..WIDTH * HEIGHT {
        let below = below(p);
        let noise = |(index, y): (usize, &f64)| {
            let id = SampleId { pixel: (p % WIDTH, p / WIDTH), index: index as u64 };
            ((y - means[p as usize]).powi(2) / below, id)
        };
        all.extend(values[p as usize].iter().enumerate().map(noise));
    }
    let total: f64 = all.iter().map(|(noise, _)| noise).sum();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));

    let found = find_outliers(&render, &film, 12);
    assert!(found.complete);
    assert_eq!(found.samples.len(), 12);
    for (found, (noise, id)) in found.samples.iter().zip(&all) {
        assert_eq!(found.id, *id);
        assert!((found.share - noise / total).abs() < 1e-9, "{found:?}: {}", noise / total);
    }
}

/// If all samples are equal, the list is empty. If they differ only by uniform noise, the list states that it may be incomplete.
#[test]
fn even_pictures_have_no_worst_sample() {
    let (render, film) = rendered(Speckle::Even, Kind::Independent);
    assert_eq!(find_outliers(&render, &film, 5), Outliers { samples: vec![], complete: true });
    let (render, film) = rendered(Speckle::Firefly(Vec2::NEG_ONE), Kind::Independent);
    let found = find_outliers(&render, &film, 5);
    assert!(!found.complete && found.samples.len() == 5, "{found:?}");
    assert!(found.samples[0].share < 1e-3);
}
