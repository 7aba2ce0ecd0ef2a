//! Hits are on the surface of the balls, and of the lines across a ribbon.

use glam::{DVec3, Vec2, Vec3, Vec4Swizzles as _};
use pt::accel::{self, List};
use pt::math::{Aabb, AreaPdf, Ray, Transform};
use pt::primitive::{Hit, Primitive as _};
use pt::shape::curves::Basis;
use pt::shape::{Capsule, Curves, Facet, Geometry, Shape, ShapeHit, SurfacePoint};
use pt::torture::meshes::{baked, mesh, shapes};
use rayon::prelude::*;

use super::{BASES, EXTENT, RibbonSpline, Spline, random_spline};
use crate::random::Random;

/// Number of balls along a curve that stand for all of them.
const BALLS: u32 = 2000;

/// The parts of a ray within the ball at a share of the curve.
fn within(spline: &Spline, u: f64, ray: &Ray) -> Option<[f64; 2]> {
    let (b, d) = (spline.at(u), ray.direction.as_dvec3());
    let o = ray.origin.as_dvec3() - b.xyz();
    let middle = -o.dot(d) / d.length_squared();
    let h = b.w * b.w - (o + d * middle).length_squared();
    (h > 0.0).then(|| [middle - (h / d.length_squared()).sqrt(), middle + (h / d.length_squared()).sqrt()])
}

/// The parts of a ray within any ball, joined.
fn parts(spline: &Spline, ray: &Ray) -> Vec<[f64; 2]> {
    let mut parts: Vec<[f64; 2]> = (0..=BALLS).filter_map(|k| within(spline, f64::from(k) / f64::from(BALLS), ray)).collect();
    parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut joined: Vec<[f64; 2]> = vec![];
    for part in parts {
        match joined.last_mut() {
            Some(last) if part[0] <= last[1] => last[1] = last[1].max(part[1]),
            _ => joined.push(part),
        }
    }
    joined
}

/// Greatest depth of a ray below the surface (m): by how much it passes nearer to the curve than the radius.
fn depth(spline: &Spline, ray: &Ray) -> f64 {
    let d = ray.direction.as_dvec3();
    let depth = |u: f64| {
        let b = spline.at(u);
        let o = ray.origin.as_dvec3() - b.xyz();
        b.w - (o - d * (o.dot(d) / d.length_squared())).length()
    };
    (0..=BALLS).map(|k| depth(f64::from(k) / f64::from(BALLS))).fold(f64::NEG_INFINITY, f64::max)
}

/// Distance of a point above the surface of the balls (m), negative below. The nearest of many places is improved by halving steps.
pub(super) fn height(spline: &Spline, p: DVec3) -> f64 {
    let height = |u: f64| {
        let b = spline.at(u.clamp(0.0, 1.0));
        (p - b.xyz()).length() - b.w
    };
    let places = (0..=BALLS).map(|k| f64::from(k) / f64::from(BALLS));
    let mut best = places.min_by(|a, b| height(*a).total_cmp(&height(*b))).expect("some");
    let mut step = 1.0 / f64::from(BALLS);
    for _ in 0..40 {
        let next = [best - step, best + step].into_iter().find(|u| height(*u) < height(best));
        match next {
            Some(next) => best = next,
            None => step *= 0.5,
        }
    }
    height(best)
}

/// Balls 1/2000 of a curve apart bulge by (1.6/2000)²/(8 · .02) < 10⁻⁵ more than all balls do.
const BULGE: f64 = 1e-5;

/// Rays from outside meet a tube where they enter its first ball. Those that pass less than 10⁻⁴ below the surface may be missed here: the
/// few balls leave gaps.
#[test]
fn tubes_are_entered_where_the_first_ball_is() {
    let hits: usize = (0..240u64).into_par_iter().map(|seed| enter(BASES[seed as usize % 4], seed)).sum();
    assert!(hits > 12_000, "{hits}");
}

fn enter(basis: Basis, seed: u64) -> usize {
    let mut random = Random::new(seed);
    let spline = random_spline(basis, &mut random);
    let tube = accel::build(shapes(vec![spline.tube()]));
    let mut hits = 0;
    for _ in 0..100 {
        let origin = (random.direction() * EXTENT * random.decade(0.0, 3.0)).as_vec3();
        let b = spline.at(random.unit());
        let target = b.xyz() + random.direction() * (b.w * random.range(0.0, 1.3));
        let ray = Ray::new(origin, (target - origin.as_dvec3()).normalize().as_vec3());
        let found = tube.intersect(&ray);
        let expected = parts(&spline, &ray).first().map(|part| part[0]);
        match (found, expected) {
            (Some(hit), Some(expected)) => {
                let p = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(hit.t);
                let above = height(&spline, p);
                // The rounding of t moves the point along the ray.
                let rounding = 2f64.powi(-22) * f64::from(hit.t);
                assert!(above.abs() <= rounding, "{basis:?} {seed}: a hit {above:e} above the surface, {spline:?} {ray:?}");
                assert!(f64::from(hit.t) <= expected + rounding, "{basis:?} {seed}: {} lies behind {expected}, {spline:?} {ray:?}", hit.t);
                hits += 1;
            }
            (None, None) => {}
            _ => assert!(depth(&spline, &ray).abs() < 1e-4, "{basis:?} {seed}: {found:?}, not {expected:?}: {spline:?} {ray:?}"),
        }
    }
    hits
}

/// Rays that start within a tube leave it where they leave the last of the balls that follow one another, and meet nothing within.
#[test]
fn tubes_are_left_where_the_last_ball_is() {
    let hits: usize = (0..240u64).into_par_iter().map(|seed| leave(BASES[seed as usize % 4], seed)).sum();
    assert!(hits > 23_000, "{hits}");
}

fn leave(basis: Basis, seed: u64) -> usize {
    let mut random = Random::new(seed);
    let spline = random_spline(basis, &mut random);
    let tube = accel::build(shapes(vec![spline.tube()]));
    let mut hits = 0;
    for _ in 0..100 {
        let u = random.unit();
        let b = spline.at(u);
        let origin = (b.xyz() + random.direction() * (b.w * random.range(0.0, 0.9))).as_vec3();
        // Along the tube, or in any direction.
        let along = (spline.at((u + 0.01).min(1.0)) - spline.at((u - 0.01).max(0.0))).xyz().normalize();
        let direction = if random.unit() < 0.5 { random.direction() } else { (along + 0.3 * random.in_cube()).normalize() };
        let ray = Ray::new(origin, direction.as_vec3());
        let expected = parts(&spline, &ray).into_iter().find(|part| part[0] <= 0.0 && part[1] >= 0.0);
        let Some([_, expected]) = expected else { continue };
        let hit = tube.intersect(&ray).unwrap_or_else(|| panic!("{basis:?} {seed}: no way out, not {expected}: {spline:?} {ray:?}"));
        let t = f64::from(hit.t);
        // The few balls end before all of them do, where the ray nearly grazes the tube by far.
        let p = ray.origin.as_dvec3() + ray.direction.as_dvec3() * t;
        let above = height(&spline, p);
        assert!(above.abs() < 1e-6, "{basis:?} {seed}: {above:e} above the surface at {t}, not {expected}: {spline:?} {ray:?}");
        assert!(t >= expected - BULGE, "{basis:?} {seed}: {t} lies before {expected}: {spline:?} {ray:?}");
        let slack = parts(&spline, &ray).iter().any(|part| (part[1] - t).abs() < 1e-2);
        assert!(slack || t <= expected + 1e-2, "{basis:?} {seed}: {t} lies behind {expected}");
        hits += 1;
    }
    hits
}

/// No ray passes between two pieces: rays at the circles in which pieces meet, from outside, from all around, and with rounded targets.
#[test]
fn joints_are_closed() {
    let missed: usize = (0..400u64).into_par_iter().map(|seed| joints(BASES[seed as usize % 4], seed)).sum();
    assert_eq!(missed, 0, "of 400,000 rays");
}

fn joints(basis: Basis, seed: u64) -> usize {
    let mut random = Random::new(seed);
    let spline = random_spline(basis, &mut random);
    let tube = accel::build(shapes(vec![spline.tube()]));
    let parts = 4 * spline.spans();
    let missed = (0..1000).filter(|_| {
        let u = (1 + random.below(parts - 1)) as f64 / parts as f64;
        let b = spline.at(u);
        let along = (spline.at(u + 1e-6) - spline.at(u - 1e-6)).xyz().normalize();
        let side = along.cross(random.direction()).normalize();
        // A point in the plane between two pieces, and a ray in that plane or across it.
        let target = b.xyz() + side * (b.w * random.pick(&[0.0, 0.5, 0.9, 0.99]));
        let direction = if random.unit() < 0.5 { along.cross(random.direction()) } else { random.direction() }.normalize();
        let origin = (target - direction * EXTENT * 2.0).as_vec3();
        tube.intersect(&Ray::new(origin, (target - origin.as_dvec3()).normalize().as_vec3())).is_none()
    });
    missed.count()
}

/// Rays along the axis of a straight tube, through the ends, at kinks, and beside.
#[test]
fn special_rays_have_the_hits_of_geometry() {
    let tube = |points: &[[f32; 4]]| {
        let points: Vec<_> = points.iter().map(|p| (*p).into()).collect();
        let curves = Curves { basis: Basis::Linear, counts: vec![points.len() as u32], points, normals: vec![] };
        accel::build(shapes(vec![curves.bake(&Transform::IDENTITY).expect("a curve")]))
    };
    let straight = tube(&[[0.0, 0.0, 0.0, 0.5], [0.0, 0.0, 2.0, 0.5], [0.0, 0.0, 3.0, 0.5]]);
    let corner = tube(&[[-2.0, 0.0, 0.0, 0.5], [0.0, 0.0, 0.0, 0.5], [0.0, -2.0, 0.0, 0.5]]);
    // The ball of radius 1 at 0 and that of radius 0 at 2 span a cone with the half angle 30°.
    let cone = tube(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 2.0, 0.0]]);
    let hit = |shape: &dyn pt::primitive::Primitive, origin: [f32; 3], direction: [f32; 3]| {
        shape.intersect(&Ray::new(origin.into(), Vec3::from(direction).normalize())).map(|hit: Hit| hit.t)
    };
    let root2 = 2f32.sqrt();
    let cases = [
        ("along the axis", hit(&*straight, [0.0, 0.0, -4.0], [0.0, 0.0, 1.0]), Some(3.5)),
        ("along the axis from within", hit(&*straight, [0.0, 0.0, 0.25], [0.0, 0.0, 1.0]), Some(3.25)),
        ("beside the axis from within", hit(&*straight, [0.0, 0.3, 0.25], [0.0, 0.0, 1.0]), Some(3.15)),
        ("across at the joint", hit(&*straight, [0.0, -4.0, 2.0], [0.0, 1.0, 0.0]), Some(3.5)),
        ("across at the joint from within", hit(&*straight, [0.0, 0.0, 2.0], [0.0, 1.0, 0.0]), Some(0.5)),
        ("tangential and outside", hit(&*straight, [0.50001, -4.0, 1.0], [0.0, 1.0, 0.0]), None),
        ("behind", hit(&*straight, [0.0, 4.0, 1.0], [0.0, 1.0, 0.0]), None),
        ("on a corner from outside", hit(&*corner, [4.0, 4.0, 0.0], [-1.0, -1.0, 0.0]), Some(4.0 * root2 - 0.5)),
        ("out of a corner", hit(&*corner, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]), Some(1.5)),
        ("out of a corner on the inside", hit(&*corner, [0.0, 0.0, 0.0], [-1.0, -1.0, 0.0]), Some(0.5 * root2)),
        ("on the tip of a cone", hit(&*cone, [0.0, 0.0, 4.0], [0.0, 0.0, -1.0]), Some(2.0)),
        // The cone z = 2 − x/tan 30° at z = 1.5: x = .5 tan 30°.
        ("across a cone", hit(&*cone, [-4.0, 0.0, 1.5], [1.0, 0.0, 0.0]), Some(4.0 - 0.5 / 3f32.sqrt())),
        ("on the ball of a cone", hit(&*cone, [0.0, 0.0, -4.0], [0.0, 0.0, 1.0]), Some(3.0)),
    ];
    for (name, found, expected) in cases {
        match (found, expected) {
            (Some(found), Some(expected)) => assert!((found - expected).abs() <= 1e-6 * expected, "{name}: {found}, not {expected}"),
            _ => assert_eq!(found, expected, "{name}"),
        }
    }
}

/// Among dense fur the hierarchy, which tests capsules around the pieces first, finds the hits that all exact tests find: the same bits, on tubes
/// and ribbons, from outside, along the skin and from afar, and the same among triangles. With capsules that are too thin it misses some.
#[test]
fn fur_is_met_where_a_test_of_all_hairs_says() {
    let ground = || mesh(vec![Vec3::new(-2.0, -0.05, -2.0), Vec3::new(2.0, -0.05, -2.0), Vec3::new(0.0, 0.01, 3.0)], vec![[0, 1, 2]]);
    let found: Vec<[usize; 2]> = (0..64u64)
        .into_par_iter()
        .map(|seed| {
            let mut random = Random::new(seed);
            let basis = BASES[seed as usize % 4];
            let mut fur = Curves { basis, points: vec![], counts: vec![4; 60], normals: vec![] };
            for _ in 0..60 {
                let (root, bend) = (random.in_cube() * DVec3::new(1.0, 0.0, 1.0), random.in_cube() * 0.3);
                let up = (DVec3::Y + 0.5 * random.in_cube()) * 0.4;
                for k in 0..4 {
                    let share = f64::from(k) / 3.0;
                    let p = root + up * share + bend * (share * share);
                    fur.points.push(p.extend(random.decade(-3.0, -1.5)).as_vec4());
                }
                if seed % 2 == 1 {
                    fur.normals.extend([random.direction().cross(up).normalize().as_vec3(); 4]);
                }
            }
            let all = || shapes(vec![fur.bake(&Transform::IDENTITY).expect("fur"), baked(ground())]);
            let (hierarchy, list) = (accel::build(all()), List::new(all()));
            let thin = accel::build(shapes(vec![Box::new(Thin(fur.bake(&Transform::IDENTITY).expect("fur"))), baked(ground())]));
            let rays = (0..2000).map(|_| {
                // Half of the rays aim at a hair.
                let hair = 4 * random.below(60);
                let of_hair = fur.points[hair + 1].lerp(fur.points[hair + 2], random.unit() as f32).as_dvec4();
                let target = match random.unit() < 0.5 {
                    true => of_hair.xyz() + random.in_cube() * (2.0 * of_hair.w),
                    false => random.in_cube() * DVec3::new(1.0, 0.2, 1.0) + DVec3::Y * 0.2,
                };
                let from = target + random.direction() * random.decade(-1.0, 4.0);
                let to = if random.unit() < 0.2 { target * DVec3::new(1.0, 1e-3, 1.0) } else { target };
                Ray::new(from.as_vec3(), (to - from).normalize().as_vec3())
            });
            let (mut hits, mut missed) = (0, 0);
            for ray in rays.collect::<Vec<_>>() {
                let (hit, expected) = (hierarchy.intersect(&ray), list.intersect(&ray));
                assert_eq!(hit, expected, "{basis:?} {seed}: {ray:?}");
                assert_eq!(hierarchy.occluded(&ray), expected.is_some(), "{basis:?} {seed}: {ray:?}");
                hits += usize::from(expected.is_some_and(|hit| hit.shape == 0));
                missed += usize::from(thin.intersect(&ray) != expected);
            }
            [hits, missed]
        })
        .collect();
    let [hits, missed] = found.iter().fold([0, 0], |a, b| [a[0] + b[0], a[1] + b[1]]);
    assert!(hits > 4_000 && missed > 10, "{hits} of 128,000 rays meet a hair; {missed} differ with thin capsules");
}

/// A shape with capsules that are too thin by three tenths.
struct Thin(Box<dyn Shape>);

impl Shape for Thin {
    fn count(&self) -> u32 {
        self.0.count()
    }

    fn bounds(&self, i: u32) -> Aabb {
        self.0.bounds(i)
    }

    fn area(&self, i: u32) -> f32 {
        self.0.area(i)
    }

    fn facet(&self, i: u32) -> Facet {
        self.0.facet(i)
    }

    fn capsule(&self, i: u32) -> Option<Capsule> {
        self.0.capsule(i).map(|capsule| Capsule { radius: 0.7 * capsule.radius, ..capsule })
    }

    fn intersect(&self, i: u32, ray: &Ray) -> Option<ShapeHit> {
        self.0.intersect(i, ray)
    }

    fn point(&self, i: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.0.point(i, ray, hit)
    }

    fn sample_area(&self, i: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        self.0.sample_area(i, u)
    }
}

/// A ribbon as a mesh of `n` × 8 cells of two triangles.
fn ribbon_mesh(ribbon: &RibbonSpline, n: u32) -> Box<dyn Shape> {
    let corner = |i: u32, j: u32| ribbon.point(f64::from(i) / f64::from(n), f64::from(j) / 8.0).as_vec3();
    let cells = (0..n).flat_map(|i| (0..8).map(move |j| (i, j)));
    let corners: Vec<Vec3> = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [a, b, c, a, c, d]
        })
        .collect();
    let triangles = (0..corners.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    baked(mesh(corners, triangles))
}

/// Rays meet a fine mesh of a ribbon at the same distances, but for a few at its sides.
#[test]
fn ribbons_are_met_where_a_fine_mesh_is() {
    let found: Vec<[usize; 2]> = (0..40u64)
        .into_par_iter()
        .map(|seed| {
            let mut random = Random::new(seed);
            let ribbon = RibbonSpline::random(BASES[seed as usize % 4], &mut random);
            let (exact, fine) = (accel::build(shapes(vec![ribbon.shape()])), accel::build(shapes(vec![ribbon_mesh(&ribbon, 2000)])));
            let (mut both, mut one) = (0, 0);
            for _ in 0..2000 {
                let target = ribbon.point(random.unit(), random.range(-0.2, 1.2));
                let origin = (random.direction() * EXTENT).as_vec3();
                let ray = Ray::new(origin, (target - origin.as_dvec3()).normalize().as_vec3());
                match (exact.intersect(&ray), fine.intersect(&ray)) {
                    // Where a ray grazes the ribbon, a small distance beside it is a large one along it.
                    (Some(a), Some(b)) if (a.t - b.t).abs() < 1e-3 => both += 1,
                    (None, None) => {}
                    _ => one += 1,
                }
            }
            [both, one]
        })
        .collect();
    let [both, one] = found.iter().fold([0, 0], |a, b| [a[0] + b[0], a[1] + b[1]]);
    assert!(both > 40_000 && one < 400, "{both} agree, {one} do not");
}

/// No ray passes between two pieces of a ribbon: rays at the lines across it in which pieces meet, of those bases that are smooth there.
#[test]
fn ribbons_are_closed_where_pieces_meet() {
    let missed: usize = (0..200u64)
        .into_par_iter()
        .map(|seed| {
            let mut random = Random::new(seed);
            let basis = [Basis::Bezier, Basis::Bspline, Basis::CatmullRom][seed as usize % 3];
            let ribbon = RibbonSpline::random(basis, &mut random);
            let shape = accel::build(shapes(vec![ribbon.shape()]));
            let parts = 4 * ribbon.centre.spans();
            let missed = (0..1000).filter(|_| {
                let u = (1 + random.below(parts - 1)) as f64 / parts as f64;
                let target = ribbon.point(u, random.range(0.05, 0.95));
                let origin = (random.direction() * EXTENT).as_vec3();
                let ray = Ray::new(origin, (target - origin.as_dvec3()).normalize().as_vec3());
                // Rays that graze the ribbon may pass it by the rounding of their direction.
                let across = ribbon.point(u, 1.0) - ribbon.point(u, 0.0);
                let along = ribbon.point((u + 1e-4).min(1.0), 0.5) - ribbon.point(u - 1e-4, 0.5);
                let cos = across.cross(along).normalize().dot(ray.direction.as_dvec3()).abs();
                cos > 0.05 && shape.intersect(&ray).is_none()
            });
            missed.count()
        })
        .sum();
    assert_eq!(missed, 0, "of 200,000 rays");
}

/// Everything scales exactly by powers of two.
#[test]
fn scale_is_exact() {
    for seed in 0..16 {
        let mut random = Random::new(seed);
        let ribbon = RibbonSpline::random(BASES[seed as usize % 4], &mut random);
        let normals: Vec<Vec3> = ribbon.normal.points.iter().map(|p| p.xyz().as_vec3()).collect();
        for curves in [ribbon.centre.curves(), Curves { normals, ..ribbon.centre.curves() }] {
            let shape = curves.bake(&Transform::IDENTITY).expect("curves");
            for factor in [2f32.powi(-20), 2f32.powi(20)] {
                let scale = Transform::scale(DVec3::splat(factor.into())).expect("not zero");
                let grown = curves.bake(&scale).expect("curves");
                for i in 0..shape.count() {
                    assert_eq!(grown.area(i), shape.area(i) * factor * factor);
                    for _ in 0..50 {
                        let u = random.square();
                        let ((point, pdf), (far, far_pdf)) = (shape.sample_area(i, u), grown.sample_area(i, u));
                        let same = |a: &SurfacePoint, b: &SurfacePoint| {
                            (b.p, b.ng, b.uv) == (a.p * factor, a.ng, a.uv) && b.offset == a.offset * factor
                        };
                        assert!(same(&point, &far), "{point:?} {far:?}");
                        assert_eq!(far_pdf.get() * (factor * factor), pdf.get());
                        let origin = (random.direction() * EXTENT).as_vec3();
                        let direction = (point.p - origin).normalize();
                        let (near, far) = (Ray::new(origin, direction), Ray::new(origin * factor, direction));
                        let (hit, grown_hit) = (shape.intersect(i, &near), grown.intersect(i, &far));
                        assert_eq!(grown_hit, hit.map(|hit| ShapeHit { t: hit.t * factor, ..hit }));
                    }
                }
            }
        }
    }
}
