//! Laws of all shapes: areas, samples and densities are consistent, and transforms keep normals on the same side.

use std::f64::consts::PI;

use glam::{DVec3, Vec2, Vec3};
use pt::math::{Ray, Transform};
use pt::shape::{
    BilinearPatch, Cone, Cuboid, Cylinder, Disk, Geometry, MeshData, PartialDisk, PartialSphere, Quad, Shape, Sphere, TriangleMesh,
};

use crate::random::Random;
use pt::torture::meshes::{icosphere, mesh};

fn stretch(by: [f64; 3]) -> Transform {
    Transform::scale(DVec3::from(by)).expect("no factor is zero")
}

/// Each kind of shape: untransformed, stretched and mirrored.
fn families() -> Vec<(&'static str, Box<dyn Geometry>, Transform)> {
    let mut all = vec![];
    let mut random = Random::new(11);
    for scale in [[1.0, 1.0, 1.0], [2.0, 0.5, 1.3], [-1.0, 1.0, 1.0], [-0.7, -2.0, -1.1]] {
        let place = stretch(scale).then(&random.rotation()).then(&Transform::translate(random.in_cube()).expect("finite"));
        let triangle = TriangleMesh::new(mesh(vec![Vec3::ZERO, Vec3::X * 1.5, Vec3::new(0.3, 1.2, 0.0)], vec![[0, 1, 2]]));
        let corners = [[-0.8, -0.7, 0.1], [0.9, -0.6, -0.3], [-0.7, 0.8, -0.4], [0.6, 0.7, 0.5]].map(DVec3::from);
        let geometries: [(&str, Box<dyn Geometry>); 10] = [
            ("triangle", Box::new(triangle)),
            ("quad", Box::new(Quad { size: [1.5, 0.8] })),
            ("box", Box::new(Cuboid { size: [1.5, 0.8, 1.1] })),
            ("disk", Box::new(Disk { radius: 0.7 })),
            ("sphere", Box::new(Sphere { radius: 0.6 })),
            ("cylinder", Box::new(Cylinder { radius: 0.6, z: [-0.5, 0.7], phi_max: 250.0 })),
            ("cone", Box::new(Cone { radius: 0.6, height: 0.9, phi_max: 360.0 })),
            ("belt", Box::new(PartialSphere { radius: 0.7, z: [-0.2, 0.5], phi_max: 300.0 })),
            ("ring", Box::new(PartialDisk { radius: 0.7, inner_radius: 0.3, phi_max: 200.0 })),
            ("patch", Box::new(BilinearPatch { corners })),
        ];
        all.extend(geometries.map(|(name, geometry)| (name, geometry, place)));
    }
    all
}

fn bake((_, geometry, place): &(&str, Box<dyn Geometry>, Transform)) -> Box<dyn Shape> {
    geometry.bake(place).expect("an area")
}

/// Mean and its standard error.
fn mean(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut n, mut sum, mut square) = (0.0, 0.0, 0.0);
    for v in values {
        (n, sum, square) = (n + 1.0, sum + v, square + v * v);
    }
    let mean = sum / n;
    (mean, ((square / n - mean * mean).max(0.0) / n).sqrt())
}

/// ∫ dA / p over samples is the area. All samples are within the bounds and on the surface, and normals are unit vectors.
#[test]
fn samples_cover_the_area() {
    for family in families() {
        let shape = bake(&family);
        let mut random = Random::new(3);
        let bounds = shape.bounds(0);
        let slack = Vec3::splat(2.0 * f32::EPSILON * bounds.magnitude().max_element());
        let (area, error) = mean((0..100_000).map(|_| {
            let (point, pdf) = shape.sample_area(0, random.uniform_square());
            assert!(point.p.cmpge(bounds.min - slack).all() && point.p.cmple(bounds.max + slack).all(), "{} {point:?}", family.0);
            assert!((point.ng.length() - 1.0).abs() < 4.0 * f32::EPSILON && point.ns.dot(point.ng) > 0.0);
            1.0 / pdf.get() as f64
        }));
        // Five standard errors, which is one false alarm in 10⁶, with a fixed seed; 10⁻⁵ if there is no variance.
        assert!((area - shape.area(0) as f64).abs() <= 5.0 * error + 1e-5 * area, "{}: {area} ± {error}, not {}", family.0, shape.area(0));
    }
}

/// The density of `sample_from` equals `pdf_from`, and the ray to the sample hits it.
#[test]
fn the_pdf_of_a_sample_equals_the_evaluated_pdf() {
    for family in families() {
        let shape = bake(&family);
        let mut random = Random::new(4);
        for _ in 0..20_000 {
            let from = shape.bounds(0).center() + (random.direction() * random.decade(-0.5, 3.0)).as_vec3();
            let Some((point, pdf)) = shape.sample_from(0, from, random.square()) else { continue };
            let asked = shape.pdf_from(0, from, &point).get();
            assert!(pdf.get() > 0.0 && pdf.get().is_finite());
            // The point is rounded to f32 before its density is computed. Seen nearly edge-on, the error grows with 1/cos.
            let line = (point.p - from).as_dvec3();
            let cos = (point.ng.as_dvec3().dot(line) / line.length()).abs();
            assert!((asked / pdf.get() - 1.0).abs() as f64 <= 1e-5 + 1e-5 / cos, "{}: {} but {asked}", family.0, pdf.get());
        }
    }
}

/// The texture coordinates of a small sphere do not depend on how far from the origin it is, though its points round to its centre.
#[test]
fn texture_coordinates_of_a_distant_sphere() {
    let at = |distance: f64| {
        let place = Transform::translate(DVec3::new(distance, -distance, distance)).expect("finite");
        let shape = Sphere { radius: 1e-3 }.bake(&place).expect("a sphere");
        let from = (DVec3::new(distance, -distance, distance) + DVec3::new(3.0, 2.0, 1.0) * distance.max(1.0)).as_vec3();
        shape.sample_from(0, from, Vec2::new(0.3, 0.6)).map(|(point, _)| shape.texture_coordinates(0, &point))
    };
    let (near, far) = (at(0.0).expect("a sample"), at(1e6).expect("a sample"));
    // The near point sees the sphere under an angle of 3·10⁻⁴ on either side, and so other points of it.
    assert!(near.is_finite() && (near - far).abs().max_element() < 1e-3, "{near} and {far}");
}

/// A sample that lights a point has the texture coordinates of the hit of a ray against its normal.
#[test]
fn samples_have_the_texture_coordinates_of_hits() {
    for family in families() {
        let shape = bake(&family);
        let (bounds, mut random, mut compared) = (shape.bounds(0), Random::new(5), 0);
        let radius = bounds.radius();
        // The roundings of the points, relative to the size of the shape.
        let rounding = 8.0 * f32::EPSILON * bounds.magnitude().max_element() / radius;
        for _ in 0..5_000 {
            let from = bounds.center() + (random.direction() * random.decade(-0.5, 3.0)).as_vec3();
            let Some((point, _)) = shape.sample_from(0, from, random.square()) else { continue };
            let ray = Ray::new(point.p + point.ng * (0.05 * radius), -point.ng);
            let Some(hit) = shape.intersect(0, &ray) else { continue };
            let found = shape.point(0, &ray, &hit);
            if (found.p - point.p).length() > 0.01 * radius {
                continue;
            }
            let difference = shape.texture_coordinates(0, &point) - found.uv;
            // u goes around. Near a pole or a tip, a short way is a long one in u.
            let [u, v] = [difference.x - difference.x.round(), difference.y].map(f32::abs);
            let sine = (std::f32::consts::PI * found.uv.y).sin();
            if sine < 0.01 {
                continue;
            }
            assert!(v <= rounding && u <= rounding / sine, "{}: {difference} at {}", family.0, found.uv);
            compared += 1;
        }
        assert!(compared > 1000, "{}: {compared}", family.0);
    }
}

/// ∫ pdf over the directions in which the primitive is visible is 1, estimated with random directions from points near, far and, for
/// the sphere, inside.
#[test]
fn densities_integrate_to_one() {
    for family in families() {
        let shape = bake(&family);
        let bounds = shape.bounds(0);
        for (seed, distance) in [0.0, 1.2, 3.0].into_iter().enumerate() {
            let mut random = Random::new(seed as u64);
            let from = bounds.center() + (random.direction() * distance * bounds.radius() as f64).as_vec3();
            let inside = distance == 0.0;
            if inside && family.0 != "sphere" {
                continue;
            }
            let (integral, error) = mean((0..400_000).map(|_| {
                let ray = Ray::new(from, random.direction().as_vec3());
                // Sampling by area covers both sides of an ellipsoid, so that all hits count.
                let (mut sum, mut start) = (0.0, ray);
                while let Some(hit) = shape.intersect(0, &start) {
                    let point = shape.point(0, &start, &hit);
                    sum += shape.pdf_from(0, from, &point).get() as f64 * 4.0 * PI;
                    let is_cone =
                        family.0 == "sphere" && family.2.matrix().matrix3.x_axis.length() == family.2.matrix().matrix3.y_axis.length();
                    if is_cone {
                        break;
                    }
                    start.origin = point.p + start.direction * (bounds.radius() * 1e-4);
                }
                sum
            }));
            // Five standard errors, and one sample in 10⁴ that may be on an edge.
            assert!((integral - 1.0).abs() <= 5.0 * error + 1e-3, "{} from {distance}: {integral} ± {error}", family.0);
        }
    }
}

/// Normals stay perpendicular under non-uniform scaling and keep their side under mirroring transforms.
///
/// The side is tested by a small step along the normal in object space, transformed as a vector, which must lead to the side of `ng`.
#[test]
fn normals_keep_their_side() {
    let (points, triangles) = icosphere(2);
    let positions: Vec<Vec3> = points.iter().map(|p| p.as_vec3()).collect();
    for (k, scale) in [[1.0, 1.0, 1.0], [3.0, 0.2, 1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, -2.0], [-1.0, -3.0, -0.5]].into_iter().enumerate() {
        let mut random = Random::new(k as u64);
        let place = stretch(scale).then(&random.rotation());
        let outward = |p: Vec3, ng: Vec3| ng.as_dvec3().dot(place.vector(place.inverse().point(p.as_dvec3()))) > 0.0;
        let sphere = Sphere { radius: 1.0 }.bake(&place).expect("a sphere");
        for normals in [vec![], positions.clone()] {
            let ball = MeshData { positions: positions.clone(), triangles: triangles.clone(), normals, ..MeshData::default() };
            let ball = TriangleMesh::new(ball).bake(&place).expect("a ball");
            for i in 0..ball.count() {
                let (point, _) = ball.sample_area(i, random.square());
                assert!(outward(point.p, point.ng) && outward(point.p, point.ns), "mesh, scale {scale:?}");
            }
        }
        let step = place.vector(DVec3::Z);
        for _ in 0..200 {
            let (point, _) = sphere.sample_area(0, random.square());
            assert!(outward(point.p, point.ng), "sphere, scale {scale:?}");
            for flat in [Quad { size: [1.0, 1.0] }.bake(&place), Disk { radius: 1.0 }.bake(&place)] {
                let (point, _) = flat.expect("an area").sample_area(0, random.square());
                assert!(point.ng.as_dvec3().dot(step) > 0.0, "flat, scale {scale:?}");
                let tangent = place.vector(DVec3::new(random.unit(), random.unit(), 0.0)).normalize();
                assert!(point.ng.as_dvec3().dot(tangent).abs() < 1e-6, "flat, scale {scale:?}");
            }
        }
    }
}
