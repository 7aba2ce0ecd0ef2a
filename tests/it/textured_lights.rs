//! Lights whose emission a texture varies: where on a primitive their samples lie.

use std::sync::Arc;

use glam::{DVec3, UVec2, Vec2, Vec3};
use pt::light::{Area, Emitter, Light, LightSample, LightSampleContext, Lights, ShadowTarget};
use pt::math::{Density, Rgb, Transform};
use pt::shape::{BilinearPatch, Cone, Cuboid, Cylinder, Disk, Geometry, PartialDisk, PartialSphere, Quad, Shape, Sphere, TriangleMesh};
use pt::texture::image::{Filter, Image, Pixels, Wrap};
use pt::texture::{Texture, TextureContext};

use crate::random::Random;
use pt::torture::meshes::mesh;

/// A picture of 32 × 32 pixels with a bright spot on a dim ground.
fn spot() -> Emitter {
    const SIDE: u32 = 32;
    let pixel = |k: u32| {
        let at = Vec2::new((k % SIDE) as f32, (k / SIDE) as f32) / SIDE as f32 - Vec2::new(0.35, 0.4);
        [0.05 + 40.0 * (-at.length_squared() / 0.005).exp(); 3]
    };
    let pixels = Pixels::new(UVec2::splat(SIDE), (0..SIDE * SIDE).map(pixel).collect()).expect("pixels");
    let image = Image { pixels: pixels.into(), pyramid: None, scale: Vec2::ONE, wrap: Wrap::Clamp, filter: Filter::Bilinear };
    Emitter { texture: Some(Arc::new(Texture::Image(image))), ..Emitter::new(Rgb::gray(2.0)) }
}

/// A triangle, the texture coordinates of which are its barycentric weights.
fn triangle() -> TriangleMesh {
    TriangleMesh::new(mesh(vec![Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.5, -0.8, 0.2), Vec3::new(-0.6, 1.0, -0.1)], vec![[0, 1, 2]]))
}

/// Shapes with their names, in the order of sampling by solid angle, by area and by other densities.
fn shapes() -> Vec<(&'static str, Box<dyn Geometry>, Transform)> {
    let turned = Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 140.0).expect("an axis");
    let stretched = Transform::scale(DVec3::new(0.5, 0.8, 1.3)).expect("a scale");
    let skewed = stretched.then(&turned);
    let corners = [[-0.8, -0.7, 0.1], [0.8, -0.6, 0.0], [-0.7, 0.8, -0.1], [0.6, 0.7, 0.2]].map(DVec3::from);
    vec![
        ("quad", Box::new(Quad { size: [1.6, 1.2] }), turned),
        ("disk", Box::new(Disk { radius: 0.8 }), turned),
        ("sphere", Box::new(Sphere { radius: 0.8 }), turned),
        ("ellipsoid", Box::new(Sphere { radius: 0.8 }), stretched.then(&turned)),
        ("box", Box::new(Cuboid { size: [0.8, 0.9, 1.0] }), turned),
        ("triangle", Box::new(triangle()), turned),
        ("cylinder", Box::new(Cylinder { radius: 0.8, z: [-0.5, 0.7], phi_max: 360.0 }), skewed),
        ("cone", Box::new(Cone { radius: 0.8, height: 0.9, phi_max: 300.0 }), skewed),
        ("belt", Box::new(PartialSphere { radius: 0.8, z: [-0.78, 0.7], phi_max: 360.0 }), skewed),
        ("ring", Box::new(PartialDisk { radius: 0.8, inner_radius: 0.4, phi_max: 270.0 }), turned),
        ("patch", Box::new(BilinearPatch { corners }), turned),
    ]
}

fn baked(geometry: &dyn Geometry, to_world: &Transform) -> Box<dyn Shape> {
    geometry.bake(to_world).expect("the shape can be hit")
}

/// Each primitive of a shape as the only light.
fn alone(geometry: &dyn Geometry, to_world: &Transform, emitter: &Emitter) -> Vec<Lights> {
    let light = |primitive| {
        let area = Area::new(0, primitive, emitter.clone());
        Lights::new(vec![Light::Area(area)], vec![baked(geometry, to_world)].into(), (Vec3::ZERO, 1.0))
    };
    (0..baked(geometry, to_world).count()).map(light).collect()
}

fn grid(n: u32) -> impl Iterator<Item = Vec2> {
    (0..n * n).map(move |k| (Vec2::new((k % n) as f32, (k / n) as f32) + 0.5) / n as f32)
}

fn density(sample: &LightSample) -> f64 {
    let Density::Smooth(pdf) = sample.density else { panic!("an area light has a density") };
    f64::from(pdf.get())
}

/// Sum over the area of a primitive of f(point, dA), by the uniform numbers of its sampling.
fn integral(shape: &dyn Shape, primitive: u32, f: impl Fn(&pt::shape::SurfacePoint) -> f64) -> f64 {
    const N: u32 = 512;
    let term = |u| {
        let (point, pdf) = shape.sample_area(primitive, u);
        f(&point) / f64::from(pdf.get())
    };
    grid(N).map(term).sum::<f64>() / f64::from(N * N)
}

/// Number of samples of a test.
const COUNT: u32 = 1 << 18;

fn samples(lights: &Lights, cx: &LightSampleContext) -> Vec<Option<LightSample>> {
    let mut random = Random::new(7);
    let mut number = move || (random.bits() >> 40) as f32 * 2f32.powi(-24);
    (0..COUNT).map(|_| lights.sample(cx, 0.5, Vec2::new(number(), number()))).collect()
}

/// The light that arrives is that of an integral over the surface without any sampling, from near and from far; every sample has the
/// density that a ray which finds its point is given; and the densities integrate to one.
#[test]
fn emission_is_sampled_in_proportion_to_its_texture() {
    for (name, geometry, to_world) in shapes() {
        let shape = baked(&*geometry, &to_world);
        // One side of a curved shape hides the other.
        let is_curved = matches!(name, "sphere" | "ellipsoid" | "cylinder" | "cone" | "belt");
        let emitter = Emitter { two_sided: !is_curved, ..spot() };
        for (primitive, lights) in (0..).zip(alone(&*geometry, &to_world, &emitter)) {
            for from in [Vec3::new(0.4, 1.5, 1.2), Vec3::new(-30.0, 50.0, 20.0), Vec3::new(60.0, -20.0, -40.0)] {
                let cx = LightSampleContext::at(from);
                // The fluence: the radiance from all directions.
                let of_a_point = |point: &pt::shape::SurfacePoint| {
                    let line = (point.p - from).as_dvec3();
                    (point.ng.as_dvec3().dot(line).abs() / line.length().powi(3), -line.as_vec3())
                };
                let expected = integral(&*shape, primitive, |point| {
                    let (angle, w) = of_a_point(point);
                    f64::from(emitter.at(&TextureContext::exact(point)).towards(point.ng, w).average()) * angle
                });
                let whole = integral(&*shape, primitive, |point| of_a_point(point).0 * f64::from(lights.pdf(0, &cx, point).get()));
                assert!(is_curved || (whole - 1.0).abs() < 0.01, "{name} {primitive} from {from}: the densities sum to {whole}");
                let samples = samples(&lights, &cx);
                let weights: Vec<f64> = samples.iter().flatten().map(|s| f64::from(s.weight().average())).collect();
                let found = weights.iter().sum::<f64>() / f64::from(COUNT);
                let variance = weights.iter().map(|w| w * w).sum::<f64>() / f64::from(COUNT) - found * found;
                let z = (found - expected) / (variance / f64::from(COUNT)).sqrt();
                // 48 cases, so that one of them exceeds the bound by chance once in 3000 times.
                assert!(z.abs() < 4.5, "{name} {primitive} from {from}: {found}, expected {expected}, z = {z}");
                for sample in samples.iter().flatten().step_by(997) {
                    let ShadowTarget::Surface(point) = sample.target else { panic!("a point on the shape") };
                    let stated = f64::from(lights.pdf(0, &cx, &point).get());
                    assert!((stated / density(sample) - 1.0).abs() < 1e-5, "{name} from {from}: {stated}, sampled by {}", density(sample));
                }
            }
        }
    }
}

/// From afar the variance of one sample is a small share of that of points spread evenly, which is ∫ L² / (∫ L)² − 1, here 17 to 25.
#[test]
fn peaks_of_emission_cost_little_noise() {
    for (name, geometry, to_world) in shapes() {
        let shape = baked(&*geometry, &to_world);
        let emitter = Emitter { two_sided: true, ..spot() };
        for (primitive, lights) in (0..).zip(alone(&*geometry, &to_world, &emitter)) {
            let spread = |values: &[f64]| {
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                values.iter().map(|v| (v / mean - 1.0).powi(2)).sum::<f64>() / values.len() as f64
            };
            let weight = |sample: &Option<LightSample>| sample.map_or(0.0, |s| f64::from(s.weight().average()));
            let cx = LightSampleContext::at(Vec3::new(3000.0, 1000.0, 2000.0));
            let found = spread(&samples(&lights, &cx).iter().map(weight).collect::<Vec<f64>>());
            let of_a_point = |u| f64::from(emitter.at(&TextureContext::exact(&shape.sample_area(primitive, u).0)).radiance.average());
            let even = spread(&grid(512).map(of_a_point).collect::<Vec<f64>>());
            assert!(found < even / 50.0, "{name} {primitive}: {found}, spread evenly {even}");
        }
    }
}
