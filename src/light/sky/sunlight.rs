//! Sunlight that reaches a point of the atmosphere.

use rayon::prelude::*;

use super::atmosphere::{Amounts, Atmosphere, Color, GROUND, KINDS, TOP};
use super::path::{amounts_to_top, distance_to_top, is_below_horizon};

/// Amounts of particles between points of the atmosphere and its upper end, as a table.
///
/// The table has the coordinates ρ/H and (d − d_least)/(d_most − d_least), with the distance ρ from the horizon's point of contact, its
/// greatest value H, and the distance d to the upper end, in which the amounts are smooth.
///
/// Source: Bruneton, *Precomputed Atmospheric Scattering: a New Implementation* (2017).
pub(super) struct Sunlight {
    atmosphere: Atmosphere,
    amounts: Vec<Amounts>,
}

/// Entries of the table by height and by direction. With fewer, interpolated sunlight near the horizon would be off by more than 10⁻³.
const HEIGHTS: usize = 96;
const DIRECTIONS: usize = 512;

/// Steps of the integrals in the table.
const STEPS: u32 = 12;

impl Sunlight {
    pub fn new(atmosphere: Atmosphere) -> Sunlight {
        let row = |height: usize| {
            (0..DIRECTIONS).map(move |direction| {
                let [x, y] = [(direction, DIRECTIONS), (height, HEIGHTS)].map(|(k, count)| k as f64 / (count - 1) as f64);
                let rho = y * horizon();
                let radius = (rho * rho + GROUND * GROUND).sqrt();
                let (least, most) = (TOP - radius, rho + horizon());
                let distance = least + x * (most - least);
                let cos = ((TOP - radius) * (TOP + radius) - distance * distance) / (2.0 * radius * distance);
                let cos = if distance > 0.0 { cos.clamp(-1.0, 1.0) } else { 1.0 };
                // Rounding must not turn the direction of the horizon into one towards the ground.
                let lowest = -rho / radius;
                amounts_to_top(radius, cos.max(lowest), STEPS)
            })
        };
        let rows: Vec<Vec<Amounts>> = (0..HEIGHTS).into_par_iter().map(|height| row(height).collect()).collect();
        Sunlight { atmosphere, amounts: rows.concat() }
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
        let [(column, x), (row, y)] = [(x, DIRECTIONS), (rho / horizon(), HEIGHTS)].map(|(share, count)| {
            let at = share.clamp(0.0, 1.0) * (count - 1) as f64;
            let low = at.floor().min((count - 2) as f64);
            (low as usize, at - low)
        });
        let line = |row: usize, kind: usize| {
            let at = row * DIRECTIONS + column;
            self.amounts[at][kind] * (1.0 - x) + self.amounts[at + 1][kind] * x
        };
        let amounts: [f64; KINDS] = std::array::from_fn(|kind| line(row, kind) * (1.0 - y) + line(row + 1, kind) * y);
        self.atmosphere.transmittance(&amounts)
    }
}

/// Length of the tangent from a point of the ground to the upper end of the atmosphere (m).
fn horizon() -> f64 {
    ((TOP - GROUND) * (TOP + GROUND)).sqrt()
}
