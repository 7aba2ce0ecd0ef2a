//! Cameras in double precision.

use glam::{DVec2, DVec3};

use super::surfaces::DoubleRay;

/// A camera at `eye` that looks along −`back`.
pub struct DoubleCamera {
    pub eye: DVec3,
    /// Unit axes of the camera: x to the right, y up, z to the back.
    pub right: DVec3,
    pub up: DVec3,
    pub back: DVec3,
    pub lens: Lens,
}

/// How a camera maps points of the film to rays.
pub enum Lens {
    /// Parallel rays; the picture shows this height (m).
    Orthographic { height: f64 },
    /// A pinhole, or a thin lens.
    Perspective {
        /// Tangent of half the vertical field of view.
        tan: f64,
        /// Width / height of the view, if it is not that of the film.
        aspect: Option<f64>,
        /// Shift of the view to the right and up, by fractions of the picture.
        shift: DVec2,
        /// Radius of the lens; 0 for a pinhole (m).
        radius: f64,
        /// Inverse distance of the plane of focus at slopes x and y of the ray: 1/s − g·(x, y).
        focus: f64,
        tilt: DVec2,
    },
}

impl DoubleCamera {
    /// Ray through a point of the film.
    ///
    /// - `film`: position in [0, 1)², from the upper left corner
    /// - `aspect`: width / height of the film
    /// - `lens`: point of the lens in the unit disk
    pub fn ray(&self, film: DVec2, aspect: f64, lens: DVec2) -> DoubleRay {
        // From −1 to 1, x to the right and y up.
        let (x, y) = (2.0 * film.x - 1.0, 1.0 - 2.0 * film.y);
        let (from, towards) = match &self.lens {
            Lens::Orthographic { height } => (DVec3::new(x * aspect, y, 0.0) * (0.5 * height), DVec3::NEG_Z),
            Lens::Perspective { tan, aspect: own, shift, radius, focus, tilt } => {
                let slope = DVec2::new((x + 2.0 * shift.x) * own.unwrap_or(aspect), y + 2.0 * shift.y) * *tan;
                let from = lens * *radius;
                // All rays of a point of the film meet at the depth 1 / (focus − tilt·slope).
                let towards = slope - from * (focus - tilt.dot(slope));
                (from.extend(0.0), towards.extend(-1.0))
            }
        };
        let in_world = |v: DVec3| self.right * v.x + self.up * v.y + self.back * v.z;
        DoubleRay { origin: self.eye + in_world(from), direction: in_world(towards).normalize() }
    }
}
