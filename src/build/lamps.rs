//! Warnings about lamps that face away from the scene.

use glam::DVec3;

use super::Builder;
use crate::camera::Camera;
use crate::describe::Shape;
use crate::math::Transform;
use crate::reader::locate;

/// A flat shape that emits on one side.
pub(super) struct Lamp {
    pointer: String,
    /// The index of its box in `Builder::boxes`.
    shape: usize,
    /// A point of the lamp's plane, in world space.
    point: DVec3,
    /// The normal on the emitting side, in world space.
    normal: DVec3,
}

/// The largest number of lamps that are tested, each against all shapes.
const LOOKED_AT: usize = 1000;
/// The largest number of lamps that warnings name.
const NAMED: usize = 3;

impl Builder<'_> {
    /// Remembers the shape that is placed next, if it is flat and emits on one side.
    pub(super) fn note_lamp(&mut self, pointer: &str, shape: &Shape, to_world: &Transform) {
        let is_flat = matches!(shape, Shape::Quad(_) | Shape::Disk(_));
        let shines = shape.emission().is_some_and(|emission| !emission.two_sided && emission.radiance.linear() != [0.0; 3]);
        if is_flat && shines && self.lamps.len() < LOOKED_AT {
            let (point, normal) = (to_world.point(DVec3::ZERO), to_world.normal(DVec3::Z));
            self.lamps.push(Lamp { pointer: format!("{pointer}/emission"), shape: self.boxes.len(), point, normal });
        }
    }

    /// Warnings about lamps that have the camera and all other shapes behind them.
    pub(super) fn averted(&self, camera: &Camera) -> Vec<String> {
        let message = "the lamp faces away from everything in the scene: turn it round, or say \"two_sided\": true";
        // A camera that moves may come to the other side.
        if camera.is_moving() {
            return vec![];
        }
        let said = |lamp: &Lamp| locate(self.source.root, self.source.file, &lamp.pointer, message).to_string();
        self.lamps.iter().filter(|lamp| self.is_averted(lamp, camera)).take(NAMED).map(said).collect()
    }

    fn is_averted(&self, lamp: &Lamp, camera: &Camera) -> bool {
        let others = self.boxes.iter().enumerate().filter(|(shape, _)| *shape != lamp.shape);
        !camera.faces(lamp.point, lamp.normal) && others.into_iter().all(|(_, around)| lamp.is_before(*around))
    }
}

impl Lamp {
    /// Whether a box lies entirely behind the lamp's plane, with a tolerance for the rounding of a box that touches the plane.
    fn is_before(&self, (low, high): (DVec3, DVec3)) -> bool {
        // The corner of the box that is farthest along the normal.
        let corner = DVec3::select(self.normal.cmpge(DVec3::ZERO), high, low);
        let rounding = 64.0 * f64::EPSILON * self.normal.abs().dot(corner.abs().max(self.point.abs()));
        (corner - self.point).dot(self.normal) <= rounding
    }
}
