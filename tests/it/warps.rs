//! Maps from the unit square to other domains: all maps are tested by the same laws.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3, Vec2, Vec3};
use pt::math::float::ONE_MINUS_EPSILON;
use pt::math::warp;

use crate::random::Random;

/// A map to the sphere with its density and inverse.
struct Warp {
    name: String,
    forward: Box<dyn Fn(Vec2) -> Vec3>,
    pdf: Box<dyn Fn(Vec3) -> f32>,
    inverse: Box<dyn Fn(Vec3) -> Vec2>,
    /// 1 − cos of the angle that the directions lie within.
    extent: f64,
}

fn spherical() -> Vec<Warp> {
    let mut all = vec![
        Warp {
            name: "sphere".into(),
            forward: Box::new(warp::uniform_sphere),
            pdf: Box::new(|_| warp::uniform_sphere_pdf()),
            inverse: Box::new(warp::uniform_sphere_inverse),
            extent: 2.0,
        },
        Warp {
            name: "hemisphere".into(),
            forward: Box::new(warp::uniform_hemisphere),
            pdf: Box::new(warp::uniform_hemisphere_pdf),
            inverse: Box::new(warp::uniform_hemisphere_inverse),
            extent: 1.0,
        },
        Warp {
            name: "cosine".into(),
            forward: Box::new(warp::cosine_hemisphere),
            pdf: Box::new(warp::cosine_hemisphere_pdf),
            inverse: Box::new(warp::cosine_hemisphere_inverse),
            extent: 1.0,
        },
    ];
    for omc in [1.9f32, 1.0, 0.3, 1e-3, 1e-6, 1e-10, 1e-20] {
        all.push(Warp {
            name: format!("cone {omc:e}"),
            forward: Box::new(move |u| warp::uniform_cone(u, omc)),
            pdf: Box::new(move |_| warp::uniform_cone_pdf(omc)),
            inverse: Box::new(move |w| warp::uniform_cone_inverse(w, omc)),
            extent: f64::from(omc),
        });
    }
    for n in [0.0f32, 1.0, 10.0, 1e3, 1e6, 1e8] {
        all.push(Warp {
            name: format!("cosine to the {n:e}"),
            forward: Box::new(move |u| warp::cos_power_hemisphere(u, n)),
            pdf: Box::new(move |w| warp::cos_power_hemisphere_pdf(w, n)),
            inverse: Box::new(move |w| warp::cos_power_hemisphere_inverse(w, n)),
            extent: 1.0,
        });
    }
    all
}

/// Corners and edges of the square, its centre, and random points.
fn squares(random: &mut Random, count: usize) -> Vec<Vec2> {
    let special = [0.0, 2f32.powi(-24), 1e-30, 0.25, 0.5f32.next_down(), 0.5, 0.5f32.next_up(), 0.75, ONE_MINUS_EPSILON];
    let corners = special.iter().flat_map(|&x| special.map(|y| Vec2::new(x, y)));
    let points = (0..count).map(|_| Vec2::new(random.unit() as f32, random.unit() as f32).min(Vec2::splat(ONE_MINUS_EPSILON)));
    corners.chain(points).collect()
}

/// Points away from the edges, and from the diagonals and the centre, where the concentric map is not differentiable.
fn smooth_points(random: &mut Random, count: usize, step: f64) -> Vec<DVec2> {
    let inside = |u: &DVec2| {
        let p = 2.0 * *u - 1.0;
        (p.x.abs() - p.y.abs()).abs() > 8.0 * step && (0.1..0.9).contains(&p.x.abs().max(p.y.abs()))
    };
    std::iter::repeat_with(|| DVec2::new(random.unit(), random.unit())).filter(inside).take(count).collect()
}

/// Central differences with a step of 2⁻⁹: the rounding of `f32` results, 6·10⁻⁸ over 2⁻⁸, is 2·10⁻⁵;
/// the third derivatives left out are up to 10² · step² = 4·10⁻⁴; both twice in a product.
const STEP: f64 = 1.0 / 512.0;
const DERIVATIVE_ERROR: f64 = 1.5e-3;

/// The derivatives of a map of the square along u and v.
fn derivatives(u: DVec2, map: impl Fn(Vec2) -> DVec3) -> (DVec3, DVec3) {
    let along = |d: DVec2| (map((u + d).as_vec2()) - map((u - d).as_vec2())) / (2.0 * STEP);
    (along(DVec2::X * STEP), along(DVec2::Y * STEP))
}

#[test]
fn pdf_is_inverse_jacobian() {
    let mut random = Random::new(1);
    for warp in spherical() {
        for u in smooth_points(&mut random, 10_000, STEP) {
            let w = (warp.forward)(u.as_vec2());
            let (du, dv) = derivatives(u, |u| (warp.forward)(u).as_dvec3());
            // dω = |ω · (∂ω/∂u × ∂ω/∂v)|, in which the rounding error along ω, of z ≈ 1, has no effect.
            let jacobian = w.as_dvec3().dot(du.cross(dv)).abs();
            let product = f64::from((warp.pdf)(w)) * jacobian;
            assert!((product - 1.0).abs() < DERIVATIVE_ERROR, "{} at {u}: pdf · |J| = {product}", warp.name);
        }
    }
    for u in smooth_points(&mut random, 10_000, STEP) {
        let (du, dv) = derivatives(u, |u| warp::disk(u).as_dvec2().extend(0.0));
        let product = f64::from(warp::disk_pdf()) * du.cross(dv).z.abs();
        assert!((product - 1.0).abs() < DERIVATIVE_ERROR, "disk at {u}: {product}");
        if (u.x - u.y).abs() > 2.0 * STEP {
            let (du, dv) = derivatives(u, |u| warp::triangle(u).as_dvec2().extend(0.0));
            let product = f64::from(warp::triangle_pdf()) * du.cross(dv).z.abs();
            assert!((product - 1.0).abs() < 1e-4, "triangle at {u}: {product}");
        }
    }
}

#[test]
fn inverse_round_trip() {
    // A few roundings of coordinates up to 1.
    const TOLERANCE: f32 = 1.5e-6;
    let mut random = Random::new(2);
    let squares = squares(&mut random, 100_000);
    for warp in spherical() {
        for &u in &squares {
            let back = (warp.inverse)((warp.forward)(u));
            assert!((back - u).abs().max_element() < TOLERANCE, "{}: {u} → {} → {back}", warp.name, (warp.forward)(u));
            assert!(back.min_element() >= 0.0 && back.max_element() < 1.0);
        }
    }
    for &u in &squares {
        let back = warp::disk_inverse(warp::disk(u));
        assert!((back - u).abs().max_element() < TOLERANCE, "disk: {u} → {back}");
        let back = warp::triangle_inverse(warp::triangle(u));
        assert!((back - u).abs().max_element() < TOLERANCE, "triangle: {u} → {back}");
    }
}

#[test]
fn samples_are_inside_even_from_the_corners() {
    let mut random = Random::new(3);
    let squares = squares(&mut random, 100_000);
    for warp in spherical() {
        for &u in &squares {
            let w = (warp.forward)(u);
            assert!(w.is_finite() && (w.as_dvec3().length() - 1.0).abs() < 2e-7, "{}: {u} → {w}", warp.name);
            assert!(warp.extent > 1.0 || w.z > 0.0, "{}: {u} → {w}", warp.name);
            // 1 − cos θ = sin²θ / (1 + cos θ)
            let sin2 = w.as_dvec3().truncate().length_squared();
            let h = if w.z > 0.0 { sin2 / (1.0 + f64::from(w.z)) } else { 1.0 - f64::from(w.z) };
            assert!(h <= warp.extent * (1.0 + 4e-7), "{}: {u} → {w}", warp.name);
            let pdf = (warp.pdf)(w);
            assert!(pdf.is_finite() && pdf >= 0.0, "{}: pdf {pdf} at {w}", warp.name);
        }
    }
    for &u in &squares {
        assert!(warp::disk(u).length() <= 1.0 && warp::disk(u).is_finite(), "{u}");
        let b = warp::triangle(u);
        assert!(b.min_element() >= 0.0 && b.x + b.y < 1.0, "{u} → {b}");
        assert!(warp::cosine_hemisphere_pdf(warp::cosine_hemisphere(u)) > 0.0, "a sample that was drawn has a density");
    }
}

#[test]
fn densities_integrate_to_one_and_vanish_outside() {
    for warp in spherical() {
        // Polar angle from 0 to where the density ends; sharp lobes end long before the horizon.
        let power: f64 =
            warp.name.rsplit(' ').next().and_then(|n| n.parse().ok()).filter(|_| warp.name.starts_with("cosine to")).unwrap_or(0.0);
        let end = if warp.extent == 2.0 { PI } else { 2.0 * (0.5 * warp.extent).sqrt().asin() };
        let end = end.min(12.0 / power.max(1.0).sqrt()).min(end);
        const STEPS: i32 = 20_000;
        let ring = |i: i32| {
            let theta = end * (f64::from(i) + 0.5) / f64::from(STEPS);
            let w = Vec3::new(theta.sin() as f32, 0.0, theta.cos() as f32);
            f64::from((warp.pdf)(w)) * theta.sin()
        };
        let integral = TAU * end * (0..STEPS).map(ring).sum::<f64>() / f64::from(STEPS);
        // Rounding errors of f32 densities are random and average out. Those of the constants are 1e-7.
        assert!((integral - 1.0).abs() < 1e-6, "{}: {integral}", warp.name);
        if warp.extent == 1.0 && !warp.name.starts_with("cone") {
            assert_eq!((warp.pdf)(Vec3::new(0.8, 0.0, -0.6)), 0.0, "{} below the horizon", warp.name);
        }
    }
    assert!((f64::from(warp::disk_pdf()) * PI - 1.0).abs() < 1e-7);
    assert_eq!(warp::triangle_pdf() * 0.5, 1.0);
}

#[test]
fn sharp_lobes_keep_their_mean_cosine() {
    // ⟨cos θ⟩ = (n + 1)/(n + 2), that is ⟨1 − cos θ⟩ = 1/(n + 2). The polar angle depends only on
    // r = max(|2u − 1|, |2v − 1|), of density 2r; r = 1 − t² is dense at the rim, where a logarithm has its pole.
    const STEPS: i32 = 1_000_000;
    for n in [0.0, 1.0, 50.0, 1e4, 1e6, 1e8f32] {
        let term = |i: i32| {
            let t = (f64::from(i) + 0.5) / f64::from(STEPS);
            let u = Vec2::new((1.0 - 0.5 * t * t) as f32, 0.5).min(Vec2::splat(ONE_MINUS_EPSILON));
            let w = warp::cos_power_hemisphere(u, n).as_dvec3();
            let one_minus_cos = w.truncate().length_squared() / (1.0 + w.z);
            one_minus_cos * 2.0 * (1.0 - t * t) * 2.0 * t
        };
        let mean = (0..STEPS).map(term).sum::<f64>() / f64::from(STEPS);
        assert!((mean * (f64::from(n) + 2.0) - 1.0).abs() < 1e-5, "n = {n}: {}", mean * (f64::from(n) + 2.0));
    }
}

#[test]
fn tiny_cones_fill_their_angle_evenly() {
    // Half of the directions lie where 1 − cos θ is below half of its maximum, to the last digits of sin²θ.
    for sin_max in [1e-2f64, 1e-3, 1e-5, 1e-8] {
        let omc = (sin_max * sin_max / (1.0 + (1.0 - sin_max * sin_max).sqrt())) as f32;
        let solid_angle = 1.0 / f64::from(warp::uniform_cone_pdf(omc));
        let exact = TAU * sin_max * sin_max / (1.0 + (1.0 - sin_max * sin_max).sqrt());
        assert!((solid_angle / exact - 1.0).abs() < 3e-7, "{sin_max}: {solid_angle}");
        let rim = warp::uniform_cone(Vec2::new(ONE_MINUS_EPSILON, 0.5), omc).as_dvec3();
        assert!((rim.truncate().length() / sin_max - 1.0).abs() < 3e-7, "{sin_max}: {}", rim.truncate().length());
    }
}
