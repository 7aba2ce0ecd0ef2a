//! Comparison of directions and values up to rounding errors.

use glam::Vec3;

use crate::math::{Local, Spectrum};

/// Returns whether two directions are equal up to the rounding of their computation.
pub fn same_direction(a: Local, b: Local) -> bool {
    (a.0 - b.0).abs().max_element() <= 8.0 * f32::EPSILON
}

/// Whether |a − b| ≤ relative · max(|a|, |b|) + slack in every coefficient; `false` for NaN.
///
/// Differences below the smallest normal number count as 0.
pub fn near(a: Spectrum, b: Spectrum, relative: f32, slack: Spectrum) -> bool {
    let excess = a.zip(b, |a, b| (a - b).abs() - (relative * a.abs().max(b.abs())).max(f32::MIN_POSITIVE));
    excess.zip(slack, |excess, slack| if excess <= slack { 0.0 } else { 1.0 }).is_black()
}

/// Change of a value under rounding of the inputs: the range over the neighbours, doubled for the neighbours that were not tried.
pub fn rounding_sensitivity(centre: Spectrum, neighbours: impl IntoIterator<Item = Spectrum>) -> Spectrum {
    let largest = |a: Spectrum, b: Spectrum| a.zip(b, f32::max);
    let off = |value: Spectrum| value.zip(centre, |a, b| 2.0 * (a - b).abs());
    neighbours.into_iter().map(off).fold(Spectrum::BLACK, largest)
}

/// Directions that differ by a few roundings of their own coordinates.
pub fn rounded(w: Local) -> [Local; 6] {
    const BY: f32 = 4.0 * f32::EPSILON;
    let change = |axis: Vec3, by: f32| Local(w.0 + w.0 * axis * by);
    let [x, y, z] = Vec3::AXES;
    [change(x, BY), change(x, -BY), change(y, BY), change(y, -BY), change(z, BY), change(z, -BY)]
}

/// Directions near `w`, shifted along the axes by `roundings` times the rounding error of a computation with unit vectors.
pub fn shifted(w: Local, roundings: f32) -> [Local; 8] {
    let by = roundings * f32::EPSILON;
    let sign = |k: u32, axis: u32| if k >> axis & 1 == 0 { -by } else { by };
    [0, 1, 2, 3, 4, 5, 6, 7].map(|k| Local(w.0 + Vec3::new(sign(k, 0), sign(k, 1), sign(k, 2))))
}
