//! The choice of the point around which a scene's coordinates are stored.
//!
//! Coordinates in f32 are the finer, the nearer they are to it: it belongs where the scene is finest. The middle of the box
//! around everything would be drawn away by a large ground or a single far lamp.

use std::cmp::Ordering;

use glam::DVec3;

use crate::shape::Detail;

/// The median of the details' middles, axis by axis, each weighted by its density. Where two places divide the weight in half, the
/// point between them that is nearest to the camera; the camera itself where there are no details.
///
/// A lone far object moves it to the next detail at most, unless it weighs as much as all others together. The weights are rounded
/// down to powers of two, and what is less than 2⁻⁶⁴ of the greatest counts as nothing: their sums are whole numbers and exact, so
/// that two objects of the same size on both sides change nothing, in whatever order all are listed.
pub fn of(details: impl Iterator<Item = Detail>, eye: DVec3) -> DVec3 {
    let details: Vec<Detail> = details.collect();
    let greatest = details.iter().map(|detail| exponent(detail.density)).max().unwrap_or(0);
    let weight = |detail: &Detail| 1u128.checked_shl((64 + exponent(detail.density) - greatest).try_into().ok()?);
    let weighted: Vec<(DVec3, u128)> = details.iter().filter_map(|detail| Some((detail.middle, weight(detail)?))).collect();
    DVec3::from_array([0, 1, 2].map(|axis| median(weighted.iter().map(|(p, weight)| (p[axis], *weight)).collect(), eye[axis])))
}

/// The exponent of a positive number of normal size: log₂, rounded down, plus a constant.
fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32
}

/// The place below and above which less than half of the weight lies; of a gap with half of it on each side, the point nearest to
/// `eye`.
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

    /// Neither a large ground nor a far lamp moves the origin of a scene, nor does a pair of them.
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

    /// The order of the objects is of no influence, and twice the scene has its origin twice as far away.
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
