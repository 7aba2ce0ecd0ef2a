//! Ellipsoids for several rays or points at once, one in each lane, with the bits of [`Shape`](crate::shape::Shape)'s methods.
//!
//! Tests: lanes_have_the_bits_of_single_rays_and_points, side_by_side_paths_have_the_bits_of_single_ones.

use std::f64::consts::TAU;

use glam::DMat3;

use super::Ellipsoid;
use crate::math::float::sin_cos_lanes;
use crate::math::lanes::{Lanes, Rays, Vector, VectorF64, tangents};
use crate::shape::offset_bound_lanes;

/// Points of a surface, one in each lane.
pub(crate) struct PointLanes<L: Lanes> {
    /// Positions (m).
    pub p: Vector<L>,
    /// Unit normals.
    pub ng: Vector<L>,
    /// Distances from `p` at which rays start (m).
    pub offset: L::F32,
}

impl Ellipsoid {
    /// Distances of the first hits with 0 < t < `t_max`, and the lanes that have one: see
    /// [`Shape::intersect`](crate::shape::Shape::intersect).
    #[inline(always)]
    pub(crate) fn intersect_lanes<L: Lanes>(&self, origin: VectorF64<L>, direction: VectorF64<L>, t_max: L::F32) -> (L::F32, L::Mask) {
        let o = product(self.inverse, origin - VectorF64::splat(self.center));
        let d = product(self.inverse, direction);
        let d2 = d.length_squared();
        let middle = -o.dot(d) / d2;
        let inside = L::f64(1.0) - (o + d.scaled(middle)).length_squared();
        let passes_by = L::lt_f64(inside, L::f64(0.0));
        let half = L::sqrt_f64(inside / d2);
        let (near, far) = (L::narrow(middle - half), L::narrow(middle + half));
        let zero = L::f32(0.0);
        let is_near = L::lt(zero, near) & L::lt(near, t_max);
        let is_far = L::lt(zero, far) & L::lt(far, t_max);
        (L::select(is_near, near, far), (is_near | is_far) & !passes_by)
    }

    /// Points at which rays hit, without texture coordinates: see [`Shape::point`](crate::shape::Shape::point).
    #[inline(always)]
    pub(crate) fn points_lanes<L: Lanes>(&self, rays: &Rays<L>, t: L::F32) -> PointLanes<L> {
        let p = rays.origin.widened() + rays.direction.widened().scaled(L::widen(t));
        self.at_lanes(product(self.inverse, p - VectorF64::splat(self.center)).normalized())
    }

    /// Points for points `n` of the unit sphere, without texture coordinates.
    #[inline(always)]
    fn at_lanes<L: Lanes>(&self, n: VectorF64<L>) -> PointLanes<L> {
        let ng = product(self.inverse.transpose(), n).normalized().narrowed();
        let p = (VectorF64::splat(self.center) + product(self.linear, n)).narrowed();
        PointLanes { p, ng, offset: offset_bound_lanes(ng, self.magnitude()) }
    }

    /// Samples points for the points `from` outside of a sphere, uniformly in the cones of directions that it covers: see
    /// [`Shape::sample_from`](crate::shape::Shape::sample_from). Returns them with their densities by solid angle and the lanes of `active`
    /// whose points are outside; `None` if there are none, or for a stretched sphere.
    #[inline(always)]
    pub(crate) fn sample_lanes<L: Lanes>(
        &self,
        from: Vector<L>,
        [u, v]: [L::F32; 2],
        active: L::Mask,
    ) -> Option<(PointLanes<L>, L::F32, L::Mask)> {
        let (one, radius) = (L::f64(1.0), L::f64(self.radius?));
        let line = from.widened() - VectorF64::splat(self.center);
        let d = line.length();
        let axis = line.divided(d);
        let rounding = L::widen(offset_bound_lanes(axis.narrowed(), self.magnitude()));
        let is_outside = active & L::lt_f64(rounding, d - radius);
        if !L::any(is_outside) {
            return None;
        }
        let sin2 = (radius / d) * (radius / d);
        let opening = sin2 / (one + L::sqrt_f64(one - sin2));
        let pdf = L::narrow(one / (L::f64(TAU) * opening));

        let one_minus_cos = opening * L::widen(u);
        let (cos, sin2) = (one - one_minus_cos, one_minus_cos * (L::f64(2.0) - one_minus_cos));
        let to_hit = d * cos - L::sqrt_f64(L::max_f64(radius * radius - d * d * sin2, L::f64(0.0)));
        let along = (d - to_hit * cos) / radius;
        let across = to_hit * L::sqrt_f64(sin2) / radius;
        let (sin_phi, cos_phi) = sin_cos_lanes::<L>(L::f32(std::f32::consts::TAU) * v);
        let [x, y] = tangents(axis.narrowed());
        let side = x.widened().scaled(L::widen(cos_phi)) + y.widened().scaled(L::widen(sin_phi));
        let normal = (axis.scaled(along) + side.scaled(across)).normalized();
        Some((self.at_lanes(product(self.inverse, normal).normalized()), pdf, is_outside))
    }
}

/// Products M·v with a matrix, as glam computes them.
#[inline(always)]
fn product<L: Lanes>(matrix: DMat3, v: VectorF64<L>) -> VectorF64<L> {
    let (x, y, z) = (VectorF64::splat(matrix.x_axis), VectorF64::splat(matrix.y_axis), VectorF64::splat(matrix.z_axis));
    x.scaled(v.x) + y.scaled(v.y) + z.scaled(v.z)
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec2, Vec3};
    use proptest::array::uniform3;
    use proptest::prelude::*;

    use super::*;
    use crate::math::lanes::{Kernel, MAX_COUNT, Width, to_array};
    use crate::math::{Ray, Transform};
    use crate::shape::{Shape, Sphere};

    /// Everything that is computed for some rays and the points at which they start.
    struct All<'a> {
        ellipsoid: &'a Ellipsoid,
        rays: &'a [Ray],
        u: [Vec2; MAX_COUNT],
    }

    /// Results of all lanes; the properties of points are p, ng and offset.
    struct Results {
        count: usize,
        hit: u32,
        t: [f32; MAX_COUNT],
        points: [[f32; MAX_COUNT]; 7],
        outside: u32,
        samples: [[f32; MAX_COUNT]; 7],
        pdf: [f32; MAX_COUNT],
    }

    impl Kernel for All<'_> {
        type Output = Results;

        #[inline(always)]
        fn run<L: Lanes>(self) -> Results {
            let (rays, _) = Rays::<L>::new(&self.rays[..L::COUNT]);
            let (t, hit) = self.ellipsoid.intersect_lanes::<L>(rays.origin.widened(), rays.direction.widened(), rays.t_max);
            let points = self.ellipsoid.points_lanes(&rays, t);
            let u = [L::load(&self.u.map(|u| u.x)), L::load(&self.u.map(|u| u.y))];
            let sample = self.ellipsoid.sample_lanes(rays.origin, u, L::mask(u32::MAX));
            let none = [0.0; MAX_COUNT];
            let (samples, pdf, outside) = match sample {
                Some((points, pdf, outside)) => (properties(&points), to_array::<L>(pdf), L::bits(outside)),
                None => ([none; 7], none, 0),
            };
            let points = properties(&points);
            Results { count: L::COUNT, hit: L::bits(hit), t: to_array::<L>(t), points, outside, samples, pdf }
        }
    }

    fn properties<L: Lanes>(points: &PointLanes<L>) -> [[f32; MAX_COUNT]; 7] {
        let ([x, y, z], [nx, ny, nz]) = (points.p.to_arrays(), points.ng.to_arrays());
        [x, y, z, nx, ny, nz, to_array::<L>(points.offset)]
    }

    /// Whether numbers have the same bits, or are NaN.
    fn same(a: &[f32], b: &[f32]) -> bool {
        a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
    }

    /// A number of any size and sign.
    fn number() -> impl Strategy<Value = f64> {
        (0.5..1.0, -20..20i32, any::<bool>()).prop_map(|(x, exponent, sign)| x * 2f64.powi(exponent) * if sign { 1.0 } else { -1.0 })
    }

    /// A ray near a sphere: its origin and direction in the system of the unit sphere, and the share of the distance to the centre that it goes.
    fn rays() -> impl Strategy<Value = Vec<(DVec3, DVec3, f32)>> {
        let vector = || uniform3(-2.0..2.0).prop_map(DVec3::from_array);
        let origin = prop_oneof![vector(), vector().prop_map(DVec3::normalize_or_zero), uniform3(number()).prop_map(DVec3::from_array)];
        let end = prop_oneof![Just(f32::INFINITY), 0.0f32..2.0];
        prop::collection::vec((origin, vector(), end), MAX_COUNT)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1_000))]

        /// Spheres and stretched ones, mirrored and turned, small and large, near and far from the origin.
        #[test]
        fn lanes_have_the_bits_of_single_rays_and_points(
            stretch in prop_oneof![number().prop_map(DVec3::splat), uniform3(number()).prop_map(DVec3::from_array)],
            axis in uniform3(-1.0..1.0),
            degrees in 0.0..360.0,
            center in prop_oneof![Just([0.0; 3]), uniform3(number())],
            rays in rays(),
            u in prop::array::uniform2(prop::array::uniform16(0.0f32..1.0)),
        ) {
            let turned = Transform::rotate(DVec3::from_array(axis) + DVec3::X * 2.0, degrees).expect("an axis");
            let moved = Transform::translate(DVec3::from_array(center)).expect("finite");
            let placed = Transform::scale(stretch).expect("not zero").then(&turned).then(&moved);
            let ellipsoid = Sphere { radius: 1.0 }.place(&placed);
            let rays: Vec<Ray> = rays.into_iter().map(|(origin, direction, end)| {
                let ray = Ray::new(placed.point(origin).as_vec3(), placed.vector(direction).as_vec3().normalize_or(Vec3::X));
                Ray { t_max: end * (ray.origin.as_dvec3() - placed.point(DVec3::ZERO)).length() as f32, ..ray }
            }).collect();
            let u = std::array::from_fn(|k| Vec2::new(u[0][k], u[1][k]));
            for width in Width::available() {
                let found = width.run(All { ellipsoid: &ellipsoid, rays: &rays, u });
                for (k, ray) in rays.iter().enumerate().take(found.count) {
                    let hit = ellipsoid.intersect(0, ray);
                    prop_assert_eq!(hit.is_some(), found.hit >> k & 1 == 1, "{:?} {:?}", width, ray);
                    let of_lane = |rows: &[[f32; MAX_COUNT]; 7]| rows.map(|row| row[k]);
                    let of_point = |point: &crate::shape::SurfacePoint| {
                        let (p, n) = (point.p, point.ng);
                        [p.x, p.y, p.z, n.x, n.y, n.z, point.offset]
                    };
                    if let Some(hit) = hit {
                        prop_assert!(same(&[hit.t], &[found.t[k]]), "{:?} {:?}", width, ray);
                        let point = ellipsoid.point(0, ray, &hit);
                        prop_assert!(same(&of_point(&point), &of_lane(&found.points)), "{:?} {:?}", width, ray);
                    }
                    prop_assert_eq!(ellipsoid.cone(ray.origin).is_some(), found.outside >> k & 1 == 1, "{:?} {:?}", width, ray);
                    if found.outside >> k & 1 == 1 {
                        let (point, pdf) = ellipsoid.sample_from(0, ray.origin, u[k]).expect("from outside");
                        prop_assert!(same(&of_point(&point), &of_lane(&found.samples)), "{:?} {:?}", width, ray);
                        prop_assert!(same(&[pdf.get()], &[found.pdf[k]]), "{:?} {:?}", width, ray);
                    }
                }
            }
        }
    }
}
