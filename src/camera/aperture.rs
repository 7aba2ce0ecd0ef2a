//! Opening of a lens: a disk, or a regular polygon whose sides are the blades of an iris.
//!
//! ```text
//! A = π R²  or  A = n/2 R² sin(2π/n)                      R: radius of the disk, or of the circle around the n corners
//! ```

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::Vec2;

use crate::math::{float, warp};

/// Opening around the axis of a lens, in the plane of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aperture {
    /// Radius of the disk, or of the circle through the corners (m); 0 for a pinhole.
    pub radius: f32,
    /// The polygon; `None` for a disk.
    pub blades: Option<Blades>,
}

/// Blades of an iris that form a regular polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blades {
    /// Number of blades, at least 3.
    count: u32,
    /// Angle of the first corner from the x axis towards the y axis.
    first: f32,
}

impl Blades {
    /// Blades that form a polygon with one corner up, turned counterclockwise as the camera looks through it.
    ///
    /// - `count`: number of blades; fewer than 3 count as 3
    /// - `rotation`: in degrees
    pub fn new(count: u32, rotation: f64) -> Blades {
        Blades { count: count.max(3), first: FRAC_PI_2 + (rotation % 360.0).to_radians() as f32 }
    }

    /// Corner `k` on the unit circle.
    fn corner(&self, k: u32) -> Vec2 {
        let (sin, cos) = float::sin_cos(self.first + TAU * k as f32 / self.count as f32);
        Vec2::new(cos, sin)
    }

    /// Maps the unit square uniformly to the polygon: x goes round its triangles, and y away from the centre.
    fn point(&self, u: Vec2) -> Vec2 {
        let around = u.x * self.count as f32;
        // The product may be rounded up to the number of blades.
        let k = (around as u32).min(self.count - 1);
        self.corner(k).lerp(self.corner((k + 1) % self.count), (around - k as f32).min(1.0)) * u.y.sqrt()
    }
}

impl Aperture {
    /// A round opening with this radius (m).
    pub fn disk(radius: f32) -> Aperture {
        Aperture { radius, blades: None }
    }

    /// Whether the opening has a radius above 0.
    #[inline(always)]
    pub fn is_open(&self) -> bool {
        self.radius > 0.0
    }

    /// Maps the unit square uniformly to the opening (m).
    ///
    /// Tests: the_whole_lens_is_used, blades_are_sampled_evenly.
    #[inline(always)]
    pub fn point(&self, u: Vec2) -> Vec2 {
        let on_unit_circle = match &self.blades {
            None => warp::disk(u),
            Some(blades) => blades.point(u),
        };
        on_unit_circle * self.radius
    }

    /// Area (m²).
    pub fn area(&self) -> f32 {
        let of_unit_circle = match &self.blades {
            None => PI,
            Some(blades) => 0.5 * blades.count as f32 * float::sin(TAU / blades.count as f32),
        };
        of_unit_circle * self.radius * self.radius
    }
}
