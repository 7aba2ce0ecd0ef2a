//! The AgX tone curve: very bright and very saturated colours fade to white, as on film, and do not turn into one of the six corner
//! colours of the display.
//!
//! Colours are first mixed with a little of each other (the primaries move outwards by a quarter, so that all colours move inwards).
//! Each component then goes through a sigmoid of its logarithm, which shows 10 stops below middle grey and 6.5 above. At last the
//! mixing is undone.
//!
//! Source: Troy Sobotka, AgX (2022), base look: slope 2, toe power 3, shoulder power 3.25, middle grey at half of white.

use std::f32::consts::LN_2;

use glam::{Mat3, Vec3};

use crate::math::float::{ln, powf};

/// Stops below and above middle grey that the curve shows.
const STOPS: [f32; 2] = [10.0, 6.5];

/// Linear radiance that is shown at half of white.
const MIDDLE_GREY: f32 = 0.18;

/// Display value of middle grey.
const PIVOT: f32 = 0.5;

/// Slope of the curve at middle grey: display values per share of all stops.
const SLOPE: f32 = 2.0;

/// Powers that bend the curve below and above middle grey.
const POWERS: [f32; 2] = [3.0, 3.25];

/// From the sRGB primaries to primaries that are 1/0.8 times as far from white, by columns. Each row sums to 1, so greys stay.
const INSET: Mat3 = Mat3::from_cols(
    Vec3::new(0.842_398_9, 0.042_398_93, 0.042_398_93),
    Vec3::new(0.078_430_17, 0.878_430_2, 0.078_430_17),
    Vec3::new(0.079_170_91, 0.079_170_91, 0.879_170_9),
);

/// Inverse of [`INSET`].
const OUTSET: Mat3 = Mat3::from_cols(
    Vec3::new(1.197_001_3, -0.052_998_66, -0.052_998_66),
    Vec3::new(-0.098_037_71, 1.151_962_3, -0.098_037_71),
    Vec3::new(-0.098_963_63, -0.098_963_63, 1.151_036_4),
);

/// Display value of a linear colour; its components may lie slightly outside of 0 to 1.
pub fn agx(rgb: [f32; 3]) -> [f32; 3] {
    let shown = (INSET * Vec3::from_array(rgb)).to_array().map(sigmoid);
    (OUTSET * Vec3::from_array(shown)).to_array()
}

/// Display value of one component, from 0 to 1.
///
/// With d the distance from middle grey in shares of all stops, D and E the distances from there to the end of the curve in x and in y,
/// m the slope and p the power:
///
/// y = PIVOT ± m d / (1 + ((m D / E)^p − 1) (d / D)^p)^(1/p)
fn sigmoid(x: f32) -> f32 {
    let [below, above] = STOPS;
    let middle = below / (below + above);
    // Logarithm to base 2 over middle grey; values at and below 0 are shown as the darkest.
    let stops = if x > 0.0 { (ln(x / MIDDLE_GREY) / LN_2).clamp(-below, above) } else { -below };
    let d = stops / (below + above);
    let (sign, power, [width, height]) =
        if d < 0.0 { (-1.0, POWERS[0], [middle, PIVOT]) } else { (1.0, POWERS[1], [1.0 - middle, 1.0 - PIVOT]) };
    let bend = (powf(SLOPE * width / height, power) - 1.0) * powf(d.abs() / width, power);
    PIVOT + sign * SLOPE * d.abs() / powf(1.0 + bend, 1.0 / power)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns: XYZ of red, green and blue that add up to white (D65). Source: IEC 61966-2-1.
    fn to_xyz(away: f32) -> Mat3 {
        let white = [0.3127, 0.3290];
        let xyz = |[x, y]: [f32; 2]| Vec3::new(x / y, 1.0, (1.0 - x - y) / y);
        let primaries = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]].map(|p: [f32; 2]| [0, 1].map(|i| white[i] + away * (p[i] - white[i])));
        let [r, g, b] = primaries.map(xyz);
        let m = Mat3::from_cols(r, g, b);
        m * Mat3::from_diagonal(m.inverse() * xyz(white))
    }

    /// The matrix follows from the primaries of sRGB. The tolerance is for rounding in f32.
    #[test]
    fn primaries_move_outwards_by_a_quarter() {
        let inset = to_xyz(1.25).inverse() * to_xyz(1.0);
        assert!(inset.abs_diff_eq(INSET, 1e-5), "{inset}");
        assert!(INSET.inverse().abs_diff_eq(OUTSET, 1e-5), "{}", INSET.inverse());
    }

    /// Wrensch's polynomial of degree six was fitted to the same curve by others; it
    /// misses black by 0.0023 and differs by up to 0.006 in between.
    #[test]
    fn the_curve_is_the_published_one() {
        for i in 0..=1000 {
            let x = i as f32 / 1000.0;
            let [x2, x4] = [x * x, x * x * x * x];
            let fit = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
            let value = sigmoid(MIDDLE_GREY * powf(2.0, x * 16.5 - 10.0));
            assert!((value - fit).abs() < 8e-3, "{x}: {value}, {fit}");
        }
        assert_eq!([0.0, f32::NEG_INFINITY, MIDDLE_GREY].map(sigmoid), [0.0, 0.0, 0.5]);
    }

    /// A red lamp that becomes brighter stays red at first and becomes white at last.
    #[test]
    fn bright_colours_fade_to_white() {
        let share = |gain: f32| {
            let [r, g, _] = agx([gain, 0.0, 0.0]);
            g / r
        };
        let shares = [0.1, 1.0, 10.0, 100.0].map(share);
        assert!(shares.is_sorted() && shares[0] < 0.1 && shares[3] > 0.7, "{shares:?}");
        for grey in [0.001, 0.18, 1.0, 50.0] {
            let [r, g, b] = agx([grey; 3]);
            assert!((r - g).abs() < 1e-6 && (g - b).abs() < 1e-6, "{grey}");
        }
    }
}
