//! Films and picture files: filters, waves, means and errors, tone curves, formats.

use std::sync::Arc;

use glam::{DVec2, DVec3, UVec2, Vec2};
use proptest::prelude::*;
use pt::film::pixel_sums::estimate;
use pt::film::{Channel, Crop, Film, FilmSpec, Filter, Image, MomentFilm, Moments, PixelSums, SampleSet, Wave};
use pt::integrators::path::Path;
use pt::light::{Environment, Light};
use pt::math::{Rgb, Spectrum, float::ONE_MINUS_EPSILON};
use pt::output::{Attributes, Curve, Format, Tonemap, Value, exr, pfm, png, replace, tonemap::srgb, write};
use pt::sampler::{ErrorEstimator, Kind, SamplerSpec};
use pt::world::World;

use crate::random::{Random, cases};
use crate::scenes::{self, probe};

/// Name, filter, radius and formula of a filter.
type Known = (&'static str, Filter, f64, Box<dyn Fn(f64) -> f64>);

fn filters() -> Vec<Known> {
    let gauss = |x: f64, sigma: f64| (-x * x / (2.0 * sigma * sigma)).exp();
    vec![
        ("box", Filter::pixel_box(0.5), 0.5, Box::new(|_| 1.0)),
        ("wide box", Filter::pixel_box(1.5), 1.5, Box::new(|_| 1.0)),
        ("tent", Filter::tent(1.25), 1.25, Box::new(|x: f64| 1.25 - x.abs())),
        ("gaussian", Filter::gaussian(1.5, 0.5), 1.5, Box::new(move |x| gauss(x, 0.5) - gauss(1.5, 0.5))),
        // For σ ≫ r the formula is a parabola.
        ("narrow gaussian", Filter::gaussian(1.5, 0.01), 1.5, Box::new(move |x| gauss(x, 0.01) - gauss(1.5, 0.01))),
        ("broad gaussian", Filter::gaussian(2.0, 1e9), 2.0, Box::new(|x: f64| 4.0 - x * x)),
        ("mitchell", Filter::mitchell(2.0, 1.0 / 3.0, 1.0 / 3.0), 2.0, Box::new(|x| cubic(x, 1.0 / 3.0, 1.0 / 3.0))),
        ("catmull-rom", Filter::mitchell(3.0, 0.0, 0.5), 3.0, Box::new(|x| cubic(x / 1.5, 0.0, 0.5))),
        ("b-spline", Filter::mitchell(2.0, 1.0, 0.0), 2.0, Box::new(|x| cubic(x, 1.0, 0.0))),
    ]
}

/// Mitchell and Netravali, equation 8.
fn cubic(x: f64, b: f64, c: f64) -> f64 {
    let x = x.abs();
    let [x3, x2] = [x * x * x, x * x];
    if x < 1.0 {
        ((12.0 - 9.0 * b - 6.0 * c) * x3 + (-18.0 + 12.0 * b + 6.0 * c) * x2 + (6.0 - 2.0 * b)) / 6.0
    } else {
        ((-b - 6.0 * c) * x3 + (6.0 * b + 30.0 * c) * x2 + (-12.0 * b - 48.0 * c) * x + (8.0 * b + 24.0 * c)) / 6.0
    }
}

/// ∫f over [−r, r] by the midpoint rule, with an error below 10⁻⁷ for the functions here.
fn integral(radius: f64, f: impl Fn(f64) -> f64) -> f64 {
    let n = 20_000;
    let width = 2.0 * radius / f64::from(n);
    (0..n).map(|i| f((f64::from(i) + 0.5) * width - radius)).sum::<f64>() * width
}

/// The mean of g(offset, weight) over 2¹⁶ Hammersley points.
fn mean(filter: &Filter, g: impl Fn(DVec2, f64) -> f64) -> f64 {
    let n = 1u32 << 16;
    let each = |i: u32| {
        let u = Vec2::new((i as f32 + 0.5) / n as f32, (i.reverse_bits() >> 8) as f32 / 16_777_216.0);
        let (offset, weight) = filter.sample(u);
        g(offset.as_dvec2(), f64::from(weight))
    };
    (0..n).map(each).sum::<f64>() / f64::from(n)
}

/// Integration error of the points, about 17/2¹⁶.
const POINTS: f64 = 4e-4;

/// The weighted mean of g(x)·h(y) is ∫fg ∫fh / (∫f)².
#[test]
fn filters_are_their_formulas() {
    type Test = (&'static str, fn(f64) -> f64);
    let tests: [Test; 5] =
        [("1", |_| 1.0), ("x", |x| x), ("x²", |x| x * x), ("cos 2x", |x| (2.0 * x).cos()), ("x > 0", |x| f64::from(x > 0.0))];
    for (name, filter, radius, f) in filters() {
        let whole = integral(radius, &f);
        for (of_x, g) in tests {
            for (of_y, h) in tests {
                let expected = integral(radius, |x| f(x) * g(x)) * integral(radius, |y| f(y) * h(y)) / (whole * whole);
                let found = mean(&filter, |p, weight| weight * g(p.x) * h(p.y));
                let tolerance = POINTS * (1.0 + radius * radius);
                assert!((found - expected).abs() < tolerance, "{name}: {of_x} times {of_y} is {found}, not {expected}");
            }
        }
    }
}

/// Offsets have a density proportional to |f|, and the mean of |weight| is (∫|f|/∫f)².
#[test]
fn offsets_follow_the_filters_size() {
    for (name, filter, radius, f) in filters() {
        let size = integral(radius, |x| f(x).abs());
        let variance = integral(radius, |x| f(x).abs() * x * x) / size;
        let found = mean(&filter, |p, _| p.y * p.y);
        assert!((found - variance).abs() < POINTS * (1.0 + radius * radius), "{name}: {found} is not {variance}");
        let expected = (size / integral(radius, &f)).powi(2);
        let found = mean(&filter, |_, weight| weight.abs());
        assert!((found - expected).abs() < POINTS * expected, "{name}: {found} is not {expected}");
    }
}

/// The integral of |f| up to the offset is the fraction u, up to the rounding of the offset to f32.
#[test]
fn offsets_invert_the_integral() {
    for (name, filter, radius, f) in filters() {
        let whole = integral(radius, |x| f(x).abs());
        for k in 0..=512 {
            let u = (k as f32 / 512.0).min(ONE_MINUS_EPSILON);
            let (offset, _) = filter.sample(Vec2::new(u, 0.25));
            // From the left end to the offset, by the same midpoint rule.
            let half = 0.5 * (f64::from(offset.x) + radius);
            let share = integral(half, |x| f(x + half - radius).abs()) / whole;
            // The midpoint rule has an error of 10⁻⁷.
            assert!((share - f64::from(u)).abs() < 1e-6, "{name}: {share} of it lies left of {}, not {u}", offset.x);
        }
    }
}

/// All weights are ±(∫|f|/∫f)², exactly 1 for filters without negative lobes, so that a constant stays constant.
#[test]
fn weights_have_one_size() {
    for (name, filter, radius, f) in filters() {
        let expected = (integral(radius, |x| f(x).abs()) / integral(radius, &f)).powi(2);
        let worst = |size: f64| mean(&filter, |_, weight| f64::from((weight.abs() - size).abs() > 1e-6 * size));
        assert_eq!(worst(expected), 0.0, "{name}: {expected}");
        if filter.is_positive() {
            assert_eq!(mean(&filter, |_, weight| f64::from(weight != 1.0)), 0.0, "{name}");
        }
    }
}

/// A uniform sky gives a uniform picture, to the last bit, for each filter without negative lobes.
#[test]
fn a_constant_picture_stays_constant() {
    let mut world = World::builder(probe(DVec3::Z, DVec3::ZERO));
    world.light(Light::Environment(Environment { radiance: Rgb::gray(0.7) }));
    let scene = Arc::new(world.build().expect("a sky"));
    for (name, filter, ..) in filters().into_iter().filter(|(_, filter, ..)| filter.is_positive()) {
        for kind in [Kind::Independent, Kind::Sobol] {
            let sampler = SamplerSpec { kind, spp: 16, ..SamplerSpec::default() };
            let image =
                scenes::picture(scene.clone(), &Path::default(), FilmSpec { filter: filter.clone(), ..FilmSpec::new(8, 8) }, sampler);
            assert!(image.channel("R").expect("red").iter().all(|value| *value == 0.7), "{name}");
        }
    }
}

/// Second moments are r²/3 and r²/6 for box and tent. For B + 2C = 1 that of the cubic is B/3: 1/3 for the B-spline, 0 for Catmull–Rom.
#[test]
fn known_variances() {
    let variance = |filter: &Filter| mean(filter, |p, weight| weight * p.x * p.x);
    let known = [
        (Filter::pixel_box(0.5), 0.25 / 3.0),
        (Filter::tent(2.0), 4.0 / 6.0),
        (Filter::mitchell(2.0, 1.0, 0.0), 1.0 / 3.0),
        (Filter::mitchell(2.0, 1.0 / 3.0, 1.0 / 3.0), 1.0 / 9.0),
        (Filter::mitchell(2.0, 0.0, 0.5), 0.0),
    ];
    for (filter, expected) in known {
        assert!((variance(&filter) - expected).abs() < 2.0 * POINTS, "{filter:?}: {} is not {expected}", variance(&filter));
    }
}

#[test]
fn only_mitchell_has_negative_weights() {
    for (name, filter, ..) in filters() {
        let share = mean(&filter, |_, weight| f64::from(weight < 0.0));
        assert_eq!(share > 0.01, ["mitchell", "catmull-rom"].contains(&name), "{name}: {share}");
    }
}

proptest! {
    #![proptest_config(cases(10_000))]

    /// Samples are finite and inside the radius for all parameters, also at the corners of the square.
    #[test]
    fn offsets_stay_inside(radius in -20i32..20, sigma in -60i32..60, [b, c] in [0f32..=1.0, 0f32..=1.0], u in [0f32..1.0, 0f32..1.0]) {
        let (radius, sigma) = (2f32.powi(radius), 2f32.powi(sigma));
        let filters = [Filter::pixel_box(radius), Filter::tent(radius), Filter::gaussian(radius, sigma), Filter::mitchell(radius, b, c)];
        for filter in filters {
            for u in [u, [0.0, u[1]], [ONE_MINUS_EPSILON, 0.0], [0.5, ONE_MINUS_EPSILON]] {
                let (offset, weight) = filter.sample(u.into());
                prop_assert!(offset.abs().max_element() <= radius, "{:?} at {:?}: {}", filter, u, offset);
                prop_assert!(weight.is_finite(), "{:?} at {:?}: {}", filter, u, weight);
            }
        }
    }

    /// Waves follow one another without gaps, aligned to their own length, and end exactly at the total.
    #[test]
    fn waves_cover_exactly(total in 0u64..2000, max_level in 0u32..12) {
        let mut done = 0;
        while let Some(wave) = Wave::next(done, total, max_level) {
            prop_assert_eq!(wave.first, done);
            prop_assert_eq!(wave.first % wave.samples(), 0);
            prop_assert!(wave.level <= max_level);
            done += wave.samples();
        }
        prop_assert_eq!(done, total);
    }

    /// The first wave is one sample, so that a picture is shown at once. All others are as long as possible.
    #[test]
    fn waves_are_the_longest(done: u64, left: u64, shift in 0u32..64, max_level in 0u32..63) {
        let done = done >> shift << (shift / 2);
        let total = done.saturating_add(left);
        prop_assume!(done < total);
        let wave = Wave::next(done, total, max_level).expect("something is left");
        let fits = |level: u32| u128::from(done).is_multiple_of(1 << level) && u128::from(done) + (1 << level) <= u128::from(total);
        prop_assert!(wave.first == done && fits(wave.level) && wave.level <= max_level);
        prop_assert!(done == 0 && wave.level == 0 || done > 0 && (wave.level == max_level || !fits(wave.level + 1)));
    }

    /// Mean Σx/n and its standard error √(Σ(x − mean)²/(n (n − 1))), however the samples come in waves.
    #[test]
    fn the_film_keeps_mean_and_error(samples in prop::collection::vec(0f32..100.0, 2..40), max_level in 0u32..7) {
        let image = filmed(&samples, max_level).image();
        let n = samples.len() as f64;
        let mean = samples.iter().map(|&x| f64::from(x)).sum::<f64>() / n;
        let error = (samples.iter().map(|&x| (f64::from(x) - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
        // One rounding to f32. The standard error also has the cancellation of Σx² − (Σx)²/n: √(2⁻⁵³·40·10⁴) at most.
        let near = |found: f32, exact: f64, lost: f64| (f64::from(found) - exact).abs() <= exact * 1e-6 + lost;
        prop_assert!(near(image.channel("R").expect("red")[0], mean, 0.0));
        prop_assert!(near(image.channel("StdErr.R").expect("an error")[0], error, 1e-5));
        prop_assert!(near(image.channel("G").expect("green")[4], 3.0 * mean, 0.0));
        prop_assert!(near(image.channel("StdErr.G").expect("an error")[4], 3.0 * error, 3e-5));
    }
}

/// Film of five pixels, with the samples in the first and three times the samples in the last. The black ones between them are so many
/// that the two share no variance.
fn filmed(samples: &[f32], max_level: u32) -> MomentFilm {
    let mut film = MomentFilm::new(FilmSpec::new(5, 1));
    while let Some(wave) = Wave::next(film.samples(), samples.len() as u64, max_level) {
        let of_wave = &samples[wave.first as usize..][..wave.samples() as usize];
        let sum = |factor: f32| of_wave.iter().map(|&x| Moments::of(Spectrum::gray(x) * factor)).reduce(|a, b| a.join(&b));
        film.add(wave, PixelSums::of_samples(&[1.0, 0.0, 0.0, 0.0, 3.0].map(|factor| sum(factor).expect("a wave has samples"))));
    }
    film
}

#[test]
fn textbook_samples() {
    // Mean 5, s² = 32/7, so the mean's standard error is √(4/7).
    let film = filmed(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0], 3);
    let image = film.image();
    // (2 + 3·4 + 2·5 + 7 + 9)/8
    assert_eq!((film.colors().rgb(0, 0), film.colors().rgb(4, 0)), ([5.0; 3], [15.0; 3]));
    assert_eq!(image.rgb(0, 0), [5.0; 3]);
    assert_eq!(image.channel("StdErr.B").expect("an error")[0], (4f64 / 7.0).sqrt() as f32);
    // Equal samples have no error, in spite of the rounding of 0.1².
    let equal = filmed(&[0.1; 37], 6).image();
    assert!(equal.channel("StdErr.R").expect("an error")[0] < 1e-8);
    assert_eq!(filmed(&[1.0], 0).image().channel("StdErr.R"), None, "one sample tells nothing of its error");
    assert_eq!(filmed(&[1.0, 2.0], 1).image().channel("SampleCount.Y"), Some([2.0; 5].as_slice()));
    assert_eq!(filmed(&[], 0).image().rgb(1, 0), [0.0; 3], "black before the first wave");
    assert_eq!(filmed(&[], 0).colors().rgb(1, 0), [0.0; 3], "black before the first wave");
}

/// Four scramblings of the means 1, 2, 3, 6: mean 3, Σ(m − 3)² = 14, so the mean's variance is 14/(4·3).
#[test]
fn scramblings_tell_the_error_by_their_means() {
    let samples = |n: u64| (0..n).map(|i| [1.0, 2.0, 3.0, 6.0][i as usize % 4]).collect::<Vec<f32>>();
    for (n, max_level) in [(8, 0), (8, 3), (24, 6), (256, 1), (256, 6)] {
        let image = dealt(4, &samples(n), max_level);
        assert_eq!(image.rgb(0, 0), [3.0; 3], "{n} samples");
        assert_eq!(image.channel("StdErr.G").expect("an error")[0], (14f64 / 12.0).sqrt() as f32, "{n} samples");
    }
    // Variation within a scrambling does not change its mean.
    let even = dealt(2, &[0.0, 9.0, 9.0, 0.0, 0.0, 9.0, 9.0, 0.0], 6);
    assert_eq!((even.rgb(0, 0), even.channel("StdErr.R")), ([4.5; 3], Some([0.0].as_slice())));
    assert_eq!(dealt(4, &samples(7), 6).channel("StdErr.R"), None, "two samples each at least");
    assert_eq!(dealt(1, &samples(64), 6).channel("StdErr.R"), None, "one scrambling tells nothing");
}

/// Film of one pixel whose samples are dealt to k scramblings in turn.
fn dealt(k: u32, samples: &[f32], max_level: u32) -> Image {
    let mut film = MomentFilm::new(FilmSpec::new(1, 1));
    while let Some(wave) = Wave::next(film.samples(), samples.len() as u64, max_level) {
        let mut block = PixelSums::with_capacity(ErrorEstimator::Scramblings(k), 1);
        let sequence = |r: u64| {
            let own = wave.range().filter(|i| i % u64::from(k) == r).map(|i| Moments::of(Spectrum::gray(samples[i as usize])));
            own.reduce(|a, b| a.join(&b)).unwrap_or_default()
        };
        block.push(&(0..k.into()).map(sequence).collect::<Vec<_>>(), [0.0; 2]);
        film.add(wave, block);
    }
    film.image()
}

#[test]
fn a_crop_knows_its_place() {
    let (min, max) = (UVec2::new(3, 5), UVec2::new(7, 8));
    let spec = FilmSpec { crop: Crop { min, max }, ..FilmSpec::new(10, 20) };
    assert_eq!((spec.aspect(), spec.crop.pixel_count()), (0.5, 12));
    let moments: Vec<Moments> = (0..12).map(|i| Moments::of(Spectrum::rgb(i as f32, 0.0, 1.0))).collect();
    let image = Image::from_sums(&spec, &PixelSums::of_samples(&moments), &SampleSet::first(1));
    assert_eq!((image.full_size, image.origin, image.size), (UVec2::new(10, 20), min, UVec2::new(4, 3)));
    assert_eq!(image.rgb(1, 2), [9.0, 0.0, 1.0], "rows from the top, 4 pixels each");
    assert_eq!(image.pixels().count(), 12);
}

/// Picture of gray pixels in one row.
fn grays(values: &[f32]) -> Image {
    picture(UVec2::new(values.len() as u32, 1), |_, i| values[i])
}

fn picture(size: UVec2, value: impl Fn(usize, usize) -> f32) -> Image {
    let count = (size.x * size.y) as usize;
    let channel = |c: usize| Channel { name: ["R", "G", "B"][c].into(), values: (0..count).map(|i| value(c, i)).collect() };
    Image { full_size: size, origin: UVec2::ZERO, size, channels: (0..3).map(channel).collect() }
}

const CURVES: [Curve; 5] = [Curve::None, Curve::Filmic, Curve::Agx, Curve::Normalize, Curve::Postcard];

fn toned(values: &[f32], exposure: f32, curve: Curve) -> Vec<u8> {
    Tonemap { exposure, curve }.apply(&grays(values)).into_iter().step_by(3).collect()
}

#[test]
fn srgb_is_the_standards() {
    for (linear, encoded) in [(0.18, 0.4613561295), (0.5, 0.7353569831), (0.0, 0.0), (1.0, 1.0), (0.003, 12.92 * 0.003)] {
        assert!((f64::from(srgb(linear)) - encoded).abs() < 1e-6, "sRGB({linear}) = {}", srgb(linear));
    }
    assert_eq!(toned(&[0.18, 0.5, 1.0, 2.0], 0.0, Curve::None), [118, 188, 255, 255]);
}

/// One stop doubles the radiance, and the brightest pixel of a normalised picture is white at any exposure.
#[test]
fn exposure_counts_stops() {
    let values = [0.0, 0.001, 0.02, 0.17, 0.3, 0.45];
    for curve in CURVES {
        let doubled = values.map(|v| 8.0 * v);
        assert_eq!(toned(&values, 3.0, curve), toned(&doubled, 0.0, curve), "{curve:?}");
    }
    for exposure in [-10.0, 0.0, 10.0] {
        assert_eq!(toned(&[0.0, 3.0, 6.0], exposure, Curve::Normalize), [0, 128, 255]);
    }
}

/// Tone curves are monotonic, from black to infinity.
#[test]
fn tone_curves_are_monotonic() {
    let mut values: Vec<f32> = (-40..=127).map(|e| 2f32.powi(e)).chain([f32::MAX, f32::INFINITY]).collect();
    values.extend(values.clone().iter().map(|v| -v));
    values.push(0.0);
    values.sort_by(f32::total_cmp);
    for curve in CURVES {
        let shown = toned(&values, 0.0, curve);
        assert!(shown.is_sorted(), "{curve:?}: {shown:?}");
        assert_eq!(shown.last(), Some(&255), "{curve:?}");
    }
}

#[test]
fn nan_is_shown_black() {
    for curve in CURVES {
        assert_eq!(toned(&[f32::NAN, 1.0], 0.0, curve)[0], 0, "{curve:?}");
    }
    assert_eq!(toned(&[0.0, 0.0], 0.0, Curve::Normalize), [0, 0], "a black picture stays black");
}

/// Values that a careless format would lose: negative numbers, signed zeros, subnormals, infinities.
fn delicate() -> Image {
    let hard = [0.0, -0.0, 1.0, -1.5, 1e-45, -1e-40, f32::MIN_POSITIVE, f32::MAX, f32::MIN, f32::INFINITY, 0.1, 1.0 / 3.0];
    let mut image = picture(UVec2::new(4, 3), |c, i| hard[(i + c) % 12]);
    image.channels.push(Channel { name: "StdErr.R".into(), values: hard.map(|v| v * 0.5).to_vec() });
    image.full_size = UVec2::new(100, 50);
    image.origin = UVec2::new(90, 47);
    image
}

fn bits(image: &Image, name: &str) -> Vec<u32> {
    image.channel(name).expect(name).iter().map(|v| v.to_bits()).collect()
}

#[test]
fn exr_keeps_every_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("picture.exr");
    let image = delicate();
    let mut attributes: Attributes = [("pt/seed", "7"), ("pt/a name of more than thirty-one characters", "Küche → 台所"), ("pt/empty", "")]
        .map(|(name, value)| (name.to_owned(), value.into()))
        .to_vec();
    attributes.push(("pt/a number".into(), Value::Integer(-7)));
    attributes.push(("worldToNDC".into(), Value::Matrix(std::array::from_fn(|i| i as f32 / 3.0))));
    attributes.push(("pt/a matrix".into(), Value::Matrix([1e-30; 16])));
    attributes.push(("screenWindowWidth".into(), Value::Number(0.1)));
    attributes.push(("pixelAspectRatio".into(), Value::Number(0.75)));
    attributes.push(("screenWindowCenter".into(), Value::Point([0.1, -3.0])));
    write(&path, &image, &attributes, &Tonemap::default()).expect("written");
    let (read, kept) = exr::read(&path).expect("read");
    for name in ["R", "G", "B", "StdErr.R"] {
        assert_eq!(bits(&read, name), bits(&image, name), "{name}");
    }
    assert_eq!((read.full_size, read.origin, read.size), (image.full_size, image.origin, image.size));
    attributes.sort_by(|a, b| a.0.cmp(&b.0));
    assert_eq!(kept, attributes);
}

#[test]
fn pfm_is_bottom_up_and_little_endian() {
    let bytes = pfm::encode(&picture(UVec2::new(2, 2), |c, i| (10 * i + c) as f32 + 0.5));
    let mut expected = b"PF\n2 2\n-1.0\n".to_vec();
    for pixel in [2, 3, 0, 1] {
        expected.extend((0..3).flat_map(|c| ((10 * pixel + c) as f32 + 0.5).to_le_bytes()));
    }
    assert_eq!(bytes, expected);
}

#[test]
fn png_and_ppm_hold_the_tonemaps_bytes() {
    let image = picture(UVec2::new(5, 3), |c, i| (i * 3 + c) as f32 / 45.0);
    let tonemap = Tonemap { exposure: 0.5, curve: Curve::Filmic };
    let expected = tonemap.apply(&image);
    let decoded = image::load_from_memory(&png::encode(&image, &tonemap).expect("encoded")).expect("a PNG").into_rgb8();
    assert_eq!((decoded.dimensions(), decoded.as_raw()), ((5, 3), &expected));
    assert_eq!(png::encode_ppm(&image, &tonemap), [b"P6\n5 3\n255\n".to_vec(), expected].concat());
}

#[test]
fn a_file_is_whole_or_not_at_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let names = || std::fs::read_dir(folder.path()).expect("a folder").map(|e| e.expect("an entry").file_name()).collect::<Vec<_>>();
    let path = folder.path().join("picture.png");
    replace(&path, b"old").expect("written");
    replace(&path, b"new").expect("replaced");
    assert_eq!(std::fs::read(&path).expect("there"), b"new");

    assert_eq!(replace(&folder.path().join("missing/picture.png"), b"x").map_err(|e| e.exit_code()), Err(5));
    assert_eq!(write(&folder.path().join("picture.jpg"), &grays(&[1.0]), &vec![], &Tonemap::default()).map_err(|e| e.exit_code()), Err(2));
    // The last step fails, because a folder has the name of the file.
    let taken = folder.path().join("taken.exr");
    std::fs::create_dir(&taken).expect("made");
    assert_eq!(replace(&taken, b"x").map_err(|e| e.exit_code()), Err(5));
    let mut left = names();
    left.sort();
    assert_eq!(left, ["picture.png", "taken.exr"], "nothing half-done stays behind");
}

/// A folder that cannot be written to keeps its old file. (A superuser could write to it.)
#[cfg(unix)]
#[test]
fn a_refused_write_keeps_the_old_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("picture.pfm");
    replace(&path, b"old").expect("written");
    let allow = |mode| std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(mode)).expect("permitted");
    allow(0o555);
    let overruled = std::fs::write(folder.path().join("probe"), b"").is_ok();
    let result = replace(&path, b"new").map_err(|e| e.exit_code());
    allow(0o755);
    if !overruled {
        assert_eq!(result, Err(5));
        assert_eq!(std::fs::read(&path).expect("there"), b"old");
    }
}

#[test]
fn formats_go_by_extension() {
    for (name, format) in [("a.exr", Some(Format::Exr)), ("b.c.PNG", Some(Format::Png)), ("ppm", None), ("x.jpeg", None)] {
        assert_eq!(Format::of(name.as_ref()), format, "{name}");
    }
}

/// Samples with gaps between them: the variance is that of the mean of these samples, on average over the pixels, wherever the gaps begin and
/// end. Scramblings without two samples tell no error.
#[test]
fn gaps_leave_the_error_right() {
    const PIXELS: u64 = 20_000;
    const K: u32 = 4;
    let noise = |pixel: u64, index: u64| Random::new(1000 * pixel + index).unit() as f32;
    for ranges in [&[4..12, 20..28][..], &[1..7, 9..10, 15..20], &[3..4, 4..14], &[0..1, 5..6, 10..11, 14..40]] {
        let set = SampleSet::of(ranges.iter().cloned());
        let mut film = MomentFilm::new(FilmSpec::new(PIXELS as u32, 1));
        for index in set.ranges().iter().cloned().flatten() {
            let mut block = PixelSums::with_capacity(ErrorEstimator::Scramblings(K), PIXELS as usize);
            for pixel in 0..PIXELS {
                let mut sequences = [Moments::default(); K as usize];
                sequences[(index % u64::from(K)) as usize] = Moments::of(Spectrum::gray(noise(pixel, index)));
                block.push(&sequences, [0.0; 2]);
            }
            film.add(Wave { first: index, level: 0 }, block);
        }
        assert_eq!(film.sample_set(), set);
        let (total, n) = (film.total(), film.samples() as f64);
        let estimates: Vec<(f64, f64)> = total.pixels().map(|pixel| estimate(total.error_estimator(), pixel, set.of_pixel(0))[0]).collect();
        let mean = |value: fn(&(f64, f64)) -> f64| estimates.iter().map(value).sum::<f64>() / PIXELS as f64;
        // Uniform numbers have the variance 1/12. Each estimate has three degrees of freedom, so that the mean of v has the relative standard
        // error √(2/3/PIXELS), and less as the sums of uniform numbers have thinner tails than a normal distribution; 5 of them are allowed.
        let (expected, off) = (1.0 / 12.0 / n, 5.0 * (2.0 / 3.0 / PIXELS as f64).sqrt());
        assert!((mean(|(_, v)| *v) / expected - 1.0).abs() < off, "{set}: {} for {expected}", mean(|(_, v)| *v));
        assert!((mean(|(x, _)| *x) - 0.5).abs() < 5.0 * (expected / PIXELS as f64).sqrt(), "{set}");
        assert_eq!(film.freedom(), 3.0);
    }
    // Sample 2 is the only one of scrambling 2.
    let mut film = MomentFilm::new(FilmSpec::new(1, 1));
    for first in [0, 1, 2, 3, 4, 5, 7, 9] {
        film.add(Wave { first, level: 0 }, PixelSums::black(ErrorEstimator::Scramblings(K), 1));
    }
    assert_eq!((film.freedom(), film.samples(), film.blocks().len()), (0.0, 8, 4));
}
