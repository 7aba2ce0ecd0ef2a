//! Integrators of the course, from emission to multiple importance sampling, each with a classical mistake: docs/course/integrator.md.

use pt::bsdf::TransportMode::Radiance;
use pt::integrator::Entry;
use pt::light::LightSampleContext;
use pt::math::{Density, Local, Ray, SolidAnglePdf, Spectrum, Vec2, Vec3, balance_heuristic, power_heuristic, warp};
use pt::sampler::SampleNumbers;
use pt::sampler::dimension::{self, Use};
use pt::scene::{Scene, Surface};

use super::method::{Method, row};

/// Rows of the table of integrators.
pub const METHODS: &[Entry] = &[
    row("emission", "light that the camera sees directly", |_| Box::new(Method(emission))),
    row("one_bounce", "emission and direct light, by uniform directions", |_| Box::new(Method(one_bounce))),
    row("one_bounce_wrong", "one_bounce with the cosine twice", |_| Box::new(Method(one_bounce_wrong))),
    row("paths", "paths of up to 16 scattering events", |_| Box::new(Method(paths))),
    row("paths_wrong", "paths that forget what was scattered before", |_| Box::new(Method(paths_wrong))),
    row("roulette", "paths that Russian roulette ends", |_| Box::new(Method(roulette))),
    row("roulette_wrong", "roulette without compensation", |_| Box::new(Method(roulette_wrong))),
    row("light_samples", "paths with next-event estimation", |_| Box::new(Method(light_samples))),
    row("light_samples_wrong", "light_samples that count direct light twice", |_| Box::new(Method(light_samples_wrong))),
    row("weighted", "paths with multiple importance sampling", |_| Box::new(Method(weighted))),
    row("weighted_wrong", "weighted with two different heuristics", |_| Box::new(Method(weighted_wrong))),
];

/// Greatest number of scattering events of a path.
const MAX_DEPTH: u32 = 16;

/// Light from beyond all shapes.
pub fn background(scene: &dyn Scene, ray: &Ray) -> Spectrum {
    scene.lights().background(ray.direction).map(|(_, radiance)| radiance).sum()
}

/// Step 1. L = Le
pub fn emission(scene: &dyn Scene, ray: &Ray, _: &mut SampleNumbers) -> Spectrum {
    let Some(hit) = scene.intersect(ray) else { return background(scene, ray) };
    scene.surface(ray, &hit).emitted(-ray.direction)
}

/// Step 2. L = Le + f |cos θi| Le(from wi) / p(wi),  p = 1/2π
fn one_bounce(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    direct(scene, ray, numbers, |surface, wo, wi| surface.eval(wo, wi, Radiance))
}

/// Step 2 with a mistake: `eval` contains the cosine already.
fn one_bounce_wrong(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    direct(scene, ray, numbers, |surface, wo, wi| surface.eval(wo, wi, Radiance) * surface.point.ns.dot(wi).abs())
}

/// Step 2, with `f` for the product f(wo, wi) |cos θi|.
fn direct(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers, f: fn(&Surface, Vec3, Vec3) -> Spectrum) -> Spectrum {
    let Some(hit) = scene.intersect(ray) else { return background(scene, ray) };
    let surface = scene.surface(ray, &hit);
    let wo = -ray.direction;
    let (_, u) = numbers.get_3d(dimension::vertex(0, Use::Bsdf));
    let local = Local(warp::uniform_hemisphere(u)).on_the_side_of(surface.frame.to_local(wo));
    let wi = surface.frame.to_world(local);
    let pdf = 1.0 / (2.0 * std::f32::consts::PI);
    let arriving = emission(scene, &surface.spawn(wi, ray.time), numbers);
    surface.emitted(wo) + f(&surface, wo, wi) * arriving / pdf
}

/// Step 3. L = Σ_k β_k Le(x_k),  β_{k+1} = β_k f |cos θi| / p(wi)
fn paths(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    follow(scene, ray, numbers, sample_bsdf, |beta, weight, _| Some(beta * weight))
}

/// Step 3 with a mistake: what was scattered before is forgotten.
fn paths_wrong(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    follow(scene, ray, numbers, sample_bsdf, |_, weight, _| Some(weight))
}

/// Step 4. A path goes on with the probability q = min(1, β), and then counts 1/q times.
fn roulette(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    follow(scene, ray, numbers, sample_bsdf, |beta, weight, u| {
        let beta = beta * weight;
        let survival = beta.max().min(1.0);
        (u < survival).then(|| beta / survival)
    })
}

/// Step 4 with a mistake: the paths that go on do not stand for those that ended.
fn roulette_wrong(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    follow(scene, ray, numbers, sample_bsdf, |beta, weight, u| {
        let beta = beta * weight;
        (u < beta.max()).then_some(beta)
    })
}

/// The next direction and the factor f |cos θi| / p(wi), by the surface's own material. `None` if it absorbs the path.
fn sample_bsdf(surface: &Surface, wo: Vec3, choice: f32, u: Vec2) -> Option<(Vec3, Spectrum)> {
    surface.sample(wo, choice, u, Radiance).map(|(wi, sample)| (wi, sample.weight))
}

/// Steps 3 and 4.
///
/// - `scatter`: next direction and its factor, as [`sample_bsdf`]
/// - `go_on`: next throughput, by the one before, the factor and a random number; `None` ends the path
pub fn follow(
    scene: &dyn Scene,
    ray: &Ray,
    numbers: &mut SampleNumbers,
    scatter: impl Fn(&Surface, Vec3, f32, Vec2) -> Option<(Vec3, Spectrum)>,
    go_on: fn(Spectrum, Spectrum, f32) -> Option<Spectrum>,
) -> Spectrum {
    let (mut ray, mut beta, mut radiance) = (*ray, Spectrum::ONE, Spectrum::BLACK);
    for depth in 0..=MAX_DEPTH {
        let Some(hit) = scene.intersect(&ray) else { return radiance + beta * background(scene, &ray) };
        let surface = scene.surface(&ray, &hit);
        let wo = -ray.direction;
        radiance += beta * surface.emitted(wo);
        let (choice, u) = numbers.get_3d(dimension::vertex(depth, Use::Bsdf));
        let Some((wi, weight)) = scatter(&surface, wo, choice, u) else { return radiance };
        let Some(next) = go_on(beta, weight, numbers.get_1d(dimension::vertex(depth, Use::Roulette))) else { return radiance };
        (ray, beta) = (surface.spawn(wi, ray.time), next);
    }
    radiance
}

/// Weights of the same light, found by a light sample and by a material sample, from the densities of both.
struct Weights {
    light: fn(SolidAnglePdf, SolidAnglePdf) -> f32,
    material: fn(SolidAnglePdf, SolidAnglePdf) -> f32,
}

/// Step 5. L = Le(x_0) + Σ_k β_k f |cos θl| Ll / p_light
fn light_samples(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    next_event(scene, ray, numbers, &Weights { light: |_, _| 1.0, material: |_, _| 0.0 })
}

/// Step 5 with a mistake: a lamp that a path meets was counted already, by the light sample before.
fn light_samples_wrong(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    next_event(scene, ray, numbers, &Weights { light: |_, _| 1.0, material: |_, _| 1.0 })
}

/// Step 6. Both find the light, with weights w(p, q) = p / (p + q) that add up to 1.
fn weighted(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    next_event(scene, ray, numbers, &Weights { light: balance_heuristic, material: balance_heuristic })
}

/// Step 6 with a mistake: the weights do not add up to 1.
fn weighted_wrong(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    next_event(scene, ray, numbers, &Weights { light: power_heuristic, material: balance_heuristic })
}

/// Steps 5 and 6.
fn next_event(scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers, weights: &Weights) -> Spectrum {
    let (mut ray, mut beta, mut radiance) = (*ray, Spectrum::ONE, Spectrum::BLACK);
    // Where the ray starts, and its density there: no light sample can find what the camera sees directly.
    let mut arrival = (LightSampleContext::at(ray.origin), Density::Delta);
    for depth in 0..=MAX_DEPTH {
        // Weight of light that the ray meets, from the density of a light sample in its direction.
        let met = |by_light: SolidAnglePdf| match arrival.1 {
            Density::Smooth(pdf) if by_light > SolidAnglePdf::ZERO => (weights.material)(pdf, by_light),
            _ => 1.0,
        };
        let Some(hit) = scene.intersect(&ray) else {
            let lights = scene.lights();
            let found = |(light, arriving)| arriving * met(lights.background_pdf(light, &arrival.0, ray.direction));
            return radiance + beta * lights.background(ray.direction).map(found).sum::<Spectrum>();
        };
        let surface = scene.surface(&ray, &hit);
        let wo = -ray.direction;
        let emitted = surface.emitted(wo);
        if !emitted.is_black() {
            radiance += beta * emitted * met(scene.lights().pdf(surface.light, &arrival.0, &surface.point));
        }
        if depth == MAX_DEPTH {
            break;
        }
        radiance += beta * lit(scene, &surface, wo, &ray, depth, numbers, weights);
        let (choice, u) = numbers.get_3d(dimension::vertex(depth, Use::Bsdf));
        let Some((wi, sample)) = surface.sample(wo, choice, u, Radiance) else { break };
        arrival = (surface.light_context(wo, ray.time), sample.density);
        (ray, beta) = (surface.spawn(wi, ray.time), beta * sample.weight);
    }
    radiance
}

/// Direct light at a surface, by one light sample.
fn lit(scene: &dyn Scene, surface: &Surface, wo: Vec3, ray: &Ray, depth: u32, numbers: &mut SampleNumbers, weights: &Weights) -> Spectrum {
    let (choice, u) = numbers.get_3d(dimension::vertex(depth, Use::Light));
    let Some(light) = scene.lights().sample(&surface.light_context(wo, ray.time), choice, u) else { return Spectrum::BLACK };
    let f = surface.eval(wo, light.wi, Radiance);
    if f.is_black() || scene.occluded(&surface.shadow_ray(light.wi, &light.target, ray.time)) {
        return Spectrum::BLACK;
    }
    let weight = match light.density {
        Density::Smooth(pdf) => (weights.light)(pdf, surface.pdf(wo, light.wi)),
        Density::Delta => 1.0,
    };
    f * light.weight() * weight
}
