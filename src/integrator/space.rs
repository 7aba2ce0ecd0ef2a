//! The space between the vertices of a path: empty, or filled with media.
//!
//! A walk is generic over its [`Space`] and compiled twice, so that scenes without media do not pay for them.

mod distances;
mod flight;
mod stretches;
mod way;

use std::ops::ControlFlow;

use self::flight::Flight;
use self::stretches::{Stretch, stretches};
use self::way::Way;
use super::{CameraPath, CameraSample};
use crate::math::{Ray, Spectrum, Vec3};
use crate::medium::{Boundaries, Inside, transmittance};
use crate::primitive::Hit;
use crate::recorder::{Event, Origin, Recorder};
use crate::sampler::SampleNumbers;
use crate::sampler::dimension::{self, Use};
use crate::scene::{MediumPoint, Scene, Surface};

/// Space in which a path is: what lies between its vertices, and what it needs to know of that.
pub trait Space: Send + Sync + 'static {
    /// The space at the start of a path.
    fn at_camera(scene: &dyn Scene, camera: &CameraSample) -> Self;

    /// The point before the next surface at which a medium scatters the path, if it does. What the medium emits is added to the path, and
    /// what it absorbs is taken from the throughput.
    ///
    /// - `hit`: next surface; `None` if there is none
    fn scatter<'s, R: Recorder + ?Sized>(
        &mut self,
        scene: &'s dyn Scene,
        path: &mut CameraPath,
        hit: Option<&Hit>,
        numbers: &mut SampleNumbers,
        recorder: &mut R,
    ) -> Option<MediumPoint<'s>>;

    /// A point on the way to the next surface at which media scatter light into the path, the weight of that light, and the space around
    /// the point. The point does not depend on where [`Space::scatter`] scatters the path: its light stands for that of all such points.
    ///
    /// - `hit`: next surface; `None` if there is none
    fn point_on_way<'s>(
        &mut self,
        scene: &'s dyn Scene,
        path: &CameraPath,
        hit: Option<&Hit>,
        numbers: &mut SampleNumbers,
    ) -> Option<(MediumPoint<'s>, Spectrum, Self)>
    where
        Self: Sized;

    /// Whether the vertex is a point of a medium, and [`Space::point_on_way`] has chosen a point in its place.
    fn was_lit_on_way(&self) -> bool;

    /// Takes note of the surface at which the path has arrived.
    fn arrive(&mut self, scene: &dyn Scene, hit: &Hit, surface: &Surface);

    /// Takes note of the direction in which the path leaves its vertex.
    fn leave(&mut self, wi: Vec3);

    /// Share of the light that passes along a ray from the vertex of the path to the end of the ray; `None` if none does.
    fn transmittance(&self, scene: &dyn Scene, ray: &Ray) -> Option<Spectrum>;
}

/// Empty space: light passes from surface to surface.
#[derive(Clone, Copy, Debug)]
pub struct Vacuum;

impl Space for Vacuum {
    #[inline(always)]
    fn at_camera(_: &dyn Scene, _: &CameraSample) -> Vacuum {
        Vacuum
    }

    #[inline(always)]
    fn scatter<'s, R: Recorder + ?Sized>(
        &mut self,
        _: &'s dyn Scene,
        _: &mut CameraPath,
        _: Option<&Hit>,
        _: &mut SampleNumbers,
        _: &mut R,
    ) -> Option<MediumPoint<'s>> {
        None
    }

    #[inline(always)]
    fn point_on_way<'s>(
        &mut self,
        _: &'s dyn Scene,
        _: &CameraPath,
        _: Option<&Hit>,
        _: &mut SampleNumbers,
    ) -> Option<(MediumPoint<'s>, Spectrum, Vacuum)> {
        None
    }

    #[inline(always)]
    fn was_lit_on_way(&self) -> bool {
        false
    }

    #[inline(always)]
    fn arrive(&mut self, _: &dyn Scene, _: &Hit, _: &Surface) {}

    #[inline(always)]
    fn leave(&mut self, _: Vec3) {}

    #[inline(always)]
    fn transmittance(&self, scene: &dyn Scene, ray: &Ray) -> Option<Spectrum> {
        scene.transmittance(ray)
    }
}

/// Space with media.
#[derive(Clone, Debug)]
pub struct Filled {
    /// Bodies around the path.
    inside: Inside,
    /// Surfaces of bodies where the path is.
    at: Boundaries,
    /// Whether a point on the way to the next surface was chosen.
    has_point_on_way: bool,
}

impl Filled {
    fn new(inside: Inside) -> Filled {
        Filled { inside, at: Boundaries::new(), has_point_on_way: false }
    }

    /// Bodies around a ray that leaves the vertex in a direction.
    fn beyond(&self, wi: Vec3) -> Inside {
        let mut inside = self.inside;
        inside.cross(&self.at, wi);
        inside
    }
}

impl Space for Filled {
    fn at_camera(_: &dyn Scene, camera: &CameraSample) -> Filled {
        Filled::new(camera.inside)
    }

    fn scatter<'s, R: Recorder + ?Sized>(
        &mut self,
        scene: &'s dyn Scene,
        path: &mut CameraPath,
        hit: Option<&Hit>,
        numbers: &mut SampleNumbers,
        recorder: &mut R,
    ) -> Option<MediumPoint<'s>> {
        let media = scene.media()?;
        let (ray, depth) = (path.ray, path.depth);
        let mut flight = None;
        let visit = |stretch: &Stretch<'s>| {
            let Some((id, medium)) = stretch.medium else { return ControlFlow::Continue(()) };
            let length = stretch.length;
            if medium.emits() {
                path.add_emission(medium.emitted(length), recorder, Origin::medium);
            }
            if !medium.scatters() {
                path.beta *= transmittance(medium.depth(length));
                return ControlFlow::Continue(());
            }
            let flight = flight.get_or_insert_with(|| Flight::new(media, path.beta, numbers.get_1d(dimension::vertex(depth, Use::Medium))));
            let extinction = medium.extinction().coefficients()[flight.channel];
            let reach = if extinction > 0.0 { flight.left / extinction } else { f32::INFINITY };
            if reach >= length {
                path.beta *= flight.pass(medium, length);
                return ControlFlow::Continue(());
            }
            path.beta *= flight.scattered(medium, reach);
            ControlFlow::Break((id, medium, stretch.start + reach))
        };
        let t_max = hit.map_or(f32::INFINITY, |hit| hit.t);
        let ControlFlow::Break((id, medium, length)) = stretches(scene, media, &mut self.inside, &ray, t_max, visit) else { return None };
        self.at = Boundaries::new();
        path.leave_surfaces();
        let shift = (ray.origin - ray.from).dot(ray.direction);
        let point = MediumPoint { p: ray.at((length - shift).max(0.0)), phase: &medium.phase };
        recorder.record(|| Event::medium(depth, length, id, &point, -ray.direction, path.beta));
        Some(point)
    }

    fn point_on_way<'s>(
        &mut self,
        scene: &'s dyn Scene,
        path: &CameraPath,
        hit: Option<&Hit>,
        numbers: &mut SampleNumbers,
    ) -> Option<(MediumPoint<'s>, Spectrum, Filled)> {
        let media = scene.media()?;
        let mut way = Way::new();
        self.has_point_on_way = way.follow(scene, media, &self.inside, &path.ray, hit);
        if !self.has_point_on_way {
            return None;
        }
        let (point, weight, inside) = way.sample(scene, media, path, numbers)?;
        Some((point, weight, Filled::new(inside)))
    }

    fn was_lit_on_way(&self) -> bool {
        self.has_point_on_way
    }

    fn arrive(&mut self, scene: &dyn Scene, hit: &Hit, surface: &Surface) {
        self.at = scene.boundaries(hit, &surface.point);
        self.has_point_on_way = false;
    }

    fn leave(&mut self, wi: Vec3) {
        self.inside = self.beyond(wi);
        self.has_point_on_way = false;
    }

    fn transmittance(&self, scene: &dyn Scene, ray: &Ray) -> Option<Spectrum> {
        let unoccluded = scene.transmittance(ray)?;
        let Some(media) = scene.media() else { return Some(unoccluded) };
        let mut depth = Spectrum::BLACK;
        let add = |stretch: &Stretch| {
            depth += stretch.medium.map_or(Spectrum::BLACK, |(_, medium)| medium.depth(stretch.length));
            ControlFlow::<()>::Continue(())
        };
        let _ = stretches(scene, media, &mut self.beyond(ray.direction), ray, ray.t_max, add);
        let passed = transmittance(depth);
        (!passed.is_black()).then_some(passed)
    }
}
