//! What light transport asks of the world.

use glam::{DVec3, Vec2, Vec3};

use crate::bsdf::{Bsdf, BsdfSample, TransportMode};
use crate::camera::Camera;
use crate::effects::Effects;
use crate::light::{Emission, Lights, Target};
use crate::math::{Frame, Local, Ray, SolidAnglePdf, Spectrum};
use crate::primitive::Hit;
use crate::shape::SurfacePoint;

/// A scene, as integrators see it.
pub trait Scene: Send + Sync {
    /// The nearest hit with 0 < t < `ray.t_max`.
    fn intersect(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything is hit with 0 < t < `ray.t_max`.
    fn occluded(&self, ray: &Ray) -> bool;

    /// All about the point that `ray` hit.
    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_>;

    fn lights(&self) -> &Lights;

    fn camera(&self) -> &Camera;

    /// What a picture of this scene calls for.
    fn effects(&self) -> Effects;

    /// What was subtracted from the user's coordinates, so that f32 is finest where the scene is (m).
    fn origin(&self) -> DVec3;
}

/// A point on a surface and what happens to light there.
///
/// Directions are in world space here and point away from the surface; the BSDF sees them in the
/// frame of the shading normal. Where shading and geometric normal disagree on the side of a
/// direction nothing is scattered: light does not leak through. Above a coarse mesh that stands for a smooth
/// surface, [`Surface::lift`], the shading normal decides alone, and the ray itself finds what is in its way.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    pub point: SurfacePoint,
    pub frame: Frame,
    pub bsdf: Bsdf<'a>,
    pub emission: Option<Emission>,
    /// Its index among the lights; of meaning where it emits.
    pub light: u32,
    /// The point that light shines upon, and leaves outwards: `point.p`, or above it by [`Surface::lift`].
    pub lit: Vec3,
}

impl<'a> Surface<'a> {
    pub fn new(point: SurfacePoint, bsdf: Bsdf<'a>, emission: Option<(Emission, u32)>) -> Surface<'a> {
        let (emission, light) = (emission.map(|e| e.0), emission.map_or(u32::MAX, |e| e.1));
        Surface { frame: Frame::around(point.ns), lit: point.p, point, bsdf, emission, light }
    }

    /// As `ray` met it, where it stands for a smooth surface `lift` above it (m): [`Shape::lift`](crate::shape::Shape::lift).
    ///
    /// What leaves outwards starts up there, and the shading normal alone says what does: a facet that faces away
    /// from a light that the smooth surface sees is lit if the ray really passes all facets. Nothing changes where
    /// `ray` comes from below, by either normal; nor for a lift within the error bound of the point, mere rounding.
    pub fn lift(&mut self, lift: f32, ray: &Ray) {
        let from_above = self.point.ng.dot(ray.direction) < 0.0 && self.point.ns.dot(ray.direction) < 0.0;
        if from_above && lift > self.point.offset {
            self.lit = self.point.p + self.point.ng * lift;
        }
    }

    /// Gives it another shading normal, and lays the x axis of its frame along a tangent, where there is one.
    pub fn turn(&mut self, ns: Vec3, tangent: Option<Vec3>) {
        self.frame = tangent.and_then(|x| Frame::along(ns, x)).unwrap_or_else(|| Frame::around(ns));
        self.point.ns = ns;
    }

    /// Radiance that the surface itself sends into `w`.
    pub fn emitted(&self, w: Vec3) -> Spectrum {
        self.emission.map_or(Spectrum::BLACK, |e| e.towards(self.point.ng, w))
    }

    /// f(wo, wi)·|cos θi| [sr⁻¹]; 0 for delta lobes.
    // (Else the rare callers take it out of line for the frequent one, [`crate::integrator::sample_light`].)
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        let (lo, li) = (self.frame.to_local(wo), self.frame.to_local(wi));
        if !self.agrees(wo, lo, wi, li) {
            return Spectrum::BLACK;
        }
        let f = self.bsdf.eval(lo, li, mode);
        match mode {
            TransportMode::Radiance => f,
            TransportMode::Importance => f * self.adjoint(wo, lo, wi, li),
        }
    }

    /// |cos θo| |ng·wi| / (|ng·wo| |cos θi|): importance meets the surface by its geometric normal.
    ///
    /// A shading normal makes the cosines of f·|cos θi| those of another surface. For radiance that is the look that is wanted;
    /// what lights send must then be scaled so that both find the same picture.
    ///
    /// Source: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), §5.3. Tests: importance_is_adjoint.
    #[inline(never)]
    fn adjoint(&self, wo: Vec3, lo: Local, wi: Vec3, li: Local) -> f32 {
        let ng = self.point.ng;
        let ratio = (lo.abs_cos() / li.abs_cos()) * (ng.dot(wi) / ng.dot(wo)).abs();
        if ratio.is_finite() { ratio } else { 0.0 }
    }

    /// The density with which [`Surface::sample`] returns `wi`.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> SolidAnglePdf {
        self.bsdf.pdf(self.frame.to_local(wo), self.frame.to_local(wi))
    }

    /// A direction drawn from the BSDF, and the same in world space.
    #[inline]
    pub fn sample(&self, wo: Vec3, choice: f32, u: Vec2, mode: TransportMode) -> Option<(Vec3, BsdfSample)> {
        let lo = self.frame.to_local(wo);
        let sample = self.bsdf.sample(lo, choice, u, mode)?;
        self.in_world(wo, lo, sample, mode)
    }

    /// The delta lobes, and their directions in world space.
    pub fn delta_lobes(&self, wo: Vec3, mode: TransportMode) -> impl Iterator<Item = (Vec3, BsdfSample)> {
        let lo = self.frame.to_local(wo);
        self.bsdf.delta_lobes(lo, mode).filter_map(move |sample| self.in_world(wo, lo, sample, mode))
    }

    #[inline]
    fn in_world(&self, wo: Vec3, lo: Local, sample: BsdfSample, mode: TransportMode) -> Option<(Vec3, BsdfSample)> {
        // A path must not lengthen its directions bounce by bounce. This near to 1, a step of Newton's for 1/√x
        // is as good as a root and a division, and does not make the next ray wait for them.
        let w = self.frame.to_world(sample.wi);
        let wi = w * (1.5 - 0.5 * w.length_squared());
        if !self.agrees(wo, lo, wi, sample.wi) {
            return None;
        }
        match mode {
            TransportMode::Radiance => Some((wi, sample)),
            TransportMode::Importance => Some((wi, BsdfSample { weight: sample.weight * self.adjoint(wo, lo, wi, sample.wi), ..sample })),
        }
    }

    /// Whether the geometric normal sees reflection and transmission as the shading normal does.
    fn agrees(&self, wo: Vec3, lo: Local, wi: Vec3, li: Local) -> bool {
        let (out, on) = (self.point.ng.dot(wo), self.point.ng.dot(wi));
        let same_side = out * on > 0.0 || (out > 0.0 && self.rises(wi));
        same_side == lo.same_side(li)
    }

    /// Whether `w` leaves the smooth surface above, if there is one, outwards.
    fn rises(&self, w: Vec3) -> bool {
        self.lit != self.point.p && self.point.ns.dot(w) > 0.0
    }

    /// The point that a ray into `w` leaves, and where it starts: off the surface, on the side that `w` leads to.
    fn start(&self, w: Vec3) -> [Vec3; 2] {
        let off = self.point.ng * self.point.offset;
        if self.point.ng.dot(w) < 0.0 && !self.rises(w) { [self.point.p, self.point.p - off] } else { [self.lit, self.lit + off] }
    }

    /// The ray that leaves into `wi`, starting beside the surface.
    pub fn spawn(&self, wi: Vec3, time: f32) -> Ray {
        let [from, origin] = self.start(wi);
        Ray { origin, from, direction: wi, t_max: f32::INFINITY, time }
    }

    /// The ray whose occlusion is the shadow of `target`, in the direction `wi`.
    pub fn shadow_ray(&self, wi: Vec3, target: &Target, time: f32) -> Ray {
        let [from, origin] = self.start(wi);
        let end = match target {
            Target::Infinity => return self.spawn(wi, time),
            Target::Free(end) => *end,
            // Over its length the ray strays by the rounding of its direction: end that much farther off the
            // light, whose own offset knows only how large its own coordinates are.
            Target::Surface(point) => {
                // (The sum of its coordinates bounds the length.)
                let stray = SHORTEN * (point.p - origin).abs().element_sum();
                beside(&SurfacePoint { offset: point.offset + stray, ..*point }, -wi)
            }
        };
        let line = end - origin;
        let distance = line.length();
        // t of a hit is rounded a few times: stop that much short of the end.
        let t_max = distance * (1.0 - SHORTEN);
        Ray { origin, from, direction: line / distance, t_max, time }
    }
}

/// Four roundings of a direction's coordinates, or of a distance, as a share of the length.
const SHORTEN: f32 = 4.0 * f32::EPSILON;

/// The point moved off its surface, towards the side that `w` leads to.
pub(crate) fn beside(point: &SurfacePoint, w: Vec3) -> Vec3 {
    let side = if point.ng.dot(w) < 0.0 { -point.offset } else { point.offset };
    point.p + point.ng * side
}
