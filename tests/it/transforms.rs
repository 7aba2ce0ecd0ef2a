//! Affine maps and their inverses.

use glam::{DMat3, DMat4, DVec3, DVec4};
use pt::math::transform::{Transform, unit};
use pt::math::{Frame, Local, Vec3};

use crate::random::Random;

/// Tolerance: a dozen roundings of numbers up to 1.
const FEW_ROUNDINGS: f64 = 12.0 * f64::EPSILON;

/// Translation, rotation and scale, with the condition number of its linear part: the largest scale over the smallest.
fn random_trs(random: &mut Random, mirrored: bool) -> (Transform, f64) {
    let s = DVec3::new(random.magnitude(0.1, 1000.0), random.magnitude(0.1, 1000.0), random.magnitude(0.1, 1000.0));
    let sign = if mirrored { DVec3::new(-1.0, 1.0, 1.0) } else { DVec3::ONE };
    let rotate = Transform::rotate(random.direction(), random.range(-360.0, 360.0)).unwrap();
    let shear = Transform::rotate(random.direction(), random.range(-360.0, 360.0)).unwrap();
    let translate = Transform::translate(random.direction() * random.magnitude(0.01, 100.0)).unwrap();
    let trs = shear.then(&Transform::scale(s * sign).unwrap()).then(&rotate).then(&translate);
    (trs, s.max_element() / s.min_element())
}

/// The largest element of M·M⁻¹ − 1.
fn inverse_error(t: &Transform) -> f64 {
    let product = t.matrix().matrix3 * t.inverse().matrix().matrix3;
    (product - DMat3::IDENTITY).to_cols_array().into_iter().fold(0.0, |worst, e| worst.max(e.abs()))
}

#[test]
fn the_inverse_undoes_a_transform() {
    let mut random = Random::new(1);
    for i in 0..1_000_000 {
        let (t, condition) = random_trs(&mut random, i % 2 == 0);
        // The rounding error is amplified by at most the condition number.
        let tolerance = FEW_ROUNDINGS * condition;
        assert!(inverse_error(&t) < tolerance, "{t:?}");
        let p = random.direction() * 10.0;
        // A translation of up to 100 in M becomes up to 100/0.1 in M⁻¹.
        let back = t.inverse().point(t.point(p));
        assert!(back.distance(p) < 1200.0 * tolerance, "{t:?}: {p} → {back}");
        let rebuilt = Transform::from_matrix(DMat4::from(t.matrix())).unwrap();
        assert!(inverse_error(&rebuilt) < FEW_ROUNDINGS * condition * condition.sqrt());
        assert_eq!(rebuilt.flips_handedness(), t.flips_handedness());
    }
}

#[test]
fn mirrors_flip_handedness_and_two_of_them_do_not() {
    let mirror = Transform::scale(DVec3::new(-1.0, 1.0, 1.0)).unwrap();
    let n = mirror.normal(DVec3::new(1.0, 1.0, 0.0) / 2f64.sqrt());
    assert!(n.distance(DVec3::new(-1.0, 1.0, 0.0) / 2f64.sqrt()) < 1e-15, "{n}");

    let mut random = Random::new(3);
    for i in 0..10_000 {
        let (a, _) = random_trs(&mut random, i % 2 == 0);
        let (b, _) = random_trs(&mut random, i % 3 == 0);
        let both = a.then(&b);
        assert_eq!(both.flips_handedness(), both.determinant() < 0.0);
        assert_eq!(both.flips_handedness(), a.flips_handedness() ^ b.flips_handedness());
        // The cross product of mapped edges points along the mapped normal, or against it after a mirror.
        let (x, y) = (random.direction(), random.direction());
        let crossed = both.vector(x).cross(both.vector(y)).dot(both.normal(x.cross(y)));
        assert_eq!(crossed < 0.0, both.flips_handedness());
    }
    let (any, _) = random_trs(&mut random, false);
    assert_eq!(mirror.then(&mirror).then(&any).matrix(), any.matrix());
}

#[test]
fn then_applies_the_receiver_first() {
    let one_right = Transform::translate(DVec3::X).unwrap();
    let doubled = Transform::scale(DVec3::splat(2.0)).unwrap();
    assert_eq!(one_right.then(&doubled).point(DVec3::ZERO), 2.0 * DVec3::X);
    assert_eq!(doubled.then(&one_right).point(DVec3::ZERO), DVec3::X);
    assert_eq!(one_right.then(&doubled).vector(DVec3::Y), 2.0 * DVec3::Y);
}

#[test]
fn quarter_turns_are_exact() {
    for quarter in -8..8i32 {
        let t = Transform::rotate(DVec3::Z * 3.0, 90.0 * f64::from(quarter)).unwrap();
        let turned = [DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y][quarter.rem_euclid(4) as usize];
        assert_eq!(t.vector(DVec3::X), turned, "counter-clockwise about z");
        assert_eq!(t.vector(DVec3::Z), DVec3::Z);
    }
    assert_eq!(Transform::rotate(DVec3::X, 90.0).unwrap().vector(DVec3::Y), DVec3::Z);
    assert_eq!(Transform::rotate(DVec3::Y, 90.0).unwrap().vector(DVec3::Z), DVec3::X);
}

#[test]
fn rotations_keep_lengths_axes_and_handedness() {
    let mut random = Random::new(4);
    for _ in 0..10_000 {
        let (axis, degrees, v) = (random.direction() * random.magnitude(1e-200, 1e200), random.range(-720.0, 720.0), random.direction());
        let t = Transform::rotate(axis, degrees).unwrap();
        let axis = unit(axis).unwrap();
        let turned = t.vector(v);
        assert!((turned.length() - 1.0).abs() < FEW_ROUNDINGS && t.vector(axis).distance(axis) < FEW_ROUNDINGS);
        assert!((t.determinant() - 1.0).abs() < FEW_ROUNDINGS && !t.flips_handedness());
        // The angle between the parts of v across the axis, counter-clockwise.
        let (before, after) = (v.reject_from_normalized(axis), turned.reject_from_normalized(axis));
        let (sin, cos) = (axis.dot(before.cross(after)), before.dot(after));
        let expected = degrees.to_radians();
        let error = (sin - cos.hypot(sin) * expected.sin()).abs() + (cos - cos.hypot(sin) * expected.cos()).abs();
        assert!(error < 2e-14, "{degrees}° about {axis}");
    }
}

#[test]
fn look_at_looks_down_minus_z_with_y_up() {
    let mut random = Random::new(5);
    for _ in 0..10_000 {
        let (from, to, up) = (random.direction() * 10.0, random.direction() * 10.0, random.direction());
        let t = Transform::look_at(from, to, up).unwrap();
        let (x, y, z) = (t.vector(DVec3::X), t.vector(DVec3::Y), t.vector(DVec3::Z));
        assert_eq!(t.point(DVec3::ZERO), from);
        let ahead = t.point(DVec3::Z * -from.distance(to));
        assert!(ahead.distance(to) < 1e-14 * 20.0, "{ahead} is not {to}");
        assert!(y.dot(up) > 0.0 && x.dot(up).abs() < 1e-14, "y is up and x is level");
        assert!(x.cross(y).distance(z) < FEW_ROUNDINGS && inverse_error(&t) < FEW_ROUNDINGS && !t.flips_handedness());
    }
}

#[test]
fn look_at_refuses_what_has_no_frame() {
    let (o, ahead) = (DVec3::ZERO, DVec3::new(1.0, 2.0, -3.0));
    assert!(Transform::look_at(o, o, DVec3::Y).is_err());
    assert!(Transform::look_at(o, ahead, DVec3::ZERO).is_err());
    assert!(Transform::look_at(o, DVec3::NAN, DVec3::Y).is_err());
    assert!(Transform::look_at(o, DVec3::INFINITY, DVec3::Y).is_err());
    let mut random = Random::new(6);
    for _ in 0..10_000 {
        let (from, direction) = (random.direction(), random.direction() * random.magnitude(0.1, 10.0));
        assert!(Transform::look_at(DVec3::ZERO, direction, direction * random.range(-3.0, 3.0)).is_err());
        // Directions that are nearly parallel still give a frame.
        let up = direction + 1e-6 * from;
        let frame = Transform::look_at(DVec3::ZERO, direction, up).unwrap();
        assert!(inverse_error(&frame) < FEW_ROUNDINGS);
    }
}

#[test]
fn matrices_that_are_no_affine_bijections_are_refused() {
    let refused = |m: DMat4| Transform::from_matrix(m).is_err();
    let zero_scale = DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0));
    assert!(refused(DMat4::ZERO) && refused(zero_scale) && refused(DMat4::NAN));
    assert!(refused(DMat4::IDENTITY * f64::INFINITY) && refused(DMat4::from_translation(DVec3::INFINITY)));
    for projective in [DVec4::new(0.0, 0.0, -1.0, 0.0), DVec4::new(1e-9, 0.0, 0.0, 1.0), DVec4::new(0.0, 0.0, 0.0, 2.0)] {
        assert!(refused(DMat4::from_rows(DVec4::X, DVec4::Y, DVec4::Z, projective)));
    }
    assert!(Transform::scale(DVec3::new(1.0, 0.0, 1.0)).is_err() && Transform::scale(DVec3::NAN).is_err());
    assert!(Transform::scale(DVec3::splat(f64::INFINITY)).is_err());
    assert!(Transform::rotate(DVec3::ZERO, 30.0).is_err() && Transform::rotate(DVec3::X, f64::NAN).is_err());
    assert!(Transform::rotate(DVec3::X, f64::INFINITY).is_err() && Transform::translate(DVec3::NAN).is_err());

    let mut random = Random::new(7);
    for _ in 0..10_000 {
        let (a, b) = (random.direction() * random.magnitude(1e-9, 1e9), random.direction());
        let (s, t) = (random.range(-2.0, 2.0), random.range(-2.0, 2.0));
        // The third column lies in the plane of the others, up to rounding. Rows and columns have any magnitude.
        let flat = DMat3::from_cols(a, b, s * a + t * b);
        let rows = DMat3::from_diagonal(DVec3::new(random.magnitude(1e-9, 1e9), 1.0, random.magnitude(1e-9, 1e9)));
        assert!(refused(DMat4::from_mat3(rows * flat)), "{flat}");
    }
}

#[test]
fn singular_is_relative_so_tiny_and_flat_objects_are_allowed() {
    for s in [1e-80, 1e-30, 1e-15, 1e15, 1e30, 1e80] {
        let t = Transform::from_matrix(DMat4::from_scale(DVec3::splat(s))).unwrap();
        assert!(inverse_error(&t) < 4.0 * f64::EPSILON);
        assert!(Transform::from_matrix(DMat4::from_scale(DVec3::new(1.0, 1.0, s))).is_ok());
    }
}

/// Frames around all directions, including the poles and their neighbourhood, are orthonormal and right-handed, and invert their own
/// transform of vectors. The tolerance is four roundings of numbers up to 1, over the sine of the angle to the given x axis, whose
/// component along z is removed.
#[test]
fn frames_are_orthonormal() {
    let given = Vec3::new(0.6, -0.48, 0.64);
    let mut random = Random::new(3);
    let near_poles = [0.0f32, -0.0, 1e-30, 1e-8, 1e-4].into_iter().flat_map(|x| [1f32, -1.0].map(|z| Vec3::new(x, -x, z).normalize()));
    let anywhere = (0..100_000).map(|_| random.direction().as_vec3().normalize());
    for z in near_poles.chain(anywhere.collect::<Vec<_>>()) {
        for (frame, sine) in [(Some(Frame::around(z)), 1.0), (Frame::along(z, given), given.cross(z).length())] {
            let (Some(frame), few) = (frame, 4.0 * f32::EPSILON / sine) else { continue };
            let Frame { x, y, z } = frame;
            assert!([x, y, z].iter().all(|v| (v.length() - 1.0).abs() < few), "{frame:?}");
            assert!(x.dot(y).abs() < few && y.dot(z).abs() < few && z.dot(x).abs() < few, "{frame:?}");
            assert!((x.cross(y) - z).length() < few, "{frame:?}");
            let w = Vec3::new(0.36, 0.48, -0.8);
            // The tolerance is that of three axes.
            assert!((frame.to_local(frame.to_world(Local(w))).0 - w).length() < 3.0 * few, "{frame:?}");
        }
    }
}

/// Invalid transforms have error messages in words, and a pose equals the transform that it is made of.
#[test]
fn error_messages_name_the_invalid_input() {
    let said = |result: pt::Result<Transform>| result.expect_err("no transform").to_string();
    assert_eq!(said(Transform::translate(DVec3::new(f64::NAN, 0.0, 0.0))), "expected a translation by finite numbers, found [NaN, 0, 0]");
    assert_eq!(said(Transform::scale(DVec3::new(1.0, 0.0, 1.0))), "expected scale factors that are finite and not 0, found [1, 0, 1]");
    assert_eq!(said(Transform::rotate(DVec3::ZERO, 30.0)), "expected a finite angle and an axis that is not 0, found 30° about [0, 0, 0]");
    assert!(said(Transform::look_at(DVec3::X, DVec3::X, DVec3::Y)).starts_with("a view from [1, 0, 0] to [1, 0, 0]"));
    let (from, to, up) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.5, 0.0), DVec3::Y);
    let pose = pt::camera::Pose::look_at(from, to, up).expect("a view");
    assert_eq!(pose, pt::camera::Pose::new(&Transform::look_at(from, to, up).expect("a view")));
    assert!(pt::camera::Pose::look_at(from, from, up).is_err());
}
