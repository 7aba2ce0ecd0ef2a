//! Texture coordinates, derivatives and normals, and points that are sampled.

use glam::{DVec3, Vec2, Vec3};
use pt::math::{Ray, Transform};
use pt::proof::chi2;
use pt::shape::{BilinearPatch, Cone, Cylinder, Disk, Geometry, PartialDisk, PartialSphere, Shape, ShapeHit, Sphere, SurfacePoint};

use super::{around, kinds, saddle, skewed};
use crate::random::Random;

/// Texture coordinates as the documentation says: of a point at the share `turn` of the angle, at the share `along` of the profile.
#[test]
fn texture_coordinates_are_those_of_the_documentation() {
    let place = Transform::rotate(DVec3::new(1.0, 2.0, 3.0), 50.0).expect("an axis");
    type Row = (&'static str, Box<dyn Geometry>, fn(f64, f64) -> (DVec3, [f64; 2]));
    let rows: [Row; 5] = [
        ("cylinder", Box::new(Cylinder { radius: 0.5, z: [-0.5, 1.5], phi_max: 200.0 }), |u, v| {
            (around(u, 200.0, 0.5, -0.5 + 2.0 * v), [u, v])
        }),
        ("cone", Box::new(Cone { radius: 0.5, height: 1.5, phi_max: 200.0 }), |u, v| (around(u, 200.0, 0.5 * (1.0 - v), 1.5 * v), [u, v])),
        ("sphere", Box::new(PartialSphere { radius: 0.5, z: [-0.4, 0.4], phi_max: 90.0 }), |u, v| {
            let z = 0.8 * v - 0.4;
            (around(u, 90.0, (0.25 - z * z).sqrt(), z), [u / 4.0, (z / 0.5).acos() / std::f64::consts::PI])
        }),
        ("disk", Box::new(PartialDisk { radius: 2.0, inner_radius: 1.0, phi_max: 200.0 }), |u, v| {
            let p = around(u, 200.0, 1.0 + v, 0.0);
            (p, [0.5 + 0.25 * p.x, 0.5 + 0.25 * p.y])
        }),
        ("patch", Box::new(BilinearPatch { corners: saddle() }), |u, v| {
            let [a, b, c, d] = saddle();
            (a.lerp(b, u).lerp(c.lerp(d, u), v), [u, v])
        }),
    ];
    for (name, geometry, point) in rows {
        let shape = geometry.bake(&place).expect("an area");
        for (u, v) in (1..10).flat_map(|i| (1..10).map(move |j| (0.1 * f64::from(i), 0.1 * f64::from(j)))) {
            let (target, expected) = point(u, v);
            // From near by, so that no other part of the surface lies before the point.
            let direction = place.vector(-target - DVec3::Z * 0.3).normalize().as_vec3();
            let ray = Ray::new(place.point(target).as_vec3() - direction * 1e-3, direction);
            let hit = shape.intersect(0, &ray).unwrap_or_else(|| panic!("{name}: missed at {u} {v} by {ray:?}"));
            let found = shape.point(0, &ray, &hit).uv;
            let far = (found - Vec2::new(expected[0] as f32, expected[1] as f32)).abs().max_element();
            assert!(far < 2e-6, "{name} at {u} {v}: {found}, not {expected:?}");
        }
    }
}

/// The point of the surface nearest to a point beside it, by a ray along the normal.
fn near(shape: &dyn Shape, from: &SurfacePoint, p: Vec3) -> Option<(SurfacePoint, ShapeHit)> {
    let ray = Ray::new(p + from.ng * 0.05, -from.ng);
    let hit = shape.intersect(0, &ray).filter(|hit| hit.t < 0.1)?;
    Some((shape.point(0, &ray, &hit), hit))
}

/// The derivatives and the change of the normal are those of neighbouring points: steps of 1/512 to both sides. The error of the difference
/// is (step)² of the third derivative, up to (2π)³ where u is a turn, and the rounding of f32 divided by the step.
#[test]
fn derivatives_are_those_of_neighbouring_points() {
    const STEP: f32 = 1.0 / 512.0;
    for (k, kind) in kinds().into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        let (mut checked, mut normals) = (0, 0);
        for _ in 0..20 {
            let place = skewed(&mut random);
            let shape = kind.bake(&place);
            for _ in 0..100 {
                let (point, _) = shape.sample_area(0, random.uniform_square());
                let Some((point, hit)) = near(&*shape, &point, point.p) else { continue };
                let tangents = shape.tangents(0, &point, 0.0).expect("not at a pole");
                // Tangents lie in the surface.
                assert!(tangents.iter().all(|t| t.dot(point.ng).abs() <= 1e-5 * t.length()), "{}", kind.name);
                for (k, tangent) in tangents.into_iter().enumerate() {
                    // Near an apex or a pole the derivative changes as fast as the point moves.
                    let length = tangent.length();
                    if length < 0.3 || tangents[1 - k].length() < 0.3 {
                        continue;
                    }
                    let along = tangent / length * STEP;
                    let (Some((before, _)), Some((after, _))) =
                        (near(&*shape, &point, point.p - along), near(&*shape, &point, point.p + along))
                    else {
                        continue;
                    };
                    let found = (after.uv - before.uv) / (2.0 * STEP) * length;
                    // u of the sphere begins again.
                    if found.abs().max_element() > 10.0 {
                        continue;
                    }
                    let expected = if k == 0 { Vec2::X } else { Vec2::Y };
                    assert!((found - expected).length() < 0.02, "{} {point:?}: {found}, not {expected}", kind.name);
                    checked += 1;
                    let Some(change) = shape.normal_change(0, hit.uv, &point, along, 0.0) else { continue };
                    let moved = (after.ng - before.ng) * 0.5;
                    assert!((moved - change).length() <= 0.02 * STEP + 0.02 * change.length(), "{}: {moved}, not {change}", kind.name);
                    normals += 1;
                }
            }
        }
        assert!(checked > 1500 && normals > 1500, "{}: {checked} and {normals}", kind.name);
    }
}

/// Normals point to the outside that the formulas have, also under transforms that mirror.
#[test]
fn normals_point_outwards() {
    for (k, kind) in kinds().into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        for _ in 0..200 {
            let place = skewed(&mut random);
            let shape = kind.bake(&place);
            let (u, v) = (random.range(0.05, 0.95), random.range(0.1, 0.8));
            let at = |u: f64, v: f64| (kind.point)(u, v);
            let step = 1e-5;
            let own = (at(u + step, v) - at(u - step, v)).cross(at(u, v + step) - at(u, v - step));
            let target = place.point(at(u, v));
            let outward = place.vector(own).normalize().as_vec3();
            let ray = Ray::new(target.as_vec3() + outward * 0.01, -outward);
            let Some(hit) = shape.intersect(0, &ray) else { continue };
            let point = shape.point(0, &ray, &hit);
            let expected = place.normal(own).as_vec3();
            // The hit may be 0.01 · |tan| aside, on a surface with a radius of curvature above 0.2.
            assert!(point.ng.dot(expected) > 0.95 && point.ng == point.ns, "{}: {}, not {expected}", kind.name, point.ng);
        }
    }
}

/// Shapes that know a cone around their normals have no other normals, and the cone is no wider than they need.
#[test]
fn cones_contain_the_normals() {
    let mut known = 0;
    for (k, kind) in kinds().into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        for _ in 0..20 {
            let shape = kind.bake(&skewed(&mut random));
            let Some((axis, angle)) = shape.normal_cone(0) else { continue };
            known += 1;
            // At the corners normals are farthest from their mean.
            let last = 1.0 - f32::EPSILON / 2.0;
            let corners = [Vec2::ZERO, Vec2::new(last, 0.0), Vec2::new(0.0, last), Vec2::splat(last)];
            let numbers = (0..5000).map(|_| random.uniform_square()).chain(corners);
            let angles = numbers.map(|u| shape.sample_area(0, u).0.ng.as_dvec3().angle_between(axis));
            let farthest = angles.fold(0.0, f64::max);
            assert!(farthest <= angle + 1e-6 && farthest >= angle - 1e-3, "{}: {farthest} of {angle}", kind.name);
        }
    }
    assert!(known >= 20, "{known} cones");
}

/// Samples are distributed with the density that is stated: counts in 8 × 8 cells of the surface pass the χ² test, where the share of a cell
/// is the sum of density times area over its triangles. 33 tests with a probability of false alarms of 10⁻⁵ each.
#[test]
fn samples_have_the_stated_density() {
    const CELLS: u32 = 8;
    const FINE: u32 = 32;
    for (k, kind) in kinds().into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        for round in 0..3 {
            let place = if round == 0 { random.rotation() } else { skewed(&mut random) };
            let shape = kind.bake(&place);
            // Cells by the numbers that lead to a point, which are found again.
            let cell = |point: &SurfacePoint| {
                let at = shape.area_coordinates(0, point).expect("an inverse") * CELLS as f32;
                at.y as usize * CELLS as usize + at.x as usize
            };
            let (mut shares, mut counts) = (vec![0.0; (CELLS * CELLS) as usize], vec![0u64; (CELLS * CELLS) as usize]);
            let (mut area, mut sum) = (0.0, 0.0);
            for [a, b, c] in kind.triangles(&place, CELLS * FINE) {
                let middle = (a + b + c) / 3.0;
                let normal = (b - a).cross(c - a);
                let ng = normal.normalize().as_vec3();
                // The centroid lies beside the surface by less than 10⁻³.
                let ray = Ray::new(middle.as_vec3() + ng * 2e-3, -ng);
                area += 0.5 * normal.length();
                let Some(hit) = shape.intersect(0, &ray).filter(|hit| hit.t < 4e-3) else { continue };
                let point = shape.point(0, &ray, &hit);
                let share = f64::from(shape.area_pdf(0, &point).get()) * 0.5 * normal.length();
                shares[cell(&point)] += share;
                sum += share;
            }
            let relative = f64::from(shape.area(0)) / area;
            assert!((relative - 1.0).abs() < 2e-4, "{}: area {}, not {area}", kind.name, shape.area(0));
            assert!((sum - 1.0).abs() < 2e-3, "{}: densities add up to {sum}", kind.name);
            shares.iter_mut().for_each(|share| *share /= sum);
            for _ in 0..40_000 {
                let u = random.uniform_square();
                let (point, pdf) = shape.sample_area(0, u);
                counts[cell(&point)] += 1;
                let again = shape.area_pdf(0, &point).get();
                assert!((again / pdf.get() - 1.0).abs() < 1e-4, "{}: {again}, not {}", kind.name, pdf.get());
                let found = shape.area_coordinates(0, &point).expect("an inverse");
                // Near an apex or a pole the angle of a rounded point is not known, and after a full turn it begins again.
                let aside = (found - u).abs();
                let aside = Vec2::new(aside.x.min(1.0 - aside.x), aside.y);
                assert!(aside.y < 1e-3 && (aside.x < 1e-3 || u.y < 0.01 || u.y > 0.99), "{}: {found}, not {u}", kind.name);
            }
            let test = chi2(&shares, &counts);
            assert!(test.p > 1e-5, "{} {round}: {test:?}", kind.name);
        }
    }
}

/// What is not cut is the whole shape: the same hits, coordinates, areas and densities as the whole sphere or disk has.
#[test]
fn uncut_parts_are_whole() {
    let mut random = Random::new(1);
    let pairs: [(Box<dyn Geometry>, Box<dyn Geometry>); 2] = [
        (Box::new(PartialSphere { radius: 0.8, z: [-0.8, 0.8], phi_max: 360.0 }), Box::new(Sphere { radius: 0.8 })),
        (Box::new(PartialDisk { radius: 0.8, inner_radius: 0.0, phi_max: 360.0 }), Box::new(Disk { radius: 0.8 })),
    ];
    for (part, whole) in pairs {
        for _ in 0..20 {
            let place = skewed(&mut random);
            let [part, whole] = [&part, &whole].map(|geometry| geometry.bake(&place).expect("an area"));
            assert!((part.area(0) / whole.area(0) - 1.0).abs() < 1e-5, "{} and {}", part.area(0), whole.area(0));
            assert!((part.bounds(0).min - whole.bounds(0).min).abs().max_element() < 1e-6);
            for _ in 0..500 {
                let origin = (random.direction() * 3.0).as_vec3();
                let ray = Ray::new(origin, ((random.in_cube() * 0.5).as_vec3() - origin).normalize());
                let (a, b) = (part.intersect(0, &ray), whole.intersect(0, &ray));
                let Some((a, b)) = a.zip(b) else {
                    assert_eq!(a.is_some(), b.is_some(), "{ray:?}");
                    continue;
                };
                let (p, q) = (part.point(0, &ray, &a), whole.point(0, &ray, &b));
                let same = (p.p - q.p).length() < 1e-5 && (p.ng - q.ng).length() < 1e-4 && (p.offset / q.offset - 1.0).abs() < 0.5;
                assert!(same && (p.uv - q.uv).length() < 1e-4, "{p:?} and {q:?}");
                let densities = (part.area_pdf(0, &p).get(), whole.area_pdf(0, &q).get());
                assert!((densities.0 / densities.1 - 1.0).abs() < 1e-4, "{densities:?}");
            }
        }
    }
}

/// A flat patch is sampled uniformly by area, whatever its corners.
#[test]
fn flat_patches_are_sampled_uniformly() {
    let corners = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.5, 1.0, 0.0], [1.5, 1.5, 0.0]].map(DVec3::from);
    let patch = BilinearPatch { corners }.bake(&Transform::rotate(DVec3::ONE, 30.0).expect("an axis")).expect("an area");
    // The shoelace formula over the corners in turn.
    let turn = [corners[0], corners[1], corners[3], corners[2]];
    let area = 0.5 * (0..4).map(|k| turn[k].cross(turn[(k + 1) % 4]).z).sum::<f64>();
    assert!((f64::from(patch.area(0)) / area - 1.0).abs() < 1e-6, "{} and {area}", patch.area(0));
    let mut random = Random::new(5);
    for _ in 0..1000 {
        let (_, pdf) = patch.sample_area(0, random.square());
        assert!((f64::from(pdf.get()) * area - 1.0).abs() < 1e-5, "{}", pdf.get());
    }
}
