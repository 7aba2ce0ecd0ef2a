//! FLIP: the visible difference between two pictures that alternate on a screen.
//!
//! FLIP = ΔEc^(1 − ΔEf)
//!
//! - ΔEc, colour: both pictures are blurred as an eye at that distance blurs them (a Gaussian for each of brightness, red–green and
//!   blue–yellow). They are compared in L*a*b* with the Hunt effect by the HyAB distance, which is mapped to 0 … 1
//! - ΔEf, features: difference of the edges and points of the brightness
//!
//! Source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, *FLIP: A Difference Evaluator for Alternating Images*
//! (2020), with the constants of its published implementation. Tests: black against white by hand, and pictures against that
//! implementation.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use super::ImagePair;
use super::filter::{Border, Kernel, convolve};

/// Resolution of a screen that is 0.7 m wide, has 3840 pixels and is seen from 0.7 m: 0.7·3840/0.7·π/180.
const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// FLIP of every pixel, 0 to 1.
pub fn flip(pair: &ImagePair) -> Vec<f64> {
    let [width, _] = pair.size();
    let [a, r] = pair.displayed().map(|pixels| Opponent::of(&pixels, width));
    let (colour_a, colour_r) = (a.blurred(), r.blurred());
    let (features_a, features_r) = (a.features(), r.features());
    let scale = Redistribution::new();
    let error = |i: usize| {
        let colour = scale.of(hyab(colour_a[i], colour_r[i]));
        let [edge, point] = [0, 1].map(|k| (features_a[i][k] - features_r[i][k]).abs());
        let feature = (FRAC_1_SQRT_2 * edge.max(point)).sqrt();
        colour.powf(1.0 - feature)
    };
    (0..colour_a.len()).map(error).collect()
}

/// A picture in the colour space YCxCz, one channel after the other. The space is linear in light, and its axes are opponent colours.
struct Opponent {
    width: usize,
    channels: [Vec<f64>; 3],
}

impl Opponent {
    /// Converts a picture.
    ///
    /// - `pixels`: sRGB, 0 to 1
    fn of(pixels: &[[f32; 3]], width: usize) -> Opponent {
        let pixels: Vec<[f64; 3]> = pixels.iter().map(|rgb| to_opponent(to_xyz(rgb.map(|c| linear(c.into()))))).collect();
        Opponent { width, channels: [0, 1, 2].map(|c| pixels.iter().map(|p| p[c]).collect()) }
    }

    /// The picture as the eye sees it, in Hunt-adjusted L*a*b*.
    fn blurred(&self) -> Vec<[f64; 3]> {
        // Weights and widths (degrees²) of the Gaussians of the contrast sensitivities.
        let sensitivities: [&[(f64, f64)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
        let mut blurred = self.channels.iter().zip(sensitivities).map(|(channel, gaussians)| self.blur(channel, gaussians));
        let [y, cx, cz] = std::array::from_fn(|_| blurred.next().unwrap_or_default());
        let seen = |i: usize| hunt(to_lab(to_xyz(to_rgb(from_opponent([y[i], cx[i], cz[i]])).map(|c| c.clamp(0.0, 1.0)))));
        (0..y.len()).map(seen).collect()
    }

    /// Convolution with Σ a √(π/b) exp(−π² d²/b) over distances d in degrees, with weights that add up to 1.
    fn blur(&self, channel: &[f64], gaussians: &[(f64, f64)]) -> Vec<f64> {
        const WIDEST: f64 = 0.04;
        let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
        let degrees = |x: f64| x / PIXELS_PER_DEGREE;
        let bell = |b: f64, x: f64| (-PI * PI * degrees(x) * degrees(x) / b).exp();
        // A Gaussian of two dimensions is a product of two of one dimension, so its sum over the square is the square of the sum
        // over a line.
        let mass = |a: f64, b: f64| a * (PI / b).sqrt() * (-radius..=radius).map(|x| bell(b, x.into())).sum::<f64>().powi(2);
        let total: f64 = gaussians.iter().map(|&(a, b)| mass(a, b)).sum();
        let mut sum = vec![0.0; channel.len()];
        for &(a, b) in gaussians {
            let kernel = Kernel::new(radius, |x| bell(b, x)).normalised();
            let part = convolve(channel, self.width, &kernel, &kernel, Border::Nearest);
            sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += mass(a, b) / total * part);
        }
        sum
    }

    /// Strength of edges and of points: gradients and second derivatives of the brightness, at the scale that the eye responds to.
    fn features(&self) -> Vec<[f64; 2]> {
        const WIDTH: f64 = 0.082;
        let sigma = 0.5 * WIDTH * PIXELS_PER_DEGREE;
        let radius = (3.0 * sigma).ceil() as i32;
        let bell = |x: f64| (-x * x / (2.0 * sigma * sigma)).exp();
        let smooth = Kernel::new(radius, bell).normalised();
        let edge = Kernel::new(radius, |x| -x * bell(x)).normalised();
        let point = Kernel::new(radius, |x| (x * x / (sigma * sigma) - 1.0) * bell(x)).normalised();
        let brightness: Vec<f64> = self.channels[0].iter().map(|y| (y + 16.0) / 116.0).collect();
        let strength = |kernel: &Kernel| {
            let along = convolve(&brightness, self.width, kernel, &smooth, Border::Nearest);
            let down = convolve(&brightness, self.width, &smooth, kernel, Border::Nearest);
            along.into_iter().zip(down).map(|(x, y)| x.hypot(y)).collect::<Vec<f64>>()
        };
        strength(&edge).into_iter().zip(strength(&point)).map(|(edge, point)| [edge, point]).collect()
    }
}

/// Map of colour distances, raised to 0.7, to 0 … 1: the lower 0.4 of the possible distances take 0.95 of the range.
struct Redistribution {
    largest: f64,
}

impl Redistribution {
    /// Map whose maximum is the distance of green and blue, the largest of a screen.
    fn new() -> Redistribution {
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| hunt(to_lab(to_xyz(rgb))));
        Redistribution { largest: Redistribution::pressed(hyab(green, blue)) }
    }

    fn pressed(distance: f64) -> f64 {
        distance.powf(0.7)
    }

    fn of(&self, distance: f64) -> f64 {
        let (error, knee) = (Redistribution::pressed(distance), 0.4 * self.largest);
        if error < knee { 0.95 * error / knee } else { 0.95 + 0.05 * (error - knee) / (self.largest - knee) }
    }
}

/// HyAB distance |ΔL| + √(Δa² + Δb²) of two colours in L*a*b*.
fn hyab(x: [f64; 3], y: [f64; 3]) -> f64 {
    (x[0] - y[0]).abs() + (x[1] - y[1]).hypot(x[2] - y[2])
}

/// Hunt effect: colours look more colourful when they are brighter. a and b are multiplied by L/100.
fn hunt([l, a, b]: [f64; 3]) -> [f64; 3] {
    [l, 0.01 * l * a, 0.01 * l * b]
}

fn linear(c: f64) -> f64 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Linear Rec. 709 to XYZ, as ratios of the primaries' coordinates.
const XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// XYZ to linear Rec. 709.
const RGB: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

/// White: XYZ of (1, 1, 1).
const WHITE: [f64; 3] = [0.950_428_545, 1.0, 1.088_900_371];

fn apply(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn to_xyz(rgb: [f64; 3]) -> [f64; 3] {
    apply(&XYZ, rgb)
}

fn to_rgb(xyz: [f64; 3]) -> [f64; 3] {
    apply(&RGB, xyz)
}

/// XYZ to YCxCz.
fn to_opponent(xyz: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = std::array::from_fn(|c| xyz[c] / WHITE[c]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn from_opponent([y, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    [WHITE[0] * (y + cx / 500.0), WHITE[1] * y, WHITE[2] * (y - cz / 200.0)]
}

/// XYZ to L*a*b*.
fn to_lab(xyz: [f64; 3]) -> [f64; 3] {
    const KNEE: f64 = 6.0 / 29.0;
    let bent = |t: f64| if t > KNEE.powi(3) { t.cbrt() } else { t / (3.0 * KNEE * KNEE) + 4.0 / 29.0 };
    let [x, y, z] = std::array::from_fn(|c| bent(xyz[c] / WHITE[c]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}
