//! Builds the lights without a surface.

use std::sync::Arc;

use glam::DVec3;

use super::{Builder, rgb, transform};
use crate::describe;
use crate::error::Error;
use crate::format::Radiometric;
use crate::light::{Directional, Falloff, Light, Placed, Point, ProfiledPoint, Projector, Spot, Sun};
use crate::math::{Transform, float};

impl Builder<'_> {
    pub(super) fn lights(&mut self) {
        for (i, described) in self.scene.lights.iter().enumerate() {
            let pointer = format!("/lights/{i}");
            let made = match described {
                describe::Light::Point(l) => self.point(&pointer, l),
                describe::Light::Directional(l) => Some(directional(l)),
                describe::Light::Spot(l) => self.spot(&pointer, l),
            };
            let Some(made) = made.and_then(|light| self.placed(&pointer, light, described.transform())) else { continue };
            let name = described.name().map_or(pointer, |name| format!("{name:?}"));
            self.needs.push((name, made.effects()));
            self.world.light(made);
        }
    }

    /// A light with its transform; nothing after adding a fault.
    fn placed(&mut self, pointer: &str, light: Light, steps: &describe::Transform) -> Option<Light> {
        if steps.is_identity() {
            return Some(light);
        }
        let pointer = format!("{pointer}/transform");
        match transform::animated(steps, &Transform::IDENTITY, &self.scene.shutter) {
            Ok(to_world) => match Placed::new(light, to_world) {
                Some(placed) => return Some(Light::Placed(Box::new(placed))),
                None => self.fault(&pointer, "a light is placed by translations and rotations only: leave out scales and mirrors"),
            },
            Err(message) => self.fault(&pointer, &message),
        }
        None
    }

    /// A point light; nothing after adding a fault.
    fn point(&mut self, pointer: &str, l: &describe::PointLight) -> Option<Light> {
        let (position, intensity) = (l.position.0.into(), rgb(&l.intensity));
        let Some(file) = &l.profile else { return Some(Light::Point(Point { position, intensity })) };
        let profile = match self.source.files.profile(file) {
            Ok((profile, warnings, hash)) => {
                self.warnings.extend(warnings);
                self.contents.insert(file.clone(), hash);
                Arc::new(profile)
            }
            Err(Error::Invalid(faults)) => {
                for fault in faults {
                    self.fault(&format!("{pointer}/profile"), &format!("{file}: {}", fault.message));
                }
                return None;
            }
            Err(other) => {
                self.failures.push(other);
                return None;
            }
        };
        let [axis, across] = l.axes();
        let x = (across - axis * axis.dot(across)).normalize();
        let axes = [x, axis.cross(x), axis].map(|v| v.as_vec3());
        Some(Light::Profiled(ProfiledPoint { position, axes, intensity, profile }))
    }

    /// A spotlight; nothing after adding a fault.
    fn spot(&mut self, pointer: &str, l: &describe::SpotLight) -> Option<Light> {
        let axis = l.axis().unwrap_or(DVec3::NEG_Z).as_vec3();
        let cos = |angle: describe::ConeAngle| float::sin_cos_degrees(angle.get()).1;
        let falloff = match l.falloff {
            describe::Falloff::Smooth => Falloff::Smooth,
            describe::Falloff::Linear => Falloff::Linear,
            describe::Falloff::Squared => Falloff::Squared,
        };
        let spot = Spot {
            position: DVec3::from(l.position.0),
            axis,
            intensity: rgb(&l.intensity),
            cos_inner: cos(l.inner_angle),
            cos_outer: cos(l.outer_angle),
            falloff,
        };
        let Some(file) = &l.image else { return Some(Light::Spot(spot)) };
        let pixels = self.picture(&format!("{pointer}/image"), file, l.encoding, None)?;
        let most = f64::from(pixels.most()) * f64::from(spot.intensity.max());
        if Radiometric::new(most).is_none() {
            self.fault(
                &format!("{pointer}/image"),
                &format!("{file}: an intensity of {most:.1e} W/sr with its picture, expected at most 1e30"),
            );
            return None;
        }
        let (sin, cos) = float::sin_cos_degrees(l.image_angle.map_or(l.outer_angle.get(), |angle| angle.get()));
        Projector::new(spot, l.image_up().as_vec3(), (sin / cos) as f32, pixels).map(|projector| Light::Projector(Box::new(projector)))
    }
}

fn directional(l: &describe::DirectionalLight) -> Light {
    let direction = DVec3::from(l.direction.0).normalize().as_vec3();
    match l.angle.get() > 0.0 {
        true => Light::Sun(Sun::of_irradiance(direction, l.irradiance.linear(), l.angle.get() / 2.0)),
        false => Light::Directional(Directional { direction, irradiance: rgb(&l.irradiance) }),
    }
}
