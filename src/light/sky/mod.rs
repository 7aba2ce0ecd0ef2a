//! The sky by day: sunlight scattered by air, computed from the physics of scattering.
//!
//! Light of a single scattering is integrated along each direction. Light of further scatterings is added by the approximation of
//! Hillaire (2020). Refraction by the air, clouds, the stars and polarization are left out.
//!
//! Tests: sunlight_is_dimmed_as_the_exact_integrals_say, single_scattering_is_that_of_the_exact_integrals,
//! multiple_scattering_keeps_the_energy.

mod atmosphere;
mod multiple;
mod path;
mod position;
mod sunlight;
mod table;

use std::f64::consts::PI;

use glam::UVec2;
use rayon::prelude::*;

use self::atmosphere::{Atmosphere, Color, GROUND, phases};
use self::multiple::Multiple;
use self::path::{Path, PathPoint, amounts_to_top};
pub use self::position::SunPosition;
use self::sunlight::Sunlight;
use crate::math::float::{acos_f64, sin_cos_degrees, sin_cos_f64};
use crate::texture::image::Pixels;

/// Half of the angle under which the sun is seen (degrees).
pub const SUN_HALF_ANGLE: f64 = 0.2665;

/// Sun and air of a sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Elevation of the sun above the horizon (degrees).
    pub elevation: f64,
    /// Ratio of the extinction by molecules and aerosols to that by molecules alone; 1 is air without aerosols.
    pub turbidity: f64,
    /// Albedo of the ground.
    pub ground: [f64; 3],
    /// Height of the observer above the ground (m).
    pub altitude: f64,
}

/// Light of a sky, for a sun whose irradiance at the upper end of the atmosphere is 1 on a plane that faces it.
pub struct SkyLight {
    /// Radiance without the sun's disk, by latitude and longitude with the zenith at the top and the sun in the middle column [sr⁻¹].
    pub pixels: Pixels,
    /// Irradiance from the sun's disk on a plane that faces it.
    pub sun: [f64; 3],
}

/// Width and height of the picture (pixels): 0.7° each, which the smooth light of the sky fills well.
const SIZE: UVec2 = UVec2::new(512, 256);

/// Steps of the integral along each direction, three points each.
const STEPS: u32 = 16;

/// Computes light that arrives at an observer.
struct Observer {
    atmosphere: Atmosphere,
    sunlight: Sunlight,
    /// `None` for light that was scattered once only.
    multiple: Option<Multiple>,
    /// Distance from the centre of the earth (m).
    radius: f64,
    /// Elevation of the sun (degrees).
    elevation: f64,
    /// Sine and cosine of the sun's angle to the zenith.
    sun: (f64, f64),
}

impl Sky {
    /// Computes the light of the sky. The result has the same bits with any number of threads.
    pub fn light(&self) -> SkyLight {
        let observer = Observer::new(Atmosphere::of_turbidity(self.turbidity), self.altitude, self.elevation, Some(self.ground));
        let [columns, rows] = SIZE.to_array();
        let cosine = |row: u32| sin_cos_f64(PI * (f64::from(row) + 0.5) / f64::from(rows)).1;
        let half = columns / 2;
        let line = |row: u32| -> Vec<Color> {
            let view = observer.view(cosine(row));
            (0..half).map(|column| observer.scattered(&view, azimuth(column, columns))).collect()
        };
        let mut lines: Vec<Vec<Color>> = (0..rows).into_par_iter().map(line).collect();
        self.add_ground(&observer, &mut lines, cosine);
        // Column k and column −1 − k are equally far from the sun, which is between the two columns in the middle.
        let values = lines.iter().flat_map(|line| (0..columns).map(|column| line[column.min(columns - 1 - column) as usize]));
        let values = values.map(|color| color.map(|c| c as f32)).collect();
        let pixels = Pixels::new(SIZE, values).expect("as many values as pixels");
        SkyLight { pixels, sun: observer.sunlight() }
    }

    /// Adds the light that the ground reflects.
    fn add_ground(&self, observer: &Observer, lines: &mut [Vec<Color>], cosine: impl Fn(u32) -> f64) {
        let rows = lines.len();
        // Irradiance from the sky: the sum over the upper half of the picture.
        let mut irradiance = [0.0; 3];
        for (row, line) in lines.iter().enumerate().take(rows / 2) {
            let cos = cosine(row as u32);
            let weight = PI / rows as f64 * (1.0 - cos * cos).sqrt() * cos * 2.0 * PI / line.len() as f64;
            line.iter().for_each(|color| (0..3).for_each(|k| irradiance[k] += weight * color[k]));
        }
        let direct = observer.sunlight.at(GROUND, observer.sun.1).map(|share| share * observer.sun.1.max(0.0));
        for (row, line) in lines.iter_mut().enumerate() {
            let path = Path::new(observer.radius, cosine(row as u32), STEPS);
            if path.hits_ground {
                let passed = observer.atmosphere.transmittance(&path.amounts);
                line.iter_mut().for_each(|color| {
                    (0..3).for_each(|k| color[k] += passed[k] * self.ground[k] / PI * (direct[k] + irradiance[k]));
                });
            }
        }
    }
}

/// Azimuth from the sun of the middle of a column, from 180° at the left border to 0° in the middle of the picture (radians).
fn azimuth(column: u32, columns: u32) -> f64 {
    PI * (1.0 - (2.0 * f64::from(column) + 1.0) / f64::from(columns))
}

impl Observer {
    /// - `ground`: albedo of the ground, for light that is scattered more than once; without it only single scattering is computed
    fn new(atmosphere: Atmosphere, altitude: f64, elevation: f64, ground: Option<Color>) -> Observer {
        let sunlight = Sunlight::new(atmosphere);
        let multiple = ground.map(|ground| Multiple::new(&atmosphere, &sunlight, ground));
        let (sin, cos) = sin_cos_degrees(90.0 - elevation);
        Observer { atmosphere, sunlight, multiple, radius: GROUND + altitude, elevation, sun: (sin, cos) }
    }

    /// Share of the sun's light that arrives: the integral over the part of the disk above the horizon. With strips of the disk at the
    /// height α cos θ above its middle, α being its half angle, it is
    ///
    /// ∫ T(elevation + α cos θ) 2/π sin² θ dθ,
    ///
    /// where T is the transmittance.
    fn sunlight(&self) -> Color {
        const STRIPS: u32 = 16;
        let lowest = -((self.radius - GROUND) * (self.radius + GROUND)).max(0.0).sqrt() / self.radius;
        let horizon = 90.0 - acos_f64(lowest) * (180.0 / PI);
        // From the top of the disk to the horizon, or to its lower end.
        let end = acos_f64((horizon - self.elevation) / SUN_HALF_ANGLE);
        let width = end / f64::from(STRIPS);
        let mut sum = [0.0; 3];
        for strip in 0..STRIPS {
            let (sin, cos) = sin_cos_f64((f64::from(strip) + 0.5) * width);
            let passed = self.passed(sin_cos_degrees(self.elevation + SUN_HALF_ANGLE * cos).0.max(lowest));
            (0..3).for_each(|k| sum[k] += passed[k] * sin * sin * width * (2.0 / PI));
        }
        sum
    }

    /// Transmittance of the air along a direction that does not meet the ground, by an integral of its own: near the horizon it is more
    /// exact than the table.
    ///
    /// - `cos`: cosine of the angle to the zenith
    fn passed(&self, cos: f64) -> Color {
        self.atmosphere.transmittance(&amounts_to_top(self.radius, cos, 4 * STEPS))
    }

    /// The view at an angle to the zenith with a given cosine.
    fn view(&self, cos: f64) -> View {
        let path = Path::new(self.radius, cos, STEPS);
        let scatterer = |point: &PathPoint| {
            let passed = self.atmosphere.transmittance(&point.amounts);
            let scattering = self.atmosphere.scattering(&point.densities);
            let weights = scattering.map(|kind| std::array::from_fn(|k| point.weight * passed[k] * kind[k]));
            Scatterer { distance: point.distance, radius: point.radius, weights }
        };
        View { cos, scatterers: path.points.iter().map(scatterer).collect() }
    }

    /// Radiance of the light that is scattered along a view [sr⁻¹].
    ///
    /// - `azimuth`: angle of the view around the zenith from the sun (radians)
    fn scattered(&self, view: &View, azimuth: f64) -> Color {
        let sin = (1.0 - view.cos * view.cos).max(0.0).sqrt();
        let to_sun = sin * self.sun.0 * sin_cos_f64(azimuth).1 + view.cos * self.sun.1;
        let [of_molecules, of_aerosols] = phases(to_sun);
        let mut radiance = [0.0; 3];
        for Scatterer { distance, radius, weights: [molecules, aerosols] } in &view.scatterers {
            let sun = (self.radius * self.sun.1 + distance * to_sun) / radius;
            let arriving = self.sunlight.at(*radius, sun);
            let further = self.multiple.as_ref().map_or([0.0; 3], |multiple| multiple.at(*radius, sun));
            for k in 0..3 {
                let once = (molecules[k] * of_molecules + aerosols[k] * of_aerosols) * arriving[k];
                radiance[k] += once + (molecules[k] + aerosols[k]) * further[k];
            }
        }
        radiance
    }
}

/// View of an observer at one angle to the zenith.
struct View {
    /// Cosine of the angle.
    cos: f64,
    scatterers: Vec<Scatterer>,
}

/// Air at a point of a view.
struct Scatterer {
    /// Distance from the observer (m).
    distance: f64,
    /// Distance from the centre of the earth (m).
    radius: f64,
    /// Share of the light there that molecules and aerosols would scatter to the observer if their phase functions were 1.
    weights: [Color; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Very clean air seen from a height of 2 m, without light from the ground.
    fn observer(elevation: f64) -> Observer {
        Observer::new(Atmosphere { aerosols: 1.0 }, 2.0, elevation, None)
    }

    fn assert_near(found: Color, exact: Color, what: &str) {
        assert!(found.iter().zip(&exact).all(|(a, b)| (a / b - 1.0).abs() < 1e-3), "{what}: {found:?} and not {exact:?}");
    }

    /// Exact integrals over spherical shells, by Gauss' method.
    #[test]
    fn sunlight_is_dimmed_as_the_exact_integrals_say() {
        for (elevation, exact) in [
            (90.0, [0.940402, 0.867698, 0.762478]),
            (60.0, [0.93154, 0.848937, 0.731247]),
            (30.0, [0.884864, 0.753999, 0.582534]),
            (10.0, [0.713104, 0.459592, 0.221864]),
            (5.0, [0.543844, 0.249647, 0.063732]),
            (2.0, [0.331011, 0.085372, 0.006173]),
        ] {
            let observer = observer(elevation);
            assert_near(observer.passed(observer.sun.1), exact, &format!("{elevation}°"));
        }
        assert_eq!(observer(-1.0).sunlight(), [0.0; 3]);
    }

    /// Exact integrals of light that is scattered once, by elevation of the sun, elevation of the view, and azimuth between them.
    #[test]
    fn single_scattering_is_that_of_the_exact_integrals() {
        for (sun, view, azimuth, exact) in [
            (60.0, 90.0, 0.0, [0.00552377, 0.0106043, 0.0214227]),
            (60.0, 45.0, 90.0, [0.00523366, 0.0107379, 0.0218537]),
            (60.0, 10.0, 180.0, [0.0142683, 0.0264972, 0.041475]),
            (60.0, 55.0, 0.0, [0.0240881, 0.029537, 0.0417891]),
            (30.0, 90.0, 0.0, [0.0032623, 0.00657321, 0.0132893]),
            (30.0, 10.0, 180.0, [0.0196219, 0.0349072, 0.0514188]),
            (10.0, 90.0, 0.0, [0.0023549, 0.00409189, 0.00717406]),
            (10.0, 5.0, 0.0, [0.154779, 0.120065, 0.0719434]),
            (2.0, 90.0, 0.0, [0.00159188, 0.00181716, 0.00251239]),
            (2.0, 7.0, 0.0, [0.0677016, 0.0315985, 0.0119173]),
        ] {
            let observer = observer(sun);
            let view_cos = sin_cos_degrees(90.0 - view).1;
            let found = observer.scattered(&observer.view(view_cos), f64::to_radians(azimuth));
            assert_near(found, exact, &format!("sun {sun}°, view {view}°, azimuth {azimuth}°"));
        }
    }

    /// The sun sets without a jump: its light falls with each hundredth of a degree by at most a twelfth of what it was before it touched the
    /// horizon, to nothing when the last of its disk has set. High above the horizon the disk counts as its middle does.
    #[test]
    fn the_sun_sets_gradually() {
        let light = |elevation: f64| Observer::new(Atmosphere::of_turbidity(2.0), 0.0, elevation, None).sunlight();
        let whole = light(0.3);
        let lights: Vec<Color> = (0..=60).map(|k| light(0.3 - 0.01 * f64::from(k))).collect();
        for (k, pair) in lights.windows(2).enumerate() {
            for channel in 0..3 {
                let fall = (pair[0][channel] - pair[1][channel]) / whole[channel];
                assert!((0.0..1.0 / 12.0).contains(&fall), "step {k}: {pair:?}");
            }
        }
        assert!(lights[56][0] > 0.0 && lights[57] == [0.0; 3], "{lights:?}");
        let observer = Observer::new(Atmosphere::of_turbidity(2.0), 0.0, 40.0, None);
        for (disk, middle) in observer.sunlight().into_iter().zip(observer.passed(observer.sun.1)) {
            assert!((disk / middle - 1.0).abs() < 1e-4, "{disk} and {middle}");
        }
    }

    /// Over black ground, sun and sky together bring less than the sun above the atmosphere, and more than half of what the sun alone
    /// brings through clean air. White ground adds what the air returns of its reflection.
    #[test]
    fn multiple_scattering_keeps_the_energy() {
        for elevation in [10.0, 40.0, 80.0] {
            let irradiance = |ground: f64| {
                let sky = Sky { elevation, turbidity: 1.5, ground: [ground; 3], altitude: 0.0 };
                let SkyLight { pixels, sun } = sky.light();
                let mut sum = sun.map(|s| s * sin_cos_degrees(elevation).0);
                let [columns, rows] = pixels.size().to_array();
                for (k, value) in pixels.values().iter().take((columns * rows / 2) as usize).enumerate() {
                    let theta = PI * ((k as u32 / columns) as f64 + 0.5) / f64::from(rows);
                    let weight = theta.sin() * theta.cos() * PI / f64::from(rows) * 2.0 * PI / f64::from(columns);
                    (0..3).for_each(|c| sum[c] += weight * f64::from(value[c]));
                }
                sum
            };
            let (black, white) = (irradiance(0.0), irradiance(1.0));
            let above = sin_cos_degrees(elevation).0;
            for k in 0..3 {
                let direct = observer(elevation).sunlight()[k] * above;
                assert!(black[k] < above && black[k] > 0.5 * direct, "{elevation}°: {black:?} of {above}");
                // The air returns at most a third of what a white ground reflects: 1/(1 − 1/3).
                assert!(white[k] > black[k] && white[k] < 1.5 * black[k], "{elevation}°: {white:?} and {black:?}");
            }
        }
    }
}
