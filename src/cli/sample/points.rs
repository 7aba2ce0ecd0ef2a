//! The warps by name, and their points.

use glam::{UVec2, Vec2, Vec3};

use crate::math::{float, warp};
use crate::sampler::{Kind, Sampler, SamplerSpec};

/// What the points of a warp lie in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kindred {
    /// The unit square.
    Square,
    /// The plane, within −1 … 1.
    Plane,
    /// Space, within the unit sphere.
    Space,
}

/// What some warps take.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    /// n of cosⁿ.
    pub exponent: f32,
    /// Of the half angle of a cone.
    pub one_minus_cos: f32,
}

pub struct Warp {
    pub name: &'static str,
    pub about: &'static str,
    pub kin: Kindred,
    map: fn(&Parameters, &mut dyn Sampler) -> Vec3,
}

/// To add a warp to the list: a row here.
pub const WARPS: &[Warp] = &[
    Warp {
        name: "disk",
        about: "Uniform on the unit disk, by the concentric map.",
        kin: Kindred::Plane,
        map: |_, s| warp::disk(s.next_2d()).extend(0.0),
    },
    Warp {
        name: "triangle",
        about: "Uniform on a triangle, as the barycentrics of two corners.",
        kin: Kindred::Square,
        map: |_, s| warp::triangle(s.next_2d()).extend(0.0),
    },
    Warp {
        name: "ball-rejection",
        about: "Uniform in the unit ball: points of the cube, until one lies inside.",
        kin: Kindred::Space,
        map: |_, s| rejected(s),
    },
    Warp {
        name: "ball",
        about: "Uniform in the unit ball, directly: a direction, and the cube root of u for a radius.",
        kin: Kindred::Space,
        map: |_, s| ball(s),
    },
    Warp { name: "sphere", about: "Uniform on the unit sphere.", kin: Kindred::Space, map: |_, s| warp::uniform_sphere(s.next_2d()) },
    Warp {
        name: "hemisphere",
        about: "Uniform on the hemisphere z > 0.",
        kin: Kindred::Space,
        map: |_, s| warp::uniform_hemisphere(s.next_2d()),
    },
    Warp {
        name: "hemisphere-angles",
        about: "The usual mistake: uniform in the angle, so that points crowd at the pole. Compare `hemisphere` and `cosine`.",
        kin: Kindred::Space,
        map: |_, s| angles(s.next_2d()),
    },
    Warp {
        name: "cosine",
        about: "On the hemisphere, with density proportional to the cosine.",
        kin: Kindred::Space,
        map: |_, s| warp::cosine_hemisphere(s.next_2d()),
    },
    Warp {
        name: "cosine-power",
        about: "On the hemisphere, with density proportional to cosⁿ: --exponent n.",
        kin: Kindred::Space,
        map: |p, s| warp::cos_power_hemisphere(s.next_2d(), p.exponent),
    },
    Warp {
        name: "cone",
        about: "Uniform on a cone of directions: --angle degrees, its half angle.",
        kin: Kindred::Space,
        map: |p, s| warp::uniform_cone(s.next_2d(), p.one_minus_cos),
    },
];

/// What samplers draw.
pub const SQUARE: Warp = Warp { name: "square", about: "", kin: Kindred::Square, map: |_, s| s.next_2d().extend(0.0) };

/// The first `count` points.
pub fn draw(warp: &Warp, parameters: Parameters, sampler: Kind, seed: u64, count: u32) -> Vec<Vec3> {
    let mut sampler = SamplerSpec { kind: sampler, seed, spp: count.into() }.build();
    let mut point = |i: u32| {
        sampler.start(UVec2::ZERO, i.into());
        (warp.map)(&parameters, &mut *sampler)
    };
    (0..count).map(&mut point).collect()
}

/// A header and a line per point, with all digits.
pub fn csv(points: &[Vec3], warp: &Warp) -> String {
    let mut text = if warp.kin == Kindred::Space { "x,y,z\n" } else { "x,y\n" }.to_owned();
    for p in points {
        text += &match warp.kin {
            Kindred::Space => format!("{:?},{:?},{:?}\n", p.x, p.y, p.z),
            _ => format!("{:?},{:?}\n", p.x, p.y),
        };
    }
    text
}

fn rejected(sampler: &mut dyn Sampler) -> Vec3 {
    loop {
        let p = 2.0 * sampler.next_2d().extend(sampler.next_1d()) - 1.0;
        if p.length_squared() < 1.0 {
            return p;
        }
    }
}

fn ball(sampler: &mut dyn Sampler) -> Vec3 {
    let direction = warp::uniform_sphere(sampler.next_2d());
    direction * float::powf(sampler.next_1d(), 1.0 / 3.0)
}

/// θ = u · 90°: as many points between 0° and 10° as between 80° and 90°, where there is eleven times the room.
fn angles(u: Vec2) -> Vec3 {
    let (sin, cos) = float::sin_cos(u.x * std::f32::consts::FRAC_PI_2);
    let (y, x) = float::sin_cos(u.y * std::f32::consts::TAU);
    Vec3::new(sin * x, sin * y, cos)
}
