//! Targets for a region of a picture, and for most of its tiles.

use std::path::Path;
use std::sync::Arc;

use assert_cmd::Command;
use glam::UVec2;
use pt::build::Source;
use pt::describe::{self, Files};
use pt::film::{Allocation, Crop, Film, FilmSpec, MomentFilm, Moments, PixelSums, Wave};
use pt::integrator::Integrator;
use pt::integrators::nee::Nee;
use pt::math::Spectrum;
use pt::measure::{RelativeError, Scope, StopCondition, render_until};
use pt::render::{Render, Settings, Silent};
use pt::sampler::{ErrorEstimator, Kind, SamplerSpec};
use pt::scene::Scene;

use crate::accuracy::is_between;
use crate::random::Random;

const CORNELL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box.json");

/// The film of a scene's picture with these samples, and its specification.
fn film(scene: &Arc<dyn Scene>, spec: &FilmSpec, kind: Kind, spp: u64) -> MomentFilm {
    let sampler = SamplerSpec { kind, spp, ..SamplerSpec::default() };
    let mut film = MomentFilm::new(spec.clone());
    let integrator: &dyn Integrator = &Nee::default();
    let mut render = Render::new(scene.clone(), integrator, spec, &Settings::new(sampler));
    render_until(&mut render, &mut film, &StopCondition { samples: spp, time: None, target: None, patience: None }, &Silent);
    film
}

/// The part of a picture in a rectangle has the bits and the error of a render of the rectangle alone, with every sampler, and where pixels
/// have different numbers of samples.
#[test]
fn a_region_has_the_error_of_its_crop() {
    let text = std::fs::read(CORNELL).expect("a scene");
    let root = describe::root(&text, CORNELL).expect("JSON");
    let described = describe::read(&root, CORNELL).expect("a scene");
    let built = pt::build::build(&described, Source { root: &root, file: CORNELL, files: &Files::within("") }).expect("a world");
    let scene: Arc<dyn Scene> = Arc::new(built.world);
    let crop = Crop { min: UVec2::new(9, 20), max: UVec2::new(30, 33) };
    let whole = FilmSpec { crop: Crop { min: UVec2::new(2, 3), max: UVec2::new(40, 36) }, ..FilmSpec::new(48, 36) };
    let levels = (0..whole.crop.pixel_count()).map(|i| (i % 3) as u8).collect();
    let uneven = FilmSpec { allocation: Allocation::new(levels), ..whole.clone() };
    for (spec, kind) in [(&whole, Kind::Sobol), (&whole, Kind::Independent), (&whole, Kind::Halton), (&uneven, Kind::Sobol)] {
        let all = film(&scene, spec, kind, 12);
        let cut = all.cropped(crop);
        let alone = film(&scene, cut.spec(), kind, 12);
        assert!(cut.blocks().map(|(wave, sums)| (wave, sums.numbers())).eq(alone.blocks().map(|(wave, sums)| (wave, sums.numbers()))));
        let error = RelativeError::of(&alone).expect("an error");
        assert_eq!(Scope::Region(crop).error(&all), Some(error), "{kind:?}");
        assert_ne!(Scope::Picture.error(&all), Some(error));
    }
}

const EDGE: u32 = 192;
/// Six tiles a side.
const SIDE: u32 = EDGE / 32;

/// Most tiles have at most the stated error: in at least 95 % of 100 pictures, all of whose tiles are equally noisy, so that chance alone
/// decides which are the worst. The bound is at most a fourth above the error that it bounds.
#[test]
fn most_tiles_have_at_most_the_stated_error() {
    type Draw = fn(&mut Random) -> f64;
    let uniform: Draw = |random| 2.0 * random.unit();
    let exponential: Draw = |random| -(1.0 - random.unit()).ln();
    for (name, draw, estimator) in [
        ("uniform", uniform, ErrorEstimator::Samples),
        ("exponential", exponential, ErrorEstimator::Samples),
        ("scrambled", uniform, ErrorEstimator::Scramblings(2)),
    ] {
        let shares = [0.8, 0.97];
        let (mut held, mut excess) = ([0; 2], [0.0; 2]);
        for seed in 0..100 {
            let film = noise(draw, estimator, seed);
            let mut errors = true_errors(&film);
            errors.sort_by(f64::total_cmp);
            for (k, share) in shares.into_iter().enumerate() {
                let bound = Scope::Tiles { share }.error(&film).expect("an error").below(0.95).expect("a bound");
                let truth = errors[(share * errors.len() as f64).ceil() as usize - 1];
                held[k] += u64::from(truth <= bound);
                excess[k] += bound / truth / 100.0;
            }
        }
        for ((share, held), excess) in shares.into_iter().zip(held).zip(excess) {
            assert!(is_between(held, 100, 0.95, 1.0), "{name}, {share}: {held} of 100");
            assert!(excess < 1.25, "{name}, {share}: {excess}");
        }
    }
}

/// Tiles without any noise do not hide the others: where more than half of the tiles are exact, and all must be good, the bound is that of
/// the noisy ones; where three fifths suffice it is 0.
#[test]
fn exact_tiles_leave_the_bound_of_the_others() {
    let mut random = Random::new(5);
    let mut block = PixelSums::with_capacity(ErrorEstimator::Samples, (EDGE * EDGE) as usize);
    for i in 0..EDGE * EDGE {
        let is_exact = i / EDGE < 4 * 32;
        let value = |random: &mut Random| if is_exact { 1.0 } else { 0.5 + random.unit() };
        let moments = (0..16).map(|_| Moments::of(Spectrum::gray(value(&mut random) as f32))).reduce(|a, b| a.join(&b)).expect("samples");
        block.push(&[moments], moments.gray);
    }
    let mut film = MomentFilm::new(FilmSpec::new(EDGE, EDGE));
    film.add(Wave { first: 0, level: 4 }, block);
    let bound = |share: f64| Scope::Tiles { share }.error(&film).expect("an error").below(0.95).expect("a bound");
    // Half the width of the noise over √3, of 16 samples: 7.2 %.
    let noisy = 0.5 / 3f64.sqrt() / 4.0;
    assert!((noisy..1.3 * noisy).contains(&bound(0.97)), "{}", bound(0.97));
    assert!((0.9 * noisy..1.3 * noisy).contains(&bound(0.66)), "{}", bound(0.66));
    assert_eq!(bound(0.3), 0.0);
}

/// A picture of noise about 1 with 16 samples per pixel.
fn noise(draw: fn(&mut Random) -> f64, estimator: ErrorEstimator, seed: u64) -> MomentFilm {
    let mut random = Random::new(seed);
    let mut block = PixelSums::with_capacity(estimator, (EDGE * EDGE) as usize);
    let k = estimator.sequences();
    for _ in 0..EDGE * EDGE {
        let mut sample = |_| Moments::of(Spectrum::gray(draw(&mut random) as f32));
        let mut sequence = |_| (0..16 / k).map(&mut sample).reduce(|a, b| a.join(&b)).expect("a sample");
        let sequences: Vec<Moments> = (0..k).map(&mut sequence).collect();
        block.push(&sequences, sequences.iter().fold([0.0; 2], |sum, moments| Moments::join_gray(sum, &moments.gray)));
    }
    let mut film = MomentFilm::new(FilmSpec::new(EDGE, EDGE));
    film.add(Wave { first: 0, level: 4 }, block);
    film
}

/// The relative errors of the tiles against the true value 1: √(mean (x − 1)² / 1.01).
fn true_errors(film: &MomentFilm) -> Vec<f64> {
    let image = film.image();
    let values = image.channel("R").expect("red");
    let mut squares = vec![0.0; (SIDE * SIDE) as usize];
    for (i, x) in (0..).zip(values) {
        squares[(i / EDGE / 32 * SIDE + i % EDGE / 32) as usize] += (f64::from(*x) - 1.0).powi(2) / 1.01;
    }
    squares.into_iter().map(|sum| (sum / 1024.0).sqrt()).collect()
}

fn pt(folder: &Path, code: i32, args: &[&str]) -> String {
    let size: &[&str] = if args.contains(&"--size") { &[] } else { &["--size", "96x72"] };
    let all = [&[CORNELL, "-o", "x.exr"], size, args].concat();
    let output = Command::cargo_bin("pt").expect("the program").current_dir(folder).args(all).output().expect("a run");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{args:?}\n{text}");
    text
}

/// The program stops when the region or the tiles are good enough, and says what they have.
#[test]
fn regions_and_tiles_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let pt = |code: i32, args: &[&str]| pt(folder.path(), code, args);
    let region = pt(7, &["--target", "0.01%", "--region", "20,60,10,50", "--spp", "16"]);
    assert!(region.contains("target 0.01 % in 20,60,10,50: not met\n"), "{region}");
    let alone = pt(0, &["--crop", "20,60,10,50", "--spp", "16"]);
    let error = |text: &str| text.split(" · ").find(|part| part.starts_with("relative error")).expect("an error").to_owned();
    let told = region.split("region 20,60,10,50").nth(1).expect("a line");
    assert_eq!(error(told), error(&alone));
    assert_ne!(error(&region), error(&alone));
    let met = pt(0, &["--target", "10%", "--region", "20,60,10,50", "--spp", "4096"]);
    assert!(met.contains("target 10 % in 20,60,10,50: met (95 % sure)"), "{met}");
    // The number of samples ends a render that does not reach the target.
    let tiles = pt(0, &["--target", "15%", "--tiles", "80%", "--size", "192x144", "--spp", "1024"]);
    for said in
        ["target 15 % on 80 % of the tiles: met (95 % sure)", "80 % of the 30 tiles · relative error at most ", "the worst tile, --crop "]
    {
        assert!(tiles.contains(said), "{said}: {tiles}");
    }
    assert!(pt(7, &["--target", "0.1%", "--tiles", "90%", "--spp", "8"]).contains("target 0.1 % on 90 % of the tiles: "));
    for (args, said) in [
        (&["--target", "1%", "--region", "20,20,10,50"] as &[&str], "expected X0 < X1 and Y0 < Y1 within the picture, 0,96,0,72"),
        (&["--target", "1%", "--region", "20,97,10,50"], "within the picture"),
        (&["--target", "1%", "--region", "20,27,10,17"], "expected at least 64 pixels"),
        (&["--target", "1%", "--tiles", "90%", "--size", "9x7", "--spp", "2"], "is too small: a tile needs at least 64 pixels"),
        (&["--target", "1%", "--tiles", "90%", "-i", "light"], "expected an integrator"),
        (&["--target", "1%", "--tiles", "90%", "--confidence", "90%"], "a confidence of 95 % or more"),
        (&["--region", "20,60,10,50"], "--target"),
        (&["--target", "1%", "--region", "20,60,10,50", "--resume"], "cannot be used with"),
    ] {
        let text = pt(2, args);
        assert!(text.contains(said), "{args:?}: {text}");
    }
    let kept = pt(2, &["--target", "1%", "--tiles", "90%", "-o", "x.ptc"]);
    assert!(kept.contains("a part does not keep the error of a region or of tiles"), "{kept}");
}
