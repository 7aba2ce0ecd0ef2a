//! Hits are where the formulas say, of near and far rays, in any place and size.

use glam::{DVec3, Vec3};
use pt::math::{Ray, Transform};
use pt::shape::{BilinearPatch, Cone, Cylinder, Geometry, PartialDisk, PartialSphere, Shape};
use pt::torture::meshes::shapes;
use rayon::prelude::*;

use super::{Kind, kinds, skewed};
use crate::random::Random;

/// The function of a shape along a ray.
struct Along<'a> {
    kind: &'a Kind,
    inverse: Transform,
    ray: Ray,
}

impl Along<'_> {
    fn point(&self, t: f64) -> DVec3 {
        self.inverse.point(self.ray.origin.as_dvec3() + self.ray.direction.as_dvec3() * t)
    }

    fn value(&self, t: f64) -> f64 {
        (self.kind.implicit)(self.point(t))
    }

    /// Where the function changes its sign between two distances, by bisection of many intervals.
    fn roots(&self, from: f64, to: f64) -> Vec<f64> {
        const INTERVALS: u32 = 256;
        let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(INTERVALS);
        let changes = (0..INTERVALS).map(|k| (at(k), at(k + 1))).filter(|(a, b)| (self.value(*a) < 0.0) != (self.value(*b) < 0.0));
        changes
            .map(|(mut low, mut high)| {
                let is_below = self.value(low) < 0.0;
                for _ in 0..100 {
                    let middle = 0.5 * (low + high);
                    let keeps = (self.value(middle) < 0.0) == is_below;
                    (low, high) = if keeps { (middle, high) } else { (low, middle) };
                }
                0.5 * (low + high)
            })
            .collect()
    }
}

/// The first change of sign of the function on the part of the surface that is there is hit, to the rounding of t, and every hit is such a
/// place. Hits that are tangential or at a border, within rounding, may be missed or not.
#[test]
fn hits_are_the_first_zeros_of_the_formulas() {
    for kind in kinds() {
        let hits: usize = (0..400u64).into_par_iter().map(|seed| check(&kind, seed)).sum();
        assert!(hits > 4000, "{}: {hits} of 4·10⁴ rays hit", kind.name);
    }
}

fn check(kind: &Kind, seed: u64) -> usize {
    let mut random = Random::new(seed);
    let size = random.decade(-6.0, 6.0);
    let center = random.direction() * size * random.pick(&[0.0, 1.0, 1e3]);
    let place = skewed(&mut random).then(&Transform::scale(DVec3::splat(size)).expect("not zero"));
    let place = place.then(&Transform::translate(center).expect("finite"));
    let shape = kind.bake(&place);
    let mut hits = 0;
    for _ in 0..100 {
        let origin = (center + random.direction() * size * random.decade(-2.0, 4.0)).as_vec3();
        let target = place.point((kind.point)(random.unit(), random.unit())) + random.in_cube() * (size * random.pick(&[0.0, 0.0, 0.3]));
        let ray = Ray::new(origin, (target - origin.as_dvec3()).normalize().as_vec3());
        let along = Along { kind, inverse: place.inverse(), ray };
        let middle = (center - origin.as_dvec3()).dot(ray.direction.as_dvec3());
        let found = shape.intersect(0, &ray);
        // All shapes lie within 4 sizes around their origin.
        let roots = along.roots((middle - 4.0 * size).max(0.0), (middle + 4.0 * size).max(0.0));
        // t has the rounding of f32, and positions that of coordinates in f64.
        let coordinates = 1e-13 * (size + center.length() + f64::from(origin.length()));
        let rounding = |t: f64| t * 2f64.powi(-23) + coordinates;
        let inside = |t: f64| (kind.inside)(along.point(t));
        let is_there = |t: &f64| inside(*t) > 100.0 * coordinates / size && *t > rounding(*t);
        // Nearly tangential zeros move further than t is rounded.
        let is_sure = |t: &f64| {
            let step = 1e-4 * size;
            let slope = (along.value(t + step) - along.value(t - step)).abs() / (2.0 * step);
            slope * size > 1e-2
        };
        let first = roots.iter().copied().filter(|t| is_there(t) && is_sure(t)).fold(f64::INFINITY, f64::min);
        match found {
            Some(hit) => {
                let t = f64::from(hit.t);
                assert!(t <= first + rounding(first), "{} {seed}: {t} lies behind {first}", kind.name);
                let is_negative = |t: f64| along.value(t) < 0.0;
                let is_zero = is_negative(t - 2.0 * rounding(t)) != is_negative(t + 2.0 * rounding(t));
                let is_tangential = !is_sure(&t);
                assert!(is_zero || is_tangential, "{} {seed}: no zero at {t}, but at {roots:?}", kind.name);
                // The border moves by the rounding of t, which transforms magnify by less than 10.
                let slack = if is_tangential { 1e-4 } else { 0.0 } + 10.0 * rounding(t) / size;
                assert!(inside(t) >= -slack, "{} {seed}: {} at {t}", kind.name, inside(t));
                hits += 1;
            }
            None => assert!(first.is_infinite(), "{} {seed}: missed at {first}", kind.name),
        }
    }
    hits
}

/// Rays meet a mesh of 2 · 256² triangles of the same surface at the same distances: its sagitta is (5.3/256)²/8 < 10⁻⁴ for an angle of
/// 300° and a radius of 1. Near borders and outlines one of the two may be missed.
#[test]
fn hits_are_those_of_a_fine_mesh() {
    const SAG: f64 = 1e-4;
    for (k, kind) in kinds().into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        let place = skewed(&mut random);
        let shape = kind.bake(&place);
        let mesh = pt::accel::build(shapes(vec![kind.mesh(&place, 256)]));
        let (mut both, mut one) = (0, 0);
        for _ in 0..100_000 {
            let ray = Ray::new((random.direction() * 4.0).as_vec3(), Vec3::ZERO);
            let target = place.point((kind.point)(random.unit(), random.unit())) + random.in_cube() * 0.2;
            let ray = Ray { direction: (target - ray.origin.as_dvec3()).normalize().as_vec3(), ..ray };
            match (shape.intersect(0, &ray), mesh.intersect(&ray)) {
                (Some(hit), Some(expected)) => {
                    let cos = shape.point(0, &ray, &hit).ng.dot(ray.direction).abs();
                    // A ray may pass the border of one surface and meet its far side.
                    let is_near = f64::from((hit.t - expected.t).abs() * cos) <= 2.0 * SAG;
                    (both, one) = if is_near || cos < 0.05 { (both + 1, one) } else { (both, one + 1) };
                }
                (None, None) => {}
                _ => one += 1,
            }
        }
        assert!(both > 40_000 && one < 400, "{}: {both} agree, {one} do not", kind.name);
    }
}

fn hit(shape: &dyn Shape, origin: [f32; 3], direction: [f32; 3]) -> Option<f32> {
    shape.intersect(0, &Ray::new(origin.into(), direction.into())).map(|hit| hit.t)
}

fn baked(geometry: impl Geometry) -> Box<dyn Shape> {
    geometry.bake(&Transform::IDENTITY).expect("an area")
}

/// Rays along the axis, through apexes and holes, along straight lines of a surface, and tangential ones.
#[test]
fn special_rays_have_the_hits_of_geometry() {
    let tube = baked(Cylinder { radius: 1.0, z: [-1.0, 1.0], phi_max: 360.0 });
    let half = baked(Cylinder { radius: 1.0, z: [-1.0, 1.0], phi_max: 180.0 });
    let hat = baked(Cone { radius: 1.0, height: 2.0, phi_max: 360.0 });
    let bowl = baked(PartialSphere { radius: 1.0, z: [-1.0, 0.0], phi_max: 360.0 });
    let ring = baked(PartialDisk { radius: 1.0, inner_radius: 0.5, phi_max: 270.0 });
    let corners = [[-1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [1.0, 1.0, 1.0]].map(DVec3::from);
    let saddle = baked(BilinearPatch { corners });
    let cases = [
        ("along the axis of a cylinder", hit(&*tube, [0.0, 0.0, -5.0], [0.0, 0.0, 1.0]), None),
        ("along its wall, outside", hit(&*tube, [1.25, 0.0, -5.0], [0.0, 0.0, 1.0]), None),
        ("across it", hit(&*tube, [-5.0, 0.0, 0.5], [1.0, 0.0, 0.0]), Some(4.0)),
        ("from within", hit(&*tube, [0.0, 0.0, 0.5], [1.0, 0.0, 0.0]), Some(1.0)),
        ("over it", hit(&*tube, [-5.0, 0.0, 1.25], [1.0, 0.0, 0.0]), None),
        ("beside it", hit(&*tube, [-5.0, 1.0001, 0.0], [1.0, 0.0, 0.0]), None),
        ("tangential", hit(&*tube, [-5.0, 1.0, 0.0], [1.0, 0.0, 0.0]), Some(5.0)),
        ("into a half cylinder through its open side", hit(&*half, [0.0, -5.0, 0.0], [0.0, 1.0, 0.0]), Some(6.0)),
        ("on its closed side", hit(&*half, [0.0, 5.0, 0.0], [0.0, -1.0, 0.0]), Some(4.0)),
        ("down on the apex of a cone", hit(&*hat, [0.0, 0.0, 5.0], [0.0, 0.0, -1.0]), Some(3.0)),
        ("up to the apex", hit(&*hat, [0.0, 0.0, -5.0], [0.0, 0.0, 1.0]), Some(7.0)),
        ("across the cone", hit(&*hat, [-5.0, 0.0, 1.0], [1.0, 0.0, 0.0]), Some(4.5)),
        ("through the cone's reflection in its apex", hit(&*hat, [-5.0, 0.0, 3.0], [1.0, 0.0, 0.0]), None),
        ("parallel to a line of the cone", hit(&*hat, [0.0, 0.0, 0.0], [-0.25, 0.0, 0.5]), Some(2.0)),
        ("into a bowl from above", hit(&*bowl, [0.0, 0.0, 5.0], [0.0, 0.0, -1.0]), Some(6.0)),
        ("on a bowl from below", hit(&*bowl, [0.0, 0.0, -5.0], [0.0, 0.0, 1.0]), Some(4.0)),
        ("through the missing half", hit(&*bowl, [-5.0, 0.0, 0.25], [1.0, 0.0, 0.0]), None),
        ("through the hole of a ring", hit(&*ring, [0.25, 0.25, 5.0], [0.0, 0.0, -1.0]), None),
        ("on the ring", hit(&*ring, [-0.5, 0.5, 5.0], [0.0, 0.0, -1.0]), Some(5.0)),
        ("through its missing quarter", hit(&*ring, [0.5, -0.5, 5.0], [0.0, 0.0, -1.0]), None),
        ("in its plane", hit(&*ring, [-5.0, 0.0, 0.0], [1.0, 0.0, 0.0]), None),
        // z = x y.
        ("down on a saddle", hit(&*saddle, [0.5, 0.5, 5.0], [0.0, 0.0, -1.0]), Some(4.75)),
        ("up to it", hit(&*saddle, [-0.5, 0.5, -5.0], [0.0, 0.0, 1.0]), Some(4.75)),
        ("along a diagonal, in and out", hit(&*saddle, [-2.0, -2.0, 0.25], [0.5, 0.5, 0.0]), Some(3.0)),
        ("beside the saddle", hit(&*saddle, [1.25, 0.0, 5.0], [0.0, 0.0, -1.0]), None),
    ];
    for (name, found, expected) in cases {
        match (found, expected) {
            (Some(found), Some(expected)) => {
                assert!((found - expected).abs() <= 4.0 * f32::EPSILON * expected, "{name}: {found}, not {expected}")
            }
            _ => assert_eq!(found, expected, "{name}"),
        }
    }
}

/// A small thing far away is hit where it is, and not beside it, by rays of which only one in 10⁶ widths of it is known.
#[test]
fn small_and_distant_shapes_keep_their_digits() {
    for kind in kinds() {
        let scale = Transform::scale(DVec3::splat(0.1)).expect("not zero");
        let shape = kind.bake(&scale);
        for (u, v) in (0..64).map(|k| (0.1 + 0.1 * f64::from(k % 8), 0.1 + 0.1 * f64::from(k / 8))) {
            let target = scale.point((kind.point)(u, v)).as_vec3();
            for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                let origin = target - target * axis * axis - axis * 1e7;
                let ray = Ray::new(origin, axis);
                let near = Ray::new(origin + axis * (1e7 - 1.0), axis);
                let distant = shape.intersect(0, &ray).map(|hit| hit.t);
                let expected = shape.intersect(0, &near);
                // Where the near ray hits, the same line hits from afar, and the distance is within the spacing of f32 there.
                assert_eq!(distant.is_some(), expected.is_some(), "{} from {axis} at {target}", kind.name);
                assert!(distant.is_none_or(|t| (t - 1e7).abs() <= 1.0), "{}: {distant:?}", kind.name);
            }
        }
    }
}

/// Everything scales exactly by powers of two: hits, points, samples and densities.
#[test]
fn scale_is_exact() {
    for (k, kind) in kinds().into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        let place = skewed(&mut random).then(&Transform::translate(random.in_cube()).expect("finite"));
        let shape = kind.bake(&place);
        for factor in [2f32.powi(-20), 2f32.powi(20)] {
            let grown = kind.bake(&place.then(&Transform::scale(DVec3::splat(factor.into())).expect("not zero")));
            assert_eq!(grown.area(0), shape.area(0) * factor * factor, "{}", kind.name);
            for _ in 0..2000 {
                let u = random.square();
                let ((point, pdf), (far, far_pdf)) = (shape.sample_area(0, u), grown.sample_area(0, u));
                assert_eq!(
                    (far.p, far.offset, far.ng, far.uv),
                    (point.p * factor, point.offset * factor, point.ng, point.uv),
                    "{}",
                    kind.name
                );
                assert_eq!(far_pdf.get() * (factor * factor), pdf.get(), "{}", kind.name);
                let origin = (random.direction() * 5.0).as_vec3();
                let direction = (point.p - origin).normalize();
                let (near, far) = (Ray::new(origin, direction), Ray::new(origin * factor, direction));
                let (hit, grown_hit) = (shape.intersect(0, &near), grown.intersect(0, &far));
                assert_eq!(grown_hit.map(|hit| (hit.t, hit.uv)), hit.map(|hit| (hit.t * factor, hit.uv)), "{}", kind.name);
                let Some((hit, grown_hit)) = hit.zip(grown_hit) else { continue };
                let (a, b) = (shape.point(0, &near, &hit), grown.point(0, &far, &grown_hit));
                assert_eq!((b.p, b.offset, b.ng, b.uv), (a.p * factor, a.offset * factor, a.ng, a.uv), "{}", kind.name);
            }
        }
    }
}

/// The box contains all points, and points reach each of its sides.
#[test]
fn bounds_are_tight() {
    for (k, kind) in kinds().into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        for _ in 0..20 {
            let place = skewed(&mut random).then(&Transform::translate(random.in_cube()).expect("finite"));
            let (low, high) = kind.geometry.bounds(&place);
            let points: Vec<DVec3> = (0..=300)
                .flat_map(|i| (0..=300).map(move |j| (f64::from(i) / 300.0, f64::from(j) / 300.0)))
                .map(|(u, v)| place.point((kind.point)(u, v)))
                .collect();
            let (least, most) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
            assert!(
                (low - 1e-12).cmple(least).all() && (high + 1e-12).cmpge(most).all(),
                "{}: {low} {high}, not {least} {most}",
                kind.name
            );
            // Half a step of 1/300 of a turn from the farthest point: 2 (1 − cos 0.6°) < 2·10⁻⁴; twice that for both directions.
            assert!((least - low).max(high - most).max_element() < 4e-4, "{}: {low} {high}, not {least} {most}", kind.name);
        }
    }
}
