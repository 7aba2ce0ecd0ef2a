//! The part of a full turn about the z axis that a surface of revolution covers.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::math::float::{atan2_f64, sin_cos_degrees, sin_cos_f64};

/// Angles 0 ≤ φ ≤ φmax about the z axis, counted from +x towards +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sector {
    /// Angle φmax (rad).
    angle: f64,
    /// Directions at φmax/2 and at φmax; `None` for a full turn.
    ends: Option<[DVec2; 2]>,
}

impl Sector {
    /// The sector up to an angle from 0 to 360 degrees.
    pub fn new(degrees: f64) -> Sector {
        let direction = |degrees: f64| {
            let (sin, cos) = sin_cos_degrees(degrees);
            DVec2::new(cos, sin)
        };
        let ends = (degrees < 360.0).then(|| [0.5 * degrees, degrees].map(direction));
        Sector { angle: degrees * (TAU / 360.0), ends }
    }

    /// Angle φmax (rad).
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// Whether the point `p` lies in the sector, or outside of it by no more than `margin`.
    ///
    /// With the direction e of φmax and cross products in the plane, a point at most half a turn on lies to the left of +x and to the
    /// right of e. For more than half a turn one of the two is enough. A narrow sector also needs the middle direction, because the point
    /// opposite to it lies nearly on both lines.
    pub fn covers(&self, p: DVec2, margin: f64) -> bool {
        let Some([middle, end]) = self.ends else { return true };
        let (left, right) = (p.y >= -margin, p.perp_dot(end) >= -margin);
        if self.angle > 0.5 * TAU { left || right } else { left && right && p.dot(middle) >= -margin }
    }

    /// Angle φ of a direction, from 0 to φmax: the nearer end for a direction outside.
    pub fn angle_of(&self, direction: DVec2) -> f64 {
        let signed = atan2_f64(direction.y, direction.x);
        let phi = if signed < 0.0 { signed + TAU } else { signed };
        match () {
            () if phi <= self.angle => phi,
            () if phi - self.angle <= TAU - phi => self.angle,
            () => 0.0,
        }
    }

    /// Direction at a share of the sector.
    pub fn direction(&self, share: f64) -> DVec2 {
        let (sin, cos) = sin_cos_f64(self.angle * share);
        DVec2::new(cos, sin)
    }

    /// Greatest x·g over the unit directions x of the sector: |g| if the sector contains the direction of g, or the value at an end.
    pub fn greatest(&self, g: DVec2) -> f64 {
        match self.ends {
            Some([_, end]) if !self.covers(g, 0.0) => g.x.max(g.dot(end)),
            _ => g.length(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANGLES: [f64; 9] = [1e-9, 1.0, 89.0, 90.0, 179.0, 180.0, 181.0, 270.0, 359.0];

    /// The angle of each direction decides, at steps of half a degree, and within 10⁻¹⁰ of the ends.
    #[test]
    fn a_direction_is_covered_if_its_angle_is_in_range() {
        for degrees in ANGLES {
            let sector = Sector::new(degrees);
            for at in (0..720).map(|k| 0.5 * f64::from(k) + 0.25) {
                let (sin, cos) = sin_cos_degrees(at);
                assert_eq!(sector.covers(DVec2::new(cos, sin), 1e-13), at <= degrees, "{at} of {degrees}");
            }
            for (at, is_inside) in [(0.0, true), (degrees, true), (-1e-10, false), (degrees + 1e-10, false)] {
                let (sin, cos) = sin_cos_degrees(at);
                assert_eq!(sector.covers(DVec2::new(cos, sin), 1e-13), is_inside, "{at} of {degrees}");
            }
        }
    }

    /// Shares lead to directions whose angles lead back. Directions outside have the angle of the nearer end.
    #[test]
    fn angles_and_shares_belong_together() {
        for degrees in ANGLES.into_iter().chain([360.0]) {
            let sector = Sector::new(degrees);
            for share in [0.0, 0.1, 0.5, 0.9] {
                let again = sector.angle_of(sector.direction(share)) / sector.angle();
                assert!((again - share).abs() < 1e-9, "{again}, not {share}, of {degrees}");
            }
            if degrees < 360.0 {
                assert_eq!(sector.angle_of(DVec2::new(1.0, -1e-9)), 0.0);
                let (sin, cos) = sin_cos_degrees(degrees + 0.25);
                assert_eq!(sector.angle_of(DVec2::new(cos, sin)), sector.angle());
            }
        }
    }

    /// The greatest product is that of the best of many directions.
    #[test]
    fn the_greatest_product_is_that_of_the_best_direction() {
        for degrees in ANGLES.into_iter().chain([360.0]) {
            let sector = Sector::new(degrees);
            for at in (0..72).map(|k| 5.0 * f64::from(k) + 1.0) {
                let (sin, cos) = sin_cos_degrees(at);
                let g = 3.0 * DVec2::new(cos, sin);
                let found = (0..=4096).map(|k| sector.direction(f64::from(k) / 4096.0).dot(g)).fold(f64::NEG_INFINITY, f64::max);
                // The best of 4097 directions is at most half a step from the best of all: 3 (1 − cos(π/4096)) < 10⁻⁶.
                let greatest = sector.greatest(g);
                assert!(greatest >= found - 1e-14 && greatest <= found + 1e-6, "{at} of {degrees}: {greatest}, not {found}");
            }
        }
    }
}
