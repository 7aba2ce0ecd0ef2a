//! Bounds of lights: where they are, in which directions they emit, and how strongly.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::math::Aabb;
use crate::math::float::{acos_f64, atan2_f64, sin_cos_f64};

/// Bounds of one light, or of several.
///
/// A cone of normals with the half angle θo around the axis contains the normals of all emitting surfaces. They emit at angles up to θe
/// from their normals.
///
/// Source: Conty Estevez and Kulla, *Importance Sampling of Many Lights with Adaptive Tree Splitting* (2018).
/// Tests: measures_of_directions, unions_of_cones_contain_both, every_light_that_shines_can_be_chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LightBounds {
    /// Box around all points that emit (m).
    pub space: Aabb,
    /// Unit axis of the cone of normals.
    pub axis: DVec3,
    /// Half angle θo of the cone of normals (rad).
    pub theta_o: f64,
    /// Greatest angle θe between a normal and emitted light (rad).
    pub theta_e: f64,
    /// Whether surfaces emit to both sides, so that each normal stands for its opposite too.
    pub two_sided: bool,
    /// Sum of the lights' intensities, each in the direction in which it is greatest, or for curved surfaces in the mean over all
    /// directions [W·sr⁻¹].
    pub intensity: f64,
}

impl LightBounds {
    /// A flat surface that emits around its normal.
    pub fn flat(space: Aabb, normal: DVec3, two_sided: bool, intensity: f64) -> LightBounds {
        LightBounds::around(space, normal, 0.0, two_sided, intensity)
    }

    /// A surface with normals within a cone.
    ///
    /// - `angle`: half angle of the cone (rad)
    pub fn around(space: Aabb, axis: DVec3, angle: f64, two_sided: bool, intensity: f64) -> LightBounds {
        LightBounds { space, axis, theta_o: angle, theta_e: FRAC_PI_2, two_sided, intensity }
    }

    /// A light that emits in all directions.
    pub fn all_directions(space: Aabb, intensity: f64) -> LightBounds {
        LightBounds { space, axis: DVec3::Z, theta_o: PI, theta_e: FRAC_PI_2, two_sided: false, intensity }
    }

    /// A point that emits with its full intensity within a cone.
    ///
    /// - `cos`: cosine of the half angle of the cone
    pub fn cone(space: Aabb, axis: DVec3, cos: f64, intensity: f64) -> LightBounds {
        LightBounds { space, axis, theta_o: acos_f64(cos), theta_e: 0.0, two_sided: false, intensity }
    }

    /// Bounds of both.
    pub fn union(self, other: LightBounds) -> LightBounds {
        let two_sided = self.two_sided || other.two_sided;
        // A two-sided cone may be stated by either of its axes.
        let flip = two_sided && self.axis.dot(other.axis) < 0.0;
        let other_axis = if flip { -other.axis } else { other.axis };
        let (axis, theta_o) = cone_union((self.axis, self.theta_o), (other_axis, other.theta_o));
        LightBounds {
            space: self.space.union(other.space),
            axis,
            theta_o,
            theta_e: self.theta_e.max(other.theta_e),
            two_sided,
            intensity: self.intensity + other.intensity,
        }
    }

    /// Cost of the bounds as a node of a tree: intensity, times the measure of the directions, times the squared diagonal of the box.
    ///
    /// The squared diagonal takes the place of the area in the source, so that lights along a line are divided too.
    pub fn cost(&self) -> f64 {
        let diagonal = (self.space.max - self.space.min).as_dvec3();
        self.intensity * directions(self.theta_o, self.theta_e) * diagonal.length_squared()
    }
}

/// Measure M of the directions in which lights with the normals of a cone emit:
///
/// M = 2π (1 − cos θo) + π/2 (2 θw sin θo − cos(θo − 2 θw) − 2 θo sin θo + cos θo),    θw = min(θo + θe, π)
pub(super) fn directions(theta_o: f64, theta_e: f64) -> f64 {
    let theta_w = (theta_o + theta_e).min(PI);
    let ((sin, cos), (_, far)) = (sin_cos_f64(theta_o), sin_cos_f64(theta_o - 2.0 * theta_w));
    2.0 * PI * (1.0 - cos) + FRAC_PI_2 * (2.0 * (theta_w - theta_o) * sin - far + cos)
}

/// Axis and half angle of the smallest cone around two cones.
fn cone_union((a, a_angle): (DVec3, f64), (b, b_angle): (DVec3, f64)) -> (DVec3, f64) {
    let between = atan2_f64(a.cross(b).length(), a.dot(b));
    if between + b_angle <= a_angle {
        return (a, a_angle);
    }
    if between + a_angle <= b_angle {
        return (b, b_angle);
    }
    let half = 0.5 * (a_angle + between + b_angle);
    let aside = (b - a * a.dot(b)).try_normalize();
    match aside {
        Some(aside) if half < PI => {
            let (sin, cos) = sin_cos_f64(half - a_angle);
            ((a * cos + aside * sin).normalize(), half)
        }
        _ => (a, PI),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_4, FRAC_PI_6};

    use approx::assert_relative_eq;

    use super::*;
    use crate::math::Vec3;

    /// The integral over all directions of the factor cos θ′, computed by hand for five cones.
    #[test]
    fn measures_of_directions() {
        let exact = [
            (0.0, FRAC_PI_2, PI),
            (FRAC_PI_6, FRAC_PI_2, 6.029_887_361),
            (FRAC_PI_2, FRAC_PI_2, 11.217_987_508),
            (PI, FRAC_PI_2, 4.0 * PI),
            (0.0, FRAC_PI_6, FRAC_PI_4),
        ];
        for (theta_o, theta_e, expected) in exact {
            assert_relative_eq!(directions(theta_o, theta_e), expected, max_relative = 1e-9);
        }
    }

    /// The union of two cones contains every direction of both: those at the rim of each are tried.
    #[test]
    fn unions_of_cones_contain_both() {
        let turned = |k: f64| DVec3::new((1.3 * k).sin(), (2.1 * k).cos(), (0.7 * k).sin() + 0.1).normalize();
        for k in 0..2000 {
            let k = f64::from(k);
            let cones = [(turned(k), (0.37 * k) % PI), (turned(k + 0.5), (0.61 * k) % PI)];
            let (axis, angle) = cone_union(cones[0], cones[1]);
            for (of, half) in cones {
                let aside = of.any_orthonormal_vector();
                for turn in 0..16 {
                    let around = aside * f64::from(turn).cos() + of.cross(aside) * f64::from(turn).sin();
                    let rim = of * half.cos() + around * half.sin();
                    assert!(axis.angle_between(rim) <= angle + 1e-9, "{cones:?}: {axis} {angle}");
                }
            }
        }
    }

    /// A union with a two-sided light contains its normals or their opposites.
    #[test]
    fn unions_with_two_sided_lights_may_turn_them() {
        let flat = |normal: DVec3, two_sided| LightBounds::flat(Aabb::around([Vec3::ZERO]), normal, two_sided, 1.0);
        let both = flat(DVec3::Z, false).union(flat(DVec3::NEG_Z, true));
        assert_eq!((both.axis, both.theta_o, both.two_sided), (DVec3::Z, 0.0, true));
        let opposite = flat(DVec3::Z, false).union(flat(DVec3::NEG_Z, false));
        assert_eq!(opposite.theta_o, PI);
    }
}
