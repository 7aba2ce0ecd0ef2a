//! A statue of a dancer with raised arms in a long dress: smoothly joined solids, each described by (approximately) its distance field.

use glam::{DVec2, DVec3, IVec3};
use pt::math::float::sin_cos_degrees;
use pt::shape::mesh_data::MeshData;

use super::surface_nets::{self, Grid};

/// Makes the mesh of the statue, 2 m high, that stands on y = 0 at the origin and faces +z.
pub fn statue() -> MeshData {
    let edge = 0.0112;
    let grid = Grid { min: DVec3::new(-0.52, -0.02, -0.52), cells: (DVec3::new(1.04, 2.1, 1.04) / edge).as_ivec3() + IVec3::ONE, edge };
    surface_nets::mesh(&grid, &dancer)
}

fn dancer(p: DVec3) -> f64 {
    let body = join(dress(p), torso(p), 0.05);
    let arms = LEFT_ARM.distance(p).min(RIGHT_ARM.distance(p));
    let hands = join(LEFT_HAND.distance(p), RIGHT_HAND.distance(p), 0.05);
    let figure = join(join(body, join(arms, hands, 0.015), 0.045), head(p), 0.03);
    join(figure, plinth(p), 0.02)
}

/// Distance to the dress: a bell with folds that wind around it.
///
/// r(y, θ) = r₀(s) (1 + a(s) cos(9θ + twist) + …),  s = height over the length of the dress
fn dress(p: DVec3) -> f64 {
    const BOTTOM: f64 = 0.07;
    const TOP: f64 = 1.06;
    let s = ((p.y - BOTTOM) / (TOP - BOTTOM)).clamp(0.0, 1.0);
    let q = DVec2::new(p.x, p.z) - sway(p.y);
    let bell = 1.0 - s;
    let radius = 0.088 + 0.10 * bell + 0.20 * bell * bell * bell + 0.045 * bump((s - 0.86) / 0.22);
    let depth = 0.26 * bell * (1.0 - 0.35 * bell);
    let wide = depth * cos_multiple(q, 9, 330.0 * s * s) + 0.4 * depth * cos_multiple(q, 4, -160.0 * s);
    // The slope of the bell makes the true distance shorter than the horizontal one.
    let side = 0.75 * (q.length() - radius * (1.0 + wide));
    side.max(p.y - TOP).max(BOTTOM - 0.02 - p.y)
}

/// Horizontal position of the body's axis at a height. The body leans to one side and back, as its weight rests on one leg.
fn sway(y: f64) -> DVec2 {
    DVec2::new(0.05 * bump((y - 0.95) / 0.75), 0.02 * bump((y - 1.1) / 0.6))
}

fn torso(p: DVec3) -> f64 {
    let q = p - DVec3::new(sway(p.y).x, 0.0, sway(p.y).y);
    // A torso is wider than it is deep.
    let flat = DVec3::new(q.x, q.y, q.z * 1.25);
    let waist = round_cone(flat, DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, 1.28, 0.015), 0.088, 0.118);
    let shoulders = round_cone(q, DVec3::new(-0.125, 1.385, 0.0), DVec3::new(0.125, 1.375, 0.0), 0.05, 0.05);
    let breast = |x: f64| (q - DVec3::new(x, 1.27, 0.075)).length() - 0.048;
    let chest = join(waist, breast(-0.055).min(breast(0.055)), 0.035);
    let neck = round_cone(q, DVec3::new(0.0, 1.38, -0.005), DVec3::new(0.012, 1.52, 0.005), 0.043, 0.037);
    join(join(chest, shoulders, 0.07), neck, 0.04)
}

/// Distance to the head, turned to one side and slightly raised, with the hair tied in a knot.
fn head(p: DVec3) -> f64 {
    let q = p - DVec3::new(0.035, 1.605, 0.03);
    let (sin, cos) = sin_cos_degrees(-35.0);
    let q = DVec3::new(cos * q.x + sin * q.z, q.y, cos * q.z - sin * q.x);
    let (sin, cos) = sin_cos_degrees(-14.0);
    let q = DVec3::new(q.x, cos * q.y - sin * q.z, cos * q.z + sin * q.y);
    let skull = ellipsoid(q - DVec3::new(0.0, 0.015, -0.012), DVec3::new(0.07, 0.08, 0.086));
    let face = ellipsoid(q - DVec3::new(0.0, -0.028, 0.028), DVec3::new(0.052, 0.077, 0.056));
    let nose = round_cone(q, DVec3::new(0.0, 0.0, 0.078), DVec3::new(0.0, -0.034, 0.094), 0.006, 0.010);
    let knot = ellipsoid(q - DVec3::new(0.0, 0.05, -0.1), DVec3::new(0.045, 0.042, 0.042));
    join(join(join(skull, face, 0.03), nose, 0.012), knot, 0.018)
}

/// A curved limb: a parabola (Bézier curve of second order) that gets thinner.
struct Limb {
    from: DVec3,
    towards: DVec3,
    to: DVec3,
    radii: [f64; 2],
}

const LEFT_ARM: Limb = Limb {
    from: DVec3::new(-0.10, 1.375, 0.005),
    towards: DVec3::new(-0.56, 1.58, 0.08),
    to: DVec3::new(-0.025, 1.97, 0.06),
    radii: [0.05, 0.022],
};

const RIGHT_ARM: Limb = Limb {
    from: DVec3::new(0.155, 1.375, 0.005),
    towards: DVec3::new(0.58, 1.66, 0.1),
    to: DVec3::new(0.06, 1.945, 0.075),
    radii: [0.05, 0.022],
};

const LEFT_HAND: Limb = Limb {
    from: DVec3::new(-0.035, 1.962, 0.06),
    towards: DVec3::new(0.005, 1.998, 0.06),
    to: DVec3::new(0.07, 2.0, 0.04),
    radii: [0.026, 0.009],
};

const RIGHT_HAND: Limb = Limb {
    from: DVec3::new(0.07, 1.937, 0.075),
    towards: DVec3::new(0.02, 1.965, 0.085),
    to: DVec3::new(-0.045, 1.93, 0.105),
    radii: [0.026, 0.009],
};

impl Limb {
    fn distance(&self, p: DVec3) -> f64 {
        const PIECES: u32 = 14;
        let at = |i: u32| {
            let t = f64::from(i) / f64::from(PIECES);
            let point = self.from.lerp(self.towards, t).lerp(self.towards.lerp(self.to, t), t);
            (point, self.radii[0] + t * (self.radii[1] - self.radii[0]))
        };
        let piece = |i: u32| {
            let ((a, ra), (b, rb)) = (at(i), at(i + 1));
            round_cone(p, a, b, ra, rb)
        };
        (0..PIECES).map(piece).fold(f64::INFINITY, f64::min)
    }
}

/// Distance to the base, a round slab with a rounded rim.
fn plinth(p: DVec3) -> f64 {
    const RIM: f64 = 0.012;
    let outside = DVec2::new(DVec2::new(p.x, p.z).length() - (0.47 - RIM), (p.y - 0.04).abs() - (0.04 - RIM));
    outside.max(DVec2::ZERO).length() + outside.max_element().min(0.0) - RIM
}

/// Smooth minimum of two distances: rounded where they differ by less than `k`, so that the solids blend.
///
/// min(a, b) − k h³/6,  h = max(k − |a − b|, 0) / k
fn join(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - k * h * h * h / 6.0
}

/// Distance to a segment whose radius changes linearly along it.
fn round_cone(p: DVec3, a: DVec3, b: DVec3, ra: f64, rb: f64) -> f64 {
    let axis = b - a;
    let t = ((p - a).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
    (p - a.lerp(b, t)).length() - (ra + t * (rb - ra))
}

/// Approximate distance to an ellipsoid: |q| (|q| − 1) / |∇|, with q = p / radii.
fn ellipsoid(p: DVec3, radii: DVec3) -> f64 {
    let (q, slope) = ((p / radii).length(), (p / (radii * radii)).length());
    if slope == 0.0 { -radii.min_element() } else { q * (q - 1.0) / slope }
}

/// (1 − x²)³ for |x| < 1, else 0: a smooth hill of height 1.
fn bump(x: f64) -> f64 {
    let rest = (1.0 - x * x).max(0.0);
    rest * rest * rest
}

/// cos(nθ + phase) of the polar angle θ of `q`, as Re (q/|q|)ⁿ e^{i·phase}; phase in degrees.
fn cos_multiple(q: DVec2, n: u32, phase: f64) -> f64 {
    let unit = q.normalize_or(DVec2::X);
    let (sin, cos) = sin_cos_degrees(phase);
    (0..n).fold(DVec2::new(cos, sin), |z, _| z.rotate(unit)).x
}
