//! Point lights with measured intensities, and spotlights that project a picture.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec3, UVec2, Vec2, Vec3};
use pt::describe::ies;
use pt::light::{Falloff, IntensityProfile, Light, LightSampleContext, Lights, Projector, Spot};
use pt::math::Rgb;
use pt::texture::image::Pixels;

use crate::random::Random;

/// An IES file with the given angles and values.
fn file(vertical: &[f64], horizontal: &[f64], values: &[f64]) -> String {
    let list = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join("\n");
    format!(
        "IESNA:LM-63-2002\r\n[TEST] none\nTILT=NONE\n1 1000 1.5 {} {} 1 2 .1 .1 0\n1 1 60\n{}\n{}\n{}\n",
        vertical.len(),
        horizontal.len(),
        list(vertical),
        list(horizontal),
        list(values)
    )
}

fn read(text: &str) -> IntensityProfile {
    let (profile, warnings) = ies::read(text.as_bytes(), "lamp.ies").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(warnings, [""; 0]);
    profile
}

fn direction(vertical: f64, horizontal: f64) -> Vec3 {
    let (theta, phi) = (vertical.to_radians(), horizontal.to_radians());
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()).as_vec3()
}

/// The file's values at its angles, divided by the greatest, and their mean half way between. 0 beyond its angles.
#[test]
fn profiles_have_the_values_of_their_file() {
    let (vertical, horizontal) = ([0.0, 30.0, 90.0], [0.0, 120.0, 240.0, 360.0]);
    let values = [100.0, 80.0, 20.0, 100.0, 60.0, 0.0, 100.0, 40.0, 10.0, 100.0, 80.0, 20.0];
    let profile = read(&file(&vertical, &horizontal, &values));
    let near = |found: f32, expected: f64| assert!((f64::from(found) - expected).abs() < 2e-5, "{found}, expected {expected}");
    for (i, phi) in horizontal.into_iter().enumerate() {
        for (j, theta) in vertical.into_iter().enumerate() {
            // Just inside the last angle, beyond which there is no light.
            near(profile.at(direction(theta.min(89.9999), phi)), values[3 * i + j] / 100.0);
        }
    }
    near(profile.at(direction(60.0, 180.0)), (60.0 + 0.0 + 40.0 + 10.0) / 400.0);
    near(profile.at(direction(15.0, 300.0)), (100.0 + 40.0 + 100.0 + 80.0) / 400.0);
    assert_eq!(profile.at(direction(91.0, 10.0)), 0.0);
}

/// Files that state a part of the horizontal angles stand for the rest by symmetry: all, a half to either side, a quarter.
#[test]
fn profiles_are_unfolded_by_symmetry() {
    let vertical = [0.0, 90.0, 180.0];
    // The value at 90° from the axis falls linearly with the angle that the horizontal angle is folded to.
    let profile = |horizontal: &[f64], of: &dyn Fn(f64) -> f64| {
        let values: Vec<f64> = horizontal.iter().flat_map(|phi| [50.0, of(*phi), 50.0]).collect();
        read(&file(&vertical, horizontal, &values))
    };
    let by_angle = |phi: f64| 100.0 - phi / 9.0;
    type Fold = fn(f64) -> f64;
    let folded: [(&[f64], Fold); 4] = [
        (&[0.0], |_| 0.0),
        (&[0.0, 45.0, 90.0], |phi| if phi % 180.0 > 90.0 { 180.0 - phi % 180.0 } else { phi % 180.0 }),
        (&[0.0, 90.0, 180.0], |phi| if phi > 180.0 { 360.0 - phi } else { phi }),
        (&[90.0, 135.0, 180.0, 225.0, 270.0], |phi| if (90.0..=270.0).contains(&phi) { phi } else { (540.0 - phi) % 360.0 }),
    ];
    for (horizontal, fold) in folded {
        let profile = profile(horizontal, &by_angle);
        for phi in [10.0, 100.0, 170.0, 190.0, 280.0, 359.0] {
            let (found, expected) =
                (f64::from(profile.at(direction(90.0, phi))), by_angle(fold(phi)) / by_angle(fold(0.0).min(horizontal[0])));
            assert!((found - expected).abs() < 1e-5, "{horizontal:?}, {phi}: {found}, expected {expected}");
        }
    }
}

/// Sampled directions have the density that is stated for them, and the estimates of the flux by them have the mean of the integral.
#[test]
fn directions_of_profiles_are_distributed_as_their_density_says() {
    let (vertical, horizontal) = (vec![0.2, 0.9, 1.7, 3.0], vec![0.0, 1.0, 4.0, TAU]);
    let mut random = Random::new(8);
    let values: Vec<f64> = (0..16).map(|k| if k % 5 == 0 { 0.0 } else { random.unit() }).collect();
    let profile = IntensityProfile::new(vertical, horizontal, values).expect("a profile");
    // The integral by the midpoint rule.
    let n = 600;
    let mut integral = 0.0;
    for (i, j) in (0..2 * n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let (phi, theta) = ((i as f32 + 0.5) * PI / n as f32, (j as f32 + 0.5) * PI / n as f32);
        let w = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        integral += f64::from(profile.at(w) * theta.sin()) * (f64::from(PI) / f64::from(n)).powi(2);
    }
    let (mut sum, mut square, count) = (0.0, 0.0, 200_000);
    for _ in 0..count {
        let (w, pdf) = profile.sample(Vec2::new(random.unit() as f32, random.unit() as f32));
        let again = profile.pdf(w).get();
        assert!((w.length() - 1.0).abs() < 1e-6 && pdf.get() > 0.0, "{w}");
        // Rounding may put a direction on the other side of a border between cells.
        let on_border = (profile.pdf(w + Vec3::splat(1e-5)).get() - again).abs() > 1e-6
            || (profile.pdf(w - Vec3::splat(1e-5)).get() - again).abs() > 1e-6;
        assert!((again - pdf.get()).abs() <= 1e-4 * pdf.get() || on_border, "{w}: {again}, {}", pdf.get());
        let estimate = f64::from(profile.at(w) / pdf.get());
        (sum, square) = (sum + estimate, square + estimate * estimate);
    }
    let mean = sum / f64::from(count);
    let error = ((square / f64::from(count) - mean * mean) / f64::from(count)).sqrt();
    // Four standard errors, and the steps of the midpoint rule at the edges.
    assert!((mean - integral).abs() < 4.0 * error + 2e-3 * integral, "{mean} ± {error}, quadrature {integral}");
}

/// What is no IES file of type C is refused in one sentence that says what was found.
#[test]
fn other_profiles_are_refused() {
    let sound = file(&[0.0, 90.0], &[0.0], &[1.0, 2.0]);
    read(&sound);
    let cases = [
        (String::new(), "no IES file"),
        ("\u{1f600} not at all".into(), "no IES file"),
        (sound.replace("TILT=NONE", "TILT=lamp.tlt"), "TILT=lamp.tlt"),
        (sound.replace(" 1 2 .1", " 2 2 .1"), "type B"),
        (sound.replace(" 1 2 .1", " 3 2 .1"), "type A"),
        (sound.replace("60", "sixty"), "found \"sixty\""),
        (sound.replace("60", "NaN"), "found \"NaN\""),
        (sound.replace("1.5 2 1", "1.5 2.5 1"), "vertical angles from 1 to 65536, found 2.5"),
        (sound.replace("1.5 2 1", "1.5 2 60000"), "ends too early"),
        (file(&[0.0, 90.0], &[0.0], &[1.0, -2.0]), "at least 0, found -2"),
        (file(&[0.0, 90.0], &[0.0], &[0.0, 0.0]), "above 0"),
        (file(&[90.0, 0.0], &[0.0], &[1.0, 2.0]), "rise within 0 to 180"),
        (file(&[0.0, 270.0], &[0.0], &[1.0, 2.0]), "rise within 0 to 180"),
        (file(&[0.0], &[0.0], &[1.0]), "rise within 0 to 180"),
        (file(&[0.0, 90.0], &[0.0, 70.0], &[1.0; 4]), "horizontal angles"),
        (file(&[0.0, 90.0], &[0.0, 0.0], &[1.0; 4]), "horizontal angles"),
    ];
    for (text, expected) in cases {
        let refused = ies::read(text.as_bytes(), "lamp.ies").expect_err(expected).to_string();
        assert!(refused.contains("lamp.ies") && refused.contains(expected), "{refused}");
    }
    let tilted = sound.replace("TILT=NONE", "TILT=INCLUDE\n1\n2\n0 90\n1 .9");
    let (profile, warnings) = ies::read(tilted.as_bytes(), "lamp.ies").expect("a profile");
    assert_eq!((profile, warnings.len()), (read(&sound), 1));
}

/// On a wall before the light the picture stands upright and not mirrored as seen from the light: each point has the intensity of the
/// pixel that a straight line from the light meets, over the squared distance. Beside the picture there is no light.
#[test]
fn projectors_show_their_picture() {
    let values: Vec<[f32; 3]> = (0..6).map(|k| [k as f32 / 8.0 + 0.1, 0.5, 1.0 - k as f32 / 8.0]).collect();
    let pixels = Arc::new(Pixels::new(UVec2::new(3, 2), values.clone()).expect("pixels"));
    let axis = Vec3::NEG_Z;
    let spot = Spot { position: DVec3::ZERO, axis, intensity: Rgb::gray(4.0), cos_inner: 0.5, cos_outer: 0.4, falloff: Falloff::Smooth };
    let light = Light::Projector(Box::new(Projector::new(spot, Vec3::Y, 0.6, pixels).expect("y is not the axis")));
    let lights = Lights::new(vec![light], vec![].into(), (Vec3::ZERO, 10.0));
    let at = |x: f32, y: f32| {
        // A wall 5 m before the light, 6 m of which show the width of the picture and 4 m its height.
        let p = Vec3::new(x, y, -5.0);
        lights.sample(&LightSampleContext::at(p), 0.5, Vec2::splat(0.5)).map(|sample| (sample.li.to_rgb(), p.length_squared()))
    };
    for (k, value) in values.into_iter().enumerate() {
        let (column, row) = ((k % 3) as f32, (k / 3) as f32);
        let (found, square) = at(-2.0 + 2.0 * column, 1.0 - 2.0 * row).expect("light");
        for (found, value) in found.into_iter().zip(value) {
            assert!((found * square / 4.0 - value).abs() < 1e-5, "pixel {k}: {found} for {value}");
        }
    }
    assert!(at(3.01, 0.0).is_none() && at(0.0, -2.01).is_none() && at(2.99, 1.99).is_some());
    assert!(Projector::new(spot, Vec3::Z, 0.6, Arc::new(Pixels::new(UVec2::ONE, vec![[1.0; 3]]).expect("a pixel"))).is_none());
}
