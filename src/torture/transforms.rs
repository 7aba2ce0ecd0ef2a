//! Transforms: inverses, normals and mirrors.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DMat3, DVec3};

use super::{Failures, Random, Row};
use crate::math::Transform;
use crate::math::transform::unit;

/// The rows.
pub fn rows() -> Vec<Row> {
    vec![
        inverse(),
        perpendicular(),
        normals(),
        mirrors(),
        Row::not_yet("T5", "interpolation of rotations"),
        Row::not_yet("T6", "bounds of a turning shape"),
        Row::not_yet("T7", "bounds of moving shapes, 1000 pairs of transforms"),
        Row::not_yet("T8", "a blurred furnace, and a shutter of 0"),
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
