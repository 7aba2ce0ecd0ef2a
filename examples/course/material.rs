//! Materials of the course, from matte to a mixture, each with a classical mistake: docs/course/material.md.

use std::f32::consts::PI;

use pt::bsdf::{BsdfSample, Lobe, TransportMode};
use pt::integrator::Entry;
use pt::math::float::powf;
use pt::math::{Density, Frame, Local, Ray, SolidAnglePdf, Spectrum, Vec2, Vec3, warp};
use pt::proof::Model;
use pt::sampler::SampleNumbers;
use pt::scene::Scene;

use super::integrator::follow;
use super::method::{Method, row};

/// Rows of the table of integrators.
pub const METHODS: &[Entry] = &[
    row("painted_matte", "paths in a scene all of which has the material `matte`", |_| {
        Box::new(Method(|scene, ray, numbers| painted(&Matte { albedo: 0.5, mistake: false }, scene, ray, numbers)))
    }),
    row("painted_mixture", "paths in a scene all of which has the material `mixture`", |_| {
        Box::new(Method(|scene, ray, numbers| painted(&Mixture { mistake: false }, scene, ray, numbers)))
    }),
];

/// A model by the name that `prove` takes.
pub fn model(name: &str) -> Option<Box<dyn Model>> {
    Some(match name {
        "uniform" => Box::new(Uniform { albedo: 0.8, mistake: false }),
        "uniform_wrong" => Box::new(Uniform { albedo: 0.8, mistake: true }),
        "matte" => Box::new(Matte { albedo: 0.8, mistake: false }),
        "matte_wrong" => Box::new(Matte { albedo: 0.8, mistake: true }),
        "gloss" => Box::new(Gloss { albedo: 0.8, exponent: 20.0, mistake: false }),
        "gloss_wrong" => Box::new(Gloss { albedo: 0.8, exponent: 20.0, mistake: true }),
        "mixture" => Box::new(Mixture { mistake: false }),
        "mixture_wrong" => Box::new(Mixture { mistake: true }),
        _ => return None,
    })
}

/// The sample of a direction, with the weight f |cos θi| / p that its definition demands; `None` where the density is 0.
pub fn sampled(model: &dyn Model, wo: Local, wi: Local, mode: TransportMode) -> Option<BsdfSample> {
    let pdf = model.pdf(wo, wi);
    let weight = model.eval(wo, wi, mode) / pdf.get();
    (pdf > SolidAnglePdf::ZERO).then_some(BsdfSample { wi, weight, density: Density::Smooth(pdf), lobe: Lobe::Reflection, eta: 1.0 })
}

/// Step 1. Matte: f = ρ/π. Directions are uniform, p = 1/2π.
#[derive(Clone, Copy, Debug)]
struct Uniform {
    albedo: f32,
    /// Whether the cosine is missing.
    mistake: bool,
}

impl Model for Uniform {
    fn eval(&self, wo: Local, wi: Local, _: TransportMode) -> Spectrum {
        let cosine = if self.mistake { 1.0 } else { wi.abs_cos() };
        if wo.same_side(wi) { Spectrum::gray(self.albedo / PI * cosine) } else { Spectrum::BLACK }
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        if wo.same_side(wi) { SolidAnglePdf::new(1.0 / (2.0 * PI)) } else { SolidAnglePdf::ZERO }
    }

    fn sample(&self, wo: Local, _: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        sampled(self, wo, Local(warp::uniform_hemisphere(u)).on_the_side_of(wo), mode)
    }

    fn one_to_one(&self) -> bool {
        true
    }
}

/// Step 2. Matte: f = ρ/π. Directions follow the cosine, p = |cos θi|/π.
#[derive(Clone, Copy, Debug)]
struct Matte {
    albedo: f32,
    /// Whether the density is that of step 1.
    mistake: bool,
}

impl Model for Matte {
    fn eval(&self, wo: Local, wi: Local, _: TransportMode) -> Spectrum {
        if wo.same_side(wi) { Spectrum::gray(self.albedo / PI * wi.abs_cos()) } else { Spectrum::BLACK }
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let pdf = if self.mistake { 1.0 / (2.0 * PI) } else { wi.abs_cos() / PI };
        if wo.same_side(wi) { SolidAnglePdf::new(pdf) } else { SolidAnglePdf::ZERO }
    }

    fn sample(&self, wo: Local, _: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        sampled(self, wo, Local(warp::cosine_hemisphere(u)).on_the_side_of(wo), mode)
    }

    fn one_to_one(&self) -> bool {
        true
    }
}

/// Step 3. A glossy lobe around the mirror direction r of wo (Phong's, normalised by Lafortune and Willems).
///
/// f = ρ (n + 2)/(2π) (r·wi)ⁿ,  p = (n + 1)/(2π) (r·wi)ⁿ
#[derive(Clone, Copy, Debug)]
struct Gloss {
    albedo: f32,
    exponent: f32,
    /// Whether f is divided by |cos θo|.
    mistake: bool,
}

/// Direction in which a mirror reflects `wo`.
fn mirror(Local(w): Local) -> Vec3 {
    Vec3::new(-w.x, -w.y, w.z)
}

impl Gloss {
    /// (r·wi)ⁿ / 2π
    fn lobe(&self, wo: Local, wi: Local) -> f32 {
        if wo.same_side(wi) { powf(mirror(wo).dot(wi.0).max(0.0), self.exponent) / (2.0 * PI) } else { 0.0 }
    }
}

impl Model for Gloss {
    fn eval(&self, wo: Local, wi: Local, _: TransportMode) -> Spectrum {
        let f = self.albedo * (self.exponent + 2.0) * self.lobe(wo, wi);
        let f = if self.mistake { f / wo.abs_cos() } else { f };
        Spectrum::gray(f * wi.abs_cos())
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::new((self.exponent + 1.0) * self.lobe(wo, wi))
    }

    fn sample(&self, wo: Local, _: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let around = Local(warp::cos_power_hemisphere(u, self.exponent));
        sampled(self, wo, Local(Frame::around(mirror(wo)).to_world(around)), mode)
    }

    fn one_to_one(&self) -> bool {
        true
    }
}

/// Step 4. Half matte, half glossy: f = (f_matte + f_gloss)/2, p = (p_matte + p_gloss)/2.
#[derive(Clone, Copy, Debug)]
struct Mixture {
    /// Whether a sample has the density of the part that it was drawn from.
    mistake: bool,
}

const MATTE: Matte = Matte { albedo: 0.5, mistake: false };
const GLOSS: Gloss = Gloss { albedo: 0.9, exponent: 50.0, mistake: false };

impl Model for Mixture {
    fn eval(&self, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        (MATTE.eval(wo, wi, mode) + GLOSS.eval(wo, wi, mode)) * 0.5
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::new(0.5 * (MATTE.pdf(wo, wi).get() + GLOSS.pdf(wo, wi).get()))
    }

    fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let part: &dyn Model = if choice < 0.5 { &MATTE } else { &GLOSS };
        let drawn = part.sample(wo, choice, u, mode)?;
        if self.mistake { Some(drawn) } else { sampled(self, wo, drawn.wi, mode) }
    }
}

/// Step 5. Paths in a scene all of whose surfaces have one material.
fn painted(model: &dyn Model, scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    let scatter = |surface: &pt::scene::Surface, wo: Vec3, choice: f32, u: Vec2| {
        let sample = model.sample(surface.frame.to_local(wo), choice, u, TransportMode::Radiance)?;
        Some((surface.frame.to_world(sample.wi), sample.weight))
    };
    follow(scene, ray, numbers, scatter, |beta, weight, _| Some(beta * weight))
}
