//! Origins of spawned rays: a ray does not hit the surface that it leaves, and its offset is not larger than necessary.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec3, Vec3};
use pt::bsdf::{Bsdf, Diffuse};
use pt::light::ShadowTarget;
use pt::math::{Ray, Spectrum, Transform};
use pt::scene::Surface;
use pt::shape::{Disk, Geometry, Quad, Shape, Sphere, SurfacePoint, VertexColor};
use rayon::prelude::*;

use crate::geometry::{baked, mesh};
use crate::random::Random;

/// Kind of a shape that is placed at random.
#[derive(Clone, Copy, Debug)]
enum Family {
    Triangle,
    Quad,
    Disk,
    Sphere,
    Ellipsoid,
}

const FAMILIES: [Family; 5] = [Family::Triangle, Family::Quad, Family::Disk, Family::Sphere, Family::Ellipsoid];

impl Family {
    /// Whether the shape is flat. A ray hits a flat shape at most once, and may hit a curved shape again on its far side.
    fn is_flat(self) -> bool {
        matches!(self, Family::Triangle | Family::Quad | Family::Disk)
    }

    /// Coordinates of the given size, or 10^U(−8, 8) each.
    fn place(self, coordinate: Option<f64>, random: &mut Random) -> (Box<dyn Shape>, f64) {
        let spread = random.decade(-1.0, 2.0);
        let mut any = || match coordinate {
            Some(c) => c + spread * random.range(-1.0, 1.0),
            None => random.decade(-8.0, 8.0) * if random.below(2) == 0 { 1.0 } else { -1.0 },
        };
        let corners = [(); 3].map(|_| DVec3::new(any(), any(), any()));
        let size = coordinate.map_or((corners[0] - corners[1]).length(), |_| spread);
        let stretch = if matches!(self, Family::Sphere) { DVec3::ONE } else { random.in_cube() * 0.9 + 1.0 };
        let place = Transform::scale(stretch * size).expect("not zero").then(&random.rotation());
        let place = place.then(&Transform::translate(corners[0]).expect("finite"));
        let shape = match self {
            // Far out, all corners may round to a line. Another shape is then tried.
            Family::Triangle if pt::shape::triangle::normal(corners.map(|c| c.as_vec3())).is_none() => {
                return self.place(coordinate, random);
            }
            Family::Triangle => return (baked(mesh(corners.map(|c| c.as_vec3()).to_vec(), vec![[0, 1, 2]])), size),
            Family::Quad => Quad { size: [1.0, 2.0] }.bake(&place),
            Family::Disk => Disk { radius: 1.0 }.bake(&place),
            Family::Sphere | Family::Ellipsoid => Sphere { radius: 1.0 }.bake(&place),
        };
        (shape.expect("an area"), size)
    }
}

fn surface(point: SurfacePoint) -> Surface<'static> {
    Surface::new(point, Bsdf::Diffuse(Diffuse { albedo: Spectrum::ONE }), None)
}

/// Point on the shape, sampled or hit by a ray.
fn point(shape: &dyn Shape, random: &mut Random) -> SurfacePoint {
    let (point, _) = shape.sample_area(0, random.square());
    if random.below(2) == 0 {
        return point;
    }
    let bounds = shape.bounds(0);
    let origin = point.p + (random.direction() * bounds.radius() as f64 * random.decade(-1.0, 1.0)).as_vec3();
    let Some(direction) = (point.p - origin).try_normalize() else { return point };
    let ray = Ray::new(origin, direction);
    shape.intersect(0, &ray).map_or(point, |hit| shape.point(0, &ray, &hit))
}

/// Whether the spawned ray hits the surface at its start.
///
/// A ray from the inside of a curved surface correctly hits its far side, which it leaves and does not enter.
fn is_false_hit(family: Family, shape: &dyn Shape, point: &SurfacePoint, ray: &Ray) -> bool {
    let Some(hit) = shape.intersect(0, ray) else { return false };
    let inwards = point.ng.dot(ray.direction) < 0.0;
    let enters = shape.point(0, ray, &hit).ng.dot(ray.direction) < 0.0;
    family.is_flat() || !inwards || (enters && hit.t <= point.offset)
}

/// 0 of 10⁷ rays hit their own surface: from both sides, at small and large coordinates, also near edges.
#[test]
fn no_self_hits() {
    const SHAPES: u64 = 100;
    const RAYS: u64 = 5_000;
    let places = [None, Some(0.0), Some(1e3), Some(1e6)];
    for (family, place) in FAMILIES.iter().flat_map(|f| places.map(|p| (*f, p))) {
        let check = |seed: u64| {
            let mut random = Random::new(seed);
            let (shape, size) = family.place(place, &mut random);
            let is_false = |_: &u64| {
                let point = point(&*shape, &mut random);
                // A shape thinner than its error bound has no inside to start from.
                if !family.is_flat() && 0.1 * size < 4.0 * point.offset as f64 {
                    return false;
                }
                let ray = surface(point).spawn(random.direction().as_vec3(), 0.0);
                is_false_hit(family, &*shape, &point, &ray)
            };
            (0..RAYS).filter(is_false).count()
        };
        let hits: usize = (0..SHAPES).into_par_iter().map(check).sum();
        assert_eq!(hits, 0, "of {} rays from {family:?} at {place:?}", SHAPES * RAYS);
    }
}

/// A sampled point of a light is visible from every point without an occluder between: neither end shadows itself.
#[test]
fn shadow_rays_end_before_the_light() {
    const PAIRS: u64 = 200;
    const RAYS: u64 = 1_000;
    for (family, place) in FAMILIES.iter().flat_map(|f| [None, Some(0.0), Some(1e3), Some(1e6)].map(|p| (*f, p))) {
        let judged = AtomicU64::new(0);
        let check = |seed: u64| {
            let mut random = Random::new(seed);
            let ((light, _), (lit, _)) = (family.place(place, &mut random), Family::Triangle.place(place, &mut random));
            let is_shadowed = |_: &u64| {
                let from = point(&*lit, &mut random);
                let Some((target, _)) = light.sample_from(0, from.p, random.square()) else { return false };
                let Some(wi) = (target.p - from.p).try_normalize() else { return false };
                // The far side of a curved light is correctly hidden by its near side.
                if !family.is_flat() && target.ng.dot(-wi) <= 0.0 {
                    return false;
                }
                // If one end lies in the plane of the other, within the error bounds, its side is unknown.
                let line = target.p.as_dvec3() - from.p.as_dvec3();
                let apart = line.dot(from.ng.as_dvec3()).abs().min(line.dot(target.ng.as_dvec3()).abs());
                let stray = 4.0 * f32::EPSILON * line.length() as f32;
                if apart <= 2.0 * (from.offset + target.offset + stray) as f64 {
                    return false;
                }
                judged.fetch_add(1, Ordering::Relaxed);
                let ray = surface(from).shadow_ray(wi, &ShadowTarget::Surface(target), 0.0);
                lit.intersect(0, &ray).is_some() || light.intersect(0, &ray).is_some()
            };
            (0..RAYS).filter(is_shadowed).count()
        };
        let hits: usize = (0..PAIRS).into_par_iter().map(check).sum();
        let judged = judged.load(Ordering::Relaxed);
        assert_eq!(hits, 0, "of {judged} shadow rays to {family:?} at {place:?}");
        assert!(judged > PAIRS * RAYS / 100, "only {judged} shadow rays to {family:?} at {place:?}");
    }
}

/// A small light at the centre of the scene has a small offset. From far away at a grazing angle, the rounding of the direction alone
/// could carry the shadow ray through it.
#[test]
fn a_small_light_far_away_does_not_shadow_itself() {
    for seed in 0..1_000_000 {
        let mut random = Random::new(seed);
        let place = random.rotation();
        let light = Quad { size: [2.0, 2.0] }.bake(&place).expect("an area");
        let (target, _) = light.sample_area(0, random.square());
        let (distance, cosine) = (random.decade(0.0, 4.0), random.decade(-3.0, 0.0));
        let across = random.direction().with_z(0.0).normalize() * (distance * (1.0 - cosine * cosine).sqrt());
        let p = place.point(across.with_z(distance * cosine)).as_vec3();
        let wi = (target.p - p).normalize();
        let from = SurfacePoint { p, offset: 0.0, ng: wi, ns: wi, uv: target.uv, color: VertexColor::WHITE };
        let ray = surface(from).shadow_ray(wi, &ShadowTarget::Surface(target), 0.0);
        assert_eq!(light.intersect(0, &ray), None, "seed {seed}: from {p} to {}", target.p);
    }
}

/// The start is at most 10⁻⁵ off the surface at coordinates of 1, 5·10⁻³ at 10³ and 5 at 10⁶, and is proportional to the coordinates.
#[test]
fn ray_offsets_are_small() {
    for (coordinate, bound) in [(0.0, 1e-5), (1e3, 5e-3), (1e6, 5.0)] {
        for seed in 0..2000 {
            let mut random = Random::new(seed);
            let corners = [(); 3].map(|_| (DVec3::splat(coordinate) + random.in_cube()).as_vec3());
            let shape = baked(mesh(corners.to_vec(), vec![[0, 1, 2]]));
            let (point, _) = shape.sample_area(0, random.square());
            let moved = surface(point).spawn(point.ng, 0.0).origin.as_dvec3() - point.p.as_dvec3();
            // Adding the offset rounds once more, by half an ulp per axis.
            let rounding = 3f64.sqrt() * 0.5 * f32::EPSILON as f64 * (coordinate + 1.0);
            assert!(moved.length() <= bound + rounding, "{} at {coordinate}", moved.length());
        }
    }
}

/// Rays between a unit sphere and a shell 4·10⁻⁵ above it hit both in turn.
#[test]
fn rays_cross_a_narrow_gap() {
    let gap = 4e-5;
    let [inner, outer] = [1.0, 1.0 + gap].map(|radius| Sphere { radius }.bake(&Transform::IDENTITY).expect("a sphere"));
    for seed in 0..100_000 {
        let mut random = Random::new(seed);
        let from = (random.direction() * random.range(2.0, 5.0)).as_vec3();
        let to = (random.direction() * random.range(0.0, 0.99)).as_vec3();
        let ray = Ray::new(from, (to - from).normalize());
        let first = outer.intersect(0, &ray).expect("aimed at the inside");
        let entered = surface(outer.point(0, &ray, &first)).spawn(ray.direction, 0.0);
        let second = inner.intersect(0, &entered).expect("the sphere within the shell");
        let far = outer.intersect(0, &entered).expect("the shell's other side");
        assert!(second.t < far.t, "seed {seed}");
        // The path through the gap is at least its width minus the offsets.
        assert!(second.t as f64 > 0.5 * gap, "seed {seed}: {}", second.t);
        // From the inner sphere outwards the ray hits the shell, not the sphere itself.
        let back = surface(inner.point(0, &entered, &second)).spawn(-ray.direction, 0.0);
        assert!(inner.intersect(0, &back).is_none(), "seed {seed}");
        assert!(outer.intersect(0, &back).is_some_and(|hit| hit.t < 1.0), "seed {seed}");
    }
}

/// A floor through the origin has no error and so no offset: the ray starts on it and does not hit it.
#[test]
fn rays_leave_exact_planes_without_an_offset() {
    let floor = Quad { size: [2.0, 2.0] }.bake(&Transform::IDENTITY).expect("an area");
    let mut random = Random::new(5);
    for _ in 0..100_000 {
        let (point, _) = floor.sample_area(0, random.square());
        assert_eq!(point.offset, 0.0);
        let ray = surface(point).spawn(random.direction().as_vec3(), 0.0);
        assert_eq!(ray.origin, Vec3::new(point.p.x, point.p.y, 0.0));
        assert_eq!(floor.intersect(0, &ray), None);
    }
}
