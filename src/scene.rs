//! Interface between integrators and the scene.

mod interaction;

use std::any::Any;

use glam::{DVec3, Vec2, Vec3};

use crate::bsdf::{Bsdf, BsdfSample, TransportMode};
use crate::camera::Camera;
use crate::effects::Effects;
use crate::light::{Emission, LightSampleContext, Lights, ShadowTarget};
use crate::math::{Frame, Local, Ray, RayDifferential, SolidAnglePdf, Spectrum, SurfaceDifferential};
use crate::medium::{Boundaries, Inside, InterfaceCrossing, Media};
use crate::primitive::Hit;
use crate::shape::SurfacePoint;

pub use interaction::{Interaction, MediumPoint};

/// Scene as integrators see it.
pub trait Scene: Any + Send + Sync {
    /// Nearest hit with 0 < t < `ray.t_max`.
    fn intersect(&self, ray: &Ray) -> Option<Hit>;

    /// Whether there is a hit with 0 < t < `ray.t_max`.
    fn occluded(&self, ray: &Ray) -> bool;

    /// Surface at the point that `ray` hit.
    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_>;

    /// Surface at the point that `ray` hit, with its textures averaged over the footprint of the ray; and how point, normal and ray differ
    /// between the ray and those beside it, if that is known and the surface reflects or refracts into single directions.
    ///
    /// - `differential`: differential between the ray and those beside it
    fn surface_with_footprint(&self, ray: &Ray, hit: &Hit, differential: &RayDifferential) -> (Surface<'_>, Option<SurfaceDifferential>);

    /// Surface at the point that `ray` hit, as a path from the camera finds it that arrives from the direction `wo`.
    ///
    /// Shading normals that face away from the viewer are bent towards it, so that a surface depends on the direction it is seen from.
    /// Paths from the lights need this to scatter light as paths from the camera do. Absorption is that along `ray`.
    fn surface_seen_from(&self, ray: &Ray, hit: &Hit, wo: Vec3) -> Surface<'_>;

    /// Lights of the scene.
    fn lights(&self) -> &Lights;

    /// Camera of the scene.
    fn camera(&self) -> &Camera;

    /// Media of the scene; `None` for a scene whose space is empty.
    fn media(&self) -> Option<&Media>;

    /// Surfaces of bodies with media at the point of a hit.
    fn boundaries(&self, hit: &Hit, point: &SurfacePoint) -> Boundaries;

    /// Bodies with media around a point that is on none of their surfaces.
    fn bodies_around(&self, p: Vec3) -> Inside;

    /// First boundary of a medium without a surface on a ray, before its end. Such boundaries are no hits: only media ask for them.
    fn interface(&self, ray: &Ray) -> Option<InterfaceCrossing>;

    /// Effects that a picture of the scene requires.
    fn effects(&self) -> Effects;

    /// Origin that was subtracted from the user's coordinates, chosen so that f32 is most precise where the scene has detail (m).
    fn origin(&self) -> DVec3;
}

impl dyn Scene + '_ {
    /// Share of the light that passes from one end of a ray in empty space to the other: all of it, or `None`.
    #[inline(always)]
    pub fn transmittance(&self, ray: &Ray) -> Option<Spectrum> {
        (!self.occluded(ray)).then_some(Spectrum::ONE)
    }
}

/// Point on a surface with its BSDF and emission.
///
/// Directions are in world space and point away from the surface; the BSDF uses the frame of the shading normal. If the shading
/// normal and the geometric normal disagree on the side of a direction, nothing is scattered, so that light does not leak through.
/// The exception is the outside of a coarse mesh that represents a smooth surface, see [`Surface::set_shadow_origin`]: there the
/// shading normal alone decides, and the ray itself is tested against all facets.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Position, normals and texture coordinates.
    pub point: SurfacePoint,
    /// Frame of the shading normal.
    pub frame: Frame,
    /// Scattering model.
    pub bsdf: Bsdf<'a>,
    /// Whether light may pass through the surface. Where it does not, no light behind the surface is sampled.
    pub transmits: bool,
    /// Whether the scattering model depends on the wavelength. A path then gives it its own: see
    /// [`PathWavelength`](crate::integrator::PathWavelength).
    pub is_dispersive: bool,
    /// Emission of the surface.
    pub emission: Option<Emission>,
    /// Index of the surface among the lights; valid only if `emission` is set.
    pub light: u32,
    /// Origin of rays that leave to the outside: `point.p`, or a point above it set by [`Surface::set_shadow_origin`].
    pub shadow_origin: Vec3,
}

impl<'a> Surface<'a> {
    /// A surface with the frame of the point's shading normal, through which light may pass.
    ///
    /// - `emission`: emission and index of the light
    pub fn new(point: SurfacePoint, bsdf: Bsdf<'a>, emission: Option<(Emission, u32)>) -> Surface<'a> {
        let (emission, light) = (emission.map(|e| e.0), emission.map_or(u32::MAX, |e| e.1));
        let (frame, shadow_origin) = (Frame::around(point.ns), point.p);
        Surface { frame, shadow_origin, point, bsdf, transmits: true, is_dispersive: false, emission, light }
    }

    /// Moves the origin of rays to the outside up to the smooth surface that a coarse mesh represents, `offset` above the point (m):
    /// see [`Shape::shadow_terminator_offset`](crate::shape::Shape::shadow_terminator_offset).
    ///
    /// The shading normal alone then decides about scattering to the outside: a facet that faces away from a light which the smooth
    /// surface sees is lit if the shadow ray passes all facets. Nothing changes if `ray` comes from below, by either normal, or if the
    /// offset is within the error bound of the point and so is mere rounding.
    pub fn set_shadow_origin(&mut self, offset: f32, ray: &Ray) {
        let from_above = self.point.ng.dot(ray.direction) < 0.0 && self.point.ns.dot(ray.direction) < 0.0;
        if from_above && offset > self.point.offset {
            self.shadow_origin = self.point.p + self.point.ng * offset;
        }
    }

    /// Sets the shading normal, and aligns the x axis of the frame with the tangent if there is one.
    pub fn set_shading_frame(&mut self, ns: Vec3, tangent: Option<Vec3>) {
        self.frame = tangent.and_then(|x| Frame::along(ns, x)).unwrap_or_else(|| Frame::around(ns));
        self.point.ns = ns;
    }

    /// The point as lights are sampled for it.
    ///
    /// - `wo`: direction to the viewer
    #[inline]
    pub fn light_context(&self, wo: Vec3, time: f32) -> LightSampleContext {
        let SurfacePoint { ng, ns, .. } = self.point;
        let ns = if ns.dot(wo) < 0.0 { -ns } else { ns };
        LightSampleContext { p: self.shadow_origin, ng, ns, transmits: self.transmits, time }
    }

    /// Radiance that the surface emits in the direction `w`.
    pub fn emitted(&self, w: Vec3) -> Spectrum {
        self.emission.map_or(Spectrum::BLACK, |e| e.towards(self.point.ng, w))
    }

    /// f(wo, wi)·|cos θi| [sr⁻¹]; 0 for delta lobes.
    // Always inlined: otherwise the compiler would keep it out of line in the hot caller, `integrator::sample_light`, too.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        let (lo, li) = (self.frame.to_local(wo), self.frame.to_local(wi));
        if !self.normals_agree(wo, lo, wi, li) {
            return Spectrum::BLACK;
        }
        let f = self.bsdf.eval(lo, li, mode);
        match mode {
            TransportMode::Radiance => f,
            TransportMode::Importance => f * self.adjoint(wo, lo, wi, li),
        }
    }

    /// Correction |cos θo| |ng·wi| / (|ng·wo| |cos θi|) for the transport of importance with a shading normal.
    ///
    /// A shading normal changes the cosines in f·|cos θi|. For radiance this is the intended look. Light that is traced from lights
    /// must be scaled by this factor so that it gives the same picture.
    ///
    /// Source: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), §5.3. Tests: importance_is_adjoint.
    #[inline(never)]
    fn adjoint(&self, wo: Vec3, lo: Local, wi: Vec3, li: Local) -> f32 {
        let ng = self.point.ng;
        let ratio = (lo.abs_cos() / li.abs_cos()) * (ng.dot(wi) / ng.dot(wo)).abs();
        if ratio.is_finite() { ratio } else { 0.0 }
    }

    /// Whether the geometric normal and the shading normal agree on reflection or transmission from `wo` to `wi`. If not, nothing is
    /// scattered, and [`Surface::sample`] does not return `wi`.
    pub fn scatters_between(&self, wo: Vec3, wi: Vec3) -> bool {
        self.normals_agree(wo, self.frame.to_local(wo), wi, self.frame.to_local(wi))
    }

    /// Density with which [`Surface::sample`] returns `wi`, if it does.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> SolidAnglePdf {
        self.bsdf.pdf(self.frame.to_local(wo), self.frame.to_local(wi))
    }

    /// Samples the BSDF; returns the direction in world space and the sample.
    // Always inlined: each walk calls it once for each vertex.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, choice: f32, u: Vec2, mode: TransportMode) -> Option<(Vec3, BsdfSample)> {
        let lo = self.frame.to_local(wo);
        let sample = self.bsdf.sample(lo, choice, u, mode)?;
        self.in_world(wo, lo, sample, mode)
    }

    /// Delta lobes with their directions in world space.
    pub fn delta_lobes(&self, wo: Vec3, mode: TransportMode) -> impl Iterator<Item = (Vec3, BsdfSample)> {
        let lo = self.frame.to_local(wo);
        self.bsdf.delta_lobes(lo, mode).filter_map(move |sample| self.in_world(wo, lo, sample, mode))
    }

    /// Direction of a sample in world space, and the sample; `None` if the normals disagree on its side.
    #[inline]
    fn in_world(&self, wo: Vec3, lo: Local, sample: BsdfSample, mode: TransportMode) -> Option<(Vec3, BsdfSample)> {
        // Directions must not become longer from bounce to bounce. For lengths this close to 1, one Newton step for 1/√x is as precise
        // as a root and a division, and has less latency.
        let w = self.frame.to_world(sample.wi);
        let wi = w * (1.5 - 0.5 * w.length_squared());
        if !self.normals_agree(wo, lo, wi, sample.wi) {
            return None;
        }
        match mode {
            TransportMode::Radiance => Some((wi, sample)),
            TransportMode::Importance => Some((wi, BsdfSample { weight: sample.weight * self.adjoint(wo, lo, wi, sample.wi), ..sample })),
        }
    }

    /// Whether the geometric normal agrees with the shading normal on reflection or transmission.
    fn normals_agree(&self, wo: Vec3, lo: Local, wi: Vec3, li: Local) -> bool {
        let (out, on) = (self.point.ng.dot(wo), self.point.ng.dot(wi));
        let same_side = out * on > 0.0 || (out > 0.0 && self.is_above_smooth_surface(wi));
        same_side == lo.same_side(li)
    }

    /// Whether there is a smooth surface above the point and `w` leaves it to the outside.
    fn is_above_smooth_surface(&self, w: Vec3) -> bool {
        self.shadow_origin != self.point.p && self.point.ns.dot(w) > 0.0
    }

    /// Surface point that a ray in the direction `w` leaves, and the origin of the ray: off the surface on the side of `w`.
    fn ray_start(&self, w: Vec3) -> [Vec3; 2] {
        let off = self.point.ng * self.point.offset;
        if self.point.ng.dot(w) < 0.0 && !self.is_above_smooth_surface(w) {
            [self.point.p, self.point.p - off]
        } else {
            [self.shadow_origin, self.shadow_origin + off]
        }
    }

    /// Ray in the direction `wi`, starting off the surface.
    pub fn spawn(&self, wi: Vec3, time: f32) -> Ray {
        let [from, origin] = self.ray_start(wi);
        Ray { origin, from, direction: wi, t_max: f32::INFINITY, time }
    }

    /// Shadow ray to `target` in the direction `wi`.
    // Always inlined: otherwise the compiler would keep it out of line in `integrator::sample_light`, too.
    #[inline(always)]
    pub fn shadow_ray(&self, wi: Vec3, target: &ShadowTarget, time: f32) -> Ray {
        interaction::shadow_ray(self.ray_start(wi), wi, target, time)
    }
}

/// Four roundings of the coordinates of a direction or of a distance, relative to the length.
pub(crate) const ROUNDING: f32 = 4.0 * f32::EPSILON;
