//! Points of the surface: their places, normals, texture coordinates and densities, and the light of lamps.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, DVec4, Vec2, Vec3, Vec4Swizzles as _};
use pt::accel;
use pt::bsdf::Material;
use pt::math::{Ray, Transform};
use pt::shape::curves::Basis;
use pt::shape::{Curves, Geometry, Quad, Shape, SurfacePoint};
use pt::torture::meshes::shapes;
use pt::world::World;

use super::hits::height;
use super::{BASES, RibbonSpline, Spline, random_spline};
use crate::random::Random;
use crate::scenes::{Depth, Effort, KnownRadiance, black, confirm, facing, glow, gray, probe, stored, two_sided};

/// Sampled points of smooth tubes lie on the surface of the balls or within it, and their normals point away from it. Hidden points are
/// those of ends and of sharp bends.
#[test]
fn points_lie_on_the_surface() {
    for seed in 0..32 {
        let mut random = Random::new(seed);
        let spline = random_spline(BASES[seed as usize % 4], &mut random);
        let tube = spline.tube();
        let (mut seen, mut hidden) = (0, 0);
        for i in 0..tube.count() {
            for _ in 0..40 {
                let (point, _) = tube.sample_area(i, random.uniform_square());
                let above = height(&spline, point.p.as_dvec3());
                let further = height(&spline, point.p.as_dvec3() + point.ng.as_dvec3() * 1e-3);
                // Points are rounded to f32.
                assert!(above < 4.0 * f64::from(f32::EPSILON), "{seed}: {above:e} above the surface");
                if above.abs() < 1e-6 && (further - 1e-3).abs() < 1e-5 { seen += 1 } else { hidden += 1 }
            }
        }
        assert!(hidden * 4 < seen, "{seed}: {hidden} hidden, {seen} seen");
    }
}

/// The point of the surface nearest to a point beside it, by a ray along the normal.
fn near(shape: &dyn Shape, i: u32, from: &SurfacePoint, p: Vec3) -> Option<(SurfacePoint, Vec2)> {
    let ray = Ray::new(p + from.ng * 0.01, -from.ng);
    let hit = shape.intersect(i, &ray).filter(|hit| hit.t < 0.02)?;
    Some((shape.point(i, &ray, &hit), hit.uv))
}

/// Curves among others are what they are alone, also if they have different numbers of points, among them numbers that are too small for a curve
/// or too great for its last span.
#[test]
fn curves_among_others_are_what_they_are_alone() {
    for basis in BASES {
        let mut random = Random::new(11);
        let counts: Vec<u32> = (0..100).map(|_| 1 + random.below(12) as u32).collect();
        let splines: Vec<Curves> = counts
            .iter()
            .map(|&count| {
                let points = (0..count).map(|_| random.in_cube().extend(random.range(0.1, 0.2)).as_vec4()).collect();
                Curves { basis, points, counts: vec![count], normals: (0..count).map(|_| random.direction().as_vec3()).collect() }
            })
            .collect();
        for is_tube in [true, false] {
            let normals = |of: &Curves| if is_tube { vec![] } else { of.normals.clone() };
            let all = Curves {
                basis,
                points: splines.iter().flat_map(|one| one.points.clone()).collect(),
                counts: counts.clone(),
                normals: splines.iter().flat_map(normals).collect(),
            };
            let whole = all.bake(&Transform::IDENTITY).expect("curves");
            let mut i = 0;
            for one in &splines {
                let alone = Curves { normals: normals(one), ..one.clone() }.bake(&Transform::IDENTITY).expect("a curve");
                for k in 0..alone.count() {
                    let u = random.square();
                    assert_eq!((alone.bounds(k), alone.sample_area(k, u)), (whole.bounds(i), whole.sample_area(i, u)), "{basis:?} {i} {k}");
                    i += 1;
                }
            }
            assert_eq!(i, whole.count(), "{basis:?}");
        }
    }
}

/// A ribbon's normal is on the side of the given ones, in mirrored ribbons too.
#[test]
fn ribbons_face_their_normals() {
    for seed in 0..16 {
        let mut random = Random::new(seed);
        let ribbon = RibbonSpline::random(BASES[seed as usize % 4], &mut random);
        let normals: Vec<Vec3> = ribbon.normal.points.iter().map(|p| p.xyz().as_vec3()).collect();
        for mirror in [1.0, -1.0] {
            let place = Transform::scale(DVec3::new(mirror, 1.0, 1.0)).expect("not zero");
            let shape = Curves { normals: normals.clone(), ..ribbon.centre.curves() }.bake(&place).expect("a ribbon");
            let pieces = f64::from(shape.count());
            for i in 0..shape.count() {
                let u = random.uniform_square();
                let (point, _) = shape.sample_area(i, u);
                let normal = ribbon.normal.at((f64::from(i) + f64::from(u.x)) / pieces).xyz();
                let facing = place.normal(normal).as_vec3().dot(point.ng);
                assert!(facing > 0.0, "{seed} {i} {mirror}: {facing}");
            }
        }
    }
}

/// The derivatives and the change of the normal are those of neighbouring points. Steps are 1/512 of the radius; the error of the difference
/// is the square of the step times the third derivative, and rounding divided by the step.
#[test]
fn derivatives_are_those_of_neighbouring_points() {
    let (mut checked, mut turned) = (0, 0);
    for seed in 0..64 {
        let mut random = Random::new(seed);
        let ribbon = RibbonSpline::random(BASES[seed as usize % 4], &mut random);
        for (shape, is_tube) in [(ribbon.centre.tube(), true), (ribbon.shape(), false)] {
            for i in 0..shape.count() {
                for _ in 0..40 {
                    let (point, _) = shape.sample_area(i, random.uniform_square());
                    let Some((point, uv)) = near(&*shape, i, &point, point.p) else { continue };
                    let Some(tangents) = shape.tangents(i, &point, 0.0) else { continue };
                    assert!(tangents.iter().all(|t| t.dot(point.ng).abs() <= 2e-5 * t.length()), "{seed} {is_tube}");
                    let outside = tangents[0].cross(tangents[1]).dot(point.ng);
                    assert!(outside > 0.0, "{seed} {is_tube}: {tangents:?}");
                    for (k, tangent) in tangents.into_iter().enumerate() {
                        let step = 2e-3 * 0.05;
                        let along = tangent.normalize() * step;
                        let (Some((before, _)), Some((after, _))) =
                            (near(&*shape, i, &point, point.p - along), near(&*shape, i, &point, point.p + along))
                        else {
                            continue;
                        };
                        let found = (after.uv - before.uv) / (2.0 * step) * tangent.length();
                        // The angle begins again after a turn.
                        if found.abs().max_element() > 10.0 {
                            continue;
                        }
                        let expected = if k == 0 { Vec2::X } else { Vec2::Y };
                        let error = (found - expected).length();
                        assert!(error < 0.03, "{seed} {is_tube} {i} {k}: {found}, not {expected} at {point:?}");
                        checked += 1;
                        let Some(change) = shape.normal_change(i, uv, &point, along, 0.0) else { continue };
                        let moved = (after.ng - before.ng) * 0.5;
                        assert!((moved - change).length() <= 1e-4 + 0.03 * change.length(), "{seed} {k}: {moved}, not {change}");
                        turned += 1;
                    }
                }
            }
        }
    }
    assert!(checked > 5000 && turned > 2500, "{checked} and {turned}");
}

/// v runs from 0 at the first end to 1 at the last one, in proportion to the parameter. Around a straight tube, u is the angle from the same
/// direction everywhere, also for a tube that turns back and forth between.
#[test]
fn texture_coordinates_are_those_of_the_documentation() {
    for basis in BASES {
        let mut random = Random::new(7);
        let spline = random_spline(basis, &mut random);
        let tube = accel::build(shapes(vec![spline.tube()]));
        let shape = spline.tube();
        for k in 1..40 {
            // Not at kinks.
            let v = (f64::from(k) + 0.25) / 40.5;
            let b = spline.at(v);
            let tangent = (spline.at(v + 1e-5) - spline.at(v - 1e-5)).xyz();
            let side = tangent.cross(random.direction()).normalize();
            let ray = Ray::new((b.xyz() + side * (b.w + 0.01)).as_vec3(), -side.as_vec3());
            let Some(hit) = tube.intersect(&ray).filter(|hit| hit.t < 0.03) else { continue };
            let found = shape.point(hit.primitive, &ray, &pt::shape::ShapeHit { t: hit.t, uv: hit.uv }).uv;
            // The circle in which the ball touches the surface is up to r′ r/|c′|² ≈ .02 further along where the radius changes.
            assert!((f64::from(found.y) - v).abs() < 0.05, "{basis:?}: {found}, not {v}");
        }
    }
    // There and back in a plane: the angle of a direction perpendicular to the plane does not change.
    let points = [[0.0, 0.0, 0.0], [1.0, 0.5, 0.0], [2.0, -0.5, 0.0], [3.0, 0.0, 0.0]].map(|[x, y, z]| DVec4::new(x, y, z, 0.1));
    let tube = Spline { basis: Basis::CatmullRom, points: points.to_vec() }.tube();
    let whole = accel::build(shapes(vec![Spline { basis: Basis::CatmullRom, points: points.to_vec() }.tube()]));
    let angles: Vec<f32> = (1..30)
        .map(|k| {
            let p = Spline { basis: Basis::CatmullRom, points: points.to_vec() }.at(f64::from(k) / 30.0).xyz().as_vec3();
            let ray = Ray::new(p + Vec3::Z, Vec3::NEG_Z);
            let hit = whole.intersect(&ray).expect("a hit");
            tube.point(hit.primitive, &ray, &pt::shape::ShapeHit { t: hit.t, uv: hit.uv }).uv.x
        })
        .collect();
    assert!(angles.iter().all(|angle| (angle - angles[0]).abs() < 1e-5), "{angles:?}");
}

/// Areas by formulas: a capsule, a frustum of a cone between two balls, and part of a torus by Pappus's theorem.
#[test]
fn areas_are_those_of_formulas() {
    let area = |basis: Basis, points: Vec<DVec4>| {
        let tube = Spline { basis, points }.tube();
        (0..tube.count()).map(|i| f64::from(tube.area(i))).sum::<f64>()
    };
    let capsule = area(Basis::Linear, vec![DVec4::new(0.0, 0.0, 0.0, 0.5), DVec4::new(3.0, 4.0, 0.0, 0.5)]);
    assert!((capsule / (TAU * 0.5 * 5.0 + 4.0 * PI * 0.25) - 1.0).abs() < 1e-6, "{capsule}");
    // Radii 1 and .4 at a distance of 2: sin α = .3. The frustum touches the balls in circles of radius r cos α, and has the slant √(4 − .36).
    let cone = area(Basis::Linear, vec![DVec4::new(0.0, 0.0, 0.0, 1.0), DVec4::new(0.0, 2.0, 0.0, 0.4)]);
    let (sin, cos) = (0.3, 0.91f64.sqrt());
    let expected = PI * 1.4 * cos * (2.0 * cos) + TAU * (1.0 + sin) + TAU * 0.16 * (1.0 - sin);
    assert!((cone / expected - 1.0).abs() < 1e-6, "{cone}, not {expected}");
    // A Bézier curve within 3·10⁻⁴ of a quarter of a circle of radius 1, by the usual constant.
    let k = 0.5522847498;
    let bend = [[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]].map(|[x, y]| DVec4::new(x, y, 0.0, 0.2));
    let torus = area(Basis::Bezier, bend.to_vec());
    let expected = TAU * 0.2 * (PI / 2.0) + 4.0 * PI * 0.04;
    assert!((torus / expected - 1.0).abs() < 1e-3, "{torus}, not {expected}");
}

/// The density of a point is the share of the random numbers that lead to the area around it: areas of small triangles of samples.
#[test]
fn samples_have_the_stated_density() {
    for seed in 0..48 {
        let mut random = Random::new(seed);
        let ribbon = RibbonSpline::random(BASES[seed as usize % 4], &mut random);
        for shape in [ribbon.centre.tube(), ribbon.shape()] {
            for i in 0..shape.count() {
                for _ in 0..50 {
                    let u = random.uniform_square() * 0.99;
                    let step = 1.0 / 512.0;
                    let [a, b, c, d] = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(|corner| shape.sample_area(i, u + corner * step));
                    let middle = shape.sample_area(i, u + 0.5 * step).0;
                    let [p, q, r, s] = [a, b, c, d].map(|(point, _)| point.p.as_dvec3());
                    let area = 0.5 * (r - p).cross(s - q).length();
                    let share = area * f64::from(shape.area_pdf(i, &middle).get());
                    let expected = f64::from(step * step);
                    // Cells across the border between the tube and the ball that closes it have two densities.
                    let is_one = [a, b, c, d].iter().all(|(_, pdf)| (pdf.get() / a.1.get() - 1.0).abs() < 0.1);
                    // Tapered tubes and bent ones differ within a cell by some percent; a point is rounded by 10⁻⁷ of a cell of 10⁻⁴.
                    assert!(!is_one || (share / expected - 1.0).abs() < 0.05, "{seed} {i} {u}: {}", share / expected);
                    let found = shape.area_coordinates(i, &middle).expect("an inverse");
                    let aside = (found - (u + 0.5 * step)).abs();
                    let aside = Vec2::new(aside.x, aside.y.min(1.0 - aside.y));
                    assert!(!is_one || aside.max_element() < 2e-3, "{seed} {i}: {found}, not {u}");
                    let (point, pdf) = shape.sample_area(i, u);
                    let again = shape.area_pdf(i, &point).get();
                    assert!(!is_one || (again / pdf.get() - 1.0).abs() < 1e-3, "{seed} {i}: {again}, not {}", pdf.get());
                }
            }
        }
    }
}

/// A tile below a lamp that is a tube or a ribbon of radiance 1 gets the light that small pieces of its surface send: Σ cos θ cos θ′ dA / d²
/// over what is seen of them. The tube is a bend of Catmull and Rom's curves, and a line with a kink; the ribbon shines on the side of its
/// normals, or, turned away from the tile, on both.
#[test]
fn lamps_light_by_their_area() {
    let bend = Spline {
        basis: Basis::CatmullRom,
        points: vec![
            DVec4::new(-0.6, 0.9, 0.1, 0.05),
            DVec4::new(-0.2, 1.1, -0.2, 0.1),
            DVec4::new(0.2, 0.8, 0.2, 0.12),
            DVec4::new(0.6, 1.0, 0.0, 0.04),
        ],
    };
    let kink = Spline {
        basis: Basis::Linear,
        points: vec![DVec4::new(-0.5, 1.0, 0.0, 0.1), DVec4::new(0.1, 0.7, 0.0, 0.2), DVec4::new(0.4, 1.1, 0.3, 0.05)],
    };
    let normals = [[0.0, -1.0, 0.1], [0.1, -1.0, 0.0], [-0.2, -1.0, 0.3], [0.0, -1.0, 0.0]].map(Vec3::from).to_vec();
    let away = Curves { normals: normals.iter().map(|n| -n).collect(), ..bend.curves() };
    let flat = Curves { normals, ..bend.curves() };
    let lamps =
        [("bend", bend.curves(), false), ("kink", kink.curves(), false), ("ribbon", flat, false), ("ribbon, both sides", away, true)];
    let laws = lamps.into_iter().map(|(name, curves, on_both)| {
        let shape = curves.bake(&Transform::IDENTITY).expect("curves");
        let expected = irradiance(&curves, &*shape, on_both) / PI;
        assert!(expected > 0.03, "{name}: the lamp faces the tile");
        let mut world = World::builder(probe(DVec3::new(3f64.sqrt(), 1.0, 0.0) * 0.002, DVec3::ZERO));
        let white = world.material(Material::diffuse(stored(gray(1.0))));
        world.shape(Quad { size: [0.002; 2] }, facing(DVec3::ZERO, DVec3::Y), white, None);
        let dark = world.material(black());
        world.shape(curves, Transform::IDENTITY, dark, if on_both { two_sided(1.0) } else { glow(1.0) });
        KnownRadiance::new(name.to_owned(), world, expected, Depth { max: 1, roulette: u32::MAX }).resolution(3e-3, 6e-3).by_chance(1e-2)
    });
    confirm(laws.collect(), Effort::Standard);
}

/// Irradiance at the origin on a tile that faces +y, by the light of the directions in which the lamp is seen: ∫ cos θ dω, by 400 × 400
/// directions that are uniform in the projected solid angle. Where the lamp is seen, its radiance is 1.
///
/// - `on_both`: whether both sides of a ribbon shine, or that of its normal alone
fn irradiance(curves: &Curves, shape: &dyn Shape, on_both: bool) -> f64 {
    const N: u32 = 400;
    let whole = accel::build(shapes(vec![curves.bake(&Transform::IDENTITY).expect("curves")]));
    let seen = |k: u32| {
        let (x, y) = (f64::from(k % N) + 0.5, f64::from(k / N) + 0.5);
        let (r, phi) = ((x / f64::from(N)).sqrt(), TAU * y / f64::from(N));
        let w = DVec3::new(r * phi.cos(), (1.0 - r * r).sqrt(), r * phi.sin());
        let ray = Ray::new(Vec3::ZERO, w.as_vec3());
        let hit = whole.intersect(&ray);
        hit.is_some_and(|hit| {
            let point = shape.point(hit.primitive, &ray, &pt::shape::ShapeHit { t: hit.t, uv: hit.uv });
            on_both || point.ng.dot(ray.direction) < 0.0
        })
    };
    use rayon::prelude::*;
    PI * (0..N * N).into_par_iter().filter(|k| seen(*k)).count() as f64 / f64::from(N * N)
}
