//! Thick lens: what a lens does to rays near its axis.
//!
//! ```text
//! (y, n θ)' = (A B; C D) (y, n θ),    refraction: (1 0; −φ 1), φ = (n' − n)/R,    thickness: (1 t/n; 0 1)
//! f = −1/C,  H = (D − 1)/C behind the front surface,  H' = (1 − A)/C behind the rear surface
//! 1/u + 1/v = 1/f                                         u: from the object to H, v: from H' to the film
//! ```
//!
//! Source: Hecht, *Optics* (2017), §6.2; Pharr, Jakob and Humphreys, *Physically Based Rendering* (2023), §5.4.3.

use super::table::LensTable;

/// Cardinal points of a lens in air. Positions count along the axis towards the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThickLens {
    /// Focal length f.
    pub focal_length: f64,
    /// Front principal plane H, behind the first surface.
    pub front: f64,
    /// Rear principal plane H', behind the last surface.
    pub rear: f64,
    /// Distance from H to H'.
    pub separation: f64,
}

impl ThickLens {
    /// The cardinal points of a lens.
    ///
    /// # Errors
    /// The lens does not bring parallel rays together.
    ///
    /// Tests: a_singlet_is_that_of_the_lensmaker.
    pub fn new(table: &LensTable) -> Result<ThickLens, String> {
        let [mut a, mut b, mut c, mut d] = [1.0, 0.0, 0.0, 1.0];
        let last = table.surfaces().len() - 1;
        for (k, surface) in table.surfaces().iter().enumerate() {
            let power = (surface.ior - table.ior_before(k)) * surface.curvature;
            (c, d) = (c - power * a, d - power * b);
            if k < last {
                let reduced = surface.thickness / surface.ior;
                (a, b) = (a + reduced * c, b + reduced * d);
            }
        }
        let focal_length = -1.0 / c;
        if !(focal_length > 0.0 && focal_length.is_finite()) {
            return Err("this lens does not bring parallel light together: expected a positive focal length".to_owned());
        }
        let (front, rear) = ((d - 1.0) / c, (1.0 - a) / c);
        Ok(ThickLens { focal_length, front, rear, separation: table.length() + rear - front })
    }

    /// Least distance between an object and its picture.
    pub fn least_distance(&self) -> f64 {
        4.0 * self.focal_length + self.separation
    }

    /// Distance of the film behind the last surface that brings into focus what is at a distance from the film; `None` if it is
    /// nearer than [`ThickLens::least_distance`], or the film would be in the lens.
    ///
    /// With T = u + v the equation is v² − T v + f T = 0. The lens is nearer to the film than to the object, so that v is the lesser root.
    pub fn film_distance(&self, focus_distance: f64) -> Option<f64> {
        let (f, sum) = (self.focal_length, focus_distance - self.separation);
        let root = (1.0 - 4.0 * f / sum).sqrt();
        let behind = self.rear + 2.0 * f / (1.0 + root);
        (sum > 0.0 && root.is_finite() && behind > 0.0).then_some(behind)
    }
}
