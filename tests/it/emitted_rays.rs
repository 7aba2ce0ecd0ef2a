//! Rays that lights emit carry the light that light sampling finds.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec3, UVec2, Vec2, Vec3};
use pt::light::{Area, Directional, EmittedRay, Emitter, Environment, Falloff, Light, LightSampleContext, Lights, Point, Spot};
use pt::math::{Rgb, Transform};
use pt::sampler::{Kind, SamplerSpec, Sequence};
use pt::shape::{Cuboid, Disk, Geometry, Quad, Shape, Sphere};
use pt::texture::Texture;
use pt::texture::image::{Filter, Image, Pixels, Wrap};

/// Bounding sphere of the scenes: centre and radius (m).
const BOUNDS: (Vec3, f32) = (Vec3::new(0.2, -0.1, 0.3), 2.5);

/// Lights, and the shapes that they refer to.
type LightsAndShapes = (Vec<Light>, Vec<Box<dyn Shape>>);

fn area(geometry: impl Geometry, at: DVec3, emitter: Emitter) -> LightsAndShapes {
    let turned = Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 40.0).expect("an axis");
    let shape = geometry.bake(&turned.then(&Transform::translate(at).expect("finite"))).expect("a shape");
    let light = |primitive| Light::Area(Area { shape: 0, primitive, emitter: emitter.clone() });
    ((0..shape.count()).map(light).collect(), vec![shape])
}

fn gray(value: f32) -> Emitter {
    Emitter::new(Rgb::gray(value))
}

/// Emission on the left half of a texture: 0 on the right.
fn half_white() -> Emitter {
    let pixels = Pixels::new(UVec2::new(2, 1), vec![[1.0; 3], [0.0; 3]]).expect("two pixels");
    let image = Image { pixels: pixels.into(), scale: Vec2::ONE, wrap: Wrap::Clamp, filter: Filter::Nearest };
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
    let rows: Vec<(&'static str, LightsAndShapes, f64)> = vec![
        ("quad", area(Quad { size: [0.8, 0.5] }, at, gray(3.0)), PI * 3.0 * 0.4),
        ("two-sided quad", area(Quad { size: [0.8, 0.5] }, at, two_sided), 2.0 * PI * 1.5 * 0.4),
        ("textured quad", area(Quad { size: [0.8, 0.5] }, at, half_white()), PI * 3.0 * 0.2),
        ("disk", area(Disk { radius: 0.4 }, at, gray(2.0)), PI * 2.0 * PI * 0.16),
        ("sphere", area(Sphere { radius: 0.3 }, at, gray(2.0)), PI * 2.0 * 4.0 * PI * 0.09),
        ("box", area(Cuboid { size: [0.3, 0.4, 0.5] }, at, gray(1.0)), PI * 2.0 * (0.12 + 0.15 + 0.2)),
        ("point", alone(Light::Point(Point { position: place, intensity: Rgb::gray(2.0) })), 4.0 * PI * 2.0),
        ("spot, smooth", alone(spot(Falloff::Smooth)), TAU * 2.0 * (1.0 - 0.75)),
        ("spot, squared", alone(spot(Falloff::Squared)), TAU * 2.0 * (0.1 + 0.3 / 3.0)),
        ("spot, linear", alone(spot(Falloff::Linear)), TAU * 2.0 * (0.1 + linear)),
        (
            "directional",
            alone(Light::Directional(Directional { direction: Vec3::new(0.2, -0.9, 0.4).normalize(), irradiance: Rgb::gray(1.5) })),
            PI * 6.25 * 1.5,
        ),
        ("sky", alone(Light::Environment(Environment { radiance: Rgb::gray(0.7) })), 4.0 * PI * PI * 6.25 * 0.7),
    ];
    rows.into_iter().map(|(name, (lights, shapes), flux)| (name, Lights::new(lights, shapes.into(), BOUNDS), flux)).collect()
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
