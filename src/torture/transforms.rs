//! Transforms: inverses, normals and mirrors; keyframes, bounds of what moves, and light with a formula.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DMat3, DVec3};

use super::radiance::{Depth, KnownRadiance, at, black, probe};
use super::{Failures, Random, Row};
use crate::bsdf::Material;
use crate::light::{Emitter, Environment, Light};
use crate::math::transform::unit;
use crate::math::{AnimatedTransform, Keyframes, Rgb, Transform};
use crate::shape::{Quad, Sphere};
use crate::world::{Objects, World};

/// The rows.
pub fn rows() -> Vec<Row> {
    vec![
        inverse(),
        perpendicular(),
        normals(),
        mirrors(),
        rotations(),
        turning_points(),
        bounds_of_motion(),
        blurred_furnace(),
        moving_lamp(),
    ]
}

/// A dozen roundings of numbers up to 1.
const FEW_ROUNDINGS: f64 = 12.0 * f64::EPSILON;

/// Translation, rotation, scale and shear, with the condition number: the largest scale over the smallest.
fn any(random: &mut Random) -> (Transform, f64) {
    let scale = DVec3::new(random.magnitude(0.1, 1000.0), random.magnitude(0.1, 1000.0), random.magnitude(0.1, 1000.0));
    let sign = random.pick(&[DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0)]);
    let translate = Transform::translate(random.direction() * random.magnitude(0.01, 100.0)).expect("finite");
    let stretched = random.rotation().then(&Transform::scale(scale * sign).expect("not zero"));
    (stretched.then(&random.rotation()).then(&translate), scale.max_element() / scale.min_element())
}

fn inverse() -> Row {
    Row::new("T1", "a transform and its inverse", "a dozen roundings times the condition number, up to 10^4").never(
        "any scale from .1 to 1000",
        10_000_000,
        |tries| {
            Failures::count(tries, |random| {
                let (t, condition) = any(random);
                let product = t.matrix().matrix3 * t.inverse().matrix().matrix3 - DMat3::IDENTITY;
                let error = product.to_cols_array().into_iter().fold(0.0, |worst, e| f64::max(worst, e.abs()));
                (error >= FEW_ROUNDINGS * condition).then(|| format!("{t:?}"))
            })
        },
    )
}

fn perpendicular() -> Row {
    Row::new("T2", "normals stay perpendicular, unit and on their side", "1e-14 times the condition number").never(
        "any scale from .1 to 1000",
        10_000_000,
        |tries| {
            Failures::count(tries, |random| {
                let (t, condition) = any(random);
                let n = random.direction();
                let tangent = n.any_orthonormal_vector();
                let holds = || {
                    let (mapped, along) = (t.normal(n), unit(t.vector(tangent))?);
                    let outward = unit(n + 0.5 * tangent)?;
                    let flat = mapped.dot(along).abs() < 1e-14 * condition && (mapped.length() - 1.0).abs() < 4.0 * f64::EPSILON;
                    (flat && mapped.dot(t.vector(outward)) > 0.0).then_some(())
                };
                holds().is_none().then(|| format!("{t:?}, {n:?}"))
            })
        },
    )
}

/// M⁻ᵀ (1, 1, 0) = (½, 1, 0): a surface stretched along x faces y the more.
fn normals() -> Row {
    let diagonal = DVec3::new(1.0, 1.0, 0.0) * FRAC_1_SQRT_2;
    let turned = move |scale: DVec3| Transform::scale(scale).map_or(DVec3::NAN, |t| t.normal(diagonal));
    Row::new("T3", "normal of (1, 1, 0) after a scale", "two roundings in f64")
        .peers("filament #3108, LuxCore #412: mirrored copies inside out")
        .number("x by 2: x", 0.4472135955, 1e-10, move || turned(DVec3::new(2.0, 1.0, 1.0)).x)
        .number("x by 2: y", 0.8944271910, 1e-10, move || turned(DVec3::new(2.0, 1.0, 1.0)).y)
        .number("mirrored: x", -FRAC_1_SQRT_2, 1e-10, move || turned(DVec3::new(-1.0, 1.0, 1.0)).x)
        .number("mirrored: y", FRAC_1_SQRT_2, 1e-10, move || turned(DVec3::new(-1.0, 1.0, 1.0)).y)
}

/// The cross product of mapped edges points along the mapped normal, or against it after an odd number of mirrors.
fn mirrors() -> Row {
    Row::new("T4", "two mirrors are none", "exact").never("pairs of transforms", 1_000_000, |tries| {
        Failures::count(tries, |random| {
            let ((a, _), (b, _)) = (any(random), any(random));
            let both = a.then(&b);
            let (x, y) = (random.direction(), random.direction());
            let crossed = both.vector(x).cross(both.vector(y)).dot(both.normal(x.cross(y)));
            let flips = both.flips_handedness();
            let holds = flips == (a.flips_handedness() ^ b.flips_handedness()) && flips == (crossed < 0.0);
            (!holds).then(|| format!("{a:?}, {b:?}"))
        })
    })
}

/// Transforms that begin with one and end with another.
fn between(start: Transform, end: Transform) -> AnimatedTransform {
    Keyframes::new(&[(0.0, start), (1.0, end)]).expect("neither mirrors").into()
}

/// The greatest difference from 0 of an entry.
fn greatest(m: DMat3) -> f64 {
    m.to_cols_array().into_iter().fold(0.0, |worst, e| f64::max(worst, e.abs()))
}

/// A rotation keeps all lengths, also in the middle of the way from one to another.
fn rotations() -> Row {
    let turned = |axis: DVec3, degrees: f64| Transform::rotate(axis, degrees).expect("an axis");
    let axis = DVec3::new(1.0, 2.0, 3.0);
    // 400 degrees about an axis are 320 about its opposite: the quaternions of the two are opposite.
    let written_twice = move || {
        let middle = between(turned(axis, 400.0), turned(-axis, 320.0)).at(0.5).matrix().matrix3;
        greatest(middle - turned(axis, 40.0).matrix().matrix3)
    };
    let half_turn = move || {
        let middle = between(Transform::IDENTITY, turned(axis, 180.0)).at(0.5).matrix().matrix3;
        let quarters = [90.0, -90.0].map(|degrees| greatest(middle - turned(axis, degrees).matrix().matrix3));
        quarters[0].min(quarters[1])
    };
    Row::new("T5", "rotations between two keyframes", "two dozen roundings of numbers up to 1: decomposing, turning, and the product")
        .number("from an orientation to itself, written in another way", 0.0, FEW_ROUNDINGS, written_twice)
        .number("half a turn, in its middle", 0.0, 2.0 * FEW_ROUNDINGS, half_turn)
        .never("any two rotations, lengths at any time", 1_000_000, |tries| {
            Failures::count(tries, |random| {
                let (start, end) = (random.rotation(), random.rotation());
                let m = between(start, end).at(random.unit() as f32).matrix().matrix3;
                (greatest(m.transpose() * m - DMat3::IDENTITY) >= 2.0 * FEW_ROUNDINGS).then(|| format!("{start:?}, {end:?}"))
            })
        })
}

/// The point (1, 0, 0) that goes half around the origin is highest in the middle. While it moves on by 2 t, its x coordinate
/// cos πt + 2t has its extremes where sin πt = 2/π.
fn turning_points() -> Row {
    let moved = |by: f64| {
        let end = Transform::rotate(DVec3::Z, 180.0).expect("an axis").then(&Transform::translate(DVec3::X * by).expect("finite"));
        between(Transform::IDENTITY, end).bounds([DVec3::X; 2])
    };
    let tau = (2.0 / std::f64::consts::PI).asin() / std::f64::consts::PI;
    let greatest_x = (std::f64::consts::PI * tau).cos() + 2.0 * tau;
    Row::new("T6", "bounds of a point that turns by half a turn", "the bounds may exceed the way by 2^-33 of its size")
        .peers("the box around both ends has y = 0")
        .number("greatest |y|", 1.0, 1e-9, move || moved(0.0)[0].y.abs().max(moved(0.0)[1].y))
        .number("while it moves by 2: greatest x", greatest_x, 1e-9, move || moved(2.0)[1].x)
        .number("while it moves by 2: least x", 2.0 - greatest_x, 1e-9, move || moved(2.0)[0].x)
}

/// Bounds contain what moves, and are hardly larger than it.
fn bounds_of_motion() -> Row {
    // Number of boxes under each motion. The text of the row names it, too.
    const BOXES: usize = 5;
    const TIMES: u32 = 1000;
    // Bounds of some boxes under one motion, and the box around all corners at all times.
    let tried = |random: &mut Random| -> [([DVec3; 2], [DVec3; 2]); BOXES] {
        // Either all transforms mirror the boxes or none does.
        let sign = if random.unit() < 0.5 { 1.0 } else { -1.0 };
        let mut transform = || {
            let scale = DVec3::new(sign * random.range(0.1, 1.1), random.range(0.1, 1.1), random.range(0.1, 1.1));
            let translate = Transform::translate(random.direction() * random.range(0.0, 3.0)).expect("finite");
            random.rotation().then(&Transform::scale(scale).expect("not zero")).then(&random.rotation()).then(&translate)
        };
        let [before, start, end, after] = std::array::from_fn(|_| transform());
        // Some are far away in between, and come back.
        let away = random.direction() * if random.unit() < 0.5 { 0.0 } else { 1e6 };
        let [there, back] = [away, -away].map(|by| Transform::translate(by).expect("finite"));
        let [start, end] = [start.then(&there), end.then(&there)];
        let motion = AnimatedTransform::from(before).then(&between(start, end)).then(&back.then(&after).into());
        std::array::from_fn(|_| {
            let (p, q) = (random.direction() * random.unit(), random.direction() * random.unit());
            let corners = [p.min(q), p.max(q)];
            let mut seen = [DVec3::INFINITY, DVec3::NEG_INFINITY];
            for k in 0..TIMES {
                let [low, high] = motion.at(k as f32 / (TIMES - 1) as f32).bounds(corners);
                seen = [seen[0].min(low), seen[1].max(high)];
            }
            (motion.bounds(corners), seen)
        })
    };
    // Number of pairs of transforms, and what is wrong with a box.
    let count = move |pairs: u64, is_wrong: fn([DVec3; 2], [DVec3; 2]) -> bool| {
        Failures::count(pairs, |random| {
            let wrong = tried(random).into_iter().find(|(bounds, seen)| is_wrong(*bounds, *seen));
            wrong.map(|([low, high], seen)| format!("{low} {high}, {} {}", seen[0], seen[1]))
        })
    };
    let is_outside = |[low, high]: [DVec3; 2], seen: [DVec3; 2]| seen[0].cmplt(low).any() || seen[1].cmpgt(high).any();
    let is_loose = |[low, high]: [DVec3; 2], seen: [DVec3; 2]| ((high - low) / (seen[1] - seen[0])).cmpgt(DVec3::splat(1.02)).any();
    let what = "bounds of five boxes that move, turn and are sheared, at 1000 times";
    Row::new("T7", what, "exact; 1.02 times the box around all corners")
        .peers("pbrt-v4: 200 pairs, with a tolerance of 1e-4 of the diagonal")
        .never("nothing outside", 1000, move |pairs| count(pairs, is_outside))
        .never("at most 1.02 times as large", 1000, move |pairs| count(pairs, is_loose))
}

/// Reason of the tolerance of a mean.
const CONFIDENCE: &str = "confidence interval of the mean; 1 % of false alarms over all cases";

/// Light of a radiance of 1 from everywhere, and what absorbs none of it: the radiance stays 1, however it moves, turns and is stretched.
fn blurred_furnace() -> Row {
    let mut world = World::builder(probe(DVec3::Z * 5.0, DVec3::ZERO));
    let white = world.material(Material::diffuse(Rgb::gray(1.0)));
    let turn = |degrees: f64| Transform::rotate(DVec3::new(0.3, 1.0, 0.2), degrees).expect("an axis");
    let stretch = |by: DVec3| Transform::scale(by).expect("not zero");
    let mut objects = Objects::default();
    objects.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, white, None);
    let start = stretch(DVec3::new(1.0, 0.3, 0.5)).then(&turn(20.0)).then(&at(DVec3::X * -1.5));
    let end = stretch(DVec3::new(0.4, 1.0, 0.6)).then(&turn(170.0)).then(&at(DVec3::X * 1.5));
    world.moving(objects, between(start, end));
    world.shape(Quad { size: [4.0; 2] }, at(DVec3::Z * -1.5), white, None);
    world.light(Light::Environment(Environment { radiance: Rgb::gray(1.0) }));
    let depth = Depth { max: 64, roulette: 8 };
    let known = KnownRadiance::new("a white body that flies, turns and is stretched before a wall", world, 1.0, depth);
    Row::new("T8", "a furnace in which things move", CONFIDENCE).radiance(known.by_chance(2e-3))
}

/// A ball of the radius r and the radiance L that flies over a matte floor gives the irradiance π L (r/d)² cos θ at each time.
fn moving_lamp() -> Row {
    let (from, to) = (DVec3::new(-1.5, 0.8, 0.3), DVec3::new(1.0, 2.0, -0.5));
    let (radius, albedo, radiance) = (0.25, 0.5, 3.0);
    let mut world = World::builder(probe(DVec3::new(0.0, 0.3, 3.0), DVec3::ZERO));
    let (floor, lamp) = (world.material(Material::diffuse(Rgb::gray(albedo as f32))), world.material(black()));
    world.shape(Quad { size: [20.0; 2] }, Transform::rotate(DVec3::X, -90.0).expect("an axis"), floor, None);
    let mut objects = Objects::default();
    objects.shape(Sphere { radius }, Transform::IDENTITY, lamp, Some(Emitter::new(Rgb::gray(radiance as f32))));
    world.moving(objects, between(at(from), at(to)));
    let irradiance = |time: f64| {
        let p = from.lerp(to, time);
        radius * radius * p.y / p.length().powi(3)
    };
    // The midpoint rule has an error of 10⁻⁹ here.
    let steps = 1 << 14;
    let mean = (0..steps).map(|k| irradiance((f64::from(k) + 0.5) / f64::from(steps))).sum::<f64>() / f64::from(steps);
    let known = KnownRadiance::new("a ball that flies over a matte floor", world, albedo * radiance * mean, Depth::exactly(1));
    Row::new("T9", "the light of a lamp that moves", CONFIDENCE).radiance(known.by_chance(1e-2))
}
