//! Choice of the origin of a scene's stored coordinates.
//!
//! Coordinates in f32 are most precise near the origin, so it belongs where the scene has its finest detail. A large ground or a single
//! far lamp would move the centre of the bounding box away from there.

use std::cmp::Ordering;

use glam::DVec3;

use crate::shape::Detail;

/// Angle under which the camera sees the finest detail that counts (rad). Where the camera is at the origin, f32 resolves 65,000 steps
/// within it.
const FINEST_ANGLE: f64 = 1.0 / 256.0;

/// The detail of a surface that a camera at `eye` can show: what is far away counts as no finer than it looks. Otherwise a single tiny
/// object far away would take the precision from all that the picture shows.
pub fn seen_from(detail: Detail, eye: DVec3) -> Detail {
    Detail { density: detail.density.min(1.0 / (FINEST_ANGLE * detail.middle.distance(eye))), ..detail }
}

/// Weighted median of the centres of the details, separately for each axis, with their densities as weights. If all points of an
/// interval are medians, the one nearest to the camera; the camera if there are no details.
///
/// A single far object moves the median to the next detail at most, unless it weighs as much as all others together. The weights are
/// rounded down to powers of two, and weights below 2⁻⁶⁴ of the greatest count as 0. Their sums are exact whole numbers, so that the
/// order of the objects has no influence and two equal objects on opposite sides cancel exactly.
pub fn of(details: impl Iterator<Item = Detail>, eye: DVec3) -> DVec3 {
    let details: Vec<Detail> = details.collect();
    let greatest = details.iter().map(|detail| exponent(detail.density)).max().unwrap_or(0);
    let weight = |detail: &Detail| 1u128.checked_shl((64 + exponent(detail.density) - greatest).try_into().ok()?);
    let weighted: Vec<(DVec3, u128)> = details.iter().filter_map(|detail| Some((detail.middle, weight(detail)?))).collect();
    DVec3::from_array([0, 1, 2].map(|axis| median(weighted.iter().map(|(p, weight)| (p[axis], *weight)).collect(), eye[axis])))
}

/// Exponent of a positive normal number: log₂, rounded down, plus a constant.
fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32
}

/// Weighted median: the position with less than half of the weight on each side. If half of the weight lies on each side of a gap, the
/// point of the gap that is nearest to `eye`.
fn median(mut places: Vec<(f64, u128)>, eye: f64) -> f64 {
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: u128 = places.iter().map(|(_, weight)| weight).sum();
    let mut up_to = 0;
    for (k, (place, weight)) in places.iter().enumerate() {
        up_to += weight;
        match (2 * up_to).cmp(&total) {
            Ordering::Less => {}
            Ordering::Equal => return eye.max(*place).min(places.get(k + 1).map_or(*place, |next| next.0)),
            Ordering::Greater => return *place,
        }
    }
    eye
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detail(x: f64, size: f64) -> Detail {
        Detail { middle: DVec3::new(x, 0.0, 0.0), density: 1.0 / size }
    }

    fn x(details: &[Detail]) -> f64 {
        of(details.iter().copied(), DVec3::X).x
    }

    /// The origin of a scene is not moved by a large ground, by a far lamp, or by a pair of them.
    #[test]
    fn the_origin_stays_where_the_detail_is() {
        let home = [detail(1.0, 0.01), detail(1.5, 0.02), detail(1.25, 0.01)];
        let at_home = x(&home);
        assert!((1.0..=1.5).contains(&at_home));
        for far in [10.0, 1e3, 1e9, 1e18] {
            let with = |more: &[Detail]| x(&[&home[..], more].concat());
            assert_eq!(with(&[detail(far, 1.0)]), at_home, "one object at {far} m");
            assert_eq!(with(&[detail(-far, 1.0)]), at_home, "one object at -{far} m");
            assert_eq!(with(&[detail(-far, 1e-3), detail(far, 1e-3)]), at_home, "a fine pair at {far} m");
            assert_eq!(with(&[detail(0.5 * far, far)]), at_home, "a ground of {far} m");
        }
    }

    /// A single fine object that is too far away to be seen does not move the origin, at any distance and size.
    #[test]
    fn the_origin_stays_where_the_camera_sees_detail() {
        let (eye, home) = (DVec3::X, [detail(1.0, 0.3), detail(1.5, 0.2), detail(1.25, 0.1)]);
        let origin = |details: &[Detail]| of(details.iter().map(|detail| seen_from(*detail, eye)), eye).x;
        for far in [1e3, 1e6, 1e12] {
            for size in [1e-9, 1e-3, 1.0] {
                let with = origin(&[&home[..], &[detail(far, size)]].concat());
                assert!((1.0..=1.5).contains(&with), "{size} m large at {far} m: {with}");
            }
        }
    }

    /// The order of the objects has no influence, and a scene of twice the size has its origin twice as far away.
    #[test]
    fn the_origin_depends_on_the_scene_alone() {
        let scene = [detail(3.0, 1.0), detail(-7.0, 1.0), detail(0.1, 4.0), detail(5.0, 0.3)];
        let backwards: Vec<Detail> = scene.iter().rev().copied().collect();
        assert_eq!(x(&scene), x(&backwards));
        let twice = scene.map(|d| Detail { middle: 2.0 * d.middle, density: 0.5 * d.density });
        assert_eq!(2.0 * x(&scene), x(&twice));
        assert_eq!(x(&[]), 1.0, "nothing but the camera");
        assert_eq!(x(&[detail(-3.0, 1.0), detail(4.0, 1.0)]), 1.0, "the camera is between");
        assert_eq!(x(&[detail(3.0, 1.0), detail(4e9, 1.0)]), 3.0, "near to the camera");
    }
}
