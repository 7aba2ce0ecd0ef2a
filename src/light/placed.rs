//! Lights without a surface in spaces of their own, which may move.

use glam::{DVec3, Vec2, Vec3};

use super::bounds::LightBounds;
use super::emitted_ray::EmissionContext;
use super::{EmittedRay, Light, LightLiSample, LightSampleContext, ShadowTarget};
use crate::effects::Effects;
use crate::math::{Aabb, AnimatedTransform, Ray, Transform};
use crate::shape::Shape;

/// Light without a surface that is placed, and may be moved and turned, by a transform.
///
/// The light is sampled in its own space. The transform keeps all lengths, so that radiances, intensities and densities are the same there.
///
/// Tests: placed_lights_shine_as_others.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    light: Light,
    to_world: AnimatedTransform,
}

/// Greatest relative error of a length that a transform keeps.
const RIGID: f64 = 1e-9;

impl Placed {
    /// A light, placed; `None` if the light has a surface or a disk, or the transform changes lengths at the time of a keyframe, or half-way
    /// between two.
    ///
    /// The position of the light becomes part of the transform, which is in double precision. So the light is near the origin of its own space,
    /// wherever it is in the world.
    ///
    /// - `light`: light in its own space
    pub fn new(light: Light, to_world: AnimatedTransform) -> Option<Placed> {
        let position = match &light {
            Light::Point(light) => light.position,
            Light::Spot(light) => light.position,
            Light::Profiled(light) => light.position,
            Light::Projector(light) => light.spot.position,
            Light::Directional(_) => DVec3::ZERO,
            _ => return None,
        };
        let to_position = Transform::translate(position).ok()?;
        let is_rigid = |time: f32| {
            let m = to_world.at(time).matrix().matrix3;
            let off = m.transpose() * m - glam::DMat3::IDENTITY;
            off.to_cols_array().into_iter().all(|entry| entry.abs() <= RIGID) && !to_world.at(time).flips_handedness()
        };
        let times = to_world.keyframe_times();
        let halves = times.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let keeps_lengths = times.iter().copied().chain(halves).all(|time| is_rigid(time as f32));
        let to_world = AnimatedTransform::from(to_position).then(&to_world);
        keeps_lengths.then(|| Placed { light: light.recentred(position), to_world })
    }

    /// The light in its own space, at its origin.
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// A point of the light's own space in the world, at a time.
    pub(super) fn point(&self, p: Vec3, time: f32) -> Vec3 {
        self.to_world.at(time).point(p.as_dvec3()).as_vec3()
    }

    /// A unit vector of the world in the light's own space, at a time.
    pub(super) fn direction_to_local(&self, w: Vec3, time: f32) -> Vec3 {
        self.to_world.at(time).inverse_matrix().transform_vector3(w.as_dvec3()).normalize().as_vec3()
    }

    pub(super) fn sample(&self, shapes: &[Box<dyn Shape>], cx: &LightSampleContext, u: Vec2) -> Option<LightLiSample> {
        let to_world = self.to_world.at(cx.time);
        let p = to_world.inverse_matrix().transform_point3(cx.p.as_dvec3()).as_vec3();
        let sample = self.light.sample(shapes, &LightSampleContext { p, ..*cx }, u)?;
        let target = match sample.target {
            ShadowTarget::Point(p) => ShadowTarget::Point(to_world.point(p.as_dvec3()).as_vec3()),
            other => other,
        };
        Some(LightLiSample { wi: direction(&to_world, sample.wi), target, ..sample })
    }

    pub(super) fn emit(&self, shapes: &[Box<dyn Shape>], cx: &EmissionContext) -> Option<EmittedRay> {
        let to_world = self.to_world.at(cx.time);
        // Parallel light is everywhere: it is turned about the origin of the world, so that no distance is added and taken away again.
        let turn_only = matches!(self.light, Light::Directional(_));
        let center = match turn_only {
            true => to_world.inverse_matrix().transform_vector3(cx.bounds.0.as_dvec3()).as_vec3(),
            false => to_world.inverse_matrix().transform_point3(cx.bounds.0.as_dvec3()).as_vec3(),
        };
        let emitted = self.light.emit(shapes, &EmissionContext { bounds: (center, cx.bounds.1), ..*cx })?;
        let point = |p: Vec3| if turn_only { to_world.vector(p.as_dvec3()).as_vec3() } else { to_world.point(p.as_dvec3()).as_vec3() };
        let Ray { origin, from, direction: w, .. } = emitted.ray;
        let ray = Ray { origin: point(origin), from: point(from), direction: direction(&to_world, w), ..emitted.ray };
        Some(EmittedRay { ray, ..emitted })
    }

    /// Bounds for the choice of the light, which may shine in any direction.
    pub(super) fn bounds(&self, shapes: &[Box<dyn Shape>]) -> Option<LightBounds> {
        let LightBounds { space, intensity, .. } = self.light.bounds(shapes)?;
        let [min, max] = self.to_world.bounds([space.min.as_dvec3(), space.max.as_dvec3()]);
        let space = Aabb { min: min.as_vec3().map(f32::next_down), max: max.as_vec3().map(f32::next_up) };
        Some(LightBounds::all_directions(space, intensity))
    }

    /// The light in coordinates shifted by −`origin`.
    pub(super) fn recentred(self, origin: DVec3) -> Placed {
        Placed { to_world: self.to_world.shifted(-origin), ..self }
    }

    /// Effects that simulating the light requires.
    pub(super) fn effects(&self) -> Effects {
        self.light.effects() | if self.to_world.is_moving() { Effects::MOTION } else { Effects::NONE }
    }
}

/// A unit vector of the light's own space in the world.
fn direction(to_world: &Transform, w: Vec3) -> Vec3 {
    to_world.vector(w.as_dvec3()).normalize().as_vec3()
}
