//! A ball of fur: hairs on a sphere of radius 1 around the origin, combed from the top (+y) down, except where the eyes are.

use glam::Vec3;
use pt::math::float::{exp, sin_cos};

const HAIRS: u32 = 9000;
const POINTS: u32 = 4;

/// Places of the eyes on the sphere, and the cosine of the angle around them without hair.
const EYES: [Vec3; 2] = [Vec3::new(-0.3, 0.32, 0.9), Vec3::new(0.3, 0.32, 0.9)];
const EYE: f32 = 0.975;

/// The hairs as a .hair file: header, number of segments, positions. Thickness is left to the scene.
pub fn fur() -> Vec<u8> {
    let hairs: Vec<[Vec3; POINTS as usize]> = (0..HAIRS).filter_map(hair).collect();
    let mut file = b"HAIR".to_vec();
    // Strands, points, flags (positions only), segments of each strand.
    for number in [hairs.len() as u32, hairs.len() as u32 * POINTS, 2, POINTS - 1] {
        file.extend(number.to_le_bytes());
    }
    // Thickness, transparency, colour, and 88 bytes of text.
    file.resize(128, 0);
    for number in hairs.iter().flatten().flat_map(|p| p.to_array()) {
        file.extend(number.to_le_bytes());
    }
    file
}

/// Pseudorandom number in [0, 1) for a hair and a purpose.
fn number(hair: u32, purpose: u32) -> f32 {
    let mut x = (hair.wrapping_mul(3).wrapping_add(purpose)).wrapping_mul(0x9e37_79b9);
    x = (x ^ (x >> 16)).wrapping_mul(0x85eb_ca6b);
    x = (x ^ (x >> 13)).wrapping_mul(0xc2b2_ae35);
    ((x ^ (x >> 16)) >> 8) as f32 / 16_777_216.0
}

/// Points of a hair, whose root is one of those of a spiral on the sphere; `None` near the eyes.
fn hair(k: u32) -> Option<[Vec3; POINTS as usize]> {
    let y = 1.0 - 2.0 * (k as f32 + 0.5) / HAIRS as f32;
    let turns = k as f32 * 0.618_034;
    let (sin, cos) = sin_cos(std::f32::consts::TAU * (turns - turns.floor()));
    let normal = Vec3::new(sin * (1.0 - y * y).sqrt(), y, cos * (1.0 - y * y).sqrt());
    if EYES.iter().any(|eye| eye.normalize().dot(normal) > EYE) {
        return None;
    }
    // Down, a little to one side, and a little in any direction.
    let jitter = Vec3::new(number(k, 0), number(k, 1), number(k, 2)) * 2.0 - 1.0;
    let down = Vec3::NEG_Y + 0.3 * normal.cross(Vec3::Y) + 0.35 * jitter;
    let comb = down - normal * down.dot(normal);
    let length = 0.36 + 0.12 * number(k + HAIRS, 0) + 0.25 * exp(-8.0 * (1.0 - y));
    Some([(0.0, 0.0), (0.35, 0.08), (0.62, 0.35), (0.72, 0.8)].map(|(out, along)| normal + (normal * out + comb * along) * length))
}
