//! Builds the lights without a surface.

use glam::DVec3;

use super::{Builder, rgb};
use crate::describe;
use crate::light::{Directional, Falloff, Light, Point, Spot, Sun};
use crate::math::float;

impl Builder<'_> {
    pub(super) fn lights(&mut self) {
        for (i, described) in self.scene.lights.iter().enumerate() {
            let (made, name) = light_of(described);
            let name = name.map_or_else(|| format!("/lights/{i}"), |name| format!("{name:?}"));
            self.needs.push((name, made.effects()));
            self.world.light(made);
        }
    }
}

fn light_of(described: &describe::Light) -> (Light, Option<&String>) {
    match described {
        describe::Light::Point(l) => (Light::Point(Point { position: l.position.0.into(), intensity: rgb(&l.intensity) }), l.name.as_ref()),
        describe::Light::Directional(l) => {
            let direction = DVec3::from(l.direction.0).normalize().as_vec3();
            let light = match l.angle.get() > 0.0 {
                true => Light::Sun(Sun::of_irradiance(direction, l.irradiance.linear(), l.angle.get() / 2.0)),
                false => Light::Directional(Directional { direction, irradiance: rgb(&l.irradiance) }),
            };
            (light, l.name.as_ref())
        }
        describe::Light::Spot(l) => {
            let position = DVec3::from(l.position.0);
            let towards = l.to.map(|to| DVec3::from(to.0) - position);
            let axis = l.direction.map(|d| DVec3::from(d.0)).or(towards).unwrap_or(DVec3::NEG_Z);
            let cos = |angle: describe::ConeAngle| float::sin_cos_degrees(angle.get()).1;
            let falloff = match l.falloff {
                describe::Falloff::Smooth => Falloff::Smooth,
                describe::Falloff::Linear => Falloff::Linear,
                describe::Falloff::Squared => Falloff::Squared,
            };
            let spot = Spot {
                position,
                axis: axis.normalize().as_vec3(),
                intensity: rgb(&l.intensity),
                cos_inner: cos(l.inner_angle),
                cos_outer: cos(l.outer_angle),
                falloff,
            };
            (Light::Spot(spot), l.name.as_ref())
        }
    }
}
