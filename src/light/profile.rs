//! Point lights whose intensity was measured for each direction.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::bounds::LightBounds;
use super::emitted_ray::EmissionContext;
use super::point::direction_and_square;
use super::{EmittedRay, LightLiSample, ShadowTarget};
use crate::math::{Aabb, Density, Discrete, Rgb, SolidAnglePdf, Spectrum, float};

/// Point light with the intensity I · s(w) in the direction w, where s is an [`IntensityProfile`].
#[derive(Clone, Debug, PartialEq)]
pub struct ProfiledPoint {
    /// Position (m).
    pub position: DVec3,
    /// Unit axes of the profile: towards the horizontal angles 0° and 90°, and towards the vertical angle 0°.
    pub axes: [Vec3; 3],
    /// I, the intensity where the profile is greatest [W·sr⁻¹].
    pub intensity: Rgb,
    /// The profile.
    pub profile: Arc<IntensityProfile>,
}

/// Relative intensity by direction, from 0 to 1, interpolated linearly between a grid of angles. Beyond the grid it is 0.
///
/// Tests: profiles_have_the_values_of_their_file, directions_of_profiles_are_distributed_as_their_density_says.
#[derive(Clone, Debug, PartialEq)]
pub struct IntensityProfile {
    /// Angles from the axis, ascending (rad).
    vertical: Vec<f32>,
    /// Angles around the axis, from 0 to 2π, ascending (rad).
    horizontal: Vec<f32>,
    /// Values for each horizontal angle, and within it for each vertical one.
    values: Vec<f32>,
    /// Choice of a cell of the grid, in proportion to its light.
    cells: Discrete,
    /// Mean over all directions.
    mean: f64,
}

impl IntensityProfile {
    /// A profile with the given values, which are divided by the greatest of them; `None` if none is above 0, the numbers do not fit
    /// together, or the angles do not rise, from 0 to 2π around the axis.
    ///
    /// - `vertical`, `horizontal`: angles from and around the axis, at least two each (rad)
    /// - `values`: for each horizontal angle, and within it for each vertical one
    pub fn new(vertical: Vec<f32>, horizontal: Vec<f32>, values: Vec<f64>) -> Option<IntensityProfile> {
        let rises = |angles: &[f32]| angles.len() >= 2 && angles.windows(2).all(|pair| pair[0] < pair[1]);
        let is_whole = horizontal.first() == Some(&0.0) && horizontal.last().is_some_and(|last| (f64::from(*last) - TAU).abs() < 1e-6);
        let is_grid = rises(&vertical) && rises(&horizontal) && is_whole && values.len() == vertical.len() * horizontal.len();
        if !is_grid || vertical[0] < 0.0 || f64::from(vertical[vertical.len() - 1]) > PI + 1e-6 {
            return None;
        }
        let most = values.iter().copied().fold(0.0, f64::max);
        let values: Vec<f32> = values.iter().map(|value| (value / most) as f32).collect();
        let (rows, columns) = (vertical.len() - 1, horizontal.len() - 1);
        let grid = Grid { vertical: &vertical, horizontal: &horizontal };
        let light = |k: usize| {
            let (i, j) = (k / rows, k % rows);
            let at = |i: usize, j: usize| values[i * vertical.len() + j];
            0.25 * (at(i, j) + at(i + 1, j) + at(i, j + 1) + at(i + 1, j + 1)) * grid.solid_angle(i, j)
        };
        let weights: Vec<f32> = (0..rows * columns).map(light).collect();
        let cells = Discrete::new(&weights)?;
        let mean = cells.total() / (2.0 * TAU);
        Some(IntensityProfile { vertical, horizontal, values, cells, mean })
    }

    /// Relative intensity in a direction, given by its components along the axes of the profile.
    pub fn at(&self, w: Vec3) -> f32 {
        let (theta, phi) = angles(w);
        let (Some((i, s)), Some((j, t))) = (place(&self.horizontal, phi), place(&self.vertical, theta)) else { return 0.0 };
        let at = |i: usize, j: usize| self.values[i * self.vertical.len() + j];
        let along = |i: usize| at(i, j) * (1.0 - t) + at(i, j + 1) * t;
        along(i) * (1.0 - s) + along(i + 1) * s
    }

    /// Samples a direction about in proportion to the intensity: a cell of the grid by the mean of its corners, then uniformly within it.
    pub fn sample(&self, u: Vec2) -> (Vec3, SolidAnglePdf) {
        let (cell, pmf, within) = self.cells.sample(u.x);
        let (i, j) = (cell / (self.vertical.len() - 1), cell % (self.vertical.len() - 1));
        let [from, to] = [self.vertical[j], self.vertical[j + 1]].map(float::cos);
        let z = (from + (to - from) * within).clamp(-1.0, 1.0);
        let phi = self.horizontal[i] + (self.horizontal[i + 1] - self.horizontal[i]) * u.y;
        let (sin_phi, cos_phi) = float::sin_cos(phi);
        let sin = ((1.0 - z) * (1.0 + z)).sqrt();
        (Vec3::new(sin * cos_phi, sin * sin_phi, z), SolidAnglePdf::new(pmf / self.grid().solid_angle(i, j)))
    }

    /// Density of [`IntensityProfile::sample`].
    pub fn pdf(&self, w: Vec3) -> SolidAnglePdf {
        let (theta, phi) = angles(w);
        let (Some((i, _)), Some((j, _))) = (place(&self.horizontal, phi), place(&self.vertical, theta)) else { return SolidAnglePdf::ZERO };
        SolidAnglePdf::new(self.cells.pmf(i * (self.vertical.len() - 1) + j) / self.grid().solid_angle(i, j))
    }

    fn grid(&self) -> Grid<'_> {
        Grid { vertical: &self.vertical, horizontal: &self.horizontal }
    }
}

/// Angles of the grid of a profile.
struct Grid<'a> {
    vertical: &'a [f32],
    horizontal: &'a [f32],
}

impl Grid<'_> {
    /// Solid angle of the cell between the horizontal angles `i` and `i` + 1 and the vertical ones `j` and `j` + 1 (sr).
    fn solid_angle(&self, i: usize, j: usize) -> f32 {
        (float::cos(self.vertical[j]) - float::cos(self.vertical[j + 1])) * (self.horizontal[i + 1] - self.horizontal[i])
    }
}

/// Angle from the z axis, and around it from x, from 0 to 2π.
fn angles(w: Vec3) -> (f32, f32) {
    let phi = float::atan2(w.y, w.x);
    // Unlike the arc cosine of z, this keeps its digits near the poles.
    (float::atan2((w.x * w.x + w.y * w.y).sqrt(), w.z), if phi < 0.0 { phi + std::f32::consts::TAU } else { phi })
}

/// Index of the interval that contains the angle, and the place within it from 0 to 1; `None` outside.
fn place(angles: &[f32], angle: f32) -> Option<(usize, f32)> {
    let last = angles.len() - 1;
    // Rounding must not lose the pole and the seam.
    let angle = if angle > angles[last] && angle <= angles[last] + 4.0 * f32::EPSILON * angle { angles[last] } else { angle };
    if angle < angles[0] || angle > angles[last] {
        return None;
    }
    let i = angles.partition_point(|a| *a <= angle).clamp(1, last) - 1;
    Some((i, (angle - angles[i]) / (angles[i + 1] - angles[i])))
}

impl ProfiledPoint {
    pub(super) fn sample(&self, from: Vec3) -> Option<LightLiSample> {
        let (wi, d2) = direction_and_square(from, self.position.as_vec3())?;
        let li = Spectrum::from_illuminant(self.intensity) * (self.profile.at(self.local(-wi)) / d2);
        (!li.is_black()).then_some(LightLiSample { wi, li, density: Density::Delta, target: ShadowTarget::Point(self.position.as_vec3()) })
    }

    /// A ray in a direction about in proportion to the intensity.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        let (local, pdf) = self.profile.sample(cx.direction);
        let [x, y, z] = self.axes;
        let w = (x * local.x + y * local.y + z * local.z).normalize();
        cx.ray_from_position(self.position.as_vec3(), w, Spectrum::from_illuminant(self.intensity) * self.profile.at(local), pdf)
    }

    pub(super) fn emission_pdf(&self, w: Vec3) -> SolidAnglePdf {
        self.profile.pdf(self.local(w))
    }

    /// Components of a direction along the axes of the profile.
    fn local(&self, w: Vec3) -> Vec3 {
        Vec3::from_array(self.axes.map(|axis| axis.dot(w)))
    }

    /// Bounds for the choice of the light: its mean intensity, in all directions.
    pub(super) fn bounds(&self) -> LightBounds {
        LightBounds::all_directions(Aabb::around([self.position.as_vec3()]), self.power() / (2.0 * TAU))
    }

    /// Flux Φ = 4π I times the mean of the profile (W).
    pub(super) fn power(&self) -> f64 {
        2.0 * TAU * f64::from(Spectrum::from_illuminant(self.intensity).average()) * self.profile.mean
    }
}
