//! Error measures compared with values computed by hand, with their laws, and with values of other programs.

use glam::UVec2;
use proptest::prelude::*;
use pt::film::{Channel, Image};
use pt::measure::metric::{ALL, ImagePair, Metric, Named};
use pt::output::{Curve, Tonemap};
use pt::{Error, Result};

use crate::random::cases;

/// A picture of that width from its pixels, row by row.
fn image(width: u32, pixels: &[[f32; 3]]) -> Image {
    let size = UVec2::new(width, pixels.len() as u32 / width);
    let channel = |(c, name): (usize, &str)| Channel { name: name.into(), values: pixels.iter().map(|p| p[c]).collect() };
    Image { full_size: size, origin: UVec2::ZERO, size, channels: ["R", "G", "B"].into_iter().enumerate().map(channel).collect() }
}

fn gray(values: &[f32]) -> Image {
    image(values.len() as u32, &values.iter().map(|&v| [v; 3]).collect::<Vec<_>>())
}

fn pair<'a>(a: &'a Image, r: &'a Image) -> Result<ImagePair<'a>> {
    ImagePair::new(Named { name: "a.exr", image: a }, Named { name: "r.exr", image: r }, Tonemap::default())
}

fn metric(text: &str) -> Metric {
    Metric::parse(text).unwrap_or_else(|e| panic!("{e}"))
}

fn measured(text: &str, a: &Image, r: &Image) -> f64 {
    metric(text).measure(&pair(a, r).unwrap_or_else(|e| panic!("{e}"))).value
}

/// The pictures a = (1, 0, 3) and r = (2, 0.5, 3), all numbers and their squares exact.
#[test]
fn by_hand() {
    let (a, r) = (gray(&[1.0, 0.0, 3.0]), gray(&[2.0, 0.5, 3.0]));
    // d = −1, −½, 0; d² = 1, ¼, 0; r² = 4, ¼, 9; mean(r) = 11/6.
    let epsilon = 0.01 * (11.0f64 / 6.0).powi(2);
    let expected = [
        ("mse", 1.25 / 3.0),
        ("rmse", (1.25f64 / 3.0).sqrt()),
        ("mae", 0.5),
        ("l1", 0.5),
        ("l2", 1.25 / 3.0),
        ("relmse", (1.0 / (4.0 + epsilon) + 0.25 / (0.25 + epsilon)) / 3.0),
        ("relmse:eps=0.75", (1.0 / 4.75 + 0.25) / 3.0),
        ("relmse-tev", (1.0 / 4.01 + 0.25 / 0.26) / 3.0),
        ("relmse-seesharp", (1.0 / 4.01 + 0.25 / 0.26) / 3.0),
        ("mrse-pbrt", (1.0 / 2.01f64.powi(2) + 0.25 / 0.51f64.powi(2)) / 3.0),
        ("mrse-jeri", (1.0 / 4.0001 + 0.25 / 0.2501) / 3.0),
        ("mrse-tungsten", (1.0 / 1.001 + 250.0) / 3.0),
        ("mape", (1.0 / 2.01 + 0.5 / 0.51) / 3.0),
        ("mape:eps=0.5", (1.0 / 2.5 + 0.5) / 3.0),
        ("smape", (2.0 / 3.02 + 1.0 / 0.52) / 3.0),
        ("smape:eps=0.25", (2.0 / 3.5 + 1.0) / 3.0),
    ];
    for (name, value) in expected {
        let found = measured(name, &a, &r);
        assert!((found - value).abs() <= 4.0 * f64::EPSILON * value, "{name}: {found} for {value}");
    }
    let tested = |name: &str| expected.iter().any(|(n, _)| *n == name) || ["flip", "ssim"].contains(&name);
    assert!(ALL.iter().all(|kind| tested(kind.name)));
}

/// Where the reference is black, or where a denominator would be 0 because of a constant of the formula, each measure has its documented
/// value.
#[test]
fn errors_against_a_black_reference_follow_their_formulas() {
    let (a, black) = (gray(&[1.0, 0.0]), gray(&[0.0, 0.0]));
    assert_eq!(measured("relmse", &a, &black), f64::INFINITY);
    assert_eq!(measured("relmse", &black, &black), 0.0);
    assert_eq!(measured("mape:eps=0", &black, &black), 0.0);
    assert_eq!(measured("relmse-seesharp", &a, &black), 0.0);
    assert_eq!(measured("relmse-tev", &a, &black), 50.0);
    // The f32 nearest to −0.01 differs from −1/100 in f64, so the error is large but not infinite.
    assert!(measured("mrse-pbrt", &a, &gray(&[-0.01, 0.0])) > 1e15);
}

/// Each of the three colours has the weight ⅓.
#[test]
fn colours_are_averaged() {
    let (a, r) = (image(1, &[[3.0, 0.0, 0.0]]), image(1, &[[0.0, 0.0, 0.0]]));
    assert_eq!((measured("mse", &a, &r), measured("mae", &a, &r)), (3.0, 1.0));
}

/// 2999 pixels with the errors 0 … 2998, of which the two largest are left out. The mean of the others is 1498.
#[test]
fn trimmed_mean_by_hand() {
    let errors: Vec<f32> = (0..2999).map(|i| ((i * 1009) % 2999) as f32).collect();
    let (a, r) = (gray(&errors), gray(&[0.0; 2999]));
    assert_eq!(measured("mae:robust", &a, &r), 1498.0);
    assert_eq!(measured("mae", &a, &r), 1499.0);
    assert!((measured("rmse:robust", &a, &r).powi(2) - measured("mse:robust", &a, &r)).abs() < 1e-6);
    let few = gray(&errors[..999]);
    assert_eq!(measured("mae:robust", &few, &gray(&[0.0; 999])), measured("mae", &few, &gray(&[0.0; 999])));
}

fn pictures() -> impl Strategy<Value = (Image, Image)> {
    let value = prop_oneof![4 => 0.0f32..2.0, 1 => Just(0.0f32), 1 => 2.0f32..1000.0];
    let pixels = move |n: usize| prop::collection::vec([value.clone(), value.clone(), value.clone()], n);
    (1u32..14, 1u32..14).prop_flat_map(move |(w, h)| {
        let n = (w * h) as usize;
        (pixels(n), pixels(n)).prop_map(move |(a, b)| (image(w, &a), image(w, &b)))
    })
}

fn scaled(image: &Image, by: f32) -> Image {
    let channels = image.channels.iter().map(|c| Channel { name: c.name.clone(), values: c.values.iter().map(|v| v * by).collect() });
    Image { channels: channels.collect(), ..image.clone() }
}

proptest! {
    #![proptest_config(cases(60))]

    /// Equal pictures have no error, others have one of 0 or more; the symmetric measures are symmetric.
    #[test]
    fn identity_sign_and_symmetry((a, b) in pictures()) {
        for kind in ALL {
            prop_assert!(measured(kind.name, &a, &a).abs() < 1e-12, "{}", kind.name);
            let (there, back) = (measured(kind.name, &a, &b), measured(kind.name, &b, &a));
            // SSIM has rounding errors, because it is a product of ratios near 1.
            prop_assert!(there >= -1e-12, "{}: {there}", kind.name);
            if kind.first == kind.second {
                prop_assert!((there - back).abs() <= 1e-12 * there.abs().max(1.0), "{}: {there} and {back}", kind.name);
            }
        }
    }

    /// Scaling both pictures by 2^k scales squares by 4^k, differences by 2^k, and pt's own measure by nothing, bit for bit.
    #[test]
    fn scaling((a, b) in pictures(), k in -40i32..40) {
        let s = 2f32.powi(k);
        let (c, d) = (scaled(&a, s), scaled(&b, s));
        let s = f64::from(s);
        for (name, factor) in [("mse", s * s), ("rmse", s), ("mae", s), ("relmse", 1.0), ("relmse:robust", 1.0), ("mape:eps=0", 1.0)] {
            let before = measured(name, &a, &b);
            let expected = if before == 0.0 { 0.0 } else { before * factor };
            prop_assert_eq!(measured(name, &c, &d), expected, "{}", name);
        }
    }

    /// FLIP lies between 0 and 1, SMAPE between 0 and 2, 1 − SSIM between 0 and 2.
    #[test]
    fn ranges((a, b) in pictures()) {
        for (name, most) in [("flip", 1.0), ("smape", 2.0), ("ssim", 2.0)] {
            let map = metric(name).measure(&pair(&a, &b).expect("comparable")).map;
            prop_assert!(map.iter().all(|e| (-1e-12..=most).contains(e)), "{}", name);
        }
    }

    /// SSIM equals its definition: windows summed up one by one, with variances from differences.
    #[test]
    fn ssim_is_its_definition((a, b) in pictures()) {
        let map = metric("ssim").measure(&pair(&a, &b).expect("comparable")).map;
        let luma = |image: &Image| -> Vec<f64> {
            let shown = Tonemap::default().display(image);
            shown.iter().map(|p| 0.2126 * p[0] as f64 + 0.7152 * p[1] as f64 + 0.0722 * p[2] as f64).collect()
        };
        let (w, h, x, y) = (a.size.x as i32, a.size.y as i32, luma(&a), luma(&b));
        for (i, found) in map.iter().enumerate() {
            let (px, py) = (i as i32 % w, i as i32 / w);
            let near = (0..w * h).map(|j| (j as usize, j % w - px, j / w - py)).filter(|(_, dx, dy)| dx.abs() <= 5 && dy.abs() <= 5);
            let weighed: Vec<(usize, f64)> = near.map(|(j, dx, dy)| (j, (-f64::from(dx * dx + dy * dy) / 4.5).exp())).collect();
            let total: f64 = weighed.iter().map(|(_, g)| g).sum();
            let mean = |f: &dyn Fn(usize) -> f64| weighed.iter().map(|&(j, g)| g * f(j)).sum::<f64>() / total;
            let (mx, my) = (mean(&|j| x[j]), mean(&|j| y[j]));
            let (vx, vy, c) = (mean(&|j| (x[j] - mx).powi(2)), mean(&|j| (y[j] - my).powi(2)), mean(&|j| (x[j] - mx) * (y[j] - my)));
            let (c1, c2) = (1e-4, 9e-4);
            let expected = 1.0 - (2.0 * mx * my + c1) * (2.0 * c + c2) / ((mx * mx + my * my + c1) * (vx + vy + c2));
            // Σw(x − μ)² and Σwx² − μ² differ by a few roundings of numbers up to 1, over c2.
            prop_assert!((found - expected).abs() < 1e-11, "{found} for {expected}");
        }
    }
}

/// Constant pictures have neither contrast nor structure, so that SSIM depends only on the means, and FLIP only on the colours.
#[test]
fn flat_pictures_by_hand() {
    let (black, white) = (image(20, &[[0.0; 3]; 400]), image(20, &[[1.0; 3]; 400]));
    let ssim = measured("ssim", &black, &white);
    assert!((ssim - (1.0 - 1e-4 / 1.0001)).abs() < 1e-6, "{ssim}");
    // L* goes from 0 to 100, so the distance is 100^0.7 = 25.118864; green and blue are 41.2760 apart (the published constant).
    let (pressed, largest) = (100f64.powf(0.7), 41.2760);
    let expected = 0.95 + 0.05 * (pressed - 0.4 * largest) / (0.6 * largest);
    let flip = measured("flip", &black, &white);
    assert!((flip - expected).abs() < 1e-4, "{flip} for {expected}");
    // These two colours have the largest distance.
    let (green, blue) = (image(20, &[[0.0, 1.0, 0.0]; 400]), image(20, &[[0.0, 0.0, 1.0]; 400]));
    assert!((measured("flip", &green, &blue) - 1.0).abs() < 1e-6);
}

/// |(n mod 2p) − p|/p
fn triangle(n: u32, p: u32) -> f32 {
    (n % (2 * p)).abs_diff(p) as f32 / p as f32
}

/// Results of the authors' implementation (flip-evaluator 1.7, `evaluate(…, "LDR", inputsRGB=False)`), which computes in f32, for two
/// pictures of whole numbers: a triangle wave, and the same with an increasing displacement and a block of noise.
#[test]
fn flip_is_that_of_its_authors() {
    let pixel = |x: u32, y: u32, shift: u32| [0, 1, 2].map(|c| triangle(3 * x + 2 * y + 5 * c + shift, 16 + 4 * c));
    let noise = |x: u32, y: u32| [0, 1, 2].map(|c| ((7 * x + 13 * y + 3 * c) % 8) as f32 / 8.0);
    let is_noise = |x: u32, y: u32| (20..30).contains(&x) && (10..18).contains(&y);
    let places = || (0..40).flat_map(|y| (0..48).map(move |x| (x, y)));
    let reference: Vec<[f32; 3]> = places().map(|(x, y)| pixel(x, y, 0)).collect();
    let test: Vec<[f32; 3]> = places().map(|(x, y)| if is_noise(x, y) { noise(x, y) } else { pixel(x, y, x / 8) }).collect();
    let (a, r) = (image(48, &test), image(48, &reference));
    let measured = metric("flip").measure(&pair(&a, &r).expect("comparable"));
    assert!((measured.value - 0.402_099_46).abs() < 1e-5, "{}", measured.value);
    let published =
        [((0, 0), 0.000_618_257), ((47, 39), 0.618_250_73), ((24, 13), 0.813_865_1), ((10, 30), 0.228_792_95), ((33, 5), 0.495_113_85)];
    for ((x, y), expected) in published {
        let found = measured.map[y * 48 + x];
        assert!((found - expected).abs() < 5e-5, "({x}, {y}): {found} for {expected}");
    }
}

/// FLIP and SSIM compare pictures after tone mapping: differences above white are invisible, unless the exposure is lowered.
#[test]
fn errors_are_measured_after_tone_mapping() {
    let (a, r) = (gray(&[2.0; 30]), gray(&[4.0; 30]));
    let through =
        |exposure: f32, curve| ImagePair::new(Named { name: "a", image: &a }, Named { name: "r", image: &r }, Tonemap { exposure, curve });
    for name in ["flip", "ssim"] {
        let error = |exposure, curve| metric(name).measure(&through(exposure, curve).expect("comparable")).value;
        assert!(error(0.0, Curve::None).abs() < 1e-12, "{name}");
        assert!(error(-3.0, Curve::None) > 1e-5 && error(0.0, Curve::Filmic) > 1e-5, "{name}");
    }
}

#[test]
fn names_are_read_and_shown() {
    for text in ["mse", "relmse", "relmse:eps=0.5", "mape:eps=0.001,robust", "flip:robust"] {
        assert_eq!(metric(text).name(), text);
    }
    for kind in ALL {
        assert_eq!(metric(kind.name).name(), kind.name);
        assert!(metric(kind.name).formula().contains(kind.formula));
    }
    assert_eq!(metric("relmse:eps=1e-2").formula(), "mean over all pixels of (a − r)²/(r² + ε), ε = 0.01");
    assert_eq!(metric("rmse:robust").formula(), "square root of the mean over all pixels but the worst 0.1 % of (a − r)²");
    assert_eq!(Metric::default().name(), "relmse");
    let refusals = [
        ("rmsee", "unknown metric \"rmsee\", did you mean \"rmse\"?"),
        ("mse:eps=1", "metric \"mse:eps=1\": this metric takes no eps"),
        ("relmse:eps=-1", "metric \"relmse:eps=-1\": expected a number from 0 after eps="),
        ("relmse:eps=NaN", "metric \"relmse:eps=NaN\": expected a number from 0 after eps="),
        ("relmse:robots", "metric \"relmse:robots\": unknown option \"robots\", expected robust or eps=NUMBER"),
    ];
    for (text, said) in refusals {
        let error = Metric::parse(text).expect_err("refused");
        assert_eq!((error.to_string(), error.exit_code()), (said.into(), 2));
    }
}

/// Pictures that cannot be compared are refused with their names, and not compared in part.
#[test]
fn pictures_that_do_not_match_are_refused() {
    let right = image(3, &[[0.5; 3]; 6]);
    let crop = |x: u32| Image { full_size: UVec2::new(9, 9), origin: UVec2::new(x, 0), ..right.clone() };
    let without = |name: &str| {
        let mut image = right.clone();
        image.channels.retain(|c| c.name != name);
        image
    };
    let broken = |value: f32, count: usize| {
        let mut image = crop(2);
        image.channels[1].values[4..4 + count].fill(value);
        image
    };
    let empty = Image { size: UVec2::new(0, 3), channels: image(1, &[]).channels, ..right.clone() };
    let table = [
        (right.clone(), image(2, &[[0.5; 3]; 6]), "r.exr: expected the window of a.exr, 3 × 2; found 2 × 3"),
        (crop(0), crop(1), "r.exr: expected the window of a.exr, 3 × 2 at (0, 0) of 9 × 9; found 3 × 2 at (1, 0) of 9 × 9"),
        (right.clone(), crop(0), "r.exr: expected the window of a.exr, 3 × 2; found 3 × 2 at (0, 0) of 9 × 9"),
        (without("G"), right.clone(), "a.exr: expected channels R, G and B, found no G among R, B"),
        (right.clone(), without("R"), "r.exr: expected channels R, G and B, found no R among G, B"),
        (broken(f32::NAN, 1), crop(2), "a.exr: 1 pixel is not finite; the first: (3, 1) with 0.5, NaN, 0.5"),
        (crop(2), broken(f32::INFINITY, 2), "r.exr: 2 pixels are not finite; the first: (3, 1) with 0.5, inf, 0.5"),
        (empty.clone(), empty, "a.exr: a picture without pixels"),
    ];
    for (a, r, said) in table {
        let Err(error @ Error::Invalid(_)) = pair(&a, &r) else { panic!("not refused: {said}") };
        assert_eq!(error.to_string(), said);
    }
}
