//! Light sampling without a picture: choice by power, densities, and irradiance against closed forms.
//!
//! E = ∫ L cos θ dω is the mean of weight·cos θ at the centres of a regular grid. The error of f32 is about 10⁻⁶, and a kink in the
//! integrand gives an error of c/n² for n×n points. All radiances are 1 unless noted otherwise.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec2, Vec3};
use pt::light::{
    Area, Directional, Emitter, Environment, Falloff, Light, LightSample, LightSampleContext, Lights, Point, ShadowTarget, Spot,
};
use pt::math::float::sin_cos_degrees;
use pt::math::{Density, Rgb, Transform};
use pt::shape::{Disk, Geometry, Quad, Shape, Sphere, TriangleMesh};

use crate::random::Random;
use pt::torture::meshes::{icosphere, mesh};

/// Lights of one shape. The index of a light is that of its primitive.
fn lit(geometry: &dyn Geometry, to_world: &Transform, two_sided: bool) -> Lights {
    let shape = geometry.bake(to_world).expect("the shape can be hit");
    let emitter = Emitter { two_sided, ..Emitter::new(Rgb::WHITE) };
    let lights = (0..shape.count()).map(|primitive| Light::Area(Area::new(0, primitive, emitter.clone()))).collect();
    Lights::new(lights, vec![shape].into(), (Vec3::ZERO, 1.0))
}

fn moved(x: f64, y: f64, z: f64) -> Transform {
    Transform::translate(DVec3::new(x, y, z)).expect("finite")
}

fn turn(axis: DVec3, degrees: f64) -> Transform {
    Transform::rotate(axis, degrees).expect("an axis has a direction")
}

fn scaled(x: f64, y: f64, z: f64) -> Transform {
    Transform::scale(DVec3::new(x, y, z)).expect("not zero")
}

fn icosahedron() -> TriangleMesh {
    let (points, triangles) = icosphere(0);
    TriangleMesh::new(mesh(points.iter().map(|p| p.as_vec3()).collect(), triangles))
}

fn grid(n: usize) -> impl Iterator<Item = Vec2> {
    let middle = move |k: usize| (k as f32 + 0.5) / n as f32;
    (0..n).flat_map(move |i| (0..n).map(move |j| Vec2::new(middle(i), middle(j))))
}

/// Each primitive of a shape as the only light.
fn each_alone(geometry: &dyn Geometry, to_world: &Transform, two_sided: bool) -> Vec<Lights> {
    let count = geometry.bake(to_world).expect("the shape can be hit").count();
    let light = |primitive| {
        let emitter = Emitter { two_sided, ..Emitter::new(Rgb::WHITE) };
        let shape = geometry.bake(to_world).expect("the shape can be hit");
        Lights::new(vec![Light::Area(Area::new(0, primitive, emitter))], vec![shape].into(), (Vec3::ZERO, 1.0))
    };
    (0..count).map(light).collect()
}

/// Irradiance of a surface at `from` by the sum of lights [W·m⁻²].
fn irradiance(each: &[Lights], from: DVec3, normal: DVec3, n: usize) -> f64 {
    let cx = LightSampleContext::at(from.as_vec3());
    let samples = each.iter().flat_map(|light| grid(n).filter_map(move |u| light.sample(&cx, 0.5, u)));
    let brought = samples.map(|s| f64::from(s.weight().average()) * s.wi.as_dvec3().dot(normal).max(0.0));
    brought.sum::<f64>() / (n * n) as f64
}

fn assert_near(found: f64, exact: f64, tolerance: f64, what: &str) {
    let off = (found - exact).abs() / exact;
    assert!(off <= tolerance, "{what}: {found} for {exact}, off by {off:.2e}");
}

fn smooth(sample: &LightSample) -> f64 {
    match sample.density {
        Density::Smooth(pdf) => f64::from(pdf.get()),
        Density::Delta => panic!("not a delta light"),
    }
}

/// An ellipsoid with half axes (b, c, a) at distance d on its axis a fills the elliptic cone of the slopes
/// t = b/√(d² − a²) and c/√(d² − a²): E = π / √((1 + 1/t₁²)(1 + 1/t₂²)), by Nusselt's projection.
#[test]
fn irradiance_of_ellipsoids_is_exact() {
    for ([b, c, a], d) in [([1.0, 0.6, 1.5], 3.0), ([2.0, 0.5, 0.2], 0.5), ([1.0, 1.0, 3.0], 4.0), ([1.5, 0.6, 1.0], 1e4)] {
        // The poles of the sphere, where the grid is coarsest, point to the sides.
        let place = turn(DVec3::X, 90.0).then(&scaled(b, c, a)).then(&moved(0.0, 0.0, d));
        let lights = each_alone(&Sphere { radius: 1.0 }, &place, false);
        let slope = |b: f64| (d * d - a * a) / (b * b);
        let exact = PI / ((1.0 + slope(b)) * (1.0 + slope(c))).sqrt();
        // The integrand has a kink at the edge of the visible side.
        assert_near(irradiance(&lights, DVec3::ZERO, DVec3::Z, 1024), exact, 1e-4, &format!("ellipsoid {a} {b} {c} at {d}"));
    }
}

/// Inside a shape that emits everywhere, E = πL at every point and for every normal.
#[test]
fn irradiance_inside_an_emitter_is_exact() {
    let squash = scaled(1.5, 0.6, 1.0).then(&turn(DVec3::Y, 30.0));
    let mut random = Random::new(3);
    let shapes: [(&dyn Geometry, Transform); 3] =
        [(&Sphere { radius: 1.0 }, Transform::IDENTITY), (&Sphere { radius: 1.0 }, squash), (&icosahedron(), Transform::IDENTITY)];
    for (k, (geometry, to_world)) in shapes.into_iter().enumerate() {
        let (two_sided, outward) = (each_alone(geometry, &to_world, true), each_alone(geometry, &to_world, false));
        for _ in 0..4 {
            let (inside, normal) = (to_world.point(random.direction() * 0.5), random.direction());
            // The integrand has a kink at the horizon, and the grid is coarsest on the nearest part.
            assert_near(irradiance(&two_sided, inside, normal, 200), PI, 1e-3, &format!("shape {k} from {inside}"));
            assert_eq!(irradiance(&outward, inside, normal, 16), 0.0, "shape {k} shines outward");
        }
    }
}

/// Irradiance of a wall that touches the floor and of an oblique triangle: E = ½ Σ θᵢ (nᵢ·n) over the edges.
#[test]
fn irradiance_of_polygons_is_exact() {
    let wall = each_alone(&Quad { size: [2.0, 2.0] }, &turn(DVec3::Y, -90.0).then(&moved(1.0, 0.0, 1.0)), false);
    let corners = [(1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (1.0, 1.0, 2.0), (1.0, -1.0, 2.0)].map(DVec3::from);
    assert_near(lambert(&corners), 0.597_329_491_3, 1e-9, "the formula");
    assert_near(irradiance(&wall, DVec3::ZERO, DVec3::Z, 256), lambert(&corners), 1e-5, "wall");
    let corners = [(1.0, 0.0, 1.0), (0.0, 1.0, 1.0), (-1.0, -1.0, 2.0)].map(DVec3::from);
    let data = mesh(corners.iter().map(|p| p.as_vec3()).collect(), vec![[0, 1, 2]]);
    let triangle = each_alone(&TriangleMesh::new(data), &Transform::IDENTITY, true);
    assert_near(lambert(&corners), 0.687_617_388_7, 1e-9, "the formula");
    // The warp to the triangle has a root at one corner.
    assert_near(irradiance(&triangle, DVec3::ZERO, DVec3::Z, 512), lambert(&corners), 1e-4, "triangle");
}

/// Irradiance at the origin on the floor z = 0.
fn lambert(corners: &[DVec3]) -> f64 {
    let edge = |i: usize| {
        let (a, b) = (corners[i].normalize(), corners[(i + 1) % corners.len()].normalize());
        a.angle_between(b) * a.cross(b).normalize().z
    };
    (0.5 * (0..corners.len()).map(edge).sum::<f64>()).abs()
}

/// Name, shape and placement of each kind of shape.
fn families() -> Vec<(&'static str, Box<dyn Geometry>, Transform)> {
    let askew = turn(DVec3::new(1.0, 2.0, -0.5), 50.0).then(&moved(0.2, -0.1, 0.3));
    vec![
        ("quad", Box::new(Quad { size: [1.0, 0.6] }), askew.then(&scaled(1.0, 3.0, 0.5))),
        ("disk", Box::new(Disk { radius: 0.7 }), askew.then(&scaled(1.0, 3.0, 0.5))),
        ("sphere", Box::new(Sphere { radius: 0.8 }), askew),
        ("ellipsoid", Box::new(Sphere { radius: 0.8 }), askew.then(&scaled(1.0, 2.0, 0.5))),
        ("mesh", Box::new(icosahedron()), askew),
    ]
}

/// The density of a sample equals `pdf` at its point, including the choice of the light, and weight·density is the radiance, 1.
#[test]
fn pdf_is_the_density() {
    let mut random = Random::new(5);
    for (name, geometry, place) in families() {
        let lights = lit(&*geometry, &place, true);
        for _ in 0..4000 {
            let from = (random.in_cube() * random.decade(-0.5, 3.0)).as_vec3();
            let cx = LightSampleContext::at(from);
            let Some(sample) = lights.sample(&cx, random.unit() as f32, random.square()) else { continue };
            let ShadowTarget::Surface(point) = sample.target else { panic!("{name}: a light on a surface") };
            let (density, pdf) = (smooth(&sample), f64::from(lights.pdf(sample.light, &cx, &point).get()));
            // A grazing angle magnifies the rounding of the point's normal and position, 6·10⁻⁸.
            let flat = f64::from(point.ng.dot(sample.wi).abs());
            assert!((density - pdf).abs() <= pdf * (1e-5 + 1e-6 / flat), "{name} from {from}: {density} or {pdf}, cos {flat}");
            assert_near(f64::from(sample.weight().average()) * density, 1.0, 1e-6, name);
        }
    }
}

/// In the plane of a light, and closer to it than f32 can square, samples are absent or finite.
#[test]
fn samples_near_a_light_are_finite() {
    let mut random = Random::new(7);
    for (name, geometry, _) in families() {
        let lights = lit(&*geometry, &moved(0.3, 0.7, 0.0), true);
        for k in 0..4000 {
            let height = if k % 2 == 0 { 0.0 } else { random.decade(-38.0, -3.0) };
            let from = DVec3::new(random.range(-2.0, 2.0), random.range(-2.0, 2.0), height).as_vec3();
            let Some(sample) = lights.sample(&LightSampleContext::at(from), random.unit() as f32 * 0.999, random.square()) else {
                continue;
            };
            let sound = sample.weight().is_valid() && smooth(&sample).is_finite() && sample.wi.is_normalized();
            assert!(sound, "{name} from {from:?}: {sample:?}");
        }
    }
}

/// From within two radii, rectangles and triangles are sampled uniformly in their solid angle Ω. Girard's formula, the sum of the angles
/// between the planes of the edges less π, is another one than that of the library.
#[test]
fn near_lights_are_sampled_by_solid_angle() {
    let girard = |corners: [DVec3; 3]| {
        let normal = |k: usize| corners[k].cross(corners[(k + 1) % 3]);
        let angles = (0..3).map(|k| PI - normal(k).angle_between(normal((k + 2) % 3)));
        angles.sum::<f64>() - PI
    };
    let mut random = Random::new(8);
    let corners = [(-0.5, -0.3, 0.0), (0.5, -0.3, 0.0), (0.5, 0.3, 0.0), (-0.5, 0.3, 0.0)].map(DVec3::from);
    let triangle = mesh(corners[..3].iter().map(|p| p.as_vec3()).collect(), vec![[0, 1, 2]]);
    let quad = lit(&Quad { size: [1.0, 0.6] }, &Transform::IDENTITY, true);
    for (lights, halves) in [(&quad, 2), (&lit(&TriangleMesh::new(triangle), &Transform::IDENTITY, true), 1)] {
        for _ in 0..2000 {
            let from = random.in_cube() * 0.6;
            if from.z.abs() < 0.05 {
                continue;
            }
            let seen = |[a, b, c]: [usize; 3]| girard([corners[a] - from, corners[b] - from, corners[c] - from]);
            let solid_angle: f64 = [[0, 1, 2], [0, 2, 3]][..halves].iter().map(|&corners| seen(corners)).sum();
            let sample = lights.sample(&LightSampleContext::at(from.as_vec3()), 0.5, random.square()).expect("a sample");
            assert_near(smooth(&sample) * solid_angle, 1.0, 1e-5, &format!("{halves} triangles from {from}"));
            let ShadowTarget::Surface(point) = sample.target else { panic!("a light on a surface") };
            let pdf = lights.pdf(0, &LightSampleContext::at(from.as_vec3()), &point);
            assert_eq!(f64::from(pdf.get()), smooth(&sample), "{halves} triangles from {from}");
        }
    }
}

const REFERENCE: DVec3 = DVec3::new(3.0, 4.0, 5.0);

/// Fraction of emitted rays that are of `light`, together with a point light of the given power (W).
fn share(light: Light, shapes: Vec<Box<dyn Shape>>, radius: f32, power: f64) -> f64 {
    let reference = Light::Point(Point { position: REFERENCE, intensity: Rgb::gray((power / (2.0 * TAU)) as f32) });
    let lights = Lights::new(vec![light, reference], shapes.into(), (Vec3::ZERO, radius));
    f64::from(lights.emission_probability(0))
}

/// The probability that an emitted ray is of a light follows from the formulas of flux: Φ/(Φ + Φ′).
#[test]
fn rays_are_emitted_by_power() {
    let gray = Rgb::new(1.0, 2.0, 6.0); // 3 in the mean
    let area = |two_sided| Light::Area(Area::new(0, 0, Emitter { two_sided, ..Emitter::new(gray) }));
    let spot = Spot {
        position: DVec3::new(0.0, 0.0, 2.0),
        axis: Vec3::NEG_Z,
        intensity: gray,
        cos_inner: 0.9,
        cos_outer: 0.7,
        falloff: Falloff::Smooth,
    };
    let quad = || vec![Quad { size: [2.0, 3.0] }.bake(&moved(0.0, 0.0, 2.0)).expect("it can be hit")];
    let sphere = || vec![Sphere { radius: 2.0 }.bake(&moved(0.0, 0.0, 5.0)).expect("it can be hit")];
    let cases = [
        ("quad", area(false), quad(), PI * 6.0 * 3.0),
        ("two-sided quad", area(true), quad(), 2.0 * PI * 6.0 * 3.0),
        ("sphere", area(false), sphere(), PI * (4.0 * PI * 4.0) * 3.0),
        ("point", Light::Point(Point { position: DVec3::Y, intensity: gray }), vec![], 4.0 * PI * 3.0),
        // The mean of s²(3 − 2s) over s is ½.
        ("spot", Light::Spot(spot), vec![], TAU * 3.0 * (0.1 + 0.5 * 0.2)),
        ("directional", Light::Directional(Directional { direction: Vec3::NEG_Z, irradiance: gray }), vec![], PI * 100.0 * 3.0),
        ("environment", Light::Environment(Environment { radiance: gray }), vec![], 4.0 * PI * PI * 100.0 * 3.0),
    ];
    for (name, light, shapes, power) in cases {
        // An eighth of the rays is divided equally: ⅞ · ¼ + ⅛ · ½.
        assert_near(share(light, shapes, 10.0, 3.0 * power), 9.0 / 32.0, 1e-6, name);
    }
}

/// Under a uniform sky E = πL, and the density is 1/4π times the probability of the sky.
#[test]
fn irradiance_and_probability_of_the_sky() {
    let sky = Light::Environment(Environment { radiance: Rgb::WHITE });
    let alone = Lights::new(vec![sky.clone()], Vec::new().into(), (Vec3::ZERO, 1.0));
    // Half of the sphere is below the horizon, where the integrand has a kink.
    assert_near(irradiance(&[alone], DVec3::X, DVec3::new(0.6, 0.0, 0.8), 256), PI, 1e-3, "sky");
    // Where there is no surface the sky brings 4π, and the point light 3π/50 over the distance √50. A quarter of the choices is divided
    // equally.
    let share = 0.75 * (4.0 / (4.0 + 3.0 / 50.0)) + 0.125;
    let point = Light::Point(Point { position: REFERENCE, intensity: Rgb::gray(3.0 * std::f32::consts::PI) });
    let both = Lights::new(vec![point, sky], Vec::new().into(), (Vec3::ZERO, 1.0));
    assert_near(
        f64::from(both.background_pdf(1, &LightSampleContext::at(Vec3::ZERO), Vec3::X).get()),
        share / (2.0 * TAU),
        1e-6,
        "the choice among lights",
    );
    let sample = both.sample(&LightSampleContext::at(Vec3::ZERO), 0.3, Vec2::splat(0.3)).expect("the sky is everywhere");
    assert_near(smooth(&sample), share / (2.0 * TAU), 1e-6, "density of the sample");
}

/// Two skies light like one of their summed radiance: what arrives along a ray, what is sampled, and the densities.
#[test]
fn infinite_lights_add_up() {
    let sky = |radiance| Light::Environment(Environment { radiance: Rgb::gray(radiance) });
    let both = Lights::new(vec![sky(1.0), sky(2.0)], Vec::new().into(), (Vec3::ZERO, 1.0));
    let arriving: Vec<(u32, f32)> = both.background(Vec3::X).map(|(light, radiance)| (light, radiance.average())).collect();
    assert_eq!(arriving, [(0, 1.0), (1, 2.0)]);
    let cx = LightSampleContext::at(Vec3::ZERO);
    let density: f64 = [0, 1].map(|light| f64::from(both.background_pdf(light, &cx, Vec3::X).get())).iter().sum();
    assert_near(density, 1.0 / (2.0 * TAU), 1e-6, "density of both");
    // The integral of 3 cos θ over the hemisphere; the grid leaves a kink at the horizon.
    // The probabilities are ¾·⅓ + ⅛ = ⅜ and ⅝, as are the shares of eight choices.
    let choices = (0..8).flat_map(|k| grid(128).map(move |u| ((k as f32 + 0.5) / 8.0, u)));
    let samples = choices.filter_map(|(choice, u)| both.sample(&cx, choice, u));
    let sum: f64 = samples.map(|s| f64::from(s.weight().average() * s.wi.z.max(0.0))).sum();
    assert_near(sum / (8.0 * 128.0 * 128.0), 3.0 * PI, 2e-3, "light of both");
}

/// Falloff s = (outer − θ)/(outer − inner) for cones whose cosines round to 1 in f32.
#[test]
fn narrow_cones_fall_off_in_the_angle() {
    let (inner, outer) = (0.01, 0.05);
    let [cos_inner, cos_outer] = [inner, outer].map(|degrees| sin_cos_degrees(degrees).1);
    let falloff = Falloff::Linear;
    let spot = Spot { position: DVec3::ZERO, axis: Vec3::NEG_Z, intensity: Rgb::WHITE, cos_inner, cos_outer, falloff };
    let lights = Lights::new(vec![Light::Spot(spot)], Vec::new().into(), (Vec3::ZERO, 1.0));
    for degrees in [0.0, 0.009, 0.02, 0.03, 0.04, 0.049] {
        let point = Vec3::new(f64::to_radians(degrees).tan() as f32, 0.0, -1.0);
        let found = lights.sample(&LightSampleContext::at(point), 0.5, Vec2::splat(0.5)).expect("within the cone").weight().to_rgb()[0];
        let expected = ((outer - degrees) / (outer - inner)).min(1.0);
        // The unit vector towards the light is rounded by 6·10⁻⁸, that is 3.4·10⁻⁶ of the 0.04 degrees.
        assert_near(f64::from(found), expected, 1e-3, &format!("at {degrees}°"));
    }
    let beyond = LightSampleContext::at(Vec3::new(f64::to_radians(0.051).tan() as f32, 0.0, -1.0));
    assert!(lights.sample(&beyond, 0.5, Vec2::splat(0.5)).is_none(), "beyond");
}

/// Falloff s² with s linear in the cosine: half way between the cosines it is ¼.
#[test]
fn cones_fall_off_with_the_square() {
    let (cos_inner, cos_outer) = (0.9, 0.5);
    let spot = Spot { position: DVec3::ZERO, axis: Vec3::NEG_Z, intensity: Rgb::WHITE, cos_inner, cos_outer, falloff: Falloff::Squared };
    let lights = Lights::new(vec![Light::Spot(spot)], Vec::new().into(), (Vec3::ZERO, 1.0));
    for (cos, expected) in [(0.95f64, 1.0), (0.8, 0.5625), (0.7, 0.25), (0.6, 0.0625)] {
        let point = Vec3::new((1.0 - cos * cos).sqrt() as f32, 0.0, -cos as f32);
        let found = lights.sample(&LightSampleContext::at(point), 0.5, Vec2::splat(0.5)).expect("within the cone").weight().to_rgb()[0];
        assert_near(f64::from(found), expected, 1e-5, &format!("at a cosine of {cos}"));
    }
}

/// A lamp with a white half and a black half lights like half a lamp, also if the estimated probability of its light is wrong.
#[test]
fn textured_lamps_light_as_their_bright_part_does() {
    use pt::texture::image::{Filter, Image, Pixels, Wrap};
    let pixels = Pixels::new(glam::UVec2::new(2, 1), vec![[1.0; 3], [0.0; 3]]).expect("two pixels");
    let image = Image { pixels: pixels.into(), pyramid: None, scale: Vec2::ONE, wrap: Wrap::Clamp, filter: Filter::Nearest };
    let plain = Emitter::new(Rgb::gray(3.0));
    let textured = Emitter { texture: Some(std::sync::Arc::new(pt::texture::Texture::Image(image))), ..plain.clone() };
    let down = |x: f64| Transform::look_at(DVec3::new(x, 0.0, 1.0), DVec3::new(x, 0.0, 2.0), DVec3::Y).expect("a place");
    let irradiance = |size: [f64; 2], x: f64, emitter: Emitter| {
        let shape = Quad { size }.bake(&down(x)).expect("a quad");
        let lights = Lights::new(vec![Light::Area(Area::new(0, 0, emitter))], vec![shape].into(), (Vec3::ZERO, 1.0));
        const N: u32 = 256;
        let middle = |k: u32| (k as f32 + 0.5) / N as f32;
        let cx = LightSampleContext::at(Vec3::new(0.3, 0.2, 0.0));
        let each = (0..N * N).filter_map(|k| lights.sample(&cx, 0.5, Vec2::new(middle(k % N), middle(k / N))));
        each.map(|sample| f64::from(sample.weight().to_rgb()[0] * sample.wi.z.max(0.0))).sum::<f64>() / f64::from(N * N)
    };
    let whole = irradiance([2.0, 2.0], 0.0, textured);
    // The lamp faces down, so that u runs along −x or x. One of the two halves is white.
    let halves = [-0.5, 0.5].map(|x| irradiance([1.0, 2.0], x, plain.clone()));
    let nearest = halves.iter().map(|half| (whole / half - 1.0).abs()).fold(f64::INFINITY, f64::min);
    // One column of the grid, with 1/256 of the light, may be on either side of the edge.
    assert!(nearest < 0.01, "{whole}, expected one of {halves:?}");
    assert!((halves[0] / halves[1] - 1.0).abs() > 0.1, "the halves are told apart");
}
