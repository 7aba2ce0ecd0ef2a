//! Cost of the scattering models: nanoseconds of CPU time to sample a direction, and to evaluate f and pdf for it.
//!
//! `cargo bench --bench bsdfs`. Directions and numbers are prepared beforehand; the fastest of several rounds counts. The sample is not
//! copied: a copy would add some 3 ns to every model, and integrators read the fields of the sample directly.

use std::hint::black_box;

use cpu_time::ProcessTime;
use glam::{Vec2, Vec3};
use pt::bsdf::microfacet::Distribution;
use pt::bsdf::microfacet::roughness::{Alpha, Roughness};
use pt::bsdf::{Bsdf, Element, HitContext, Material, TransportMode, textured};
use pt::math::{Local, Rgb, warp};
use pt::sampler::{Kind, SamplerSpec};
use pt::shape::SurfacePoint;

const COUNT: usize = 1 << 14;
const ROUNDS: usize = 400;

fn main() {
    let gray = || Rgb::gray(0.5);
    let (eta, k) = Element::Au.index();
    let roughness = |alpha: Vec2, distribution| Roughness { alpha: Alpha::Constant(alpha), distribution };
    let round = || roughness(Vec2::splat(0.3), Distribution::Ggx);
    let models = [
        ("diffuse", Material::diffuse(gray())),
        ("oren_nayar", Material::OrenNayar(textured::OrenNayar { albedo: gray().into(), roughness: 0.5.into() })),
        ("mirror", Material::mirror(gray())),
        ("conductor", Material::metal((eta, k), None, true)),
        ("conductor, GGX", Material::metal((eta, k), Some(round()), false)),
        ("conductor, GGX, multiscatter", Material::metal((eta, k), Some(round()), true)),
        ("conductor, GGX 4:1", Material::metal((eta, k), Some(roughness(Vec2::new(0.6, 0.15), Distribution::Ggx)), false)),
        ("conductor, Beckmann", Material::metal((eta, k), Some(roughness(Vec2::splat(0.3), Distribution::Beckmann)), false)),
        ("dielectric", Material::glass(1.5)),
        ("dielectric, GGX", Material::rough_glass(1.5, Rgb::WHITE, round(), false)),
        ("dielectric, GGX, multiscatter", Material::rough_glass(1.5, Rgb::WHITE, round(), true)),
        ("thin_dielectric", Material::ThinDielectric(textured::ThinDielectric { eta: 1.5.into(), color: Rgb::WHITE.into() })),
        ("matte_cone", Material::MatteCone(textured::MatteCone { color: gray().into(), mattness: 0.3.into() })),
        ("phong", Material::Phong(textured::Phong { color: gray().into(), exponent: 30.0.into() })),
        ("blinn_phong", Material::BlinnPhong(textured::BlinnPhong { color: gray().into(), exponent: 30.0.into() })),
        ("metal", Material::Metal(textured::Metal { color: gray().into(), roughness: 0.3.into() })),
        ("plastic", Material::plastic(gray(), 1.5)),
        (
            "diffuse_transmission",
            Material::DiffuseTransmission(textured::DiffuseTransmission { reflectance: gray().into(), transmittance: gray().into() }),
        ),
    ];
    let inputs = inputs();
    println!("{:32}{:>12}{:>16}", "ns of CPU time", "sample", "eval + pdf");
    for (name, material) in models {
        let model = material.bsdf_at(&HitContext::from_outside(SurfacePoint {
            p: Vec3::ZERO,
            offset: 0.0,
            ng: Vec3::Z,
            ns: Vec3::Z,
            uv: Vec2::ZERO,
            color: pt::shape::VertexColor::WHITE,
        }));
        let sample = fastest(|| sample_all(&model, &inputs));
        let evaluate = fastest(|| evaluate_all(&model, &inputs));
        println!("{name:32}{sample:12.1}{evaluate:16.1}");
    }
}

struct Input {
    wo: Local,
    wi: Local,
    choice: f32,
    u: Vec2,
}

fn inputs() -> Vec<Input> {
    let sequence = SamplerSpec { kind: Kind::Independent, seed: 1, spp: COUNT as u64, ..SamplerSpec::default() }.build();
    let one = |index| {
        let mut numbers = sequence.sample(glam::UVec2::ZERO, index);
        let (wo, wi) = (warp::cosine_hemisphere(numbers.get_2d(0)), warp::cosine_hemisphere(numbers.get_2d(2)));
        let (choice, u) = numbers.get_3d(4);
        Input { wo: Local(wo), wi: Local(wi), choice, u }
    };
    (0..COUNT as u64).map(one).collect()
}

fn sample_all(model: &Bsdf, inputs: &[Input]) {
    for input in inputs {
        // The result is passed by reference, so that the measurement does not include a copy of it.
        black_box(&black_box(model).sample(input.wo, input.choice, input.u, TransportMode::Radiance));
    }
}

fn evaluate_all(model: &Bsdf, inputs: &[Input]) {
    for input in inputs {
        black_box((black_box(model).eval(input.wo, input.wi, TransportMode::Radiance), model.pdf(input.wo, input.wi)));
    }
}

/// Time per input of the fastest round (ns).
fn fastest(mut run: impl FnMut()) -> f64 {
    let mut round = || {
        let start = ProcessTime::now();
        run();
        start.elapsed().as_secs_f64() * 1e9 / COUNT as f64
    };
    (0..ROUNDS).map(|_| round()).fold(f64::INFINITY, f64::min)
}
