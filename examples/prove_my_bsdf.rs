//! Proves a custom scattering model, and finds the bug in a faulty version of it: `cargo run --release --example prove_my_bsdf`.

use std::f32::consts::PI;
use std::process::ExitCode;

use pt::bsdf::{BsdfSample, Lobe, TransportMode};
use pt::math::{Density, Frame, Local, SolidAnglePdf, Spectrum, Vec2, Vec3, warp};
use pt::proof::{Model, Options, prove};

/// A glossy lobe around the mirror direction (Phong's, normalised by Lafortune and Willems).
///
/// f(wo, wi) = ρ (n + 2)/(2π) cosⁿ ∠(reflect(wo), wi),  above the surface;  pdf = (n + 1)/(2π) cosⁿ ∠(reflect(wo), wi)
#[derive(Clone, Copy, Debug)]
struct Phong {
    albedo: f32,
    exponent: f32,
    /// Whether the density has a bug: the factor n + 2 of f instead of its own, n + 1, which is an error of 5 % at n = 20.
    confuses_factors: bool,
}

impl Phong {
    /// cosⁿ/(2π) of the angle to the mirror direction.
    fn lobe(&self, wo: Local, wi: Local) -> f32 {
        if wo.same_side(wi) { mirror(wo).dot(wi.0).max(0.0).powf(self.exponent) / (2.0 * PI) } else { 0.0 }
    }
}

impl Model for Phong {
    fn eval(&self, wo: Local, wi: Local, _: TransportMode) -> Spectrum {
        Spectrum::gray(self.albedo * (self.exponent + 2.0) * self.lobe(wo, wi) * wi.abs_cos())
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let factor = self.exponent + if self.confuses_factors { 2.0 } else { 1.0 };
        SolidAnglePdf::new(factor * self.lobe(wo, wi))
    }

    fn sample(&self, wo: Local, _: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let around = Local(warp::cos_power_hemisphere(u, self.exponent));
        let wi = Local(Frame::around(mirror(wo)).to_world(around));
        let pdf = self.pdf(wo, wi);
        // Directions below the surface are lost, and so are directions whose density rounds to 0.
        let found = pdf > SolidAnglePdf::ZERO;
        let weight = self.eval(wo, wi, mode) / pdf.get();
        found.then_some(BsdfSample { wi, weight, density: Density::Smooth(pdf), lobe: Lobe::Reflection, eta: 1.0 })
    }

    fn one_to_one(&self) -> bool {
        true
    }
}

fn mirror(Local(w): Local) -> Vec3 {
    Vec3::new(-w.x, -w.y, w.z)
}

fn main() -> ExitCode {
    let right = Phong { albedo: 0.9, exponent: 20.0, confuses_factors: false };
    let wrong = Phong { confuses_factors: true, ..right };
    let [right, wrong] = [right, wrong].map(|model| prove(&model, &Options { samples: 200_000, ..Options::default() }));
    println!("{right}\n{wrong}");
    let as_it_should_be = right.accepts() && !wrong.accepts();
    ExitCode::from(u8::from(!as_it_should_be))
}
