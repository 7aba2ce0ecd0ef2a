//! Reflectance and refraction at smooth boundaries. The numbers were computed with 20 digits.

use glam::{Vec3, Vec3A};

use super::{Failures, Row};
use crate::math::fresnel::{self, dielectric, refract};

/// The rows.
pub fn rows() -> Vec<Row> {
    vec![
        normal(),
        from_air(),
        refracted(),
        brewster(),
        from_glass(),
        critical(),
        equal(),
        nearly_equal(),
        extreme(),
        stokes(),
        metals(),
        limits(),
        averages(),
        input(),
    ]
}

/// Cosine of an angle in degrees; beyond 90° the direction lies inside.
fn cos(degrees: f64) -> f32 {
    degrees.to_radians().cos() as f32
}

/// Unit direction at this angle from +z, in the plane y = 0.
fn direction(degrees: f64) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vec3::new(sin as f32, 0.0, cos as f32)
}

/// Angle of the refracted direction from the normal (degrees); NaN if there is none.
fn angle(degrees: f64, eta: f32) -> f64 {
    refract(direction(degrees), eta).map_or(f64::NAN, |wi| f64::from(wi.x.abs()).atan2(f64::from(wi.z.abs())).to_degrees())
}

fn metal(cos: f32, eta: f32, k: f32) -> f64 {
    fresnel::conductor(cos, Vec3A::splat(eta), Vec3A::splat(k)).x.into()
}

/// Textbook: rₛ = (cos i − n cos t)/(cos i + n cos t), rₚ = (n cos i − cos t)/(n cos i + cos t).
fn textbook(cos_i: f64, n: f64) -> f64 {
    let sin2_t = (1.0 - cos_i * cos_i) / (n * n);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let (s, p) = ((cos_i - n * cos_t) / (cos_i + n * cos_t), (n * cos_i - cos_t) / (n * cos_i + cos_t));
    0.5 * (s * s + p * p)
}

fn normal() -> Row {
    let table = [(1.33, 0.0200593122), (1.5, 0.04), (2.42, 0.1723949249)];
    let row = Row::new("F1", "reflectance at normal incidence", "one rounding to f32").peers("Mitsuba: within 1e-5");
    table.into_iter().fold(row, |row, (n, exact)| {
        row.number(format!("index {n}"), exact, 1e-7, move || dielectric(1.0, n).into()).number(
            format!("index {n}, from inside"),
            exact,
            1e-7,
            move || dielectric(-1.0, n).into(),
        )
    })
}

fn from_air() -> Row {
    let table = [
        (30.0, 0.0415226260),
        (45.0, 0.0502399110),
        (60.0, 0.0891867128),
        (75.0, 0.2530605630),
        (85.0, 0.6127996453),
        (89.0, 0.9041849498),
        (89.9, 0.9899118769),
        (89.99, 0.9989858952),
    ];
    let row = Row::new("F2", "reflectance from air to glass, index 1.5", "rounding of the cosine to f32, near grazing incidence");
    let row = row.peers("Mitsuba: 45° only");
    table
        .into_iter()
        .fold(row, |row, (degrees, exact)| row.number(format!("{degrees}°"), exact, 5e-7, move || dielectric(cos(degrees), 1.5).into()))
}

fn refracted() -> Row {
    let table = [
        (30.0, 19.4712206),
        (45.0, 28.1255057),
        (60.0, 35.2643897),
        (75.0, 40.0870369),
        (85.0, 41.6156005),
        (89.0, 41.8025102),
        (89.9, 41.8102368),
        (89.99, 41.8103141),
    ];
    // 10⁻⁷ in the sine is 10⁻⁷/cos θt rad.
    let row = Row::new("F3", "angle of refraction into glass, degrees", "rounding of the sine to f32").peers("Mitsuba: sine within 1e-5");
    table.into_iter().fold(row, |row, (degrees, exact)| {
        let tolerance = (1e-7 / f64::to_radians(exact).cos()).to_degrees();
        row.number(format!("{degrees}°"), exact, tolerance, move || angle(degrees, 1.5))
    })
}

fn brewster() -> Row {
    let at = 1.5f64.atan().to_degrees();
    Row::new("F4", "reflectance at Brewster's angle: 25/338", "one rounding to f32").number(
        "index 1.5, 56.309932474°",
        0.0739644970,
        6e-8,
        move || dielectric(cos(at), 1.5).into(),
    )
}

fn from_glass() -> Row {
    let table = [
        (10.0, 0.0400829592, 15.0980866),
        (30.0, 0.0551901673, 48.5903779),
        (40.0, 0.2452912043, 74.6185683),
        (41.0, 0.3797512660, 79.7654172),
    ];
    let row = Row::new("F5", "reflectance and angle from glass to air", "the slope is infinite at the critical angle");
    table.into_iter().fold(row, |row, (degrees, exact, leaves)| {
        let tolerance = (2e-7 / f64::to_radians(leaves).cos()).to_degrees();
        row.number(format!("{degrees}°"), exact, 3e-5, move || dielectric(cos(180.0 - degrees), 1.5).into()).number(
            format!("{degrees}°, angle"),
            leaves,
            tolerance,
            move || angle(180.0 - degrees, 1.5),
        )
    })
}

fn critical() -> Row {
    let critical = (1.0 / 1.5f64).asin();
    let approach = [0.10028199, 0.43957606, 0.76364119, 0.91723792, 0.97293684, 0.99134959];
    let row = Row::new("F6", "reflectance up to the critical angle, 41.81°", "rounding of the cosine times the slope");
    let row = row.peers("glm returned NaN (#1452)");
    let row = approach.into_iter().enumerate().fold(row, |row, (k, exact)| {
        let below = 10f64.powi(-1 - k as i32);
        // Half an ulp of the cosine moves the angle by this share of its distance to the critical one.
        let share = 6e-8 * 0.745 / (2.0 * below);
        row.number(format!("10^-{} rad below", k + 1), exact, 3e-5 + 5.0 * share * (1.0 - exact), move || {
            dielectric(cos(180.0 - (critical - below).to_degrees()), 1.5).into()
        })
    });
    row.never("beyond it is exactly 1, before it the textbook's", 1_000_000, move |tries| {
        let (mut failures, middle) = (Failures::default(), -(critical.cos() as f32));
        // There are 4.3 million numbers between this cosine and 1.
        let steps = (tries / 2).min(u64::from((-1f32).to_bits() - middle.to_bits())) as i32;
        for step in -steps..=steps {
            let cos = f32::from_bits(middle.to_bits().wrapping_add_signed(step));
            let (found, exact) = (dielectric(cos, 1.5), textbook(f64::from(-cos), 1.0 / 1.5));
            let holds = (f64::from(found) - exact).abs() <= 6e-8 && (found == 1.0) == (exact == 1.0);
            failures.record((!holds).then(|| format!("cos {cos:?}: {found:?}")));
        }
        failures
    })
}

fn equal() -> Row {
    Row::new("F7", "without a change of index nothing is reflected", "exact").peers("three-gpu-pathtracer is black (#429)").never(
        "any direction",
        1_000_000,
        |tries| {
            Failures::count(tries, |random| {
                let wo = random.direction().as_vec3();
                let holds = dielectric(wo.z, 1.0) == 0.0 && refract(wo, 1.0) == Some(-wo) && metal(wo.z, 1.0, 0.0) == 0.0;
                (!holds).then(|| format!("{wo:?}"))
            })
        },
    )
}

fn nearly_equal() -> Row {
    let row = Row::new("F8", "reflectance over the exact one, index near 1", "one rounding, although the differences cancel");
    let row = row.peers("the textbook's form in f32 is off by up to 5.8e-3");
    let row = [1.0001f32, 1.000001, 1.0000001, 0.9999999].into_iter().fold(row, |row, n| {
        let exact = ((f64::from(n) - 1.0) / (f64::from(n) + 1.0)).powi(2);
        row.number(format!("index {n}, 0°"), 1.0, 6e-8, move || f64::from(dielectric(1.0, n)) / exact)
    });
    // For the nearest f32 of the index, evaluated at the nearest f32 of the cosine of 89.9°.
    row.never("any cosine, index 1 + 10^-7 to 1 + 10^-2", 1_000_000, |tries| {
        Failures::count(tries, |random| {
            let n = (1.0 + random.magnitude(1e-7, 1e-2)) as f32;
            let cos = random.magnitude(1e-4, 1.0) as f32;
            let (n64, c) = (f64::from(n), f64::from(cos));
            // The difference first, q − c = (n² − 1)/(q + c); rₚ = −rₛ (cos i cos t − sin i sin t)/(cos i cos t + sin i sin t).
            let difference = (n64 * n64 - 1.0) / (c + (n64 * n64 - 1.0 + c * c).sqrt());
            let q = c + difference;
            let s = difference / (q + c);
            let p = s * (c * q - (1.0 - c * c)) / (c * q + (1.0 - c * c));
            let found = f64::from(dielectric(cos, n)) / (0.5 * (s * s + p * p));
            let wrong = (found - 1.0).abs() > 1e-7;
            wrong.then(|| format!("cos {cos:?}, index {n:?}: {found}"))
        })
    })
}

fn extreme() -> Row {
    let row = Row::new("F9", "reflectance with an index of 1000 or 1/1000", "one rounding to f32; beyond 0.0573° all is reflected");
    [1e-3f32, 1e3]
        .into_iter()
        .fold(row, |row, n| row.number(format!("index {n}, 0°"), 0.996007988, 1e-7, move || dielectric(1.0, n).into()))
        .number("index 1000, 0.06° from inside", 1.0, 0.0, || dielectric(cos(180.0 - 0.06), 1e3).into())
        .never("finite at any cosine", 1_000_000, |tries| {
            Failures::count(tries, |random| {
                let (cos, eta) = (random.range(-1.0, 1.0) as f32, random.magnitude(1e-30, 1e30) as f32);
                let found = dielectric(cos, eta);
                (!(0.0..=1.0).contains(&found)).then(|| format!("cos {cos:?}, index {eta:?}: {found:?}"))
            })
        })
}

fn stokes() -> Row {
    Row::new("F10", "the way back reflects as much: R(θi, n) = R(θt, 1/n)", "rounding of cos θt times the slope; 2e-6 elsewhere").never(
        "any cosine, index 1.001 to 10",
        1_000_000,
        |tries| {
            Failures::count(tries, |random| {
                let (cos, eta) = (random.range(0.01, 1.0) as f32, random.magnitude(1.001, 10.0) as f32);
                let cos_t = (1.0 - (1.0 - f64::from(cos).powi(2)) / f64::from(eta).powi(2)).sqrt();
                let (there, back) = (f64::from(dielectric(cos, eta)), f64::from(dielectric(-cos_t as f32, eta)));
                let reflectance = |c: f64| textbook(c, 1.0 / f64::from(eta));
                let step = 1e-7 * cos_t.max(1e-3);
                let slope = (reflectance((cos_t + step).min(1.0)) - reflectance(cos_t - step)).abs() / step;
                let tolerance = (2e-6f64).max(6e-8 + 6e-8 * cos_t * slope).min(1e-2);
                ((there - back).abs() > tolerance).then(|| format!("cos {cos:?}, index {eta:?}: {there} and {back}"))
            })
        },
    )
}

fn metals() -> Row {
    let values = [
        ((0.2f32, 3.9f32), [(0.0, 0.951951952), (45.0, 0.950043180), (80.0, 0.948407448), (89.9, 0.999240979)]),
        ((2.0, 4.0), [(0.0, 0.68), (45.0, 0.672878863), (80.0, 0.658842646), (89.9, 0.992578868)]),
    ];
    let row = Row::new("F11", "reflectance of metal", "nine operations in f32").peers("pbrt: no test");
    values.into_iter().flat_map(|(metal, row)| row.map(|value| (metal, value))).fold(row, |row, ((eta, k), (degrees, exact))| {
        row.number(format!("eta {eta}, k {k}, {degrees}°"), exact, 1e-6, move || metal(cos(degrees), eta, k))
    })
}

fn limits() -> Row {
    let row = Row::new("F13", "metal without absorption is glass, and with much a mirror", "nine operations in f32");
    let row = [(0.0, 1.0f32, 1e4f32, 0.99999996), (89.9, 1.0, 1e4, 0.999988578), (0.0, 0.05, 100.0, 0.999980002), (0.0, 1.0, 0.0, 0.0)]
        .into_iter()
        .fold(row, |row, (degrees, eta, k, exact)| {
            row.number(format!("eta {eta}, k {k}, {degrees}°"), exact, 1e-6, move || metal(cos(degrees), eta, k))
        });
    row.never("k = 0, any cosine, index 1/5 to 5", 1_000_000, |tries| {
        Failures::count(tries, |random| {
            let (cos, eta) = (random.unit() as f32, random.magnitude(0.2, 5.0) as f32);
            let (metal, glass) = (metal(cos, eta, 0.0), f64::from(dielectric(cos, eta)));
            ((metal - glass).abs() > 1e-6).then(|| format!("cos {cos:?}, index {eta:?}: {metal} and {glass}"))
        })
    })
}

fn averages() -> Row {
    let row = Row::new("F14", "reflectance averaged over the hemisphere", "midpoint rule with 400,000 steps");
    let table = [(1.33f32, 0.0659308493, 0.4719491488), (1.5, 0.0917779593, 0.5963457597)];
    let average = |n: f32, sign: f64| {
        const STEPS: i32 = 400_000;
        // F̄ = ∫ 2 c R(c) dc. In c = t³ the rule converges at both grazing and critical cosines.
        let term = |t: f64| 6.0 * t.powi(5) * f64::from(dielectric((sign * t.powi(3)) as f32, n));
        (0..STEPS).map(|i| term((f64::from(i) + 0.5) / f64::from(STEPS))).sum::<f64>() / f64::from(STEPS)
    };
    table.into_iter().fold(row, |row, (n, outside, inside)| {
        row.number(format!("index {n}"), outside, 1e-6, move || average(n, 1.0)).number(
            format!("index {n}, from inside"),
            inside,
            1e-6,
            move || average(n, -1.0),
        )
    })
}

fn input() -> Row {
    Row::new("F15", "Snell's law, in the plane, unit, on the other side, and back again", "four roundings, times the condition").never(
        "any direction, index 1/1000 to 1000",
        10_000_000,
        |tries| {
            Failures::count(tries, |random| {
                let (wo, eta) = (random.direction().as_vec3(), random.magnitude(1e-3, 1e3) as f32);
                let reflectance = dielectric(wo.z, eta);
                let Some(wi) = refract(wo, eta) else {
                    return (reflectance != 1.0).then(|| format!("{wo:?}, index {eta:?}: {reflectance:?}"));
                };
                let (o, i) = (wo.as_dvec3(), wi.as_dvec3());
                let n = if wo.z > 0.0 { f64::from(eta) } else { 1.0 / f64::from(eta) };
                let (sin_o, sin_i) = (o.truncate(), i.truncate());
                let snell = (n * sin_i + sin_o).length() <= 3e-7 * sin_o.length().max(n * sin_i.length()).max(1e-30);
                let plane = o.cross(i).z.abs() <= 2e-7 * sin_o.length() * sin_i.length();
                let unit = (i.length() - 1.0).abs() <= 1.5e-7 && (0.0..=1.0).contains(&reflectance) && wo.z * wi.z < 0.0;
                // Half an ulp in sin θt is n times that in sin θ, and 1/cos θ times that in the angle.
                let condition = (n.max(1.0) / o.z.abs()).max(1.0);
                let back = refract(wi, eta).is_none_or(|back| (back.as_dvec3() - o).length() <= 1e-6 * condition);
                (!(snell && plane && unit && back)).then(|| format!("{wo:?}, index {eta:?}: {wi:?}"))
            })
        },
    )
}
