//! Gradients of distance fields, compared with finite differences where the field is differentiable.

use glam::DVec3;
use pt::shape::sdf::{Dual, Field};

use super::zoo;
use crate::random::Random;

/// (d(p + h) − d(p)) / h along each axis.
fn slopes(field: &Field, p: DVec3, h: f64) -> DVec3 {
    let along = |axis: DVec3| (field.at(p + axis * h) - field.at(p)) / h;
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}

/// Forward and backward differences over 10⁻⁶ agree up to the curvature. At an edge they do not agree, and there is no gradient.
///
/// The error of their mean is that of the third derivative, below h² / 10⁻³ for features of 10⁻¹, and that of rounding, 10⁻¹⁵/h.
#[test]
fn gradients_are_finite_differences() {
    const STEP: f64 = 1e-6;
    for (name, make) in zoo::all() {
        let (mut judged, mut all) = (0, 0);
        for seed in 0..40 {
            let mut random = Random::new(seed);
            let field = make(&mut random);
            for _ in 0..200 {
                let p = random.in_cube() * 3.0;
                let (forward, backward) = (slopes(&field, p, STEP), slopes(&field, p, -STEP));
                all += 1;
                if (forward - backward).abs().max_element() > 1e-4 {
                    continue;
                }
                judged += 1;
                let found = field.distance(Dual::coordinates(p));
                assert_eq!(found.value, field.at(p), "{name}, seed {seed}");
                let apart = (found.gradient - 0.5 * (forward + backward)).abs().max_element();
                assert!(apart < 1e-6, "{name}, seed {seed}: {} but {forward} at {p}", found.gradient);
                assert!(found.gradient.length() <= 1.0 + 1e-12, "{name}, seed {seed}: {}", found.gradient);
            }
        }
        assert!(judged > all * 9 / 10, "{name}: {judged} of {all}");
    }
}
