//! A checkerboard.

use glam::{DVec3, Vec3};

use super::{Space, Texture, TextureContext};
use crate::math::Rgb;

/// A checkerboard: `even` where ⌊x⌋ + ⌊y⌋ + ⌊z⌋ is even, in cells of the texture's space.
#[derive(Clone, Debug, PartialEq)]
pub struct Checker {
    /// The colour of the even cells.
    pub even: Texture,
    /// The colour of the odd cells.
    pub odd: Texture,
    /// Cells per unit of the coordinates, along each axis.
    pub scale: Vec3,
    /// The coordinates of the cells.
    pub space: Space,
}

impl Checker {
    /// Looks up the colour at a point.
    pub fn at(&self, at: &TextureContext) -> Rgb {
        let place = self.space.coordinates(at) * self.scale.as_dvec3();
        if let Some(widths) = self.space.widths(at) {
            let share = even_share(place, widths * self.scale.as_dvec3());
            return self.odd.at(at).mix(self.even.at(at), share as f32);
        }
        if is_even(place.map(f64::floor)) { self.even.at(at) } else { self.odd.at(at) }
    }

    pub(super) fn recentred(self, origin: DVec3) -> Checker {
        let space = self.space.recentred(origin);
        Checker { even: self.even.recentred(origin), odd: self.odd.recentred(origin), scale: self.scale, space }
    }
}

/// The share of the even cells in a box around a point: ½ (1 + Π mean of s over the box's side), where s is 1 and −1 in turn.
///
/// Tests: filtered_checkers_are_means_over_boxes.
fn even_share(place: DVec3, widths: DVec3) -> f64 {
    let mean = |k: usize| {
        let (x, w) = (place[k], widths[k]);
        // The integral of s from 0 to x is a triangle wave: even for even x, so that whole pairs of cells cancel.
        let integral = |x: f64| 1.0 - (modulo_2(x) - 1.0).abs();
        let [from, to] = [x - 0.5 * w, x + 0.5 * w];
        // A box within one cell: the difference of the integrals would lose digits.
        if from.floor() == to.floor() { 1.0 - 2.0 * modulo_2(from.floor()) } else { (integral(to) - integral(from)) / w }
    };
    0.5 * (1.0 + mean(0) * mean(1) * mean(2))
}

/// Whether the sum of three whole numbers is even.
fn is_even(cell: DVec3) -> bool {
    modulo_2(cell.x + cell.y + cell.z) < 1.0
}

/// `x.rem_euclid(2.0)` for all but subnormal numbers, without the slow remainder: halving, floor and doubling are exact, so that only the
/// subtraction rounds, as there.
fn modulo_2(x: f64) -> f64 {
    x - 2.0 * (0.5 * x).floor()
}

#[cfg(test)]
mod tests {
    use super::modulo_2;

    #[test]
    fn modulo_2_is_the_remainder() {
        let sizes = (-1021..1024).step_by(3).map(|k| 2f64.powi(k)).flat_map(|x| [x.next_down(), x, x.next_up(), 1.37 * x]);
        let near = (1..4000).map(|k| f64::from(k) * 0.25).flat_map(|x| [x.next_down(), x, x.next_up()]);
        for x in sizes.chain(near).flat_map(|x| [x, -x]).filter(|x| x.is_finite()) {
            assert_eq!(modulo_2(x), x.rem_euclid(2.0), "{x:e}");
        }
        assert!(modulo_2(f64::INFINITY).is_nan() && modulo_2(f64::NAN).is_nan());
    }
}
