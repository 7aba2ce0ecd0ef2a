//! Fields of every kind, at random.

use glam::{DVec3, Vec3};
use pt::math::{Ray, Transform};
use pt::shape::sdf::*;
use pt::shape::{Geometry, Sdf, Shape};

use crate::random::Random;

/// A kind of field, and how to make one.
pub type Kind = (&'static str, fn(&mut Random) -> Field);

/// The field is the exact Euclidean distance, inside and outside.
pub const EXACT: &[Kind] =
    &[("ball", ball), ("capsule", capsule), ("torus", torus), ("half ring", half_ring), ("box", sharp_box), ("plane", plane)];

/// The field is a lower bound of the distance.
const BOUNDS: &[Kind] = &[
    ("rounded box", rounded_box),
    ("Chebyshev box", chebyshev),
    ("union", |r| Field::Union(Union::new(vec![ball(r), capsule(r), sharp_box(r)]))),
    ("intersection", |r| Field::Intersection(Intersection { of: vec![centred(1.2, r), chebyshev(r)] })),
    ("difference", |r| Field::Difference(Difference { from: centred(1.5, r).into(), minus: vec![ball(r), torus(r)] })),
    ("complement", |r| Field::Complement(Complement { of: Field::Union(Union::new(vec![chebyshev(r), chebyshev(r)])).into() })),
    ("smooth union", |r| Field::SmoothUnion(SmoothUnion { of: vec![ball(r), capsule(r), rounded_box(r)], width: r.range(0.1, 1.0) })),
    ("placed", |r| Field::Placed(Placed::new(rounded_box(r), place(DVec3::splat(r.range(0.5, 2.0)), r)).into())),
    ("stretched", |r| Field::Placed(Placed::new(torus(r), place(DVec3::new(r.range(0.5, 2.0), -1.0, r.range(0.5, 2.0)), r)).into())),
    ("mirrored", |r| Field::Mirrored(Mirrored { of: torus(r).into(), axis: r.below(2) })),
    ("repeated", |r| repeated(r, [f64::NEG_INFINITY, f64::INFINITY])),
    ("in a row", |r| repeated(r, [-1.0, 2.0])),
    ("extruded, round", |r| extruded(r, 1)),
    ("extruded", |r| extruded(r, 3)),
    ("extruded, sharp", |r| extruded(r, 6)),
];

pub fn all() -> impl Iterator<Item = Kind> {
    EXACT.iter().chain(BOUNDS).copied()
}

/// The kinds of fields that are bounded and have an inside: solids.
pub fn solids() -> impl Iterator<Item = Kind> {
    all().filter(|(_, make)| Sdf::new(make(&mut Random::new(0))).ends().all())
}

fn place(scale: DVec3, random: &mut Random) -> Transform {
    let scale = Transform::scale(scale).expect("not zero");
    scale.then(&random.rotation()).then(&Transform::translate(random.in_cube()).expect("finite"))
}

pub fn ball(random: &mut Random) -> Field {
    Field::Ball(Ball { center: random.in_cube(), radius: random.range(0.3, 1.0) })
}

fn centred(radius: f64, random: &mut Random) -> Field {
    Field::Ball(Ball { center: random.in_cube() * 0.2, radius })
}

pub fn capsule(random: &mut Random) -> Field {
    Field::Capsule(Capsule::new(random.in_cube(), random.in_cube() + DVec3::splat(0.1), random.range(0.1, 0.5)))
}

pub fn torus(random: &mut Random) -> Field {
    Field::Ring(ring(random, false))
}

fn half_ring(random: &mut Random) -> Field {
    Field::Ring(ring(random, true))
}

pub fn ring(random: &mut Random, half: bool) -> Ring {
    Ring { center: random.in_cube() * 0.3, radius: random.range(0.7, 1.2), tube: random.range(0.1, 0.5), half }
}

fn corners(random: &mut Random) -> [DVec3; 2] {
    let half = random.in_cube() * 0.4 + 0.6;
    let center = random.in_cube() * 0.5;
    [center - half, center + half]
}

pub fn sharp_box(random: &mut Random) -> Field {
    let [low, high] = corners(random);
    Field::Cuboid(Cuboid { low, high, rounding: 0.0 })
}

fn rounded_box(random: &mut Random) -> Field {
    let [low, high] = corners(random);
    Field::Cuboid(Cuboid { low, high, rounding: random.range(0.05, 0.2) })
}

fn chebyshev(random: &mut Random) -> Field {
    let [low, high] = corners(random);
    Field::ChebyshevBox(ChebyshevBox { low, high })
}

fn plane(random: &mut Random) -> Field {
    Field::HalfSpace(HalfSpace { point: random.in_cube(), normal: random.direction() })
}

fn repeated(random: &mut Random, copies: [f64; 2]) -> Field {
    // The half ring does not lie in the middle of its box, so a neighbouring copy may be nearer.
    let of = if random.below(2) == 0 { sharp_box(random) } else { half_ring(random) };
    let axis = random.below(3);
    let [low, high] = of.bounds(0.0);
    let period = (high[axis] - low[axis]) * random.range(1.0, 1.5);
    Field::Repeated(Repeated::new(of, axis, period, copies).expect("it fits"))
}

/// Extruded fields: lines without thickness, or solids.
fn extruded(random: &mut Random, log_power: u32) -> Field {
    let line = Field::Capsule(Capsule::new(random.in_cube().with_z(0.0), random.in_cube().with_z(0.0) + DVec3::X * 0.1, 0.0));
    let arc = Field::Ring(Ring { center: DVec3::ZERO, tube: 0.0, ..ring(random, true) });
    let of = if random.below(2) == 0 { Field::Union(Union::new(vec![line, arc])) } else { centred(0.6, random) };
    Field::Extruded(Extruded { of: of.into(), half_thickness: random.range(0.1, 0.4), log_power })
}

pub fn baked(field: Field, place: &Transform) -> Box<dyn Shape> {
    Sdf::new(field).bake(place).expect("it has an end")
}

/// A ray from a random point within a few sizes of the shape to a random point in its box.
pub fn ray(shape: &dyn Shape, random: &mut Random) -> Ray {
    let bounds = shape.bounds(0);
    let (center, radius) = (bounds.center().as_dvec3(), f64::from(bounds.radius()));
    let origin = (center + random.direction() * radius * random.decade(-1.0, 1.0)).as_vec3();
    let size = (bounds.max - bounds.min).as_dvec3();
    let target = bounds.min.as_dvec3() + size * (random.in_cube() * 0.5 + 0.5);
    Ray::new(origin, (target - origin.as_dvec3()).normalize_or(DVec3::X).as_vec3())
}

/// Converts a point in world space to the space of a field, where the two are the same.
pub fn dvec(p: Vec3) -> DVec3 {
    p.as_dvec3()
}
