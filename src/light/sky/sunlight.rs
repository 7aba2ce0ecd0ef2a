//! Sunlight that reaches a point of the atmosphere.

use super::atmosphere::{Atmosphere, Color, GROUND, TOP};
use super::path::{amounts_to_top, distance_to_top, is_below_horizon};
use super::table::{Table, coordinate};

/// Amounts of particles between points of the atmosphere and its upper end, as a table.
///
/// The coordinates of the table are ρ/H and (d − d_least)/(d_most − d_least), in which the amounts are smooth. ρ is the distance from the
/// point to its horizon (where the tangent touches the ground), H the greatest ρ, and d the distance along the ray to the upper end.
///
/// Source: Bruneton, *Precomputed Atmospheric Scattering: a New Implementation* (2017).
pub(super) struct Sunlight {
    atmosphere: Atmosphere,
    /// Amounts of particles (m).
    amounts: Table,
}

/// Entries of the table by height and by direction: light that is scattered once is then within 10⁻³ of the exact integrals.
const HEIGHTS: usize = 96;
const DIRECTIONS: usize = 512;

/// Steps of the integrals in the table.
const STEPS: u32 = 12;

impl Sunlight {
    /// Computes the table of an atmosphere.
    pub fn new(atmosphere: Atmosphere) -> Sunlight {
        let row = |y: f64| {
            let rho = y * horizon();
            let radius = (rho * rho + GROUND * GROUND).sqrt();
            let (least, most) = (TOP - radius, rho + horizon());
            // Rounding must not turn the direction of the horizon into one towards the ground.
            let lowest = -rho / radius;
            let entry = |direction: usize| {
                let distance = least + coordinate(direction, DIRECTIONS) * (most - least);
                let cos = ((TOP - radius) * (TOP + radius) - distance * distance) / (2.0 * radius * distance);
                let cos = if distance > 0.0 { cos.clamp(-1.0, 1.0) } else { 1.0 };
                amounts_to_top(radius, cos.max(lowest), STEPS)
            };
            (0..DIRECTIONS).map(entry).collect()
        };
        Sunlight { atmosphere, amounts: Table::new(DIRECTIONS, HEIGHTS, row) }
    }

    /// Share of the sunlight that reaches a point; 0 in the shadow of the earth.
    ///
    /// - `radius`: distance from the centre of the earth (m); `cos`: cosine between the zenith and the sun there
    pub fn at(&self, radius: f64, cos: f64) -> Color {
        if is_below_horizon(radius, cos) {
            return [0.0; 3];
        }
        let rho = ((radius - GROUND) * (radius + GROUND)).max(0.0).sqrt();
        let (least, most) = (TOP - radius, rho + horizon());
        let x = (distance_to_top(radius, cos) - least) / (most - least);
        self.atmosphere.transmittance(&self.amounts.at(x, rho / horizon()))
    }
}

/// Length of the tangent from a point of the ground to the upper end of the atmosphere (m).
fn horizon() -> f64 {
    ((TOP - GROUND) * (TOP + GROUND)).sqrt()
}
