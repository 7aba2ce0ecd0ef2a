//! Spherical triangles and rectangles: solid angles and uniform sampling.

use std::f64::consts::PI;

use glam::{DVec3, Vec2, Vec3, Vec3Swizzles};
use pt::math::float::ONE_MINUS_EPSILON;
use pt::math::{SphericalRectangle, SphericalTriangle};
use pt::proof::chi2;

use crate::random::Random;
use crate::statistics::sidak;

/// Parallelogram or half of it: a corner and the edges from there.
#[derive(Clone, Copy, Debug)]
struct Flat {
    corner: DVec3,
    edges: [DVec3; 2],
    is_triangle: bool,
}

/// Interface of both shapes.
struct Region {
    flat: Flat,
    solid_angle: f32,
    pdf: f32,
    sample: Box<dyn Fn(Vec2) -> Vec3>,
    inverse: Box<dyn Fn(Vec3) -> Vec2>,
    contains: Box<dyn Fn(Vec3) -> bool>,
}

fn triangle(a: Vec3, b: Vec3, c: Vec3) -> Option<Region> {
    let [corner, x, y] = [a, b, c].map(Vec3::as_dvec3);
    let seen = SphericalTriangle::new([a, b, c])?;
    Some(Region {
        flat: Flat { corner, edges: [x - corner, y - corner], is_triangle: true },
        solid_angle: seen.solid_angle(),
        pdf: seen.pdf(),
        sample: Box::new(move |u| seen.sample(u)),
        inverse: Box::new(move |w| seen.sample_inverse(w)),
        contains: Box::new(move |w| seen.contains(w)),
    })
}

fn rectangle(corner: Vec3, x: Vec3, y: Vec3) -> Option<Region> {
    let seen = SphericalRectangle::new(corner, [x, y])?;
    Some(Region {
        flat: Flat { corner: corner.as_dvec3(), edges: [x, y].map(Vec3::as_dvec3), is_triangle: false },
        solid_angle: seen.solid_angle(),
        pdf: seen.pdf(),
        sample: Box::new(move |u| seen.sample(u)),
        inverse: Box::new(move |w| seen.sample_inverse(w)),
        contains: Box::new(move |w| seen.contains(w)),
    })
}

impl Flat {
    fn at(&self, x: f64, y: f64) -> DVec3 {
        self.corner + x * self.edges[0] + y * self.edges[1]
    }

    /// Intersection of a direction with the plane, in units of the edges.
    fn coordinates(&self, w: Vec3) -> [f64; 2] {
        let (w, [x, y]) = (w.as_dvec3(), self.edges);
        let normal = x.cross(y);
        // The vector t w − corner in the plane.
        let from_corner = w * (self.corner.dot(normal) / w.dot(normal)) - self.corner;
        let square = normal.length_squared();
        [from_corner.cross(y).dot(normal) / square, x.cross(from_corner).dot(normal) / square]
    }
}

/// Solid angle by L'Huilier's formula tan²(Ω/4) = tan(s/2) tan((s − a)/2) tan((s − b)/2) tan((s − c)/2), where s is half the sum of the
/// sides.
fn lhuilier(corners: [DVec3; 3]) -> f64 {
    let side = |i: usize| {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        p.cross(q - p).length().atan2(p.dot(q))
    };
    let sides = [0, 1, 2].map(side);
    let half = 0.5 * sides.iter().sum::<f64>();
    let product: f64 = sides.iter().map(|side| (0.5 * (half - side)).tan()).product();
    4.0 * ((0.5 * half).tan() * product).max(0.0).sqrt().atan()
}

/// Triangles and rectangles of all sizes and positions, and whether each is so small that it must lie near the z axis, where an f32
/// resolves its directions.
fn regions() -> Vec<Region> {
    let mut random = Random::new(71);
    let mut all = vec![
        triangle(Vec3::X, Vec3::Y, Vec3::Z),
        // Nearly all of a hemisphere.
        triangle(Vec3::new(1.0, 0.0, 0.01), Vec3::new(-0.5, 0.9, 0.01), Vec3::new(-0.5, -0.9, 0.01)),
        rectangle(Vec3::new(-1.0, -1.0, 0.003), Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0)),
        // Long shapes at grazing incidence.
        triangle(Vec3::new(1.0, 0.0, 0.1), Vec3::new(90.0, 1.0, 0.1), Vec3::new(1.0, 1.0, 0.1)),
        rectangle(Vec3::new(0.2, 0.3, 0.01), Vec3::new(70.0, 0.0, 0.0), Vec3::new(0.0, 0.7, 0.0)),
        rectangle(Vec3::new(0.2, 0.3, 0.01), Vec3::new(0.0, 0.7, 0.0), Vec3::new(70.0, 0.0, 0.0)),
        rectangle(Vec3::new(-0.1, -40.0, 0.01), Vec3::new(0.2, 0.0, 0.0), Vec3::new(0.0, 80.0, 0.0)),
    ];
    for size in [1e-2, 1e-4, 1e-7, 1e-12f32] {
        all.push(triangle(Vec3::Z, Vec3::new(size, 0.0, 1.0), Vec3::new(0.0, size, 1.0)));
        all.push(rectangle(Vec3::new(-0.3 * size, 0.1 * size, -1.0), Vec3::X * size, Vec3::Y * size));
    }
    for _ in 0..12 {
        let place = (random.direction() * random.magnitude(0.1, 30.0)).as_vec3();
        let [x, y, z] = [(); 3].map(|()| random.in_cube().as_vec3());
        all.push(triangle(place + x, place + y, place + z));
        let turn = random.rotation();
        let [x, y] = [DVec3::X, DVec3::Y].map(|axis| (turn.vector(axis) * random.magnitude(0.3, 3.0)).as_vec3());
        all.push(rectangle(place, x, y));
    }
    all.into_iter().map(|region| region.expect("large enough")).collect()
}

/// The solid angle of a centred rectangle of 2a by 2b is Ω = 4 atan(a b / (d √(a² + b² + d²))).
#[test]
fn solid_angles_of_rectangles() {
    for (a, b, d) in [(1.0, 1.0, 1.0), (3.0, 0.1, 2.0), (1e-4, 2e-5, 1.0), (1.0, 1e3, 1e-3), (50.0, 50.0, 1e-2f32)] {
        let seen = SphericalRectangle::new(Vec3::new(-a, -b, d), [Vec3::X * (2.0 * a), Vec3::Y * (2.0 * b)]).expect("seen");
        let [a, b, d] = [a, b, d].map(f64::from);
        let exact = 4.0 * (a * b).atan2(d * (a * a + b * b + d * d).sqrt());
        assert!((f64::from(seen.solid_angle()) / exact - 1.0).abs() < 2e-7, "{a} {b} {d}: {} {exact}", seen.solid_angle());
    }
}

/// Seen from inside, the faces of a tetrahedron and of a box cover the sphere once.
#[test]
fn closed_surfaces_cover_the_sphere() {
    let mut random = Random::new(72);
    for _ in 0..1000 {
        let inside = random.in_cube() * 0.999;
        let faces = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
            let [x, y]: [DVec3; 2] = [axis.yzx(), axis.zxy()];
            [-1.0, 1.0].map(|side| rectangle((side * axis - x - y - inside).as_vec3(), (2.0 * x).as_vec3(), (2.0 * y).as_vec3()))
        });
        let sum: f64 = faces.as_flattened().iter().flatten().map(|face| f64::from(face.solid_angle)).sum();
        // The corners are rounded to f32, and the nearest face is 10⁻³ away.
        assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-4, "box at {inside}: {sum}");
    }
    for _ in 0..1000 {
        let corners = [(); 4].map(|()| random.direction().as_vec3());
        let faces = [[0, 1, 2], [1, 2, 3], [2, 3, 0], [3, 0, 1]];
        let volume = |[a, b, c]: [DVec3; 3]| a.dot(b.cross(c));
        let signs = faces.map(|face| volume(face.map(|i| corners[i].as_dvec3())).signum());
        let is_inside = signs[0] == -signs[1] && signs[1] == -signs[2] && signs[2] == -signs[3];
        if is_inside {
            let seen = |face: [usize; 3]| SphericalTriangle::new(face.map(|i| corners[i])).map_or(0.0, |t| f64::from(t.solid_angle()));
            let sum: f64 = faces.into_iter().map(seen).sum();
            assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-6, "{corners:?}: {sum}");
        }
    }
}

/// Sampled directions are uniform: counts in cells of the plane are compared with the solid angles of the cells by an independent formula.
#[test]
fn directions_are_uniform() {
    const SIDE: usize = 8;
    const SAMPLES: usize = 40_000;
    let regions = regions();
    let level = sidak(regions.len());
    let mut random = Random::new(73);
    for Region { flat, solid_angle, pdf, sample, .. } in &regions {
        let (mut shares, mut counts) = (vec![0.0; 2 * SIDE * SIDE], vec![0u64; 2 * SIDE * SIDE]);
        let index = |row: usize, column: usize, upper: bool| 2 * (row * SIDE + column) + usize::from(upper);
        for (row, column) in (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (row, column))) {
            let at = |x: usize, y: usize| flat.at((column + x) as f64 / SIDE as f64, (row + y) as f64 / SIDE as f64);
            let diagonal = [at(1, 0), at(0, 1)];
            let inside = |upper: bool| !flat.is_triangle || row + column + usize::from(upper) < SIDE;
            for (upper, tip) in [(false, at(0, 0)), (true, at(1, 1))] {
                shares[index(row, column, upper)] = if inside(upper) { lhuilier([diagonal[0], diagonal[1], tip]) } else { 0.0 };
            }
        }
        for _ in 0..SAMPLES {
            let [x, y] = flat.coordinates(sample(random.uniform_square())).map(|c| c.clamp(0.0, ONE_MINUS_EPSILON.into()) * SIDE as f64);
            let cell = index(y as usize, x as usize, x.fract() + y.fract() > 1.0);
            // Rounding may move a point beyond the hypotenuse.
            let cell = if shares[cell] == 0.0 { cell - 1 } else { cell };
            counts[cell] += 1;
        }
        let total: f64 = shares.iter().sum();
        // L'Huilier's formula loses precision for cells seen nearly edge-on.
        assert!((f64::from(*solid_angle) / total - 1.0).abs() < 1e-5, "{flat:?}: {solid_angle} sr, expected {total}");
        assert!((f64::from(*pdf) * f64::from(*solid_angle) - 1.0).abs() < 2e-7);
        let test = chi2(&shares, &counts);
        assert!(test.p > level, "{flat:?}: p = {:e}, cell {} of {shares:?} against {counts:?}", test.p, test.worst);
    }
}

/// Corners and edges of the square, and random points.
fn squares(random: &mut Random) -> Vec<Vec2> {
    let special = [0.0, 1e-30, 2f32.powi(-24), 0.5, ONE_MINUS_EPSILON];
    let corners = special.iter().flat_map(|&x| special.map(|y| Vec2::new(x, y)));
    corners.chain((0..5000).map(|_| random.uniform_square())).collect()
}

/// Angle by which a direction lies outside a region, beyond the planes through the viewer and the edges.
fn outside(flat: &Flat, w: Vec3) -> f64 {
    let corners: &[[f64; 2]] = if flat.is_triangle { &[[0., 0.], [1., 0.], [0., 1.]] } else { &[[0., 0.], [1., 0.], [1., 1.], [0., 1.]] };
    let corner = |i: usize| flat.at(corners[i % corners.len()][0], corners[i % corners.len()][1]);
    let centre = flat.at(0.25, 0.25);
    let beyond = |i: usize| {
        let normal = corner(i).cross(corner(i + 1) - corner(i)).normalize();
        -w.as_dvec3().dot(normal) * centre.dot(normal).signum()
    };
    (0..corners.len()).map(beyond).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn directions_lie_inside() {
    let mut random = Random::new(74);
    for Region { flat, sample, solid_angle, .. } in regions() {
        // Rounding of three coordinates below 1; near the z axis, of x and y, which are as small as the region.
        let rounding = if solid_angle < 1e-5 { 2e-7 * f64::from(solid_angle).sqrt() } else { 6e-8 };
        for u in squares(&mut random) {
            let w = sample(u);
            assert!((w.as_dvec3().length() - 1.0).abs() < 1.5e-7, "{flat:?} at {u}: {w}");
            assert!(outside(&flat, w) < rounding, "{flat:?} at {u}: {w} is {} outside", outside(&flat, w));
            let normal = flat.edges[0].cross(flat.edges[1]).normalize();
            assert!(w.as_dvec3().dot(normal) * flat.corner.dot(normal).signum() > -6e-8, "{flat:?} at {u}: {w} leads away");
        }
    }
}

/// `contains` is true for directions inside by more than their rounding error, and false for those outside by more.
#[test]
fn regions_contain_what_is_inside() {
    let mut random = Random::new(77);
    for Region { flat, contains, sample, .. } in regions() {
        let (mut inside, mut not) = (0, 0);
        for _ in 0..2000 {
            let near = sample(random.uniform_square()).as_dvec3();
            let w = (near + random.direction() * random.magnitude(1e-7, 1.0)).normalize().as_vec3();
            let far = outside(&flat, w);
            let normal = flat.edges[0].cross(flat.edges[1]).normalize();
            let rises = w.as_dvec3().dot(normal) * flat.corner.dot(normal).signum();
            if far.abs() > 1e-7 && rises.abs() > 1e-7 {
                let is_inside = far < 0.0 && rises > 0.0;
                assert_eq!(contains(w), is_inside, "{flat:?}: {w} is {far} outside");
                *(if is_inside { &mut inside } else { &mut not }) += 1;
            }
        }
        assert!(not > 20 && (inside > 100 || flat.edges[0].length() < 1e-3), "{flat:?}: {inside} inside, {not} not");
    }
}

/// `sample_inverse` inverts `sample` up to the rounding of a direction, 6·10⁻⁸, relative to the size of the region.
#[test]
fn round_trip() {
    let mut random = Random::new(75);
    for Region { sample, inverse, solid_angle, flat, .. } in regions() {
        let size = if solid_angle < 1e-5 { 1.0 } else { f64::from(solid_angle).sqrt() } as f32;
        for u in squares(&mut random) {
            let w = sample(u);
            let back = inverse(w);
            assert!(back.min_element() >= 0.0 && back.max_element() < 1.0, "{flat:?} at {u}: {back}");
            assert!(sample(back).distance(w) < 1e-6 * solid_angle.sqrt().max(0.3), "{flat:?} at {u}: {w}, then {}", sample(back));
            let tolerance = 1e-5 / (size * size);
            assert!((back.y - u.y).abs() < tolerance, "{flat:?}: {u} came back as {back}");
            // At the second corner of a triangle u.x is arbitrary.
            assert!((back.x - u.x).abs() < tolerance / u.y.sqrt(), "{flat:?}: {u} came back as {back}");
        }
    }
}

/// A mirrored region has the mirrored directions, to the last bit.
#[test]
fn mirror_images() {
    let mut random = Random::new(76);
    for mirror in [Vec3::new(-1.0, 1.0, 1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::NEG_ONE] {
        for region in regions() {
            let Flat { corner, edges: [x, y], is_triangle } = region.flat;
            let [corner, x, y] = [corner, x, y].map(DVec3::as_vec3);
            let make = |mirror: Vec3| {
                let [corner, x, y] = [corner, x, y].map(|v| v * mirror);
                if is_triangle { triangle(corner, corner + x, corner + y) } else { rectangle(corner, x, y) }.expect("as large")
            };
            let (one, other) = (make(Vec3::ONE), make(mirror));
            assert_eq!(one.solid_angle, other.solid_angle);
            for u in (0..20).map(|_| random.square()) {
                assert_eq!((one.sample)(u) * mirror, (other.sample)(u), "{:?} at {u}, mirrored by {mirror}", region.flat);
            }
        }
    }
}

/// Regions that are seen edge-on, have no extent, are too small for a density, or touch the viewer cannot be sampled and give no NaN.
#[test]
fn invisible_regions_have_no_samples() {
    let flat = Vec3::new(1.0, 2.0, 0.0);
    assert!(SphericalTriangle::new([flat, flat + Vec3::X, flat + Vec3::Y]).is_none());
    assert!(SphericalTriangle::new([Vec3::Z; 3]).is_none());
    assert!(SphericalTriangle::new([Vec3::ZERO, Vec3::X, Vec3::Y]).is_none());
    assert!(SphericalTriangle::new([Vec3::Z, Vec3::new(1e-20, 0.0, 1.0), Vec3::new(0.0, 1e-20, 1.0)]).is_none());
    assert!(SphericalTriangle::new([Vec3::NAN, Vec3::X, Vec3::Y]).is_none());
    assert!(SphericalRectangle::new(flat, [Vec3::X, Vec3::Y]).is_none());
    assert!(SphericalRectangle::new(Vec3::Z, [Vec3::X, Vec3::ZERO]).is_none());
    assert!(SphericalRectangle::new(Vec3::Z, [Vec3::X, Vec3::X]).is_none());
    assert!(SphericalRectangle::new(Vec3::Z, [Vec3::X * 1e-20, Vec3::Y * 1e-20]).is_none());
    assert!(SphericalRectangle::new(Vec3::NAN, [Vec3::X, Vec3::Y]).is_none());
}
