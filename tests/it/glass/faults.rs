//! Diagnosis of ray tracers: the magnification by a pane identifies the mistake in the code.
//!
//! Camera and ruler at the distances a and b from a thin pane of index n; M is the paraxial magnification:
//!
//! | mistake | M | a = b = 1, n = 1.5 |
//! |---|---|---|
//! | none | 1 | 1 |
//! | the exit is missed (an offset larger than the pane) | (a + b)/(a + b/n) | 1.2 |
//! | η not inverted on exit | (a + b)/(a + b/n²) | 1.3846 |
//! | η inverted on entry | (a + b)/(a + b n²) | 0.6154 |
//! | the normal not turned on exit | (a + b)/(a + b/(2n − 1)) | 4/3 |

use std::sync::Arc;

use glam::{DVec3, Vec3};
use pt::bsdf::{Bsdf, Lobe, TransportMode};
use pt::film::FilmSpec;
use pt::integrator::{CameraSample, Context, Estimator, Integrator};
use pt::integrators::whitted::Whitted;
use pt::math::{Frame, Ray, Spectrum, fresnel};
use pt::measure::{SampledImage, agreement};
use pt::sampler::SamplerSpec;
use pt::scene::Scene;

use crate::scenes::picture;
use pt::torture::glass::{Stand, read};

/// Formula of refraction, correct or with a typical mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Refraction {
    /// pt's own formula, which is correct.
    Right,
    ExitMissed,
    /// Mistake: the index of refraction for entry is also used on exit.
    NotInverted,
    /// Mistake: the index of refraction for exit is also used on entry.
    Inverted,
    /// Mistake: on exit the indices are swapped, but the normal still points outside.
    NormalNotTurned,
}

/// The formulas with their magnifications for a = b = 1.
const ALL: [(Refraction, f64); 5] = [
    (Refraction::Right, 1.0),
    (Refraction::ExitMissed, 2.0 / (1.0 + 1.0 / 1.5)),
    (Refraction::NotInverted, 2.0 / (1.0 + 1.0 / 2.25)),
    (Refraction::Inverted, 2.0 / (1.0 + 2.25)),
    (Refraction::NormalNotTurned, 4.0 / 3.0),
];

impl Refraction {
    /// The direction behind an interface with the outward normal `n`; `d` leads to it.
    fn bend(self, d: Vec3, n: Vec3, eta: f32) -> Option<Vec3> {
        let leaving = d.dot(n) > 0.0;
        let frame = Frame::around(n);
        // `eta` is used as it is, as on entry, if the normal points to the side that the light comes from.
        let entering = |eta: f32| {
            let turned = Frame::around(if leaving { -n } else { n });
            fresnel::refract(turned.to_local(-d).0, eta).map(|w| turned.to_world(pt::math::Local(w)))
        };
        match self {
            Refraction::Right => fresnel::refract(frame.to_local(-d).0, eta).map(|w| frame.to_world(pt::math::Local(w))),
            Refraction::ExitMissed if leaving => Some(d),
            Refraction::NotInverted if leaving => entering(eta),
            Refraction::Inverted if !leaving => entering(1.0 / eta),
            Refraction::NormalNotTurned if leaving => Some(unturned(d, n, eta)),
            _ => Refraction::Right.bend(d, n, eta),
        }
    }
}

/// ηd + (η cos θ − cos θt) n, which is correct only if n points against d. On exit it does not, and |cos θ| hides that.
pub fn unturned(d: Vec3, n: Vec3, eta: f32) -> Vec3 {
    let cos = d.dot(n).abs();
    let cos_t = (1.0 - eta * eta * (1.0 - cos * cos)).max(0.0).sqrt();
    (eta * d + (eta * cos - cos_t) * n).normalize()
}

/// Integrator that follows camera rays through glass to the light and refracts them by the given formula, right or wrong.
struct Tracer(Refraction);

struct Walk {
    scene: Arc<dyn Scene>,
    refraction: Refraction,
}

impl Integrator for Tracer {
    fn prepare(&self, scene: Arc<dyn Scene>, _: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Walk { scene, refraction: self.0 })
    }
}

impl Estimator for Walk {
    fn li(&self, camera: &CameraSample, _: &mut Context) -> Spectrum {
        let (mut ray, mut weight) = (camera.ray, Spectrum::ONE);
        for _ in 0..=2 {
            let Some(hit) = self.scene.intersect(&ray) else { return Spectrum::BLACK };
            let surface = self.scene.surface(&ray, &hit);
            let Bsdf::Dielectric(glass) = surface.bsdf else { return weight * surface.emitted(-ray.direction) };
            let lobe = surface.delta_lobes(-ray.direction, TransportMode::Radiance).find(|(_, sample)| sample.lobe == Lobe::Transmission);
            let bent = self.refraction.bend(ray.direction, surface.point.ng, glass.eta);
            let (Some((_, sample)), Some(direction)) = (lobe, bent) else { return Spectrum::BLACK };
            weight *= sample.weight;
            ray = surface.spawn(direction, 0.0);
        }
        Spectrum::BLACK
    }
}

/// A thin pane half way between camera and ruler.
fn stand(distance: f64) -> Stand {
    Stand { distance, near: 1.0 - 1e-5, thickness: 1e-5, closed: false, offset: 0.0 }
}

/// With a normal that is not turned on exit, a ray leaves a slab at θ/(2n − 1): 10° become 4.975°.
#[test]
fn unturned_normal_bends_the_ray() {
    let entering = slanting(10.0);
    let inside = Refraction::Right.bend(entering, Vec3::Z, 1.5).unwrap();
    let angle = |d: Vec3| f64::from(d.x).atan2(f64::from(-d.z)).to_degrees();
    let right = Refraction::Right.bend(inside, -Vec3::Z, 1.5).unwrap();
    let wrong = Refraction::NormalNotTurned.bend(inside, -Vec3::Z, 1.5).unwrap();
    assert!((angle(right) - 10.0).abs() < 1e-4, "{}", angle(right));
    assert!((angle(wrong) - 4.975).abs() < 1e-3, "{}", angle(wrong));
}

fn slanting(degrees: f64) -> Vec3 {
    DVec3::new(degrees.to_radians().sin(), 0.0, -degrees.to_radians().cos()).as_vec3()
}

/// The magnification of the ruler differs between all mistakes and the correct formula.
#[test]
fn the_magnification_identifies_the_mistake() {
    for (refraction, expected) in ALL {
        let m = read(stand(2.0), &Tracer(refraction));
        assert!((m / expected - 1.0).abs() < 2e-3, "{refraction:?}: {m} for {expected}");
    }
    let m = read(stand(2.0), &Whitted { max_depth: 2, ..Whitted::default() });
    assert!((m - 1.0).abs() < 5e-4, "pt: {m}");
    // Other distances, a = 1 and b = 3, also distinguish a missed exit from a normal that is not turned.
    let far = read(stand(4.0), &Tracer(Refraction::ExitMissed));
    assert!((far / (4.0 / 3.0) - 1.0).abs() < 2e-3, "{far}");
}

/// The comparison of pictures detects every mistake, and accepts the correct tracer.
#[test]
fn the_comparison_refuses_every_mistake() {
    let scene = stand(2.0).scene(true);
    let image = |integrator: &dyn Integrator, seed| {
        picture(scene.clone(), integrator, FilmSpec::new(1024, 1), SamplerSpec { spp: 64, seed, ..SamplerSpec::default() })
    };
    let pt = image(&Whitted { max_depth: 2, ..Whitted::default() }, 1);
    for (refraction, _) in ALL {
        let other = image(&Tracer(refraction), 2);
        let found = agreement(SampledImage { image: &pt, samples: 64 }, SampledImage { image: &other, samples: 64 }, 1e-3).unwrap();
        assert_eq!(found.accepts(), refraction == Refraction::Right, "{refraction:?}: {found}");
    }
}

/// A ray in pt's scene is refracted as the correct formula says.
#[test]
fn scene_and_formula_agree() {
    let ray = Ray::new(Vec3::ZERO, slanting(30.0));
    let inside = Refraction::Right.bend(ray.direction, Vec3::Z, 1.5).unwrap();
    let sine = f64::from(inside.x);
    assert!((sine - 0.5 / 1.5).abs() < 1e-7, "{sine}");
}
