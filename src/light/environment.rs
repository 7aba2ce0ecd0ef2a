//! Environment light, infinitely far away.

use std::f32::consts::FRAC_1_PI;
use std::f64::consts::PI;

use glam::{Vec2, Vec3};

use super::emitted_ray::EmissionContext;
use super::{EmittedRay, LightLiSample, LightSampleContext, ShadowTarget};
use crate::math::lanes::{Lanes, One, Vector, tangents};
use crate::math::{Density, Frame, Local, Rgb, SolidAnglePdf, Spectrum, warp};

/// Environment with the same radiance from all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// Radiance [W·m⁻²·sr⁻¹].
    pub radiance: Rgb,
}

impl Environment {
    /// Radiance that arrives from the direction `_direction`.
    pub fn radiance(&self, _direction: Vec3) -> Spectrum {
        Spectrum::from_illuminant(self.radiance)
    }

    /// Radiance in all lanes.
    #[inline(always)]
    pub(crate) fn radiance_lanes<L: Lanes>(&self) -> Vector<L> {
        Vector::splat(Vec3::from(self.radiance(Vec3::Y).coefficients()))
    }

    /// Samples a direction for a point.
    pub(super) fn sample(&self, cx: &LightSampleContext, u: Vec2) -> Option<LightLiSample> {
        let wi = FlatLight::sample(cx, u.to_array());
        let density = Density::Smooth(SolidAnglePdf::new(FlatLight::pdf(cx, wi)));
        Some(LightLiSample { wi: wi.into(), li: self.radiance(wi.into()), density, target: ShadowTarget::Infinity })
    }

    /// Density of a sampled direction.
    pub(super) fn pdf(&self, cx: &LightSampleContext, wi: Vec3) -> SolidAnglePdf {
        SolidAnglePdf::new(FlatLight::pdf(cx, wi.into()))
    }

    /// Density 1 / 4π of an emitted direction.
    pub(super) fn emission_pdf(&self) -> SolidAnglePdf {
        SolidAnglePdf::new(warp::uniform_sphere_pdf())
    }

    /// A ray through the scene in a uniformly distributed direction.
    pub(super) fn emit(&self, cx: &EmissionContext) -> Option<EmittedRay> {
        let wi = warp::uniform_sphere(cx.direction);
        cx.ray_from_infinity(-wi, self.radiance(wi), Density::Smooth(self.emission_pdf()))
    }

    /// Flux Φ = π R² · 4π L through a scene of radius R (W).
    pub(super) fn power(&self, radius: f64) -> f64 {
        4.0 * PI * PI * radius * radius * f64::from(Spectrum::from_illuminant(self.radiance).average())
    }
}

/// How light that is the same in all directions is sampled for points, one in each lane.
pub(crate) trait FlatLight<L: Lanes> {
    /// Samples directions.
    fn sample(&self, u: [L::F32; 2]) -> Vector<L>;
    /// Densities of sampled directions [sr⁻¹].
    fn pdf(&self, wi: Vector<L>) -> L::F32;
}

/// For a single point: in proportion to the cosine on the side of the viewer where only that side counts, else uniformly.
impl FlatLight<One> for LightSampleContext {
    #[inline]
    fn sample(&self, u: [f32; 2]) -> Vector<One> {
        let wi = match self.is_one_sided() {
            true => Frame::around(self.ns).to_world(Local(warp::cosine_hemisphere(u.into()))).normalize(),
            false => warp::uniform_sphere(u.into()),
        };
        wi.into()
    }

    #[inline]
    fn pdf(&self, wi: Vector<One>) -> f32 {
        match self.is_one_sided() {
            true => warp::cosine_hemisphere_pdf(Vec3::Z * self.ns.dot(wi.into())),
            false => warp::uniform_sphere_pdf(),
        }
    }
}

/// Points for which light is sampled, with the bits of single points.
#[derive(Clone, Copy)]
pub(crate) struct FlatLightLanes<L: Lanes> {
    /// Unit shading normals on the side of the viewer, where only that side counts.
    pub ns: Vector<L>,
    /// Whether only light on that side counts.
    pub is_one_sided: L::Mask,
}

impl<L: Lanes> FlatLight<L> for FlatLightLanes<L> {
    #[inline(always)]
    fn sample(&self, u: [L::F32; 2]) -> Vector<L> {
        let mut wi = Vector::splat(Vec3::Y);
        if L::any(!self.is_one_sided) {
            wi = warp::uniform_sphere_lanes(u);
        }
        if L::any(self.is_one_sided) {
            let (w, [x, y]) = (warp::cosine_hemisphere_lanes::<L>(u), tangents(self.ns));
            let one_sided = (x.scaled(w.x) + y.scaled(w.y) + self.ns.scaled(w.z)).normalized();
            wi = Vector::select(self.is_one_sided, one_sided, wi);
        }
        wi
    }

    #[inline(always)]
    fn pdf(&self, wi: Vector<L>) -> L::F32 {
        let cosine = L::f32(FRAC_1_PI) * L::max(self.ns.dot(wi), L::f32(0.0));
        L::select(self.is_one_sided, cosine, L::f32(warp::uniform_sphere_pdf()))
    }
}
