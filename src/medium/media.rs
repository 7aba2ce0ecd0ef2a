//! Where in a scene which medium is.

use arrayvec::ArrayVec;
use glam::{DAffine3, DVec3, Vec3};

use super::{Medium, MediumId};
use crate::math::Ray;

/// Media of a scene, and the bodies that contain them.
///
/// A body is a closed shape with a medium. Where bodies overlap, the medium of one of them counts: by the priorities of the media, then
/// that of the smaller body, so that what is inside something else counts there. The order of all bodies is decided once, when the scene
/// is built.
pub struct Media {
    /// The media that were described, and then copies of them for bodies that instances show.
    media: Vec<Medium>,
    /// Medium of each body. Of several bodies around a point, the first counts.
    bodies: Vec<BodyMedium>,
    /// Shape of each body.
    shapes: Vec<u32>,
    /// Index of each shape's body; [`NO_BODY`] for shapes without a medium.
    of_shapes: Vec<u16>,
    /// Medium outside of all bodies.
    around: Option<MediumId>,
    /// Bodies around the camera.
    at_camera: Inside,
    is_gray: bool,
}

/// Shape with a medium.
pub struct Body {
    /// Index of the shape.
    pub shape: u32,
    /// Its medium.
    pub medium: MediumId,
    /// Transform to the world from the space of a group, in which its density is described; `None` for bodies of the scene itself.
    pub to_world: Option<DAffine3>,
    /// Volume of the box around it along its own axes (m³).
    pub volume: f64,
}

/// Medium of a body.
#[derive(Clone, Copy)]
struct BodyMedium {
    /// The medium that was described.
    described: MediumId,
    /// Its copy for the body, or the same: an index among all media.
    index: u32,
}

/// Surface of a body at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Geometric normal of the surface.
    pub normal: Vec3,
    /// Index of the body.
    pub body: u16,
}

/// Point where a ray crosses the boundary of a medium that has no surface.
#[derive(Clone, Debug)]
pub struct InterfaceCrossing {
    /// Length of the way from the point that the ray leaves (m).
    pub length: f32,
    /// Surfaces of bodies there.
    pub boundaries: Boundaries,
    /// The ray from there on, to the same end.
    pub onward: Ray,
}

/// Surfaces of bodies in one place, at most four: a fifth body in the same place is neither entered nor left there.
pub type Boundaries = ArrayVec<Boundary, 4>;

const NO_BODY: u16 = u16::MAX;

/// Greatest number of bodies of a scene.
pub const MOST_BODIES: usize = NO_BODY as usize;

/// Greatest number of bodies around a point. Further ones have no effect there.
pub const MOST_NESTED: usize = 15;

/// Bodies around a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Inside {
    count: u16,
    /// Indices in ascending order, so that the first is the body whose medium counts.
    bodies: [u16; MOST_NESTED],
}

impl Media {
    /// Media with the shapes that contain them; at most [`MOST_BODIES`].
    ///
    /// - `around`: the medium outside of all bodies
    /// - `origin`: origin of the coordinates in which shapes are stored
    pub fn new(media: Vec<Medium>, mut bodies: Vec<Body>, around: Option<MediumId>, origin: DVec3) -> Media {
        let priority = |body: &Body| media[body.medium.0 as usize].priority;
        bodies.sort_by(|a, b| {
            let by_volume = a.volume.total_cmp(&b.volume);
            priority(a).cmp(&priority(b)).then(by_volume).then(b.shape.cmp(&a.shape))
        });
        let count = bodies.iter().map(|body| body.shape as usize + 1).max().unwrap_or(0);
        let mut of_shapes = vec![NO_BODY; count];
        let shapes = bodies.iter().map(|body| body.shape).collect();
        (0..).zip(&bodies).for_each(|(index, body)| of_shapes[body.shape as usize] = index);
        let is_gray = bodies.iter().map(|body| body.medium).chain(around).all(|medium| media[medium.0 as usize].is_gray());
        let to_stored = DAffine3::from_translation(-origin);
        let mut stored: Vec<Medium> = media.iter().map(|medium| medium.moved(to_stored)).collect();
        let of_body = |Body { medium: described, to_world, .. }: Body| {
            let medium = &media[described.0 as usize];
            let Some(to_world) = to_world.filter(|_| medium.density().is_some()) else {
                return BodyMedium { described, index: described.0 };
            };
            stored.push(medium.moved(to_stored * to_world));
            BodyMedium { described, index: stored.len() as u32 - 1 }
        };
        let bodies = bodies.into_iter().map(of_body).collect();
        Media { media: stored, bodies, shapes, of_shapes, around, at_camera: Inside::default(), is_gray }
    }

    /// The media with the bodies around the camera.
    pub fn with_camera(self, at_camera: Inside) -> Media {
        Media { at_camera, ..self }
    }

    /// Bodies around the camera.
    pub fn at_camera(&self) -> &Inside {
        &self.at_camera
    }

    /// Medium outside of all bodies.
    pub fn around(&self) -> Option<&Medium> {
        self.around.map(|medium| &self.media[medium.0 as usize])
    }

    /// Whether any medium of a body, or that around everything, emits light.
    pub fn emit(&self) -> bool {
        let used = self.bodies.iter().map(|body| body.index).chain(self.around.map(|medium| medium.0));
        used.into_iter().any(|medium| self.media[medium as usize].emits())
    }

    /// Index of the body of a shape.
    #[inline]
    pub fn body(&self, shape: u32) -> Option<u16> {
        self.of_shapes.get(shape as usize).copied().filter(|body| *body != NO_BODY)
    }

    /// Indices of all bodies, each with that of its shape.
    pub fn bodies(&self) -> impl Iterator<Item = (u16, u32)> {
        self.shapes.iter().enumerate().map(|(body, shape)| (body as u16, *shape))
    }

    /// Medium at a point, and its index among those that were described.
    ///
    /// - `inside`: bodies around the point
    #[inline]
    pub fn at(&self, inside: &Inside) -> Option<(MediumId, &Medium)> {
        let Some(body) = inside.first() else { return self.around.map(|id| (id, &self.media[id.0 as usize])) };
        let BodyMedium { described, index } = self.bodies[usize::from(body)];
        Some((described, &self.media[index as usize]))
    }

    /// Whether any medium that is used emits light.
    pub fn emits(&self) -> bool {
        self.bodies.iter().map(|body| body.described).chain(self.around).any(|medium| self.media[medium.0 as usize].emits())
    }

    /// Whether the extinction of every medium is equal for all wavelengths.
    pub fn is_gray(&self) -> bool {
        self.is_gray
    }
}

impl Inside {
    fn first(&self) -> Option<u16> {
        (self.count > 0).then_some(self.bodies[0])
    }

    /// Bodies around the point, by index.
    pub fn bodies(&self) -> &[u16] {
        &self.bodies[..usize::from(self.count)]
    }

    /// Goes beyond surfaces in a direction.
    pub fn cross(&mut self, boundaries: &Boundaries, direction: Vec3) {
        for Boundary { normal, body } in boundaries {
            self.set(*body, direction.dot(*normal) < 0.0);
        }
    }

    /// Enters a body, or leaves it. Entering a body again, or leaving it again, changes nothing.
    pub fn set(&mut self, body: u16, is_inside: bool) {
        let count = usize::from(self.count);
        match (self.bodies().binary_search(&body), is_inside) {
            (Err(place), true) if count < MOST_NESTED => {
                self.bodies.copy_within(place..count, place + 1);
                self.bodies[place] = body;
                self.count += 1;
            }
            (Ok(place), false) => {
                self.bodies.copy_within(place + 1..count, place);
                self.count -= 1;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Spectrum;
    use crate::medium::Phase;

    fn medium(priority: i32) -> Medium {
        Medium::new(Spectrum::ONE, Spectrum::BLACK, Phase::Isotropic).with_priority(priority)
    }

    #[test]
    fn bodies_are_entered_and_left_in_any_order() {
        let mut inside = Inside::default();
        for body in [5, 2, 9, 2, 7] {
            inside.set(body, true);
        }
        assert_eq!(inside.bodies(), [2, 5, 7, 9]);
        for body in [9, 2, 4] {
            inside.set(body, false);
        }
        assert_eq!(inside.bodies(), [5, 7]);
        (20..100).for_each(|body| inside.set(body, true));
        assert_eq!(inside.bodies().len(), MOST_NESTED);
    }

    #[test]
    fn the_inner_body_counts_unless_priorities_say_otherwise() {
        let body = |shape, medium, volume| Body { shape, medium: MediumId(medium), to_world: None, volume };
        let bodies = vec![body(0, 0, 8.0), body(1, 1, 1.0), body(2, 2, 64.0), body(3, 1, 1.0)];
        let media = Media::new(vec![medium(0), medium(0), medium(-1)], bodies, None, DVec3::ZERO);
        let at = |shapes: &[u32]| {
            let mut inside = Inside::default();
            shapes.iter().for_each(|shape| inside.set(media.body(*shape).expect("a body"), true));
            media.at(&inside).map(|(id, _)| id.0)
        };
        assert_eq!(at(&[]), None);
        assert_eq!((at(&[0]), at(&[0, 1]), at(&[1, 0])), (Some(0), Some(1), Some(1)));
        assert_eq!(at(&[0, 1, 2]), Some(2));
        assert_eq!(media.body(4), None);
    }
}
