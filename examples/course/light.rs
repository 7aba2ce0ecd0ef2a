//! Light samplers of the course, for a disk, a ball and several lamps, each with a classical mistake: docs/course/light.md.

use std::f32::consts::PI;
use std::fmt::Debug;

use pt::bsdf::{BsdfSample, TransportMode};
use pt::integrator::Entry;
use pt::math::{Frame, Local, Ray, SolidAnglePdf, Spectrum, Vec2, Vec3, warp};
use pt::proof::Model;
use pt::sampler::SampleNumbers;
use pt::sampler::dimension::{self, Use};
use pt::scene::Scene;

use super::integrator::{background, emission};
use super::material::sampled;
use super::method::{Method, row};

/// Rows of the table of integrators.
pub const METHODS: &[Entry] = &[
    row("disk", "direct light of the lamp in disk.json", |_| Box::new(Method(|s, r, n| direct(&DISK, s, r, n)))),
    row("disk_wrong", "disk with a density by area", |_| Box::new(Method(|s, r, n| direct(&Disk { mistake: true, ..DISK }, s, r, n)))),
    row("ball", "direct light of the lamp in ball.json", |_| Box::new(Method(|s, r, n| direct(&NEAR, s, r, n)))),
    row("two_balls", "direct light of the lamps in two-balls.json", |_| Box::new(Method(|s, r, n| direct(&LAMPS, s, r, n)))),
    row("two_balls_wrong", "two_balls without the probability of the lamp", |_| {
        Box::new(Method(|s, r, n| direct(&Lamps { mistake: true, ..LAMPS }, s, r, n)))
    }),
    row("one_of_two", "two_balls that never chooses the far lamp", |_| {
        Box::new(Method(|s, r, n| direct(&Lamps { shares: [1.0, 0.0], ..LAMPS }, s, r, n)))
    }),
];

/// A light sampler as a model, by the name that `prove` takes.
pub fn model(name: &str) -> Option<Box<dyn Model>> {
    Some(match name {
        "disk" => Box::new(Floor { lamp: DISK }),
        "disk_wrong" => Box::new(Floor { lamp: Disk { mistake: true, ..DISK } }),
        "ball" => Box::new(Floor { lamp: NEAR }),
        "two_balls" => Box::new(Floor { lamp: LAMPS }),
        "two_balls_wrong" => Box::new(Floor { lamp: Lamps { mistake: true, ..LAMPS } }),
        "one_of_two" => Box::new(Floor { lamp: Lamps { shares: [1.0, 0.0], ..LAMPS } }),
        _ => return None,
    })
}

/// Directions to the light, as seen from a point.
trait Lamp: Debug + Send + Sync {
    /// A direction from the point `p` (m) to the lamp.
    fn sample(&self, p: Vec3, choice: f32, u: Vec2) -> Vec3;

    /// Density with which [`sample`](Lamp::sample) returns `w` [sr⁻¹]; 0 where `w` misses the lamp.
    fn pdf(&self, p: Vec3, w: Vec3) -> f32;
}

/// Step 1. A horizontal disk: points uniform by area, 1/A.
#[derive(Clone, Copy, Debug)]
struct Disk {
    center: Vec3,
    radius: f32,
    /// Whether the density by area is taken for one by solid angle.
    mistake: bool,
}

const DISK: Disk = Disk { center: Vec3::new(0.0, 1.0, 0.0), radius: 1.0, mistake: false };

impl Lamp for Disk {
    fn sample(&self, p: Vec3, _: f32, u: Vec2) -> Vec3 {
        let on_disk = self.radius * warp::disk(u);
        (self.center + Vec3::new(on_disk.x, 0.0, on_disk.y) - p).normalize()
    }

    fn pdf(&self, p: Vec3, w: Vec3) -> f32 {
        let distance = (self.center.y - p.y) / w.y;
        let is_hit = distance > 0.0 && (p + distance * w).distance_squared(self.center) <= self.radius * self.radius;
        if !is_hit {
            return 0.0;
        }
        let by_area = 1.0 / (PI * self.radius * self.radius);
        if self.mistake { by_area } else { by_area * distance * distance / w.y.abs() }
    }
}

/// Step 2. A ball: directions uniform in the cone that it fills, 1/(2π (1 − cos θmax)).
#[derive(Clone, Copy, Debug)]
struct Ball {
    center: Vec3,
    radius: f32,
}

const NEAR: Ball = Ball { center: Vec3::new(0.0, 1.0, 0.0), radius: 0.5 };
const FAR: Ball = Ball { center: Vec3::new(4.0, 3.0, 0.0), radius: 1.0 };

impl Ball {
    /// The direction to the centre, and 1 − cos θmax of the cone: sin θmax = R/d, 1 − cos = sin²/(1 + cos).
    fn cone(&self, p: Vec3) -> (Vec3, f32) {
        let to_center = self.center - p;
        let sin2 = self.radius * self.radius / to_center.length_squared();
        (to_center.normalize(), sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt()))
    }
}

impl Lamp for Ball {
    fn sample(&self, p: Vec3, _: f32, u: Vec2) -> Vec3 {
        let (axis, one_minus_cos) = self.cone(p);
        Frame::around(axis).to_world(Local(warp::uniform_cone(u, one_minus_cos)))
    }

    fn pdf(&self, p: Vec3, w: Vec3) -> f32 {
        let (axis, one_minus_cos) = self.cone(p);
        if 1.0 - axis.dot(w) <= one_minus_cos { 1.0 / (2.0 * PI * one_minus_cos) } else { 0.0 }
    }
}

/// Step 3. Two balls: one of them is chosen, P(lamp), and a direction to it.
#[derive(Clone, Copy, Debug)]
struct Lamps {
    balls: [Ball; 2],
    /// Probabilities of the lamps.
    shares: [f32; 2],
    /// Whether the probabilities are missing in the density.
    mistake: bool,
}

const LAMPS: Lamps = Lamps { balls: [NEAR, FAR], shares: [0.6, 0.4], mistake: false };

impl Lamp for Lamps {
    fn sample(&self, p: Vec3, choice: f32, u: Vec2) -> Vec3 {
        let chosen = if choice < self.shares[0] { self.balls[0] } else { self.balls[1] };
        chosen.sample(p, choice, u)
    }

    fn pdf(&self, p: Vec3, w: Vec3) -> f32 {
        let shares = if self.mistake { [1.0, 1.0] } else { self.shares };
        shares[0] * self.balls[0].pdf(p, w) + shares[1] * self.balls[1].pdf(p, w)
    }
}

/// L = Le + f |cos θi| L(from wi) / p(wi), with the directions of a light sampler.
fn direct(lamp: &impl Lamp, scene: &dyn Scene, ray: &Ray, numbers: &mut SampleNumbers) -> Spectrum {
    let Some(hit) = scene.intersect(ray) else { return background(scene, ray) };
    let surface = scene.surface(ray, &hit);
    let wo = -ray.direction;
    let (choice, u) = numbers.get_3d(dimension::vertex(0, Use::Light));
    // pt moves each scene; the lamps have their places in the coordinates of the scene file.
    let p = surface.point.p + scene.origin().as_vec3();
    let wi = lamp.sample(p, choice, u);
    let pdf = lamp.pdf(p, wi);
    if pdf == 0.0 {
        return surface.emitted(wo);
    }
    let arriving = emission(scene, &surface.spawn(wi, ray.time), numbers);
    surface.emitted(wo) + surface.eval(wo, wi, TransportMode::Radiance) * arriving / pdf
}

/// A matte floor at the origin, with a light sampler in the place of its own: what `prove` tests.
#[derive(Debug)]
struct Floor<L> {
    lamp: L,
}

impl<L: Lamp> Model for Floor<L> {
    fn eval(&self, wo: Local, wi: Local, _: TransportMode) -> Spectrum {
        let is_lit = self.pdf(wo, wi) > SolidAnglePdf::ZERO;
        if is_lit { Spectrum::gray(0.5 / PI * wi.abs_cos()) } else { Spectrum::BLACK }
    }

    fn pdf(&self, wo: Local, wi: Local) -> SolidAnglePdf {
        let w = Frame::around(Vec3::Y).to_world(wi.on_the_side_of(Local::NORMAL));
        if wo.same_side(wi) { SolidAnglePdf::new(self.lamp.pdf(Vec3::ZERO, w)) } else { SolidAnglePdf::ZERO }
    }

    fn sample(&self, wo: Local, choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let wi = Frame::around(Vec3::Y).to_local(self.lamp.sample(Vec3::ZERO, choice, u));
        sampled(self, wo, wi.on_the_side_of(wo), mode)
    }

    /// Light is scattered only from the lamp, so that the directions cannot be exchanged.
    fn reciprocal(&self) -> bool {
        false
    }
}
