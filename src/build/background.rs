//! Builds the light from infinite distance, all around.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::{Builder, rgb, transform};
use crate::describe::{self, Background, Radiometric};
use crate::light::sky::{SUN_HALF_ANGLE, SunPosition};
use crate::light::{Environment, EnvironmentMap, Light, Mapping, Sky, Sun};
use crate::math::float::sin_cos_degrees;
use crate::math::{Rgb, Transform};
use crate::texture::image::Pixels;

impl Builder<'_> {
    pub(super) fn background(&mut self) {
        let Some(background) = &self.scene.background else { return };
        if let Some(radiance) = &background.radiance {
            self.infinite_light("background", Light::Environment(Environment { radiance: rgb(radiance) }));
        }
        if let Some(map) = background.image.as_ref().and_then(|file| self.environment_map(background, file)) {
            self.infinite_light("background", map);
        }
        if let Some(sky) = &background.sky {
            self.sky(background, sky);
        }
    }

    fn infinite_light(&mut self, name: &str, light: Light) {
        self.needs.push((name.into(), light.effects()));
        self.world.light(light);
    }

    /// Adds a sky as an environment map, and its sun.
    fn sky(&mut self, background: &Background, described: &describe::Sky) {
        let Some(to_world) = self.rotation(&background.transform) else { return };
        let Some(SunPosition { elevation, azimuth }) = self.sun_position(described) else { return };
        let sky =
            Sky { elevation, turbidity: described.turbidity.get(), ground: described.ground.linear(), altitude: described.altitude.get() };
        let light = sky.light();
        // The picture shows the sun in its middle, which is −z: azimuths turn it clockwise as seen from above.
        let (sin, cos) = sin_cos_degrees(azimuth);
        let turn = DMat3::from_cols(DVec3::new(cos, 0.0, sin), DVec3::Y, DVec3::new(-sin, 0.0, cos));
        let map = EnvironmentMap::new(Arc::new(light.pixels), Mapping::LatLong, rgb(&described.irradiance), (to_world * turn).as_mat3());
        self.infinite_light("background", Light::EnvironmentMap(Arc::new(map)));
        if described.sun {
            let irradiance: [f64; 3] = std::array::from_fn(|k| described.irradiance.linear()[k] * light.sun[k]);
            let (sin_up, cos_up) = sin_cos_degrees(sky.elevation);
            let towards = to_world * DVec3::new(cos_up * sin, sin_up, -cos_up * cos);
            self.infinite_light("sun", Light::Sun(Sun::of_irradiance(-towards.as_vec3(), irradiance, SUN_HALF_ANGLE)));
        }
    }

    /// Where the sun stands, as stated or by place and time; nothing after adding a fault about a night.
    fn sun_position(&mut self, described: &describe::Sky) -> Option<SunPosition> {
        let Some(describe::Place { latitude, longitude, time }) = &described.place else {
            let elevation = described.elevation.as_ref().map_or(ELEVATION, |elevation| elevation.get());
            return Some(SunPosition { elevation, azimuth: described.azimuth.as_ref().map_or(AZIMUTH, |azimuth| azimuth.get()) });
        };
        let sun = SunPosition::new(latitude.get(), longitude.get(), time.seconds());
        if sun.elevation < NIGHT {
            let below = -sun.elevation;
            self.fault("/background/sky/place", &format!("the sun is {below:.1}° below the horizon there: pt has no sky of the night"));
            return None;
        }
        Some(sun)
    }

    /// Builds the environment map of a picture; nothing after adding a fault.
    fn environment_map(&mut self, background: &Background, file: &str) -> Option<Light> {
        let pixels = self.picture("/background/image", file, background.encoding, None);
        let to_world = self.rotation(&background.transform);
        let (pixels, to_world) = (pixels?, to_world?);
        let mapping = match background.mapping {
            describe::Mapping::LatLong => Mapping::LatLong,
            describe::Mapping::Octahedral => Mapping::Octahedral,
        };
        if mapping == Mapping::Octahedral && pixels.size().x != pixels.size().y {
            let [width, height] = pixels.size().to_array();
            self.fault("/background/image", &format!("{file}: expected a square picture for an octahedral map, found {width} × {height}"));
            return None;
        }
        if pixels.values().as_flattened().len() > MOST_NUMBERS {
            let [width, height] = pixels.size().to_array();
            self.fault("/background/image", &format!("{file}: expected fewer than 7·10⁸ pixels, found {width} × {height}"));
            return None;
        }
        self.note_unusual_shape(file, mapping, &pixels);
        let scale = background.scale.as_ref().map_or(Rgb::WHITE, rgb);
        let most = f64::from(pixels.most()) * f64::from(scale.max());
        if Radiometric::new(most).is_none() {
            self.fault("/background/image", &format!("{file}: a radiance of {most:.1e} W/(m² sr) with its scale, expected at most 1e30"));
            return None;
        }
        Some(Light::EnvironmentMap(Arc::new(EnvironmentMap::new(pixels, mapping, scale, to_world.as_mat3()))))
    }

    /// Warns of a square picture by latitude and longitude, which probably is of the other mapping.
    fn note_unusual_shape(&mut self, file: &str, mapping: Mapping, pixels: &Pixels) {
        let [width, height] = pixels.size().to_array();
        if mapping == Mapping::LatLong && width == height && width > 1 {
            let message = format!("{file}: {width} × {height} pixels, though maps by latitude and longitude are twice as wide as high; ");
            self.warnings.push(message + "if it is pbrt's octahedral map, say \"mapping\": \"octahedral\"");
        }
    }

    /// The rotation that the steps of a transform make; nothing after adding a fault about steps that do more than turn and mirror.
    fn rotation(&mut self, steps: &describe::Transform) -> Option<DMat3> {
        match transform::placed(steps, &Transform::IDENTITY) {
            Ok(to_world) => {
                let matrix = to_world.matrix();
                let is_rotation = (matrix.matrix3.transpose() * matrix.matrix3).abs_diff_eq(DMat3::IDENTITY, NEARLY);
                if is_rotation && matrix.translation.length() <= NEARLY {
                    // The axes are made perpendicular and of unit length, which rounded numbers in a file are not.
                    let [x, y, z] = [matrix.matrix3.x_axis, matrix.matrix3.y_axis, matrix.matrix3.z_axis];
                    let x = x.normalize();
                    let y = (y - x * x.dot(y)).normalize();
                    return Some(DMat3::from_cols(x, y, (z - x * x.dot(z) - y * y.dot(z)).normalize()));
                }
                let message = "expected rotations only: light from infinite distance has no place and no size";
                self.fault("/background/transform", message);
            }
            Err(message) => self.fault("/background/transform", &message),
        }
        None
    }
}

/// Elevation and azimuth of the sun that is not stated (degrees): to the right of a camera that looks down −z, and a little behind it.
const ELEVATION: f64 = 40.0;
const AZIMUTH: f64 = 120.0;

/// Elevation of the sun below which the sky has no light from it (degrees).
const NIGHT: f64 = -18.0;

/// Greatest number of colour components of an environment map, three for each pixel: lookups side by side have indices of 31 bits.
const MOST_NUMBERS: usize = i32::MAX as usize;

/// Deviation from a rotation that numbers with seven digits in a scene file have.
const NEARLY: f64 = 1e-5;
