//! Rays that lights emit carry the light that light sampling finds.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec3, Mat3, UVec2, Vec2, Vec3};
use pt::light::{
    Area, Directional, EmittedRay, Emitter, Environment, EnvironmentMap, Falloff, Light, LightSampleContext, Lights, Mapping, Point, Spot,
    Sun,
};
use pt::math::{AreaPdf, Rgb, SolidAnglePdf, Transform};
use pt::sampler::{Kind, SamplerSpec, Sequence};
use pt::shape::{Cuboid, Disk, Geometry, Quad, Shape, Sphere};
use pt::texture::Texture;
use pt::texture::image::{Filter, Image, Pixels, Wrap};

use pt::torture::everything::{profile, projector};

/// Bounding sphere of the scenes: centre and radius (m).
const BOUNDS: (Vec3, f32) = (Vec3::new(0.2, -0.1, 0.3), 2.5);

/// Lights, and the shapes that they refer to.
type LightsAndShapes = (Vec<Light>, Vec<Box<dyn Shape>>);

fn area(geometry: impl Geometry, at: DVec3, emitter: Emitter) -> LightsAndShapes {
    let turned = Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 40.0).expect("an axis");
    let shape = geometry.bake(&turned.then(&Transform::translate(at).expect("finite"))).expect("a shape");
    let light = |primitive| Light::Area(Area::new(0, primitive, emitter.clone()));
    ((0..shape.count()).map(light).collect(), vec![shape])
}

/// An emitting ellipsoid of revolution and its flux π L A, with the area A of a prolate spheroid: 2π a² (1 + c/(a e) asin e).
fn ellipsoid(at: DVec3) -> (LightsAndShapes, f64) {
    let (a, c) = (0.2f64, 0.5f64);
    let stretched = Transform::scale(DVec3::new(a, a, c)).expect("a scale");
    let shape = Sphere { radius: 1.0 }.bake(&stretched.then(&Transform::translate(at).expect("finite"))).expect("a shape");
    let e = (1.0 - (a / c).powi(2)).sqrt();
    let light = Light::Area(Area::new(0, 0, gray(2.0)));
    ((vec![light], vec![shape]), PI * 2.0 * TAU * a * a * (1.0 + c / (a * e) * e.asin()))
}

fn gray(value: f32) -> Emitter {
    Emitter::new(Rgb::gray(value))
}

/// Emission on the left half of a texture: 0 on the right.
fn half_white() -> Emitter {
    let pixels = Pixels::new(UVec2::new(2, 1), vec![[1.0; 3], [0.0; 3]]).expect("two pixels");
    let image = Image { pixels: pixels.into(), pyramid: None, scale: Vec2::ONE, wrap: Wrap::Clamp, filter: Filter::Nearest };
    Emitter { texture: Some(Arc::new(Texture::Image(image))), ..gray(3.0) }
}

fn spot(falloff: Falloff) -> Light {
    let axis = Vec3::new(0.3, -0.9, 0.2).normalize();
    Light::Spot(Spot { position: DVec3::new(0.5, 1.0, 0.2), axis, intensity: Rgb::gray(2.0), cos_inner: 0.9, cos_outer: 0.6, falloff })
}

/// Lights alone in a scene, with their flux (W) by the formulas of geometry.
fn lights() -> Vec<(&'static str, Lights, f64)> {
    let at = DVec3::new(0.4, 1.1, -0.2);
    let two_sided = Emitter { two_sided: true, ..gray(1.5) };
    let alone = |light: Light| (vec![light], vec![]);
    let place = DVec3::new(-0.3, 0.9, 0.4);
    let angle = [0.9f64, 0.6].map(f64::acos);
    // ∫ (outer − θ)/(outer − inner) sin θ dθ between the cones, by parts.
    let linear = angle[0].cos() - (angle[1].sin() - angle[0].sin()) / (angle[1] - angle[0]);
    let ellipsoid = ellipsoid(at);
    let sun = PI * 6.25 * TAU * (1.0 - 30f64.to_radians().cos()) * 3.0;
    let (map, mean) = environment_map();
    let rows: Vec<(&'static str, LightsAndShapes, f64)> = vec![
        ("quad", area(Quad { size: [0.8, 0.5] }, at, gray(3.0)), PI * 3.0 * 0.4),
        ("two-sided quad", area(Quad { size: [0.8, 0.5] }, at, two_sided), 2.0 * PI * 1.5 * 0.4),
        ("textured quad", area(Quad { size: [0.8, 0.5] }, at, half_white()), PI * 3.0 * 0.2),
        ("textured disk", area(Disk { radius: 0.4 }, at, half_white()), PI * 3.0 * PI * 0.08),
        ("disk", area(Disk { radius: 0.4 }, at, gray(2.0)), PI * 2.0 * PI * 0.16),
        ("sphere", area(Sphere { radius: 0.3 }, at, gray(2.0)), PI * 2.0 * 4.0 * PI * 0.09),
        ("ellipsoid", ellipsoid.0, ellipsoid.1),
        ("box", area(Cuboid { size: [0.3, 0.4, 0.5] }, at, gray(1.0)), PI * 2.0 * (0.12 + 0.15 + 0.2)),
        ("point", alone(Light::Point(Point { position: place, intensity: Rgb::gray(2.0) })), 4.0 * PI * 2.0),
        ("spot, smooth", alone(spot(Falloff::Smooth)), TAU * 2.0 * (1.0 - 0.75)),
        ("spot, squared", alone(spot(Falloff::Squared)), TAU * 2.0 * (0.1 + 0.3 / 3.0)),
        ("spot, linear", alone(spot(Falloff::Linear)), TAU * 2.0 * (0.1 + linear)),
        // I before the light, and falling to 0 behind it: 2π I (1 + ∫ (1 − 2x/π) cos x dx from 0 to π/2) = 2π I (1 + 2/π).
        ("profile", alone(profile()), 2.0 * TAU * (1.0 + 2.0 / PI)),
        // The solid angle of a square pyramid whose half angles have the tangent t is 4 asin(t²/(1 + t²)).
        ("projector", alone(projector()), 2.0 * 4.0 * (0.09f64 / 1.09).asin()),
        (
            "directional",
            alone(Light::Directional(Directional { direction: Vec3::new(0.2, -0.9, 0.4).normalize(), irradiance: Rgb::gray(1.5) })),
            PI * 6.25 * 1.5,
        ),
        ("sun", alone(Light::Sun(Sun::new(Vec3::new(0.2, -0.9, 0.4).normalize(), Rgb::gray(3.0), 30.0))), sun),
        ("map", alone(map), 4.0 * PI * PI * 6.25 * mean),
        ("sky", alone(Light::Environment(Environment { radiance: Rgb::gray(0.7) })), 4.0 * PI * PI * 6.25 * 0.7),
    ];
    rows.into_iter().map(|(name, (lights, shapes), flux)| (name, Lights::new(lights, shapes.into(), BOUNDS), flux)).collect()
}

/// A picture of 4 × 4 pixels, the second row of which is bright, and the mean of its radiance. The area of a pixel is the same on the
/// octahedral map, where the interpolation keeps the mean.
fn environment_map() -> (Light, f64) {
    let values = (0..16).map(|k| if k / 4 == 1 { [2.0; 3] } else { [0.1; 3] }).collect();
    let pixels = Arc::new(Pixels::new(UVec2::new(4, 4), values).expect("pixels"));
    let map = EnvironmentMap::new(pixels, Mapping::Octahedral, Rgb::WHITE, Mat3::IDENTITY);
    (Light::EnvironmentMap(Arc::new(map)), (4.0 * 2.0 + 12.0 * 0.1) / 16.0)
}

/// Random numbers of Sobol' sequences, whose pairs are evenly distributed.
fn sequence() -> Sequence {
    SamplerSpec { kind: Kind::Sobol, ..SamplerSpec::default() }.build()
}

fn rays(lights: &Lights, count: u32) -> impl Iterator<Item = EmittedRay> {
    let sequence = sequence();
    (0..count).filter_map(move |i| {
        let mut numbers = sequence.sample(UVec2::ZERO, i.into());
        let (choice, position) = numbers.get_3d(0);
        lights.emit(choice, position, numbers.get_2d(3), 0.0)
    })
}

/// A given ray has the densities with which it is emitted, to the rounding of its direction and its start.
#[test]
fn given_rays_have_the_densities_of_emitted_rays() {
    for (name, lights, _) in lights() {
        for ray in rays(&lights, 1 << 10) {
            let given = lights.emission_density(ray.light, ray.point.as_ref(), ray.ray.direction, 0.0);
            let positions = [given.position, ray.position].map(|density| density.smooth().map(AreaPdf::get));
            let directions = [given.direction, ray.direction].map(|density| density.smooth().map(SolidAnglePdf::get));
            for [given, emitted] in [positions, directions] {
                // The cosine of a direction near the horizon has lost digits: 10⁻⁶ of a density that is at most 1/π there.
                let tolerance = 1e-4 * emitted.unwrap_or(0.0) + 1e-6;
                assert_eq!(given.is_some(), emitted.is_some(), "{name}");
                assert!((given.unwrap_or(0.0) - emitted.unwrap_or(0.0)).abs() <= tolerance, "{name}: {given:?} and not {emitted:?}");
            }
            assert_eq!(lights.emission_probability(ray.light), ray.probability, "{name}");
        }
    }
}

/// The density of directions integrates to 1 over the sphere, so that it is 0 just where a light emits nothing.
#[test]
fn densities_of_directions_integrate_to_one() {
    const N: u32 = 300;
    let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(N);
    for (name, lights, _) in lights() {
        let ray = rays(&lights, 16).last().expect("an emitted ray");
        let density = |w: Vec3| lights.emission_density(ray.light, ray.point.as_ref(), w, 0.0).direction.smooth();
        if density(Vec3::Z).is_none() {
            assert_eq!(name, "directional");
            continue;
        }
        let mut sum = 0.0;
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            let (z, phi) = (2.0 * middle(i) - 1.0, TAU * middle(j));
            let w = DVec3::new((1.0 - z * z).sqrt() * phi.cos(), (1.0 - z * z).sqrt() * phi.sin(), z);
            sum += f64::from(density(w.as_vec3()).map_or(0.0, SolidAnglePdf::get)) * 4.0 * PI / f64::from(N * N);
        }
        // The edge of a cone cuts through about N of the N² cells.
        assert!((sum - 1.0).abs() < 1.0 / f64::from(N), "{name}: {sum}");
    }
}

/// Uniform directions to a disk, stated by area, integrate to 1 over the disk; converted back, they are uniform again.
#[test]
fn densities_convert_between_solid_angle_and_area() {
    const N: u32 = 4096;
    let (distance, radius) = (0.7f64, 1.3f64);
    let uniform = SolidAnglePdf::new((1.0 / (TAU * (1.0 - distance / distance.hypot(radius)))) as f32);
    let mut sum = 0.0;
    for k in 0..N {
        let r = radius * (f64::from(k) + 0.5) / f64::from(N);
        let line = DVec3::new(r, 0.0, -distance);
        let by_area = uniform.to_area(line, DVec3::Z);
        sum += f64::from(by_area.get()) * TAU * r * radius / f64::from(N);
        let back = by_area.to_solid_angle(line, DVec3::Z).expect("not edge-on");
        assert!((back.get() / uniform.get() - 1.0).abs() < 1e-6, "{back:?} at {r}");
    }
    // Each density is rounded to f32; the quadrature has an error of 1/N².
    assert!((sum - 1.0).abs() < 1e-6, "{sum}");
}

#[test]
fn emitted_flux_is_the_power() {
    const COUNT: u32 = 1 << 16;
    for (name, lights, flux) in lights() {
        let mean = rays(&lights, COUNT).map(|ray| f64::from(ray.flux().average())).sum::<f64>() / f64::from(COUNT);
        // Areas and cones are sampled with densities that leave little variance; the halves of the texture are counted to 2⁻¹⁰.
        assert!((mean / flux - 1.0).abs() < 2e-3, "{name}: {mean} W for {flux} W");
    }
}

/// The flux of the emitted rays that hit a disk is the irradiance over the disk as light sampling finds it, for disks in several places
/// and attitudes. This holds only if starts and directions have the densities that are stated.
#[test]
fn emitted_rays_light_what_light_samples_light() {
    const SIDE: u32 = 24;
    const RAYS: u32 = 1 << 21;
    let disks = [
        (DVec3::new(0.1, -0.6, 0.2), DVec3::new(0.1, 1.0, 0.2).normalize(), 0.6),
        (DVec3::new(-0.8, 0.3, 0.1), DVec3::new(1.0, 0.3, -0.1).normalize(), 0.5),
        (DVec3::new(0.3, 0.2, 1.2), DVec3::new(-0.2, 0.4, -1.0).normalize(), 0.5),
    ];
    for (name, lights, _) in lights() {
        let mut hit = [0.0; 3];
        for ray in rays(&lights, RAYS) {
            let (origin, w) = (ray.ray.origin.as_dvec3(), ray.ray.direction.as_dvec3());
            for (sum, (center, normal, radius)) in hit.iter_mut().zip(disks) {
                let t = (center - origin).dot(normal) / w.dot(normal);
                if w.dot(normal) < 0.0 && t > 0.0 && (origin + w * t - center).length() < radius {
                    *sum += f64::from(ray.flux().average()) / f64::from(RAYS);
                }
            }
        }
        for (found, (center, normal, radius)) in hit.into_iter().zip(disks) {
            let side = normal.any_orthonormal_vector();
            let mut expected = 0.0;
            let mut points = 0.0;
            let middle = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(SIDE) - 1.0;
            for (x, y) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (middle(i), middle(j)))).filter(|(x, y)| x * x + y * y < 1.0) {
                let p = center + (side * x + normal.cross(side) * y) * radius;
                points += 1.0;
                expected += irradiance(&lights, p, normal);
            }
            expected *= PI * radius * radius / points;
            // A hundredth of the rays of the sky hits a disk: four standard deviations of that number are 2.8 %. Where few rays hit, the
            // absolute part is as much.
            let tolerance = 0.03 * expected + 2e-4;
            assert!((found - expected).abs() < tolerance, "{name}, disk at {center}: {found} W for {expected} W");
        }
    }
}

/// Irradiance on a plane by light sampling [W·m⁻²].
fn irradiance(lights: &Lights, p: DVec3, normal: DVec3) -> f64 {
    const SAMPLES: u32 = 1024;
    let (cx, sequence) = (LightSampleContext::at(p.as_vec3()), sequence());
    let samples = (0..SAMPLES).filter_map(|i| {
        let (choice, u) = sequence.sample(UVec2::ZERO, i.into()).get_3d(0);
        lights.sample(&cx, choice, u)
    });
    samples.map(|s| f64::from(s.weight().average()) * s.wi.as_dvec3().dot(normal).max(0.0)).sum::<f64>() / f64::from(SAMPLES)
}
