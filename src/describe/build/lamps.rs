//! Lamps that light nothing.

use glam::DVec3;

use super::Builder;
use crate::camera::Camera;
use crate::describe::Shape;
use crate::math::Transform;
use crate::reader::locate;

/// A flat shape that emits on one side.
pub(super) struct Lamp {
    pointer: String,
    /// Its place among all boxes.
    shape: usize,
    point: DVec3,
    /// To the side that shines.
    normal: DVec3,
}

/// So many lamps are looked at, each against all shapes, and so many are named.
const LOOKED_AT: usize = 1000;
const NAMED: usize = 3;

impl Builder<'_> {
    /// Notes the shape that is placed next, if it is a lamp that may face away.
    pub(super) fn note_lamp(&mut self, pointer: &str, shape: &Shape, to_world: &Transform) {
        let is_flat = matches!(shape, Shape::Quad(_) | Shape::Disk(_));
        let shines = shape.emission().is_some_and(|emission| !emission.two_sided && emission.radiance.linear() != [0.0; 3]);
        if is_flat && shines && self.lamps.len() < LOOKED_AT {
            let (point, normal) = (to_world.point(DVec3::ZERO), to_world.normal(DVec3::Z));
            self.lamps.push(Lamp { pointer: format!("{pointer}/emission"), shape: self.boxes.len(), point, normal });
        }
    }

    /// Says so of lamps that have the camera and every other shape behind them.
    pub(super) fn averted(&self, camera: &Camera) -> Vec<String> {
        let message = "the lamp faces away from everything in the scene: turn it round, or say \"two_sided\": true";
        let said = |lamp: &Lamp| locate(self.source.root, self.source.file, &lamp.pointer, message).to_string();
        self.lamps.iter().filter(|lamp| self.is_averted(lamp, camera)).take(NAMED).map(said).collect()
    }

    fn is_averted(&self, lamp: &Lamp, camera: &Camera) -> bool {
        let others = self.boxes.iter().enumerate().filter(|(shape, _)| *shape != lamp.shape);
        !camera.faces(lamp.point, lamp.normal) && others.into_iter().all(|(_, around)| lamp.is_before(*around))
    }
}

impl Lamp {
    /// Whether nothing of a box lies on the side that shines, but for what rounding makes of a box that touches its plane.
    fn is_before(&self, (low, high): (DVec3, DVec3)) -> bool {
        // The corner that is the farthest along the normal.
        let corner = DVec3::select(self.normal.cmpge(DVec3::ZERO), high, low);
        let rounding = 64.0 * f64::EPSILON * self.normal.abs().dot(corner.abs().max(self.point.abs()));
        (corner - self.point).dot(self.normal) <= rounding
    }
}
