//! The space between the vertices of a path: empty, or filled with media.
//!
//! A walk is generic over its [`Space`] and compiled twice, so that scenes without media do not pay for them.

mod distances;
mod flight;
mod lanes;
mod stretches;
mod tracking;
mod way;

use std::ops::ControlFlow;

use self::flight::Flight;
pub use self::lanes::WideSpace;
use self::stretches::{Stretch, stretches};
use self::tracking::Collision;
use self::way::Way;
use super::{CameraPath, CameraSample, PathState};
use crate::light::EmittedRay;
use crate::math::{Ray, Spectrum, Vec3};
use crate::medium::{Boundaries, Density, Inside, Media, Medium, transmittance};
use crate::primitive::Hit;
use crate::recorder::{Event, Recorder};
use crate::sampler::dimension::{self, Use};
use crate::sampler::{SampleNumbers, Stream};
use crate::scene::{MediumPoint, Scene, Surface};

/// Space in which a path is: what lies between its vertices, and what it needs to know of that.
pub trait Space: Send + Sync + 'static {
    /// The space at the start of a path from the camera.
    fn at_camera(scene: &dyn Scene, camera: &CameraSample) -> Self;

    /// The space at the start of a path from a light.
    fn at_light(scene: &dyn Scene, emitted: &EmittedRay) -> Self;

    /// The point before the next surface at which a medium scatters the path, if it does. What the medium emits is added to the path, and
    /// what it absorbs is taken from the throughput.
    ///
    /// - `hit`: next surface; `None` if there is none
    fn scatter<'s, P: PathState, R: Recorder + ?Sized>(
        &mut self,
        scene: &'s dyn Scene,
        path: &mut P,
        hit: Option<&Hit>,
        numbers: &mut SampleNumbers,
        recorder: &mut R,
    ) -> Option<MediumPoint<'s>>;

    /// A point on the way to the next surface at which media scatter light into the path, the weight of that light, and the space around
    /// the point. The point is sampled independently of [`Space::scatter`]: the direct light there, times the weight, is an unbiased estimate
    /// of all single scattering of direct light along the way.
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

    /// Whether the vertex is a point of a medium whose direct light [`Space::point_on_way`] has estimated, also where it chose no point. The
    /// vertex itself then samples no light.
    fn is_lit_on_way(&self) -> bool;

    /// Takes note of the surface at which the path has arrived.
    fn arrive(&mut self, scene: &dyn Scene, hit: &Hit, surface: &Surface);

    /// Takes note of the direction in which the path leaves its vertex.
    fn leave(&mut self, wi: Vec3);

    /// Share of the light that passes along a ray from the vertex of the path to the end of the ray, or an estimate of it; `None` if none
    /// does, for example because a surface is on the way.
    ///
    /// - `dimension`: dimension whose stream of random numbers the estimate may use
    fn transmittance(&self, scene: &dyn Scene, ray: &Ray, dimension: u32, numbers: &SampleNumbers) -> Option<Spectrum>;

    /// Share of the light that the media let pass along a ray up to its end, or an estimate of it, whatever surfaces are on the way.
    ///
    /// - `dimension`: dimension whose stream of random numbers the estimate may use
    fn media_transmittance(&self, scene: &dyn Scene, ray: &Ray, dimension: u32, numbers: &SampleNumbers) -> Spectrum;
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
    fn at_light(_: &dyn Scene, _: &EmittedRay) -> Vacuum {
        Vacuum
    }

    #[inline(always)]
    fn scatter<'s, P: PathState, R: Recorder + ?Sized>(
        &mut self,
        _: &'s dyn Scene,
        _: &mut P,
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
    fn is_lit_on_way(&self) -> bool {
        false
    }

    #[inline(always)]
    fn arrive(&mut self, _: &dyn Scene, _: &Hit, _: &Surface) {}

    #[inline(always)]
    fn leave(&mut self, _: Vec3) {}

    #[inline(always)]
    fn transmittance(&self, scene: &dyn Scene, ray: &Ray, _: u32, _: &SampleNumbers) -> Option<Spectrum> {
        scene.transmittance(ray)
    }

    #[inline(always)]
    fn media_transmittance(&self, _: &dyn Scene, _: &Ray, _: u32, _: &SampleNumbers) -> Spectrum {
        Spectrum::ONE
    }
}

/// Space with media.
#[derive(Clone, Debug)]
pub struct Filled {
    /// Bodies around the path.
    inside: Inside,
    /// Boundaries of media at the vertex of the path: surfaces of closed shapes with a medium inside. The direction in which the path leaves
    /// decides which of them it crosses.
    at: Boundaries,
    /// Whether the direct light on the way to the next surface is estimated by a point on that way.
    is_lit_on_way: bool,
}

impl Filled {
    /// The space at a point.
    ///
    /// - `inside`: bodies around the point
    pub fn new(inside: Inside) -> Filled {
        Filled { inside, at: Boundaries::new(), is_lit_on_way: false }
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

    fn at_light(scene: &dyn Scene, emitted: &EmittedRay) -> Filled {
        // Distant lights begin outside of everything.
        Filled::new(if emitted.is_distant() { Inside::default() } else { scene.bodies_around(emitted.ray.origin) })
    }

    fn scatter<'s, P: PathState, R: Recorder + ?Sized>(
        &mut self,
        scene: &'s dyn Scene,
        path: &mut P,
        hit: Option<&Hit>,
        numbers: &mut SampleNumbers,
        recorder: &mut R,
    ) -> Option<MediumPoint<'s>> {
        let media = scene.media()?;
        let (ray, depth) = (path.ray(), path.depth());
        let mut travel = Travel { path, recorder, media, flight: None, tentative: None, numbers };
        let visit = |stretch: &Stretch<'s>| {
            let Some((id, medium)) = stretch.medium else { return ControlFlow::Continue(()) };
            let scattered = match medium.density() {
                Some(density) => travel.through_density(medium, density, stretch),
                None => travel.through(medium, stretch),
            };
            scattered.map_break(|length| (id, medium, length))
        };
        let t_max = hit.map_or(f32::INFINITY, |hit| hit.t);
        let ControlFlow::Break((id, medium, length)) = stretches(scene, media, &mut self.inside, &ray, t_max, visit) else { return None };
        self.at = Boundaries::new();
        path.leave_surfaces();
        let beta = *path.beta();
        let shift = (ray.origin - ray.from).dot(ray.direction);
        let point = MediumPoint { p: ray.at((length - shift).max(0.0)), phase: &medium.phase };
        recorder.record(|| Event::medium(depth, length, id, &point, -ray.direction, beta));
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
        self.is_lit_on_way = way.follow(scene, media, &self.inside, &path.ray, hit);
        if !self.is_lit_on_way {
            return None;
        }
        let (point, weight, inside) = way.sample(scene, media, path, numbers)?;
        Some((point, weight, Filled::new(inside)))
    }

    fn is_lit_on_way(&self) -> bool {
        self.is_lit_on_way
    }

    fn arrive(&mut self, scene: &dyn Scene, hit: &Hit, surface: &Surface) {
        self.at = scene.boundaries(hit, &surface.point);
        self.is_lit_on_way = false;
    }

    fn leave(&mut self, wi: Vec3) {
        self.inside = self.beyond(wi);
        self.is_lit_on_way = false;
    }

    fn transmittance(&self, scene: &dyn Scene, ray: &Ray, dimension: u32, numbers: &SampleNumbers) -> Option<Spectrum> {
        let unoccluded = scene.transmittance(ray)?;
        let passed = self.media_transmittance(scene, ray, dimension, numbers);
        (!passed.is_black()).then_some(unoccluded * passed)
    }

    fn media_transmittance(&self, scene: &dyn Scene, ray: &Ray, dimension: u32, numbers: &SampleNumbers) -> Spectrum {
        let Some(media) = scene.media() else { return Spectrum::ONE };
        let (mut depth, mut passed, mut stream) = (Spectrum::BLACK, Spectrum::ONE, None);
        let add = |stretch: &Stretch| {
            match stretch.medium.map(|(_, medium)| (medium, medium.density())) {
                None => {}
                Some((medium, None)) => depth += medium.depth(stretch.length),
                Some((medium, Some(density))) => {
                    let stream = stream.get_or_insert_with(|| numbers.stream(dimension));
                    passed *= tracking::ratio(medium, density, ray, stretch, stream);
                }
            }
            if passed.is_black() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let _ = stretches(scene, media, &mut self.beyond(ray.direction), ray, ray.t_max, add);
        passed * transmittance(depth)
    }
}

/// A path on its way to the next surface.
struct Travel<'t, 'n, P, R: ?Sized> {
    path: &'t mut P,
    recorder: &'t mut R,
    media: &'t Media,
    /// How far the path goes; from the first medium that scatters on.
    flight: Option<Flight>,
    /// Numbers for tentative collisions; from the first medium with a density on.
    tentative: Option<Stream>,
    numbers: &'t mut SampleNumbers<'n>,
}

impl<P: PathState, R: Recorder + ?Sized> Travel<'_, '_, P, R> {
    /// Dimension of the way.
    fn dimension(&self) -> u32 {
        dimension::vertex(self.path.depth(), Use::Medium)
    }

    fn flight(&mut self) -> &mut Flight {
        let (dimension, beta) = (self.dimension(), *self.path.beta());
        self.flight.get_or_insert_with(|| Flight::new(self.media, beta, self.numbers.get_1d(dimension)))
    }

    /// Goes through a medium whose density is 1. If the path is scattered, breaks with the distance from the start of the whole way (m).
    fn through(&mut self, medium: &Medium, stretch: &Stretch) -> ControlFlow<f32> {
        let length = stretch.length;
        if medium.emits() {
            self.path.add_emission(medium.emitted(length), self.recorder);
        }
        if !medium.scatters() {
            *self.path.beta() *= transmittance(medium.depth(length));
            return ControlFlow::Continue(());
        }
        let flight = self.flight();
        let extinction = medium.extinction().coefficients()[flight.channel];
        let reach = if extinction > 0.0 { flight.left / extinction } else { f32::INFINITY };
        let is_scattered = reach < length;
        let weight = if is_scattered { flight.scattered(medium, reach) } else { flight.pass(medium, length) };
        *self.path.beta() *= weight;
        if is_scattered { ControlFlow::Break(stretch.start + reach) } else { ControlFlow::Continue(()) }
    }

    /// Goes through a medium whose density varies. If the path is scattered, breaks with the distance from the start of the whole way (m).
    fn through_density(&mut self, medium: &Medium, density: &Density, stretch: &Stretch) -> ControlFlow<f32> {
        let mut stream = self.tentative.take().unwrap_or_else(|| self.numbers.stream(self.dimension()));
        let ray = self.path.ray();
        let end = tracking::collisions(medium, density, &ray, stretch, &mut stream, |Collision { length, place, real }, numbers| {
            if medium.emits() {
                self.path.add_emission(medium.emission_at(place) * real, self.recorder);
            }
            if !medium.scatters() {
                *self.path.beta() *= Spectrum::ONE - real;
                return if self.path.beta().is_black() { ControlFlow::Break(None) } else { ControlFlow::Continue(()) };
            }
            let flight = self.flight();
            let is_scattered = numbers.next_1d() < real.coefficients()[flight.channel];
            let weight = if is_scattered { flight.collided(medium, medium.albedo_at(place), real) } else { flight.missed(medium, real) };
            *self.path.beta() *= weight;
            if is_scattered { ControlFlow::Break(Some(length)) } else { ControlFlow::Continue(()) }
        });
        self.tentative = Some(stream);
        match end {
            ControlFlow::Break(Some(length)) => ControlFlow::Break(length),
            ControlFlow::Break(None) | ControlFlow::Continue(()) => ControlFlow::Continue(()),
        }
    }
}
