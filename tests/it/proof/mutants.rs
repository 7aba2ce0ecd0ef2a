//! Correct models, and models with typical bugs.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3};
use pt::bsdf::{Bsdf, BsdfSample, Dielectric, Lobe, TransportMode};
use pt::math::{Density, Local, SolidAnglePdf, Spectrum, warp};
use pt::proof::{Model, Options, prove};

/// Lambert's law, with or without its cosine. The bug may be in the weight as well.
#[derive(Clone, Copy, Debug)]
pub struct Lambert {
    pub cosine: bool,
    pub consistent: bool,
}

impl Model for Lambert {
    fn eval(&self, wo: Local, wi: Local, _: TransportMode) -> Spectrum {
        let f = if wo.same_side(wi) { 0.8 * FRAC_1_PI } else { 0.0 };
        Spectrum::gray(if self.cosine { f * wi.abs_cos() } else { f })
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::new(if wo.same_side(wi) { FRAC_1_PI * wi.abs_cos() } else { 0.0 })
    }

    fn sample(&self, wo: Local, _: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let wi = Local(warp::cosine_hemisphere(u) * 1f32.copysign(wo.cos()));
        let pdf = self.pdf(wo, wi);
        let weight = if self.consistent { self.eval(wo, wi, mode) / pdf.get() } else { Spectrum::gray(0.8) };
        (pdf.get() > 0.0).then_some(BsdfSample { wi, weight, density: Density::Smooth(pdf), lobe: Lobe::Reflection, eta: 1.0 })
    }

    fn one_to_one(&self) -> bool {
        true
    }
}

/// Blinn's lobe about the half vector, with sampled half vectors: pdf = (n + 1)/(2π) cosⁿ θh / (4 wo·h).
#[derive(Clone, Copy, Debug)]
pub struct Blinn {
    pub exponent: f32,
    pub bug: Option<Bug>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bug {
    /// The density without 1/(4 wo·h).
    Jacobian,
    /// The density at the half vector of `wi` and the normal.
    HalfVector,
    /// (n + 2)/(2π) in the density.
    Normalisation,
    /// The density of a lobe that is 2 % wider, correctly normalised.
    Width,
}

impl Blinn {
    fn half(wo: Local, wi: Local) -> Vec3 {
        (wo.0 + wi.0).normalize() * 1f32.copysign(wo.cos())
    }

    fn density(&self, wo: Local, wi: Local) -> f32 {
        let half = match self.bug {
            Some(Bug::HalfVector) => Self::half(Local(Vec3::Z * 1f32.copysign(wo.cos())), wi),
            _ => Self::half(wo, wi),
        };
        let (n, factor) = match self.bug {
            Some(Bug::Normalisation) => (self.exponent, (self.exponent + 2.0) / (self.exponent + 1.0)),
            Some(Bug::Width) => (self.exponent / 1.04, 1.0),
            _ => (self.exponent, 1.0),
        };
        let jacobian = if self.bug == Some(Bug::Jacobian) { 1.0 } else { 1.0 / (4.0 * wo.0.dot(half).abs()) };
        factor * warp::cos_power_hemisphere_pdf(half, n) * jacobian
    }
}

impl Model for Blinn {
    fn eval(&self, wo: Local, wi: Local, _: TransportMode) -> Spectrum {
        if !wo.same_side(wi) {
            return Spectrum::BLACK;
        }
        Spectrum::gray(0.5 * warp::cos_power_hemisphere_pdf(Self::half(wo, wi), self.exponent) * wi.abs_cos() / 4.0)
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::new(if wo.same_side(wi) { self.density(wo, wi) } else { 0.0 })
    }

    fn sample(&self, wo: Local, _: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let half = warp::cos_power_hemisphere(u, self.exponent) * 1f32.copysign(wo.cos());
        let wi = Local((2.0 * wo.0.dot(half) * half - wo.0).normalize());
        let pdf = self.pdf(wo, wi);
        let found = wo.0.dot(half) > 0.0 && pdf.get() > 0.0 && pdf.get().is_finite();
        let weight = self.eval(wo, wi, mode) / pdf.get();
        found.then_some(BsdfSample { wi, weight, density: Density::Smooth(pdf), lobe: Lobe::Reflection, eta: 1.0 })
    }

    fn one_to_one(&self) -> bool {
        true
    }
}

/// Glass that treats light from inside as light from outside: η is not inverted.
#[derive(Clone, Copy, Debug)]
pub struct Frontal(pub Dielectric);

impl Frontal {
    fn turned(self, wo: Local, of: impl Fn(Local) -> Vec<BsdfSample>) -> Vec<BsdfSample> {
        if wo.cos() > 0.0 {
            return of(wo);
        }
        let turn = |w: Local| Local(w.0 * Vec3::new(1.0, 1.0, -1.0));
        of(turn(wo)).into_iter().map(|sample| BsdfSample { wi: turn(sample.wi), ..sample }).collect()
    }
}

impl Model for Frontal {
    fn eval(&self, _: Local, _: Local, _: TransportMode) -> Spectrum {
        Spectrum::BLACK
    }

    fn pdf(&self, _: Local, _: Local) -> SolidAnglePdf {
        SolidAnglePdf::ZERO
    }

    fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        self.turned(wo, |wo| Bsdf::Dielectric(self.0).sample(wo, choice, u, mode).into_iter().collect()).pop()
    }

    fn delta_lobes(&self, wo: Local, mode: TransportMode) -> Vec<BsdfSample> {
        self.turned(wo, |wo| Bsdf::Dielectric(self.0).delta_lobes(wo, mode).collect())
    }
}

/// Rough glass that transmits light diffusely: f = T/π below, divided by η² for radiance, or without that factor.
#[derive(Clone, Copy, Debug)]
pub struct Frosted {
    pub eta: f32,
    pub inverts: bool,
}

impl Frosted {
    fn index(&self, wo: Local) -> f32 {
        if wo.cos() > 0.0 || !self.inverts { self.eta } else { 1.0 / self.eta }
    }
}

impl Model for Frosted {
    fn eval(&self, wo: Local, wi: Local, mode: TransportMode) -> Spectrum {
        if wo.0.z * wi.0.z >= 0.0 {
            return Spectrum::BLACK;
        }
        // From the dense side, the transmitted flux is smaller by 1/η².
        let index = self.index(wo);
        let spread = if mode == TransportMode::Radiance { 1.0 / (index * index) } else { 1.0 };
        let share = if self.index(wo) > 1.0 { 0.9 } else { 0.9 * self.index(wo).powi(2) };
        Spectrum::gray(share * spread * FRAC_1_PI * wi.abs_cos())
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        SolidAnglePdf::new(if wo.0.z * wi.0.z < 0.0 { FRAC_1_PI * wi.abs_cos() } else { 0.0 })
    }

    fn sample(&self, wo: Local, _: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let wi = Local(warp::cosine_hemisphere(u) * -1f32.copysign(wo.cos()));
        let pdf = self.pdf(wo, wi);
        let weight = self.eval(wo, wi, mode) / pdf.get();
        let sample = BsdfSample { wi, weight, density: Density::Smooth(pdf), lobe: Lobe::Transmission, eta: self.index(wo) };
        (pdf.get() > 0.0).then_some(sample)
    }

    fn one_to_one(&self) -> bool {
        true
    }
}

fn options() -> Options {
    Options { samples: super::samples(), cases: 4000, ..Options::default() }
}

/// The models without bugs pass, so that failures are due to the bugs.
#[test]
fn unspoilt_models_are_proved() {
    let blinn = [1.0, 20.0, 1000.0, 1e5].map(|exponent| Box::new(Blinn { exponent, bug: None }) as Box<dyn Model>);
    let others: [Box<dyn Model>; 2] = [Box::new(Lambert { cosine: true, consistent: true }), Box::new(Frosted { eta: 1.5, inverts: true })];
    for model in blinn.into_iter().chain(others) {
        let report = prove(&*model, &Options { suite: 6, ..options() });
        assert!(report.accepts(), "{report}");
    }
}

/// Asserts that each of these laws rejects the model. Other laws may reject it too.
#[track_caller]
fn refused(model: &dyn Model, laws: &[&str]) {
    let report = prove(model, &options());
    for law in laws {
        assert!(report.refuses(law), "expected `{law}` to refuse\n{report}");
    }
}

#[test]
fn a_missing_cosine_is_refused() {
    refused(&Lambert { cosine: false, consistent: false }, &["weight"]);
    // The weight lacks the cosine as well, so that only laws of physics detect the bug.
    refused(&Lambert { cosine: false, consistent: true }, &["reciprocity", "energy"]);
}

#[test]
fn eta_not_inverted_is_refused() {
    refused(&Frontal(Dielectric { eta: 1.5, color: Spectrum::ONE }), &["delta"]);
    refused(&Frosted { eta: 1.5, inverts: false }, &["reciprocity"]);
}

#[test]
fn the_density_of_another_half_vector_is_refused() {
    refused(&Blinn { exponent: 20.0, bug: Some(Bug::HalfVector) }, &["chi2", "jacobian"]);
}

#[test]
fn a_forgotten_jacobian_is_refused() {
    refused(&Blinn { exponent: 20.0, bug: Some(Bug::Jacobian) }, &["integral", "jacobian", "chi2"]);
}

/// An error of 5 %, which a chi² test of relative shares does not detect.
#[test]
fn a_wrong_normalisation_is_refused() {
    refused(&Blinn { exponent: 20.0, bug: Some(Bug::Normalisation) }, &["integral", "jacobian"]);
}

/// The density is correctly normalised but 2 % wider than the sampled lobe.
#[test]
fn a_lobe_of_another_width_is_refused() {
    refused(&Blinn { exponent: 20.0, bug: Some(Bug::Width) }, &["chi2"]);
}
