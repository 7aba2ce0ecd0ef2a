//! Boxes: closed surfaces with outward normals and the documented texture coordinates, equal to their six quads.

use glam::{DVec3, Vec2, Vec3};
use pt::accel;
use pt::math::{Ray, Transform};
use pt::shape::{Cuboid, Geometry, Quad, Shape};

use crate::random::Random;
use pt::torture::meshes::shapes;

const SIZE: [f64; 3] = [1.5, 0.8, 2.5];

/// Transforms of the box: identity, stretched, mirrored, and rotated with a translation.
fn places() -> Vec<Transform> {
    let mut random = Random::new(21);
    let scales = [[1.0, 1.0, 1.0], [2.0, 0.5, 1.3], [-1.0, 1.0, 1.0], [-0.7, -2.0, -1.1], [1e-9, 1e-9, 1e-9], [1e9, 1e9, 1e9]];
    let place = |scale: [f64; 3]| {
        let stretch = Transform::scale(DVec3::from(scale)).expect("no factor is zero");
        let to = Transform::translate(random.in_cube() * scale[0]).expect("finite");
        stretch.then(&random.rotation()).then(&to)
    };
    [Transform::IDENTITY].into_iter().chain(scales.map(place)).collect()
}

fn baked(place: &Transform) -> Box<dyn Shape> {
    Cuboid { size: SIZE }.bake(place).expect("a volume")
}

/// The middle of each face, its normal and its area.
fn faces(shape: &dyn Shape) -> Vec<(DVec3, DVec3, f64)> {
    let face = |i| {
        let (point, _) = shape.sample_area(i, Vec2::splat(0.5));
        (point.p.as_dvec3(), point.ng.as_dvec3(), f64::from(shape.area(i)))
    };
    (0..shape.count()).map(face).collect()
}

/// Gauss: Σ A n = 0 and ⅓ Σ A n·p = V for a closed surface whose normals point outwards; also mirrored.
#[test]
fn a_box_is_closed_and_its_normals_point_outwards() {
    for place in places() {
        let shape = baked(&place);
        let faces = faces(&*shape);
        assert_eq!(faces.len(), 6);
        let area: f64 = faces.iter().map(|(.., area)| area).sum();
        let vector = faces.iter().map(|(_, n, area)| *n * *area).sum::<DVec3>();
        let middle = place.point(DVec3::ZERO);
        let volume: f64 = faces.iter().map(|(p, n, area)| area * n.dot(*p - middle) / 3.0).sum();
        let expected = SIZE.iter().product::<f64>() * place.determinant().abs();
        // Each number is computed from a few coordinates in f32.
        assert!(vector.length() <= 1e-6 * area, "{vector} of {area}");
        assert!((volume / expected - 1.0).abs() < 1e-5, "{volume}, expected {expected}");
    }
}

/// A ray from outside through a point inside hits the box exactly twice, also where it grazes edges and corners.
#[test]
fn rays_go_in_and_out() {
    for (seed, place) in places().into_iter().enumerate() {
        let shapes = shapes(vec![baked(&place)]);
        let hierarchy = accel::build(shapes.clone());
        let mut random = Random::new(seed as u64);
        let radius = place.vector(DVec3::ONE * 4.0).length();
        for _ in 0..20_000 {
            let within = place.point(DVec3::from(SIZE) * 0.499 * random.in_cube().clamp(DVec3::NEG_ONE, DVec3::ONE));
            let direction = random.direction();
            let ray = Ray::new((within - direction * radius).as_vec3(), direction.as_vec3());
            let first = hierarchy.intersect(&ray).expect("it goes in");
            let cos = |hit: &pt::primitive::Hit| {
                let shape = &shapes[hit.shape as usize];
                shape.point(hit.primitive, &ray, &pt::shape::ShapeHit { t: hit.t, uv: hit.uv }).ng.dot(ray.direction)
            };
            assert!(cos(&first) < 0.0, "{first:?}");
            let back = Ray::new((within + direction * radius).as_vec3(), -direction.as_vec3());
            assert!(hierarchy.intersect(&back).is_some(), "it comes out");
        }
    }
}

/// For a viewer outside of each face, with +y up (above and below the box: with −z and +z up), u runs to the right and v upwards, from 0 to
/// 1.
#[test]
fn texture_coordinates_are_those_of_the_docs() {
    let shape = baked(&Transform::IDENTITY);
    let half = DVec3::from(SIZE) * 0.5;
    for (normal, up) in [
        (DVec3::X, DVec3::Y),
        (DVec3::NEG_X, DVec3::Y),
        (DVec3::Z, DVec3::Y),
        (DVec3::NEG_Z, DVec3::Y),
        (DVec3::Y, DVec3::NEG_Z),
        (DVec3::NEG_Y, DVec3::Z),
    ] {
        let right = up.cross(normal);
        let face = (0..6).find(|&i| shape.sample_area(i, Vec2::splat(0.5)).0.ng.as_dvec3() == normal).expect("a face");
        for uv in [Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.0), Vec2::new(0.25, 0.75)] {
            let expected = half * (normal + right * (2.0 * f64::from(uv.x) - 1.0) + up * (2.0 * f64::from(uv.y) - 1.0));
            let ray = Ray::new((expected + normal).as_vec3(), (-normal).as_vec3());
            let found = shape.sample_area(face, uv).0;
            assert!((found.p.as_dvec3() - expected).length() < 1e-6 && found.uv == uv, "{normal}: {found:?}, expected {expected}");
            let inner = Vec2::splat(0.5).lerp(uv, 0.5);
            let at = half * (normal + right * (2.0 * f64::from(inner.x) - 1.0) + up * (2.0 * f64::from(inner.y) - 1.0));
            let hit = shape.intersect(face, &Ray { origin: (at + normal).as_vec3(), ..ray }).expect("a hit");
            assert!((shape.point(face, &ray, &hit).uv - inner).length() < 1e-6, "{normal} {inner}");
        }
    }
}

/// The face +z equals a quad that is moved there, bit for bit.
#[test]
fn a_face_is_a_quad() {
    let lift = Transform::translate(DVec3::Z * 0.5 * SIZE[2]).expect("finite");
    let quad = Quad { size: [SIZE[0], SIZE[1]] }.bake(&lift).expect("an area");
    let shape = baked(&Transform::IDENTITY);
    let face = (0..6).find(|&i| shape.sample_area(i, Vec2::splat(0.5)).0.ng == Vec3::Z).expect("a face");
    assert_eq!((shape.bounds(face), shape.area(face), shape.facet(face)), (quad.bounds(0), quad.area(0), quad.facet(0)));
    for u in [Vec2::new(0.1, 0.9), Vec2::new(0.7, 0.3)] {
        assert_eq!(shape.sample_area(face, u), quad.sample_area(0, u));
    }
}
