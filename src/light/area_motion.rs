//! Motion of emitting shapes: their samples and densities in the world.

use glam::Vec3;

use crate::math::{Aabb, AnimatedTransform, AreaPdf, SolidAnglePdf, Transform};
use crate::shape::SurfacePoint;

/// How an emitting shape moves. It is sampled in its own space, in which it is at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct EmitterMotion {
    /// Transform from the space of the shape to the world.
    pub to_world: AnimatedTransform,
    /// Distance outside of its triangles at which rays still hit them, in the space of the shape (m).
    pub tolerance: f32,
}

/// Motion at a time.
pub(super) struct Moment<'a> {
    to_world: std::borrow::Cow<'a, Transform>,
    tolerance: f32,
}

impl EmitterMotion {
    /// The motion at a time.
    pub(super) fn at(&self, time: f32) -> Moment<'_> {
        Moment { to_world: self.to_world.at(time), tolerance: self.tolerance }
    }

    /// Bounding box of a box over all times.
    pub(super) fn bounds(&self, space: &Aabb) -> Aabb {
        let [min, max] = self.to_world.bounds([space.min.as_dvec3(), space.max.as_dvec3()]);
        Aabb { min: min.as_vec3().map(f32::next_down), max: max.as_vec3().map(f32::next_up) }
    }

    /// Estimate of the factor by which the area of the shape grows, the mean over some times: |det M| |M⁻ᵀ n| for a flat shape, and
    /// |det M|^⅔, which is exact for similarities, for others.
    ///
    /// - `normal`: unit normal of a flat shape, in its own space
    pub(super) fn growth(&self, normal: Option<Vec3>) -> f64 {
        const TIMES: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
        let at = |time: f32| {
            let to_world = self.to_world.at(time);
            let (volume, inverse) = (to_world.determinant().abs(), to_world.inverse_matrix().matrix3);
            let side = volume.cbrt();
            normal.map_or(side * side, |n| volume * (inverse.transpose() * n.as_dvec3()).length())
        };
        TIMES.map(at).iter().sum::<f64>() / TIMES.len() as f64
    }
}

impl Moment<'_> {
    /// A point of the world in the space of the shape.
    pub fn to_local(&self, p: Vec3) -> Vec3 {
        self.to_world.inverse_matrix().transform_point3(p.as_dvec3()).as_vec3()
    }

    /// A surface point in the world. Rays that start there or end there do not hit the shape.
    pub fn place(&self, point: &SurfacePoint) -> SurfacePoint {
        SurfacePoint { offset: point.offset + 2.0 * self.tolerance, ..*point }.placed(&self.to_world)
    }

    /// A surface point of the world in the space of the shape.
    pub fn point_to_local(&self, point: &SurfacePoint) -> SurfacePoint {
        point.placed(&self.to_world.inverse())
    }

    /// Density by solid angle in the world of a direction that has the density `pdf` in the space of the shape.
    ///
    /// With M⁻¹ the linear map from the world, dω′ = |det M⁻¹| / |M⁻¹ w|³ dω.
    ///
    /// - `w`: unit direction in the world
    pub fn by_solid_angle(&self, pdf: SolidAnglePdf, w: Vec3) -> SolidAnglePdf {
        let inverse = self.to_world.inverse_matrix().matrix3;
        let stretch = (inverse * w.as_dvec3()).length();
        pdf * (inverse.determinant().abs() / (stretch * stretch * stretch)) as f32
    }

    /// Density by area in the world of a point that has the density `pdf` in the space of the shape.
    ///
    /// dA = |det M| |M⁻ᵀ n′| dA′
    ///
    /// - `n`: unit normal in the space of the shape
    pub fn by_area(&self, pdf: AreaPdf, n: Vec3) -> AreaPdf {
        let normal = self.to_world.inverse_matrix().matrix3.transpose() * n.as_dvec3();
        AreaPdf::new((f64::from(pdf.get()) / (self.to_world.determinant().abs() * normal.length())) as f32)
    }
}
